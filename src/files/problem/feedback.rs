//! Conversion of the feedback of a problem file to costs of deviations, and to a controller.

use crate::control::problem::{FeedbackControl, Noise, Observation, Regulator};
use crate::feedback::Law;
use crate::files::feedback::read_law;
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::At;
use crate::files::units::quantity::{
    Angle, AngularVelocity, JointCoordinate, Length, PhysicalQuantity, Quantity, Time, Velocity,
};
use crate::math::shortest;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Words on the file of a problem that a controller plans anew.
pub(crate) const CONTROL_FILE: &str = "the path of a problem file with a \"control\"";
/// Part of a step by which a sample or delay may differ from a multiple of it.
pub(crate) const ROUNDING: f64 = 1e-6;

pub(crate) fn regulator(spec: &FeedbackSpec, at: &At<'_>) -> Result<Regulator> {
    let place = at.key("weights");
    let weight = |key: &str, written: Option<f64>, usual: f64| weight(key, written, usual, &place);
    let usual = Regulator::default();
    let weights = &spec.weights;
    let mut markers = Vec::new();
    for (name, &weight) in &weights.markers {
        let place = place.key("markers").key(name);
        let marker = place.marker(name)?;
        let weight = finite(weight, &place)?;
        markers.extend((weight > 0.0).then_some((marker, weight)));
    }
    let inputs = weight("voltages", weights.voltages, usual.inputs)?;
    refuse!(if inputs == 0.0, place.key("voltages");
        found "0", expected "a positive weight: without one the voltages are not bounded");
    let out = Regulator {
        coordinates: weight("joints", weights.joints, usual.coordinates)?,
        rates: weight("rates", weights.rates, usual.rates)?,
        markers,
        inputs,
        integral: weight("integral", weights.integral, usual.integral)?,
        step: at
            .optional("step", &spec.step, |at, step| at.positive(step))?
            .unwrap_or(usual.step),
        delay: or_zero("delay", &spec.delay, at)?,
        terminal: self::weight("terminal", spec.terminal, usual.terminal, at)?,
        observer: at.optional("observer", &spec.observer, observation)?,
    };
    let lasting = out.observer.as_ref().and_then(|one| one.lasting);
    refuse!(if out.integral > 0.0 && lasting.is_some(), place.key("integral");
        found out.integral,
        expected "no integrals beside constant disturbances of the observer, which do their work");
    let costs = [out.coordinates, out.rates, out.integral];
    refuse!(if costs.iter().all(|cost| *cost == 0.0) && out.markers.is_empty(), place;
        found "no positive weight of a deviation", expected "one or more");
    Ok(out)
}

fn observation(at: &At<'_>, spec: &ObserverSpec) -> Result<Observation> {
    let positive = |deviation: f64, place: &Scope<'_>| match deviation > 0.0 {
        true => Ok(deviation),
        false => Err(place.wrong(deviation.to_string(), "a positive standard deviation")),
    };
    let joints = at
        .key("joints")
        .each_named(&spec.joints, |name, deviation, at| {
            let joint = at.coordinate(name)?;
            Ok((joint, positive(at.of_joint(joint, deviation)?, at)?))
        })?;
    let markers = at
        .key("markers")
        .each_named(&spec.markers, |name, deviation, at| {
            Ok((at.moving_marker(name)?, at.positive(deviation)?))
        })?;
    let [inputs, rates] = Observation::USUAL;
    let out = Observation {
        joints,
        markers,
        inputs: weight("voltages", spec.voltages, inputs, at)?,
        rates: weight("rates", spec.rates, rates, at)?,
        lasting: spec.lasting,
    };
    if let Some(part) = spec.lasting {
        refuse!(if !(part > 0.0 && part.is_finite()), at.key("lasting");
            found part, expected "a positive number, or none where no force lasts");
    }
    refuse!(if out.joints.is_empty() && out.markers.is_empty(), at;
        found "nothing that is measured", expected "\"joints\", \"markers\" or both");
    Ok(out)
}

/// The weight under a key, or the usual one.
fn weight(key: &str, written: Option<f64>, usual: f64, at: &Scope<'_>) -> Result<f64> {
    written.map_or(Ok(usual), |weight| finite(weight, &at.key(key)))
}

fn finite(weight: f64, place: &Scope<'_>) -> Result<f64> {
    match weight.is_finite() {
        true => place.weight(weight),
        false => Err(place.wrong(weight.to_string(), "a finite number")),
    }
}

