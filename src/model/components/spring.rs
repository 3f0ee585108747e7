//! A spring with or without a damper between two points.

use crate::energy::{LinearSpring, SpanDamper};
use crate::math::{Fault, Key, not_negative, refuse};
use crate::model::components::component::Component;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::system::bodies::Attachment;
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

    /// Makes the terms; `index` is its place among the springs of the system, constants of which can be free.
    pub(crate) fn add(&self, index: Option<usize>, terms: &mut Terms<'_>) {
        let Some(span) = terms.span(&self.from, &self.to) else {
            terms.without_each([ELASTICITY, DAMPING], "no spring that moves");
            return;
        };
        let mut nothing = index.map_or_else(Read::nothing, |_| terms.sought().read());
        let index = index.unwrap_or_default();
        let ends = MovedPoints {
            parts: [-1.0, 1.0],
            bodies: [&self.from, &self.to].map(|end| terms.carrier(end)),
            places: Some(&|end, axis| Constant::SpringEnd(index, end, axis)),
        };
        nothing.moves(0, ends, |moved| terms.vector(moved));
        let name = &self.name;
        match self.stiffness {
            Some(stiffness) => {
                let mut read = nothing.clone();
                let law = LinearSpring {
                    stiffness: read.constant(Constant::SpringStiffness(index), stiffness),
                    length: read.constant(Constant::SpringLength(index), self.rest_length),
                };
                let element = read.element(law, [mid(span)], []);
                terms.add_law(ELASTICITY, "stiffness of", name, element);
            }
            None => terms.without(ELASTICITY, "no spring that moves names a stiffness"),
        }
        match self.damping {
            Some(damping) if terms.is_of_motion() => {
                let mut read = nothing;
                let coefficient = read.constant(Constant::SpringDamping(index), damping);
                let law = SpanDamper { coefficient };
                let element = read.element(law, [mid(span), mid(span), rate(span)], []);
                terms.add_law(DAMPING, "damping of", name, element);
            }
            Some(_) => terms.without(DAMPING, "a state of rest dissipates nothing"),
            None => terms.without(DAMPING, "no spring that moves names a damping"),
        }
    }
}

impl Component for Spring {
    fn name(&self) -> &str {
        &self.name
    }

    fn points(&self) -> Vec<Attachment> {
        vec![self.from, self.to]
    }

    fn check(&self) -> Result<(), Fault> {
        not_negative("stiffness", self.stiffness.unwrap_or(0.0))?;
        not_negative("damping", self.damping.unwrap_or(0.0))?;
        let rest = self.rest_length;
        refuse!(unless rest >= 0.0 && rest.is_finite(), Key("rest_length");
            found format!("{rest} mm"), expected "zero or a positive length");
        // The force of a spring with a rest length has no direction where the ends meet; nor has that of a damper.
        let has_direction = self.damping.is_some() || self.stiffness.is_some() && rest > 0.0;
        refuse!(unless !has_direction || self.length() > 0.0, Key("to.at");
            found "the place of \"from\"",
            expected "another place than \"from\", as the force along the span has no direction there");
        Ok(())
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
