//! The page of a run: its data are those of the run, its code is small and asks for nothing.

use std::collections::{BTreeMap, HashSet};
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use proboscis::dynamics::trajectory::{Column, Observations, Trajectory};
use proboscis::model::System;
use proboscis::model::system::{ElectricConstants, VACUUM_PERMITTIVITY};
use proboscis::report::lines::LinePlot;
use proboscis::report::origin::Origin;
use proboscis::report::skins::Skins;
use proboscis::report::{PageContent, Run, page};
use serde_json::Value;

use crate::report::swing;

/// The data that a page draws.
pub(crate) fn page_data(html: &str) -> Value {
    let from = html
        .split("<script type=\"application/json\" id=\"data\">")
        .nth(1);
    let text = from.expect("a page has data").split("</script>").next();
    serde_json::from_str(text.unwrap()).unwrap()
}

/// Numbers of single precision in base64.
fn unpacked(text: &Value) -> Vec<f64> {
    let bytes = STANDARD.decode(text.as_str().unwrap()).unwrap();
    let number = |four: &[u8]| f64::from(f32::from_le_bytes(four.try_into().unwrap()));
    bytes.chunks_exact(4).map(number).collect()
}

#[test]
fn a_page_has_the_motion_and_the_curves_of_its_run() {
    let (mut system, trajectory) = swing();
    system.muscles[5].material.electric = Some(ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: VACUUM_PERMITTIVITY,
    });
    let run = Run {
        goal: Some(&trajectory.poses[20]),
        targets: &[(0, Vector3::new(1.0, -2.0, 3.5))],
        ..run(&system, &trajectory)
    };
    let data = page_data(&html(&run));
    assert_scene(&data["scenes"][0], &run);
    assert_charts(&data["charts"], &run);
}

fn run<'a>(system: &'a System, trajectory: &'a Trajectory) -> Run<'a> {
    static PARTS: LazyLock<(Skins, Observations, Origin, PageContent)> =
        LazyLock::new(Default::default);
    let (skins, observations, origin, content) = &*PARTS;
    Run {
        page: Some(content),
        ..Run::from_trajectory(system, trajectory, skins, observations, origin)
    }
}

/// The page of a run alone.
fn html(run: &Run<'_>) -> String {
    page::html(&run.system.name, &[*run], run.page.unwrap(), run.origin)
}

/// Returns true if a number of single precision is the one of double precision.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * b.abs().max(1.0)
}

/// Parts of the page stand where bodies and muscles are.
fn assert_scene(scene: &Value, run: &Run<'_>) {
    let (system, trajectory) = (run.system, run.trajectory);
    let times = unpacked(&scene["times"]);
    assert_eq!(times.len(), trajectory.times.len());
    assert!(close(times[20], trajectory.times[20] / 1e3) && times[20] > 0.0);
    let parts = scene["parts"].as_array().unwrap();
    assert_eq!(parts.len(), system.bodies.len() + system.muscles.len());
    let at =
        |part: usize, k: usize| unpacked(&parts[part]["motion"])[12 * k..12 * (k + 1)].to_vec();
    for (b, pose) in trajectory.poses[20].iter().enumerate() {
        let columns = pose.directors.iter().chain(pose.centre.iter());
        assert!(at(b, 20).iter().zip(columns).all(|(a, b)| close(*a, *b)));
        assert!(
            unpacked(&scene["goal"])[12 * b..]
                .iter()
                .zip(at(b, 20))
                .all(|(a, b)| close(*a, b))
        );
    }
    assert_ne!(at(5, 0), at(5, 20));
    let (muscle, part) = (&system.muscles[5], &parts[system.bodies.len() + 5]);
    let ends = [&muscle.from, &muscle.to].map(|end| trajectory.point(20, end, system));
    let length = (ends[1] - ends[0]).norm();
    let rest = (muscle.to.at - muscle.from.at).norm();
    let column = &at(system.bodies.len() + 5, 20)[6..9];
    assert!(close(2.0 * Vector3::from_row_slice(column).norm(), length));
    let voltage = trajectory.voltages[19][5].abs() / 1e3;
    let quantity = |name: &str| unpacked(&part["quantities"][name])[20];
    assert!(voltage > 0.1 && close(quantity("voltage"), voltage));
    assert!(close(quantity("stretch"), length / rest));
    let field = voltage / (muscle.layer_thickness * length / rest);
    assert!(close(quantity("field"), field));
    assert_eq!(unpacked(&scene["markers"][0]["target"]), [1.0, -2.0, 3.5]);
    let path = unpacked(&scene["markers"][0]["path"]);
    assert!(
        trajectory
            .marks
            .iter()
            .flat_map(|m| m[0].iter())
            .zip(&path)
            .all(|(a, b)| close(*b, *a))
    );
}

