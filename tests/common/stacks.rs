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
