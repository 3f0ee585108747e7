//! Elastic and dielectric finite elements: energies W(x̄, φ) of elements of any number of nodes.
//!
//! Nodes are read at the midpoint of an interval, potentials are scalars of the interval.
//!
//! Gent's law whose limit follows a free parameter has energies W(x̄, Jₘ(π)), which are not linear in it. The derivatives of the law by its limit
//! are laws themselves, so that those of an element by π are sums of elements: `∂W/∂π = J′ W_J` and `∂²W/∂π² = J′² W_JJ + J″ W_J`.

use crate::element::{
    Dielectric, Dilatation, Elastomer, ElementGeometry, ElementLaw, Field, FieldPoint,
    IsochoricLaw, Local, Passive, SpatialField, second_derivatives_of_volume,
};
use crate::energy::{Coefficient, NeoHooke};
use crate::functional::{Kernel, Order, Sample, ScalarArg, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};
use std::fmt;
use std::sync::Arc;

/// One finite element: its geometry, its law, and its arguments.
#[derive(Clone, Debug)]
pub struct FiniteElement<F: Electrical, L = NeoHooke, const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law.
    pub law: Elastomer<F, L>,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Sources of the potentials of the nodes; nothing for a passive element.
    pub terminals: F::Terminals<NODES>,
}

/// Map from the scalars of an interval to the potentials of an element.
pub trait Electrical: Field {
    /// One argument a node, or nothing.
    type Terminals<const NODES: usize>: Clone + fmt::Debug + Send + Sync;

    /// Names of the parts of the energy.
    const PARTS: Option<[&'static str; 2]>;

    /// The arguments; none for a passive element.
    fn terminals<const NODES: usize>(terminals: &Self::Terminals<NODES>) -> &[ScalarArg];

    /// Potentials of the nodes.
    fn potentials<const NODES: usize>(potential: impl Fn(usize) -> f64) -> Self::Potentials<NODES>;
}

impl Electrical for Passive {
    type Terminals<const NODES: usize> = ();

    const PARTS: Option<[&'static str; 2]> = None;

    #[inline(always)]
    fn terminals<const NODES: usize>((): &()) -> &[ScalarArg] {
        &[]
    }

    fn potentials<const NODES: usize>(_: impl Fn(usize) -> f64) {}
}

impl Electrical for Dielectric {
    type Terminals<const NODES: usize> = [ScalarArg; NODES];

    const PARTS: Option<[&'static str; 2]> = Some(["elastic", "electric"]);

    #[inline(always)]
    fn terminals<const NODES: usize>(terminals: &[ScalarArg; NODES]) -> &[ScalarArg] {
        terminals
    }

    fn potentials<const NODES: usize>(potential: impl Fn(usize) -> f64) -> [f64; NODES] {
        std::array::from_fn(potential)
    }
}

/// Derivatives of the scalar of an element, and those of its contraction with the direction.
#[derive(Debug, Default)]
pub struct Variations<P, A = P> {
    pub(super) plain: P,
    pub(super) along: A,
}

impl<P: Derivatives, A: Derivatives> Variations<P, A> {
    /// Hands them over.
    #[inline(always)]
    pub(super) fn hand(&self, order: Order, to: &mut impl Scatter) {
        to.plain(&self.plain);
        if order == Order::Third {
            to.along(&self.plain, &self.along);
        }
    }
}

/// Half the sum of both instants.
#[inline(always)]
pub(super) fn middle<const NODES: usize>(
    vectors: [&[Vector]; 2],
    nodes: &[usize; NODES],
) -> [Vector; NODES] {
    nodes.map(|v| (vectors[0][v] + vectors[1][v]) * 0.5)
}

impl<F: Electrical, L, const NODES: usize> FiniteElement<F, L, NODES> {
    fn potentials(&self, scalars: &[f64]) -> F::Potentials<NODES> {
        let terminals = F::terminals::<NODES>(&self.terminals);
        F::potentials::<NODES>(|i| terminals[i].read(scalars))
    }
}

/// The arguments are the nodes, and the scalars their potentials.
impl<F: Field, const NODES: usize> Derivatives for Local<F, NODES> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        self.forces[i]
    }

    #[inline(always)]
    fn row(&self, s: usize) -> f64 {
        F::derivatives::<NODES>(&self.electric).map_or(0.0, |electric| electric.charges[s])
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        self.stiffness[i][j]
    }

