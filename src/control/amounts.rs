//! Limits of the volumes and masses of muscles, which follow from sought constants alone; those that are given keep them, or are refused.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::bounded_quantity::{BoundedQuantity, When};
use crate::control::error::BoundaryError;
use crate::control::limits::{Limits, largest};
use crate::control::problem::{Control, PathConstraint};
use crate::model::{Model, Quantity, System};

impl Limits {
    /// Adds a limit of the volume or mass of muscles: one row, at the end.
    pub(super) fn add_amount(&mut self, limit: &PathConstraint, system: &System) {
        let PathConstraint::OfMuscles {
            muscles,
            amount,
            min,
            max,
        } = limit
        else {
            return;
        };
        let bounds = [*min, *max];
        let unit = largest(bounds).unwrap_or(1.0);
        let quantity = Quantity::OfMuscles {
            muscles: muscles.clone(),
            amount: *amount,
            unit,
        };
        let name = amount.words(muscles, system);
        let [lower, upper] = bounds.map(|bound| bound / unit);
        self.list.push(BoundedQuantity {
            quantity,
            lower,
            upper,
            rate: None,
            when: When::At(1.0),
            name,
        });
    }
}

/// Refuses limits of given amounts that these break, and costs of given amounts.
pub(super) fn given_amounts(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
) -> Result<(), BoundaryError> {
    let is_given = |measure: &Option<usize>| measure.is_none();
    let limits = boundary.limits.list.iter().zip(&model.measured);
    for (bounded, _) in limits.filter(|(_, measure)| is_given(measure)) {
        let Quantity::OfMuscles {
            muscles,
            amount,
            unit,
        } = &bounded.quantity
        else {
            continue;
        };
        let value = amount.of(muscles, &model.system) / unit;
        if let Some(broken) = bounded.broken(value, &model.system) {
            return Err(BoundaryError::Limit {
                place: "limits",
                reason: format!("{broken}; no constant that is sought changes it"),
            });
        }
    }
    let costs = &control.objective.quantities;
    let measures = &model.measured[boundary.limits.quantities().len()..];
    for (cost, _) in costs.iter().zip(measures).filter(|(_, m)| is_given(m)) {
        if let Quantity::OfMuscles {
            muscles, amount, ..
        } = &cost.quantity
        {
            let words = amount.words(muscles, &model.system);
            return Err(BoundaryError::Limit {
                place: "objective",
                reason: format!("no constant that is sought changes the {words}"),
            });
        }
    }
    Ok(())
}
