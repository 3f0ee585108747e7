//! Contacts as they are written, and their conversion to components, whose rules stand in the model.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::names::find_body;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::scene::shape::{NamedShape, ShapeKind};
use crate::files::units::quantity::{Length, Quantity, Stiffness, Stress, Velocity};
use crate::model::components::{
    Contact, ContactElasticLaw, ContactShape, ContactSide, ElasticSolid, Restitution, SLIP_SPEED,
};
use crate::model::system::Attachment;

objects! {
    /// Contact of all pairs of shapes `between` two names, or of a `sphere` or a point and a `plane` or an `other` sphere, with a `stiffness` or the
    /// law of `hertz`.
    pub struct ContactSpec {
        /// Name, unique among springs, tendons and contacts; a pair of shapes has the name `a_b` of both.
        pub name: Option<String>,
        /// Names of two shapes, or of groups of shapes.
        pub between: Option<[String; 2]>,
        /// The sphere; or give `between`.
        pub sphere: Option<ContactSphereSpec>,
        /// The plane that it touches; or give `other`.
        pub plane: Option<ContactPlaneSpec>,
        /// The other sphere that it touches; or give `plane`.
        pub other: Option<ContactSphereSpec>,
        /// Force for an overlap of the undeformed shapes, SI unit N/m; or give `hertz`.
        pub stiffness: Option<Quantity<Stiffness>>,
        /// Law of Hertz for elastic solids, one of them on a rigid one or two; or give `stiffness`.
        pub hertz: Option<Vec<ElasticSolidSpec>>,
        /// Width of the overlap around zero over which the stiffness grows, SI unit m, for optimal control; it jumps where not written.
        pub smoothing: Option<Quantity<Length>>,
        /// Restitution, from which the damping follows; without it the contact does not damp.
        pub restitution: Option<RestitutionSpec>,
        /// Coefficient of friction; without it the contact is smooth.
        pub friction: Option<f64>,
        /// Speed of slip up to which friction grows, SI unit m/s; 0.1 mm/s where not written. What sticks creeps at a part of it, unless `stick`
        /// is written.
        pub slip_speed: Option<Quantity<Velocity>>,
        /// Greatest elastic displacement before the contact slips, SI unit m; with it friction holds without creep.
        pub stick: Option<Quantity<Length>>,
    }

    /// A sphere of a body.
    pub struct ContactSphereSpec {
        /// Name of the body, or `ground`.
        pub body: String,
        /// Centre, SI unit m.
        pub at: Point,
        /// Radius, SI unit m; a point where not written.
        pub radius: Option<Quantity<Length>>,
    }

    /// A plane of a body.
    pub struct ContactPlaneSpec {
        /// Name of the body; the ground where not written.
        pub body: Option<String>,
        /// A point of it, SI unit m.
        pub at: Point,
        /// Normal in the ground frame, of any length, towards the sphere.
        pub normal: [f64; 3],
    }

    /// Elastic constants of a solid.
    pub struct ElasticSolidSpec {
        /// Young's modulus, SI unit Pa.
        pub modulus: Quantity<Stress>,
        /// Poisson ratio, up to 0.5.
        pub poisson_ratio: f64,
    }

    /// Restitution of an impact.
    pub struct RestitutionSpec {
        /// Speed after the impact over the speed before it, above 0 and up to 1.
        pub coefficient: f64,
        /// Speed before the impact at which it is so, SI unit m/s.
        pub speed: Quantity<Velocity>,
    }
}

impl ContactSphereSpec {
    fn sphere(&self, bodies: &[String], scope: &Scope<'_>) -> Result<ContactShape> {
        Ok(ContactShape {
            centre: Attachment {
                body: find_body(&self.body, bodies, &scope.key("body"))?,
                at: vector(&self.at),
            },
            radius: self.radius.as_ref().map_or(0.0, Quantity::value),
            ..ContactShape::default()
        })
    }
}

impl ContactPlaneSpec {
    fn side(&self, bodies: &[String], scope: &Scope<'_>) -> Result<ContactSide> {
        let body = self.body.as_deref().unwrap_or("ground");
        Ok(ContactSide::Plane {
            at: Attachment {
                body: find_body(body, bodies, &scope.key("body"))?,
                at: vector(&self.at),
            },
            normal: unit_axis(&self.normal, &scope.key("normal"))?,
        })
    }
}

