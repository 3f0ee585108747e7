//! The block of dielectric finite elements that several measurements share.

use nalgebra::Vector3;
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{
    ElectricConstants, Electrode, ElementKind, Material, Potential, Solid, Support, System,
    VACUUM_PERMITTIVITY,
};

/// A block of n × n × 4n elements of 10 × 10 × 40 mm with four layers, fixed below.
pub(crate) fn block(n: usize, viscosity: Option<f64>) -> System {
    long_block([n, n, 4 * n], viscosity)
}

/// The same of other numbers of elements.
pub(crate) fn long_block(counts: [usize; 3], viscosity: Option<f64>) -> System {
    let mesh = Grid::uniform(Vector3::zeros(), Vector3::new(10.0, 10.0, 40.0), counts).mesh();
    let electrode = |layer: usize| Electrode {
        circuit: None,
        name: format!("e{layer}"),
        nodes: mesh.nodes_on_plane(2, 10.0 * layer as f64, 1e-9),
        potential: match layer % 2 {
            0 => Potential::Given(0.0),
            _ => Potential::Driven {
                source: 0,
                factor: 1.0,
            },
        },
    };
    let material = Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(0.4),
        electric: Some(ElectricConstants {
            c1: -2.0 * VACUUM_PERMITTIVITY,
            c2: VACUUM_PERMITTIVITY,
            permittivity: VACUUM_PERMITTIVITY,
        }),
        viscosity,
        ..Material::default()
    };
    let solid = Solid {
        name: "block".into(),
        materials: vec![material],
        element: ElementKind::Hex8,
        electrodes: (0..5).map(electrode).collect(),
        supports: vec![Support {
            nodes: mesh.sets["z_min"].clone(),
            held: [true; 3],
        }],
        mesh,
        ..Solid::default()
    };
    System {
        components: Default::default(),
        name: "block".into(),
        bodies: Vec::new(),
        joints: Vec::new(),
        muscles: Vec::new(),
        solids: vec![solid],
        markers: Vec::new(),
        gravity: None,
    }
}
