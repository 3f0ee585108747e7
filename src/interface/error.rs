//! Errors of the interface for Rust.

use crate::dynamics::{EquilibriumError, StepError};
use crate::identify::IdentifyError;
use crate::interface::handle::Input;
use crate::interface::motion::Motion;
use crate::math::{Signal, refuse};
use crate::model::{System, SystemError};
use crate::workflow::WorkflowError;
use thiserror::Error;

/// Reason why there is no result.
#[derive(Debug, Error)]
pub enum Error {
    /// The system makes no sense.
    #[error(transparent)]
    System(#[from] SystemError),
    /// A value of the problem makes no sense.
    #[error("{what}: {found}, expected {expected}")]
    Problem {
        /// Entry of the problem.
        what: &'static str,
        /// Value that was found.
        found: String,
        /// Value that was expected.
        expected: &'static str,
    },
    /// The problem asks for something that does not exist, or the run was interrupted before there was a result.
    #[error(transparent)]
    Workflow(#[from] WorkflowError),
    /// Recordings determine no constants, or cannot be simulated.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// There is no equilibrium.
    #[error(transparent)]
    NoEquilibrium(EquilibriumError),
    /// Growing loads lose the stable equilibrium, and no other one was found; the last one before is kept.
    #[error("no equilibrium was found: stability is lost at {:.6} % of the loads", 100.0 * fraction)]
    StabilityLost {
        /// Fraction of the voltages and loads.
        fraction: f64,
        /// The last equilibrium, a motion of one instant.
        motion: Box<Motion>,
    },
    /// No stable equilibrium was found; an unstable one is kept.
    #[error("no stable equilibrium was found: a disturbance of the one that was found grows")]
    Unstable {
        /// The unstable equilibrium, a motion of one instant.
        motion: Box<Motion>,
    },
    /// A step of a simulation failed; the motion so far is kept.
    #[error("{source}")]
    Step {
        /// Reason.
        source: StepError,
        /// The motion up to there.
        motion: Box<Motion>,
    },
    /// A simulation was interrupted; the motion so far is kept.
    #[error("interrupted at {} ms", .motion.times().last().unwrap_or(&0.0))]
    Interrupted {
        /// The motion up to there.
        motion: Box<Motion>,
    },
}

/// A result, or why there is none.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An entry of a problem.
pub(super) struct Entry(pub(super) &'static str);

impl Entry {
    /// The error of what is found there.
    pub(super) fn wrong(self, found: String, expected: &'static str) -> Error {
        Error::Problem {
            what: self.0,
            found,
            expected,
        }
    }
}

/// A function of time for each source of a system, zero where nothing is said.
pub(super) fn signals(
    inputs: &[(Input, Signal)],
    what: &'static str,
    system: &System,
) -> Result<Vec<Signal>> {
    let mut signals = vec![Signal::Constant(0.0); system.sources().len()];
    for (input, signal) in inputs {
        refuse!(unless signal.is_sound(), Entry(what);
            found format!("{signal:?} of {input:?}"),
            expected "finite numbers, and times that grow");
        signals[source(input, system)?] = signal.clone();
    }
    Ok(signals)
}

/// A value for each source of a system, zero where nothing is said.
pub(super) fn row(
    inputs: &[(Input, f64)],
    what: &'static str,
    system: &System,
) -> Result<Vec<f64>> {
    let mut row = vec![0.0; system.sources().len()];
    for (input, value) in inputs {
        refuse!(unless value.is_finite(), Entry(what);
            found format!("{value} of {input:?}"), expected "a finite number");
        row[source(input, system)?] = *value;
    }
    Ok(row)
}

/// The source of an input of a system.
pub(super) fn source(input: &Input, system: &System) -> Result<usize> {
    let expected = "a muscle or a driven electrode of the system";
    let missing = || Entry("voltage").wrong(format!("{input:?}"), expected);
    input.source(system).ok_or_else(missing)
}
