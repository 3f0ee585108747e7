//! Robots that share one history of inputs: the greatest of their objectives, and closed forms.

use crate::loads::cart;
use crate::motions::{last, motion, together_by, with_programs};
use crate::motions_shared::{INPUTS, alone, steered, stiffer};
use proboscis::control::problem::{Combined, Control, Task};
use proboscis::files::read_problem;
use proboscis::nlp::joined::Joined;
use proboscis::nlp::{Nlp, differences};
use proboscis::tasks::{SolveRequest, solve_motions};
use proboscis::workflow::{Iterate, Optimum, Together};
use std::ops::ControlFlow;
use std::path::Path;

/// The steered robot, whose objective counts by a weight.
fn weighted(system: &proboscis::System, weight: f64) -> Control {
    let mut control = steered(system);
    control.objective.effort *= weight;
    control.objective.quantities[0].weight *= weight;
    control
}

fn objectives(found: &Together) -> Vec<f64> {
    assert!(found.optima.iter().all(Optimum::is_solved));
    let each = found.optima.iter().map(|one| one.solution.objective);
    each.collect()
}

#[test]
fn derivatives_of_the_greatest_objective_are_differences() {
    let systems = [0.8, 1.0, 1.2].map(stiffer);
    let each = systems.iter().enumerate();
    let list = each.map(|(k, system)| {
        let intervals = 6 + k;
        let control = Control {
            intervals,
            ..weighted(system, 1.0 + k as f64)
        };
        motion(&format!("robot{k}"), system, control)
    });
    let list: Vec<_> = list.collect();
    with_programs(&list, |programs, points| {
        // Any variables may be shared: here the last ones, one of them by another scale.
        let mut shared = last(2, &programs);
        shared[1].0[1].as_mut().unwrap().1 = 2.0;
        let mut sum = Joined::new(programs, &shared);
        let points: Vec<&[f64]> = points.iter().map(|x| &**x).collect();
        let mut x = sum.places().values(&points);
        let total = sum.objective(&x);
        let (rows, columns) = (sum.constraints().lower.len(), x.len());
        let mut worst = sum.with_worst();
        x.push(0.0);
        worst.complete(&mut x, None);
        assert_eq!(worst.constraints().lower.len(), rows + 3);
        assert_eq!(worst.variable_name(columns), "the greatest objective");
        assert!(worst.constraint_name(rows + 2).starts_with("robot2: "));
        // The bound begins above the greatest of three objectives, of which none vanishes.
        let bound = worst.objective(&x);
        assert!(total > 0.1 && bound > 1.1 * total / 3.0 && bound < 1.1 * total);
        let mut g = vec![0.0; rows + 3];
        worst.constraint(&x, &mut g);
        let kept = &g[rows..];
        assert!(
            kept.iter().all(|g| *g < 0.0) && kept[0] != kept[1],
            "{kept:?}"
        );
        let report = differences::check(&mut worst, &x, 3);
        assert!(report.is_consistent(), "{report}");
    });
}

#[test]
fn the_greatest_objective_is_no_greater_than_that_of_the_least_sum_and_weights_tell_why() {
    let systems = [0.7, 1.0, 1.4].map(stiffer);
    let list = |weights: [f64; 3]| {
        let each = systems.iter().zip(weights).enumerate();
        each.map(|(k, (system, w))| motion(&format!("robot{k}"), system, weighted(system, w)))
            .collect::<Vec<_>>()
    };
    let sum = together_by(list([1.0; 3]), &INPUTS, Combined::Sum);
    let worst = together_by(list([1.0; 3]), &INPUTS, Combined::Worst);
    let greatest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    let (of_sum, of_worst) = (objectives(&sum), objectives(&worst));
    println!("{of_sum:?} {of_worst:?} {:?}", worst.whole.weights);
    assert!(sum.whole.weights.is_none());
    assert!((worst.whole.objective - greatest(&of_worst)).abs() < 1e-7);
    assert!(greatest(&of_worst) < 0.99 * greatest(&of_sum));
    assert!(of_worst.iter().sum::<f64>() > of_sum.iter().sum::<f64>());
    // Weights are a mean over the robots that are worst.
    let weights = worst.whole.weights.clone().expect("weights");
    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-6);
    for (weight, objective) in weights.iter().zip(&of_worst) {
        let is_worst = (objective / greatest(&of_worst) - 1.0).abs() < 1e-6;
        assert!(
            *weight > -1e-9 && (is_worst || *weight < 1e-5),
            "{weights:?} {of_worst:?}"
        );
    }
    assert!(
        weights.iter().filter(|w| **w > 0.05).count() >= 2,
        "{weights:?}"
    );
    // The least sum with these weights is that optimum.
    let weights = [0, 1, 2].map(|k| weights[k].max(1e-9));
    let again = together_by(list(weights), &INPUTS, Combined::Sum);
    let value = again.whole.objective;
    assert!(
        (value / worst.whole.objective - 1.0).abs() < 1e-5,
        "{value}"
    );
}

