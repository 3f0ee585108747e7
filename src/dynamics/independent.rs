//! Independent coordinates of closed loops, which determine the others along a motion.
//!
//! Of the coordinates u = (y, w) the constraints c(u) = 0 give w by y. With their gradients Γ and T = ∂u/∂y, whose rows of w are −Γ_w⁻ᵀ Γ_yᵀ, momenta p
//! act as π = Tᵀ p: a step from p and one from (π, 0) are the same. Forces f do along the curvature of u(y) what multipliers λ do along that of c,
//!
//! ```text
//! f·u″ = Tᵀ (λ·c″) T,     Γ_w λ = −f_w.
//! ```
//!
//! Without constraints all coordinates are independent. Where y does not determine w, as in a dead point, T is not a number.

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::loop_rates::{SETTLED, UPDATES, gradients};
use crate::dynamics::momenta::directions;
use crate::functional::Order;
use crate::math::Vector;
use crate::model::{Coordinates, Model, independent_rows};
use crate::sparse::Direct;
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// Reason why a model has no state of independent coordinates and their momenta.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum NoState {
    /// Its coordinates are redundant.
    #[error("the coordinates are redundant; expected \"reduced\"")]
    Redundant,
    /// Some of its coordinates are turns relative to a rotation that changes.
    #[error("a spherical joint or a free body turns in all directions")]
    Charts,
    /// No choice of its coordinates determines the others.
    #[error(
        "along the motion no choice of joint coordinates determines the others of its closed loops"
    )]
    Dependent,
}

/// Independent coordinates of a model.
#[derive(Clone, Debug)]
pub struct Independent {
    free: Vec<usize>,
    dependent: Vec<usize>,
}

/// T at an instant: the rows of the coordinates that follow, by those that are independent.
#[derive(Clone, Debug)]
pub struct Slopes {
    free: Vec<usize>,
    dependent: Vec<usize>,
    by_free: DMatrix<f64>,
}

impl Independent {
    /// Those of a model along a motion, of which these are coordinates at some instants; the reference without any. Coordinates that move most where
    /// they move least are taken.
    ///
    /// # Errors
    /// The coordinates are no state, or no choice of them is independent.
    pub fn new(model: &Model, along: &[Vec<f64>]) -> Result<Self, NoState> {
        let map = &model.action.map;
        if model.coordinates == Coordinates::Redundant {
            return Err(NoState::Redundant);
        }
        if map.instant().z.len() > map.unknowns() {
            return Err(NoState::Charts);
        }
        let open = open(model);
        if map.multipliers == 0 {
            return Ok(Self {
                free: open,
                dependent: Vec::new(),
            });
        }
        let is_joined = |i: &usize| !model.is_memory(*i);
        let joined: Vec<usize> = open.iter().copied().filter(is_joined).collect();
        let reference = [model.reference_coordinates()];
        let states = match along {
            [] => &reference[..],
            _ => along,
        };
        let bases: Option<Vec<_>> = states.iter().map(|z| basis(model, &joined, z)).collect();
        let picked = independent_rows(bases.ok_or(NoState::Dependent)?);
        let picked: Vec<usize> = picked.into_iter().map(|row| joined[row]).collect();
        let is_free = |i: &usize| picked.contains(i) || model.is_memory(*i);
        let free: Vec<usize> = open.into_iter().filter(is_free).collect();
        let found = Self::of(model, free);
        match found.dependent.len() == map.multipliers {
            true => Ok(found),
            false => Err(NoState::Dependent),
        }
    }

    /// Coordinates that are known to be independent.
    pub fn of(model: &Model, free: Vec<usize>) -> Self {
        let mut dependent = open(model);
        dependent.retain(|i| !free.contains(i));
        Self { free, dependent }
    }

    /// The independent coordinates, but those that are functions of time.
    pub fn coordinates(&self) -> &[usize] {
        &self.free
    }

    /// The coordinates that follow.
    pub fn followers(&self) -> &[usize] {
        &self.dependent
    }

    /// T at coordinates.
    pub fn slopes(&self, model: &Model, z: &[f64]) -> Slopes {
        let [own, others] = self.gradients(model, z);
        Slopes {
            by_free: -solved(own.transpose(), &others.transpose()),
            free: self.free.clone(),
            dependent: self.dependent.clone(),
        }
    }

    /// Lets the other coordinates and their rates follow; none is a number where the loops cannot be closed.
    pub fn close(&self, model: &Model, z: &mut [f64], rates: &mut [f64]) {
        let mut instant = model.action.map.placed(z);
        if !Closing::new(model, self).close(model, &mut instant, rates) {
            self.dependent.iter().for_each(|&i| rates[i] = f64::NAN);
            instant.z.fill(f64::NAN);
        }
        z.copy_from_slice(&instant.z);
    }

