//! Muscles: voltages from zero, pull-in, large stretches, no length.

use crate::page::{Case, Verdict};
use crate::program::{difference, largest, points, run};
use crate::scenes::*;
use nalgebra::Vector2;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

/// 4^(−1/3), and the nominal field there in units of √(μ/ε): the limit of Λ − Λ⁴ (docs/theory.md, 12.3).
const AT_PULL_IN: [f64; 2] = [0.629960524947, 0.687364818499];

/// The silicone as an ideal dielectric without mass, with entries changed.
fn ideal(changes: Value) -> Value {
    let mut material =
        silicone_with(json!({ "dielectric": "ideal", "density": null, "viscosity": null }));
    let entries = material.as_object_mut().unwrap();
    entries.extend(changes.as_object().unwrap().clone());
    material
}

/// Voltage in V that makes the nominal field √(μ/ε) in layers of 50 µm.
fn field_unit() -> f64 {
    50e-6 * (SHEAR / (3.0 * VACUUM)).sqrt()
}

/// Volume times the derivative of the elastic energy with the stretch, N mm.
fn pull(stretch: f64) -> f64 {
    VOLUME * SHEAR * 1e-6 * (stretch - stretch.powi(-2))
}

pub(crate) fn time(label: &str) -> Axis {
    Axis::linear(label, Extent::Tight)
}

#[test]
fn voltages_start_at_zero() {
    let scene = trunk(1, silicone());
    let problem = control("0.2 s", 20, bent());
    let usual = run(&scene, &problem).solved();
    let mut from_zero = problem.clone();
    from_zero["control"]["guess"] = json!({ "simulate": { "voltages": {} } });
    let found = run(&scene, &from_zero).solved();
    let [a, b] = [&usual, &found].map(|run| run.number(&["objective"]));
    assert!(a > 0.04 && (a / b - 1.0).abs() < 1e-7, "{a} and {b}");
    let [u, v] = [&usual, &found].map(|run| run.column("joint1"));
    assert!(largest(&u) > 0.1 && difference(&u, &v) < 1e-6);
    let t: Vec<f64> = (0..20).map(|k| 10.0 * f64::from(k) + 5.0).collect();
    let curve = |name: &str, muscle, colour| {
        Series::curve(name, points(&t, &found.voltages(muscle)), hue(colour)).marked(Mark::Disc)
    };
    Case {
        name: "voltage-from-zero",
        title: "Voltages start at zero",
        law: "Forces go with V²: where all voltages are zero the motion does not depend on them to first order. From a guess \
              without any voltage or motion the solver finds the optimum that it finds from the usual guess.",
        verdict: Verdict::Answer,
        seen: vec![
            format!("objective {a:.9} kV² s from the usual guess, {b:.9} kV² s from zero"),
            format!("iterations {} and {}", usual.number(&["iterations"]), found.number(&["iterations"])),
        ],
        x: time("time [ms]"),
        y: Axis::linear("optimal voltage [V]", Extent::FromZero),
        curves: vec![curve("muscle1", "muscle1", 0), curve("muscle2", "muscle2", 1)],
    }
    .record();
}

#[test]
fn a_lumped_muscle_at_rest_near_pull_in_and_beyond() {
    let [stretch, critical] = AT_PULL_IN;
    let scene = slider(ideal(json!({})));
    let at = |field: f64| {
        run(
            &scene,
            &equilibrium(json!({ "muscle": field * field_unit() })),
        )
    };
    let stretch_of = |end: f64| 1e3 * end / LENGTH;
    let mut seen = Vec::new();
    let mut found = Vec::new();
    for field in [
        0.1,
        0.2,
        0.3,
        0.4,
        0.5,
        0.6,
        0.65,
        0.68,
        0.687,
        critical * (1.0 - 1e-6),
    ] {
        let rest = at(field).solved();
        assert_eq!(rest.summary["is_stable"], true);
        let ratio = stretch_of(rest.summary["markers"]["end"][2].as_f64().unwrap());
        // Λ − Λ⁴ = Ē² on the branch above the limit.
        let expected = bisection(|s| s - s.powi(4) - field * field, stretch, 1.0);
        assert!(
            (ratio - expected).abs() < 1e-7,
            "{field}: {ratio} against {expected}"
        );
        found.push([field, ratio]);
    }
    for beyond in [1.001, 1.1, 2.0, 100.0] {
        let lost = at(beyond * critical);
        assert_eq!((lost.exit, lost.status()), (1, "pull_in"));
        let words = lost.refusal();
        assert!(words.contains("pull-in at"), "{words}");
        let fraction = lost.number(&["fraction"]) * beyond;
        assert!((fraction - 1.0).abs() < 1e-7, "{fraction}");
        seen.push(format!("at {beyond} times the critical voltage: {words}"));
    }
    let curve: Vec<[f64; 2]> = (0..=80)
        .map(|k| 0.35 + 0.65 * f64::from(k) / 80.0)
        .map(|s: f64| [(s - s.powi(4)).sqrt(), s])
        .collect();
    Case {
        name: "pull-in-lumped",
        title: "A lumped muscle near pull-in and beyond, at rest",
        law: "Equilibria of an ideal dielectric lie on Λ − Λ⁴ = εE²/μ up to Λ = 0.630 at 0.687 √(μ/ε). Up to a millionth below it \
              the stretch agrees to 1e-7; beyond it the run is refused as pull-in, with the critical voltage to 1e-7.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("nominal field E √(ε/μ)", Extent::FromZero),
        y: Axis::linear("stretch Λ", Extent::Padded),
        curves: vec![
            Series::curve("closed form", curve, hue(0)),
            Series::curve("found at rest", found, hue(1)).marked(Mark::Disc).unjoined(),
            Series::curve("pull-in", vec![[critical, stretch]], hue(2)).marked(Mark::Ring).unjoined(),
        ],
    }
    .record();
}

