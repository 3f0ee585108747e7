//! Where physics meets indices: from a checked system to sums of effects over its coordinates.

mod analysis;
mod attachment;
mod block_terms;
mod blocks;
mod bodies;
mod check;
mod component;
pub mod components;
mod constraints;
mod dampers;
mod error;
mod field_extent;
mod floating;
mod graph;
mod immobile;
mod joints;
mod measures;
mod named;
pub mod plan;
mod presolved;
mod quantity;
mod redundancy;
mod solid_block;
mod solids;
mod states;
pub mod system;
mod terms;
mod variables;

pub use analysis::{Analysis, InitiallyMoving};
pub use check::SystemError;
pub use component::Component;
pub use error::ModelError;
pub use floating::Floating;
pub use graph::Graph;
pub use immobile::Immobile;
pub use joints::{JointReading, Screw};
pub use named::Freedom;
pub use plan::{LeftOut, Present};
pub use presolved::{BodyLocation, Presolved};
pub use quantity::{FieldPlace, Quantity, Region, joint_unit};
pub use solid_block::SolidBlock;
pub use system::{System, VACUUM_PERMITTIVITY};
pub use terms::{Terms, mid, rate};
pub use variables::{Role, Size, Time, Variable, Variables};

use crate::coordinates::{Configuration, CoordinateMap, NodePlace, Reduced};
use crate::functional::{Functional, Kind};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Vector;
use crate::sparse::Symmetry;
use measures::Measures;
use solids::Solids;
use system::{Attachment, Muscle, Source};

/// Coordinates in which a problem is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// Independent joint coordinates; joints form a tree, and what no joint connects to the ground floats.
    Reduced,
    /// Directors with multipliers; any graph of bodies and joints.
    Redundant,
}

impl Coordinates {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reduced => "reduced",
            Self::Redundant => "redundant",
        }
    }
}

/// A system with its coordinates, vectors and effects: constant during a run.
#[derive(Debug)]
pub struct Model {
    /// What the scene means.
    pub system: System,
    /// What is asked of it.
    pub analysis: Analysis,
    /// What remains of it to be solved for; its blocks are in `continua`.
    pub presolved: Presolved,
    /// Which coordinates.
    pub coordinates: Coordinates,
    /// The action as a function of coordinates and voltages.
    pub action: Reduced,
    /// The vectors that effects read, in terms of poses.
    pub vectors: Vec<MaterialVector>,
    /// What is unknown or prescribed, at instants and in intervals.
    pub variables: Variables,
    /// Sources whose voltage does something or would, were it not zero all the time: all that files have voltages of.
    pub reached: Vec<usize>,
    /// All that voltages are named for.
    pub sources: Vec<Source>,
    /// Elastic blocks, those of muscles last.
    pub solids: Vec<SolidBlock>,
    /// Vector of the span of each muscle.
    pub spans: Vec<usize>,
    /// Vector of each marker.
    pub markers: Vec<usize>,
    /// Index of each quantity of the question among the measures of its site; `None` where nothing of the model can change it.
    pub measured: Vec<Option<usize>>,
    /// How the coordinates of each joint are read from poses.
    pub gauges: Vec<JointReading>,
    /// Time that scales multipliers: the action holds −h₀ λ·g, in ms.
    pub multiplier_time: f64,
    graph: Graph,
    reference: Vec<Pose>,
    /// Terms of components, and what calls for them.
    pub present: Vec<Present>,
    /// Terms that components could have and have not.
    pub left_out: Vec<LeftOut>,
    nodes: Vec<NodePlace>,
    /// Block and node of the mesh of each node with coordinates.
    pub node_names: Vec<(usize, usize)>,
}

