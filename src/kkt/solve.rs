//! Solution with factors: forward along the fronts, backward against them.

use pulp::{Arch, Simd, WithSimd};

use super::lanes::{dot, subtract};
use super::numeric::{Block, Factors};

/// Replaces a right-hand side by the solution; `work` holds the largest front.
pub(super) fn solve(factors: &Factors, x: &mut [f64], work: &mut Vec<f64>) {
    if work.len() < factors.largest {
        work.resize(factors.largest, 0.0);
    }
    Arch::new().dispatch(Solve { factors, x, work });
}

struct Solve<'a> {
    factors: &'a Factors,
    x: &'a mut [f64],
    work: &'a mut [f64],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Solve { factors, x, work } = self;
        for block in &factors.blocks {
            forward(unit, factors, block, x, work);
        }
        for block in factors.blocks.iter().rev() {
            backward(unit, factors, block, x, work);
        }
    }
}

/// `L y = b` on the rows of one block.
#[inline(always)]
fn forward<S: Simd>(unit: S, factors: &Factors, block: &Block, x: &mut [f64], work: &mut [f64]) {
    let unknowns = &factors.unknowns[block.unknowns..][..block.order];
    let work = &mut work[..block.order];
    gather(x, unknowns, work);
    let mut columns = &factors.columns[block.columns..];
    for j in 0..block.eliminated {
        let (pivot, below) = work[j..].split_first_mut().expect("a row for each column");
        let (column, rest) = columns.split_at(below.len());
        subtract(unit, below, column, *pivot);
        columns = rest;
    }
    for (&i, value) in unknowns.iter().zip(&*work) {
        x[i as usize] = *value;
    }
}

/// `D Lᵀ x = y` on the rows of one block.
#[inline(always)]
fn backward<S: Simd>(unit: S, factors: &Factors, block: &Block, x: &mut [f64], work: &mut [f64]) {
    let unknowns = &factors.unknowns[block.unknowns..][..block.order];
    let work = &mut work[..block.order];
    gather(x, unknowns, work);
    let count = block.eliminated;
    divide(&factors.pivots[block.pivots..][..count], &mut work[..count]);
    let length = |j: usize| block.order - j - 1;
    let total: usize = (0..count).map(length).sum();
    let mut columns = &factors.columns[block.columns..][..total];
    for j in (0..count).rev() {
        let (rest, column) = columns.split_at(columns.len() - length(j));
        let (pivot, below) = work[j..].split_first_mut().expect("a row for each column");
        *pivot -= dot(unit, column, below);
        columns = rest;
    }
    for (&i, value) in unknowns[..count].iter().zip(&*work) {
        x[i as usize] = *value;
    }
}

#[inline(always)]
fn gather(x: &[f64], unknowns: &[u32], work: &mut [f64]) {
    for (value, &i) in work.iter_mut().zip(unknowns) {
        *value = x[i as usize];
    }
}

/// `x ← D⁻¹ x`.
#[inline(always)]
fn divide(pivots: &[[f64; 2]], x: &mut [f64]) {
    let mut j = 0;
    while j < x.len() {
        let [diagonal, below] = pivots[j];
        if below == 0.0 {
            x[j] *= diagonal;
            j += 1;
        } else {
            let (y, z) = (x[j], x[j + 1]);
            x[j] = diagonal * y + below * z;
            x[j + 1] = below * y + pivots[j + 1][0] * z;
            j += 2;
        }
    }
}
