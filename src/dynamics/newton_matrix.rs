//! The matrix of Newton's method, of a step or of rest: factorised, or by the nodes of boxes and meshes, where an iteration solves and
//! factors take over where it does not converge and there is room for them.
//!
//! The matrix of one Newton iteration by the nodes of boxes and meshes, solved by an iteration with multigrid to the accuracy that the next update
//! deserves (S. C. Eisenstat, H. F. Walker, SIAM J. Sci. Comput. 17, 1996).

use crate::coordinates::Dependence;
use crate::dynamics::solving::{MultigridUse, Solving};
use crate::dynamics::tangent::Tangent;
use crate::dynamics::trajectory::TangentState;
use crate::functional::{NodeBlocks, Pressures, ScalarPlace, Term, VectorPlace};
use crate::math::join::available;
use crate::math::{IsOver, Stopped};
use crate::model::Model;
use crate::sparse::multigrid::{LowestModes, Multigrid, MultigridReport, NoSolution};
use crate::sparse::{MethodState, Singular};
use std::sync::Arc;

/// A matrix with its solver.
#[derive(Debug)]
pub(super) enum NewtonMatrix {
    /// Factorised.
    Direct(Box<Tangent>),
    /// On box grids.
    Grids(Box<GridTangent>),
}

/// Bytes of factors for each unknown of a block of `MEASURED` unknowns; they grow with the cube root of the number.
const OF_UNKNOWN: f64 = 3.4e4;
const MEASURED: f64 = 237_500.0;

/// Returns true if there is room for the factors of so many unknowns.
fn is_affordable(unknowns: usize) -> bool {
    let unknowns = unknowns as f64;
    let bytes = unknowns * OF_UNKNOWN * (unknowns / MEASURED).cbrt();
    available().is_none_or(|available| bytes < available)
}

impl NewtonMatrix {
    /// By the nodes where an iteration is wanted and nodes have all unknowns, otherwise factorised by `direct`. Factors that take over from an
    /// iteration are those of `later`.
    pub(super) fn new(
        model: &Model,
        solving: Solving,
        is_at_rest: bool,
        later: fn(&Model) -> Tangent,
        direct: impl FnOnce() -> Tangent,
    ) -> Self {
        let grids = solving.takes_grids(model).then(|| {
            let later = (solving.multigrid != MultigridUse::Alone).then_some(later);
            GridTangent::new(model, later, is_at_rest)
        });
        match grids.flatten() {
            Some(grids) => Self::Grids(Box::new(grids)),
            None => Self::Direct(Box::new(direct())),
        }
    }

    /// The factorised one.
    pub(super) fn direct(&self) -> Option<&Tangent> {
        match self {
            Self::Direct(tangent) => Some(tangent),
            Self::Grids(_) => None,
        }
    }

    /// The factorised one.
    pub(super) fn direct_mut(&mut self) -> Option<&mut Tangent> {
        match self {
            Self::Direct(tangent) => Some(tangent),
            Self::Grids(_) => None,
        }
    }

    /// The one on grids.
    pub(super) fn grids_mut(&mut self) -> Option<&mut GridTangent> {
        match self {
            Self::Grids(grids) => Some(grids),
            Self::Direct(_) => None,
        }
    }

