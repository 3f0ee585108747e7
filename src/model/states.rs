//! Coordinates and rates of states that are given by joints, poses and velocities of bodies.

use crate::coordinates::Configuration;
use crate::kinematics::Pose;
use crate::math::Vector;
use crate::model::analysis::Coordinates;
use crate::model::model::Model;
use std::collections::BTreeMap;
use std::ops::Range;

impl Model {
    /// Rates of director coordinates at joint coordinates with given rates.
    pub fn redundant_rates(&self, joints: &[f64], rates: &[f64]) -> Vec<f64> {
        let moving = self.moving(joints, rates, &BTreeMap::new());
        let instant = moving.expect("no body is named");
        instant.w.iter().flat_map(|w| [w.x, w.y, w.z]).collect()
    }

    /// Rates of the coordinates of the bodies at joint coordinates (by joint) with given rates, and velocities of the centre and
    /// of rotation of some bodies of the scene, both in the ground frame.
    ///
    /// # Errors
    /// The first of these bodies that is neither free nor on a spherical or floating joint: its motion follows from its joints.
    pub fn rates_at(
        &self,
        joints: &[f64],
        rates: &[f64],
        velocities: &BTreeMap<usize, [Vector; 2]>,
    ) -> Result<Vec<f64>, usize> {
        let instant = self.moving(joints, rates, velocities)?;
        Ok(match self.coordinates {
            Coordinates::Reduced => instant.l[..self.action.map.of_bodies].to_vec(),
            Coordinates::Redundant => instant.w.iter().flat_map(|w| [w.x, w.y, w.z]).collect(),
        })
    }

    /// Returns true if some body turns in ways that joint coordinates in files do not give: it is free, or on a spherical joint.
    pub fn turns_freely(&self) -> bool {
        let mut joints = self.presolved.system.joints.iter();
        !self.graph.free().is_empty() || joints.any(|joint| joint.kind.freedoms() > 1)
    }

    /// Coordinates of the body that carries a body of the scene, in directors; none of one that does not move.
    pub fn coordinates_of_body(&self, body: usize) -> Range<usize> {
        let carrier = self.presolved.carrier(Some(body));
        carrier.map_or(0..0, |b| 12 * b..12 * (b + 1))
    }

    /// Returns true if joints close loops of bodies.
    pub fn has_loops(&self) -> bool {
        !self.graph.loops().is_empty()
    }

    /// First coordinate and coordinates at poses of the joints of several coordinates without a chart.
    fn several(&self, poses: &[Pose]) -> Vec<(usize, Vec<f64>)> {
        let mut next = 0;
        let mut list = Vec::new();
        for joint in &self.presolved.system.joints {
            let values = joint.several(poses, &self.reference);
            list.extend(values.map(|values| (next, values)));
            next += joint.kind.freedoms();
        }
        list
    }

    /// The tree in motion, with the vectors φ, d₁, d₂, d₃ of all bodies.
    fn moving(
        &self,
        joints: &[f64],
        rates: &[f64],
        velocities: &BTreeMap<usize, [Vector; 2]>,
    ) -> Result<Configuration, usize> {
        let [joints, rates] = [joints, rates].map(|values| self.presolved.by_joint(values));
        let (motion, mut instant) =
            self.graph
                .moving(&self.presolved.system, &self.reference, &joints, &rates);
        // A body before those that it carries.
        let mut named: Vec<_> = velocities.iter().collect();
        named.sort_by_key(|&(&body, _)| {
            self.presolved
                .carrier(Some(body))
                .map(|b| motion.place_in_tree(b))
        });
        for (&body, &[velocity, spin]) in named {
            let poses = motion.poses(&instant, self.reference.len());
            let all = self.presolved.poses(&poses, &self.system.bodies);
            let kept = self.presolved.carrier(Some(body)).ok_or(body)?;
            let arm = poses[kept].centre - all[body].centre;
            let velocity = velocity + spin.cross(&arm);
            if !motion.set_in_motion(kept, [velocity, spin], &mut instant) {
                return Err(body);
            }
        }
        Ok(instant)
    }

    /// Coordinates of an instant at given poses of the bodies of the scene and joint coordinates (by joint), as these are known
    /// without whole turns; nodes at their reference places.
    pub fn coordinates_of_poses(&self, poses: &[Pose], joints: &[f64]) -> Vec<f64> {
        let z = self.coordinates_at(joints);
        if self
            .graph
            .has_one_coordinate_a_joint(&self.presolved.system)
        {
            return z;
        }
        let poses = self.presolved.condense(poses, &self.reference);
        let map = &self.action.map;
        match &map.tree {
            None => self.coordinates_of(&poses, joints),
            Some(_) => {
                let mut instant = map.placed(&z);
                map.follow(&poses, &mut instant);
                for (first, values) in self.several(&poses) {
                    instant.z[first..first + values.len()].copy_from_slice(&values);
                }
                map.place(&mut instant);
                self.place_internals(&mut instant.z, joints);
                instant.z
            }
        }
    }
}
