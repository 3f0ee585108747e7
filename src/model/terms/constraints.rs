//! Constraints that coordinates leave open, times their multipliers: of redundant ones rigid bodies and joints, of reduced ones the joints
//! that close loops.

use crate::energy::{Coincidence, JointAngle, JointDisplacement, Orthogonality};
use crate::functional::{Element, Group, Kernel, Stencil, Term};
use crate::kinematics::{MaterialVector, Vectors};
use crate::model::analysis::Coordinates;
use crate::model::construction::Construction;
use crate::model::layout::internal::InternalKind;
use crate::model::system::Glue;
use crate::model::system::joints::JointCoordinate;
use crate::model::terms::joint_constraints::{JointConstraints, Product};
use crate::model::terms::{LeftOut, Present, note};
use std::mem::take;
use std::sync::Arc;

/// Terms of constraints.
const RIGID: &str = "rigid bodies";
const DIRECTIONS: &str = "joint directions";
const POINTS: &str = "joint points";
const COORDINATES: &str = "joint coordinates";
/// Term of the nodes that constraints glue to bodies.
pub(crate) const GLUE: &str = "glue";

/// Constraints collected for the action, with the names of their multipliers.
#[derive(Default)]
pub(crate) struct Constraints {
    pub(crate) terms: Vec<Arc<dyn Term>>,
    pub(crate) multipliers: Vec<String>,
    pub(crate) present: Vec<Present>,
    pub(crate) left_out: Vec<LeftOut>,
}

impl Constraints {
    /// Adds a term of elements for the parts of the scene that are named, if there are any.
    fn add<'n, K: Kernel>(
        &mut self,
        term: &'static str,
        scale: f64,
        elements: Vec<K>,
        why: &'static str,
        names: impl Iterator<Item = &'n str>,
    ) {
        if elements.is_empty() {
            return;
        }
        for name in names {
            note(&mut self.present, term, why, name);
        }
        let group = Group::instants(term, scale, elements);
        self.terms.push(Arc::new(group));
    }
}