    /// The method that solves.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Direct(tangent) => tangent.name(),
            Self::Grids(_) => "GMRES with multigrid".to_owned(),
        }
    }

    /// Takes the matrix of these values, unless it is time to stop.
    pub(super) fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        match self {
            Self::Direct(tangent) => tangent.factor_unless(values, is_over),
            Self::Grids(grids) => {
                // What follows from the matrix alone can be resumed with the same bits.
                grids.forget();
                grids.take();
                Ok(Ok(()))
            }
        }
    }

    /// Writes how it is solved, and the matrix where it is used again.
    pub(super) fn keep(&mut self, with_matrix: bool, to: &mut TangentState) {
        match self {
            Self::Direct(tangent) => tangent.keep(with_matrix, to),
            Self::Grids(grids) => {
                (to.is_approximate, to.method) = (false, MethodState::default());
                to.matrix.clear();
                if with_matrix {
                    grids.copy(&mut to.matrix);
                }
            }
        }
    }

    /// Returns true if the matrix serves for several steps.
    pub(super) fn is_kept(&self) -> bool {
        match self {
            Self::Direct(_) => true,
            Self::Grids(grids) => grids.is_kept(),
        }
    }

    /// Solves as it was done before; returns true if that is possible.
    pub(super) fn restore(&mut self, model: &Model, from: &TangentState) -> bool {
        if from.method.method.is_empty() {
            let Self::Grids(grids) = self else {
                return false;
            };
            return from.step.is_none() || grids.take_copy(&from.matrix);
        }
        self.fall_back(model);
        self.direct_mut().is_some_and(|tangent| tangent.take(from))
    }

    /// Factorises from now on where there is room; returns true if it did not before.
    pub(super) fn fall_back_with_room(&mut self, model: &Model) -> bool {
        is_affordable(model.variables.unknown_count()) && self.fall_back(model)
    }

    /// Factorises from now on; returns true if it did not before.
    fn fall_back(&mut self, model: &Model) -> bool {
        let Self::Grids(grids) = self else {
            return false;
        };
        let Some(direct) = grids.direct else {
            return false;
        };
        *self = Self::Direct(Box::new(direct(model)));
        true
    }
}

/// Least and largest residual of a linear system relative to that of no update.
const FORCING: [f64; 2] = [1e-4, 1e-2];
/// Part of the ratio of successive residuals, or of its square, that is asked for.
const PART: f64 = 0.5;
/// Most unknowns whose matrix is kept over steps, and stored with a motion that is to be resumed.
const KEPT: usize = 250_000;
/// Change of a potential over the shortest edge, in the unit of fields in which mechanics and electrostatics have one magnitude, above which
/// potentials come to Gauss's law before anything moves.
const STRONG: f64 = 0.1;
/// Residual of that solution.
const OF_POTENTIALS: f64 = 1e-4;

/// A matrix on box grids.
#[derive(Debug)]
pub(super) struct GridTangent {
    /// The way from derivatives of the action to the matrix.
    nodes: NodeBlocks,
    solver: Multigrid,
    /// Place in the solver of each volume, where it has one.
    volumes: Vec<Option<usize>>,
    /// Unknowns from here on are potentials.
    potentials: usize,
    /// Shortest edge of all grids in mm.
    edge: f64,
    /// Norm of the residual of the iteration before.
    before: Option<f64>,
    /// True where the matrices of all grids are regular.
    is_regular: bool,
    /// True before the first solution with this matrix.
    is_new: bool,
    /// Number of unknowns.
    size: usize,
    /// Makes the direct solver that takes over, where one may.
    pub(super) direct: Option<fn(&Model) -> Tangent>,
}

impl GridTangent {
    /// Of a model whose unknowns are those of nodes; `None` for others. At rest derivatives by given scalars are kept too.
    pub(super) fn new(
        model: &Model,
        direct: Option<fn(&Model) -> Tangent>,
        is_at_rest: bool,
    ) -> Option<Self> {
        let grids = model.node_grids().ok()?;
        let (map, size) = (&model.action.map, model.variables.unknown_count());
        let solver = Multigrid::new(size, &grids.boxes, &grids.meshes)?;
        let sum = &model.action.intervals;
        let vectors = map.vectors.iter().map(|of| vector_place(&solver, of));
        let scalars = (0..sum.scalars).map(|s| scalar_place(&solver, model.variables.place(s)));
        let mut nodes = NodeBlocks::new(
            solver.block_places(),
            vectors.collect(),
            scalars.collect(),
            is_at_rest,
        );
        nodes.pressures = solver.has_pressures().then_some(Pressures::Exact);
        let is_meant = |term: &&Arc<dyn Term>| !is_at_rest || term.kind().acts_at_rest();
        for term in sum.terms.iter().filter(is_meant) {
            let mut are_taken = true;
            term.couple(&mut |coupling| {
                are_taken &= coupling.is_none_or(|coupling| nodes.take(coupling));
            });
            if !are_taken {
                return None;
            }
        }
        Some(Self {
            nodes,
            solver,
            volumes: Vec::new(),
            potentials: map.unknowns(),
            edge: grids.shortest_edge(),
            before: None,
            is_regular: false,
            is_new: true,
            size,
            direct,
        })
    }