impl Model {
    /// Builds the model of a system for intervals of about `h0` ms, in which `quantities` can be measured, any voltage may act
    /// and anything may be set in motion.
    ///
    /// Without a choice the coordinates are reduced where the joints form a tree.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn new(
        system: System,
        coordinates: Option<Coordinates>,
        h0: f64,
        quantities: &[Quantity],
    ) -> Result<Self, ModelError> {
        let question = Analysis {
            coordinates,
            quantities: quantities.to_vec(),
            ..Analysis::of_motion(h0)
        };
        Self::answering(system, question)
    }

    /// Builds the model of what a question calls for, and of nothing else.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn answering(system: System, question: Analysis) -> Result<Self, ModelError> {
        let mut condensed = Presolved::new(&system, &question);
        let voltages = field_extent::voltages(&condensed.system);
        let reached = match question.zero_voltage.is_empty() {
            true => voltages.clone(),
            false => field_extent::voltages(&system),
        };
        let solids = blocks::blocks(&mut condensed);
        let rest = &condensed.system;
        let coordinates = Self::choose(rest, question.coordinates)?;
        let graph = Graph::new(rest);
        let reference: Vec<Pose> = rest.bodies.iter().map(system::Body::pose).collect();
        let mut vectors = Vectors::default();
        let sources = system.sources();
        let mut variables = Variables::default();
        for source in voltages {
            variables.add(Variable::voltage(source, sources[source].name.clone()));
        }
        let ties = coordinates == Coordinates::Redundant;
        let scene = system.solids.len();
        let continua = Solids::new(
            solids,
            scene,
            &reference,
            ties,
            &mut variables,
            &mut vectors,
        )?;
        let (intervals, mut present, mut left_out, spans) = {
            let motion = question.of_motion;
            let mut terms = Terms::new(&condensed, &reference, &variables, motion, &mut vectors);
            let span = |m: &Muscle, terms: &mut Terms<'_>| {
                let span = MaterialVector::span(&terms.point(&m.from), &terms.point(&m.to));
                terms.vector(span)
            };
            let muscles = &system.muscles;
            let spans: Vec<usize> = muscles.iter().map(|m| span(m, &mut terms)).collect();
            components::body::build(&rest.bodies, &reference, &mut terms);
            components::muscle::build(muscles, &spans, &mut terms);
            continua.build(&mut terms);
            let no_weight = match system.gravity {
                None => "the scene names no gravity",
                Some(_) => "nothing that moves has a mass",
            };
            terms.without(plan::GRAVITY, no_weight);
            dampers::build(rest, &reference, coordinates, &mut terms);
            system.components.build(&mut terms);
            let (intervals, present, left_out) = terms.finish();
            (intervals, present, left_out, spans)
        };
        let made = match coordinates {
            Coordinates::Reduced => constraints::Made::none(),
            Coordinates::Redundant => constraints::Builder {
                system: rest,
                reference: &reference,
                vectors: &mut vectors,
                continua: &continua,
            }
            .constraints(question.interval),
        };
        let (instants, constraints) = (made.effects, made.multipliers);
        present.extend(made.present);
        left_out.extend(made.left_out);
        plan::settle(&present, &mut left_out);
        let point = |a: &Attachment| MaterialVector::point(a.body, &a.at, &reference);
        let markers = rest
            .markers
            .iter()
            .map(|m| match m.solid {
                Some(solid) => continua.list[solid].nearest(&m.point.at),
                None => vectors.index(point(&m.point)),
            })
            .collect::<Vec<_>>();
        let measures = {
            let known = measures::Known {
                condensed: &condensed,
                reference: &reference,
                variables: &variables,
                markers: &markers,
                continua: &continua.list,
            };
            Measures::new(&question.quantities, &known, &mut vectors)
        };
        let list = vectors.list();
        let multipliers = constraints.len();
        let motion = match coordinates {
            Coordinates::Reduced => {
                let tree = graph.tree(rest, &reference, list);
                CoordinateMap::articulated(tree, list, &continua.nodes, multipliers)
            }
            Coordinates::Redundant => {
                CoordinateMap::redundant(rest.bodies.len(), list, &continua.nodes, multipliers)
            }
        };
        let intervals = {
            let scalars = variables.of(Time::Interval).len();
            Functional::new(intervals, measures.intervals, list.len(), scalars)
        };
        let instants = Functional::new(instants, measures.instants, list.len(), multipliers);
        {
            let named = named::Named {
                coordinates,
                system: rest,
                graph: &graph,
                motion: &motion,
                nodes: &continua.names,
                solids: &continua.list,
            };
            (0..motion.coordinates).for_each(|i| _ = variables.add(named.coordinate(i)));
            let multiplier = |name| Variable::of(Role::Multiplier, name, Size::Unknown);
            constraints
                .into_iter()
                .for_each(|name| _ = variables.add(multiplier(name)));
        }
        Ok(Self {
            coordinates,
            action: Reduced::new(motion, intervals, instants),
            vectors: list.to_vec(),
            variables,
            reached,
            sources,
            solids: continua.list,
            nodes: continua.nodes,
            node_names: continua.names,
            spans,
            markers,
            measured: measures.places,
            gauges: Self::gauges(&system, &condensed),
            multiplier_time: question.interval,
            graph,
            reference,
            present,
            left_out,
            system,
            analysis: question,
            presolved: condensed,
        })
    }

    /// How the coordinates of the joints of the scene are read from the poses of its bodies.
    fn gauges(system: &System, condensed: &Presolved) -> Vec<JointReading> {
        let reference: Vec<Pose> = system.bodies.iter().map(system::Body::pose).collect();
        let coordinates = condensed.system.joint_coordinates();
        let gauge = |(j, joint)| {
            let coordinate = condensed.joint(j).and_then(|kept| coordinates[kept]);
            JointReading::new(joint, coordinate, &reference)
        };
        system.joints.iter().enumerate().map(gauge).collect()
    }

    /// The coordinates of a system: those asked for, or reduced where the joints form a tree.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn choose(
        system: &System,
        coordinates: Option<Coordinates>,
    ) -> Result<Coordinates, ModelError> {
        match (coordinates, Graph::new(system).obstacle(system)) {
            (Some(Coordinates::Reduced), Some(obstacle)) => Err(obstacle),
            (Some(choice), _) => Ok(choice),
            (None, Some(_)) => Ok(Coordinates::Redundant),
            (None, None) => Ok(Coordinates::Reduced),
        }
    }

    /// Poses of the condensed bodies in the reference configuration.
    pub fn reference(&self) -> &[Pose] {
        &self.reference
    }

    /// Number of coordinates of an instant, without multipliers.
    pub fn coordinate_count(&self) -> usize {
        self.action.motion.coordinates
    }

    /// Coordinates of an instant at given joint coordinates (rad or mm, by joint; zero where a joint has none): other joints and
    /// free bodies stay at their reference.
    pub fn coordinates_at(&self, joints: &[f64]) -> Vec<f64> {
        match self.coordinates {
            Coordinates::Reduced => {
                let mut z = self.action.motion.instant().z;
                for (gauge, &value) in self.gauges.iter().zip(joints) {
                    if let Some(c) = gauge.coordinate {
                        z[c] = value;
                    }
                }
                self.place_nodes(&mut z);
                z
            }
            Coordinates::Redundant => {
                let joints = self.presolved.by_joint(joints);
                let system = &self.presolved.system;
                self.coordinates_of(&self.graph.poses(system, &self.reference, &joints))
            }
        }
    }

    /// Director coordinates of given poses; multipliers zero.
    fn coordinates_of(&self, poses: &[Pose]) -> Vec<f64> {
        let mut z = vec![0.0; self.action.motion.unknowns()];
        for (body, pose) in poses.iter().enumerate() {
            let q = &mut z[12 * body..12 * body + 12];
            q[..3].copy_from_slice(pose.centre.as_slice());
            q[3..].copy_from_slice(pose.directors.as_slice());
        }
        self.place_nodes(&mut z);
        z
    }

    /// Puts the nodes at their reference places.
    fn place_nodes(&self, z: &mut [f64]) {
        let motion = &self.action.motion;
        for (value, &(node, axis)) in z[motion.of_bodies..].iter_mut().zip(&motion.of_nodes) {
            *value = self.nodes[node].reference[axis];
        }
    }

    /// Rates of the coordinates of the nodes at the start, after zeros for those of the bodies; `None` at rest.
    pub fn node_rates(&self) -> Option<Vec<f64>> {
        let motion = &self.action.motion;
        let mut rates = vec![0.0; motion.coordinates];
        let mut moves = false;
        for (rate, &(node, axis)) in rates[motion.of_bodies..].iter_mut().zip(&motion.of_nodes) {
            let (block, node) = self.node_names[node];
            if let Some(velocity) = self.solids[block].solid.velocities.get(node) {
                *rate = velocity[axis];
                moves |= *rate != 0.0;
            }
        }
        moves.then_some(rates)
    }

    /// Whether the tangent of a step is symmetric: all coordinates are nodes', and every force has a potential.
    pub fn step_symmetry(&self) -> Symmetry {
        let motion = &self.action.motion;
        let effects = &self.action.intervals.effects;
        let has_potential = effects.iter().all(|e| e.kind() != Kind::VirtualWork);
        match motion.of_bodies == 0 && motion.multipliers == 0 && has_potential {
            true => Symmetry::Symmetric,
            false => Symmetry::Unsymmetric,
        }
    }

    /// The part of a block that nothing holds, if there is one.
    pub fn floating(&self) -> Option<Floating> {
        floating::floating(&self.solids, &self.vectors, &self.nodes)
    }

    /// Joint coordinates (rad or mm, zero where a joint has none) at poses, angles in the branch nearest to `near`.
    pub fn read_joints(&self, poses: &[Pose], near: &[f64]) -> Vec<f64> {
        self.gauges
            .iter()
            .zip(near)
            .map(|(g, &near)| g.read(poses, near))
            .collect()
    }

    /// Joint coordinates of an instant.
    pub fn joints(&self, instant: &Configuration, near: &[f64]) -> Vec<f64> {
        match self.coordinates {
            Coordinates::Reduced => self
                .gauges
                .iter()
                .map(|g| g.coordinate.map_or(0.0, |c| instant.z[c]))
                .collect(),
            Coordinates::Redundant => self.read_joints(&self.poses(instant), near),
        }
    }

    /// Poses of all bodies of the scene at an instant.
    pub fn poses(&self, instant: &Configuration) -> Vec<Pose> {
        let poses = self.condensed_poses(instant);
        self.presolved.poses(&poses, &self.system.bodies)
    }

    /// Poses of the condensed bodies at an instant, which carry the vectors.
    pub fn condensed_poses(&self, instant: &Configuration) -> Vec<Pose> {
        let bodies = self.presolved.system.bodies.len();
        self.action.motion.poses(instant, bodies)
    }

    /// Inputs of an interval from one voltage a source.
    pub fn scalars(&self, voltages: &[f64]) -> Vec<f64> {
        self.variables.sources().map(|s| voltages[s]).collect()
    }

    /// Typical sizes of the unknowns of a step: 1 rad, the length of the system; infinite where the model does not tell.
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
        let far = |length: f64, x: &Vector| length.max(x.amax());
        let nodes = self.nodes.iter().map(|n| &n.reference);
        let places = self.reference.iter().map(|p| &p.centre).chain(nodes);
        let length = places
            .chain(self.presolved.system.joints.iter().map(|j| &j.at))
            .fold(0.0, far);
        if length > 0.0 { length } else { 1.0 }
    }
}
