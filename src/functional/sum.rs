//! Sums of quantities, of which functions are taken. A curved function couples all that the parts of a sum read.

use crate::functional::{Couplings, Horizon, Measure, Outer, Sample, SumDerivatives};
use crate::math::Vector;
use std::sync::{Mutex, PoisonError};

/// A sum of quantities of one site.
#[derive(Debug)]
pub struct Sum {
    parts: Vec<Box<dyn Measure>>,
    /// Number of slots of each part.
    slots: Vec<usize>,
    /// For curved functions of the sum: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.
    square: Option<Square>,
}

/// The square ∇m ∇mᵀ of the gradient of a sum.
#[derive(Debug)]
struct Square {
    /// Vectors and scalars that the sum reads, each once.
    vectors: Vec<usize>,
    scalars: Vec<usize>,
    gradient: Mutex<Gradient>,
}

/// Storage of the gradient of a sum.
#[derive(Debug)]
struct Gradient {
    forces: [Vec<Vector>; 2],
    rows: Vec<f64>,
}

impl Square {
    fn new(vectors: Vec<usize>, scalars: Vec<usize>) -> Self {
        let vectors = each_once(vectors);
        let count = |list: &[usize]| list.last().map_or(0, |last| last + 1);
        let zeros = || vec![Vector::zeros(); count(&vectors)];
        Self {
            gradient: Mutex::new(Gradient {
                forces: [zeros(), zeros()],
                rows: vec![0.0; count(&scalars)],
            }),
            vectors,
            scalars,
        }
    }

    /// Pairs of its scalars, each once, the later one first.
    fn pairs_of_scalars(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let scalars = self.scalars.iter().enumerate();
        scalars.flat_map(|(i, &s)| self.scalars[..=i].iter().map(move |&t| (s, t)))
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for &a in &self.vectors {
            let with_vectors = self.vectors.iter();
            slots.extend(with_vectors.map(|&b| couplings.add_full(a, b) as u32));
            let with_scalars = self.scalars.iter();
            slots.extend(with_scalars.map(|&s| couplings.add_mixed(a, s) as u32));
        }
        let pairs = self.pairs_of_scalars();
        slots.extend(pairs.map(|(s, t)| couplings.add_scalars(s, t) as u32));
    }

    /// Adds the curvature times the square.
    fn add(
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
    }

    /// Adds its row of the length of the interval: the curvature times the derivative of the sum by it is a factor.
    fn add_horizon(&self, factor: f64, by_duration: f64, g: &Gradient, out: &mut SumDerivatives) {
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

impl Sum {
    /// The sum of its parts, of which linear functions are taken.
    pub fn linear(parts: Vec<Box<dyn Measure>>) -> Self {
        let slots = parts.iter().map(|part| {
            let mut slots = Vec::new();
            part.couple(&mut Couplings::default(), &mut slots);
            slots.len()
        });
        Self {
            slots: slots.collect(),
            parts,
            square: None,
        }
    }

    /// The sum of its parts, of which curved functions are taken.
    pub fn curved(parts: Vec<Box<dyn Measure>>) -> Self {
        let sum = Self::linear(parts);
        let square = Square::new(sum.vectors(), sum.scalars());
        Self {
            square: Some(square),
            ..sum
        }
    }

    /// Numbers of all parts, in their order.
    fn all(&self, of: impl Fn(&dyn Measure) -> Vec<usize>) -> Vec<usize> {
        self.parts
            .iter()
            .flat_map(|part| of(part.as_ref()))
            .collect()
    }
}

fn each_once(mut list: Vec<usize>) -> Vec<usize> {
    list.sort_unstable();
    list.dedup();
    list
}

impl Measure for Sum {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        self.parts
            .iter()
            .for_each(|part| part.couple(couplings, slots));
        self.square
            .iter()
            .for_each(|square| square.couple(couplings, slots));
    }

    fn vectors(&self) -> Vec<usize> {
        match &self.square {
            None => self.all(|part| part.vectors()),
            Some(square) => square.vectors.clone(),
        }
    }

    fn scalars(&self) -> Vec<usize> {
        each_once(self.all(|part| part.scalars()))
    }

    fn not_by_squares(&self) -> Vec<usize> {
        match &self.square {
            None => each_once(self.all(|part| part.not_by_squares())),
            Some(_) => self.scalars(),
        }
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
        let Outer { slope, curvature } = outer;
        debug_assert!(curvature == 0.0 || self.square.is_some(), "parts couple");
        for (part, &count) in self.parts.iter().zip(&self.slots) {
            let own;
            (own, slots) = slots.split_at(count);
            part.add_function(Outer::linear(slope), sample, own, out);
        }
        let Some(square) = self.square.as_ref().filter(|_| curvature != 0.0) else {
            return;
        };
        let gradient = square.gradient.lock();
        let mut g = gradient.unwrap_or_else(PoisonError::into_inner);
        let Gradient { forces, rows } = &mut *g;
        forces
            .iter_mut()
            .for_each(|side| side.fill(Vector::zeros()));
        rows.fill(0.0);
        self.gradient(sample, forces, rows);
        square.add(curvature, &g, sample, slots, out);
        if sample.horizon == Horizon::Free && self.reads_rates() {
            let by_duration = self.by_duration(sample);
            square.add_horizon(curvature * by_duration, by_duration, &g, out);
        }
    }
}
