//! What accuracy costs: studies of motions with a closed form, refused studies, points that fail, and their files.

use assert_cmd::Command;
use proboscis::control::problem::Task;
use proboscis::dynamics::simulate;
use proboscis::run::{Allowed, Iterate, integrate, optimise, trajectory};
use proboscis::scene::read_problem;
use proboscis::study::limit::{How, limit, observed_order};
use proboscis::study::read::read_study;
use serde_json::{Value, json};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;
use tempfile::TempDir;

/// A wheel of 1 kg and 0.1 m that is slowed down by its hub: θ(t) = ω I/c (1 − exp(−c t/I)) with I = m r²/2.
fn wheel() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = json!({
        "name": "wheel",
        "bodies": [{
            "name": "wheel", "mass": "1 kg", "position": [0, 0, 0],
            "cylinder": { "length": "50 mm", "radius": "100 mm", "axis": [0, 0, 1] }
        }],
        "joints": [{
            "name": "hub", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "wheel",
            "at": [0, 0, 0], "damping": "0.02 N m s/rad"
        }],
        "markers": [{ "name": "rim", "body": "wheel", "at": ["100 mm", 0, 0] }]
    });
    let problem = json!({
        "scene": "wheel.json",
        "simulate": {
            "duration": "1 s", "step": "50 ms",
            "start": { "joint_angles": {}, "joint_rates": { "hub": "3 rad/s" } }
        }
    });
    write(folder.path(), "wheel.json", &scene);
    write(folder.path(), "problem.json", &problem);
    folder
}

/// Place of the rim in m at a time in s.
fn rim(time: f64) -> [f64; 3] {
    let rate = 0.02 / (0.5 * 0.1 * 0.1);
    let angle = 3.0 / rate * (1.0 - f64::exp(-rate * time));
    [0.1 * angle.cos(), 0.1 * angle.sin(), 0.0]
}

/// A study of the step of the wheel in both kinds of coordinates.
fn steps() -> Value {
    json!({
        "title": "Steps of a wheel",
        "problem": "problem.json",
        "methods": [
            { "name": "angle", "set": { "simulate.coordinates": "reduced" } },
            { "name": "directors", "set": { "simulate.coordinates": "redundant" } }
        ],
        "refine": {
            "name": "step",
            "set": { "simulate.step": ["50 ms", "25 ms", "12.5 ms", "6.25 ms", "3.125 ms"] }
        }
    })
}

fn write(folder: &Path, name: &str, value: &Value) {
    fs::write(folder.join(name), value.to_string()).unwrap();
}

/// Exit status, standard output and standard error of a run in a folder.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("proboscis").unwrap();
    let output = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let status = output.status.code().unwrap();
    (status, text(output.stdout), text(output.stderr))
}

/// Runs a study in a folder and returns its `study.json`.
fn results(folder: &Path, study: &Value, runs: &str) -> Value {
    write(folder, "study.json", study);
    let (status, out, err) = run(
        folder,
        &["study", "study.json", "-o", "out", "--runs", runs, "-q"],
    );
    assert_eq!(status, 0, "{out}{err}");
    record(folder)
}

fn record(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("out/study.json")).unwrap()).unwrap()
}