    /// Counts since the last call.
    pub(super) fn counted(&mut self) -> MultigridReport {
        self.solver.counted()
    }

    /// Begins an iteration.
    pub(super) fn start(&mut self) {
        self.before = None;
        self.expect(Pressures::Bounded);
    }

    /// Lets second derivatives of volumes enter the next matrix with these pressures.
    fn expect(&mut self, pressures: Pressures) {
        if self.nodes.pressures.is_some() {
            self.nodes.pressures = Some(pressures);
        }
    }

    /// Makes the grids of the preconditioner anew with the next matrix.
    pub(super) fn forget(&mut self) {
        self.solver.forget();
    }

    /// Lets a matrix be written in place of the last one; returns false if it was time to stop before it was whole.
    pub(super) fn write(&mut self, evaluate: impl FnOnce(&mut NodeBlocks)) -> bool {
        self.nodes.matrix = self.solver.lend();
        self.nodes.clear();
        evaluate(&mut self.nodes);
        let matrix = std::mem::take(&mut self.nodes.matrix);
        self.solver.hand_back(matrix);
        if self.nodes.pressures.is_some() {
            self.solver.clear_volumes();
            self.volumes.clear();
            for of in &self.nodes.volumes {
                let place = self.solver.take_volume(&of.corners, &of.volume);
                self.volumes.push(place);
            }
            self.nodes.pressures = Some(Pressures::Exact);
        }
        self.nodes.is_whole
    }

    /// Derivatives by given scalars, of the matrix that was written.
    pub(super) fn nodes(&self) -> &NodeBlocks {
        &self.nodes
    }

    /// Takes the matrix that was written; where a matrix of the grids is singular, nothing is solved.
    pub(super) fn take(&mut self) {
        self.is_new = true;
        self.is_regular = self.solver.take_values().is_ok();
    }

    /// Returns true if the matrix serves for several steps.
    pub(super) fn is_kept(&self) -> bool {
        self.size <= KEPT
    }

    /// Copies the matrix.
    pub(super) fn copy(&mut self, to: &mut Vec<f64>) {
        self.solver.copy_values(to);
    }

    /// Takes a matrix that was copied; returns true if it fits.
    pub(super) fn take_copy(&mut self, from: &[f64]) -> bool {
        if !self.solver.restore_values(from) {
            return false;
        }
        self.solver.forget();
        self.is_regular = self.solver.take_values().is_ok();
        self.is_regular
    }

    /// Solves for an update in place, as accurately as it deserves.
    pub(super) fn solve_for_update(
        &mut self,
        residual: &mut [f64],
        is_over: IsOver<'_>,
    ) -> Iterated {
        let norm = self.solver.size(residual);
        let [least, largest] = FORCING;
        // A new matrix makes residuals shrink quadratically, one that is kept by a factor.
        let is_new = std::mem::take(&mut self.is_new);
        let power = if is_new { 2 } else { 1 };
        let asked = match self.before.replace(norm) {
            Some(before) => (PART * (norm / before).powi(power)).clamp(least, largest),
            None => largest,
        };
        let solved = self.solve(residual, asked, is_over);
        if is_new && self.nodes.pressures.is_some() {
            // Volumes are off by the square of the update, which a stiffness makes great; pressures of this solution are not.
            self.nodes.predicted.clear();
            for (of, place) in self.nodes.volumes.iter().zip(&self.volumes) {
                let change = place.map(|place| self.solver.volume_change(place));
                let pressure = of.pressure - of.change * change.unwrap_or_default();
                self.nodes.predicted.push(pressure);
            }
            self.expect(Pressures::Predicted);
        }
        solved
    }

