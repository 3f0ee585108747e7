//! Rest: what stands until it is too heavy, and pull-in of badly shaped elements.

use crate::common::random::Random;
use crate::page::{Case, Verdict};
use crate::program::{largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::{Value, json};
use std::fmt::Write;

/// Shear modulus of the link's muscles in MPa, their rest length, arm and volume in mm, and half of the link in mm.
const LINK: [f64; 5] = [0.1, 40.0, 15.0, 4000.0, 25.0];

/// One link of 50 mm upright on a hinge, between two muscles without density.
fn link(mass: f64) -> Value {
    let mut scene = trunk(
        1,
        silicone_with(json!({ "density": null, "viscosity": null })),
    );
    scene["chain"]["mass"] = json!(format!("{mass} g"));
    scene["gravity"] = json!([0, -9.81, 0]);
    scene
}

/// Potential energy in N mm of the link at an angle: the muscles run from (±a, y) on the ground to (±a, y + L) on the link,
/// written for the hinge as origin.
fn energy(mass: f64, low: f64, angle: f64) -> f64 {
    let [shear, length, arm, volume, half] = LINK;
    let (sin, cos) = angle.sin_cos();
    let muscle = |side: f64| {
        let (x, y) = (side * arm, low + length);
        let (dx, dy) = (cos * x - sin * y - x, sin * x + cos * y - low);
        let stretch = dx.hypot(dy) / length;
        volume * 0.5 * shear * (2.0 / stretch + stretch * stretch - 3.0)
    };
    muscle(1.0) + muscle(-1.0) + mass * 9.81e-3 * half * cos
}

/// The angle of least energy up to a right angle, on a grid refined twice.
fn leaning(mass: f64, low: f64) -> f64 {
    let (mut from, mut step, mut best) = (0.0, 1e-3, 0.0);
    for _ in 0..3 {
        let at = |k: i32| from + step * f64::from(k);
        let of = |k: i32| energy(mass, low, at(k));
        let least = (0..1571).min_by(|&i, &j| of(i).total_cmp(&of(j)));
        best = at(least.unwrap());
        from = f64::max(best - 2.0 * step, 0.0);
        step *= 4.0 / 1571.0;
    }
    best
}

#[test]
fn a_link_collapses_under_its_weight() {
    // The lower ends of the muscles, from the expanded scene: the hinge is the origin.
    let low = -20.0;
    // m g ℓ/2 sin θ against k θ: the weight at which the upright link is no minimum any more.
    let curvature = |mass: f64| {
        let d = 1e-3;
        (energy(mass, low, d) - 2.0 * energy(mass, low, 0.0) + energy(mass, low, -d)) / (d * d)
    };
    let critical = 100.0 * curvature(0.0) / (curvature(0.0) - curvature(100.0));
    let mut seen = Vec::new();
    let mut found = Vec::new();
    for ratio in [0.5, 0.9, 0.999, 1.001, 1.05, 1.2, 1.5, 2.0] {
        let mass = ratio * critical;
        let rest = run(&link(mass), &equilibrium(json!({}))).solved();
        assert_eq!(rest.summary["is_stable"], true, "{ratio}");
        let angle = rest.number(&["joints", "joint1"]).abs();
        let expected = if ratio < 1.0 { 0.0 } else { leaning(mass, low) };
        assert!(
            (angle - expected).abs() < 2e-3,
            "{ratio}: {angle} {expected}"
        );
        let route = rest.summary["route"].as_str().unwrap();
        assert_eq!(route == "growing_loads", ratio < 1.0, "{ratio}: {route}");
        found.push([ratio, angle.to_degrees()]);
        seen.push(format!(
            "{ratio} of the critical weight: {:.2}°, softest {:.2} N mm/rad, {}",
            angle.to_degrees(),
            1e3 * rest.summary["stiffness"][0].as_f64().unwrap(),
            route.replace('_', " ")
        ));
    }
    assert!(largest(&found.iter().map(|p| p[1]).collect::<Vec<_>>()) > 20.0);
    let ratios: Vec<f64> = (0..=120).map(|k| 0.4 + 0.0135 * f64::from(k)).collect();
    let angles: Vec<f64> = ratios
        .iter()
        .map(|&ratio| match ratio < 1.0 {
            true => 0.0,
            false => leaning(ratio * critical, low).to_degrees(),
        })
        .collect();
    // The trunk of six does the same.
    let mut tall = trunk(6, silicone());
    tall["gravity"] = json!([0, -9.81, 0]);
    let rest = run(&tall, &equilibrium(json!({}))).solved();
    assert_eq!(rest.summary["is_stable"], true);
    let tip = rest.summary["markers"]["tip"][1].as_f64().unwrap();
    assert!(tip < 0.25, "{tip}");
    seen.push(format!(
        "the trunk of six under its weight: tip at a height of {:.1} mm of 300",
        1e3 * tip
    ));
    Case {
        name: "collapse-under-weight",
        title: "Collapse under weight",
        law: "A link between two muscles stands upright until its weight takes all of their stiffness. Beyond, the path of growing weight \
              stays upright and is unstable; the equilibrium found is the leaning one, where the energy written out by hand is \
              least, to 2 mrad. The upright trunk of six rests bent.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("weight over the critical one", Extent::Tight),
        y: Axis::linear("angle [°]", Extent::FromZero),
        curves: vec![
            Series::curve("least energy", points(&ratios, &angles), hue(0)),
            Series::curve("equilibrium found", found, hue(1)).marked(Mark::Disc).unjoined(),
            Series::curve("upright, unstable", vec![[1.0, 0.0], [2.0, 0.0]], hue(2))
                .dashed(proboscis::report::style::Dash::Dashed),
        ],
    }
    .record();
}

/// A cube of 10 mm of 3 × 3 × 3 hexahedra in the Gmsh format 2.2; nodes inside are moved by up to `part` of an element, nodes on
/// a face within it.
fn distorted(part: f64) -> String {
    let mut random = Random(5);
    let node = |i: usize, j: usize, k: usize| 1 + i + 4 * j + 16 * k;
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n2 1 \"x_min\"\n2 2 \"y_min\"\n2 3 \"z_min\"\n2 4 \"z_max\"\n\
                    3 5 \"all\"\n$EndPhysicalNames\n$Nodes\n64\n"
        .to_owned();
    for k in 0..4 {
        for j in 0..4 {
            for i in 0..4 {
                let at = [i, j, k].map(|c| {
                    let moved = if c == 0 || c == 3 {
                        0.0
                    } else {
                        part * random.unit()
                    };
                    10.0 / 3.0 * (c as f64 + moved)
                });
                writeln!(
                    text,
                    "{} {:?} {:?} {:?}",
                    node(i, j, k),
                    at[0],
                    at[1],
                    at[2]
                )
                .unwrap();
            }
        }
    }
    let mut elements = Vec::new();
    for a in 0..3 {
        for b in 0..3 {
            let square = [(a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)];
            let mut face = |group: usize, at: &dyn Fn(usize, usize) -> usize| {
                let nodes = square.map(|(a, b)| at(a, b).to_string());
                elements.push(format!("3 2 {group} {group} {}", nodes.join(" ")));
            };
            face(1, &|a, b| node(0, a, b));
            face(2, &|a, b| node(a, 0, b));
            face(3, &|a, b| node(a, b, 0));
            face(4, &|a, b| node(a, b, 3));
        }
    }
    for k in 0..3 {
        for j in 0..3 {
            for i in 0..3 {
                let layer = |k: usize| {
                    [
                        node(i, j, k),
                        node(i + 1, j, k),
                        node(i + 1, j + 1, k),
                        node(i, j + 1, k),
                    ]
                };
                let nodes: Vec<String> = layer(k)
                    .iter()
                    .chain(&layer(k + 1))
                    .map(usize::to_string)
                    .collect();
                elements.push(format!("5 2 5 5 {}", nodes.join(" ")));
            }
        }
    }
    writeln!(text, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
    for (e, element) in elements.iter().enumerate() {
        writeln!(text, "{} {element}", e + 1).unwrap();
    }
    text + "$EndElements\n"
}

#[test]
fn a_cube_of_distorted_elements_pulls_in() {
    // λ, Λ and E √(ε/μ) at pull-in of a free cube of ν = 0.4 (docs/theory.md, 12.3).
    let (lame_lambda, stretch, critical) = ("400 kPa", 0.63473428, 0.68759172);
    let unit = 10e-3 * (SHEAR / (3.0 * VACUUM)).sqrt();
    let material = silicone_with(json!({
        "dielectric": "ideal", "lame_lambda": lame_lambda, "density": null, "viscosity": null,
    }));
    let folder = tempfile::tempdir().unwrap();
    let (mut seen, mut curves) = (Vec::new(), Vec::new());
    for (i, part) in [0.0, 0.3].into_iter().enumerate() {
        let mesh = folder.path().join(format!("cube{i}.msh"));
        std::fs::write(&mesh, distorted(part)).unwrap();
        let scene = json!({
            "name": "cube", "materials": { "silicone": material },
            "solids": [{
                "name": "cube", "mesh": mesh.to_str().unwrap(), "unit": "1 mm", "material": "silicone", "element": "hex8",
                "electrodes": [
                    { "name": "bottom", "face": "z_min", "potential": "grounded" },
                    { "name": "top", "face": "z_max", "potential": "driven" },
                ],
                "fixed": [
                    { "face": "x_min", "directions": ["x"] }, { "face": "y_min", "directions": ["y"] },
                    { "face": "z_min", "directions": ["z"] },
                ],
            }],
            "markers": [{ "name": "corner", "solid": "cube", "at": ["10 mm", "10 mm", "10 mm"] }],
        });
        let at = |field: f64| run(&scene, &equilibrium(json!({ "cube.top": field * unit })));
        let near = at(critical * (1.0 - 1e-6)).solved();
        assert_eq!(near.summary["is_stable"], true);
        let height = 100.0 * near.summary["markers"]["corner"][2].as_f64().unwrap();
        assert!((height - stretch).abs() < 2e-3, "{height}");
        let lost = at(1.02 * critical);
        assert_eq!((lost.exit, lost.status()), (1, "pull_in"));
        let fraction = 1.02 * lost.number(&["fraction"]);
        assert!((fraction - 1.0).abs() < 1e-7, "{part}: {fraction}");
        seen.push(format!(
            "nodes moved by up to {:.0} % of an element: {}",
            100.0 * part,
            lost.refusal()
        ));
        let mut task = equilibrium(json!({ "cube.top": unit }));
        task["equilibrium"]["path"] = json!(25);
        let path = run(&scene, &task).solved();
        let heights: Vec<f64> = path.path("corner_z").iter().map(|z| z / 10.0).collect();
        let fields = path.path("fraction");
        assert!((largest(&fields) / critical - 1.0).abs() < 1e-7);
        let name = format!("moved by {:.0} %", 100.0 * part);
        let mark = [Mark::Disc, Mark::Ring, Mark::None][i];
        curves.push(Series::curve(name, points(&fields, &heights), hue(i)).marked(mark));
    }
    curves.push(
        Series::curve("pull-in", vec![[critical, stretch]], hue(4))
            .marked(Mark::Ring)
            .unjoined(),
    );
    Case {
        name: "pull-in-distorted",
        title: "Distorted hexahedra near pull-in",
        law: "A free cube deforms homogeneously whatever its elements look like. With nodes moved by up to 30 % of an element it rests stably up \
              to a millionth below pull-in, and is refused beyond with the critical voltage to 1e-7, as with bricks.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("nominal field E √(ε/μ)", Extent::FromZero),
        y: Axis::linear("stretch Λ", Extent::Padded),
        curves,
    }
    .record();
}
