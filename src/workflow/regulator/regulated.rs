//! A regulator that was found, or the reason why there is none.
//!
//! Costs of rates: of the differences of coordinates over an interval, which a receding horizon counts too.
//!
//! With x₊ = A x + B u a step costs `xᵀQx + uᵀRu + (x₊ − x)ᵀW(x₊ − x)`, which is `xᵀQ̂x + 2 xᵀN u + uᵀR̂u` with
//!
//! ```text
//! Q̂ = Q + (A − 1)ᵀW(A − 1),     N = (A − 1)ᵀWB,     R̂ = R + BᵀWB
//! ```
//!
//! Of the inputs `v = u + L x`, L = R̂⁻¹Nᵀ, the step has no such products: A′ = A − B L, Q′ = Q̂ − N L, K = K′ + L. Q′ is computed as
//! `Q + (A − 1)ᵀ (W⁻¹ + BR⁻¹Bᵀ)⁻¹ (A − 1)`, a sum of squares.

use crate::dynamics::NoState;
use crate::feedback::{
    Costs, HeldGain, Law, NotHeld, RiccatiStep, held_gain, riccati_step, symmetric,
};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use thiserror::Error;

/// Most entries of a state.
pub(super) const MOST: usize = 1500;
/// A relative difference from which on the closed loop is not reproduced.
const ALLOWED: f64 = 1e-2;

/// The deviation after a step from a state off the motion: by the equations of motion against that of the linear closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reproduced {
    /// The interval.
    pub interval: usize,
    /// Relative difference; NaN where a step fails.
    pub difference: f64,
}

impl Reproduced {
    /// Returns true if the linear closed loop is a good one of small deviations.
    pub fn is_small(&self) -> bool {
        self.difference <= ALLOWED
    }
}

/// A regulator that was found.
#[derive(Clone, Debug)]
pub struct Regulated {
    /// The law that a controller reads.
    pub law: Law,
    /// Linearised steps with the gains of their states.
    pub steps: Vec<RegulatedStep>,
    /// The step at the goal, and the proof that it is held.
    pub held: Option<(RegulatedStep, HeldGain)>,
    /// Cost of the state at the end of the motion.
    pub end_cost: DMatrix<f64>,
    /// State at rest at the goal by constant disturbances, and by the inputs against them; none without such forces.
    pub lasting: Option<DMatrix<f64>>,
    /// Reason why the goal is not held.
    pub not_held: Option<String>,
    /// Spectral radius of the errors of the observer, where there is one.
    pub observer_radius: Option<f64>,
    /// Greatest relative residual of the equations of the gains.
    pub residual: f64,
    /// Comparison with the equations of motion.
    pub reproduced: Vec<Reproduced>,
}

/// A linearised step with integrals, its costs, and its gain.
#[derive(Clone, Debug)]
pub struct RegulatedStep {
    /// A.
    pub by_state: DMatrix<f64>,
    /// B.
    pub by_inputs: DMatrix<f64>,
    /// Q and R, without rates.
    pub costs: Costs,
    /// W, over the state: weights of its differences over the step.
    pub rates: Vec<f64>,
    /// The part of Q that is of coordinates and markers, over the coordinates.
    pub places: DMatrix<f64>,
    /// K, over the state.
    pub gain: DMatrix<f64>,
    /// S, the cost of the state and of all that follows.
    pub cost: DMatrix<f64>,
    /// E, over constant disturbances on joints; no columns without them.
    pub by_forces: DMatrix<f64>,
    /// Of constant disturbances and the inputs against them: the gain over them, and P at the start of the step.
    pub lasting: Option<[DMatrix<f64>; 2]>,
}

/// Reason why there is no regulator.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoRegulator {
    /// The model has no state of this kind.
    #[error("{0}")]
    State(NoState),
    /// No input is sought.
    #[error("no voltage or load is sought that could be fed back")]
    NoInput,
    /// The state is too large.
    #[error("its state has {0} entries, more than {most}", most = MOST)]
    Large(usize),
    /// A step is singular.
    #[error("the linearised step of interval {0} is singular")]
    Singular(usize),
    /// A step of the motion fails.
    #[error("{0}")]
    Step(String),
    /// The recursion fails at a step.
    #[error("the Riccati recursion has no result in interval {0}")]
    Recursion(usize),
    /// The state does not follow from what is measured.
    #[error("no observer: {0}")]
    Observer(String),
    /// It was time to stop.
    #[error("the run was stopped before")]
    Stopped,
}

