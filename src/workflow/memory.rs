//! Lower bounds of the memory that a run needs, checked before it begins.

use crate::dynamics::Solving;
use crate::math::join::{available, readable};
use crate::model::system::{Fidelity, Material};
use crate::model::{Model, System, Time, has_nodes_alone};
use crate::workflow::error::WorkflowError;

/// Bytes of an element with its share of nodes, couplings, tangent and factors: dielectric blocks of 2048 to 16 384 elements took
/// 133 000 at rest, 155 000 to 193 000 with the first step of a motion.
const OF_ELEMENT: f64 = 1.2e5;
/// The same where an iteration solves for all unknowns: blocks of 55 000 to 256 000 elements took 11 400 to 12 100 (benches/README.md).
const OF_ITERATION: f64 = 1e4;
/// Bytes of a Maxwell branch of an element in a motion, with the derivatives and factors of what it remembers: blocks of 512 and 1024
/// elements took 410 000 to 500 000 more with each branch.
const OF_BRANCH: f64 = 4e5;
/// Unknowns of a branch of an element: five at each of eight Gauss points.
const REMEMBERED: usize = 40;
/// Bytes of a second derivative of an interval in a program and in the solver: 300 were measured for the trunk without fill-in, 220
/// for each entry of Jacobian and Hessian of a block of 64 elements with its factors.
const OF_DERIVATIVE: f64 = 200.0;
/// Bytes of an instant in tables and figures.
const OF_INSTANT: f64 = 1e3;
/// Bytes of a body at an instant: its pose, in the motion and in the drawings.
const OF_POSE: f64 = 192.0;

/// Occasion at which elements are solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Occasion {
    /// States of rest: Maxwell branches are no unknowns, and an iteration may solve.
    Rest,
    /// Steps for which an iteration may solve.
    Steps,
    /// Steps or programs that are solved by factors.
    Factors,
}

impl Occasion {
    /// That of a simulation.
    pub(crate) fn of_steps(solving: Solving) -> Self {
        match solving.may_iterate() {
            true => Self::Steps,
            false => Self::Factors,
        }
    }
}

/// Refuses a scene whose elements need more than there is.
///
/// # Errors
/// They do.
pub(crate) fn of_elements(system: &System, occasion: Occasion) -> Result<(), WorkflowError> {
    let elements = system.elements();
    let branches = match occasion {
        Occasion::Rest => 0,
        Occasion::Steps | Occasion::Factors => branches(system),
    };
    let unknowns = unknowns(system) + REMEMBERED * branches;
    let with = match branches {
        0 => String::new(),
        branches => format!("{branches} Maxwell branches and "),
    };
    let what = format!("{elements} elements with {with}about {unknowns} unknowns");
    let may_iterate = occasion != Occasion::Factors && branches == 0;
    let of_element = match may_iterate && has_nodes_alone(system) {
        true => OF_ITERATION,
        false => OF_ELEMENT,
    };
    let bytes = elements as f64 * of_element + branches as f64 * OF_BRANCH;
    enough("scene", &what, bytes)
}

/// Maxwell branches of all finite elements.
fn branches(system: &System) -> usize {
    let count = |material: &Material| material.maxwell.list().len();
    let of_muscles = system.muscles.iter();
    let of_muscles = of_muscles.map(|m| m.fidelity.elements() * count(&m.material));
    let of_blocks = system.solids.iter().flat_map(|solid| {
        let regions = solid.mesh.regions.iter();
        regions.map(|&region| count(&solid.materials[region]))
    });
    of_muscles.chain(of_blocks).sum()
}

/// Places and potentials of the nodes of finite elements, those that are fixed or given included.
fn unknowns(system: &System) -> usize {
    let of_muscles = system.muscles.iter().map(|muscle| match muscle.fidelity {
        Fidelity::Lumped => 0,
        Fidelity::FiniteElements(grid) => {
            4 * grid.elements.map(|n| n + 1).iter().product::<usize>()
        }
    });
    let of_blocks = system.solids.iter().map(|solid| {
        let of_node = if solid.electrodes.is_empty() { 3 } else { 4 };
        of_node * solid.mesh.nodes.len()
    });
    of_muscles.chain(of_blocks).sum()
}

/// Refuses a motion of too many steps.
///
/// # Errors
/// Its instants need more than there is.
pub(crate) fn of_motion(model: &Model, steps: usize) -> Result<(), WorkflowError> {
    let map = &model.action.map;
    let scalars = model.variables.of(Time::Interval).len();
    let numbers = 3 * map.unknowns() + 2 * map.coordinates + 2 * scalars;
    let instant = 8.0 * numbers as f64 + OF_POSE * model.system.bodies.len() as f64 + OF_INSTANT;
    let what = format!("a motion of {steps} steps");
    enough("simulate.step", &what, steps as f64 * instant)
}

/// Refuses a program of too many intervals.
///
/// # Errors
/// Its derivatives need more than there is.
pub(crate) fn of_program(model: &Model, intervals: usize) -> Result<(), WorkflowError> {
    let derivatives = model.action.layout().values(1) as f64;
    let times = [Time::Instant, Time::Interval].into_iter();
    let unknowns: usize = times.map(|time| model.variables.of(time).len()).sum();
    let what = format!(
        "a program of {intervals} intervals with {unknowns} unknowns and {derivatives} second derivatives each"
    );
    let bytes = intervals as f64 * derivatives * OF_DERIVATIVE;
    enough("control.intervals", &what, bytes)
}

fn enough(place: &str, what: &str, bytes: f64) -> Result<(), WorkflowError> {
    match available() {
        Some(available) if bytes > available => {
            let [needed, free] = [bytes, available].map(readable);
            let reason = format!("{what} needs {needed} of memory or more, and {free} are free");
            Err(WorkflowError::problem(place, reason))
        }
        _ => Ok(()),
    }
}
