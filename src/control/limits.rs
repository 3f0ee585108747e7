//! Path limits and goals as bounded quantities at instants and in intervals.
//!
//! Path limits of a problem, along the motion or at a single time, and quantities with bounds: limits, goals and waypoints before they are rows.

use crate::math::significant;
use crate::model::system::Muscle;
use crate::model::{At, FieldPlace, Of, Pulling, Quantity, Region, System, What};

/// Length of the intervals, by which steps are rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Length in ms; where it is free at the guess.
    pub h: f64,
    /// True if it is an unknown.
    pub is_free: bool,
}

/// All bounded quantities of a problem.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// The quantities.
    pub list: Vec<BoundedQuantity>,
}

/// Σ ξ¹⁶ ≥ 3 holds only outside the box.
const OUTSIDE_BOX: f64 = 3.0;
/// Times at which fields are bounded: where the voltages of an interval act, and at the instants, where those of both neighbours do.
const TIMES: [At; 3] = [At::Start, At::Middle, At::End];

impl Limits {
    /// The path limits of a problem. Joint limits become measures only where `measure_joints`; in independent joint coordinates they are
    /// bounds of variables.
    pub fn new(limits: &[Limit], system: &System, measure_joints: bool, length: Length) -> Self {
        let mut out = Self::default();
        for limit in limits {
            // Those with a column of their own are its bounds.
            let is_column = |joint: usize| !measure_joints && system.joints[joint].motion.is_none();
            if limit.part.is_some() || !limit.joint().is_some_and(is_column) {
                out.add_limit(limit, system, length);
            }
        }
        out
    }

    /// Adds the quantities that a limit bounds; at a single time a field under the voltages of the interval before it.
    fn add_limit(&mut self, limit: &Limit, system: &System, length: Length) {
        let first = self.list.len();
        self.add_everywhere(limit, system, length);
        let Some(part) = limit.part else {
            return;
        };
        let mut own = self.list.split_off(first);
        own.retain(|one| {
            !matches!(one.quantity.what, What::Field(_)) || one.quantity.at == At::End
        });
        for bounded in &mut own {
            bounded.when = When::At(part);
        }
        self.list.append(&mut own);
    }

    fn add_everywhere(&mut self, limit: &Limit, system: &System, length: Length) {
        let (what, h) = (limit.what.clone(), length.h);
        let bounds @ [min, max] = limit.bounds();
        let name = what.words(limit.of, system);
        let largest = largest(bounds);
        let unit = largest.unwrap_or(1.0);
        match what {
            What::Joint { joint, .. } if limit.of == Of::Value => {
                self.add_joint(joint, bounds, system);
            }
            What::Joint { .. } => self.add_rate(Quantity::step(what, h), bounds, name, length),
            What::Tension(part) => {
                let typical = match part {
                    Pulling::Muscle(muscle) => system.muscles[muscle].shear_force(),
                    Pulling::Spring(_) | Pulling::Tendon(_) => 1.0,
                };
                self.add_in(Quantity::of(what), largest.unwrap_or(typical), bounds, name);
            }
            What::ContactForce(_) => self.add_in(Quantity::of(what), unit, bounds, name),
            What::Stretch(_) => {
                let squares = [min.max(0.0), max].map(|bound| bound * bound);
                self.add(Quantity::of(what), squares, name);
            }
            What::Speed(_) => {
                let square = |bound: f64| (bound / unit).powi(2);
                let lower = if min > 0.0 {
                    square(min)
                } else {
                    f64::NEG_INFINITY
                };
                let quantity = Quantity::of(what).in_unit(unit);
                self.add(quantity, [lower, square(max)], name);
            }
            What::Field(FieldPlace::Block { block, region }) => {
                self.add_block_field(block, region, max, system);
            }
            What::Field(FieldPlace::Muscle(muscle))
                if system.muscles[muscle].is_behind_resistor() =>
            {
                let quantity = Quantity::of(What::ChargedField(muscle)).in_unit(max);
                self.add(quantity, [f64::NEG_INFINITY, 1.0], name);
            }
            What::Field(place) => self.add_field(place, max, &name),
            What::Current(source) | What::Power(source) => {
                self.add_source(limit, source, name, system, length);
            }
            What::Voltage(_) | What::Reaction { .. } => {
                self.add_rate(Quantity::jump(what, h * unit, h), bounds, name, length);
            }
            What::Region { marker, region } => self.add_region(marker, region, bounds, system),
            What::Amount { .. } => {
                self.add_in(Quantity::of(what), unit, bounds, name);
                self.list.last_mut().expect("it was added").when = When::At(1.0);
            }
            _ => self.add(Quantity::of(what), bounds, name),
        }
    }

    /// Adds a limit whose rows are in a unit.
    fn add_in(&mut self, quantity: Quantity, unit: f64, bounds: [f64; 2], name: String) {
        let bounds = bounds.map(|bound| bound / unit);
        self.add(quantity.in_unit(unit), bounds, name);
    }

    /// Adds a limit.
    fn add(&mut self, quantity: Quantity, bounds: [f64; 2], name: String) {
        self.add_at(When::Everywhere, quantity, bounds, name);
    }