/// What the record says of one measure.
fn of<'a>(record: &'a Value, measure: &str) -> &'a Value {
    let all = record["measures"].as_array().unwrap();
    all.iter()
        .find(|m| m["measure"] == measure)
        .unwrap_or_else(|| panic!("no {measure}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn a_wheel_that_is_slowed_down_converges_to_its_closed_form() {
    let folder = wheel();
    let record = results(folder.path(), &steps(), "1");
    assert_eq!(record["status"], "complete");
    assert_eq!(record["asked"], "motion");
    let exact = rim(1.0);
    assert!(apart(&exact, &[0.1, 0.0, 0.0]) > 0.05, "the wheel turns");
    for (m, reference) in of(&record, "end")["references"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let order = reference["orders"]
            .as_array()
            .unwrap()
            .last()
            .unwrap()
            .as_f64()
            .unwrap();
        assert!((order - 2.0).abs() < 0.05, "{order}");
        assert_eq!(reference["is_extrapolated"], true);
        let method = &record["methods"][m];
        let shown = method["orders"]["end"].as_f64().unwrap();
        assert!((shown - 2.0).abs() < 0.05, "{shown}");
        let points = method["points"].as_array().unwrap();
        assert_eq!(points.len(), 5);
        let finest = numbers(&points[4]["values"]["end"]);
        let left = apart(&finest, &exact);
        let limit = apart(&numbers(&reference["value"]), &exact);
        assert!(
            left > 1e-9 && limit < 1e-3 * left,
            "{limit:e} against {left:e}"
        );
        for point in points {
            // Against the closed form, by the places that are recorded.
            let truth = apart(&numbers(&point["values"]["end"]), &exact);
            let told = point["errors"]["end"].as_f64().unwrap();
            assert!(
                (told - truth).abs() < 1e-2 * truth,
                "{told:e} against {truth:e}"
            );
        }
    }
    // Along the path: all 21 instants of the coarsest grid, and the greatest error among them.
    let instants = numbers(&record["instants"]);
    assert_eq!(instants.len(), 21);
    let coarsest = &record["methods"][0]["points"][0];
    let places = numbers(&coarsest["values"]["path"]);
    let pairs = places.chunks(3).zip(&instants);
    let truth = pairs
        .map(|(place, t)| apart(place, &rim(*t)))
        .fold(0.0, f64::max);
    let told = coarsest["errors"]["path"].as_f64().unwrap();
    assert!(
        truth > 1e-6 && (told - truth).abs() < 1e-2 * truth,
        "{told:e} against {truth:e}"
    );
    // What the hub dissipates is accounted for, to the order of the rule.
    for method in record["methods"].as_array().unwrap() {
        let order = method["orders"]["energy_balance"].as_f64().unwrap();
        // The greatest error is that of t₁ = h, where energies of two intervals are interpolated: h²/8 E″(h), and E″ falls like
        // exp(−8 h/s). Two steps h and h/2 show 2 − 4 h/(s ln 2), which is 1.71 for the coarsest two and 1.96 for the finest.
        let points = method["points"].as_array().unwrap();
        let error = |k: usize| points[k]["errors"]["energy_balance"].as_f64().unwrap();
        for k in 0..4 {
            let step = 0.05 * 0.5_f64.powi(k as i32);
            let here = (error(k) / error(k + 1)).log2();
            let seen = 2.0 - 4.0 * step / std::f64::consts::LN_2;
            // To the next order in the step.
            assert!((here - seen).abs() < 1.5 * step, "{here} against {seen}");
        }
        assert!((order - 2.0).abs() < 0.15, "{order}");
        assert!(
            method["points"][0]["errors"]["energy_balance"]
                .as_f64()
                .unwrap()
                > 1e-5
        );
    }
    let violation = |m: usize| {
        record["methods"][m]["points"][0]["errors"]["constraint_violation"]
            .as_f64()
            .unwrap()
    };
    assert_eq!(violation(0), 0.0);
    assert!(
        violation(1) > 0.0 && violation(1) < 1e-8,
        "{}",
        violation(1)
    );
}

#[test]
fn a_reference_of_its_own_is_finer_than_the_points_and_is_not_timed() {
    let folder = wheel();
    let mut study = steps();
    study["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms"]);
    study["reference"] = json!({
        "method": "angle",
        "refine": { "name": "step", "set": { "simulate.step": ["4 ms", "2 ms", "1 ms"] } }
    });
    let record = results(folder.path(), &study, "1");
    let end = of(&record, "end");
    assert_eq!(end["references"].as_array().unwrap().len(), 1);
    assert_eq!(end["references"][0]["method"], "angle");
    assert!(apart(&numbers(&end["references"][0]["value"]), &rim(1.0)) < 1e-9);
    let extra = record["reference_points"].as_array().unwrap();
    assert_eq!(extra.len(), 3);
    assert!(extra.iter().all(|point| point.get("seconds").is_none()));
    let timed = record["methods"][1]["points"][1]["seconds"]["runs"]
        .as_array()
        .unwrap();
    assert_eq!(timed.len(), 1);
    // The steps of the reference share their instants with 50 and 25 ms only where 4 ms does: every 100 ms.
    assert_eq!(numbers(&record["instants"]).len(), 11);
}

