//! Rates of a system with closed loops: those that a state names, completed so that no loop opens.
//!
//! With the rates w of nodes and of bodies that are named, at which all joints rest, the rates v have the least
//!
//! ```text
//! ½ (v − w)ᵀ M (v − w)     with  Gᵀ v = 0,   Jᵀ v = r
//! ```
//!
//! of the gradients G of the constraints and J of what is named, joint coordinates and bodies, with the rates r: where w is zero it is the kinetic
//! energy. With v₀ = w + p of the rates p of prescribed coordinates, v = v₀ + d₀ + D ν and
//!
//! ```text
//! M d₀ + G μ₀ = −M p,  Gᵀ d₀ = −Gᵀ v₀;      M D + G μ = J,  Gᵀ D = 0;      (Jᵀ D) ν = r − Jᵀ (v₀ + d₀).
//! ```
//!
//! Independent changes of coordinates under constraints.
//!
//! N is a basis of the null space of the gradients G of the constraints g at coordinates z₀. The coordinates with changes δ along it solve
//!
//! ```text
//! g(z) = 0,   Nᵀ(z − z₀) = δ,        ∂z/∂δ = [Gᵀ N]⁻ᵀ [0 I]ᵀ.
//! ```
//!
//! Without constraints N holds unit vectors, and z = z₀ + N δ. Prescribed coordinates do not change.

use crate::coordinates::Configuration;
use crate::dynamics::momenta::{Kinetic, constrained, directions};
use crate::functional::Order;
use crate::model::{Model, Role};
use nalgebra::{DMatrix, DVector, SVD};

/// Part of the greatest rate by which a constraint or what is named may be missed.
const OPEN: f64 = 1e-9;
/// Singular values of Jᵀ D below this part of the greatest belong to named rates that follow from the others.
const DEPENDENT: f64 = 1e-10;
/// Number of rates of a body.
const BODY: usize = 12;
/// Corrections of rates by squares of gradients, each with half of the digits.
const CORRECTIONS: usize = 3;

/// Rates v of the coordinates at coordinates `z`, completed from those of nodes and named bodies, `rates`, and of joints that are named.
///
/// # Errors
/// The constraint, joint or body that the named rates violate most.
pub fn rates_in_loops(
    model: &Model,
    z: &[f64],
    rates: Vec<f64>,
    joints: &[(usize, f64)],
    bodies: &[usize],
) -> Result<Vec<f64>, String> {
    let mut all = rates.iter().chain(joints.iter().map(|(_, rate)| rate));
    if !model.has_loops() || all.all(|rate| *rate == 0.0) {
        return Ok(rates);
    }
    let mut instant = model.action.map.placed(z);
    let mut kinetic = Kinetic::new(model);
    kinetic.assemble(&mut instant);
    let mut prescribed = vec![0.0; rates.len()];
    model.prescribe_rates(0.0, &mut prescribed);
    let named = Named { joints, bodies };
    let mut wanted = named.at(model, &mut instant, &rates);
    let given = wanted.iter_mut().zip(joints);
    given.for_each(|(wanted, &(_, rate))| *wanted = rate);
    let problem = Problem {
        named: named.gradients(model, &mut instant, wanted.len()),
        wanted: DVector::from_vec(wanted),
        prescribed: DVector::from_vec(prescribed),
        carried: DVector::from_vec(rates),
    };
    let exact = problem.by_factors(&mut kinetic, model.action.map.unknowns());
    let found = exact.filter(|found| problem.gaps(&kinetic, found).amax() <= OPEN * found.amax());
    let found = found.or_else(|| problem.by_squares(&kinetic));
    let found = found.unwrap_or_else(|| problem.carried.clone());
    let gaps = problem.gaps(&kinetic, &found);
    let worst = gaps.iamax();
    if gaps[worst].abs() <= OPEN * found.amax() {
        return Ok(found.as_slice().to_vec());
    }
    let constraints = model.variables.with(Role::Multiplier);
    Err(match constraints.get(worst) {
        Some(constraint) => constraint.name.clone(),
        None => named.name(model, worst - constraints.len()),
    })
}

struct Problem {
    /// J.
    named: DMatrix<f64>,
    /// r.
    wanted: DVector<f64>,
    /// p.
    prescribed: DVector<f64>,
    /// w.
    carried: DVector<f64>,
}

impl Problem {
    /// v by the factors of the bordered masses; `None` where these have no inverse.
    fn by_factors(&self, kinetic: &mut Kinetic<'_>, unknowns: usize) -> Option<DVector<f64>> {
        kinetic.factor()?;
        let n = self.carried.len();
        let mut prescribed = self.prescribed.as_slice().to_vec();
        prescribed.resize(unknowns, 0.0);
        let mut right = kinetic.without(&vec![0.0; n], &prescribed);
        let opening = kinetic.opening(self.carried.as_slice());
        right
            .iter_mut()
            .zip(opening)
            .for_each(|(value, rate)| *value -= rate);
        let mut found = &self.carried + &self.prescribed;
        found += DVector::from_vec(kinetic.solve(&right)?);
        if self.wanted.is_empty() {
            return Some(found);
        }
        let mut pulls = DMatrix::zeros(n, self.wanted.len());
        for (k, gradient) in self.named.column_iter().enumerate() {
            right.clear();
            right.extend(gradient.iter());
            right.resize(unknowns, 0.0);
            kinetic.hold(&mut right);
            pulls.set_column(k, &DVector::from_vec(kinetic.solve(&right)?));
        }
        let left = &self.wanted - self.named.tr_mul(&found);
        let moved = self.named.tr_mul(&pulls).svd(true, true);
        let least = DEPENDENT * moved.singular_values.amax();
        found += pulls * moved.solve(&left, least).ok()?;
        Some(found)
    }

