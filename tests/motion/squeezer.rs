//! Andrews' squeezing mechanism: seven bodies, ten parallel hinges, three loops, against the published motion.
//!
//! Parameters and solution: Test Set for IVP Solvers (F. Mazzia, C. Magherini), problem "Andrews' squeezing mechanism", in SI units.

use crate::common::{at_reference, bare, body, motion, richardson};
use crate::reactions::hinge;
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::Start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::components::{Load, LoadPlace, Spring};
use proboscis::model::system::{Attachment, Body, System};
use proboscis::model::{Coordinates, Model};

/// Angles β, Θ, γ, Φ, δ, Ω, ε at the start and at 0.03 s.
const START: [f64; 7] = [
    -0.0617138900142764,
    0.0,
    0.455279819163070,
    0.222668390165886,
    0.487364979543843,
    -0.222668390165886,
    1.23054744454982,
];
const END: [f64; 7] = [
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
];

fn squeezer() -> System {
    let [beta, theta, gamma, phi, delta, omega, epsilon] = START;
    let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let polar = |length: f64, angle: f64| at(length * angle.cos(), length * angle.sin());
    // Along an axis turned by an angle, and across it.
    let turned = |along: f64, across: f64, angle: f64| {
        polar(along, angle) + polar(across, angle + std::f64::consts::FRAC_PI_2)
    };
    let right = -std::f64::consts::FRAC_PI_2;
    let [a, b, c] = [
        at(-0.06934, -0.00227),
        at(-0.03635, 0.03273),
        at(0.014, 0.072),
    ];
    let crank = polar(0.007, beta);
    let knot = crank - polar(0.028, beta + theta);
    let heel = a + polar(0.04, delta);
    let foot = a + polar(0.04, epsilon + right);
    let masses = [
        0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498,
    ];
    let inertias = [
        2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5,
    ];
    let centres = [
        polar(0.00092, beta),
        crank - polar(0.0115, beta + theta),
        b + turned(0.01874, 0.01043, gamma + right),
        heel + polar(0.02 - 0.01421, phi + delta + right),
        a + turned(0.02308, 0.00916, delta),
        foot + polar(0.02 - 0.01421, omega + epsilon),
        a + turned(0.01228, -0.00449, epsilon + right),
    ];
    let bodies = (0..7).map(|i| -> Body {
        let name = format!("K{}", i + 1);
        body(
            &name,
            masses[i],
            [inertias[i]; 3],
            centres[i],
            Matrix3::identity(),
        )
    });
    let joints = vec![
        hinge("O", None, 0, Vector3::zeros()),
        hinge("crank", Some(0), 1, crank),
        hinge("B", None, 2, b),
        hinge("knot3", Some(1), 2, knot),
        hinge("A5", None, 4, a),
        hinge("heel", Some(4), 3, heel),
        hinge("knot4", Some(1), 3, knot),
        hinge("A7", None, 6, a),
        hinge("foot", Some(6), 5, foot),
        hinge("knot6", Some(1), 5, knot),
    ];
    let mut system = bare(bodies.collect(), joints, None);
    system.components.springs.push(Spring {
        name: "spring".into(),
        from: Attachment { body: None, at: c },
        to: Attachment {
            body: Some(2),
            at: b + turned(0.018, 0.02, gamma + right),
        },
        stiffness: Some(4530.0),
        damping: None,
        rest_length: 0.07785,
    });
    system.components.loads.push(Load {
        name: "drive".into(),
        on: LoadPlace::Joint(0),
    });
    system
}

#[test]
fn the_squeezing_mechanism_moves_as_published() {
    let model = Model::new(squeezer(), None, 1e-4, &[]).unwrap();
    assert_eq!(model.coordinates, Coordinates::Reduced);
    assert_eq!(model.loops.left_out().count(), 9);
    assert_eq!(model.loops.mobility, Some(1));
    let start = Start::at_rest(&model, at_reference(&model));
    let scalars = model.scalars(&[0.033]);
    assert_eq!(scalars, [0.033]);
    let ends = [300, 600, 1200].map(|steps| {
        let discrete = motion(&model, &start, 0.03 / steps as f64, steps, &scalars);
        let motion = Trajectory::from_discrete(&model, &discrete);
        motion.joints[steps].clone()
    });
    // Joint coordinates in the order of the scene, counted from the start: hinges O, crank, B, A5, heel.
    let change = |i: usize| END[i] - START[i];
    let exact = [
        (0, change(0)),
        (1, change(1)),
        (2, change(2)),
        (4, change(4)),
        (5, change(3)),
        (7, change(6)),
        (8, change(5)),
    ];
    for (joint, exact) in exact {
        let values = ends.each_ref().map(|row| row[joint]);
        let errors = values.map(|value| (value - exact).abs());
        let limit = (richardson(&values) - exact).abs();
        println!("joint {joint}: {exact} by {errors:?}, limit {limit:e}");
        assert!(
            ((errors[1] / errors[2]).log2() - 2.0).abs() < 0.2,
            "{errors:?}"
        );
        assert!(limit < 1e-7, "{limit:e}");
    }
}
