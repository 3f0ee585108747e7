//! Masses, stiffnesses and viscosities that differ by six orders and more.

use crate::common::{richardson, runge_kutta};
use crate::page::{Case, Verdict};
use crate::program::{difference, largest, points, run};
use crate::scenes::*;
use nalgebra::{Matrix2, SVector, Vector2};
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

/// Rods of 100 mm with a radius of 5 mm on hinges about z, from rest along x.
fn double_pendulum(masses: [f64; 2]) -> Value {
    let body = |i: usize| {
        json!({
            "name": format!("rod{}", i + 1), "mass": masses[i], "position": [0.05 + 0.1 * i as f64, 0, 0],
            "cylinder": { "length": 0.1, "radius": 0.005, "axis": [1, 0, 0] },
        })
    };
    let joint = |name: &str, parent: &str, child: &str, x: f64| json!({ "name": name, "revolute": { "axis": [0, 0, 1] }, "parent": parent, "child": child, "at": [x, 0, 0] });
    json!({
        "name": "double pendulum", "gravity": [0, -9.81, 0], "bodies": [body(0), body(1)],
        "joints": [joint("upper", "ground", "rod1", 0.0), joint("lower", "rod1", "rod2", 0.1)],
    })
}

/// Its angles from the horizontal (upper, lower − upper) at `time` in s, by Runge and Kutta in absolute angles.
fn swing(masses: [f64; 2], time: f64) -> [f64; 2] {
    let (l, c, g) = (0.1, 0.05, 9.81);
    let central = |m: f64| m * (3.0 * 0.005_f64.powi(2) + l * l) / 12.0;
    let [m1, m2] = masses;
    let rate = |y: &SVector<f64, 4>| {
        let (a, b, va, vb) = (y[0], y[1], y[2], y[3]);
        let mixed = m2 * l * c;
        let mass = Matrix2::new(
            central(m1) + m1 * c * c + m2 * l * l,
            mixed * (a - b).cos(),
            mixed * (a - b).cos(),
            central(m2) + m2 * c * c,
        );
        let force = Vector2::new(
            -mixed * (a - b).sin() * vb * vb - (m1 * c + m2 * l) * g * a.cos(),
            mixed * (a - b).sin() * va * va - m2 * c * g * b.cos(),
        );
        let v = mass.try_inverse().unwrap() * force;
        SVector::<f64, 4>::new(va, vb, v.x, v.y)
    };
    let steps = 20_000;
    let mut y = SVector::<f64, 4>::zeros();
    for _ in 0..steps {
        y = runge_kutta(&rate, &y, time / f64::from(steps));
    }
    [y[0], y[1] - y[0]]
}

#[test]
fn a_million_times_the_mass_on_either_side_of_a_joint() {
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, masses) in [[1.0, 1e-6], [1e-6, 1.0]].into_iter().enumerate() {
        let expected = swing(masses, 0.2);
        assert!(expected[0].abs() > 0.5 && expected[1].abs() > 1e-3);
        let scene = double_pendulum(masses);
        for coordinates in ["reduced", "redundant"] {
            let motions = ["2 ms", "1 ms", "0.5 ms"].map(|step| {
                let mut task = simulate("0.2 s", step, json!({}));
                task["simulate"]["coordinates"] = json!(coordinates);
                run(&scene, &task).solved()
            });
            for (joint, expected) in ["upper", "lower"].into_iter().zip(expected) {
                let ends = motions
                    .each_ref()
                    .map(|motion| *motion.column(joint).last().unwrap());
                let order = ((ends[0] - expected) / (ends[1] - expected)).abs().log2();
                let error = (richardson(&ends) - expected).abs();
                assert!(
                    (order - 2.0).abs() < 0.2 && error < 1e-6,
                    "{joint} of {masses:?}: {ends:?}, {order}, {error:e}"
                );
                seen.push(format!(
                    "{} kg on {} kg, {coordinates}: {joint} ends at {expected:.6} rad, limit of the steps {error:.1e} beside",
                    masses[1], masses[0]
                ));
            }
            let fine = &motions[2];
            assert_eq!(fine.number(&["halved_steps"]), 0.0);
            assert!(largest(&fine.column("constraint_violation")) < 1e-11);
            if coordinates == "reduced" {
                let name = format!("{} kg on {} kg", masses[1], masses[0]);
                let upper = points(&fine.column("time"), &fine.column("upper"));
                let lower = points(&fine.column("time"), &fine.column("lower"));
                curves.push(Series::curve(format!("upper, {name}"), upper, hue(i)));
                curves.push(
                    Series::curve(format!("lower, {name}"), lower, hue(i)).dashed(Dash::Dashed),
                );
            }
        }
    }
    Case {
        name: "mass-ratio",
        title: "A double pendulum of 1 kg and 1 mg, either way round",
        law: "In both kinds of coordinates the motion converges with the second order of the step to that of the equations of the double \
              pendulum, integrated by Runge and Kutta; the limit of three steps agrees to 1e-6 rad.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint angle [rad]", Extent::Padded),
        curves,
    }
    .record();
}

