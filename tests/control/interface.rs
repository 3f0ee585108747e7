//! The library as a program uses it: its examples, the same systems as those of files, and refusals.

use proboscis::control::problem::Task;
use proboscis::files::read_problem;
use proboscis::prelude::*;
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use std::ops::ControlFlow;
use std::path::Path;

#[path = "../../examples/fe_block.rs"]
mod fe_block;
#[path = "../../examples/nlp.rs"]
mod nlp;
#[path = "../../examples/own_component.rs"]
mod own_component;
#[path = "../../examples/spring.rs"]
mod spring;
#[path = "../../examples/tracking.rs"]
mod tracking;
#[path = "../../examples/trunk.rs"]
mod trunk;

#[test]
fn examples_run() {
    spring::main().unwrap();
    fe_block::main().unwrap();
    nlp::main().unwrap();
    own_component::main().unwrap();
    tracking::main().unwrap();
    trunk::main().unwrap();
}

/// The trunk of `problems/elephant_trunk_effort.json`, part by part.
fn elephant() -> (System, Vec<Handle<Muscle>>, Handle<Marker>) {
    let silicone = Material::elastomer(kpa(100.0))
        .density(kg_per_m3(1000.0))
        .relative_permittivity(3.0)
        .viscosity(pa_s(1000.0));
    let silicone = Material {
        lame_lambda: Some(kpa(400.0)),
        ..silicone
    };
    let mut trunk = System::new("elephant trunk");
    let (mut below, mut muscles) = (GROUND, Vec::new());
    for i in 0..6 {
        let base = Y * mm(50.0 * f64::from(i));
        let body = Body::cylinder(mm(50.0), mm(20.0)).mass(g(30.0));
        let name = format!("segment{}", i + 1);
        let segment = trunk.add(body.at(base + Y * mm(25.0)).along(Y).named(name));
        let (axis, out) = if i % 2 == 0 { (Z, X) } else { (X, Z) };
        trunk.add(Joint::revolute(axis).between(below, segment).at(base));
        for side in [out, -out] {
            let end = |y: f64| base + side * mm(15.0) + Y * mm(y);
            let muscle = Muscle::of(&silicone)
                .section(mm(10.0), mm(10.0))
                .layer(um(50.0));
            muscles.push(trunk.add(muscle.from(below, end(-20.0)).to(segment, end(20.0))));
        }
        below = segment.into();
    }
    let tip = trunk.add(Marker::on(below, Y * mm(300.0)).named("tip"));
    (trunk, muscles, tip)
}

#[test]
fn a_trunk_made_by_a_program_is_steered_as_that_of_a_file() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk_effort.json");
    let loaded = read_problem(&file, &[]).unwrap();
    let (trunk, muscles, tip) = elephant();
    assert_eq!(trunk.bodies.len(), loaded.system.bodies.len());
    for (made, read) in trunk.bodies.iter().zip(&loaded.system.bodies) {
        assert!((made.centre - read.centre).norm() < 1e-12);
        assert_eq!(made.inertia, read.inertia);
    }
    for (made, read) in trunk.muscles.iter().zip(&loaded.system.muscles) {
        let [from, to] = [made.from.at - read.from.at, made.to.at - read.to.at];
        assert!(
            from.norm() + to.norm() < 1e-12,
            "{} {}",
            made.name,
            read.name
        );
    }
    let goal = [1, 2, 5, 6, 9, 10].map(|m| (muscles[m], kv(if m % 4 == 1 { 1.7 } else { 1.6 })));
    let problem = Control::over(s(0.6), 40)
        .goal(State::rest_at(goal))
        .voltage_bounds(0.0, kv(3.0))
        .effort(1.0);
    let found = problem.solve(&trunk).unwrap();
    assert!(found.is_solved(), "{}", found.status);
    let Task::Control(control) = &loaded.task else {
        unreachable!("the file asks for control");
    };
    let limits = SolveLimits::default();
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let of_file = optimise(&loaded.system, control, None, limits, go_on).unwrap();
    let objective = of_file.solution.objective;
    assert!(objective > 0.1 && (found.objective - objective).abs() < 1e-9 * objective);
    let end = *found.motion.position(tip).last().unwrap();
    assert!((end - Y * 300.0).norm() > 50.0);
    // Charged muscles hold the trunk at the end: their sources gave at least what they store.
    for &muscle in &muscles {
        let energy = found.motion.electrical_energy(muscle);
        let work = found.motion.mechanical_work(muscle);
        assert_eq!((energy.len(), work.len(), energy[0]), (41, 41, 0.0));
        assert!(energy[40] > work[40].abs(), "{} {}", energy[40], work[40]);
    }
    // It moves from rest to rest.
    let seen = found.motion.observations().columns;
    let rates = seen.iter().filter(|column| column.unit == "rad/ms");
    let rates: Vec<&[f64]> = rates.map(|column| column.values.as_slice()).collect();
    assert_eq!(rates.len(), 6);
    for rate in rates {
        let largest = rate.iter().fold(0.0_f64, |max, rate| max.max(rate.abs()));
        let ends = rate[0].abs().max(rate[40].abs());
        assert!(largest > 1e-4 && ends < 1e-8, "{largest} {ends}");
    }
    // Its solution is a start from which nothing is left to do.
    let again = problem.starting_from(found.solution).solve(&trunk).unwrap();
    assert!(
        again.is_solved() && again.iterations <= 3,
        "{}",
        again.iterations
    );
}

