//! Motions that joints permit, and joint coordinates read from poses.

use crate::kinematics::{MaterialVector, Pose};
use crate::math::{Signal, Vector};
use crate::model::system::{Joint, JointKind, JointStops, System};

/// Two unit vectors that complete a unit vector n to a right-handed triad (a, b, n).
pub(crate) fn triad(n: &Vector) -> [Vector; 2] {
    let helper = if n.x.abs() < 0.6 {
        Vector::x()
    } else if n.y.abs() < 0.6 {
        Vector::y()
    } else {
        Vector::z()
    };
    let a = helper.cross(n).normalize();
    [a, n.cross(&a)]
}

/// An angle and as many whole turns as bring it nearest to another one.
pub fn nearest_turn(angle: f64, near: f64) -> f64 {
    use std::f64::consts::TAU;
    angle + ((near - angle) / TAU).round() * TAU
}

/// A joint coordinate whose value is prescribed.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescribed {
    /// The coordinate.
    pub coordinate: usize,
    /// Its joint of the scene.
    pub joint: usize,
    /// Its value in rad or mm.
    pub motion: Signal,
}

/// Reading of the coordinate of a joint from the poses of its bodies.
#[derive(Clone, Debug)]
pub struct JointReading {
    /// The coordinate of the model that is this one, of the tree or an internal one; `None` where poses alone tell it.
    pub coordinate: Option<usize>,
    /// Vectors a, b of the parent and c of the child, whose angle is the coordinate; or n, span for a displacement.
    measure: Option<JointCoordinate>,
}

/// Formula of the coordinate.
#[derive(Clone, Debug)]
pub(crate) enum JointCoordinate {
    /// atan2(b·c, a·c).
    Angle {
        /// a, b, c.
        vectors: [MaterialVector; 3],
    },
    /// n·r.
    Displacement {
        /// n, fixed in the parent.
        axis: MaterialVector,
        /// Span r from the parent to the child.
        span: MaterialVector,
    },
}

/// One degree of freedom of a joint, about or along a unit axis in the ground frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Screw {
    /// Rotation about the axis.
    Turn(Vector),
    /// Translation along the axis.
    Slide(Vector),
}

impl JointKind {
    /// Returns its screws from the parent outwards, and the number of screws in front of its chart, where they give any rotation.
    pub fn screws(&self) -> (Vec<Screw>, Option<usize>) {
        let axes = [Vector::x(), Vector::y(), Vector::z()];
        match *self {
            Self::Fixed => (Vec::new(), None),
            Self::Revolute { axis } => (vec![Screw::Turn(axis)], None),
            Self::Prismatic { axis } => (vec![Screw::Slide(axis)], None),
            Self::Universal { axes } => (axes.map(Screw::Turn).to_vec(), None),
            Self::Cylindrical { axis } => (vec![Screw::Slide(axis), Screw::Turn(axis)], None),
            Self::Planar { normal } => {
                let slides = triad(&normal).map(Screw::Slide).into_iter();
                (slides.chain([Screw::Turn(normal)]).collect(), None)
            }
            Self::Spherical => (axes.map(Screw::Turn).to_vec(), Some(0)),
            Self::Floating => {
                let slides = axes.map(Screw::Slide).into_iter();
                (slides.chain(axes.map(Screw::Turn)).collect(), Some(3))
            }
        }
    }

    /// The axes with which it is written.
    pub(crate) fn axes(&self) -> Vec<Vector> {
        match *self {
            Self::Revolute { axis } | Self::Prismatic { axis } | Self::Cylindrical { axis } => {
                vec![axis]
            }
            Self::Universal { axes } => axes.to_vec(),
            Self::Planar { normal } => vec![normal],
            Self::Spherical | Self::Floating | Self::Fixed => Vec::new(),
        }
    }

    /// Number of its coordinates.
    pub fn freedoms(&self) -> usize {
        self.screws().0.len()
    }
}

impl Joint {
    /// Returns true if it has one coordinate: revolute and prismatic joints do.
    pub fn has_coordinate(&self) -> bool {
        self.kind.freedoms() == 1
    }

    /// Names and units of the coordinates of a kind of several coordinates without a chart: `wrist_angle1`.
    pub fn several_names(&self) -> Vec<(String, &'static str)> {
        let parts: &[_] = match self.kind {
            JointKind::Universal { .. } => &[("angle1", "rad"), ("angle2", "rad")],
            JointKind::Cylindrical { .. } => &[("slide", "mm"), ("angle", "rad")],
            JointKind::Planar { .. } => &[("slide1", "mm"), ("slide2", "mm"), ("angle", "rad")],
            _ => &[],
        };
        let named = |&(part, unit)| (format!("{}_{part}", self.name), unit);
        parts.iter().map(named).collect()
    }

