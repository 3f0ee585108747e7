//! Conversion of the simulation entry of a problem file to its task.

use crate::control::problem::Simulation;
use crate::dynamics::{Integrator, MultigridUse, Newton, Solving};
use crate::feedback::Law;
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::{At, CoordinatesSpec};
use crate::files::problem::feedback::{ControllerSpec, controller};
use crate::files::problem::inputs::{LoadMap, VoltagesSpec, driven};
use crate::files::problem::state::StartSpec;
use crate::files::units::quantity::{Quantity, Time};
use crate::math::shortest;
use crate::sparse::Backend;

/// Tolerances below this ask for more than rounding allows.
pub(crate) const LEAST_TOLERANCE: f64 = 1e-9;

/// Most steps of a simulation.
pub(crate) const MOST_STEPS: f64 = 1e8;

pub(crate) fn simulation(spec: &SimulateSpec, at: &At<'_>) -> Result<Simulation> {
    let duration = at.key("duration").positive(&spec.duration)?;
    let method = integrator(spec.integrator.as_ref(), &at.key("integrator"))?;
    let (step, tolerance) = step(spec, duration, method, at)?;
    let (start, voltages) = driven(spec.start.as_ref(), &spec.voltages, &spec.loads, at)?;
    let named = spec.linear_solver.unwrap_or(LinearSolverSpec::Auto);
    let (backend, multigrid) = named.taken();
    Ok(Simulation {
        duration,
        step,
        tolerance,
        start,
        voltages,
        coordinates: spec.coordinates.map(Into::into),
        solving: Solving {
            integrator: method,
            newton: spec
                .newton
                .map_or_else(|| Newton::for_system(at.system), Into::into),
            backend,
            multigrid,
        },
        controller: at.optional("controller", &spec.controller, |place, written| {
            // The steps that are taken, which divide the duration.
            let equal = duration / (duration / step - 1e-9).ceil().max(1.0);
            let equal = tolerance.is_none().then_some(equal);
            let controller = controller(written, equal, place)?;
            refuse!(if controller.delay > duration, place.key("delay");
                found format!("{} s", shortest(controller.delay / 1e3, 9)),
                expected format!("no more than the duration {}", spec.duration));
            refuse_given(spec, &controller.law, at)?;
            Ok(Box::new(controller))
        })?,
    })
}

/// Refuses voltages and loads that are written for inputs which the controller gives.
pub(crate) fn refuse_given(spec: &SimulateSpec, law: &Law, at: &Scope<'_>) -> Result<()> {
    let of_voltages: Vec<&String> = match &spec.voltages {
        VoltagesSpec::Signals(map) => map.keys().collect(),
        VoltagesSpec::Table(table) => table.voltages.keys().collect(),
        VoltagesSpec::Solution(_) => Vec::new(),
    };
    let loads = spec.loads.keys().map(|name| ("loads", name));
    let mut written = of_voltages
        .into_iter()
        .map(|name| ("voltages", name))
        .chain(loads);
    let given = written.find(|(_, name)| law.inputs.iter().any(|input| input.name == **name));
    refuse!(if let Some((key, name)) = given, at.key(key).key(name);
        found format!("{name:?}, an input that the controller gives"),
        expected "other inputs alone beside \"controller\"");
    Ok(())
}

/// Length of the steps in ms, of the first attempt where a tolerance controls it, and the tolerance.
pub(crate) fn step(
    spec: &SimulateSpec,
    duration: f64,
    method: Integrator,
    at: &Scope<'_>,
) -> Result<(f64, Option<f64>)> {
    let Some(StepSpec::Given(written)) = &spec.step else {
        refuse!(if method != Integrator::Midpoint, at;
            found format!("steps of no given length with the integrator {}", method.name()),
            expected "a step, such as \"10 ms\": only the midpoint rule chooses its steps");
        let tolerance = spec.tolerance.unwrap_or(Simulation::TOLERANCE);
        refuse!(if !(LEAST_TOLERANCE..1.0).contains(&tolerance), at.key("tolerance");
            found tolerance, expected format!("a tolerance from {LEAST_TOLERANCE:.0e} to below 1"));
        return Ok((Simulation::FIRST * duration, Some(tolerance)));
    };
    let place = at.key("step");
    let step = place.positive(written)?;
    refuse!(if let Some(tolerance) = spec.tolerance, at.key("tolerance");
        found format!("{tolerance} beside steps of {written}"),
        expected "a tolerance only where the step is \"auto\" or not written");
    refuse!(if step > duration, place;
        found written,
        expected format!("a step that is no longer than the duration {}", spec.duration));
    refuse!(if duration / step > MOST_STEPS, place;
        found format!("{written}, which makes {:.0e} steps", duration / step),
        expected format!("no more than {MOST_STEPS:.0e} steps"));
    Ok((step, None))
}

