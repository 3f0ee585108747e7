//! Bodies, joints, muscles, markers, solids, elastomers, springs, loads and components of other crates, built with defaults.

use crate::interface::handle::{Carrier, Handle, Part, builder, makers, named};
use crate::math::{Matrix, Signal};
use crate::mesh::Mesh;
use crate::model::components::{
    BlockLoad, Contact, ContactElasticLaw, ContactShape, ContactSide, ElasticSolid, Faces, Load,
    LoadPlace, Other, Restitution, SLIP_SPEED, Spring, Tendon,
};
use crate::model::system::{
    Attachment, Body, Circuit, Discretisation, ElasticLaw, ElectricConstants, Electrode,
    ElementKind, Fidelity, Joint, JointKind, JointSpring, JointStops, Marker, Material,
    MaxwellBranch, MaxwellBranches, Muscle, Potential, Shape, Solid, Support, directors_along,
};
use crate::model::{Component, System};
use nalgebra::Vector3;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// A point of a body or the ground in mm.
pub(super) fn attachment(carrier: impl Into<Carrier>, at: Vector3<f64>) -> Attachment {
    Attachment {
        body: carrier.into().0,
        at,
    }
}

/// Declares parts by their lists in a system and the words that names are made of.
macro_rules! parts {
    ($($part:ident in $($list:ident).+: $word:literal;)*) => {
        $(
            impl $part {
                /// A name of its own.
                pub fn named(self, name: impl Into<String>) -> Self {
                    let name = name.into();
                    Self { name, ..self }
                }
            }

            impl Part for $part {
                fn join(mut self, system: &mut System) -> usize {
                    let list = &mut system.$($list).+;
                    self.name = named(self.name, $word, list.len());
                    list.push(self);
                    list.len() - 1
                }
            }
        )*
    };
}

parts! {
    Body in bodies: "body";
    Joint in joints: "joint";
    Muscle in muscles: "muscle";
    Solid in solids: "solid";
    Marker in markers: "marker";
    Load in components.loads: "load";
    Spring in components.springs: "spring";
    Tendon in components.tendons: "tendon";
    Contact in components.contacts: "contact";
}

makers! {
    impl Body => Self;
    /// A homogeneous cylinder along z, lengths in mm.
    cylinder(length: f64, radius: f64) = Self::from_shape(Shape::Cylinder { length, radius });
    /// A homogeneous box with edges along the axes, lengths in mm.
    cuboid(size: [f64; 3]) = Self::from_shape(Shape::Box { size });
    /// A homogeneous sphere, radius in mm.
    sphere(radius: f64) = Self::from_shape(Shape::Sphere { radius });
}

impl Body {
    /// Density in g/mm³, which gives the mass; a body without a volume keeps its mass.
    pub fn density(self, density: f64) -> Self {
        match self.shape.volume() {
            Some(volume) => self.mass(density * volume),
            None => self,
        }
    }
}

builder! {
    impl Body;
    /// Mass in g; the moments of inertia follow from the shape.
    mass(mass: f64) |of| (of.mass, of.inertia) = (mass, of.shape.inertia(mass));
    /// Principal moments of inertia in g mm² in place of those of its shape.
    inertia(inertia: [f64; 3]) |of| of.inertia = inertia;
    /// Centre of mass in mm.
    at(centre: Vector3<f64>) |of| of.centre = centre;
    /// Direction of the third director, which is the axis of a cylinder.
    along(axis: Vector3<f64>) |of| of.directors = directors_along(&axis.normalize());
}

makers! {
    impl Joint => JointKind;
    /// A hinge about an axis.
    revolute(axis: Vector3<f64>) = JointKind::Revolute { axis: axis.normalize() };
    /// A slide along an axis.
    prismatic(axis: Vector3<f64>) = JointKind::Prismatic { axis: axis.normalize() };
    /// A slide along an axis that also turns about it.
    cylindrical(axis: Vector3<f64>) = JointKind::Cylindrical { axis: axis.normalize() };
    /// A slide in a plane across a normal that also turns about it.
    planar(normal: Vector3<f64>) = JointKind::Planar { normal: normal.normalize() };
}