#[test]
fn each_point_runs_again_from_its_overrides_to_the_last_bit() {
    let folder = wheel();
    let record = results(folder.path(), &steps(), "1");
    let mut count = 0;
    for method in record["methods"].as_array().unwrap() {
        for point in method["points"].as_array().unwrap() {
            let set: Vec<String> = serde_json::from_value(point["set"].clone()).unwrap();
            assert_eq!(set.len(), 2);
            let path = folder.path().join(point["problem"].as_str().unwrap());
            let loaded = read_problem(&path, &set).unwrap();
            let Task::Simulate(task) = &loaded.task else {
                panic!("a simulation");
            };
            let moved = integrate(
                &path,
                &loaded.system,
                task,
                |_, _| ControlFlow::Continue(()),
            )
            .unwrap();
            let kept = proboscis::run::solved(&moved.model, &moved.history, None);
            let places = trajectory(&moved.model, &kept).path(0);
            let last = places.last().unwrap();
            let told = numbers(&point["values"]["end"]);
            assert_eq!(told, [last.x / 1e3, last.y / 1e3, last.z / 1e3]);
            let command = point["command"].as_str().unwrap();
            assert!(
                command.starts_with("proboscis simulate problem.json --set "),
                "{command}"
            );
            // Blanks need quotes in a shell.
            assert!(command.contains("--set 'simulate.step="), "{command}");
            count += 1;
        }
    }
    assert_eq!(count, 10);
}

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
    let optimum = optimise(
        &path,
        &loaded.system,
        task,
        None,
        Allowed::default(),
        &mut on,
    )
    .unwrap();
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
    let (history, failure) = simulate(
        model,
        &optimum.boundary.start,
        h,
        fine.len(),
        voltages,
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    let kept = proboscis::run::solved(model, &history, None);
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
    let page = fs::read_to_string(folder.path().join("out/study.md")).unwrap();
    assert!(page.contains("Points without an answer"), "{page}");
    let svg = fs::read_to_string(folder.path().join("out/objective.svg")).unwrap();
    assert_well_formed(&svg);
    // Three points, and one in the legend, each a disc and its rim.
    assert_eq!(svg.matches("<circle").count(), 8, "{svg}");
}

/// Every tag closes, nothing is outside the root, no number is missing.
fn assert_well_formed(svg: &str) {
    assert!(svg.starts_with("<svg "));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let mut open = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap());
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && rest.trim().is_empty());
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
    assert!(page.contains("## What accuracy costs") && page.contains("**"));
    let said = record["conclusion"].as_str().unwrap();
    let second = page.split("\n\n").nth(1).unwrap();
    assert_eq!(second, format!("**Conclusion.** {said}"));
    for words in [
        "Greatest error along the path: ",
        "`angle`",
        "Observed order",
    ] {
        assert!(said.contains(words), "{words:?} in {said}");
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
    let said = record["conclusion"].as_str().unwrap();
    assert!(
        said.contains("Steps were halved") && said.contains("step 50 ms"),
        "{said}"
    );
    let text = fs::read_to_string(folder.path().join("out/table.txt")).unwrap();
    assert!(text.contains("halved"), "{text}");
}

#[test]
fn what_any_mesh_tells_exactly_has_nothing_to_extrapolate() {
    let folder = tempfile::tempdir().unwrap();
    let scene = json!({
        "name": "cube",
        "materials": { "silicone": { "shear_modulus": "100 kPa", "lame_lambda": "400 kPa", "relative_permittivity": 3.0 } },
        "solids": [{
            "name": "cube", "material": "silicone",
            "box": { "size": ["10 mm", "10 mm", "10 mm"], "elements": [1, 1, 1] },
            "electrodes": [
                { "name": "bottom", "face": "z_min", "potential": "grounded" },
                { "name": "top", "face": "z_max", "potential": "driven" }
            ],
            "fixed": [
                { "face": "x_min", "directions": ["x"] },
                { "face": "y_min", "directions": ["y"] },
                { "face": "z_min", "directions": ["z"] }
            ]
        }],
        "markers": [
            { "name": "corner", "solid": "cube", "at": ["10 mm", "10 mm", "10 mm"] },
            { "name": "middle", "solid": "cube", "at": ["5 mm", "5 mm", "5 mm"] }
        ]
    });
    write(folder.path(), "cube.json", &scene);
    let problem =
        json!({ "scene": "cube.json", "equilibrium": { "voltages": { "cube.top": "500 kV" } } });
    write(folder.path(), "problem.json", &problem);
    let mut study = json!({
        "title": "Meshes of a cube",
        "problem": "problem.json",
        "methods": [{ "name": "hex8" }],
        "refine": {
            "name": "elements", "sizes": [2, 4, 6],
            "set": { "scene.solids[0].box.elements": [[2, 2, 2], [4, 4, 4], [6, 6, 6]] }
        }
    });
    let record = results(folder.path(), &study, "1");
    assert_eq!(record["asked"], "rest");
    let place = of(&record, "place");
    assert!(place["scale"].as_f64().unwrap() > 1e-5, "{place}");
    assert_eq!(place["references"][0]["is_extrapolated"], false);
    for point in record["methods"][0]["points"].as_array().unwrap() {
        assert_eq!(point["status"], "at_rest");
        assert!(point["errors"]["place"].as_f64().unwrap() < 1e-12);
    }
    assert!(!folder.path().join("out/place.svg").exists());
    // The middle is no node of three elements.
    study["refine"]["sizes"] = json!([2, 3, 4]);
    study["refine"]["set"]["scene.solids[0].box.elements"] =
        json!([[2, 2, 2], [3, 3, 3], [4, 4, 4]]);
    write(folder.path(), "study.json", &study);
    let (status, _, err) = run(folder.path(), &["study", "study.json", "-o", "other", "-q"]);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("markers") && err.contains("\"middle\"") && err.contains("nearest node"),
        "{err}"
    );
}

