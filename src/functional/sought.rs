//! Elements of a formula of one span and of sought parameters, some of which move the ends of the span.
//!
//! The formula reads `r = r₀ + Σ (π_a − π_a⁰) e_a` at the midpoint of an interval, and as a virtual displacement and a rate where it
//! is a virtual work. Its arguments are material vectors r₀, e_a and scalars; the chain rule from the arguments of the formula
//! to these is exact, since r is linear in each of them:
//!
//! ```text
//! ∂/∂v_a = c_a ∂/∂r,     ∂/∂π_a = ∂/∂π_a of the formula + e_a·∂/∂r,     c₀ = 1, c_a = π_a − π_a⁰.
//! ```

use crate::energy::SoughtEnergy;
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Jet, Matrix, Vector};
use nalgebra::{SMatrix, SVector};
use std::fmt;
use std::marker::PhantomData;

/// A parameter that moves the ends of a span.
#[derive(Clone, Copy, Debug)]
pub struct SpanMove {
    /// The vector e.
    pub vector: usize,
    /// Place of the parameter among the scalars of the element.
    pub scalar: usize,
    /// Its value π⁰ at which the span is r₀.
    pub at: f64,
}

/// One element: a formula, its span, and the further arguments that it reads.
#[derive(Clone, Debug)]
pub struct SoughtElement<E, const N: usize> {
    /// The formula.
    pub energy: E,
    /// The vector r₀.
    pub span: usize,
    /// Parameters that move it, as many as N − 1.
    pub moves: Vec<SpanMove>,
    /// Scalars of the interval in the order of the arguments of the formula; `None`: zero.
    pub scalars: Vec<Option<usize>>,
}

/// Elements of one formula of `M` arguments: R readings of a span of N vectors, then scalars.
pub struct SoughtFormulas<E, const M: usize, const R: usize, const N: usize>(PhantomData<E>);

impl<E, const M: usize, const R: usize, const N: usize> fmt::Debug for SoughtFormulas<E, M, R, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "formulas of {M} arguments with sought parameters")
    }
}

/// The arguments of an element, or their rates along the direction.
struct Arguments<const M: usize, const R: usize, const N: usize> {
    /// Factors c of the vectors.
    factors: [f64; N],
    /// Readings of each vector.
    vectors: [[Vector; N]; R],
    /// Arguments of the formula.
    formula: SVector<f64, M>,
}

impl<const M: usize, const R: usize, const N: usize> Arguments<M, R, N> {
    /// Σ c_a v_a of a reading.
    fn span(&self, factors: &[f64; N], reading: usize) -> Vector {
        let parts = self.vectors[reading].iter().zip(factors);
        parts.map(|(v, &c)| v * c).sum()
    }

    /// Derivative of the arguments of the formula by scalar `s`, where `own` is the argument that it is.
    fn by_scalar(&self, moves: &[SpanMove], s: usize, own: f64) -> SVector<f64, M> {
        let mut out = SVector::<f64, M>::zeros();
        out[3 * R + s] = own;
        for (a, _) in moves.iter().enumerate().filter(|(_, m)| m.scalar == s) {
            for (reading, vectors) in self.vectors.iter().enumerate() {
                let mut part = out.fixed_rows_mut::<3>(3 * reading);
                part += vectors[a + 1];
            }
        }
        out
    }
}

/// Gradient and Hessian of the formula, or their rates: ∇f and ∇²f with the factors c and the derivatives of the arguments.
struct OfSpan<'a, const M: usize, const R: usize, const N: usize> {
    moves: &'a [SpanMove],
    at: &'a Arguments<M, R, N>,
    gradient: &'a SVector<f64, M>,
    hessian: &'a SMatrix<f64, M, M>,
}

impl<const M: usize, const R: usize, const N: usize> OfSpan<'_, M, R, N> {
    fn three(vector: &SVector<f64, M>, reading: usize) -> Vector {
        vector.fixed_rows::<3>(3 * reading).into()
    }

    /// Returns true if scalar `s` is the factor of vector `a`.
    fn is_factor(&self, a: usize, s: usize) -> bool {
        a > 0 && self.moves[a - 1].scalar == s
    }

    fn by_scalar(&self, s: usize) -> SVector<f64, M> {
        self.at.by_scalar(self.moves, s, 1.0)
    }
}