#[test]
fn a_lumped_muscle_moves_into_pull_in() {
    let critical = AT_PULL_IN[1];
    let scene = slider(ideal(json!({ "viscosity": "1000 Pa s" })));
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, ratio) in [0.9, 1.05, 1.2, 2.0].into_iter().enumerate() {
        let field = ratio * critical;
        let task = simulate("0.2 s", "0.2 ms", json!({ "muscle": field * field_unit() }));
        let motion = run(&scene, &task);
        let found = motion.column("muscle_stretch");
        let times = motion.column("time");
        // m L₀² Λ̈ = −V₀ [μ(Λ − Λ⁻²) + μ Ē² Λ⁻³ + 3/2 η Λ̇ Λ⁻²], by Runge and Kutta until it is flat.
        let rate = |y: &Vector2<f64>| {
            let (s, v) = (y.x, y.y);
            let electric = VOLUME * SHEAR * 1e-6 * field * field * s.powi(-3);
            let viscous = 1.5 * VOLUME * v / (s * s);
            Vector2::new(
                v,
                -(pull(s) + electric + viscous) / (WEIGHT * LENGTH * LENGTH),
            )
        };
        let (mut y, mut t, dt) = (Vector2::new(1.0, 0.0), 0.0, 1e-3);
        let mut expected = vec![1.0];
        while expected.len() < 1001 && y.x > 0.02 {
            y = crate::common::runge_kutta(&rate, &y, dt);
            t += dt;
            if (t / 0.2).round() as usize == expected.len()
                && (t / 0.2).fract().min(1.0 - (t / 0.2).fract()) < 1e-6
            {
                expected.push(y.x);
            }
        }
        for (a, b) in found.iter().zip(&expected) {
            assert!(*b < 0.3 || (a - b).abs() < 1e-3, "{ratio}: {a} against {b}");
        }
        if ratio < 1.0 {
            assert_eq!(motion.exit, 0);
            assert!(found.last().unwrap() > &0.7);
            seen.push(format!(
                "{ratio} of the critical voltage: stays at Λ = {:.6}",
                found.last().unwrap()
            ));
        } else {
            assert_eq!((motion.exit, motion.status()), (1, "step_failed"));
            let words = motion.refusal();
            let why = ["muscle \"muscle\"", "energy balance"];
            assert!(why.iter().any(|why| words.contains(why)), "{words}");
            assert!(words.contains("pull-in"), "{words}");
            let end = *times.last().unwrap();
            assert!((end / t - 1.0).abs() < 0.02, "{end} against {t}");
            seen.push(format!("{ratio} of the critical voltage: {words}; Runge and Kutta's collapse is at {t:.1} ms"));
        }
        let name = format!("{ratio} of the critical voltage");
        curves.push(Series::curve(name, points(&times, &found), hue(i)));
        let exact: Vec<f64> = (0..expected.len()).map(|k| 0.2 * k as f64).collect();
        let name = if i == 0 { "Runge–Kutta" } else { "" };
        curves.push(Series::curve(name, points(&exact, &expected), hue(4)).dashed(Dash::Dashed));
    }
    Case {
        name: "pull-in-lumped-motion",
        title: "A lumped muscle near pull-in and beyond, in motion",
        law: "Under a voltage step the stretch follows the equation of motion, integrated independently by Runge and Kutta, to 1e-3. \
              Beyond pull-in it collapses at the time that they find, to 2 %, where the run is refused and names the muscle.",
        verdict: Verdict::Both,
        seen,
        x: time("time [ms]"),
        y: Axis::linear("stretch Λ", Extent::FromZero),
        curves,
    }
    .record();
}

/// The silicone without charge, mass and viscosity.
pub(crate) fn rubber() -> Value {
    silicone_with(json!({ "relative_permittivity": null, "density": null, "viscosity": null }))
}

