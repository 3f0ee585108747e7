//! The step of the midpoint rule, linearised: the state after it by the state before it and the inputs of the interval.
//!
//! The state is `x = (q, p)`: coordinates, and momenta of those that have inertia or a potential. A step solves
//!
//! ```text
//! p + D₁L_d(q, q₊, s, u) + f⁻ = 0,     ∂L_d/∂s = 0,     p₊ = D₂L_d(q, q₊, s, u) + f⁺
//! ```
//!
//! with scalars s of the interval that have an equation. Their second derivatives give `δx₊ = A δx + B δu` exactly. What remembers has no
//! momentum: its row holds with p = 0 at all instants. In closed loops the state has independent coordinates q and their momenta
//! ([`Independent`]): L_d is that of all coordinates, which follow from them. A voltage V that acts by its square alone is replaced by `w = V²`, as its own
//! derivative vanishes with it: the derivative by w is the same at all V.

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::independent::Independent;
use crate::functional::{Order, Sample};
use crate::math::Vector;
use crate::model::{Model, Role};
use nalgebra::{DMatrix, DVector};

/// An input by which a step is differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepInput {
    /// Scalar of an interval.
    pub scalar: usize,
    /// True if it acts by its square, by which is differentiated.
    pub is_squared: bool,
}

/// A linearised step `δx₊ = A δx + B δu`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearStep {
    /// A.
    pub by_state: DMatrix<f64>,
    /// B.
    pub by_inputs: DMatrix<f64>,
    /// Momentum of each coordinate after the step.
    pub momentum: Vec<f64>,
}

/// Linearises steps of a model.
#[derive(Debug)]
pub struct Linearisation<'m> {
    model: &'m Model,
    inputs: Vec<StepInput>,
    independent: Independent,
    /// The independent coordinates.
    free: Vec<usize>,
    /// Those of them with a momentum.
    inert: Vec<usize>,
    ends: [Configuration; 2],
    scratch: Scratch,
    values: Vec<f64>,
}

/// Second derivatives of an interval: `by[i][j]` of the rows of instant i by the coordinates of instant j.
struct Blocks {
    by: [[DMatrix<f64>; 2]; 2],
    /// Of the rows of both instants by the scalars.
    mixed: [DMatrix<f64>; 2],
    /// Of the rows of the scalars by the scalars.
    scalars: DMatrix<f64>,
    /// Momentum after the interval.
    momentum: Vec<f64>,
}

/// The voltages and loads of a model, each with whether it acts by its square alone.
pub fn step_inputs(model: &Model) -> Vec<StepInput> {
    let terms = model.action.intervals.terms.iter();
    let others: Vec<usize> = terms.flat_map(|term| term.not_by_squares()).collect();
    let voltages = model.variables.range(Role::Voltage);
    let inputs = model.variables.sources_range();
    let input = |scalar| StepInput {
        scalar,
        is_squared: voltages.contains(&scalar) && !others.contains(&scalar),
    };
    inputs.map(input).collect()
}

impl<'m> Linearisation<'m> {
    /// Prepares the linearisation by these inputs, of a state of independent coordinates.
    pub fn new(model: &'m Model, independent: &Independent, inputs: &[StepInput]) -> Self {
        let map = &model.action.map;
        let free = independent.coordinates().to_vec();
        let is_inert = |i: &usize| !model.is_memory(*i);
        Self {
            model,
            inputs: inputs.to_vec(),
            inert: free.iter().copied().filter(is_inert).collect(),
            free,
            independent: independent.clone(),
            ends: [map.instant(), map.instant()],
            scratch: model.action.scratch(Order::Hessian),
            values: vec![0.0; model.action.layout().values(1)],
        }
    }

    /// The coordinates of the state.
    pub fn coordinates(&self) -> &[usize] {
        &self.free
    }

    /// The coordinates whose momenta belong to the state, which follow the coordinates.
    pub fn momenta(&self) -> &[usize] {
        &self.inert
    }

    /// Number of entries of the state.
    pub fn size(&self) -> usize {
        self.free.len() + self.inert.len()
    }

    /// The state of these coordinates and momenta.
    pub fn state(&self, z: &[f64], momentum: &[f64]) -> Vec<f64> {
        let mut momentum = momentum.to_vec();
        self.independent.reduce(self.model, z, &mut momentum);
        let coordinates = self.free.iter().map(|&i| z[i]);
        coordinates
            .chain(self.inert.iter().map(|&i| momentum[i]))
            .collect()
    }

