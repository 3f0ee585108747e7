//! A contact of a round shape with a plane or another round shape.

use crate::energy::{
    ContactDamping, ContactElasticity, ContactFriction, ContactLaw, Energy, StickingFriction,
    Surface,
};
use crate::functional::Element;
use crate::kinematics::MaterialVector;
use crate::math::{DIRECTION, Fault, Key, not_negative, positive, refuse};
use crate::model::components::component::Component;
use crate::model::layout::contact_reading::ContactReading;
use crate::model::system::bodies::Attachment;
use crate::model::system::joints::triad;
use crate::model::terms::{Terms, mid, rate};
use nalgebra::Vector3;
use std::ops::Range;

/// A compliant contact with or without damping and friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Unique name.
    pub name: String,
    /// The round shape.
    pub sphere: ContactSphere,
    /// The other side.
    pub side: ContactSide,
    /// Elasticity of both.
    pub elasticity: ContactElasticLaw,
    /// Width in mm of the overlap around zero over which the stiffness grows; zero where it jumps.
    pub smoothing: f64,
    /// Restitution; without it the contact does not damp.
    pub restitution: Option<Restitution>,
    /// Coefficient of friction; `None` leaves no trace.
    pub friction: Option<f64>,
    /// Speed in mm/ms of slip up to which friction grows.
    pub slip_speed: f64,
    /// Greatest elastic displacement in mm of friction that sticks; without it friction is a function of the slip.
    pub stick: Option<f64>,
}

/// A sphere of a body or of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSphere {
    /// Its centre.
    pub centre: Attachment,
    /// Its radius in mm; zero of a point.
    pub radius: f64,
}

/// The side that a round shape touches.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactSide {
    /// A plane of a body or of the ground.
    Plane {
        /// A point of it.
        at: Attachment,
        /// Unit normal in the reference configuration, towards the round shape.
        normal: Vector3<f64>,
    },
    /// A sphere.
    Sphere(ContactSphere),
}

/// Elasticity of a contact.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactElasticLaw {
    /// Force proportional to the overlap, stiffness in N/mm.
    Linear(f64),
    /// Law of Hertz for one elastic solid on a rigid one, or for two.
    Hertz(Vec<ElasticSolid>),
}

/// Elastic constants of a solid in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticSolid {
    /// Young's modulus in MPa.
    pub modulus: f64,
    /// Poisson ratio.
    pub poisson_ratio: f64,
}

/// Restitution of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restitution {
    /// Speed after the impact over the speed before it.
    pub coefficient: f64,
    /// The speed in mm/ms at which it is so.
    pub speed: f64,
}

const ELASTICITY: &str = "contact elasticity";
const DAMPING: &str = "contact damping";
const FRICTION: &str = "contact friction";

/// Speed of slip in mm/ms up to which friction grows where none is given.
pub const SLIP_SPEED: f64 = 1e-4;

impl ContactElasticLaw {
    /// Stiffness in N/mmᵖ and exponent p for a radius of relative curvature in mm.
    fn constants(&self, radius: f64) -> [f64; 2] {
        match self {
            Self::Linear(stiffness) => [*stiffness, 1.0],
            Self::Hertz(solids) => {
                let compliance = |solid: &ElasticSolid| {
                    (1.0 - solid.poisson_ratio * solid.poisson_ratio) / solid.modulus
                };
                let compliance: f64 = solids.iter().map(compliance).sum();
                [4.0 / 3.0 * radius.sqrt() / compliance, 1.5]
            }
        }
    }
}

impl Restitution {
    /// Damping times speed κ of the restitution e: `κ (1 + e) = ln[(1 + κ)/(1 − κ e)]`, zero of e = 1.
    fn damping_number(&self) -> f64 {
        let e = self.coefficient;
        let excess = |k: f64| (k.ln_1p() - (-k * e).ln_1p()) - k * (1.0 + e);
        if e >= 1.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0 / e);
        // The excess falls from zero at zero, and is infinite at 1/e.
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            match excess(middle) > 0.0 {
                true => high = middle,
                false => low = middle,
            }
        }
    }
}

/// Constants of a contact that a solver finds easily, no stiffer than its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftContact {
    /// Width in mm of the overlap over which the stiffness grows.
    smoothing: f64,
    /// Part of the stiffness.
    part: f64,
    /// Speed in mm/ms of slip up to which friction grows.
    slip_speed: f64,
    /// Greatest elastic displacement in mm of friction that sticks.
    stick: f64,
}

/// Part of a soft width in the place of a width that a scene does not have.
const NO_WIDTH: f64 = 0.01;
/// Overlap at which the laws of soft contacts are compared, in radii.
const SMALL: f64 = 0.01;