#[test]
fn a_tip_follows_a_path_of_a_program_as_that_of_a_file() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = file.join("problems/elephant_trunk_figure_eight.json");
    let loaded = read_problem(&file, &["control.intervals=40".to_owned()]).unwrap();
    let Task::Control(control) = loaded.task else {
        unreachable!("the file asks for control");
    };
    let limits = SolveLimits::default();
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let of_file = optimise(&loaded.system, &control, None, limits, go_on).unwrap();
    let (trunk, muscles, tip) = elephant();
    let sine = |amplitude: f64, period: f64| {
        Some(Signal::Sine {
            mean: 0.0,
            amplitude: mm(amplitude),
            frequency: s(period).recip(),
            phase: 0.0,
        })
    };
    let problem = Control::over(s(2.0), 40)
        .goal(State::Free)
        .voltage_bounds(0.0, kv(3.0))
        .rate(1e-4)
        .track(tip, [sine(40.0, 2.0), None, sine(20.0, 1.0)], 1.0)
        .field_below(&muscles, 80e3);
    let found = problem.solve(&trunk).unwrap();
    assert!(found.is_solved(), "{}", found.status);
    let objective = of_file.solution.objective;
    assert!(objective > 1e-3 && (found.objective - objective).abs() < 1e-7 * objective);
    let warned = found.motion.remarks().iter();
    assert!(
        warned
            .filter(|remark| remark.code == "free_end" && remark.text.contains("the end is free"))
            .count()
            == 1
    );
    // The deviations are those of the eight, in mm.
    let far = |(t, tip): (&f64, &nalgebra::Vector3<f64>)| {
        let turn = std::f64::consts::PI * t / 1e3;
        (tip.x - 40.0 * turn.sin()).hypot(tip.z - 20.0 * (2.0 * turn).sin())
    };
    let places = found.motion.position(tip);
    let most = found
        .motion
        .times()
        .iter()
        .zip(&places)
        .map(far)
        .fold(0.0, f64::max);
    let [one] = &found.tracking[..] else {
        panic!("{:?}", found.tracking);
    };
    assert_eq!((one.kind, one.name.as_str()), ("marker", "tip"));
    assert!(most > 1e-3 && (1e3 * one.error.maximum - most).abs() < 1e-9);
    assert!(one.simulated.is_some());
    // Ends near a place, without a path.
    let near = Y * 290.0 + X * 40.0;
    let problem = Control::over(s(0.4), 20)
        .goal(State::Free)
        .voltage_bounds(0.0, kv(3.0))
        .effort(1e-3)
        .end_near(tip, near, 1.0);
    let found = problem.solve(&trunk).unwrap();
    let end = *found.motion.position(tip).last().unwrap();
    assert!(found.is_solved() && (end - near).norm() < 2.0, "{end}");
    let weightless = problem.end_near(tip, near, -1.0).solve(&trunk);
    assert!(
        weightless
            .unwrap_err()
            .to_string()
            .contains("a positive weight")
    );
}

