//! Contacts: impacts, rest, rolling and sliding against closed forms, balances of free pairs, and mistakes in files.

use crate::common::{at_reference, column, columns, motion, with_velocities};
use crate::component_files::read;
use nalgebra::Vector3;
use proboscis::dynamics::{DiscreteTrajectory, Start, observations};
use proboscis::model::{Coordinates, Model};
use proboscis::prelude::*;

pub(crate) const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];
pub(crate) const MASS: f64 = 20.0;
pub(crate) const RADIUS: f64 = 10.0;
/// Gravity in mm/ms².
pub(crate) const GRAVITY: f64 = 9.81e-3;

/// A ball on a slide along y, at a gap in mm from the ground.
fn falling(gap: f64) -> (System, Handle<Body>, Handle<Joint>) {
    let mut system = System::new("falling");
    let centre = Y * (RADIUS + gap);
    let ball = system.add(Body::sphere(RADIUS).mass(MASS).at(centre));
    let slide = system.add(Joint::prismatic(Y).between(GROUND, ball));
    (system, ball, slide)
}

/// Its contact with the ground.
fn floor(ball: Handle<Body>, gap: f64) -> Contact {
    let sphere = (ball, Y * (RADIUS + gap), RADIUS);
    Contact::on_plane(sphere, (GROUND, Vector3::zeros(), Y))
}

pub(crate) fn model(system: &System, coordinates: Coordinates, h: f64) -> Model {
    Model::new(system.clone(), Some(coordinates), h, &[]).unwrap()
}

/// Speed after an impact at 1 mm/ms, from a gap of 1 mm.
fn rebound(law: &dyn Fn(Contact) -> Contact, coordinates: Coordinates, h: f64) -> f64 {
    let (mut system, ball, _) = falling(1.0);
    system.add(law(floor(ball, 1.0)));
    let model = model(&system, coordinates, h);
    let start = with_velocities(&model, at_reference(&model), &[[-Y, Vector3::zeros()]]);
    let steps = (14.0 / h).round() as usize;
    let discrete = motion(&model, &start, h, steps, &[]);
    let observed = observations(&model, &discrete);
    assert!(
        column(&observed, "contact1_force")
            .iter()
            .all(|f| *f >= 0.0)
    );
    assert!(
        column(&observed, "contact1_gap")[steps] > 0.5,
        "it has left"
    );
    2.0 * column(&observed, "kinetic_energy")[steps] / MASS
}

#[test]
fn a_ball_rebounds_with_the_restitution_that_is_asked_for() {
    let linear = |contact: Contact| contact.stiffness(10.0);
    // E/(1 − ν²) = 3 MPa.
    let hertz = |contact: Contact| contact.hertz(&[[2.25, 0.5]]);
    let stiff: [&dyn Fn(Contact) -> Contact; 2] = [&linear, &hertz];
    // R5 of the references: κ = 0.15, 0.3, 0.75, 1.05 and 1.35.
    for e in [
        0.9090157413,
        0.8328697923,
        0.6629622000,
        0.5812880418,
        0.5158326164,
    ] {
        for stiff in stiff {
            let law = |contact| stiff(contact).restitution(e, 1.0).smoothing(0.5);
            let square = |h: f64| rebound(&law, Coordinates::Reduced, h);
            let errors = [0.04, 0.02, 0.01].map(|h| square(h).sqrt() - e);
            println!("{e}: {errors:?}");
            assert!(errors[2].abs() < 1e-5, "{e}: {errors:?}");
            let ratio = errors[0] / errors[1];
            assert!((3.5..4.5).contains(&ratio), "{e}: {errors:?}");
        }
    }
    // Without a width the stiffness jumps; without a restitution nothing is lost. In directors it is the same.
    let jumps = |contact: Contact| contact.stiffness(10.0).restitution(0.8, 1.0);
    for coordinates in BOTH {
        let e = rebound(&jumps, coordinates, 0.01).sqrt();
        assert!((e - 0.8).abs() < 2e-5, "{e}");
        let e = rebound(&linear, coordinates, 0.01).sqrt();
        assert!((e - 1.0).abs() < 2e-5, "{e}");
    }
    // A restitution of one leaves no term.
    let (mut system, ball, _) = falling(1.0);
    system.add(floor(ball, 1.0).stiffness(10.0).restitution(1.0, 1.0));
    let model = model(&system, Coordinates::Reduced, 0.1);
    assert!(
        model
            .present
            .iter()
            .all(|one| one.term != "contact damping")
    );
}

