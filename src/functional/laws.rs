//! Elements of a formula whose constants are functions of free parameters, some of which move the points that it reads.
//!
//! The formula is that of elements without parameters, over [`Dual`] numbers where derivatives by parameters are asked for. Parameters π have
//! no equation, hence no direction, so that three derivatives are shared out. With the contraction D = ∇E·w,
//!
//! ```text
//! ∂²D/∂x∂x    the plain formula, third order, as where nothing is sought
//! ∂²D/∂x∂π    ∂/∂π of ∇²E w: the formula with a seeded parameter, second order
//! ∂²D/∂π∂π    ∂²/∂π∂π of ∇E·w: the formula with two seeded parameters, first order
//! ```
//!
//! A parameter that moves a point changes the vectors r that the formula reads: `r = r₀ + Σ c_a e_a` with the factors c_a = π_a − π_a⁰ and
//! material vectors e_a, which are arguments of the element like r₀.

use crate::energy::{Energy, Law};
use crate::functional::{Element, Kernel, Order, ParameterOrder, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, Dual, Gradient, HyperDual, Local, Matrix, Number, Vector};
use nalgebra::{SVector, Vector3};
use smallvec::SmallVec;

/// The formula over plain numbers.
type Plain<L, const M: usize> = <L as Law<M>>::Formula<f64>;

/// An element at a sample, with its parameters.
struct Evaluation<'a, L, const M: usize, const NV: usize, const NS: usize> {
    element: &'a LawElement<L, M, NV, NS>,
    order: Order,
    sample: &'a Sample<'a>,
    values: Values<f64>,
}

impl<'a, L: Law<M>, const M: usize, const NV: usize, const NS: usize> Evaluation<'a, L, M, NV, NS> {
    /// Number of vectors of the formula.
    const BASE: usize = NV / Plain::<L, M>::READINGS;
    /// Leading arguments of the formula that are virtual displacements.
    const VIRTUAL: usize = Plain::<L, M>::VIRTUAL;

    fn new(element: &'a LawElement<L, M, NV, NS>, order: Order, sample: &'a Sample<'a>) -> Self {
        let mut values = [0.0; MOST_PARAMETERS];
        for (value, &scalar) in values.iter_mut().zip(&element.parameters) {
            *value = sample.scalars[scalar];
        }
        Self {
            element,
            order,
            sample,
            values,
        }
    }

    fn parameters(&self) -> &[f64] {
        &self.values[..self.element.parameters.len()]
    }

    /// Vectors of the formula at parameters, each of what `read` reads.
    #[inline(always)]
    fn moved<T: Number>(
        &self,
        parameters: &[T],
        read: impl Fn(usize, VectorArg) -> Vector,
    ) -> SVector<T, M> {
        let mut p = SVector::<T, M>::zeros();
        for (i, &arg) in self.element.vectors.iter().enumerate() {
            let mut value: Vector3<T> = read(i, arg).map(T::of);
            let moves = self.element.moves.iter();
            for one in moves.filter(|one| one.of == i % Self::BASE) {
                let along = read(i, arg.stencil.of(one.vector));
                value += along.map(T::of) * parameters[one.parameter].shifted(-one.at);
            }
            p.fixed_rows_mut::<3>(3 * i).copy_from(&value);
        }
        p
    }

    /// Arguments of the formula at a sample; a virtual displacement takes the direction.
    #[inline(always)]
    fn point<T: Number>(&self, parameters: &[T]) -> SVector<T, M> {
        const { assert!(M == 3 * NV + NS && Self::VIRTUAL.is_multiple_of(Self::BASE)) };
        let sample = self.sample;
        let mut p = self.moved(parameters, |i, arg| match (i < Self::VIRTUAL, self.order) {
            (false, _) => arg.read(sample.h, sample.vectors),
            (true, Order::Third) => arg.read(sample.h, sample.along),
            (true, _) => Vector::zeros(),
        });
        for (i, &s) in self.element.scalars.iter().enumerate() {
            p[3 * NV + i] = T::of(sample.scalars[s]);
        }
        p
    }

    /// Rates of the arguments along the direction, where the formula is no virtual work.
    #[inline(always)]
    fn direction<T: Number>(&self, parameters: &[T]) -> SVector<T, M> {
        let sample = self.sample;
        let mut w = self.moved(parameters, |_, arg| arg.read(sample.h, sample.along));
        for (i, &s) in self.element.scalars.iter().enumerate() {
            w[3 * NV + i] = T::of(sample.scalars_along[s]);
        }
        w
    }