    /// Solves in place to this residual, relative to that of zero.
    pub(super) fn solve(
        &mut self,
        rhs: &mut [f64],
        tolerance: f64,
        is_over: IsOver<'_>,
    ) -> Iterated {
        match self.is_regular {
            true => self.solver.solve(rhs, tolerance, is_over),
            // A matrix that is not whole is singular.
            false if is_over() => Err(Stopped),
            false => Ok(Err(NoSolution)),
        }
    }

    /// The lowest modes of displacements that potentials follow, of a factor times the matrix taken last, which is lost where it has no
    /// symmetry; `None` where they are not found.
    pub(super) fn lowest_modes(
        &mut self,
        factor: f64,
        is_over: IsOver<'_>,
    ) -> Result<Option<LowestModes>, Stopped> {
        match self.is_regular {
            true => self.solver.lowest_modes(factor, is_over),
            false => Ok(None),
        }
    }

    /// Product of the matrix that was written with a direction on either side.
    pub(super) fn along(&self, direction: &[f64]) -> f64 {
        self.solver.along(direction)
    }

    /// The update that brings potentials to Gauss's law where nothing moves, with the matrix that was written, which is lost; `None` where they are
    /// near it, or it is not found.
    pub(super) fn potentials_first(
        &mut self,
        residual: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Option<Vec<f64>>, Stopped> {
        if self.potentials == residual.len() {
            return Ok(None);
        }
        let changes = (self.potentials..residual.len()).map(|i| match self.solver.diagonal(i) {
            0.0 => 0.0,
            diagonal => residual[i] / diagonal,
        });
        let largest = changes.fold(0.0, |m, change| f64::max(m, change.abs()));
        match largest < STRONG * self.edge {
            true => Ok(None),
            false => {
                let found = self.potentials_to_law(residual, is_over);
                self.expect(Pressures::Bounded);
                found
            }
        }
    }

    /// The update that brings potentials to Gauss's law where nothing moves, with the matrix that was written, which is lost; `None` where it is not
    /// found.
    pub(super) fn potentials_to_law(
        &mut self,
        residual: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Option<Vec<f64>>, Stopped> {
        self.solver.keep_last_components();
        self.solver.forget();
        let mut update = residual.to_vec();
        update[..self.potentials].fill(0.0);
        let solved = match self.solver.take_values() {
            Ok(()) => self.solver.solve(&mut update, OF_POTENTIALS, is_over)?,
            Err(_) => Err(NoSolution),
        };
        self.solver.forget();
        Ok(solved.is_ok().then_some(update))
    }
}

/// Outcome of an iteration that may be stopped.
pub(super) type Iterated = Result<Result<(), NoSolution>, Stopped>;

/// The node that a vector is the place of.
fn vector_place(solver: &Multigrid, dependence: &Dependence) -> VectorPlace {
    let parts = match dependence {
        Dependence::Linear { parts, .. } => parts,
        Dependence::Articulated(columns) if columns.support.is_empty() => {
            return VectorPlace::Still;
        }
        Dependence::Articulated(_) => return VectorPlace::Other,
    };
    let mut place = VectorPlace::Still;
    for part in parts {
        // What is held does not move.
        let Some((node, component)) = solver.place(part.coordinate) else {
            continue;
        };
        let mut free = match place {
            VectorPlace::Still => [false; 3],
            VectorPlace::Node(known, free) if known == node => free,
            _ => return VectorPlace::Other,
        };
        if component != part.axis || part.factor != 1.0 {
            return VectorPlace::Other;
        }
        free[part.axis] = true;
        place = VectorPlace::Node(node, free);
    }
    place
}

/// The node that a scalar with this unknown belongs to.
fn scalar_place(solver: &Multigrid, unknown: Option<usize>) -> ScalarPlace {
    let node = unknown.and_then(|unknown| solver.place(unknown));
    node.map_or(ScalarPlace::Given, |(node, _)| ScalarPlace::Node(node))
}
