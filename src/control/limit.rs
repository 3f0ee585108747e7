//! Path limits of a problem: bounds of quantities along the motion, or at a single time.

use crate::model::system::Muscle;
use crate::model::{FieldPlace, Of, System, What};

/// Bounds of a quantity at every instant or in every interval, or at a single time.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Bounded variable, in its unit. A field is bounded in the intervals and at the instants, of a block at all of its points; current and power
    /// without a resistor from the middle of an interval to that of the next one; a reaction at the instants between intervals.
    pub what: What,
    /// Its value, or the rate of a joint coordinate (rad/ms or mm/ms, the mean in each interval) or of a voltage (V/ms between the middles of
    /// neighbouring intervals).
    pub of: Of,
    /// Lower bound or −∞.
    pub min: f64,
    /// Upper bound or ∞.
    pub max: f64,
    /// Part of the duration, above 0 and at most 1, the end, where it holds at the instant nearest to it alone, or in the interval before it.
    pub part: Option<f64>,
}

impl Limit {
    /// Bounds of the values along the motion.
    pub fn new(what: What, [min, max]: [f64; 2]) -> Self {
        Self {
            what,
            of: Of::Value,
            min,
            max,
            part: None,
        }
    }

    /// Bounds of the rates along the motion.
    pub fn of_rate(what: What, bounds: [f64; 2]) -> Self {
        let of = match what {
            What::Voltage(_) => Of::Jump,
            _ => Of::Step,
        };
        Self {
            of,
            ..Self::new(what, bounds)
        }
    }

    /// The largest value.
    pub fn below(what: What, max: f64) -> Self {
        Self::new(what, [f64::NEG_INFINITY, max])
    }

    /// The same at a single time.
    #[must_use]
    pub fn at_part(self, part: f64) -> Self {
        Self {
            part: Some(part),
            ..self
        }
    }

    /// Both bounds.
    pub fn bounds(&self) -> [f64; 2] {
        [self.min, self.max]
    }

    /// The joint whose coordinate it bounds.
    pub(crate) fn joint(&self) -> Option<usize> {
        match self.what {
            What::Joint { joint, .. } if self.of == Of::Value => Some(joint),
            _ => None,
        }
    }

    /// Returns true if it bounds steps from interval to interval, or a single time.
    pub(crate) fn is_of_steps(&self) -> bool {
        let what = matches!(
            self.what,
            What::Voltage(_) | What::Current(_) | What::Power(_) | What::Reaction { .. }
        );
        what || self.part.is_some()
    }

    /// Returns true if it bounds what is the same constant in two systems that differ: the amount of muscles of one shape and density.
    pub(super) fn is_as_in(&self, one: &System, other: &System) -> bool {
        let shape = |muscle: &Muscle| {
            let of = (muscle.from, muscle.to, muscle.cross_section);
            (of, muscle.prestretch, muscle.material.density)
        };
        let What::Amount { muscles, .. } = &self.what else {
            return false;
        };
        let of = |system: &System, m: usize| system.muscles.get(m).map(shape);
        let mut muscles = muscles.iter();
        muscles.all(|&m| of(one, m) == of(other, m))
    }

    /// The limit of another system whose parts have the same names; none where it has not what is limited.
    pub(super) fn of_other(&self, from: &System, to: &System) -> Option<Self> {
        let what = match self.what {
            // Steps between intervals, free parameters and single times belong to the intervals of a problem.
            What::Voltage(_) | What::PeakExcess { .. } | What::Amount { .. } => return None,
            _ if self.part.is_some() => return None,
            What::Field(FieldPlace::Block { .. }) => {
                (from.solids == to.solids && from.muscles == to.muscles).then(|| self.what.clone())
            }
            _ => self.what.of_other(from, to),
        };
        let what = what.filter(|what| what.exists(to))?;
        Some(Self {
            what,
            ..self.clone()
        })
    }
}
