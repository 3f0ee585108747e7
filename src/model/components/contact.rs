//! A contact of a round shape with a plane or another round shape.

use crate::energy::{
    ContactDamping, ContactElasticity, ContactFriction, ContactLaw, CoreFriction, Cores, Energy,
    OfCores, StickingFriction, Surface, Touch,
};
use crate::functional::Element;
use crate::kinematics::MaterialVector;
use crate::math::{DIRECTION, Fault, Key, not_negative, positive, refuse};
use crate::model::components::component::Component;
use crate::model::components::contact_law::{ContactElasticLaw, Restitution};
use crate::model::components::contact_shape::{ContactShape, Core, cores};
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
    /// The round shape: a point, a sphere or, against a capsule or a box, a capsule.
    pub round: ContactShape,
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
    /// Another shape.
    Shape(ContactShape),
}

const ELASTICITY: &str = "contact elasticity";
const DAMPING: &str = "contact damping";
const FRICTION: &str = "contact friction";

impl Contact {
    /// The points between which it acts.
    pub(in crate::model) fn ends(&self) -> [Attachment; 2] {
        [self.round.centre, *self.origin()]
    }

    /// Number of the components of its elastic displacement: along a plane, or in space between spheres.
    pub(in crate::model) fn bristles(&self) -> usize {
        let holds = self.friction.is_some_and(|coefficient| coefficient > 0.0);
        match (self.stick, &self.side) {
            (Some(_), ContactSide::Plane { .. }) if holds => 2,
            (Some(_), ContactSide::Shape(_)) if holds => 3,
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
            ContactSide::Shape(other) => &other.centre,
        }
    }

    /// Its shapes.
    fn shapes(&self) -> Vec<ContactShape> {
        match self.side {
            ContactSide::Plane { .. } => vec![self.round],
            ContactSide::Shape(other) => vec![self.round, other],
        }
    }

    /// The cores of its shapes; that of the other side is none of a plane.
    fn each_core(&self) -> [Option<Core>; 2] {
        let other = match &self.side {
            ContactSide::Plane { .. } => None,
            ContactSide::Shape(other) => other.core(),
        };
        [self.round.core(), other]
    }

    /// The cores of both shapes; none between points and planes.
    fn cores(&self) -> Option<Cores> {
        let [round, other] = &self.each_core();
        cores([round, other], self.round.radius + self.other_radius())
    }

    /// The axes of the cores, that of the round shape first: unit vectors in the reference configuration with points of their bodies.
    fn axes(&self) -> Vec<(Attachment, Vector3<f64>)> {
        let of = |(end, core): (Attachment, Option<Core>)| {
            let core = core.into_iter();
            core.flat_map(move |core| {
                let count = core.half_lengths.len();
                core.directions
                    .into_iter()
                    .take(count)
                    .map(move |axis| (end, axis))
            })
        };
        let ends = self.ends().into_iter();
        ends.zip(self.each_core()).flat_map(of).collect()
    }

    /// Radius of the other side, zero of a plane.
    fn other_radius(&self) -> f64 {
        match &self.side {
            ContactSide::Plane { .. } => 0.0,
            ContactSide::Shape(other) => other.radius,
        }
    }

