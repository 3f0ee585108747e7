//! Feedback of a robot whose muscles remember: units of viscous stretches and charges in its files, and controllers in these units.

use crate::commands::summary;
use crate::common::receding::problem;
use crate::feedback::{number, solved};
use crate::runs::{read, run, workshop};
use proboscis::control::problem::Task;
use proboscis::feedback::Memory;
use proboscis::files::read_problem;
use proboscis::math::Random;
use proboscis::tasks::{SolveRequest, solve};
use proboscis::workflow::Iterate;
use proboscis::workflow::regulator::{Along, regulator};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

/// A resistor before each muscle, and rubber with one branch.
pub(crate) const RESISTOR: &str = "scene.chain.muscles.circuit={\"resistance\":\"100 kOhm\"}";
pub(crate) const BRANCH: &str = "scene.materials.silicone.maxwell=[{\"shear_modulus\":\"30 kPa\",\"relaxation_time\":\"0.04 s\"}]";

/// Unit of the charge of a muscle in C, as the design has it: 100 kPa times 4 cm³ of rubber with 3 ε₀ in layers of 50 µm.
fn unit_of_charge() -> f64 {
    let (modulus, volume, layer): (f64, f64, f64) = (100e3, 10e-3 * 10e-3 * 40e-3, 50e-6);
    let capacitance = 3.0 * 8.854_187_812_8e-12 * volume / (layer * layer);
    (modulus * volume * capacitance).sqrt()
}

/// The values of a column of a table by its title.
fn column(file: &Path, title: &str) -> Vec<f64> {
    let text = fs::read_to_string(file).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let titles: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = titles.iter().position(|own| *own == title);
    let place = place.unwrap_or_else(|| panic!("{title}: {titles:?}"));
    let value = |line: &str| line.split(',').nth(place).unwrap().parse().unwrap();
    lines.map(value).collect()
}

#[test]
fn charges_and_viscous_stretches_have_their_si_units() {
    let folder = workshop();
    let here = folder.path();
    let set = [RESISTOR, BRANCH];
    solved(here, "problems/pair_feedback.json", "kept", &set);
    let file = read(here.join("kept/feedback.json"));
    let measured = file["measured"].as_array().unwrap();
    let place = |name: &str| {
        let place = measured.iter().position(|one| one["name"] == name);
        place.unwrap_or_else(|| panic!("{name}: {measured:?}"))
    };
    let trajectory = here.join("kept/trajectory.csv");
    let times = column(&trajectory, "time [ms]");
    let head = fs::read_to_string(here.join("kept/feedback.c")).unwrap();
    for (name, unit, title, of_column) in [
        (
            "charge of muscle2",
            "C",
            "muscle2_charge [nC]",
            (|x| 1e-9 * x) as fn(f64) -> f64,
        ),
        (
            "logarithm of viscous stretch 1 of muscle2",
            "1",
            "muscle2_viscous_stretch1",
            f64::ln,
        ),
    ] {
        let place = place(name);
        assert_eq!(measured[place]["unit"], unit);
        assert_eq!(measured[place]["is_memory"], true);
        assert!(head.contains(&format!("] {name} [{unit}]")), "{head}");
        let values = column(&trajectory, title);
        let intervals = file["intervals"].as_array().unwrap();
        let largest = values
            .iter()
            .map(|x| of_column(*x).abs())
            .fold(0.0, f64::max);
        assert!(largest > 1e-6, "{largest}");
        for (k, interval) in intervals.iter().enumerate() {
            // The motion of the gains has steps of 1 ms, that of the table 10 ms.
            let own = number(&interval["state"][place]);
            let at = times
                .iter()
                .position(|t| (t - 10.0 * k as f64).abs() < 1e-6);
            let expected = of_column(values[at.unwrap()]);
            assert!(
                (own - expected).abs() < 0.1 * largest,
                "{name} {k}: {own} {expected}"
            );
        }
    }
    // The same corrections by the gains in memory, in their own unit, and by those of the file.
    let (system, control) = problem("pair_feedback.json", &set);
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve(&system, &control, SolveRequest::default(), go_on).unwrap();
    let path = here.join("problems/pair_feedback.json");
    let task = read_problem(&path, &set.map(str::to_owned))
        .unwrap()
        .feedback;
    let along = Along::new(&found.optimum, &found.discrete, &control);
    let own = regulator(along, &task.unwrap()).unwrap().law;
    let law = format!("simulate.controller.feedback={:?}", here.join("kept"));
    let path = here.join("problems/pair_closed_loop.json");
    let Task::Simulate(task) = read_problem(&path, &[law]).unwrap().task else {
        panic!("a simulation");
    };
    let of_file = task.controller.unwrap().law;
    let random = &mut Random::new(7);
    let mut largest = 0.0_f64;
    for k in 0..own.points.len() + 2 {
        let time = own.h * k as f64;
        let width = own.points[0].gain.ncols();
        let mut deviation = vec![0.0; width];
        let mut same = deviation.clone();
        for (place, one) in own
            .measured
            .iter()
            .enumerate()
            .filter(|(_, one)| one.memory.is_some())
        {
            deviation[place] = random.between(-0.1, 0.1);
            same[place] = match (one.memory.unwrap(), of_file.measured[place].memory) {
                // 1 mC.
                (Memory::Charge(_), Some(Memory::Charge(unit))) => {
                    deviation[place] * unit_of_charge() / (1e-3 * unit)
                }
                (Memory::Number, Some(Memory::Number)) => deviation[place],
                other => panic!("{other:?}"),
            };
        }
        let [mut a, mut b] = [vec![0.0; 2], vec![0.0; 2]];
        own.correct(time, &deviation, &mut a);
        of_file.correct(time, &same, &mut b);
        for (a, b) in a.iter().zip(&b) {
            largest = largest.max(a.abs());
            assert!((a - b).abs() < 1e-6 * largest, "{k}: {a} {b}");
        }
    }
    assert!(largest > 1.0, "{largest}");
}

/// Charges of the robot are in its own unit, and those of the law in mC.
#[test]
fn a_robot_that_remembers_needs_no_corrections_where_nothing_deviates() {
    let folder = workshop();
    let here = folder.path();
    solved(
        here,
        "problems/pair_feedback.json",
        "kept",
        &[RESISTOR, BRANCH],
    );
    let law = format!("simulate.controller.feedback={:?}", here.join("kept"));
    let arguments = [
        "simulate",
        "problems/pair_closed_loop.json",
        "-o",
        "same",
        "--no-report",
        "--set",
        &law,
        "--set",
        "simulate.start={\"joint_angles\":{}}",
        "--set",
        "simulate.duration=\"0.19 s\"",
        "--set",
        RESISTOR,
        "--set",
        BRANCH,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let tip = &summary(here, "same")["closed_loop"]["markers"]["tip"];
    let [with, without] = ["feedback", "open_loop"].map(|key| number(&tip[key]["greatest"]));
    assert!(with > 1e-6 && (with - without).abs() < 1e-9, "{tip}");
}