/// A residual of the Riccati equations from which on gains are doubtful.
const DOUBTFUL: f64 = 1e-8;

/// Numbers of a regulator for a summary.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RegulatorReport {
    /// Entries of the state: coordinates, momenta and integrals.
    pub state: usize,
    /// Inputs that are fed back.
    pub inputs: usize,
    /// Spectral radius of a step at the held goal, without feedback; absent where it is not held.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_radius: Option<f64>,
    /// The same with feedback.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Spectral radius of a step of the errors of the observer, at the held goal, or at the start where that is not held.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observer_radius: Option<f64>,
    /// Greatest relative residual of the Riccati equations.
    pub residual: f64,
    /// Greatest relative difference of a step of the linear closed loop from one of the equations of motion.
    pub difference: f64,
}

/// The goal is not held as no inputs were sought or given that do.
pub(crate) const NOTHING_HOLDS: &str = "no inputs that hold it are known";

/// Part of its range within which an input is at a bound.
const AT_BOUND: f64 = 1e-6;

impl Regulated {
    /// Numbers for a summary.
    pub fn report(&self) -> RegulatorReport {
        let held = self.held.as_ref().map(|(_, held)| held);
        let differences = self.reproduced.iter().map(|one| one.difference);
        RegulatorReport {
            state: self.steps[0].by_state.nrows(),
            inputs: self.steps[0].by_inputs.ncols(),
            open_radius: held.map(|held| held.open_radius),
            radius: held.map(|held| held.radius),
            observer_radius: self.observer_radius,
            residual: self.residual,
            // Not a number is worse than any.
            difference: differences.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a }),
        }
    }

    /// That the goal is held, and that the observer finds the state, with their proofs.
    pub fn notes(&self) -> Vec<String> {
        let h = self.law.h;
        let time = |radius: f64| -h / radius.ln() / 1e3;
        let held = self.held.as_ref().map(|(_, held)| {
            let open = match held.open_radius < 1.0 {
                true => format!("without it in {:.3} s", time(held.open_radius)),
                false => format!("without it the spectral radius is {:.4}", held.open_radius),
            };
            format!(
                "feedback holds the goal: the spectral radius of the closed loop is {:.4}, deviations fall to 1/e in {:.3} s or less, {open}",
                held.radius,
                time(held.radius)
            )
        });
        let observed = self.observer_radius.map(|radius| {
            format!(
                "the observer finds the state: the spectral radius of its errors is {radius:.4}, they fall to 1/e in {:.3} s or less",
                time(radius)
            )
        });
        held.into_iter().chain(observed).collect()
    }

    /// That a goal which is unstable without feedback is held by inputs of which some act to one side alone, which linear feedback does not know.
    fn one_sided(&self) -> Option<String> {
        let (_, held) = self.held.as_ref()?;
        let point = self.law.held.as_ref().filter(|_| held.open_radius >= 1.0)?;
        let all = self.law.inputs.iter().zip(&point.inputs);
        let at_bound = all.filter(|(input, value)| {
            let [low, high] = input.bounds;
            let margin = AT_BOUND * (high - low);
            **value <= low + margin || **value >= high - margin
        });
        let names: Vec<&str> = at_bound.map(|(input, _)| input.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "without feedback the goal is unstable (spectral radius {:.4}), and there {} at a bound, where inputs act to one side alone: \
                 that feedback holds it is not shown; simulate it with \"controller\"",
                held.open_radius,
                match &names[..] {
                    [one] => format!("{one} is"),
                    several => format!("{} are", several.join(", ")),
                }
            )
        })
    }

    /// Doubts about the gains.
    pub fn warnings(&self) -> Vec<String> {
        let mut out: Vec<String> = self.one_sided().into_iter().collect();
        if !self.law.holds_goal() {
            let reason = self.not_held.as_deref().unwrap_or(NOTHING_HOLDS);
            out.push(format!(
                "feedback does not hold the goal after the end: {reason}; the gains serve as long as the motion lasts"
            ));
        }
        if self.residual.is_nan() || self.residual > DOUBTFUL {
            out.push(format!(
                "the gains of feedback meet their Riccati equations up to {:.1e} only",
                self.residual
            ));
        }
        let worst = self.reproduced.iter().find(|one| !one.is_small());
        out.extend(worst.map(|one| {
            format!(
                "in interval {} a step of the motion from a state off it differs from that of the linear closed loop by {:.1} %: shorter intervals are needed for feedback",
                one.interval,
                100.0 * one.difference
            )
        }));
        out
    }
}

