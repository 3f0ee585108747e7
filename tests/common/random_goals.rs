//! Random goals of the elephant trunk that can be reached by construction: rest under random voltages, and places of its tip.

#![allow(dead_code, reason = "test and bench use a part each")]

use nalgebra::Vector3;
use proboscis::control::problem::Task;
use proboscis::dynamics::equilibrium;
use proboscis::files::read_problem;
use proboscis::math::Random;
use proboscis::model::{Coordinates, Model};
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Upper bound of the voltages in V.
const MOST: f64 = 3000.0;

/// Kind of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The equilibrium under random voltages.
    Rest,
    /// The tip where it is in such an equilibrium, at rest in any posture.
    Tip,
}

/// A goal.
#[derive(Clone, Debug)]
pub(crate) struct Goal {
    /// As a problem file states it.
    pub(crate) json: Value,
    /// Joint angles of the equilibrium in rad.
    pub(crate) angles: Vec<f64>,
    /// Place of the tip in it in mm.
    pub(crate) tip: Vector3<f64>,
}

/// Record of a solve: its status, and all numbers of its point and its multipliers; nothing where the goal is refused.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Solved {
    pub(crate) word: &'static str,
    /// Variables and all multipliers, bit by bit.
    pub(crate) bits: Vec<u64>,
    pub(crate) objective: u64,
    pub(crate) iterations: usize,
    /// The largest of the voltages in V.
    pub(crate) voltage: u64,
}

/// Solves a kept problem with changes, in memory.
pub(crate) fn solved(problem: &Path, changes: &[String]) -> Solved {
    let loaded = read_problem(problem, changes).expect("a kept problem");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let allowed = SolveLimits {
        iterations: Some(100),
        seconds: None,
    };
    let optimum = optimise(&loaded.system, &control, None, allowed, &mut go_on);
    let Ok(optimum) = optimum else {
        return Solved::default();
    };
    let solution = &optimum.solution;
    let multipliers = &solution.costates;
    let all = [
        &solution.x,
        &multipliers.constraints,
        &multipliers.lower,
        &multipliers.upper,
    ];
    let voltages = optimum.motion.voltages.iter().flatten();
    Solved {
        word: optimum.word(),
        bits: all.into_iter().flatten().map(|v| v.to_bits()).collect(),
        objective: solution.objective.to_bits(),
        iterations: solution.iterations.len(),
        voltage: voltages.fold(0.0_f64, |m, v| m.max(*v)) as u64,
    }
}

/// Draws goals of a trunk.
#[derive(Debug)]
pub(crate) struct Goals {
    random: Random,
    model: Model,
}

/// The kept problem of the trunk.
pub(crate) fn trunk() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk_effort.json")
}

impl Goals {
    /// Goals of the kept trunk; equal seeds give equal goals.
    pub(crate) fn new(seed: u64) -> Self {
        let system = read_problem(&trunk(), &[]).expect("a kept problem").system;
        let model = Model::new(system, Some(Coordinates::Reduced), 15.0, &[]);
        Self {
            random: Random::new(seed),
            model: model.expect("a tree"),
        }
    }

    /// The next goal; voltages without an equilibrium are drawn again.
    pub(crate) fn draw(&mut self, kind: Kind) -> Goal {
        let Self { random, model } = self;
        let zero = model.coordinates_at(&vec![0.0; model.joint_readings.len()]);
        loop {
            // Whole volts, so that what is written is what is meant.
            let voltages: Vec<f64> = (0..model.sources.len())
                .map(|_| random.between(0.0, MOST).round())
                .collect();
            let Ok(rest) = equilibrium(model, &zero, &model.scalars(&voltages)) else {
                continue;
            };
            let mut instant = model.action.map.instant();
            instant.z.copy_from_slice(&rest.z);
            model.action.map.place(&mut instant);
            let tip = instant.x[model.markers[0]];
            let json = match kind {
                Kind::Rest => {
                    let named = model.sources.iter().map(|source| source.name.clone());
                    let map: Value = named.zip(voltages.iter().map(|&v| json!(v))).collect();
                    json!({ "rest_at_voltages": map })
                }
                Kind::Tip => {
                    let place = [0, 1, 2].map(|axis| tip[axis] / 1e3);
                    json!({ "markers": { "tip": place } })
                }
            };
            return Goal {
                json,
                angles: model.joints(&instant, &zero),
                tip,
            };
        }
    }
}
