//! Lasting forces that an observer finds, and the inputs that hold the goal against them.
//!
//! Of forces f on coordinates, which inputs u change by F u where the goal is held, the inputs against them are those within their bounds with the
//! least `|F u + f|`, by a bounded number of sweeps of coordinate descent that begin at those of the last sample.

use nalgebra::DMatrix;

/// Sweeps over all inputs.
const SWEEPS: usize = 50;
/// Cost of an input relative to that of its forces: of inputs that do the same the smallest are found.
const SMALL: f64 = 1e-9;

/// A coordinate on which a lasting force acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Forced {
    /// Its name.
    pub name: String,
    /// True for a force in N, false for a torque in N mm.
    pub is_length: bool,
}

/// Lasting forces that an observer finds beside the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Lasting {
    /// Coordinates on which they act.
    pub on: Vec<Forced>,
    /// F, by force over the inputs, or their squares.
    pub by_inputs: DMatrix<f64>,
}

impl Lasting {
    /// Improves the changes of inputs at the held goal, within `limits`, that are `against` forces; `left` has room for one number a force.
    pub(super) fn hold(
        &self,
        forces: &[f64],
        limits: &[[f64; 2]],
        against: &mut [f64],
        left: &mut [f64],
    ) {
        for (row, left) in left.iter_mut().enumerate() {
            let held = against.iter().enumerate();
            *left = forces[row] + held.map(|(i, u)| self.by_inputs[(row, i)] * u).sum::<f64>();
        }
        for _ in 0..SWEEPS {
            for (i, u) in against.iter_mut().enumerate() {
                let of = self.by_inputs.column(i);
                let size = of.norm_squared() * (1.0 + SMALL);
                if size == 0.0 {
                    continue;
                }
                let slope: f64 = of.iter().zip(&*left).map(|(f, left)| f * left).sum();
                let slope = slope + SMALL * of.norm_squared() * *u;
                let [low, high] = limits[i];
                let change = (*u - slope / size).clamp(low, high) - *u;
                *u += change;
                let changed = left.iter_mut().zip(&of);
                changed.for_each(|(left, f)| *left += f * change);
            }
        }
    }
}
