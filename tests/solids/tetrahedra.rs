//! Quadratic tetrahedra: against FElupe, closed forms and hexahedra, in motion, and from files.

use crate::common::solid::{
    block, clamped, crooked, held, homogeneous, numbers, placed, reference, system,
};
use crate::common::stacks::{cubes, rubber};
use crate::multigrid::compare;
use nalgebra::Vector3;
use proboscis::dynamics::{Start, equilibrium, observations, simulate};
use proboscis::mesh::cell::Cell;
use proboscis::mesh::grid::Grid;
use proboscis::mesh::{Mesh, gmsh};
use proboscis::model::Model;
use proboscis::model::components::{BlockLoad, Load, LoadPlace};
use proboscis::model::system::{ElementKind, Material, Solid, Support, System};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;

fn places(value: &Value) -> Vec<Vector3<f64>> {
    let rows = value.as_array().unwrap().iter();
    rows.map(|row| Vector3::from_vec(numbers(row))).collect()
}

fn indices(value: &Value) -> Vec<usize> {
    numbers(value).into_iter().map(|n| n as usize).collect()
}

/// The same block of tetrahedra.
fn in_tetrahedra(mut solid: Solid) -> Solid {
    solid.element = match solid.element {
        ElementKind::Hex8 => ElementKind::Tet10,
        _ => ElementKind::Tet10P2P0,
    };
    let first = solid.mesh.nodes.len();
    solid.mesh = solid.mesh.in_tetrahedra();
    // The middle of an edge belongs to what has both ends.
    let ends: Vec<_> = solid
        .mesh
        .tetrahedra
        .iter()
        .flat_map(|nodes| {
            let pairs = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];
            (0..6).map(move |edge| (nodes[4 + edge], pairs[edge].map(|corner| nodes[corner])))
        })
        .collect();
    let more = |nodes: &mut Vec<usize>| {
        let middles = ends
            .iter()
            .filter(|(_, ends)| ends.iter().all(|end| nodes.contains(end)));
        let middles: Vec<_> = middles.map(|(middle, _)| *middle).collect();
        nodes.extend(middles);
        nodes.sort_unstable();
        nodes.dedup();
    };
    assert!(solid.mesh.nodes.len() > first);
    solid
        .electrodes
        .iter_mut()
        .for_each(|electrode| more(&mut electrode.nodes));
    solid
        .supports
        .iter_mut()
        .for_each(|support| more(&mut support.nodes));
    solid
}

#[test]
fn a_crooked_block_is_that_of_felupe() {
    let known = reference("tetrahedra");
    let number = |key: &str| known[key].as_f64().unwrap();
    let elements = known["tetrahedra"].as_array().unwrap().iter();
    let tetrahedra: Vec<[usize; 10]> = elements.map(|e| indices(e).try_into().unwrap()).collect();
    let mesh = Mesh {
        nodes: places(&known["nodes"]),
        regions: vec![0; tetrahedra.len()],
        tetrahedra,
        region_names: vec!["all".into()],
        ..Mesh::default()
    };
    let faces = mesh.faces_of(&indices(&known["upper"]));
    let traction = Vector3::from_vec(numbers(&known["traction"]));
    let pressure = BlockLoad::Pressure {
        faces: faces.clone(),
        follows: true,
    };
    let along = BlockLoad::Traction(faces, traction.normalize());
    for (name, load, size, element, lambda) in [
        (
            "following",
            pressure,
            number("pressure"),
            ElementKind::Tet10,
            number("lambda"),
        ),
        (
            "traction",
            along.clone(),
            traction.norm(),
            ElementKind::Tet10,
            number("lambda"),
        ),
        (
            "mean",
            along,
            traction.norm(),
            ElementKind::Tet10P2P0,
            number("stiff"),
        ),
    ] {
        let material = Material {
            density: None,
            shear_modulus: number("mu"),
            lame_lambda: Some(lambda),
            ..Material::default()
        };
        let mut solid = block(mesh.clone(), material);
        solid.element = element;
        solid.supports = vec![Support {
            nodes: indices(&known["clamped"]),
            held: [true; 3],
        }];
        let mut system = system(vec![solid]);
        system.components.loads = vec![Load {
            name: "load".into(),
            on: LoadPlace::Block { block: 0, load },
        }];
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[size]).unwrap();
        assert_eq!(found.is_stable(), Some(true), "{name}");
        let expected = places(&known["displacements"][name]);
        let largest = expected.iter().map(Vector3::amax).fold(0.0, f64::max);
        let moved = placed(&model, &found.z).into_iter().zip(&mesh.nodes);
        let errors = moved.zip(&expected).map(|((x, at), u)| (x - at - u).amax());
        let error = errors.fold(0.0, f64::max);
        assert!(error < 1e-9 * largest, "{name}: {error:e} of {largest}");
    }
}

