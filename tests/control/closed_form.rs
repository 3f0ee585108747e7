//! Optimal control of one degree of freedom with a force, in closed form (docs/theory.md, 12.4).
//!
//! A force s along n is the potential −s n·x, a torque s about the ground's axis the potential −s θ, with s constant in
//! each interval: the midpoint rule gives f⁻ = f⁺ = (h/2) s.

use crate::common::force::{Force, UNIT, with_control};
use crate::common::{bare, body, joint};
use nalgebra::{Matrix3, SVector, Vector3};
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Guess, Objective, Solver, SoughtHold,
};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::energy::Energy;
use proboscis::ipopt::{self, LinearSolver, Options};
use proboscis::kinematics::MaterialVector;
use proboscis::math::Jet;
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::differences;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

/// `−s atan2(y, x)` of a vector (x, y, ·) that stays to the right, arguments: the vector and s.
#[derive(Clone)]
struct Torque;

impl Energy<4> for Torque {
    type Local<const ORDER: usize> = Jet<4, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> Jet<4, ORDER> {
        // Relative to the direction now, where atan(t) has the derivatives 1, 0, −2.
        let (sin, cos) = p[1].atan2(p[0]).sin_cos();
        let (x, y) = (Jet::argument(0, p, w), Jet::argument(1, p, w));
        let ratio = (y * cos - x * sin) * (x * cos + y * sin).recip();
        let angle = ratio.map([0.0, 1.0, 0.0, -2.0]) + p[1].atan2(p[0]);
        angle * Jet::argument(3, p, w) * -UNIT
    }
}

/// Optimal value of Σ h s² from rest at zero to rest at `goal` of the one joint, and the optimal s.
fn optimum(
    scene: &System,
    coordinates: Coordinates,
    goal: f64,
    time: f64,
    intervals: usize,
    control: impl FnOnce(Model) -> Model,
) -> (f64, Vec<f64>) {
    let rest_at = |angle: f64| BoundaryState::JointAngles {
        angles: BTreeMap::from([(0, angle)]),
        rates: BTreeMap::new(),
        velocities: Default::default(),
    };
    let problem = Control {
        duration: Duration::Given(time),
        intervals,
        input_intervals: 1,
        is_refined: false,
        varied: Vec::new(),
        outcomes: Vec::new(),
        start: rest_at(0.0),
        goal: rest_at(goal),
        voltage_bounds: [f64::NEG_INFINITY, f64::INFINITY],
        load_bounds: Default::default(),
        given: BTreeMap::new(),
        course: None,
        parameters: Vec::new(),
        continues: [false; 2],
        sought_hold: SoughtHold::default(),
        hold: Default::default(),
        // h is in ms and the effort in s.
        objective: Objective {
            effort: 1e3,
            ..Objective::default()
        },
        limits: Vec::new(),
        waypoints: Vec::new(),
        coordinates: Some(coordinates),
        guess: Guess::Interpolate,
        solver: Solver {
            tolerance: 1e-10,
            max_iterations: 200,
            linear_solver: LinearSolver::Auto,
            ipopt: BTreeMap::new(),
        },
    };
    let h = time / intervals as f64;
    let (model, mut boundary) = BoundaryConditions::resolve(scene, &problem, h).unwrap();
    let model = control(model);
    boundary.rest = [Some(vec![0.0]), Some(vec![0.0])];
    let initial = guess(&model, &boundary, &problem, h, None);
    let mut program = Transcription::new(&model, &boundary, &problem, &initial).unwrap();
    let start = program.start(&initial);
    let report = differences::check(&mut program, &start.x, 3);
    assert!(report.is_consistent(), "{report}");
    let options = Options {
        tolerance: 1e-11,
        ..Options::default()
    };
    let solution = ipopt::solve(&mut program, &start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(solution.status.is_solved(), "{:?}", solution.status);
    let discrete = program.decode(&solution.x);
    let s: Vec<f64> = discrete.scalars.iter().map(|s| s[0] * UNIT).collect();
    let effort: f64 = s.iter().map(|s| h * s * s).sum();
    assert!((effort - solution.objective).abs() < 1e-12 * effort);
    (effort, s)
}

#[test]
fn a_double_integrator_pays_n2_over_n2_minus_1() {
    let (mass, goal, time) = (1.3, 0.7, 2.0);
    let axis = Vector3::new(1.0, -2.0, 2.0) / 3.0;
    let slider = body(
        "slider",
        mass,
        [0.4, 0.5, 0.6],
        Vector3::zeros(),
        Matrix3::identity(),
    );
    let rail = joint(
        "rail",
        JointKind::Prismatic { axis },
        None,
        0,
        Vector3::zeros(),
    );
    let scene = bare(vec![slider], vec![rail], None);
    // I q̈ = τ, I = 1.3, Δq = 0.7, T = 2: a τ that falls linearly, J = 12 I²Δq²/T³ · N²/(N² − 1).
    let continuous = 12.0 * (mass * goal) * (mass * goal) / (time * time * time);
    for (n, expected) in [
        (4_u32, 1.32496),
        (10, 1.2546969696969694),
        (50, 1.2426470588235292),
    ] {
        let (count, h) = (f64::from(n), time / f64::from(n));
        let exact = continuous * count * count / (count * count - 1.0);
        assert!((exact - expected).abs() < 1e-12);
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let (effort, force) = optimum(&scene, coordinates, goal, time, n as usize, |model| {
                let centre = MaterialVector::point(Some(0), &Vector3::zeros(), &model.reference);
                with_control(model, Force { direction: axis }, &centre)
            });
            println!("{n} {coordinates:?}: {effort} against {exact}");
            assert!(
                (effort - exact).abs() < 1e-8 * exact,
                "{effort} against {exact}"
            );
            let slope = 12.0 * mass * goal / (h * h * count * (count * count - 1.0));
            for (k, f) in force.iter().enumerate() {
                let expected = slope * (0.5 * (count - 1.0) - k as f64);
                assert!(
                    (f - expected).abs() < 1e-6 * force[0],
                    "{k}: {f} against {expected}"
                );
            }
        }
    }
}

#[test]
fn a_quarter_turn_in_directors_costs_the_discrete_optimum() {
    let inertia = [0.9, 1.1, 1.3];
    let (goal, time) = (FRAC_PI_2, 2.0);
    let rotor = body("rotor", 2.0, inertia, Vector3::zeros(), Matrix3::identity());
    let axle = joint(
        "axle",
        JointKind::Revolute { axis: Vector3::z() },
        None,
        0,
        Vector3::zeros(),
    );
    let scene = bare(vec![rotor], vec![axle], None);
    // L_d = J₃ (1 − cos Δθ)/h with the torque on the joint angle: p_{k+½} = J₃ sin Δθ/h; verified by a second code.
    let table = [
        (5, 6.193599310),
        (10, 6.238376704),
        (20, 6.250676592),
        (40, 6.253811654),
    ];
    let continuous = 12.0 * (1.3 * goal) * (1.3 * goal) / 8.0;
    assert!((continuous - 6.254861789190381).abs() < 1e-12);
    for (n, expected) in table {
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let (effort, _) = optimum(&scene, coordinates, goal, time, n, |model| {
                let director = MaterialVector::direction(Some(0), &Vector3::x(), &model.reference);
                with_control(model, Torque, &director)
            });
            println!("{n} {coordinates:?}: {effort:.9} against {expected:.9}");
            assert!(
                (effort - expected).abs() < 1e-8,
                "{effort} against {expected}"
            );
        }
    }
}
