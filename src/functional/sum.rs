//! Sums of quantities of different formulas.

use crate::functional::{Couplings, Measure, Outer, Sample, SumDerivatives};
use crate::math::Vector;

/// A sum of quantities of one site, of which linear functions are taken.
#[derive(Debug)]
pub struct Sum {
    parts: Vec<Box<dyn Measure>>,
    /// Number of slots of each part.
    slots: Vec<usize>,
}

impl Sum {
    /// The sum of its parts.
    pub fn new(parts: Vec<Box<dyn Measure>>) -> Self {
        let slots = parts.iter().map(|part| {
            let mut slots = Vec::new();
            part.couple(&mut Couplings::default(), &mut slots);
            slots.len()
        });
        Self {
            slots: slots.collect(),
            parts,
        }
    }

    /// Number of slots of all parts.
    pub(super) fn slot_count(&self) -> usize {
        self.slots.iter().sum()
    }

    /// Numbers of all parts, in their order.
    fn all(&self, of: impl Fn(&dyn Measure) -> Vec<usize>) -> Vec<usize> {
        self.parts
            .iter()
            .flat_map(|part| of(part.as_ref()))
            .collect()
    }

    /// The same, each number once.
    fn each_once(&self, of: impl Fn(&dyn Measure) -> Vec<usize>) -> Vec<usize> {
        let mut all = self.all(of);
        all.sort_unstable();
        all.dedup();
        all
    }
}

impl Measure for Sum {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        self.parts
            .iter()
            .for_each(|part| part.couple(couplings, slots));
    }

    fn vectors(&self) -> Vec<usize> {
        self.all(|part| part.vectors())
    }

    fn scalars(&self) -> Vec<usize> {
        self.each_once(|part| part.scalars())
    }

    fn not_by_squares(&self) -> Vec<usize> {
        self.each_once(|part| part.not_by_squares())
    }

    fn reads(&self, side: usize) -> bool {
        self.parts.iter().any(|part| part.reads(side))
    }

    fn reads_rates(&self) -> bool {
        self.parts.iter().any(|part| part.reads_rates())
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        self.parts.iter().map(|part| part.value(sample)).sum()
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        self.parts.iter().map(|part| part.by_duration(sample)).sum()
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        for part in &self.parts {
            part.gradient(sample, forces, rows);
        }
    }

    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        mut slots: &[u32],
        out: &mut SumDerivatives,
    ) {
        debug_assert!(outer.curvature == 0.0, "parts do not couple");
        for (part, &count) in self.parts.iter().zip(&self.slots) {
            let own;
            (own, slots) = slots.split_at(count);
            part.add_function(outer, sample, own, out);
        }
    }
}
