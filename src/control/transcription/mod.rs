//! The transcription: the discrete equations of motion over a horizon as a nonlinear program (DMOCC).
//!
//! Rows of instant k are `P(q_k)ᵀ [D₂L_d(q_{k−1}, q_k) + D₁L_d(q_k, q_{k+1}) + f⁺ + f⁻] (− h₀ Gᵀλ_k) = 0` with the
//! momentum of the start in row 0 and rest at the goal in row N, constraints where coordinates leave any, then limits.
//! The Jacobian is ∇²Ŝ, the Hessian of the Lagrangian ∇³Ŝ along the costates plus objective and limits, both exact.
//!
//! Rows, limits and multipliers are scaled by magnitudes of derivatives at the guess, the objective by its value there, inputs by their bounds, lengths
//! by the length of the system, and the interval length by its guess, so that one tolerance means the same everywhere.
//!
//! A [`Transcription`] has constant parts, `layout` (unknowns, equations, limits), `cost_rows` and `structure` (entries of the derivatives),
//! and one that every evaluation changes, `workspace`. Its methods are in `program` (the trait [`Nlp`]), `point`, `interval_pass`, `scaling` and
//! `measured`.

mod cost_rows;
mod interval_pass;
pub(super) mod layout;
mod limit_rows;
mod measured;
mod point;
mod program;
mod scaling;
mod segment;
pub(super) mod structure;
mod workspace;

use crate::control::BoundaryError;
use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::guess::InitialGuess;
use crate::control::limits::BoundedQuantity;
use crate::control::numbering::Numbering;
use crate::control::problem::{self, Control};
use crate::functional::{BlockMask, ParameterOrder};
use crate::model::{Model, Role};
use crate::nlp::{Bounds, Nlp};
use cost_rows::Objective;
use layout::Layout;
pub use layout::Outline;
pub(super) use limit_rows::Site;
use structure::{Structure, overdetermined};
use workspace::Workspace;

/// A control problem as a nonlinear program.
#[derive(Debug)]
pub struct Transcription<'m> {
    model: &'m Model,
    layout: Layout,
    objective: Objective,
    structure: Structure,
    // Scales: value = scale · variable, scaled row = scale · row.
    variable_scales: Vec<f64>,
    row_scales: Vec<f64>,
    /// Bounds of the variables, and of the scaled rows.
    bounds: Bounds,
    row_bounds: Bounds,
    /// Momentum of the start.
    momenta: Momenta,
    /// Second derivatives of an interval that are asked for.
    sides: BlockMask,
    workspace: Workspace,
}

impl<'m> Transcription<'m> {
    /// Transcribes a control problem; the guess sets the scales, and the interval length where the duration is free.
    ///
    /// # Errors
    /// There are more equations than unknowns, or it is time to stop.
    pub fn new(
        model: &'m Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
    ) -> Result<Self, BoundaryError> {
        let out = Self::of_any(model, boundary, control, initial)?;
        let refused = overdetermined(&out.layout, model, control.intervals);
        refused.map_or(Ok(out), Err)
    }

    /// Transcribes like [`new`](Self::new), also where there are more equations than unknowns: derivatives exist all the same.
    ///
    /// # Errors
    /// It is time to stop.
    pub fn of_any(
        model: &'m Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
    ) -> Result<Self, BoundaryError> {
        let layout = Layout::new(model, boundary, control, control.intervals);
        let objective = Objective::new(model, boundary, control, &layout);
        let structure = Structure::new(model, &layout, &objective)?;
        let workspace = Workspace::new(model, boundary, control, initial, &layout);
        let momenta = Momenta::new(model, boundary, &layout, &structure);
        let mut out = Self {
            model,
            variable_scales: Self::variable_scales(model, &layout, control, initial.h),
            row_scales: vec![1.0; layout.unknowns.rows.len()],
            objective,
            structure,
            bounds: Bounds::default(),
            row_bounds: Bounds::default(),
            momenta,
            layout,
            sides: BlockMask::ALL,
            workspace,
        };
        out.set_scales(&initial.discrete, initial.h);
        out.set_bounds(control);
        out.set_row_bounds();
        out.set_objective_scale(&initial.discrete, initial.h);
        Ok(out)
    }

    /// Gives effort, rate and duration the weights of another objective, for its value and gradient. Second derivatives have entries of those weights alone that it
    /// was built with.
    pub fn weigh(&mut self, objective: &problem::Objective) {
        self.objective.cost.weigh(objective);
    }

