//! Names and units of the columns that are observed along a motion.

use crate::dynamics::part_columns::PartColumns;
use crate::dynamics::trajectory::Column;
use crate::functional::TermKind;
use crate::model::{Model, Role, SolidBlock};

/// Names and units of the columns, in the order of the values of a row.
pub(super) fn columns(model: &Model, parts: &PartColumns) -> Vec<Column> {
    let mut columns = Vec::new();
    let mut add = |name: String, unit: &'static str| {
        columns.push(Column {
            name,
            unit,
            values: Vec::new(),
        });
    };
    let system = &model.system;
    for muscle in &system.muscles {
        add(format!("{}_stretch", muscle.name), "");
    }
    let electrodes = model
        .solids
        .iter()
        .flat_map(SolidBlock::immobile_electrodes);
    for (block, electrode) in electrodes {
        add(format!("{block}_{electrode}_charge"), "mC");
    }
    for voltage in model.variables.with(Role::Voltage) {
        let name = voltage.name.replace('.', "_");
        add(format!("{name}_charge"), "mC");
    }
    add("kinetic_energy".to_owned(), "N mm");
    for term in &model.action.intervals.terms {
        if term.kind() == TermKind::Potential {
            for part in term.energy_parts() {
                add(format!("{}_energy", part.replace(' ', "_")), "N mm");
            }
        }
    }
    add("total_energy".to_owned(), "N mm");
    for (_, name) in works(model) {
        add(name.to_owned(), "N mm");
    }
    for (name, unit) in [("linear_momentum", "N ms"), ("angular_momentum", "N mm ms")] {
        for axis in ["x", "y", "z"] {
            add(format!("{name}_{axis}"), unit);
        }
    }
    add("constraint_violation".to_owned(), "");
    for component in system.components.iter() {
        for (quantity, unit) in component.columns() {
            add(format!("{}_{quantity}", component.name()), unit);
        }
    }
    for name in model.viscous_stretches() {
        add(name, "");
    }
    for name in model.electrodes() {
        add(name, "V");
    }
    columns.extend(parts.columns(model));
    columns
}

/// Kinds of work that are done, each with the name of its sum.
pub(super) fn works(model: &Model) -> impl Iterator<Item = (TermKind, &'static str)> {
    let terms = &model.action.intervals.terms;
    let has = |kind| terms.iter().any(|term| term.kind() == kind);
    let all = [
        (TermKind::Dissipation, "dissipated_energy"),
        (TermKind::AppliedWork, "following_load_work"),
    ];
    all.into_iter().filter(move |(kind, _)| has(*kind))
}