#[test]
fn a_ball_rests_in_its_indentation() {
    let hertz = 4.0 / 3.0 * (1.5 / 0.75) * RADIUS.sqrt();
    for (p, k) in [(1.0, 0.4), (1.5, hertz)] {
        let (mut system, ball, slide) = falling(-0.2);
        system.gravity = Some(-Y * GRAVITY);
        let contact = floor(ball, -0.2).restitution(0.5, 1.0).friction(0.3);
        system.add(match p {
            1.0 => contact.stiffness(k),
            _ => contact.hertz(&[[1.5, 0.5]]),
        });
        let still = Equilibrium::new().find(&system).unwrap();
        let exact = (MASS * GRAVITY / k).powf(1.0 / p);
        let found = 0.2 - still.joint(slide)[0];
        assert!((found - exact).abs() < 1e-8 * exact, "{found} for {exact}");
        let observed = still.observations();
        let force = column(&observed, "contact1_force")[0];
        assert!((force - MASS * GRAVITY).abs() < 1e-8, "{force}");
    }
}

/// A sphere, which may be a point, on a plane that falls towards x by an angle in rad; it moves in the plane (x, y), and overlaps as at rest.
pub(crate) struct Incline {
    pub(crate) system: System,
    pub(crate) down: Vector3<f64>,
}

const STIFFNESS: f64 = 10.0;

pub(crate) fn incline(alpha: f64, radius: f64, friction: f64) -> Incline {
    let normal = Vector3::new(alpha.sin(), alpha.cos(), 0.0);
    let down = Vector3::new(alpha.cos(), -alpha.sin(), 0.0);
    let mut system = System::new("incline");
    system.gravity = Some(-Y * GRAVITY);
    let sunk = MASS * GRAVITY * alpha.cos() / STIFFNESS;
    let centre = normal * (radius - sunk);
    let ball = system.add(Body::sphere(RADIUS).mass(MASS).at(centre));
    system.add(Joint::planar(Z).between(GROUND, ball));
    let contact = Contact::on_plane((ball, centre, radius), (GROUND, Vector3::zeros(), normal));
    system.add(contact.stiffness(STIFFNESS).friction(friction));
    Incline { system, down }
}

/// Mean acceleration down the plane in the second half of a time in ms.
pub(crate) fn acceleration(
    incline: &Incline,
    start: &Start,
    model: &Model,
    h: f64,
    time: f64,
) -> f64 {
    let steps = (time / h).round() as usize;
    let discrete = motion(model, start, h, steps, &[]);
    let way = |k: usize| way(model, &discrete, k, &incline.down);
    let quarter = steps / 4;
    let [a, b, c] = [steps - 2 * quarter, steps - quarter, steps].map(way);
    (c - 2.0 * b + a) / (quarter as f64 * h).powi(2)
}

pub(crate) fn way(
    model: &Model,
    discrete: &DiscreteTrajectory,
    k: usize,
    down: &Vector3<f64>,
) -> f64 {
    let instant = crate::common::placed(model, &discrete.z[k]);
    model.poses(&instant)[0].centre.dot(down)
}

#[test]
fn a_ball_rolls_with_five_sevenths_of_the_fall() {
    for degrees in [10.0_f64, 20.0] {
        let alpha = degrees.to_radians();
        for coordinates in BOTH {
            let of = incline(alpha, RADIUS, 0.4);
            let model = model(&of.system, coordinates, 0.1);
            let start = Start::at_rest(&model, at_reference(&model));
            let found = acceleration(&of, &start, &model, 0.1, 100.0);
            let exact = 5.0 / 7.0 * GRAVITY * alpha.sin();
            println!("rolling at {degrees}: {:e}", found / exact - 1.0);
            assert!((found - exact).abs() < 1e-5 * exact, "{found} {exact}");
        }
    }
}

