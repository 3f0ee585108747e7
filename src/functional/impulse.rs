//! Impulse of the forces of terms along a displacement of one end of an interval, or their mean force along a span, as a quantity.
//!
//! With the part S of the action in an interval and a displacement w of the vectors of one instant it is `m = ∇S·w`. For a constant w
//! `∇m = ∇(∇S·w)` and `∇²m = ∇²(∇S·w)` are what terms give contracted with the direction w, virtual works included. For a turn
//! `w_i = c e × x_j` with `f = ∇S` the sum has `∂m/∂x_j = c f_i × e` too, and `∂²m/∂x_j∂y = −c e × ∂f_i/∂y` for all y that x_i couples with.
//!
//! A span r, read in the middle of the interval of the length h, is shortened by `w = −c r/(h |r|)` at both ends, so that m is a mean force. Its
//! force f is along it, so that `f·∂w = 0`: the sum has the derivatives of a constant w, and `∂²m/∂r∂r = (m/|r|²) P` with `P = 1 − r rᵀ/|r|²` too,
//! also where free parameters move the ends: `r = r₀ + Σ c_a e_a` (functional/laws.rs). The factor 1/h of w gives, with `s₁ = ∇(∂S/∂h)·w` and
//! `s₂ = ∇(∂²S/∂h²)·w`, the derivatives `∂m/∂h = s₁ − m/h` and `∂²m/∂h² = s₂ − 2 s₁/h + 2 m/h²`.

use crate::functional::curved::{Gradient, Square, each_once};
use crate::functional::{
    BlockMask, Blocks, Couplings, Functional, Horizon, Measure, Move, Order, Outer, Output, Sample,
    Stencil, SumDerivatives, Term, TermKind,
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
    /// A span whose ends come closer.
    Shortening(Shortening),
}

/// A span of which both ends come closer at both instants, by the inverse of the length of the interval.
#[derive(Clone, Debug)]
pub struct Shortening {
    /// Its vector r₀.
    pub span: usize,
    /// Factor c.
    pub factor: f64,
    /// Parameters that move its ends, scalars of the interval.
    pub parameters: Vec<usize>,
    /// Their moves.
    pub moves: Vec<Move>,
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
    /// The span that is shortened at both ends, with the square of the derivatives of a component of it.
    shortened: Option<(Shortening, Square)>,
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
            Displacement::Shortening(span) => shortened = Some(span.with_square()),
        }
        let is_turned = |vector: usize| turns.iter().any(|turn| turn.of == vector);
        let is_moved = |vector: usize| {
            let is_span = shortened.as_ref().is_some_and(|(of, _)| of.span == vector);
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
            vectors: each_once(of_pairs.chain(of_turns).collect()),
            scalars: each_once(read.chain(mixed.iter().map(|&(_, s)| s)).collect()),
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
        if let Some((of, _)) = &self.shortened {
            let r = of.read(sample);
            along[of.span] = r * (-of.factor / (sample.h * r.norm()));
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

impl Shortening {
    /// It, and the square of the derivatives of a component of the span.
    fn with_square(self) -> (Self, Square) {
        let moved = self.moves.iter().map(|one| one.vector);
        let scalars = self.moves.iter().map(|one| self.parameters[one.parameter]);
        let square = Square::new(moved.chain([self.span]).collect(), scalars.collect());
        (self, square)
    }

    /// The vectors by which a parameter moves the span, in the middle of an interval: its scalar, and by how much it differs.
    fn moved(&self, sample: &Sample<'_>) -> impl Iterator<Item = (&Move, usize, f64)> {
        self.moves.iter().map(move |one| {
            let scalar = self.parameters[one.parameter];
            (one, scalar, sample.scalars[scalar] - one.at)
        })
    }

    /// The span r.
    fn read(&self, sample: &Sample<'_>) -> Vector {
        let mut r = middle(self.span, sample);
        for (one, _, by) in self.moved(sample) {
            r += middle(one.vector, sample) * by;
        }
        r
    }

    /// Adds the gradient of its component along a vector.
    fn add_gradient(&self, along: &Vector, sample: &Sample<'_>, to: &mut Gradient) {
        for forces in &mut to.forces {
            forces[self.span] += along * 0.5;
        }
        for (one, scalar, by) in self.moved(sample) {
            for forces in &mut to.forces {
                forces[one.vector] += along * (0.5 * by);
            }
            to.rows[scalar] += along.dot(&middle(one.vector, sample));
        }
    }
}

/// A vector in the middle of an interval.
fn middle(vector: usize, sample: &Sample<'_>) -> Vector {
    Stencil::Mid.of(vector).read(sample.h, sample.vectors)
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
        if let Some((_, square)) = &self.shortened {
            square.couple(couplings, slots);
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
        let mut terms = self.functional.terms.iter();
        self.shortened.is_none() || terms.any(|term| term.kind() == TermKind::Dissipation)
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
        let (along, plain) = (&evaluation.along, &evaluation.out.plain);
        let by_action = self.product(along, &plain.horizon_forces);
        match self.shortened {
            Some(_) => by_action - self.product(along, &plain.forces) / sample.h,
            None => by_action,
        }
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
        let own_slots = slots.len() - self.shortened.as_ref().map_or(0, |(_, of)| of.slots());
        let (of_terms, of_square) = slots.split_at(own_slots);
        let mut of_terms = of_terms.iter().map(|&slot| slot as usize);
        let mask = &sample.sides.blocks;
        part.blocks.add(&own.blocks, c, &mut of_terms, mask);
        self.add_turned_blocks(c, &plain.blocks, &mut of_terms, mask, &mut part.blocks);
        let m = self.product(&evaluation.along, &plain.forces);
        if let Some((of, square)) = &self.shortened {
            let r = of.read(sample);
            for axis in 0..3 {
                let across = Vector::ith(axis, 1.0) - r * (r[axis] / r.norm_squared());
                let g = square.gradient(|g| of.add_gradient(&across, sample, g));
                square.add(c * m / r.norm_squared(), &g, sample, of_square, part);
            }
        }
        if sample.horizon == Horizon::Free && self.reads_rates() {
            self.add_turned(c, &plain.horizon_forces, &mut part.horizon_forces);
            for (to, from) in part.horizon_forces.iter_mut().zip(&own.horizon_forces) {
                add!(&self.vectors, from, c, to);
            }
            add!(&self.scalars, own.horizon_rows, c, part.horizon_rows);
            part.horizon += c * own.horizon;
            if self.shortened.is_some() {
                let (h, m_h) = (
                    sample.h,
                    self.product(&evaluation.along, &plain.horizon_forces),
                );
                for (to, from) in part.horizon_forces.iter_mut().zip(&own.forces) {
                    add!(&self.vectors, from, -c / h, to);
                }
                add!(&self.scalars, own.rows, -c / h, part.horizon_rows);
                part.horizon += 2.0 * c / h * (m / h - m_h);
            }
        }
    }
}
