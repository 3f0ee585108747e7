//! Systems that together call for every effect and joint.

pub use super::loaded::{loaded, pressed};
use super::trunk;
use nalgebra::{Matrix3, Rotation3, Vector3};
use proboscis::mesh::grid::Grid;
use proboscis::model::components::{
    Contact, ContactElasticLaw, ContactShape, ContactSide, ElasticSolid, Load, LoadPlace,
    Restitution, Spring, Tendon,
};
use proboscis::model::system::{
    Attachment, Body, Discretisation, ElasticLaw, ElectricConstants, Electrode, ElementKind,
    Fidelity, Glue, Joint, JointKind, JointSpring, JointStops, Marker, Material, Muscle, Potential,
    Shape, Solid, Support, System, VACUUM_PERMITTIVITY,
};

/// Gravity along −y in mm/ms².
pub const GRAVITY: Vector3<f64> = Vector3::new(0.0, -9.81e-3, 0.0);

/// The three muscles of the branched tree that take a voltage, at 900 V each; the fourth is passive.
pub const BRANCHED_VOLTAGES: [f64; 4] = [900.0, 900.0, 900.0, 0.0];

/// A prestressed spring with a damper from the ground to the second segment of a trunk, a damper between both segments, and a
/// taut tendon through all three.
pub fn tied(mut system: System) -> System {
    let point = |body, x: f64, y: f64, z: f64| Attachment {
        body,
        at: Vector3::new(x, y, z),
    };
    let spring = |name: &str, stiffness, from, to| Spring {
        name: name.into(),
        from,
        to,
        stiffness,
        damping: Some(0.4),
        rest_length: 40.0,
    };
    let (low, high) = (
        point(None, 30.0, -10.0, 4.0),
        point(Some(1), 5.0, 80.0, 12.0),
    );
    let across = point(Some(0), -8.0, 20.0, 9.0);
    system.components.springs = vec![
        spring("stay", Some(0.02), low, high),
        spring("dashpot", None, across, high),
    ];
    let through = vec![
        point(None, -12.0, -30.0, 3.0),
        point(None, -12.0, -5.0, 3.0),
        point(Some(0), -12.0, 12.0, 5.0),
        point(Some(0), -11.0, 40.0, 6.0),
        point(Some(1), -10.0, 75.0, 2.0),
    ];
    system.components.tendons = vec![Tendon {
        name: "cord".into(),
        through,
        stiffness: 0.01,
        rest_length: 80.0,
        smoothing: 0.0,
    }];
    system
}

/// A chain of two bodies or more with contacts that are felt from afar: with planes of the ground and of a body, and between bodies, of which
/// those of two bodies stick.
pub fn touching(mut system: System) -> System {
    let point = |body, x: f64, y: f64, z: f64| Attachment {
        body,
        at: Vector3::new(x, y, z),
    };
    let contact = |name: &str, centre, radius, side| Contact {
        name: name.into(),
        round: ContactShape {
            centre,
            radius,
            ..ContactShape::default()
        },
        side,
        elasticity: ContactElasticLaw::Linear(0.02),
        smoothing: 60.0,
        restitution: Some(Restitution {
            coefficient: 0.6,
            speed: 1.0,
        }),
        friction: Some(0.3),
        slip_speed: 0.5,
        stick: None,
    };
    let wall = ContactSide::Plane {
        at: point(None, -5.0, 0.0, 0.0),
        normal: Vector3::x(),
    };
    let lid = ContactSide::Plane {
        at: point(Some(0), 0.0, 45.0, 0.0),
        normal: Vector3::y(),
    };
    let other = ContactSide::Shape(ContactShape {
        centre: point(Some(0), 0.0, 30.0, 5.0),
        radius: 15.0,
        ..ContactShape::default()
    });
    let solid = ElasticSolid {
        modulus: 0.01,
        poisson_ratio: 0.4,
    };
    system.components.contacts = vec![
        contact("wall", point(Some(1), 5.0, 80.0, 12.0), 8.0, wall),
        Contact {
            stick: Some(2.0),
            ..contact("lid", point(Some(1), 3.0, 60.0, 4.0), 6.0, lid)
        },
        Contact {
            stick: Some(3.0),
            elasticity: ContactElasticLaw::Hertz(vec![solid; 2]),
            ..contact("own", point(Some(1), 0.0, 70.0, 0.0), 12.0, other)
        },
    ];
    system
}