/// A controller of a simulation in steps of a length in ms; `None`: their length follows a tolerance.
pub(crate) fn controller(
    spec: &ControllerSpec,
    step: Option<f64>,
    at: &At<'_>,
) -> Result<FeedbackControl> {
    let Some(step) = step else {
        let expected = "a \"step\" of the simulation: samples are multiples of it";
        return Err(at.wrong("steps of no given length", expected));
    };
    let path = match (&spec.feedback, &spec.horizon) {
        (Some(path), None) => path,
        (None, Some(horizon)) => return planning(spec, horizon, step, at),
        (both, _) => {
            let found = if both.is_some() { "both" } else { "neither" };
            let found = format!("{found} of \"feedback\" and \"horizon\"");
            return Err(at.wrong(found, "one of them"));
        }
    };
    let place = at.key("feedback");
    let path = place.feedback_file(path)?;
    let law = read_law(&path, at.system)?;
    let sample = match &spec.sample {
        Some(sample) => multiple(sample, step, &at.key("sample"))?,
        None => (law.h / step - 1e-6).ceil().max(1.0) * step,
    };
    let is_other = (sample - law.h).abs() > ROUNDING * law.h;
    let h = shortest(law.h, 9);
    refuse!(if law.observer.is_some() && is_other, at.key("sample");
        found format!("{} ms", shortest(sample, 9)),
        expected format!("{h} ms, the interval of the observer, in steps of which it is a multiple"));
    let noise = noise(&spec.noise, &at.key("noise"))?;
    refuse_unread(&noise, &law, &at.key("noise"))?;
    let predicted = (law.delay as f64 * law.h / step - 1e-6).ceil() * step;
    let delay = delay(spec, step, at)?.unwrap_or(predicted);
    Ok(FeedbackControl {
        law: Arc::new(law),
        path,
        sample,
        delay,
        noise,
        ahead: None,
    })
}

/// Refuses noise of a kind of which the controller measures nothing.
fn refuse_unread(noise: &Noise, law: &Law, at: &Scope<'_>) -> Result<()> {
    let [found, expected] = Noise::UNREAD;
    noise
        .unread(law)
        .map_or(Ok(()), |key| Err(at.key(key).wrong(found, expected)))
}

/// The delay of a controller as it is written, a multiple of the step.
fn delay(spec: &ControllerSpec, step: f64, at: &Scope<'_>) -> Result<Option<f64>> {
    match &spec.delay {
        Some(delay) if delay.value() != 0.0 => multiple(delay, step, &at.key("delay")).map(Some),
        delay => Ok(delay.as_ref().map(|_| 0.0)),
    }
}

fn noise(of: &NoiseSpec, place: &Scope<'_>) -> Result<Noise> {
    Ok(Noise {
        angle: or_zero("angle", &of.angle, place)?,
        length: or_zero("length", &of.length, place)?,
        angular_velocity: or_zero("angular_velocity", &of.angular_velocity, place)?,
        velocity: or_zero("velocity", &of.velocity, place)?,
        seed: of.seed,
    })
}

/// A controller that plans anew in each interval of a problem, which is read later.
fn planning(
    spec: &ControllerSpec,
    horizon: &HorizonSpec,
    step: f64,
    at: &Scope<'_>,
) -> Result<FeedbackControl> {
    refuse!(if let Some(sample) = &spec.sample, at.key("sample");
        found sample,
        expected "none beside \"horizon\", which plans anew in each interval of its problem");
    Ok(FeedbackControl {
        law: Arc::default(),
        path: at
            .key("horizon")
            .key("problem")
            .file_or_result(&horizon.problem, CONTROL_FILE)?,
        sample: 0.0,
        delay: delay(spec, step, at)?.unwrap_or(0.0),
        noise: noise(&spec.noise, &at.key("noise"))?,
        ahead: None,
    })
}

/// A quantity under a key that is zero or more; zero where not written.
fn or_zero<M: PhysicalQuantity>(
    key: &str,
    written: &Option<Quantity<M>>,
    at: &Scope<'_>,
) -> Result<f64> {
    match written {
        Some(quantity) if quantity.value() != 0.0 => at.key(key).positive(quantity),
        _ => Ok(0.0),
    }
}

/// A positive multiple of the step in ms.
fn multiple<M: PhysicalQuantity>(
    written: &Quantity<M>,
    step: f64,
    place: &Scope<'_>,
) -> Result<f64> {
    let time = place.positive(written)?;
    let steps = (time / step).round();
    let is_multiple = steps >= 1.0 && (time / step - steps).abs() <= ROUNDING * steps;
    refuse!(if !is_multiple, place;
        found written, expected format!("a multiple of the step {} ms", shortest(step, 9)));
    Ok(steps * step)
}

