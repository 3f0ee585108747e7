//! Vibrations about a state of rest, and the response to an input that oscillates.

use crate::control::problem::{AtRest, FrequencySweep, VibrationRequest};
use crate::dynamics::{
    DiscreteTrajectory, Equilibrium, Modes, Vibration, Vibrations, stable_equilibrium,
};
use crate::math::significant;
use crate::model::system::System;
use crate::model::{Model, Quantity, joint_unit};
use crate::stop;
use crate::workflow::WorkflowError;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Instants of a period of a mode that is shown, the periods of each, and the time in ms from one to the next.
const INSTANTS: usize = 24;
const PERIODS: usize = 2;
const SHOWN: f64 = 1000.0 / 24.0;
/// Largest change of a mode that is shown, in rad and lengths of the system.
const SIZE: f64 = 0.1;
/// Damping ratio of a vibration at whose frequency the response has no bound.
const UNDAMPED: f64 = 1e-9;
/// Parts of the length of the system by which the state of rest of motions may differ from that of rest alone.
const SAME: f64 = 1e-6;

/// Vibrations that were found.
#[derive(Debug)]
pub struct Vibrating {
    /// The model of motions.
    pub model: Model,
    /// The slowest motions.
    pub modes: Modes,
    /// The response to an input that oscillates.
    pub response: Option<FrequencyResponse>,
    /// Shapes one after another, each for two slow periods.
    pub shapes: DiscreteTrajectory,
    /// Notes on them.
    pub notes: Vec<String>,
}

