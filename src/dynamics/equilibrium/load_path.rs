//! Equilibria along the path of growing voltages, past limit points.

use crate::dynamics::equilibrium::arc_length::{FIRST, LARGEST, PathPoint, Ramp, SMALLEST, path};
use crate::dynamics::equilibrium::rest_state::{Equilibrium, Instability, Load, Route};
use crate::dynamics::equilibrium::stable::stable_equilibrium;
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::error::EquilibriumError;
use crate::model::Model;
use crate::stop;

/// Equilibria along a path.
#[derive(Clone, Debug)]
pub struct Continuation {
    /// Fraction of the voltages at each point.
    pub fractions: Vec<f64>,
    /// The equilibria.
    pub points: Vec<Equilibrium>,
    /// Index of the last point before each loss of stability, the exact fraction there, and its kind.
    pub lost: Vec<(usize, f64, Instability)>,
    /// The equilibria there.
    pub limits: Vec<Equilibrium>,
}

/// Follows the path of equilibria from zero voltage by arc length for `steps` points, past limit points.
///
/// # Errors
/// There is no equilibrium without voltages, or nothing holds the system.
pub fn continuation(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
    steps: usize,
) -> Result<Continuation, EquilibriumError> {
    // At zero voltage nothing depends on the fraction to first order: the path starts a little further.
    let ramp = Ramp {
        load: Load::Voltages,
        voltages,
    };
    let mut statics = Statics::new(model, voltages);
    let beginning = ramp.apply(&mut statics, FIRST);
    let first = stable_equilibrium(model, start, &beginning)?;
    let [_, scalars] = model.variables.split(&first.scalars);
    let state = statics.state(&first.z, scalars);
    let mut path = path(&mut statics, ramp);
    let mut out = Continuation {
        fractions: vec![FIRST],
        points: vec![first],
        lost: Vec::new(),
        limits: Vec::new(),
    };
    let Some(mut here) = path.point(state, FIRST, None) else {
        return Ok(out);
    };
    let mut step = FIRST;
    while out.points.len() < steps {
        let Some(next) = path.advance(&here, step) else {
            step *= 0.5;
            if step < SMALLEST {
                break;
            }
            continue;
        };
        let index = out.points.len() - 1;
        let limit = path.lost(&here, step, &next);
        // A search that was stopped ends elsewhere than where stability is lost.
        if stop::reason().is_some() {
            break;
        }
        let mut rest = |point: &PathPoint| {
            let loaded = ramp.apply(path.statics, point.fraction);
            Equilibrium::on_path(path.statics, &point.state, &loaded, Route::Loads)
        };
        if let Some((point, kind)) = limit {
            out.limits.push(rest(&point));
            out.lost.push((index, point.fraction, kind));
        }
        out.points.push(rest(&next));
        out.fractions.push(next.fraction);
        here = next;
        step = (1.5 * step).min(LARGEST);
    }
    Ok(out)
}