/// The same with shapes in the place of spheres: a ball and a capsule at a plate of the ground, and a capsule at one of the other body.
pub fn touching_shapes(system: System) -> System {
    let mut system = touching(system);
    let axis = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
    let plate = ContactSide::Shape(ContactShape {
        centre: Attachment {
            body: None,
            at: axis(-15.0, 70.0, 0.0),
        },
        radius: 2.0,
        axes: [
            axis(4.0, 3.0, 0.0),
            axis(0.0, 0.0, 12.0),
            axis(-3.0, 4.0, 0.0),
        ],
        node: None,
    });
    let [wall, lid, own] = &mut system.components.contacts[..] else {
        unreachable!("there are three contacts")
    };
    wall.side = plate.clone();
    lid.side = plate;
    lid.round.axes[0] = axis(5.0, 1.0, 8.0);
    own.round.axes[0] = axis(1.0, 3.0, 6.0);
    own.round.radius = 3.0;
    own.smoothing = 120.0;
    own.elasticity = ContactElasticLaw::Linear(0.02);
    if let ContactSide::Shape(other) = &mut own.side {
        other.radius = 4.0;
        other.axes[0] = axis(9.0, 2.0, 0.0);
    }
    lid.stick = None;
    own.stick = None;
    system
}

/// The branched tree with muscles of other laws of elasticity, the passive one among them.
pub fn stiffening() -> System {
    let mut system = branched();
    let laws = [
        (0, ElasticLaw::Gent { limit: 8.0 }),
        (1, ElasticLaw::MooneyRivlin { share: 0.3 }),
        (
            3,
            ElasticLaw::Ogden {
                exponents: [1.3, 5.0],
                share: 0.2,
            },
        ),
    ];
    for (muscle, law) in laws {
        system.muscles[muscle].material.law = Some(law);
    }
    system
}

/// The branched tree with a leaking muscle behind a resistor, and one whose charge is given.
pub fn charged() -> System {
    let mut system = branched();
    system.muscles[0] = system.muscles[0].clone().resistance(3e7).leakage(9e7);
    system.components.loads.push(Load {
        name: "charge".into(),
        on: LoadPlace::Muscle(1),
    });
    system
}

/// The branched tree with springs of its first hinge, beyond a half turn, and of its slider, which has stops.
pub fn sprung() -> System {
    let mut system = branched();
    for (joint, stiffness, rest) in [(0, 90.0, 4.0), (1, 0.3, -2.0)] {
        system.joints[joint].spring = Some(JointSpring { stiffness, rest });
    }
    system.joints[1].stops = Some(JointStops {
        at: [-0.5, 0.4],
        stiffness: 2.0,
        smoothing: 1.5,
    });
    system
}