impl Contact {
    /// The constants of a width in mm, a stiffness in N/mm, a speed of slip in mm/ms and an elastic displacement in mm, where they are softer
    /// than those of the contact.
    pub fn soft(&self, width: f64, stiffness: f64, slip_speed: f64, stick: f64) -> SoftContact {
        let smoothing = width.max(self.smoothing);
        let law = self.law_at_reference();
        let overlap = smoothing.max(SMALL * law.distance);
        let own = law.stiffness * overlap.powf(law.exponent - 1.0);
        SoftContact {
            smoothing,
            part: (stiffness / own).min(1.0),
            slip_speed: slip_speed.max(self.slip_speed),
            stick,
        }
    }

    /// The contact between its own constants, at t = 0, and soft ones, at t = 1, beyond which its width and its speed of slip grow on.
    pub fn softened(&self, soft: &SoftContact, t: f64) -> Self {
        let between = |own: f64, soft: f64| own * (soft.max(own) / own).powf(t);
        let smoothing = match soft.smoothing > self.smoothing {
            true => between(
                self.smoothing.max(NO_WIDTH * soft.smoothing),
                soft.smoothing,
            ),
            false => self.smoothing,
        };
        let part = soft.part.powf(t.min(1.0));
        let elasticity = match &self.elasticity {
            ContactElasticLaw::Linear(stiffness) => ContactElasticLaw::Linear(stiffness * part),
            ContactElasticLaw::Hertz(solids) => {
                let softer = solids.iter().map(|solid| ElasticSolid {
                    modulus: solid.modulus * part,
                    ..*solid
                });
                ContactElasticLaw::Hertz(softer.collect())
            }
        };
        let slip_speed = match self.friction {
            Some(_) => between(self.slip_speed, soft.slip_speed),
            None => self.slip_speed,
        };
        Self {
            elasticity,
            smoothing,
            slip_speed,
            stick: self.stick.map(|own| between(own, soft.stick)),
            ..self.clone()
        }
    }

    /// The points between which it acts.
    pub(in crate::model) fn ends(&self) -> [Attachment; 2] {
        [self.sphere.centre, *self.origin()]
    }

    /// Number of the components of its elastic displacement: along a plane, or in space between spheres.
    pub(in crate::model) fn bristles(&self) -> usize {
        let holds = self.friction.is_some_and(|coefficient| coefficient > 0.0);
        match (self.stick, &self.side) {
            (Some(_), ContactSide::Plane { .. }) if holds => 2,
            (Some(_), ContactSide::Sphere(_)) if holds => 3,
            _ => 0,
        }
    }

    /// The vector of these coordinates, in the frame of a plane that turns.
    fn bristle(&self, coordinates: Range<usize>, surface: Surface) -> MaterialVector {
        let mut vector = MaterialVector::coordinates(coordinates);
        if let Surface::Plane(normal) = surface {
            for (term, tangent) in vector.terms.iter_mut().zip(triad(&normal)) {
                term.directors = tangent;
            }
        }
        vector
    }

    /// The point of the other side from which the contact reads its span.
    fn origin(&self) -> &Attachment {
        match &self.side {
            ContactSide::Plane { at, .. } => at,
            ContactSide::Sphere(other) => &other.centre,
        }
    }

    /// Its spheres.
    fn spheres(&self) -> Vec<ContactSphere> {
        match self.side {
            ContactSide::Plane { .. } => vec![self.sphere],
            ContactSide::Sphere(other) => vec![self.sphere, other],
        }
    }

    /// Radius of the other side, zero of a plane.
    fn other_radius(&self) -> f64 {
        match &self.side {
            ContactSide::Plane { .. } => 0.0,
            ContactSide::Sphere(other) => other.radius,
        }
    }

    /// The law on a surface.
    fn law(&self, surface: Surface) -> ContactLaw {
        let (a, b) = (self.sphere.radius, self.other_radius());
        let radius = match surface {
            Surface::Sphere => a * b / (a + b),
            Surface::Plane(_) | Surface::MovingPlane => a,
        };
        let [stiffness, exponent] = self.elasticity.constants(radius);
        let damping = self.restitution.map(|of| (of, of.damping_number()));
        ContactLaw {
            surface,
            distance: a + b,
            stiffness,
            exponent,
            smoothing: self.smoothing,
            damping: damping.map_or(0.0, |(of, number)| number / of.speed),
            // An impact at the speed of the restitution comes as far as to 1 − κ e.
            release: damping.map_or(1.0, |(of, number)| 1.0 - number * of.coefficient),
        }
    }

    /// The law in the reference configuration, in the ground frame.
    fn law_at_reference(&self) -> ContactLaw {
        self.law(match self.side {
            ContactSide::Plane { normal, .. } => Surface::Plane(normal),
            ContactSide::Sphere(_) => Surface::Sphere,
        })
    }

