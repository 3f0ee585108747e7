//! A state of rest that depends on free parameters, as a program of its own: its coordinates q are unknowns, which the motion that starts
//! or ends there shares.
//!
//! It has one interval whose ends are one instant, under given inputs u. Nothing moves in it, and the one balance of both ends says that
//! q is an equilibrium:
//!
//! ```text
//! D₂L_d(q, q; u) + D₁L_d(q, q; u) = −h ∂V/∂q(q, u) = 0.
//! ```
//!
//! Limits of quantities that read the inputs, as of fields, hold there too; those of coordinates alone are those of the motion at its end.
//!
//! The peak of the voltages as a cost, by its epigraph.
//!
//! One free parameter s bounds all voltages that are sought, and its square is a final cost:
//!
//! ```text
//! minimise … + w s²   subject to   V_k² ≤ s²  of all sources and intervals k,   V in kV.
//! ```

use crate::control::boundary::is_set_at;
use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::costs::{CostFunction, During, QuantityCost};
use crate::control::error::BoundaryError;
use crate::control::guess::InitialGuess;
use crate::control::inputs::Voltages;
use crate::control::limits::{BoundedQuantity, Limits};
use crate::control::problem::{BoundaryState, Control, Limit};
use crate::control::transcription::Transcription;
use crate::dynamics::{DiscreteTrajectory, Start};
use crate::ipopt::StartingPoint;
use crate::math::Signal;
use crate::model::{Constant, Model, Parameter, Quantity, Role, System, What};
use crate::nlp::{Multipliers, Nlp};

/// A state of rest whose coordinates are unknowns.
#[derive(Debug)]
pub struct RestProgram<'m> {
    /// Its equations.
    pub program: Transcription<'m>,
    /// The equilibrium at the guesses of the constants.
    pub point: StartingPoint,
    /// Variables of the motion and of this program that are one.
    pub shared: Vec<[usize; 2]>,
    /// The end of the motion: `start` or `goal`.
    pub end: &'static str,
}

/// The states of rest at start and goal of a motion that depend on free parameters; `motion` is the program of the motion.
///
/// # Errors
/// It is time to stop.
pub fn rest_programs<'m>(
    motion: &Transcription<'_>,
    model: &'m Model,
    boundary: &BoundaryConditions,
    control: &Control,
) -> Result<Vec<RestProgram<'m>>, BoundaryError> {
    let at_start = Some((0, "start", &boundary.start.z[..]));
    let rest = boundary.goal.rest.as_ref();
    let at_goal = rest.map(|rest| (motion.intervals(), "goal", &rest.z[..]));
    let mut out = Vec::new();
    for (at, (end, voltages)) in [at_start, at_goal]
        .into_iter()
        .zip(boundary.rest.iter().enumerate())
    {
        let (Some((k, name, z)), true, Some(voltages)) = (at, boundary.sought_rest[end], voltages)
        else {
            continue;
        };
        let h = control.duration.first() / control.intervals as f64;
        let limits = boundary.limits.list.iter().map(BoundedQuantity::of_rest);
        let list = limits.collect();
        let limits = Limits { list };
        let (program, point) = equations(model, limits, control, z, voltages, h)?;
        // At the goal, what muscles remember may still relax.
        let is_free =
            |i: usize| end == 1 && model.is_memory(i) && !is_set_at(model, control, voltages, i);
        let own = |i: usize| {
            Some([
                motion.unknowns().unknown(k, i)?,
                program.unknowns().unknown(0, i)?,
            ])
        };
        // The peak of the voltages is none of this program, but a parameter of its model.
        let is_peak = |p: &usize| control.parameters[*p].name == PEAK_VOLTAGE;
        let first = model.variables.range(Role::Parameter).start;
        let peak = (0..control.parameters.len()).filter(is_peak);
        let of_peak = |p: usize| {
            let column = |program: &Transcription<'_>| program.unknowns().scalar(0, first + p);
            Some([column(motion)?, column(&program)?])
        };
        let coordinates = model.variables.range(Role::Coordinate);
        let coordinates = coordinates.filter(|&i| !is_free(i)).filter_map(own);
        out.push(RestProgram {
            shared: coordinates.chain(peak.filter_map(of_peak)).collect(),
            program,
            point,
            end: name,
        });
    }
    Ok(out)
}

/// The equations of an equilibrium near coordinates under voltages and its limits, with steps of `h` ms, and the point of these coordinates.
fn equations<'m>(
    model: &'m Model,
    limits: Limits,
    control: &Control,
    z: &[f64],
    voltages: &[f64],
    h: f64,
) -> Result<(Transcription<'m>, StartingPoint), BoundaryError> {
    let inputs = Voltages::constant(voltages);
    let rest = Control {
        goal: BoundaryState::Periodic,
        parameters: control.parameters.clone(),
        coordinates: control.coordinates,
        ..Control::of_course(&control.start, &inputs, h, 1)
    };
    let start = Start::moving(model, z.to_vec(), vec![0.0; model.coordinate_count()]);
    let boundary = BoundaryConditions {
        limits,
        ..BoundaryConditions::without_goal(start, model.coordinate_count())
    };
    let scalars = model.variables.scalars(&model.scalars(voltages));
    let discrete = DiscreteTrajectory::in_steps(h, vec![z.to_vec(); 2], vec![scalars]);
    let initial = InitialGuess::of_motion(discrete, h);
    let program = Transcription::of_any(model, &boundary, &rest, &initial)?;
    let point = program.start(&initial);
    let [rows, columns] = [program.constraints(), program.variables()].map(|one| one.lower.len());
    let point = StartingPoint {
        // Nothing is known of them.
        costates: Some(Multipliers {
            constraints: vec![0.0; rows],
            lower: vec![0.0; columns],
            upper: vec![0.0; columns],
        }),
        ..point
    };
    Ok((program, point))
}

/// Name of the parameter that is the peak.
pub const PEAK_VOLTAGE: &str = "peak voltage";

impl Control {
    /// Adds the square of the largest voltage in kV that is sought, with a positive weight, to the objective. Returns false if no
    /// voltage is sought.
    pub fn minimise_peak_voltage(&mut self, weight: f64, system: &System) -> bool {
        let sources = system.sources().into_iter().enumerate();
        let sought = sources.filter(|(s, source)| source.takes_voltage && !self.is_given(*s));
        let sought: Vec<usize> = sought.map(|(source, _)| source).collect();
        if sought.is_empty() {
            return false;
        }
        let (parameter, unit) = (self.parameters.len(), self.voltage_size(system));
        let [low, high] = self.voltage_bounds.map(f64::abs);
        let upper = low.max(high);
        self.parameters.push(Parameter {
            name: PEAK_VOLTAGE.to_owned(),
            constants: vec![Constant::PeakVoltage.into()],
            lower: 0.0,
            upper,
            guess: if upper.is_finite() { upper } else { unit },
        });
        let limit = |source| {
            let what = What::PeakExcess {
                source,
                parameter,
                unit,
            };
            Limit::below(what, 0.0)
        };
        self.limits.extend(sought.into_iter().map(limit));
        self.objective.quantities.push(QuantityCost {
            quantity: Quantity::of(What::PeakVoltage(parameter)),
            weight,
            function: CostFunction::Square {
                reference: Signal::Constant(0.0),
            },
            during: During::End,
        });
        true
    }
}
