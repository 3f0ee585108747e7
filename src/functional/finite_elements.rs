//! Elastic and dielectric finite elements: energies W(x̄, φ) of elements of any number of nodes.
//!
//! Nodes are read at the midpoint of an interval, potentials are scalars of the interval.
//!
//! Gent's law whose limit follows a free parameter has energies W(x̄, Jₘ(π)), which are not linear in it. The derivatives of the law by its limit
//! are laws themselves, so that those of an element by π are sums of elements: `∂W/∂π = J′ W_J` and `∂²W/∂π² = J′² W_JJ + J″ W_J`.

use crate::element::{
    Dielectric, Dilatation, Elastomer, ElementEnergy, ElementGeometry, ElementLaw, Field,
    FieldPoint, IsochoricLaw, Local, NodeState, Passive, SpatialField,
    second_derivatives_of_volume,
};
use crate::energy::NeoHooke;
use crate::functional::scaled::{Factor, FreeConstant, OfConstant};
use crate::functional::{Kernel, Order, Sample, ScalarArg, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
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

impl<P> Variations<P> {
    /// Fills them up to an order by an energy at a state, and by its rates along the direction.
    pub(super) fn fill<E: ElementEnergy<NODES, Local = P>, const NODES: usize>(
        &mut self,
        order: Order,
        law: &E,
        at: NodeState<'_, E::Arguments, NODES>,
        rates: impl FnOnce() -> ([Vector; NODES], E::Arguments),
    ) {
        let Self { plain, along } = self;
        match order {
            Order::Gradient => law.gradient(&at, plain),
            Order::Hessian => law.tangent(&at, plain),
            Order::Third => {
                let (w, rates) = rates();
                law.third(&at.along(&w, &rates), plain, along);
            }
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
        let at = NodeState::new(&self.shape, &x, &potentials);
        self.law.energy(&at)
    }

    /// The energy without the field.
    fn first_part(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let law = self.law.passive();
        law.energy(&NodeState::new(&self.shape, &x, &()))
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

    fn prepare(&self, order: Order, sample: &Sample<'_>, to: &mut Self::Storage) {
        let x = middle(sample.vectors, &self.nodes);
        let potentials = self.potentials(sample.scalars);
        let at = NodeState::new(&self.shape, &x, &potentials);
        to.fill(order, &self.law, at, || {
            let terminals = F::terminals::<NODES>(&self.terminals);
            let rates = F::potentials::<NODES>(|i| terminals[i].rate(sample.scalars_along));
            (middle(sample.along, &self.nodes), rates)
        });
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

/// One finite element without a field whose limit follows a parameter, its only scalar.
#[derive(Clone, Debug)]
pub struct VariedElement<const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law, but its limit.
    pub law: Elastomer<Passive, IsochoricLaw>,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Gent's limit Jₘ.
    pub limit: FreeConstant,
}

impl<const NODES: usize> VariedElement<NODES> {
    /// The law at a sample.
    fn law(&self, sample: &Sample<'_>) -> Elastomer<Passive, IsochoricLaw> {
        let limit = self.limit.value(sample);
        self.law.by(IsochoricLaw::Gent { limit })
    }
}

impl<const NODES: usize> Kernel for VariedElement<NODES> {
    /// Derivatives of the energy W of an element and of W_J and W_JJ.
    type Storage = [Variations<Local<Passive, NODES>>; 3];

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
        Some((self.limit.parameters[0], 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let at = NodeState::new(&self.shape, &x, &());
        self.law(sample).energy(&at)
    }

    fn prepare(&self, order: Order, sample: &Sample<'_>, storage: &mut Self::Storage) {
        let x = middle(sample.vectors, &self.nodes);
        let at = NodeState::new(&self.shape, &x, &());
        let law = self.law(sample);
        let [slope, curvature] = law.law.by_limit().expect("it is Gent's law");
        let laws = [law, law.by(slope), law.by(curvature)];
        for (law, to) in laws.iter().zip(storage) {
            to.fill(order, law, at, || (middle(sample.along, &self.nodes), ()));
        }
    }

    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        sample: &Sample<'_>,
        storage: &Self::Storage,
        to: &mut S,
    ) {
        let factor = self.limit.factor(sample);
        let plain = by_limit(factor, storage.each_ref().map(|one| &one.plain));
        to.plain(&plain);
        if order == Order::Third {
            let along = storage.each_ref().map(|one| &one.along);
            to.along(&plain, &by_limit(factor, along));
        }
    }
}

/// Derivatives of an energy by nodes and the parameter of its limit, from those of itself and of its derivatives by the limit.
fn by_limit<const NODES: usize>(
    factor: Factor,
    [of, slope, curvature]: [&Local<Passive, NODES>; 3],
) -> OfConstant<'_, Local<Passive, NODES>> {
    OfConstant {
        scale: 1.0,
        factor,
        base: 0,
        of: [of, slope],
        values: [slope.energy, curvature.energy],
    }
}
