//! Path limits and goals as bounded quantities at instants and in intervals.

use crate::control::limit::{BoundedQuantity, When};
use crate::control::problem::Limit;
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
    /// The path limits of a problem. Joint limits become measures only where `measure_joints`; in joint coordinates they are bounds of
    /// variables.
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
            What::Tension(Pulling::Muscle(muscle)) => {
                let unit = largest.unwrap_or(system.muscles[muscle].shear_force());
                self.add_in(Quantity::of(what), unit, bounds, name);
            }
            What::Tension(_) => self.add_rate(Quantity::step(what, h), bounds, name, length),
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
        let bounded = BoundedQuantity::new(quantity, bounds, When::Everywhere, name);
        self.list.push(bounded);
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

    /// Adds an equality at a single instant.
    pub fn add_equality(&mut self, when: When, quantity: Quantity, value: f64, name: String) {
        let bounded = BoundedQuantity::new(quantity, [value; 2], when, name);
        self.list.push(bounded);
    }

    /// Adds a lower bound at a single instant.
    pub fn add_lower(&mut self, when: When, quantity: Quantity, lower: f64, name: String) {
        let bounded = BoundedQuantity::new(quantity, [lower, f64::INFINITY], when, name);
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