read_objects! {
    /// A linear-quadratic regulator along the optimum; its gains are written to `feedback.json`, `feedback.csv` and `feedback.npz`.
    #[derive(Default)]
    pub struct FeedbackSpec {
        /// Costs of deviations.
        pub weights?: WeightsSpec,
        /// Greatest length of the steps that are linearised, SI unit s; 1 ms where not written. Gains act over the intervals of the optimum.
        pub step: Option<Quantity<Time>>,
        /// Time from a measurement to its effect, over which the state is predicted, SI unit s, upwards to whole intervals; 0 where not written.
        pub delay: Option<Quantity<Time>>,
        /// Factor of the costs at the end: of holding the goal for ever, or, where its voltages are not known, of the deviations there; 1 where
        /// not written.
        pub terminal: Option<f64>,
        /// Measurements of the controller in place of the state, which a Kalman filter along the optimum then finds from them.
        pub observer: Option<ObserverSpec>,
    }

    /// Standard deviations of what is measured at the start of each interval, and of what disturbs the motion in it.
    pub struct ObserverSpec {
        /// Of measured joint coordinates, by joint, SI unit rad or m.
        pub joints: BTreeMap<String, Quantity<JointCoordinate>>,
        /// Of each component of the places of measured markers, by marker, SI unit m.
        pub markers: BTreeMap<String, Quantity<Length>>,
        /// Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; 0.05 where not written.
        pub voltages: Option<f64>,
        /// Of the rates of all coordinates, in 100 degrees/s or 100 mm/s, 0.1 where not written: pushes.
        pub rates: Option<f64>,
        /// Of the change in each interval of a constant disturbance on each joint, as a part of the greatest force of an input on it. These forces are then found
        /// beside the state, and inputs hold the goal against them; without it none are. As many independent measurements are needed as there are joints.
        pub lasting: Option<f64>,
    }

    /// Factors of sums of squares of deviations.
    #[derive(Default)]
    pub struct WeightsSpec {
        /// Of coordinates of joints and nodes in degrees or mm; 1 where not written.
        pub joints: Option<f64>,
        /// Of their mean rates over an interval in 100 degrees/s or 100 mm/s; 0 where not written.
        pub rates: Option<f64>,
        /// Of places of markers in mm, by name; 0 where not named.
        pub markers: BTreeMap<String, f64>,
        /// Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; positive, 0.01 where not written.
        pub voltages: Option<f64>,
        /// Of integrals over time of the deviations of joint coordinates, in degrees or mm times 0.1 s; 0 where not written, and then none are formed.
        /// They take deviations at rest to zero, where there are inputs enough.
        pub integral: Option<f64>,
    }

    /// A controller that follows a motion by the gains of `feedback.json`, or plans anew over a receding horizon: one of `feedback` and `horizon`.
    pub struct ControllerSpec {
        /// Path of a `feedback.json` or of the folder that holds it, relative to this file or to the current folder. It gives the inputs that were sought
        /// in its problem; the robot here has joints of the same names, and may be another one otherwise.
        pub feedback: Option<String>,
        /// Plans anew in each interval, without `sample`.
        pub horizon: Option<HorizonSpec>,
        /// Time between samples, a multiple of the step, SI unit s; the interval of the gains, for which they are, where not written.
        pub sample: Option<Quantity<Time>>,
        /// Time from a sample to its effect, a multiple of the step, SI unit s; that which the gains or plans predict where not written.
        pub delay: Option<Quantity<Time>>,
        /// Noise of what is measured.
        pub noise?: NoiseSpec,
        /// Simulations of parts of the disturbance too, for a slider on the page.
        pub disturbance: Option<DisturbanceSpec>,
    }
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

read_objects! {
    /// A motion that is planned anew over a horizon in each interval of its problem, with its limits and bounds, by one iteration of an interior-point
    /// method.
    pub struct HorizonSpec {
        /// Path of a problem file with a `control`, relative to this file or to the current folder, whose optimum is followed. The costs of deviations are
        /// those of its `feedback`, and their usual ones without it. The robot here has joints of the same names, and may be another one otherwise.
        pub problem: String,
        /// Number of its intervals in the horizon; what follows counts as the regulator of the same costs does.
        pub intervals: usize,
    }

    /// Standard deviations of what is measured; 0 where not written.
    #[derive(Default)]
    pub struct NoiseSpec {
        /// Of angles, SI unit rad.
        pub angle: Option<Quantity<Angle>>,
        /// Of lengths, SI unit m.
        pub length: Option<Quantity<Length>>,
        /// Of rates of angles, SI unit rad/s.
        pub angular_velocity: Option<Quantity<AngularVelocity>>,
        /// Of rates of lengths, SI unit m/s.
        pub velocity: Option<Quantity<Velocity>>,
        /// Seed of the numbers that are drawn; 0 where not written.
        pub seed?: u64,
    }
}