impl Joint {
    /// A Cardan joint about an axis of the parent and one of the child, made perpendicular to it.
    ///
    /// # Panics
    /// The axes are parallel.
    pub fn universal([first, second]: [Vector3<f64>; 2]) -> JointKind {
        let first = first.normalize();
        let across = second - first * first.dot(&second);
        assert!(
            across.norm() > 0.0,
            "the axes of a universal joint are not parallel"
        );
        let axes = [first, across.normalize()];
        JointKind::Universal { axes }
    }
}

builder! {
    impl Joint;
    /// Place in mm, in the reference configuration.
    at(at: Vector3<f64>) |of| of.at = at;
    /// Damping of its coordinate: N mm ms of an angle, N ms/mm of a displacement.
    damping(damping: f64) |of| of.damping = Some(damping);
    /// Spring of its coordinate: stiffness in N mm/rad or N/mm, and the coordinate in rad or mm at which it exerts no force.
    spring(stiffness: f64, rest: f64) |of| of.spring = Some(JointSpring { stiffness, rest });
    /// Prescribes its coordinate in rad or mm as a function of time.
    motion(motion: impl Into<Signal>) |of| of.motion = Some(motion.into());
    /// Elastic stops of its coordinate at both ends of a range in rad or mm, infinite where there is none; stiffness in N mm/rad or N/mm.
    /// It grows over a width around each, or jumps where that is zero.
    stops(range: RangeInclusive<f64>, stiffness: f64, smoothing: f64) |of| {
        let at = [*range.start(), *range.end()];
        of.stops = Some(JointStops { at, stiffness, smoothing });
    };
}

impl JointKind {
    /// The joint between a parent and a child, at the origin.
    pub fn between(self, parent: impl Into<Carrier>, child: Handle<Body>) -> Joint {
        Joint {
            kind: self,
            parent: parent.into().0,
            child: child.index(),
            ..Joint::default()
        }
    }
}

makers! {
    impl Muscle => Self;
    /// A stack of a material, which still needs its ends, its section and its layers.
    of(material: &Material) = Self { material: *material, ..Self::default() };
}

builder! {
    impl Muscle;
    /// A resistance in Ω between its source and its electrodes.
    resistance(resistance: f64) |of| of.circuit.get_or_insert_default().resistance = Some(resistance);
    /// A leak of a resistance in Ω parallel to its electrodes.
    leakage(leakage: f64) |of| of.circuit.get_or_insert_default().leakage = Some(leakage);
    /// Trilinear hexahedra in place of one stretch: elements across both sides and along the span, each along the span a layer of
    /// the model. The material needs its Poisson ratio.
    finite_elements(elements: [usize; 3]) |of| {
        of.fidelity = Fidelity::FiniteElements(Discretisation {
            elements,
            layers: elements[2],
            element: ElementKind::Hex8,
            first_side: None,
        });
    };
    /// Direction of the first side of the cross-section in the ground frame, of finite elements; a lumped muscle has none.
    first_side(direction: Vector3<f64>) |of| {
        if let Fidelity::FiniteElements(discretisation) = &mut of.fidelity {
            discretisation.first_side = Some(direction);
        }
    };
    /// Sets its start: a body or the ground, and a place in mm.
    from(carrier: impl Into<Carrier>, at: Vector3<f64>) |of| of.from = attachment(carrier, at);
    /// Sets its end.
    to(carrier: impl Into<Carrier>, at: Vector3<f64>) |of| of.to = attachment(carrier, at);
    /// Stretch before it is glued between its ends: its rest length is their distance divided by it.
    prestretch(stretch: f64) |of| of.prestretch = Some(stretch);
    /// Sides of its rectangular cross-section at rest in mm.
    section(width: f64, depth: f64) |of| of.cross_section = [width, depth];
    /// Thickness of one layer at rest in mm.
    layer(thickness: f64) |of| of.layer_thickness = thickness;
}

