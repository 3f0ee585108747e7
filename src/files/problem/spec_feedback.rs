//! Feedback of a problem as it is written: costs of deviations along an optimum, and a controller in a simulation.

use crate::files::units::quantity::{
    Angle, AngularVelocity, JointCoordinate, Length, Quantity, Time, Velocity,
};
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A linear-quadratic regulator along the optimum; its gains are written to `feedback.json`, `feedback.csv` and `feedback.npz`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeedbackSpec {
    /// Costs of deviations.
    #[serde(default)]
    pub weights: WeightsSpec,
    /// Greatest length of the steps that are linearised, SI unit s; 1 ms where not written. Gains act over the intervals of the optimum.
    #[serde(default)]
    pub step: Option<Quantity<Time>>,
    /// Time from a measurement to its effect, over which the state is predicted, SI unit s, upwards to whole intervals; 0 where not written.
    #[serde(default)]
    pub delay: Option<Quantity<Time>>,
    /// Factor of the costs at the end: of holding the goal for ever, or, where its voltages are not known, of the deviations there; 1 where
    /// not written.
    #[serde(default)]
    pub terminal: Option<f64>,
    /// Measurements of the controller in place of the state, which a Kalman filter along the optimum then finds from them.
    #[serde(default)]
    pub observer: Option<ObserverSpec>,
}

/// Standard deviations of what is measured at the start of each interval, and of what disturbs the motion in it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObserverSpec {
    /// Of measured joint coordinates, by joint, SI unit rad or m.
    #[serde(default)]
    pub joints: BTreeMap<String, Quantity<JointCoordinate>>,
    /// Of each component of the places of measured markers, by marker, SI unit m.
    #[serde(default)]
    pub markers: BTreeMap<String, Quantity<Length>>,
    /// Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; 0.05 where not written.
    #[serde(default)]
    pub voltages: Option<f64>,
    /// Of the rates of all coordinates, in 100 degrees/s or 100 mm/s, 0.1 where not written: pushes.
    #[serde(default)]
    pub rates: Option<f64>,
    /// Of the change in each interval of a lasting force on each joint, as a part of the greatest force of an input on it. These forces are then found
    /// beside the state, and inputs hold the goal against them; without it none are. As many independent measurements are needed as there are joints.
    #[serde(default)]
    pub lasting: Option<f64>,
}

/// Factors of sums of squares of deviations.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightsSpec {
    /// Of coordinates of joints and nodes in degrees or mm; 1 where not written.
    #[serde(default)]
    pub joints: Option<f64>,
    /// Of their mean rates over an interval in 100 degrees/s or 100 mm/s; 0 where not written.
    #[serde(default)]
    pub rates: Option<f64>,
    /// Of places of markers in mm, by name; 0 where not named.
    #[serde(default)]
    pub markers: BTreeMap<String, f64>,
    /// Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; positive, 0.01 where not written.
    #[serde(default)]
    pub voltages: Option<f64>,
    /// Of integrals over time of the deviations of joint coordinates, in degrees or mm times 0.1 s; 0 where not written, and then none are formed.
    /// They take deviations at rest to zero, where there are inputs enough.
    #[serde(default)]
    pub integral: Option<f64>,
}

/// A controller that follows a motion by the gains of `feedback.json`, or plans anew over a receding horizon: one of `feedback` and `horizon`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControllerSpec {
    /// Path of a `feedback.json` or of the folder that holds it, relative to this file or to the current folder. It gives the inputs that were sought
    /// in its problem; the robot here has joints of the same names, and may be another one otherwise.
    #[serde(default)]
    pub feedback: Option<String>,
    /// Plans anew in each interval, without `sample`.
    #[serde(default)]
    pub horizon: Option<HorizonSpec>,
    /// Time between samples, a multiple of the step, SI unit s; the interval of the gains, for which they are, where not written.
    #[serde(default)]
    pub sample: Option<Quantity<Time>>,
    /// Time from a sample to its effect, a multiple of the step, SI unit s; that which the gains or plans predict where not written.
    #[serde(default)]
    pub delay: Option<Quantity<Time>>,
    /// Noise of what is measured.
    #[serde(default)]
    pub noise: NoiseSpec,
    /// Simulations of parts of the disturbance too, for a slider on the page.
    #[serde(default)]
    pub disturbance: Option<DisturbanceSpec>,
}

/// The disturbance of a closed loop: what differs from the robot and the motion that the controller knows. It is simulated in several sizes, of which 0 has
/// none and 1 is that of the problem.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DisturbanceSpec {
    /// Values without the disturbance, by their places in the problem, or in its scene after `scene.`. Values of a size are on the line between these and
    /// those of the problem.
    pub without: BTreeMap<String, serde_json::Value>,
    /// Sizes, the smallest first; 0, 0.25, 0.5 and 1 where not written.
    #[serde(default)]
    pub sizes: Option<Vec<f64>>,
}

/// A motion that is planned anew over a horizon in each interval of its problem, with its limits and bounds, by one iteration of an interior-point
/// method.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HorizonSpec {
    /// Path of a problem file with a `control`, relative to this file or to the current folder, whose optimum is followed. The costs of deviations are
    /// those of its `feedback`, and their usual ones without it. The robot here has joints of the same names, and may be another one otherwise.
    pub problem: String,
    /// Number of its intervals in the horizon; what follows counts as the regulator of the same costs does.
    pub intervals: usize,
}

/// Standard deviations of what is measured; 0 where not written.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseSpec {
    /// Of angles, SI unit rad.
    #[serde(default)]
    pub angle: Option<Quantity<Angle>>,
    /// Of lengths, SI unit m.
    #[serde(default)]
    pub length: Option<Quantity<Length>>,
    /// Of rates of angles, SI unit rad/s.
    #[serde(default)]
    pub angular_velocity: Option<Quantity<AngularVelocity>>,
    /// Of rates of lengths, SI unit m/s.
    #[serde(default)]
    pub velocity: Option<Quantity<Velocity>>,
    /// Seed of the numbers that are drawn; 0 where not written.
    #[serde(default)]
    pub seed: u64,
}
