//! Prescribed joint coordinates: functions of time in the place of their equations of motion.
//!
//! A coordinate u = c(t) of a joint is no unknown: steps and programs have u_k = c(t_k), and the momentum balance of u gives the force or
//! torque that moves the joint.

use crate::coordinates::Configuration;
use crate::model::layout::internal::Internals;
use crate::model::model::Model;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::System;
use crate::model::system::joints::Prescribed;

/// Prescribed coordinates of a scene and its presolved system.
pub(crate) fn prescribed(
    scene: &System,
    presolved: &Presolved,
    internals: &Internals,
) -> Vec<Prescribed> {
    let joints = scene.joints.iter().enumerate();
    let moved = joints.filter_map(|(joint, named)| {
        let motion = named.motion.clone()?;
        let coordinate = internals.joint_coordinate(presolved.joint(joint)?)?;
        Some(Prescribed {
            coordinate,
            joint,
            motion,
        })
    });
    moved.collect()
}

impl Model {
    /// The coordinates that are prescribed.
    pub fn prescribed_coordinates(&self) -> Vec<usize> {
        self.prescribed.iter().map(|one| one.coordinate).collect()
    }

    /// A number for each joint of the scene: `of` of those that are prescribed, zero of others.
    pub fn of_prescribed_joints(&self, of: impl Fn(&Prescribed) -> f64) -> Vec<f64> {
        let mut joints = vec![0.0; self.joint_readings.len()];
        for one in &self.prescribed {
            joints[one.joint] = of(one);
        }
        joints
    }

    /// Returns true if coordinate `i` is prescribed.
    pub fn is_prescribed(&self, i: usize) -> bool {
        self.prescribed.iter().any(|one| one.coordinate == i)
    }

    /// Gives prescribed coordinates their values at a time in ms.
    pub fn prescribe(&self, time: f64, z: &mut [f64]) {
        for one in &self.prescribed {
            z[one.coordinate] = one.motion.at(time);
        }
    }

    /// Sets entries of prescribed coordinates to zero.
    pub fn hold(&self, values: &mut [f64]) {
        for one in &self.prescribed {
            values[one.coordinate] = 0.0;
        }
    }

    /// Gives prescribed coordinates their rates at a time in ms.
    pub fn prescribe_rates(&self, time: f64, rates: &mut [f64]) {
        for one in &self.prescribed {
            let [_, rate, _] = one.motion.derivatives(time);
            rates[one.coordinate] = rate;
        }
    }

    /// Rates of the coordinates at a time in ms, where nothing but what is prescribed moves in the joints of a placed instant; `None`
    /// where all of it rests.
    pub fn rates_at_rest(&self, time: f64, instant: &Configuration) -> Option<Vec<f64>> {
        let of_joints = self.of_prescribed_joints(|one| one.motion.derivatives(time)[1]);
        if of_joints.iter().all(|rate| *rate == 0.0) {
            return self.node_rates();
        }
        let joints = self.joints(instant, &vec![0.0; of_joints.len()]);
        let rates = self.rates_at(&joints, &of_joints, &Default::default());
        let rates = rates.expect("no body has a velocity of its own");
        Some(self.rates_of_all(&rates, &of_joints))
    }

    /// Coordinates of an instant in the reference configuration, but for those that are prescribed at a time in ms.
    pub fn reference_coordinates_at(&self, time: f64) -> Vec<f64> {
        self.coordinates_at(&self.of_prescribed_joints(|one| one.motion.at(time)))
    }
}