/// All costs of a step as factors of products.
#[derive(Clone, Debug)]
pub struct WholeCosts {
    /// Q̂ and R̂.
    pub costs: Costs,
    /// Nᵀ, by input over the state.
    pub cross: DMatrix<f64>,
}

/// A step without products of state and inputs.
struct Plain {
    /// A′.
    by_state: DMatrix<f64>,
    /// Q′ and R̂.
    costs: Costs,
    /// L.
    shift: DMatrix<f64>,
}

impl RegulatedStep {
    /// True if rates cost.
    pub(crate) fn has_rates(&self) -> bool {
        self.rates.iter().any(|weight| *weight > 0.0)
    }

    /// A − 1.
    fn change(&self) -> DMatrix<f64> {
        let n = self.by_state.nrows();
        &self.by_state - DMatrix::identity(n, n)
    }

    /// W times a matrix.
    pub(super) fn weighted(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(of.nrows(), of.ncols(), |i, j| self.rates[i] * of[(i, j)])
    }

    /// Its costs with those of rates.
    pub fn whole_costs(&self) -> WholeCosts {
        let change = self.change();
        let weighted = self.weighted(&self.by_inputs);
        WholeCosts {
            costs: Costs {
                state: &self.costs.state + change.transpose() * self.weighted(&change),
                inputs: &self.costs.inputs + self.by_inputs.transpose() * &weighted,
            },
            cross: weighted.transpose() * change,
        }
    }

    /// `None` where R̂ is not positive definite.
    fn plain(&self) -> Option<Plain> {
        let WholeCosts { costs, cross } = self.whole_costs();
        let shift = costs.inputs.clone().cholesky()?.solve(&cross);
        let costly: Vec<usize> = (0..self.rates.len())
            .filter(|&i| self.rates[i] > 0.0)
            .collect();
        let moved = self.by_inputs.select_rows(&costly);
        let resistance = self.costs.inputs.clone().cholesky()?;
        let weights = costly.iter().map(|&i| 1.0 / self.rates[i]);
        let weights = DVector::from_iterator(costly.len(), weights);
        let inner = &moved * resistance.solve(&moved.transpose());
        let inner = symmetric(inner + DMatrix::from_diagonal(&weights));
        let change = self.change().select_rows(&costly);
        let of_rates = change.transpose() * inner.cholesky()?.solve(&change);
        let state = &self.costs.state + symmetric(of_rates);
        Some(Plain {
            by_state: &self.by_state - &self.by_inputs * &shift,
            costs: Costs { state, ..costs },
            shift,
        })
    }

    /// The gain before a cost, and the cost with that of the step.
    pub(crate) fn riccati(&self, after: &DMatrix<f64>) -> Option<RiccatiStep> {
        if !self.has_rates() {
            return riccati_step([&self.by_state, &self.by_inputs], &self.costs, after);
        }
        let plain = self.plain()?;
        let found = riccati_step([&plain.by_state, &self.by_inputs], &plain.costs, after)?;
        Some(RiccatiStep {
            gain: found.gain + plain.shift,
            cost: found.cost,
        })
    }

    /// The gain of the step for ever.
    pub(super) fn for_ever(&self) -> Result<HeldGain, NotHeld> {
        if !self.has_rates() {
            return held_gain([&self.by_state, &self.by_inputs], &self.costs);
        }
        let plain = self.plain().ok_or(NotHeld::Unsolved)?;
        let found = held_gain([&plain.by_state, &self.by_inputs], &plain.costs)?;
        Ok(HeldGain {
            gain: found.gain + plain.shift,
            ..found
        })
    }
}
