//! Charts: rotations that a configuration carries as data, each before three turns.

use crate::kinematics::Pose;
use crate::reduction::tree::{CHART, Link, Tree};
use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

/// A part of a mean: its weight, and the coordinates and charts of a configuration.
pub(in crate::reduction) type Weighted<'a> = (f64, [&'a [f64]; 2]);

/// The rotation of a chart.
pub(super) fn rotation(chart: &[f64]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(chart[0], chart[1], chart[2], chart[3]))
}

/// Writes a rotation as a chart, the quaternion of length one.
pub(in crate::reduction) fn write(mut rotation: UnitQuaternion<f64>, chart: &mut [f64]) {
    rotation.renormalize();
    let q = rotation.quaternion();
    chart.copy_from_slice(&[q.w, q.i, q.j, q.k]);
}

impl Tree {
    /// The three turns behind each chart.
    fn turns(&self) -> impl Iterator<Item = &[Link]> {
        self.charts
            .iter()
            .map(|&first| &self.links[first..first + 3])
    }

    /// Coordinates of the three turns behind each chart.
    pub fn charted(&self) -> Vec<[usize; 3]> {
        let turn = |link: &Link| link.coordinate.expect("a turn has a coordinate");
        let turns = |links: &[Link]| [turn(&links[0]), turn(&links[1]), turn(&links[2])];
        self.turns().map(turns).collect()
    }

    /// Puts the turns behind each chart into the chart: the configuration stays, these coordinates become zero.
    pub fn recentre(&self, u: &mut [f64], charts: &mut [f64]) {
        for (links, chart) in self.turns().zip(charts.chunks_exact_mut(CHART)) {
            write(turned(links, u, chart), chart);
            for link in links {
                u[link.coordinate.expect("a turn has a coordinate")] = 0.0;
            }
        }
    }

    /// Writes the charts and slides of the joints with a chart such that bodies have given poses, and their turns as zero.
    pub(in crate::reduction) fn follow(&self, poses: &[Pose], u: &mut [f64], charts: &mut [f64]) {
        let before = |j: usize| self.before[j].map(|i| (i, self.links[i].child >= poses.len()));
        for (&first, chart) in self.charts.iter().zip(charts.chunks_exact_mut(CHART)) {
            let last = &self.links[first + 2];
            // The links of the joint before its chart are slides.
            let mut root = first;
            while let Some((before, true)) = before(root) {
                root = before;
            }
            let link = &self.links[root];
            let parent = link.parent.map_or(Pose::GROUND, |b| poses[b]);
            let child = &poses[last.child];
            let turned = parent.directors.tr_mul(&child.directors) * last.directors.transpose();
            let rotation = Rotation3::from_matrix(&turned);
            write(UnitQuaternion::from_rotation_matrix(&rotation), chart);
            let point = child.centre - parent.directors * (rotation * last.centre);
            let moved = parent.local(&point) - link.point;
            for slide in &self.links[root..first] {
                u[slide.coordinate.expect("a slide has a coordinate")] = slide.axis.dot(&moved);
            }
            for turn in &self.links[first..first + 3] {
                u[turn.coordinate.expect("a turn has a coordinate")] = 0.0;
            }
        }
    }

    /// Puts the charts at the mean of the rotations of other configurations, by weights whose sum is one, and their turns to
    /// zero; a configuration that has all of the weight keeps both as they are.
    pub(in crate::reduction) fn mean(
        &self,
        parts: &[Weighted<'_>],
        u: &mut [f64],
        charts: &mut [f64],
    ) {
        let Some((weight, [_, most])) = parts.iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        else {
            return;
        };
        if *weight == 1.0 {
            charts.copy_from_slice(most);
            return;
        }
        for (c, (links, chart)) in self.turns().zip(charts.chunks_exact_mut(CHART)).enumerate() {
            let of = |[u, charts]: [&[f64]; 2]| turned(links, u, &charts[CHART * c..]);
            // Rotation vectors from the configuration with the greatest weight.
            let near = parts
                .iter()
                .find(|(w, _)| w == weight)
                .map(|&(_, part)| of(part));
            let near = near.unwrap_or_default();
            let away = parts
                .iter()
                .map(|&(w, part)| (near.inverse() * of(part)).scaled_axis() * w);
            let mean = away.sum::<Vector3<f64>>();
            write(near * UnitQuaternion::from_scaled_axis(mean), chart);
            for link in links {
                u[link.coordinate.expect("a turn has a coordinate")] = 0.0;
            }
        }
    }
}

/// The rotation of a chart and of the turns behind it.
fn turned(links: &[Link], u: &[f64], chart: &[f64]) -> UnitQuaternion<f64> {
    let turn = |link: &Link| {
        let value = link.coordinate.map_or(0.0, |c| u[c]);
        UnitQuaternion::from_axis_angle(&Unit::new_unchecked(link.axis), value)
    };
    links
        .iter()
        .fold(rotation(chart), |sum, link| sum * turn(link))
}
