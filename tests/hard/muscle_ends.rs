//! Muscles whose ends meet, or would.

use crate::muscles::{rubber, time};
use crate::page::{Case, Verdict};
use crate::program::{largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::json;

#[test]
fn a_mass_thrown_at_a_muscle_never_comes_out_behind_it() {
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, (speed, step, duration)) in [
        (1.0, "0.1 ms", "20 ms"),
        (10.0, "0.1 ms", "20 ms"),
        (30.0, "1 us", "3 ms"),
        (100.0, "1 ms", "20 ms"),
        (1000.0, "0.1 ms", "20 ms"),
    ]
    .into_iter()
    .enumerate()
    {
        let rates = json!({ "slide": format!("{} m/s", -speed) });
        let task = simulate_from(duration, step, json!({}), rates);
        let motion = run(&slider(rubber()), &task);
        let end = motion.column("end_z");
        assert!(end.iter().all(|&z| z > 0.0), "{speed}: behind the ground");
        if motion.exit == 0 {
            // ½ m v² = V₀ μ/2 (2/Λ + Λ² − 3): where it turns.
            let excess = |s: f64| {
                VOLUME * 0.5 * SHEAR * 1e-6 * (2.0 / s + s * s - 3.0) - 0.5 * WEIGHT * speed * speed
            };
            let turn = LENGTH * bisection(excess, 1e-6, 1.0);
            let least = end.iter().copied().fold(f64::INFINITY, f64::min);
            // The instants need not hit the turning point itself.
            assert!(least > 0.98 * turn, "{least} against {turn}");
            assert!(
                speed > 50.0 || least < 1.02 * turn,
                "{least} against {turn}"
            );
            let total = motion.column("total_energy");
            let kept = total[total.len() - 1] / total[0];
            let told = motion.err.contains("of numerical energy");
            assert!(speed > 50.0 || (kept - 1.0).abs() < 0.02, "{speed}: {kept}");
            assert!(told || (kept - 1.0).abs() < 0.02, "{speed}: {kept}");
            seen.push(format!(
                "{speed} m/s, steps of {step}: turns {least:.4} mm before the ground, closed form {turn:.4} mm"
            ));
        } else {
            assert_eq!(motion.status(), "step_failed");
            assert!(speed > 50.0 && motion.number(&["halved_steps"]) >= 10.0);
            let words = motion.refusal();
            let why = [
                "muscle \"muscle\" by more than a right angle",
                "energy balance",
            ];
            assert!(why.iter().any(|why| words.contains(why)), "{words}");
            seen.push(format!("{speed} m/s, steps of {step}: {words}"));
        }
        if end.len() > 1 {
            let name = format!("{speed} m/s");
            curves.push(Series::curve(
                name,
                points(&motion.column("time"), &end),
                hue(i),
            ));
        }
    }
    assert!(seen.iter().any(|line| line.contains("closed form")));
    assert!(seen.iter().any(|line| line.contains("even with a step")));
    Case {
        name: "singular-length",
        title: "A mass thrown at a muscle along its axis",
        law: "The energy of a muscle grows without bound as its ends meet, so the mass turns back before. Where the step resolves that, \
              it turns at the place of equal energy to 2 % and keeps its energy; where it does not, steps are halved and then refused, and the mass is \
              never behind the ground.",
        verdict: Verdict::Both,
        seen,
        x: time("time [ms]"),
        y: Axis::log("length of the muscle [mm]"),
        curves,
    }
    .record();
}

#[test]
fn ends_that_meet_are_no_state() {
    let scene = slider(silicone());
    let meet = json!({ "slide": "-30 mm" });
    let start = run(
        &scene,
        &simulate_from("0.1 s", "1 ms", meet.clone(), json!({})),
    );
    assert_eq!(start.exit, 2);
    let goal = run(
        &scene,
        &control("0.2 s", 20, json!({ "joint_angles": meet })),
    );
    assert_eq!(goal.exit, 2);
    let mut seen = Vec::new();
    for (refused, place) in [(&start, "simulate.start"), (&goal, "control.goal")] {
        let words = refused.refusal();
        let expected = format!("{place}: the ends of muscle \"muscle\" meet there");
        assert!(words.contains(&expected), "{words}");
        seen.push(words);
    }
    // A tenth of a millimetre beside it there is a motion.
    let task = simulate_from(
        "20 ms",
        "0.01 ms",
        json!({ "slide": "-29.9 mm" }),
        json!({}),
    );
    let beside = run(&scene, &task).solved();
    let length = beside.column("end_z");
    assert!(length[0] < 0.11 && largest(&length) > 3.0);
    Case {
        name: "singular-length-start",
        title: "A start and a goal where the ends of a muscle meet",
        law: "There a muscle has no energy: a simulation that starts there and an optimal control that ends there are wrong input, and \
              the muscle is named. A tenth of a millimetre beside it the muscle pushes its weight away.",
        verdict: Verdict::Both,
        seen,
        x: time("time [ms]"),
        y: Axis::log("length of the muscle [mm]"),
        curves: vec![Series::curve(
            "from 0.1 mm",
            points(&beside.column("time"), &length),
            hue(0),
        )],
    }
    .record();
}

#[test]
fn no_optimum_leads_through_a_muscle_of_no_length() {
    let soft = silicone_with(json!({ "shear_modulus": "1 kPa" }));
    let scene = slider(soft);
    let goal = json!({ "joint_angles": { "slide": "-60 mm" } });
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, intervals) in [3, 5, 7, 20].into_iter().enumerate() {
        let found = run(&scene, &control("0.2 s", intervals, goal.clone()));
        assert_eq!(found.exit, 1, "{intervals}: {}", found.summary);
        seen.push(format!("{intervals} intervals: {}", found.refusal()));
        let z = found.column("end_z");
        let name = format!(
            "{intervals} intervals, {}",
            found.status().replace('_', " ")
        );
        curves.push(
            Series::curve(name, points(&found.column("time"), &z), hue(i)).marked(Mark::Disc),
        );
    }
    Case {
        name: "singular-length-control",
        title: "A goal on the other side of a muscle",
        law: "The way there leads through a length of zero, where the energy is infinite: no run may call it solved, also where \
              the equations at the middles of long intervals have a solution that jumps.",
        verdict: Verdict::Refusal,
        seen,
        x: time("time [ms]"),
        y: Axis::linear("end of the muscle [mm]", Extent::Padded),
        curves,
    }
    .record();
}
