//! Where physics meets indices: from a checked system to sums of effects over its coordinates.

mod constraints;
mod effects;
mod error;
mod graph;
mod joints;
mod quantity;
pub mod system;

pub use error::ModelError;
pub use graph::Graph;
pub use joints::JointGauge;
pub use quantity::{Quantity, Region};
pub use system::{System, VACUUM_PERMITTIVITY};

use crate::functional::Sum;
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Vector;
use crate::reduction::{Instant, Motion, Reduced};
use system::Attachment;

/// Coordinates in which a problem is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// Independent joint coordinates; joints form a tree.
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
    /// Which coordinates.
    pub coordinates: Coordinates,
    /// The action as a function of coordinates and voltages.
    pub action: Reduced,
    /// The vectors that effects read, in terms of poses.
    pub vectors: Vec<MaterialVector>,
    /// Muscle of each voltage.
    pub voltages: Vec<usize>,
    /// Vector of the span of each muscle.
    pub spans: Vec<usize>,
    /// Vector of each marker.
    pub markers: Vec<usize>,
    /// How the coordinates of each joint are read from poses.
    pub gauges: Vec<JointGauge>,
    /// Names of the multipliers.
    pub multiplier_names: Vec<String>,
    /// Time that scales multipliers: the action holds −h₀ λ·g, in ms.
    pub multiplier_time: f64,
    graph: Graph,
    reference: Vec<Pose>,
}

impl Model {
    /// Builds the model of a system for intervals of about `h0` ms, in which `quantities` can be measured.
    ///
    /// Without a choice the coordinates are reduced where the joints form a tree that the reduction knows.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn new(
        system: System,
        coordinates: Option<Coordinates>,
        h0: f64,
        quantities: &[Quantity],
    ) -> Result<Self, ModelError> {
        let coordinates = Self::choose(&system, coordinates)?;
        let graph = Graph::new(&system);
        let reference: Vec<Pose> = system.bodies.iter().map(system::Body::pose).collect();
        let mut vectors = Vectors::default();
        let mut parts = effects::Builder::new(&system, &reference, &mut vectors);
        let intervals = parts.intervals();
        let (instants, multiplier_names) = match coordinates {
            Coordinates::Reduced => (Vec::new(), Vec::new()),
            Coordinates::Redundant => parts.constraints(h0),
        };
        let (voltages, spans) = (parts.voltages, parts.spans);
        let point = |a: &Attachment| MaterialVector::point(a.body, &a.at, &reference);
        let markers = system
            .markers
            .iter()
            .map(|m| vectors.index(point(&m.point)))
            .collect();
        let measures = quantity::measures(quantities, &system, &reference, &voltages, &mut vectors);
        let list = vectors.list();
        let multipliers = multiplier_names.len();
        let motion = match coordinates {
            Coordinates::Reduced => {
                Motion::articulated(graph.tree(&system, &reference, list), multipliers)
            }
            Coordinates::Redundant => Motion::redundant(system.bodies.len(), list, multipliers),
        };
        let intervals = Sum::new(intervals, measures.intervals, list.len(), voltages.len());
        let instants = Sum::new(instants, measures.instants, list.len(), multipliers);
        let gauge = |(joint, coordinate)| JointGauge::new(joint, coordinate, &reference);
        let gauges = system
            .joints
            .iter()
            .zip(system.joint_coordinates())
            .map(gauge)
            .collect();
        Ok(Self {
            coordinates,
            action: Reduced::new(motion, intervals, instants),
            vectors: list.to_vec(),
            voltages,
            spans,
            markers,
            gauges,
            multiplier_names,
            multiplier_time: h0,
            graph,
            reference,
            system,
        })
    }

    /// The coordinates of a system: those asked for, or reduced where the joints form a tree that the reduction knows.
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

    /// Rates of director coordinates at joint coordinates with given rates.
    pub fn redundant_rates(&self, joints: &[f64], rates: &[f64]) -> Vec<f64> {
        self.graph
            .rates(&self.system, &self.reference, joints, rates)
    }

    /// Poses of the reference configuration.
    pub fn reference(&self) -> &[Pose] {
        &self.reference
    }

    /// Number of coordinates of an instant, without multipliers.
    pub fn coordinate_count(&self) -> usize {
        self.action.motion.coordinates
    }

    /// What coordinate or multiplier `i` of an instant is.
    pub fn unknown_name(&self, i: usize) -> String {
        let n = self.coordinate_count();
        match self.coordinates {
            _ if i >= n => format!("multiplier of {}", self.multiplier_names[i - n]),
            Coordinates::Reduced => {
                let joint = self.gauges.iter().position(|g| g.coordinate == Some(i));
                format!(
                    "coordinate of {}",
                    self.system.joints[joint.expect("each coordinate has a joint")].name
                )
            }
            Coordinates::Redundant => {
                let part = ["centre", "d1", "d2", "d3"][i % 12 / 3];
                let axis = ["x", "y", "z"][i % 3];
                format!("{} {part}.{axis}", self.system.bodies[i / 12].name)
            }
        }
    }

    /// Whether coordinate `i` is a length, rather than an angle or a component of a director.
    pub fn is_length(&self, i: usize) -> bool {
        match self.coordinates {
            Coordinates::Redundant => i % 12 < 3,
            Coordinates::Reduced => {
                let prismatic =
                    |j: &system::Joint| matches!(j.kind, system::JointKind::Prismatic { .. });
                let joint = self.gauges.iter().position(|g| g.coordinate == Some(i));
                joint.is_some_and(|j| prismatic(&self.system.joints[j]))
            }
        }
    }

    /// Coordinates of an instant at given joint coordinates (rad or mm, by joint; zero where a joint has none).
    pub fn coordinates_at(&self, joints: &[f64]) -> Vec<f64> {
        match self.coordinates {
            Coordinates::Reduced => {
                let mut z = vec![0.0; self.action.motion.unknowns()];
                for (gauge, &value) in self.gauges.iter().zip(joints) {
                    if let Some(c) = gauge.coordinate {
                        z[c] = value;
                    }
                }
                z
            }
            Coordinates::Redundant => {
                self.coordinates_of(&self.graph.poses(&self.system, &self.reference, joints))
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
        z
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
    pub fn joints(&self, instant: &Instant, near: &[f64]) -> Vec<f64> {
        match self.coordinates {
            Coordinates::Reduced => self
                .gauges
                .iter()
                .map(|g| g.coordinate.map_or(0.0, |c| instant.z[c]))
                .collect(),
            Coordinates::Redundant => self.read_joints(&self.poses(instant), near),
        }
    }

    /// Poses of all bodies at an instant.
    pub fn poses(&self, instant: &Instant) -> Vec<Pose> {
        self.action.motion.poses(instant, self.system.bodies.len())
    }

    /// Voltages in the order of the scalars of an interval from one voltage a muscle.
    pub fn scalars(&self, voltages: &[f64]) -> Vec<f64> {
        self.voltages.iter().map(|&m| voltages[m]).collect()
    }

    /// A length in mm that is typical of the system.
    pub fn length(&self) -> f64 {
        let far = |length: f64, x: &Vector| length.max(x.amax());
        let places = self.reference.iter().map(|p| &p.centre);
        let length = places
            .chain(self.system.joints.iter().map(|j| &j.at))
            .fold(0.0, far);
        if length > 0.0 { length } else { 1.0 }
    }
}
