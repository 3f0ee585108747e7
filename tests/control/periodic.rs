//! Periodic motions: a closed form, an independent program, motions that come back, and what is refused.

use crate::loads::{assert_refused, cart, loaded, solved};
use proboscis::control::BoundaryConditions;
use proboscis::control::problem::{
    BoundaryState, Control, EnergyCost, SourceEnergy, Task, Waypoint,
};
use proboscis::dynamics::simulate;
use proboscis::files::read_problem;
use proboscis::model::system::{MaxwellBranch, MaxwellBranches};
use proboscis::nlp::Status;
use proboscis::prelude::{Body, GROUND, Joint, Load, State, System, X};
use proboscis::stop::{self, Questions};
use proboscis::tasks::{SolveRequest, solve};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// A joint coordinate that is passed at a part of the duration.
fn pass(part: f64, coordinate: f64) -> Waypoint {
    Waypoint {
        part,
        name: "waypoint".into(),
        angles: BTreeMap::from([(0, coordinate)]),
        ..Waypoint::default()
    }
}

#[test]
fn to_and_fro_costs_its_closed_form_with_order_two() {
    // Each half is a motion from rest to rest by 2 m in 0.5 s: 2 · 4 · 12/0.5³ = 768 N² s.
    for coordinates in ["reduced", "redundant"] {
        let errors = [20, 40].map(|intervals| {
            let (system, mut control) = cart(intervals, &[], coordinates);
            control.goal = BoundaryState::Periodic;
            control.waypoints = vec![pass(0.5, 1000.0), pass(1.0, -1000.0)];
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            let joints = &optimum.motion.joints;
            assert!((joints[intervals / 2][0] - 1000.0).abs() < 1e-6);
            for k in [0, intervals] {
                assert!((joints[k][0] + 1000.0).abs() < 1e-6, "{}", joints[k][0]);
            }
            optimum.solution.objective - 768.0
        });
        assert!(errors[0].abs() > 1e-2, "{errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.2, "{coordinates}: {errors:?}");
    }
}

/// A rod that a motor swings periodically.
fn rod(coordinates: &str) -> (System, Control) {
    let (system, mut control) = loaded(&[
        "scene.joints[0].stops=null".to_owned(),
        "scene.loads=[{\"name\": \"motor\", \"joint\": \"shoulder\"}]".to_owned(),
        "control.loads={}".to_owned(),
        "control.duration=0.9 s".to_owned(),
        "control.intervals=40".to_owned(),
        r#"control.goal="periodic""#.to_owned(),
        r#"control.load_bounds={"motor": [-10, 10]}"#.to_owned(),
        r#"control.objective={"effort": 1, "rate": 0.001}"#.to_owned(),
        format!("control.coordinates={coordinates:?}"),
        r#"control.solver={"tolerance": 1e-12}"#.to_owned(),
    ]);
    control.waypoints = vec![pass(0.5, 0.8), pass(1.0, -0.3)];
    (system, control)
}

#[test]
fn a_motor_swings_a_rod_periodically_as_in_an_independent_program() {
    let text = include_str!("../reference/periodic.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let [exact, torque] = ["objective", "torque"].map(|key| reference[key].as_f64().unwrap());
    for coordinates in ["reduced", "redundant"] {
        let (system, control) = rod(coordinates);
        let optimum = solved(&system, &control);
        assert_eq!(optimum.solution.status, Status::Solved);
        let found = optimum.solution.objective;
        assert!((found - exact).abs() < 1e-8 * exact, "{found:e} {exact:e}");
        let first = optimum.motion.voltages[0][0] / 1e3;
        assert!((first - torque).abs() < 1e-7, "{first} {torque}");
    }
}

fn pair(changes: &[String]) -> (System, Control) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_swing.json");
    let loaded = read_problem(&path, changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    (loaded.system, *control)
}

#[test]
fn muscles_swing_a_segment_that_comes_back_in_every_period() {
    let (system, control) = pair(&[]);
    let request = SolveRequest::default();
    let result = solve(&system, &control, request, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(result.verdict.is_solved, "{:?}", result.verdict);
    let (optimum, n) = (&result.optimum, 40);
    let motion = &optimum.motion;
    let h = motion.times[1];
    // Three periods from the start that was found, with the steps of the optimum.
    let scalars = |from: f64, _: f64| {
        let k = (from / h).round() as usize % n;
        optimum.model.scalars(&motion.voltages[k])
    };
    let start = &optimum.boundary.start;
    let go_on = |_: &_| ControlFlow::Continue(());
    let (again, failure) = simulate(&optimum.model, start, h, 3 * n, scalars, go_on);
    assert_eq!(failure, None);
    let degree = 1_f64.to_radians();
    for (k, degrees) in [
        (0, -5.0),
        (n / 2, 5.0),
        (n, -5.0),
        (5 * n / 2, 5.0),
        (3 * n, -5.0),
    ] {
        let joint = again.z[k][0];
        assert!((joint - degrees * degree).abs() < 1e-6, "{k}: {joint}");
    }
    // A quarter of a period after the turn it moves, and does so again two periods later.
    let [first, last] = [n / 4, 2 * n + n / 4].map(|k| again.momenta[k][0]);
    assert!(
        first.abs() > 1e-3 && (first - last).abs() < 1e-6 * first.abs(),
        "{first} {last}"
    );
    let repeated = optimum.repeated.as_ref().unwrap();
    assert!(
        repeated.comes_back && repeated.periods == 5 && repeated.drift.angle < 1e-6,
        "{repeated:?}"
    );
    let notes: Vec<String> = result.remarks.lines().collect();
    assert!(
        notes
            .iter()
            .any(|note| note.contains("the motion is periodic")),
        "{notes:?}"
    );
    // Rates of voltages are limited from the last interval to the first one too: 150 kV/s over 2 ms are 300 V.
    let mut closed = motion.voltages.clone();
    closed.push(motion.voltages[0].clone());
    let steps = closed
        .windows(2)
        .flat_map(|rows| [rows[1][0] - rows[0][0], rows[1][1] - rows[0][1]]);
    let steps: Vec<f64> = steps.map(f64::abs).collect();
    assert!(steps.iter().all(|step| *step < 300.01), "{steps:?}");
    assert!(
        steps.iter().filter(|step| **step > 299.9).count() > 3,
        "{steps:?}"
    );
    // Without the limit it costs less.
    let (system, control) = pair(&["control.limits=[]".to_owned()]);
    let free = solved(&system, &control);
    assert!(free.solution.objective < 0.999 * optimum.solution.objective);
}

#[test]
fn the_start_may_be_any_instant() {
    // Effort, rate and limited rates are the same wherever the period is cut.
    let objective = r#"control.objective={"effort": 1, "rate": 0.001}"#.to_owned();
    let (system, control) = pair(&[objective]);
    let turn = 5_f64.to_radians();
    let objectives = [(0.5, 1.0), (0.25, 0.75), (0.9, 0.4)].map(|(there, back)| {
        let mut control = control.clone();
        control.waypoints = vec![pass(there, turn), pass(back, -turn)];
        let optimum = solved(&system, &control);
        assert_eq!(optimum.solution.status, Status::Solved);
        println!("{there} {back}: {}", optimum.solution.objective);
        optimum.solution.objective
    });
    let [first, ..] = objectives;
    assert!(
        objectives.iter().all(|o| (o - first).abs() < 1e-7 * first),
        "{objectives:?}"
    );
}

#[test]
fn a_free_period_is_found() {
    let duration = r#"control.duration={"min": "0.15 s", "max": "0.26 s", "guess": "0.2 s"}"#;
    let (system, control) = pair(&["control.limits=[]".to_owned(), duration.to_owned()]);
    let optimum = solved(&system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    let found = optimum.motion.times[40];
    let given = [
        "control.limits=[]".to_owned(),
        "control.duration=0.2 s".to_owned(),
    ];
    let (system, control) = pair(&given);
    let given = solved(&system, &control);
    println!(
        "{found} ms: {} {}",
        optimum.solution.objective, given.solution.objective
    );
    assert!(
        (160.0..199.0).contains(&found),
        "near the frequency of the pair: {found} ms"
    );
    assert!(optimum.solution.objective < 0.999 * given.solution.objective);
}

#[test]
fn a_program_moves_periodically_too() {
    let mut system = System::new("cart");
    let body = system.add(Body::sphere(10.0).mass(1000.0));
    let slide = system.add(Joint::prismatic(X).between(GROUND, body));
    let motor = system.add(Load::motor(slide));
    let problem = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -500.0..=500.0)
        .effort(1.0)
        .start(State::Reference)
        .joint_passes(slide, 1000.0, 0.5)
        .joint_passes(slide, -1000.0, 1.0);
    let optimum = problem
        .clone()
        .goal(State::Periodic)
        .solve(&system)
        .unwrap();
    assert!(
        (optimum.objective - 768.0).abs() < 20.0,
        "{}",
        optimum.objective
    );
    assert!(optimum.repeated.unwrap().comes_back);
    let wrong = problem.solve(&system);
    assert!(wrong.unwrap_err().to_string().contains("below 1"));
}

/// A stop while the motion is repeated takes periods away, and says neither that it comes back in none nor that it does not.
#[test]
fn a_stop_between_periods_is_no_drift() {
    let (system, control) = pair(&[]);
    let within = |allowed: u64| {
        let questions = Questions::allowed(allowed);
        let watch = stop::watch_questions(&questions);
        let request = SolveRequest::default();
        let result = solve(&system, &control, request, &mut |_, _| {
            ControlFlow::Continue(())
        });
        drop(watch);
        (result.unwrap().optimum, questions.asked())
    };
    let (whole, asked) = within(u64::MAX);
    assert_eq!(whole.repeated.unwrap().periods, 5);
    let mut periods = Vec::new();
    for part in 1..16 {
        let (stopped, _) = within(asked - part * asked / 32);
        let Some(repeated) = stopped.repeated else {
            periods.push(0);
            continue;
        };
        assert!(
            repeated.comes_back && repeated.failure.is_none(),
            "{repeated:?}"
        );
        assert!(repeated.periods > 0);
        periods.push(repeated.periods);
    }
    println!("{asked} {periods:?}");
    assert!(
        periods.contains(&0) && periods.iter().any(|&p| (1..5).contains(&p)),
        "{periods:?}"
    );
}

#[test]
fn what_has_no_period_is_refused_with_its_place() {
    assert_refused(
        "pair_swing",
        r#"control.goal="periodical""#,
        "control.goal",
        "periodic",
    );
    assert_refused(
        "pair_swing",
        r#"control.waypoints[1].part=1.5"#,
        "waypoints[1].part",
        "at most 1",
    );
    let (system, mut control) = pair(&[]);
    control.objective.energies.push(EnergyCost {
        source: 0,
        energy: SourceEnergy::Electrical,
        weight: 1.0,
    });
    let error = BoundaryConditions::resolve(&system, &control, 5.0).unwrap_err();
    assert!(error.to_string().contains("energies of sources"), "{error}");
    let (mut system, control) = pair(&[]);
    let one = Control {
        intervals: 1,
        ..control.clone()
    };
    let error = BoundaryConditions::resolve(&system, &one, 5.0).unwrap_err();
    assert!(
        error.to_string().contains("at least two intervals"),
        "{error}"
    );
    let branch = MaxwellBranch {
        shear_modulus: 0.05,
        relaxation_time: 20.0,
    };
    system.muscles[0].material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    let error = BoundaryConditions::resolve(&system, &control, 5.0).unwrap_err();
    assert!(error.to_string().contains("do not creep"), "{error}");
}
