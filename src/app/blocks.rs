//! Elastic blocks in numbers: their sizes, and the charges of their electrodes at the end.

use crate::dynamics::EnergyExchange;
use crate::dynamics::trajectory::Observations;
use crate::kinematics::Carrier;
use crate::math::significant;
use crate::model::{Model, Role, SolidBlock};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A block, or a muscle of finite elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct BlockSize {
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Coordinates of an instant.
    pub unknowns: usize,
    /// Potentials of an interval.
    pub potentials: usize,
}

/// All blocks of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BlockSizes {
    /// By name.
    pub blocks: BTreeMap<String, BlockSize>,
    /// Nodes of all blocks.
    pub nodes: usize,
    /// Elements of all blocks.
    pub elements: usize,
    /// Coordinates of an instant of all blocks.
    pub unknowns: usize,
    /// Potentials of an interval.
    pub potentials: usize,
    /// Charge in C at the end by `block.electrode` or by muscle.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub charges: BTreeMap<String, f64>,
    /// Instants whose fields were written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instants_written: Option<usize>,
}

impl BlockSizes {
    /// Those of a model; `None` where nothing is elastic.
    pub fn from_model(model: &Model) -> Option<Self> {
        if model.solids.is_empty() {
            return None;
        }
        let named = model.solids.iter();
        let blocks: BTreeMap<_, _> = named
            .map(|c| (c.solid.name.clone(), BlockSize::from_block(model, c)))
            .collect();
        let sum = |part: fn(&BlockSize) -> usize| blocks.values().map(part).sum();
        Some(Self {
            nodes: sum(|b| b.nodes),
            elements: sum(|b| b.elements),
            unknowns: sum(|b| b.unknowns),
            potentials: model.variables.count(Role::Potential),
            blocks,
            ..Self::default()
        })
    }

    /// The same with the charges at the last instant observed and the number of instants written.
    pub(super) fn after(self, model: &Model, observed: &Observations, written: usize) -> Self {
        let immobile = model
            .solids
            .iter()
            .flat_map(SolidBlock::immobile_electrodes);
        let immobile = immobile.map(|(block, electrode)| format!("{block}.{electrode}"));
        let voltages = model.variables.with(Role::Voltage).iter();
        let sources = voltages.map(|voltage| voltage.name.clone());
        // Charges are observed in this order, in mC.
        let columns = observed.columns.iter();
        let charges = columns.filter(|column| column.name.ends_with("_charge"));
        let last = charges.filter_map(|column| column.values.last());
        Self {
            charges: immobile.chain(sources).zip(last.map(|q| q / 1e3)).collect(),
            instants_written: Some(written),
            ..self
        }
    }
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
            elements: block.shapes.len(),
            unknowns: block.vectors.iter().map(coordinates).sum(),
            potentials: potentials.len(),
        }
    }
}

/// Sums over all sources from the start to the end of a motion, in J.
#[derive(Debug, Serialize)]
pub(super) struct EnergySummary {
    /// Electrical energy from the sources.
    electrical_energy: f64,
    /// Work of the electrical forces.
    mechanical_work: f64,
}

impl EnergySummary {
    /// Of a motion; none without sources, or where one drives finite elements.
    pub(super) fn new(exchange: &EnergyExchange) -> Option<Self> {
        let last = |sums: Vec<f64>| sums.last().copied().unwrap_or(0.0) / 1e3;
        let [electrical_energy, mechanical_work] = exchange.totals()?.map(last);
        Some(Self {
            electrical_energy,
            mechanical_work,
        })
    }

    /// Rows of the table of the page.
    pub(super) fn rows(&self) -> [(String, String); 2] {
        let row = |name: &str, energy: f64| {
            let value = format!("{} mJ", significant(1e3 * energy, 5));
            (name.to_owned(), value)
        };
        [
            row("electrical energy from the sources", self.electrical_energy),
            row(
                "mechanical work of the electrical forces",
                self.mechanical_work,
            ),
        ]
    }
}