#[test]
fn the_greatest_objective_of_one_motion_is_its_own() {
    let system = stiffer(1.0);
    let one = alone(&system, &steered(&system)).solution.objective;
    let list = vec![motion("robot", &system, steered(&system))];
    let found = together_by(list, &[], Combined::Worst);
    assert_eq!(objectives(&found)[0].to_bits(), one.to_bits());
}

/// The least effort ∫a² of one history that moves 1 kg by 1 m in 1 s from rest to rest, and leaves light oscillators on it at rest, one on each
/// of as many robots: by the Gramian of all, of which the effort is second order in the interval.
#[test]
fn one_history_leaves_each_sampled_robot_at_rest_with_the_least_effort_of_the_closed_form() {
    let cases: [(&[f64], f64); 3] = [
        (&[2.0], 14.150_639_28),
        (&[1.6, 2.4], 12.708_192_71),
        (&[1.6, 2.0, 2.4], 46.891_754_45),
    ];
    for combined in [Combined::Sum, Combined::Worst] {
        for (frequencies, exact) in cases {
            let efforts = [120, 240].map(|intervals| {
                let robots = frequencies.iter().enumerate().map(|(k, frequency)| {
                    let (system, control) = cart(intervals, &[*frequency], "reduced");
                    motion(&format!("robot{k}"), &system, control)
                });
                let found = together_by(robots.collect(), &["motor"], combined);
                let each = objectives(&found);
                assert!(each.iter().all(|own| (own / each[0] - 1.0).abs() < 1e-9));
                each[0]
            });
            let limit = efforts[1] + (efforts[1] - efforts[0]) / 3.0;
            println!("{combined:?} {frequencies:?}: {efforts:?} {limit} {exact}");
            assert!((efforts[0] - exact).abs() > 1e-4, "{efforts:?}");
            assert!((limit / exact - 1.0).abs() < 1e-4, "{limit} {exact}");
        }
    }
}

/// Three stiffnesses come to rest at one angle by one history, and are held there by three pairs of voltages.
#[test]
fn inputs_that_part_after_the_end_are_told() {
    let found = |changes: &[&str]| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/robust_pair.json");
        let set = ["control.intervals=30"].iter().chain(changes);
        let set: Vec<String> = set.map(|one| one.to_string()).collect();
        let Task::Motions(motions) = read_problem(&path, &set).unwrap().task else {
            panic!("several motions");
        };
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        solve_motions(&motions.task(), SolveRequest::default(), go_on).unwrap()
    };
    let held = found(&[
        r#"control.goal={"joint_angles":{"joint1":0.05},"hold":"find"}"#,
        r#"control.objective={"effort":1}"#,
    ]);
    let voltages = held
        .list
        .iter()
        .map(|one| one.optimum.motion.hold.clone().unwrap());
    let voltages: Vec<Vec<f64>> = voltages.collect();
    assert!(
        (voltages[0][1] - voltages[2][1]).abs() > 50.0,
        "{voltages:?}"
    );
    let told = |result: &proboscis::tasks::MotionsResult| -> String {
        result.remarks.lines().collect::<Vec<_>>().join("\n")
    };
    let words = told(&held);
    assert!(
        words.contains("inputs of muscle") && words.contains("after it"),
        "{words}"
    );
    let free = found(&[]);
    assert!(!told(&free).contains("after it"), "{}", told(&free));
}
