//! End of the domain of the first-order dielectric, and the messages about it.

use crate::stable::{file, model, reference, run, scene, summary};
use proboscis::dynamics::{DiscreteTrajectory, largest_stretch, out_of_domain};
use proboscis::model::Role;
use proboscis::model::system::ElectricConstants;
use serde_json::{Value, json};
use std::path::Path;

/// Charge over voltage of a cell at stretch Λ and volume ratio J: positive inside the domain, negative outside.
#[test]
fn the_domain_ends_where_the_permittivity_vanishes() {
    let vacuum = 8.854e-12;
    let electric = ElectricConstants {
        c1: -4.0 * vacuum,
        c2: 2.0 * vacuum,
        permittivity: vacuum,
    };
    // docs/theory.md, 2.4: exact zero for ε_r = 5, J = 1.
    assert!((largest_stretch(&electric, 1.0).unwrap() - 1.4553).abs() < 5e-5);
    for volume in [0.7, 1.0, 1.3] {
        let limit = largest_stretch(&electric, volume).unwrap();
        let permittivity = |l: f64| 4.0 * (2.0 - l * l) + volume / (l * l);
        assert!(permittivity(0.999 * limit) > 1e-3 && permittivity(1.001 * limit) < -1e-3);
    }
    let ideal = ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: 5.0 * vacuum,
    };
    assert_eq!(largest_stretch(&ideal, 1.0), None);
}

/// A block drawn out by known stretches under voltage, at three instants.
#[test]
fn a_block_outside_the_domain_is_told_with_its_instants() {
    let system = scene(&json!({
        "name": "block",
        "materials": { "m": { "density": 1000, "shear_modulus": 1e5, "lame_lambda": 4e5, "relative_permittivity": 5.0 } },
        "solids": [{
            "name": "block", "material": "m", "element": "hex8",
            "box": { "size": [0.01, 0.01, 0.01], "elements": [1, 1, 2] },
            "electrodes": [
                { "name": "bottom", "face": "z_min", "potential": "grounded" },
                { "name": "top", "face": "z_max", "potential": "driven" },
            ],
            "fixed": [
                { "face": "x_min", "directions": ["x"] }, { "face": "y_min", "directions": ["y"] },
                { "face": "z_min", "directions": ["z"] },
            ],
        }],
    }));
    let model = model(system);
    let zero = reference(&model);
    let stretched = |l: f64| -> Vec<f64> {
        let axes = model.action.map.of_nodes.iter().zip(&zero);
        axes.map(|(&(_, axis), x)| if axis == 2 { l * x } else { x / l.sqrt() })
            .collect()
    };
    let scalars = |voltage: f64| {
        let mut scalars = vec![0.5 * voltage; model.action.intervals.scalars];
        scalars[model.variables.range(Role::Voltage)].fill(voltage);
        scalars
    };
    let motion = |voltage: f64| DiscreteTrajectory {
        times: vec![0.0, 1.0, 2.0, 3.0],
        z: [1.0, 1.46, 1.6, 1.5].map(stretched).to_vec(),
        scalars: vec![scalars(voltage); 3],
        ..DiscreteTrajectory::default()
    };
    assert_eq!(out_of_domain(&model, &motion(0.0)), Vec::new());
    let outside = out_of_domain(&model, &motion(1e3));
    let [one] = &outside[..] else {
        panic!("{outside:?}");
    };
    assert_eq!(
        (one.name.as_str(), one.first, one.time),
        ("block", 1.0, 2.0)
    );
    assert!(
        (one.stretch - 1.6).abs() < 1e-9 && (one.limit - 1.4553).abs() < 5e-5,
        "{one:?}"
    );
}

