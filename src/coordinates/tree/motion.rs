//! Positions of bodies and vectors at joint coordinates, and their derivatives by these.

use crate::coordinates::configuration::{Configuration, TreeState};
use crate::coordinates::tree::charts::rotation;
use crate::coordinates::tree::{CHART, LinkKind, Tree};
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
            state.screws[j] = match link.kind {
                LinkKind::Turn => [axis, point.cross(&axis)],
                _ => [Vector::zeros(), axis],
            };
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

    /// Columns of P: `ω_j × v + c ν_j` for the screw (ω_j, ν_j) of a link and the part v of a vector that it moves, with c centres.
    pub fn tangent(&self, state: &mut TreeState, columns: &mut [f64]) {
        for (arm, value) in self.moved_parts.iter().zip(&mut state.arms) {
            *value = sum(&state.terms[arm.first..arm.first + arm.count]);
        }
        self.each_column(columns, |link, arm, centre| {
            let [angular, linear] = &state.screws[link];
            angular.cross(&state.arms[arm]) + linear * centre
        });
    }

    /// Writes the columns of all vectors, each made of its link, the part that moves, and the centres in this part.
    #[inline(always)]
    fn each_column(&self, columns: &mut [f64], value: impl Fn(usize, usize, f64) -> Vector) {
        let mut others = self.columns.as_slice();
        for packed in &self.packed {
            let own = others.split_off(..packed.of_tree).unwrap_or_default();
            let rows = &mut columns[packed.first..packed.first + 3 * packed.stride];
            let (x, rest) = rows.split_at_mut(packed.stride);
            let (y, z) = rest.split_at_mut(packed.stride);
            for (column, (x, (y, z))) in own.iter().zip(x.iter_mut().zip(y.iter_mut().zip(z))) {
                let (link, arm) = (column.link as usize, column.arm as usize);
                [*x, *y, *z] = value(link, arm, column.centre).into();
            }
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
            let [angular, linear] = tree.screws[j];
            tree.screws_l[j] = [
                omega.cross(&angular),
                omega.cross(&linear) + origin.cross(&angular),
            ];
            let rate = link.coordinate.map_or(0.0, |c| l[c]);
            tree.twists[link.child] = [omega + angular * rate, origin + linear * rate];
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
        self.each_column(columns_l, |link, arm, centre| {
            let ([angular, _], [angular_l, linear_l]) = (&tree.screws[link], &tree.screws_l[link]);
            angular_l.cross(&tree.arms[arm]) + angular.cross(&tree.arms_l[arm]) + linear_l * centre
        });
    }
}

#[inline]
fn sum(vectors: &[Vector]) -> Vector {
    vectors[1..].iter().fold(vectors[0], |sum, v| sum + v)
}