makers! {
    impl Marker => Self;
    /// A point of a body or of the ground, in mm.
    on(carrier: impl Into<Carrier>, at: Vector3<f64>) = Self {
        name: String::new(),
        point: attachment(carrier, at),
        solid: None,
    };
    /// The node of a solid that is nearest to a place in mm.
    on_solid(solid: Handle<Solid>, at: Vector3<f64>) = Self {
        solid: Some(solid.index()),
        ..Self::on(super::GROUND, at)
    };
}

makers! {
    impl Solid => Self;
    /// A solid of one material on a mesh.
    on(mesh: Mesh, material: &Material) = Self {
        materials: vec![*material; mesh.region_names.len()],
        element: ElementKind::of_mesh(&mesh),
        mesh,
        ..Self::default()
    };
}

impl Solid {
    /// Nodes of a set of the mesh, such as `z_min`; none where there is no such set, which a check of the system reports.
    pub(super) fn nodes(&self, set: &str) -> Vec<usize> {
        self.mesh.sets.get(set).cloned().unwrap_or_default()
    }
}

builder! {
    impl Solid;
    /// Thickness of a membrane without stress in mm, whose mesh is one of triangles.
    thickness(thickness: f64) |of| of.thickness = Some(thickness);
    /// Stretches along x, y, z before it was glued and held, by which the mesh differs from the solid without stress.
    prestretch(stretches: [f64; 3]) |of| of.prestretch = Some(Matrix::from_diagonal(&stretches.into()));
    /// Holds the nodes of a set of the mesh, such as `z_min`.
    clamped(set: &str) |of| {
        let nodes = of.nodes(set);
        of.supports.push(Support { nodes, held: [true; 3] });
    };
    /// An electrode on the nodes of a set of the mesh.
    electrode(name: &str, set: &str, potential: Potential) |of| {
        let (name, nodes) = (name.to_owned(), of.nodes(set));
        of.electrodes.push(Electrode { name, nodes, potential, circuit: None });
    };
    /// Puts a circuit between the electrode that was added last and its source. Nothing without an electrode.
    behind(circuit: Circuit) |of| {
        if let Some(last) = of.electrodes.last_mut() {
            last.circuit = Some(circuit);
        }
    };
}

makers! {
    impl Material => Self;
    /// A neo-Hookean elastomer with a shear modulus in MPa, without density, permittivity or viscosity so far.
    elastomer(shear_modulus: f64) = Self { shear_modulus, ..Self::default() };
}

impl Material {
    /// One more Maxwell branch: shear modulus μ₁ of its spring in MPa, relaxation time in ms.
    ///
    /// # Panics
    /// It has five.
    pub fn maxwell(self, shear_modulus: f64, relaxation_time: f64) -> Self {
        let mut branches = self.maxwell.list().to_vec();
        branches.push(MaxwellBranch {
            shear_modulus,
            relaxation_time,
        });
        let maxwell = MaxwellBranches::new(&branches).expect("five branches at most");
        Self { maxwell, ..self }
    }
}

builder! {
    impl Material;
    /// Poisson ratio, which finite elements need: λ = 2 μ ν/(1 − 2 ν).
    poisson_ratio(ratio: f64) |of| of.lame_lambda = Some(Self::first_lame_constant(of.shear_modulus, ratio));
    /// Law of elasticity in place of the neo-Hookean one, with the same shear modulus at small strains.
    law(law: ElasticLaw) |of| of.law = Some(law);
    /// Smallest and largest stretch for which the constants hold: a lumped muscle beyond them is a warning.
    stretch_range(range: [f64; 2]) |of| of.stretch_range = Some(range);
    /// Density in g/mm³.
    density(density: f64) |of| of.density = Some(density);
    /// Relative permittivity of a dielectric whose polarisation is linear in the reference field (c₁ = −(ε_r − 1) ε₀,
    /// c₂ = (ε_r − 1) ε₀/2).
    relative_permittivity(ratio: f64) |of| of.electric = Some(ElectricConstants::first_order(ratio));
    /// Relative permittivity of an ideal dielectric.
    ideal_dielectric(ratio: f64) |of| of.electric = Some(ElectricConstants::ideal(ratio));
    /// Viscosity in MPa ms.
    viscosity(viscosity: f64) |of| of.viscosity = Some(viscosity);
}