/// A branched tree: a revolute joint about an oblique axis, on it a damped slider and a damped hinge written from child
/// to parent, and a body fixed on the slider; four muscles, of which one is passive and one has no mass and no viscosity.
pub fn branched() -> System {
    let turned = |angle: f64| {
        Rotation3::from_axis_angle(&Vector3::x_axis(), angle).into_inner()
            * Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()])
    };
    let body = |name: &str, centre: [f64; 3], angle: f64| Body {
        name: name.into(),
        mass: 20.0,
        inertia: [4e3, 5e3, 3e3],
        centre: Vector3::from(centre),
        directors: turned(angle),
        shape: Shape::Box {
            size: [20.0, 20.0, 40.0],
        },
    };
    let oblique = Vector3::new(0.2, 0.3, 1.0).normalize();
    let along = Vector3::new(0.6, 0.8, 0.0);
    let joint = |name: &str, kind, parent, child, at: [f64; 3], damping| Joint {
        name: name.into(),
        kind,
        parent,
        child,
        at: Vector3::from(at),
        damping,
        ..Joint::default()
    };
    let at = |body, at: [f64; 3]| Attachment {
        body,
        at: Vector3::from(at),
    };
    let silicone = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: None,
        electric: Some(ElectricConstants {
            c1: -2.0 * VACUUM_PERMITTIVITY,
            c2: VACUUM_PERMITTIVITY,
            permittivity: VACUUM_PERMITTIVITY,
        }),
        viscosity: Some(1.0),
        ..Material::default()
    };
    let ideal = Material {
        electric: Some(ElectricConstants {
            c1: 0.0,
            c2: 0.0,
            permittivity: 3.0 * VACUUM_PERMITTIVITY,
        }),
        ..silicone
    };
    let rubber = Material {
        electric: None,
        ..silicone
    };
    let light = Material {
        density: None,
        viscosity: None,
        ..silicone
    };
    let muscle = |name: &str, from, to, material, section_inertia| Muscle {
        name: name.into(),
        from,
        to,
        cross_section: [10.0, 8.0],
        layer_thickness: 0.05,
        material,
        prestretch: None,
        section_inertia,
        circuit: None,
        fidelity: Default::default(),
    };
    System {
        components: Default::default(),
        name: "branched".into(),
        bodies: vec![
            body("stem", [0.0, 25.0, 0.0], 0.0),
            body("slider", [15.0, 70.0, 5.0], 0.4),
            body("branch", [-30.0, 60.0, 0.0], -0.7),
            body("cap", [25.0, 110.0, 5.0], 0.2),
        ],
        joints: vec![
            joint(
                "root",
                JointKind::Revolute { axis: oblique },
                None,
                0,
                [0.0; 3],
                Some(30.0),
            ),
            joint(
                "slide",
                JointKind::Prismatic { axis: along },
                Some(0),
                1,
                [5.0, 50.0, 0.0],
                Some(0.4),
            ),
            joint(
                "hinge",
                JointKind::Revolute { axis: Vector3::x() },
                Some(2),
                0,
                [-10.0, 50.0, 0.0],
                Some(20.0),
            ),
            joint(
                "glue",
                JointKind::Fixed,
                Some(1),
                3,
                [20.0, 90.0, 5.0],
                None,
            ),
        ],
        muscles: vec![
            muscle(
                "ground to stem",
                at(None, [20.0, 0.0, 5.0]),
                at(Some(0), [15.0, 45.0, 5.0]),
                silicone,
                true,
            ),
            muscle(
                "stem to slider",
                at(Some(0), [0.0, 20.0, 5.0]),
                at(Some(1), [10.0, 75.0, 0.0]),
                ideal,
                false,
            ),
            muscle(
                "slider to branch",
                at(Some(1), [10.0, 75.0, 12.0]),
                at(Some(2), [-35.0, 70.0, 10.0]),
                light,
                false,
            ),
            muscle(
                "ground to branch",
                at(None, [-40.0, 0.0, 5.0]),
                at(Some(2), [-35.0, 60.0, -10.0]),
                rubber,
                true,
            ),
        ],
        solids: Vec::new(),
        markers: vec![
            Marker {
                name: "cap".into(),
                point: at(Some(3), [30.0, 130.0, 10.0]),
                solid: None,
            },
            Marker {
                name: "tip".into(),
                point: at(Some(2), [-40.0, 80.0, 3.0]),
                solid: None,
            },
        ],
        gravity: Some(GRAVITY),
    }
}

/// A trunk whose first joint is a ball in a socket, held by four muscles.
pub fn ball() -> System {
    let mut system = trunk(3);
    system.joints[0].kind = JointKind::Spherical;
    for (name, x, z) in [("front", 3.0, 15.0), ("back", -3.0, -15.0)] {
        let mut muscle = system.muscles[0].clone();
        muscle.name = name.into();
        (muscle.from.at.x, muscle.from.at.z) = (0.5 * x, z);
        (muscle.to.at.x, muscle.to.at.z) = (x, z);
        system.muscles.push(muscle);
    }
    system
}

/// A trunk without its joint to the ground, whose last joint is a ball: a free robot.
pub fn satellite() -> System {
    let mut system = trunk(3);
    system.name = "satellite".into();
    system.joints.remove(0);
    system.muscles.drain(..2);
    system.joints[1].kind = JointKind::Spherical;
    system.bodies[0].inertia = [2e4, 3e4, 5e4];
    system
}

