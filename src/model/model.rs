//! The model of a system, and what is read off its instants.

use crate::coordinates::{Configuration, NodePlace, Reduced};
use crate::element::relaxed;
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm};
use crate::math::Vector;
use crate::model::analysis::{Analysis, Coordinates};
use crate::model::constants::constant::Parameter;
use crate::model::layout::contact_reading::ContactReading;
use crate::model::layout::internal::{InternalKind, Internals};
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::variables::{Size, Variable, Variables};
use crate::model::presolve::graph::Graph;
use crate::model::presolve::loops::Loops;
use crate::model::presolve::presolved::Presolved;
use crate::model::quantities::quantity::Quantity;
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::system::joints::{JointReading, Prescribed};
use crate::model::system::{Body, InputKind, Source, System};
use crate::model::terms::{LeftOut, Present};
use crate::sparse::Symmetry;
use std::cell::OnceCell;

/// A system with its coordinates, vectors and terms: constant during a run.
#[derive(Debug)]
pub struct Model {
    /// System of the scene.
    pub system: System,
    /// Analysis for which the model is made.
    pub analysis: Analysis,
    /// Presolved system; its blocks are in `solids`.
    pub presolved: Presolved,
    /// Kind of the coordinates.
    pub coordinates: Coordinates,
    /// The action as a function of coordinates and voltages.
    pub action: Reduced,
    /// The vectors that terms read, in terms of poses.
    pub vectors: Vec<MaterialVector>,
    /// Variables, unknown or prescribed, at instants and in intervals.
    pub variables: Variables,
    /// Sources whose voltage does something or would, were it not zero all the time: all that files have voltages of.
    pub reached: Vec<usize>,
    /// All that voltages are named for.
    pub sources: Vec<Source>,
    /// Elastic blocks, those of muscles last.
    pub solids: Vec<SolidBlock>,
    /// Electrodes of them behind resistors.
    pub electrode_circuits: Vec<ElectrodeCircuit>,
    /// Vector of the span of each muscle.
    pub spans: Vec<usize>,
    /// Vector of each marker.
    pub markers: Vec<usize>,
    /// Index of each quantity of the analysis among the measures of its site; `None` where nothing of the model can change it.
    pub measured: Vec<Option<usize>>,
    /// Coordinates whose values are prescribed.
    pub prescribed: Vec<Prescribed>,
    /// Readings of the coordinates of each joint from poses.
    pub joint_readings: Vec<JointReading>,
    /// Time that scales multipliers: the action holds −h₀ λ·g, in ms.
    pub multiplier_time: f64,
    pub(super) graph: Graph,
    /// Poses of the presolved bodies in the reference configuration.
    pub reference: Vec<Pose>,
    /// Closing constraints that are left out.
    pub loops: Loops,
    /// Contacts that act, as they are read at times.
    pub contacts: Vec<ContactReading>,
    /// Terms of components, and what calls for them.
    pub present: Vec<Present>,
    /// Terms that components could have and have not.
    pub left_out: Vec<LeftOut>,
    pub(super) nodes: Vec<NodePlace>,
    /// Block and node of the mesh of each node with coordinates.
    pub node_names: Vec<(usize, usize)>,
    /// Internal coordinates.
    pub(super) internals: Internals,
}

impl Model {
    /// Number of coordinates of an instant, without multipliers.
    pub fn coordinate_count(&self) -> usize {
        self.action.map.coordinates
    }

    /// Coordinates of an instant at given joint coordinates (rad or mm, by joint; zero where a joint has none): other joints and
    /// free bodies stay at their reference.
    pub fn coordinates_at(&self, joints: &[f64]) -> Vec<f64> {
        match self.coordinates {
            Coordinates::Reduced => {
                let mut z = self.action.map.instant().z;
                for (reading, &value) in self.joint_readings.iter().zip(joints) {
                    if let Some(c) = reading.coordinate {
                        z[c] = value;
                    }
                }
                self.place_nodes(&mut z);
                self.place_internals(&mut z, joints);
                z
            }
            Coordinates::Redundant => {
                let system = &self.presolved.system;
                let of_joints = self.presolved.by_joint(joints);
                let poses = self.graph.poses(system, &self.reference, &of_joints);
                self.coordinates_of(&poses, joints)
            }
        }
    }

    /// Coordinates of an instant in the reference configuration, but for those that are prescribed at time zero.
    pub fn reference_coordinates(&self) -> Vec<f64> {
        self.reference_coordinates_at(0.0)
    }

