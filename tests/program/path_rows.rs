//! Rows of a path of equilibria: each one is the equilibrium of its voltage, charges and energies too.

use crate::runs::{run, workshop};
use std::collections::BTreeMap;
use std::fs;

#[test]
fn rows_of_a_path_are_single_equilibria() {
    let folder = workshop();
    let path = folder.path();
    let row = |file: &str, k: usize| {
        let text = fs::read_to_string(path.join(file)).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let names = lines.next().unwrap().split(',').map(str::to_owned);
        let values = lines.nth(k).unwrap().split(',');
        let values = values.map(|value| value.parse::<f64>().unwrap());
        names.zip(values).collect::<BTreeMap<String, f64>>()
    };
    let few = "equilibrium.path=6";
    let arguments = ["solve", "problems/pull_in.json", "--set", few, "-o", "path"];
    assert_eq!(run(path, &arguments).0, 0);
    let on_path = row("path/path.csv", 3);
    let voltage = format!("cube.top={}", on_path["cube.top [V]"]);
    let arguments = [
        "equilibrium",
        "problems/pull_in.json",
        "--voltages",
        &voltage,
    ];
    let arguments = [&arguments[..], &["-o", "single"]].concat();
    assert_eq!(run(path, &arguments).0, 0);
    let mut seen = 0;
    for (name, value) in row("single/equilibrium.csv", 0) {
        if name.contains("charge") || name.contains("energy") {
            let error = (on_path[&name] - value).abs();
            assert!(error < 1e-6 * value.abs().max(1.0), "{name}: {error}");
            seen += usize::from(value.abs() > 1.0);
        }
    }
    assert!(seen > 1, "{seen}");
}
