//! Charts: rotations that a configuration carries as data, each before three turns.

use crate::coordinates::configuration::TreeState;
use crate::coordinates::tree::{CHART, Link, LinkKind, Tree};
use crate::kinematics::Pose;
use crate::math::{Matrix, Vector};
use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

/// A part of a mean: its weight, and the coordinates and charts of a configuration.
pub(in crate::coordinates) type Weighted<'a> = (f64, [&'a [f64]; 2]);

/// Most steps of the search for a nearest rotation, which goes on without end where round-off moves its last digit to and fro.
const SEARCH: usize = 100;

/// The rotation of a chart.
pub(super) fn rotation(chart: &[f64]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(chart[0], chart[1], chart[2], chart[3]))
}

/// Writes a rotation as a chart, the quaternion of length one.
pub(in crate::coordinates) fn write(mut rotation: UnitQuaternion<f64>, chart: &mut [f64]) {
    rotation.renormalize();
    let q = rotation.quaternion();
    chart.copy_from_slice(&[q.w, q.i, q.j, q.k]);
}

/// The rotation nearest to a matrix that is nearly one.
fn nearest_rotation(matrix: &Matrix) -> Rotation3<f64> {
    let near = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*matrix));
    let near = UnitQuaternion::new_normalize(near.into_inner()).to_rotation_matrix();
    Rotation3::from_matrix_eps(matrix, f64::EPSILON, SEARCH, near)
}