impl Construction<'_> {
    /// Adds the constraints of an instant, `−h₀ λ·g`, that the coordinates leave open.
    pub(crate) fn add_constraints(&self, made: &mut Constraints, vectors: &mut Vectors) {
        let (mut all, h0) = (Elements::default(), self.analysis.interval);
        let system = &self.presolved.system;
        let (open, bodies, ends) = match self.coordinates {
            Coordinates::Reduced => {
                let why = "reduced coordinates leave no constraint";
                let none = [RIGID, DIRECTIONS, POINTS, COORDINATES, GLUE];
                made.left_out.extend(none.map(|term| LeftOut { term, why }));
                (self.graph.loops().to_vec(), &[][..], "a loop is closed by")
            }
            Coordinates::Redundant => (
                (0..system.joints.len()).collect(),
                &system.bodies[..],
                "redundant coordinates at the ends of",
            ),
        };
        for (b, body) in bodies.iter().enumerate() {
            let axis = |i: usize| {
                MaterialVector::direction(Some(b), &body.directors.column(i).into(), self.reference)
            };
            let d = [axis(0), axis(1), axis(2)];
            for i in 0..3 {
                for j in i..3 {
                    let (product, factor) = if i == j { (1.0, 0.5) } else { (0.0, 1.0) };
                    let name = format!("{} d{}.d{}", body.name, i + 1, j + 1);
                    all.dot(vectors, name, &d[i], &d[j], product, factor);
                }
            }
        }
        let rigid = take(&mut all.dots);
        self.joints(&open, vectors, &mut all);
        let points = take(&mut all.points);
        for (span, name) in &self.blocks.ties {
            all.point(vectors, name, span.clone());
        }
        self.joint_coordinates(vectors, &mut all);
        let bodies = bodies.iter().map(|body| body.name.as_str());
        let joints = || open.iter().map(|&j| system.joints[j].name.as_str());
        let is_glued = |glue: &Glue| glue.body.is_some();
        let glued = self.blocks.list.iter().filter(|c| !c.is_immobile);
        let glued = glued.filter(|c| c.solid.glued.iter().any(is_glued));
        let glued = glued.map(|c| c.solid.name.as_str());
        made.multipliers = all.names;
        made.add(RIGID, -h0, rigid, "directors of", bodies);
        made.add(DIRECTIONS, -h0, all.dots, ends, joints());
        made.add(POINTS, -h0, points, ends, joints());
        let (why, of) = ("stiffness of", || all.of.iter().map(String::as_str));
        made.add(COORDINATES, -h0, all.angles, why, of());
        made.add(COORDINATES, -h0, all.displacements, why, of());
        made.add(GLUE, -h0, all.points, "glued nodes of", glued);
    }

    /// Constraints of some joints, those that close loops without what is left out.
    fn joints(&self, open: &[usize], vectors: &mut Vectors, out: &mut Elements) {
        for &j in open {
            let joint = &self.presolved.system.joints[j];
            if let Some(products) = self.loops.kept(j) {
                out.products(vectors, products.to_vec());
                continue;
            }
            let made = JointConstraints::new(joint, self.reference);
            out.products(vectors, made.products);
            if let Some(span) = made.point {
                out.point(vectors, &joint.name, span);
            }
        }
    }

    /// Internal coordinates are those of their joints.
    fn joint_coordinates(&self, vectors: &mut Vectors, out: &mut Elements) {
        for (internal, value) in self.internals.vectors() {
            let InternalKind::Joint(index) = internal.kind else {
                continue;
            };
            let joint = &self.presolved.system.joints[index];
            let value = Stencil::Here.of(vectors.index(value));
            let scalars = [out.names.len()];
            out.names.push(internal.name.clone());
            out.of.push(joint.name.clone());
            let mut index = |v: MaterialVector| Stencil::Here.of(vectors.index(v));
            let coordinate = JointCoordinate::new(joint, self.reference);
            match coordinate.expect("its joint has a coordinate") {
                JointCoordinate::Angle { vectors } => {
                    let [a, b, c] = vectors.map(&mut index);
                    out.angles.push(Element {
                        energy: JointAngle,
                        vectors: [a, b, c, value],
                        scalars,
                    });
                }
                JointCoordinate::Displacement { axis, span } => out.displacements.push(Element {
                    energy: JointDisplacement,
                    vectors: [index(axis), index(span), value],
                    scalars,
                }),
            }
        }
    }
}

/// Constraints collected for groups; multipliers are numbered in the order of the names.
#[derive(Default)]
struct Elements {
    dots: Vec<Element<Orthogonality, 7, 2, 1>>,
    points: Vec<Element<Coincidence, 6, 1, 3>>,
    angles: Vec<Element<JointAngle, 13, 4, 1>>,
    displacements: Vec<Element<JointDisplacement, 10, 3, 1>>,
    names: Vec<String>,
    /// Joints of the coordinates.
    of: Vec<String>,
}

impl Elements {
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
            Stencil::Here.of(vectors.index(a.clone())),
            Stencil::Here.of(vectors.index(b.clone())),
        ];
        self.dots.push(Element {
            energy: Orthogonality { product, factor },
            vectors: args,
            scalars: [scalar],
        });
    }

    fn products(&mut self, vectors: &mut Vectors, products: Vec<Product>) {
        for Product {
            name,
            vectors: [a, b],
        } in products
        {
            self.dot(vectors, name, &a, &b, 0.0, 1.0);
        }
    }

    fn point(&mut self, vectors: &mut Vectors, joint: &str, span: MaterialVector) {
        let first = self.names.len();
        self.names
            .extend(["x", "y", "z"].map(|axis| format!("{joint} point {axis}")));
        let args = [Stencil::Here.of(vectors.index(span))];
        self.points.push(Element {
            energy: Coincidence,
            vectors: args,
            scalars: [first, first + 1, first + 2],
        });
    }
}