    /// The step of `h` ms from coordinates to the next under these scalars; `None` where it is singular.
    pub fn step(&mut self, z: [&[f64]; 2], scalars: &[f64], h: f64) -> Option<LinearStep> {
        let blocks = self.blocks(z, scalars, h);
        let by_inputs = self.by_inputs(z, scalars, &blocks, h);
        let (n, m, u) = (self.free.len(), self.inert.len(), self.inputs.len());
        let own: Vec<usize> = self.model.variables.algebraic().collect();
        let (size, columns) = (n + own.len(), n + m + u);
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DMatrix::zeros(size, columns);
        for (r, &i) in self.free.iter().enumerate() {
            for (c, &j) in self.free.iter().enumerate() {
                matrix[(r, c)] = blocks.by[0][1][(i, j)];
                right[(r, c)] = -blocks.by[0][0][(i, j)];
            }
            for (a, &s) in own.iter().enumerate() {
                matrix[(r, n + a)] = blocks.mixed[0][(i, s)];
                matrix[(n + a, r)] = blocks.mixed[1][(i, s)];
                right[(n + a, r)] = -blocks.mixed[0][(i, s)];
            }
            if let Some(p) = self.inert.iter().position(|&other| other == i) {
                right[(r, n + p)] = -1.0;
            }
            for c in 0..u {
                right[(r, n + m + c)] = -by_inputs[0][(i, c)];
            }
        }
        for (a, &s) in own.iter().enumerate() {
            for (b, &t) in own.iter().enumerate() {
                matrix[(n + a, n + b)] = blocks.scalars[(s, t)];
            }
            for c in 0..u {
                right[(n + a, n + m + c)] = -by_inputs[2][(s, c)];
            }
        }
        let solved = matrix.lu().solve(&right)?;
        let mut next = DMatrix::zeros(n + m, columns);
        next.rows_mut(0, n).copy_from(&solved.rows(0, n));
        for (r, &i) in self.inert.iter().enumerate() {
            for c in 0..columns {
                let mut sum = match c {
                    _ if c < n => blocks.by[1][0][(i, self.free[c])],
                    _ if c < n + m => 0.0,
                    _ => by_inputs[1][(i, c - n - m)],
                };
                for (k, &j) in self.free.iter().enumerate() {
                    sum += blocks.by[1][1][(i, j)] * solved[(k, c)];
                }
                for (a, &s) in own.iter().enumerate() {
                    sum += blocks.mixed[1][(i, s)] * solved[(n + a, c)];
                }
                next[(n + r, c)] = sum;
            }
        }
        let is_finite = next.iter().all(|value| value.is_finite());
        is_finite.then(|| LinearStep {
            by_state: next.columns(0, n + m).into_owned(),
            by_inputs: next.columns(n + m, u).into_owned(),
            momentum: blocks.momentum,
        })
    }

    /// Derivatives by the inputs: of the rows of both instants, and of the scalars. Those by squares are taken at 1 V, as they are the same
    /// at all voltages.
    fn by_inputs(
        &mut self,
        z: [&[f64]; 2],
        scalars: &[f64],
        blocks: &Blocks,
        h: f64,
    ) -> [DMatrix<f64>; 3] {
        let inputs = self.inputs.clone();
        let squared = inputs.iter().any(|input| input.is_squared).then(|| {
            let mut scalars = scalars.to_vec();
            let squared = inputs.iter().filter(|input| input.is_squared);
            squared.for_each(|input| scalars[input.scalar] = 1.0);
            self.blocks(z, &scalars, h)
        });
        let of = |pick: &dyn Fn(&Blocks) -> &DMatrix<f64>| {
            let rows = pick(blocks).nrows();
            DMatrix::from_fn(rows, inputs.len(), |row, c| match (&squared, inputs[c]) {
                (Some(at_one), input) if input.is_squared => {
                    0.5 * pick(at_one)[(row, input.scalar)]
                }
                (_, input) => pick(blocks)[(row, input.scalar)],
            })
        };
        [
            of(&|blocks| &blocks.mixed[0]),
            of(&|blocks| &blocks.mixed[1]),
            of(&|blocks| &blocks.scalars),
        ]
    }

