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
    /// At the final instant only (a goal), or everywhere (a limit).
    pub when: When,
    /// Words for messages.
    pub name: String,
}

/// Instants or intervals at which a quantity is bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// At every instant, or in every interval.
    Everywhere,
    /// At the last instant.
    Goal,
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
    /// The path limits of a problem. Joint limits become measures only where `measure_joints`; in joint coordinates
    /// they are bounds of variables.
    pub fn new(limits: &[PathConstraint], system: &System, measure_joints: bool) -> Self {
        let mut list = Vec::new();
        for limit in limits {
            let mut add = |quantity, lower, upper, name| {
                list.push(BoundedQuantity {
                    quantity,
                    lower,
                    upper,
                    when: When::Everywhere,
                    name,
                });
            };
            match *limit {
                PathConstraint::JointAngle { joint, min, max } => {
                    if measure_joints {
                        let near = match (min.is_finite(), max.is_finite()) {
                            (true, true) => 0.5 * (min + max),
                            _ => 0.0,
                        };
                        let name = format!("limit of {}", system.joints[joint].name);
                        add(Quantity::Joint { joint, near }, min, max, name);
                    }
                }
                PathConstraint::Stretch { muscle, min, max } => {
                    let name = format!("stretch of {}", system.muscles[muscle].name);
                    add(
                        Quantity::SquaredStretch { muscle },
                        min * min,
                        max * max,
                        name,
                    );
                }
                PathConstraint::ElectricField { muscle, max } => {
                    let place = FieldPlace::Muscle(muscle);
                    for at in TIMES {
                        let limit = max;
                        let quantity = Quantity::SquaredField { place, limit, at };
                        let name = format!("electric field of {}", system.muscles[muscle].name);
                        add(quantity, f64::NEG_INFINITY, 1.0, name);
                    }
                }
                PathConstraint::BlockField { block, region, max } => {
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
                        for at in TIMES {
                            let limit = max;
                            let quantity = Quantity::SquaredField { place, limit, at };
                            let name = format!(
                                "electric field of {name} at {where_} of element {element}"
                            );
                            add(quantity, f64::NEG_INFINITY, 1.0, name);
                        }
                    }
                }
                PathConstraint::Marker {
                    marker,
                    region,
                    side,
                } => {
                    let name = &system.markers[marker].name;
                    match (region, side) {
                        (Region::Box { min, max }, Side::Inside) => {
                            for axis in 0..3 {
                                let name = format!(
                                    "{} of marker {name} inside its box",
                                    ["x", "y", "z"][axis]
                                );
                                add(
                                    Quantity::MarkerPlace { marker, axis },
                                    min[axis],
                                    max[axis],
                                    name,
                                );
                            }
                        }
                        (Region::Box { .. }, Side::Outside) => {
                            let name = format!("marker {name} outside its box");
                            add(
                                Quantity::MarkerRegion { marker, region },
                                OUTSIDE_BOX,
                                f64::INFINITY,
                                name,
                            );
                        }
                        (Region::Sphere { .. }, Side::Inside) => {
                            let name = format!("marker {name} inside its sphere");
                            add(
                                Quantity::MarkerRegion { marker, region },
                                f64::NEG_INFINITY,
                                1.0,
                                name,
                            );
                        }
                        (Region::Sphere { .. }, Side::Outside) => {
                            let name = format!("marker {name} outside its sphere");
                            add(
                                Quantity::MarkerRegion { marker, region },
                                1.0,
                                f64::INFINITY,
                                name,
                            );
                        }
                    }
                }
            }
        }
        Self { list }
    }

    /// Adds an equality at the final instant.
    pub fn add_goal(&mut self, quantity: Quantity, value: f64, name: String) {
        self.list.push(BoundedQuantity {
            quantity,
            lower: value,
            upper: value,
            when: When::Goal,
            name,
        });
    }

    /// Adds a lower bound at the final instant.
    pub fn add_goal_above(&mut self, quantity: Quantity, lower: f64, name: String) {
        self.list.push(BoundedQuantity {
            quantity,
            lower,
            upper: f64::INFINITY,
            when: When::Goal,
            name,
        });
    }

    /// Returns the quantities, in order.
    pub fn quantities(&self) -> Vec<Quantity> {
        self.list.iter().map(|b| b.quantity).collect()
    }
}

impl BoundedQuantity {
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
