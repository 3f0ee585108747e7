//! Layout of elastic blocks before they become terms: the vector of each node of a mesh, and the source of its potential.
//!
//! A node glued to a body is a material point of it, one glued to another block a sum of nodes there, a node held in all directions a point of the ground; all others have
//! coordinates. Only nodes that an electric field reaches have a potential.

use crate::coordinates::NodePlace;
use crate::element::{Inverted, SHEET_POINTS, SheetPoint};
use crate::functional::ScalarArg;
use crate::kinematics::{Carrier, MaterialVector, Pose, Vectors};
use crate::model::analysis::{Analysis, ModelError};
use crate::model::layout::solid_block::{Owner, Shape, SolidBlock};
use crate::model::layout::variables::{Variable, Variables};
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::system::{Glue, Material, Potential, Solid, System, Tie};
use crate::model::terms::field_extent;
use std::collections::{BTreeMap, HashMap};

/// Blocks before they become terms: nodes and ties of all of them.
#[derive(Debug, Default)]
pub(crate) struct Solids {
    pub(crate) list: Vec<SolidBlock>,
    /// Nodes with coordinates.
    pub(crate) nodes: Vec<NodePlace>,
    /// Block and node of the mesh of each of them.
    pub(crate) names: Vec<(usize, usize)>,
    /// Node and place on a body that multipliers keep together, and their names.
    pub(crate) ties: Vec<(MaterialVector, String)>,
    /// Electrodes behind resistors.
    pub(crate) circuits: Vec<ElectrodeCircuit>,
}

/// Source of a potential before it is numbered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Connection {
    Terminal(ScalarArg),
    /// The potential of a floating electrode, by index.
    Floating(usize),
    /// The potential of electrodes behind the resistor of a source, times a factor.
    Behind(usize, f64),
    Free,
}

impl Solids {
    /// Lays out blocks, of which the first ones are those of the scene. Their potentials are added to `variables`, which have all
    /// voltages; glued nodes keep coordinates of their own where `ties` says so.
    ///
    /// # Errors
    /// An element of a mesh is inverted.
    pub(crate) fn new(
        solids: Vec<Solid>,
        system: &System,
        analysis: &Analysis,
        reference: &[Pose],
        ties: bool,
        variables: &mut Variables,
        vectors: &mut Vectors,
    ) -> Result<Self, ModelError> {
        let (mut out, unit) = (Self::default(), unit(&solids));
        let mut places: Vec<Vec<usize>> = vec![Vec::new(); solids.len()];
        // Those that are glued to others come after them.
        for is_tied in [false, true] {
            let all = solids.iter().enumerate();
            for (index, solid) in all.filter(|(_, solid)| solid.tied.is_empty() != is_tied) {
                places[index] = out.places(index, solid, reference, ties, vectors, &places);
            }
        }
        let of_scene = (0..system.solids.len()).map(Owner::Block);
        let owners = of_scene.chain(system.meshed_muscles().map(Owner::Muscle));
        for ((index, solid), owner) in solids.into_iter().enumerate().zip(owners) {
            let (shapes, sheets) = (shapes(&solid)?, sheets(&solid)?);
            let places = std::mem::take(&mut places[index]);
            let charged = field_extent::charged(system, index, &analysis.zero_inputs);
            let is_dielectric = field_extent::dielectric(&solid, &charged);
            let of_motion = analysis.of_motion;
            let (terminals, own) =
                terminals(&solid, &is_dielectric, unit, system, of_motion, variables);
            let volume = volume(&solid, &shapes, &sheets);
            let charge = unit_of_charge(&solid, volume);
            out.circuits
                .extend(own.into_iter().filter_map(|(source, potential)| {
                    Some(ElectrodeCircuit {
                        source,
                        name: system.sources()[source].name.clone(),
                        circuit: system.electrode_circuit(source)?,
                        input: variables.input(source)?,
                        potential: (potential, unit),
                        unit_of_charge: charge,
                    })
                }));
            let on_ground = |&v: &usize| {
                let mut terms = vectors.list()[v].terms.iter();
                terms.all(|term| term.carrier == Carrier::Ground)
            };
            let is_immobile = !is_dielectric.contains(&true) && places.iter().all(on_ground);
            out.list.push(SolidBlock {
                solid,
                vectors: places,
                owner,
                terminals,
                shapes,
                sheets,
                is_dielectric,
                is_immobile,
            });
        }
        Ok(out)
    }

    /// The vector of each node.
    fn places(
        &mut self,
        index: usize,
        solid: &Solid,
        reference: &[Pose],
        ties: bool,
        vectors: &mut Vectors,
        others: &[Vec<usize>],
    ) -> Vec<usize> {
        let count = solid.mesh.nodes.len();
        let mut free = vec![[true; 3]; count];
        for support in &solid.supports {
            for &node in &support.nodes {
                for (free, held) in free[node].iter_mut().zip(support.held) {
                    *free &= !held;
                }
            }
        }
        let mut body = vec![None; count];
        for Glue { nodes, body: to } in &solid.glued {
            for &node in nodes {
                body[node] = Some(*to);
                // A glued node moves with its body, whatever else holds it.
                free[node] = [to.is_some() && ties; 3];
            }
        }
        let tied: BTreeMap<usize, &Tie> = solid.tied.iter().map(|tie| (tie.node, tie)).collect();
        let mut place = |node: usize| {
            let at = &solid.mesh.nodes[node];
            if let Some(Tie { solid, on, .. }) = tied.get(&node) {
                let mut sum = MaterialVector::default();
                for &(node, part) in on {
                    let place = &vectors.list()[others[*solid][node]];
                    sum = MaterialVector::combine(1.0, &sum, part, place);
                }
                return vectors.push(sum);
            }
            if free[node] == [false; 3] {
                let body = body[node].flatten();
                return vectors.push(MaterialVector::point(body, at, reference));
            }
            let number = self.nodes.len();
            self.nodes.push(NodePlace {
                reference: *at,
                free: free[node],
            });
            self.names.push((index, node));
            if let Some(Some(body)) = body[node] {
                let point = MaterialVector::point(Some(body), at, reference);
                let name = format!("glue of node {node} of {}", solid.name);
                self.ties.push((
                    MaterialVector::span(&MaterialVector::node(number), &point),
                    name,
                ));
            }
            vectors.push(MaterialVector::node(number))
        };
        (0..count).map(&mut place).collect()
    }
}