    /// Makes momenta of a state those that act as they do, with zeros of the coordinates that follow.
    pub fn reduce(&self, model: &Model, z: &[f64], momentum: &mut [f64]) {
        if self.dependent.is_empty() {
            return;
        }
        for (i, slopes) in self.slopes(model, z).followers() {
            let moved = std::mem::take(&mut momentum[i]);
            for (slope, &own) in slopes.iter().zip(&self.free) {
                momentum[own] += slope * moved;
            }
        }
    }

    /// Γ_w and Γ_y at coordinates.
    fn gradients(&self, model: &Model, z: &[f64]) -> [DMatrix<f64>; 2] {
        let counts = [model.coordinate_count(), self.dependent.len()];
        let all = match self.dependent.is_empty() {
            true => None,
            false => gradients(model, z),
        };
        let all = all.unwrap_or_else(|| DMatrix::from_element(counts[0], counts[1], f64::NAN));
        [&self.dependent, &self.free].map(|own| all.select_rows(own))
    }

    /// Gives a placed instant the multipliers λ that balance forces on the coordinates that follow.
    pub(super) fn balance(&self, model: &Model, instant: &mut Configuration, forces: &[f64]) {
        let [own, _] = self.gradients(model, &instant.z);
        let left = self.dependent.iter().map(|&i| -forces[i]);
        let left = DMatrix::from_iterator(self.dependent.len(), 1, left);
        let (first, multipliers) = (model.coordinate_count(), solved(own, &left));
        instant.z[first..first + multipliers.len()].copy_from_slice(multipliers.as_slice());
    }

    /// Adds to derivatives of momenta p = M u̇ by u, at rates u̇ = T ẏ of a placed instant, what makes them those of Tᵀ M T ẏ: the changes of T.
    pub(super) fn add_curvature(
        &self,
        model: &Model,
        instant: &mut Configuration,
        [rates, momentum]: [&[f64]; 2],
        mass: &DMatrix<f64>,
        by_coordinates: &mut DMatrix<f64>,
    ) {
        if self.dependent.is_empty() {
            return;
        }
        let (n, m) = (model.coordinate_count(), self.dependent.len());
        let rates = DVector::from_column_slice(rates);
        let mut opened = DMatrix::zeros(m, n);
        for j in 0..m {
            instant.z[n..n + m].fill(0.0);
            instant.z[n + j] = 1.0;
            opened.set_row(j, &(rates.transpose() * curvature(model, instant)));
        }
        let [own, _] = self.gradients(model, &instant.z);
        // Changes of the rates of the coordinates that follow with u.
        let turned = solved(own.transpose(), &-opened);
        for (row, &i) in turned.row_iter().zip(&self.dependent) {
            by_coordinates.ger(1.0, &mass.column(i), &row.transpose(), 1.0);
        }
        self.balance(model, instant, momentum);
        *by_coordinates += curvature(model, instant);
    }
}

impl Slopes {
    /// Multiplies rows of coordinates by Tᵀ: those of coordinates that follow are added to the others, and vanish.
    pub fn rows(&self, matrix: &mut DMatrix<f64>) {
        for (i, slopes) in self.followers() {
            let row = matrix.row(i).into_owned();
            for (slope, &to) in slopes.iter().zip(&self.free) {
                let mut sum = matrix.row_mut(to);
                sum += &row * *slope;
            }
            matrix.row_mut(i).fill(0.0);
        }
    }

    /// Multiplies columns of coordinates by T likewise.
    pub fn columns(&self, matrix: &mut DMatrix<f64>) {
        for (i, slopes) in self.followers() {
            let column = matrix.column(i).into_owned();
            for (slope, &to) in slopes.iter().zip(&self.free) {
                matrix.column_mut(to).axpy(*slope, &column, 1.0);
            }
            matrix.column_mut(i).fill(0.0);
        }
    }

    /// The coordinates that follow, each with its derivatives by the independent ones.
    pub fn followers(&self) -> impl Iterator<Item = (usize, DVector<f64>)> + '_ {
        let rows = self.by_free.row_iter().map(|row| row.transpose());
        self.dependent.iter().copied().zip(rows)
    }
}

/// Storage in which coordinates follow from the independent ones.
#[derive(Debug)]
pub struct Closing {
    dependent: Vec<usize>,
    sizes: Vec<f64>,
    scratch: Scratch,
    values: Vec<f64>,
    /// Γ_w, and the slots of its entries among the values.
    matrix: Direct,
    slots: Vec<usize>,
    entries: Vec<f64>,
    /// Entries of Γ_y: slot, constraint and coordinate.
    others: Vec<[usize; 3]>,
    step: Vec<f64>,
}

