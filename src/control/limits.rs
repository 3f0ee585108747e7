//! Path limits and goals as bounded quantities at instants and in intervals.

use crate::control::problem::{PathConstraint, Side};
use crate::functional::Stencil;
use crate::math::significant;
use crate::model::{FieldPlace, Quantity, Region, System};

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
}

impl When {
    /// Returns true unless it is a limit of the whole path.
    pub fn is_single(self) -> bool {
        matches!(self, Self::Goal | Self::At(_))
    }
}

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

/// A value this far beyond its bound, relative to it, is rounding.
const ROUNDING: f64 = 1e-8;
/// Σ ξ¹⁶ ≥ 3 holds only outside the box.
const OUTSIDE_BOX: f64 = 3.0;
/// Times at which fields are bounded: where the voltages of an interval act, and at the instants, where those of both neighbours do.
const TIMES: [Stencil; 3] = [Stencil::Here, Stencil::Mid, Stencil::Next];

impl Limits {
    /// The path limits of a problem. Joint limits become measures only where `measure_joints`; in joint coordinates they are bounds of
    /// variables.
    pub fn new(
        limits: &[PathConstraint],
        system: &System,
        measure_joints: bool,
        length: Length,
    ) -> Self {
        let h = length.h;
        let mut out = Self::default();
        for limit in limits {
            match *limit {
                PathConstraint::JointAngle { joint, min, max } => {
                    if measure_joints {
                        out.add_joint(joint, [min, max], system);
                    }
                }
                PathConstraint::JointRate { joint, min, max } => {
                    let name = format!("rate of {}", system.joints[joint].name);
                    out.add_rate(Quantity::JointStep { joint, h }, [min, max], name, length);
                }
                PathConstraint::Stretch { muscle, min, max } => {
                    let name = format!("stretch of {}", system.muscles[muscle].name);
                    let quantity = Quantity::SquaredStretch { muscle };
                    out.add(quantity, [min * min, max * max], name);
                }
                PathConstraint::Tension { muscle, min, max } => {
                    let name = format!("tension of {}", system.muscles[muscle].name);
                    let unit = largest([min, max]).unwrap_or(system.muscles[muscle].shear_force());
                    let quantity = Quantity::Tension { muscle, unit };
                    out.add(quantity, [min / unit, max / unit], name);
                }
                PathConstraint::ElectricField { muscle, max } => {
                    let name = format!("electric field of {}", system.muscles[muscle].name);
                    match system.muscles[muscle].is_behind_resistor() {
                        true => {
                            let quantity = Quantity::ChargedField { muscle, limit: max };
                            out.add(quantity, [f64::NEG_INFINITY, 1.0], name);
                        }
                        false => out.add_field(FieldPlace::Muscle(muscle), max, &name),
                    }
                }
                PathConstraint::Current { .. } | PathConstraint::Power { .. } => {
                    out.add_source(limit, system, length);
                }
                PathConstraint::VoltageRate { source, min, max } => {
                    let name = format!("rate of the voltage of {}", system.sources()[source].name);
                    let unit = h * largest([min, max]).unwrap_or(1.0);
                    let quantity = Quantity::VoltageStep { source, unit, h };
                    out.add_rate(quantity, [min, max], name, length);
                }
                PathConstraint::PeakVoltage {
                    source,
                    parameter,
                    unit,
                } => {
                    let name = format!("peak voltage of {}", system.sources()[source].name);
                    let quantity = Quantity::PeakExcess {
                        source,
                        parameter,
                        unit,
                    };
                    out.add(quantity, [f64::NEG_INFINITY, 0.0], name);
                }
                PathConstraint::BlockField { block, region, max } => {
                    out.add_block_field(block, region, max, system);
                }
                PathConstraint::Marker {
                    marker,
                    region,
                    side,
                } => out.add_region(marker, region, side, system),
            }
        }
        out
    }

