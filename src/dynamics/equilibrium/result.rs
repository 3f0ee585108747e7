//! A state of rest: its stiffness, and the route to it.

use crate::dynamics::equilibrium::examined::LowestMode;
use crate::dynamics::equilibrium::instability::{Instability, Load};
use crate::dynamics::equilibrium::mode::Mode;
use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::static_matrix::turned_pairs;
use crate::dynamics::equilibrium::statics::Statics;
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

impl Statics<'_> {
    /// The state at a configuration, potentials being zero.
    pub(super) fn state_without_field(&self, z: &[f64]) -> RestState {
        let scalars = vec![0.0; self.model.variables.algebraic().len()];
        self.state(z, &scalars)
    }

    /// The state at a configuration with scalars that have an equation. Its charts are where its bodies are: there turns are rotations about the
    /// axes of the ground or of a parent, without singularity, and a stiffness by them does not depend on the choice of these axes.
    pub(super) fn state(&self, z: &[f64], scalars: &[f64]) -> RestState {
        let map = &self.model.action.map;
        let mut instant = map.placed(z);
        map.recentre(&mut instant);
        let (unknowns, charts) = instant.z.split_at(map.unknowns());
        RestState {
            unknowns: [unknowns, scalars].concat(),
            charts: charts.to_vec(),
        }
    }

    /// Coordinates, multipliers and charts of a state.
    pub(super) fn configuration(&self, state: &RestState) -> Vec<f64> {
        let m = self.model.action.map.unknowns();
        [&state[..m], state.charts()].concat()
    }

    /// The state a step along a direction away: bodies behind charts turn by rotation vectors, so that no choice of axes matters.
    pub(super) fn moved(&self, state: &RestState, step: f64, direction: &[f64]) -> RestState {
        let mut moved = state.clone();
        let RestState { unknowns, charts } = &mut moved;
        self.model
            .action
            .map
            .advance(step, direction, unknowns, charts);
        moved
    }

    /// Makes second derivatives by turns those by rotation vectors, at turns of zero: a product of turns a, b, c about e₁, e₂, e₃ is the
    /// rotation vector a e₁ + b e₂ + c e₃ + ½ (a b e₁ × e₂ + a c e₁ × e₃ + b c e₂ × e₃) + …
    pub(super) fn add_curvature(&mut self) {
        let pairs = self.charted.iter().flat_map(turned_pairs);
        let signs = self
            .handedness
            .iter()
            .flat_map(|s| [-0.5 * s, 0.5 * s, -0.5 * s]);
        for ((place, [_, _, third]), sign) in pairs.enumerate().zip(signs) {
            self.values[self.curved + place] = sign * self.residual[third];
        }
    }

    /// Leaves the second derivatives evaluated last by turns: those by one on which nothing depends are zero, whatever the forces.
    pub(super) fn leave_out_curvature(&mut self) {
        self.values[self.curved..self.added].fill(0.0);
    }
}