/// Curves are what the run says, voltages by joint.
fn assert_charts(charts: &Value, run: &Run<'_>) {
    let (system, trajectory) = (run.system, run.trajectory);
    let charts = charts.as_array().unwrap();
    let chart = |title: &str| {
        let found = charts.iter().find(|chart| chart["title"] == title);
        found.unwrap_or_else(|| panic!("no chart of {title}"))
    };
    let pairs = chart("Voltages")["panels"].as_array().unwrap();
    assert_eq!(pairs.len(), system.joints.len());
    for (panel, joint) in pairs.iter().zip(&system.joints) {
        assert_eq!(panel["title"], joint.name);
        let dashed = [0, 1].map(|i| panel["series"][i]["dashed"].as_bool().unwrap());
        assert_eq!(dashed, [false, true]);
    }
    let points = unpacked(&pairs[2]["series"][1]["points"]);
    let end = trajectory.voltages[19][5] / 1e3;
    assert!(close(points[points.len() - 1], end));
    let angle = unpacked(&chart("Joints")["panels"][0]["series"][2]["points"]);
    let degrees = trajectory.joints[20][2].to_degrees();
    assert!(degrees.abs() > 0.1 && close(angle[41], degrees));
    assert_eq!(
        chart("Paths of the markers")["panels"]
            .as_array()
            .unwrap()
            .len(),
        3
    );
    assert!(charts.iter().all(|chart| chart["title"] != "Charges"));
}

#[test]
fn a_page_has_its_code_in_less_than_half_a_megabyte_and_asks_for_nothing() {
    let (system, mut trajectory) = swing();
    // A long motion is thinned, but not at its extremes.
    let count = 12_000;
    trajectory.times = (0..=count).map(|k| 0.1 * f64::from(k)).collect();
    trajectory
        .poses
        .resize(count as usize + 1, trajectory.poses[3].clone());
    trajectory
        .marks
        .resize(count as usize + 1, trajectory.marks[3].clone());
    trajectory.voltages.resize(count as usize, vec![0.0; 12]);
    trajectory.joints.resize(count as usize + 1, vec![0.0; 6]);
    trajectory.joints[7777][2] = 1.5;
    let run = run(&system, &trajectory);
    let html = html(&run);
    let data = page_data(&html);
    let size = data.to_string().len();
    assert!(html.len() - size < 500_000, "{} of code", html.len() - size);
    assert!(size < 2_000_000, "{size} of data");
    for outside in ["<script src", "<link", "http://", "https://", "@import"] {
        assert!(!html.contains(outside), "the page asks for {outside}");
    }
    let charts = data["charts"].as_array().unwrap();
    let joints = charts
        .iter()
        .find(|chart| chart["title"] == "Joints")
        .unwrap();
    let points = unpacked(&joints["panels"][0]["series"][2]["points"]);
    assert!((500..=4000).contains(&points.len()), "{}", points.len());
    assert!(
        points
            .iter()
            .any(|value| (value - 1.5_f64.to_degrees()).abs() < 1e-4)
    );
    assert!((points[points.len() - 2] - 1.2).abs() < 1e-6);
}

