//! Elastic blocks: which vector each node of a mesh is, and where its potential comes from.
//!
//! A node glued to a body is a material point of it, a node held in all directions a point of the ground; all others have
//! coordinates. Only nodes that an electric field reaches have a potential: those of dielectric elements of a part that
//! an electrode with a voltage touches.

use crate::element::{Dielectric, Elastomer, Inverted, Local, Passive, Shape, Volume};
use crate::functional::Terminal;
use crate::kinematics::{Carrier, MaterialVector, Pose, Term, Vectors};
use crate::math::Vector;
use crate::model::ModelError;
use crate::model::system::{
    Electric, Electrode, ElementKind, Glue, Material, Potential, Solid, System,
};
use crate::reduction::NodePlace;
use std::collections::{BTreeSet, HashMap};

/// A block as the model sees it.
#[derive(Clone, Debug)]
pub struct Continuum {
    /// What the scene says.
    pub solid: Solid,
    /// Vector of each node of the mesh.
    pub vectors: Vec<usize>,
    /// Terminal of each node of the mesh; `None` where there is no potential.
    pub terminals: Vec<Option<Terminal>>,
    /// Whether it is a muscle, whose electrodes are one.
    pub of_muscle: bool,
    /// Geometry of each element.
    pub shapes: Vec<Shape>,
    /// Whether a field reaches each element.
    pub is_dielectric: Vec<bool>,
}

/// Blocks on their way to effects: nodes, ties and potentials of all of them.
#[derive(Debug, Default)]
pub(super) struct Continua {
    pub(super) list: Vec<Continuum>,
    /// Nodes with coordinates.
    pub(super) nodes: Vec<NodePlace>,
    /// Block and node of the mesh of each of them.
    pub(super) names: Vec<(usize, usize)>,
    /// Node and place on a body that multipliers hold together, and what they are called.
    pub(super) ties: Vec<(MaterialVector, String)>,
    /// What each potential of an interval is.
    pub(super) potentials: Vec<String>,
    /// Unit of the potentials in V.
    pub(super) unit: f64,
}

/// What is in use of a potential before it is numbered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wire {
    Terminal(Terminal),
    /// The potential of a floating electrode, by index.
    Floating(usize),
    Free,
}