impl Potential {
    /// Zero.
    pub const GROUNDED: Self = Self::Given(0.0);
    /// The voltage that is given or sought under the name of the electrode.
    pub const DRIVEN: Self = Self::Driven {
        source: 0,
        factor: 1.0,
    };
}

impl Spring {
    /// A spring between two points in mm, without force in the reference configuration, without stiffness or damping so far.
    pub fn between(
        from: (impl Into<Carrier>, Vector3<f64>),
        to: (impl Into<Carrier>, Vector3<f64>),
    ) -> Self {
        Self {
            name: String::new(),
            rest_length: (to.1 - from.1).norm(),
            from: attachment(from.0, from.1),
            to: attachment(to.0, to.1),
            stiffness: None,
            damping: None,
        }
    }
}

builder! {
    impl Spring;
    /// Stiffness in N/mm.
    stiffness(stiffness: f64) |of| of.stiffness = Some(stiffness);
    /// Damping in N ms/mm.
    damping(damping: f64) |of| of.damping = Some(damping);
    /// Length without force in mm.
    rest_length(rest_length: f64) |of| of.rest_length = rest_length;
}

impl Contact {
    /// A sphere on a plane: a carrier, the centre in mm and the radius in mm, zero of a point; a carrier, a point of the plane in mm and its
    /// normal towards the sphere. Without stiffness so far.
    pub fn on_plane(
        sphere: (impl Into<Carrier>, Vector3<f64>, f64),
        plane: (impl Into<Carrier>, Vector3<f64>, Vector3<f64>),
    ) -> Self {
        let normal = plane.2.normalize();
        let at = attachment(plane.0, plane.1);
        let plane = ContactSide::Plane { at, normal };
        touching(ContactShape::sphere(sphere.0, sphere.1, sphere.2), plane)
    }

    /// Two spheres, each a carrier, the centre in mm and the radius in mm, one of them zero of a point. Without stiffness so far.
    pub fn of_spheres(
        one: (impl Into<Carrier>, Vector3<f64>, f64),
        other: (impl Into<Carrier>, Vector3<f64>, f64),
    ) -> Self {
        let one = ContactShape::sphere(one.0, one.1, one.2);
        let other = ContactShape::sphere(other.0, other.1, other.2);
        touching(one, ContactSide::Shape(other))
    }

    /// Two shapes, of which no more than one is a box. Without stiffness so far.
    pub fn of_shapes(one: ContactShape, other: ContactShape) -> Self {
        let [round, other] = ContactShape::by_axes([one, other]);
        touching(round, ContactSide::Shape(other))
    }
}

impl ContactShape {
    /// A sphere of a body or the ground: its centre and radius in mm, zero of a point.
    pub fn sphere(carrier: impl Into<Carrier>, centre: Vector3<f64>, radius: f64) -> Self {
        Self {
            centre: attachment(carrier, centre),
            radius,
            ..Self::default()
        }
    }

    /// A capsule of a body or the ground: both centres of its ends and its radius in mm.
    pub fn capsule(carrier: impl Into<Carrier>, ends: [Vector3<f64>; 2], radius: f64) -> Self {
        let [from, to] = ends;
        let half = (to - from) * 0.5;
        Self {
            axes: [half, Vector3::zeros(), Vector3::zeros()],
            ..Self::sphere(carrier, (from + to) * 0.5, radius)
        }
    }

    /// A box of a body or the ground: its centre, three half axes at right angles to the faces and the radius of its edges in mm.
    pub fn cuboid(
        carrier: impl Into<Carrier>,
        centre: Vector3<f64>,
        half_axes: [Vector3<f64>; 3],
        radius: f64,
    ) -> Self {
        let core = |axis: Vector3<f64>| axis * (1.0 - radius / axis.norm()).max(0.0);
        Self {
            axes: half_axes.map(core),
            ..Self::sphere(carrier, centre, radius)
        }
    }
}

fn touching(round: ContactShape, side: ContactSide) -> Contact {
    Contact {
        name: String::new(),
        round,
        side,
        elasticity: ContactElasticLaw::Linear(0.0),
        smoothing: 0.0,
        restitution: None,
        friction: None,
        slip_speed: SLIP_SPEED,
        stick: None,
    }
}

