//! States at the start and at the end of a motion.
//!
//! Comparison of the meshes of an earlier motion with those of a model.

use crate::control::goal::{Orientation, Place};
use crate::dynamics::{Start, StepState};
use crate::kinematics::Pose;
use crate::math::Vector;
use crate::model::{Coordinates, Model};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A state of rest, or of given motion.
#[derive(Clone, Debug, PartialEq)]
pub enum BoundaryState {
    /// Static equilibrium under these voltages (V, one per muscle), and at a goal what of it is reached; the start has all of it.
    RestAtVoltages(Vec<f64>, Rest),
    /// Joint coordinates by joint index (rad or mm); at a start, joints not named stay at zero.
    JointAngles {
        /// Coordinates.
        angles: BTreeMap<usize, f64>,
        /// Rates in rad/ms or mm/ms, zero where not named; at a goal only where all coordinates are given.
        rates: BTreeMap<usize, f64>,
        /// Velocity of the centre of mass in mm/ms and angular velocity in rad/ms by body, both in the ground frame; only at a start,
        /// of the first body of a free part and of those on a spherical or floating joint. Others follow from their joints.
        velocities: BTreeMap<usize, [Vector3<f64>; 2]>,
    },
    /// The end of another motion, moving on; only at a start.
    EndOf(Box<EndState>),
    /// Positions of markers in mm by marker index and orientations of bodies by body index, at rest; only as a goal.
    Markers {
        /// The places.
        places: BTreeMap<usize, Place>,
        /// The orientations.
        orientations: BTreeMap<usize, Orientation>,
        /// Part of the system that comes to rest there.
        rest: Rest,
        /// Voltages that are held afterwards (V, one per source), where they are known.
        hold: Option<Vec<f64>>,
    },
    /// Anything, in motion or at rest; only as a goal.
    Free,
    /// The start, which is sought: coordinates and momenta are the same there; only as a goal. The state at the start is where the solver
    /// begins.
    Periodic,
}

impl BoundaryState {
    /// Returns true if it gives a rate other than zero.
    pub fn has_rates(&self) -> bool {
        matches!(self, Self::JointAngles { rates, .. } if rates.values().any(|rate| *rate != 0.0))
    }

    /// Joint coordinates by joint index, at rest.
    pub fn at_joints(angles: BTreeMap<usize, f64>) -> Self {
        Self::JointAngles {
            angles,
            rates: BTreeMap::new(),
            velocities: BTreeMap::new(),
        }
    }
}

/// Part of the system that comes to rest at a goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rest {
    /// Every coordinate.
    #[default]
    Everything,
    /// Bodies and the markers of the goal; elastic blocks have more coordinates than a few voltages can bring to rest.
    Bodies,
    /// Every coordinate, or, of elastic blocks where the voltages are too few for that, bodies and the markers of the goal.
    Attainable,
}

/// Treatment of a goal that its voltages do not keep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// It is reported.
    #[default]
    Reported,
    /// It is refused.
    Required,
}

/// Search for the inputs that hold a goal of places or joint coordinates that names none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SoughtHold {
    /// They are unknowns of a second solve, if the motion leaves the goal under its last inputs.
    #[default]
    WhereLeft,
    /// They are unknowns.
    Always,
    /// They are not sought.
    Never,
}

impl BoundaryState {
    /// The voltages in V, by source, that act there, where they are known: at rest those that hold it, where another motion ended those to
    /// which its muscles are charged.
    pub fn voltages(&self) -> Option<&[f64]> {
        match self {
            Self::RestAtVoltages(voltages, _) => Some(voltages),
            Self::EndOf(end) => Some(&end.voltages),
            Self::Markers { hold, .. } => hold.as_deref(),
            Self::JointAngles { .. } | Self::Free | Self::Periodic => None,
        }
    }

    /// A goal that leaves open what rests, with what rests.
    pub(crate) fn resting(&self, what: Rest) -> Option<Self> {
        let mut goal = self.clone();
        let rest = match &mut goal {
            Self::RestAtVoltages(_, rest) | Self::Markers { rest, .. } => rest,
            _ => return None,
        };
        (std::mem::replace(rest, what) == Rest::Attainable).then_some(goal)
    }