/// The terminal of each node that a dielectric element has, and the potentials of electrodes behind resistors by source: at rest no charge
/// flows.
fn terminals(
    solid: &Solid,
    is_dielectric: &[bool],
    unit: f64,
    system: &System,
    of_motion: bool,
    variables: &mut Variables,
) -> (Vec<Option<ScalarArg>>, BTreeMap<usize, usize>) {
    let mut wires = vec![None; solid.mesh.nodes.len()];
    let elements = solid.mesh.elements().zip(is_dielectric);
    for (nodes, _) in elements.filter(|(_, is)| **is) {
        for &node in nodes {
            wires[node] = Some(Connection::Free);
        }
    }
    for (e, electrode) in solid.electrodes.iter().enumerate() {
        let wire = match electrode.potential {
            Potential::Given(constant) => Connection::Terminal(ScalarArg {
                constant,
                scalar: None,
            }),
            Potential::Driven { source, factor }
                if of_motion
                    && system.has_electrodes_behind_resistor(source)
                    && variables.input(source).is_some() =>
            {
                Connection::Behind(source, factor)
            }
            Potential::Driven { source, factor } => Connection::Terminal(ScalarArg {
                constant: 0.0,
                scalar: variables
                    .input(source)
                    .map(|s| (s, factor * system.division(source))),
            }),
            Potential::Floating => Connection::Floating(e),
        };
        for &node in &electrode.nodes {
            if wires[node].is_some() {
                wires[node] = Some(wire);
            }
        }
    }
    let mut floating: HashMap<usize, usize> = HashMap::new();
    let mut behind: BTreeMap<usize, usize> = BTreeMap::new();
    let mut fresh = |name: String| variables.add(Variable::potential(name, unit));
    let mut terminal = |(node, wire): (usize, Option<Connection>)| {
        let mut factor = 1.0;
        let scalar = match wire? {
            Connection::Terminal(terminal) => return Some(terminal),
            Connection::Behind(source, of_source) => {
                factor = of_source;
                let name = || system.sources()[source].name.clone();
                *behind.entry(source).or_insert_with(|| fresh(name()))
            }
            Connection::Floating(e) => *floating.entry(e).or_insert_with(|| {
                let name = format!("{}.{}", solid.name, solid.electrodes[e].name);
                fresh(name)
            }),
            Connection::Free => fresh(format!("node {node} of {}", solid.name)),
        };
        Some(ScalarArg {
            constant: 0.0,
            scalar: Some((scalar, factor * unit)),
        })
    };
    let terminals = wires.into_iter().enumerate().map(&mut terminal).collect();
    (terminals, behind)
}

/// √(μ ε) V^⅔ in mC of the volume V of a block: a charge whose field balances the elasticity.
fn unit_of_charge(solid: &Solid, volume: f64) -> f64 {
    let area = volume.powf(2.0 / 3.0);
    let of = |m: &Material| {
        let electric = m.electric?;
        Some((m.shear_modulus * electric.permittivity).sqrt() * area)
    };
    let units = solid.materials.iter().filter_map(of);
    units.reduce(f64::max).unwrap_or(1.0)
}

/// √(μ/ε) in V/mm, the unit of fields in which mechanics and electrostatics have one magnitude; potentials are counted in
/// this times a millimetre.
fn unit(solids: &[Solid]) -> f64 {
    let of = |m: &Material| {
        m.electric
            .map(|e| (m.shear_modulus / e.permittivity).sqrt())
    };
    let units = solids
        .iter()
        .flat_map(|s| s.materials.iter().filter_map(of));
    let largest = units.fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Volume in mm³.
fn volume(solid: &Solid, shapes: &[Shape], sheets: &[[SheetPoint; SHEET_POINTS]]) -> f64 {
    let volumes = shapes.iter().flat_map(|shape| shape.weights());
    let areas = sheets.iter().flatten().map(|point| point.area);
    volumes.sum::<f64>() + areas.sum::<f64>() * solid.thickness.unwrap_or(0.0)
}

fn inverted(solid: &Solid, element: usize) -> impl FnOnce(Inverted) -> ModelError {
    move |_| ModelError::Inverted {
        solid: solid.name.clone(),
        element,
    }
}

/// Geometries of the elements of a block.
fn shapes(solid: &Solid) -> Result<Vec<Shape>, ModelError> {
    let elements = solid.mesh.elements().enumerate();
    let shape = |(element, nodes): (usize, &[usize])| {
        let shape = Shape::new(nodes, |node| solid.unstretched(node));
        shape.map_err(inverted(solid, element))
    };
    elements
        .filter(|_| !solid.is_membrane())
        .map(shape)
        .collect()
}

/// Points of the triangles of a membrane.
fn sheets(solid: &Solid) -> Result<Vec<[SheetPoint; SHEET_POINTS]>, ModelError> {
    let triangles = solid.mesh.triangles.iter().enumerate();
    let points = |(element, nodes): (usize, &[usize; 6])| {
        let points = SheetPoint::all(&nodes.map(|node| solid.unstretched(node)));
        points.map_err(inverted(solid, element))
    };
    triangles.map(points).collect()
}