    /// Adds a limit of a rate by the steps of a quantity: bounds of the steps in their unit, or where the length of the intervals is free
    /// one row for each bound, of what the step has more than the bound allows.
    fn add_rate(&mut self, quantity: Quantity, bounds: [f64; 2], name: String, length: Length) {
        let unit = quantity.step_unit();
        if !length.is_free {
            return self.add(quantity, bounds.map(|bound| bound * length.h / unit), name);
        }
        let sides = [[0.0, f64::INFINITY], [f64::NEG_INFINITY, 0.0]];
        for (bound, side) in bounds.into_iter().zip(sides) {
            if bound.is_finite() {
                self.add(quantity.clone(), side, name.clone());
                let added = self.list.last_mut().expect("it was added");
                added.rate = Some(bound / unit);
            }
        }
    }

    /// Adds a limit of what the source of a muscle gives: behind a resistor in the intervals, otherwise of the charge or energy that flows from
    /// the middle of an interval to that of the next one.
    fn add_source(
        &mut self,
        limit: &Limit,
        muscle: usize,
        name: String,
        system: &System,
        length: Length,
    ) {
        let (h, bounds) = (length.h, limit.bounds());
        let is_power = matches!(limit.what, What::Power(_));
        let largest = largest(bounds);
        if system.muscles[muscle].is_behind_resistor() {
            let typical = system.short_circuit(muscle)[usize::from(is_power)];
            let quantity = Quantity::of(limit.what.clone());
            return self.add_in(quantity, largest.unwrap_or(typical), bounds, name);
        }
        let typical = system.charging(muscle)[usize::from(is_power)];
        let unit = largest.map_or(typical, |largest| h * largest);
        let what = match is_power {
            false => What::MeanCharge(muscle),
            true => What::Energy(muscle),
        };
        self.add_rate(Quantity::jump(what, unit, h), bounds, name, length);
    }

    /// Adds a limit of a joint that is measured.
    fn add_joint(&mut self, joint: usize, [min, max]: [f64; 2], system: &System) {
        let near = match (min.is_finite(), max.is_finite()) {
            (true, true) => 0.5 * (min + max),
            _ => 0.0,
        };
        let name = format!("limit of {}", system.joints[joint].name);
        self.add(Quantity::joint(joint, near), [min, max], name);
    }

    /// Adds a limit of a field at all times at which it is bounded.
    fn add_field(&mut self, place: FieldPlace, limit: f64, name: &str) {
        for at in TIMES {
            let quantity = Quantity::of(What::Field(place)).at(at).in_unit(limit);
            self.add(quantity, [f64::NEG_INFINITY, 1.0], name.to_owned());
        }
    }

    /// Adds the limits of the field of a block at the points of its elements.
    fn add_block_field(&mut self, block: usize, region: Option<usize>, max: f64, system: &System) {
        let name = system.block_name(block);
        for (element, point) in system.field_points(block, region) {
            let where_ = match point {
                None => "the centre".to_owned(),
                Some(point) => format!("Gauss point {}", point + 1),
            };
            let place = FieldPlace::Element {
                block,
                element,
                point,
            };
            let name = format!("electric field of {name} at {where_} of element {element}");
            self.add_field(place, max, &name);
        }
    }

    /// Adds the limits that keep a marker inside a region, as far as its relative place 1, or outside it.
    fn add_region(&mut self, marker: usize, region: Region, bounds: [f64; 2], system: &System) {
        let name = &system.markers[marker].name;
        let in_region = Quantity::of(What::Region { marker, region });
        let is_inside = bounds[1].is_finite();
        match region {
            Region::Box { min, max } if is_inside => {
                for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                    let name = format!("{letter} of marker {name} inside its box");
                    let quantity = Quantity::marker_place(marker, axis);
                    self.add(quantity, [min[axis], max[axis]], name);
                }
            }
            Region::Box { .. } => {
                let name = format!("marker {name} outside its box");
                self.add(in_region, [OUTSIDE_BOX, f64::INFINITY], name);
            }
            Region::Sphere { .. } => {
                let side = if is_inside { "inside" } else { "outside" };
                self.add(
                    in_region,
                    bounds,
                    format!("marker {name} {side} its sphere"),
                );
            }
        }
    }

    /// Adds bounds, an equality where both are one.
    pub fn add_at(&mut self, when: When, quantity: Quantity, bounds: [f64; 2], name: String) {
        let bounded = BoundedQuantity::new(quantity, bounds, when, name);
        self.list.push(bounded);
    }

    /// Returns the quantities, in order, then those that are subtracted in the intervals before where they are others.
    pub fn quantities(&self) -> Vec<Quantity> {
        let own = self.list.iter().map(|bounded| bounded.quantity.clone());
        own.chain(self.list.iter().filter_map(BoundedQuantity::other_before))
            .collect()
    }
}

/// The largest finite bound by its size; none where there is none but zero.
pub(super) fn largest(bounds: [f64; 2]) -> Option<f64> {
    let sizes = bounds.map(f64::abs).into_iter();
    let finite = sizes.filter(|size| *size > 0.0 && size.is_finite());
    finite.reduce(f64::max)
}

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
