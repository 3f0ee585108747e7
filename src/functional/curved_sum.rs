//! Curved functions of a sum of quantities: all that its parts read couples.

use crate::functional::{Couplings, Horizon, Measure, Outer, Sample, SumDerivatives};
use crate::math::Vector;
use std::sync::{Mutex, PoisonError};

/// Storage of the gradient of a sum.
#[derive(Debug)]
struct Gradient {
    forces: [Vec<Vector>; 2],
    rows: Vec<f64>,
}

/// A sum of quantities of one site, of which curved functions are taken: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.
#[derive(Debug)]
pub struct CurvedSum {
    sum: Sum,
    /// Vectors and scalars that it reads, each once.
    vectors: Vec<usize>,
    scalars: Vec<usize>,
    gradient: Mutex<Gradient>,
}

impl CurvedSum {
    /// The sum of parts.
    pub fn new(parts: Vec<Box<dyn Measure>>) -> Self {
        let sum = Sum::new(parts);
        let (mut vectors, scalars) = (sum.vectors(), sum.scalars());
        vectors.sort_unstable();
        vectors.dedup();
        let count = |list: &[usize]| list.last().map_or(0, |last| last + 1);
        let zeros = || vec![Vector::zeros(); count(&vectors)];
        Self {
            gradient: Mutex::new(Gradient {
                forces: [zeros(), zeros()],
                rows: vec![0.0; count(&scalars)],
            }),
            sum,
            vectors,
            scalars,
        }
    }

    /// Pairs of its scalars, each once, the later one first.
    fn pairs_of_scalars(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let scalars = self.scalars.iter().enumerate();
        scalars.flat_map(|(i, &s)| self.scalars[..=i].iter().map(move |&t| (s, t)))
    }

    /// Adds the curvature times ∇m ∇mᵀ.
    fn add_square(
        &self,
        curvature: f64,
        g: &Gradient,
        sample: &Sample<'_>,
        slots: &[u32],
        out: &mut SumDerivatives,
    ) {
        let mut slots = slots.iter().map(|&slot| slot as usize);
        let mut next = || slots.next().expect("a slot of each pair");
        for &a in &self.vectors {
            for &b in &self.vectors {
                let block = &mut out.blocks.full[next()];
                for (side, sum) in block.iter_mut().enumerate() {
                    if sample.sides.blocks[side] {
                        let (row, column) = (g.forces[side / 2][a], g.forces[side % 2][b]);
                        *sum += row * column.transpose() * curvature;
                    }
                }
            }
            for &s in &self.scalars {
                let mixed = &mut out.blocks.mixed[next()];
                for (sum, force) in mixed.iter_mut().zip(&g.forces) {
                    *sum += force[a] * (curvature * g.rows[s]);
                }
            }
        }
        for (s, t) in self.pairs_of_scalars() {
            out.blocks.scalars[next()] += curvature * g.rows[s] * g.rows[t];
        }
        if sample.horizon == Horizon::Free && self.sum.reads_rates() {
            let by_duration = self.sum.by_duration(sample);
            let factor = curvature * by_duration;
            for (sums, force) in out.horizon_forces.iter_mut().zip(&g.forces) {
                self.vectors
                    .iter()
                    .for_each(|&a| sums[a] += force[a] * factor);
            }
            let rows = &mut out.horizon_rows;
            self.scalars
                .iter()
                .for_each(|&s| rows[s] += g.rows[s] * factor);
            out.horizon += factor * by_duration;
        }
    }
}

impl Measure for CurvedSum {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        self.sum.couple(couplings, slots);
        for &a in &self.vectors {
            let with_vectors = self.vectors.iter();
            slots.extend(with_vectors.map(|&b| couplings.add_full(a, b) as u32));
            let with_scalars = self.scalars.iter();
            slots.extend(with_scalars.map(|&s| couplings.add_mixed(a, s) as u32));
        }
        let pairs = self.pairs_of_scalars();
        slots.extend(pairs.map(|(s, t)| couplings.add_scalars(s, t) as u32));
    }

    fn vectors(&self) -> Vec<usize> {
        self.vectors.clone()
    }

    fn scalars(&self) -> Vec<usize> {
        self.scalars.clone()
    }

    fn not_by_squares(&self) -> Vec<usize> {
        self.scalars.clone()
    }

    fn reads(&self, side: usize) -> bool {
        self.sum.reads(side)
    }

    fn reads_rates(&self) -> bool {
        self.sum.reads_rates()
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        self.sum.value(sample)
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        self.sum.by_duration(sample)
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        self.sum.gradient(sample, forces, rows);
    }

    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        slots: &[u32],
        out: &mut SumDerivatives,
    ) {
        let (own, squares) = slots.split_at(self.sum.slot_count());
        let linear = Outer::linear(outer.slope);
        self.sum.add_function(linear, sample, own, out);
        if outer.curvature == 0.0 {
            return;
        }
        let mut g = self.gradient.lock().unwrap_or_else(PoisonError::into_inner);
        let Gradient { forces, rows } = &mut *g;
        forces
            .iter_mut()
            .for_each(|side| side.fill(Vector::zeros()));
        rows.fill(0.0);
        self.sum.gradient(sample, forces, rows);
        self.add_square(outer.curvature, &g, sample, squares, out);
    }
}

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
