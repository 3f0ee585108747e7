//! The end of another motion, as the start of a new one.

use crate::control::mesh_match::other_mesh;
use crate::dynamics::{Start, StepState};
use crate::kinematics::Pose;
use crate::model::{Coordinates, Model};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Places that differ by no more than this part of the size of the system are one: a file has other units.
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