/// The contacts that are written.
pub(crate) fn contacts(
    spec: &ContactSpec,
    bodies: &[String],
    shapes: &[NamedShape],
    scope: &Scope<'_>,
) -> Result<Vec<Contact>> {
    refuse!(if spec.slip_speed.is_some() && spec.friction.is_none(), scope.key("slip_speed");
        found "\"slip_speed\"", expected "no such key, as a contact without \"friction\" does not read it");
    refuse!(if spec.stick.is_some() && spec.friction.is_none(), scope.key("stick");
        found "\"stick\"", expected "no such key, as a contact without \"friction\" does not read it");
    let pairs = the_one!(scope, spec;
        "between" between |place, names| {
            for (key, is_written) in [
                ("name", spec.name.is_some()),
                ("plane", spec.plane.is_some()),
                ("other", spec.other.is_some()),
            ] {
                refuse!(if is_written, scope.key(key);
                    found format!("{key:?}"), expected "no such key, as shapes are named \"between\" which contacts are");
            }
            pairs(names, shapes, place)?
        };
        "sphere" sphere |place, sphere| {
            let side = the_one!(scope, spec;
                "plane" plane |place, plane| plane.side(bodies, place)?;
                "other" other |place, other| ContactSide::Shape(other.sphere(bodies, place)?);
            );
            let name = spec.name.clone().ok_or_else(|| scope.missing_key("name"))?;
            let round = sphere.sphere(bodies, place)?;
            vec![Pair { name, round, side, part: 1.0 }]
        };
    );
    let elasticity = the_one!(scope, spec;
        "stiffness" stiffness |_, stiffness| ContactElasticLaw::Linear(stiffness.value());
        "hertz" hertz |_, solids| {
            let solid = |solid: &ElasticSolidSpec| ElasticSolid {
                modulus: solid.modulus.value(),
                poisson_ratio: solid.poisson_ratio,
            };
            ContactElasticLaw::Hertz(solids.iter().map(solid).collect())
        };
    );
    let restitution = spec.restitution.as_ref().map(|of| Restitution {
        coefficient: of.coefficient,
        speed: of.speed.value(),
    });
    let contact = |pair: Pair| Contact {
        name: pair.name,
        round: pair.round,
        side: pair.side,
        elasticity: match &elasticity {
            ContactElasticLaw::Linear(stiffness) => {
                ContactElasticLaw::Linear(stiffness * pair.part)
            }
            hertz @ ContactElasticLaw::Hertz(_) => hertz.clone(),
        },
        smoothing: Quantity::present(&spec.smoothing).unwrap_or(0.0),
        restitution,
        friction: spec.friction.filter(|friction| *friction != 0.0),
        slip_speed: spec.slip_speed.as_ref().map_or(SLIP_SPEED, Quantity::value),
        stick: Quantity::present(&spec.stick),
    };
    Ok(pairs.into_iter().map(contact).collect())
}

/// A round shape and the side that it touches.
struct Pair {
    name: String,
    round: ContactShape,
    side: ContactSide,
    /// Part of the stiffness.
    part: f64,
}

/// The pairs of shapes of different carriers between two names.
fn pairs(names: &[String; 2], shapes: &[NamedShape], scope: &Scope<'_>) -> Result<Vec<Pair>> {
    let mut known: Vec<String> = shapes.iter().map(|one| one.name.clone()).collect();
    known.extend(shapes.iter().filter_map(|one| one.group.clone()));
    let mut sides = [Vec::new(), Vec::new()];
    for (k, (side, name)) in sides.iter_mut().zip(names).enumerate() {
        let expected = "the name of a shape or of a group of shapes";
        scope.index(k).find(name, &known, expected)?;
        let is_meant = |one: &&NamedShape| one.name == *name || one.group.as_ref() == Some(name);
        side.extend(shapes.iter().filter(is_meant));
    }
    let [first, second] = &sides;
    let mut pairs = Vec::new();
    for (i, one) in first.iter().enumerate() {
        // Of a group with itself each pair once.
        let from = if names[0] == names[1] { i + 1 } else { 0 };
        for other in &second[from.min(second.len())..] {
            if one.carrier() != other.carrier() {
                pairs.extend(pair([one, other], scope)?);
            }
        }
    }
    refuse!(if pairs.is_empty(), scope;
        found format!("{:?} and {:?}", names[0], names[1]), expected "shapes of different bodies");
    Ok(pairs)
}

/// The contacts of a pair of shapes: of each node, of each end of a capsule and each corner of a box on a plane, and one of others.
fn pair([one, other]: [&NamedShape; 2], scope: &Scope<'_>) -> Result<Vec<Pair>> {
    let name = format!("{}_{}", one.name, other.name);
    let refused = || {
        let found = format!("{:?} and {:?}", one.name, other.name);
        let expected =
            "pairs of which one is a sphere, a capsule, or nodes against a shape of a body";
        scope.wrong(found, expected)
    };
    let each = |rounds: Vec<(String, f64, ContactShape)>, side: &ContactSide| {
        let pair = |(suffix, part, round)| Pair {
            name: format!("{name}{suffix}"),
            round,
            side: side.clone(),
            part,
        };
        rounds.into_iter().map(pair).collect()
    };
    let of_nodes = |nodes: &[(usize, f64, ContactShape)]| {
        let node =
            |(node, part, shape): &(usize, f64, ContactShape)| (format!("_{node}"), *part, *shape);
        nodes.iter().map(node).collect()
    };
    Ok(match (&one.kind, &other.kind) {
        (ShapeKind::Shape(a), ShapeKind::Shape(b)) => {
            let [round, side] = ContactShape::by_axes([*a, *b]);
            if round.corners().len() > 2 {
                return Err(refused());
            }
            each(vec![(String::new(), 1.0, round)], &ContactSide::Shape(side))
        }
        (ShapeKind::Shape(shape), ShapeKind::Plane(plane))
        | (ShapeKind::Plane(plane), ShapeKind::Shape(shape)) => each(on_plane(shape), plane),
        (ShapeKind::Nodes(nodes), ShapeKind::Plane(plane))
        | (ShapeKind::Plane(plane), ShapeKind::Nodes(nodes)) => each(of_nodes(nodes), plane),
        (ShapeKind::Nodes(nodes), ShapeKind::Shape(shape))
        | (ShapeKind::Shape(shape), ShapeKind::Nodes(nodes)) => {
            each(of_nodes(nodes), &ContactSide::Shape(*shape))
        }
        _ => return Err(refused()),
    })
}

/// The spheres with which a shape stands on a plane, and what is added to its name.
fn on_plane(shape: &ContactShape) -> Vec<(String, f64, ContactShape)> {
    let corners = shape.corners();
    let suffix = |k: usize| match corners.len() {
        1 => String::new(),
        2 => ["_from", "_to"][k].to_owned(),
        _ => format!("_{}", k + 1),
    };
    let corner = |(k, corner): (usize, &ContactShape)| (suffix(k), 1.0, *corner);
    corners.iter().enumerate().map(corner).collect()
}
