//! Systems and reference solutions that several tests share.
#![allow(dead_code, reason = "each test binary uses a part")]
#![allow(unreachable_pub, reason = "a module of several test binaries")]

pub mod boxes;
pub mod cases;
pub mod counting;
pub mod ends;
pub mod force;
pub mod limited;
pub mod loaded;
pub mod measuring;
pub mod pairs;
pub mod programs;
pub mod random;
pub mod random_goals;
pub mod receding;
pub mod remembering;
pub mod robot;
pub mod signals;
pub mod similar;
pub mod solid;
pub mod sought;
pub mod stacks;
pub mod systems;
pub mod timed;
pub mod tracked;
pub mod trunk;
pub mod vtk_arrays;

use nalgebra::{Matrix3, SVector, Vector3};
use proboscis::coordinates::Configuration;
use proboscis::dynamics::trajectory::{Observations, Trajectory};
use proboscis::dynamics::{DiscreteTrajectory, Start, simulate};
use proboscis::kinematics::{Carrier, MaterialVector, Pose};
use proboscis::model::Model;
use proboscis::model::system::{
    Attachment, Body, ElectricConstants, Joint, JointKind, Marker, Material, Muscle, Shape, System,
    VACUUM_PERMITTIVITY,
};
use serde_json::Value;
use std::ops::ControlFlow;

/// A start with a velocity of the centre of mass (mm/ms) and an angular velocity (rad/ms), both in the ground frame, of each body that is solved for;
/// nodes rest. What the coordinates do not let move counts as an impulse on its supports.
pub(crate) fn with_velocities(
    model: &Model,
    z: Vec<f64>,
    velocities: &[[Vector3<f64>; 2]],
) -> Start {
    let map = &model.action.map;
    let instant = map.placed(&z);
    let poses = model.condensed_poses(&instant);
    let rate = |vector: &MaterialVector| {
        let terms = vector.terms.iter().map(|term| match term.carrier {
            Carrier::Body(b) => {
                let [velocity, spin] = velocities[b];
                velocity * term.centre + spin.cross(&(poses[b].directors * term.directors))
            }
            _ => Vector3::zeros(),
        });
        terms.sum()
    };
    let rates: Vec<Vector3<f64>> = model.vectors.iter().map(rate).collect();
    let mut momenta = vec![Vector3::zeros(); rates.len()];
    for term in &model.action.intervals.terms {
        term.momentum(&instant.x, &rates, &mut momenta);
    }
    let mut momentum = vec![0.0; model.coordinate_count()];
    map.pull_back(&instant.columns, &momenta, &mut momentum);
    Start {
        momentum,
        ..Start::at_rest(model, z)
    }
}