    #[inline(always)]
    fn column(&self, i: usize, s: usize) -> Vector {
        let electric = F::derivatives::<NODES>(&self.electric);
        electric.map_or(Vector::zeros(), |electric| electric.coupling[i][s])
    }

    #[inline(always)]
    fn entry(&self, s: usize, t: usize) -> f64 {
        F::derivatives::<NODES>(&self.electric).map_or(0.0, |electric| electric.permittivity[s][t])
    }
}

impl<F: Electrical, L: ElementLaw, const NODES: usize> Kernel for FiniteElement<F, L, NODES> {
    type Storage = Variations<Local<F, NODES>>;

    const PARTS: Option<[&'static str; 2]> = F::PARTS;

    #[inline(always)]
    fn vectors(&self) -> usize {
        NODES
    }

    #[inline(always)]
    fn scalars(&self) -> usize {
        F::terminals::<NODES>(&self.terminals).len()
    }

    #[inline(always)]
    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(self.nodes[i])
    }

    #[inline(always)]
    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        F::terminals::<NODES>(&self.terminals)[s].scalar
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let potentials = self.potentials(sample.scalars);
        self.law.energy(&self.shape, &x, &potentials)
    }

    /// The energy without the field.
    fn first_part(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let law = self.law.passive();
        law.energy(&self.shape, &x, &())
    }

    fn volume(&self, sample: &Sample<'_>) -> Option<Dilatation> {
        let x = middle(sample.vectors, &self.nodes);
        let found = self.law.dilatation(&self.shape, &x)?;
        Some(Dilatation {
            slopes: found.slopes.as_slice().try_into().ok()?,
            stiffness: found.stiffness,
            pressure: found.pressure,
            shear_modulus: found.shear_modulus,
        })
    }

    fn curved_volume(&self, sample: &Sample<'_>) -> Option<[[Matrix; 8]; 8]> {
        let x = middle(sample.vectors, &self.nodes);
        let found = second_derivatives_of_volume(&self.shape, &x);
        let rows = found.iter().map(|row| row.as_slice().try_into().ok());
        let rows: Option<Vec<[Matrix; 8]>> = rows.collect();
        rows?.try_into().ok()
    }

    fn prepare(
        &self,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut Variations<Local<F, NODES>>,
    ) {
        let Self { shape, law, .. } = self;
        let x = middle(sample.vectors, &self.nodes);
        let potentials = self.potentials(sample.scalars);
        match order {
            Order::Gradient => law.gradient(shape, &x, &potentials, plain),
            Order::Hessian => law.tangent(shape, &x, &potentials, plain),
            Order::Third => {
                let w = middle(sample.along, &self.nodes);
                let terminals = F::terminals::<NODES>(&self.terminals);
                let rates = F::potentials::<NODES>(|i| terminals[i].rate(sample.scalars_along));
                law.third(shape, &x, &potentials, &w, &rates, plain, along);
            }
        }
    }

    #[inline(always)]
    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        _: &Sample<'_>,
        variations: &Variations<Local<F, NODES>>,
        to: &mut S,
    ) {
        variations.hand(order, to);
    }
}

/// |e|²/E² at a point of an element, with the nodes at one time of an interval and the potentials of the interval.
#[derive(Clone, Debug)]
pub struct ElementField<const NODES: usize = 8> {
    /// The point.
    pub point: FieldPoint<NODES>,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Sources of the potentials of the nodes.
    pub terminals: [ScalarArg; NODES],
    /// Time at which the nodes are read.
    pub at: Stencil,
}

impl<const NODES: usize> ElementField<NODES> {
    fn field(&self, sample: &Sample<'_>) -> SpatialField<NODES> {
        let read = |vector| self.at.of(vector).read(sample.h, sample.vectors);
        let potentials = self.terminals.map(|arg| arg.read(sample.scalars));
        self.point.at(&self.nodes.map(read), &potentials)
    }
}

/// The arguments are the nodes, and the scalars their potentials.
impl<const NODES: usize> Derivatives for SpatialField<NODES> {
    fn force(&self, i: usize) -> Vector {
        self.by_place(i)
    }

    fn row(&self, s: usize) -> f64 {
        self.by_potential(s)
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        self.by_places(i, j)
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        self.by_place_and_potential(i, s)
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.by_potentials(s, t)
    }
}

impl<const NODES: usize> Kernel for ElementField<NODES> {
    type Storage = ();