    /// Adds a limit.
    fn add(&mut self, quantity: Quantity, [lower, upper]: [f64; 2], name: String) {
        self.list.push(BoundedQuantity {
            quantity,
            lower,
            upper,
            rate: None,
            when: When::Everywhere,
            name,
        });
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
                self.add(quantity, side, name.clone());
                let added = self.list.last_mut().expect("it was added");
                added.rate = Some(bound / unit);
            }
        }
    }

    /// Adds a limit of the current or the power of the source of a muscle: behind a resistor in the intervals, otherwise of the charge or energy
    /// that flows from the middle of an interval to that of the next one.
    fn add_source(&mut self, limit: &PathConstraint, system: &System, length: Length) {
        let h = length.h;
        let (muscle, bounds, is_current) = match *limit {
            PathConstraint::Current { muscle, min, max } => (muscle, [min, max], true),
            PathConstraint::Power { muscle, min, max } => (muscle, [min, max], false),
            _ => return,
        };
        let name = &system.muscles[muscle].name;
        let name = match is_current {
            true => format!("current of {name}"),
            false => format!("power of {name}"),
        };
        if system.muscles[muscle].is_behind_resistor() {
            let typical = system.short_circuit(muscle)[usize::from(!is_current)];
            let unit = largest(bounds).unwrap_or(typical);
            let quantity = match is_current {
                true => Quantity::SourceCurrent { muscle, unit },
                false => Quantity::SourcePower { muscle, unit },
            };
            return self.add(quantity, bounds.map(|bound| bound / unit), name);
        }
        let typical = system.charging(muscle)[usize::from(!is_current)];
        let unit = largest(bounds).map_or(typical, |largest| h * largest);
        let at = Stencil::Next;
        let quantity = match is_current {
            true => Quantity::ChargeStep { muscle, unit, h },
            false => Quantity::EnergyStep {
                muscle,
                at,
                unit,
                h,
            },
        };
        self.add_rate(quantity, bounds, name, length);
    }

    /// Adds a limit of a joint that is measured.
    fn add_joint(&mut self, joint: usize, [min, max]: [f64; 2], system: &System) {
        let near = match (min.is_finite(), max.is_finite()) {
            (true, true) => 0.5 * (min + max),
            _ => 0.0,
        };
        let name = format!("limit of {}", system.joints[joint].name);
        self.add(Quantity::Joint { joint, near }, [min, max], name);
    }

    /// Adds a limit of a field at all times at which it is bounded.
    fn add_field(&mut self, place: FieldPlace, limit: f64, name: &str) {
        for at in TIMES {
            let quantity = Quantity::SquaredField { place, limit, at };
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

    /// Adds the limits that keep a marker inside or outside a region.
    fn add_region(&mut self, marker: usize, region: Region, side: Side, system: &System) {
        let name = &system.markers[marker].name;
        let in_region = Quantity::MarkerRegion { marker, region };
        match (region, side) {
            (Region::Box { min, max }, Side::Inside) => {
                for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                    let name = format!("{letter} of marker {name} inside its box");
                    let quantity = Quantity::MarkerPlace { marker, axis };
                    self.add(quantity, [min[axis], max[axis]], name);
                }
            }
            (Region::Box { .. }, Side::Outside) => {
                let name = format!("marker {name} outside its box");
                self.add(in_region, [OUTSIDE_BOX, f64::INFINITY], name);
            }
            (Region::Sphere { .. }, Side::Inside) => {
                let name = format!("marker {name} inside its sphere");
                self.add(in_region, [f64::NEG_INFINITY, 1.0], name);
            }
            (Region::Sphere { .. }, Side::Outside) => {
                let name = format!("marker {name} outside its sphere");
                self.add(in_region, [1.0, f64::INFINITY], name);
            }
        }
    }

    /// Adds an equality at a single instant.
    pub fn add_equality(&mut self, when: When, quantity: Quantity, value: f64, name: String) {
        self.list.push(BoundedQuantity {
            quantity,
            lower: value,
            upper: value,
            rate: None,
            when,
            name,
        });
    }

    /// Adds a lower bound at a single instant.
    pub fn add_lower(&mut self, when: When, quantity: Quantity, lower: f64, name: String) {
        self.list.push(BoundedQuantity {
            quantity,
            lower,
            upper: f64::INFINITY,
            rate: None,
            when,
            name,
        });
    }

    /// Returns the quantities, in order, then those that are subtracted in the intervals before where they are others.
    pub fn quantities(&self) -> Vec<Quantity> {
        let own = self.list.iter().map(|bounded| bounded.quantity);
        own.chain(self.list.iter().filter_map(BoundedQuantity::other_before))
            .collect()
    }
}

/// The largest finite bound by its size; none where there is none but zero.
fn largest(bounds: [f64; 2]) -> Option<f64> {
    let sizes = bounds.map(f64::abs).into_iter();
    let finite = sizes.filter(|size| *size > 0.0 && size.is_finite());
    finite.reduce(f64::max)
}

impl BoundedQuantity {
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

    /// A value and the bound that it breaks, in words; `None` where it keeps its bounds up to rounding.
    pub fn broken(&self, value: f64, system: &System) -> Option<String> {
        let rounding = |bound: f64| ROUNDING * (1.0 + bound.abs());
        let (is_below, is_above) = (
            value < self.lower - rounding(self.lower),
            value > self.upper + rounding(self.upper),
        );
        let bound = match (is_below, is_above) {
            (true, _) => self.lower,
            (_, true) => self.upper,
            _ => return None,
        };
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