#[test]
fn a_ball_slides_down_with_the_friction_of_its_normal_force() {
    let alpha = 30.0_f64.to_radians();
    for radius in [0.0, RADIUS] {
        let of = incline(alpha, radius, 0.1);
        let model = model(&of.system, Coordinates::Reduced, 0.1);
        let velocity = [of.down * 0.2, Vector3::zeros()];
        let start = with_velocities(&model, at_reference(&model), &[velocity]);
        let found = acceleration(&of, &start, &model, 0.1, 100.0);
        let exact = GRAVITY * (alpha.sin() - 0.1 * alpha.cos());
        println!("sliding with radius {radius}: {:e}", found / exact - 1.0);
        assert!((found - exact).abs() < 1e-5 * exact, "{found} {exact}");
    }
}

#[test]
fn what_sticks_creeps_at_a_part_of_the_slip_speed() {
    let alpha = 10.0_f64.to_radians();
    let of = incline(alpha, 0.0, 0.4);
    let model = model(&of.system, Coordinates::Reduced, 0.5);
    let start = Start::at_rest(&model, at_reference(&model));
    let discrete = motion(&model, &start, 0.5, 400, &[]);
    let [a, b] = [200, 400].map(|k| way(&model, &discrete, k, &of.down));
    // μ N u/√(u² + ε²) = m g sin α.
    let tangent = alpha.tan();
    let exact = 1e-4 * tangent / (0.4 * 0.4 - tangent * tangent).sqrt();
    let found = (b - a) / 100.0;
    assert!((found - exact).abs() < 1e-6 * exact, "{found} {exact}");
    let observed = observations(&model, &discrete);
    let slip = column(&observed, "contact1_slip")[300];
    assert!((slip - exact).abs() < 1e-6 * exact, "{slip} {exact}");
    let friction = column(&observed, "contact1_friction")[300];
    let held = MASS * GRAVITY * alpha.sin();
    assert!((friction - held).abs() < 1e-6 * held, "{friction} {held}");
}

/// Two free bodies that meet, spinning: two spheres, or a sphere and a plate with a plane.
fn pair(is_plate: bool) -> System {
    let mut system = System::new("pair");
    let ball = system.add(
        Body::sphere(8.0)
            .mass(12.0)
            .at(Vector3::new(-9.0, 1.0, 0.5)),
    );
    let sphere = (ball, Vector3::new(-9.0, 1.0, 0.5), 8.0);
    let contact = match is_plate {
        true => {
            let plate = system.add(Body::cuboid([6.0, 40.0, 40.0]).mass(30.0).at(X * 3.0));
            Contact::on_plane(sphere, (plate, Vector3::zeros(), -X))
        }
        false => {
            let other = system.add(Body::sphere(6.0).mass(9.0).at(X * 6.0));
            Contact::of_spheres(sphere, (other, X * 6.0, 6.0))
        }
    };
    system.add(
        contact
            .stiffness(4.0)
            .restitution(0.7, 1.0)
            .friction(0.3)
            .slip_speed(0.01),
    );
    system
}

/// Momenta before and after, and energy with what was lost.
fn balances(system: &System, coordinates: Coordinates, h: f64) -> ([Vector3<f64>; 4], [f64; 3]) {
    let model = model(system, coordinates, h);
    let velocities = [
        [
            Vector3::new(1.0, 0.1, -0.2),
            Vector3::new(0.02, -0.06, 0.09),
        ],
        [
            Vector3::new(-0.3, 0.0, 0.1),
            Vector3::new(0.03, 0.05, -0.04),
        ],
    ];
    let start = with_velocities(&model, at_reference(&model), &velocities);
    let steps = (14.0 / h).round() as usize;
    let discrete = motion(&model, &start, h, steps, &[]);
    let observed = observations(&model, &discrete);
    let [p, l] = ["linear_momentum", "angular_momentum"].map(|name| columns(&observed, name));
    let total = column(&observed, "total_energy");
    let lost = column(&observed, "dissipated_energy");
    assert!(lost.windows(2).all(|pair| pair[1] >= pair[0] - 1e-15));
    assert!(lost[steps] > 0.05 * total[0], "{}", lost[steps]);
    assert!(total.iter().all(|e| *e < total[0] * (1.0 + 1e-6)));
    (
        [p[0], p[steps], l[0], l[steps]],
        [total[0], total[steps], lost[steps]],
    )
}

