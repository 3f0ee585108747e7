//! Contacts with softer constants, from which optimal control begins.

use crate::model::components::contact::Contact;
use crate::model::components::contact_law::{ContactElasticLaw, ElasticSolid};

/// Constants of a contact that a solver finds easily, no stiffer than its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftContact {
    /// Width in mm of the overlap over which the stiffness grows.
    smoothing: f64,
    /// Part of the stiffness.
    part: f64,
    /// Speed in mm/ms of slip up to which friction grows.
    slip_speed: f64,
    /// Greatest elastic displacement in mm of friction that sticks.
    stick: f64,
}

/// Part of a soft width in the place of a width that a scene does not have.
const NO_WIDTH: f64 = 0.01;
/// Overlap at which the laws of soft contacts are compared, in radii.
const SMALL: f64 = 0.01;

impl Contact {
    /// The constants of a width in mm, a stiffness in N/mm, a speed of slip in mm/ms and an elastic displacement in mm, where they are softer
    /// than those of the contact.
    pub fn soft(&self, width: f64, stiffness: f64, slip_speed: f64, stick: f64) -> SoftContact {
        let smoothing = width.max(self.smoothing);
        let law = self.law_at_reference();
        let overlap = smoothing.max(SMALL * law.distance);
        let own = law.stiffness * overlap.powf(law.exponent - 1.0);
        SoftContact {
            smoothing,
            part: (stiffness / own).min(1.0),
            slip_speed: slip_speed.max(self.slip_speed),
            stick,
        }
    }

    /// The contact between its own constants, at t = 0, and soft ones, at t = 1, beyond which its width and its speed of slip grow on.
    pub fn softened(&self, soft: &SoftContact, t: f64) -> Self {
        let between = |own: f64, soft: f64| own * (soft.max(own) / own).powf(t);
        let smoothing = match soft.smoothing > self.smoothing {
            true => between(
                self.smoothing.max(NO_WIDTH * soft.smoothing),
                soft.smoothing,
            ),
            false => self.smoothing,
        };
        let part = soft.part.powf(t.min(1.0));
        let elasticity = match &self.elasticity {
            ContactElasticLaw::Linear(stiffness) => ContactElasticLaw::Linear(stiffness * part),
            ContactElasticLaw::Hertz(solids) => {
                let softer = solids.iter().map(|solid| ElasticSolid {
                    modulus: solid.modulus * part,
                    ..*solid
                });
                ContactElasticLaw::Hertz(softer.collect())
            }
        };
        let slip_speed = match self.friction {
            Some(_) => between(self.slip_speed, soft.slip_speed),
            None => self.slip_speed,
        };
        Self {
            elasticity,
            smoothing,
            slip_speed,
            stick: self.stick.map(|own| between(own, soft.stick)),
            ..self.clone()
        }
    }
}
