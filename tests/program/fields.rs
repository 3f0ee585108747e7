//! Fields of elastic blocks as ParaView reads them, against the state, the electrodes and homogeneous solutions.

use crate::common::vtk_arrays::unpacked;
use crate::runs::read;
use nalgebra::Vector3;
use proboscis::app::{CommandInput, CommandOutput, PageWanted, ProgressDisplay, run};
use proboscis::model::VACUUM_PERMITTIVITY;
use proboscis::report::Figures;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

type Vector = Vector3<f64>;

/// Shear modulus and first Lamé constant in Pa, edge of the cube in m.
const MU: f64 = 1e5;
const LAMBDA: f64 = 4e5;
const EDGE: f64 = 0.01;

/// Arrays of a `.vtu` file by name.
#[derive(Debug)]
pub(crate) struct Fields(HashMap<String, Vec<f64>>);

impl Fields {
    pub(crate) fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let arrays = text.split("<DataArray").skip(1).map(|array| {
            let (tag, rest) = array.split_once('>').unwrap();
            let name = tag.split("Name=\"").nth(1).unwrap();
            let name = name.split('"').next().unwrap().to_owned();
            let bytes = unpacked(rest.split("</DataArray>").next().unwrap());
            let numbers = bytes.chunks_exact(8);
            let numbers = numbers.map(|b| f64::from_le_bytes(b.try_into().unwrap()));
            (name, numbers.collect())
        });
        Self(arrays.collect())
    }

    fn has(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    pub(crate) fn numbers(&self, name: &str) -> &[f64] {
        let names = || self.0.keys().collect::<Vec<_>>();
        self.0
            .get(name)
            .unwrap_or_else(|| panic!("{name} in {:?}", names()))
    }

    pub(crate) fn vectors(&self, name: &str) -> Vec<Vector> {
        let numbers = self.numbers(name);
        numbers
            .chunks_exact(3)
            .map(Vector::from_column_slice)
            .collect()
    }

    /// Places in the reference configuration in m.
    pub(crate) fn reference(&self) -> Vec<Vector> {
        let moved = self.vectors("displacement [m]");
        let places = self.vectors("Points");
        places.iter().zip(&moved).map(|(x, u)| x - u).collect()
    }
}

pub(crate) fn request(input: PathBuf, output: &Path, set: &[&str]) -> CommandInput {
    CommandInput {
        command: "proboscis".to_owned(),
        input,
        set: set.iter().map(|&s| s.to_owned()).collect(),
        output: Some(output.to_owned()),
        max_seconds: None,
        max_iterations: None,
        from: None,
        wanted: None,
        figures: Figures::default(),
        progress: ProgressDisplay::Never,
        page: PageWanted::Written,
        once: false,
    }
}

/// A kept problem, with overrides.
fn kept(name: &str, output: &Path, set: &[&str]) -> CommandOutput {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    run(&request(folder.join(name), output, set)).unwrap()
}

/// A problem of a cube between two electrodes on rollers.
fn cube(folder: &Path, fixed: Value, task: &Value) -> CommandOutput {
    let scene = json!({
        "name": "cube",
        "materials": { "gel": {
            "density": "1000 kg/m^3", "shear_modulus": MU, "lame_lambda": LAMBDA,
            "relative_permittivity": 3.0, "dielectric": "ideal", "viscosity": "100 Pa s"
        } },
        "solids": [{
            "name": "cube", "material": "gel",
            "box": { "size": [EDGE, EDGE, EDGE], "elements": [2, 1, 2] },
            "electrodes": [
                { "name": "ground", "face": "z_min", "potential": "grounded" },
                { "name": "top", "face": "z_max", "potential": "driven" }
            ],
            "fixed": fixed
        }],
        "markers": [{ "name": "corner", "solid": "cube", "at": [EDGE, EDGE, EDGE] }]
    });
    fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    let mut problem = task.clone();
    problem["scene"] = json!("scene.json");
    let path = folder.join("problem.json");
    fs::write(&path, problem.to_string()).unwrap();
    run(&request(path, &folder.join("out"), &[])).unwrap()
}

fn assert_close(found: f64, expected: f64, scale: f64) {
    assert!(
        (found - expected).abs() < 1e-9 * scale,
        "{found} instead of {expected}"
    );
}