/// Two weights of 10 g on two muscles in a row along z.
fn series(moduli: [f64; 2]) -> Value {
    let material = |modulus: f64| json!({ "density": "1000 kg/m^3", "shear_modulus": modulus });
    let weight = |name: &str, z: &str| json!({ "name": name, "mass": "10 g", "position": [0, 0, z], "sphere": { "radius": "2 mm" } });
    let slide = |name: &str, child: &str, z: &str| json!({ "name": name, "prismatic": { "axis": [0, 0, 1] }, "parent": "ground", "child": child, "at": [0, 0, z] });
    let muscle = |name: &str, material: &str, from: (&str, &str), to: (&str, &str)| {
        json!({
            "name": name, "material": material, "cross_section": ["4 mm", "5 mm"], "layer_thickness": "50 um",
            "from": { "body": from.0, "at": [0, 0, from.1] }, "to": { "body": to.0, "at": [0, 0, to.1] },
        })
    };
    json!({
        "name": "series", "gravity": [0, 0, 5],
        "materials": { "first": material(moduli[0]), "second": material(moduli[1]) },
        "bodies": [weight("near", "30 mm"), weight("far", "60 mm")],
        "joints": [slide("near_slide", "near", "30 mm"), slide("far_slide", "far", "60 mm")],
        "muscles": [
            muscle("first", "first", ("ground", "0 mm"), ("near", "30 mm")),
            muscle("second", "second", ("near", "30 mm"), ("far", "60 mm")),
        ],
    })
}

#[test]
fn a_million_times_the_stiffness_in_a_row() {
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    // g in mm/ms²; muscles of 0.6 g, half of it at each end.
    let (g, own) = (5e-3, 0.6);
    let loads = [20.0 + 1.5 * own, 10.0 + 0.5 * own].map(|mass| mass * g);
    for (i, moduli) in [[1e11, 1e5], [1e5, 1e11]].into_iter().enumerate() {
        let scene = series(moduli);
        let rest = run(&scene, &equilibrium(json!({}))).solved();
        let slide = |name: &str| 1e3 * rest.summary["joints"][name].as_f64().unwrap();
        let stretched = [
            slide("near_slide"),
            slide("far_slide") - slide("near_slide"),
        ];
        for m in 0..2 {
            let force = |x: f64| {
                let s = 1.0 + x / LENGTH;
                VOLUME * moduli[m] * 1e-6 * (s - s.powi(-2)) / LENGTH - loads[m]
            };
            let expected = bisection(force, 0.0, LENGTH);
            // The difference of two places of 30 mm has 1e-14 of them.
            let error = (stretched[m] - expected).abs();
            assert!(
                error < 1e-6 * expected + 1e-13 * LENGTH,
                "{m}: {} against {expected}",
                stretched[m]
            );
        }
        seen.push(format!(
            "{:.0e} Pa on {:.0e} Pa: stretched by {:.4e} mm and {:.4e} mm",
            moduli[1], moduli[0], stretched[0], stretched[1]
        ));

        // In motion the stiff muscle is rigid: one mass on the soft one.
        let motion = run(&scene, &simulate("0.1 s", "0.1 ms", json!({}))).solved();
        assert_eq!(motion.number(&["halved_steps"]), 0.0);
        let found = motion.column("far_slide");
        let (mass, load) = match i {
            0 => (10.0 + own / 3.0, loads[1]),
            _ => (20.0 + own + own / 3.0, loads[0]),
        };
        let rate = |y: &Vector2<f64>| {
            let s = 1.0 + y.x / LENGTH;
            let pull = VOLUME * 0.1 * (s - s.powi(-2)) / LENGTH;
            Vector2::new(y.y, (load - pull) / mass)
        };
        let mut y = Vector2::zeros();
        let mut expected = vec![0.0];
        for _ in 0..1000 {
            for _ in 0..4 {
                y = runge_kutta(&rate, &y, 0.025);
            }
            expected.push(y.x);
        }
        let error = difference(&found, &expected) / largest(&expected);
        assert!(largest(&expected) > 0.4 && error < 2e-3, "{error:e}");
        let total = motion.column("total_energy");
        let spread = difference(&total, &vec![total[0]; total.len()]);
        let kinetic = largest(&motion.column("kinetic_energy"));
        assert!(spread < 1e-2 * kinetic, "{spread:e} of {kinetic:e}");
        seen.push(format!(
            "in motion {error:.1e} beside a rigid one; energy within {:.1e} of the kinetic",
            spread / kinetic
        ));
        let name = if i == 0 {
            "stiff, then soft"
        } else {
            "soft, then stiff"
        };
        curves.push(Series::curve(
            name,
            points(&motion.column("time"), &found),
            hue(i),
        ));
        let name = if i == 0 { "stiff one rigid" } else { "" };
        curves.push(
            Series::curve(name, points(&motion.column("time"), &expected), hue(2))
                .dashed(Dash::Dashed),
        );
    }
    Case {
        name: "stiffness-ratio",
        title: "Two muscles in a row, one a million times as stiff",
        law: "At rest each carries its load, found by halving, to 1e-6. In motion, with steps many periods of the stiff muscle long, the weights move as if it \
              were rigid (Runge and Kutta), to 2e-3, and the energy stays.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("displacement of the far weight [mm]", Extent::FromZero),
        curves,
    }
    .record();
}

