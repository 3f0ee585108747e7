//! Studies of control problems: re-simulation, points that fail, tables and figures.

use crate::report::assert_well_formed;
use crate::study::{numbers, of, results, steps, wheel};
use proboscis::control::problem::Task;
use proboscis::dynamics::simulate;
use proboscis::files::read_problem;
use proboscis::workflow::{Iterate, SolveLimits, optimise, trajectory};
use serde_json::json;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use tempfile::TempDir;

/// The pair of muscles of the kept problems.
fn pair() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let problems = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    fs::create_dir_all(folder.path().join("problems/scenes")).unwrap();
    for name in ["pair.json", "scenes/pair.json"] {
        fs::copy(
            problems.join(name),
            folder.path().join("problems").join(name),
        )
        .unwrap();
    }
    folder
}

#[test]
fn optimal_voltages_are_put_to_the_test_on_a_finer_grid() {
    let folder = pair();
    let study = json!({
        "title": "Intervals",
        "problem": "problems/pair.json",
        "methods": [{ "name": "reduced" }],
        "refine": { "name": "intervals", "set": { "control.intervals": [20, 40, 80, 160] } }
    });
    let record = results(folder.path(), &study, "1");
    let method = &record["methods"][0];
    let order = method["orders"]["resimulated_path"].as_f64().unwrap();
    assert!((order - 2.0).abs() < 0.2, "{order}");
    // The first point again, with a loop of its own.
    let point = &method["points"][0];
    let path = folder.path().join("problems/pair.json");
    let loaded = read_problem(&path, &["control.intervals=20".to_owned()]).unwrap();
    let Task::Control(task) = &loaded.task else {
        panic!("a control problem");
    };
    let mut on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let optimum = optimise(&loaded.system, task, None, SolveLimits::default(), &mut on).unwrap();
    assert_eq!(
        optimum.solution.objective,
        point["values"]["objective"][0].as_f64().unwrap()
    );
    let model = &optimum.model;
    let mut fine = Vec::new();
    for row in &optimum.motion.voltages {
        fine.extend(std::iter::repeat_n(row.clone(), 16));
    }
    let h = 200.0 / fine.len() as f64;
    let voltages = |from: f64, _: f64| model.scalars(&fine[(from / h).round() as usize]);
    let (discrete, failure) = simulate(
        model,
        &optimum.boundary.start,
        h,
        fine.len(),
        voltages,
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    let kept = proboscis::workflow::solved(model, &discrete, None);
    let again = trajectory(model, &kept).path(0);
    let optimal = trajectory(model, &optimum.motion).path(0);
    let distances: Vec<f64> = (0..=20)
        .map(|k| (again[16 * k] - optimal[k]).norm() / 1e3)
        .collect();
    let greatest = distances.iter().fold(0.0_f64, |m, d| m.max(*d));
    let told = |measure: &str| point["errors"][measure].as_f64().unwrap();
    assert!(greatest > 1e-6, "{greatest:e}");
    assert!((told("resimulated_path") - greatest).abs() < 1e-9 * greatest);
    assert!((told("resimulated_end") - distances[20]).abs() < 1e-9 * greatest);
}

#[test]
fn a_point_that_fails_is_listed_and_drawn_nowhere_and_the_others_go_on() {
    let folder = pair();
    let study = json!({
        "title": "Too few iterations",
        "problem": "problems/pair.json",
        "methods": [{ "name": "reduced" }],
        "refine": {
            "name": "intervals", "sizes": [20, 40, 80, 160],
            "set": {
                "control.intervals": [20, 40, 80, 160],
                "control.solver.max_iterations": [500, 2, 500, 500]
            }
        },
        "measures": ["objective", "end"]
    });
    let record = results(folder.path(), &study, "2");
    let points = record["methods"][0]["points"].as_array().unwrap();
    let status: Vec<_> = points
        .iter()
        .map(|p| p["status"].as_str().unwrap())
        .collect();
    assert_eq!(status, ["solved", "iteration_limit", "solved", "solved"]);
    assert!(points[1].get("seconds").is_none() && points[1].get("message").is_some());
    assert_eq!(points[1]["errors"], json!({}));
    for k in [0, 2, 3] {
        assert_eq!(points[k]["seconds"]["runs"].as_array().unwrap().len(), 2);
        assert!(points[k]["errors"]["objective"].as_f64().unwrap() > 0.0);
    }
    // The ratio of sizes is four and then two: the limit is extrapolated all the same.
    assert_eq!(
        of(&record, "objective")["references"][0]["orders"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
    let text = fs::read_to_string(folder.path().join("out/table.txt")).unwrap();
    assert!(text.contains("iteration limit"), "{text}");
    let html = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(html.contains("\"label\":\"median time of a solution [s]\",\"log\":true"));
    let page = fs::read_to_string(folder.path().join("out/study.md")).unwrap();
    assert!(page.contains("Points without an answer"), "{page}");
    let svg = fs::read_to_string(folder.path().join("out/objective.svg")).unwrap();
    assert_well_formed(&svg);
    // Three points, and one in the legend, each a disc and its rim.
    assert_eq!(svg.matches("<circle").count(), 8, "{svg}");
}

#[test]
fn tables_figures_and_page_say_the_same() {
    let folder = wheel();
    let record = results(folder.path(), &steps(), "3");
    let out = folder.path().join("out");
    let csv = fs::read_to_string(out.join("table.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    assert_eq!(rows.len(), 11);
    let column = |name: &str| rows[0].iter().position(|cell| *cell == name).unwrap();
    for (row, k) in rows[1..].iter().zip(0..) {
        let point = &record["methods"][k / 5]["points"][k % 5];
        let cell = |name: &str| row[column(name)].parse::<f64>().unwrap();
        let end = point["errors"]["end"].as_f64().unwrap();
        assert!((cell("end [mm]") / 1e3 - end).abs() <= 1e-15 * end);
        let runs = numbers(&point["seconds"]["runs"]);
        assert_eq!(runs.len(), 3);
        assert!(runs[0] > 0.0 && runs[0] <= runs[1] && runs[1] <= runs[2]);
        assert_eq!(cell("median [s]"), runs[1]);
        let quartile = point["seconds"]["lower_quartile"].as_f64().unwrap();
        assert!((quartile - 0.5 * (runs[0] + runs[1])).abs() < 1e-12 * quartile);
    }
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    let mut figures = 0;
    for measure in record["measures"].as_array().unwrap() {
        let name = format!("{}.svg", measure["measure"].as_str().unwrap());
        if out.join(&name).exists() {
            assert!(page.contains(&format!("({name})")), "{name}");
            let svg = fs::read_to_string(out.join(&name)).unwrap();
            assert_well_formed(&svg);
            assert!(svg.contains("directors"), "{name}");
            figures += 1;
        }
    }
    assert!(figures >= 4, "{figures}");
    let svg = fs::read_to_string(out.join("end.svg")).unwrap();
    for words in [
        "angle, order 2.0",
        "directors, order 2.0",
        "50 ms",
        "3.125 ms",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(page.contains("## What accuracy costs"));
    let said = record["conclusion"].as_str().unwrap();
    let second = page.split("\n\n").nth(1).unwrap();
    assert_eq!(second, format!("**Conclusion.** {said}"));
    let reached = "10 of 10 points have an answer; greatest error along the path: ";
    assert!(said.starts_with(reached), "{said}");
    assert!(said.contains(" costs least by `"), "{said}");
    // The costs are those of the page, with the order of each method.
    let text = fs::read_to_string(out.join("table.txt")).unwrap();
    let (_, costs) = text.split_once("\n\n").unwrap();
    assert!(page.contains(costs), "{page}");
    for method in ["angle", "directors"] {
        let mut lines = costs
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>());
        let line = lines.find(|cells| cells[..2] == ["path", method]).unwrap();
        let order: f64 = line[2].parse().unwrap();
        assert!((order - 2.0).abs() < 0.1, "{line:?}");
        assert_eq!(*line.last().unwrap(), "resolved");
    }
}

#[test]
fn a_point_whose_steps_are_halved_says_so_and_enters_no_order() {
    let folder = wheel();
    let mut study = steps();
    // 50 rad/s in steps of 50 ms are more than a right angle at once.
    study["set"] =
        json!({ "simulate.start.joint_rates.hub": "50 rad/s", "simulate.duration": "0.2 s" });
    study["methods"] = json!([{ "name": "angle", "set": { "simulate.coordinates": "reduced" } }]);
    study["refine"]["set"]["simulate.step"] =
        json!(["50 ms", "10 ms", "5 ms", "2.5 ms", "1.25 ms"]);
    study["measures"] = json!(["end"]);
    let record = results(folder.path(), &study, "1");
    let points = record["methods"][0]["points"].as_array().unwrap();
    assert!(points[0]["halved_steps"].as_u64().unwrap() > 0);
    assert!(
        points[1..]
            .iter()
            .all(|point| point.get("halved_steps").is_none())
    );
    assert!(points[0]["errors"]["end"].as_f64().unwrap() > 0.0);
    // Four points are left of five.
    let orders = of(&record, "end")["references"][0]["orders"]
        .as_array()
        .unwrap();
    assert_eq!(orders.len(), 2);
    let order = record["methods"][0]["orders"]["end"].as_f64().unwrap();
    assert!((order - 2.0).abs() < 0.2, "{order}");
    let text = fs::read_to_string(folder.path().join("out/table.txt")).unwrap();
    assert!(text.contains("1 of 5 with halved steps"), "{text}");
}