impl Link {
    /// Coordinate of a link that turns or slides.
    fn own_coordinate(&self) -> usize {
        self.coordinate.expect("a screw has a coordinate")
    }
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
        let turns = |links: &[Link]| [0, 1, 2].map(|i| links[i].own_coordinate());
        self.turns().map(turns).collect()
    }

    /// Handedness of the axes of the turns behind each chart.
    pub fn handedness(&self) -> Vec<f64> {
        let axes = |links: &[Link]| Matrix::from_columns(&[0, 1, 2].map(|i| links[i].axis));
        self.turns()
            .map(|links| axes(links).determinant().signum())
            .collect()
    }

    /// Puts the turns behind each chart into the chart: the configuration stays, these coordinates become zero.
    pub fn recentre(&self, u: &mut [f64], charts: &mut [f64]) {
        for (links, chart) in self.turns().zip(charts.chunks_exact_mut(CHART)) {
            write(turned(links, u, chart), chart);
            for link in links {
                u[link.own_coordinate()] = 0.0;
            }
        }
    }

    /// Replaces the differences of the turns behind each chart between two lists of coordinates by the rotation vector between them, by the
    /// axes of the turns.
    pub(in crate::coordinates) fn rotations_between(
        &self,
        [from, to]: [&[f64]; 2],
        differences: &mut [f64],
    ) {
        let none = [1.0, 0.0, 0.0, 0.0];
        for links in self.turns() {
            let between = turned(links, from, &none).inverse() * turned(links, to, &none);
            let vector = between.scaled_axis();
            for link in links {
                let coordinate = link.own_coordinate();
                differences[coordinate] = link.axis.dot(&vector);
            }
        }
    }

    /// Turns each chart by the rotation vector that stands in the place of the turns behind it, by their axes; these become zero.
    pub(in crate::coordinates) fn turn_charts(&self, u: &mut [f64], charts: &mut [f64]) {
        for (links, chart) in self.turns().zip(charts.chunks_exact_mut(CHART)) {
            let mut vector = Vector::zeros();
            for link in links {
                let coordinate = link.own_coordinate();
                vector += std::mem::take(&mut u[coordinate]) * link.axis;
            }
            write(
                rotation(chart) * UnitQuaternion::from_scaled_axis(vector),
                chart,
            );
        }
    }

    /// Takes over other charts: the turns behind them are chosen such that the configuration stays.
    pub(in crate::coordinates) fn take_charts(
        &self,
        other: &[f64],
        u: &mut [f64],
        charts: &mut [f64],
    ) {
        let pairs = charts
            .chunks_exact_mut(CHART)
            .zip(other.chunks_exact(CHART));
        for (links, (chart, other)) in self.turns().zip(pairs).filter(|(_, (a, b))| a != b) {
            let left = rotation(other).inverse() * turned(links, u, chart);
            // Cardan angles about the axes of the links, which may be a left-handed triad.
            let axes = Matrix::from_columns(&[links[0].axis, links[1].axis, links[2].axis]);
            let r = axes.tr_mul(left.to_rotation_matrix().matrix()) * axes;
            let angles = [
                (-r[(1, 2)]).atan2(r[(2, 2)]),
                r[(0, 2)].clamp(-1.0, 1.0).asin(),
                (-r[(0, 1)]).atan2(r[(0, 0)]),
            ];
            let sign = axes.determinant().signum();
            for (link, angle) in links.iter().zip(angles) {
                u[link.own_coordinate()] = sign * angle;
            }
            chart.copy_from_slice(other);
        }
    }

    /// Greatest angle in rad between a chart and the rotation of its joint.
    pub fn angle_from_charts(&self, u: &[f64]) -> f64 {
        let none = [1.0, 0.0, 0.0, 0.0];
        self.turns()
            .map(|links| turned(links, u, &none).angle())
            .fold(0.0, f64::max)
    }

    /// Writes the charts and slides of the joints with a chart such that bodies have given poses, and their turns as zero.
    pub(in crate::coordinates) fn follow(&self, poses: &[Pose], u: &mut [f64], charts: &mut [f64]) {
        for (&first, chart) in self.charts.iter().zip(charts.chunks_exact_mut(CHART)) {
            let last = &self.links[first + 2];
            let root = self.root(first);
            let link = &self.links[root];
            let parent = link.parent.map_or(Pose::GROUND, |b| poses[b]);
            let child = &poses[last.child];
            let turned = parent.directors.tr_mul(&child.directors) * last.directors.transpose();
            let rotation = nearest_rotation(&turned);
            write(UnitQuaternion::from_rotation_matrix(&rotation), chart);
            let point = child.centre - parent.directors * (rotation * last.centre);
            let moved = parent.local(&point) - link.point;
            for slide in root..first {
                u[self.links[slide].own_coordinate()] = self.links[slide].axis.dot(&moved);
            }
            for turn in first..first + 3 {
                u[self.links[turn].own_coordinate()] = 0.0;
            }
        }
    }

    /// Writes the rates of the joint of a body, where it has a chart and turns of zero, such that the body has a velocity of its centre and an
    /// angular velocity.
    pub(in crate::coordinates) fn set_in_motion(
        &self,
        body: usize,
        [velocity, spin]: [Vector; 2],
        state: &TreeState,
        l: &mut [f64],
    ) -> bool {
        let last = self.carrier[body];
        let Some(&first) = self.charts.iter().find(|&&first| first + 2 == last) else {
            return false;
        };
        let root = self.root(first);
        let twist = self.links[root].parent.map(|b| state.twists[b]);
        let [omega, origin] = twist.unwrap_or_default();
        // The point of the joint as a point of the body, next to the same point of the parent.
        let point = state.points[first];
        let passes = velocity + spin.cross(&(point - state.poses[body].centre));
        let passes = passes - (origin + omega.cross(&point));
        for j in root..=last {
            let apart = if j < first { passes } else { spin - omega };
            l[self.links[j].own_coordinate()] = state.axes[j].dot(&apart);
        }
        true
    }

    /// The first link of the joint whose chart stands before link `first`: slides come before the chart.
    fn root(&self, first: usize) -> usize {
        let is_between = |j: &usize| {
            self.links[*j].kind == LinkKind::Slide
                && self.links[*j].child == self.links[j + 1].parent.unwrap_or(usize::MAX)
                && self.links[*j].child >= self.bodies
        };
        (0..first)
            .rev()
            .take_while(is_between)
            .last()
            .unwrap_or(first)
    }

    /// Puts the charts at the mean of the rotations of other configurations, by weights whose sum is one, and their turns to
    /// zero; a configuration that has all of the weight keeps both as they are.
    pub(in crate::coordinates) fn mean(
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
                u[link.own_coordinate()] = 0.0;
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
