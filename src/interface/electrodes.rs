//! Electrodes of elastic blocks.

use crate::model::system::{Circuit, Electrode, Potential, Solid};

impl Solid {
    /// An electrode on the nodes of a set of the mesh.
    pub fn electrode(mut self, name: &str, set: &str, potential: Potential) -> Self {
        self.electrodes.push(Electrode {
            name: name.to_owned(),
            nodes: self.nodes(set),
            potential,
            circuit: None,
        });
        self
    }

    /// Puts a circuit between the electrode that was added last and its source. Nothing without an electrode.
    pub fn behind(mut self, circuit: Circuit) -> Self {
        if let Some(last) = self.electrodes.last_mut() {
            last.circuit = Some(circuit);
        }
        self
    }
}

impl Potential {
    /// Zero.
    pub const GROUNDED: Self = Self::Given(0.0);
    /// The voltage that is given or sought under the name of the electrode.
    pub const DRIVEN: Self = Self::Driven {
        source: 0,
        factor: 1.0,
    };
}
