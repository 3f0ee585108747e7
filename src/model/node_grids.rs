//! Box grids of nodes with the unknowns of a step at each node, where these are all that is unknown.

use crate::model::Model;
use crate::model::system::{ElementKind, Material, Solid, System};
use crate::sparse::multigrid::NodeGrid;
use thiserror::Error;

/// Reason why the unknowns are not those of box grids.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NoGrids {
    /// There is no block.
    #[error("there is no elastic block that moves")]
    NoBlock,
    /// The nodes of a block are no box grid.
    #[error("the mesh of {0} is no box of elements")]
    NoBox(String),
    /// Something else is unknown.
    #[error("{0} is unknown too, which belongs to no node")]
    Other(String),
}

/// Returns true if all that can move in a system are blocks on boxes.
pub(crate) fn has_boxes_alone(system: &System) -> bool {
    let is_box = |solid: &Solid| solid.mesh.box_planes().is_some();
    system.bodies.is_empty() && system.muscles.is_empty() && system.solids.iter().all(is_box)
}

/// Least λ/μ from which on pressures of mean dilatations are worth their iterations.
const STIFF: f64 = 4.0;

/// Returns true if elements of a block resist changes of their volumes by far more than anything else, with one pressure each.
fn has_pressures(solid: &Solid) -> bool {
    let is_stiff = |of: &Material| {
        of.lame_lambda
            .is_some_and(|lambda| lambda > STIFF * of.shear_modulus)
    };
    solid.element == ElementKind::Hex8Q1P0 && solid.materials.iter().any(is_stiff)
}

impl Model {
    /// The grids of the blocks that move, each with its unknowns. Prescribed coordinates belong to no grid.
    ///
    /// # Errors
    /// A block is no box grid, or something else is unknown: coordinates of bodies, what materials remember, multipliers, potentials of whole
    /// electrodes.
    pub fn node_grids(&self) -> Result<Vec<NodeGrid>, NoGrids> {
        let map = &self.action.map;
        let mut grids = Vec::new();
        for block in &self.solids {
            let planes = match block.is_immobile {
                true => Default::default(),
                false => (block.solid.mesh.box_planes())
                    .ok_or_else(|| NoGrids::NoBox(block.solid.name.clone()))?,
            };
            let nodes = planes.iter().map(Vec::len).product();
            let unknowns = vec![[None; 4]; nodes];
            grids.push(NodeGrid {
                planes,
                unknowns,
                has_pressures: has_pressures(&block.solid),
            });
        }
        let mut found = vec![false; self.variables.unknown_count()];
        for (place, &(node, axis)) in map.of_nodes.iter().enumerate() {
            let (block, node) = self.node_names[node];
            let unknown = map.of_bodies + place;
            if !self.is_prescribed(unknown) {
                grids[block].unknowns[node][axis] = Some(unknown as u32);
            }
            found[unknown] = true;
        }
        let other = |unknown: usize| NoGrids::Other(self.variables.unknown(unknown).to_string());
        for (grid, block) in grids.iter_mut().zip(&self.solids) {
            for (unknowns, terminal) in grid.unknowns.iter_mut().zip(&block.terminals) {
                let scalar = terminal.and_then(|terminal| terminal.scalar);
                let Some(unknown) = scalar.and_then(|(s, _)| self.variables.place(s)) else {
                    continue;
                };
                // An electrode is at many nodes.
                if std::mem::replace(&mut found[unknown], true) {
                    return Err(other(unknown));
                }
                unknowns[3] = Some(unknown as u32);
            }
        }
        grids.retain(|grid| !grid.unknowns.is_empty());
        match found.iter().position(|found| !found) {
            Some(unknown) => Err(other(unknown)),
            None if grids.is_empty() => Err(NoGrids::NoBlock),
            None => Ok(grids),
        }
    }
}
