//! Start of a motion: at rest, with rates, momenta or velocities of bodies.

use crate::dynamics::momenta::{rates, vector_momenta};
use crate::kinematics::{Carrier, MaterialVector};
use crate::math::Vector;
use crate::model::Model;

/// Start of a motion: coordinates z and the momentum of each coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Momenta.
    pub momentum: Vec<f64>,
    /// Rates of the coordinates, where the momenta were made of them.
    pub rates: Option<Vec<f64>>,
    /// Time in ms to which prescribed motions have come.
    pub time: f64,
}

impl Start {
    /// At rest.
    pub fn at_rest(model: &Model, z: Vec<f64>) -> Self {
        Self {
            z,
            momentum: vec![0.0; model.coordinate_count()],
            rates: None,
            time: 0.0,
        }
    }

    /// With given rates of the coordinates.
    pub fn with_rates(model: &Model, z: Vec<f64>, rates: &[f64]) -> Self {
        let mut instant = model.action.map.instant();
        instant.z.copy_from_slice(&z);
        model.action.map.place(&mut instant);
        let momentum = model.action.momentum(&mut instant, rates);
        Self {
            z,
            momentum,
            rates: Some(rates.to_vec()),
            time: 0.0,
        }
    }

    /// With the momentum of each coordinate.
    pub fn moving(model: &Model, z: Vec<f64>, momentum: Vec<f64>) -> Self {
        let mut instant = model.action.map.placed(&z);
        let rates = rates(model, &mut instant, 0.0, &momentum);
        Self {
            z,
            momentum,
            rates: Some(rates),
            time: 0.0,
        }
    }

    /// With a velocity of the centre of mass (mm/ms) and an angular velocity (rad/ms), both in the ground frame, of each body that is solved for;
    /// nodes rest. What the coordinates do not let move counts as an impulse on its supports.
    pub fn with_velocities(model: &Model, z: Vec<f64>, velocities: &[[Vector; 2]]) -> Self {
        let map = &model.action.map;
        let instant = map.placed(&z);
        let poses = model.condensed_poses(&instant);
        let rate = |vector: &MaterialVector| {
            let terms = vector.terms.iter().map(|term| match term.carrier {
                Carrier::Body(b) => {
                    let [velocity, spin] = velocities[b];
                    velocity * term.centre + spin.cross(&(poses[b].directors * term.directors))
                }
                _ => Vector::zeros(),
            });
            terms.sum()
        };
        let rates: Vec<Vector> = model.vectors.iter().map(rate).collect();
        let momenta = vector_momenta(model, &instant.x, &rates);
        let mut momentum = vec![0.0; model.coordinate_count()];
        map.pull_back(&instant.columns, &momenta, &mut momentum);
        Self {
            z,
            momentum,
            rates: None,
            time: 0.0,
        }
    }
}
