//! Elements evaluated on all cores and added up one after the other, so that sums are the same for any number of threads.

use rayon::prelude::*;
use std::sync::Mutex;

/// From so many elements on, they are evaluated on all cores.
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
    /// `add` takes what `compute` makes of each element, in their order.
    pub(super) fn each<E: Sync>(
        &self,
        elements: &[E],
        compute: impl Fn(&E, &mut L) + Sync,
        mut add: impl FnMut(usize, &mut L),
    ) {
        let kept = self.0.try_lock();
        let (true, Ok(mut locals)) = (elements.len() >= PARALLEL, kept) else {
            let mut local = L::default();
            for (index, element) in elements.iter().enumerate() {
                compute(element, &mut local);
                add(index, &mut local);
            }
            return;
        };
        locals.resize_with(STRETCH.min(elements.len()), L::default);
        for (k, stretch) in elements.chunks(STRETCH).enumerate() {
            let pairs = stretch.par_iter().with_min_len(LEAST);
            pairs
                .zip(locals.par_iter_mut())
                .for_each(|(element, local)| compute(element, local));
            for (i, local) in locals[..stretch.len()].iter_mut().enumerate() {
                add(k * STRETCH + i, local);
            }
        }
    }
}
