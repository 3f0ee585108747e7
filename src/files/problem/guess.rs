//! Conversion of the guess of a problem file to the guess of a task.

use crate::control::Earlier;
use crate::control::problem::{BoundaryState, Guess, Voltages};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_control::GuessSpec;
use crate::files::problem::voltages::{SOLUTION_PATH, over_time};
use crate::files::solution::SolutionFile;
use crate::math::Random;
use crate::model::system::{Fidelity, Source, System};

pub(crate) fn guess(
    spec: &GuessSpec,
    system: &System,
    bounds: [f64; 2],
    scope: &Scope<'_>,
) -> Result<Guess, SceneError> {
    let GuessSpec::Object(spec) = spec else {
        return Ok(Guess::Interpolate);
    };
    type Build<'a> = Box<dyn FnOnce() -> Result<Guess, SceneError> + 'a>;
    let simulate = spec.simulate.as_ref().map(|simulate| -> Build<'_> {
        let scope = scope.key("simulate").key("voltages");
        Box::new(move || over_time(&simulate.voltages, system, &scope).map(Guess::Simulate))
    });
    let solution = spec.solution.as_ref().map(|solution| -> Build<'_> {
        let scope = scope.key("solution");
        Box::new(move || {
            let path = scope.solution_file(solution, SOLUTION_PATH)?;
            Ok(Guess::Solution(Earlier::new(SolutionFile(path))))
        })
    });
    let random = spec.random.as_ref().map(|random| -> Build<'_> {
        Box::new(|| {
            let voltages = drawn(random.seed, system, bounds);
            Ok(Guess::Simulate(Voltages::Constant(voltages)))
        })
    });
    let build = scope.exactly_one([
        ("simulate", simulate),
        ("solution", solution),
        ("random", random),
    ])?;
    build()
}

/// The guess where none is written: of elastic blocks the motion under the voltages that hold the goal, where they are named, as the goal lacks the
/// places of nodes to interpolate between.
pub(crate) fn unwritten(goal: &BoundaryState, system: &System) -> Guess {
    let of_muscles = system
        .muscles
        .iter()
        .any(|m| m.fidelity != Fidelity::Lumped);
    let has_elements = of_muscles || !system.solids.is_empty();
    match goal {
        BoundaryState::Markers {
            hold: Some(hold), ..
        } if has_elements => Guess::Simulate(Voltages::Constant(hold.clone())),
        _ => Guess::Interpolate,
    }
}

/// A voltage within the bounds for each source that takes one, drawn at random.
pub(crate) fn drawn(seed: u64, system: &System, [lower, upper]: [f64; 2]) -> Vec<f64> {
    let mut random = Random::new(seed);
    let draw = |source: &Source| match source.takes_voltage {
        true => random.between(lower, upper),
        false => 0.0,
    };
    system.sources().iter().map(draw).collect()
}
