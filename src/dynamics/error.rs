//! Errors of steps and of equilibria.

use crate::dynamics::equilibrium::{Equilibrium, Instability, Load, StabilityLoss};
use crate::dynamics::singular_configurations::NOTHING;
use crate::nlp::Status;
use crate::stop::Stopped;
use thiserror::Error;

/// A step forward in time failed and was not accepted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StepError {
    /// Newton's method did not converge, although the step was halved.
    #[error(
        "no convergence of the step from t = {time} ms, even with a step of {step} ms; last residuals relative to the first: {}{}",
        short(residuals), hint(residuals, limit.as_deref(), muscle.as_ref(), overflow.as_ref())
    )]
    NoConvergence {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// Residual norms of the last attempt, relative to the first.
        residuals: Vec<f64>,
        /// Shortest lumped muscle at the start of the step and its stretch, if it is rather short.
        muscle: Option<(String, f64)>,
        /// Words on a lumped muscle or block near the limit of its law at the start of the step, or beyond it at the end that was tried.
        limit: Option<String>,
        /// Forces beyond the range of numbers, and the greatest voltage, where an inverted element is not what they are laid to.
        overflow: Option<f64>,
    },
    /// The span of a lumped muscle turned by a right angle or more, although the step was halved.
    #[error(
        "the step from t = {time} ms turns muscle \"{muscle}\" by more than a right angle, even with a step of {step} ms: its ends meet, or the motion is too fast for the step"
    )]
    Reversed {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// The muscle.
        muscle: String,
    },
    /// A lumped muscle or block is stretched beyond the limit of its law at the end of the step, although it was halved.
    #[error("the step from t = {time} ms ends where {part}, even with a step of {step} ms")]
    BeyondLaw {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// Words on the muscle or block.
        part: String,
    },
    /// An element of a block is inverted at the end of the step, although it was halved.
    #[error(
        "the step from t = {time} ms inverts an element (J ≤ 0), even with a step of {step} ms: it is crushed, as in pull-in, or the motion is too fast for the step"
    )]
    Inverted {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
    },
    /// The motion that was to go on is one of another model or method.
    #[error("the motion that ends at t = {time} ms was made by other equations or another method")]
    Foreign {
        /// Time of its end in ms.
        time: f64,
    },
    /// Ctrl-C was pressed, or the time allowed is over.
    #[error("the step from t = {time} ms was stopped ({})", status.word().replace('_', " "))]
    Stopped {
        /// Start of the step in ms.
        time: f64,
        /// Step in ms.
        step: f64,
        /// [`Status::Interrupted`] or [`Status::TimeLimit`].
        status: Status,
    },
    /// A joint turned by more than half a turn or a body by more than a right angle, although the step was halved.
    #[error(
        "the step from t = {time} ms turns {what} by {angle:.4} rad, even with a step of {step} ms: the rotation in one step is not unique; the motion is too fast for the step: take shorter steps"
    )]
    Turned {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// The joint coordinate or the body.
        what: String,
        /// Angle in rad.
        angle: f64,
    },
    /// The energy balance of the step does not close, although it was halved.
    #[error(
        "the energy balance of the step from t = {time} ms does not close, even with a step of {step} ms: the energy changes by {made:+.4e} N mm without a source, while {exchanged:.4e} N mm are exchanged; the motion is too fast for the step, as in pull-in or at a bounce: take shorter ones"
    )]
    Unbalanced {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// Energy in N mm that the step makes, or loses where negative.
        made: f64,
        /// Energy in N mm that is exchanged in the step.
        exchanged: f64,
    },
    /// The local error is beyond what the tolerance allows, although the step was made shorter.
    #[error(
        "the step from t = {time} ms has an estimated local error of {error:.1e} where the tolerance allows {allowed:.1e}, even with a step of {step} ms: the motion is too fast for any step, as in pull-in"
    )]
    Inaccurate {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// Local error, of angles in rad or of lengths relative to the system's.
        error: f64,
        /// Local error that the tolerance allows.
        allowed: f64,
    },
    /// A closing constraint that was left out, as it follows from the others along the motion, does not hold.
    #[error(
        "the step to t = {time} ms opens a loop: {constraint} was left out, as it follows from the others near the reference, and is violated by {gap:.1e} (rad, or of the length of the system): the mechanism has passed to another branch or through a singular configuration; take shorter steps"
    )]
    OpenLoop {
        /// End of the step in ms.
        time: f64,
        /// The constraint.
        constraint: String,
        /// Its violation, in rad or relative to the length of the system.
        gap: f64,
    },
    /// The tangent is singular.
    #[error(
        "singular tangent at t = {time} ms with a step of {step} ms: {name} is not determined{}",
        redundancy(
            redundant,
            "constraints are redundant, or the configuration is singular"
        )
    )]
    Singular {
        /// Start of the step in ms.
        time: f64,
        /// Step in ms.
        step: f64,
        /// The unknown whose pivot vanished.
        name: String,
        /// Constraints that follow from the others.
        redundant: Vec<String>,
    },
}

