//! The motion that a receding horizon follows, with the costs of deviations from it: those of the regulator.

use crate::feedback::LawInput;
use crate::workflow::regulator::{Regulated, RegulatedStep};
use nalgebra::DMatrix;

/// The motion at an instant, with the costs there.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Coordinates, then rates of those that have momenta: rad, mm, rad/ms, mm/ms.
    pub(super) state: Vec<f64>,
    /// The momenta.
    pub(super) momentum: Vec<f64>,
    /// Inputs of the interval behind it, or their squares: V, V², N, N mm.
    pub(super) inputs: Vec<f64>,
    /// Cost of the coordinates.
    pub(super) places: DMatrix<f64>,
    /// Cost of coordinates and momenta, as those of all time that follows.
    pub(super) end: DMatrix<f64>,
    /// Slope of that cost by constant disturbances and the inputs against them; none without such forces.
    pub(super) slope: Option<DMatrix<f64>>,
}

/// A motion that ends in a state that is held.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// Its instants; the last is the state that is held.
    points: Vec<Point>,
    /// Cost of each input, or of its square.
    pub(super) inputs: Vec<f64>,
    /// Change of the state at rest by constant disturbances and the inputs against them; none without such forces.
    pub(super) rest: Option<DMatrix<f64>>,
}

impl Reference {
    /// That of a regulator, with the momenta of a state; none where the goal is not held.
    pub(super) fn new(of: &Regulated, momentum: impl Fn(&[f64]) -> Vec<f64>) -> Option<Self> {
        let (held_step, held) = of.held.as_ref()?;
        let law = &of.law;
        let mut after = of.end_cost.clone();
        let mut ends = vec![];
        for step in of.steps.iter().rev() {
            after = step.riccati(&after)?.cost;
            ends.push(after.clone());
        }
        ends.reverse();
        let point = |at: &crate::feedback::Point, step: &RegulatedStep, end: &DMatrix<f64>| Point {
            state: at.state.clone(),
            momentum: momentum(&at.state),
            inputs: acting(&law.inputs, &at.inputs),
            places: step.places.clone(),
            end: end.clone(),
            slope: step.lasting.as_ref().map(|[_, slope]| slope.clone()),
        };
        let motion = law.points.iter().zip(&of.steps).zip(&ends);
        let mut points: Vec<Point> = motion
            .map(|((at, step), end)| point(at, step, end))
            .collect();
        points.push(point(law.held.as_ref()?, held_step, &held.cost));
        let costs = &held_step.costs.inputs;
        Some(Self {
            points,
            rest: of.lasting.clone(),
            inputs: costs.diagonal().iter().copied().collect(),
        })
    }

    /// The motion at an instant, also behind its end.
    pub(super) fn at(&self, k: usize) -> &Point {
        &self.points[k.min(self.points.len() - 1)]
    }
}

/// Inputs as they act: squares where they do by them.
fn acting(of: &[LawInput], inputs: &[f64]) -> Vec<f64> {
    let all = of.iter().zip(inputs);
    all.map(|(of, input)| if of.is_squared { input * input } else { *input })
        .collect()
}
