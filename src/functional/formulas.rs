//! Elements of a formula: a fixed number of arguments, and derivatives on the stack.

use crate::energy::Energy;
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Gradient, Local, Vector};
use nalgebra::SVector;

/// One element: a formula of `M = 3 NV + NS` arguments, and these.
#[derive(Clone, Debug)]
pub struct Element<E, const M: usize, const NV: usize, const NS: usize> {
    /// The formula.
    pub energy: E,
    /// Vectors, in the order of the arguments.
    pub vectors: [VectorArg; NV],
    /// Scalars of the site, after the vectors.
    pub scalars: [usize; NS],
}

impl<E, const M: usize, const NV: usize, const NS: usize> Element<E, M, NV, NS>
where
    E: Energy<M>,
{
    /// Arguments at the sample and their rates along its direction; a virtual displacement takes the rate as value.
    #[inline(always)]
    fn arguments(&self, order: Order, sample: &Sample<'_>) -> (SVector<f64, M>, SVector<f64, M>) {
        const { assert!(M == 3 * NV + NS) };
        let mut p = SVector::<f64, M>::zeros();
        let mut w = SVector::<f64, M>::zeros();
        for (i, arg) in self.vectors.iter().enumerate() {
            let is_virtual = i < E::VIRTUAL;
            if !is_virtual {
                let value = arg.read(sample.h, sample.vectors);
                p.fixed_rows_mut::<3>(3 * i).copy_from(&value);
            }
            if order == Order::Third {
                let rate = arg.read(sample.h, sample.along);
                let to = if is_virtual { &mut p } else { &mut w };
                to.fixed_rows_mut::<3>(3 * i).copy_from(&rate);
            }
        }
        for (i, &s) in self.scalars.iter().enumerate() {
            p[3 * NV + i] = sample.scalars[s];
            if order == Order::Third {
                w[3 * NV + i] = sample.scalars_along[s];
            }
        }
        (p, w)
    }

    /// Arguments with vectors and rates, of a kinetic energy.
    fn moving(&self, [x, v]: [&[Vector]; 2]) -> SVector<f64, M> {
        let mut p = SVector::<f64, M>::zeros();
        for (i, arg) in self.vectors.iter().enumerate() {
            let read = if arg.stencil == Stencil::Rate { v } else { x };
            p.fixed_rows_mut::<3>(3 * i).copy_from(&read[arg.vector]);
        }
        p
    }

    /// The arguments that are rates.
    fn rates(&self) -> impl Iterator<Item = (usize, &VectorArg)> {
        let all = self.vectors.iter().enumerate();
        all.filter(|(_, arg)| arg.stencil == Stencil::Rate)
    }

    #[inline(always)]
    fn hand<const ORDER: usize>(&self, order: Order, sample: &Sample<'_>, to: &mut impl Scatter) {
        let (p, w) = self.arguments(order, sample);
        let local = self.energy.at::<ORDER>(&p, &w);
        let plain = local.plain::<NV>();
        if const { ORDER == 1 } {
            return to.plain(&Gradient(&plain));
        }
        to.plain(&plain);
        if const { ORDER == 3 } {
            to.along(&plain, &local.along::<NV>());
        } else if const { ORDER == 2 && E::VIRTUAL > 0 } && order == Order::Third {
            // At δx = w the virtual work itself is the contraction with the costates.
            to.along(&plain, &plain);
        }
    }
}

impl<E, const M: usize, const NV: usize, const NS: usize> Kernel for Element<E, M, NV, NS>
where
    E: Energy<M> + 'static,
{
    type Storage = ();

    const DEGREE: usize = E::DEGREE;
    const VIRTUAL: usize = E::VIRTUAL;
    const APPLIED: bool = E::APPLIED;
    const KINETIC: bool = E::KINETIC;
    const READINGS: usize = E::READINGS;
    const ISOTROPIC: bool = E::ISOTROPIC;
    const OF_SQUARES: bool = E::OF_SQUARES;

    fn couples(i: usize, j: usize) -> bool {
        E::couples(i, j)
    }

    #[inline(always)]
    fn vectors(&self) -> usize {
        const { assert!(NV.is_multiple_of(E::READINGS)) };
        NV / E::READINGS
    }

    #[inline(always)]
    fn scalars(&self) -> usize {
        NS
    }

    #[inline(always)]
    fn vector(&self, i: usize) -> VectorArg {
        let arg = self.vectors[i];
        debug_assert_eq!(arg.vector, self.vectors[i % (NV / E::READINGS)].vector);
        arg
    }

    #[inline(always)]
    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        Some((self.scalars[s], 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let (mut p, w) = self.arguments(Order::Gradient, sample);
        for (i, arg) in self.vectors.iter().enumerate().take(E::VIRTUAL) {
            let step = sample.vectors[1][arg.vector] - sample.vectors[0][arg.vector];
            p.fixed_rows_mut::<3>(3 * i).copy_from(&step);
        }
        self.energy.at::<1>(&p, &w).value()
    }

    fn momentum(&self, scale: f64, x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        let p = self.moving([x, v]);
        let local = self.energy.at::<1>(&p, &SVector::zeros());
        let gradient = local.plain::<NV>();
        for (i, arg) in self.rates() {
            out[arg.vector] += gradient.force(i) * scale;
        }
    }

    fn momentum_along(
        &self,
        scale: f64,
        at: [&[Vector]; 2],
        by: [&[Vector]; 2],
        out: &mut [Vector],
    ) {
        let [p, w] = [at, by].map(|of| self.moving(of));
        let local = self.energy.at::<3>(&p, &w);
        let change = local.along::<NV>();
        for (i, arg) in self.rates() {
            out[arg.vector] += change.force(i) * scale;
        }
    }

    #[inline(always)]
    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        debug_assert!(S::receives(order));
        if const { matches!(S::ORDER, Some(Order::Gradient)) } {
            self.hand::<1>(order, sample, to);
        } else if const { matches!(S::ORDER, Some(Order::Hessian)) } {
            self.hand::<2>(order, sample, to);
        } else if order == Order::Gradient {
            self.hand::<1>(order, sample, to);
        } else if const { E::VIRTUAL > 0 } || order == Order::Hessian {
            self.hand::<2>(order, sample, to);
        } else {
            self.hand::<3>(order, sample, to);
        }
    }
}
