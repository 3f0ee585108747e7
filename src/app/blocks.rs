//! Elastic blocks in numbers: their sizes, and the charges of their electrodes at the end.

use crate::dynamics::EnergyExchange;
use crate::dynamics::trajectory::Observations;
use crate::files::Entries;
use crate::kinematics::Carrier;
use crate::math::significant;
use crate::model::{Model, Role, SolidBlock};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Sizes of a block, or of a muscle of finite elements.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct BlockSize {
    pub(super) nodes: usize,
    pub(super) elements: usize,
    /// Coordinates of an instant.
    unknowns: usize,
    /// Potentials of an interval.
    potentials: usize,
}

/// Sizes of all blocks of a model by name.
pub(super) fn sizes(model: &Model) -> BTreeMap<&str, BlockSize> {
    let blocks = model.solids.iter();
    let size = |block| BlockSize::from_block(model, block);
    blocks
        .map(|block| (block.solid.name.as_str(), size(block)))
        .collect()
}

/// Blocks of a model in `summary.json`, with the charges in C at the last instant observed by `block.electrode` or by muscle, and the number of instants
/// whose fields were written; none where nothing is elastic.
pub(super) fn entries(model: &Model, observed: &Observations, written: usize) -> Option<Entries> {
    let blocks = sizes(model);
    let sum = |part: fn(&BlockSize) -> usize| blocks.values().map(part).sum::<usize>();
    let solids = model.solids.iter();
    let immobile = solids.flat_map(SolidBlock::immobile_electrodes);
    let immobile = immobile.map(|(block, electrode)| format!("{block}.{electrode}"));
    let voltages = model.variables.with(Role::Voltage).iter();
    let sources = voltages.map(|voltage| voltage.name.clone());
    // Charges are observed in this order, in mC.
    let columns = observed.columns.iter();
    let charges = columns.filter(|column| column.name.ends_with("_charge"));
    let last = charges.filter_map(|column| column.values.last());
    let charges = immobile.chain(sources).zip(last.map(|q| q / 1e3));
    let charges: BTreeMap<String, f64> = charges.collect();
    (!blocks.is_empty()).then(|| {
        Entries::default()
            .with("blocks", &blocks)
            .with("nodes", sum(|block| block.nodes))
            .with("elements", sum(|block| block.elements))
            .with("unknowns", sum(|block| block.unknowns))
            .with("potentials", model.variables.count(Role::Potential))
            .with_some("charges", Some(&charges).filter(|all| !all.is_empty()))
            .with("instants_written", written)
    })
}

impl BlockSize {
    fn from_block(model: &Model, block: &SolidBlock) -> Self {
        let coordinates = |&vector: &usize| {
            let is_node = |carrier| matches!(carrier, Carrier::Node(_));
            let terms = &model.vectors[vector].terms;
            match terms.iter().any(|term| is_node(term.carrier)) {
                true => model.action.map.support(vector).len(),
                false => 0,
            }
        };
        let scalars = block.terminals.iter().flatten();
        let scalars = scalars.filter_map(|terminal| terminal.scalar.map(|(s, _)| s));
        let all = model.variables.range(Role::Potential);
        let potentials: BTreeSet<usize> = scalars.filter(|s| all.contains(s)).collect();
        Self {
            nodes: block.solid.mesh.nodes.len(),
            elements: block.solid.mesh.element_count(),
            unknowns: block.vectors.iter().map(coordinates).sum(),
            potentials: potentials.len(),
        }
    }
}

/// The electrical energy from all sources and the work of the electrical forces from the start to the end of a motion in J; none without
/// sources, or where one drives finite elements.
pub(super) fn energies(exchange: &EnergyExchange) -> Option<BTreeMap<&'static str, f64>> {
    let last = |sums: Vec<f64>| sums.last().copied().unwrap_or(0.0) / 1e3;
    let sums = exchange.totals()?.map(last);
    let names = ["electrical_energy", "mechanical_work"];
    Some(names.into_iter().zip(sums).collect())
}

/// Rows of the page with these energies.
pub(super) fn energy_rows(energies: &BTreeMap<&'static str, f64>) -> Vec<(String, String)> {
    let names = [
        "electrical energy from the sources",
        "mechanical work of the electrical forces",
    ];
    let text = |energy: &f64| format!("{} mJ", significant(1e3 * energy, 5));
    let rows = names.map(str::to_owned).into_iter();
    rows.zip(energies.values().map(text)).collect()
}
