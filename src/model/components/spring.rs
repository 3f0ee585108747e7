//! A spring with or without a damper between two points.

use crate::energy::{Affine, LinearSpring, SoughtSpanDamper, SoughtSpring, SpanDamper};
use crate::functional::{Element, SoughtElement};
use crate::model::attachment::Attachment;
use crate::model::component::Component;
use crate::model::components::kind::Kind;
use crate::model::constant::Constant;
use crate::model::sought::{Arguments, Sought};
use crate::model::system_error::{SystemError, positive, require};
use crate::model::terms::{Terms, mid, rate};
use nalgebra::Vector3;

/// A linear spring and damper along the line between two points: `k (|r| − ℓ) + c d|r|/dt`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Unique name.
    pub name: String,
    /// One end.
    pub from: Attachment,
    /// The other end.
    pub to: Attachment,
    /// Stiffness k in N/mm; `None` leaves no trace.
    pub stiffness: Option<f64>,
    /// Damping c in N ms/mm; `None` leaves no trace.
    pub damping: Option<f64>,
    /// Length ℓ without force in mm.
    pub rest_length: f64,
}

const ELASTICITY: &str = "spring elasticity";
const DAMPING: &str = "spring damping";

impl Spring {
    fn length(&self) -> f64 {
        (self.to.at - self.from.at).norm()
    }

    fn energy(&self) -> Option<LinearSpring> {
        self.stiffness.map(|stiffness| LinearSpring {
            stiffness,
            length: self.rest_length,
        })
    }

    /// Makes the terms; `index` is its place among the springs of the system, constants of which can be sought.
    fn add(&self, index: Option<usize>, terms: &mut Terms<'_>) {
        let Some(span) = terms.span(&self.from, &self.to) else {
            for term in [ELASTICITY, DAMPING] {
                terms.without(term, "no spring that moves");
            }
            return;
        };
        let sought = index.map(|index| (terms.sought(), index));
        match self.energy() {
            Some(energy) => self.add_energy(energy, span, sought.as_ref(), terms),
            None => terms.without(ELASTICITY, "no spring that moves names a stiffness"),
        }
        match self.damping {
            Some(coefficient) if terms.is_of_motion() => {
                self.add_damping(coefficient, span, sought.as_ref(), terms);
            }
            Some(_) => terms.without(DAMPING, "a state of rest dissipates nothing"),
            None => terms.without(DAMPING, "no spring that moves names a damping"),
        }
    }

    fn add_energy(
        &self,
        energy: LinearSpring,
        span: usize,
        sought: Option<&(Sought, usize)>,
        terms: &mut Terms<'_>,
    ) {
        let (why, name) = ("stiffness of", &self.name);
        let mut arguments = Arguments::new(3);
        let mut constant = |constant: fn(usize) -> Constant, value: f64| {
            sought_constant(sought, constant, value, &mut arguments)
        };
        let sought = SoughtSpring {
            stiffness: constant(Constant::SpringStiffness, energy.stiffness),
            length: constant(Constant::SpringLength, energy.length),
        };
        if arguments.count() > 0 {
            let element = sought_element(sought, span, arguments);
            return terms.add_sought::<_, 5, 1, 1>(ELASTICITY, why, name, element);
        }
        let element = Element {
            energy,
            vectors: [mid(span)],
            scalars: [],
        };
        terms.add(ELASTICITY, why, name, element);
    }

    fn add_damping(
        &self,
        coefficient: f64,
        span: usize,
        sought: Option<&(Sought, usize)>,
        terms: &mut Terms<'_>,
    ) {
        let (why, name) = ("damping of", &self.name);
        let mut arguments = Arguments::new(9);
        let constant = Constant::SpringDamping;
        let sought = SoughtSpanDamper {
            coefficient: sought_constant(sought, constant, coefficient, &mut arguments),
        };
        if arguments.count() > 0 {
            let element = sought_element(sought, span, arguments);
            return terms.add_sought::<_, 10, 3, 1>(DAMPING, why, name, element);
        }
        let element = Element {
            energy: SpanDamper { coefficient },
            vectors: [mid(span), mid(span), rate(span)],
            scalars: [],
        };
        terms.add(DAMPING, why, name, element);
    }
}

/// A constant of a spring as a function of the arguments.
fn sought_constant(
    sought: Option<&(Sought, usize)>,
    constant: fn(usize) -> Constant,
    value: f64,
    arguments: &mut Arguments,
) -> Affine {
    match sought {
        Some((sought, index)) => sought.constant(constant(*index), value, arguments),
        None => value.into(),
    }
}

fn sought_element<E>(energy: E, span: usize, arguments: Arguments) -> SoughtElement<E, 1> {
    SoughtElement {
        energy,
        span,
        moves: Vec::new(),
        scalars: arguments.scalars(),
    }
}

impl Kind for Spring {
    const NAME: &'static str = "spring";
    const ABSENT: &'static str = "no spring";
    const POTENTIALS: &'static [&'static str] = &[ELASTICITY];
    const DISSIPATIONS: &'static [&'static str] = &[DAMPING];

    fn name_mut(&mut self) -> &mut String {
        &mut self.name
    }

    fn build_at(&self, index: usize, terms: &mut Terms<'_>) {
        self.add(Some(index), terms);
    }
}

impl Component for Spring {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        vec![self.from, self.to]
    }

    fn check(&self) -> Result<(), SystemError> {
        if let Some(stiffness) = self.stiffness {
            positive(&self.name, "stiffness", stiffness)?;
        }
        if let Some(damping) = self.damping {
            positive(&self.name, "damping", damping)?;
        }
        let length = self.rest_length;
        require(
            length >= 0.0 && length.is_finite(),
            &self.name,
            || format!("rest length {length}"),
            "zero or a positive length",
        )?;
        let needs_direction = self.damping.is_some() || self.stiffness.is_some() && length > 0.0;
        require(
            !needs_direction || self.length() > 0.0,
            &self.name,
            || "both ends in one place".to_owned(),
            "ends in two places, as the force has no direction there",
        )
    }

    fn is_prestressed(&self) -> bool {
        self.stiffness.is_some() && self.length() != self.rest_length
    }

    fn build(&self, terms: &mut Terms<'_>) {
        self.add(None, terms);
    }

    fn columns(&self) -> Vec<(&'static str, &'static str)> {
        let force = self.stiffness.map(|_| ("force", "N"));
        [("length", "mm")].into_iter().chain(force).collect()
    }

    fn observe(&self, places: &[Vector3<f64>]) -> Vec<f64> {
        let length = (places[1] - places[0]).norm();
        let force = self.stiffness.map(|k| k * (length - self.rest_length));
        [length].into_iter().chain(force).collect()
    }

    fn is_coiled(&self) -> bool {
        self.stiffness.is_some()
    }

    fn typical_energy(&self) -> f64 {
        let length = self.length().max(self.rest_length);
        0.5 * self.stiffness.unwrap_or(0.0) * length * length
    }
}