#[test]
fn each_muscle_looks_the_same_in_all_charts() {
    let (system, trajectory) = swing();
    let values = || (0..21).map(|k| 1.0 + f64::from(k)).collect::<Vec<_>>();
    let column = |name: String, unit| Column {
        name,
        unit,
        values: values(),
    };
    let each = system
        .muscles
        .iter()
        .enumerate()
        .rev()
        .flat_map(|(_, muscle)| {
            let ends = [
                ("stretch", ""),
                ("charge", "mC"),
                ("electrical_energy", "N mm"),
                ("mechanical_work", "N mm"),
            ];
            ends.map(|(end, unit)| column(format!("{}_{end}", muscle.name), unit))
        });
    let observations = Observations {
        columns: each.collect(),
    };
    let run = Run {
        observations: &observations,
        ..run(&system, &trajectory)
    };
    let data = page_data(&html(&run));
    let mut looks: BTreeMap<String, Vec<(Value, Value)>> = BTreeMap::new();
    let named = [
        "Voltages",
        "Stretches",
        "Charges",
        "Energy from each source",
        "Work of each source",
    ];
    for chart in data["charts"].as_array().unwrap() {
        let is_of_muscles = named.iter().any(|title| chart["title"] == *title);
        let panels = chart["panels"].as_array().unwrap().iter();
        let curves = panels.flat_map(|panel| panel["series"].as_array().unwrap());
        for curve in curves.filter(|_| is_of_muscles) {
            let look = (curve["colour"].clone(), curve["dashed"].clone());
            looks
                .entry(curve["name"].as_str().unwrap().to_owned())
                .or_default()
                .push(look);
        }
    }
    assert_eq!(looks.len(), 12, "{looks:?}");
    for (name, look) in &looks {
        assert_eq!(look.len(), named.len(), "{name}");
        assert!(look.iter().all(|one| *one == look[0]), "{name}: {look:?}");
    }
    let distinct: HashSet<_> = looks
        .values()
        .map(|look| look[0].0.to_string() + &look[0].1.to_string())
        .collect();
    assert_eq!(distinct.len(), 12);
}

#[test]
fn a_page_shows_the_ground_and_names_the_motion_beside() {
    let (system, trajectory) = swing();
    let run = Run {
        comparison: Some(("constant voltages", &trajectory)),
        name: "optimal voltages",
        ..run(&system, &trajectory)
    };
    let data = page_data(&html(&run));
    let scene = &data["scenes"][0];
    assert_eq!(scene["names"][0], "optimal voltages");
    assert_eq!(scene["names"][1], "constant voltages");
    // Below the lowest end of a muscle in the ground, and around all of them.
    let plate = unpacked(&scene["ground"]["plate"]);
    let ends = system
        .muscles
        .iter()
        .filter(|muscle| muscle.from.body.is_none());
    let ends: Vec<_> = ends.map(|muscle| muscle.from.at).collect();
    let lowest = ends.iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
    assert!(plate.len() > 30 && plate.chunks(3).all(|at| close(at[1], lowest)));
    let radius = (plate[0] - plate[plate.len() / 6 * 3])
        .hypot(plate[2] - plate[plate.len() / 6 * 3 + 2])
        / 2.0;
    assert!(ends.iter().all(|at| at.xz().norm() < radius), "{radius}");
    assert_eq!(unpacked(&scene["ground"]["faces"]).len(), 0);
}

#[test]
fn a_page_of_several_motions_tells_of_which_its_charts_are() {
    let (system, trajectory) = swing();
    let plots = [(
        "angle".to_owned(),
        LinePlot::over_time("angle [rad]", Vec::new()),
    )];
    let of = |name| Run {
        name,
        plots: &plots,
        ..run(&system, &trajectory)
    };
    let runs = [of("step"), of("sine")];
    let content = runs[0].page.unwrap();
    let data = page_data(&page::html("robot", &runs, content, runs[0].origin));
    assert_eq!(data["system"], "robot");
    let scenes = data["scenes"].as_array().unwrap().iter();
    let names: Vec<_> = scenes
        .map(|scene| scene["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["step", "sine"]);
    for name in names {
        let mut charts = data["charts"].as_array().unwrap().iter();
        let first = charts.find(|chart| chart["of"] == name).unwrap();
        assert_eq!(
            (&first["title"], &first["time"]),
            (&"angle".into(), &true.into())
        );
        assert!(charts.any(|chart| chart["of"] == name && chart["title"] == "Voltages"));
    }
    let alone = page_data(&html(&runs[0]));
    assert!(
        alone["charts"]
            .as_array()
            .unwrap()
            .iter()
            .all(|chart| chart["of"].is_null())
    );
}
