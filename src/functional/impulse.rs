//! Impulse of the forces of terms along a displacement of one end of an interval, as a quantity.
//!
//! With the part S of the action in an interval and a displacement w of the vectors of one instant it is `m = ∇S·w`. For a constant w
//! `∇m = ∇(∇S·w)` and `∇²m = ∇²(∇S·w)` are what terms give contracted with the direction w, virtual works included. For a turn
//! `w_i = c e × x_j` with `f = ∇S` the sum has `∂m/∂x_j = c f_i × e` too, and `∂²m/∂x_j∂y = −c e × ∂f_i/∂y` for all y that x_i couples with.
//!
//! A span r, read in the middle of the interval, is shortened by `w = −c r/|r|` at both ends. Its force f is along it, so that `f·∂w = 0`: the sum
//! has the derivatives of a constant w, and `∂²m/∂r∂r = (m/|r|²) (1 − r rᵀ/|r|²)` too.

use crate::functional::{
    BlockMask, Blocks, Couplings, Functional, Horizon, Measure, Order, Outer, Output, Sample,
    SumDerivatives, Term,
};
use crate::math::{Matrix, Vector};
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A displacement of the vectors of an instant.
#[derive(Clone, Debug)]
pub enum Displacement {
    /// Constant displacements by vectors.
    Shift(Vec<Vector>),
    /// Turns about an axis.
    Turn {
        /// Unit vector e.
        axis: Vector,
        /// The turns.
        turns: Vec<Turn>,
    },
    /// A span of which both ends come closer in both instants.
    Shortening {
        /// Its vector.
        span: usize,
        /// Factor c.
        factor: f64,
    },
}

/// A part `c e × x_j` of the displacement of a vector i.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Vector i.
    pub of: usize,
    /// Vector j.
    pub by: usize,
    /// Factor c.
    pub factor: f64,
}

/// The impulse of some terms.
#[derive(Debug)]
pub struct Impulse {
    functional: Functional,
    /// Unit vector e of its turns.
    axis: Vector,
    turns: Vec<Turn>,
    /// Couplings that a turn adds to: its place, and the pair of its vector i with another one, with the same up to a factor, and with a scalar.
    turned: [Vec<(usize, usize)>; 3],
    still: Vec<Vector>,
    scalars_still: Vec<f64>,
    /// The end of the interval, 0 or 1, where it is displaced at one.
    side: usize,
    /// The vector of a span that is shortened at both ends, and the factor.
    shortened: Option<(usize, f64)>,
    /// Vectors and scalars that the derivatives of the impulse belong to, each once.
    vectors: Vec<usize>,
    scalars: Vec<usize>,
    evaluation: Mutex<Evaluation>,
}

/// The displacement w by vectors, zero at the other end, and derivatives of the terms.
#[derive(Debug)]
struct Evaluation {
    along: Vec<Vector>,
    out: Output,
}

impl Impulse {
    /// The impulse of terms along a displacement of one end of the interval, from the numbers of vectors and scalars; elements that do not read
    /// what is displaced have none.
    pub fn new(
        terms: &[&Arc<dyn Term>],
        [vectors, scalars]: [usize; 2],
        displacement: Displacement,
        side: usize,
    ) -> Self {
        let still = vec![Vector::zeros(); vectors];
        let (mut along, mut axis, mut turns) = (still.clone(), Vector::zeros(), Vec::new());
        let mut shortened = None;
        match displacement {
            Displacement::Shift(shift) => along = shift,
            Displacement::Turn { axis: e, turns: t } => (axis, turns) = (e, t),
            Displacement::Shortening { span, factor } => shortened = Some((span, factor)),
        }
        let is_turned = |vector: usize| turns.iter().any(|turn| turn.of == vector);
        let is_moved = |vector: usize| {
            let is_span = shortened.is_some_and(|(span, _)| span == vector);
            along[vector] != Vector::zeros() || is_turned(vector) || is_span
        };
        let terms = terms.iter().filter_map(|term| term.reading(&is_moved));
        let functional = Functional::new(terms.collect(), Vec::new(), vectors, scalars);
        let Couplings {
            full,
            isotropic,
            mixed,
            scalars: pairs,
            ..
        } = functional.couplings();
        let once = |mut list: Vec<usize>| {
            list.sort_unstable();
            list.dedup();
            list
        };
        let of_pairs = full.iter().chain(isotropic).flat_map(|&(a, b)| [a, b]);
        let of_turns = turns.iter().map(|turn| turn.by);
        let of_pairs = of_pairs.chain(mixed.iter().map(|&(a, _)| a));
        let read = pairs.iter().flat_map(|&(s, t)| [s, t]);
        let turned = |pairs: &[(usize, usize)]| {
            let of = |(t, turn): (usize, &Turn)| {
                let own = pairs.iter().enumerate();
                let own = own.filter(|(_, (a, _))| *a == turn.of);
                own.map(|(pair, _)| (t, pair)).collect::<Vec<_>>()
            };
            turns.iter().enumerate().flat_map(of).collect()
        };
        Self {
            vectors: once(of_pairs.chain(of_turns).collect()),
            scalars: once(read.chain(mixed.iter().map(|&(_, s)| s)).collect()),
            turned: [full, isotropic, mixed].map(|pairs| turned(pairs)),
            evaluation: Mutex::new(Evaluation {
                along,
                out: functional.output(Order::Third),
            }),
            scalars_still: vec![0.0; scalars],
            functional,
            axis,
            turns,
            still,
            side,
            shortened,
        }
    }

