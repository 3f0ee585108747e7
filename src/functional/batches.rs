//! Elements evaluated on all cores and added up one after the other, so that sums are the same for any number of threads.

use crate::math::has_pool;
use rayon::prelude::*;
use std::sync::Mutex;

/// Number of elements from which on they are evaluated on all cores.
const PARALLEL: usize = 256;
/// Elements whose derivatives are kept at once.
const STRETCH: usize = 512;
/// Elements that one thread takes at least.
const LEAST: usize = 32;

/// Derivatives of the elements of a stretch, kept for the next evaluation.
#[derive(Debug)]
pub(super) struct Batches<L>(Mutex<Vec<L>>);

impl<L> Default for Batches<L> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<L: Default + Send> Batches<L> {
    /// `add` takes each element with what `compute` makes of it, in their order; where nothing is kept there is nothing to compute
    /// ahead.
    #[inline(always)]
    pub(super) fn each<E: Sync>(
        &self,
        elements: &[E],
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L),
    ) {
        // A constant, so that loops over threads are compiled only for what is kept.
        if const { size_of::<L>() > 0 }
            && elements.len() >= PARALLEL
            && has_pool()
            && let Ok(mut locals) = self.0.try_lock()
        {
            return Self::each_on_all_cores(&mut locals, elements, compute, add);
        }
        let mut local = L::default();
        for element in elements {
            compute(element, &mut local);
            add(element, &local);
        }
    }

    fn each_on_all_cores<E: Sync>(
        locals: &mut Vec<L>,
        elements: &[E],
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(&E, &L),
    ) {
        locals.resize_with(STRETCH.min(elements.len()), L::default);
        for stretch in elements.chunks(STRETCH) {
            let pairs = stretch.par_iter().with_min_len(LEAST);
            pairs
                .zip(locals.par_iter_mut())
                .for_each(|(element, local)| compute(element, local));
            for (element, local) in stretch.iter().zip(locals.iter()) {
                add(element, local);
            }
        }
    }
}