#[test]
fn viscosities_from_none_to_huge() {
    let material = |viscosity: Value| {
        silicone_with(
            json!({ "relative_permittivity": null, "density": null, "viscosity": viscosity }),
        )
    };
    let task = simulate_from("0.1 s", "1 ms", json!({ "slide": "3 mm" }), json!({}));
    let stretch = |viscosity: Value| {
        let motion = run(&slider(material(viscosity)), &task).solved();
        assert_eq!(motion.number(&["halved_steps"]), 0.0);
        motion.column("muscle_stretch")
    };
    // Written as zero it is not there.
    let none = stretch(Value::Null);
    assert!(none.iter().any(|s| *s < 0.95));
    assert_eq!(none, stretch(json!("0 Pa s")));
    assert!(difference(&none, &stretch(json!("1e-9 Pa s"))) < 1e-9);
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    let times: Vec<f64> = (0..=100).map(f64::from).collect();
    let moved = |s: &[f64]| -> Vec<f64> { s[1..].iter().map(|s| (s - s_start()).abs()).collect() };
    curves.push(Series::curve(
        "none",
        points(&times[1..], &moved(&none)),
        hue(0),
    ));
    for (i, viscosity) in [1e6, 1e9, 1e12].into_iter().enumerate() {
        let found = stretch(json!(viscosity));
        // Inertia is nothing beside it: 3/2 η Λ̇ Λ⁻² = −μ (Λ − Λ⁻²), η in MPa ms.
        let rate = |y: &SVector<f64, 1>| {
            let s = y[0];
            SVector::<f64, 1>::new(-0.1 * (s - s.powi(-2)) * s * s / (1.5 * viscosity * 1e-3))
        };
        let mut y = SVector::<f64, 1>::new(s_start());
        for _ in 0..100 {
            y = runge_kutta(&rate, &y, 1.0);
        }
        let crept = s_start() - found.last().unwrap();
        let expected = s_start() - y[0];
        assert!(
            expected > 0.0 && (crept / expected - 1.0).abs() < 1e-3,
            "{viscosity:e}: {crept:e} against {expected:e}"
        );
        seen.push(format!("η = {viscosity:.0e} Pa s: creeps by {crept:.6e} in 0.1 s, first-order law {expected:.6e}"));
        let name = format!("{viscosity:.0e} Pa s");
        curves.push(
            Series::curve(name, points(&times[1..], &moved(&found)), hue(i + 1)).marked(Mark::None),
        );
    }
    Case {
        name: "viscosity-none-to-huge",
        title: "A stretched muscle let go, without viscosity and with far too much",
        law: "A viscosity of zero leaves the same bits as none. Where it is huge the muscle creeps as the first-order law of viscosity against \
              elasticity says (Runge and Kutta), to 1e-3 of the way, be the way a thousand-millionth of its length.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::log("change of stretch"),
        curves,
    }
    .record();
}

/// The stretch from which the muscle is let go.
fn s_start() -> f64 {
    1.1
}
