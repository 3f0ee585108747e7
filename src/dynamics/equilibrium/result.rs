//! A state of rest: its stiffness, and the route to it.

use crate::dynamics::equilibrium::rest_state::{Instability, Load, LowestMode, Mode};
use crate::sparse::multigrid::MultigridReport;

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
