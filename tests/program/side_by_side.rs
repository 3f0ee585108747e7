//! Several results on one page, and results without a page.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::refusals::refused_run;
use crate::runs::{run, workshop};

/// The data of a page.
fn page(folder: &Path) -> Value {
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    let (_, rest) = html.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split("</script>").next().unwrap()).unwrap()
}

/// Points of a curve of a chart's panel, as they stand in the page.
fn points<'a>(data: &'a Value, chart: &str, panel: Option<&str>, curve: &str) -> &'a Value {
    let named = |list: &'a Value, key: &str, name: &str| {
        let mut all = list.as_array().unwrap().iter();
        let found = all.find(|one| one[key] == name);
        found.unwrap_or_else(|| panic!("no {name} in {list}"))
    };
    let panels = &named(&data["charts"], "title", chart)["panels"];
    let panel = match panel {
        Some(name) => named(panels, "title", name),
        None => &panels[0],
    };
    &named(&panel["series"], "name", curve)["points"]
}

#[test]
fn results_are_compared_curve_by_curve_and_row_by_row() {
    let folder = workshop();
    let solve = |name: &str, limit: &str| {
        let bounds = format!("control.voltage_bounds=[\"0 V\",\"{limit}\"]");
        let arguments = ["solve", "problems/pair.json", "--set", &bounds, "-o", name];
        assert_eq!(run(folder.path(), &arguments).0, 0);
    };
    solve("results/a", "3 kV");
    solve("results/b", "2 kV");
    let arguments = ["report", "results/a", "results/b", "-o", "both"];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(
        (status, out.trim(), err.as_str()),
        (0, "both/report.html", "")
    );
    let both = page(&folder.path().join("both"));
    let each = ["a", "b"].map(|name| page(&folder.path().join("results").join(name)));
    assert_ne!(each[0]["rows"], each[1]["rows"]);
    for (name, one) in ["a", "b"].into_iter().zip(&each) {
        let joint = points(one, "Joints", None, "joint1");
        assert_eq!(points(&both, "Joints", Some("joint1"), name), joint);
        let path = points(one, "Paths of the markers", Some("x–y"), "optimal voltages");
        let own = format!("{name}, optimal voltages");
        assert_eq!(
            points(&both, "Paths of the markers", Some("x–y"), &own),
            path
        );
    }
    let [a, b] = ["a", "b"].map(|name| points(&both, "Joints", Some("joint1"), name));
    assert_ne!(a, b);
    let table = both["table"].as_array().unwrap();
    for (r, one) in each.iter().enumerate() {
        for row in one["rows"].as_array().unwrap() {
            let found = table.iter().find(|other| other[0] == row[0]).unwrap();
            assert_eq!(found[r + 1], row[1]);
        }
    }
    assert_eq!(both["span"][1], each[0]["scenes"][0]["span"][1]);
    for (r, name) in ["a", "b"].into_iter().enumerate() {
        let (shown, own) = (&both["scenes"][r], &each[r]["scenes"][0]);
        assert_eq!(
            (&shown["name"], &shown["parts"]),
            (&name.into(), &own["parts"])
        );
    }
}

#[test]
fn a_page_that_nobody_wants_is_not_written_and_then_cannot_be_compared() {
    let folder = workshop();
    let solve = ["solve", "problems/pair.json", "-o", "out"];
    assert_eq!(run(folder.path(), &solve).0, 0);
    let file = folder.path().join("out/report.html");
    assert!(file.is_file());
    // Nor does that of an earlier run stay.
    let arguments = [&solve[..], &["--no-report"]].concat();
    assert_eq!(run(folder.path(), &arguments).0, 0);
    assert!(!file.exists() && folder.path().join("out/voltages.svg").is_file());
    let refused = |words: &[&str]| {
        let arguments = ["report", "out", "out", "-o", "both"];
        refused_run(folder.path(), &arguments, words);
        assert!(!folder.path().join("both").exists());
    };
    refused(&["out/report.html", "--no-report"]);
    fs::write(&file, "<html>another page</html>").unwrap();
    refused(&["out/report.html", "no whole page of a result"]);
}

#[test]
fn a_result_keeps_its_own_page_and_a_truncated_one_is_refused() {
    let folder = workshop();
    let of = |name: &str| {
        let arguments = ["solve", "problems/pair.json", "-o", name];
        assert_eq!(run(folder.path(), &arguments).0, 0);
        folder.path().join(name).join("report.html")
    };
    let [_, second] = ["one", "two"].map(of);
    let whole = fs::read_to_string(&second).unwrap();
    for output in ["two", "one/../two"] {
        let arguments = ["report", "one", "two", "-o", output];
        refused_run(folder.path(), &arguments, &["--output", "another folder"]);
    }
    assert!(fs::read_to_string(&second).unwrap() == whole);
    // Behind the data, so that these can still be read.
    let data = whole.find("id=\"data\">").unwrap();
    let end = data + whole[data..].find("</script>").unwrap() + "</script>".len();
    assert!(end < whole.len());
    fs::write(&second, &whole[..end]).unwrap();
    let arguments = ["report", "one", "two", "-o", "both"];
    refused_run(
        folder.path(),
        &arguments,
        &["two/report.html", "no whole page"],
    );
}
