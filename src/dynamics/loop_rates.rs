//! Rates of a system with closed loops: those that a state names, completed so that no loop opens.
//!
//! With v₀ the rates at which all joints of the tree rest but those that are named, v has the least
//!
//! ```text
//! ½ (v − v₀)ᵀ M (v − v₀)     with  Gᵀ v = 0,   Jᵀ v = r
//! ```
//!
//! of the gradients G of the constraints and J of the joint coordinates with the named rates r.

use crate::coordinates::Configuration;
use crate::dynamics::kinetic::{Kinetic, constrained};
use crate::model::{Model, Role};
use nalgebra::{DMatrix, DVector};

/// Part of the product of a gradient and the rates that a constraint may change by.
const OPEN: f64 = 1e-9;
/// Corrections of the rates, each with the square of the digits of the one before.
const CORRECTIONS: usize = 3;

/// Rates v of the coordinates at coordinates `z`, completed from v₀ and the rates of joints that are `named`.
///
/// # Errors
/// The name of the constraint that the named rates violate most.
pub fn rates_in_loops(
    model: &Model,
    z: &[f64],
    rates: Vec<f64>,
    named: &[(usize, f64)],
) -> Result<Vec<f64>, String> {
    let mut all = rates.iter().chain(named.iter().map(|(_, rate)| rate));
    if !model.has_loops() || all.all(|rate| *rate == 0.0) {
        return Ok(rates);
    }
    let mut instant = model.action.map.placed(z);
    let Some((mass, of_constraints)) = Kinetic::new(model).dense_at(&mut instant) else {
        return Ok(rates);
    };
    let gradients = with_joints(model, &mut instant, &of_constraints, named);
    let given = DVector::from_vec(rates);
    let mut wanted = -gradients.tr_mul(&given);
    let of_joints = of_constraints.ncols()..;
    for (k, (_, rate)) in of_joints.zip(named) {
        wanted[k] += rate;
    }
    for (k, column) in gradients.column_iter().enumerate() {
        wanted[k] /= size(column.norm());
    }
    let unit = DMatrix::from_fn(gradients.nrows(), gradients.ncols(), |i, k| {
        gradients[(i, k)] / size(gradients.column(k).norm())
    });
    let mut added = DVector::<f64>::zeros(given.len());
    for _ in 0..CORRECTIONS {
        let left = &wanted - unit.tr_mul(&added);
        let pull = -(&mass * &added);
        let step = constrained((&mass, &unit), [pull.as_slice(), left.as_slice()]);
        added += DVector::from_vec(step);
    }
    let left = &wanted - unit.tr_mul(&added);
    let found = &given + added;
    let worst = left.iamax();
    if left[worst].abs() <= OPEN * found.amax() {
        return Ok(found.as_slice().to_vec());
    }
    let multipliers = model.variables.with(Role::Multiplier);
    Err(match multipliers.get(worst) {
        Some(constraint) => constraint.name.clone(),
        None => {
            let (joint, _) = named[worst - of_constraints.ncols()];
            model.system.joints[joint].name.clone()
        }
    })
}

/// A length to divide by.
fn size(norm: f64) -> f64 {
    if norm > 0.0 { norm } else { 1.0 }
}

/// The gradients of the constraints, then those of the coordinates of joints, which are linear in the rates.
fn with_joints(
    model: &Model,
    instant: &mut Configuration,
    of_constraints: &DMatrix<f64>,
    joints: &[(usize, f64)],
) -> DMatrix<f64> {
    let (n, count) = of_constraints.shape();
    let mut all = of_constraints
        .clone()
        .insert_columns(count, joints.len(), 0.0);
    for i in 0..n {
        instant.l.fill(0.0);
        instant.l[i] = 1.0;
        for (k, &(joint, _)) in joints.iter().enumerate() {
            all[(i, count + k)] = model.joint_rate(joint, instant);
        }
    }
    all
}
