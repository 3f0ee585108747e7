//! Constraints of a joint: constant products of material vectors, and points that coincide.

use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::system::joints::triad;
use crate::model::system::{Joint, JointKind};

/// A constraint `a·b = 0` of two material vectors.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Product {
    /// Name of its multiplier.
    pub(crate) name: String,
    /// The vectors a and b.
    pub(crate) vectors: [MaterialVector; 2],
}

impl Product {
    /// a·b at poses; of points relative to a length in mm.
    pub(crate) fn at(&self, poses: &[Pose], length: f64) -> f64 {
        let [a, b] = self.vectors.each_ref().map(|v| v.at(poses, &[]));
        a.dot(&b) / self.size(length)
    }

    /// Typical size of a·b: the length of the system where b is a distance of points, 1 where both are directions.
    pub(crate) fn size(&self, length: f64) -> f64 {
        let mut terms = self.vectors[1].terms.iter();
        match terms.any(|term| term.centre != 0.0) {
            true => length,
            false => 1.0,
        }
    }
}

/// The constraints of a joint in the reference poses of the bodies.
pub(crate) struct JointConstraints<'a> {
    joint: &'a Joint,
    reference: &'a [Pose],
    /// Constant products, in the order of the multipliers.
    pub(crate) products: Vec<Product>,
    /// The distance that vanishes, where points of both bodies coincide; its multipliers follow.
    pub(crate) point: Option<MaterialVector>,
}

impl<'a> JointConstraints<'a> {
    /// Those of a joint.
    pub(crate) fn new(joint: &'a Joint, reference: &'a [Pose]) -> Self {
        let mut made = Self {
            joint,
            reference,
            products: Vec::new(),
            point: None,
        };
        match joint.kind {
            JointKind::Floating => {}
            JointKind::Spherical => made.point = Some(made.span()),
            JointKind::Fixed => {
                made.all_directions();
                made.point = Some(made.span());
            }
            JointKind::Revolute { axis } => {
                made.axis(&axis);
                made.point = Some(made.span());
            }
            JointKind::Universal { axes: [a, b] } => {
                made.add("axes", made.parent(&a), made.child(&b));
                made.point = Some(made.span());
            }
            JointKind::Cylindrical { axis } => {
                made.axis(&axis);
                made.offsets(&triad(&axis));
            }
            JointKind::Planar { normal } => {
                made.axis(&normal);
                made.offsets(&[normal]);
            }
            JointKind::Prismatic { axis } => {
                made.all_directions();
                made.offsets(&triad(&axis));
            }
        }
        made
    }

    /// The same constraints as products alone: those of the point along three directions of the parent, the axis of the joint last.
    pub(crate) fn into_products(mut self) -> Vec<Product> {
        if self.point.is_some() {
            let directions = match self.joint.kind {
                JointKind::Revolute { axis } | JointKind::Universal { axes: [axis, _] } => {
                    let [a, b] = triad(&axis);
                    [a, b, axis]
                }
                _ => [Vector::x(), Vector::y(), Vector::z()],
            };
            for (direction, name) in directions.iter().zip(["1", "2", "3"]) {
                self.add(
                    &format!("point {name}"),
                    self.parent(direction),
                    self.span(),
                );
            }
        }
        self.products
    }

    fn parent(&self, direction: &Vector) -> MaterialVector {
        MaterialVector::direction(self.joint.parent, direction, self.reference)
    }

    fn child(&self, direction: &Vector) -> MaterialVector {
        MaterialVector::direction(Some(self.joint.child), direction, self.reference)
    }

    /// Distance of the point of the joint in the child from that in the parent.
    fn span(&self) -> MaterialVector {
        let Joint {
            parent, child, at, ..
        } = self.joint;
        MaterialVector::span(
            &MaterialVector::point(*parent, at, self.reference),
            &MaterialVector::point(Some(*child), at, self.reference),
        )
    }

    fn add(&mut self, what: &str, a: MaterialVector, b: MaterialVector) {
        self.products.push(Product {
            name: format!("{} {what}", self.joint.name),
            vectors: [a, b],
        });
    }

    /// All directions of both bodies stay parallel.
    fn all_directions(&mut self) {
        let axes = [Vector::x(), Vector::y(), Vector::z()];
        for i in 0..3 {
            let (p, c) = (self.parent(&axes[i]), self.child(&axes[(i + 1) % 3]));
            self.add(&format!("direction {}", i + 1), p, c);
        }
    }

    /// An axis is fixed in both bodies.
    fn axis(&mut self, axis: &Vector) {
        for (i, direction) in triad(axis).iter().enumerate() {
            let (p, c) = (self.parent(axis), self.child(direction));
            self.add(&format!("axis {}", i + 1), p, c);
        }
    }

    /// The points do not part along directions of the parent.
    fn offsets(&mut self, directions: &[Vector]) {
        for (i, direction) in directions.iter().enumerate() {
            let (p, span) = (self.parent(direction), self.span());
            self.add(&format!("offset {}", i + 1), p, span);
        }
    }
}