/// A reference solution from `tests/reference`.
pub(crate) fn reference(name: &str) -> Value {
    let path = format!("{}/tests/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A list of numbers.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v.as_f64().unwrap())
        .collect()
}

/// The elephant trunk of the reference solutions with any number of segments, written out by hand.
pub(crate) fn trunk(segments: usize) -> System {
    let (length, radius, mass) = (50.0, 20.0, 30.0);
    let transverse = mass * (3.0 * radius * radius + length * length) / 12.0;
    let axial = mass * radius * radius / 2.0;
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
    let mut system = System {
        components: Default::default(),
        name: "trunk".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        muscles: Vec::new(),
        solids: Vec::new(),
        markers: Vec::new(),
        gravity: None,
    };
    for i in 0..segments {
        let base = i as f64 * length;
        // d3 is the long axis.
        let directors = Matrix3::from_columns(&[Vector3::z(), Vector3::x(), Vector3::y()]);
        system.bodies.push(Body {
            name: format!("segment{}", i + 1),
            mass,
            inertia: [transverse, transverse, axial],
            centre: Vector3::new(0.0, base + 0.5 * length, 0.0),
            directors,
            shape: Shape::Cylinder { length, radius },
        });
        let parent = i.checked_sub(1);
        let (axis, side) = if i % 2 == 0 {
            (Vector3::z(), Vector3::x())
        } else {
            (Vector3::x(), Vector3::z())
        };
        let at = Vector3::new(0.0, base, 0.0);
        system.joints.push(Joint {
            name: format!("joint{}", i + 1),
            kind: JointKind::Revolute { axis },
            parent,
            child: i,
            at,
            ..Joint::default()
        });
        for (m, sign) in [(1, 1.0), (2, -1.0)] {
            let offset = side * (15.0 * sign);
            let end = |y: f64| at + offset + Vector3::new(0.0, y, 0.0);
            system.muscles.push(Muscle {
                name: format!("muscle{}", 2 * i + m),
                from: Attachment {
                    body: parent,
                    at: end(-20.0),
                },
                to: Attachment {
                    body: Some(i),
                    at: end(20.0),
                },
                cross_section: [10.0, 10.0],
                layer_thickness: 0.05,
                material: silicone,
                prestretch: None,
                section_inertia: false,
                circuit: None,
                fidelity: Default::default(),
            });
        }
    }
    let tip = Vector3::new(0.0, segments as f64 * length, 0.0);
    system.markers.push(Marker {
        name: "tip".into(),
        point: Attachment {
            body: Some(segments - 1),
            at: tip,
        },
        solid: None,
    });
    system
}

/// A body at a place with its principal axes along the columns of `directors`.
pub(crate) fn body(
    name: &str,
    mass: f64,
    inertia: [f64; 3],
    centre: Vector3<f64>,
    directors: Matrix3<f64>,
) -> Body {
    Body {
        name: name.into(),
        mass,
        inertia,
        centre,
        directors,
        shape: Shape::None,
    }
}

/// A joint without damping.
pub(crate) fn joint(
    name: &str,
    kind: JointKind,
    parent: Option<usize>,
    child: usize,
    at: Vector3<f64>,
) -> Joint {
    Joint {
        name: name.into(),
        kind,
        parent,
        child,
        at,
        ..Joint::default()
    }
}

/// Bodies and joints without muscles; any coherent units do.
pub(crate) fn bare(bodies: Vec<Body>, joints: Vec<Joint>, gravity: Option<Vector3<f64>>) -> System {
    System {
        components: Default::default(),
        name: "bare".into(),
        bodies,
        joints,
        muscles: Vec::new(),
        solids: Vec::new(),
        markers: Vec::new(),
        gravity,
    }
}

/// Coordinates of the reference configuration.
pub(crate) fn at_reference(model: &Model) -> Vec<f64> {
    model.coordinates_at(&vec![0.0; model.joint_readings.len()])
}

/// A placed instant.
pub(crate) fn placed(model: &Model, z: &[f64]) -> Configuration {
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(z);
    model.action.map.place(&mut instant);
    instant
}

/// Rates of the directors of one body that moves with velocity v and angular velocity ω (both in space).
pub(crate) fn spin(pose: &Pose, v: Vector3<f64>, omega: Vector3<f64>) -> Vec<f64> {
    let mut rates: Vec<f64> = v.iter().copied().collect();
    for i in 0..3 {
        rates.extend(omega.cross(&pose.directors.column(i)).iter());
    }
    rates
}

/// A motion of all its steps under constant voltages.
pub(crate) fn motion(
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    scalars: &[f64],
) -> DiscreteTrajectory {
    let (discrete, failure) = simulate(
        model,
        start,
        h,
        steps,
        |_, _| scalars.to_vec(),
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    assert_eq!(discrete.report.halved, 0);
    discrete
}

/// The limit of a sequence with steps h, h/2, h/4, … whose error is even in h.
pub(crate) fn richardson(values: &[f64]) -> f64 {
    let mut row = values.to_vec();
    for order in 1..values.len() {
        let factor = 4_f64.powi(order as i32);
        row = row
            .windows(2)
            .map(|w| (factor * w[1] - w[0]) / (factor - 1.0))
            .collect();
    }
    row[0]
}

/// One step of Runge and Kutta's fourth-order method for ẏ = f(y).
pub(crate) fn runge_kutta<const N: usize>(
    f: &impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
    y: &SVector<f64, N>,
    h: f64,
) -> SVector<f64, N> {
    let a = f(y);
    let b = f(&(y + a * (0.5 * h)));
    let c = f(&(y + b * (0.5 * h)));
    let d = f(&(y + c * h));
    y + (a + (b + c) * 2.0 + d) * (h / 6.0)
}

/// Largest difference of all poses along two motions of one system: centres relative to `length`, directors.
pub(crate) fn distance(a: &Trajectory, b: &Trajectory, length: f64) -> f64 {
    assert_eq!(a.times.len(), b.times.len());
    let pairs = a.poses.iter().flatten().zip(b.poses.iter().flatten());
    pairs
        .map(|(a, b)| {
            let centres = (a.centre - b.centre).amax() / length;
            let directors = (a.directors - b.directors).amax();
            assert!(centres.is_finite() && directors.is_finite());
            centres.max(directors)
        })
        .fold(0.0, f64::max)
}

/// Values of an observed column.
pub(crate) fn column<'a>(observations: &'a Observations, name: &str) -> &'a [f64] {
    let column = observations.columns.iter().find(|c| c.name == name);
    &column.unwrap_or_else(|| panic!("no column {name}")).values
}

/// Three observed columns with the suffixes x, y, z.
pub(crate) fn columns(observations: &Observations, name: &str) -> Vec<Vector3<f64>> {
    let [x, y, z] = ["x", "y", "z"].map(|axis| column(observations, &format!("{name}_{axis}")));
    x.iter()
        .zip(y)
        .zip(z)
        .map(|((&x, &y), &z)| Vector3::new(x, y, z))
        .collect()
}

/// System and task of a problem file with the scene in it.
pub(crate) fn problem(problem: &Value) -> (System, proboscis::control::problem::Task) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.json");
    std::fs::write(&path, problem.to_string()).unwrap();
    let read = proboscis::files::read_problem(&path, &[]);
    let loaded = read.unwrap_or_else(|error| panic!("{error}\n{problem}"));
    (loaded.system, loaded.task)
}
