//! Shapes that contacts name as they are written, and their conversion.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::names::{find_body, names};
use crate::files::scene::nodes::nodes;
use crate::files::scene::point::{CornersSpec, Point, unit_axis, vector};
use crate::files::scene::spec_solids::PlaneSpec;
use crate::files::units::quantity::{Length, Quantity};
use crate::mesh::Mesh;
use crate::mesh::cell::flat_parts;
use crate::model::components::{ContactShape, ContactSide};
use crate::model::system::{Attachment, Solid};
use nalgebra::Vector3;

objects! {
    /// A shape that contacts name: a `sphere`, `capsule`, `box` or `plane` of a body, or `nodes` of an elastic block.
    pub struct ContactShapeSpec {
        /// Name, unique among shapes and their groups.
        pub name: String,
        /// Name of the shapes that contacts mean together.
        pub group: Option<String>,
        /// Name of the body, or `ground`; the ground where not written.
        pub body: Option<String>,
        /// A sphere, or a point.
        pub sphere: Option<SphereShapeSpec>,
        /// A cylinder between two half spheres.
        pub capsule: Option<CapsuleShapeSpec>,
        /// A box.
        #[serde(rename = "box")]
        pub cuboid: Option<BoxShapeSpec>,
        /// A plane, which reaches to infinity.
        pub plane: Option<PlaneShapeSpec>,
        /// Nodes of an elastic block, each a point.
        pub nodes: Option<NodesShapeSpec>,
    }

    /// A sphere.
    pub struct SphereShapeSpec {
        /// Centre, SI unit m.
        pub at: Point,
        /// Radius, SI unit m; a point where not written.
        pub radius: Option<Quantity<Length>>,
    }

    /// A capsule.
    pub struct CapsuleShapeSpec {
        /// Centre of the half sphere at one end, SI unit m.
        pub from: Point,
        /// Centre of the half sphere at the other end, SI unit m.
        pub to: Point,
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
    }

    /// A box, or a plate.
    pub struct BoxShapeSpec {
        /// Centre, SI unit m.
        pub at: Point,
        /// Lengths of its edges, SI unit m.
        pub size: Point,
        /// Directions of the edges of the first two lengths in the ground frame; x and y where not written.
        pub axes: Option<[[f64; 3]; 2]>,
        /// Radius of its edges, no more than half of the least length, SI unit m; sharp where not written.
        pub radius: Option<Quantity<Length>>,
    }

    /// A plane.
    pub struct PlaneShapeSpec {
        /// A point of it, SI unit m.
        pub at: Point,
        /// Normal in the ground frame, of any length, towards what touches it.
        pub normal: [f64; 3],
    }

    /// Nodes of an elastic block: those of a `face`, in a `plane` or in a `box`.
    pub struct NodesShapeSpec {
        /// Name of the block.
        pub solid: String,
        /// Name of a face of a box, or of a physical group of a mesh.
        pub face: Option<String>,
        /// Plane at right angles to an axis.
        pub plane: Option<PlaneSpec>,
        /// Box.
        #[serde(rename = "box")]
        pub cuboid: Option<CornersSpec>,
    }
}

/// Greatest cosine of directions at right angles.
const SQUARE: f64 = 1e-9;

/// A shape that contacts name.
#[derive(Clone, Debug)]
pub(crate) struct NamedShape {
    pub(crate) name: String,
    pub(crate) group: Option<String>,
    pub(crate) kind: ShapeKind,
}

/// Shape of one of the kinds, or nodes.
#[derive(Clone, Debug)]
pub(crate) enum ShapeKind {
    /// A plane.
    Plane(ContactSide),
    /// A point, sphere, capsule or box.
    Shape(ContactShape),
    /// Nodes, each with its number in the mesh and its part of the stiffness.
    Nodes(Vec<(usize, f64, ContactShape)>),
}

impl NamedShape {
    /// The carriers of what it is: a body, or a block; none is the ground.
    pub(crate) fn carrier(&self) -> [Option<usize>; 2] {
        match &self.kind {
            ShapeKind::Plane(ContactSide::Plane { at, .. }) => [at.body, None],
            ShapeKind::Plane(ContactSide::Shape(shape)) | ShapeKind::Shape(shape) => {
                [shape.centre.body, None]
            }
            ShapeKind::Nodes(nodes) => {
                let node = nodes.first().and_then(|(_, _, shape)| shape.node);
                [None, node.map(|[solid, _]| solid)]
            }
        }
    }
}

