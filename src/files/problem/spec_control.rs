//! A control problem as it is written.

use crate::files::json::either::AutoOr;
use crate::files::json::objects::read_objects;
use crate::files::problem::at::CoordinatesSpec;
use crate::files::problem::free::FreeMap;
use crate::files::problem::loads::{LoadBounds, LoadMap};
use crate::files::problem::quantities::keys::{FinalSpec, LimitSpec, TrackSpec};
use crate::files::problem::sensitivity::SensitivityMap;
use crate::files::problem::state::{GoalSpec, HoldSpec, StartSpec, WaypointSpec};
use crate::files::problem::voltages::VoltagesSpec;
use crate::files::study::ChangesSpec;
use crate::files::units::quantity::{Quantity, Time, Voltage};
use crate::ipopt::LinearSolver;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;

read_objects! {
    /// An optimal control problem.
    #[schemars(transform = needed_without_motions)]
    pub struct ControlSpec {
        /// Final time, SI unit s, or its bounds and a guess.
        pub duration: DurationSpec,
        /// Number of intervals, 1 or more, or `"auto"`, as where it is not written: as many as the verification of the optimum needs to confirm
        /// an error of 1 % of the path length, or of the part that `--accuracy` gives.
        pub intervals: Option<IntervalsSpec>,
        /// Initial state; of a periodic motion, whose start is sought, the state where the solver begins.
        pub start: StartSpec,
        /// Final state; may be left out where the objective names something to `track` or where to end (`final`), and is free then.
        pub goal: Option<GoalSpec>,
        /// Lower and upper bound of every voltage that is sought, SI unit V; not needed where none is.
        pub voltage_bounds: Option<[Quantity<Voltage>; 2]>,
        /// Lower and upper bound of each load that is sought, by name, SI units N, N m, Pa, N/m³ and C/m².
        pub load_bounds?: LoadBounds,
        /// Loads that are given, by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where neither given nor sought.
        pub loads?: LoadMap,
        /// Voltages that are given, by the names of muscles and driven electrodes (`block.electrode`), SI unit V: they are no unknowns,
        /// and one of 0 for all the time leaves no electric term at all. Functions of time, a table and those of a solution give all
        /// voltages, as of a simulation; then a constant of the scene has to be sought.
        pub voltages?: VoltagesSpec,
        /// Constants of the scene that are sought, by their paths, such as `materials.silicone.shear_modulus`.
        pub free?: FreeMap,
        /// Numbers by which the optimum is differentiated, by their paths: constants of the scene, such as `materials.silicone.shear_modulus`, and
        /// `duration`, `goal.joint_angles.NAME`, `goal.markers.NAME[0]`, `goal.rest_at_voltages.NAME`, `start.joint_angles.NAME`,
        /// `start.joint_rates.NAME`, `start.rest_at_voltages.NAME`, `voltage_bounds[1]`, `load_bounds.NAME[1]`, `objective.effort`, `objective.rate`,
        /// `objective.duration`.
        pub sensitivity?: SensitivityMap,
        /// Treatment of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is
        /// `reported` (where not written), or refused where holding it is `required`.
        pub hold?: HoldSpec,
        /// Objective that is minimised.
        pub objective: ObjectiveSpec,
        /// Path limits.
        pub limits?: Vec<LimitSpec>,
        /// Places, orientations and joint coordinates that the motion reaches on its way.
        pub waypoints?: Vec<WaypointSpec>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
        /// Initial guess of the solver; where not written, of elastic blocks whose goal has `hold`, the motion under these voltages, otherwise
        /// `"interpolate"`.
        pub guess: Option<GuessSpec>,
        /// Options of the solver.
        pub solver?: SolverSpec,
        /// Several motions in one optimisation: what `free` seeks is the same in all of them, and the objective is the sum of theirs. Each names the
        /// keys that are other ones in it.
        pub motions?: Vec<MotionSpec>,
        /// Names of muscles, driven electrodes (`block.electrode`) and loads whose inputs are sought once for all motions; these have one
        /// given duration and one number of intervals.
        pub shared_inputs?: Vec<String>,
        /// The objective of several motions: the `sum` of theirs (where not written), or that of the `worst`, the greatest one.
        pub combine: Option<CombinedSpec>,
    }

    /// The objective of several motions.
    pub enum CombinedSpec {
        /// The sum of their objectives.
        Sum,
        /// The greatest of their objectives.
        Worst,
    }
}

/// Keys that are needed, but where each motion may have its own.
fn needed_without_motions(schema: &mut Schema) {
    if let Some(needed) = schema.remove("required") {
        let no_motions = json_schema!({ "not": { "required": ["motions"] } });
        schema.insert("if".into(), no_motions.to_value());
        let needed = json_schema!({ "required": needed });
        schema.insert("then".into(), needed.to_value());
    }
}

/// Keys of a control problem that all of its motions have in common.
pub(crate) const COMMON: [&str; 6] = [
    "combine",
    "free",
    "motions",
    "sensitivity",
    "shared_inputs",
    "solver",
];

/// One of several motions: the keys of a control problem that are other ones in it. It is read with those that it shares with the others.
#[derive(Clone, Debug, Deserialize)]
pub struct MotionSpec(IgnoredAny);

impl JsonSchema for MotionSpec {
    fn schema_name() -> Cow<'static, str> {
        "MotionSpec".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let name = json_schema!({
            "description": "Name, and that of its folder of results; one without a name has its number, as in `motion1`.",
            "type": ["string", "null"]
        });
        let mut set = generator.subschema_for::<ChangesSpec>();
        set.insert(
            "description".into(),
            "Constants of the scene that are other ones in this motion, by their places, such as `scene.materials.silicone.shear_modulus`.".into(),
        );
        let mut schema = ControlSpec::json_schema(generator);
        schema.remove("if");
        schema.remove("then");
        if let Some(Value::Object(keys)) = schema.get_mut("properties") {
            keys.retain(|key, _| !COMMON.contains(&&**key));
            keys.insert("name".into(), name.into());
            keys.insert("set".into(), set.into());
        }
        schema.insert(
            "description".into(),
            "One of several motions: the keys of a control problem that are other ones in it; those that it does not name are those of \
             `control`."
                .into(),
        );
        schema
    }
}

