//! Elastic and dielectric hexahedra: energies W(x̄, φ) of finite elements.
//!
//! Nodes are read at the midpoint of an interval, potentials are scalars of the interval.

use crate::element::{Dielectric, Elastomer, ElementGeometry, Field, Local, Passive};
use crate::functional::{
    Derivatives, Kernel, Order, Sample, ScalarArg, Scatter, Stencil, VectorArg,
};
use crate::math::{Matrix, Vector};
use std::fmt;
use std::marker::PhantomData;

/// One hexahedron: its geometry, its law, and what it reads.
#[derive(Clone, Debug)]
pub struct Hexahedron<F: Electrical> {
    /// Gradients of the shape functions.
    pub shape: ElementGeometry,
    /// The law.
    pub law: Elastomer<F>,
    /// Vectors of the nodes.
    pub nodes: [usize; 8],
    /// Where the potentials of the nodes come from; nothing for a passive element.
    pub terminals: F::Terminals,
}

/// How the potentials of an element follow from the scalars of an interval.
pub trait Electrical: Field {
    /// One argument a node, or nothing.
    type Terminals: Clone + fmt::Debug + Send + Sync;

    /// Names of the parts of the energy.
    const PARTS: Option<[&'static str; 2]>;

    /// The arguments; none for a passive element.
    fn terminals(terminals: &Self::Terminals) -> &[ScalarArg];

    /// Potentials of the nodes.
    fn potentials(potential: impl Fn(usize) -> f64) -> Self::Potentials;
}

impl Electrical for Passive {
    type Terminals = ();

    const PARTS: Option<[&'static str; 2]> = None;

    #[inline(always)]
    fn terminals((): &()) -> &[ScalarArg] {
        &[]
    }

    fn potentials(_: impl Fn(usize) -> f64) {}
}

impl Electrical for Dielectric {
    type Terminals = [ScalarArg; 8];

    const PARTS: Option<[&'static str; 2]> = Some(["elastic", "electric"]);

    #[inline(always)]
    fn terminals(terminals: &[ScalarArg; 8]) -> &[ScalarArg] {
        terminals
    }

    fn potentials(potential: impl Fn(usize) -> f64) -> [f64; 8] {
        std::array::from_fn(potential)
    }
}

/// The kind of elements that are hexahedra.
#[derive(Debug)]
pub struct Hexahedra<F>(PhantomData<F>);

/// Derivatives of the energy of a hexahedron, and their rates along the direction.
#[derive(Debug)]
pub struct Variations<F: Field> {
    plain: Local<F>,
    along: Local<F>,
}

impl<F: Field> Default for Variations<F> {
    fn default() -> Self {
        Self {
            plain: Local::default(),
            along: Local::default(),
        }
    }
}

/// Half the sum of both instants.
#[inline(always)]
pub(super) fn middle(vectors: [&[Vector]; 2], nodes: &[usize; 8]) -> [Vector; 8] {
    nodes.map(|v| (vectors[0][v] + vectors[1][v]) * 0.5)
}

impl<F: Electrical> Hexahedron<F> {
    fn potentials(&self, scalars: &[f64]) -> F::Potentials {
        let terminals = F::terminals(&self.terminals);
        F::potentials(|i| terminals[i].read(scalars))
    }
}

/// The arguments are the nodes, and the scalars their potentials.
impl<F: Field> Derivatives for Local<F> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        self.forces[i]
    }

    #[inline(always)]
    fn row(&self, s: usize) -> f64 {
        F::derivatives(&self.electric).map_or(0.0, |electric| electric.charges[s])
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        self.stiffness[i][j]
    }

    #[inline(always)]
    fn column(&self, i: usize, s: usize) -> Vector {
        let electric = F::derivatives(&self.electric);
        electric.map_or(Vector::zeros(), |electric| electric.coupling[i][s])
    }

    #[inline(always)]
    fn entry(&self, s: usize, t: usize) -> f64 {
        F::derivatives(&self.electric).map_or(0.0, |electric| electric.permittivity[s][t])
    }
}

impl<F: Electrical> Kernel for Hexahedra<F> {
    type Element = Hexahedron<F>;
    type Storage = Variations<F>;

    const PARTS: Option<[&'static str; 2]> = F::PARTS;

    #[inline(always)]
    fn vectors(_: &Hexahedron<F>) -> usize {
        8
    }

    #[inline(always)]
    fn scalars(element: &Hexahedron<F>) -> usize {
        F::terminals(&element.terminals).len()
    }

    #[inline(always)]
    fn vector(element: &Hexahedron<F>, i: usize) -> VectorArg {
        VectorArg {
            vector: element.nodes[i],
            stencil: Stencil::Mid,
        }
    }

    #[inline(always)]
    fn scalar(element: &Hexahedron<F>, s: usize) -> Option<(usize, f64)> {
        F::terminals(&element.terminals)[s].scalar
    }

    fn energy(element: &Hexahedron<F>, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &element.nodes);
        let potentials = element.potentials(sample.scalars);
        element.law.energy(&element.shape, &x, &potentials)
    }

    /// The energy without the field.
    fn first_part(element: &Hexahedron<F>, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &element.nodes);
        let law = element.law.passive();
        law.energy(&element.shape, &x, &())
    }

    fn prepare(
        element: &Hexahedron<F>,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut Variations<F>,
    ) {
        let Hexahedron { shape, law, .. } = element;
        let x = middle(sample.vectors, &element.nodes);
        let potentials = element.potentials(sample.scalars);
        match order {
            Order::Gradient => law.gradient(shape, &x, &potentials, plain),
            Order::Hessian => law.tangent(shape, &x, &potentials, plain),
            Order::Third => {
                let w = middle(sample.along, &element.nodes);
                let terminals = F::terminals(&element.terminals);
                let rates = F::potentials(|i| terminals[i].rate(sample.scalars_along));
                law.third(shape, &x, &potentials, &w, &rates, plain, along);
            }
        }
    }

    #[inline(always)]
    fn derivatives<S: Scatter>(
        _: &Hexahedron<F>,
        order: Order,
        _: &Sample<'_>,
        Variations { plain, along }: &Variations<F>,
        to: &mut S,
    ) {
        to.plain(plain);
        if order == Order::Third {
            to.along(plain, along);
        }
    }
}
