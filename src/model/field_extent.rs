//! Extent of electric fields: elements that have one, and voltages that have an effect.

use crate::math::DisjointSets;
use crate::model::system::{Potential, Solid, System};
use std::collections::{BTreeSet, HashMap};

impl Solid {
    /// For each element, true if a field reaches it, provided that no voltage is zero all the time.
    pub fn elements_with_field(&self) -> Vec<bool> {
        dielectric(self)
    }
}

/// For each element, true if a field reaches it: its material has electric constants, and the dielectric part of the block that it
/// belongs to touches electrodes of different voltages. Electrodes that are held at a voltage part a block; a floating one
/// joins what it touches.
pub(super) fn dielectric(solid: &Solid) -> Vec<bool> {
    let mesh = &solid.mesh;
    let is: Vec<bool> = mesh
        .regions
        .iter()
        .map(|&region| solid.materials[region].electric.is_some())
        .collect();
    let mut held: HashMap<usize, Potential> = HashMap::new();
    for electrode in &solid.electrodes {
        for &node in &electrode.nodes {
            match electrode.potential {
                Potential::Floating => held.remove(&node),
                potential => held.insert(node, potential),
            };
        }
    }
    // Nodes, then elements.
    let count = mesh.nodes.len();
    let mut parts = DisjointSets::new(count + mesh.hexahedra.len());
    for (e, nodes) in mesh.hexahedra.iter().enumerate().filter(|(e, _)| is[*e]) {
        for &node in nodes.iter().filter(|node| !held.contains_key(node)) {
            parts.join(node, count + e);
        }
    }
    for electrode in &solid.electrodes {
        if electrode.potential == Potential::Floating {
            for pair in electrode.nodes.windows(2) {
                parts.join(pair[0], pair[1]);
            }
        }
    }
    let mut potentials: HashMap<usize, Vec<Potential>> = HashMap::new();
    for (e, nodes) in mesh.hexahedra.iter().enumerate().filter(|(e, _)| is[*e]) {
        for potential in nodes.iter().filter_map(|node| held.get(node)) {
            let seen = potentials.entry(parts.smallest(count + e)).or_default();
            if !seen.contains(potential) {
                seen.push(*potential);
            }
        }
    }
    let mut reached = |e: usize| {
        let seen = potentials.get(&parts.smallest(count + e));
        is[e] && seen.is_some_and(|seen| seen.len() > 1)
    };
    (0..mesh.hexahedra.len()).map(&mut reached).collect()
}

/// Sources whose voltages do something: of dielectric muscles, and of driven electrodes that a dielectric element touches.
pub(super) fn voltages(system: &System) -> Vec<usize> {
    let muscles = system.muscles.iter().enumerate();
    let muscles = muscles.filter(|(_, m)| m.material.electric.is_some());
    let mut voltages: Vec<usize> = muscles.map(|(m, _)| m).collect();
    for solid in &system.solids {
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
