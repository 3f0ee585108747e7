//! Where bodies and vectors are at joint coordinates, and how they move with them.

use crate::coordinates::configuration::{Configuration, TreeState};
use crate::coordinates::tree::charts::rotation;
use crate::coordinates::tree::{CHART, Column, LinkKind, Tree};
use crate::kinematics::Pose;
use crate::math::Vector;
use nalgebra::{Rotation3, Unit};

impl Tree {
    /// Poses of all frames at joint coordinates u before charts, from root to leaves.
    pub fn place(&self, u: &[f64], charts: &[f64], state: &mut TreeState) {
        for (j, link) in self.links.iter().enumerate() {
            let mut parent = link.parent.map_or(Pose::GROUND, |b| state.poses[b]);
            let point = parent.point(&link.point);
            if let Some(chart) = link.chart {
                parent.directors *= rotation(&charts[CHART * chart..]).to_rotation_matrix();
            }
            let axis = parent.directors * link.axis;
            let value = link.coordinate.map_or(0.0, |c| u[c]);
            let mut pose = Pose {
                centre: point + parent.directors * link.centre,
                directors: parent.directors * link.directors,
            };
            match link.kind {
                LinkKind::Turn => {
                    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(link.axis), value);
                    let turned = parent.directors * turn.matrix();
                    pose.centre = point + turned * link.centre;
                    pose.directors = turned * link.directors;
                }
                LinkKind::Slide => pose.centre += axis * value,
                LinkKind::Fixed => {}
            }
            state.axes[j] = axis;
            state.points[j] = point;
            state.poses[link.child] = pose;
        }
    }

    /// Values of all vectors at the poses.
    pub fn vectors(&self, state: &mut TreeState, x: &mut [Vector]) {
        x.copy_from_slice(&self.constants);
        for (term, value) in self.terms.iter().zip(&mut state.terms) {
            let pose = &state.poses[term.body];
            *value = pose.centre * term.centre + pose.directors * term.directors;
            x[term.vector] += *value;
        }
    }

    /// Columns of P.
    pub fn tangent(&self, state: &mut TreeState, columns: &mut [f64]) {
        for (arm, value) in self.moved_parts.iter().zip(&mut state.arms) {
            *value = sum(&state.terms[arm.first..arm.first + arm.count]);
        }
        for column in &self.columns {
            let axis = state.axes[column.link];
            let centre = self.moved_parts[column.arm].centre;
            let value = match self.links[column.link].kind {
                LinkKind::Turn => {
                    axis.cross(&(state.arms[column.arm] - state.points[column.link] * centre))
                }
                _ => axis * centre,
            };
            column.store(&value, columns);
        }
    }

    /// Twists along l, derivatives of axes, points and columns along l, and w = P l.
    pub fn along(&self, instant: &mut Configuration) {
        let Configuration {
            l,
            w,
            columns_l,
            tree,
            ..
        } = instant;
        for (j, link) in self.links.iter().enumerate() {
            let [omega, origin] = link.parent.map_or([Vector::zeros(); 2], |b| tree.twists[b]);
            let (axis, point) = (tree.axes[j], tree.points[j]);
            tree.axes_l[j] = omega.cross(&axis);
            tree.points_l[j] = origin + omega.cross(&point);
            let rate = link.coordinate.map_or(0.0, |c| l[c]);
            tree.twists[link.child] = match link.kind {
                LinkKind::Turn => [omega + axis * rate, origin + point.cross(&axis) * rate],
                LinkKind::Slide => [omega, origin + axis * rate],
                LinkKind::Fixed => [omega, origin],
            };
        }
        w.fill(Vector::zeros());
        for ((term, value), rate) in self.terms.iter().zip(&tree.terms).zip(&mut tree.terms_l) {
            let [omega, origin] = tree.twists[term.body];
            *rate = origin * term.centre + omega.cross(value);
            w[term.vector] += *rate;
        }
        for (arm, rate) in self.moved_parts.iter().zip(&mut tree.arms_l) {
            *rate = sum(&tree.terms_l[arm.first..arm.first + arm.count]);
        }
        for column in &self.columns {
            let (j, arm) = (column.link, column.arm);
            let centre = self.moved_parts[arm].centre;
            let value = match self.links[j].kind {
                LinkKind::Turn => {
                    let reach = tree.arms[arm] - tree.points[j] * centre;
                    let reach_l = tree.arms_l[arm] - tree.points_l[j] * centre;
                    tree.axes_l[j].cross(&reach) + tree.axes[j].cross(&reach_l)
                }
                _ => tree.axes_l[j] * centre,
            };
            column.store(&value, columns_l);
        }
    }
}

#[inline]
fn sum(vectors: &[Vector]) -> Vector {
    vectors[1..].iter().fold(vectors[0], |sum, v| sum + v)
}

impl Column {
    #[inline]
    fn store(&self, value: &Vector, columns: &mut [f64]) {
        columns[self.place] = value.x;
        columns[self.place + self.stride] = value.y;
        columns[self.place + 2 * self.stride] = value.z;
    }
}