    /// Director coordinates of given poses, with joint coordinates (by joint of the scene) that count whole turns; multipliers zero.
    pub(super) fn coordinates_of(&self, poses: &[Pose], joints: &[f64]) -> Vec<f64> {
        let mut z = vec![0.0; self.action.map.unknowns()];
        for (body, pose) in poses.iter().enumerate() {
            let q = &mut z[12 * body..12 * body + 12];
            q[..3].copy_from_slice(pose.centre.as_slice());
            q[3..].copy_from_slice(pose.directors.as_slice());
        }
        self.place_nodes(&mut z);
        self.place_internals(&mut z, joints);
        z
    }

    /// Internal coordinates with their meaning.
    pub(super) fn internal_kinds(&self) -> impl Iterator<Item = (usize, InternalKind)> + '_ {
        let kinds = self.internals.list.iter().map(|own| own.kind);
        self.action.map.internal().zip(kinds)
    }

    /// Meaning of coordinate `i`, where it is an internal one.
    pub(super) fn internal_kind(&self, i: usize) -> Option<InternalKind> {
        let index = i.checked_sub(self.action.map.internal().start)?;
        Some(self.internals.list.get(index)?.kind)
    }

    /// Internal coordinates of some meaning, each with what is read of it.
    fn internals_of<'m, T: 'm>(
        &'m self,
        of: impl Fn(InternalKind) -> Option<T> + 'm,
    ) -> impl Iterator<Item = (usize, T)> + 'm {
        self.internal_kinds()
            .filter_map(move |(coordinate, kind)| Some((coordinate, of(kind)?)))
    }

    /// Internal coordinates of joints, each with its joint of the scene.
    fn internal_joints(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.internals_of(|kind| match kind {
            InternalKind::Joint(joint) => Some(self.presolved.joints[joint]),
            _ => None,
        })
    }

    /// Internal coordinates of Maxwell branches, each with its muscle and its number there.
    fn branches(&self) -> impl Iterator<Item = (usize, [usize; 2])> + '_ {
        self.internals_of(|kind| match kind {
            InternalKind::Branch { muscle, branch } => Some([muscle, branch]),
            _ => None,
        })
    }

    /// Coordinates of the Maxwell branches of a muscle, in their order.
    pub(super) fn branches_of(&self, muscle: usize) -> Vec<usize> {
        let own = self.branches().filter(|(_, [of, _])| *of == muscle);
        own.map(|(coordinate, _)| coordinate).collect()
    }

    /// Gives internal coordinates their values at joint coordinates (by joint of the scene); muscles and blocks have been held there for long, and
    /// nothing has slipped.
    pub(super) fn place_internals(&self, z: &mut [f64], joints: &[f64]) {
        for (coordinate, joint) in self.internal_joints() {
            z[coordinate] = joints[joint];
        }
        if self.memory().next().is_none() {
            return;
        }
        let x = self.action.map.placed(z).x;
        for (coordinate, kind) in self.internal_kinds() {
            match kind {
                InternalKind::Joint(_) | InternalKind::Charge(_) | InternalKind::Bristle => {}
                InternalKind::Branch { muscle, .. } => {
                    let length = self.system.muscles[muscle].length();
                    z[coordinate] = (x[self.spans[muscle]].norm() / length).ln();
                }
                InternalKind::Strain {
                    block,
                    element,
                    point,
                    component,
                } => {
                    let deformation = self.solids[block].deformation(element, point, &x);
                    z[coordinate] = relaxed(&deformation)[component];
                }
            }
        }
    }

    /// [Effects](crate::model::system::Joint::pulls) of forces on coordinates that are no places: internal ones act by constraints, or within a muscle.
    pub fn pulls(&self) -> Vec<[Vector; 2]> {
        match self.coordinates {
            Coordinates::Reduced => {
                let joints = self.graph.in_order(&self.presolved.system);
                joints.flat_map(|(_, joint)| joint.pulls()).collect()
            }
            Coordinates::Redundant => Vec::new(),
        }
    }

    /// Names of the viscous stretches of the Maxwell branches.
    pub fn viscous_stretches(&self) -> impl Iterator<Item = String> + '_ {
        let name = |muscle: usize| &self.system.muscles[muscle].name;
        let branches = self.branches();
        branches.map(move |(_, [m, branch])| format!("{}_viscous_stretch{}", name(m), branch + 1))
    }

    /// Their coordinates, of which each is the logarithm of one.
    pub fn viscous_coordinates(&self) -> impl Iterator<Item = usize> + '_ {
        self.branches().map(|(coordinate, _)| coordinate)
    }

    /// Coordinates that muscles, blocks and contacts remember: they have no momentum, and nothing brings them to rest but time.
    pub fn memory(&self) -> impl Iterator<Item = usize> + '_ {
        let all = self.internal_kinds();
        all.filter_map(|(coordinate, kind)| kind.is_memory().then_some(coordinate))
    }

    /// Coordinates that equilibria do not seek: prescribed ones, and elastic displacements of contacts, as friction does not act there.
    pub fn held_at_rest(&self) -> Vec<usize> {
        let bristles = self.internals_of(|kind| (kind == InternalKind::Bristle).then_some(()));
        let mut held = self.prescribed_coordinates();
        held.extend(bristles.map(|(coordinate, ())| coordinate));
        held
    }

    /// Returns true if it has Maxwell branches, whose stretches follow the motion in times of their own.
    pub fn creeps(&self) -> bool {
        self.branches().next().is_some() || self.strains().next().is_some()
    }

    /// Coordinates of the viscous strains of blocks: they have no inertia, whatever moves.
    pub fn strains(&self) -> impl Iterator<Item = usize> + '_ {
        let all = self.internal_kinds();
        let strains = all.filter(|(_, kind)| matches!(kind, InternalKind::Strain { .. }));
        strains.map(|(coordinate, _)| coordinate)
    }

    /// Returns true if coordinate `i` is one of [`memory`](Self::memory).
    pub fn is_memory(&self, i: usize) -> bool {
        self.internal_kind(i).is_some_and(InternalKind::is_memory)
    }

    /// Rates of all coordinates from those of the bodies and of the joints (by joint of the scene); nodes have those of a start.
    pub fn rates_of_all(&self, bodies: &[f64], joints: &[f64]) -> Vec<f64> {
        let zeros = || vec![0.0; self.coordinate_count()];
        let mut rates = self.node_rates().unwrap_or_else(zeros);
        let count = bodies.len().min(self.action.map.of_bodies);
        rates[..count].copy_from_slice(&bodies[..count]);
        for (coordinate, joint) in self.internal_joints() {
            rates[coordinate] = joints[joint];
        }
        rates
    }

    /// Puts the nodes at their reference places.
    fn place_nodes(&self, z: &mut [f64]) {
        let map = &self.action.map;
        for (value, &(node, axis)) in z[map.of_bodies..].iter_mut().zip(&map.of_nodes) {
            *value = self.nodes[node].reference[axis];
        }
    }

    /// Rates of the coordinates of the nodes at the start, after zeros for those of the bodies; `None` at rest.
    pub fn node_rates(&self) -> Option<Vec<f64>> {
        let map = &self.action.map;
        let mut rates = vec![0.0; map.coordinates];
        let mut moves = false;
        for (rate, &(node, axis)) in rates[map.of_bodies..].iter_mut().zip(&map.of_nodes) {
            let (block, node) = self.node_names[node];
            if let Some(velocity) = self.solids[block].solid.velocities.get(node) {
                *rate = velocity[axis];
                moves |= *rate != 0.0;
            }
        }
        moves.then_some(rates)
    }

    /// Returns the symmetry of the tangent of a step: symmetric if all coordinates are nodes', and every force has a potential.
    pub fn step_symmetry(&self) -> Symmetry {
        let map = &self.action.map;
        let terms = &self.action.intervals.terms;
        let has_potential = terms.iter().all(|e| !e.kind().is_virtual_work());
        match map.of_bodies == 0 && map.multipliers == 0 && has_potential {
            true => Symmetry::Symmetric,
            false => Symmetry::Unsymmetric,
        }
    }

    /// The part of a block that nothing holds, if there is one.
    pub fn floating(&self) -> Option<Floating> {
        floating(&self.solids, &self.vectors, &self.nodes)
    }

    /// Joint coordinates (rad or mm, zero where a joint has none) at poses, angles in the branch nearest to `near`.
    pub fn read_joints(&self, poses: &[Pose], near: &[f64]) -> Vec<f64> {
        self.joint_readings
            .iter()
            .zip(near)
            .map(|(g, &near)| g.read(poses, near))
            .collect()
    }

    /// Joint coordinates of an instant.
    pub fn joints(&self, instant: &Configuration, near: &[f64]) -> Vec<f64> {
        let poses = OnceCell::new();
        let readings = self.joint_readings.iter().zip(near).enumerate();
        let joints = readings.map(|(j, (reading, &near))| match reading.coordinate {
            Some(coordinate) => instant.z[coordinate],
            None if self.presolved.joint(j).is_none() => 0.0,
            None => reading.read(poses.get_or_init(|| self.poses(instant)), near),
        });
        joints.collect()
    }

    /// Poses of all bodies of the scene at an instant.
    pub fn poses(&self, instant: &Configuration) -> Vec<Pose> {
        let poses = self.condensed_poses(instant);
        self.presolved.poses(&poses, &self.system.bodies)
    }

    /// Poses of the presolved bodies at an instant, which carry the vectors.
    pub fn condensed_poses(&self, instant: &Configuration) -> Vec<Pose> {
        let bodies = self.presolved.system.bodies.len();
        self.action.map.poses(instant, bodies)
    }

    /// Index of a quantity of the analysis among the measures of its site; none where nothing of the model can change it.
    pub fn place_of(&self, quantity: &Quantity) -> Option<usize> {
        let mut all = self.analysis.quantities.iter().zip(&self.measured);
        all.find(|(one, _)| *one == quantity)?.1.to_owned()
    }

    /// Inputs of an interval from one voltage a source; free parameters are at their guesses.
    pub fn scalars(&self, voltages: &[f64]) -> Vec<f64> {
        let voltages = self.variables.sources().map(|s| voltages[s]);
        let parameters = self.analysis.parameters.iter();
        voltages.chain(parameters.map(|p| p.guess)).collect()
    }

    /// Physical kind of the input of a source; a voltage where the scene has no such source.
    pub fn input_kind(&self, source: usize) -> InputKind {
        let source = self.sources.get(source);
        source.map_or(InputKind::Voltage, |source| source.kind)
    }

    /// The free parameter that a variable is.
    ///
    /// # Panics
    /// It is no parameter.
    pub fn parameter(&self, variable: &Variable) -> &Parameter {
        let mut all = self.analysis.parameters.iter();
        let found = all.find(|parameter| parameter.name == variable.name);
        found.expect("a parameter of the analysis")
    }

    /// Typical sizes of the unknowns of a step: 1 rad, the length of the system; infinite where the model does not know them.
    pub fn sizes(&self) -> Vec<f64> {
        let length = self.length();
        let size = |variable: &Variable| match variable.size {
            Size::One => 1.0,
            Size::Length => length,
            Size::Unknown => f64::INFINITY,
        };
        self.variables.unknowns().map(size).collect()
    }

    /// A length in mm that is typical of the system.
    pub fn length(&self) -> f64 {
        length(&self.presolved.system, &self.nodes)
    }
}

