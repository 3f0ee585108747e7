//! Impulse of the forces of terms along a displacement of one end of an interval, as a quantity.
//!
//! With the part S of the action in an interval and a constant displacement w of the vectors of one instant it is `m = ∇S·w`, and
//! `∇m = ∇(∇S·w)` and `∇²m = ∇²(∇S·w)` are what terms give contracted with the direction w, virtual works included.

use crate::functional::{
    BlockMask, Couplings, Functional, Horizon, Measure, Order, Outer, Output, Sample,
    SumDerivatives, Term,
};
use crate::math::Vector;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The impulse of some terms.
#[derive(Debug)]
pub struct Impulse {
    functional: Functional,
    /// Displacement w by vectors; zero at the other end.
    along: Vec<Vector>,
    still: Vec<Vector>,
    scalars_still: Vec<f64>,
    /// The end of the interval, 0 or 1.
    side: usize,
    /// Vectors and scalars that the derivatives of the impulse belong to, each once.
    vectors: Vec<usize>,
    scalars: Vec<usize>,
    out: Mutex<Output>,
}

impl Impulse {
    /// The impulse of terms that read this number of scalars, along a displacement by vectors of one end of the interval.
    pub fn new(terms: Vec<Arc<dyn Term>>, scalars: usize, along: Vec<Vector>, side: usize) -> Self {
        let functional = Functional::new(terms, Vec::new(), along.len(), scalars);
        let Couplings {
            full,
            isotropic,
            mixed,
            scalars: pairs,
            ..
        } = &functional.couplings;
        let once = |mut list: Vec<usize>| {
            list.sort_unstable();
            list.dedup();
            list
        };
        let of_pairs = full.iter().chain(isotropic).flat_map(|&(a, b)| [a, b]);
        let vectors = once(of_pairs.chain(mixed.iter().map(|&(a, _)| a)).collect());
        let of_pairs = pairs.iter().flat_map(|&(s, t)| [s, t]);
        let read = once(of_pairs.chain(mixed.iter().map(|&(_, s)| s)).collect());
        Self {
            still: vec![Vector::zeros(); along.len()],
            scalars_still: vec![0.0; scalars],
            out: Mutex::new(functional.output(Order::Third)),
            functional,
            along,
            side,
            vectors,
            scalars: read,
        }
    }

    /// The derivatives of the terms up to an order, those contracted with the displacement included.
    fn evaluated(&self, order: Order, sample: &Sample<'_>) -> MutexGuard<'_, Output> {
        let mut along = [&self.still[..], &self.still];
        along[self.side] = &self.along;
        let sample = Sample {
            along,
            scalars_along: &self.scalars_still,
            sides: BlockMask::ALL,
            outer: &[],
            ..*sample
        };
        let mut out = self.out.lock().unwrap_or_else(PoisonError::into_inner);
        self.functional.evaluate(order, &sample, &mut out);
        out
    }

    /// The product of forces at its end with the displacement.
    fn product(&self, forces: &[Vec<Vector>; 2]) -> f64 {
        let pairs = forces[self.side].iter().zip(&self.along);
        pairs.map(|(force, along)| force.dot(along)).sum()
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
        let own = &self.functional.couplings;
        let mut add = |slot: usize| slots.push(slot as u32);
        own.full
            .iter()
            .for_each(|&(a, b)| add(couplings.add_full(a, b)));
        own.isotropic
            .iter()
            .for_each(|&(a, b)| add(couplings.add_isotropic(a, b)));
        own.mixed
            .iter()
            .for_each(|&(a, s)| add(couplings.add_mixed(a, s)));
        own.scalars
            .iter()
            .for_each(|&(s, t)| add(couplings.add_scalars(s, t)));
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
        self.product(&self.evaluated(Order::Gradient, sample).plain.forces)
    }

    fn by_duration(&self, sample: &Sample<'_>) -> f64 {
        let sample = Sample {
            horizon: Horizon::Free,
            ..*sample
        };
        self.product(&self.evaluated(Order::Hessian, &sample).plain.horizon_forces)
    }

    fn gradient(&self, sample: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        let out = self.evaluated(Order::Third, sample);
        let own = &out.contracted;
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
        let out = self.evaluated(Order::Third, sample);
        let own = &out.contracted;
        for (to, from) in part.forces.iter_mut().zip(&own.forces) {
            add!(&self.vectors, from, c, to);
        }
        add!(&self.scalars, own.rows, c, part.rows);
        let mut slots = slots.iter().map(|&slot| slot as usize);
        let mask = &sample.sides.blocks;
        for (from, slot) in own.blocks.full.iter().zip(&mut slots) {
            let to = &mut part.blocks.full[slot];
            (0..4)
                .filter(|&side| mask[side])
                .for_each(|side| to[side] += from[side] * c);
        }
        for (from, slot) in own.blocks.isotropic.iter().zip(&mut slots) {
            let to = &mut part.blocks.isotropic[slot];
            (0..4)
                .filter(|&side| mask[side])
                .for_each(|side| to[side] += from[side] * c);
        }
        for (from, slot) in own.blocks.mixed.iter().zip(&mut slots) {
            let to = &mut part.blocks.mixed[slot];
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to += from * c);
        }
        for (from, slot) in own.blocks.scalars.iter().zip(&mut slots) {
            part.blocks.scalars[slot] += from * c;
        }
        if sample.horizon == Horizon::Free {
            for (to, from) in part.horizon_forces.iter_mut().zip(&own.horizon_forces) {
                add!(&self.vectors, from, c, to);
            }
            add!(&self.scalars, own.horizon_rows, c, part.horizon_rows);
            part.horizon += c * own.horizon;
        }
    }
}
