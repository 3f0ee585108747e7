//! Elements evaluated on all cores and added up one after the other, so that sums are the same for any number of threads.

use crate::math::{has_pool, join};
use rayon::prelude::*;
use std::sync::Mutex;

/// Number of elements from which on they are evaluated on all cores.
const PARALLEL: usize = 256;
/// Elements of a stretch: the derivatives of two are kept, those that are computed and those that are added.
const STRETCH: usize = 128;
/// Elements that one thread takes at least.
const LEAST: usize = 16;

/// Derivatives of the elements of two stretches, kept for the next evaluation.
#[derive(Debug)]
pub(super) struct Batches<L>(Mutex<Vec<L>>);

impl<L> Default for Batches<L> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<L: Default + Send + Sync> Batches<L> {
    /// `add` takes each element with what `compute` makes of it, in their order, as long as `goes_on` says so before each stretch; returns
    /// true if it took all. Where nothing is kept there is nothing to compute ahead.
    #[inline(always)]
    pub(super) fn each<E: Sync>(
        &self,
        elements: &[E],
        goes_on: impl Fn() -> bool,
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L) + Send,
    ) -> bool {
        // A constant, so that loops over threads are compiled only for what is kept.
        if const { size_of::<L>() > 0 }
            && elements.len() >= PARALLEL
            && has_pool()
            && let Ok(mut locals) = self.0.try_lock()
        {
            return Self::each_on_all_cores(&mut locals, elements, goes_on, compute, add);
        }
        let mut local = L::default();
        for stretch in elements.chunks(STRETCH) {
            if !goes_on() {
                return false;
            }
            for element in stretch {
                compute(element, &mut local);
                add(element, &local);
            }
        }
        true
    }

    /// One thread adds a stretch while the others compute the next one.
    fn each_on_all_cores<E: Sync>(
        locals: &mut Vec<L>,
        elements: &[E],
        goes_on: impl Fn() -> bool,
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L) + Send,
    ) -> bool {
        locals.resize_with(2 * STRETCH, L::default);
        let (mut computed, mut free) = locals.split_at_mut(STRETCH);
        let fill = |stretch: &[E], locals: &mut [L]| {
            let pairs = stretch.par_iter().with_min_len(LEAST);
            pairs
                .zip(locals.par_iter_mut())
                .for_each(|(element, local)| compute(element, local));
        };
        let mut stretches = elements.chunks(STRETCH);
        let mut next = stretches.next();
        let mut now: &[E] = &[];
        while goes_on() {
            let mut add_all = || {
                for (element, local) in now.iter().zip(computed.iter()) {
                    add(element, local);
                }
            };
            let Some(stretch) = next else {
                add_all();
                return true;
            };
            join(add_all, || fill(stretch, free));
            std::mem::swap(&mut computed, &mut free);
            (now, next) = (stretch, stretches.next());
        }
        false
    }
}