    fn blocks(&mut self, z: [&[f64]; 2], scalars: &[f64], h: f64) -> Blocks {
        let action = &self.model.action;
        let layout = action.layout();
        let n = action.map.coordinates;
        for (end, z) in self.ends.iter_mut().zip(z) {
            end.z[..n].copy_from_slice(&z[..n]);
            action.map.place(end);
            end.forces.fill(Vector::zeros());
        }
        self.values.fill(0.0);
        let interval = Sample::of_interval(scalars, h);
        let (scratch, values) = (&mut self.scratch, &mut self.values);
        let [here, next] = &mut self.ends;
        action.evaluate_interval(Order::Hessian, [here, next], &interval, scratch);
        action.pull_back_interval(Order::Hessian, [here, next], &interval, 0, scratch, values);
        // The curvature of the coordinates under the forces of this interval alone.
        for (k, end) in [here, next].into_iter().enumerate() {
            let mut forces = vec![0.0; n];
            action.map.pull_back(&end.columns, &end.forces, &mut forces);
            self.independent.balance(self.model, end, &forces);
            action.evaluate_instant(Order::Hessian, end, &[], scratch);
            action.pull_back_instant(Order::Hessian, end, k, scratch, values);
        }
        let square = || DMatrix::zeros(n, n);
        let count = layout.interval_scalars;
        let mut out = Blocks {
            by: [[square(), square()], [square(), square()]],
            mixed: [DMatrix::zeros(n, count), DMatrix::zeros(n, count)],
            scalars: DMatrix::zeros(count, count),
            momentum: vec![0.0; n],
        };
        let next = &self.ends[1];
        action
            .map
            .pull_back(&next.columns, &next.forces, &mut out.momentum);
        let of_coordinates = |(_, (row, col)): &(usize, (usize, usize))| *row < n && *col < n;
        let same = layout.same.entries().enumerate();
        for (slot, (row, col)) in same.filter(of_coordinates) {
            out.by[0][0][(row, col)] = values[layout.same_at(0) + slot];
            out.by[1][1][(row, col)] = values[layout.same_at(1) + slot];
        }
        for (slot, (row, col)) in layout.cross.entries().enumerate() {
            out.by[0][1][(row, col)] = values[layout.upper_at(0) + slot];
            out.by[1][0][(row, col)] = values[layout.lower_at(0) + slot];
        }
        for (slot, (row, s)) in layout.mixed.entries().enumerate() {
            for side in 0..2 {
                out.mixed[side][(row, s)] = values[layout.mixed_at(0, side) + slot];
            }
        }
        for (slot, (s, t)) in layout.scalars.entries().enumerate() {
            let value = values[layout.scalars_at(0) + slot];
            out.scalars[(s, t)] = value;
            out.scalars[(t, s)] = value;
        }
        let slopes = z.map(|z| self.independent.slopes(self.model, z));
        for (i, of_row) in slopes.iter().enumerate() {
            of_row.rows(&mut out.mixed[i]);
            for (j, of_column) in slopes.iter().enumerate() {
                of_row.rows(&mut out.by[i][j]);
                of_column.columns(&mut out.by[i][j]);
            }
        }
        out
    }
}

/// Derivatives of the momentum of each coordinate at coordinates z with these rates: the mass matrix by rates, and by coordinates; in closed loops
/// those of independent coordinates.
pub fn momentum_derivatives(
    model: &Model,
    independent: &Independent,
    z: &[f64],
    rates: &[f64],
) -> [DMatrix<f64>; 2] {
    let action = &model.action;
    let map = &action.map;
    let n = map.coordinates;
    let mut instant = map.placed(z);
    let mut unit = vec![0.0; n];
    let mut mass = DMatrix::zeros(n, n);
    for c in 0..n {
        unit[c] = 1.0;
        let column = action.momentum(&mut instant, &unit);
        mass.set_column(c, &DVector::from_vec(column));
        unit[c] = 0.0;
    }
    let slopes = independent.slopes(model, z);
    let whole = |mut of: DMatrix<f64>| {
        slopes.rows(&mut of);
        slopes.columns(&mut of);
        of
    };
    let mut by_coordinates = DMatrix::zeros(n, n);
    if rates.iter().all(|rate| *rate == 0.0) {
        return [whole(mass), by_coordinates];
    }
    instant.l[..n].copy_from_slice(rates);
    map.along(&mut instant);
    let zeros = || vec![Vector::zeros(); instant.x.len()];
    let (v, mut moving, mut changes) = (instant.w.clone(), zeros(), zeros());
    for term in &action.intervals.terms {
        term.momentum(&instant.x, &v, &mut moving);
    }
    for c in 0..n {
        // ∂/∂q_c (Pᵀ π(x, P v)) = P′_cᵀ π + Pᵀ (∂π/∂x P_c + ∂π/∂ẋ P′_c v).
        unit[c] = 1.0;
        instant.l[..n].copy_from_slice(&unit);
        map.along(&mut instant);
        let by = [&*instant.w, &*map.times(&instant.columns_l, rates)];
        changes.fill(Vector::zeros());
        for term in &action.intervals.terms {
            term.momentum_along([&instant.x, &v], by, &mut changes);
        }
        let mut rows = vec![0.0; n];
        map.pull_back_along(&instant.columns_l, &moving, &mut rows);
        map.pull_back(&instant.columns, &changes, &mut rows);
        by_coordinates.set_column(c, &DVector::from_vec(rows));
        unit[c] = 0.0;
    }
    let mut momentum = vec![0.0; n];
    map.pull_back(&instant.columns, &moving, &mut momentum);
    let moving = [rates, &momentum[..]];
    independent.add_curvature(model, &mut instant, moving, &mass, &mut by_coordinates);
    [mass, by_coordinates].map(whole)
}