read_objects! {
    /// A forward simulation.
    pub struct SimulateSpec {
        /// Length, SI unit s.
        pub duration: Quantity<Time>,
        /// Step, SI unit s, or `"auto"`, as where it is not written: steps as short as the tolerance needs, by the midpoint rule.
        pub step: Option<StepSpec>,
        /// Sum of the estimated local errors that `"auto"` allows over the duration, of angles in rad, of lengths relative to the
        /// robot's size; 1e-3 where not written.
        pub tolerance: Option<f64>,
        /// Constant voltages, those of a solution, or a table; 0 where not written.
        pub voltages?: VoltagesSpec,
        /// Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        pub loads?: LoadMap,
        /// A controller that gives the voltages which it has gains for.
        pub controller: Option<ControllerSpec>,
        /// Start of the motion; the reference configuration at rest where not written.
        pub start: Option<StartSpec>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
        /// The method; the midpoint variational integrator where not written.
        pub integrator: Option<IntegratorSpec>,
        /// Occasions at which the tangent of a step is factorised; where not written `modified` with finite elements, otherwise `full`.
        pub newton: Option<NewtonSpec>,
        /// Method by which its linear systems are solved; `auto` where not written.
        pub linear_solver: Option<LinearSolverSpec>,
    }

    /// Length of the steps.
    pub auto StepSpec("a time, such as \"10 ms\", or \"auto\"") {
        /// Steps of no given length.
        StepWord {
            /// By an estimate of their local error.
            Auto
        },
        /// A length of time.
        Given: Quantity<Time>, false
    }

    /// Occasions at which the tangent of a step is factorised.
    pub enum NewtonSpec: Newton {
        /// In every iteration.
        Full,
        /// Modified Newton, only where the last factorisation converges too slowly: for large meshes, whose factorisation is the cost.
        Modified,
        /// The former name of `modified`.
        Reused = Modified,
    }

    /// Method by which linear systems with the tangent are solved.
    pub enum LinearSolverSpec {
        /// The one that is fastest as a rule.
        Auto,
        /// LDLᵀ or LU of faer.
        Faer,
        /// LDLᵀ or LU of MUMPS.
        Mumps,
        /// GMRES with multigrid, for blocks beside which nothing moves.
        Multigrid,
    }

    /// A method by its name.
    pub enum IntegratorWord {
        /// The midpoint variational integrator, order 2.
        Midpoint,
        /// Implicit Euler, order 1; damps.
        ImplicitEuler,
        /// Generalised α with the spectral radius 0.8, order 2; damps fast oscillations.
        GeneralisedAlpha,
    }

    /// A method with its parameter: exactly one of the two.
    pub struct IntegratorObject {
        /// Degree, from 1 to 8, of a Galerkin variational integrator with Lobatto points, order 2 × degree.
        pub galerkin: Option<usize>,
        /// Spectral radius at infinity, from 0 to 1, of the generalised-α method.
        pub generalised_alpha: Option<f64>,
    }

    /// A word or an object.
    pub either IntegratorSpec(
        "\"midpoint\", \"implicit_euler\", \"generalised_alpha\" or an object with \"galerkin\" or \"generalised_alpha\""
    ) {
        /// By name.
        Word: IntegratorWord,
        /// With its parameter.
        Object: IntegratorObject,
    }
}

impl LinearSolverSpec {
    /// The factorisation that is named, and the use of multigrid.
    pub(crate) fn taken(self) -> (Option<Backend>, MultigridUse) {
        match self {
            Self::Auto => (None, MultigridUse::WhereFaster),
            Self::Faer => (Some(Backend::Faer), MultigridUse::WhereFaster),
            Self::Mumps => (Some(Backend::Mumps), MultigridUse::WhereFaster),
            Self::Multigrid => (None, MultigridUse::Always),
        }
    }
}

/// Degree beyond which rounding takes what the order gives.
const HIGHEST: usize = 8;
/// Spectral radius of the word alone.
const RADIUS: f64 = 0.8;

/// The method of a simulation.
pub(crate) fn integrator(spec: Option<&IntegratorSpec>, at: &At<'_>) -> Result<Integrator> {
    let method = match spec {
        None => Integrator::Midpoint,
        Some(IntegratorSpec::Word(word)) => match word {
            IntegratorWord::Midpoint => Integrator::Midpoint,
            IntegratorWord::ImplicitEuler => Integrator::ImplicitEuler,
            IntegratorWord::GeneralisedAlpha => Integrator::GeneralisedAlpha {
                spectral_radius: RADIUS,
            },
        },
        Some(IntegratorSpec::Object(object)) => with_parameter(object, at)?,
    };
    let mut muscles = at.system.muscles.iter();
    let changes = muscles.find(|muscle| muscle.section_inertia);
    refuse!(if let (Integrator::GeneralisedAlpha { .. }, Some(muscle)) = (method, changes), at;
        found format!("\"generalised_alpha\", though \"section_inertia\" of {} is not constant", muscle.name),
        expected "another method");
    Ok(method)
}

fn with_parameter(object: &IntegratorObject, at: &Scope<'_>) -> Result<Integrator> {
    Ok(the_one!(at, object;
        "galerkin" galerkin |at, degree| {
            refuse!(if !(1..=HIGHEST).contains(degree), at;
                found degree, expected format!("a degree from 1 to {HIGHEST}"));
            Integrator::Galerkin { degree: *degree }
        };
        "generalised_alpha" generalised_alpha |at, radius| {
            refuse!(if !(0.0..=1.0).contains(radius), at;
                found radius, expected "a spectral radius from 0 to 1");
            Integrator::GeneralisedAlpha { spectral_radius: *radius }
        };
    ))
}
