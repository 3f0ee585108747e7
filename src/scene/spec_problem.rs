//! A problem as it is written: the serde types of the problem file.

use schemars::JsonSchema;
use serde::de::{Error, IntoDeserializer, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use crate::control::problem::{Hold, Rest};
use crate::dynamics::Newton;
use crate::scene::either::{Either, ScalarOrObject, scalar_or_object};
use crate::scene::point::Point;
use crate::scene::quantity::{
    AngularVelocity, JointCoordinate, JointRate, Quantity, Time, Velocity, Voltage,
};
use crate::scene::spec_integrator::IntegratorSpec;
use crate::scene::spec_limits::LimitSpec;
use crate::scene::spec_scene::SceneSpec;
use crate::sparse::Backend;

/// What is asked of a scene: exactly one of `simulate`, `equilibrium`, `control`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemSpec {
    /// JSON Schema of this file, for editors.
    #[serde(rename = "$schema", default)]
    #[expect(dead_code, reason = "read by editors only")]
    pub(crate) schema: Option<String>,
    /// Path of the scene file, relative to this file, or the scene itself.
    pub scene: SceneSource,
    /// Forward simulation.
    #[serde(default)]
    pub simulate: Option<SimulateSpec>,
    /// Static equilibrium.
    #[serde(default)]
    pub equilibrium: Option<EquilibriumSpec>,
    /// Optimal control.
    #[serde(default)]
    pub control: Option<ControlSpec>,
}

/// Coordinates in which a problem is solved; reduced where the joints form a tree, unless written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CoordinatesSpec {
    /// Independent joint coordinates.
    Reduced,
    /// Directors with multipliers.
    Redundant,
}

/// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
pub type VoltageMap = BTreeMap<String, Quantity<Voltage>>;

/// A forward simulation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SimulateSpec {
    /// Length, SI unit s.
    pub duration: Quantity<Time>,
    /// Step, SI unit s, or `"auto"`, as where it is not written: steps as short as the tolerance needs, by the midpoint rule.
    #[serde(default)]
    pub step: Option<StepSpec>,
    /// Sum of the estimated local errors that `"auto"` allows over the duration, of angles in rad, of lengths relative to the
    /// robot's size; 1e-3 where not written.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// Constant voltages, those of a solution, or a table; 0 where not written.
    #[serde(default)]
    pub voltages: VoltagesSpec,
    /// Where it starts; the reference configuration at rest where not written.
    #[serde(default)]
    pub start: Option<StartSpec>,
    /// Coordinates.
    #[serde(default)]
    pub coordinates: Option<CoordinatesSpec>,
    /// The method; the midpoint variational integrator where not written.
    #[serde(default)]
    pub integrator: Option<IntegratorSpec>,
    /// When the tangent of a step is factorised; where not written `reused` with finite elements, otherwise `full`.
    #[serde(default)]
    pub newton: Option<NewtonSpec>,
    /// Who factorises it; the one that is fastest as a rule where not written.
    #[serde(default)]
    pub linear_solver: Option<LinearSolverSpec>,
}

/// How long steps are.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum StepSpec {
    /// `"auto"`.
    Word(StepWord),
    /// A length of time.
    Given(Quantity<Time>),
}

/// Steps of no given length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StepWord {
    /// By an estimate of their local error.
    Auto,
}

impl<'de> Deserialize<'de> for StepSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StepVisitor)
    }
}

struct StepVisitor;

