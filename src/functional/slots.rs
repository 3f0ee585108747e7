//! Positions of the second derivatives of one element.

use crate::functional::{Couplings, Kernel};

/// No slot.
const NONE: u32 = u32::MAX;

/// The slots of one element: pairs of vectors, then of vectors and scalars, then of scalars.
#[derive(Clone, Copy, Default)]
pub(super) struct Slots<'a> {
    list: &'a [u32],
    vectors: usize,
    scalars: usize,
}

impl<'a> Slots<'a> {
    /// The first slots of a list are those of the element; they are taken off it.
    #[inline(always)]
    pub(super) fn take<K: Kernel>(element: &K::Element, list: &mut &'a [u32]) -> Self {
        let (vectors, scalars) = (K::vectors(element), K::scalars(element));
        let count = match K::DEGREE >= 2 {
            true => vectors * (vectors + scalars) + scalars * scalars,
            false => 0,
        };
        let (own, rest) = list.split_at(count);
        *list = rest;
        Self {
            list: own,
            vectors,
            scalars,
        }
    }

    /// Slot of two vectors, should they couple.
    #[inline(always)]
    pub(super) fn vectors(self, a: usize, b: usize) -> Option<usize> {
        self.slot(self.vectors * a + b)
    }

    /// Slot of a vector and a scalar that is none of the constants.
    #[inline(always)]
    pub(super) fn mixed(self, a: usize, s: usize) -> Option<usize> {
        self.slot(self.vectors * self.vectors + self.scalars * a + s)
    }

    /// Slot of two scalars; `None` where they do not couple, and for one order of two different ones.
    #[inline(always)]
    pub(super) fn scalars(self, s: usize, t: usize) -> Option<usize> {
        let before = self.vectors * (self.vectors + self.scalars);
        self.slot(before + self.scalars * s + t)
    }

    #[inline(always)]
    fn slot(self, at: usize) -> Option<usize> {
        let slot = self.list[at];
        (slot != NONE).then_some(slot as usize)
    }
}

/// Registers the couplings of an element; `has_scalars` is true if its scalars couple with each other.
pub(super) fn couple<K: Kernel>(
    element: &K::Element,
    has_scalars: bool,
    couplings: &mut Couplings,
    slots: &mut Vec<u32>,
) {
    if K::DEGREE < 2 {
        return;
    }
    let (vectors, scalars) = (K::vectors(element), K::scalars(element));
    let index = |a: usize| K::vector(element, a).vector;
    let readings = |a: usize| (0..K::READINGS).map(move |k| k * vectors + a);
    for a in 0..vectors {
        for b in 0..vectors {
            let couples = readings(a).any(|i| readings(b).any(|j| K::couples(i, j)));
            slots.push(match (couples, K::ISOTROPIC) {
                (false, _) => NONE,
                (true, true) => couplings.add_isotropic(index(a), index(b)) as u32,
                (true, false) => couplings.add_full(index(a), index(b)) as u32,
            });
        }
    }
    let first = slots.len();
    slots.resize(first + scalars * (vectors + scalars), NONE);
    for s in 0..scalars {
        let Some((at, _)) = K::scalar(element, s) else {
            continue;
        };
        for a in 0..vectors {
            slots[first + scalars * a + s] = couplings.add_mixed(index(a), at) as u32;
        }
        for t in 0..scalars {
            // Pairs of different scalars are met twice, once in each order, and kept once.
            let other = K::scalar(element, t).filter(|&(other, _)| has_scalars && other <= at);
            if let Some((other, _)) = other {
                let slot = couplings.add_scalars(at, other) as u32;
                slots[first + scalars * (vectors + s) + t] = slot;
            }
        }
    }
}