#[test]
fn a_free_pair_keeps_its_momenta_and_loses_energy() {
    for is_plate in [false, true] {
        let system = pair(is_plate);
        for coordinates in BOTH {
            let drifts = [0.02, 0.01].map(|h| {
                let ([p0, p1, l0, l1], [before, after, lost]) = balances(&system, coordinates, h);
                assert!((p1 - p0).norm() < 1e-11 * p0.norm(), "{p0} {p1}");
                let error = (after + lost - before).abs() / before;
                assert!(error < 1e-3 * h, "{before} {after} {lost}");
                (l1 - l0).norm() / l0.norm()
            });
            println!("{coordinates:?}, plate {is_plate}: {drifts:?}");
            // The midpoint rule turns directors by O(h²) less than they turn.
            assert!(drifts[1] < 1e-6, "{drifts:?}");
            assert!(drifts[0] / drifts[1] > 3.5, "{drifts:?}");
        }
    }
}

#[test]
fn a_heavy_plate_is_a_plane_of_the_ground() {
    let ends = [true, false].map(|is_body| {
        let mut system = System::new("bounce");
        let centre = Vector3::new(0.0, 11.0, 0.0);
        let ball = system.add(Body::sphere(RADIUS).mass(MASS).at(centre));
        let plane = match is_body {
            true => {
                let plate = Body::cuboid([80.0, 10.0, 80.0]).mass(1e7).at(-Y * 5.0);
                Carrier::from(system.add(plate))
            }
            false => GROUND,
        };
        let contact = Contact::on_plane((ball, centre, RADIUS), (plane, Vector3::zeros(), Y));
        let contact = contact.stiffness(10.0).restitution(0.6, 1.0);
        system.add(contact.friction(0.2).slip_speed(0.05));
        let model = model(&system, Coordinates::Reduced, 0.05);
        let still = [Vector3::zeros(); 2];
        let moving = [Vector3::new(0.5, -1.0, 0.2), Vector3::new(0.0, 0.02, -0.03)];
        let start = with_velocities(&model, at_reference(&model), &[moving, still]);
        let discrete = motion(&model, &start, 0.05, 240, &[]);
        let observed = observations(&model, &discrete);
        assert!(column(&observed, "contact1_gap")[240] > 0.1);
        model.poses(&crate::common::placed(&model, &discrete.z[240]))[0]
    });
    let [body, ground] = ends;
    assert!((body.centre - ground.centre).norm() < 1e-4, "{ends:?}");
    assert!(
        (body.directors - ground.directors).norm() < 1e-5,
        "{ends:?}"
    );
}

#[test]
fn a_smooth_contact_reads_no_spin() {
    let count = |friction: Option<f64>| {
        let mut system = System::new("free");
        // Its directors are no axes of the ground, which friction reads.
        let ball = Body::sphere(RADIUS).mass(MASS).at(Y * (RADIUS + 1.0));
        let ball = system.add(ball.along(Vector3::new(1.0, 2.0, 3.0)));
        let contact = floor(ball, 1.0).stiffness(10.0).restitution(0.5, 1.0);
        system.add(friction.map_or(contact.clone(), |mu| contact.friction(mu)));
        let model = model(&system, Coordinates::Redundant, 0.1);
        let mut left_out = model.left_out.iter();
        let why = left_out.find(|one| one.term == "contact friction");
        (model.vectors.len(), why.map(|one| one.why))
    };
    let (smooth, why) = count(None);
    assert_eq!(why, Some("no contact that moves names a friction"));
    assert_eq!(count(Some(0.3)), (smooth + 3, None));
}