/// The shape that is written.
pub(crate) fn shape(
    spec: &ContactShapeSpec,
    bodies: &[String],
    solids: &[Solid],
    scope: &Scope<'_>,
) -> Result<NamedShape> {
    refuse!(if spec.nodes.is_some() && spec.body.is_some(), scope.key("body");
        found "\"body\"", expected "no such key, as \"nodes\" are those of a \"solid\"");
    let name = spec.body.as_deref().unwrap_or("ground");
    let body = find_body(name, bodies, &scope.key("body"))?;
    let on = |at: Vector3<f64>| Attachment { body, at };
    let kind = the_one!(scope, spec;
        "sphere" sphere |place, sphere| ShapeKind::Shape(ContactShape {
            centre: on(vector(&sphere.at)),
            radius: place.optional("radius", &sphere.radius, |at, radius| at.positive(radius))?.unwrap_or(0.0),
            ..ContactShape::default()
        });
        "capsule" capsule |place, capsule| {
            let (from, to) = (vector(&capsule.from), vector(&capsule.to));
            refuse!(if from == to, place.key("to");
                found "the same place as \"from\"", expected "another place, or a \"sphere\"");
            ShapeKind::Shape(ContactShape {
                centre: on((from + to) * 0.5),
                radius: place.key("radius").positive(&capsule.radius)?,
                axes: [(to - from) * 0.5, Vector3::zeros(), Vector3::zeros()],
                node: None,
            })
        };
        "box" cuboid |place, cuboid| ShapeKind::Shape(ContactShape {
            centre: on(vector(&cuboid.at)),
            ..cuboid.about_centre(place)?
        });
        "plane" plane |place, plane| ShapeKind::Plane(ContactSide::Plane {
            at: on(vector(&plane.at)),
            normal: unit_axis(&plane.normal, &place.key("normal"))?,
        });
        "nodes" nodes |place, nodes| ShapeKind::Nodes(nodes.each(&spec.name, solids, place)?);
    );
    Ok(NamedShape {
        name: spec.name.clone(),
        group: spec.group.clone(),
        kind,
    })
}

impl BoxShapeSpec {
    /// The box about its centre.
    fn about_centre(&self, scope: &Scope<'_>) -> Result<ContactShape> {
        let at_size = scope.key("size");
        let lengths: Vec<f64> = at_size.each(&self.size, |length, at| at.positive(length))?;
        let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let radius = scope.optional("radius", &self.radius, |at, radius| {
            let value = at.positive(radius)?;
            refuse!(if value > 0.5 * least, at;
                found radius, expected "no more than half of the least length");
            Ok(value)
        })?;
        let radius = radius.unwrap_or(0.0);
        let at_axes = scope.key("axes");
        let [first, second] = match &self.axes {
            None => [Vector3::x(), Vector3::y()],
            Some([first, second]) => [
                unit_axis(first, &at_axes.index(0))?,
                unit_axis(second, &at_axes.index(1))?,
            ],
        };
        refuse!(if first.dot(&second).abs() > SQUARE, at_axes;
            found format!("{:?}", self.axes.unwrap_or_default()), expected "directions at right angles");
        let directions = [first, second, first.cross(&second)];
        let half = |k: usize| directions[k] * (0.5 * lengths[k] - radius).max(0.0);
        Ok(ContactShape {
            radius,
            axes: [0, 1, 2].map(half),
            ..ContactShape::default()
        })
    }
}

impl NodesShapeSpec {
    /// The nodes, each with its number and its part of the stiffness.
    fn each(
        &self,
        name: &str,
        solids: &[Solid],
        scope: &Scope<'_>,
    ) -> Result<Vec<(usize, f64, ContactShape)>> {
        let all = names(solids, |solid| &solid.name);
        let expected = "the name of an elastic block";
        let solid = scope.key("solid").find(&self.solid, &all, expected)?;
        let mesh = &solids[solid].mesh;
        let owner = format!("shape {name:?}");
        let nodes = nodes!(&owner, self, mesh, scope);
        let parts = parts_of_surface(mesh, &nodes);
        let node = |(node, part): (usize, f64)| {
            let at = mesh.nodes[node];
            let shape = ContactShape {
                centre: Attachment { body: None, at },
                node: Some([solid, node]),
                ..ContactShape::default()
            };
            (node, part, shape)
        };
        Ok(nodes.into_iter().zip(parts).map(node).collect())
    }
}

/// The part of each of some nodes in the surface between them, an equal share of each flat face with each of its corners; equal parts where they
/// make no face.
fn parts_of_surface(mesh: &Mesh, nodes: &[usize]) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.nodes.len()];
    for face in mesh
        .faces_of(nodes)
        .iter()
        .flat_map(|face| flat_parts(face))
    {
        let [a, b, c, d] = face.map(|node| mesh.nodes[node]);
        let area = 0.5 * (c - a).cross(&(d - b)).norm();
        let corners = if face[2] == face[3] { 3 } else { 4 };
        for &node in &face[..corners] {
            areas[node] += area / corners as f64;
        }
    }
    let whole: f64 = areas.iter().sum();
    let part = |&node: &usize| match whole > 0.0 {
        true => areas[node] / whole,
        false => (nodes.len() as f64).recip(),
    };
    nodes.iter().map(part).collect()
}
