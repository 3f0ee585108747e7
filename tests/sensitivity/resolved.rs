//! Derivatives of optima of kept problems against central differences of optima that are found anew.

use proboscis::control::problem::{Control, Task};
use proboscis::files::read_problem;
use proboscis::model::System;
use proboscis::sensitivity::{Sensitivity, sensitivities};
use proboscis::workflow::{Iterate, Optimum, SolveLimits, optimise};
use std::ops::ControlFlow;
use std::path::Path;

/// A problem of `problems/` with changes.
pub(crate) fn problem(name: &str, changes: &[String]) -> (System, Control) {
    let path = format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let loaded = read_problem(Path::new(&path), changes).unwrap_or_else(|error| panic!("{error}"));
    let Task::Control(control) = loaded.task else {
        panic!("{name} is a control problem");
    };
    (loaded.system, *control)
}

/// Its optimum, from another one where there is one.
pub(crate) fn optimum((system, control): &(System, Control), from: Option<&Optimum>) -> Optimum {
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let from = from.map(|one| &one.motion);
    let found = optimise(system, control, from, SolveLimits::default(), &mut go_on).unwrap();
    assert!(
        found.solution.status.is_solved(),
        "{:?}",
        found.solution.status
    );
    found
}

/// Norms of a difference and of what it is a difference from.
fn compare(found: impl Iterator<Item = f64>, expected: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut error, mut size) = (0.0_f64, 0.0_f64);
    for (a, b) in found.zip(expected) {
        error = error.max((a - b).abs());
        size = size.max(b.abs());
    }
    (error, size)
}

/// A number of a problem with two values beside it, as `--set` writes them.
pub(crate) struct Beside<'a> {
    /// Its path in `sensitivity`.
    pub path: &'a str,
    /// Its path for `--set`.
    pub set: &'a str,
    /// Its value in SI units, and the step of differences.
    pub value: f64,
    pub step: f64,
}

