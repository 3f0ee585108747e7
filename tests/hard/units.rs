//! Units and sizes: a thousandth and a thousand times as large is the same problem.

use crate::page::{Case, Verdict};
use crate::program::{difference, largest, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::{Value, json};

/// Three segments with all lengths and times `s` times as large at the same moduli, densities and fields.
///
/// Masses then go with s³, voltages and viscosity with s, gravity with 1/s.
fn similar(s: f64) -> Value {
    let mut scene = trunk(3, silicone_with(json!({ "viscosity": 1000.0 * s })));
    scene["gravity"] = json!([0, -9.81 / s, 0]);
    let chain = &mut scene["chain"];
    chain["length"] = json!(0.05 * s);
    chain["radius"] = json!(0.02 * s);
    chain["mass"] = json!(0.03 * s.powi(3));
    let muscles = &mut chain["muscles"];
    muscles["arm"] = json!(0.015 * s);
    muscles["rest_length"] = json!(0.04 * s);
    muscles["cross_section"] = json!([0.01 * s, 0.01 * s]);
    muscles["layer_thickness"] = json!(50e-6 * s);
    scene
}

#[test]
fn systems_a_thousand_times_as_small_and_as_large_are_similar() {
    let sizes = [1.0, 1e-3, 1e3];
    let joints = |run: &crate::program::Run| -> Vec<f64> {
        (1..=3)
            .flat_map(|j| run.column(&format!("joint{j}")))
            .collect()
    };
    let motions = sizes.map(|s| {
        let voltages = json!({ "muscle2": 1700.0 * s, "muscle3": 1000.0 * s });
        let mut task = simulate("", "", voltages);
        task["simulate"]["duration"] = json!(s);
        task["simulate"]["step"] = json!(5e-3 * s);
        run(&similar(s), &task).solved()
    });
    let plans = sizes.map(|s| {
        let goal = json!({ "rest_at_voltages": { "muscle2": 1700.0 * s, "muscle3": 1600.0 * s } });
        let mut task = control("", 20, goal);
        task["control"]["duration"] = json!(0.2 * s);
        task["control"]["voltage_bounds"] = json!([0, 3000.0 * s]);
        run(&similar(s), &task).solved()
    });
    let rests = sizes.map(|s| {
        let rest = run(&similar(s), &equilibrium(json!({ "muscle2": 1700.0 * s }))).solved();
        rest.summary["joints"]["joint1"].as_f64().unwrap()
    });
    let mut seen = Vec::new();
    let (moved, planned) = (joints(&motions[0]), joints(&plans[0]));
    let objective = plans[0].number(&["objective"]);
    assert!(largest(&moved) > 0.1 && largest(&planned) > 0.1 && rests[0] > 0.1 && objective > 0.01);
    for k in 1..3 {
        let s = sizes[k];
        let errors = [
            difference(&joints(&motions[k]), &moved),
            (rests[k] - rests[0]).abs(),
            difference(&joints(&plans[k]), &planned),
            // kV² s.
            (plans[k].number(&["objective"]) / s.powi(3) / objective - 1.0).abs(),
        ];
        assert!(errors.iter().all(|&e| e < 1e-8), "{s}: {errors:?}");
        assert_eq!(plans[k].status(), "solved");
        seen.push(format!(
            "{s} times the size: angles differ by {:.1e} rad in motion, {:.1e} rad at rest, {:.1e} rad in the optimum, objective by {:.1e} of it, after {} iterations",
            errors[0], errors[1], errors[2], errors[3], plans[k].number(&["iterations"])
        ));
    }
    let curve = |k: usize| {
        let times = plans[k].column("time");
        let list = times
            .iter()
            .zip(plans[k].column("joint1"))
            .map(|(t, angle)| [t / sizes[k], angle]);
        let curve = Series::curve(
            format!("{} times the size", sizes[k]),
            list.collect(),
            hue(k),
        );
        if k == 0 {
            curve
        } else {
            curve.marked([Mark::Ring, Mark::Disc][k - 1]).unjoined()
        }
    };
    Case {
        name: "similar-systems",
        title: "The same trunk of 0.15 mm, 150 mm and 150 m",
        law: "At the same moduli and densities lengths, times and voltages may be stretched alike: angles and the objective in its units stay, to \
              1e-8, in motion, at rest and in the optimum.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time over size [ms]", Extent::Tight),
        y: Axis::linear("optimal joint1 [rad]", Extent::Padded),
        curves: vec![curve(0), curve(2), curve(1)],
    }
    .record();
}

