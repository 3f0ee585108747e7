//! Positions of the second derivatives of one element.

use crate::functional::couplings::NONE;
use crate::functional::{Coupling, Kernel};

/// The slots of one element: pairs of vectors, then of vectors and scalars, then of scalars.
#[derive(Clone, Copy, Default)]
pub(super) struct Slots<'a> {
    list: &'a [u32],
    vectors: usize,
    scalars: usize,
}

impl<'a> Slots<'a> {
    /// The first slots of a list are those of the element; they are taken off it. A list without slots serves where no blocks are asked for.
    #[inline(always)]
    pub(super) fn take<K: Kernel>(element: &K::Element, list: &mut &'a [u32]) -> Self {
        let (vectors, scalars) = (K::vectors(element), K::scalars(element));
        let count = match K::DEGREE >= 2 {
            true => vectors * (vectors + scalars) + scalars * scalars,
            false => 0,
        };
        let (own, rest) = list.split_at(count.min(list.len()));
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
        self.slot(self.vectors * (self.vectors + s) + a)
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

/// Hands over the couplings of an element in the order of its slots; `has_scalars` is true if its scalars couple with each other.
pub(super) fn couple<K: Kernel>(
    element: &K::Element,
    has_scalars: bool,
    to: &mut dyn FnMut(Option<Coupling>),
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
    .couple(to);
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
    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        for a in 0..self.vectors {
            for b in 0..self.vectors {
                let (row, column) = ((self.vector)(a), (self.vector)(b));
                to(match (self.are_coupled(a, b), self.is_isotropic) {
                    (false, _) => None,
                    (true, true) => Some(Coupling::Isotropic(row, column)),
                    (true, false) => Some(Coupling::Full(row, column)),
                });
            }
        }
        for s in 0..self.scalars {
            for a in 0..self.vectors {
                to((self.scalar)(s).map(|at| Coupling::Mixed((self.vector)(a), at)));
            }
        }
        for s in 0..self.scalars {
            for t in 0..self.scalars {
                // Pairs of different scalars are met twice, once in each order, and kept once.
                let pair = (self.scalar)(s).zip((self.scalar)(t));
                let pair = pair.filter(|(at, other)| self.has_scalars && other <= at);
                to(pair.map(|(at, other)| Coupling::Scalars(at, other)));
            }
        }
    }

    fn are_coupled(&self, a: usize, b: usize) -> bool {
        let readings = |a: usize| (0..self.readings).map(move |k| k * self.vectors + a);
        readings(a).any(|i| readings(b).any(|j| (self.couples)(i, j)))
    }
}
