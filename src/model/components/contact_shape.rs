//! Shapes that touch: all that lies within a radius of a core, which is a point, a segment or a box.

use crate::energy::Cores;
use crate::math::{Fault, Key, not_negative, refuse};
use crate::model::system::bodies::Attachment;
use crate::model::system::joints::triad;
use nalgebra::Vector3;

/// A point, sphere, capsule or box with round edges of a body or of the ground, or a node of an elastic block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactShape {
    /// Its centre, on no body where it is a node.
    pub centre: Attachment,
    /// An elastic block and its node that is the centre.
    pub node: Option<[usize; 2]>,
    /// Radius in mm of all that is round; zero of a point and of a box with sharp edges.
    pub radius: f64,
    /// Half axes of the core in mm in the reference configuration, at right angles; zero where there are fewer.
    pub axes: [Vector3<f64>; 3],
}

/// A core that is no point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Core {
    /// Half lengths in mm of its axes: one of a segment, three of a box, of which one may be zero.
    pub(super) half_lengths: Vec<f64>,
    /// Unit vectors at right angles, along the axes first.
    pub(super) directions: [Vector3<f64>; 3],
}

/// Greatest cosine of axes at right angles.
const SQUARE: f64 = 1e-9;

impl ContactShape {
    /// The axes that have a length.
    fn own_axes(&self) -> Vec<Vector3<f64>> {
        let axes = self.axes.into_iter();
        axes.filter(|axis| *axis != Vector3::zeros()).collect()
    }

    /// Its core; none of a point.
    pub(super) fn core(&self) -> Option<Core> {
        let axes = self.own_axes();
        let mut half_lengths: Vec<f64> = axes.iter().map(Vector3::norm).collect();
        let units: Vec<Vector3<f64>> = axes.iter().map(Vector3::normalize).collect();
        match units[..] {
            [] => None,
            [axis] => {
                let [first, second] = triad(&axis);
                Some(Core {
                    half_lengths,
                    directions: [axis, first, second],
                })
            }
            [a, b, ..] => {
                // A plate is a box.
                half_lengths.resize(3, 0.0);
                let third = units.get(2).copied().unwrap_or(a.cross(&b));
                Some(Core {
                    half_lengths,
                    directions: [a, b, third],
                })
            }
        }
    }

    /// Two shapes, a node or else that with fewer axes first, which is the round side.
    pub fn by_axes(mut shapes: [Self; 2]) -> [Self; 2] {
        shapes.sort_by_key(|shape| (shape.node.is_none(), shape.own_axes().len()));
        shapes
    }

    /// The spheres at the ends of a capsule or the corners of a box, which it stands on where it touches a plane; of a sphere itself.
    pub fn corners(&self) -> Vec<Self> {
        let mut corners = vec![self.centre.at];
        for axis in self.own_axes() {
            let both = |at: Vector3<f64>| [at - axis, at + axis];
            corners = corners.into_iter().flat_map(both).collect();
        }
        let corner = |at: Vector3<f64>| Self {
            centre: Attachment { at, ..self.centre },
            axes: Default::default(),
            ..*self
        };
        corners.into_iter().map(corner).collect()
    }

    /// Checks the radius and the axes of the shape under a key.
    pub(super) fn check(&self, key: &'static str) -> Result<(), Fault> {
        not_negative(format!("{key}.radius"), self.radius)?;
        let axes = self.own_axes();
        refuse!(if self.node.is_some() && (!axes.is_empty() || self.centre.body.is_some()), Key(key);
            found "a node with axes or a body", expected "a point or a sphere about the node");
        let lengths = axes.iter().map(Vector3::norm);
        refuse!(unless lengths.clone().all(f64::is_finite), Key(key);
            found "an axis of no finite length", expected "finite axes");
        let cosine = |a: &Vector3<f64>, b: &Vector3<f64>| a.normalize().dot(&b.normalize()).abs();
        let pairs = (1..axes.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let mut pairs = pairs.map(|[i, j]| cosine(&axes[i], &axes[j]));
        refuse!(unless pairs.all(|cosine| cosine < SQUARE), Key(key);
            found "axes that are not at right angles", expected "axes of a box at right angles");
        Ok(())
    }

    /// Points of a line that shows it, about its centre: three great circles of a sphere, lines along a capsule, edges of a box.
    pub(super) fn outline(&self) -> Vec<Vector3<f64>> {
        match self.core() {
            None => circles(self.radius),
            Some(Core {
                half_lengths,
                directions: [axis, first, second],
            }) if half_lengths.len() == 1 => {
                let half = axis * half_lengths[0];
                let profile = |across: Vector3<f64>| {
                    let cap = |sign: f64| {
                        (0..=SEGMENTS / 2).map(move |k| {
                            let angle = std::f64::consts::TAU * k as f64 / SEGMENTS as f64;
                            let round = across * angle.cos() + axis * (angle.sin());
                            (half + round * self.radius) * sign
                        })
                    };
                    let start = half + across * self.radius;
                    cap(1.0).chain(cap(-1.0)).chain([start])
                };
                let turned = (0..=SEGMENTS / 4).map(|k| {
                    let angle = std::f64::consts::TAU * k as f64 / SEGMENTS as f64;
                    half + (first * angle.cos() + second * angle.sin()) * self.radius
                });
                profile(first)
                    .chain(turned)
                    .chain(profile(second))
                    .collect()
            }
            Some(core) => {
                let half = |k: usize| core.directions[k] * (core.half_lengths[k] + self.radius);
                let corner = |signs: &[f64; 3]| {
                    let sides = (0..3).map(|k| half(k) * signs[k]);
                    sides.sum()
                };
                EDGES.iter().map(corner).collect()
            }
        }
    }
}

/// Cores of a round shape and another one at the distance of both in touch; none of points. An axis of the round shape meets those of another one.
pub(super) fn cores([round, other]: [&Option<Core>; 2], distance: f64) -> Option<Cores> {
    let other = &other.as_ref()?.half_lengths;
    let round = round.as_ref().map(|core| core.half_lengths[0]);
    Some(Cores::new(round, other, distance))
}

/// Corners of a box along all its edges in one line.
const EDGES: [[f64; 3]; 16] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, 1.0, 1.0],
    [-1.0, -1.0, 1.0],
];

/// Segments of a circle of an outline.
const SEGMENTS: usize = 24;

/// Three great circles about the axes in one line, a quarter of the first one twice.
fn circles(radius: f64) -> Vec<Vector3<f64>> {
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let arc = move |[a, b]: [Vector3<f64>; 2], quarters: usize| {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / SEGMENTS as f64;
        let at = move |k: usize| (a * angle(k).cos() + b * angle(k).sin()) * radius;
        (0..=quarters * SEGMENTS / 4).map(at)
    };
    arc([x, z], 4)
        .chain(arc([x, y], 5))
        .chain(arc([y, z], 4))
        .collect()
}