/// A uniform field and stretch, which both kinds have exactly.
#[test]
fn a_uniform_state_is_that_of_hexahedra() {
    let known = reference("caseA");
    let entry = &known["fe"][0];
    let scene = homogeneous(entry);
    let voltage = entry["V"].as_f64().unwrap();
    let rest = |system: System| {
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[voltage]).unwrap();
        placed(&model, &found.z)
    };
    let hexahedra = rest(scene.clone());
    let mut tetrahedra = scene.clone();
    tetrahedra.solids[0] = in_tetrahedra(scene.solids[0].clone());
    let moved = rest(tetrahedra);
    let (mut error, mut largest) = (0.0_f64, 0.0_f64);
    for ((a, b), at) in hexahedra
        .iter()
        .zip(&moved)
        .zip(&scene.solids[0].mesh.nodes)
    {
        error = error.max((a - b).amax());
        largest = largest.max((a - at).amax());
    }
    assert!(
        largest > 0.0 && error < 1e-9 * largest,
        "{error:e} of {largest:e}"
    );
}

fn thrown(mut solid: Solid) -> Solid {
    let spin = Vector3::new(0.02, -0.03, 0.05);
    let nodes = solid.mesh.nodes.iter();
    solid.velocities = nodes
        .map(|x| Vector3::new(0.1, 0.0, -0.05) + spin.cross(x))
        .collect();
    solid.electrodes.clear();
    solid
}

#[test]
fn a_block_in_flight_keeps_its_momenta_and_its_energy() {
    let solid = thrown(in_tetrahedra(crooked(None)));
    let model = Model::new(system(vec![solid]), None, 0.1, &[]).unwrap();
    let start = Start::with_rates(
        &model,
        model.coordinates_at(&[]),
        &model.node_rates().unwrap(),
    );
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 0.1, 200, |_, _| vec![], go_on);
    assert_eq!(failure, None);
    let seen = observations(&model, &discrete);
    for column in seen
        .columns
        .iter()
        .filter(|column| column.name.contains("momentum"))
    {
        let values = &column.values;
        let largest = values
            .iter()
            .fold(1e-9_f64, |most, value| most.max(value.abs()));
        let drift = values
            .iter()
            .map(|value| (value - values[1]).abs())
            .fold(0.0, f64::max);
        assert!(
            drift < 1e-9 * largest.max(1.0),
            "{}: {drift:e} of {largest:e}",
            column.name
        );
    }
    let total = seen
        .columns
        .iter()
        .find(|column| column.name == "total_energy")
        .unwrap();
    let first = total.values[1];
    let drift = total.values[1..]
        .iter()
        .map(|e| (e - first).abs())
        .fold(0.0, f64::max);
    assert!(drift < 1e-2 * first.abs(), "{drift:e} of {first}");
}

#[test]
fn a_curved_block_falls_without_a_strain() {
    let mut solid = in_tetrahedra(crooked(Some(0.5)));
    solid.electrodes.clear();
    let mut system = system(vec![solid]);
    system.gravity = Some(Vector3::new(0.0, 0.0, -9.81e-3));
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 1.0, 50, |_, _| vec![], go_on);
    assert_eq!(failure, None);
    let nodes = &model.solids[0].solid.mesh.nodes;
    let last = placed(&model, discrete.z.last().unwrap());
    let fallen = Vector3::new(0.0, 0.0, -0.5 * 9.81e-3 * 50.0 * 50.0);
    let error = last
        .iter()
        .zip(nodes)
        .map(|(x, at)| (x - at - fallen).amax());
    let error = error.fold(0.0, f64::max);
    assert!(error < 1e-9 * fallen.norm(), "{error:e}");
}

#[test]
fn multigrid_moves_tetrahedra_as_factors_do() {
    for viscosity in [None, Some(1.0)] {
        let solid = in_tetrahedra(cubes(2, rubber(0.4, viscosity)));
        compare(&system(vec![solid]), (0.5, 3), 2e5);
    }
}

fn file(name: &str) -> Mesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/meshes")
        .join(name);
    gmsh::read(&path, 1.0).unwrap()
}

#[test]
fn one_mesh_of_gmsh_in_every_format() {
    let mesh = file("bar_41.msh");
    assert_eq!((mesh.nodes.len(), mesh.tetrahedra.len()), (147, 60));
    for other in ["bar_22.msh", "bar_22b.msh", "bar_41b.msh"] {
        let other = file(other);
        assert_eq!(
            (&mesh.tetrahedra, &mesh.sets),
            (&other.tetrahedra, &other.sets)
        );
        let apart = mesh
            .nodes
            .iter()
            .zip(&other.nodes)
            .map(|(a, b)| (a - b).amax());
        assert!(apart.fold(0.0, f64::max) < 1e-12);
    }
    // Faces that are planes keep them when linear elements are raised.
    let raised = file("bar_linear.msh");
    assert_eq!((raised.nodes.len(), raised.tetrahedra.len()), (147, 60));
    let sorted = |mesh: &Mesh, set: &str| {
        let places = mesh.sets[set].iter().map(|&node| mesh.nodes[node]);
        let mut places: Vec<_> = places
            .map(|x| [x.x, x.y, x.z].map(|x| (1e6 * x).round() as i64))
            .collect();
        places.sort_unstable();
        places
    };
    for set in ["left", "right", "top"] {
        assert_eq!(sorted(&mesh, set), sorted(&raised, set), "{set}");
        let area: f64 = mesh
            .areas_of(&mesh.faces_of(&mesh.sets[set]))
            .values()
            .sum();
        let exact = if set == "top" { 40.0 } else { 16.0 };
        assert!((area - exact).abs() < 1e-10, "{set}: {area}");
    }
}

