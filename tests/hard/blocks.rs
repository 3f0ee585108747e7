//! Elastic blocks: pull-in, and materials that hardly change their volume.

use crate::page::{Case, Verdict};
use crate::program::{Run, difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::{Value, json};

/// λ, Λ and E √(ε/μ) at pull-in of a free cube of ν = 0.4 (docs/theory.md, 12.3).
const AT_PULL_IN: (&str, f64, f64) = ("400 kPa", 0.63473428, 0.68759172);

fn ideal(lame_lambda: &str) -> Value {
    silicone_with(json!({
        "dielectric": "ideal", "lame_lambda": lame_lambda, "density": null, "viscosity": null,
    }))
}

/// Voltage in V that makes the nominal field √(μ/ε) over 10 mm.
fn field_unit() -> f64 {
    10e-3 * (SHEAR / (3.0 * VACUUM)).sqrt()
}

/// Stretch along the field and across of a free cube, by halving twice: across from the tension across, along from that along.
///
/// Ω = μ/2 (2a² + b² − 3) − μ ln J + λ/2 ln²J − μ Ē² a²/(2b) with J = a² b, in units of μ; λ/μ = `ratio`.
fn free_cube(ratio: f64, field: f64) -> [f64; 2] {
    let pressure = |a: f64, b: f64| ratio * (a * a * b).ln();
    let across = |b: f64| {
        let tension = |a: f64| a - 1.0 / a + pressure(a, b) / a - 0.5 * field * field * a / b;
        bisection(tension, 0.5, 2.0)
    };
    let along = |b: f64| {
        let a = across(b);
        b - 1.0 / b + pressure(a, b) / b + 0.5 * field * field * a * a / (b * b)
    };
    let b = bisection(along, 0.66, 1.0 + 1e-12);
    [across(b), b]
}

fn corner(rest: &Run, axis: usize) -> f64 {
    100.0 * rest.summary["markers"]["corner"][axis].as_f64().unwrap()
}

#[test]
fn a_cube_at_rest_near_pull_in_and_beyond() {
    let (lame_lambda, stretch, critical) = AT_PULL_IN;
    let scene = cube(ideal(lame_lambda), "hex8", 2);
    let at = |field: f64| {
        run(
            &scene,
            &equilibrium(json!({ "cube.top": field * field_unit() })),
        )
    };
    let near = at(critical * (1.0 - 1e-6)).solved();
    assert_eq!(near.summary["is_stable"], true);
    assert!((corner(&near, 2) - stretch).abs() < 2e-3);
    let mut seen = Vec::new();
    for beyond in [1.001, 1.5, 100.0] {
        let lost = at(beyond * critical);
        assert_eq!((lost.exit, lost.status()), (1, "pull_in"));
        let fraction = lost.number(&["fraction"]) * beyond;
        assert!((fraction - 1.0).abs() < 1e-7, "{fraction}");
        assert!((corner(&lost, 2) - stretch).abs() < 1e-5);
        seen.push(format!(
            "at {beyond} times the critical voltage: {}",
            lost.refusal()
        ));
    }
    let mut task = equilibrium(json!({ "cube.top": field_unit() }));
    task["equilibrium"]["path"] = json!(45);
    let path = run(&scene, &task).solved();
    let fields = path.path("fraction");
    let heights: Vec<f64> = path.path("corner_z").iter().map(|z| z / 10.0).collect();
    let largest_field = largest(&fields);
    // The limit point itself is among them.
    assert!((largest_field / critical - 1.0).abs() < 1e-7);
    assert!(
        heights.last().unwrap() < &0.5,
        "the path goes on past the limit"
    );
    Case {
        name: "pull-in-elements",
        title: "A cube of finite elements near pull-in and beyond, at rest",
        law: "A free cube of ν = 0.4 rests up to 0.68759172 √(μ/ε) with Λ = 0.63473428 there. Up to a millionth below it rests stably; \
              beyond it the run is refused as pull-in, with the critical voltage to 1e-7; by arc length the path goes on past it.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("nominal field E √(ε/μ)", Extent::FromZero),
        y: Axis::linear("stretch Λ", Extent::Padded),
        curves: vec![
            Series::curve("path by arc length", points(&fields, &heights), hue(0)).marked(Mark::Disc),
            Series::curve("pull-in", vec![[critical, stretch]], hue(2)).marked(Mark::Ring).unjoined(),
        ],
    }
    .record();
}

#[test]
fn a_cube_moves_into_pull_in() {
    let critical = AT_PULL_IN.2;
    let material = silicone_with(json!({ "dielectric": "ideal", "viscosity": "100 Pa s" }));
    let scene = cube(material, "hex8_q1p0", 1);
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, ratio) in [0.7, 1.2, 3.0, 30.0].into_iter().enumerate() {
        let voltages = json!({ "cube.top": ratio * critical * field_unit() });
        let motion = run(&scene, &simulate("10 ms", "0.1 ms", voltages));
        let height = motion.column("corner_z");
        if ratio < 1.0 {
            assert_eq!(motion.exit, 0);
            let rest = 10.0 * free_cube(4.0, ratio * critical)[1];
            let last = *height.last().unwrap();
            assert!((last - rest).abs() < 2e-2, "{last} against {rest}");
            seen.push(format!(
                "{ratio} of the critical voltage: {last:.4} mm after 10 ms, at rest {rest:.4} mm"
            ));
        } else {
            assert_eq!((motion.exit, motion.status()), (1, "step_failed"));
            let words = motion.refusal();
            let why = ["an element is inverted", "energy balance"];
            assert!(why.iter().any(|why| words.contains(why)), "{words}");
            assert!(words.contains("even with a step of"), "{words}");
            seen.push(format!("{ratio} of the critical voltage: {words}"));
        }
        if height.len() > 1 {
            let name = format!("{ratio} of the critical voltage");
            curves.push(Series::curve(
                name,
                points(&motion.column("time"), &height),
                hue(i),
            ));
        }
    }
    Case {
        name: "pull-in-elements-motion",
        title: "A cube of finite elements near pull-in and beyond, in motion",
        law: "Below the critical voltage the cube comes to the height of rest, found by halving. Beyond it the cube is crushed, and the \
              run is refused with the time and the smallest step; the motion until then is kept.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("height [mm]", Extent::FromZero),
        curves,
    }
    .record();
}