impl Continua {
    /// Lays out blocks, of which the first `scene` are those of the scene; `voltages` are the sources of the first scalars, and glued nodes keep coordinates of their own
    /// where `ties` says so.
    ///
    /// # Errors
    /// An element of a mesh is turned inside out.
    pub(super) fn new(
        solids: Vec<Solid>,
        scene: usize,
        reference: &[Pose],
        voltages: &[usize],
        ties: bool,
        vectors: &mut Vectors,
    ) -> Result<Self, ModelError> {
        let mut out = Self {
            unit: unit(&solids),
            ..Self::default()
        };
        for (index, solid) in solids.into_iter().enumerate() {
            let shapes = shapes(&solid)?;
            let places = out.places(index, &solid, reference, ties, vectors);
            let is_dielectric = dielectric(&solid);
            let terminals = out.terminals(&solid, &is_dielectric, voltages);
            out.list.push(Continuum {
                solid,
                vectors: places,
                of_muscle: index >= scene,
                terminals,
                shapes,
                is_dielectric,
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
                if to.is_none() || !ties {
                    free[node] = [false; 3];
                }
            }
        }
        let mut place = |node: usize| {
            let at = &solid.mesh.nodes[node];
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

    /// The terminal of each node that a dielectric element has.
    fn terminals(
        &mut self,
        solid: &Solid,
        is_dielectric: &[bool],
        voltages: &[usize],
    ) -> Vec<Option<Terminal>> {
        let mut wires = vec![None; solid.mesh.nodes.len()];
        let elements = solid.mesh.hexahedra.iter().zip(is_dielectric);
        for (nodes, _) in elements.filter(|(_, is)| **is) {
            for &node in nodes {
                wires[node] = Some(Wire::Free);
            }
        }
        for (e, electrode) in solid.electrodes.iter().enumerate() {
            let wire = match electrode.potential {
                Potential::Given(constant) => Wire::Terminal(Terminal {
                    constant,
                    scalar: None,
                }),
                Potential::Driven { source, factor } => Wire::Terminal(Terminal {
                    constant: 0.0,
                    scalar: voltages
                        .iter()
                        .position(|&v| v == source)
                        .map(|s| (s, factor)),
                }),
                Potential::Floating => Wire::Floating(e),
            };
            for &node in &electrode.nodes {
                if wires[node].is_some() {
                    wires[node] = Some(wire);
                }
            }
        }
        let mut floating: HashMap<usize, usize> = HashMap::new();
        let fresh = |name: String, potentials: &mut Vec<String>| {
            potentials.push(name);
            voltages.len() + potentials.len() - 1
        };
        let mut terminal = |(node, wire): (usize, Option<Wire>)| {
            let scalar = match wire? {
                Wire::Terminal(terminal) => return Some(terminal),
                Wire::Floating(e) => *floating.entry(e).or_insert_with(|| {
                    let name = format!("{}.{}", solid.name, solid.electrodes[e].name);
                    fresh(name, &mut self.potentials)
                }),
                Wire::Free => fresh(
                    format!("node {node} of {}", solid.name),
                    &mut self.potentials,
                ),
            };
            Some(Terminal {
                constant: 0.0,
                scalar: Some((scalar, self.unit)),
            })
        };
        wires.into_iter().enumerate().map(&mut terminal).collect()
    }
}

impl Continuum {
    /// The material of an element.
    pub fn material(&self, element: usize) -> &Material {
        &self.solid.materials[self.solid.mesh.regions[element]]
    }

    /// Vectors of the nodes of an element.
    pub fn nodes(&self, element: usize) -> [usize; 8] {
        self.solid.mesh.hexahedra[element].map(|node| self.vectors[node])
    }

    /// Terminals of the nodes of a dielectric element.
    pub fn terminals(&self, element: usize) -> [Terminal; 8] {
        self.solid.mesh.hexahedra[element]
            .map(|node| self.terminals[node].expect("a dielectric element has potentials"))
    }

    /// The law of a passive element.
    pub fn passive(&self, element: usize) -> Elastomer<Passive> {
        let material = self.material(element);
        Elastomer {
            shear_modulus: material.shear_modulus,
            lame_lambda: material.lame_lambda.unwrap_or(0.0),
            volume: match self.solid.element {
                ElementKind::Hex8 => Volume::Pointwise,
                ElementKind::Hex8Q1P0 => Volume::Mean,
            },
            field: Passive,
        }
    }

    /// The law of a dielectric element.
    pub fn dielectric(&self, element: usize) -> Elastomer<Dielectric> {
        let Electric {
            c1,
            c2,
            permittivity,
        } = self
            .material(element)
            .electric
            .expect("a dielectric element has electric constants");
        let law = self.passive(element);
        Elastomer {
            shear_modulus: law.shear_modulus,
            lame_lambda: law.lame_lambda,
            volume: law.volume,
            field: Dielectric {
                c1,
                c2,
                permittivity,
            },
        }
    }

    /// Vector of the node nearest to a place.
    pub(super) fn nearest(&self, place: &Vector) -> usize {
        let node = self.solid.mesh.nearest_node(place);
        self.vectors[node.expect("a mesh has nodes")]
    }

    /// Places of the nodes at vectors x.
    pub fn places(&self, x: &[Vector]) -> Vec<Vector> {
        self.vectors.iter().map(|&v| x[v]).collect()
    }

    /// Block and electrode of the electrodes that no voltage drives.
    pub fn still_electrodes(&self) -> impl Iterator<Item = (&str, &str)> + '_ {
        let all = self.solid.electrodes.iter().filter(|e| self.is_still(e));
        all.map(|e| (self.solid.name.as_str(), e.name.as_str()))
    }

    fn is_still(&self, electrode: &Electrode) -> bool {
        !self.of_muscle && !matches!(electrode.potential, Potential::Driven { .. })
    }

    /// Charges −∂W/∂φ in mC of the electrodes that no voltage drives, with the nodes at vectors x.
    pub fn still_charges(&self, x: &[Vector], scalars: &[f64]) -> Vec<f64> {
        let electrodes = self.solid.electrodes.iter();
        let still: Vec<_> = electrodes.filter(|e| self.is_still(e)).collect();
        if still.is_empty() {
            return Vec::new();
        }
        let (places, potentials) = (self.places(x), self.potentials(scalars));
        let mut charges = vec![0.0; places.len()];
        let mut local = Local::default();
        for (e, nodes) in self.solid.mesh.hexahedra.iter().enumerate() {
            if self.is_dielectric[e] {
                let (at, phi) = (nodes.map(|n| places[n]), nodes.map(|n| potentials[n]));
                let law = self.dielectric(e);
                law.gradient(&self.shapes[e], &at, &phi, &mut local);
                for (&node, charge) in nodes.iter().zip(&local.electric.charges) {
                    charges[node] -= charge;
                }
            }
        }
        let sum = |e: &&Electrode| -> f64 { e.nodes.iter().map(|&n| charges[n]).sum() };
        still.iter().map(sum).collect()
    }

    /// Potentials of the nodes in V; zero where there is none.
    pub fn potentials(&self, scalars: &[f64]) -> Vec<f64> {
        let value = |t: &Option<Terminal>| {
            let Terminal { constant, scalar } = t.unwrap_or_default();
            constant + scalar.map_or(0.0, |(s, factor)| factor * scalars[s])
        };
        self.terminals.iter().map(value).collect()
    }
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

fn shapes(solid: &Solid) -> Result<Vec<Shape>, ModelError> {
    let shape = |(element, nodes): (usize, &[usize; 8])| {
        Shape::new(&nodes.map(|n| solid.mesh.nodes[n])).map_err(|Inverted { .. }| {
            ModelError::Inverted {
                solid: solid.name.clone(),
                element,
            }
        })
    };
    solid.mesh.hexahedra.iter().enumerate().map(shape).collect()
}

/// Whether a field reaches each element: its material has electric constants, and the dielectric part of the block that it
/// belongs to touches an electrode whose voltage is not the same everywhere.
fn dielectric(solid: &Solid) -> Vec<bool> {
    let mesh = &solid.mesh;
    let mut is: Vec<bool> = mesh
        .regions
        .iter()
        .map(|&region| solid.materials[region].electric.is_some())
        .collect();
    let mut part: Vec<usize> = (0..mesh.nodes.len()).collect();
    fn root(part: &mut [usize], mut node: usize) -> usize {
        while part[node] != node {
            part[node] = part[part[node]];
            node = part[node];
        }
        node
    }
    let join = |part: &mut [usize], a: usize, b: usize| {
        let (a, b) = (root(part, a), root(part, b));
        part[a.max(b)] = a.min(b);
    };
    for (nodes, _) in mesh.hexahedra.iter().zip(&is).filter(|(_, is)| **is) {
        for &node in &nodes[1..] {
            join(&mut part, nodes[0], node);
        }
    }
    for electrode in &solid.electrodes {
        for pair in electrode.nodes.windows(2) {
            join(&mut part, pair[0], pair[1]);
        }
    }
    let mut potentials: HashMap<usize, Vec<Potential>> = HashMap::new();
    for electrode in &solid.electrodes {
        if electrode.potential != Potential::Floating {
            for &node in &electrode.nodes {
                let seen = potentials.entry(root(&mut part, node)).or_default();
                if !seen.contains(&electrode.potential) {
                    seen.push(electrode.potential);
                }
            }
        }
    }
    for (nodes, is) in mesh.hexahedra.iter().zip(&mut is) {
        let seen = potentials.get(&root(&mut part, nodes[0]));
        *is &= seen.is_some_and(|seen| seen.len() > 1);
    }
    is
}

/// Sources whose voltages do something: of dielectric muscles, and of driven electrodes that a dielectric element touches.
pub(super) fn voltages(system: &System, solids: &[Solid]) -> Vec<usize> {
    let muscles = system.muscles.iter().enumerate();
    let muscles = muscles.filter(|(_, m)| m.material.electric.is_some());
    let mut voltages: Vec<usize> = muscles.map(|(m, _)| m).collect();
    for solid in solids {
        let is = dielectric(solid);
        let elements = solid.mesh.hexahedra.iter().zip(&is);
        let reached: BTreeSet<usize> = elements
            .filter(|(_, is)| **is)
            .flat_map(|(nodes, _)| *nodes)
            .collect();
        for electrode in &solid.electrodes {
            if let Potential::Driven { source, .. } = electrode.potential
                && electrode.nodes.iter().any(|n| reached.contains(n))
                && !voltages.contains(&source)
            {
                voltages.push(source);
            }
        }
    }
    voltages
}

/// A part of a block that can move without resistance: its name and the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Floating {
    /// The block.
    pub name: String,
    /// Such as `translation along x`.
    pub motion: String,
}

/// The first part of the blocks that neither supports nor bodies hold.
pub(super) fn floating(
    continua: &[Continuum],
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<Floating> {
    continua.iter().find_map(|continuum| {
        let mesh = &continuum.solid.mesh;
        mesh.parts().iter().find_map(|part| {
            let mut members: Vec<usize> = part.iter().flat_map(|&e| mesh.hexahedra[e]).collect();
            members.sort_unstable();
            members.dedup();
            let motion = free_motion(&members, continuum, vectors, nodes)?;
            Some(Floating {
                name: continuum.solid.name.clone(),
                motion,
            })
        })
    })
}

/// A rigid motion of nodes that leaves every held direction alone, to first order.
fn free_motion(
    members: &[usize],
    continuum: &Continuum,
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<String> {
    let mesh = &continuum.solid.mesh;
    let centre = members.iter().map(|&n| mesh.nodes[n]).sum::<Vector>() / members.len() as f64;
    let size = members
        .iter()
        .map(|&n| (mesh.nodes[n] - centre).norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let mut gram = nalgebra::Matrix6::<f64>::zeros();
    for &node in members {
        let Term { carrier, .. } = vectors[continuum.vectors[node]].terms[0];
        let is_glued = continuum
            .solid
            .glued
            .iter()
            .any(|g| g.nodes.contains(&node));
        let held = match carrier {
            Carrier::Node(number) if !is_glued => nodes[number].free.map(|free| !free),
            _ => [true; 3],
        };
        let arm = (mesh.nodes[node] - centre) / size;
        for axis in (0..3).filter(|&axis| held[axis]) {
            let direction = Vector::ith(axis, 1.0);
            let turned = arm.cross(&direction);
            let row = nalgebra::Vector6::new(
                direction.x,
                direction.y,
                direction.z,
                turned.x,
                turned.y,
                turned.z,
            );
            gram += row * row.transpose();
        }
    }
    let eigen = nalgebra::SymmetricEigen::new(gram);
    let (least, value) = eigen.eigenvalues.argmin();
    if value > 1e-9 {
        return None;
    }
    let mode = eigen.eigenvectors.column(least);
    let names = ["x", "y", "z"];
    let strongest = mode.iamax();
    Some(match strongest {
        0..3 => format!("translation along {}", names[strongest]),
        _ => format!("rotation about {}", names[strongest - 3]),
    })
}