impl<const M: usize, const R: usize, const N: usize> Derivatives for OfSpan<'_, M, R, N> {
    fn force(&self, i: usize) -> Vector {
        Self::three(self.gradient, i / N) * self.at.factors[i % N]
    }

    fn row(&self, s: usize) -> f64 {
        self.by_scalar(s).dot(self.gradient)
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let block: Matrix = self
            .hessian
            .fixed_view::<3, 3>(3 * (i / N), 3 * (j / N))
            .into();
        block * (self.at.factors[i % N] * self.at.factors[j % N])
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let (reading, a) = (i / N, i % N);
        let through = self.hessian * self.by_scalar(s);
        let mut column = Self::three(&through, reading) * self.at.factors[a];
        if self.is_factor(a, s) {
            column += Self::three(self.gradient, reading);
        }
        column
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.by_scalar(s).dot(&(self.hessian * self.by_scalar(t)))
    }
}

/// Rates along the direction of what [`OfSpan`] is at the point.
struct SpanRates<'a, const M: usize, const R: usize, const N: usize> {
    plain: OfSpan<'a, M, R, N>,
    /// With the rates of gradient and Hessian in place of them.
    rates: OfSpan<'a, M, R, N>,
    /// Rates of factors and vectors.
    along: &'a Arguments<M, R, N>,
}

impl<const M: usize, const R: usize, const N: usize> SpanRates<'_, M, R, N> {
    fn turned(&self, s: usize) -> SVector<f64, M> {
        self.along.by_scalar(self.plain.moves, s, 0.0)
    }
}

impl<const M: usize, const R: usize, const N: usize> Derivatives for SpanRates<'_, M, R, N> {
    fn force(&self, i: usize) -> Vector {
        let own = OfSpan::<M, R, N>::three(self.plain.gradient, i / N);
        own * self.along.factors[i % N] + self.rates.force(i)
    }

    fn row(&self, s: usize) -> f64 {
        self.turned(s).dot(self.plain.gradient) + self.rates.row(s)
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let (c, w) = (&self.plain.at.factors, &self.along.factors);
        let (a, b) = (i % N, j % N);
        let block: Matrix = self
            .plain
            .hessian
            .fixed_view::<3, 3>(3 * (i / N), 3 * (j / N))
            .into();
        block * (w[a] * c[b] + c[a] * w[b]) + self.rates.block(i, j)
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let (reading, a) = (i / N, i % N);
        let h = self.plain.hessian;
        let through = OfSpan::<M, R, N>::three(&(h * self.plain.by_scalar(s)), reading);
        let turned = OfSpan::<M, R, N>::three(&(h * self.turned(s)), reading);
        let own = through * self.along.factors[a] + turned * self.plain.at.factors[a];
        own + self.rates.column(i, s)
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        let h = self.plain.hessian;
        let one = self.turned(s).dot(&(h * self.plain.by_scalar(t)));
        let other = self.plain.by_scalar(s).dot(&(h * self.turned(t)));
        one + other + self.rates.entry(s, t)
    }
}