    /// Leaves entries of the Hessian by two free parameters of elements zero, for one who holds all of them.
    pub fn hold_parameters(&mut self) {
        self.sides.parameters = ParameterOrder::First;
    }

    /// Number of intervals N of the motion.
    pub fn intervals(&self) -> usize {
        self.layout.span.end
    }

    /// The model whose motion is looked for.
    pub fn model(&self) -> &'m Model {
        self.model
    }

    /// Columns and rows.
    pub fn unknowns(&self) -> &Numbering {
        &self.layout.unknowns
    }

    /// The limit or goal of a row.
    pub fn limit(&self, index: usize) -> &BoundedQuantity {
        &self.layout.limits[index].bounded
    }

    /// Returns a value of a limit or goal as shown to users, and its unit.
    pub fn plain(&self, index: usize, value: f64) -> (f64, &'static str) {
        let BoundedQuantity { quantity, rate, .. } = self.limit(index);
        let quantity = match rate {
            Some(_) => quantity.clone().with_interval(self.workspace.h),
            None => quantity.clone(),
        };
        quantity.plain(value, &self.model.system)
    }

    /// Scale of a column: value = scale · variable.
    pub fn column_scale(&self, column: usize) -> f64 {
        self.variable_scales[column]
    }

    /// Scale of a row: scaled row = scale · row.
    pub fn row_scale(&self, row: usize) -> f64 {
        self.row_scales[row]
    }

    /// Largest violation of the scaled rows; infinite where one has no value.
    pub fn violation(&mut self, x: &[f64]) -> f64 {
        let mut g = vec![0.0; self.layout.unknowns.rows.len()];
        self.constraint(x, &mut g);
        self.constraints().violation(&g)
    }
}

/// Momenta of the start, those at the values of the parameters at the start and straight lines in these, and of the goal.
#[derive(Debug)]
struct Momenta {
    /// Momentum of each coordinate at the start.
    given: Vec<f64>,
    lines: Vec<Line>,
    /// The last instant, and the momentum of each coordinate there; none where it rests.
    end: usize,
    goal: Vec<f64>,
}

/// Change of the momenta with a parameter.
#[derive(Debug)]
struct Line {
    /// Column of the parameter.
    column: usize,
    /// Its value where the momenta are those that are given.
    value: f64,
    /// Slope of each momentum.
    slopes: Vec<f64>,
    /// Entries of the Jacobian, and the coordinate of each.
    entries: Vec<(usize, usize)>,
}

impl Momenta {
    fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        layout: &Layout,
        structure: &Structure,
    ) -> Self {
        if layout.span.is_closed {
            return Self {
                given: vec![0.0; boundary.start.momentum.len()],
                lines: Vec::new(),
                end: layout.span.end,
                goal: Vec::new(),
            };
        }
        let pattern = model.action.layout();
        let first = model.variables.range(Role::Parameter).start;
        let lines = boundary.momentum_slopes.iter().filter_map(|one| {
            let s = first + one.parameter;
            let mixed = pattern.mixed.entries().enumerate();
            let read = mixed.filter(|&(_, (i, scalar))| scalar == s && i < one.slopes.len());
            let entry = |(slot, (i, _)): (usize, (usize, usize))| {
                let place = pattern.mixed_at(0, 0) + slot;
                let mut kept = structure.jacobian.kept.iter();
                Some((kept.position(|kept| kept.place == place)?, i))
            };
            Some(Line {
                column: layout.unknowns.scalar(0, s)?,
                value: one.value,
                slopes: one.slopes.clone(),
                entries: read.filter_map(entry).collect(),
            })
        });
        Self {
            given: boundary.start.momentum.clone(),
            lines: lines.collect(),
            end: layout.span.end,
            goal: boundary.goal.momentum.clone(),
        }
    }

    /// The part of the balance of coordinate `i` at instant `k` at a point, whose columns have these scales: the momentum that the start brings, and
    /// the goal takes away.
    fn at(&self, k: usize, i: usize, x: &[f64], scales: &[f64]) -> f64 {
        if k == self.end {
            return -self.goal.get(i).unwrap_or(&0.0);
        }
        let Some(given) = self.given.get(i).filter(|_| k == 0) else {
            return 0.0;
        };
        let of = |line: &Line| line.slopes[i] * (x[line.column] * scales[line.column] - line.value);
        given + self.lines.iter().map(of).sum::<f64>()
    }

    /// Entries of the Jacobian that the momenta change, and their parts.
    fn slopes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.lines.iter().flat_map(|line| {
            let entries = line.entries.iter();
            entries.map(|&(entry, i)| (entry, line.slopes[i]))
        })
    }
}
