//! Curved functions of quantities, which couple all that the quantity reads: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.

use crate::functional::{Couplings, Horizon, Measure, Outer, Sample, SumDerivatives};
use crate::math::Vector;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A quantity of which curved functions are taken.
#[derive(Debug)]
pub struct Curved {
    of: Box<dyn Measure>,
    square: Square,
}

/// The square ∇m ∇mᵀ of a gradient.
#[derive(Debug)]
pub(super) struct Square {
    /// Vectors and scalars by which the gradient is taken, each once.
    vectors: Vec<usize>,
    scalars: Vec<usize>,
    gradient: Mutex<Gradient>,
}

/// Storage of a gradient.
#[derive(Debug)]
pub(super) struct Gradient {
    pub(super) forces: [Vec<Vector>; 2],
    pub(super) rows: Vec<f64>,
}

impl Square {
    /// The square of a gradient by vectors and scalars.
    pub(super) fn new(vectors: Vec<usize>, scalars: Vec<usize>) -> Self {
        let (vectors, scalars) = (each_once(vectors), each_once(scalars));
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

    /// Number of the slots of its couplings.
    pub(super) fn slots(&self) -> usize {
        let (vectors, scalars) = (self.vectors.len(), self.scalars.len());
        vectors * (vectors + scalars) + self.pairs_of_scalars().count()
    }

    /// The gradient that is added to zero.
    pub(super) fn gradient(&self, add: impl FnOnce(&mut Gradient)) -> MutexGuard<'_, Gradient> {
        let gradient = self.gradient.lock();
        let mut g = gradient.unwrap_or_else(PoisonError::into_inner);
        g.forces
            .iter_mut()
            .for_each(|side| side.fill(Vector::zeros()));
        g.rows.fill(0.0);
        add(&mut g);
        g
    }

    /// Pairs of its scalars, each once, the later one first.
    fn pairs_of_scalars(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let scalars = self.scalars.iter().enumerate();
        scalars.flat_map(|(i, &s)| self.scalars[..=i].iter().map(move |&t| (s, t)))
    }

    /// Registers what it couples, and lists the slots.
    pub(super) fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
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
    pub(super) fn add(
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

impl Curved {
    /// A quantity of which curved functions are taken.
    pub fn new(of: Box<dyn Measure>) -> Self {
        Self {
            square: Square::new(of.vectors(), of.scalars()),
            of,
        }
    }
}

/// A list in order, each number once.
pub(super) fn each_once(mut list: Vec<usize>) -> Vec<usize> {
    list.sort_unstable();
    list.dedup();
    list
}

impl Measure for Curved {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        self.of.couple(couplings, slots);
        self.square.couple(couplings, slots);
    }

    fn vectors(&self) -> Vec<usize> {
        self.square.vectors.clone()
    }

    fn scalars(&self) -> Vec<usize> {
        self.square.scalars.clone()
    }

    fn not_by_squares(&self) -> Vec<usize> {
        self.scalars()
    }

    fn reads(&self, side: usize) -> bool {
        self.of.reads(side)
    }

    fn reads_rates(&self) -> bool {
        self.of.reads_rates()
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        self.of.value(sample)
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        self.of.by_duration(sample)
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        self.of.gradient(sample, forces, rows);
    }

    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        slots: &[u32],
        out: &mut SumDerivatives,
    ) {
        let Outer { slope, curvature } = outer;
        let (own, of_square) = slots.split_at(slots.len() - self.square.slots());
        self.of.add_function(Outer::linear(slope), sample, own, out);
        if curvature == 0.0 {
            return;
        }
        let g = self
            .square
            .gradient(|g| self.of.gradient(sample, &mut g.forces, &mut g.rows));
        self.square.add(curvature, &g, sample, of_square, out);
        if sample.horizon == Horizon::Free && self.reads_rates() {
            let by_duration = self.by_duration(sample);
            self.square
                .add_horizon(curvature * by_duration, by_duration, &g, out);
        }
    }
}
