//! Elements that make one term together with all of their type.

use crate::element::ElementLaw;
use crate::energy::{Energy, MaxwellDamper};
use crate::functional::{
    Electrical, Element, FiniteElement, FiniteElements, Formulas, Group, Inertia, Kernel, Law,
    LawElement, Laws, Mass, MaxwellElement, MaxwellElements, Path, Paths, PressureFace,
    PressureFaces, Scaled, ScaledElement, Term, VariedElement, VariedElements, ViscousElement,
    ViscousElements,
};

/// Element that makes one term together with all of its type.
pub(super) trait Member<Kind = ()>: Sized + 'static {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term>;
}

impl Member for Mass {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Inertia::new(name, list))
    }
}

impl<F: Electrical, L: ElementLaw> Member for FiniteElement<F, L> {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<FiniteElements<F, L>>::intervals(name, -1.0, list))
    }
}

impl Member for ViscousElement {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<ViscousElements>::intervals(name, 1.0, list))
    }
}

impl Member for VariedElement {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<VariedElements>::intervals(name, -1.0, list))
    }
}

impl Member for MaxwellElement {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<MaxwellElements>::intervals(name, -1.0, list))
    }
}

impl Member for PressureFace {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<PressureFaces>::intervals(name, 1.0, list))
    }
}

/// An element that is no formula of constants, and its kind.
pub(super) trait OfKind: Clone + Send + Sync + 'static {
    type Kind: Kernel<Element = Self>;
}

impl<F: Electrical, L: ElementLaw> OfKind for FiniteElement<F, L> {
    type Kind = FiniteElements<F, L>;
}

impl OfKind for VariedElement {
    type Kind = VariedElements;
}

impl OfKind for ViscousElement {
    type Kind = ViscousElements;
}

impl OfKind for MaxwellElement {
    type Kind = MaxwellElements;
}

impl OfKind for Element<MaxwellDamper, 6, 0> {
    type Kind = Formulas<MaxwellDamper, 18, 6, 0>;
}

impl<E: OfKind> Member for ScaledElement<E> {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        let scale = if E::Kind::VIRTUAL > 0 { 1.0 } else { -1.0 };
        Box::new(Group::<Scaled<E::Kind>>::intervals(name, scale, list))
    }
}

impl Member for Path {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Group::<Paths>::intervals(name, -1.0, list))
    }
}

/// Elements of a formula of `M` arguments; `KINETIC` is true for a kinetic energy.
pub(super) struct Formula<const M: usize, const KINETIC: bool>;

impl<E, const M: usize, const NV: usize, const NS: usize, const KINETIC: bool>
    Member<Formula<M, KINETIC>> for Element<E, NV, NS>
where
    E: Energy<M> + 'static,
{
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        // The action has the kinetic energy less the potential one; a virtual work is added.
        let scale = if KINETIC || E::VIRTUAL > 0 { 1.0 } else { -1.0 };
        Box::new(Group::<Formulas<E, M, NV, NS>>::intervals(
            name, scale, list,
        ))
    }
}

impl<L, const M: usize, const NV: usize, const NS: usize, const KINETIC: bool>
    Member<Formula<M, KINETIC>> for LawElement<L, NV, NS>
where
    L: Law<M>,
{
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        let is_added = KINETIC || L::Formula::<f64>::VIRTUAL > 0;
        let scale = if is_added { 1.0 } else { -1.0 };
        Box::new(Group::<Laws<L, M, NV, NS>>::intervals(name, scale, list))
    }
}
