//! The estimate of an observer from sample to sample: state, lasting forces, and the inputs against these.

use crate::feedback::law::Law;
use crate::feedback::observer::Observer;

/// An estimate, as deviations from the motion.
#[derive(Clone, Debug)]
pub struct Estimate<'l> {
    law: &'l Law,
    observer: &'l Observer,
    /// The state, then the forces; those that are expected at the next sample.
    state: Vec<f64>,
    expected: Vec<f64>,
    /// Changes of the inputs that hold the goal against the forces, and their limits; none without forces.
    against: Vec<f64>,
    limits: Vec<[f64; 2]>,
    /// Room for errors of readings, and for what is left of forces.
    errors: Vec<f64>,
    left: Vec<f64>,
}

impl<'l> Estimate<'l> {
    /// That of the observer of a law, where there is one, on the motion.
    pub fn new(law: &'l Law) -> Option<Self> {
        let observer = law.observer.as_ref()?;
        let forces = observer.forces();
        let size = law.measured.len() + forces;
        let goal = law.held.as_ref().or(law.points.last());
        let goal = &goal.expect("a law has an interval").inputs;
        let limits = law.inputs.iter().zip(goal).map(|(input, given)| {
            let (_, bounds, acting) = input.wanted(*given, 0.0);
            bounds.map(|bound| bound - acting)
        });
        Some(Self {
            limits: limits.take(law.targets()).collect(),
            law,
            observer,
            state: vec![0.0; size],
            expected: vec![0.0; size],
            against: vec![0.0; law.targets()],
            errors: vec![0.0; observer.readings.len()],
            left: vec![0.0; forces],
        })
    }

    /// Takes in the readings at the start of an interval; those that are no numbers were not measured.
    pub fn correct(&mut self, interval: usize, readings: &[f64]) {
        self.state.copy_from_slice(&self.expected);
        let filter = self.observer.at(interval);
        filter.correct(readings, &mut self.state, &mut self.errors);
        self.hold();
    }

    /// Takes what is expected for the state, as where nothing was measured.
    pub fn trust(&mut self) {
        self.state.copy_from_slice(&self.expected);
        self.hold();
    }

    fn hold(&mut self) {
        if let Some(lasting) = &self.observer.lasting {
            let forces = &self.state[self.law.measured.len()..];
            lasting.hold(forces, &self.limits, &mut self.against, &mut self.left);
        }
    }

    /// Expects the state an interval later, under deviations of the inputs of this interval.
    pub fn expect(&mut self, interval: usize, inputs: &[f64]) {
        let filter = self.observer.at(interval);
        filter.predict(&self.state, inputs, &mut self.expected);
        if interval + 1 == self.observer.points.len() {
            let jump = self.expected.iter_mut().zip(&self.observer.jump);
            jump.for_each(|(x, jump)| *x += jump);
        }
    }

    /// Goes on to the next interval without readings, under deviations of inputs.
    pub fn go_on(&mut self, interval: usize, inputs: &[f64]) {
        self.expect(interval, inputs);
        self.state.copy_from_slice(&self.expected);
    }

    /// Deviations of the state, then the lasting forces.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Changes of the inputs that hold the goal against the forces.
    pub fn against(&self) -> &[f64] {
        &self.against
    }

    /// Takes over another estimate of the same law.
    pub fn copy(&mut self, other: &Self) {
        self.state.copy_from_slice(&other.state);
        self.expected.copy_from_slice(&other.expected);
        self.against.copy_from_slice(&other.against);
    }
}