#[test]
fn a_nearly_incompressible_cube_contracts_as_the_closed_form_says() {
    let (mut found, mut curve) = (Vec::new(), Vec::new());
    let mut worst: f64 = 0.0;
    for element in ["hex8", "hex8_q1p0"] {
        let scene = cube(ideal("1 GPa"), element, 2);
        for field in [0.2, 0.4, 0.5, 0.6, 0.68] {
            let rest = run(
                &scene,
                &equilibrium(json!({ "cube.top": field * field_unit() })),
            )
            .solved();
            let [across, along] = free_cube(1e4, field);
            let error = (corner(&rest, 2) - along)
                .abs()
                .max((corner(&rest, 0) - across).abs());
            assert!(
                1.0 - along > 0.01 && error < 1e-7,
                "{element} {field}: {error:e}"
            );
            worst = worst.max(error);
            let volume = across * across * along;
            assert!((volume - 1.0).abs() < 1e-3);
            found.push([field, corner(&rest, 2)]);
            curve.push([field, along]);
        }
    }
    // In motion the volume stays, and no step is halved.
    let moving = silicone_with(
        json!({ "dielectric": "ideal", "lame_lambda": "1 GPa", "viscosity": "100 Pa s" }),
    );
    let task = simulate("10 ms", "0.2 ms", json!({ "cube.top": 0.5 * field_unit() }));
    let motion = run(&cube(moving, "hex8_q1p0", 1), &task).solved();
    assert_eq!(motion.number(&["halved_steps"]), 0.0);
    let [x, y, z] = ["corner_x", "corner_y", "corner_z"].map(|name| motion.column(name));
    let volume: Vec<f64> = (0..x.len()).map(|k| x[k] * y[k] * z[k] / 1e3).collect();
    let change = difference(&volume, &vec![1.0; volume.len()]);
    assert!((z.last().unwrap() / 10.0 - free_cube(1e4, 0.5)[1]).abs() < 2e-3);
    assert!(change < 1e-2, "{change:e}");
    curve.truncate(5);
    Case {
        name: "nearly-incompressible",
        title: "A cube whose λ is 10 000 μ",
        law: "Both elements contract under a field as the closed form for this λ, solved by halving, says, to 1e-7; in motion the volume \
              stays to 1 % and no step is halved.",
        verdict: Verdict::Answer,
        seen: vec![
            format!("largest error of a stretch at rest {worst:.1e}"),
            format!("largest change of volume in motion {change:.1e}"),
        ],
        x: Axis::linear("nominal field E √(ε/μ)", Extent::FromZero),
        y: Axis::linear("stretch Λ", Extent::Padded),
        curves: vec![
            Series::curve("closed form", curve, hue(0)),
            Series::curve("found at rest", found, hue(1)).marked(Mark::Ring).unjoined(),
        ],
    }
    .record();
}

