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
    Arguments {
        vectors: K::vectors(element),
        scalars: K::scalars(element),
        readings: K::READINGS,
        is_isotropic: K::ISOTROPIC,
        has_scalars,
        vector: &|i| K::vector(element, i).vector,
        scalar: &|s| K::scalar(element, s).map(|(at, _)| at),
        couples: K::couples,
    }
    .couple(couplings, slots);
}

/// The arguments of an element of any kernel.
struct Arguments<'a> {
    vectors: usize,
    scalars: usize,
    /// Arguments for each vector.
    readings: usize,
    is_isotropic: bool,
    has_scalars: bool,
    vector: &'a dyn Fn(usize) -> usize,
    scalar: &'a dyn Fn(usize) -> Option<usize>,
    couples: fn(usize, usize) -> bool,
}

impl Arguments<'_> {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for a in 0..self.vectors {
            for b in 0..self.vectors {
                let (row, column) = ((self.vector)(a), (self.vector)(b));
                slots.push(match (self.are_coupled(a, b), self.is_isotropic) {
                    (false, _) => NONE,
                    (true, true) => couplings.add_isotropic(row, column) as u32,
                    (true, false) => couplings.add_full(row, column) as u32,
                });
            }
        }
        let first = slots.len();
        slots.resize(first + self.scalars * (self.vectors + self.scalars), NONE);
        let own = &mut slots[first..];
        for s in 0..self.scalars {
            let Some(at) = (self.scalar)(s) else {
                continue;
            };
            for a in 0..self.vectors {
                own[self.scalars * a + s] = couplings.add_mixed((self.vector)(a), at) as u32;
            }
            for t in 0..self.scalars {
                // Pairs of different scalars are met twice, once in each order, and kept once.
                let other = (self.scalar)(t).filter(|&other| self.has_scalars && other <= at);
                if let Some(other) = other {
                    let slot = couplings.add_scalars(at, other) as u32;
                    own[self.scalars * (self.vectors + s) + t] = slot;
                }
            }
        }
    }

    fn are_coupled(&self, a: usize, b: usize) -> bool {
        let readings = |a: usize| (0..self.readings).map(move |k| k * self.vectors + a);
        readings(a).any(|i| readings(b).any(|j| (self.couples)(i, j)))
    }
}