/// No static equilibrium was found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EquilibriumError {
    /// The path of equilibria under growing loads ends, and no other equilibrium was found.
    #[error(
        "no equilibrium was found under these voltages: the path of equilibria under growing {} ends at {:.6} % of them ({}{})",
        grown(loss.load), 100.0 * loss.fraction, why(loss.kind), moved(last)
    )]
    LimitPoint {
        /// The load that grew, its largest fraction for which there was an equilibrium, and the instability, where that was found.
        loss: StabilityLoss,
        /// The state there.
        last: Box<Equilibrium>,
    },
    /// Ctrl-C was pressed, or the time allowed is over.
    #[error("stopped before an equilibrium was found ({0})")]
    Stopped(#[from] Stopped),
    /// There is no equilibrium to start from.
    #[error(
        "no equilibrium was found without voltages: neither Newton's method nor damped motion from the reference leads to one"
    )]
    NoStart,
    /// Joints that neither a muscle nor a block nor a weight holds.
    #[error(
        "no unique equilibrium: no stiffness acts on {}; a muscle, a spring, a block or a weight must act on what it moves",
        .0.join(", ")
    )]
    NoStiffness(Vec<String>),
    /// A closing constraint that was left out, as it follows from the others along the motion, does not hold.
    #[error(
        "no equilibrium of the mechanism: the one found opens a loop, as {constraint}, which was left out as it follows from the others near the reference, is violated by {gap:.1e} (rad, or of the length of the system)"
    )]
    OpenLoop {
        /// The constraint.
        constraint: String,
        /// Its violation, in rad or relative to the length of the system.
        gap: f64,
    },
    /// A part of a block can move freely.
    #[error("{name} is not held: {motion} is a zero-energy mode; fix or glue one of its faces")]
    Floating {
        /// The part.
        name: String,
        /// The motion that nothing resists.
        motion: String,
    },
    /// Nothing holds the system.
    #[error(
        "no unique equilibrium: {name} is not determined{}",
        redundancy(redundant, "nothing holds it, or constraints are redundant")
    )]
    Singular {
        /// The unknown whose pivot vanished.
        name: String,
        /// Constraints that follow from the others.
        redundant: Vec<String>,
    },
}

/// Names the redundant constraints, or else the likely cause.
fn redundancy(redundant: &[String], otherwise: &str) -> String {
    match redundant {
        [] => format!("; {otherwise}"),
        [one] => format!("; constraints are redundant: {one} follows from the others"),
        many => format!(
            "; constraints are redundant: {} follow from the others",
            many.join(", ")
        ),
    }
}

/// Numbers in two digits, those that do not exist in words.
fn short(residuals: &[f64]) -> String {
    let digits = |r: &f64| match r.is_finite() {
        true => format!("{r:.1e}"),
        false => "undefined".to_owned(),
    };
    let list: Vec<String> = residuals.iter().map(digits).collect();
    list.join(", ")
}

/// Explains a muscle near a limit, a short one, or residuals that are not finite.
fn hint(
    residuals: &[f64],
    limit: Option<&str>,
    muscle: Option<&(String, f64)>,
    overflow: Option<&f64>,
) -> String {
    if let Some(limit) = limit {
        return format!("; {limit}");
    }
    let is_finite = residuals.iter().all(|r| r.is_finite());
    if let (Some(voltage), false) = (overflow, is_finite) {
        return format!(
            "; the forces there are beyond the range of numbers: the greatest voltage is {voltage:.3e} V; check the units of voltages and of the scene"
        );
    }
    match muscle {
        Some((name, stretch)) if *stretch < NOTHING => {
            format!("; muscle \"{name}\" has no length there")
        }
        Some((name, stretch)) => format!(
            "; muscle \"{name}\" is compressed to {stretch:.3} of its length there, as in pull-in"
        ),
        None if is_finite => String::new(),
        None => {
            "; an element is inverted there (J ≤ 0): use shorter steps, starting earlier".to_owned()
        }
    }
}

fn grown(load: Load) -> &'static str {
    match load {
        Load::Forces => "loads",
        Load::Voltages => "voltages",
    }
}

/// Describes the motion by which an equilibrium is lost.
fn moved(last: &Equilibrium) -> String {
    match &last.softest {
        Some(mode) if !mode.moves.is_empty() => format!("; softest motion: {}", mode.moves),
        _ => String::new(),
    }
}

fn why(kind: Option<Instability>) -> &'static str {
    match kind {
        Some(Instability::PullIn) => "pull-in: a limit point",
        Some(Instability::Collapse) => "collapse under load: a limit point",
        Some(Instability::Buckling) => "buckling: another path branches off",
        None => "pull-in or a limit point",
    }
}
