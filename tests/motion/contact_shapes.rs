//! Contacts of capsules and boxes: rest, rolling and sliding against closed forms, balances of free pairs, and pairs by groups in files.

use crate::common::{at_reference, column, columns, motion, with_velocities};
use crate::component_files::read;
use crate::contact::{BOTH, GRAVITY, MASS, RADIUS, acceleration, model};
use nalgebra::{Rotation3, Vector3};
use proboscis::dynamics::{Start, observations};
use proboscis::model::Coordinates;
use proboscis::model::components::Contact as Component;
use proboscis::prelude::*;

const STIFFNESS: f64 = 10.0;

/// Half axes of a box along the axes of the ground.
fn half_axes(sizes: [f64; 3]) -> [Vector3<f64>; 3] {
    [X * sizes[0], Y * sizes[1], Z * sizes[2]]
}

/// Two free bodies that meet, spinning.
fn pair(of: &str) -> System {
    let mut system = System::new(of);
    let at = Vector3::new(-9.0, 1.0, 0.5);
    let first = system.add(Body::sphere(8.0).mass(12.0).at(at));
    let other = Body::cuboid([6.0, 30.0, 30.0]).mass(30.0).at(X * 6.0);
    let other = system.add(other);
    let oblique = Vector3::new(0.3, 4.0, 1.0);
    let ball = ContactShape::sphere(first, at, 5.0);
    let rod = ContactShape::capsule(first, [at - oblique, at + oblique], 4.0);
    let across = Vector3::new(0.5, -2.0, 9.0);
    let beam = ContactShape::capsule(other, [X * 6.0 - across, X * 6.0 + across], 6.0);
    let turned = Rotation3::from_euler_angles(0.2, 0.1, -0.3);
    let half_axes = half_axes([3.0, 8.0, 5.0]).map(|axis| turned * axis);
    let cuboid = ContactShape::cuboid(other, X * 6.0, half_axes, 1.0);
    let contact = match of {
        "ball and beam" => Contact::of_shapes(ball, beam),
        "ball and box" => Contact::of_shapes(cuboid, ball),
        "rod and beam" => Contact::of_shapes(rod, beam),
        _ => Contact::of_shapes(rod, cuboid),
    };
    let contact = contact.stiffness(4.0).restitution(0.7, 1.0).friction(0.3);
    system.add(contact.slip_speed(0.01));
    system
}

#[test]
fn free_pairs_of_shapes_keep_their_momenta_and_lose_energy() {
    for of in [
        "ball and beam",
        "ball and box",
        "rod and beam",
        "rod and box",
    ] {
        let system = pair(of);
        for coordinates in BOTH {
            let drifts = [0.02, 0.01].map(|h| {
                let model = model(&system, coordinates, h);
                let spins = [
                    Vector3::new(0.02, -0.06, 0.09),
                    Vector3::new(0.03, 0.05, -0.04),
                ];
                let velocities = [Vector3::new(1.0, 0.1, -0.2), Vector3::new(-0.3, 0.0, 0.1)];
                let rates = [[velocities[0], spins[0]], [velocities[1], spins[1]]];
                let start = with_velocities(&model, at_reference(&model), &rates);
                let steps = (18.0 / h).round() as usize;
                let observed = observations(&model, &motion(&model, &start, h, steps, &[]));
                let [p, l] =
                    ["linear_momentum", "angular_momentum"].map(|of| columns(&observed, of));
                let total = column(&observed, "total_energy");
                let lost = column(&observed, "dissipated_energy");
                assert!(
                    lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-15),
                    "{of}"
                );
                assert!(lost[steps] > 0.05 * total[0], "{of}: {}", lost[steps]);
                assert!(
                    column(&observed, "contact1_gap")[steps] > 0.1,
                    "{of} have parted"
                );
                let error = (total[steps] + lost[steps] - total[0]).abs() / total[0];
                assert!(error < 2e-3 * h, "{of}: {error}");
                assert!(
                    (p[steps] - p[0]).norm() < 1e-10 * p[0].norm(),
                    "{of}: {:?}",
                    p[steps]
                );
                (l[steps] - l[0]).norm() / l[0].norm()
            });
            println!("{of} {coordinates:?}: {drifts:?}");
            assert!(drifts[1] < 4e-6, "{of}: {drifts:?}");
            assert!(drifts[0] / drifts[1] > 3.0, "{of}: {drifts:?}");
        }
    }
}