#[test]
fn a_homogeneous_cube_has_the_analytic_stress() {
    let folder = tempfile::tempdir().unwrap();
    // The thickness is held, so that the sides alone give way.
    let fixed = json!([
        { "face": "x_min", "directions": ["x"] }, { "face": "y_min", "directions": ["y"] },
        { "face": "z_min", "directions": ["z"] }, { "face": "z_max", "directions": ["z"] }
    ]);
    let voltage = 4e5;
    let task = json!({ "equilibrium": { "voltages": { "cube.top": voltage } } });
    let told = cube(folder.path(), fixed, &task);
    assert!(told.is_solved, "{told:?}");

    let fields = Fields::read(&folder.path().join("out/fields/0000.vtu"));
    let corner = fields
        .reference()
        .iter()
        .position(|x| x.min() > 0.99 * EDGE);
    let moved = fields.vectors("displacement [m]")[corner.unwrap()];
    let stretch = moved.map(|u| 1.0 + u / EDGE);
    assert!(
        stretch.x > 1.015 && (stretch.x - stretch.y).abs() < 1e-10,
        "{stretch}"
    );
    let j = stretch.product();
    let permittivity = 3.0 * VACUUM_PERMITTIVITY;
    let field = voltage / EDGE;
    let maxwell = 0.5 * permittivity * field * field;
    let elastic = |s: f64| MU / j * (s * s - 1.0) + LAMBDA * j.ln() / j;
    // Along the field tension, across it pressure.
    let along = elastic(stretch.z) + maxwell;
    let across = elastic(stretch.x) - maxwell;
    assert_close(across, 0.0, MU);
    let expected = Vector::new(across, across, along);
    for found in fields.numbers("stress [Pa]").chunks_exact(9) {
        for (i, value) in found.iter().enumerate() {
            let expected = if i % 4 == 0 { expected[i / 4] } else { 0.0 };
            assert_close(*value, expected, MU);
        }
    }
    for found in fields.numbers("J") {
        assert_close(*found, j, 1.0);
    }
    for found in fields.numbers("von Mises stress [Pa]") {
        assert_close(*found, (along - across).abs(), MU);
    }
    for found in fields.vectors("electric field [V/m]") {
        assert_close(found.z, -field, field);
        assert_close(found.x.hypot(found.y), 0.0, field);
    }
    for found in fields.vectors("electric displacement [C/m^2]") {
        assert_close(found.z, -permittivity * field, permittivity * field);
    }
    // One instant: nothing moves.
    assert!(!fields.has("velocity [m/s]"));
    assert!(
        fields
            .numbers("region")
            .iter()
            .chain(fields.numbers("block"))
            .all(|&x| x == 0.0)
    );

    // ε E A of the deformed faces.
    let summary = read(folder.path().join("out/summary.json"));
    let charge = permittivity * field * EDGE * EDGE * stretch.x * stretch.y;
    let of = |name: &str| summary["charges"][name].as_f64().unwrap();
    assert_close(of("cube.top"), charge, charge);
    assert_close(of("cube.ground"), -charge, charge);
    let nominal = summary["largest_nominal_field"].as_f64().unwrap();
    assert_close(nominal, field, field);
}