/// Responses of joints and markers to an input of amplitude 1.
#[derive(Debug)]
pub struct FrequencyResponse {
    /// The source.
    pub source: usize,
    /// Frequencies in kHz.
    pub frequencies: Vec<f64>,
    /// Names of what responds, and units, `mm` or `rad`.
    pub outputs: Vec<(String, &'static str)>,
    /// Responses at each frequency, in the unit for V, N or N mm.
    pub values: Vec<Vec<Complex<f64>>>,
}

/// Finds the vibrations about a state of rest that are asked for; otherwise the reason why there are none.
///
/// # Errors
/// The model of motions does not exist.
pub(super) fn vibrating(
    system: &System,
    task: &AtRest,
    request: &VibrationRequest,
    still: &Equilibrium,
) -> Result<Result<Vibrating, String>, WorkflowError> {
    let (names, quantities) = outputs(system);
    let analysis = task.analysis_of_vibrations(system, quantities);
    let model = Model::for_analysis(system.clone(), analysis);
    let model = model.map_err(|error| WorkflowError::boundary("equilibrium", &error.into()))?;
    let none = |reason: &str| Ok(Err(reason.to_owned()));
    // Where nothing remembers, the state is one of motions too; otherwise it is found once more, with what they remember.
    let mut rest = still.clone();
    let mut about = Vibrations::about(&model, &rest);
    if about.is_none() {
        let scalars = model.scalars(&task.voltages);
        match stable_equilibrium(&model, &model.reference_coordinates(), &scalars) {
            Ok(found) => rest = found,
            Err(_) => {
                return none("vibrations are not told: the state of rest of motions was not found");
            }
        }
        let apart = |(a, b): (&f64, &f64)| (a - b).abs() > SAME * model.length().max(1.0);
        let places = model.action.map.of_bodies.min(still.z.len());
        if rest.z[..places].iter().zip(&still.z).any(apart) {
            return none(
                "vibrations are not told: motions have another state of rest than the one that was found",
            );
        }
        about = Vibrations::about(&model, &rest);
    }
    let Some(mut vibrations) = about else {
        return none("there are no vibrations about this state: its stiffness is singular");
    };
    let Some(modes) = vibrations.modes(request.count) else {
        return none(match stop::reason() {
            Some(_) => "the vibrations were not found before it was stopped",
            None => "the vibrations were not found: nothing that moves has inertia",
        });
    };
    let mut notes = Vec::new();
    let response = match &request.sweep {
        None => None,
        Some(sweep) => match respond(
            &model,
            &vibrations,
            sweep.source,
            peaked(sweep, &modes),
            names,
        ) {
            Ok(response) => Some(response),
            Err(reason) => {
                notes.push(reason);
                None
            }
        },
    };
    if !modes.are_exact {
        notes.push(
            "the vibrations are approximate: their equations hold to about four digits".to_owned(),
        );
    }
    notes.extend(aperiodic(&modes, request.count));
    let shapes = shapes(&vibrations, &modes.vibrations, &rest);
    drop(vibrations);
    Ok(Ok(Vibrating {
        modes,
        response,
        shapes,
        notes,
        model,
    }))
}

/// Names, units and quantities of all joints and markers.
fn outputs(system: &System) -> (Vec<(String, &'static str)>, Vec<Quantity>) {
    let joints = system.joints.iter().enumerate();
    let joints = joints.filter(|(_, joint)| joint.has_coordinate());
    let joints = joints.map(|(j, joint)| {
        let name = (joint.name.clone(), joint_unit(system, j));
        (name, Quantity::joint(j, 0.0))
    });
    let markers = system.markers.iter().enumerate();
    let markers = markers.flat_map(|(m, marker)| {
        ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .map(move |(axis, word)| {
                let name = (format!("{}_{word}", marker.name), "mm");
                (name, Quantity::marker_place(m, axis))
            })
    });
    joints.chain(markers).unzip()
}

/// The frequencies of a sweep, with those of damped vibrations among them, where the response has its peaks.
fn peaked(sweep: &FrequencySweep, modes: &Modes) -> Vec<f64> {
    let mut frequencies = sweep.frequencies();
    let [low, high] = sweep.range;
    let damped = modes
        .vibrations
        .iter()
        .filter(|one| one.damping.abs() > UNDAMPED);
    let damped = damped.map(Vibration::damped_frequency);
    frequencies.extend(damped.filter(|one| (low..high).contains(one)));
    frequencies.sort_by(f64::total_cmp);
    frequencies
}

/// The response to an input, of what can move; otherwise the reason why there is none.
fn respond(
    model: &Model,
    vibrations: &Vibrations<'_>,
    source: usize,
    frequencies: Vec<f64>,
    names: Vec<(String, &'static str)>,
) -> Result<FrequencyResponse, String> {
    let name = &model.system.sources()[source].name;
    let (outputs, quantities): (Vec<_>, Vec<usize>) = names
        .into_iter()
        .zip(0..)
        .filter(|(_, quantity)| model.measured[*quantity].is_some())
        .unzip();
    let values = vibrations.responses(source, &quantities, &frequencies);
    let values = values.ok_or_else(|| match stop::reason() {
        Some(_) => "the frequency response was not computed before it was stopped".to_owned(),
        None => format!("there is no frequency response: {name} acts on nothing that moves, or a frequency is that of an undamped vibration"),
    })?;
    if values.iter().flatten().all(|value| value.norm() == 0.0) {
        return Err(format!(
            "there is no linear response to {name}: it acts by its square, which has no slope at zero; give it a voltage at rest"
        ));
    }
    Ok(FrequencyResponse {
        source,
        frequencies,
        outputs,
        values,
    })
}

/// Notes on motions without vibration, and on vibrations that are not there.
fn aperiodic(modes: &Modes, count: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(rate) = modes.slowest_decay {
        let time = significant(1e-3 / rate.abs(), 4);
        notes.push(match rate > 0.0 {
            true => {
                format!("motions without vibration decay too, the slowest one in {time} s by 63 %")
            }
            false => format!(
                "a motion without vibration grows, in {time} s to 272 %: the state is unstable"
            ),
        });
    }
    let found = modes.vibrations.len();
    if found < count {
        notes.push(format!(
            "{found} of {count} vibrations were found: there are no others, or they are behind many motions that decay"
        ));
    }
    let growing = modes.vibrations.iter().filter(|one| one.damping < 0.0);
    let growing: Vec<String> = growing
        .map(|one| significant(1e3 * one.frequency, 4))
        .collect();
    if !growing.is_empty() {
        notes.push(format!(
            "vibrations grow: the state flutters at {} Hz",
            growing.join(", ")
        ));
    }
    notes
}

/// Shapes as a motion of slow periods.
fn shapes(
    vibrations: &Vibrations<'_>,
    list: &[Vibration],
    rest: &Equilibrium,
) -> DiscreteTrajectory {
    let frames = list.iter().flat_map(|one| {
        (0..INSTANTS * PERIODS).map(move |k| {
            let phase = TAU * k as f64 / INSTANTS as f64;
            vibrations.deflected(one, phase, SIZE)
        })
    });
    let mut z: Vec<Vec<f64>> = frames.collect();
    z.push(rest.z.clone());
    let scalars = vec![rest.scalars.clone(); z.len().max(2) - 1];
    DiscreteTrajectory::in_steps(SHOWN, z, scalars)
}