    /// Fills first derivatives by the seeded parameter, and where the contraction is asked for, those of it.
    fn first<const ORDER: usize>(
        &self,
        seeded: &[Dual<f64>],
        plain: &mut ByParameter<NV, NS>,
        along: Option<&mut ByParameter<NV, NS>>,
    ) {
        let p = self.point(seeded);
        let formula = self.element.law.formula(seeded);
        let local = formula.at::<ORDER>(&p, &SVector::zeros());
        let d = local.plain::<NV>();
        plain.row = local.value().part;
        for i in 0..NV {
            plain.column[i] = d.force(i).map(|x| x.part);
        }
        for s in 0..NS {
            plain.mixed[s] = d.row(s).part;
        }
        let Some(along) = along else {
            return;
        };
        let w = self.direction(seeded);
        let vector = |i: usize| -> Vector3<Dual<f64>> { w.fixed_rows::<3>(3 * i).into() };
        for i in 0..NV {
            let mut turned = Vector3::<Dual<f64>>::zeros();
            for j in (0..NV).filter(|&j| Plain::<L, M>::couples(i, j)) {
                turned += d.block(i, j) * vector(j);
            }
            for s in 0..NS {
                turned += d.column(i, s) * w[3 * NV + s];
            }
            along.column[i] = turned.map(|x| x.part);
        }
        for s in 0..NS {
            let mut turned = Dual::of(0.0);
            for i in 0..NV {
                turned += d.column(i, s).dot(&vector(i));
            }
            for t in 0..NS {
                turned += d.entry(s, t) * w[3 * NV + t];
            }
            along.mixed[s] = turned.part;
        }
        along.row = contraction::<_, _, NV, NS, M>(&d, &w).part;
    }

    /// Fills the second derivative by the seeded parameters, `b` one of them, and where it is asked for, that of the contraction.
    fn second(
        &self,
        b: usize,
        seeded: &[HyperDual],
        plain: &mut ByParameter<NV, NS>,
        along: Option<&mut ByParameter<NV, NS>>,
    ) {
        let p = self.point(seeded);
        let formula = self.element.law.formula(seeded);
        let local = formula.at::<1>(&p, &SVector::zeros());
        plain.entries[b] = local.value().part.part;
        if let Some(along) = along {
            let w = self.direction(seeded);
            let value = contraction::<_, _, NV, NS, M>(&local.plain::<NV>(), &w);
            along.entries[b] = value.part.part;
        }
    }

    /// Fills all derivatives by parameters, those by two of them where `pairs` are asked for.
    fn by_parameters(
        &self,
        pairs: bool,
        plain: &mut [ByParameter<NV, NS>],
        mut along: Option<&mut [ByParameter<NV, NS>]>,
    ) {
        let count = self.element.parameters.len();
        for (a, plain) in plain.iter_mut().enumerate() {
            let mut seeded = self.values.map(Dual::of);
            seeded[a].part = 1.0;
            let seeds = &seeded[..count];
            match along.as_deref_mut() {
                None => self.first::<1>(seeds, plain, None),
                Some(along) => self.first::<2>(seeds, plain, Some(&mut along[a])),
            }
            for b in (0..=a).filter(|_| pairs) {
                let mut seeded = self.values.map(HyperDual::of);
                seeded[a].value.part = 1.0;
                seeded[b].part.value = 1.0;
                let along = along.as_deref_mut().map(|along| &mut along[a]);
                self.second(b, &seeded[..count], plain, along);
            }
        }
    }

    fn of_element<'e, D: Derivatives>(
        &'e self,
        formula: D,
        by: &'e [ByParameter<NV, NS>],
    ) -> OfElement<'e, D, L, M, NV, NS> {
        OfElement {
            element: self.element,
            values: &self.values,
            base: Self::BASE,
            couples: Plain::<L, M>::couples,
            formula,
            by,
        }
    }

    /// Derivatives up to an order: of the formula by its arguments, and by parameters where `of_parameters` alone or the sample asks for them.
    /// It knows no receiver, so that it is compiled once for all.
    fn evaluated<const ORDER: usize>(
        &self,
        of_parameters: bool,
        [by, by_along]: [&mut ByParameters<NV, NS>; 2],
    ) -> <Plain<L, M> as Energy<M>>::Local<ORDER> {
        let (order, parameters) = (self.order, self.parameters());
        let p = self.point(parameters);
        let w = match const { ORDER == 3 } {
            true => self.direction(parameters),
            false => SVector::zeros(),
        };
        by.resize(parameters.len(), ByParameter::ZERO);
        if const { ORDER == 3 } {
            by_along.resize(parameters.len(), ByParameter::ZERO);
        }
        let asked = self.sample.sides.parameters;
        if of_parameters || (order > Order::Gradient && asked != ParameterOrder::None) {
            let pairs = match order {
                Order::Gradient => false,
                Order::Hessian => of_parameters,
                Order::Third => asked == ParameterOrder::Second,
            };
            let along = const { ORDER == 3 }.then_some(&mut by_along[..]);
            self.by_parameters(pairs, by, along);
        }
        self.element.law.formula(parameters).at::<ORDER>(&p, &w)
    }

    fn hand<const ORDER: usize, S: Scatter>(&self, to: &mut S) {
        let (mut by, mut by_along) = (ByParameters::new(), ByParameters::new());
        let local = self.evaluated::<ORDER>(S::OF_PARAMETERS, [&mut by, &mut by_along]);
        let plain = self.of_element(local.plain::<NV>(), &by);
        if const { ORDER == 1 } {
            return to.plain(&Gradient(&plain));
        }
        to.plain(&plain);
        if const { ORDER == 3 } {
            to.along(&plain, &self.of_element(local.along::<NV>(), &by_along));
        } else if const { ORDER == 2 && Self::VIRTUAL > 0 } && self.order == Order::Third {
            // At δx = w the virtual work itself is the contraction with the costates.
            to.along(&plain, &plain);
        }
    }
}