#[test]
fn a_touch_of_few_steps_is_told() {
    let (mut system, ball, _) = falling(1.0);
    system.gravity = Some(-Y * GRAVITY);
    system.add(floor(ball, 1.0).stiffness(1000.0).restitution(0.9, 0.1));
    let told = |step: f64| {
        let run = Simulation::over(40.0).step(step).run(&system).unwrap();
        let remarks = run.remarks().iter();
        let mut touches = remarks.filter(|remark| remark.code == "coarse_touches");
        touches.next().map(|remark| remark.text.clone())
    };
    // A touch lasts π√(m/k) = 0.44 ms.
    let text = told(0.2).unwrap();
    assert!(text.contains("contact1 at 0.0"), "{text}");
    assert_eq!(told(0.02), None);
}

const SCENE: &str = r#"{
  "name": "touching", "gravity": [0, -9.81, 0],
  "bodies": [
    { "name": "ball", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [0, 0.011, 0], "free": true },
    { "name": "other", "mass": "20 g", "sphere": { "radius": "10 mm" }, "position": [0, 0.032, 0], "free": true }
  ],
  "contacts": [
    { "name": "floor", "sphere": { "body": "ball", "at": [0, 0.011, 0], "radius": "10 mm" }, "plane": { "at": [0, 0, 0], "normal": [0, 2, 0] },
      "stiffness": "10 N/mm", "smoothing": "1 um", "restitution": { "coefficient": 0.8, "speed": "1 m/s" }, "friction": 0.4, "slip_speed": "1 mm/s" },
    { "name": "pair", "sphere": { "body": "ball", "at": [0, 0.011, 0], "radius": "10 mm" },
      "other": { "body": "other", "at": [0, 0.032, 0], "radius": "9 mm" }, "hertz": [ { "modulus": "2 MPa", "poisson_ratio": 0.25 } ] }
  ]
}"#;

#[test]
fn files_say_contacts() {
    let read_contacts = read(SCENE).unwrap().components.contacts;
    let mut system = System::new("touching");
    let [ball, other] = [11.0, 32.0].map(|y| {
        let body = Body::sphere(RADIUS).mass(MASS).at(Y * y);
        (system.add(body), Y * y)
    });
    let floor = Contact::on_plane((ball.0, ball.1, 10.0), (GROUND, Vector3::zeros(), Y));
    let floor = floor.stiffness(10.0).smoothing(1e-3).restitution(0.8, 1.0);
    let pair = Contact::of_spheres((ball.0, ball.1, 10.0), (other.0, other.1, 9.0));
    let floor = floor.friction(0.4).slip_speed(1e-3).named("floor");
    let same = [floor, pair.hertz(&[[2.0, 0.25]]).named("pair")];
    for (read, built) in read_contacts.iter().zip(&same) {
        // Conversions of units round.
        let [read, built] = [read, built].map(|one| format!("{one:.9?}"));
        assert_eq!(read, built);
    }
    for (from, to, told) in [
        (
            r#""stiffness": "10 N/mm", "#,
            "",
            "\"stiffness\", \"hertz\"",
        ),
        (r#""friction": 0.4, "#, "", "contacts[0].slip_speed"),
        (
            r#""plane": { "at": [0, 0, 0], "normal": [0, 2, 0] },"#,
            "",
            "\"plane\", \"other\"",
        ),
        ("[0, 2, 0]", "[0, 0, 0]", "plane.normal"),
        (
            r#""sphere": { "body": "ball""#,
            r#""sphere": { "body": "bell""#,
            "sphere.body",
        ),
        (
            r#""name": "pair""#,
            r#""name": "floor""#,
            "contacts[1].name",
        ),
        ("\"10 N/mm\"", "\"10 N\"", "a stiffness"),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let message = read(&SCENE.replacen(from, to, 1)).unwrap_err();
        assert!(message.contains(told), "{from}: {message}");
    }
}
