//! The matrix of one Newton iteration on box grids of nodes, solved by an iteration with multigrid to the accuracy that the next update
//! deserves (S. C. Eisenstat, H. F. Walker, SIAM J. Sci. Comput. 17, 1996).

use crate::coordinates::StepPattern;
use crate::dynamics::tangent::Tangent;
use crate::math::{IsOver, Stopped, compact_index};
use crate::model::Model;
use crate::sparse::multigrid::{Multigrid, MultigridReport, NoSolution};

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
/// In place of an entry of the matrix.
const NONE: u32 = u32::MAX;

/// Values of a range of places that go to entries of the matrix, one after the other.
#[derive(Debug)]
struct Run {
    /// Ranges that are summed up begin here.
    starts: Vec<usize>,
    targets: Vec<u32>,
}

/// A matrix on box grids.
#[derive(Debug)]
pub(super) struct GridTangent {
    runs: Vec<Run>,
    /// The first of the runs that couple potentials with each other.
    electric: usize,
    solver: Multigrid,
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
    /// Makes the direct solver that takes over.
    pub(super) direct: fn(&Model) -> Tangent,
}

/// Places in the values of the action whose numbers make a matrix.
pub(super) struct Blocks<'a> {
    /// Of blocks of coordinates at one instant.
    pub(super) same: &'a [usize],
    /// Of blocks of coordinates at two instants.
    pub(super) cross: &'a [usize],
    /// Of blocks of coordinates and scalars: rows of coordinates, and their columns.
    pub(super) sides: [&'a [usize]; 2],
    /// Place of a number that is added to the diagonal of each coordinate and potential.
    pub(super) added: Option<usize>,
}

impl GridTangent {
    /// Of a model whose unknowns are those of box grids; `None` for others.
    pub(super) fn new(
        model: &Model,
        blocks: &Blocks<'_>,
        direct: fn(&Model) -> Tangent,
    ) -> Option<Self> {
        let grids = model.node_grids().ok()?;
        let edges = grids.iter().flat_map(|grid| &grid.planes);
        let edges = edges.flat_map(|planes| planes.windows(2).map(|two| two[1] - two[0]));
        let edge = edges.fold(f64::INFINITY, f64::min);
        let (m, size) = (model.action.map.unknowns(), model.variables.unknown_count());
        let solver = Multigrid::new(size, &grids)?;
        let layout: &StepPattern = model.action.layout();
        let place = |s: usize| model.variables.place(s);
        let mut runs = Vec::new();
        let mut add =
            |starts: Vec<usize>, entries: &mut dyn Iterator<Item = Option<(usize, usize)>>| {
                if !starts.is_empty() {
                    let targets = targets(&solver, entries)?;
                    runs.push(Run { starts, targets });
                }
                Some(())
            };
        add(blocks.same.to_vec(), &mut layout.same.entries().map(Some))?;
        add(blocks.cross.to_vec(), &mut layout.cross.entries().map(Some))?;
        let entries = || layout.mixed.entries().map(|(i, s)| Some((i, place(s)?)));
        add(blocks.sides[0].to_vec(), &mut entries())?;
        let transposed = &mut entries().map(|entry| entry.map(|(i, s)| (s, i)));
        add(blocks.sides[1].to_vec(), transposed)?;
        let entries = || {
            layout
                .scalars
                .entries()
                .map(|(s, t)| Some((place(s)?, place(t)?)))
        };
        let scalars = || vec![layout.scalars_at(0)];
        add(scalars(), &mut entries())?;
        let transposed =
            &mut entries().map(|entry| entry.map(|(s, t)| (t, s)).filter(|(s, t)| s != t));
        add(scalars(), transposed)?;
        let added = blocks.added.into_iter().collect();
        add(added, &mut (0..size).map(|i| Some((i, i))))?;
        let electric = runs.len() - 2 - usize::from(blocks.added.is_some());
        Some(Self {
            runs,
            electric,
            solver,
            potentials: m,
            edge,
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
    }

    /// Makes the grids of the preconditioner anew with the next matrix.
    pub(super) fn forget(&mut self) {
        self.solver.forget();
    }

    /// Takes the matrix of these values; where a matrix of the grids is singular, nothing is solved.
    pub(super) fn take(&mut self, values: &[f64]) {
        self.fill(0, values);
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
        let matrix = self.solver.values_mut();
        if matrix.len() != from.len() {
            return false;
        }
        matrix.copy_from_slice(from);
        self.solver.forget();
        self.is_regular = self.solver.take_values().is_ok();
        self.is_regular
    }

    fn fill(&mut self, first: usize, values: &[f64]) {
        let matrix = self.solver.values_mut();
        matrix.fill(0.0);
        for run in &self.runs[first..] {
            for &start in &run.starts {
                for (value, &target) in values[start..].iter().zip(&run.targets) {
                    if target != NONE {
                        matrix[target as usize] += value;
                    }
                }
            }
        }
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
        let power = if std::mem::take(&mut self.is_new) {
            2
        } else {
            1
        };
        let asked = match self.before.replace(norm) {
            Some(before) => (PART * (norm / before).powi(power)).clamp(least, largest),
            None => largest,
        };
        self.solve(residual, asked, is_over)
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
            false => Ok(Err(NoSolution)),
        }
    }

    /// The update that brings potentials to Gauss's law where nothing moves; `None` where they are near it, or it is not found.
    pub(super) fn potentials_first(
        &mut self,
        values: &[f64],
        residual: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Option<Vec<f64>>, Stopped> {
        if self.potentials == residual.len() {
            return Ok(None);
        }
        self.fill(self.electric, values);
        let changes = (self.potentials..residual.len()).map(|i| {
            let diagonal = self.solver.slot(i, i);
            diagonal.map_or(0.0, |slot| residual[i] / self.solver.values_mut()[slot])
        });
        let largest = changes.fold(0.0, |m, change| f64::max(m, change.abs()));
        match largest < STRONG * self.edge {
            true => Ok(None),
            false => self.potentials_to_law(values, residual, is_over),
        }
    }

    /// The update that brings potentials to Gauss's law where nothing moves; `None` where it is not found.
    pub(super) fn potentials_to_law(
        &mut self,
        values: &[f64],
        residual: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Option<Vec<f64>>, Stopped> {
        self.fill(self.electric, values);
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

/// Entries of the matrix by slot; `None` where something couples that are no neighbours.
fn targets(
    solver: &Multigrid,
    entries: &mut dyn Iterator<Item = Option<(usize, usize)>>,
) -> Option<Vec<u32>> {
    let target = |entry: Option<(usize, usize)>| {
        let Some((row, col)) = entry else {
            return Some(NONE);
        };
        match solver.slot(row, col) {
            Some(slot) => Some(compact_index(slot)),
            None => (solver.holds(row) || solver.holds(col)).then_some(NONE),
        }
    };
    entries.map(target).collect()
}