    /// Ends of the interval that are displaced.
    fn sides(&self) -> Range<usize> {
        match self.shortened {
            Some(_) => 0..2,
            None => self.side..self.side + 1,
        }
    }

    /// The shortened span in the middle of the interval.
    fn span(&self, sample: &Sample<'_>) -> Option<(usize, Vector, f64)> {
        let (span, factor) = self.shortened?;
        let [a, b] = sample.vectors.map(|vectors| vectors[span]);
        Some((span, (a + b) * 0.5, factor))
    }

    /// The derivatives of the terms up to an order, those contracted with the displacement included.
    fn evaluated(&self, order: Order, sample: &Sample<'_>) -> MutexGuard<'_, Evaluation> {
        let lock = self.evaluation.lock();
        let mut evaluation = lock.unwrap_or_else(PoisonError::into_inner);
        let Evaluation { along, out } = &mut *evaluation;
        for turn in &self.turns {
            along[turn.of] = Vector::zeros();
        }
        for turn in &self.turns {
            let x = sample.vectors[self.side][turn.by];
            along[turn.of] += self.axis.cross(&x) * turn.factor;
        }
        if let Some((span, r, factor)) = self.span(sample) {
            along[span] = r * (-factor / r.norm());
        }
        let mut both = [&self.still[..], &self.still];
        both[self.sides()].fill(along);
        let sample = Sample {
            along: both,
            scalars_along: &self.scalars_still,
            sides: BlockMask::ALL,
            outer: &[],
            ..*sample
        };
        self.functional.evaluate(order, &sample, out);
        evaluation
    }

    /// The product of forces at its ends with the displacement.
    fn product(&self, along: &[Vector], forces: &[Vec<Vector>; 2]) -> f64 {
        let sides = forces[self.sides()].iter();
        let pairs = sides.flat_map(|forces| forces.iter().zip(along));
        pairs.map(|(force, along)| force.dot(along)).sum()
    }

    /// Adds c times the derivatives of turned vectors times forces.
    fn add_turned(&self, c: f64, from: &[Vec<Vector>; 2], to: &mut [Vec<Vector>; 2]) {
        for turn in &self.turns {
            let force = from[self.side][turn.of];
            to[self.side][turn.by] += force.cross(&self.axis) * (c * turn.factor);
        }
    }

    /// Adds c times the derivatives of turned vectors times the derivatives of forces.
    fn add_turned_blocks(
        &self,
        c: f64,
        from: &Blocks,
        slots: &mut impl Iterator<Item = usize>,
        mask: &[bool; 4],
        to: &mut Blocks,
    ) {
        let side = self.side;
        let cross = self.axis.cross_matrix() * -c;
        let [full, isotropic, mixed] = &self.turned;
        let full = full
            .iter()
            .map(|&(t, pair)| (t, from.full[pair].map(|block| cross * block)));
        let isotropic = isotropic
            .iter()
            .map(|&(t, pair)| (t, from.isotropic[pair].map(|factor| cross * factor)));
        for (t, blocks) in full.chain(isotropic) {
            let factor = self.turns[t].factor;
            let mut next = || slots.next().expect("a slot of each pair");
            let [row, column] = [next(), next()];
            for other in 0..2 {
                let block: Matrix = blocks[2 * side + other] * factor;
                let [at, across] = [2 * side + other, 2 * other + side];
                if mask[at] {
                    to.full[row][at] += block;
                }
                if mask[across] {
                    to.full[column][across] += block.transpose();
                }
            }
        }
        for (&(t, pair), slot) in mixed.iter().zip(slots) {
            to.mixed[slot][side] += cross * from.mixed[pair][side] * self.turns[t].factor;
        }
    }
}

/// Adds a multiple of some vectors or scalars of one list to those of another.
macro_rules! add {
    ($places:expr, $from:expr, $factor:expr, $to:expr) => {
        for &place in $places {
            $to[place] += $from[place] * $factor;
        }
    };
}

impl Measure for Impulse {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        let own = self.functional.couplings();
        slots.extend(own.list().map(|coupling| couplings.add(Some(coupling))));
        let mut add = |slot: usize| slots.push(slot as u32);
        let [full, isotropic, mixed] = &self.turned;
        let of_vectors = full.iter().map(|&(t, pair)| (t, own.full[pair]));
        let of_vectors =
            of_vectors.chain(isotropic.iter().map(|&(t, pair)| (t, own.isotropic[pair])));
        for (t, (_, b)) in of_vectors {
            let by = self.turns[t].by;
            add(couplings.add_full(by, b));
            add(couplings.add_full(b, by));
        }
        for &(t, pair) in mixed {
            add(couplings.add_mixed(self.turns[t].by, own.mixed[pair].1));
        }
        if let Some((span, _)) = self.shortened {
            add(couplings.add_full(span, span));
        }
    }