/// Two segments with a muscle of finite elements, and a block between segments and ground: a dielectric part with driven,
/// floating and grounded electrodes, a passive part of Q1P0 elements, viscosity, a roller, a marker.
pub fn blocks() -> System {
    let mut system = trunk(2);
    for muscle in &mut system.muscles {
        muscle.material.lame_lambda = Some(0.4);
    }
    system.muscles[0].fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 2],
        layers: 2,
        element: ElementKind::Hex8,
    });
    let dielectric = system.muscles[0].material;
    let passive = Material {
        electric: None,
        viscosity: None,
        lame_lambda: Some(3.0),
        ..dielectric
    };
    let corner = Vector3::new(-10.0, 20.0, 30.0);
    let mut mesh = Grid::uniform(corner, Vector3::new(20.0, 60.0, 9.0), [1, 3, 3]).mesh();
    mesh.regions = (0..9).map(|element| usize::from(element < 3)).collect();
    mesh.region_names = vec!["active".into(), "passive".into()];
    let plane = |z: f64| mesh.nodes_on_plane(2, z, 1e-9);
    let electrode = |name: &str, nodes: Vec<usize>, potential| Electrode {
        circuit: None,
        name: name.into(),
        nodes,
        potential,
    };
    let edge = |y: f64, z: f64| -> Vec<usize> {
        let on = |n: &usize| (mesh.nodes[*n].y - y).abs() < 1e-9;
        plane(z).into_iter().filter(on).collect()
    };
    system.solids.push(Solid {
        name: "block".into(),
        materials: vec![dielectric, passive],
        element: ElementKind::Hex8Q1P0,
        electrodes: vec![
            electrode("low", plane(33.0), Potential::Given(20.0)),
            electrode("island", edge(40.0, 36.0), Potential::Floating),
            electrode(
                "high",
                plane(39.0),
                Potential::Driven {
                    source: 4,
                    factor: 1.5,
                },
            ),
        ],
        supports: vec![Support {
            nodes: edge(40.0, 30.0),
            held: [true, false, false],
        }],
        glued: vec![
            Glue {
                nodes: mesh.sets["y_min"].clone(),
                body: Some(0),
            },
            Glue {
                nodes: edge(80.0, 39.0),
                body: Some(1),
            },
            Glue {
                nodes: edge(60.0, 30.0),
                body: None,
            },
        ],
        mesh,
        ..Solid::default()
    });
    system.markers.push(Marker {
        name: "corner".into(),
        point: Attachment {
            body: None,
            at: Vector3::new(10.0, 60.0, 39.0),
        },
        solid: Some(0),
    });
    system
}

/// The same with nodes of the block that touch a plane of the ground, and a sphere and a plate of a body.
pub fn touching_blocks() -> System {
    let mut system = blocks();
    let mesh = &system.solids[0].mesh;
    let place = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
    let node = |x: f64, y: f64, z: f64| {
        let node = mesh.nearest_node(&place(x, y, z)).unwrap();
        ContactShape {
            centre: Attachment {
                body: None,
                at: mesh.nodes[node],
            },
            node: Some([0, node]),
            ..ContactShape::default()
        }
    };
    let sphere = |at| ContactShape {
        centre: Attachment { body: Some(1), at },
        radius: 6.0,
        ..ContactShape::default()
    };
    let plate = ContactShape {
        axes: [
            place(9.0, 0.0, 0.0),
            place(0.0, 4.0, 3.0),
            place(0.0, 0.0, 0.0),
        ],
        ..sphere(place(0.0, 72.0, 52.0))
    };
    let ground = ContactSide::Plane {
        at: Attachment {
            body: None,
            at: place(0.0, 0.0, 25.0),
        },
        normal: place(0.0, 0.0, 1.0),
    };
    let contact = |name: &str, round, side| Contact {
        name: name.into(),
        round,
        side,
        elasticity: ContactElasticLaw::Linear(0.02),
        smoothing: 30.0,
        restitution: Some(Restitution {
            coefficient: 0.6,
            speed: 1.0,
        }),
        friction: Some(0.3),
        slip_speed: 0.5,
        stick: None,
    };
    system.components.contacts = vec![
        contact("table", node(-10.0, 60.0, 30.0), ground),
        contact(
            "ball",
            node(10.0, 60.0, 39.0),
            ContactSide::Shape(sphere(place(12.0, 70.0, 48.0))),
        ),
        contact("plate", node(-10.0, 60.0, 39.0), ContactSide::Shape(plate)),
    ];
    system
}

/// The same by other laws of elasticity.
pub fn stiffening_blocks() -> System {
    let mut system = blocks();
    system.muscles[0].material.law = Some(ElasticLaw::Yeoh {
        c2: -0.01,
        c3: 0.02,
    });
    for material in &mut system.solids[0].materials {
        material.law = Some(ElasticLaw::MooneyRivlin { share: 0.3 });
    }
    system
}