    /// v by the squares of all gradients, also where masses are missing; `None` of large systems.
    fn by_squares(&self, kinetic: &Kinetic<'_>) -> Option<DVector<f64>> {
        let (mass, mut gradients) = kinetic.small()?;
        let count = gradients.ncols();
        gradients = gradients.insert_columns(count, self.wanted.len(), 0.0);
        let mut named = gradients.columns_mut(count, self.wanted.len());
        named.copy_from(&self.named);
        let mut wanted = DVector::zeros(gradients.ncols());
        wanted
            .rows_mut(count, self.wanted.len())
            .copy_from(&self.wanted);
        for (mut column, wanted) in gradients.column_iter_mut().zip(wanted.iter_mut()) {
            let size = column.norm().max(f64::MIN_POSITIVE);
            column /= size;
            *wanted /= size;
        }
        let mut found = &self.carried + &self.prescribed;
        for _ in 0..CORRECTIONS {
            let left = &wanted - gradients.tr_mul(&found);
            let pull = &mass * (&self.carried - &found);
            let step = constrained(&mass, &gradients, [pull.as_slice(), left.as_slice()]);
            found += DVector::from_vec(step);
        }
        Some(found)
    }

    /// Rates by which constraints and then what is named are missed, relative to their gradients.
    fn gaps(&self, kinetic: &Kinetic<'_>, found: &DVector<f64>) -> DVector<f64> {
        let mut gaps = kinetic.of_constraints(found.as_slice());
        let missed = self.named.tr_mul(found) - &self.wanted;
        let named = missed.iter().zip(self.named.column_iter());
        gaps.extend(named.map(|(gap, column)| gap / column.norm().max(f64::MIN_POSITIVE)));
        DVector::from_vec(gaps)
    }
}

/// Named parts: joints with their rates, and bodies, which keep theirs.
struct Named<'a> {
    joints: &'a [(usize, f64)],
    bodies: &'a [usize],
}

impl Named<'_> {
    /// Their rates at a placed instant with rates of the coordinates, in which they are linear.
    fn at(&self, model: &Model, instant: &mut Configuration, rates: &[f64]) -> Vec<f64> {
        instant.l.fill(0.0);
        instant.l[..rates.len()].copy_from_slice(rates);
        let joints = self.joints.iter();
        let joints = joints.map(|&(joint, _)| model.joint_rate(joint, instant));
        let bodies = self.bodies.iter();
        let bodies = bodies.flat_map(|&body| model.rates_of_body(body, instant));
        joints.chain(bodies).collect()
    }

    /// The derivatives of their rates, a column for each.
    fn gradients(&self, model: &Model, instant: &mut Configuration, count: usize) -> DMatrix<f64> {
        let n = model.coordinate_count();
        let mut all = DMatrix::zeros(n, count);
        let mut unit = vec![0.0; n];
        for (i, mut row) in all.row_iter_mut().enumerate() {
            unit[i] = 1.0;
            row.copy_from_slice(&self.at(model, instant, &unit));
            unit[i] = 0.0;
        }
        all
    }

    /// The joint or body of a rate.
    fn name(&self, model: &Model, rate: usize) -> String {
        match self.joints.get(rate) {
            Some(&(joint, _)) => model.system.joints[joint].name.clone(),
            None => {
                let body = self.bodies[(rate - self.joints.len()) / BODY];
                model.system.bodies[body].name.clone()
            }
        }
    }
}

/// Singular values below this part of the greatest are none.
const NONE: f64 = 1e-11;
/// Updates of Newton's method.
pub(super) const UPDATES: usize = 50;
/// An update this small, relative to the sizes of coordinates, is the last one.
pub(super) const SETTLED: f64 = 1e-13;
/// Constraints may be violated by this part of the size of a system.
const CLOSED: f64 = 1e-9;

/// Coordinates z₀ and a basis of the changes that constraints leave free there.
#[derive(Debug)]
pub struct IndependentChanges<'m> {
    model: &'m Model,
    z: Vec<f64>,
    basis: DMatrix<f64>,
    are_memories: Vec<bool>,
}

