//! Contacts as they are written, and their conversion to components, whose rules stand in the model.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::names::find_body;
use crate::files::scene::point::{Point, unit_axis, vector};
use crate::files::units::quantity::{Length, Quantity, Stiffness, Stress, Velocity};
use crate::model::components::{
    Contact, ContactElasticLaw, ContactSide, ContactSphere, ElasticSolid, Restitution, SLIP_SPEED,
};
use crate::model::system::Attachment;

objects! {
    /// A sphere or a point that touches a `plane` or an `other` sphere, with a `stiffness` or the law of `hertz`.
    pub struct ContactSpec {
        /// Name, unique among springs, tendons and contacts.
        pub name: String,
        /// The sphere.
        pub sphere: ContactSphereSpec,
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
    fn sphere(&self, bodies: &[String], scope: &Scope<'_>) -> Result<ContactSphere> {
        Ok(ContactSphere {
            centre: Attachment {
                body: find_body(&self.body, bodies, &scope.key("body"))?,
                at: vector(&self.at),
            },
            radius: self.radius.as_ref().map_or(0.0, Quantity::value),
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

/// The contact that is written.
pub(crate) fn contact(spec: &ContactSpec, bodies: &[String], scope: &Scope<'_>) -> Result<Contact> {
    refuse!(if spec.slip_speed.is_some() && spec.friction.is_none(), scope.key("slip_speed");
        found "\"slip_speed\"", expected "no such key, as a contact without \"friction\" does not read it");
    refuse!(if spec.stick.is_some() && spec.friction.is_none(), scope.key("stick");
        found "\"stick\"", expected "no such key, as a contact without \"friction\" does not read it");
    let side = the_one!(scope, spec;
        "plane" plane |place, plane| plane.side(bodies, place)?;
        "other" other |place, other| ContactSide::Sphere(other.sphere(bodies, place)?);
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
    Ok(Contact {
        name: spec.name.clone(),
        sphere: spec.sphere.sphere(bodies, &scope.key("sphere"))?,
        side,
        elasticity,
        smoothing: Quantity::present(&spec.smoothing).unwrap_or(0.0),
        restitution,
        friction: spec.friction.filter(|friction| *friction != 0.0),
        slip_speed: spec.slip_speed.as_ref().map_or(SLIP_SPEED, Quantity::value),
        stick: Quantity::present(&spec.stick),
    })
}