#[test]
fn what_makes_no_sense_is_refused() {
    let (trunk, muscles, _) = elephant();
    let told = |result: Result<Motion>| result.unwrap_err().to_string();
    let simulate = |system: &System| Simulation::over(ms(20.0)).step(ms(10.0)).run(system);
    assert!(simulate(&trunk).is_ok());

    let mut wrong = trunk.clone();
    wrong.bodies[2].mass = 0.0;
    assert!(told(simulate(&wrong)).contains("segment3.mass: found 0"));
    let mut wrong = trunk.clone();
    wrong.joints[1].child = 17;
    assert!(told(simulate(&wrong)).contains("body 17 of 6"));
    let mut wrong = trunk.clone();
    wrong.muscles[3].layer_thickness = f64::NAN;
    assert!(told(simulate(&wrong)).contains("muscle4.layer_thickness: found NaN"));
    let mut wrong = trunk.clone();
    wrong.bodies[1].name = "segment1".to_owned();
    assert!(told(simulate(&wrong)).contains("\"segment1\" a second time"));
    let mut wrong = trunk.clone();
    wrong.add(Joint::revolute(X * 0.0).between(GROUND, wrong_body(&trunk)));
    assert!(told(simulate(&wrong)).contains("axis"));

    for goal in [State::Free, State::Periodic, State::Markers(Vec::new())] {
        let none = Simulation::over(ms(20.0)).start(goal.clone()).run(&trunk);
        assert!(told(none).contains("are goals"));
        let none = Control::over(ms(20.0), 4).start(goal).effort(1.0);
        let refused = none.solve(&trunk).unwrap_err().to_string();
        assert!(refused.contains("are goals"), "{refused}");
    }

    let backwards = Control::over(s(0.4), 20).electrical_energy(&muscles, -1.0);
    let refused = backwards.solve(&trunk).unwrap_err().to_string();
    assert!(
        refused.contains("a positive weight of a lumped muscle"),
        "{refused}"
    );
    let none = Simulation::over(ms(20.0)).step(ms(-1.0)).run(&trunk);
    assert!(told(none).contains("steps of -1 ms"));
    let signal = Signal::ramp(0.0, f64::INFINITY, 1.0);
    let none = Simulation::over(ms(20.0))
        .voltage(muscles[0], signal)
        .run(&trunk);
    assert!(told(none).contains("finite numbers"));
    let (other, ..) = elephant();
    let lone = System::new("nothing");
    let none = Simulation::over(ms(20.0))
        .voltage(muscles[0], 1.0)
        .run(&lone);
    assert!(told(none).contains("a muscle or a driven electrode"));
    let none = Control::over(ms(20.0), 0).effort(1.0).solve(&other);
    assert!(none.unwrap_err().to_string().contains("no interval"));
    let step = |start: f64| Signal::Ramp {
        from: 0.0,
        to: 1000.0,
        start,
        duration: 0.0,
    };
    let free = |signal: Signal| {
        let free = Control::over_free(ms(10.0)..=ms(30.0), 1).voltage(muscles[0], signal);
        free.solve(&other).unwrap_err().to_string()
    };
    let refused = free(step(15.0));
    assert!(refused.contains("jumps at 15 ms"), "{refused}");
    // One at the start, or behind the end, is none.
    for start in [0.0, 30.0] {
        assert!(free(step(start)).contains("weights"));
    }
    let none = Control::over(ms(20.0), 4).solve(&other);
    assert!(none.unwrap_err().to_string().contains("weights"));
}

/// A body of a trunk.
fn wrong_body(trunk: &System) -> Handle<Body> {
    let mut copy = trunk.clone();
    copy.bodies.pop();
    copy.add(trunk.bodies[5].clone())
}
