//! Blocks of 40 mm with electrodes across them, fixed below.
#![allow(dead_code, reason = "each test program uses some of these")]

use crate::common::solid::{DRIVEN, block, electrode, held};
use nalgebra::Vector3;
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{
    ElectricConstants, Material, Potential, Solid, VACUUM_PERMITTIVITY,
};

/// Length of the blocks in mm.
pub(crate) const LENGTH: f64 = 40.0;

/// Rubber of 100 kPa.
pub(crate) fn rubber(lame_lambda: f64, viscosity: Option<f64>) -> Material {
    Material {
        density: Some(1e-3),
        shear_modulus: 0.1,
        lame_lambda: Some(lame_lambda),
        electric: Some(ElectricConstants {
            c1: -2.0 * VACUUM_PERMITTIVITY,
            c2: VACUUM_PERMITTIVITY,
            permittivity: VACUUM_PERMITTIVITY,
        }),
        viscosity,
        ..Material::default()
    }
}

/// A block of 10 × 10 × 40 mm with electrodes across it, fixed below.
pub(crate) fn stack(grid: &Grid, electrodes: &[f64], material: Material) -> Solid {
    let mut solid = block(grid.mesh(), material);
    let mesh = &solid.mesh;
    solid.electrodes = (electrodes.iter().enumerate())
        .map(|(e, &place)| {
            let potential = match e % 2 {
                0 => Potential::Given(0.0),
                _ => DRIVEN,
            };
            electrode(mesh, &format!("e{e}"), place, potential)
        })
        .collect();
    solid.supports = vec![held(mesh, "z_min", [true; 3])];
    solid
}

/// The same of cubes, n across, in four layers.
pub(crate) fn cubes(n: usize, material: Material) -> Solid {
    let size = Vector3::new(10.0, 10.0, LENGTH);
    let grid = Grid::uniform(Vector3::zeros(), size, [n, n, 4 * n]);
    stack(&grid, &[0.0, 10.0, 20.0, 30.0, 40.0], material)
}

/// Twelve layers of 0.5 mm below elements ten times as high, five elements across.
pub(crate) fn thin_layers() -> Solid {
    let layers = vec![(6.0, 12), (34.0, 7)];
    let size = Vector3::new(10.0, 10.0, LENGTH);
    let across = || vec![(10.0, 5)];
    let grid = Grid::layers(Vector3::zeros(), size, [across(), across(), layers]).unwrap();
    stack(&grid, &[0.0, 1.5, 3.0, 4.5, 6.0], rubber(0.4, Some(0.5)))
}

/// Cubes, three across, on three faces that slide, beside those that are fixed.
pub(crate) fn sliding() -> Solid {
    let mut solid = cubes(3, rubber(0.3, None));
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "x_min", [true, false, false]),
        held(mesh, "y_min", [false, true, false]),
        held(mesh, "z_min", [false, false, true]),
    ];
    solid.mesh = (solid.mesh).transformed(|x| x + Vector3::new(20.0, 0.0, 0.0));
    solid
}

/// The same block with its nodes and elements in another order, and nodes inside elsewhere by a part of the distance to their neighbours: no box.
pub(crate) fn scattered(mut solid: Solid, part: f64) -> Solid {
    let mesh = &mut solid.mesh;
    let count = mesh.nodes.len();
    // Without a common divisor with the number of nodes every number is taken once.
    let stride = (count / 3..).find(|stride| gcd(*stride, count) == 1);
    let new = |old: usize| old * stride.unwrap() % count;
    let mut at_surface = vec![false; count];
    for &node in ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]
        .iter()
        .flat_map(|face| &mesh.sets[*face])
        .chain(solid.electrodes.iter().flat_map(|e| &e.nodes))
    {
        at_surface[node] = true;
    }
    let mut edges = vec![f64::INFINITY; count];
    for nodes in &mesh.hexahedra {
        for &a in nodes {
            for &b in nodes.iter().filter(|&&b| b != a) {
                edges[a] = edges[a].min((mesh.nodes[a] - mesh.nodes[b]).norm());
            }
        }
    }
    let mut nodes = mesh.nodes.clone();
    for (old, place) in mesh.nodes.iter().enumerate() {
        let inside = f64::from(u8::from(!at_surface[old]));
        let way = [0.0, 2.0, 4.0].map(|phase| (old as f64 * 12.9898 + phase).sin());
        nodes[new(old)] = place + Vector3::from(way) * (inside * part * edges[old]);
    }
    mesh.nodes = nodes;
    mesh.hexahedra = (mesh.hexahedra.iter())
        .map(|nodes| nodes.map(new))
        .collect();
    mesh.hexahedra.reverse();
    mesh.regions.reverse();
    let renumber = |list: &mut Vec<usize>| {
        list.iter_mut().for_each(|node| *node = new(*node));
        list.sort_unstable();
    };
    mesh.sets.values_mut().for_each(renumber);
    let electrodes = solid.electrodes.iter_mut().map(|e| &mut e.nodes);
    let supports = solid.supports.iter_mut().map(|s| &mut s.nodes);
    electrodes.chain(supports).for_each(renumber);
    solid
}

fn gcd(a: usize, b: usize) -> usize {
    match b {
        0 => a,
        _ => gcd(b, a % b),
    }
}