    /// The normal force with the vectors that it reads; `None` where no side moves.
    pub(crate) fn reading(&self, terms: &mut Terms<'_>) -> Option<ContactReading> {
        let span = terms.span(self.origin(), &self.sphere.centre)?;
        let normal = self.turning_normal(terms);
        Some(ContactReading {
            name: self.name.clone(),
            law: self.law(match self.side {
                ContactSide::Plane { .. } if normal.is_some() => Surface::MovingPlane,
                ContactSide::Plane { normal, .. } => Surface::Plane(normal),
                ContactSide::Sphere(_) => Surface::Sphere,
            }),
            span,
            normal,
            friction: None,
            bristle: None,
        })
    }

    /// The normal of a plane that turns with a body.
    fn turning_normal(&self, terms: &mut Terms<'_>) -> Option<usize> {
        match &self.side {
            ContactSide::Plane { at, normal } if terms.carrier(at).is_some() => {
                let normal = terms.direction(at, normal);
                Some(terms.vector(normal))
            }
            ContactSide::Plane { .. } | ContactSide::Sphere(_) => None,
        }
    }

    /// Adds the virtual works of a motion, and completes what is read of it.
    fn add_works(&self, reading: &mut ContactReading, terms: &mut Terms<'_>) {
        let (name, law) = (&self.name, reading.law);
        let call = [DAMPING, "restitution of"];
        let (read, damping) = (reading.normal_vectors(), ContactDamping(law));
        match read[..] {
            _ if law.damping == 0.0 => {
                terms.without(
                    DAMPING,
                    "no contact that moves names a restitution below one",
                );
            }
            [_] => add::<_, 9, 3>(call, name, damping, &read, terms),
            _ => add::<_, 18, 6>(call, name, damping, &read, terms),
        }
        let Some(coefficient) = self.friction else {
            return terms.without(FRICTION, "no contact that moves names a friction");
        };
        let (friction, vectors) = self.friction_law(reading, coefficient, terms);
        let bristles = terms.bristles.get(name).cloned();
        let call = [FRICTION, "friction of"];
        match (self.stick.zip(bristles), vectors.len()) {
            (Some((displacement, coordinates)), count) => {
                let bristle = terms.vector(self.bristle(coordinates, law.surface));
                reading.bristle = Some(bristle);
                let read = [&vectors[..], &[bristle]].concat();
                let sticking = StickingFriction {
                    friction,
                    displacement,
                };
                match count {
                    1 => add::<_, 18, 6>(call, name, sticking, &read, terms),
                    4 => add::<_, 45, 15>(call, name, sticking, &read, terms),
                    _ => add::<_, 72, 24>(call, name, sticking, &read, terms),
                }
            }
            (None, 1) => add::<_, 9, 3>(call, name, friction, &vectors, terms),
            (None, 4) => add::<_, 36, 12>(call, name, friction, &vectors, terms),
            (None, _) => add::<_, 63, 21>(call, name, friction, &vectors, terms),
        }
        reading.friction = Some((friction, vectors));
    }

    /// The formula of friction and the vectors that it reads.
    fn friction_law(
        &self,
        reading: &ContactReading,
        coefficient: f64,
        terms: &mut Terms<'_>,
    ) -> (ContactFriction, Vec<usize>) {
        let (mut vectors, mut spheres) = (vec![reading.span], self.spheres());
        if let (ContactSide::Plane { at, normal }, Some(turning)) = (&self.side, reading.normal) {
            let tangents = triad(normal).map(|tangent| terms.direction(at, &tangent));
            vectors.extend(tangents.map(|tangent| terms.vector(tangent)));
            vectors.push(turning);
        }
        let mut radii = [0.0; 2];
        spheres.retain(|one| one.radius > 0.0 && terms.carrier(&one.centre).is_some());
        for (sphere, radius) in spheres.iter().zip(&mut radii) {
            *radius = sphere.radius;
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            let directors = axes.map(|axis| terms.direction(&sphere.centre, &axis));
            vectors.extend(directors.map(|director| terms.vector(director)));
        }
        let friction = ContactFriction {
            law: reading.law,
            radii,
            coefficient,
            slip_speed: self.slip_speed,
        };
        (friction, vectors)
    }

    fn check_spheres(&self) -> Result<(), Fault> {
        not_negative("sphere.radius", self.sphere.radius)?;
        let mut spheres = vec![("sphere.radius", self.sphere.radius)];
        match &self.side {
            ContactSide::Plane { normal, .. } => {
                let is_unit = (normal.norm() - 1.0).abs() < 1e-9;
                refuse!(unless is_unit, Key("plane.normal");
                    value format!("{:?}", normal.as_slice()), expected DIRECTION);
            }
            ContactSide::Sphere(other) => {
                not_negative("other.radius", other.radius)?;
                spheres.push(("other.radius", other.radius));
                refuse!(if self.sphere.radius + other.radius == 0.0, Key("other.radius");
                    found "two points, which do not touch", expected "a positive radius of one of both spheres");
            }
        }
        if let ContactElasticLaw::Hertz(_) = self.elasticity {
            for (key, radius) in spheres {
                refuse!(if radius == 0.0, Key(key);
                    found "a point", expected "a positive radius, as the law of Hertz reads it");
            }
        }
        Ok(())
    }
}

