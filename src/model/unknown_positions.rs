//! Places of unknowns in space, where they have one.

use crate::model::Model;

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
        for block in &self.solids {
            for (terminal, at) in block.terminals.iter().zip(&block.solid.mesh.nodes) {
                let scalar = terminal.and_then(|terminal| terminal.scalar);
                if let Some(unknown) = scalar.and_then(|(s, _)| self.variables.place(s)) {
                    readers[unknown] += 1;
                    // An electrode is at many places.
                    places[unknown] = (readers[unknown] == 1).then_some((*at).into());
                }
            }
        }
        places
    }
}
