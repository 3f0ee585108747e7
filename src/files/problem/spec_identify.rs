//! An identification as it is written: free parameters, recordings, and candidates for the next experiment.

use crate::control::problem::SoughtStart;
use crate::files::json::objects::read_objects;
use crate::files::problem::at::CoordinatesSpec;
use crate::files::problem::free::FreeMap;
use crate::files::problem::loads::LoadMap;
use crate::files::problem::quantities::keys::MeasuredSpec;
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::problem::state::StartSpec;
use crate::files::study::ChangesSpec;
use crate::files::units::quantity::{PhysicalQuantity, Quantity, Ratio, SoughtConstant, Time};
use std::collections::BTreeMap;

read_objects! {
    /// Constants that are fitted to recordings, with what the data say of them.
    pub struct IdentifySpec {
        /// Free parameters by their paths in the scene, such as `"materials.silicone.shear_modulus"`, each between bounds.
        pub free?: FreeMap,
        /// Constants of the inputs that are sought: gains of sources, and their delays.
        pub inputs?: InputConstantsSpec,
        /// Constants of `free` that are known beside the recordings, by their paths: each counts as one reading more.
        pub priors: BTreeMap<String, PriorSpec>,
        /// Recordings: those that constants are fitted to, and those that are held out to check their prediction.
        pub recordings: Vec<RecordingSpec>,
        /// Experiments that could be done next; the result ranks them by the variance that they leave.
        pub candidates?: Vec<CandidateSpec>,
        /// Step of the first grid, SI unit s, which is halved until its bias is below a tenth of the standard errors; by the number of readings
        /// where not written.
        pub step: Option<Quantity<Time>>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
    }

    /// Constants of the inputs of all recordings.
    #[derive(Default)]
    pub struct InputConstantsSpec {
        /// Factors between the voltages and loads that recordings say and those that act, by the names of muscles, electrodes and loads.
        pub gains: BTreeMap<String, RangeSpec<Ratio>>,
        /// Time by which all voltages and loads act later than recordings say, SI unit s; before they act, those of the state of rest at the
        /// start, or the first ones.
        pub delay: Option<RangeSpec<Time>>,
        /// The same of single sources, by the names of muscles, electrodes and loads, beside that of all others.
        pub delays: BTreeMap<String, RangeSpec<Time>>,
    }

    /// Bounds of a constant.
    #[serde(bound = "")]
    #[schemars(bound = "M: PhysicalQuantity")]
    pub struct RangeSpec<M: PhysicalQuantity> {
        /// Lower bound.
        pub min: Quantity<M>,
        /// Upper bound.
        pub max: Quantity<M>,
        /// Value at which the fit starts; 1 of a gain, the lower bound of a delay where not written.
        pub guess: Option<Quantity<M>>,
        /// A normal distribution, as of a data sheet, which counts as one reading more.
        pub prior: Option<InputPriorSpec<M>>,
    }

    /// A normal distribution of a constant of the inputs.
    #[serde(bound = "")]
    #[schemars(bound = "M: PhysicalQuantity")]
    pub struct InputPriorSpec<M: PhysicalQuantity> {
        /// Mean.
        pub value: Quantity<M>,
        /// Standard deviation.
        pub standard_deviation: Quantity<M>,
    }

    /// A normal distribution of a constant, such as that of a data sheet.
    pub struct PriorSpec {
        /// Mean, in the unit of the constant.
        pub value: Quantity<SoughtConstant>,
        /// Standard deviation.
        pub standard_deviation: Quantity<SoughtConstant>,
    }

    /// Readings of a motion or of states of rest under given voltages and loads.
    pub struct RecordingSpec {
        /// Unique name.
        pub name: String,
        /// Path of the CSV file, relative to the problem or to the current folder: one line of headers such as `tip [mm]`, `tip (mm)` or `tip_mm`,
        /// SI units where a header has none, which a note says; lines that begin with `#` are comments, empty cells are gaps.
        pub file: Option<String>,
        /// Columns of numbers by such headers in place of a file; `null` is a gap.
        pub columns: Option<BTreeMap<String, Vec<Option<f64>>>>,
        /// Header of the times, which begin with the motion at 0; `time` where not written.
        #[serde(default = "time")]
        pub time: String,
        /// Time in that column at which the motion begins, SI unit s, which all times lose, also those of inputs from the same file that have no
        /// `time_offset` of their own; 0 where not written. A motion whose readings begin late needs it.
        pub time_offset: Option<Quantity<Time>>,
        /// Quantities that the columns measure.
        pub measured: Vec<MeasuredSpec>,
        /// Voltages, loads and start.
        pub experiment?: ExperimentSpec,
        /// Values that are other ones in the scene of this recording, by their places, such as `"scene.bodies.payload.mass": "1 kg"`.
        pub set?: ChangesSpec,
        /// True if no constant is fitted to it: the result says whether the fitted constants explain it.
        pub held_out: bool,
    }

    /// An experiment that could be done.
    pub struct CandidateSpec {
        /// Unique name.
        pub name: String,
        /// Length, SI unit s.
        pub duration: Quantity<Time>,
        /// Number of readings of each quantity, at equal distances.
        pub readings: usize,
        /// Measured quantities; their columns are not read.
        pub measured: Vec<MeasuredSpec>,
        /// Voltages, loads and start.
        pub experiment?: ExperimentSpec,
        /// Values that are other ones in the scene of this experiment, by their places.
        pub set?: ChangesSpec,
    }

    /// Voltages, loads and start of a recording.
    #[derive(Default)]
    pub struct ExperimentSpec {
        /// Constant voltages, those of a solution, a table, or functions of time such as columns of a CSV file; 0 where not written.
        pub voltages?: VoltagesSpec,
        /// Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        pub loads?: LoadMap,
        /// Start of the motion; the reference configuration at rest where not written.
        pub start: Option<StartSpec>,
        /// Part of the start that is unknown, and fitted with the constants; nothing where not written.
        pub sought_start?: SoughtStartSpec,
        /// True if each reading is one of a state of rest under the voltages and loads of its time.
        pub at_rest: bool,
    }

    /// Unknown part of a start.
    #[derive(Default)]
    pub enum SoughtStartSpec: SoughtStart {
        /// All is given.
        #[default]
        Nothing,
        /// The coordinates.
        Coordinates,
        /// The coordinates and the momenta.
        State,
    }
}

/// The usual header of times.
fn time() -> String {
    "time".to_owned()
}
