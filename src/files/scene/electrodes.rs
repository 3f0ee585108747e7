//! Conversion of electrodes of a scene file to the nodes of one potential each.

use std::collections::BTreeMap;

use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::mesh::Meshed;
use crate::files::scene::nodes::{AXES, extent, in_plane, nodes, place, planes_near};
use crate::files::scene::spec_solids::{CircuitSpec, PotentialSpec, SolidSpec, StackSpec};
use crate::mesh::Mesh;
use crate::model::system::{Circuit, Electrode, Potential};

/// A voltage that has no number yet, see [`number_sources`].
const DRIVEN: Potential = Potential::Driven {
    source: usize::MAX,
    factor: 1.0,
};

/// The electrodes of a block, connected ones as one.
pub(crate) fn electrodes(
    spec: &SolidSpec,
    meshed: &Meshed,
    scope: &Scope<'_>,
) -> Result<Vec<Electrode>> {
    let mut placed = Placed {
        mesh: &meshed.mesh,
        electrodes: Vec::new(),
        owners: BTreeMap::new(),
    };
    for (index, electrode) in spec.electrodes.iter().enumerate() {
        let scope = scope.key("electrodes").index(index);
        let owner = format!("electrode {:?}", electrode.name);
        let nodes = nodes!(&owner, electrode, &meshed.mesh, &scope);
        let potential = match &electrode.potential {
            PotentialSpec::Grounded => Potential::Given(0.0),
            PotentialSpec::Floating => Potential::Floating,
            PotentialSpec::Driven => DRIVEN,
            PotentialSpec::Given(voltage) => Potential::Given(voltage.value()),
        };
        let circuit = circuit(&electrode.circuit, potential == DRIVEN, &scope)?;
        let electrode = Electrode {
            name: electrode.name.clone(),
            nodes,
            potential,
            circuit,
        };
        placed.add(electrode, &scope)?;
    }
    if let Some(stack) = &spec.stack {
        placed.add_stack(stack, meshed, &scope.key("stack"))?;
    }
    let is_floating = |electrode: &Electrode| electrode.potential == Potential::Floating;
    let all = placed.electrodes;
    refuse!(if !all.is_empty() && all.iter().all(is_floating), scope.key("electrodes");
        found "floating electrodes only",
        expected "one that is grounded, driven or given, or more");
    Ok(all)
}

/// The circuit of an electrode.
fn circuit(
    spec: &Option<CircuitSpec>,
    is_driven: bool,
    scope: &Scope<'_>,
) -> Result<Option<Circuit>> {
    scope.optional("circuit", spec, |at, spec| {
        let circuit = spec.circuit();
        let checked = circuit.check(is_driven, true);
        checked.map_err(|fault| at.refuse(spec, &fault))?;
        Ok(circuit)
    })
}

/// Electrodes with the owner of each node.
struct Placed<'a> {
    mesh: &'a Mesh,
    electrodes: Vec<Electrode>,
    owners: BTreeMap<usize, usize>,
}

impl Placed<'_> {
    /// Adds an electrode, or its nodes to the driven one of the same name.
    fn add(&mut self, new: Electrode, scope: &Scope<'_>) -> Result<()> {
        let name = &new.name;
        refuse!(if name.is_empty(), scope.key("name"); found "\"\"", expected "a name");
        let known = self.electrodes.iter().position(|other| other.name == *name);
        let index = match known {
            Some(known) => {
                let other = &self.electrodes[known];
                refuse!(if [new.potential, other.potential] != [DRIVEN; 2], scope.key("name");
                    found format!("{name:?} a second time"),
                    expected "a name that is not taken: only driven electrodes share one");
                refuse!(if new.circuit.is_some() && other.circuit != new.circuit, scope.key("circuit");
                    found format!("another circuit of {name:?}"),
                    expected "one circuit, at the first electrode of the name");
                known
            }
            None => {
                let (name, nodes) = (name.clone(), Vec::new());
                self.electrodes.push(Electrode { name, nodes, ..new });
                self.electrodes.len() - 1
            }
        };
        for &node in &new.nodes {
            match self.owners.insert(node, index) {
                None => self.electrodes[index].nodes.push(node),
                Some(owner) if owner == index => {}
                Some(owner) => {
                    let other = &self.electrodes[owner].name;
                    let at = place(&self.mesh.nodes[node]);
                    let found = format!(
                        "electrode {name:?}, whose node at {at} belongs to electrode {other:?} too"
                    );
                    return Err(scope.wrong(found, "electrodes that do not meet"));
                }
            }
        }
        self.electrodes[index].nodes.sort_unstable();
        Ok(())
    }

    fn add_stack(&mut self, stack: &StackSpec, meshed: &Meshed, scope: &Scope<'_>) -> Result<()> {
        let axis = stack.axis.index();
        let boundaries = boundaries(stack, meshed, &scope.key("layers"))?;
        let mut parts = [Vec::new(), Vec::new()];
        for (layer, at) in boundaries.into_iter().enumerate() {
            let nodes = in_plane(self.mesh, axis, at);
            refuse!(if nodes.is_empty(), scope;
                found format!(
                    "layers of the electrode {:?} of which one begins at {} = {at} mm, where no node is",
                    stack.name, AXES[axis]
                ),
                expected planes_near(self.mesh, axis, at));
            parts[layer % 2].extend(nodes);
        }
        let [grounded, driven] = parts;
        let circuit = circuit(&stack.circuit, true, scope)?;
        let ground = Electrode {
            name: format!("{}_ground", stack.name),
            nodes: grounded,
            potential: Potential::Given(0.0),
            circuit: None,
        };
        self.add(ground, scope)?;
        let driven = Electrode {
            name: stack.name.clone(),
            nodes: driven,
            potential: DRIVEN,
            circuit,
        };
        self.add(driven, scope)
    }
}

/// The planes between layers and at the ends, in mm.
fn boundaries(stack: &StackSpec, meshed: &Meshed, scope: &Scope<'_>) -> Result<Vec<f64>> {
    let axis = stack.axis.index();
    let Some(planes) = &meshed.planes else {
        refuse!(if stack.layers == 0, scope; found "0", expected "1 layer or more");
        let [low, high] = extent(&meshed.mesh).map(|corner| corner[axis]);
        let place = |layer: usize| low + (high - low) * layer as f64 / stack.layers as f64;
        return Ok((0..=stack.layers).map(place).collect());
    };
    let elements = planes[axis].len() - 1;
    refuse!(if stack.layers == 0 || !elements.is_multiple_of(stack.layers), scope;
        found stack.layers,
        expected format!("a divisor of the {elements} elements along {}", AXES[axis]));
    let stride = elements / stack.layers;
    Ok(planes[axis].iter().step_by(stride).copied().collect())
}