impl Closing {
    /// That of a model with these independent coordinates.
    pub fn new(model: &Model, of: &Independent) -> Self {
        let (action, n) = (&model.action, model.coordinate_count());
        let (sizes, pattern) = (model.sizes(), action.layout());
        let (mut places, mut slots, mut others) = (Vec::new(), Vec::new(), Vec::new());
        let entries = pattern.same.entries().enumerate();
        for (slot, (i, j)) in entries.filter(|(_, (i, j))| *i < n && *j >= n) {
            if let Some(place) = of.dependent.iter().position(|&own| own == i) {
                places.push((j - n, place));
                slots.push(slot);
            } else if of.free.contains(&i) {
                others.push([slot, j - n, i]);
            }
        }
        Self {
            sizes: of.dependent.iter().map(|&i| sizes[i]).collect(),
            scratch: action.scratch(Order::Hessian),
            values: vec![0.0; pattern.values(0)],
            matrix: Direct::new(of.dependent.len(), &places),
            entries: vec![0.0; slots.len()],
            step: vec![0.0; of.dependent.len()],
            dependent: of.dependent.clone(),
            slots,
            others,
        }
    }

    /// Lets the other coordinates of an instant and their rates follow, from where they are; false where the loops cannot be closed.
    pub fn close(&mut self, model: &Model, instant: &mut Configuration, rates: &mut [f64]) -> bool {
        if self.dependent.is_empty() {
            return true;
        }
        let mut update = f64::INFINITY;
        for _ in 0..UPDATES {
            if update <= SETTLED {
                break;
            }
            if !self.factor(model, instant) {
                return false;
            }
            let gaps = self.step.iter_mut().zip(&self.scratch.instant.plain.rows);
            gaps.for_each(|(step, gap)| *step = -gap);
            self.matrix.solve(&mut self.step);
            update = 0.0;
            for ((&i, step), size) in self.dependent.iter().zip(&self.step).zip(&self.sizes) {
                instant.z[i] += step;
                update = f64::max(update, step.abs() / size);
            }
        }
        self.step.fill(0.0);
        for &[slot, row, i] in &self.others {
            self.step[row] -= self.values[slot] * rates[i];
        }
        self.matrix.solve(&mut self.step);
        let all = self.dependent.iter().zip(&self.step);
        all.for_each(|(&i, rate)| rates[i] = *rate);
        update <= SETTLED && self.step.iter().all(|rate| rate.is_finite())
    }

    /// Evaluates constraints and their gradients, and factorises those of the coordinates that follow.
    fn factor(&mut self, model: &Model, instant: &mut Configuration) -> bool {
        let (action, scratch, values) = (&model.action, &mut self.scratch, &mut self.values);
        action.map.place(instant);
        instant.forces.fill(Vector::zeros());
        values.fill(0.0);
        action.evaluate_instant(Order::Hessian, instant, &[], scratch);
        action.pull_back_instant(Order::Hessian, instant, 0, scratch, values);
        let entries = self.entries.iter_mut().zip(&self.slots);
        entries.for_each(|(entry, &slot)| *entry = values[slot]);
        self.matrix.factor(&self.entries).is_ok()
    }
}

/// Coordinates that are no functions of time.
fn open(model: &Model) -> Vec<usize> {
    let all = 0..model.coordinate_count();
    all.filter(|&i| !model.is_prescribed(i)).collect()
}

/// A⁻¹ b, not a number where A is singular.
fn solved(matrix: DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return right.clone();
    }
    let solved = matrix.lu().solve(right);
    solved.unwrap_or_else(|| DMatrix::from_element(right.nrows(), right.ncols(), f64::NAN))
}

/// Basis of the changes, relative to typical sizes, that constraints leave free at coordinates of which some are joined.
fn basis(model: &Model, joined: &[usize], z: &[f64]) -> Option<DMatrix<f64>> {
    let mut gradients = gradients(model, z)?.select_rows(joined);
    let sizes = model.sizes();
    for (mut row, &i) in gradients.row_iter_mut().zip(joined) {
        row *= sizes[i];
    }
    let (square, [free, _]) = directions(&gradients);
    Some(square.eigenvectors.select_columns(&free))
}

/// λ·c″ of the multipliers of a placed instant.
fn curvature(model: &Model, instant: &mut Configuration) -> DMatrix<f64> {
    let action = &model.action;
    let layout = action.layout();
    let n = action.map.coordinates;
    let mut scratch = action.scratch(Order::Hessian);
    let mut values = vec![0.0; layout.values(0)];
    instant.forces.fill(Vector::zeros());
    action.evaluate_instant(Order::Hessian, instant, &[], &mut scratch);
    action.pull_back_instant(Order::Hessian, instant, 0, &mut scratch, &mut values);
    let mut curvature = DMatrix::zeros(n, n);
    for ((i, j), value) in layout.same.entries().zip(&values) {
        if i < n && j < n {
            curvature[(i, j)] += value;
        }
    }
    curvature
}
