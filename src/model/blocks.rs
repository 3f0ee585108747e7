//! Blocks of a system: those of the scene, then one for each muscle of finite elements.

use crate::math::Matrix;
use crate::mesh::grid::Grid;
use crate::model::joints::triad;
use crate::model::presolved::{Presolved, clamp};
use crate::model::system::{Discretisation, Electrode, Fidelity, Glue, Muscle, Potential, Solid};
use nalgebra::Vector3;

/// All blocks, those of the scene taken out of the presolved system; every node of a muscle that nothing moves is held.
pub(super) fn blocks(presolved: &mut Presolved) -> Vec<Solid> {
    let of_scene = std::mem::take(&mut presolved.system.solids);
    let (system, immobile) = (&presolved.system, &presolved.immobile);
    let muscles = system.muscles.iter().enumerate();
    let of_muscles = muscles.filter_map(|(source, muscle)| match muscle.fidelity {
        Fidelity::Lumped => None,
        Fidelity::FiniteElements(discretisation) => {
            let mut solid = block(source, muscle, &discretisation);
            if immobile.muscles[source] {
                clamp(&mut solid);
            }
            Some(solid)
        }
    });
    of_scene.into_iter().chain(of_muscles).collect()
}

/// A muscle as a pile of layers, glued to both bodies. A layer of the model stands for many of the muscle: its voltage is
/// larger by the ratio of thicknesses, so that the field is the same.
fn block(source: usize, muscle: &Muscle, discretisation: &Discretisation) -> Solid {
    let Discretisation {
        elements,
        layers,
        element,
        first_side,
    } = *discretisation;
    let span = muscle.to.at - muscle.from.at;
    let (length, axis) = (span.norm(), span.normalize());
    let first = match first_side {
        Some(side) => (side - axis * axis.dot(&side)).normalize(),
        None => triad(&axis)[0],
    };
    let frame = Matrix::from_columns(&[first, axis.cross(&first), axis]);
    let stretches = muscle.stretches();
    let across = stretches.map_or(1.0, |[across, _]| across);
    let [a, b] = muscle.cross_section.map(|side| side * across);
    let corner = Vector3::new(-0.5 * a, -0.5 * b, 0.0);
    let grid = Grid::uniform(corner, Vector3::new(a, b, length), elements);
    let mesh = grid.mesh();
    let electrode = |layer: usize| {
        let place = length * layer as f64 / layers as f64;
        let driven = layer % 2 == 1;
        Electrode {
            name: format!("electrode{}", layer + 1),
            nodes: mesh.nodes_on_plane(2, place, 1e-9 * length),
            potential: match driven {
                true => Potential::Driven {
                    source,
                    factor: muscle.length() / layers as f64 / muscle.layer_thickness,
                },
                false => Potential::Given(0.0),
            },
            circuit: None,
        }
    };
    let is_dielectric = muscle.material.electric.is_some();
    let glue = |face: &str, body: Option<usize>| Glue {
        nodes: mesh.sets[face].clone(),
        body,
    };
    Solid {
        name: muscle.name.clone(),
        materials: vec![muscle.material],
        element,
        electrodes: match is_dielectric {
            true => (0..=layers).map(electrode).collect(),
            false => Vec::new(),
        },
        supports: Vec::new(),
        glued: vec![
            glue("z_min", muscle.from.body),
            glue("z_max", muscle.to.body),
        ],
        velocities: Vec::new(),
        prestretch: stretches.map(|[across, along]| {
            frame * Matrix::from_diagonal(&[across, across, along].into()) * frame.transpose()
        }),
        mesh: mesh.transformed(|x| muscle.from.at + frame * x),
    }
}
