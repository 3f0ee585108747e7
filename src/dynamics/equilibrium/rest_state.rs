//! A state of rest: the unknowns of a step with the charts behind which its turns are counted, its stiffness and modes, the route to it, and the
//! loads and instabilities by which it is lost.

use crate::dynamics::trajectory::{DiscreteTrajectory, Reading};
use crate::model::Model;
use crate::sparse::multigrid::MultigridReport;
use std::ops::{Deref, DerefMut};

/// The unknowns of a step (see [`Variables`](crate::model::Variables)); as a slice they stand without the charts, behind which turns are
/// zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestState {
    pub(super) unknowns: Vec<f64>,
    pub(super) charts: Vec<f64>,
}

impl Deref for RestState {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.unknowns
    }
}

impl DerefMut for RestState {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.unknowns
    }
}

/// Cause of a soft mode: the smallest of the three parts of its stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Softening {
    /// The forces of voltages, as in pull-in.
    Voltages,
    /// Weights and loads, as in collapse.
    Loads,
    /// Elastic forces, as in buckling.
    Elastic,
}

/// The softest mode of a state of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Change of each coordinate; the largest is 1 (rad, or lengths of the system).
    pub direction: Vec<f64>,
    /// Parts that move most, in words: joints, or bodies, or a node of a block, then the muscle whose stretch changes most.
    pub moves: String,
    /// Cause of its softness; `None` where nothing takes from the elastic stiffness along it.
    pub softening: Option<Softening>,
}

/// The lowest mode of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct LowestMode {
    /// Its eigenvalue in N/mm, of vectors of all displacements of nodes.
    pub stiffness: f64,
    /// Distance in N/mm within which there is an eigenvalue.
    pub bound: f64,
    /// Number of directions found in which the potential energy falls, of at most four that are sought; `None` where bounds decide nothing.
    pub unstable: Option<usize>,
    /// Iterations.
    pub iterations: usize,
    /// Change of each coordinate.
    pub(super) direction: Vec<f64>,
}

/// A lowest mode with the values that it belongs to.
#[derive(Debug, Default)]
pub(super) struct Examined {
    pub(super) at: Vec<f64>,
    pub(super) found: Option<LowestMode>,
}

/// Load that grows along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// The weights and the loads, without voltages.
    Forces,
    /// The voltages, under all weights and loads.
    Voltages,
}

/// Instability by which an equilibrium under a growing load is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instability {
    /// The path turns back: beyond this voltage there is no equilibrium nearby (pull-in).
    PullIn,
    /// The path turns back under growing weights or loads: the robot collapses.
    Collapse,
    /// The path goes on, but another one branches off and is preferred (buckling).
    Buckling,
}

impl Instability {
    /// The word in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::PullIn => "pull_in",
            Self::Collapse => "collapse",
            Self::Buckling => "buckling",
        }
    }

    /// The word in sentences.
    pub fn words(self) -> &'static str {
        match self {
            Self::PullIn => "pull-in",
            Self::Collapse => "collapse under load",
            Self::Buckling => "buckling",
        }
    }

    /// Returns the instability at a limit point of a load.
    pub(super) fn of_turn(load: Load) -> Self {
        match load {
            Load::Forces => Self::Collapse,
            Load::Voltages => Self::PullIn,
        }
    }
}

/// The status of an unstable equilibrium.
pub const UNSTABLE: &str = "unstable";

/// A state of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Voltages and potentials.
    pub scalars: Vec<f64>,
    /// Eigenvalues of the stiffness in joint coordinates, ascending, in N mm/rad or N/mm, where there are both in N mm for each rad and each
    /// length of the system; their real parts under loads that follow what they act on. Empty in redundant coordinates and for elastic blocks.
    pub stiffness: Vec<f64>,
    /// Number of directions in which a disturbance grows, by the inertia of the tangent, by its eigenvalues under loads that follow what they
    /// act on, or, without factors, of those that were found; `None` where none of these gives it.
    pub unstable: Option<usize>,
    /// True where loads follow what they act on and only damped motion surely returns: the symmetric part of the stiffness is not positive definite.
    pub may_flutter: bool,
    /// The lowest mode, where it decided without factors.
    pub lowest: Option<LowestMode>,
    /// The softest mode; `None` at the points of a path, and where nothing moves.
    pub softest: Option<Mode>,
    /// Route on which it was found.
    pub route: Route,
    /// Newton iterations over all loads.
    pub iterations: usize,
    /// Counts of an iteration with multigrid, where one led there, and of the systems for which factors took over.
    pub on_grids: Option<(MultigridReport, usize)>,
}

/// Route on which an equilibrium was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// On the path of growing loads: the weights, then the voltages.
    Loads,
    /// On the path that goes on beyond the point where growing loads lose their equilibrium, and comes back to all loads.
    Beyond(StabilityLoss),
    /// State at which damped motion comes to rest, from one where the path ends or is unstable.
    DampedMotion(StabilityLoss),
}

/// State at which the path of growing loads loses its stable equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The load that grew.
    pub load: Load,
    /// Its fraction.
    pub fraction: f64,
    /// Kind of instability, where that was found.
    pub kind: Option<Instability>,
}

impl Equilibrium {
    /// Equilibria of a model one after the other, as a motion from `begin` with their times in ms: the first one stands at both ends of an interval
    /// of its own, so that each has its potentials.
    pub fn in_turn<'a>(
        model: &Model,
        begin: f64,
        states: impl Iterator<Item = (f64, &'a Self)>,
    ) -> DiscreteTrajectory {
        let (times, states): (Vec<_>, Vec<_>) = states.unzip();
        let z = |state: &&Self| state.z.clone();
        DiscreteTrajectory {
            times: [begin].into_iter().chain(times).collect(),
            z: states[..1].iter().chain(&states).map(z).collect(),
            momenta: vec![vec![0.0; model.coordinate_count()]; states.len() + 1],
            scalars: states.iter().map(|state| state.scalars.clone()).collect(),
            reading: Reading::States,
            ..DiscreteTrajectory::default()
        }
    }

    /// Returns true if the equilibrium is stable; `None` where that is not known.
    pub fn is_stable(&self) -> Option<bool> {
        match self.stiffness.first() {
            Some(&smallest) => Some(smallest > 0.0),
            None => self.unstable.map(|count| count == 0),
        }
    }

    /// The word in files.
    pub fn status(&self) -> &'static str {
        match self.is_stable() {
            Some(false) => UNSTABLE,
            Some(true) | None => "at_rest",
        }
    }

    /// Returns the state at which growing loads lose the stable equilibrium, if it does not lie on their path.
    pub fn loss(&self) -> Option<StabilityLoss> {
        match self.route {
            Route::Loads => None,
            Route::Beyond(loss) | Route::DampedMotion(loss) => Some(loss),
        }
    }
}