    fn vectors(&self) -> usize {
        self.nodes.len()
    }

    fn scalars(&self) -> usize {
        self.terminals.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        self.at.of(self.nodes[i])
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        self.terminals[s].scalar
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        self.field(sample).value()
    }

    /// First and second derivatives: a quantity is asked for no others.
    fn derivatives<S: Scatter>(&self, _: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        to.plain(&self.field(sample));
    }
}

/// One finite element without a field; the parameter is its only scalar.
#[derive(Clone, Debug)]
pub struct VariedElement<const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law, but its limit.
    pub law: Elastomer<Passive, IsochoricLaw>,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Gent's limit Jₘ.
    pub limit: Coefficient,
    /// The parameter that it follows, a scalar of the interval.
    pub parameter: usize,
}

/// Derivatives of the energy W of an element and of W_J and W_JJ, and their rates along the direction.
type LimitVariations<const NODES: usize> = Variations<[Local<Passive, NODES>; 3]>;

/// The limit with its derivatives J′ and J″ by the parameter.
fn limit<const NODES: usize>(element: &VariedElement<NODES>, sample: &Sample<'_>) -> HyperDual {
    let mut number = HyperDual::of(sample.scalars[element.parameter]);
    (number.value.part, number.part.value) = (1.0, 1.0);
    element.limit.at(&[number])
}

impl<const NODES: usize> VariedElement<NODES> {
    /// The element at a limit.
    fn at(&self, limit: f64) -> Elastomer<Passive, IsochoricLaw> {
        self.law.by(IsochoricLaw::Gent { limit })
    }
}

/// Derivatives of a scalar S(x̄, J) from those of itself, S_J and S_JJ.
struct ByLimit<'a, const NODES: usize> {
    of: &'a [Local<Passive, NODES>; 3],
    /// The scalar with S_J and S_JJ, where derivatives by π alone are asked for.
    values: [f64; 3],
    slope: f64,
    curvature: f64,
}

impl<const NODES: usize> Derivatives for ByLimit<'_, NODES> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        self.of[0].forces[i]
    }

    #[inline(always)]
    fn row(&self, _: usize) -> f64 {
        self.slope * self.values[1]
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        self.of[0].stiffness[i][j]
    }

    #[inline(always)]
    fn column(&self, i: usize, _: usize) -> Vector {
        self.of[1].forces[i] * self.slope
    }

    #[inline(always)]
    fn entry(&self, _: usize, _: usize) -> f64 {
        self.slope * self.slope * self.values[2] + self.curvature * self.values[1]
    }
}

impl<const NODES: usize> Kernel for VariedElement<NODES> {
    type Storage = LimitVariations<NODES>;

    #[inline(always)]
    fn vectors(&self) -> usize {
        NODES
    }

    #[inline(always)]
    fn scalars(&self) -> usize {
        1
    }

    #[inline(always)]
    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(self.nodes[i])
    }

    #[inline(always)]
    fn scalar(&self, _: usize) -> Option<(usize, f64)> {
        Some((self.parameter, 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let law = self.at(limit(self, sample).real());
        law.energy(&self.shape, &x, &())
    }

    fn prepare(
        &self,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut LimitVariations<NODES>,
    ) {
        let x = middle(sample.vectors, &self.nodes);
        let w = middle(sample.along, &self.nodes);
        let shape = &self.shape;
        let law = self.at(limit(self, sample).real());
        let [slope, curvature] = law.law.by_limit().expect("it is Gent's law");
        let laws = [law, law.by(slope), law.by(curvature)];
        for ((law, plain), along) in laws.iter().zip(plain).zip(along) {
            match order {
                Order::Gradient => law.gradient(shape, &x, &(), plain),
                Order::Hessian => law.tangent(shape, &x, &(), plain),
                Order::Third => law.third(shape, &x, &(), &w, &(), plain, along),
            }
        }
    }

    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &LimitVariations<NODES>,
        to: &mut S,
    ) {
        let limit = limit(self, sample);
        let by_limit = |of, values| ByLimit {
            of,
            values,
            slope: limit.value.part,
            curvature: limit.part.part,
        };
        let of_energy = by_limit(plain, plain.each_ref().map(|local| local.energy));
        to.plain(&of_energy);
        if order == Order::Third {
            let contractions = along.each_ref().map(|local| local.energy);
            to.along(&of_energy, &by_limit(along, contractions));
        }
    }
}
