//! Path limits and goals as bounded quantities at instants and in intervals.

use crate::control::bounded_quantity::{BoundedQuantity, When};
use crate::control::problem::{PathConstraint, Side};
use crate::functional::Stencil;
use crate::model::{FieldPlace, Quantity, Reaction, Region, System};
use nalgebra::Vector3;

/// Length of the intervals, by which steps are rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Length in ms; where it is free at the guess.
    pub h: f64,
    /// True if it is an unknown.
    pub is_free: bool,
}

/// Measure of a source.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flow {
    Current,
    Power,
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
        let mut out = Self::default();
        let data = (system, measure_joints, length);
        limits.iter().for_each(|limit| out.add_limit(limit, data));
        out
    }

    /// Adds the quantities that a limit bounds.
    fn add_limit(
        &mut self,
        limit: &PathConstraint,
        (system, measure_joints, length): (&System, bool, Length),
    ) {
        let out = self;
        match *limit {
            PathConstraint::Once { part, ref limit } => {
                out.add_once(limit, part, system, length);
            }
            PathConstraint::JointAngle { joint, min, max } => {
                // Without a column of its own, in which bounds would stand.
                if measure_joints || system.joints[joint].motion.is_some() {
                    out.add_joint(joint, [min, max], system);
                }
            }
            PathConstraint::JointRate { joint, min, max } => {
                let name = format!("rate of {}", system.joints[joint].name);
                let quantity = Quantity::JointStep { joint, h: length.h };
                out.add_rate(quantity, [min, max], name, length);
            }
            PathConstraint::Stretch { muscle, min, max } => {
                let name = format!("stretch of {}", system.muscles[muscle].name);
                let quantity = Quantity::SquaredStretch { muscle, at: None };
                out.add(quantity, [min * min, max * max], name);
            }
            PathConstraint::Tension { muscle, min, max } => {
                out.add_tension(muscle, [min, max], system);
            }
            PathConstraint::ElectricField { muscle, max } => {
                out.add_muscle_field(muscle, max, system);
            }
            PathConstraint::Current { muscle, min, max } => {
                out.add_source((Flow::Current, muscle), [min, max], system, length);
            }
            PathConstraint::Power { muscle, min, max } => {
                out.add_source((Flow::Power, muscle), [min, max], system, length);
            }
            PathConstraint::BlockField { block, region, max } => {
                out.add_block_field(block, region, max, system);
            }
            PathConstraint::VoltageRate { source, min, max } => {
                let name = format!("rate of the voltage of {}", system.sources()[source].name);
                out.add_voltage_rate(source, [min, max], name, length);
            }
            PathConstraint::Reaction {
                joint,
                of,
                along,
                min,
                max,
            } => out.add_reaction((joint, of), along, ([min, max], system), length),
            PathConstraint::MarkerSpeed { marker, min, max } => {
                let name = format!("speed of marker {}", system.markers[marker].name);
                out.add_speed(marker, [min, max], name);
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
            PathConstraint::OfMuscles { .. } => out.add_amount(limit, system),
            PathConstraint::Marker {
                marker,
                region,
                side,
            } => out.add_region(marker, region, side, system),
        }
    }

    /// Adds a limit of the tension of a muscle.
    fn add_tension(&mut self, muscle: usize, [min, max]: [f64; 2], system: &System) {
        let of = &system.muscles[muscle];
        let unit = largest([min, max]).unwrap_or(of.shear_force());
        let quantity = Quantity::Tension { muscle, unit };
        let name = format!("tension of {}", of.name);
        self.add(quantity, [min / unit, max / unit], name);
    }

    /// Adds a limit of the field of a muscle.
    fn add_muscle_field(&mut self, muscle: usize, limit: f64, system: &System) {
        let of = &system.muscles[muscle];
        let name = format!("electric field of {}", of.name);
        match of.is_behind_resistor() {
            true => {
                let at = None;
                let quantity = Quantity::ChargedField { muscle, limit, at };
                self.add(quantity, [f64::NEG_INFINITY, 1.0], name);
            }
            false => self.add_field(FieldPlace::Muscle(muscle), limit, &name),
        }
    }

    /// Adds a limit of the rate of a voltage.
    fn add_voltage_rate(&mut self, source: usize, bounds: [f64; 2], name: String, length: Length) {
        let h = length.h;
        let unit = h * largest(bounds).unwrap_or(1.0);
        let quantity = Quantity::VoltageStep { source, unit, h };
        self.add_rate(quantity, bounds, name, length);
    }

    /// Adds a limit of the force or torque that a joint transmits.
    fn add_reaction(
        &mut self,
        (joint, of): (usize, Reaction),
        along: Vector3<f64>,
        (bounds, system): ([f64; 2], &System),
        length: Length,
    ) {
        let h = length.h;
        let what = match of {
            Reaction::Force => "force",
            Reaction::Torque => "torque",
        };
        let name = format!("reaction {what} of {}", system.joints[joint].name);
        let quantity = Quantity::ReactionStep {
            joint,
            of,
            along,
            at: Stencil::Here,
            unit: h * largest(bounds).unwrap_or(1.0),
            h,
        };
        self.add_rate(quantity, bounds, name, length);
    }

    /// Adds a limit of the speed of a marker.
    fn add_speed(&mut self, marker: usize, [min, max]: [f64; 2], name: String) {
        let limit = largest([min, max]).unwrap_or(1.0);
        let square = |bound: f64| (bound / limit).powi(2);
        let lower = if min > 0.0 {
            square(min)
        } else {
            f64::NEG_INFINITY
        };
        let quantity = Quantity::SquaredSpeed { marker, limit };
        self.add(quantity, [lower, square(max)], name);
    }

    /// Adds a limit at one time t/T. A field limit uses the voltage of the preceding interval.
    fn add_once(&mut self, limit: &PathConstraint, part: f64, system: &System, length: Length) {
        let mut own = Self::default();
        own.add_limit(limit, (system, true, length));
        let is_then = |quantity: &Quantity| match quantity {
            Quantity::SquaredField { at, .. } => *at == Stencil::Next,
            _ => true,
        };
        own.list.retain(|bounded| is_then(&bounded.quantity));
        for bounded in &mut own.list {
            bounded.when = When::At(part);
        }
        self.list.append(&mut own.list);
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
        (flow, muscle): (Flow, usize),
        bounds: [f64; 2],
        system: &System,
        length: Length,
    ) {
        let h = length.h;
        let what = match flow {
            Flow::Current => "current",
            Flow::Power => "power",
        };
        let name = format!("{what} of {}", system.muscles[muscle].name);
        if system.muscles[muscle].is_behind_resistor() {
            let typical = system.short_circuit(muscle)[flow as usize];
            let unit = largest(bounds).unwrap_or(typical);
            let quantity = match flow {
                Flow::Current => Quantity::SourceCurrent { muscle, unit },
                Flow::Power => Quantity::SourcePower { muscle, unit },
            };
            return self.add(quantity, bounds.map(|bound| bound / unit), name);
        }
        let typical = system.charging(muscle)[flow as usize];
        let unit = largest(bounds).map_or(typical, |largest| h * largest);
        let at = Stencil::Next;
        let quantity = match flow {
            Flow::Current => Quantity::ChargeStep { muscle, unit, h },
            Flow::Power => Quantity::EnergyStep {
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
        let at = None;
        let in_region = Quantity::MarkerRegion { marker, region, at };
        match (region, side) {
            (Region::Box { min, max }, Side::Inside) => {
                for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                    let name = format!("{letter} of marker {name} inside its box");
                    let quantity = Quantity::marker_place(marker, axis);
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
