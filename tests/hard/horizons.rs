//! Horizons: one interval, two thousand, and a final time against its bounds.

use crate::page::{Case, Verdict};
use crate::program::{largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::json;

#[test]
fn one_interval_leads_nowhere() {
    let mut seen = Vec::new();
    for (segments, goal) in [
        (1, bent()),
        (
            6,
            json!({ "rest_at_voltages": { "muscle2": "1.7 kV", "muscle3": "1.6 kV" } }),
        ),
    ] {
        // p₀ = 0 and p₁ = 0 add up to M (q₁ − q₀)/h = 0: rest to rest in one interval leads nowhere.
        let found = run(
            &trunk(segments, silicone_with(json!({ "viscosity": null }))),
            &control("0.2 s", 1, goal),
        );
        assert_eq!((found.exit, found.status()), (1, "infeasible"));
        assert!(
            found
                .err
                .contains("motion at instant 0, coordinate of joint"),
            "{}",
            found.err
        );
        seen.push(format!(
            "{segments} segments: {}",
            found.err.trim().replace('\n', "; ")
        ));
    }
    let scene = trunk(1, silicone());
    // Two equations for two voltages: whatever holds it is called a feasible point, not an optimum.
    let hold = |intervals: usize| {
        let task = control("0.2 s", intervals, json!({ "rest_at_voltages": {} }));
        run(&scene, &task).solved()
    };
    let (once, twice) = (hold(1), hold(2));
    assert_eq!(
        (once.status(), twice.status()),
        ("feasible_point", "solved")
    );
    assert!(largest(&once.column("joint1")) < 1e-12 && twice.number(&["objective"]) < 1e-6);
    for (stay, intervals) in [(&once, "one interval"), (&twice, "two")] {
        seen.push(format!(
            "to stay, {intervals}: {}, objective {:.1e} kV² s",
            stay.status().replace('_', " "),
            stay.number(&["objective"])
        ));
    }
    let mut curves = Vec::new();
    for (i, intervals) in [2, 3, 5].into_iter().enumerate() {
        let found = run(&scene, &control("0.2 s", intervals, bent())).solved();
        let angle = found.column("joint1");
        assert!((angle.last().unwrap() - 0.1554).abs() < 0.02, "{angle:?}");
        // Where so few do not resolve the motion, more are taken.
        let taken = found.number(&["intervals"]);
        let name = format!("{taken} intervals, {intervals} asked for");
        curves.push(
            Series::curve(name, points(&found.column("time"), &angle), hue(i)).marked(Mark::Disc),
        );
        seen.push(format!(
            "{taken} intervals, {intervals} asked for: objective {:.6} kV² s",
            found.number(&["objective"])
        ));
    }
    Case {
        name: "one-interval",
        title: "Horizons of one interval and a few",
        law: "From rest to rest in one interval the momenta of both ends add up to no motion at all: another goal is infeasible, with the \
              rows named. To stay leaves as many equations as voltages and is told to be a feasible point, no optimum. From two \
              intervals on the pair arrives, and to stay costs nothing; where finer steps under the same voltages lead elsewhere, more \
              intervals are taken.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint1 [rad]", Extent::Padded),
        curves,
    }
    .record();
}

#[test]
fn two_thousand_intervals() {
    let scene = trunk(1, silicone());
    let at = |intervals: usize| {
        let mut task = control("0.2 s", intervals, bent());
        task["control"]["objective"] = json!({ "rate": 1.0 });
        run(&scene, &task).solved()
    };
    let (coarse, fine) = (at(50), at(2000));
    let counts = [125, 250, 500, 1000];
    let mut objectives: Vec<f64> = counts
        .iter()
        .map(|&n| at(n).number(&["objective"]))
        .collect();
    objectives.push(fine.number(&["objective"]));
    let steps: Vec<f64> = objectives.windows(2).map(|w| (w[0] - w[1]).abs()).collect();
    println!("{objectives:?} {steps:?}");
    // Convergence: each doubling changes the objective by less than the one before, and the last hardly.
    assert!(
        objectives[4] > 1.0 && steps[3] < 1e-3 * objectives[4],
        "{objectives:?}"
    );
    assert!(steps.windows(2).all(|w| w[1] < 0.7 * w[0]), "{steps:?}");
    let angle = fine.column("joint1");
    assert_eq!(angle.len(), 2001);
    assert!(largest(&angle) > 0.15);
    let voltage = |run: &crate::program::Run| {
        let times = run.voltages("start");
        points(&times, &run.voltages("muscle2"))
    };
    let seen = counts.iter().chain(&[2000]).zip(&objectives);
    Case {
        name: "two-thousand-intervals",
        title: "A horizon of 2000 intervals",
        law: "The smoothest voltages converge as intervals double from 125 to 2000: each change of the objective is less than 0.7 of the one before, \
              the last less than a thousandth of it.",
        verdict: Verdict::Answer,
        seen: seen.map(|(n, f)| format!("{n} intervals: objective {f:.8} kV²/s")).collect(),
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("optimal voltage of muscle2 [V]", Extent::FromZero),
        curves: vec![
            Series::curve("2000 intervals", voltage(&fine), hue(0)),
            Series::curve("50 intervals", voltage(&coarse), hue(1)).marked(Mark::Ring).unjoined(),
        ],
    }
    .record();
}

#[test]
fn a_final_time_against_its_bounds() {
    let scene = trunk(1, silicone());
    let within = |min: f64, max: f64, guess: f64| {
        let mut task = control("0.2 s", 20, bent());
        task["control"]["duration"] = json!({ "min": min, "max": max, "guess": guess });
        task["control"]["objective"] = json!({ "duration": 1.0 });
        run(&scene, &task)
    };
    let free = within(0.002, 0.6, 0.2).solved();
    let least = free.number(&["duration"]);
    assert!(least > 0.003 && least < 0.1);
    let mut seen = vec![format!("free: {least:.9} s")];
    for (min, max, guess, expected) in [
        (0.1, 0.6, 0.3, 0.1),
        (0.002, 1.0001 * least, least, least),
        (least, 0.6, 0.2, least),
        (0.1, 0.1, 0.1, 0.1),
    ] {
        let found = within(min, max, guess).solved();
        let duration = found.number(&["duration"]);
        assert!(
            (duration / expected - 1.0).abs() < 1e-7,
            "{min} to {max}: {duration}"
        );
        seen.push(format!(
            "between {min:.6} s and {max:.6} s: {duration:.9} s"
        ));
    }
    let short = within(0.002, 0.99 * least, 0.9 * least);
    assert_eq!((short.exit, short.status()), (1, "infeasible"));
    assert!(short.err.contains("joint1: violated by"), "{}", short.err);
    seen.push(format!(
        "between 0.002 s and {:.6} s: {}",
        0.99 * least,
        short.err.trim().replace('\n', "; ")
    ));
    let starts = free.voltages("start");
    let curve = |name: &str, colour| {
        Series::curve(name, points(&starts, &free.voltages(name)), hue(colour)).marked(Mark::Disc)
    };
    Case {
        name: "free-time-bounds",
        title: "A free final time against its bounds",
        law: "The least time is found; where a bound lies above it, the bound is, to 1e-7; where it lies just about at it, both agree; \
              where the upper bound is 1 % below it, the problem is infeasible and the rows are named.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("voltage of least time [V]", Extent::FromZero),
        curves: vec![curve("muscle1", 0), curve("muscle2", 1)],
    }
    .record();
}
