//! The law of a controller in C, compiled and called beside that of the library.

use crate::feedback::solved;
use crate::remembered_feedback::{BRANCH, RESISTOR};
use crate::runs::workshop;
use proboscis::control::problem::Task;
use proboscis::feedback::{Controller, Law, Memory, Reading};
use proboscis::files::read_problem;
use proboscis::math::Random;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Reads what is measured, a line for each step, and writes the inputs.
const MAIN: &str = r#"
#include <stdio.h>
#include "feedback.c"
int main(void) {
  feedback_state_t state;
  double measured[FEEDBACK_READINGS], inputs[FEEDBACK_INPUTS];
  int i;
  long k;
  feedback_start(&state);
  for (k = 0; k < FEEDBACK_DELAY; k++) {
    feedback_planned(k, inputs);
    for (i = 0; i < FEEDBACK_INPUTS; i++) printf("%.17g ", inputs[i]);
  }
  for (;;) {
    for (i = 0; i < FEEDBACK_READINGS; i++)
      if (scanf("%lf", &measured[i]) != 1) return 0;
    feedback_step(&state, measured, inputs);
    for (i = 0; i < FEEDBACK_INPUTS; i++) printf("%.17g ", inputs[i]);
  }
}
"#;

/// Intervals that are compared: those of the motion, and more after its end.
const STEPS: usize = 30;

/// What is measured about the motion at an instant, and the same in SI units: off by up to 0.6 rad and 6 rad/s, or by a part of that which markers move.
fn measured(law: &Law, random: &mut Random, k: usize) -> [Vec<f64>; 2] {
    let mut off = |place: usize| {
        let of = &law.measured[place];
        let (size, unit) = match of.memory {
            Some(Memory::Charge(unit)) => (0.02 / unit, 1e-3 * unit),
            Some(Memory::Number) => (0.05, 1.0),
            None if of.is_rate => (6e-3, 1e3),
            None => (0.6, 1.0),
        };
        (random.between(-size, size), unit)
    };
    let (values, si): (Vec<f64>, Vec<f64>) = match &law.observer {
        None => (0..law.measured.len())
            .map(|place| {
                let (off, unit) = off(place);
                let value = law.reference(law.h * k as f64, place) + off;
                (value, unit * value)
            })
            .unzip(),
        Some(observer) => {
            let filter = observer.points.get(k).or(observer.held.as_ref()).unwrap();
            let readings = observer.readings.iter().zip(&filter.readings);
            readings
                .map(|(of, value)| {
                    let (off, _) = off(0);
                    match of {
                        Reading::State(_) => (value + off, value + off),
                        Reading::Marker(..) => (value + 10.0 * off, 1e-3 * (value + 10.0 * off)),
                    }
                })
                .unzip()
        }
    };
    [values, si]
}

/// Inputs of all intervals by the library, and what it measured in SI units.
fn by_library(law: &Law) -> (Vec<f64>, String) {
    let mut controller = Controller::new(law, law.h, law.h * law.delay as f64);
    let random = &mut Random::new(4);
    let (mut all, mut text) = (Vec::new(), String::new());
    for k in 0..STEPS + law.delay {
        let time = law.h * k as f64;
        if k < STEPS {
            let [mut values, mut si] = measured(law, random, k);
            if k == 7 {
                (values[0], si[0]) = (f64::NAN, f64::NAN);
            }
            si.iter()
                .for_each(|value| text.push_str(&format!("{value:?} ")));
            text.push('\n');
            controller.sample(time, &values);
        }
        let mut inputs = vec![0.0; law.inputs.len()];
        controller.inputs(time, time + 0.5 * law.h, &mut inputs);
        all.extend(inputs);
    }
    (all, text)
}

/// Inputs of all intervals by the C file.
fn by_c(folder: &Path, measured: &str) -> Vec<f64> {
    fs::write(folder.join("main.c"), MAIN).unwrap();
    let arguments = [
        "-std=c99",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-O2",
    ];
    let made = Command::new("cc")
        .args(arguments)
        .args(["main.c", "-o", "board", "-lm"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    fs::write(folder.join("measured"), measured).unwrap();
    let out = Command::new(folder.join("board"))
        .stdin(fs::File::open(folder.join("measured")).unwrap())
        .output()
        .unwrap();
    let text = String::from_utf8(out.stdout).unwrap();
    text.split_whitespace()
        .map(|one| one.parse().unwrap())
        .collect()
}

/// An observer of the tip, also with constant disturbances, and one of the joint.
const TIP: &str = "feedback.observer={\"markers\":{\"tip\":\"0.1 mm\"}}";
const LASTING: &str = "feedback.observer={\"markers\":{\"tip\":\"0.1 mm\"},\"lasting\":0.02}";
const JOINT: &str = "feedback.observer={\"joints\":{\"joint1\":\"0.5 deg\"}}";
const NO_INTEGRAL: &str = "feedback.weights.integral=0";

#[test]
fn a_compiled_controller_gives_the_inputs_of_the_library() {
    let folder = workshop();
    let here = folder.path();
    for (to, delay, observer) in [
        ("at_once", "0 ms", &[][..]),
        ("late", "21 ms", &[]),
        ("observed", "0 ms", &[JOINT]),
        ("observed_late", "21 ms", &[TIP]),
        ("remembered", "0 ms", &[RESISTOR, BRANCH]),
        ("remembered_late", "21 ms", &[RESISTOR, BRANCH]),
        ("seen_late", "21 ms", &[RESISTOR, BRANCH, TIP]),
        ("lasting", "0 ms", &[LASTING, NO_INTEGRAL]),
        ("lasting_late", "21 ms", &[LASTING, NO_INTEGRAL]),
    ] {
        let bounds = "control.voltage_bounds=[\"0 V\", \"2.2 kV\"]";
        let delay = format!("feedback.delay=\"{delay}\"");
        let set = [&[&*delay, bounds], observer].concat();
        solved(here, "problems/pair_feedback.json", to, &set);
        let law = format!(
            "simulate.controller.feedback=\"{}\"",
            here.join(to).display()
        );
        let problem = here.join("problems/pair_closed_loop.json");
        let Task::Simulate(task) = read_problem(&problem, &[law]).unwrap().task else {
            panic!("a simulation");
        };
        let law = task.controller.unwrap().law;
        assert_eq!(law.delay, if to.ends_with("late") { 3 } else { 0 });
        let is_observed = set.iter().any(|set| set.starts_with("feedback.observer"));
        assert_eq!(law.observer.is_some(), is_observed);
        let remembers = law.measured.iter().filter(|one| one.memory.is_some());
        assert_eq!(remembers.count(), if set.contains(&BRANCH) { 4 } else { 0 });
        assert_eq!(law.forces(), usize::from(to.starts_with("lasting")));
        let (expected, text) = by_library(&law);
        let found = by_c(&here.join(to), &text);
        assert_eq!(found.len(), expected.len());
        let (least, most) = (0.0, 2200.0);
        let within = expected
            .iter()
            .filter(|v| **v > least + 1.0 && **v < most - 1.0);
        assert!(within.count() > STEPS / 3, "{to}: {expected:?}");
        let [low, high] = [least, most].map(|bound| expected.contains(&bound));
        assert!(low && high, "{to}: {expected:?}");
        for (k, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{to} {k}: {a} {b}");
        }
    }
}