impl<E, const M: usize, const R: usize, const N: usize> SoughtFormulas<E, M, R, N>
where
    E: SoughtEnergy<M>,
{
    /// Returns the stencil of the span: at the midpoint; as a virtual displacement, at the midpoint and as a rate.
    fn stencil(reading: usize) -> Stencil {
        match reading {
            2 => Stencil::Rate,
            _ => Stencil::Mid,
        }
    }

    fn vector_of(element: &SoughtElement<E, N>, a: usize) -> usize {
        match a {
            0 => element.span,
            _ => element.moves[a - 1].vector,
        }
    }

    /// Readings of all vectors; `virtual_one` gives the virtual displacement of one.
    fn readings(
        element: &SoughtElement<E, N>,
        h: f64,
        of: [&[Vector]; 2],
        virtual_one: impl Fn(usize) -> Vector,
    ) -> [[Vector; N]; R] {
        std::array::from_fn(|reading| {
            std::array::from_fn(|a| {
                let vector = Self::vector_of(element, a);
                if reading < E::VIRTUAL {
                    return virtual_one(vector);
                }
                let stencil = Self::stencil(reading);
                VectorArg { vector, stencil }.read(h, of)
            })
        })
    }

    /// Arguments at a sample.
    fn at(
        element: &SoughtElement<E, N>,
        sample: &Sample<'_>,
        virtual_one: impl Fn(usize) -> Vector,
    ) -> Arguments<M, R, N> {
        let mut out = Arguments::<M, R, N> {
            factors: [1.0; N],
            vectors: Self::readings(element, sample.h, sample.vectors, virtual_one),
            formula: SVector::<f64, M>::zeros(),
        };
        for (s, scalar) in element.scalars.iter().enumerate() {
            out.formula[3 * R + s] = scalar.map_or(0.0, |scalar| sample.scalars[scalar]);
        }
        for (factor, moved) in out.factors[1..].iter_mut().zip(&element.moves) {
            *factor = out.formula[3 * R + moved.scalar] - moved.at;
        }
        for reading in 0..R {
            let span = out.span(&out.factors, reading);
            out.formula
                .fixed_rows_mut::<3>(3 * reading)
                .copy_from(&span);
        }
        out
    }

    /// Their rates along the direction, where the formula is no virtual work.
    fn along(
        element: &SoughtElement<E, N>,
        sample: &Sample<'_>,
        at: &Arguments<M, R, N>,
    ) -> Arguments<M, R, N> {
        let still = |_: usize| Vector::zeros();
        let mut out = Arguments::<M, R, N> {
            factors: [0.0; N],
            vectors: Self::readings(element, sample.h, sample.along, still),
            formula: SVector::<f64, M>::zeros(),
        };
        for (s, scalar) in element.scalars.iter().enumerate() {
            out.formula[3 * R + s] = scalar.map_or(0.0, |scalar| sample.scalars_along[scalar]);
        }
        for (factor, moved) in out.factors[1..].iter_mut().zip(&element.moves) {
            *factor = out.formula[3 * R + moved.scalar];
        }
        for reading in 0..R {
            let span = out.span(&at.factors, reading) + at.span(&out.factors, reading);
            out.formula
                .fixed_rows_mut::<3>(3 * reading)
                .copy_from(&span);
        }
        out
    }

    fn hand<const ORDER: usize>(
        element: &SoughtElement<E, N>,
        order: Order,
        sample: &Sample<'_>,
        to: &mut impl Scatter,
    ) {
        let is_third = order == Order::Third;
        let at = Self::at(element, sample, |vector| match is_third {
            true => VectorArg {
                vector,
                stencil: Stencil::Mid,
            }
            .read(sample.h, sample.along),
            false => Vector::zeros(),
        });
        let along = (is_third && E::VIRTUAL == 0).then(|| Self::along(element, sample, &at));
        let w = along
            .as_ref()
            .map_or_else(SVector::zeros, |along| along.formula);
        let jet: Jet<M, ORDER> = element.energy.jet(&at.formula, &w);
        let of = |gradient, hessian| OfSpan {
            moves: &element.moves,
            at: &at,
            gradient,
            hessian,
        };
        let plain = of(&jet.gradient, &jet.hessian);
        to.plain(&plain);
        match &along {
            Some(along) => to.along(
                &plain,
                &SpanRates {
                    plain: of(&jet.gradient, &jet.hessian),
                    rates: of(&jet.gradient_w, &jet.hessian_w),
                    along,
                },
            ),
            // At δx = w the virtual work itself is the contraction with the costates.
            None if is_third => to.along(&plain, &plain),
            None => {}
        }
    }
}

impl<E, const M: usize, const R: usize, const N: usize> Kernel for SoughtFormulas<E, M, R, N>
where
    E: SoughtEnergy<M> + 'static,
{
    type Element = SoughtElement<E, N>;
    type Storage = ();

    const VIRTUAL: usize = E::VIRTUAL * N;
    const READINGS: usize = R;

    fn vectors(_: &Self::Element) -> usize {
        N
    }

    fn scalars(element: &Self::Element) -> usize {
        element.scalars.len()
    }

    fn vector(element: &Self::Element, i: usize) -> VectorArg {
        VectorArg {
            vector: Self::vector_of(element, i % N),
            stencil: Self::stencil(i / N),
        }
    }

    fn scalar(element: &Self::Element, s: usize) -> Option<(usize, f64)> {
        element.scalars[s].map(|scalar| (scalar, 1.0))
    }

    fn energy(element: &Self::Element, sample: &Sample<'_>) -> f64 {
        let step = |vector: usize| sample.vectors[1][vector] - sample.vectors[0][vector];
        let at = Self::at(element, sample, step);
        let jet: Jet<M, 1> = element.energy.jet(&at.formula, &SVector::zeros());
        jet.value
    }

    fn derivatives<S: Scatter>(
        element: &Self::Element,
        order: Order,
        sample: &Sample<'_>,
        (): &(),
        to: &mut S,
    ) {
        match (order, E::VIRTUAL) {
            (Order::Gradient, _) => Self::hand::<1>(element, order, sample, to),
            (Order::Third, 0) => Self::hand::<3>(element, order, sample, to),
            _ => Self::hand::<2>(element, order, sample, to),
        }
    }
}