    fn vectors(&self) -> Vec<usize> {
        self.vectors.clone()
    }

    fn scalars(&self) -> Vec<usize> {
        self.scalars.clone()
    }

    fn not_by_squares(&self) -> Vec<usize> {
        let terms = self.functional.terms.iter();
        terms.flat_map(|term| term.not_by_squares()).collect()
    }

    fn reads(&self, _side: usize) -> bool {
        true
    }

    fn reads_rates(&self) -> bool {
        true
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        let evaluation = self.evaluated(Order::Gradient, sample);
        self.product(&evaluation.along, &evaluation.out.plain.forces)
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        let sample = Sample {
            horizon: Horizon::Free,
            ..*sample
        };
        let evaluation = self.evaluated(Order::Hessian, &sample);
        self.product(&evaluation.along, &evaluation.out.plain.horizon_forces)
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        let evaluation = self.evaluated(Order::Third, sample);
        let own = &evaluation.out.contracted;
        self.add_turned(1.0, &evaluation.out.plain.forces, forces);
        for (to, from) in forces.iter_mut().zip(&own.forces) {
            add!(&self.vectors, from, 1.0, to);
        }
        add!(&self.scalars, own.rows, 1.0, rows);
    }

    fn add_function(
        &self,
        outer: Outer,
        sample: &Sample<'_>,
        slots: &[u32],
        part: &mut SumDerivatives,
    ) {
        debug_assert!(outer.curvature == 0.0, "an impulse is bounded, not squared");
        let c = outer.slope;
        let evaluation = self.evaluated(Order::Third, sample);
        let (own, plain) = (&evaluation.out.contracted, &evaluation.out.plain);
        self.add_turned(c, &plain.forces, &mut part.forces);
        for (to, from) in part.forces.iter_mut().zip(&own.forces) {
            add!(&self.vectors, from, c, to);
        }
        add!(&self.scalars, own.rows, c, part.rows);
        let mut slots = slots.iter().map(|&slot| slot as usize);
        let mask = &sample.sides.blocks;
        part.blocks.add(&own.blocks, c, &mut slots, mask);
        self.add_turned_blocks(c, &plain.blocks, &mut slots, mask, &mut part.blocks);
        if let Some(((_, r, _), slot)) = self.span(sample).zip(slots.next()) {
            let m = self.product(&evaluation.along, &plain.forces);
            let across = Matrix::identity() - r * r.transpose() / r.norm_squared();
            let block = across * (0.25 * c * m / r.norm_squared());
            let to = &mut part.blocks.full[slot];
            (0..4)
                .filter(|&side| mask[side])
                .for_each(|side| to[side] += block);
        }
        if sample.horizon == Horizon::Free {
            self.add_turned(c, &plain.horizon_forces, &mut part.horizon_forces);
            for (to, from) in part.horizon_forces.iter_mut().zip(&own.horizon_forces) {
                add!(&self.vectors, from, c, to);
            }
            add!(&self.scalars, own.horizon_rows, c, part.horizon_rows);
            part.horizon += c * own.horizon;
        }
    }
}