builder! {
    impl Contact;
    /// Force for an overlap in N/mm.
    stiffness(stiffness: f64) |of| of.elasticity = ContactElasticLaw::Linear(stiffness);
    /// Law of Hertz for an elastic solid on a rigid one, or for two, by Young's modulus in MPa and the Poisson ratio of each.
    hertz(solids: &[[f64; 2]]) |of| {
        let solid = |&[modulus, poisson_ratio]: &[f64; 2]| ElasticSolid { modulus, poisson_ratio };
        of.elasticity = ContactElasticLaw::Hertz(solids.iter().map(solid).collect());
    };
    /// Width in mm of the overlap around zero over which the stiffness grows, for optimal control.
    smoothing(width: f64) |of| of.smoothing = width;
    /// Speed after an impact over the speed before it, at a speed in mm/ms.
    restitution(coefficient: f64, speed: f64) |of| of.restitution = Some(Restitution { coefficient, speed });
    /// Coefficient of friction.
    friction(coefficient: f64) |of| of.friction = Some(coefficient);
    /// Speed in mm/ms of slip up to which friction grows: what sticks creeps at a part of it.
    slip_speed(speed: f64) |of| of.slip_speed = speed;
    /// Greatest elastic displacement in mm of friction that sticks and does not creep.
    stick(displacement: f64) |of| of.stick = Some(displacement);
}

makers! {
    impl Load => Self;
    /// A force at a point of a body in mm, along a direction that does not turn.
    force(body: Handle<Body>, at: Vector3<f64>, direction: Vector3<f64>) = at_point(body, at, direction, false);
    /// A force at a point of a body in mm, along a direction that turns with the body.
    following_force(body: Handle<Body>, at: Vector3<f64>, direction: Vector3<f64>) = at_point(body, at, direction, true);
    /// A traction on faces of a solid (see [`Mesh::faces_of`](crate::mesh::Mesh::faces_of)), along a direction that does not turn.
    traction(solid: Handle<Solid>, faces: Faces, direction: Vector3<f64>) = on_block(solid, BlockLoad::Traction(faces, direction.normalize()));
    /// A pressure on faces of a solid, which follows them as they deform.
    pressure(solid: Handle<Solid>, faces: Faces) = on_block(solid, BlockLoad::Pressure { faces, follows: true });
    /// A pressure on faces of a solid as they are in the reference configuration.
    dead_pressure(solid: Handle<Solid>, faces: Faces) = on_block(solid, BlockLoad::Pressure { faces, follows: false });
    /// A surface charge on faces of a solid.
    charge(solid: Handle<Solid>, faces: Faces) = on_block(solid, BlockLoad::Charge(faces));
    /// A body force of a solid, along a direction that does not turn.
    body_force(solid: Handle<Solid>, direction: Vector3<f64>) = on_block(solid, BlockLoad::BodyForce(direction.normalize()));
    /// A motor: a torque about the axis of a revolute joint, or a force along that of a prismatic one, from the parent on the child.
    motor(joint: Handle<Joint>) = load(LoadPlace::Joint(joint.index()));
    /// The charge of a lumped muscle, in place of a voltage.
    charge_of(muscle: Handle<Muscle>) = load(LoadPlace::Muscle(muscle.index()));
}

fn load(on: LoadPlace) -> Load {
    let name = String::new();
    Load { name, on }
}

fn at_point(body: Handle<Body>, at: Vector3<f64>, direction: Vector3<f64>, follows: bool) -> Load {
    load(LoadPlace::Point {
        at: attachment(body, at),
        direction: direction.normalize(),
        follows,
    })
}

fn on_block(solid: Handle<Solid>, load: BlockLoad) -> Load {
    let block = solid.index();
    self::load(LoadPlace::Block { block, load })
}

impl Part for Arc<dyn Component> {
    fn join(self, system: &mut System) -> usize {
        let others = &mut system.components.others;
        others.push(Other(self));
        others.len() - 1
    }
}