/// A ball on a slide along y above a place of a shape of the ground, which it touches.
fn resting(
    above: Vector3<f64>,
    round: impl Fn(Handle<Body>, Vector3<f64>) -> ContactShape,
    other: ContactShape,
) -> f64 {
    let mut system = System::new("resting");
    system.gravity = Some(-Y * GRAVITY);
    let ball = system.add(Body::sphere(RADIUS).mass(MASS).at(above));
    let slide = system.add(Joint::prismatic(Y).between(GROUND, ball));
    let contact = Contact::of_shapes(round(ball, above), other);
    system.add(contact.stiffness(STIFFNESS).friction(0.3));
    let still = Equilibrium::new().find(&system).unwrap();
    above.y + still.joint(slide)[0]
}

#[test]
fn balls_and_capsules_rest_at_the_heights_of_exact_shapes() {
    let sunk = MASS * GRAVITY / STIFFNESS;
    let ball = |body, at| ContactShape::sphere(body, at, 4.0);
    let cuboid = ContactShape::cuboid(GROUND, Vector3::zeros(), half_axes([9.0, 5.0, 7.0]), 1.0);
    // On the upper face; the slide takes the force along an edge.
    let top = resting(Vector3::new(3.0, 9.0, -2.0), ball, cuboid);
    assert!((top - (9.0 - sunk)).abs() < 1e-9, "{top}");
    let mid = resting(
        Vector3::new(0.5, 10.0, 0.0),
        ball,
        ContactShape::capsule(GROUND, [X * -6.0, X * 20.0], 5.0),
    );
    assert!((mid - (9.0 - sunk)).abs() < 1e-9, "{mid}");
    // Beyond the end of the capsule: x² + y² = (9 − d)² with the force k d y/(9 − d) = m g.
    let x = 3.0_f64;
    let end = resting(
        Vector3::new(20.0 + x, 8.6, 0.0),
        ball,
        ContactShape::capsule(GROUND, [X * -6.0, X * 20.0], 5.0),
    );
    let distance = (end * end + x * x).sqrt();
    let force = STIFFNESS * (9.0 - distance) * end / distance;
    assert!((force - MASS * GRAVITY).abs() < 1e-9, "{force}");
    // A capsule across another one touches it in its middle.
    let across =
        |body, at: Vector3<f64>| ContactShape::capsule(body, [at - Z * 8.0, at + Z * 8.0], 4.0);
    let crossed = resting(
        Y * 9.0,
        across,
        ContactShape::capsule(GROUND, [X * -6.0, X * 6.0], 5.0),
    );
    assert!((crossed - (9.0 - sunk)).abs() < 1e-9, "{crossed}");
    let on_box = resting(Y * 9.0, across, cuboid);
    // The core of the capsule reaches beyond the box, which is thicker in its middle by a two-thousandth of the half lengths.
    assert!((on_box - (9.0 - sunk)).abs() < 1e-9, "{on_box}");
}

/// A ball that rolls down, and a box that slides down, an inclined face of a box of the ground.
fn incline(alpha: f64, friction: f64) -> crate::contact::Incline {
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), -alpha);
    let [down, normal] = [turned * X, turned * Y];
    let mut system = System::new("incline");
    system.gravity = Some(-Y * GRAVITY);
    let sunk = MASS * GRAVITY * alpha.cos() / STIFFNESS;
    let centre = normal * (RADIUS - sunk);
    let ball = system.add(Body::sphere(RADIUS).mass(MASS).at(centre));
    system.add(Joint::planar(Z).between(GROUND, ball));
    let axes = half_axes([900.0, 6.0, 20.0]).map(|axis| turned * axis);
    let table = ContactShape::cuboid(GROUND, normal * -6.0, axes, 0.5);
    let contact = Contact::of_shapes(ContactShape::sphere(ball, centre, RADIUS), table);
    system.add(contact.stiffness(STIFFNESS).friction(friction));
    crate::contact::Incline { system, down }
}