#[test]
fn other_words_for_the_same_quantities_are_the_same_problem() {
    let scene =
        |length: (&str, f64), mass: (&str, f64), stress: (&str, f64), viscosity: (&str, f64)| {
            // Numbers are written in mm, g, kPa, Pa s times what makes them the unit asked for.
            let text = |value: f64, (unit, factor): (&str, f64)| {
                json!(format!("{} {unit}", value * factor))
            };
            let mut scene = trunk(3, silicone());
            let material = &mut scene["materials"]["silicone"];
            material["shear_modulus"] = text(100.0, stress);
            material["lame_lambda"] = text(400.0, stress);
            material["viscosity"] = text(1000.0, viscosity);
            let chain = &mut scene["chain"];
            chain["length"] = text(50.0, length);
            chain["radius"] = text(20.0, length);
            chain["mass"] = text(30.0, mass);
            let muscles = &mut chain["muscles"];
            muscles["arm"] = text(15.0, length);
            muscles["rest_length"] = text(40.0, length);
            muscles["cross_section"] = json!([text(10.0, length), text(10.0, length)]);
            muscles["layer_thickness"] = text(0.05, length);
            scene
        };
    let scenes = [
        scene(("mm", 1.0), ("g", 1.0), ("kPa", 1.0), ("Pa s", 1.0)),
        scene(("m", 1e-3), ("kg", 1e-3), ("Pa", 1e3), ("kPa s", 1e-3)),
        scene(("km", 1e-6), ("t", 1e-6), ("MPa", 1e-3), ("MPa ms", 1e-3)),
        scene(("um", 1e3), ("mg", 1e3), ("N/mm^2", 1e-3), ("GPa us", 1e-3)),
    ];
    let times = [
        ["1 s", "5 ms"],
        ["1000 ms", "0.005 s"],
        ["1e6 us", "5000 us"],
        ["0.001 ks", "5e6 ns"],
    ];
    let volts = [
        json!("1.7 kV"),
        json!(1700),
        json!("0.0017 MV"),
        json!("1.7e6 mV"),
    ];
    let motions: Vec<_> = scenes
        .iter()
        .zip(&times)
        .zip(&volts)
        .map(|((scene, [duration, step]), volts)| {
            run(
                scene,
                &simulate(duration, step, json!({ "muscle2": volts })),
            )
            .solved()
        })
        .collect();
    let plans: Vec<_> = scenes
        .iter()
        .zip(&volts)
        .map(|(scene, volts)| {
            run(
                scene,
                &control(
                    "0.2 s",
                    20,
                    json!({ "rest_at_voltages": { "muscle2": volts } }),
                ),
            )
            .solved()
        })
        .collect();
    let (mut seen, mut curves) = (Vec::new(), Vec::new());
    let names = ["mm, g, kPa", "m, kg, Pa", "km, t, MPa", "µm, mg, N/mm²"];
    for k in 0..4 {
        let difference = |runs: &[crate::program::Run]| {
            let lists = [0, k].map(|k| runs[k].column("joint1"));
            assert!(largest(&lists[0]) > 0.1);
            difference(&lists[0], &lists[1])
        };
        let errors = [difference(&motions), difference(&plans)];
        assert!(
            errors.iter().all(|&e| e < 1e-10),
            "{}: {errors:?}",
            names[k]
        );
        seen.push(format!(
            "{}: {:.1e} rad in motion, {:.1e} rad in the optimum",
            names[k], errors[0], errors[1]
        ));
        let list: Vec<[f64; 2]> = motions[k]
            .column("time")
            .into_iter()
            .zip(motions[k].column("joint1"))
            .map(|(t, a)| [t, a])
            .collect();
        let curve = Series::curve(
            names[k],
            list.into_iter()
                .skip(5 * k)
                .step_by(if k == 0 { 1 } else { 20 })
                .collect(),
            hue(k),
        );
        curves.push(if k == 0 {
            curve
        } else {
            curve.marked(Mark::Ring).unjoined()
        });
    }
    Case {
        name: "other-units",
        title: "The same trunk written in other units",
        law: "From kilometres and tonnes to micrometres and milligrams a file means the same: angles agree to 1e-10 rad in motion and in the \
              optimum.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint1 [rad]", Extent::Padded),
        curves,
    }
    .record();
}