#[test]
fn wrong_studies_are_refused_with_place_found_and_expected() {
    let folder = wheel();
    let path = folder.path();
    let refused = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let mut study = steps();
        change(&mut study);
        write(path, "study.json", &study);
        let (status, out, err) = run(path, &["study", "study.json"]);
        assert_eq!(status, 2, "{out}{err}");
        assert_eq!(out, "");
        let first = err.lines().next().unwrap();
        for word in words {
            assert!(first.contains(word), "no {word:?} in {first}");
        }
        assert!(!path.join("results").exists(), "{first}");
    };
    let word = |key: &str| format!("study.json: {key}: found ");
    refused(
        &|s| s["methods"] = json!([]),
        &[&word("methods"), "no method", "1 method or more"],
    );
    refused(
        &|s| s["metods"] = json!([]),
        &[&word("metods"), "did you mean \"methods\"?"],
    );
    refused(
        &|s| s["methods"][1]["name"] = json!("angle"),
        &[&word("methods[1].name"), "\"angle\" a second time"],
    );
    refused(
        &|s| s["problem"] = json!("nowhere.json"),
        &[
            &word("problem"),
            "nowhere.json",
            "no file",
            "expected the path of a problem file",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "-1 ms"]),
        &[
            &word("refine.set.simulate.step[2]"),
            "-1",
            "expected a positive size",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "30 ms"]),
        &[
            &word("refine.set.simulate.step"),
            "30 ms",
            "the coarsest point first",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "1 us"]),
        &[&word("refine"), "expected \"sizes\""],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.duration"] = json!(["1 s"]),
        &[
            &word("refine.set.simulate.step"),
            "5 values",
            "expected 1, as many as of \"simulate.duration\"",
        ],
    );
    refused(
        &|s| s["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms"]),
        &[&word("methods[0]"), "2 points", "expected 3 or more"],
    );
    // A wrong override is told where it stands in the study.
    refused(
        &|s| s["methods"][1]["set"]["simulate.coordinates"] = json!("reducd"),
        &[
            &word("methods[1].set.simulate.coordinates"),
            "\"reducd\"",
            "problem.json",
            "did you mean \"reduced\"?",
        ],
    );
    refused(
        &|s| s["set"] = json!({ "scene.bodies[0].mass": "-1 kg" }),
        &[
            &word("set.scene.bodies[0].mass"),
            "-1 kg",
            "expected a positive value",
        ],
    );
    refused(
        &|s| s["set"] = json!({ "simulate..step": 1 }),
        &[
            &word("set.simulate..step"),
            "expected a place in the problem",
        ],
    );
    refused(
        &|s| s["reference"] = json!({ "method": "angel" }),
        &[
            &word("reference.method"),
            "\"angel\"",
            "did you mean \"angle\"?",
        ],
    );
    refused(
        &|s| s["markers"] = json!(["rin"]),
        &[&word("markers[0]"), "\"rin\"", "did you mean \"rim\"?"],
    );
    refused(
        &|s| s["measures"] = json!(["end", "objective"]),
        &[
            &word("measures[1]"),
            "\"objective\"",
            "a simulation does not have",
            "\"energy_balance\"",
        ],
    );
    refused(
        &|s| s["measures"] = json!([]),
        &[&word("measures"), "1 measure or more"],
    );
    refused(
        &|s| s["runs"] = json!(4),
        &[&word("runs"), "found 4", "5 runs or more"],
    );
    refused(
        &|s| s["methods"][1]["set"]["simulate.duration"] = json!("2 s"),
        &[
            &word("methods[1]"),
            "2 s",
            "expected 1 s, as of the first point",
        ],
    );
    let (status, _, err) = run(path, &["study", "none.json"]);
    assert!(status == 2 && err.contains("no readable file"), "{err}");
    let (status, _, err) = run(path, &["study", "study.json", "--runs", "0"]);
    assert!(status == 2 && err.contains("--runs"), "{err}");
}

