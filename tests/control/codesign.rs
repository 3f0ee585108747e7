//! The trunk of `problems/codesign_trunk.json`: one design for three goals costs less than that of the scene with the same mass, is verified, and meets the
//! conditions of Karush, Kuhn and Tucker, summed over the programs of the motions by hand.

use crate::optimality::{guessed_step, stationarity as slopes};
use proboscis::control::problem::Task;
use proboscis::control::{BoundaryConditions, Column, Motions, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::model::with_parameters;
use proboscis::nlp::Nlp;
use proboscis::workflow::{Iterate, Optimum, SolveRequest, Together, optimise_together};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

fn motions(changes: &[&str]) -> Motions {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/codesign_trunk.json");
    // Few intervals: the same derivatives and conditions in less time.
    let coarse = ["control.intervals=8"];
    let changes = coarse.iter().chain(changes).map(|one| one.to_string());
    let changes: Vec<String> = changes.collect();
    match read_problem(&path, &changes).expect("a kept problem").task {
        Task::Motions(motions) => *motions,
        other => panic!("{other:?}"),
    }
}

fn solved(motions: &Motions) -> Together {
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = optimise_together(&motions.task(), SolveRequest::default(), go_on);
    let found = found.expect("a problem that is right");
    assert!(found.optima.iter().all(Optimum::is_solved));
    found
}

/// Greatest entries of ∇f + ∇gᵀy − z_L + z_U by the variables of single motions, and by shared constants; and the greatest summand of the latter.
fn stationarity(motions: &Motions, found: &Together) -> [f64; 3] {
    let controls = motions.task().with_limits_once();
    let mut own: f64 = 0.0;
    let mut shared: BTreeMap<String, f64> = BTreeMap::new();
    let mut summand: f64 = 0.0;
    let each = motions.list.iter().zip(&controls);
    for ((motion, control), optimum) in each.zip(&found.optima) {
        let h = guessed_step(control);
        let (model, boundary) = BoundaryConditions::resolve(&motion.system, control, h).unwrap();
        let initial = guess(&model, &boundary, control, h, None);
        let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
        let slopes = slopes(&mut program, &optimum.solution);
        for (i, rest) in slopes.into_iter().enumerate() {
            match program.unknowns().columns[i] {
                Column::Parameter { .. } => {
                    summand = summand.max(rest.abs());
                    *shared.entry(program.variable_name(i)).or_default() += rest;
                }
                _ => own = own.max(rest.abs()),
            }
        }
    }
    assert_eq!(shared.len(), 8, "{shared:?}");
    let shared = shared.values().fold(0.0_f64, |a, b| a.max(b.abs()));
    [own, shared, summand]
}

#[test]
fn one_design_for_three_goals_costs_less_with_the_same_mass() {
    let (free, given) = (motions(&[]), motions(&["control.free={}"]));
    let (after, before) = (solved(&free), solved(&given));
    let [own, shared, summand] = stationarity(&free, &after);
    println!("stationarity {own:e}, {shared:e} of summands {summand:e}");
    assert!(summand > 1e-2, "motions ask for other designs: {summand}");
    assert!(own < 1e-5 && shared < 1e-5, "{own:e} {shared:e}");
    let (least, most) = (after.whole.objective, before.whole.objective);
    println!("objective {most} before, {least} after");
    assert!(least < 0.8 * most);
    for (one, other) in after.optima.iter().zip(&before.optima) {
        assert!(one.solution.objective < other.solution.objective);
        let tested = one.resimulation.as_ref().expect("a simulation");
        assert!(tested.cause.is_none());
    }
    // Twelve muscles of 4 g: the silicone of the given trunk, all of which the design uses.
    let parameters = &free.list[0].control.parameters;
    let values = after.optima[0]
        .motion
        .parameters
        .iter()
        .map(|one| one.value);
    let values: Vec<f64> = values.collect();
    let designed = with_parameters(&free.list[0].system, parameters, &values);
    let mass = |system: &proboscis::System| -> f64 {
        let of = |muscle: &proboscis::model::system::Muscle| {
            let [a, b] = muscle.cross_section;
            muscle.material.density.unwrap() * a * b * (muscle.to.at - muscle.from.at).norm()
        };
        system.muscles.iter().map(of).sum()
    };
    assert!((mass(&given.list[0].system) - 48.0).abs() < 1e-9);
    assert!((mass(&designed) - 48.0).abs() < 1e-4, "{}", mass(&designed));
}