/// Adds an element that reads vectors: an energy at their midpoints, a virtual work at variations, midpoints and rates.
fn add<E: Energy<M> + 'static, const M: usize, const NV: usize>(
    call: [&'static str; 2],
    name: &str,
    energy: E,
    vectors: &[usize],
    terms: &mut Terms<'_>,
) {
    let count = vectors.len();
    let vectors = std::array::from_fn(|i| match i < 2 * count {
        true => mid(vectors[i % count]),
        false => rate(vectors[i % count]),
    });
    let element: Element<E, M, NV, 0> = Element {
        energy,
        vectors,
        scalars: [],
    };
    terms.add(call[0], call[1], name, element);
}

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

impl Component for Contact {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        self.ends().to_vec()
    }

    fn outlines(&self) -> Vec<Vec<Attachment>> {
        let mut lines = Vec::new();
        if let ContactSide::Plane { at, normal } = &self.side {
            let along = self.sphere.centre.at - at.at;
            let foot = along - normal * normal.dot(&along);
            let half = (foot.norm() + 2.0 * self.sphere.radius).max(0.5 * along.norm());
            let corner = |[a, b]: [f64; 2]| {
                let [first, second] = triad(normal);
                first * (a * half) + second * (b * half)
            };
            let corners = [
                [1.0, 1.0],
                [-1.0, 1.0],
                [-1.0, -1.0],
                [1.0, -1.0],
                [1.0, 1.0],
            ];
            lines.push((*at, corners.map(corner).to_vec()));
        }
        let spheres = self.spheres();
        lines.extend(spheres.iter().map(|one| (one.centre, circles(one.radius))));
        let placed = |(point, line): (Attachment, Vec<Vector3<f64>>)| {
            let at = |step: Vector3<f64>| Attachment {
                at: point.at + step,
                ..point
            };
            line.into_iter().map(at).collect()
        };
        lines.into_iter().map(placed).collect()
    }

    fn check(&self) -> Result<(), Fault> {
        self.check_spheres()?;
        match &self.elasticity {
            ContactElasticLaw::Linear(stiffness) => positive("stiffness", *stiffness)?,
            ContactElasticLaw::Hertz(solids) => {
                refuse!(unless (1..=2).contains(&solids.len()), Key("hertz");
                    found format!("{} solids", solids.len()), expected "one elastic solid or two");
                for (index, solid) in solids.iter().enumerate() {
                    positive(format!("hertz[{index}].modulus"), solid.modulus)?;
                    let ratio = solid.poisson_ratio;
                    refuse!(unless ratio > -1.0 && ratio <= 0.5, Key(format!("hertz[{index}].poisson_ratio"));
                        value ratio, expected "a number above -1 and up to 0.5");
                }
            }
        }
        not_negative("smoothing", self.smoothing)?;
        if let Some(Restitution { coefficient, speed }) = self.restitution {
            refuse!(unless coefficient > 0.0 && coefficient <= 1.0, Key("restitution.coefficient");
                value coefficient, expected "a number above 0 and up to 1");
            positive("restitution.speed", speed)?;
        }
        not_negative("friction", self.friction.unwrap_or(0.0))?;
        positive("slip_speed", self.slip_speed)?;
        self.stick
            .map_or(Ok(()), |length| positive("stick", length))
    }

    fn is_prestressed(&self) -> bool {
        let span = self.sphere.centre.at - self.origin().at;
        let touch = self
            .law_at_reference()
            .touch([[span, Vector3::zeros()], [Vector3::zeros(); 2]]);
        touch.overlap > -0.5 * self.smoothing
    }

    fn build(&self, terms: &mut Terms<'_>) {
        let Some(mut reading) = self.reading(terms) else {
            return terms.without_each([ELASTICITY, DAMPING, FRICTION], "no contact that moves");
        };
        let call = [ELASTICITY, "stiffness of"];
        let (read, energy) = (reading.normal_vectors(), ContactElasticity(reading.law));
        match read[..] {
            [_] => add::<_, 3, 1>(call, &self.name, energy, &read, terms),
            _ => add::<_, 6, 2>(call, &self.name, energy, &read, terms),
        }
        match terms.is_of_motion() {
            true => self.add_works(&mut reading, terms),
            false => terms.without_each([DAMPING, FRICTION], "a state of rest dissipates nothing"),
        }
        terms.contacts.push(reading);
    }
}