/// A length in mm that is typical of a system with nodes: the largest coordinate of its parts, or where all of them are at the origin the largest
/// radius of gyration.
pub(super) fn length(system: &System, nodes: &[NodePlace]) -> f64 {
    let far = |length: f64, x: &Vector| length.max(x.amax());
    let nodes = nodes.iter().map(|n| &n.reference);
    let bodies = system.bodies.iter().map(|body| &body.centre);
    let joints = system.joints.iter().map(|joint| &joint.at);
    let length = bodies.chain(nodes).chain(joints).fold(0.0, far);
    let gyration =
        |body: &Body| (body.inertia.iter().fold(0.0, |a, &b| f64::max(a, b)) / body.mass).sqrt();
    let gyrations = || system.bodies.iter().map(gyration).fold(0.0, f64::max);
    let length = if length > 0.0 { length } else { gyrations() };
    if length > 0.0 { length } else { 1.0 }
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
    blocks: &[SolidBlock],
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<Floating> {
    blocks.iter().find_map(|block| {
        let mesh = &block.solid.mesh;
        mesh.parts().iter().find_map(|part| {
            let mut members: Vec<usize> = part
                .iter()
                .flat_map(|&e| mesh.element(e))
                .copied()
                .collect();
            members.sort_unstable();
            members.dedup();
            let motion = free_motion(&members, block, vectors, nodes)?;
            Some(Floating {
                name: block.solid.name.clone(),
                motion,
            })
        })
    })
}

/// A rigid motion of nodes that leaves every held direction alone, to first order.
fn free_motion(
    members: &[usize],
    block: &SolidBlock,
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<String> {
    let mesh = &block.solid.mesh;
    let centre = members.iter().map(|&n| mesh.nodes[n]).sum::<Vector>() / members.len() as f64;
    let size = members
        .iter()
        .map(|&n| (mesh.nodes[n] - centre).norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let mut gram = nalgebra::Matrix6::<f64>::zeros();
    for &node in members {
        let VectorTerm { carrier, .. } = vectors[block.vectors[node]].terms[0];
        let is_tied = block.solid.tied.iter().any(|tie| tie.node == node);
        let is_glued = is_tied || block.solid.glued.iter().any(|g| g.nodes.contains(&node));
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
