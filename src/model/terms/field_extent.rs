//! Extent of electric fields: elements that have one, and voltages that have an effect.

use crate::math::DisjointSets;
use crate::model::components::{BlockLoad, Load, LoadPlace};
use crate::model::system::{Electrode, Potential, Solid, System};
use std::collections::{BTreeSet, HashMap};

impl Solid {
    /// Returns true if a charge on faces acts on potentials: on a dielectric that touches an electrode at a voltage, beside that electrode.
    pub fn takes_charge(&self, faces: &[Vec<usize>]) -> bool {
        let charged: BTreeSet<usize> = faces.concat().into_iter().collect();
        let held = |e: &&Electrode| e.potential != Potential::Floating;
        let held: BTreeSet<usize> = self
            .electrodes
            .iter()
            .filter(held)
            .flat_map(|e| e.nodes.clone())
            .collect();
        let elements = self.mesh.elements().zip(dielectric(self, &charged));
        let mut reached = elements
            .filter(|(_, has_field)| *has_field)
            .flat_map(|(nodes, _)| nodes);
        reached.any(|node| charged.contains(node) && !held.contains(node))
    }
}

impl System {
    /// For each element of a block, true if a field reaches it, provided that no input is zero all the time.
    pub fn elements_with_field(&self, block: usize) -> Vec<bool> {
        dielectric(&self.solids[block], &charged(self, block, &BTreeSet::new()))
    }
}

/// Nodes of a block of a scene that carry a surface charge, unless its input is zero all the time.
pub(crate) fn charged(
    scene: &System,
    block: usize,
    zero_inputs: &BTreeSet<usize>,
) -> BTreeSet<usize> {
    let nodes = |(source, load): (usize, &Load)| match &load.on {
        LoadPlace::Block {
            block: of,
            load: BlockLoad::Charge(faces),
        } if *of == block && !zero_inputs.contains(&source) => faces.concat(),
        _ => Vec::new(),
    };
    scene.loads().flat_map(nodes).collect()
}

/// For each element, true if a field reaches it: its material has electric constants, and the dielectric part of the block that it
/// belongs to touches electrodes of different voltages, or one and a `charged` node. Electrodes that are held at a voltage part a
/// block; a floating one joins what it touches. A triangle of a membrane has a field across it where one electrode covers it.
pub(crate) fn dielectric(solid: &Solid, charged: &BTreeSet<usize>) -> Vec<bool> {
    let mesh = &solid.mesh;
    let is: Vec<bool> = mesh
        .regions
        .iter()
        .map(|&region| solid.materials[region].electric.is_some())
        .collect();
    if solid.is_membrane() {
        let covers = |nodes: &[usize]| {
            let mut all = solid.electrodes.iter();
            all.any(|e| nodes.iter().all(|node| e.nodes.binary_search(node).is_ok()))
        };
        return mesh
            .elements()
            .zip(is)
            .map(|(nodes, is)| is && covers(nodes))
            .collect();
    }
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
    let mut parts = DisjointSets::new(count + mesh.element_count());
    for (e, nodes) in mesh.elements().enumerate().filter(|(e, _)| is[*e]) {
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
    for (e, nodes) in mesh.elements().enumerate().filter(|(e, _)| is[*e]) {
        for potential in nodes.iter().filter_map(|node| held.get(node)) {
            let seen = potentials.entry(parts.smallest(count + e)).or_default();
            if !seen.contains(potential) {
                seen.push(*potential);
            }
        }
    }
    let charged = charged.iter().filter(|node| !held.contains_key(node));
    let charged: BTreeSet<usize> = charged.map(|&node| parts.smallest(node)).collect();
    let mut reached = |e: usize| {
        let part = parts.smallest(count + e);
        let least = if charged.contains(&part) { 1 } else { 2 };
        let seen = potentials.get(&part);
        is[e] && seen.is_some_and(|seen| seen.len() >= least)
    };
    (0..mesh.element_count()).map(&mut reached).collect()
}

/// Sources whose voltages do something in a system with these charged nodes of each block: of dielectric muscles, and of driven electrodes that a dielectric element touches.
pub(crate) fn voltages(system: &System, charged: impl Fn(usize) -> BTreeSet<usize>) -> Vec<usize> {
    let muscles = system.muscles.iter().enumerate();
    let muscles = muscles.filter(|(i, m)| m.material.electric.is_some() && !system.is_charged(*i));
    let mut voltages: Vec<usize> = muscles.map(|(m, _)| m).collect();
    for (block, solid) in system.solids.iter().enumerate() {
        let is = dielectric(solid, &charged(block));
        let elements = solid.mesh.elements().zip(&is);
        let reached: BTreeSet<usize> = elements
            .filter(|(_, is)| **is)
            .flat_map(|(nodes, _)| nodes.iter().copied())
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