#[test]
fn displacements_are_the_state_and_electrodes_have_their_voltage() {
    let folder = tempfile::tempdir().unwrap();
    let set = [
        "scene.solids[0].box.elements=[1,2,8]",
        "simulate.duration=2 ms",
    ];
    let told = kept("clamped_stack_step.json", folder.path(), &set);
    assert!(told.is_solved, "{told:?}");
    let list = fs::read_to_string(folder.path().join("trajectory.pvd")).unwrap();
    let state = read(folder.path().join("solution.json"));
    let rows = state["state"]["z"].as_array().unwrap();
    assert_eq!(rows.len(), 5);
    let csv = fs::read_to_string(folder.path().join("trajectory.csv")).unwrap();
    let header: Vec<_> = csv.lines().nth(1).unwrap().split(',').collect();
    let column = header
        .iter()
        .position(|name| name.starts_with("top_x"))
        .unwrap();
    let mut before: Option<Vec<Vector>> = None;
    for (k, row) in rows.iter().enumerate() {
        let file = format!("fields/{k:04}.vtu");
        let time = 5e-4 * k as f64;
        assert!(list.contains(&format!("timestep=\"{time:?}\"")) && list.contains(&file));
        let fields = Fields::read(&folder.path().join(&file));
        let (reference, places) = (fields.reference(), fields.vectors("Points"));
        let z: Vec<f64> = row
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.as_f64().unwrap())
            .collect();
        let mut free = z.iter();
        let potentials = fields.numbers("potential [V]");
        for (n, at) in reference.iter().enumerate() {
            let is_top = at.z > 0.0399;
            for axis in 0..3 {
                let held = at.z < 1e-4 || is_top && axis < 2;
                let expected = if held {
                    1e3 * at[axis]
                } else {
                    *free.next().unwrap()
                };
                assert!((1e3 * places[n][axis] - expected).abs() < 1e-12);
            }
            let layer = at.z / EDGE;
            if (layer - layer.round()).abs() < 1e-6 {
                let is_driven = layer.round() as usize % 2 == 1;
                assert_eq!(potentials[n], if is_driven { 3e5 } else { 0.0 });
            } else {
                assert!(potentials[n] > 1e4 && potentials[n] < 2.9e5);
            }
        }
        assert!(free.next().is_none());
        if let Some(before) = before {
            let velocities = fields.vectors("velocity [m/s]");
            for ((x, was), v) in places.iter().zip(&before).zip(velocities) {
                assert!((v - (x - was) / 5e-4).norm() < 1e-9);
            }
        }
        // The marker is the node next to its place.
        let line = csv.lines().nth(2 + k).unwrap();
        let mark = line.split(',').skip(column).take(3);
        let mark = Vector::from_iterator(mark.map(|cell| cell.parse::<f64>().unwrap()));
        let place = Vector::new(0.005, 0.005, 0.04);
        let near = |x: &&Vector| (*x - place).norm();
        let nearest = reference.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
        let nearest = reference.iter().position(|x| Some(x) == nearest).unwrap();
        assert!((mark - 1e3 * places[nearest]).norm() < 1e-12);
        before = Some(places);
    }
}

#[test]
fn a_long_motion_of_a_passive_block_leaves_two_hundred_instants() {
    let folder = tempfile::tempdir().unwrap();
    let set = [
        "scene.solids[0].box.elements=[1,1,1]",
        "simulate.duration=0.25 s",
    ];
    // Files of an earlier run with more instants.
    fs::create_dir(folder.path().join("fields")).unwrap();
    fs::write(folder.path().join("fields/0200.vtu"), "old").unwrap();
    let told = kept("free_flight.json", folder.path(), &set);
    assert!(told.is_solved, "{told:?}");
    let list = fs::read_to_string(folder.path().join("trajectory.pvd")).unwrap();
    assert_eq!(list.matches("<DataSet").count(), 200);
    let files = fs::read_dir(folder.path().join("fields")).unwrap();
    assert_eq!(files.count(), 200);
    assert!(list.contains("timestep=\"0.0\"") && list.contains("timestep=\"0.25\""));
    let fields = Fields::read(&folder.path().join("fields/0199.vtu"));
    for name in ["potential [V]", "electric field [V/m]"] {
        assert!(!fields.has(name), "{name}");
    }
    assert!(
        fields
            .numbers("velocity [m/s]")
            .iter()
            .any(|v| v.abs() > 1e-3)
    );
    let summary = read(folder.path().join("summary.json"));
    assert_eq!(summary["instants_written"], 200);
    let size = json!({ "nodes": 8, "elements": 1, "unknowns": 24, "potentials": 0 });
    let blocks = summary["blocks"].as_object().unwrap();
    assert_eq!(blocks.values().collect::<Vec<_>>(), [&size]);
    assert!(summary["charges"].is_null());
}

#[test]
fn pictures_show_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let fixed = json!(["z_min"]);
    let task = json!({ "simulate": {
        "duration": "1 ms", "step": "0.5 ms", "voltages": { "cube.top": 2e5 } } });
    let told = cube(folder.path(), fixed, &task);
    assert!(told.is_solved, "{told:?}");
    let text = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    let svg = text("configuration.svg");
    // Three faces of the cube and its reference shape, cut where the potential changes.
    assert!(svg.matches("<polygon").count() > 40);
    assert!(svg.contains("voltage [kV]") && svg.contains("path of corner"));
    assert!(!svg.contains("NaN"));
    let page = text("report.html");
    assert!(page.contains("\"kind\":\"block\"") && page.contains("\"field\":"));
    assert!(text("charge.svg").contains("cube.top"));
    assert!(text("energy.svg").contains("block electroelasticity"));
}
