//! Couplings: pairs of vectors and scalars with mixed second derivatives, and the blocks of these.

use crate::math::{Matrix, Vector};
use nalgebra::SMatrix;
use rustc_hash::FxHashMap;

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

/// Instants of an interval for which a reader asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockMask {
    /// Blocks (k, k), (k, k+1), (k+1, k), (k+1, k+1).
    pub blocks: [bool; 4],
}

impl BlockMask {
    /// All four blocks.
    pub const ALL: Self = Self { blocks: [true; 4] };
    /// All but (k+1, k+1), which is carried on to the next interval.
    pub const CARRIED: Self = Self {
        blocks: [true, true, true, false],
    };
    /// Only the rows of t_k against t_{k+1}: what one step forward needs.
    pub const FORWARD: Self = Self {
        blocks: [false, true, false, false],
    };
    /// Only the block of the first instant: what an instant needs.
    pub const HERE: Self = Self {
        blocks: [true, false, false, false],
    };
}

/// First and second derivatives of a sum on one interval.
#[derive(Clone, Debug, Default)]
pub struct SumDerivatives {
    /// ∂/∂x_k and ∂/∂x_{k+1}.
    pub forces: [Vec<Vector>; 2],
    /// ∂/∂s.
    pub rows: Vec<f64>,
    /// Second derivatives.
    pub blocks: Blocks,
    /// ∂²/∂x∂h at both instants.
    pub horizon_forces: [Vec<Vector>; 2],
    /// ∂²/∂s∂h.
    pub horizon_rows: Vec<f64>,
    /// ∂²/∂h².
    pub horizon: f64,
}

impl SumDerivatives {
    /// Zeros for first derivatives, and for second ones at these couplings.
    pub fn new(vectors: usize, scalars: usize, couplings: Option<&Couplings>) -> Self {
        let zeros = || vec![Vector::zeros(); vectors];
        let blocks = |c: &Couplings| Blocks {
            full: vec![[Matrix::zeros(); 4]; c.full.len()],
            isotropic: vec![[0.0; 4]; c.isotropic.len()],
            mixed: vec![[Vector::zeros(); 2]; c.mixed.len()],
            scalars: vec![0.0; c.scalars.len()],
        };
        Self {
            forces: [zeros(), zeros()],
            rows: vec![0.0; scalars],
            blocks: couplings.map(blocks).unwrap_or_default(),
            horizon_forces: [zeros(), zeros()],
            horizon_rows: vec![0.0; scalars],
            horizon: 0.0,
        }
    }

    /// Back to zero, first derivatives alone or second ones too.
    pub fn clear(&mut self, second: bool) {
        self.forces.iter_mut().for_each(|side| clear(side));
        self.rows.fill(0.0);
        if !second {
            return;
        }
        clear(self.blocks.full.as_flattened_mut());
        self.blocks.isotropic.as_flattened_mut().fill(0.0);
        clear(self.blocks.mixed.as_flattened_mut());
        self.blocks.scalars.fill(0.0);
        self.horizon_forces.iter_mut().for_each(|side| clear(side));
        self.horizon_rows.fill(0.0);
        self.horizon = 0.0;
    }
}

/// Number by number, which is one call for all bytes.
fn clear<const R: usize, const C: usize>(list: &mut [SMatrix<f64, R, C>]) {
    for one in list {
        one.as_mut_slice().fill(0.0);
    }
}
