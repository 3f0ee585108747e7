//! Finite elements by Gent's law whose limit follows a free parameter: energies W(x̄, Jₘ(π)), which are not linear in it.
//!
//! The derivatives of the law by its limit are laws themselves, so that those of an element by π are sums of elements:
//! `∂W/∂π = J′ W_J` and `∂²W/∂π² = J′² W_JJ + J″ W_J`.

use crate::element::{Elastomer, ElementGeometry, IsochoricLaw, Local, Passive};
use crate::energy::Coefficient;
use crate::functional::finite_elements::{Variations, middle};
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};
use std::sync::Arc;

/// One finite element without a field.
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

/// The kind of these elements; the parameter is their only scalar.
#[derive(Debug)]
pub enum VariedElements<const NODES: usize = 8> {}

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

impl<const NODES: usize> Kernel for VariedElements<NODES> {
    type Element = VariedElement<NODES>;
    type Storage = LimitVariations<NODES>;

    #[inline(always)]
    fn vectors(_: &VariedElement<NODES>) -> usize {
        NODES
    }

    #[inline(always)]
    fn scalars(_: &VariedElement<NODES>) -> usize {
        1
    }

    #[inline(always)]
    fn vector(element: &VariedElement<NODES>, i: usize) -> VectorArg {
        Stencil::Mid.of(element.nodes[i])
    }

    #[inline(always)]
    fn scalar(element: &VariedElement<NODES>, _: usize) -> Option<(usize, f64)> {
        Some((element.parameter, 1.0))
    }

    fn energy(element: &VariedElement<NODES>, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &element.nodes);
        let law = element.at(limit(element, sample).real());
        law.energy(&element.shape, &x, &())
    }

    fn prepare(
        element: &VariedElement<NODES>,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut LimitVariations<NODES>,
    ) {
        let x = middle(sample.vectors, &element.nodes);
        let w = middle(sample.along, &element.nodes);
        let shape = &element.shape;
        let law = element.at(limit(element, sample).real());
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
        element: &VariedElement<NODES>,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &LimitVariations<NODES>,
        to: &mut S,
    ) {
        let limit = limit(element, sample);
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
