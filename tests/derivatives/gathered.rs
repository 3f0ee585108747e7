//! Blocks of an energy gathered to one gradient and one Hessian.

use crate::naive_formulas::Formula;
use nalgebra::{SMatrix, SVector};
use proboscis::math::{Derivatives, Jet, Local};

/// Gradient and Hessian, block by block as sums over elements read them.
fn gathered<E: Formula<M>, const M: usize>(
    of: &impl Derivatives,
) -> (SVector<f64, M>, SMatrix<f64, M, M>) {
    let mut gradient = SVector::<f64, M>::zeros();
    let mut hessian = SMatrix::<f64, M, M>::zeros();
    let (vectors, scalars) = (E::VECTORS, M - 3 * E::VECTORS);
    for i in 0..vectors {
        gradient.fixed_rows_mut::<3>(3 * i).copy_from(&of.force(i));
        for j in 0..vectors {
            hessian
                .fixed_view_mut::<3, 3>(3 * i, 3 * j)
                .copy_from(&of.block(i, j));
        }
        for s in 0..scalars {
            let (column, at) = (of.column(i, s), 3 * vectors + s);
            hessian.fixed_view_mut::<3, 1>(3 * i, at).copy_from(&column);
            hessian
                .fixed_view_mut::<1, 3>(at, 3 * i)
                .copy_from(&column.transpose());
        }
    }
    for s in 0..scalars {
        gradient[3 * vectors + s] = of.row(s);
        for t in 0..scalars {
            hessian[(3 * vectors + s, 3 * vectors + t)] = of.entry(s, t);
        }
    }
    (gradient, hessian)
}

/// Derivatives of an energy up to an order; nothing along w of a virtual work, which is never asked for it.
pub(crate) fn jet_of<E: Formula<M>, const M: usize, const ORDER: usize>(
    energy: &E,
    p: &SVector<f64, M>,
    w: &SVector<f64, M>,
) -> Jet<M, ORDER> {
    fn both<E: Formula<M>, const M: usize, const NV: usize>(
        local: &impl Local,
    ) -> [(SVector<f64, M>, SMatrix<f64, M, M>); 2] {
        let along = gathered::<E, M>(&local.along::<NV>());
        [gathered::<E, M>(&local.plain::<NV>()), along]
    }
    let local = energy.at::<ORDER>(p, w);
    let [plain, along] = match E::VECTORS {
        0 => both::<E, M, 0>(&local),
        1 => both::<E, M, 1>(&local),
        2 => both::<E, M, 2>(&local),
        3 => both::<E, M, 3>(&local),
        4 => both::<E, M, 4>(&local),
        5 => both::<E, M, 5>(&local),
        6 => both::<E, M, 6>(&local),
        8 => both::<E, M, 8>(&local),
        9 => both::<E, M, 9>(&local),
        10 => both::<E, M, 10>(&local),
        12 => both::<E, M, 12>(&local),
        15 => both::<E, M, 15>(&local),
        21 => both::<E, M, 21>(&local),
        24 => both::<E, M, 24>(&local),
        count => unreachable!("no formula of {count} vectors"),
    };
    let mut jet = Jet::constant(local.value());
    (jet.gradient, jet.hessian) = plain;
    if ORDER == 3 && E::VIRTUAL == 0 {
        (jet.gradient_w, jet.hessian_w) = along;
    }
    jet
}
