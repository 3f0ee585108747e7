//! The gains of a linear-quadratic regulator along an optimal motion, and after its end.
//!
//! The state of the recursion is that of the discrete equations, coordinates and momenta, with the integrals that are asked for.

mod design;
mod law;
mod observer;
mod regulated;

use crate::control::problem::Regulator;
use crate::dynamics::Linearisation;
use crate::feedback::{Costs, HeldGain, NotHeld, spectral_radius};
use crate::stop;
use crate::workflow::regulator::design::Design;
use crate::workflow::regulator::law::Against;
use crate::workflow::regulator::observer::reproduced;
pub use design::Along;
pub(crate) use law::remembered;
use nalgebra::DMatrix;
pub(crate) use regulated::NOTHING_HOLDS;
pub use regulated::{
    NoRegulator, Regulated, RegulatedStep, RegulatorReport, Reproduced, WholeCosts,
};

/// The regulator of a motion.
///
/// # Errors
/// There is none.
pub fn regulator(along: Along<'_>, task: &Regulator) -> Result<Regulated, NoRegulator> {
    Design::new(along, task)?.regulated()
}

/// The same without its delay, for what predicts the state over the delay by itself: the observer of the law does, or one that takes in the whole
/// state where that is measured.
///
/// # Errors
/// There is none.
pub(crate) fn predicting(along: Along<'_>, task: &Regulator) -> Result<Regulated, NoRegulator> {
    let now = Regulator {
        delay: 0.0,
        ..task.clone()
    };
    let of = Design::new(along, &now)?;
    let mut out = of.regulated()?;
    if task.delay > 0.0 && out.law.observer.is_none() {
        out.law.observer = Some(of.whole(&out, &of.motion()?));
    }
    Ok(out)
}

