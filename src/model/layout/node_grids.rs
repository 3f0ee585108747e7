//! The nodes of boxes and meshes with the unknowns of a step at each node, where these are all that is unknown.

use crate::model::system::{ElementKind, Material, Solid, System};
use crate::model::{Model, SolidBlock};
use crate::sparse::multigrid::{NodeGrid, NodeMesh};
use thiserror::Error;

/// The nodes of blocks, with their unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeGrids {
    /// Blocks on boxes.
    pub boxes: Vec<NodeGrid>,
    /// Blocks on other meshes.
    pub meshes: Vec<NodeMesh>,
}

/// Reason why the unknowns are not those of nodes.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NoGrids {
    /// There is no block.
    #[error("there is no elastic block that moves")]
    NoBlock,
    /// There is a membrane, by its name.
    #[error("{0} is a membrane, which has no stiffness against bending")]
    Membrane(String),
    /// Something else is unknown.
    #[error("{0} is unknown too, which belongs to no node")]
    Other(String),
}

/// Returns true if all that can move in a system are blocks for which an iteration may solve.
pub(crate) fn has_nodes_alone(system: &System) -> bool {
    let mut solids = system.solids.iter();
    system.bodies.is_empty() && system.muscles.is_empty() && !solids.any(Solid::is_membrane)
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
    /// The nodes of the blocks that move, with their unknowns. Prescribed coordinates belong to no node.
    ///
    /// # Errors
    /// Something else is unknown: coordinates of bodies, what materials remember, multipliers,
    /// potentials of whole electrodes.
    pub fn node_grids(&self) -> Result<NodeGrids, NoGrids> {
        let is_membrane = |block: &&SolidBlock| block.solid.is_membrane();
        if let Some(block) = self.solids.iter().find(is_membrane) {
            return Err(NoGrids::Membrane(block.solid.name.clone()));
        }
        let map = &self.action.map;
        let nodes = |block: &SolidBlock| match block.is_immobile {
            true => Vec::new(),
            false => vec![[None; 4]; block.solid.mesh.nodes.len()],
        };
        let mut lists: Vec<_> = self.solids.iter().map(nodes).collect();
        let mut found = vec![false; self.variables.unknown_count()];
        for (place, &(node, axis)) in map.of_nodes.iter().enumerate() {
            let (block, node) = self.node_names[node];
            let unknown = map.of_bodies + place;
            if !self.is_prescribed(unknown) {
                lists[block][node][axis] = Some(unknown as u32);
            }
            found[unknown] = true;
        }
        let other = |unknown: usize| NoGrids::Other(self.variables.unknown(unknown).to_string());
        for (block, node, unknown) in self.potentials_of_nodes() {
            // An electrode is at many nodes.
            if std::mem::replace(&mut found[unknown], true) {
                return Err(other(unknown));
            }
            lists[block][node][3] = Some(unknown as u32);
        }
        if let Some(unknown) = found.iter().position(|found| !found) {
            return Err(other(unknown));
        }
        let mut grids = NodeGrids::default();
        for (block, unknowns) in self.solids.iter().zip(lists) {
            if !unknowns.is_empty() {
                grids.add(&block.solid, unknowns);
            }
        }
        match grids.boxes.is_empty() && grids.meshes.is_empty() {
            true => Err(NoGrids::NoBlock),
            false => Ok(grids),
        }
    }
}

impl NodeGrids {
    /// Adds a block with the unknowns of its nodes.
    fn add(&mut self, solid: &Solid, unknowns: Vec<[Option<u32>; 4]>) {
        let has_pressures = has_pressures(solid);
        if let Some(planes) = solid.mesh.box_planes() {
            self.boxes.push(NodeGrid {
                planes,
                unknowns,
                has_pressures,
            });
            return;
        }
        let elements = solid.mesh.elements();
        self.meshes.push(NodeMesh {
            places: solid.mesh.nodes.iter().map(|&node| node.into()).collect(),
            elements: elements
                .map(|nodes| nodes.iter().map(|&node| node as u32).collect())
                .collect(),
            unknowns,
            shortest_edge: solid.mesh.shortest_edge(),
            has_pressures,
        });
    }

    /// Length of the shortest edge in mm.
    pub fn shortest_edge(&self) -> f64 {
        let planes = self.boxes.iter().flat_map(|grid| &grid.planes);
        let edges = planes.flat_map(|planes| planes.windows(2).map(|two| two[1] - two[0]));
        let of_meshes = self.meshes.iter().map(|mesh| mesh.shortest_edge);
        edges.chain(of_meshes).fold(f64::INFINITY, f64::min)
    }
}

impl Model {
    /// Reference place in mm of each unknown of a step: that of its node for a coordinate of a node and a potential of one node, none
    /// for others.
    pub fn unknown_places(&self) -> Vec<Option<[f64; 3]>> {
        let map = &self.action.map;
        let mut places = vec![None; self.variables.unknown_count()];
        for (place, &(node, _)) in places[map.of_bodies..].iter_mut().zip(&map.of_nodes) {
            *place = Some(self.nodes[node].reference.into());
        }
        let mut readers = vec![0; places.len()];
        for (block, node, unknown) in self.potentials_of_nodes() {
            let at = self.solids[block].solid.mesh.nodes[node];
            readers[unknown] += 1;
            // An electrode is at many places.
            places[unknown] = (readers[unknown] == 1).then_some(at.into());
        }
        places
    }

    /// Block, node and unknown of a step of the nodes whose potential is unknown.
    fn potentials_of_nodes(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let blocks = self.solids.iter().enumerate();
        let nodes = blocks.flat_map(|(b, block)| {
            let terminals = block.terminals.iter().enumerate();
            terminals.map(move |(node, terminal)| (b, node, terminal))
        });
        nodes.filter_map(|(block, node, terminal)| {
            let (scalar, _) = (*terminal)?.scalar?;
            Some((block, node, self.variables.place(scalar)?))
        })
    }
}
