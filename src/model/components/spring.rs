//! A spring with or without a damper between two points.

use crate::energy::{LinearSpring, SpanDamper};
use crate::functional::Element;
use crate::model::attachment::Attachment;
use crate::model::component::Component;
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

pub(super) const ELASTICITY: &str = "spring elasticity";
pub(super) const DAMPING: &str = "spring damping";

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
}

impl Component for Spring {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        vec![self.from, self.to]
    }

    fn is_prestressed(&self) -> bool {
        self.stiffness.is_some() && self.length() != self.rest_length
    }

    fn build(&self, terms: &mut Terms<'_>) {
        let Some(span) = terms.span(&self.from, &self.to) else {
            for term in [ELASTICITY, DAMPING] {
                terms.without(term, "no spring that moves");
            }
            return;
        };
        match self.energy() {
            Some(energy) => {
                let element = Element {
                    energy,
                    vectors: [mid(span)],
                    scalars: [],
                };
                terms.add(ELASTICITY, "stiffness of", &self.name, element);
            }
            None => terms.without(ELASTICITY, "no spring that moves names a stiffness"),
        }
        match self.damping {
            Some(coefficient) if terms.is_of_motion() => {
                let element = Element {
                    energy: SpanDamper { coefficient },
                    vectors: [mid(span), mid(span), rate(span)],
                    scalars: [],
                };
                terms.add(DAMPING, "damping of", &self.name, element);
            }
            Some(_) => terms.without(DAMPING, "a state of rest dissipates nothing"),
            None => terms.without(DAMPING, "no spring that moves names a damping"),
        }
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
