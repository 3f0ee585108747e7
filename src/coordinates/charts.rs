//! Charts of whole configurations: moved to where bodies are, exchanged, taken from poses, put at means.

use crate::coordinates::configuration::Configuration;
use crate::coordinates::map::CoordinateMap;
use crate::coordinates::tree::{CHART, Tree};
use crate::kinematics::Pose;
use crate::math::Vector;

impl CoordinateMap {
    /// Coordinates that turn behind a chart.
    pub fn charted(&self) -> Vec<[usize; 3]> {
        self.tree.as_ref().map_or_else(Vec::new, Tree::charted)
    }

    /// Handedness of the axes of the turns behind each chart: 1 or −1.
    pub fn handedness(&self) -> Vec<f64> {
        self.tree.as_ref().map_or_else(Vec::new, Tree::handedness)
    }

    /// Moves the charts of a placed instant to where its bodies are: nothing moves, and the coordinates that turn behind a
    /// chart become zero. Returns true if there are charts.
    pub fn recentre(&self, instant: &mut Configuration) -> bool {
        let Some(tree) = self.tree.as_ref().filter(|tree| tree.charts() > 0) else {
            return false;
        };
        let (unknowns, charts) = instant.z.split_at_mut(self.unknowns());
        tree.recentre(unknowns, charts);
        self.place(instant);
        true
    }

    /// Writes the differences between two lists of coordinates with the same charts: of turns behind a chart the rotation vector, which over
    /// the time between is a smooth mean of the angular velocity.
    pub fn differences(&self, [from, to]: [&[f64]; 2], differences: &mut [f64]) {
        for (difference, (from, to)) in differences.iter_mut().zip(from.iter().zip(to)) {
            *difference = to - from;
        }
        if let Some(tree) = &self.tree {
            tree.rotations_between([from, to], differences);
        }
    }

    /// Moves unknowns by a step along a direction, where the turns behind charts are zero: they stay zero, and the charts turn about the
    /// rotation vectors of their parts of the direction.
    pub fn advance(&self, step: f64, direction: &[f64], unknowns: &mut [f64], charts: &mut [f64]) {
        for (value, change) in unknowns.iter_mut().zip(direction) {
            *value += step * change;
        }
        if let Some(tree) = &self.tree {
            tree.turn_charts(unknowns, charts);
        }
    }

    /// Place of the link that carries a body in the list of a tree, in which parents come first.
    pub fn place_in_tree(&self, body: usize) -> Option<usize> {
        self.tree.as_ref().map(|tree| tree.carrier(body))
    }

    /// Gives a body on a joint with a chart, with turns of zero, a velocity of its centre and an angular velocity by the rates of this joint,
    /// and updates the motion of all vectors; `false` where the body is on another joint.
    pub fn set_in_motion(
        &self,
        body: usize,
        twist: [Vector; 2],
        instant: &mut Configuration,
    ) -> bool {
        let Some(tree) = &self.tree else { return false };
        let is_set = tree.set_in_motion(body, twist, &instant.tree, &mut instant.l);
        self.along(instant);
        is_set
    }

    /// Returns true if the charts of a list of coordinates, multipliers and charts are quaternions of length one; lists of another length belong to
    /// other coordinates.
    pub fn has_unit_charts(&self, z: &[f64]) -> bool {
        let is_unit = |q: &[f64]| (q.iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-9;
        z.len() != self.unknowns() + CHART * self.charts()
            || z[self.unknowns()..].chunks(CHART).all(is_unit)
    }

    /// Takes over the charts of another list of coordinates, multipliers and charts: the configuration stays.
    pub fn take_charts(&self, other: &[f64], z: &mut [f64]) {
        let unknowns = self.unknowns();
        if let Some(tree) = &self.tree {
            let (u, charts) = z.split_at_mut(unknowns);
            tree.take_charts(&other[unknowns..], u, charts);
        }
    }

    /// Greatest angle in rad between a chart and the rotation of its joint.
    pub fn angle_from_charts(&self, z: &[f64]) -> f64 {
        self.tree
            .as_ref()
            .map_or(0.0, |tree| tree.angle_from_charts(z))
    }

    /// Lets the joints with a chart follow given poses of the bodies: their charts and slides, the turns behind them zero.
    pub fn follow(&self, poses: &[Pose], instant: &mut Configuration) {
        let unknowns = self.unknowns();
        if let Some(tree) = &self.tree {
            let (u, charts) = instant.z.split_at_mut(unknowns);
            tree.follow(poses, u, charts);
        }
        self.place(instant);
    }

    /// Puts the charts of a list of coordinates, multipliers and charts at the mean of others, by weights whose sum is one; the
    /// coordinates that turn behind them become zero, others stay.
    pub fn mean_of_charts(&self, parts: &[(f64, &[f64])], z: &mut [f64]) {
        let Some(tree) = self.tree.as_ref().filter(|tree| tree.charts() > 0) else {
            return;
        };
        let split = parts.iter().map(|&(weight, z)| {
            let (unknowns, charts) = z.split_at(self.unknowns());
            (weight, [unknowns, charts])
        });
        let parts: Vec<_> = split.collect();
        let (unknowns, charts) = z.split_at_mut(self.unknowns());
        tree.mean(&parts, unknowns, charts);
    }
}