impl Visitor<'_> for StepVisitor {
    type Value = StepSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a time, such as \"10 ms\", or \"auto\"")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<StepSpec, E> {
        match text {
            "auto" => Ok(StepSpec::Word(StepWord::Auto)),
            _ => Quantity::deserialize(text.into_deserializer()).map(StepSpec::Given),
        }
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<StepSpec, E> {
        Quantity::deserialize(number.into_deserializer()).map(StepSpec::Given)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<StepSpec, E> {
        self.visit_f64(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<StepSpec, E> {
        self.visit_f64(number as f64)
    }
}

/// When the tangent of a step is factorised.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NewtonSpec {
    /// In every iteration.
    Full,
    /// Only where the last factorisation converges too slowly: for large meshes, whose factorisation is the cost.
    Reused,
}

impl From<NewtonSpec> for Newton {
    fn from(spec: NewtonSpec) -> Self {
        match spec {
            NewtonSpec::Full => Self::Full,
            NewtonSpec::Reused => Self::Reused,
        }
    }
}

/// Who factorises a tangent.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LinearSolverSpec {
    /// LDLᵀ or LU of faer.
    Faer,
    /// LDLᵀ or LU of MUMPS.
    Mumps,
}

impl From<LinearSolverSpec> for Backend {
    fn from(spec: LinearSolverSpec) -> Self {
        match spec {
            LinearSolverSpec::Faer => Self::Faer,
            LinearSolverSpec::Mumps => Self::Mumps,
        }
    }
}

/// A static equilibrium.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EquilibriumSpec {
    /// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
    #[serde(default)]
    pub voltages: VoltageMap,
    /// Coordinates.
    #[serde(default)]
    pub coordinates: Option<CoordinatesSpec>,
    /// Follow the path of equilibria from zero voltage by arc length for so many points, past limit points such as pull-in.
    #[serde(default)]
    pub path: Option<usize>,
}

/// An optimal control problem.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlSpec {
    /// Final time, SI unit s, or its bounds and a guess.
    pub duration: DurationSpec,
    /// Number of intervals, 1 or more.
    pub intervals: usize,
    /// Initial state.
    pub start: StartSpec,
    /// Final state, at rest.
    pub goal: GoalSpec,
    /// Lower and upper bound of every voltage that is looked for, SI unit V.
    pub voltage_bounds: [Quantity<Voltage>; 2],
    /// Voltages that are given for all the time, by the names of muscles and driven electrodes (`block.electrode`), SI unit V:
    /// they are no unknowns, and one of 0 leaves no electric term at all.
    #[serde(default)]
    pub voltages: VoltageMap,
    /// What becomes of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is
    /// `reported` (where not written), or refused where holding it is `required`.
    #[serde(default)]
    pub hold: HoldSpec,
    /// What is minimised.
    pub objective: ObjectiveSpec,
    /// Path limits.
    #[serde(default)]
    pub limits: Vec<LimitSpec>,
    /// Coordinates.
    #[serde(default)]
    pub coordinates: Option<CoordinatesSpec>,
    /// Where the solver starts.
    #[serde(default)]
    pub guess: GuessSpec,
    /// Options of the solver.
    #[serde(default)]
    pub solver: SolverSpec,
}

/// A state at the start: exactly one of `rest_at_voltages` and joint coordinates.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartSpec {
    /// Static equilibrium under these voltages, SI unit V; 0 where not named.
    #[serde(default)]
    pub rest_at_voltages: Option<VoltageMap>,
    /// Joint coordinates by joint, SI unit rad or m; 0 where not named.
    #[serde(default)]
    pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
    /// Rates of joint coordinates by joint, SI unit rad/s or m/s; 0 where not named.
    #[serde(default)]
    pub joint_rates: Option<BTreeMap<String, Quantity<JointRate>>>,
    /// Velocities by body, of bodies that are free or hang on a spherical or floating joint; with what the joints before them do where not
    /// named.
    #[serde(default)]
    pub body_velocities: Option<BTreeMap<String, BodyVelocitySpec>>,
}

/// The velocity of a body at the start, in the ground frame.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyVelocitySpec {
    /// Velocity of the centre of mass, SI unit m/s; 0 where not written. On a spherical joint it follows from `angular`.
    #[serde(default)]
    pub linear: Option<[Quantity<Velocity>; 3]>,
    /// Angular velocity, SI unit rad/s; 0 where not written.
    #[serde(default)]
    pub angular: Option<[Quantity<AngularVelocity>; 3]>,
}