#[test]
fn a_muscle_bears_stretches_from_a_third_to_three_at_rest() {
    let mut found = Vec::new();
    let mut worst: f64 = 0.0;
    for wanted in [0.3, 0.5, 0.8, 1.2, 2.0, 3.0] {
        // The load in N that the closed form asks for.
        let load = pull(wanted) / LENGTH;
        let mut scene = slider(rubber());
        // m/s² of a weight in g.
        scene["gravity"] = json!([0, 0, 1e3 * load / WEIGHT]);
        let rest = run(&scene, &equilibrium(json!({}))).solved();
        let end = rest.summary["markers"]["end"][2].as_f64().unwrap();
        let expected = bisection(|s| pull(s) / LENGTH - load, 0.05, 20.0);
        assert!((expected - wanted).abs() < 1e-12);
        let error = (1e3 * end / LENGTH - expected).abs();
        assert!(error < 1e-9, "{wanted}: {error:e}");
        worst = worst.max(error);
        found.push([load, 1e3 * end / LENGTH]);
    }
    let curve = (0..=100).map(|k| 0.28 + 2.8 * f64::from(k) / 100.0);
    let curve = curve.map(|s| [pull(s) / LENGTH, s]).collect();
    Case {
        name: "stretch-static",
        title: "A muscle compressed to 0.3 and stretched to 3, at rest",
        law: "Under a weight the muscle rests where V₀ μ (Λ − Λ⁻²)/L₀ equals the load, found by halving, to 1e-9.",
        verdict: Verdict::Answer,
        seen: vec![format!("largest error of the stretch {worst:.1e}")],
        x: Axis::linear("load [N]", Extent::Padded),
        y: Axis::linear("stretch Λ", Extent::Padded),
        curves: vec![
            Series::curve("closed form", curve, hue(0)),
            Series::curve("found at rest", found, hue(1)).marked(Mark::Disc).unjoined(),
        ],
    }
    .record();
}

#[test]
fn a_muscle_swings_between_stretches_of_equal_energy() {
    let energy = |s: f64| 2.0 / s + s * s;
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, start) in [3.0, 0.3].into_iter().enumerate() {
        let other = match start > 1.0 {
            true => bisection(|s| energy(s) - energy(start), 0.01, 1.0),
            false => bisection(|s| energy(s) - energy(start), 1.0, 10.0),
        };
        let angles = json!({ "slide": format!("{} mm", LENGTH * (start - 1.0)) });
        let task = simulate_from("0.2 s", "0.1 ms", angles, json!({}));
        let motion = run(&slider(rubber()), &task).solved();
        assert_eq!(motion.number(&["halved_steps"]), 0.0);
        let found = motion.column("muscle_stretch");
        let [low, high] = [start.min(other), start.max(other)];
        let least = found.iter().copied().fold(f64::INFINITY, f64::min);
        let most = largest(&found);
        assert!(
            (least - low).abs() < 1e-3 && (most - high).abs() < 3e-3,
            "{least} {low} {most} {high}"
        );
        let total = motion.column("total_energy");
        let spread = largest(&total.iter().map(|e| e / total[0] - 1.0).collect::<Vec<_>>());
        assert!(total[0] > 10.0 && spread < 1e-2, "{spread:e}");
        seen.push(format!(
            "released at {start}: turns at {:.5}, closed form {other:.5}; energy within {spread:.1e}",
            if start > 1.0 { least } else { most }
        ));
        let name = format!("released at {start}");
        curves.push(Series::curve(
            name,
            points(&motion.column("time"), &found),
            hue(i),
        ));
        let level = vec![[0.0, other], [200.0, other]];
        curves.push(
            Series::curve(format!("turning point {other:.3}"), level, hue(i)).dashed(Dash::Dashed),
        );
        // With viscosity it comes to rest at its length.
        let viscous = silicone_with(json!({ "relative_permittivity": null, "density": null }));
        let angles = json!({ "slide": format!("{} mm", LENGTH * (start - 1.0)) });
        let task = simulate_from("1 s", "1 ms", angles, json!({}));
        let rest = run(&slider(viscous), &task).solved();
        let last = *rest.column("muscle_stretch").last().unwrap();
        assert!((last - 1.0).abs() < 1e-5, "{last}");
    }
    Case {
        name: "stretch-dynamic",
        title: "A muscle released at 0.3 and at 3",
        law: "Without viscosity it swings between the two stretches of equal energy 2/Λ + Λ², found by halving, at 0.1 ms to 3e-3; \
              with viscosity it comes to rest at Λ = 1.",
        verdict: Verdict::Answer,
        seen,
        x: time("time [ms]"),
        y: Axis::linear("stretch Λ", Extent::FromZero),
        curves,
    }
    .record();
}
