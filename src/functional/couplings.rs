//! Couplings: pairs of vectors and scalars with mixed second derivatives, and the blocks of these.

use crate::math::{Matrix, Vector};
use rustc_hash::FxHashMap;

/// Two arguments with mixed second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coupling {
    /// Vectors with a full 3 × 3 block.
    Full(usize, usize),
    /// Vectors whose block is a multiple of the identity.
    Isotropic(usize, usize),
    /// Vector and scalar.
    Mixed(usize, usize),
    /// Scalars.
    Scalars(usize, usize),
}

/// In place of the slot of arguments that do not couple.
pub(super) const NONE: u32 = u32::MAX;

/// The pairs that couple at one site; laid down once by the terms, the same for every interval.
///
/// Vector pairs come in both orders.
#[derive(Clone, Debug, Default)]
pub struct Couplings {
    /// Vector pairs with full 3 × 3 blocks.
    pub full: Vec<(usize, usize)>,
    /// Vector pairs whose blocks are multiples of the identity.
    pub isotropic: Vec<(usize, usize)>,
    /// Vector and scalar.
    pub mixed: Vec<(usize, usize)>,
    /// Scalar pairs, row ≥ column.
    pub scalars: Vec<(usize, usize)>,
    slots: FxHashMap<(u8, u32, u32), u32>,
}

impl Couplings {
    fn slot(
        slots: &mut FxHashMap<(u8, u32, u32), u32>,
        list: &mut Vec<(usize, usize)>,
        kind: u8,
        pair: (usize, usize),
    ) -> usize {
        let slot = slots.entry((kind, pair.0 as u32, pair.1 as u32));
        *slot.or_insert_with(|| {
            list.push(pair);
            list.len() as u32 - 1
        }) as usize
    }

    /// Slot of a coupling, should there be one.
    pub fn add(&mut self, coupling: Option<Coupling>) -> u32 {
        match coupling {
            None => NONE,
            Some(Coupling::Full(a, b)) => self.add_full(a, b) as u32,
            Some(Coupling::Isotropic(a, b)) => self.add_isotropic(a, b) as u32,
            Some(Coupling::Mixed(a, s)) => self.add_mixed(a, s) as u32,
            Some(Coupling::Scalars(s, t)) => self.add_scalars(s, t) as u32,
        }
    }

    /// All couplings: vectors with full blocks, with multiples of the identity, vectors and scalars, then scalars.
    pub fn list(&self) -> impl Iterator<Item = Coupling> + '_ {
        let full = self.full.iter().map(|&(a, b)| Coupling::Full(a, b));
        let isotropic = self.isotropic.iter();
        let isotropic = isotropic.map(|&(a, b)| Coupling::Isotropic(a, b));
        let mixed = self.mixed.iter().map(|&(a, s)| Coupling::Mixed(a, s));
        let scalars = self.scalars.iter().map(|&(s, t)| Coupling::Scalars(s, t));
        full.chain(isotropic).chain(mixed).chain(scalars)
    }

    /// Slot of a full block of the vectors a, b.
    pub fn add_full(&mut self, a: usize, b: usize) -> usize {
        Self::slot(&mut self.slots, &mut self.full, 0, (b, a));
        Self::slot(&mut self.slots, &mut self.full, 0, (a, b))
    }

    /// Slot of an isotropic block of the vectors a, b.
    pub fn add_isotropic(&mut self, a: usize, b: usize) -> usize {
        Self::slot(&mut self.slots, &mut self.isotropic, 1, (b, a));
        Self::slot(&mut self.slots, &mut self.isotropic, 1, (a, b))
    }

    /// Slot of the coupling of vector a and scalar s.
    pub fn add_mixed(&mut self, a: usize, s: usize) -> usize {
        Self::slot(&mut self.slots, &mut self.mixed, 2, (a, s))
    }

    /// Slot of the coupling of two scalars.
    pub fn add_scalars(&mut self, s: usize, t: usize) -> usize {
        Self::slot(&mut self.slots, &mut self.scalars, 3, (s.max(t), s.min(t)))
    }

    /// Slot of the transposed full pair.
    pub fn transposed_full(&self, slot: usize) -> usize {
        let (a, b) = self.full[slot];
        self.slots[&(0, b as u32, a as u32)] as usize
    }

    /// Slot of the transposed isotropic pair.
    pub fn transposed_isotropic(&self, slot: usize) -> usize {
        let (a, b) = self.isotropic[slot];
        self.slots[&(1, b as u32, a as u32)] as usize
    }
}

/// Second derivatives on one interval, one entry for each coupling; `[2 r + s]` for the instants k + r, k + s.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// Full blocks.
    pub full: Vec<[Matrix; 4]>,
    /// Factors of the identity.
    pub isotropic: Vec<[f64; 4]>,
    /// Vector at the instants k, k + 1 against scalar.
    pub mixed: Vec<[Vector; 2]>,
    /// Scalar against scalar.
    pub scalars: Vec<f64>,
}

impl Blocks {
    /// Adds c times blocks at slots, those of the sides that are asked for.
    pub(super) fn add(
        &mut self,
        from: &Self,
        c: f64,
        slots: &mut impl Iterator<Item = usize>,
        mask: &[bool; 4],
    ) {
        let sides = || (0..4).filter(|&side| mask[side]);
        for (from, slot) in from.full.iter().zip(&mut *slots) {
            sides().for_each(|side| self.full[slot][side] += from[side] * c);
        }
        for (from, slot) in from.isotropic.iter().zip(&mut *slots) {
            sides().for_each(|side| self.isotropic[slot][side] += from[side] * c);
        }
        for (from, slot) in from.mixed.iter().zip(&mut *slots) {
            (0..2).for_each(|side| self.mixed[slot][side] += from[side] * c);
        }
        for (from, slot) in from.scalars.iter().zip(&mut *slots) {
            self.scalars[slot] += from * c;
        }
    }
}

/// Order of the derivatives by free parameters for which a reader asks: among second derivatives of a sum and their rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterOrder {
    /// None: they are left zero.
    None,
    /// Those by one parameter.
    First,
    /// Rates of those by two of them too.
    Second,
}

/// Second derivatives of an interval for which a reader asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockMask {
    /// Blocks (k, k), (k, k+1), (k+1, k), (k+1, k+1).
    pub blocks: [bool; 4],
    /// Those by free parameters.
    pub parameters: ParameterOrder,
}

impl BlockMask {
    /// All four blocks.
    pub const ALL: Self = Self {
        blocks: [true; 4],
        parameters: ParameterOrder::Second,
    };
    /// All but (k+1, k+1), which is carried on to the next interval.
    pub const CARRIED: Self = Self {
        blocks: [true, true, true, false],
        parameters: ParameterOrder::Second,
    };
    /// Only the rows of t_k against t_{k+1}: what one step forward needs.
    pub const FORWARD: Self = Self {
        blocks: [false, true, false, false],
        parameters: ParameterOrder::Second,
    };
    /// Only the block of the first instant: what an instant needs.
    pub const HERE: Self = Self {
        blocks: [true, false, false, false],
        parameters: ParameterOrder::Second,
    };
}