impl<L: Law<M>, const M: usize, const NV: usize, const NS: usize> Kernel
    for LawElement<L, M, NV, NS>
{
    type Storage = ();

    const VIRTUAL: usize = Plain::<L, M>::VIRTUAL;
    const APPLIED: bool = Plain::<L, M>::APPLIED;
    const KINETIC: bool = Plain::<L, M>::KINETIC;
    const READINGS: usize = Plain::<L, M>::READINGS;
    const ISOTROPIC: bool = Plain::<L, M>::ISOTROPIC;

    fn virtuals(&self) -> usize {
        let readings = Self::VIRTUAL.checked_div(Evaluation::<L, M, NV, NS>::BASE);
        readings.unwrap_or(0) * self.vectors()
    }

    fn vectors(&self) -> usize {
        Evaluation::<L, M, NV, NS>::BASE + self.moves.len()
    }

    fn scalars(&self) -> usize {
        NS + self.parameters.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        let vectors = self.vectors();
        let (reading, a, base) = (i / vectors, i % vectors, Evaluation::<L, M, NV, NS>::BASE);
        match a.checked_sub(base) {
            None => self.vectors[reading * base + a],
            Some(moved) => {
                let Move { of, vector, .. } = self.moves[moved];
                let VectorArg { stencil, .. } = self.vectors[reading * base + of];
                VectorArg { vector, stencil }
            }
        }
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        let scalar = match s.checked_sub(NS) {
            None => self.scalars[s],
            Some(a) => self.parameters[a],
        };
        Some((scalar, 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let at = Evaluation::<L, M, NV, NS>::new(self, Order::Gradient, sample);
        let parameters = at.parameters();
        let mut p = at.moved(parameters, |i, arg| match i < Self::VIRTUAL {
            true => sample.vectors[1][arg.vector] - sample.vectors[0][arg.vector],
            false => arg.read(sample.h, sample.vectors),
        });
        for (i, &s) in self.scalars.iter().enumerate() {
            p[3 * NV + i] = sample.scalars[s];
        }
        let formula = self.law.formula(parameters);
        formula.at::<1>(&p, &SVector::zeros()).value()
    }

    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        debug_assert!(S::receives(order));
        let at = Evaluation::<L, M, NV, NS>::new(self, order, sample);
        if const { matches!(S::ORDER, Some(Order::Gradient)) } {
            at.hand::<1, S>(to);
        } else if const { matches!(S::ORDER, Some(Order::Hessian)) } {
            at.hand::<2, S>(to);
        } else if order == Order::Gradient {
            at.hand::<1, S>(to);
        } else if const { Self::VIRTUAL > 0 } || order == Order::Hessian {
            at.hand::<2, S>(to);
        } else {
            at.hand::<3, S>(to);
        }
    }
}

/// Most parameters that one element reads: as many as a law has constants, each of which follows one or is given. A muscle under voltage by a
/// law of two terms has six components of its ends, a prestretch, two sides, a layer, a modulus, three constants of the law and three of the
/// field.
pub const MOST_PARAMETERS: usize = 17;

/// A parameter that moves a point which an element reads.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Place of the moved vector among those of the element.
    pub of: usize,
    /// The vector e along which it moves.
    pub vector: usize,
    /// Place of the parameter among those of the element.
    pub parameter: usize,
    /// Its value π⁰ at which the vector is what it is without the move.
    pub at: f64,
}

/// One element: a law of `M = 3 NV + NS` arguments, these, and the parameters that it reads.
#[derive(Clone, Debug)]
pub struct LawElement<L, const M: usize, const NV: usize, const NS: usize> {
    /// The law.
    pub law: L,
    /// Vectors, in the order of the arguments.
    pub vectors: [VectorArg; NV],
    /// Scalars of the interval, after the vectors.
    pub scalars: [usize; NS],
    /// Parameters, scalars of the interval, no more than [`MOST_PARAMETERS`].
    pub parameters: Vec<usize>,
    /// Those that move points.
    pub moves: Vec<Move>,
}

