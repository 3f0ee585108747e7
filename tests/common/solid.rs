//! Elastic blocks written out by hand, in g, mm, ms, N, V.
#![allow(dead_code, reason = "each test file uses some of these")]

use nalgebra::Vector3;
use proboscis::dynamics::equilibrium;
use proboscis::mesh::Mesh;
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{
    ElectricConstants, Electrode, ElementKind, Material, Potential, Solid, Support, System,
    VACUUM_PERMITTIVITY,
};
use serde_json::Value;

/// A reference file of `tests/reference/fe`.
pub(crate) fn reference(name: &str) -> Value {
    let path = format!(
        "{}/tests/reference/fe/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Numbers of a list.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap().iter();
    list.map(|v| v.as_f64().unwrap()).collect()
}

/// The material of an entry of a reference file, whose viscosity is half of σ = η d.
pub(crate) fn material(entry: &Value) -> Material {
    let m = &entry["material"];
    let number = |key: &str| m[key].as_f64().unwrap();
    Material {
        density: Some(number("rho") * 1e-6),
        shear_modulus: number("mu") * 1e-6,
        lame_lambda: Some(number("lam") * 1e-6),
        electric: Some(ElectricConstants {
            c1: number("c1"),
            c2: number("c2"),
            permittivity: number("eps0"),
        }),
        viscosity: Some(2.0 * number("eta") * 1e-3).filter(|&eta| eta > 0.0),
        ..Material::default()
    }
}

/// The mesh of an entry of a reference file.
pub(crate) fn mesh(entry: &Value) -> Mesh {
    let of = |key: &str| numbers(&entry["mesh"][key]);
    let size = Vector3::from_vec(of("lengths")) * 1e3;
    let elements = of("elements")
        .iter()
        .map(|&n| n as usize)
        .collect::<Vec<_>>();
    Grid::uniform(Vector3::zeros(), size, elements.try_into().unwrap()).mesh()
}

/// A block of one material that nothing holds.
pub(crate) fn block(mesh: Mesh, material: Material) -> Solid {
    Solid {
        name: "block".into(),
        materials: vec![material],
        element: ElementKind::Hex8,
        mesh,
        ..Solid::default()
    }
}

/// Nodes of a face, held in some directions.
pub(crate) fn held(mesh: &Mesh, face: &str, held: [bool; 3]) -> Support {
    Support {
        nodes: mesh.sets[face].clone(),
        held,
    }
}

/// An electrode on a plane z = `place`.
pub(crate) fn electrode(mesh: &Mesh, name: &str, place: f64, potential: Potential) -> Electrode {
    Electrode {
        circuit: None,
        name: name.into(),
        nodes: mesh.nodes_on_plane(2, place, 1e-9),
        potential,
    }
}

/// The first source of a system without muscles.
pub(crate) const DRIVEN: Potential = Potential::Driven {
    source: 0,
    factor: 1.0,
};

/// A system of blocks alone.
pub(crate) fn system(solids: Vec<Solid>) -> System {
    System {
        components: Default::default(),
        name: "blocks".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        muscles: Vec::new(),
        solids,
        markers: Vec::new(),
        gravity: None,
    }
}

/// Case A of the reference: rollers on three faces, potentials 0 and V at both ends of z.
pub(crate) fn homogeneous(entry: &Value) -> System {
    let mesh = mesh(entry);
    let height = mesh.bounds().1.z;
    let mut solid = block(mesh, material(entry));
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "x_min", [true, false, false]),
        held(mesh, "y_min", [false, true, false]),
        held(mesh, "z_min", [false, false, true]),
    ];
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        electrode(mesh, "top", height, DRIVEN),
    ];
    system(vec![solid])
}

/// Cases B and D: four layers with alternating electrodes, clamped below, free along z alone above.
pub(crate) fn stack(entry: &Value) -> System {
    let mut solid = block(mesh(entry), material(entry));
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "z_min", [true; 3]),
        held(mesh, "z_max", [true, true, false]),
    ];
    solid.electrodes = (0..5)
        .map(|layer| {
            let potential = if layer % 2 == 1 {
                DRIVEN
            } else {
                Potential::Given(0.0)
            };
            electrode(mesh, &format!("e{layer}"), 10.0 * layer as f64, potential)
        })
        .collect();
    system(vec![solid])
}

/// An elastic dielectric without density and viscosity.
pub(crate) fn dielectric(
    shear_modulus: f64,
    lame_lambda: f64,
    electric: ElectricConstants,
) -> Material {
    Material {
        density: None,
        shear_modulus,
        lame_lambda: Some(lame_lambda),
        electric: Some(electric),
        viscosity: None,
        ..Material::default()
    }
}

/// The published material set (docs/theory.md, 2.5) with a viscosity in MPa ms.
pub(crate) fn published(viscosity: Option<f64>) -> Material {
    let electric = ElectricConstants {
        c1: 5e-8,
        c2: 1e-9,
        permittivity: 8.854e-12,
    };
    Material {
        density: Some(1.0),
        viscosity,
        ..dielectric(233.0, 999.8, electric)
    }
}

/// Places of the nodes of the first block at the coordinates of an instant.
pub(crate) fn placed(model: &Model, z: &[f64]) -> Vec<Vector3<f64>> {
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(z);
    model.action.map.place(&mut instant);
    model.solids[0].places(&instant.x)
}

/// Places of the nodes of the first block at rest under voltages, on the path from the reference.
pub(crate) fn at_rest(system: System, voltages: &[f64]) -> Vec<Vector3<f64>> {
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), voltages).unwrap();
    assert_eq!(found.is_stable(), Some(true));
    placed(&model, &found.z)
}

/// A voltage whose mean field over the block is about 0.4 √(μ/ε_r ε₀).
pub(crate) const VOLTAGE: f64 = 4.9e5;

fn silicone(viscosity: Option<f64>) -> Material {
    let electric = ElectricConstants {
        c1: -2.0 * VACUUM_PERMITTIVITY,
        c2: VACUUM_PERMITTIVITY,
        permittivity: VACUUM_PERMITTIVITY,
    };
    Material {
        density: Some(1e-3),
        viscosity,
        ..dielectric(0.1, 0.5, electric)
    }
}

/// A crooked block of 2 × 2 × 4 elements under a voltage along z, with a floating electrode inside.
pub(crate) fn crooked(viscosity: Option<f64>) -> Solid {
    let size = Vector3::new(10.0, 10.0, 20.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [2, 2, 4]).mesh();
    let mut solid = block(mesh, silicone(viscosity));
    let mesh = &solid.mesh;
    let mut island = mesh.nodes_on_plane(2, 10.0, 1e-9);
    island.retain(|&n| mesh.nodes[n].x < 6.0);
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        Electrode {
            circuit: None,
            name: "island".into(),
            nodes: island,
            potential: Potential::Floating,
        },
        electrode(mesh, "top", 20.0, DRIVEN),
    ];
    let bent = |x: Vector3<f64>| {
        let (s, c) = (0.2 * x.z + 0.3 * x.x).sin_cos();
        x + Vector3::new(0.5 * s, 0.6 * c, 0.4 * s * c)
    };
    solid.mesh = solid.mesh.transformed(bent);
    solid
}

/// The same, clamped below.
pub(crate) fn clamped(viscosity: Option<f64>) -> Solid {
    let mut solid = crooked(viscosity);
    solid.supports = vec![held(&solid.mesh, "z_min", [true; 3])];
    solid
}
