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

use crate::coordinates::Configuration;
use crate::dynamics::kinetic::{Kinetic, constrained};
use crate::model::{Model, Role};
use nalgebra::{DMatrix, DVector};

/// Part of the greatest rate by which a constraint or what is named may be missed.
const OPEN: f64 = 1e-9;
/// Singular values of Jᵀ D below this part of the greatest belong to named rates that follow from the others.
const DEPENDENT: f64 = 1e-10;
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
    let mut problem = Problem {
        named: of_joints(model, &mut instant, joints),
        wanted: DVector::from_iterator(joints.len(), joints.iter().map(|(_, rate)| *rate)),
        prescribed: DVector::from_vec(prescribed),
        carried: DVector::from_vec(rates),
    };
    let joints = joints.iter().map(|&(j, _)| &model.system.joints[j].name);
    let mut names: Vec<&String> = joints.collect();
    for &body in bodies {
        for coordinate in model.coordinates_of_body(body) {
            problem.keep(coordinate);
            names.push(&model.system.bodies[body].name);
        }
    }
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
        None => names[worst - constraints.len()].clone(),
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
    /// Names the rate that a coordinate has in w.
    fn keep(&mut self, coordinate: usize) {
        let count = self.wanted.len();
        let named = std::mem::replace(&mut self.named, DMatrix::zeros(0, 0));
        self.named = named.insert_column(count, 0.0);
        self.named[(coordinate, count)] = 1.0;
        let wanted = std::mem::replace(&mut self.wanted, DVector::zeros(0));
        self.wanted = wanted.push(self.carried[coordinate]);
    }

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
            let step = constrained((&mass, &gradients), [pull.as_slice(), left.as_slice()]);
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

/// The gradients of the coordinates of joints, whose rates are linear in those of the coordinates.
fn of_joints(model: &Model, instant: &mut Configuration, joints: &[(usize, f64)]) -> DMatrix<f64> {
    let n = model.coordinate_count();
    let mut all = DMatrix::zeros(n, joints.len());
    for i in 0..n {
        instant.l.fill(0.0);
        instant.l[i] = 1.0;
        for (k, &(joint, _)) in joints.iter().enumerate() {
            all[(i, k)] = model.joint_rate(joint, instant);
        }
    }
    all
}
