//! Contacts of nodes of elastic blocks: rest against the weight, balances of a free pair, and nodes in files.

use crate::common::{at_reference, column, columns, with_velocities};
use crate::component_files::read;
use crate::contact::{GRAVITY, model};
use nalgebra::Vector3;
use proboscis::dynamics::{Start, observations, simulate};
use proboscis::model::Coordinates;
use proboscis::prelude::*;
use std::ops::ControlFlow;

/// Side of a cube in mm, and its density in g/mm³.
const SIDE: f64 = 10.0;
const DENSITY: f64 = 1.1e-3;

/// A cube of 2 × 2 × 2 elements whose lower corner lies at a height in mm over the origin.
fn cube(height: f64, viscosity: Option<f64>) -> Solid {
    let corner = Vector3::new(-0.5 * SIDE, height, -0.5 * SIDE);
    let mesh = Grid::uniform(corner, Vector3::repeat(SIDE), [2, 2, 2]).mesh();
    let mut material = Material::elastomer(0.05);
    material.lame_lambda = Some(0.2);
    material.density = Some(DENSITY);
    material.viscosity = viscosity;
    Solid::on(mesh, &material)
}

/// Nodes of a face with the parts of the corners, edges and the middle of a square of four faces.
fn parts(solid: &Solid, face: &str) -> Vec<(usize, f64)> {
    let part = |&node: &usize| {
        let at = &solid.mesh.nodes[node];
        let inner = [at.x, at.z].iter().filter(|x| x.abs() < 1e-9).count();
        (node, [1.0, 2.0, 4.0][inner] / 16.0)
    };
    solid.mesh.sets[face].iter().map(part).collect()
}

fn node_shape(solid: &Solid, node: usize) -> ContactShape {
    let at = solid.mesh.nodes[node];
    ContactShape {
        node: Some([0, node]),
        ..ContactShape::sphere(GROUND, at, 0.0)
    }
}

/// A cube that falls on a plane of the ground.
fn on_ground(stiffness: f64) -> System {
    let mut system = System::new("cube");
    system.gravity = Some(-Y * GRAVITY);
    let solid = cube(0.0, Some(0.05));
    let below = (GROUND, Vector3::zeros(), Y);
    for (node, part) in parts(&solid, "y_min") {
        let point = (GROUND, Vector3::zeros(), 0.0);
        let mut contact = Contact::on_plane(point, below).named(format!("node{node}"));
        contact.round = node_shape(&solid, node);
        let contact = contact.stiffness(stiffness * part).friction(0.3);
        system.add(contact.restitution(0.3, 0.01));
    }
    system.add(solid);
    system
}

#[test]
fn a_cube_rests_on_the_forces_of_its_nodes() {
    let system = on_ground(2.0);
    let weight = DENSITY * SIDE.powi(3) * GRAVITY;
    let model = model(&system, Coordinates::Reduced, 1.0);
    let start = Start::at_rest(&model, at_reference(&model));
    let steps = 1500;
    // Where nodes begin to touch, steps are halved.
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 1.0, steps, |_, _| Vec::new(), go_on);
    assert_eq!(failure, None);
    let observed = observations(&model, &discrete);
    let total = column(&observed, "total_energy");
    let lost = column(&observed, "dissipated_energy");
    let balance = total[steps] + lost[steps] - total[0];
    // Of order two in the steps of 1 ms, in which it stops.
    assert!(
        balance.abs() < 0.1 * lost[steps],
        "{balance} {}",
        lost[steps]
    );
    let forces = |k: usize| -> f64 {
        let all = parts(&system.solids[0], "y_min").into_iter();
        let force = |(node, _)| column(&observed, &format!("node{node}_force"))[k];
        all.map(force).sum()
    };
    let held = forces(steps - 1);
    println!("forces of nodes {held} at the weight {weight}");
    assert!((held - weight).abs() < 1e-6 * weight, "{held} {weight}");
}

#[test]
fn a_cube_holds_on_a_slope_by_friction_that_sticks() {
    let mut system = on_ground(2.0);
    // Half of the slope at which it slips.
    let angle = 0.15_f64;
    system.gravity = Some(Vector3::new(angle.sin(), -angle.cos(), 0.0) * GRAVITY);
    for contact in &mut system.components.contacts {
        contact.stick = Some(1e-3);
    }
    let model = model(&system, Coordinates::Reduced, 1.0);
    let start = Start::at_rest(&model, at_reference(&model));
    let steps = 3000;
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 1.0, steps, |_, _| Vec::new(), go_on);
    assert_eq!(failure, None);
    let middle = |k: usize| {
        let nodes = model
            .action
            .map
            .of_nodes
            .iter()
            .zip(&discrete.z[k][model.action.map.of_bodies..]);
        let along = nodes.filter(|((_, axis), _)| *axis == 0).map(|(_, x)| *x);
        let all: Vec<f64> = along.collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    let [start, before, end] = [0, steps - 1000, steps].map(middle);
    println!(
        "slid by {} mm, then by {} mm in a second",
        before - start,
        end - before
    );
    assert!((before - start).abs() < 0.5 && (end - before).abs() < 1e-4);
}