/// A state at the end, at rest: exactly one of the three.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalSpec {
    /// Static equilibrium under these voltages, SI unit V; 0 where not named.
    #[serde(default)]
    pub rest_at_voltages: Option<VoltageMap>,
    /// Joint coordinates by joint, SI unit rad or m; free where not named.
    #[serde(default)]
    pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
    /// Positions by marker, SI unit m.
    #[serde(default)]
    pub markers: Option<BTreeMap<String, Point>>,
    /// What comes to rest at positions of markers: `everything` (where not written), or bodies and these `markers` alone, for
    /// elastic blocks, which a few voltages cannot bring to rest everywhere.
    #[serde(default)]
    pub rest: Option<RestSpec>,
    /// Voltages that are held after positions of markers are reached, SI unit V; 0 where not named.
    #[serde(default)]
    pub hold: Option<VoltageMap>,
}

/// What comes to rest at a goal.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RestSpec {
    /// Every coordinate.
    #[default]
    Everything,
    /// Bodies and the markers of the goal.
    Markers,
}

/// What becomes of a goal that cannot be kept.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HoldSpec {
    /// A line says so.
    #[default]
    Reported,
    /// It is no solution.
    Required,
}

impl From<HoldSpec> for Hold {
    fn from(spec: HoldSpec) -> Self {
        match spec {
            HoldSpec::Reported => Self::Reported,
            HoldSpec::Required => Self::Required,
        }
    }
}

impl From<RestSpec> for Rest {
    fn from(spec: RestSpec) -> Self {
        match spec {
            RestSpec::Everything => Self::Everything,
            RestSpec::Markers => Self::Markers,
        }
    }
}

/// Bounds of a free final time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FreeDurationSpec {
    /// Lower bound, SI unit s.
    pub min: Quantity<Time>,
    /// Upper bound, SI unit s.
    pub max: Quantity<Time>,
    /// Where the solver starts, SI unit s.
    pub guess: Quantity<Time>,
}

/// Weights of the objective.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectiveSpec {
    /// Weight of Σ h |V_k|², V in kV, h in s.
    #[serde(default)]
    pub effort: f64,
    /// Weight of Σ |V_k − V_{k−1}|²/h, V in kV, h in s, with the rest voltages of start and goal at the ends.
    #[serde(default)]
    pub rate: f64,
    /// Weight of the final time in s.
    #[serde(default)]
    pub duration: f64,
}

/// Options of the solver.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverSpec {
    /// Relative tolerance, 1e-10 where not written.
    #[serde(default)]
    pub tolerance: Option<f64>,
    /// Limit of iterations, 500 where not written.
    #[serde(default)]
    pub max_iterations: Option<usize>,
    /// Options of Ipopt by name.
    #[serde(default)]
    pub ipopt: BTreeMap<String, OptionSpec>,
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

/// A simulation as a guess.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GuessSimulationSpec {
    /// Constant voltages, those of a solution, or a table, as of a simulation; 0 where not written.
    #[serde(default)]
    pub voltages: VoltagesSpec,
}

/// A random guess.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomGuessSpec {
    /// Equal seeds give equal guesses.
    pub seed: u64,
}

/// An object of a guess: exactly one of the three.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GuessObjectSpec {
    /// A simulation under given voltages.
    #[serde(default)]
    pub simulate: Option<GuessSimulationSpec>,
    /// Path of a `solution.json`, relative to this file or to the current folder.
    #[serde(default)]
    pub solution: Option<String>,
    /// A simulation under constant voltages drawn at random within the bounds.
    #[serde(default)]
    pub random: Option<RandomGuessSpec>,
}

/// A word of a guess.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GuessWord {
    /// Smooth interpolation between start and goal.
    Interpolate,
}

