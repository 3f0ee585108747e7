//! Masses and weights of elastic blocks.

use crate::energy::{KineticCoupling, KineticEnergy};
use crate::functional::Mass;
use crate::model::constants::constant::{Constant, MaterialConstant};
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::solids::Solids;
use crate::model::terms::{GRAVITY, Terms, mid, rate, weight};
use std::collections::BTreeMap;

const INERTIA: &str = "block inertia";

/// A density in g/mm³ of an element of a block, where it counts.
type Density<'a> = &'a dyn Fn(&SolidBlock, usize) -> Option<f64>;

impl Solids {
    /// Consistent masses, and the weight at each node.
    pub(crate) fn add_inertia(&self, terms: &mut Terms<'_>) {
        let of = |block: &SolidBlock, e: usize| block.constant(e, MaterialConstant::Density);
        let read = terms.sought().clone();
        let given = |block: &SolidBlock, e: usize| {
            let density = block.material(e).density;
            density.filter(|_| !read.is_sought(of(block, e)))
        };
        for (vector, mass) in self.weights(&given) {
            terms.weigh_vector(vector, mass);
        }
        if self.moving().next().is_none() {
            return;
        }
        if !terms.is_of_motion() {
            terms.without(INERTIA, "a state of rest has no inertia");
        } else {
            for (vectors, mass) in self.masses(&given) {
                terms.push(INERTIA, Mass { vectors, mass });
            }
            for block in self.moving().filter(|block| block.is_heavy()) {
                terms.note(INERTIA, "density of", &block.solid.name);
            }
            terms.without(INERTIA, "no elastic block names a density");
        }
        let mut sought = Vec::new();
        for (block, e) in self.elements() {
            let is_new = sought.iter().all(|(_, known)| *known != of(block, e));
            if is_new && read.is_sought(of(block, e)) {
                sought.push((block, of(block, e)));
            }
        }
        for (block, constant) in sought {
            let its = |block: &SolidBlock, e: usize| (of(block, e) == constant).then_some(1.0);
            self.add_sought_inertia(&block.solid.name, constant, &its, terms);
        }
    }

    /// Masses and weights of the elements that have a sought density, from those of the density one.
    fn add_sought_inertia(
        &self,
        name: &str,
        constant: Constant,
        one: Density<'_>,
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let density = read.constant(constant, 0.0);
        for (vector, mass) in self.weights(one) {
            let mut read = read.clone();
            if let Some(gravity) = terms.gravity(&mut read) {
                let law = weight(&density.scaled(mass), gravity);
                let element = read.element(law, [mid(vector)], []);
                terms.add_law(GRAVITY, "gravity of", "the scene", element);
            }
        }
        if !terms.is_of_motion() {
            return;
        }
        for ([a, b], mass) in self.masses(one) {
            let (mass, why) = (density.scaled(mass), "density of");
            if a == b {
                let law = KineticEnergy { mass };
                let element = read.clone().element(law, [rate(a)], []);
                terms.add_kinetic_law(INERTIA, why, name, element);
            } else {
                let law = KineticCoupling { mass };
                let element = read.clone().element(law, [rate(a), rate(b)], []);
                terms.add_kinetic_law(INERTIA, why, name, element);
            }
        }
    }

    fn moving(&self) -> impl Iterator<Item = &SolidBlock> {
        self.list.iter().filter(|block| !block.is_immobile)
    }

    /// Entries of the consistent mass matrix in g by pairs of vectors, of which the first is not the later one.
    fn masses(&self, density: Density<'_>) -> BTreeMap<[usize; 2], f64> {
        let mut sums = BTreeMap::new();
        for (c, e) in self.elements() {
            let Some(density) = density(c, e) else {
                continue;
            };
            let (nodes, mass) = (c.nodes(e), c.shapes[e].mass(density));
            for (i, &a) in nodes.iter().enumerate() {
                for (j, &b) in nodes.iter().enumerate().filter(|&(_, &b)| a <= b) {
                    *sums.entry([a, b]).or_default() += mass[i][j];
                }
            }
        }
        sums
    }

    /// Mass in g at each vector, as gravity sees it.
    fn weights(&self, density: Density<'_>) -> Vec<(usize, f64)> {
        let masses = |block: &SolidBlock| {
            let masses = block.integrals(|e| density(block, e)).into_iter();
            masses
                .map(|(node, mass)| (block.vectors[node], mass))
                .collect::<Vec<_>>()
        };
        self.moving().flat_map(masses).collect()
    }
}
