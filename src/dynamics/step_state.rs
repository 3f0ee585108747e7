//! The state of a stepper at the end of a step: from it the next steps have the bits that they would have had without a stop.
//!
//! Besides the state of the equations that is the tangent which was factorised last, where later steps go on with it: its factors are made
//! again from the same matrix by the same method.

use crate::dynamics::solving::Solving;
use crate::model::Model;
use crate::sparse::MethodState;
use crate::sparse::multigrid::MultigridReport;
use std::fmt;
use std::fmt::Write;

/// All that the next steps follow from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepState {
    /// Identity of the equations and method: the digits of [`StepState::equations_hash`].
    pub of: String,
    /// State of the equations, list by list; none before the first step.
    pub lists: Vec<(String, Vec<f64>)>,
    /// The tangent that is kept, where one is.
    pub tangent: Option<TangentState>,
    /// Report of the steps.
    pub report: StepperReport,
    /// Length in ms that the next step may have, where a tolerance controls it.
    pub wanted: Option<f64>,
    /// The tolerance that controls the steps: tighter than the one asked for where that left too great an error.
    pub tolerance: Option<f64>,
}

/// A tangent that is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TangentState {
    /// Step in ms that it belongs to; none where there are no factors.
    pub step: Option<f64>,
    /// True if the symmetric part of the matrix is factorised.
    pub is_approximate: bool,
    /// Method of its factorisation.
    pub method: MethodState,
    /// Entries of the matrix.
    pub matrix: Vec<f64>,
}

impl StepState {
    /// Returns the hash of the equations of a method for a model.
    pub fn equations_hash(model: &Model, solving: Solving) -> String {
        let mut digits = Digits(0xcbf2_9ce4_8422_2325);
        let (coordinates, system) = (model.coordinates, &model.presolved.system);
        write!(digits, "{solving:?} {coordinates:?} {system:?}").expect("digits take everything");
        format!("{:016x}", digits.0)
    }

    /// The same at time zero, with nothing counted so far.
    pub fn begun_anew(mut self) -> Self {
        let is_time = |name: &str| name == "time" || name.ends_with(" time");
        let now = self.lists.iter().find(|(name, _)| name == "time");
        let now = now
            .and_then(|(_, time)| time.first().copied())
            .unwrap_or(0.0);
        for (_, times) in self.lists.iter_mut().filter(|(name, _)| is_time(name)) {
            times.iter_mut().for_each(|time| *time -= now);
        }
        self.report = StepperReport::default();
        self.tolerance = None;
        self
    }
}

/// The hash FNV-1a of a formatted text.
struct Digits(u64);

impl Write for Digits {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(())
    }
}

/// Counts and times of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepperReport {
    /// Steps taken, halved ones included.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Steps that had to be halved.
    pub halved: usize,
    /// Factorisations of the tangent.
    pub factorisations: usize,
    /// Seconds in the rows and the tangent.
    pub assembly: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Seconds in solutions with them.
    pub solution: f64,
    /// Systems for which a direct solver took over from an iteration.
    pub fallbacks: usize,
    /// Counts of the iterations with multigrid.
    pub multigrid: MultigridReport,
    /// Energy in mJ that the steps made, or lost where negative, where the method has a balance of energy.
    pub made: f64,
    /// Greatest energy in mJ that one step exchanged.
    pub exchanged: f64,
}