/// A scene by its path, or the scene itself.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum SceneSource {
    /// Path relative to the problem file.
    Path(String),
    /// The scene.
    Inline(Box<SceneSpec>),
}

/// A time, or bounds of a free one.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum DurationSpec {
    /// Given.
    Given(Quantity<Time>),
    /// Free.
    Free(FreeDurationSpec),
}

/// A word or an object.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum GuessSpec {
    /// `"interpolate"`.
    Word(GuessWord),
    /// An object.
    Object(GuessObjectSpec),
}

impl Default for GuessSpec {
    fn default() -> Self {
        Self::Word(GuessWord::Interpolate)
    }
}

/// Constant voltages by muscle or driven electrode, `{"solution": path}`, or `{"time": [...], "voltages": {...}}`.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum VoltagesSpec {
    /// Those of a `solution.json`.
    Solution(SolutionSpec),
    /// A table.
    Table(TableSpec),
    /// Constant.
    Constant(VoltageMap),
}

/// A solution by its path.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolutionSpec {
    /// Path of a `solution.json`, relative to this file or to the current folder.
    pub solution: String,
}

/// Voltages that are constant in intervals of time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// Start and end of the intervals, growing, the first of them 0; SI unit s.
    pub time: Vec<Quantity<Time>>,
    /// A voltage for each interval by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not
    /// named.
    pub voltages: BTreeMap<String, Vec<Quantity<Voltage>>>,
    /// Voltages after the last interval; those of the last interval where not written.
    #[serde(default)]
    pub hold: Option<VoltageMap>,
}

impl Default for VoltagesSpec {
    fn default() -> Self {
        Self::Constant(VoltageMap::new())
    }
}

scalar_or_object! {
    SceneSource: String = Self::Path, Box<SceneSpec> = Self::Inline, "the path of a scene file or a scene";
    DurationSpec: Quantity<Time> = Self::Given, FreeDurationSpec = Self::Free,
        "a time, such as \"0.6 s\", or an object with \"min\", \"max\" and \"guess\"";
    GuessSpec: GuessWord = Self::Word, GuessObjectSpec = Self::Object,
        "\"interpolate\" or an object with \"simulate\", \"solution\" or \"random\"";
}

impl<'de> Deserialize<'de> for VoltagesSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(VoltagesVisitor)
    }
}

struct VoltagesVisitor;

impl<'de> Visitor<'de> for VoltagesVisitor {
    type Value = VoltagesSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(
            "voltages by name, an object with \"solution\", or one with \"time\" and \"voltages\"",
        )
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<VoltagesSpec, A::Error> {
        let mut constant = VoltageMap::new();
        let (mut solution, mut time, mut voltages, mut hold) = (None, None, None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "solution" => solution = Some(map.next_value()?),
                "time" => time = Some(map.next_value()?),
                "voltages" => voltages = Some(map.next_value()?),
                "hold" => hold = Some(map.next_value()?),
                _ => drop(constant.insert(key, map.next_value()?)),
            }
        }
        let is_constant = !constant.is_empty();
        match (solution, time, voltages, hold) {
            (None, None, None, None) => Ok(VoltagesSpec::Constant(constant)),
            (Some(solution), None, None, None) if !is_constant => {
                Ok(VoltagesSpec::Solution(SolutionSpec { solution }))
            }
            (None, Some(time), Some(voltages), hold) if !is_constant => {
                Ok(VoltagesSpec::Table(TableSpec {
                    time,
                    voltages,
                    hold,
                }))
            }
            (Some(_), ..) => {
                let found = Unexpected::Other("\"solution\" beside voltages");
                Err(A::Error::invalid_value(found, &self))
            }
            (None, time, voltages, _) => {
                let lacks = match (time, voltages) {
                    (None, _) => "a table without \"time\"",
                    (_, None) => "a table without \"voltages\"",
                    _ => "a table beside voltages by name",
                };
                Err(A::Error::invalid_value(Unexpected::Other(lacks), &self))
            }
        }
    }
}