    /// The law on a surface.
    fn law(&self, surface: Surface) -> ContactLaw {
        let (a, b) = (self.round.radius, self.other_radius());
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
    pub(super) fn law_at_reference(&self) -> ContactLaw {
        self.law(match self.side {
            ContactSide::Plane { normal, .. } => Surface::Plane(normal),
            ContactSide::Shape(_) => Surface::Sphere,
        })
    }

    /// Overlap and normal force in the reference configuration, at rest.
    fn touch_at_reference(&self) -> Touch {
        let (law, span) = (
            self.law_at_reference(),
            self.round.centre.at - self.origin().at,
        );
        let still = [Vector3::zeros(); 5];
        match self.cores() {
            Some(cores) => {
                let axes = self.axes().into_iter().map(|(_, axis)| axis);
                let at: Vec<Vector3<f64>> = [span].into_iter().chain(axes).collect();
                cores.touch(&law, &at, &still)
            }
            None => law.touch([[span, Vector3::zeros()], [Vector3::zeros(); 2]]),
        }
    }

    /// The normal force with the vectors that it reads; `None` where no side moves.
    pub(crate) fn reading(&self, terms: &mut Terms<'_>) -> Option<ContactReading> {
        let span = match self.round.node {
            None => terms.span(self.origin(), &self.round.centre)?,
            Some(node) => terms.span_to_node(self.origin(), node)?,
        };
        let normal = self.turning_normal(terms);
        let axes = self.axes().into_iter().map(|(end, axis)| {
            let axis = terms.direction(&end, &axis);
            terms.vector(axis)
        });
        let axes = axes.collect();
        Some(ContactReading {
            name: self.name.clone(),
            law: self.law(match self.side {
                ContactSide::Plane { .. } if normal.is_some() => Surface::MovingPlane,
                ContactSide::Plane { normal, .. } => Surface::Plane(normal),
                ContactSide::Shape(_) => Surface::Sphere,
            }),
            span,
            normal,
            cores: self.cores(),
            axes,
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
            ContactSide::Plane { .. } | ContactSide::Shape(_) => None,
        }
    }

    /// Adds the virtual works of a motion, and completes what is read of it.
    fn add_works(&self, reading: &mut ContactReading, terms: &mut Terms<'_>) {
        let (name, law) = (&self.name, reading.law);
        let call = [DAMPING, "restitution of"];
        let (read, damping) = (reading.normal_vectors(), ContactDamping(law));
        match (reading.cores, read.len()) {
            _ if law.damping == 0.0 => {
                terms.without(
                    DAMPING,
                    "no contact that moves names a restitution below one",
                );
            }
            (Some(cores), count) => {
                let damping = OfCores { of: damping, cores };
                match count {
                    2 => add::<_, 18, 6>(call, name, damping, &read, terms),
                    3 => add::<_, 27, 9>(call, name, damping, &read, terms),
                    4 => add::<_, 36, 12>(call, name, damping, &read, terms),
                    _ => add::<_, 45, 15>(call, name, damping, &read, terms),
                }
            }
            (None, 1) => add::<_, 9, 3>(call, name, damping, &read, terms),
            (None, _) => add::<_, 18, 6>(call, name, damping, &read, terms),
        }
        let Some(coefficient) = self.friction else {
            return terms.without(FRICTION, "no contact that moves names a friction");
        };
        let (friction, vectors) = self.friction_law(reading, coefficient, terms);
        match reading.cores {
            Some(cores) => self.add_core_friction(friction, cores, &vectors, terms),
            None => self.add_friction(friction, &vectors, reading, terms),
        }
        reading.friction = Some((friction, vectors));
    }

    /// Adds friction between spheres or on a plane.
    fn add_friction(
        &self,
        friction: ContactFriction,
        vectors: &[usize],
        reading: &mut ContactReading,
        terms: &mut Terms<'_>,
    ) {
        let (name, call) = (&self.name, [FRICTION, "friction of"]);
        let bristles = terms.bristles.get(name).cloned();
        match (self.stick.zip(bristles), vectors.len()) {
            (Some((displacement, coordinates)), count) => {
                let bristle = terms.vector(self.bristle(coordinates, reading.law.surface));
                // Half of critical damping, of a body under its own weight.
                let weight = friction.coefficient * terms.gravity_size();
                let damping = match weight > 0.0 {
                    true => (displacement / weight).sqrt(),
                    false => 0.0,
                };
                reading.bristle = Some((bristle, damping));
                let read = [vectors, &[bristle]].concat();
                let sticking = StickingFriction {
                    friction,
                    displacement,
                    damping,
                };
                match count {
                    1 => add::<_, 18, 6>(call, name, sticking, &read, terms),
                    4 => add::<_, 45, 15>(call, name, sticking, &read, terms),
                    _ => add::<_, 72, 24>(call, name, sticking, &read, terms),
                }
            }
            (None, 1) => add::<_, 9, 3>(call, name, friction, vectors, terms),
            (None, 4) => add::<_, 36, 12>(call, name, friction, vectors, terms),
            (None, _) => add::<_, 63, 21>(call, name, friction, vectors, terms),
        }
    }

    /// Adds friction between shapes with cores.
    fn add_core_friction(
        &self,
        friction: ContactFriction,
        cores: Cores,
        vectors: &[usize],
        terms: &mut Terms<'_>,
    ) {
        /// Friction of a form of `C` vectors.
        fn of<const C: usize>(friction: ContactFriction, cores: Cores) -> CoreFriction<C> {
            CoreFriction { friction, cores }
        }
        let (name, call) = (&self.name, [FRICTION, "friction of"]);
        match (self.axes().len(), vectors.len()) {
            (1, 4) => add::<_, 36, 12>(call, name, of::<2>(friction, cores), vectors, terms),
            (1, _) => add::<_, 63, 21>(call, name, of::<2>(friction, cores), vectors, terms),
            (2, _) => add::<_, 63, 21>(call, name, of::<3>(friction, cores), vectors, terms),
            (3, 4) => add::<_, 36, 12>(call, name, of::<4>(friction, cores), vectors, terms),
            (3, _) => add::<_, 63, 21>(call, name, of::<4>(friction, cores), vectors, terms),
            (_, _) => add::<_, 63, 21>(call, name, of::<5>(friction, cores), vectors, terms),
        }
    }

    /// The formula of friction and the vectors that it reads.
    fn friction_law(
        &self,
        reading: &ContactReading,
        coefficient: f64,
        terms: &mut Terms<'_>,
    ) -> (ContactFriction, Vec<usize>) {
        let mut vectors = vec![reading.span];
        if let (ContactSide::Plane { at, normal }, Some(turning)) = (&self.side, reading.normal) {
            let tangents = triad(normal).map(|tangent| terms.direction(at, &tangent));
            vectors.extend(tangents.map(|tangent| terms.vector(tangent)));
            vectors.push(turning);
        }
        let (mut radii, mut count) = ([0.0; 2], 0);
        for (shape, core) in self.shapes().into_iter().zip(self.each_core()) {
            let turns = shape.radius > 0.0 && terms.carrier(&shape.centre).is_some();
            if core.is_none() && !turns {
                continue;
            }
            radii[count] = shape.radius;
            count += 1;
            let ground = [Vector3::x(), Vector3::y(), Vector3::z()];
            let axes = core.map_or(ground, |core| core.directions);
            let directors = axes.map(|axis| terms.direction(&shape.centre, &axis));
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

    /// Lines that show its shapes and its plane, but those that one of these contacts before it draws, and nodes, which their block draws.
    pub fn drawn_among(&self, contacts: &[Self]) -> Vec<Vec<Attachment>> {
        let before = contacts.iter().take_while(|one| one.name != self.name);
        let drawn: Vec<_> = before.flat_map(Self::shapes).collect();
        let is_new = |shape: &ContactShape| shape.node.is_none() && !drawn.contains(shape);
        let line = |shape: ContactShape| {
            let line = shape.outline().into_iter();
            line.map(|step| from(&shape.centre, step)).collect()
        };
        let shapes = self.shapes().into_iter().filter(is_new).map(line);
        shapes.chain(self.plane_outline(contacts)).collect()
    }

    /// A square on the plane of the contact, as large as all of these contacts with it need, of which the first draws it.
    fn plane_outline(&self, contacts: &[Self]) -> Option<Vec<Attachment>> {
        let ContactSide::Plane { at, normal } = &self.side else {
            return None;
        };
        let alike = contacts.iter().filter(|one| one.side == self.side);
        let is_first = |first: &Self| first.name == self.name;
        alike.clone().next().filter(|first| is_first(first))?;
        let reach = |one: &Self| {
            let along = one.round.centre.at - at.at;
            let foot = along - normal * normal.dot(&along);
            (foot.norm() + 2.0 * one.round.radius).max(0.5 * along.norm())
        };
        let half = alike.map(reach).fold(0.0, f64::max);
        let [first, second] = triad(normal).map(|tangent| tangent * half);
        let corners = [
            first + second,
            second - first,
            -first - second,
            first - second,
            first + second,
        ];
        Some(corners.map(|step| from(at, step)).to_vec())
    }

    fn check_shapes(&self) -> Result<(), Fault> {
        self.round.check("sphere")?;
        let mut shapes = vec![("sphere.radius", self.round)];
        let [round, core] = self.each_core();
        let axes = round.as_ref().map_or(0, |core| core.half_lengths.len());
        refuse!(if axes > 1, Key("sphere");
            found "a box", expected "a point, a sphere or a capsule, as boxes do not touch each other");
        match &self.side {
            ContactSide::Plane { normal, .. } => {
                let is_unit = (normal.norm() - 1.0).abs() < 1e-9;
                refuse!(unless is_unit, Key("plane.normal");
                    value format!("{:?}", normal.as_slice()), expected DIRECTION);
                refuse!(if axes > 0, Key("sphere");
                    found "a capsule on a plane", expected "a contact for each of its ends");
            }
            ContactSide::Shape(other) => {
                other.check("other")?;
                refuse!(if other.node.is_some(), Key("other");
                    found "a node", expected "a shape of a body, as a node is the round side");
                shapes.push(("other.radius", *other));
                refuse!(if self.round.radius + other.radius == 0.0, Key("other.radius");
                    found "no radius of either side", expected "a positive radius of one of both, as points and edges do not touch");
                refuse!(if axes > 0 && core.is_none(), Key("other");
                    found "a sphere", expected "a capsule or a box, as a sphere that touches a capsule is the round side");
                let deepest = DEEPEST * self.law_at_reference().distance;
                let is_apart =
                    self.cores().is_none() || self.touch_at_reference().overlap < deepest;
                refuse!(unless is_apart, Key("sphere");
                    found "a shape whose core meets that of the other one", expected "cores apart");
            }
        }
        if let ContactElasticLaw::Hertz(_) = self.elasticity {
            for (key, shape) in shapes {
                refuse!(if shape.core().is_some(), Key("hertz");
                    found "the law of spheres", expected "a \"stiffness\" of a capsule or a box");
                refuse!(if shape.radius == 0.0, Key(key);
                    found "a point", expected "a positive radius, as the law of Hertz reads it");
            }
        }
        refuse!(if self.stick.is_some() && self.cores().is_some(), Key("stick");
            found "a capsule or a box that sticks", expected "friction without it, which points and spheres have");
        Ok(())
    }
}

/// The point of the body at a step from another one.
fn from(point: &Attachment, step: Vector3<f64>) -> Attachment {
    Attachment {
        at: point.at + step,
        ..*point
    }
}

/// Overlap of shapes beyond which their cores are said to meet, in distances of the cores in touch.
const DEEPEST: f64 = 0.9;

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

impl Component for Contact {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        self.ends().to_vec()
    }

    fn nodes(&self) -> Vec<[usize; 2]> {
        self.round.node.into_iter().collect()
    }

    fn outlines(&self) -> Vec<Vec<Attachment>> {
        Vec::new()
    }

    fn check(&self) -> Result<(), Fault> {
        self.check_shapes()?;
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
        self.touch_at_reference().overlap > -0.5 * self.smoothing
    }

    fn build(&self, terms: &mut Terms<'_>) {
        let Some(mut reading) = self.reading(terms) else {
            return terms.without_each([ELASTICITY, DAMPING, FRICTION], "no contact that moves");
        };
        let call = [ELASTICITY, "stiffness of"];
        let (read, energy) = (reading.normal_vectors(), ContactElasticity(reading.law));
        let name = &self.name;
        match (reading.cores, read.len()) {
            (Some(cores), count) => {
                let energy = OfCores { of: energy, cores };
                match count {
                    2 => add::<_, 6, 2>(call, name, energy, &read, terms),
                    3 => add::<_, 9, 3>(call, name, energy, &read, terms),
                    4 => add::<_, 12, 4>(call, name, energy, &read, terms),
                    _ => add::<_, 15, 5>(call, name, energy, &read, terms),
                }
            }
            (None, 1) => add::<_, 3, 1>(call, name, energy, &read, terms),
            (None, _) => add::<_, 6, 2>(call, name, energy, &read, terms),
        }
        match terms.is_of_motion() {
            true => self.add_works(&mut reading, terms),
            false => terms.without_each([DAMPING, FRICTION], "a state of rest dissipates nothing"),
        }
        terms.contacts.push(reading);
    }
}