#[test]
fn a_ball_rolls_down_the_face_of_a_box() {
    let alpha = 15.0_f64.to_radians();
    for coordinates in BOTH {
        let of = incline(alpha, 0.4);
        let model = model(&of.system, coordinates, 0.1);
        let start = Start::at_rest(&model, at_reference(&model));
        let found = acceleration(&of, &start, &model, 0.1, 100.0);
        // The point of touch divides the distance of the centres as the radii do.
        let sunk = MASS * GRAVITY * alpha.cos() / STIFFNESS;
        let lever = 1.0 - sunk / (RADIUS + 0.5);
        let exact = GRAVITY * alpha.sin() / (1.0 + 0.4 / (lever * lever));
        println!("rolling: {:e}", found / exact - 1.0);
        assert!((found - exact).abs() < 1e-5 * exact, "{found} {exact}");
    }
}

#[test]
fn a_box_slides_on_its_corners() {
    let alpha = 0.4_f64;
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), -alpha);
    let [down, normal] = [turned * X, turned * Y];
    let mut system = System::new("block");
    system.gravity = Some(-Y * GRAVITY);
    let centre = normal * (5.0 - MASS * GRAVITY * alpha.cos() / (4.0 * STIFFNESS));
    let block = system.add(Body::cuboid([30.0, 10.0, 20.0]).mass(MASS).at(centre));
    system.add(Joint::planar(Z).between(GROUND, block));
    let axes = half_axes([15.0, 5.0, 10.0]).map(|axis| turned * axis);
    let cuboid = ContactShape::cuboid(block, centre, axes, 0.5);
    for corner in cuboid.corners() {
        let sphere = (block, corner.centre.at, corner.radius);
        let contact = Contact::on_plane(sphere, (GROUND, Vector3::zeros(), normal));
        system.add(
            contact
                .stiffness(STIFFNESS)
                .friction(0.1)
                .restitution(0.2, 0.01),
        );
    }
    let of = crate::contact::Incline { system, down };
    let model = model(&of.system, Coordinates::Reduced, 0.1);
    let velocity = [down * 0.2, Vector3::zeros()];
    let start = with_velocities(&model, at_reference(&model), &[velocity]);
    let found = acceleration(&of, &start, &model, 0.1, 400.0);
    let exact = GRAVITY * (alpha.sin() - 0.1 * alpha.cos());
    println!("a box slides: {:e}", found / exact - 1.0);
    assert!((found - exact).abs() < 1e-3 * exact, "{found} {exact}");
}

const SCENE: &str = r#"{
  "name": "hand", "gravity": [0, -9.81, 0],
  "bodies": [
    { "name": "ball", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [0, 0.011, 0], "free": true },
    { "name": "left", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [-0.03, 0.02, 0], "free": true },
    { "name": "right", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [0.03, 0.02, 0], "free": true }
  ],
  "shapes": [
    { "name": "floor", "plane": { "at": [0, 0, 0], "normal": [0, 2, 0] } },
    { "name": "ball", "group": "things", "body": "ball", "sphere": { "at": [0, 0.011, 0], "radius": "10 mm" } },
    { "name": "crate", "group": "things", "box": { "at": [0, "60 mm", 0], "size": ["20 mm", "10 mm", "30 mm"], "axes": [[0, 0, 3], [0, 1, 0]], "radius": "1 mm" } },
    { "name": "thumb", "group": "tips", "body": "left", "capsule": { "from": [-0.03, 0.02, 0], "to": [-0.02, 0.02, 0], "radius": "4 mm" } },
    { "name": "index", "group": "tips", "body": "right", "sphere": { "at": [0.03, 0.02, 0], "radius": "5 mm" } }
  ],
  "contacts": [
    { "between": ["tips", "things"], "stiffness": "2 N/mm", "friction": 0.6 },
    { "between": ["tips", "tips"], "stiffness": "1 N/mm" },
    { "between": ["floor", "thumb"], "stiffness": "3 N/mm" }
  ]
}"#;

