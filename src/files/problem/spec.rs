//! A problem as it is written: the serde types of the problem file.

use std::collections::BTreeMap;

use crate::files::json::objects::read_objects;
use crate::files::problem::at::CoordinatesSpec;
use crate::files::problem::feedback::FeedbackSpec;
use crate::files::problem::output::OutputSpec;
use crate::files::problem::simulation::SimulateSpec;
use crate::files::problem::spec_control::ControlSpec;
use crate::files::problem::spec_identify::IdentifySpec;
use crate::files::problem::spec_voltages::VoltageMap;
use crate::files::scene::spec::SceneSpec;
use crate::files::units::quantity::{LoadSize, Quantity};
use crate::model::Response;

read_objects! {
    /// Task for a scene: exactly one of `simulate`, `equilibrium`, `control`, `identify`.
    pub struct ProblemSpec {
        /// JSON Schema of this file, for editors.
        #[serde(rename = "$schema", default)]
        #[expect(dead_code, reason = "read by editors only")]
        pub(crate) schema: Option<String>,
        /// Path of the scene file, relative to this file, or the scene itself.
        pub scene: SceneSource,
        /// Forward simulation.
        pub simulate: Option<SimulateSpec>,
        /// Static equilibrium.
        pub equilibrium: Option<EquilibriumSpec>,
        /// Optimal control.
        pub control: Option<ControlSpec>,
        /// Constants fitted to recordings.
        pub identify: Option<IdentifySpec>,
        /// Gains of a controller that keeps the optimal motion.
        pub feedback: Option<FeedbackSpec>,
        /// Part of a motion that tables, figures and page show.
        pub output: Option<OutputSpec>,
    }

    /// A static equilibrium.
    pub struct EquilibriumSpec {
        /// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
        pub voltages?: VoltageMap,
        /// Loads by name, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        pub loads: BTreeMap<String, Quantity<LoadSize>>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
        /// Response of Maxwell branches; `relaxed` where not written.
        pub response: Option<ResponseSpec>,
        /// Number of points of the path of equilibria from zero voltage that are followed by arc length, past limit points such as pull-in.
        pub path: Option<usize>,
    }

    /// Response of Maxwell branches to voltages and loads.
    #[derive(Default)]
    pub enum ResponseSpec: Response {
        /// After a long time: branches carry nothing.
        #[default]
        Relaxed,
        /// At once: branches are springs without stress in the reference configuration.
        Instantaneous,
    }

    /// A scene by its path, or the scene itself.
    pub either SceneSource("the path of a scene file or a scene") {
        /// Path relative to the problem file.
        Path: String,
        /// The scene.
        Inline: Box<SceneSpec>,
    }
}
