//! The elephant trunk of `problems/elephant_trunk_effort.json` on any grid, in both coordinates.
#![allow(dead_code, reason = "each bench uses a part")]

use proboscis::control::problem::{BoundaryState, Control, Duration, Task};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::dynamics::{Start, Stepper, StepperReport};
use proboscis::files::read_problem;
use proboscis::ipopt::StartingPoint;
use proboscis::model::system::System;
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::Nlp;
use std::hint::black_box;
use std::path::Path;

/// Reads scene and control problem.
pub(crate) fn read(intervals: usize, coordinates: Coordinates) -> (System, Control) {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/elephant_trunk_effort.json"
    );
    let loaded = read_problem(Path::new(path), &[]).expect("the trunk problem can be read");
    let Task::Control(mut control) = loaded.task else {
        panic!("the trunk problem is one of control");
    };
    control.intervals = intervals;
    control.coordinates = Some(coordinates);
    (loaded.system, *control)
}

/// Transcribes the problem and hands over the program with its starting point.
pub(crate) fn with_program<T>(
    intervals: usize,
    coordinates: Coordinates,
    work: impl FnOnce(&mut Transcription<'_>, &StartingPoint) -> T,
) -> T {
    let (system, control) = read(intervals, coordinates);
    let Duration::Given(duration) = control.duration else {
        panic!("the trunk problem has a given duration");
    };
    let h = duration / intervals as f64;
    let (model, boundary) =
        BoundaryConditions::resolve(&system, &control, h).expect("states of rest exist");
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial)
        .expect("there are enough unknowns");
    let start = program.start(&initial);
    work(&mut program, &start)
}

/// The callbacks of a program at two points in turn, so that every call is at a new point.
pub(crate) struct Callbacks<'a, 'm> {
    program: &'a mut Transcription<'m>,
    points: [Vec<f64>; 2],
    costates: Vec<f64>,
    rows: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
    turn: usize,
}

impl<'a, 'm> Callbacks<'a, 'm> {
    /// Points next to the start, costates of magnitude one.
    pub(crate) fn new(program: &'a mut Transcription<'m>, start: &StartingPoint) -> Self {
        let moved = start.x.iter().map(|x| x + 1e-6).collect();
        let count = program.constraints().lower.len();
        Self {
            points: [start.x.clone(), moved],
            costates: (0..count).map(|r| (r as f64).sin()).collect(),
            rows: vec![0.0; count],
            jacobian: vec![0.0; program.jacobian_structure().rows.len()],
            hessian: vec![0.0; program.hessian_structure().rows.len()],
            program,
            turn: 0,
        }
    }

    fn turn(&mut self) -> usize {
        self.turn = 1 - self.turn;
        self.turn
    }

    /// Evaluates the constraints.
    pub(crate) fn constraint(&mut self) {
        let turn = self.turn();
        self.program.constraint(&self.points[turn], &mut self.rows);
        black_box(&self.rows);
    }

    /// Evaluates their Jacobian.
    pub(crate) fn jacobian(&mut self) {
        let turn = self.turn();
        self.program
            .jacobian(&self.points[turn], &mut self.jacobian);
        black_box(&self.jacobian);
    }

    /// Evaluates the Hessian of the Lagrangian.
    pub(crate) fn hessian(&mut self) {
        let turn = self.turn();
        self.program
            .hessian(&self.points[turn], 1.0, &self.costates, &mut self.hessian);
        black_box(&self.hessian);
    }
}

/// Step of the forward motion in ms.
pub(crate) const STEP: f64 = 10.0;

/// The trunk in its reference configuration, to be let go: model, state of rest, voltages of the goal.
pub(crate) fn at_rest(coordinates: Coordinates) -> (Model, Start, Vec<f64>) {
    let (system, control) = read(1, coordinates);
    let joints = vec![0.0; system.joints.len()];
    let model = Model::new(system, Some(coordinates), STEP, &[]).expect("the joints form a tree");
    let BoundaryState::RestAtVoltages(voltages, _) = &control.goal else {
        panic!("the goal of the trunk problem is a state of rest");
    };
    let start = Start::at_rest(&model, model.coordinates_at(&joints));
    let scalars = model.scalars(voltages);
    (model, start, scalars)
}

/// Takes `count` steps from rest.
pub(crate) fn march(model: &Model, start: &Start, scalars: &[f64], count: usize) -> StepperReport {
    let mut stepper = Stepper::new(model, &start.z, &start.momentum, Default::default());
    for _ in 0..count {
        black_box(stepper.step(STEP, scalars).expect("the trunk moves on"));
    }
    stepper.report()
}