#[test]
fn every_kept_study_is_right() {
    let mut count = 0;
    for entry in fs::read_dir("problems/studies").unwrap() {
        let path = entry.unwrap().path();
        let study = read_study(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(
            study.methods.len() > 1 && study.runs >= 5,
            "{}",
            path.display()
        );
        count += 1;
    }
    assert!(count >= 8, "{count} studies");
}

#[test]
fn ctrl_c_keeps_the_results_so_far() {
    let folder = wheel();
    let mut study = steps();
    // The last point takes long.
    study["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "12.5 ms", "0.0005 ms"]);
    write(folder.path(), "study.json", &study);
    let binary = assert_cmd::cargo::cargo_bin("proboscis");
    let mut child = std::process::Command::new(binary)
        .current_dir(folder.path())
        .args(["study", "study.json", "-o", "out", "-q"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // The folder is made once Ctrl-C is listened to.
    while !folder.path().join("out").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        thread::sleep(Duration::from_millis(10));
    }
    thread::sleep(Duration::from_millis(300));
    crate::common::signals::interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let record = record(folder.path());
    assert_eq!(record["status"], "interrupted");
    let points = record["methods"][0]["points"].as_array().unwrap();
    assert_eq!(points.len(), 4);
    assert_eq!(points[3]["status"], "interrupted");
    assert!(points[3].get("seconds").is_none());
    let page = fs::read_to_string(folder.path().join("out/study.md")).unwrap();
    assert!(page.contains("Interrupted"), "{page}");
}

#[test]
fn limits_and_orders_of_made_up_sequences() {
    for order in [1.0, 2.0, 4.0, 6.0] {
        // Steps that are not halved evenly.
        let sizes = [1.0, 0.6, 0.25, 0.15];
        let value = |h: &f64| vec![3.0 + 0.2 * h.powf(order), -1.0 - 0.7 * h.powf(order), 0.5];
        let values: Vec<_> = sizes.iter().map(value).collect();
        let found = limit(&sizes, &values, 3).unwrap();
        assert_eq!(found.how, How::Extrapolated);
        for p in &found.orders {
            assert!((p.unwrap() - order).abs() < 1e-6, "{p:?} for {order}");
        }
        assert!(apart(&found.value, &[3.0, -1.0, 0.5]) < 1e-12);
        let errors = sizes
            .iter()
            .zip(&values)
            .map(|(h, x)| [*h, apart(x, &found.value)]);
        let errors: Vec<_> = errors.collect();
        let shown = observed_order(&errors, 1e-12).unwrap();
        assert!((shown - order).abs() < 1e-6);
    }
    let sizes = [1.0, 0.5, 0.25];
    let of = |values: [f64; 3]| limit(&sizes, &values.map(|x| vec![x]), 1).unwrap();
    assert_eq!(of([1.0, 2.0, 1.0]).how, How::NoOrder);
    // Values that go to and fro show no order, however quickly they calm down.
    assert_eq!(of([1.0, 5.0, 4.0]).how, How::NoOrder);
    assert_eq!(of([1.0, 2.0, 4.0]).value, [4.0]);
    assert_eq!(of([5.0, 7.0, 7.0 + 1e-14]).how, How::Rounding);
    assert_eq!(
        limit(&sizes[..2], &[vec![1.0], vec![2.0]], 1).unwrap().how,
        How::TooFew
    );
    assert_eq!(limit(&[], &[], 1), None);
    // A rough start and rounding at the end do not belong to the straight part, a flat curve has no order.
    let error = |h: f64| if h > 0.3 { 0.5 } else { h * h };
    let halved: Vec<_> = (0..12)
        .map(|k| 0.5_f64.powi(k))
        .map(|h| [h, error(h).max(1e-6)])
        .collect();
    let shown = observed_order(&halved, 1.1e-6).unwrap();
    assert!((shown - 2.0).abs() < 0.05, "{shown}");
    let flat: Vec<_> = halved.iter().map(|p| [p[0], 0.3]).collect();
    assert_eq!(observed_order(&flat, 0.0), None);
    assert_eq!(observed_order(&[[1.0, 1.0]], 0.0), None);
    let level = [[8.0, 3.18], [4.0, 1.29], [2.0, 0.684], [1.0, 0.693]];
    assert_eq!(observed_order(&level, 0.0), None);
}
