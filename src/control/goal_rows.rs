//! Places and orientations of a goal or a waypoint as equations of one instant, without those that nothing can change.

use crate::control::error::BoundaryError;
use crate::control::goal::{Orientation, Place, Product};
use crate::control::limits::{Limits, When};
use crate::control::transcription::Site;
use crate::functional::Sample;
use crate::math::{Random, Vector};
use crate::model::{Coordinates, Model, Quantity, System, What};
use std::collections::BTreeMap;

const AXES: [&str; 3] = ["x", "y", "z"];
/// Configurations at which a gradient has to vanish.
const TRIALS: u64 = 3;
/// Distance of these from the start, in rad and lengths of the system.
const NEAR: f64 = 0.3;
/// A gradient of this size is rounding.
const ROUNDING: f64 = 1e-12;

/// Adds the equations of places of markers at a single instant, called `at` in messages.
pub(super) fn add_places(
    limits: &mut Limits,
    system: &System,
    places: &BTreeMap<usize, Place>,
    when: When,
    at: &str,
) {
    for (&marker, place) in places {
        let name = &system.markers[marker].name;
        let is_free = |axis: usize| !system.holds_marker(marker, axis);
        for (axis, value) in place.given().filter(|(axis, _)| is_free(*axis)) {
            let name = format!("{at} {} of marker {name}", AXES[axis]);
            let quantity = Quantity::marker_place(marker, axis);
            limits.add_at(when, quantity, [value; 2], name);
        }
    }
}

/// Adds the equations of the rest of markers at the goal.
pub(super) fn add_rest<'p>(
    limits: &mut Limits,
    system: &System,
    markers: impl Iterator<Item = &'p usize>,
) {
    for &marker in markers {
        let name = &system.markers[marker].name;
        for axis in (0..3).filter(|&axis| !system.holds_marker(marker, axis)) {
            let name = format!("rest at the goal, {} of marker {name}", AXES[axis]);
            let quantity = Quantity::step(What::Place { marker, axis }, 1.0);
            limits.add_at(When::Goal, quantity, [0.0; 2], name);
        }
    }
}

/// Adds the conditions of orientations of bodies at a single instant, called `at` in messages.
pub(super) fn add_orientations(
    limits: &mut Limits,
    system: &System,
    orientations: &BTreeMap<usize, Orientation>,
    when: When,
    at: &str,
) {
    for (&body, orientation) in orientations {
        let name = format!("{at} orientation of body {}", system.bodies[body].name);
        for Product {
            axis,
            along,
            is_acute,
        } in orientation.products()
        {
            let quantity = Quantity::of(What::Direction { body, axis, along });
            let upper = if is_acute { f64::INFINITY } else { 0.0 };
            limits.add_at(when, quantity, [0.0, upper], name.clone());
        }
    }
}

/// Leaves out directions at the goal that no joint coordinate changes, such as those across the plane of a plane robot: as
/// equations they would have no slope. A direction that is not kept by itself is refused.
///
/// # Errors
/// Nothing turns a direction to where the goal wants it.
pub(super) fn leave_out_constant(
    model: &mut Model,
    limits: &Limits,
    start: &[f64],
) -> Result<(), BoundaryError> {
    if model.coordinates != Coordinates::Reduced {
        return Ok(());
    }
    for (index, bounded) in limits.list.iter().enumerate() {
        let is_direction = matches!(bounded.quantity.what, What::Direction { .. });
        let Some(measure) = model.measured[index] else {
            continue;
        };
        if !bounded.when.is_single() || !is_direction || changes(model, measure, start) {
            continue;
        }
        let instant = model.action.map.placed(start);
        let measure = Site::Instants.measure(model, measure);
        let value = measure.value(&Sample::of_instant(&instant.x, &[]));
        if let Some(reason) = bounded.broken(value, &model.system) {
            let reason = format!("{reason}; no joint changes it");
            return Err(BoundaryError::refused("goal", reason));
        }
        model.measured[index] = None;
    }
    Ok(())
}

/// Returns true if coordinates change a quantity of the instants somewhere.
fn changes(model: &Model, measure: usize, start: &[f64]) -> bool {
    let map = &model.action.map;
    let measure = Site::Instants.measure(model, measure);
    let length = model.length();
    (0..TRIALS).any(|seed| {
        let mut random = Random::new(seed);
        let mut z = start.to_vec();
        for (i, value) in z[..map.of_bodies].iter_mut().enumerate() {
            let size = if model.is_length(i) { length } else { 1.0 };
            *value += random.between(-NEAR, NEAR) * size;
        }
        let mut instant = map.placed(&z);
        map.tangent(&mut instant);
        let zeros = || vec![Vector::zeros(); instant.x.len()];
        let (mut forces, mut rows) = ([zeros(), zeros()], Vec::new());
        measure.gradient(&Sample::of_instant(&instant.x, &[]), &mut forces, &mut rows);
        let mut slopes = vec![0.0; map.unknowns()];
        for vector in measure.vectors() {
            map.pull_back_one(vector, &instant.columns, &forces[0][vector], &mut slopes);
        }
        slopes.iter().any(|slope| slope.abs() > ROUNDING)
    })
}