/// Number of intervals.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[serde(untagged)]
pub enum IntervalsSpec {
    /// `"auto"`.
    Word(IntervalsWord),
    /// A number.
    Given(usize),
}

/// Intervals of no given number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum IntervalsWord {
    /// As many as the verification needs.
    Auto,
}

impl<'de> Deserialize<'de> for IntervalsSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AutoOr {
            expected: "a whole number of intervals, or \"auto\"",
            auto: Self::Word(IntervalsWord::Auto),
            value: Self::Given,
            is_whole: true,
        })
    }
}

read_objects! {
    /// Bounds of a free final time.
    pub struct FreeDurationSpec {
        /// Lower bound, SI unit s.
        pub min: Quantity<Time>,
        /// Upper bound, SI unit s.
        pub max: Quantity<Time>,
        /// Duration at which the solver starts, SI unit s.
        pub guess: Quantity<Time>,
    }

    /// Weights of the objective.
    pub struct ObjectiveSpec {
        /// Weight of Σ h |V_k|², V in kV, h in s.
        pub effort?: f64,
        /// Weight of Σ |V_k − V_{k−1}|²/h, V in kV, h in s, with the rest voltages of start and goal at the ends.
        pub rate?: f64,
        /// Weight of the final time in s.
        pub duration?: f64,
        /// Weight of the square of the peak voltage in kV: of the largest voltage of all sources that are sought, in all intervals.
        pub peak_voltage?: f64,
        /// Weight per J of the electrical energy from the sources of lumped muscles, of all sources or of named ones; what flows back is negative.
        pub electrical_energy?: EnergySpec,
        /// Weight per J of the mechanical work of the electrical forces of lumped muscles, of all sources or of named ones.
        pub mechanical_work?: EnergySpec,
        /// Weight per cm³ of the volume of all lumped muscles at rest, which follows from free parameters.
        pub muscle_volume?: f64,
        /// Weight per g of the mass of all lumped muscles with a density, which follows from free parameters.
        pub muscle_mass?: f64,
        /// References of markers and joints in time.
        pub track?: Vec<TrackSpec>,
        /// Targets of markers and joints at the end.
        #[serde(rename = "final")]
        pub at_the_end?: Vec<FinalSpec>,
    }

    /// Options of the solver.
    #[derive(Default)]
    pub struct SolverSpec {
        /// Relative tolerance, 1e-10 where not written.
        pub tolerance: Option<f64>,
        /// Limit of iterations, 500 where not written.
        pub max_iterations: Option<usize>,
        /// Solver of the linear systems, `auto` where not written.
        pub linear_solver: Option<ControlSolverSpec>,
        /// Options of Ipopt by name.
        pub ipopt: BTreeMap<String, OptionSpec>,
    }

    /// Solver of the linear systems of a control problem.
    pub enum ControlSolverSpec: LinearSolver {
        /// `stages` where Ipopt takes it, else `mumps`.
        Auto,
        /// LDLᵀ in the order of the horizon.
        Stages,
        /// LDLᵀ of MUMPS.
        Mumps,
    }
}

/// A value of an option of Ipopt.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "another kind of value, expected a whole number, a number or a text"
)]
pub enum OptionSpec {
    /// Whole number.
    Integer(i32),
    /// Number.
    Number(f64),
    /// Text.
    Text(String),
}

read_objects! {
    /// A simulation as a guess.
    pub struct GuessSimulationSpec {
        /// Constant voltages, those of a solution, or a table, as of a simulation; 0 where not written.
        pub voltages?: VoltagesSpec,
    }

    /// A random guess.
    pub struct RandomGuessSpec {
        /// Equal seeds give equal guesses.
        pub seed: u64,
    }

    /// An object of a guess: exactly one of the three.
    pub struct GuessObjectSpec {
        /// A simulation under given voltages.
        pub simulate: Option<GuessSimulationSpec>,
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder.
        pub solution: Option<String>,
        /// A simulation under constant voltages drawn at random within the bounds.
        pub random: Option<RandomGuessSpec>,
    }

    /// A word of a guess.
    pub enum GuessWord {
        /// Smooth interpolation between start and goal.
        Interpolate,
    }

    /// A time, or bounds of a free one.
    pub either DurationSpec("a time, such as \"0.6 s\", or an object with \"min\", \"max\" and \"guess\"") {
        /// Given.
        Given: Quantity<Time>,
        /// Free.
        Free: FreeDurationSpec,
    }

    /// A word or an object.
    pub either GuessSpec("\"interpolate\" or an object with \"simulate\", \"solution\" or \"random\"") {
        /// `"interpolate"`.
        Word: GuessWord,
        /// An object.
        Object: GuessObjectSpec,
    }

    /// The weight of an energy of some sources.
    pub struct SourceEnergySpec {
        /// Weight per J.
        pub weight: f64,
        /// Names of lumped muscles.
        pub sources: Vec<String>,
    }

    /// The weight of an energy of all sources, or of those that are named.
    pub either EnergySpec("a weight, or an object with \"weight\" and \"sources\"") {
        /// Of all sources, per J.
        All: f64,
        /// Of those that are named.
        Named: SourceEnergySpec,
    }
}

impl Default for EnergySpec {
    fn default() -> Self {
        Self::All(0.0)
    }
}