#[test]
fn a_free_cube_and_a_ball_keep_their_momenta() {
    let mut system = System::new("free");
    let solid = cube(12.0, None);
    let ball = system.add(Body::sphere(6.0).mass(4.0).at(Y * 4.0));
    for (node, part) in parts(&solid, "y_min") {
        let other = ContactShape::sphere(ball, Y * 4.0, 6.0);
        let contact = Contact::of_shapes(other, node_shape(&solid, node));
        let contact = contact.stiffness(4.0 * part).friction(0.4).slip_speed(0.01);
        system.add(contact.restitution(0.6, 0.5));
    }
    system.add(solid);
    let drifts = [0.1, 0.05].map(|h| {
        let model = model(&system, Coordinates::Reduced, h);
        let flight = [
            Vector3::new(0.05, 0.4, 0.02),
            Vector3::new(0.02, 0.01, -0.03),
        ];
        let start = with_velocities(&model, at_reference(&model), &[flight]);
        let steps = (40.0 / h) as usize;
        let go_on = |_: &_| ControlFlow::Continue(());
        let (discrete, failure) = simulate(&model, &start, h, steps, |_, _| Vec::new(), go_on);
        assert_eq!(failure, None);
        let observed = observations(&model, &discrete);
        let [p, l] = ["linear_momentum", "angular_momentum"].map(|of| columns(&observed, of));
        let lost = column(&observed, "dissipated_energy");
        let total = column(&observed, "total_energy");
        assert!(lost[steps] > 1e-3 * total[0], "{}", lost[steps]);
        assert!((p[steps] - p[0]).norm() < 1e-10 * p[0].norm(), "{p:?}");
        (l[steps] - l[0]).norm() / l[0].norm()
    });
    println!("a cube meets a ball: {drifts:?}");
    assert!(
        drifts[1] < 1e-3 && drifts[0] / drifts[1] > 3.0,
        "{drifts:?}"
    );
}

const SCENE: &str = r#"{
  "name": "pad", "gravity": [0, -9.81, 0],
  "materials": { "gel": { "density": "1100 kg/m^3", "shear_modulus": "50 kPa", "lame_lambda": "200 kPa" } },
  "bodies": [ { "name": "ball", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [0, "-15 mm", 0], "free": true } ],
  "solids": [ { "name": "pad", "material": "gel", "box": { "corner": ["-5 mm", 0, "-5 mm"], "size": ["10 mm", "10 mm", "10 mm"], "elements": [2, 2, 2] } } ],
  "shapes": [
    { "name": "skin", "nodes": { "solid": "pad", "face": "y_min" } },
    { "name": "floor", "plane": { "at": [0, "-1 mm", 0], "normal": [0, 1, 0] } },
    { "name": "ball", "body": "ball", "sphere": { "at": [0, "-15 mm", 0], "radius": "10 mm" } }
  ],
  "contacts": [
    { "between": ["skin", "floor"], "stiffness": "2 N/mm", "friction": 0.3 },
    { "between": ["ball", "skin"], "stiffness": "1 N/mm" }
  ]
}"#;

#[test]
fn files_say_nodes() {
    let system = read(SCENE).unwrap();
    let contacts = &system.components.contacts;
    assert_eq!(contacts.len(), 18);
    for (k, (node, part)) in parts(&system.solids[0], "y_min").into_iter().enumerate() {
        let [floor, ball] = [&contacts[k], &contacts[9 + k]];
        assert_eq!(floor.name, format!("skin_floor_{node}"));
        assert_eq!(ball.name, format!("ball_skin_{node}"));
        assert_eq!(floor.round, node_shape(&system.solids[0], node));
        assert_eq!(ball.round, floor.round);
        let stiffness = format!("Linear({:.9?})", 2.0 * part);
        assert_eq!(format!("{:.9?}", floor.elasticity), stiffness);
    }
    for (from, to, told) in [
        (
            r#""solid": "pad""#,
            r#""solid": "pod""#,
            "shapes[0].nodes.solid",
        ),
        (
            r#""face": "y_min""#,
            r#""face": "y_mid""#,
            "shapes[0].nodes.face",
        ),
        (
            r#""name": "skin", "#,
            r#""name": "skin", "body": "ball", "#,
            "shapes[0].body",
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let message = read(&SCENE.replacen(from, to, 1)).unwrap_err();
        assert!(message.contains(told), "{from}: {message}");
    }
}