impl<L: Law<M>, const M: usize, const NV: usize, const NS: usize> LawElement<L, M, NV, NS> {
    /// The element of a formula that it is where it reads no parameter.
    pub fn given(&self) -> Option<Element<L::Formula<f64>, M, NV, NS>> {
        self.parameters.is_empty().then(|| Element {
            energy: self.law.formula(&[]),
            vectors: self.vectors,
            scalars: self.scalars,
        })
    }
}

/// Values of the parameters of an element, as many as it has.
pub(super) type Values<T> = [T; MOST_PARAMETERS];

/// First and second derivatives by one parameter.
#[derive(Clone, Copy)]
pub(super) struct ByParameter<const NV: usize, const NS: usize> {
    pub(super) row: f64,
    pub(super) column: [Vector; NV],
    pub(super) mixed: [f64; NS],
    /// By this parameter and those up to it.
    pub(super) entries: Values<f64>,
}

/// First and second derivatives by the parameters of an element.
pub(super) type ByParameters<const NV: usize, const NS: usize> =
    SmallVec<[ByParameter<NV, NS>; MOST_PARAMETERS]>;

impl<const NV: usize, const NS: usize> ByParameter<NV, NS> {
    pub(super) const ZERO: Self = Self {
        row: 0.0,
        column: [Vector::new(0.0, 0.0, 0.0); NV],
        mixed: [0.0; NS],
        entries: [0.0; MOST_PARAMETERS],
    };
}

/// Derivatives by the arguments of an element from those by the arguments of its formula, or rates from rates.
pub(super) struct OfElement<'a, D, L, const M: usize, const NV: usize, const NS: usize> {
    pub(super) element: &'a LawElement<L, M, NV, NS>,
    pub(super) values: &'a Values<f64>,
    /// Number of vectors of the formula.
    pub(super) base: usize,
    /// Says which vectors of the formula have mixed second derivatives.
    pub(super) couples: fn(usize, usize) -> bool,
    pub(super) formula: D,
    pub(super) by: &'a [ByParameter<NV, NS>],
}

impl<D: Derivatives, L, const M: usize, const NV: usize, const NS: usize>
    OfElement<'_, D, L, M, NV, NS>
{
    /// Argument of the formula that argument `i` of the element enters, the factor, and the parameter that is the factor.
    fn argument(&self, i: usize) -> (usize, f64, Option<usize>) {
        let vectors = self.base + self.element.moves.len();
        let (reading, a) = (i / vectors, i % vectors);
        match a.checked_sub(self.base) {
            None => (reading * self.base + a, 1.0, None),
            Some(moved) => {
                let Move {
                    of, parameter, at, ..
                } = self.element.moves[moved];
                let factor = self.values[parameter] - at;
                (reading * self.base + of, factor, Some(parameter))
            }
        }
    }
}

impl<D: Derivatives, L, const M: usize, const NV: usize, const NS: usize> Derivatives
    for OfElement<'_, D, L, M, NV, NS>
{
    fn force(&self, i: usize) -> Vector {
        let (argument, factor, _) = self.argument(i);
        self.formula.force(argument) * factor
    }

    fn row(&self, s: usize) -> f64 {
        match s.checked_sub(NS) {
            None => self.formula.row(s),
            Some(a) => self.by[a].row,
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let ((i, c, _), (j, d, _)) = (self.argument(i), self.argument(j));
        match (self.couples)(i, j) {
            true => self.formula.block(i, j) * (c * d),
            false => Matrix::zeros(),
        }
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let (argument, factor, own) = self.argument(i);
        match s.checked_sub(NS) {
            None => self.formula.column(argument, s) * factor,
            Some(a) if own == Some(a) => {
                self.by[a].column[argument] * factor + self.formula.force(argument)
            }
            Some(a) => self.by[a].column[argument] * factor,
        }
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        match (s.checked_sub(NS), t.checked_sub(NS)) {
            (None, None) => self.formula.entry(s, t),
            (Some(a), None) => self.by[a].mixed[t],
            (None, Some(b)) => self.by[b].mixed[s],
            (Some(a), Some(b)) => self.by[a.max(b)].entries[a.min(b)],
        }
    }
}

/// ∇E·w.
pub(super) fn contraction<
    T: Number,
    D: Derivatives<T>,
    const NV: usize,
    const NS: usize,
    const M: usize,
>(
    d: &D,
    w: &SVector<T, M>,
) -> T {
    let mut sum = T::zero();
    for i in 0..NV {
        let along: Vector3<T> = w.fixed_rows::<3>(3 * i).into();
        sum += d.force(i).dot(&along);
    }
    for s in 0..NS {
        sum += d.row(s) * w[3 * NV + s];
    }
    sum
}
