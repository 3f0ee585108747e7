//! How far electric fields reach: which elements have one, and which voltages do something.

use crate::model::system::{Potential, Solid, System};
use std::collections::{BTreeSet, HashMap};

/// Whether a field reaches each element: its material has electric constants, and the dielectric part of the block that it
/// belongs to touches an electrode whose voltage is not the same everywhere.
pub(super) fn dielectric(solid: &Solid) -> Vec<bool> {
    let mesh = &solid.mesh;
    let mut is: Vec<bool> = mesh
        .regions
        .iter()
        .map(|&region| solid.materials[region].electric.is_some())
        .collect();
    let mut part: Vec<usize> = (0..mesh.nodes.len()).collect();
    fn root(part: &mut [usize], mut node: usize) -> usize {
        while part[node] != node {
            part[node] = part[part[node]];
            node = part[node];
        }
        node
    }
    let join = |part: &mut [usize], a: usize, b: usize| {
        let (a, b) = (root(part, a), root(part, b));
        part[a.max(b)] = a.min(b);
    };
    for (nodes, _) in mesh.hexahedra.iter().zip(&is).filter(|(_, is)| **is) {
        for &node in &nodes[1..] {
            join(&mut part, nodes[0], node);
        }
    }
    for electrode in &solid.electrodes {
        for pair in electrode.nodes.windows(2) {
            join(&mut part, pair[0], pair[1]);
        }
    }
    let mut potentials: HashMap<usize, Vec<Potential>> = HashMap::new();
    for electrode in &solid.electrodes {
        if electrode.potential != Potential::Floating {
            for &node in &electrode.nodes {
                let seen = potentials.entry(root(&mut part, node)).or_default();
                if !seen.contains(&electrode.potential) {
                    seen.push(electrode.potential);
                }
            }
        }
    }
    for (nodes, is) in mesh.hexahedra.iter().zip(&mut is) {
        let seen = potentials.get(&root(&mut part, nodes[0]));
        *is &= seen.is_some_and(|seen| seen.len() > 1);
    }
    is
}

/// Sources whose voltages do something: of dielectric muscles, and of driven electrodes that a dielectric element touches.
pub(super) fn voltages(system: &System, solids: &[Solid]) -> Vec<usize> {
    let muscles = system.muscles.iter().enumerate();
    let muscles = muscles.filter(|(_, m)| m.material.electric.is_some());
    let mut voltages: Vec<usize> = muscles.map(|(m, _)| m).collect();
    for solid in solids {
        let is = dielectric(solid);
        let elements = solid.mesh.hexahedra.iter().zip(&is);
        let reached: BTreeSet<usize> = elements
            .filter(|(_, is)| **is)
            .flat_map(|(nodes, _)| *nodes)
            .collect();
        for electrode in &solid.electrodes {
            if let Potential::Driven { source, .. } = electrode.potential
                && electrode.nodes.iter().any(|n| reached.contains(n))
                && !voltages.contains(&source)
            {
                voltages.push(source);
            }
        }
    }
    voltages
}