#[test]
fn a_nearly_incompressible_beam_bends_like_a_compressible_one() {
    let deflection = |element: &str, ratio: f64| {
        let lame_lambda = ratio * SHEAR;
        let scene = json!({
            "name": "beam",
            "materials": { "silicone": { "density": "1000 kg/m^3", "shear_modulus": SHEAR, "lame_lambda": lame_lambda } },
            "gravity": [0, 0, "-5 m/s^2"],
            "solids": [{
                "name": "beam", "material": "silicone", "element": element,
                "box": { "size": ["20 mm", "4 mm", "4 mm"], "elements": [20, 4, 4] }, "fixed": ["x_min"],
            }],
            "markers": [{ "name": "tip", "solid": "beam", "at": ["20 mm", "2 mm", "2 mm"] }],
        });
        let rest = run(&scene, &equilibrium(json!({}))).solved();
        2.0 - 1e3 * rest.summary["markers"]["tip"][2].as_f64().unwrap()
    };
    // E = μ (3λ + 2μ)/(λ + μ).
    let modulus = |ratio: f64| SHEAR * 1e-6 * (3.0 * ratio + 2.0) / (ratio + 1.0);
    // q L⁴/(8 E I), and a shear of q L²/(2 · 5/6 μ A).
    let slender = |ratio: f64| {
        let q = 1e-3 * 16.0 * 5e-3;
        let inertia = 4_f64.powi(4) / 12.0;
        q * 20_f64.powi(4) / (8.0 * modulus(ratio) * inertia)
            + q * 400.0 / (2.0 * 5.0 / 6.0 * SHEAR * 1e-6 * 16.0)
    };
    let ratios = [10.0, 1e2, 1e3, 1e4];
    let curve = |element: &str| -> Vec<[f64; 2]> {
        ratios
            .iter()
            .map(|&r| [r, deflection(element, r)])
            .collect()
    };
    let [q1p0, hex8] = ["hex8_q1p0", "hex8"].map(curve);
    for [ratio, found] in &q1p0 {
        let expected = slender(*ratio);
        assert!(
            expected > 0.05 && (found / expected - 1.0).abs() < 0.1,
            "{ratio}: {found} against {expected}"
        );
    }
    let stays = (q1p0[3][1] * modulus(1e4)) / (q1p0[1][1] * modulus(1e2)) - 1.0;
    assert!(stays.abs() < 0.03, "{stays}");
    // Without it the element locks: this is what the case guards against.
    assert!(hex8[3][1] < 0.5 * q1p0[3][1], "{hex8:?}");
    Case {
        name: "nearly-incompressible-bending",
        title: "A beam under its weight as λ grows to 10 000 μ",
        law: "With hex8_q1p0 the deflection of a cantilever follows q L⁴/(8 E I) with shear to 10 %, and from λ = 100 μ to 10 000 μ \
              deflection times modulus stays to 3 %. The plain hex8 locks, as README says.",
        verdict: Verdict::Answer,
        seen: vec![
            format!("deflection {:.4} mm at λ = 10 μ, {:.4} mm at λ = 10 000 μ with hex8_q1p0", q1p0[0][1], q1p0[3][1]),
            format!("{:.4} mm and {:.4} mm with hex8", hex8[0][1], hex8[3][1]),
        ],
        x: Axis::log("λ/μ"),
        y: Axis::linear("deflection of the tip [mm]", Extent::FromZero),
        curves: vec![
            Series::curve("hex8_q1p0", q1p0, hue(0)).marked(Mark::Disc),
            Series::curve("hex8", hex8, hue(1)).marked(Mark::Disc),
            Series::curve("slender beam", ratios.iter().map(|&r| [r, slender(r)]).collect(), hue(2)),
        ],
    }
    .record();
}