impl<'m> IndependentChanges<'m> {
    /// The basis at coordinates z₀ and multipliers; none where constraints join more coordinates than are decomposed.
    pub fn at(model: &'m Model, z: Vec<f64>) -> Option<Self> {
        let open = (0..model.coordinate_count()).filter(|&i| !model.is_prescribed(i));
        let joined: Vec<usize> = match model.action.map.multipliers {
            0 => Vec::new(),
            _ => open.clone().filter(|&i| !model.is_memory(i)).collect(),
        };
        let mut columns: Vec<Vec<(usize, f64)>> = Vec::new();
        if !joined.is_empty() {
            let gradients = gradients(model, &z)?.select_rows(&joined);
            let (square, [free, _]) = directions(&gradients);
            let vectors = free
                .iter()
                .map(|&i| square.eigenvectors.column(i).into_owned());
            let of =
                |vector: DVector<f64>| joined.iter().copied().zip(vector.iter().copied()).collect();
            columns.extend(vectors.map(of));
        }
        let alone = open.filter(|i| !joined.contains(i));
        columns.extend(alone.map(|i| vec![(i, 1.0)]));
        let mut basis = DMatrix::zeros(model.coordinate_count(), columns.len());
        for (column, entries) in columns.iter().enumerate() {
            entries
                .iter()
                .for_each(|&(i, value)| basis[(i, column)] = value);
        }
        let of_memory =
            |entries: &Vec<(usize, f64)>| entries.iter().all(|&(i, _)| model.is_memory(i));
        Some(Self {
            are_memories: columns.iter().map(of_memory).collect(),
            model,
            z,
            basis,
        })
    }

    /// The basis, a column for each change.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// The changes of what has momenta, by their columns: of coordinates that remember nothing.
    pub fn moving(&self) -> Vec<usize> {
        let columns = self.are_memories.iter().enumerate();
        columns
            .filter(|(_, is_memory)| !**is_memory)
            .map(|(column, _)| column)
            .collect()
    }

    /// Coordinates and multipliers with changes, and the derivatives of the coordinates by these; none where the constraints cannot be met.
    pub fn changed(&self, changes: &[f64]) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let (n, changes) = (self.basis.nrows(), DVector::from_column_slice(changes));
        let mut z = self.z.clone();
        let first = &self.basis * &changes;
        z.iter_mut()
            .zip(first.iter())
            .for_each(|(z, change)| *z += change);
        if self.model.action.map.multipliers == 0 {
            return Some((z, self.basis.clone()));
        }
        let (sizes, mut update) = (self.model.sizes(), f64::INFINITY);
        for _ in 0..UPDATES {
            if update <= SETTLED {
                break;
            }
            let values = self.values(&z);
            let moved = DVector::from_fn(n, |i, _| z[i] - self.z[i]);
            let along = self.basis.transpose() * moved - &changes;
            let gap = DVector::from_iterator(
                values.len() + along.len(),
                values.iter().chain(along.iter()).copied(),
            );
            let step = self.solved(&z, &DMatrix::from_columns(&[gap]))?;
            z.iter_mut()
                .zip(step.iter())
                .for_each(|(z, step)| *z -= step);
            let steps = step.iter().zip(&sizes);
            update = steps
                .map(|(step, size)| step.abs() / size)
                .fold(0.0, f64::max);
        }
        let largest = self
            .values(&z)
            .iter()
            .fold(0.0, |most: f64, g| most.max(g.abs()));
        let is_closed = largest <= CLOSED * self.model.length() * self.model.multiplier_time;
        let constraints = self.model.action.map.multipliers;
        let mut right = DMatrix::zeros(constraints + changes.len(), changes.len());
        right
            .view_mut((constraints, 0), (changes.len(), changes.len()))
            .fill_with_identity();
        let slopes = self.solved(&z, &right)?;
        is_closed.then_some((z, slopes))
    }

    /// Solves `[G N]ᵀ x = b`; prescribed coordinates do not change.
    fn solved(&self, z: &[f64], right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut gradients = gradients(self.model, z)?;
        for i in (0..gradients.nrows()).filter(|&i| self.model.is_prescribed(i)) {
            gradients.row_mut(i).fill(0.0);
        }
        let (rows, met) = (gradients.ncols(), right.nrows());
        let mut matrix = DMatrix::zeros(met, gradients.nrows());
        matrix.rows_mut(0, rows).copy_from(&gradients.transpose());
        matrix
            .rows_mut(rows, met - rows)
            .copy_from(&self.basis.transpose());
        let factors = SVD::new(matrix, true, true);
        let least = NONE * factors.singular_values.amax();
        factors.solve(right, least).ok()
    }

    /// Values of the constraints, in the unit of their gradients.
    fn values(&self, z: &[f64]) -> Vec<f64> {
        let action = &self.model.action;
        let mut scratch = action.scratch(Order::Gradient);
        let mut instant = action.map.placed(z);
        action.evaluate_instant(Order::Gradient, &mut instant, &[], &mut scratch);
        scratch.instant.plain.rows.clone()
    }
}

/// Gradients of the constraints, a column for each; none of too many coordinates.
pub(super) fn gradients(model: &Model, z: &[f64]) -> Option<DMatrix<f64>> {
    let mut kinetic = Kinetic::new(model);
    kinetic.assemble(&mut model.action.map.placed(z));
    Some(kinetic.small()?.1)
}
