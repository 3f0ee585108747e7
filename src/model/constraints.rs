//! Constraints that redundant coordinates leave open: rigid bodies and joints, times their multipliers.

use crate::energy::{Coincidence, Orthogonality};
use crate::functional::{Effect, Element, Group, Stencil, VectorArg};
use crate::kinematics::{MaterialVector, Vectors};
use crate::math::Vector;
use crate::model::effects::{Builder, Effects, group};
use crate::model::joints::triad;
use crate::model::system::{Joint, JointKind};

fn here(vector: usize) -> VectorArg {
    VectorArg {
        vector,
        stencil: Stencil::Here,
    }
}

impl Builder<'_> {
    /// Constraints of redundant coordinates, `−h₀ λ·g`, and the names of their multipliers.
    pub(super) fn constraints(&mut self, h0: f64) -> (Effects, Vec<String>) {
        let mut rigid = Constraints::default();
        for (b, body) in self.system.bodies.iter().enumerate() {
            let axis = |i: usize| {
                MaterialVector::direction(Some(b), &body.directors.column(i).into(), self.reference)
            };
            let d = [axis(0), axis(1), axis(2)];
            for i in 0..3 {
                for j in i..3 {
                    let (product, factor) = if i == j { (1.0, 0.5) } else { (0.0, 1.0) };
                    let name = format!("{} d{}.d{}", body.name, i + 1, j + 1);
                    rigid.dot(self.vectors, name, &d[i], &d[j], product, factor);
                }
            }
        }
        let mut joints = Constraints {
            names: rigid.names,
            ..Constraints::default()
        };
        for joint in &self.system.joints {
            self.joint(joint, &mut joints);
        }
        let mut ties = Constraints {
            names: joints.names,
            ..Constraints::default()
        };
        for (span, name) in &self.continua.ties {
            ties.point(self.vectors, name, span.clone());
        }
        let mut effects = Effects::new();
        group!(effects, instants, 7, "rigid bodies", -h0, rigid.dots);
        group!(effects, instants, 7, "joint directions", -h0, joints.dots);
        group!(effects, instants, 6, "joint points", -h0, joints.points);
        group!(effects, instants, 6, "glue", -h0, ties.points);
        (effects, ties.names)
    }

    fn joint(&mut self, joint: &Joint, out: &mut Constraints) {
        let parent =
            |direction: &Vector| MaterialVector::direction(joint.parent, direction, self.reference);
        let child = |direction: &Vector| {
            MaterialVector::direction(Some(joint.child), direction, self.reference)
        };
        let span = MaterialVector::span(
            &MaterialVector::point(joint.parent, &joint.at, self.reference),
            &MaterialVector::point(Some(joint.child), &joint.at, self.reference),
        );
        let name = |what: &str| format!("{} {what}", joint.name);
        let mut parallel = |vectors: &mut Vectors| {
            let axes = [Vector::x(), Vector::y(), Vector::z()];
            for i in 0..3 {
                let (p, c) = (parent(&axes[i]), child(&axes[(i + 1) % 3]));
                out.dot(
                    vectors,
                    name(&format!("direction {}", i + 1)),
                    &p,
                    &c,
                    0.0,
                    1.0,
                );
            }
        };
        match joint.kind {
            JointKind::Spherical => out.point(self.vectors, &joint.name, span),
            JointKind::Fixed => {
                parallel(self.vectors);
                out.point(self.vectors, &joint.name, span);
            }
            JointKind::Revolute { axis } => {
                for (i, direction) in triad(&axis).iter().enumerate() {
                    let (p, c) = (parent(&axis), child(direction));
                    out.dot(
                        self.vectors,
                        name(&format!("axis {}", i + 1)),
                        &p,
                        &c,
                        0.0,
                        1.0,
                    );
                }
                out.point(self.vectors, &joint.name, span);
            }
            JointKind::Prismatic { axis } => {
                parallel(self.vectors);
                for (i, direction) in triad(&axis).iter().enumerate() {
                    out.dot(
                        self.vectors,
                        name(&format!("offset {}", i + 1)),
                        &parent(direction),
                        &span,
                        0.0,
                        1.0,
                    );
                }
            }
        }
    }
}

/// Constraints on their way to groups; multipliers are numbered in the order of the names.
#[derive(Default)]
struct Constraints {
    dots: Vec<Element<Orthogonality, 2, 1>>,
    points: Vec<Element<Coincidence, 1, 3>>,
    names: Vec<String>,
}

impl Constraints {
    fn dot(
        &mut self,
        vectors: &mut Vectors,
        name: String,
        a: &MaterialVector,
        b: &MaterialVector,
        product: f64,
        factor: f64,
    ) {
        let scalar = self.names.len();
        self.names.push(name);
        let args = [
            here(vectors.index(a.clone())),
            here(vectors.index(b.clone())),
        ];
        self.dots.push(Element {
            energy: Orthogonality { product, factor },
            vectors: args,
            scalars: [scalar],
        });
    }

    fn point(&mut self, vectors: &mut Vectors, joint: &str, span: MaterialVector) {
        let first = self.names.len();
        self.names
            .extend(["x", "y", "z"].map(|axis| format!("{joint} point {axis}")));
        let args = [here(vectors.index(span))];
        self.points.push(Element {
            energy: Coincidence,
            vectors: args,
            scalars: [first, first + 1, first + 2],
        });
    }
}
