//! Path limits of a problem, along the motion or at a single time, and quantities with bounds: limits, goals and waypoints before they are rows.

use crate::math::significant;
use crate::model::system::Muscle;
use crate::model::{FieldPlace, Of, Quantity, System, What};

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

/// A quantity with bounds at some instants or intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedQuantity {
    /// Quantity that is bounded.
    pub quantity: Quantity,
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// Rate in units over ms that is subtracted from the quantity, times the length of the interval: a bound where the duration is free.
    pub rate: Option<f64>,
    /// At the final instant only (a goal), at one instant (a waypoint), or everywhere (a limit).
    pub when: When,
    /// Words for messages.
    pub name: String,
}

/// Instants or intervals at which a quantity is bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// At every instant, or in every interval.
    Everywhere,
    /// At the last instant.
    Goal,
    /// At the instant nearest to a part of the duration: a waypoint.
    At(f64),
    /// Not in this program.
    Never,
}

impl When {
    /// Returns true unless it is a limit of the whole path.
    pub fn is_single(self) -> bool {
        matches!(self, Self::Goal | Self::At(_))
    }
}

/// A value this far beyond its bound, relative to it, is rounding.
const ROUNDING: f64 = 1e-8;

impl BoundedQuantity {
    /// A quantity between two bounds.
    pub fn new(quantity: Quantity, [lower, upper]: [f64; 2], when: When, name: String) -> Self {
        Self {
            quantity,
            lower,
            upper,
            rate: None,
            when,
            name,
        }
    }

    /// The same in the program of a state of rest: limits of what inputs change, too, which the end of the motion does not have.
    #[must_use]
    pub fn of_rest(&self) -> Self {
        let is_counted = self.rate.is_none() && self.when == When::Everywhere;
        Self {
            when: match is_counted && self.quantity.is_of_held_inputs() {
                true => When::Everywhere,
                false => When::Never,
            },
            ..self.clone()
        }
    }

    /// The quantity that is subtracted in the interval before, where it is another one.
    pub fn other_before(&self) -> Option<Quantity> {
        let before = self.quantity.before();
        before.filter(|before| *before != self.quantity)
    }

    /// Its bounds, those of a rate in intervals of the length that the quantity names.
    pub fn bounds(&self) -> [f64; 2] {
        let of_rate = self.rate.zip(self.quantity.interval());
        let moved = of_rate.map_or(0.0, |(rate, h)| rate * h);
        [self.lower + moved, self.upper + moved]
    }

    /// The bound that a value breaks by more than rounding, and by how much; true if it is the lower one.
    pub fn beyond(&self, value: f64) -> Option<(f64, f64, bool)> {
        let rounding = |bound: f64| ROUNDING * (1.0 + bound.abs());
        let sides = [
            (self.lower, self.lower - value, true),
            (self.upper, value - self.upper, false),
        ];
        let mut sides = sides.into_iter();
        sides.find(|&(bound, excess, _)| excess > rounding(bound))
    }

    /// A value and the bound that it breaks, in words; `None` where it keeps its bounds up to rounding.
    pub fn broken(&self, value: f64, system: &System) -> Option<String> {
        let (bound, _, is_below) = self.beyond(value)?;
        let [value, bound] = [value, bound].map(|v| self.quantity.plain(v, system));
        let side = if is_below { "at least" } else { "at most" };
        let [value, bound] = [value, bound].map(|(v, unit)| {
            let space = if unit.is_empty() { "" } else { " " };
            format!("{}{space}{unit}", significant(v, 5))
        });
        let name = &self.name;
        Some(format!(
            "{name} is {value}, and its limit is {side} {bound}"
        ))
    }
}