/// The muscle drawn out by a weight of 0.6 kg is told, at rest and in motion.
#[test]
fn a_muscle_outside_the_domain_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let problem = file("09_domain");
    let (status, out, err) = run(path, &["equilibrium", problem.to_str().unwrap()]);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.contains("stable equilibrium") && out.contains("N/mm: s, stretch of m"),
        "{out}"
    );
    assert_eq!(err.lines().count(), 1, "{err}");
    for word in [
        "first-order dielectric",
        "m is stretched to 2.236",
        "ends at 1.4553",
    ] {
        assert!(err.contains(word), "{word}: {err}");
    }
    let told = summary(&path.join("results/09_domain"));
    let outside = &told["domain"][0];
    assert_eq!(outside["name"], "m");
    assert_eq!(outside["stretch"], told["stretches"]["m"]);
    // A W_Λ/V₀ = m g of the weight and half of the muscle, by docs/theory.md, 3.1; in N and m, at 1 kV over 50 µm.
    let stretch = outside["stretch"].as_f64().unwrap();
    let (field, vacuum) = (2e7_f64, 8.854_187_8e-12);
    let elastic = 1e5 * (stretch - stretch.powi(-2));
    let electric = vacuum * field * field * (4.0 * stretch + stretch.powi(-3));
    let force = 25e-6 * (elastic + electric);
    assert!((force / (0.6005 * 9.81) - 1.0).abs() < 1e-5, "{force}");
    for name in ["configuration.svg", "equilibrium.csv", "report.html"] {
        assert!(
            path.join("results/09_domain").join(name).is_file(),
            "{name}"
        );
    }

    let mut written: Value =
        serde_json::from_str(&std::fs::read_to_string(&problem).unwrap()).unwrap();
    written.as_object_mut().unwrap().remove("equilibrium");
    written["simulate"] = json!({ "duration": "20 ms", "step": "1 ms", "voltages": { "m": 1000 }, "start": { "joint_angles": {} } });
    std::fs::write(path.join("fall.json"), written.to_string()).unwrap();
    let (status, _, err) = run(path, &["simulate", "fall.json", "-o", "short"]);
    assert!(status == 0 && !err.contains("dielectric"), "{err}");
    let long = [
        "simulate",
        "fall.json",
        "-o",
        "long",
        "--set",
        "simulate.duration=100 ms",
    ];
    let (status, _, err) = run(path, &long);
    assert!(status == 0 && err.contains("outside from 0.0"), "{err}");
    let outside = &summary(&path.join("long"))["domain"][0];
    let [first, time] = ["first", "time"].map(|key| outside[key].as_f64().unwrap());
    // Falling freely it passes the limit later than (2 · 0.455 · 40 mm/g)^½ = 61 ms.
    assert!(
        first > 0.02 && first < time && time <= 0.1,
        "{first} {time}"
    );
    assert!(outside["stretch"].as_f64().unwrap() > 1.4553);
}

/// The path past pull-in has its limit point in table, picture, page and summary alike.
#[test]
fn pull_in_is_marked_on_the_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let problem = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pull_in.json");
    let arguments = ["equilibrium", problem.to_str().unwrap(), "-o", "path"];
    let (status, out, err) = run(path, &arguments);
    assert_eq!(status, 0, "{err}");
    assert!(out.contains("equilibria, path"), "{out}");
    let results = path.join("path");
    let told = summary(&results);
    let lost = &told["path"]["lost"][0];
    let fraction = lost["fraction"].as_f64().unwrap();
    assert_eq!(lost["kind"], "pull_in");
    // Of all states of rest on the path this one has the most.
    assert_eq!(told["path"]["largest_fraction"], lost["fraction"]);
    assert!(
        err.contains(&format!(
            "pull-in at {:.6} % of the voltages",
            100.0 * fraction
        )),
        "{err}"
    );
    let table = std::fs::read_to_string(results.join("path.csv")).unwrap();
    let mut lines = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let column = |name: &str| header.iter().position(|cell| *cell == name).unwrap();
    let (of_fraction, of_lost) = (column("fraction"), column("stability_lost"));
    let marked: Vec<f64> = lines
        .filter(|row| row[of_lost] == "1.0")
        .map(|row| row[of_fraction].parse().unwrap())
        .collect();
    assert_eq!(marked, [fraction]);
    let label = format!("pull-in at {:.2} %", 100.0 * fraction);
    let svg = std::fs::read_to_string(results.join("path.svg")).unwrap();
    assert!(svg.contains(&label), "{label}");
    for name in ["configuration.svg", "report.html"] {
        assert!(results.join(name).is_file(), "{name}");
    }
}
