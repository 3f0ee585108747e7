//! First and second derivatives of a sum on one interval.

use crate::functional::{Blocks, Couplings, NodeBlocks};
use crate::math::{Matrix, Vector};
use nalgebra::SMatrix;

/// First and second derivatives of a sum on one interval.
#[derive(Clone, Debug, Default)]
pub struct SumDerivatives {
    /// ∂/∂x_k and ∂/∂x_{k+1}.
    pub forces: [Vec<Vector>; 2],
    /// ∂/∂s.
    pub rows: Vec<f64>,
    /// Second derivatives.
    pub blocks: Blocks,
    /// Matrix of nodes on box grids to which second derivatives are added in place of the blocks.
    pub nodes: Option<NodeBlocks>,
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
            nodes: None,
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

/// Derivatives of a function c of a quantity m by its value: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outer {
    /// c′: the costate of a constraint, the slope of a cost.
    pub slope: f64,
    /// c″: zero of a constraint.
    pub curvature: f64,
}

impl Outer {
    /// A function that is linear in the quantity.
    pub fn linear(slope: f64) -> Self {
        Self {
            slope,
            curvature: 0.0,
        }
    }

    /// Returns true if nothing depends on the quantity.
    pub fn is_zero(self) -> bool {
        self.slope == 0.0 && self.curvature == 0.0
    }
}