    /// Returns notes on the state.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::EndOf(end) => &end.notes,
            _ => &[],
        }
    }
}

/// Places that differ by no more than this part of the size of the system or of a mesh are one: a file has other units.
const SAME_PLACE: f64 = 1e-9;

/// The last instant of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct EndState {
    /// The folder of its result.
    pub source: PathBuf,
    /// Coordinates to which `z` and `momentum` belong.
    pub coordinates: Coordinates,
    /// Coordinates, multipliers and charts.
    pub z: Vec<f64>,
    /// Momentum of each coordinate.
    pub momentum: Vec<f64>,
    /// Poses of the bodies of the scene.
    pub poses: Vec<Pose>,
    /// Reference places in mm of the nodes of each solid and each muscle of finite elements, by its name.
    pub meshes: BTreeMap<String, Vec<[f64; 3]>>,
    /// Voltages in V by source to which the muscles are charged.
    pub voltages: Vec<f64>,
    /// State of the method, from which the same method resumes to the bit; no lists where it is not known.
    pub method: StepState,
    /// Notes on that motion.
    pub notes: Vec<String>,
}

impl EndState {
    /// The start of a motion of a model.
    ///
    /// # Errors
    /// It is no state of this model; the text says what differs.
    pub(super) fn start(&self, model: &Model) -> Result<Start, String> {
        let (source, map) = (self.source.display(), &model.action.map);
        let [there, here] = [self.coordinates, model.coordinates].map(Coordinates::name);
        if self.coordinates != model.coordinates {
            return Err(format!(
                "{source} is in {there} coordinates, and this motion in {here} ones; expected \"coordinates\": \"{there}\" beside the start"
            ));
        }
        if let Some(solid) = other_mesh(model, &self.meshes) {
            return Err(format!(
                "{source} has other nodes of \"{solid}\"; expected a result of the same robot on the same mesh"
            ));
        }
        let [count, length] = [map.coordinates, map.instant().z.len()];
        if [self.momentum.len(), self.z.len()] != [count, length] {
            return Err(format!(
                "{source} has {} coordinates, and this motion {count}; expected a result of the same robot, of which everything could move",
                self.momentum.len()
            ));
        }
        if !self.z.iter().chain(&self.momentum).all(|x| x.is_finite()) {
            return Err(format!(
                "{source} ends with a coordinate or momentum that is no number; expected a motion"
            ));
        }
        if !map.has_unit_charts(&self.z) {
            return Err(format!(
                "{source} ends with a rotation whose quaternion does not have length one; expected a motion"
            ));
        }
        let poses = model.poses(&map.placed(&self.z));
        let tolerance = SAME_PLACE * model.length();
        let bodies = poses.iter().zip(&self.poses).zip(&model.system.bodies);
        for ((here, there), body) in bodies {
            let apart = (here.centre - there.centre).amax();
            let turned = (here.directors - there.directors).amax();
            if !(apart <= tolerance && turned <= SAME_PLACE) {
                return Err(format!(
                    "with the coordinates at the end of {source} body \"{}\" is {apart:.3e} mm away from where it ended, its directors differ by {turned:.1e}; expected a result of a robot with the same places of bodies and joints",
                    body.name
                ));
            }
        }
        Ok(Start::moving(model, self.z.clone(), self.momentum.clone()))
    }
}

/// The first solid of a model whose nodes differ from the given ones: reference places in mm by the name of a solid.
pub(super) fn other_mesh<'m>(
    model: &'m Model,
    told: &BTreeMap<String, Vec<[f64; 3]>>,
) -> Option<&'m str> {
    let mut solids = model.solids.iter().map(|block| &block.solid);
    let other = solids.find(|solid| {
        let nodes = &solid.mesh.nodes;
        let tolerance = SAME_PLACE * solid.mesh.size();
        let apart = |a: [f64; 3], b: &Vector| (Vector::from(a) - b).amax();
        told.get(&solid.name).is_some_and(|told| {
            let mut places = told.iter().zip(nodes);
            told.len() != nodes.len() || places.any(|(&a, b)| apart(a, b) > tolerance)
        })
    });
    other.map(|solid| solid.name.as_str())
}
