//! Effects of elastic blocks: elements by kind, masses, loads.

use crate::element::Viscosity;
use crate::functional::{Effect, Hexahedra, Hexahedron, Mass, ViscousHexahedra, ViscousHexahedron};
use crate::model::Continuum;
use crate::model::continua::Continua;
use crate::model::effects::Effects;
use std::collections::BTreeMap;

impl Continua {
    /// Elements of all blocks of which anything is unknown, as pairs of block and element.
    fn elements(&self) -> impl Iterator<Item = (&Continuum, usize)> + '_ {
        self.list
            .iter()
            .filter(|continuum| !continuum.is_still)
            .flat_map(|continuum| (0..continuum.shapes.len()).map(move |e| (continuum, e)))
    }

    /// Elastic and dielectric elements.
    pub(super) fn add_elements(&self, effects: &mut Effects) {
        let passive = self.elements().filter(|(c, e)| !c.is_dielectric[*e]);
        let passive: Vec<_> = passive
            .map(|(c, e)| Hexahedron {
                shape: c.shapes[e].clone(),
                law: c.passive(e),
                nodes: c.nodes(e),
                terminals: (),
            })
            .collect();
        let dielectric = self.elements().filter(|(c, e)| c.is_dielectric[*e]);
        let dielectric: Vec<_> = dielectric
            .map(|(c, e)| Hexahedron {
                shape: c.shapes[e].clone(),
                law: c.dielectric(e),
                nodes: c.nodes(e),
                terminals: c.terminals(e),
            })
            .collect();
        let mut add = |count: usize, effect: Box<dyn Effect>| {
            if count > 0 {
                effects.push(effect);
            }
        };
        add(
            passive.len(),
            Box::new(Hexahedra::new("block elasticity", passive)),
        );
        add(
            dielectric.len(),
            Box::new(Hexahedra::new("block electroelasticity", dielectric)),
        );
    }

    /// Viscous elements.
    pub(super) fn add_viscosity(&self, effects: &mut Effects) {
        let viscous = |(c, e): (&Continuum, usize)| {
            let viscosity = c.material(e).viscosity?;
            Some(ViscousHexahedron {
                shape: c.shapes[e].clone(),
                law: Viscosity { viscosity },
                nodes: c.nodes(e),
            })
        };
        let viscous: Vec<_> = self.elements().filter_map(viscous).collect();
        if !viscous.is_empty() {
            effects.push(Box::new(ViscousHexahedra::new("block viscosity", viscous)));
        }
    }

    /// The consistent mass matrix of all blocks.
    pub(super) fn masses(&self) -> Vec<Mass> {
        let mut sums: BTreeMap<[usize; 2], f64> = BTreeMap::new();
        for (c, e) in self.elements() {
            let Some(density) = c.material(e).density else {
                continue;
            };
            let (nodes, mass) = (c.nodes(e), c.shapes[e].mass(density));
            for (i, &a) in nodes.iter().enumerate() {
                for (j, &b) in nodes.iter().enumerate().filter(|&(_, &b)| a <= b) {
                    *sums.entry([a, b]).or_default() += mass[i][j];
                }
            }
        }
        sums.into_iter()
            .map(|(vectors, mass)| Mass { vectors, mass })
            .collect()
    }

    /// Mass at each vector, as gravity sees it.
    pub(super) fn loads(&self) -> Vec<(usize, f64)> {
        let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
        for (c, e) in self.elements() {
            let Some(density) = c.material(e).density else {
                continue;
            };
            for (node, part) in c.nodes(e).into_iter().zip(c.shapes[e].loads()) {
                *sums.entry(node).or_default() += density * part;
            }
        }
        sums.into_iter().collect()
    }
}