    /// Returns the effect of a unit force on each of its coordinates on the whole system, as a force and a torque about the origin: between
    /// two bodies nothing, from the ground the axis. Joints with several coordinates take no such force.
    pub fn pulls(&self) -> Vec<[Vector; 2]> {
        match (self.kind, self.parent) {
            (JointKind::Revolute { axis }, None) => vec![[Vector::zeros(), axis]],
            (JointKind::Prismatic { axis }, None) => vec![[axis, self.at.cross(&axis)]],
            (kind, _) => vec![[Vector::zeros(); 2]; kind.freedoms()],
        }
    }

    /// Returns true if it transmits a torque.
    pub fn has_torque(&self) -> bool {
        self.kind != JointKind::Spherical
    }

    /// Coordinates at poses of the bodies, for a kind of several coordinates without a chart: angles without whole turns.
    pub fn several(&self, poses: &[Pose], reference: &[Pose]) -> Option<Vec<f64>> {
        let pose = |poses: &[Pose], body: Option<usize>| body.map_or(Pose::GROUND, |b| poses[b]);
        // Rotations and places of both bodies relative to the reference configuration.
        let [p, c] = [self.parent, Some(self.child)].map(|body| {
            let (here, there) = (pose(poses, body), pose(reference, body));
            let turn = here.directors * there.directors.transpose();
            (turn, here.point(&there.local(&self.at)))
        });
        let turn = p.0.tr_mul(&c.0);
        let moved = p.0.tr_mul(&(c.1 - p.1));
        // Angle about an axis from one direction across it to another.
        let angle = |axis: &Vector, from: &Vector, to: Vector| {
            axis.cross(from).dot(&to).atan2(from.dot(&to))
        };
        let about = |axis: &Vector| {
            let [a, _] = triad(axis);
            angle(axis, &a, turn * a)
        };
        match self.kind {
            JointKind::Universal { axes: [a, b] } => Some(vec![
                angle(&a, &b, turn * b),
                -angle(&b, &a, turn.tr_mul(&a)),
            ]),
            JointKind::Cylindrical { axis } => Some(vec![axis.dot(&moved), about(&axis)]),
            JointKind::Planar { normal } => {
                let [a, b] = triad(&normal);
                Some(vec![a.dot(&moved), b.dot(&moved), about(&normal)])
            }
            _ => None,
        }
    }

    /// Returns true if a spring, stops or its prescribed motion take it out of the reference configuration.
    pub fn moves_by_itself(&self) -> bool {
        let presses = |stops: JointStops| stops.beyond(0.0) > -0.5 * stops.smoothing;
        let moves = |motion: &Signal| !motion.is_zero();
        self.spring.is_some_and(|spring| spring.rest != 0.0)
            || self.stops.is_some_and(presses)
            || self.motion.as_ref().is_some_and(moves)
    }
}

impl System {
    /// Index of the coordinate of each joint that has exactly one. The coordinates of the joints stand one joint after the other in the
    /// order of the scene; those of free bodies follow.
    pub fn joint_coordinates(&self) -> Vec<Option<usize>> {
        let mut next = 0;
        let index = |joint: &Joint| {
            let first = next;
            next += joint.kind.freedoms();
            joint.has_coordinate().then_some(first)
        };
        self.joints.iter().map(index).collect()
    }
}

impl JointCoordinate {
    /// That of a joint with exactly one.
    pub(crate) fn new(joint: &Joint, reference: &[Pose]) -> Option<Self> {
        let parent =
            |direction: &Vector| MaterialVector::direction(joint.parent, direction, reference);
        let child =
            |direction: &Vector| MaterialVector::direction(Some(joint.child), direction, reference);
        match joint.kind {
            JointKind::Revolute { axis } => {
                let [a, b] = triad(&axis);
                Some(Self::Angle {
                    vectors: [parent(&a), parent(&b), child(&a)],
                })
            }
            JointKind::Prismatic { axis } => Some(Self::Displacement {
                axis: parent(&axis),
                span: MaterialVector::span(
                    &MaterialVector::point(joint.parent, &joint.at, reference),
                    &MaterialVector::point(Some(joint.child), &joint.at, reference),
                ),
            }),
            _ => None,
        }
    }
}

impl JointReading {
    /// The reading of a joint of a system that is a coordinate of the model, or none.
    pub fn new(joint: &Joint, coordinate: Option<usize>, reference: &[Pose]) -> Self {
        Self {
            coordinate,
            measure: JointCoordinate::new(joint, reference),
        }
    }

    /// The coordinate at poses; an angle in the branch nearest to `near`; zero where there is none.
    pub fn read(&self, poses: &[Pose], near: f64) -> f64 {
        match &self.measure {
            Some(JointCoordinate::Angle { vectors }) => {
                let [a, b, c] = vectors.each_ref().map(|v| v.at(poses, &[]));
                nearest_turn(b.dot(&c).atan2(a.dot(&c)), near)
            }
            Some(JointCoordinate::Displacement { axis, span }) => {
                axis.at(poses, &[]).dot(&span.at(poses, &[]))
            }
            None => 0.0,
        }
    }
}
