//! Quantities with bounds: limits, goals and waypoints before they are rows.

use crate::math::significant;
use crate::model::{Quantity, System};

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