#[test]
fn hexahedra_in_binary_and_a_mixture() {
    let [text, binary] = ["hexes_41.msh", "hexes_41b.msh"].map(file);
    assert_eq!(text.hexahedra.len(), 8);
    assert_eq!(
        (&text.hexahedra, &text.sets),
        (&binary.hexahedra, &binary.sets)
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/mixed.msh");
    let error = gmsh::read(&path, 1.0).unwrap_err().to_string();
    assert!(
        error.contains("found a 5-node pyramid (type 7), expected 8-node hexahedra"),
        "{error}"
    );
    let text = std::fs::read_to_string(path).unwrap();
    // Without the block of the pyramid.
    let mut lines: Vec<&str> = text.lines().collect();
    let at = lines
        .iter()
        .position(|line| line.starts_with("3 ") && line.ends_with(" 7 1"))
        .unwrap();
    lines.drain(at..at + 2);
    let start = lines.iter().position(|line| *line == "$Elements").unwrap() + 1;
    let counts: Vec<usize> = lines[start]
        .split(' ')
        .map(|n| n.parse().unwrap())
        .collect();
    let head = format!(
        "{} {} {} {}",
        counts[0] - 1,
        counts[1] - 1,
        counts[2],
        counts[3]
    );
    lines[start] = &head;
    let error = gmsh::parse(lines.join("\n").as_bytes(), "m.msh", 1.0)
        .unwrap_err()
        .to_string();
    assert!(error.contains(" beside a "), "{error}");
    assert!(error.contains("expected elements of one kind"), "{error}");
}

/// Cook's membrane: a tapered panel that is clamped on its left and sheared on its right, one element thick between plates.
fn cook(n: usize, element: ElementKind, ratio: f64) -> Solid {
    let grid = Grid::uniform(Vector3::zeros(), Vector3::repeat(1.0), [n, n, 1]);
    let mut mesh = grid.mesh().transformed(|x| {
        let height = 44.0 + (16.0 - 44.0) * x.x;
        Vector3::new(48.0 * x.x, 44.0 * x.x + height * x.y, 4.0 * x.z)
    });
    if element.cell() == Cell::Tetrahedron {
        mesh = mesh.in_tetrahedra();
    }
    let material = Material {
        density: None,
        shear_modulus: 0.1,
        lame_lambda: Some(0.1 * ratio),
        ..Material::default()
    };
    let mut solid = block(mesh, material);
    solid.element = element;
    let flat = [false, false, true];
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "x_min", [true; 3]),
        held(mesh, "z_min", flat),
        held(mesh, "z_max", flat),
    ];
    solid
}

fn tip(n: usize, element: ElementKind, ratio: f64) -> f64 {
    let solid = cook(n, element, ratio);
    let faces = solid.mesh.faces_of(&solid.mesh.sets["x_max"]);
    let corner = Vector3::new(48.0, 60.0, 0.0);
    let node = solid.mesh.nearest_node(&corner).unwrap();
    let mut system = system(vec![solid]);
    system.components.loads = vec![Load {
        name: "shear".into(),
        on: LoadPlace::Block {
            block: 0,
            load: BlockLoad::Traction(faces, Vector3::y()),
        },
    }];
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[0.01]).unwrap();
    placed(&model, &found.z)[node].y - corner.y
}

#[test]
fn cooks_membrane_does_not_lock() {
    let known = tip(24, ElementKind::Hex8Q1P0, 1e4);
    let errors = [3, 6, 12].map(|n| (tip(n, ElementKind::Tet10P2P0, 1e4) - known).abs() / known);
    let locked = (tip(6, ElementKind::Hex8, 1e4) - known).abs() / known;
    println!("{known}: {errors:?}, {locked}");
    assert!(
        errors[0] < 0.05 && errors[1] < 0.02 && errors[2] < 0.01,
        "{errors:?}"
    );
    assert!(locked > 0.2, "{locked}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut solid = in_tetrahedra(clamped(None));
    solid.element = ElementKind::Hex8;
    let error = system(vec![solid.clone()]).check().unwrap_err().to_string();
    assert!(
        error.contains("expected one of tetrahedra, of which the mesh consists"),
        "{error}"
    );
    solid.element = ElementKind::Tet10;
    solid.mesh.hexahedra = vec![[0, 1, 2, 3, 4, 5, 6, 7]];
    let error = solid.mesh.check().unwrap_err().to_string();
    assert!(error.contains("expected elements of one kind"), "{error}");
    let mut mesh = file("bar_41.msh");
    mesh.tetrahedra[3].swap(0, 1);
    let error = mesh.check().unwrap_err().to_string();
    assert!(
        error.starts_with("tetrahedron 3: found an inverted element"),
        "{error}"
    );
}