/// Checks a problem by some of its numbers; `extra` changes it.
fn check(name: &str, extra: &[&str], numbers: &[Beside<'_>], tolerance: f64) {
    let common = [
        "control.solver.tolerance=1e-12",
        "control.intervals=\"auto\"",
    ];
    let common = common[..1].iter().chain(extra).map(|one| (*one).to_owned());
    let common: Vec<String> = common.collect();
    let list = numbers.iter().map(|one| format!("{:?}: {{}}", one.path));
    let list = list.collect::<Vec<_>>().join(", ");
    let mut asked = common.clone();
    asked.push(format!("control.sensitivity={{{list}}}"));
    let base = problem(name, &asked);
    let found = optimum(&base, None);
    let (by, refused) = sensitivities(&base.0, &base.1, &found.motion)
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    assert!(refused.is_empty(), "{name}: {refused:?}");
    assert_eq!(by.len(), numbers.len());
    for number in numbers {
        let mut list = by.iter();
        let own = list.find(|one| one.varied.name == number.path).unwrap();
        let beside = [-1.0, 1.0].map(|sign| {
            let mut changes = common.clone();
            changes.push(format!(
                "{}={:?}",
                number.set,
                number.value + sign * number.step
            ));
            optimum(&problem(name, &changes), Some(&found))
        });
        against(name, number, (own, &found), &beside, tolerance);
    }
}

fn against(
    name: &str,
    number: &Beside<'_>,
    (own, found): (&Sensitivity, &Optimum),
    [before, after]: &[Optimum; 2],
    tolerance: f64,
) {
    let factor = own.varied.unit.factor;
    let per = 2.0 * number.step / factor;
    let slope = |a: f64, b: f64| (b - a) / per;
    let objective = slope(before.solution.objective, after.solution.objective);
    let all = own
        .voltages
        .iter()
        .flatten()
        .zip(found.motion.voltages.iter().flatten());
    let squares: Vec<f64> = all.map(|(by, v)| 2.0 * v * by).collect();
    let both = before
        .motion
        .voltages
        .iter()
        .flatten()
        .zip(after.motion.voltages.iter().flatten());
    let beside: Vec<f64> = both.map(|(a, b)| slope(a * a, b * b)).collect();
    let errors = [
        (
            "objective",
            compare([own.objective].into_iter(), [objective].into_iter()),
        ),
        (
            "duration",
            compare(
                [own.duration].into_iter(),
                [slope(
                    *before.motion.times.last().unwrap(),
                    *after.motion.times.last().unwrap(),
                )]
                .into_iter(),
            ),
        ),
        // Solvers find the squares of voltages; a voltage at its bound of zero is the root of what is left of it.
        (
            "squared voltages",
            compare(squares.into_iter(), beside.into_iter()),
        ),
        (
            "coordinates",
            compare(
                own.coordinates.iter().flatten().copied(),
                before
                    .motion
                    .z
                    .iter()
                    .zip(&after.motion.z)
                    .zip(&own.coordinates)
                    .flat_map(|((a, b), own)| {
                        a.iter().zip(b).take(own.len()).map(|(a, b)| slope(*a, *b))
                    }),
            ),
        ),
        (
            "multipliers",
            compare(
                own.multipliers.iter().copied(),
                before
                    .motion
                    .costates
                    .as_ref()
                    .unwrap()
                    .rows
                    .iter()
                    .zip(&after.motion.costates.as_ref().unwrap().rows)
                    .map(|(a, b)| slope(*a, *b)),
            ),
        ),
    ];
    println!(
        "{name} by {}: {} [{:e}, {:e}] {:?} weak {:?}",
        number.path,
        errors
            .iter()
            .map(|(what, (e, s))| format!("{what} {s:.3e} ({:.1e})", e / s))
            .collect::<Vec<_>>()
            .join(", "),
        own.range.down.change * factor,
        own.range.up.change * factor,
        own.range.up.bound,
        own.weak,
    );
    for (what, (error, size)) in errors {
        if what != "duration" {
            assert!(
                size > 0.0,
                "{name}: {what} does not depend on {}",
                number.path
            );
        }
        assert!(
            error <= tolerance * size,
            "{name} by {}: {what} differs by {error:e} of {size:e}",
            number.path
        );
    }
}

fn of<'a>(path: &'a str, set: &'a str, value: f64, step: f64) -> Beside<'a> {
    Beside {
        path,
        set,
        value,
        step: step * value,
    }
}

const MODULUS: &str = "materials.silicone.shear_modulus";
const SET_MODULUS: &str = "scene.materials.silicone.shear_modulus";
const VISCOSITY: &str = "materials.silicone.viscosity";
const SET_VISCOSITY: &str = "scene.materials.silicone.viscosity";

#[test]
fn the_pair_by_constants_of_the_scene() {
    let numbers = [
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
        of(VISCOSITY, SET_VISCOSITY, 1e3, 2e-4),
        of("chain.mass", "scene.chain.mass", 0.03, 2e-4),
        of("chain.muscles.arm", "scene.chain.muscles.arm", 0.015, 2e-4),
    ];
    check("pair", &[], &numbers, 1e-6);
}

/// The curvature of constraints is a part of how states of rest follow constants.
#[test]
fn the_pair_in_redundant_coordinates() {
    let numbers = [
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
        of(VISCOSITY, SET_VISCOSITY, 1e3, 2e-4),
        of(
            "goal.rest_at_voltages.muscle2",
            "control.goal.rest_at_voltages.muscle2",
            1700.0,
            2e-4,
        ),
    ];
    let gravity = "scene.gravity=[2.0, -9.81, 0.0]";
    let extra = ["control.coordinates=\"redundant\"", gravity];
    check("pair", &extra, &numbers, 1e-5);
}

#[test]
fn the_pair_with_a_free_duration() {
    let numbers = [
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
        of("chain.mass", "scene.chain.mass", 0.03, 2e-4),
        of(
            "voltage_bounds[1]",
            "control.voltage_bounds[1]",
            3000.0,
            2e-4,
        ),
        of(
            "goal.rest_at_voltages.muscle2",
            "control.goal.rest_at_voltages.muscle2",
            1700.0,
            2e-4,
        ),
    ];
    check("pair_time", &[], &numbers, 1e-5);
}

#[test]
fn the_elephant_trunk() {
    let numbers = [
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
        of(VISCOSITY, SET_VISCOSITY, 1e3, 2e-4),
        of("objective.rate", "control.objective.rate", 5e-4, 2e-4),
        of("objective.effort", "control.objective.effort", 1.0, 2e-4),
        of("duration", "control.duration", 0.3, 2e-4),
    ];
    check("elephant_trunk", &["control.intervals=20"], &numbers, 1e-5);
}

#[test]
fn the_pair_with_goals_starts_and_bounds() {
    let of_angles = [
        r#"control.goal={"joint_angles": {"joint1": 0.2}, "hold": "none"}"#,
        r#"control.start={"joint_angles": {"joint1": 0.05}, "joint_rates": {"joint1": 0.5}}"#,
        r#"control.voltage_bounds=[0, 1800]"#,
    ];
    let numbers = [
        of(
            "goal.joint_angles.joint1",
            "control.goal.joint_angles.joint1",
            0.2,
            2e-4,
        ),
        of(
            "start.joint_rates.joint1",
            "control.start.joint_rates.joint1",
            0.5,
            2e-4,
        ),
        of(
            "voltage_bounds[1]",
            "control.voltage_bounds[1]",
            1800.0,
            2e-4,
        ),
        of("duration", "control.duration", 0.2, 2e-4),
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
    ];
    check("pair", &of_angles, &numbers, 1e-5);
}

#[test]
fn an_elastic_block() {
    let numbers = [
        of(MODULUS, SET_MODULUS, 1e5, 2e-4),
        Beside {
            path: "goal.markers.tip[2]",
            set: "control.goal.markers.tip[2]",
            value: 4.203040e-3,
            step: 1e-6,
        },
    ];
    let few = [
        "control.intervals=6",
        "scene.solids[0].box.elements=[6,1,2]",
    ];
    check("fe_bending_control", &few, &numbers, 1e-5);
}