#[test]
fn files_say_pairs_of_shapes() {
    let system = read(SCENE).unwrap();
    let contacts = &system.components.contacts;
    let found: Vec<&str> = contacts.iter().map(|one| one.name.as_str()).collect();
    let pairs = [
        "thumb_ball",
        "thumb_crate",
        "index_ball",
        "index_crate",
        "thumb_index",
        "floor_thumb_from",
        "floor_thumb_to",
    ];
    assert_eq!(found, pairs);
    let handle = |name: &str| {
        let names = system.bodies.iter().map(|body| body.name.as_str());
        names
            .collect::<Vec<_>>()
            .iter()
            .position(|one| *one == name)
    };
    let like = |name: &str, contact: Component| {
        let same = contacts.iter().find(|one| one.name == name).unwrap();
        // Conversions of units round.
        assert_eq!(
            format!("{same:.9?}"),
            format!("{:.9?}", contact.named(name))
        );
    };
    let on = |name: &str, mut shape: ContactShape| {
        shape.centre.body = handle(name);
        shape
    };
    let place = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let thumb = ContactShape::capsule(GROUND, [place(-30.0, 20.0), place(-20.0, 20.0)], 4.0);
    let thumb = on("left", thumb);
    let index = on(
        "right",
        ContactShape::sphere(GROUND, place(30.0, 20.0), 5.0),
    );
    let ball = on("ball", ContactShape::sphere(GROUND, place(0.0, 11.0), 10.0));
    let crate_axes = [Z * 10.0, Y * 5.0, Vector3::new(-15.0, 0.0, 0.0)];
    let cuboid = ContactShape::cuboid(GROUND, place(0.0, 60.0), crate_axes, 1.0);
    let grip = |one, other| Contact::of_shapes(one, other).stiffness(2.0).friction(0.6);
    like("thumb_ball", grip(thumb, ball));
    like("thumb_crate", grip(thumb, cuboid));
    like("index_ball", grip(index, ball));
    like("index_crate", grip(index, cuboid));
    like(
        "thumb_index",
        Contact::of_shapes(thumb, index).stiffness(1.0),
    );
    for (from, to, told) in [
        (
            r#"["tips", "things"]"#,
            r#"["tips", "thing"]"#,
            "contacts[0].between[1]",
        ),
        (
            r#"["tips", "things"]"#,
            r#"["crate", "floor"]"#,
            "shapes of different bodies",
        ),
        (
            r#"["tips", "things"]"#,
            r#"["floor", "floor"]"#,
            "shapes of different bodies",
        ),
        (
            r#""between": ["floor","#,
            r#""name": "c", "between": ["floor","#,
            "contacts[2].name",
        ),
        (
            r#"["floor", "thumb"]"#,
            r#"["index", "ball"]"#,
            "contacts[2].between",
        ),
        (
            r#""group": "tips", "body": "left""#,
            r#""group": "ball", "body": "left""#,
            "shapes[3].group",
        ),
        (r#""name": "index""#, r#""name": "thumb""#, "shapes[4].name"),
        (
            r#""radius": "1 mm""#,
            r#""radius": "6 mm""#,
            "half of the least length",
        ),
        (
            r#"[[0, 0, 3], [0, 1, 0]]"#,
            r#"[[0, 0, 3], [0, 1, 1]]"#,
            "right angles",
        ),
        (
            r#""to": [-0.02, 0.02, 0]"#,
            r#""to": [-0.03, 0.02, 0]"#,
            "capsule.to",
        ),
        (
            r#""body": "left", "#,
            r#""body": "lift", "#,
            "shapes[3].body",
        ),
        (
            r#""stiffness": "2 N/mm", "friction": 0.6"#,
            r#""hertz": [ { "modulus": "2 MPa", "poisson_ratio": 0.4 } ]"#,
            "stiffness",
        ),
        (
            r#""stiffness": "2 N/mm", "friction": 0.6"#,
            r#""stiffness": "2 N/mm", "friction": 0.6, "stick": "1 mm""#,
            "contacts[0].stick",
        ),
        (
            r#""at": [0, "60 mm", 0]"#,
            r#""at": ["-25 mm", "20 mm", 0]"#,
            "contacts[0].between",
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let message = read(&SCENE.replacen(from, to, 1)).unwrap_err();
        assert!(message.contains(told), "{from}: {message}");
    }
}