impl Design<'_> {
    fn regulated(&self) -> Result<Regulated, NoRegulator> {
        let mut linearisation = Linearisation::new(self.model, &self.independent, &self.inputs);
        let motion = self.motion()?;
        let mut steps = Vec::new();
        for (k, part) in motion.windows(2).enumerate() {
            let inputs = self.model.variables.split(&self.discrete.scalars[k])[0];
            let step = self.linearised(&mut linearisation, &part[0], inputs);
            // What is stopped has no result either.
            stop::check().map_err(|_| NoRegulator::Stopped)?;
            let step = step.ok_or(NoRegulator::Singular(k))?;
            steps.push(self.augmented(&step, &part[0]));
        }
        let end = motion.last().expect("an instant");
        let (mut held, mut not_held) = (None, None);
        if let Some(rest) = self.rest {
            match self.held(&mut linearisation, rest) {
                Ok(found) => held = Some(found),
                Err(_) if stop::reason().is_some() => return Err(NoRegulator::Stopped),
                Err(reason) => not_held = Some(reason),
            }
        }
        let goal = held.as_mut().map(|(step, _)| step);
        let mut against = Against::new(goal, !self.forced.is_empty())?;
        let mut cost = match &held {
            Some((_, held)) => &held.cost * self.task.terminal,
            None => self.state_costs(end) * self.task.terminal,
        };
        let end_cost = cost.clone();
        let mut residual = held.as_ref().map_or(0.0, |(_, held)| held.residual);
        for (k, step) in steps.iter_mut().enumerate().rev() {
            let found = step.riccati(&cost).ok_or(NoRegulator::Recursion(k))?;
            residual = residual.max(left(step, &cost, &found.gain));
            step.gain = found.gain;
            if let Some(against) = against.as_mut() {
                let done = against.step(step, &cost);
                done.ok_or(NoRegulator::Recursion(k))?;
            }
            cost = found.cost;
            step.cost.clone_from(&cost);
        }
        let mut law = self.law(&steps, &motion, held.as_ref());
        let mut observer_radius = None;
        if let Some(observation) = &self.task.observer {
            let forces = against.as_ref().map(|against| against.forces(self));
            let forces = forces.transpose()?;
            let found = self.observer(observation, &steps, &motion, held.as_ref(), forces)?;
            (law.observer, observer_radius) = (Some(found.0), Some(found.1));
        }
        let mut out = Regulated {
            law,
            steps,
            held,
            end_cost,
            lasting: against.map(|against| against.rest),
            not_held,
            observer_radius,
            residual,
            reproduced: Vec::new(),
        };
        out.reproduced = reproduced(self, &linearisation, &out.steps, &motion);
        Ok(out)
    }

    /// The step at the goal under the inputs that hold it, with its gain.
    fn held(
        &self,
        linearisation: &mut Linearisation<'_>,
        rest: &[f64],
    ) -> Result<(RegulatedStep, HeldGain), String> {
        if self.is_restless {
            return Err("no state at rest near the end of the motion is known".to_owned());
        }
        let goal = &self.goal;
        let step = self.linearised(linearisation, goal, &self.model.scalars(rest));
        let step = step.ok_or("the linearised step there has no result")?;
        let mut step = self.augmented(&step, goal);
        let (scales, scaled) = self.scaled(&step);
        let held = scaled.for_ever();
        let mut held = held.map_err(|reason| self.reason(reason))?;
        // Integrals that nothing takes to zero are no motion.
        let moving = scaled.by_state.nrows() - self.integrated.len();
        let without_integrals = scaled.by_state.view((0, 0), (moving, moving));
        held.open_radius = spectral_radius(&without_integrals.into_owned());
        // Back to rad, mm, V.
        let ranges = &self.ranges;
        let HeldGain { gain, cost, .. } = &mut held;
        *gain = gain.map_with_location(|i, j, gain| gain * ranges[i] / scales[j]);
        *cost = cost.map_with_location(|i, j, cost| cost / (scales[i] * scales[j]));
        step.gain.clone_from(gain);
        step.cost.clone_from(cost);
        Ok((step, held))
    }

    fn reason(&self, reason: NotHeld) -> String {
        let reason = match reason {
            NotHeld::Unsolved => "its Riccati equation has no solution".to_owned(),
            NotHeld::Unstable(radius) => {
                format!("the spectral radius of the closed loop is {radius:.6}, not below 1")
            }
        };
        match self.integrated.len() {
            0 => format!("{reason}: some motion cannot be steered by the inputs"),
            count => format!(
                "{reason}: {} inputs cannot take {count} integrals to zero; expected no \"integral\", or more inputs",
                self.inputs.len()
            ),
        }
    }

    /// The same step with entries of the state near one, inputs as parts of their ranges, and the scales of the state.
    fn scaled(&self, step: &RegulatedStep) -> (Vec<f64>, RegulatedStep) {
        let n = step.by_state.nrows();
        let q = &step.costs.state;
        let scale = |i: usize| match q[(i, i)] + step.rates[i] {
            cost if cost > 0.0 => 1.0 / cost.sqrt(),
            _ => 1.0,
        };
        let mut scales: Vec<f64> = (0..n).map(scale).collect();
        // A momentum is as large as the coordinate makes it in a step or so.
        for (place, &i) in self.momenta.iter().enumerate() {
            let own = self.coordinates.iter().position(|&j| j == i);
            let own = own.expect("a momentum belongs to a coordinate");
            let row = self.coordinates.len() + place;
            let by = step.by_state[(own, row)].abs();
            scales[row] = if by > 0.0 { scales[own] / by } else { 1.0 };
        }
        let square = |m: &DMatrix<f64>, power: i32| {
            m.map_with_location(|i, j, value| value * scales[j] * scales[i].powi(power))
        };
        let (by_inputs, inputs, ranges) = (&step.by_inputs, &step.costs.inputs, &self.ranges);
        let scaled = RegulatedStep {
            by_state: square(&step.by_state, -1),
            by_inputs: by_inputs.map_with_location(|i, j, by| by * ranges[j] / scales[i]),
            costs: Costs {
                state: square(q, 1),
                inputs: inputs.map_with_location(|i, j, cost| cost * ranges[i] * ranges[j]),
            },
            rates: (0..n).map(|i| step.rates[i] * scales[i].powi(2)).collect(),
            ..step.clone()
        };
        (scales, scaled)
    }
}

/// Relative residual of (R̂ + BᵀSB) K = BᵀSA + Nᵀ, computed once more.
fn left(step: &RegulatedStep, cost: &DMatrix<f64>, gain: &DMatrix<f64>) -> f64 {
    let WholeCosts { costs, cross } = step.whole_costs();
    let toward = step.by_inputs.transpose() * cost;
    let right = &toward * &step.by_state + cross;
    let inner = costs.inputs + &toward * &step.by_inputs;
    let size = (inner.norm() * gain.norm()).max(right.norm());
    match size > 0.0 {
        true => (inner * gain - right).norm() / size,
        false => 0.0,
    }
}
