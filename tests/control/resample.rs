//! A solution carried to a finer grid is close to the solution there, costates and all, and exact on its own grid.

use crate::common::cases::{joints, rest_to_rest};
use crate::common::trunk;
use proboscis::control::problem::{Control, Duration, Limit, Objective, Task};
use proboscis::control::{
    BoundaryConditions, Column, Costates, InitialGuess, Row, Transcription, guess,
};
use proboscis::files::read_problem;
use proboscis::model::Coordinates;
use proboscis::model::{FieldPlace, What};
use proboscis::workflow::{Iterate, Optimum, SolveLimits, optimise};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// The smoothest voltages of a trunk of two segments, with limits that hold it back and a duration as long as allowed.
fn problem(coordinates: Coordinates, intervals: usize) -> Control {
    Control {
        coordinates: Some(coordinates),
        objective: Objective {
            effort: 1.0,
            rate: 1.0,
            ..Objective::default()
        },
        duration: Duration::Free {
            min: 80.0,
            max: 120.0,
            guess: 110.0,
        },
        voltage_bounds: [0.0, 1350.0],
        limits: vec![Limit::below(What::Field(FieldPlace::Muscle(2)), 2.6e4)],
        // Without known voltages after the goal there is no last jump, which a finer grid makes dearer.
        goal: joints(&[(0, 0.15), (1, 0.13)]),
        ..rest_to_rest(2, intervals, 110.0)
    }
}

fn solve(control: &Control) -> Optimum {
    let found = optimise(
        &trunk(2),
        control,
        None,
        SolveLimits::default(),
        &mut |_| ControlFlow::Continue(()),
    );
    let found = found.unwrap();
    assert!(
        found.solution.status.is_solved(),
        "{:?}",
        found.solution.status
    );
    found
}

/// The start that an earlier optimum gives, with the layout of the program.
fn carried(control: &Control, from: &Optimum) -> (InitialGuess, Vec<Column>, Vec<Row>, usize) {
    let h = 110.0 / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&trunk(2), control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, Some(&from.motion));
    let program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let unknowns = program.unknowns();
    let (variables, rows) = (unknowns.columns.clone(), unknowns.rows.clone());
    (initial, variables, rows, model.coordinate_count())
}

/// Lists by kind.
type Kinds = BTreeMap<&'static str, Vec<f64>>;

fn kinds(costates: &Costates, variables: &[Column], rows: &[Row], count: usize) -> Kinds {
    let mut out = Kinds::new();
    for (row, &value) in rows.iter().zip(&costates.rows) {
        let kind = match row {
            Row::Instant { i, .. } if *i < count => "momentum balance",
            Row::Instant { .. } => "constraint",
            Row::Interval { .. } => "Gauss's law",
            Row::Time { .. } => "function of time",
            Row::Limit { .. } => "limit",
        };
        out.entry(kind).or_default().push(value);
    }
    for (i, variable) in variables.iter().enumerate() {
        let kind = match variable {
            Column::Instant { .. } => "bound of a coordinate",
            Column::Interval { .. } => "bound of a voltage",
            Column::Parameter { .. } => "bound of a parameter",
            Column::Horizon => "bound of the duration",
        };
        let both = [costates.lower[i], costates.upper[i]];
        out.entry(kind).or_default().extend(both);
    }
    out
}

fn norm(list: impl Iterator<Item = f64>) -> f64 {
    list.map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn what_is_carried_to_a_finer_grid_is_close_to_the_solution_there() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let coarse = solve(&problem(coordinates, 25));
        let control = problem(coordinates, 50);
        let fine = solve(&control);
        let (initial, variables, rows, count) = carried(&control, &coarse);
        assert_eq!(initial.discrete.intervals(), 50);
        assert!((initial.h - 2.4).abs() < 1e-3, "{}", initial.h);

        let costates = initial.costates.expect("the coarse optimum has costates");
        let known = fine.motion.costates.as_ref().unwrap();
        let [a, b] = [&costates, known].map(|c| kinds(c, &variables, &rows, count));
        let mut seen = Vec::new();
        for (kind, fine) in &b {
            let size = norm(fine.iter().copied());
            let apart = norm(fine.iter().zip(&a[kind]).map(|(a, b)| a - b)) / size;
            println!("{coordinates:?}, {kind}: {size:.2e}, apart by {apart:.3}");
            if size > 1e-4 {
                seen.push(*kind);
                assert!(apart < 0.35, "{coordinates:?}, {kind}: {apart}");
            }
        }
        let everywhere = [
            "momentum balance",
            "limit",
            "bound of a voltage",
            "bound of the duration",
        ];
        let of_directors = (coordinates == Coordinates::Redundant).then_some("constraint");
        let expected = everywhere.into_iter().chain(of_directors);
        for kind in expected {
            assert!(seen.contains(&kind), "{coordinates:?}: {kind} is nothing");
        }

        // Coordinates and impulses of constraints, instant by instant; voltages in the intervals.
        for (range, name) in [
            (0..count, "coordinates"),
            (count..initial.discrete.z[0].len(), "impulses"),
        ] {
            if range.is_empty() {
                continue;
            }
            let inner = |z: &[Vec<f64>]| {
                z[1..50]
                    .iter()
                    .flat_map(|z| z[range.clone()].to_vec())
                    .collect::<Vec<_>>()
            };
            // Both models are made for the same guessed step, so that multipliers have one unit.
            let (new, known) = (inner(&initial.discrete.z), inner(&fine.motion.z));
            let size = norm(known.iter().copied());
            let apart = norm(new.iter().zip(&known).map(|(a, b)| a - b)) / size;
            println!("{coordinates:?}, {name}: {size:.2e}, apart by {apart:.4}");
            assert!(size > 1e-3 && apart < 0.1, "{name}: {apart}");
        }
        let (new, known) = (
            initial.discrete.scalars.concat(),
            fine.motion.voltages.concat(),
        );
        let size = norm(known.iter().copied());
        let apart = norm(new.iter().zip(&known).map(|(a, b)| a - b)) / size;
        assert!(size > 1e3 && apart > 0.0 && apart < 0.05, "{apart}");
    }
}

#[test]
fn on_its_own_grid_a_solution_is_kept_to_the_last_digit() {
    let control = problem(Coordinates::Redundant, 20);
    let solved = solve(&control);
    let (initial, ..) = carried(&control, &solved);
    assert_eq!(initial.discrete.z, solved.motion.z);
    assert_eq!(initial.discrete.scalars, solved.motion.voltages);
    assert_eq!(initial.costates, solved.motion.costates);
    assert!(
        initial
            .costates
            .is_some_and(|c| c.rows.iter().any(|y| y.abs() > 1e-3))
    );
}

#[test]
fn a_coarser_grid_and_one_that_fits_nowhere_are_reached_as_well() {
    let solved = solve(&problem(Coordinates::Reduced, 40));
    for intervals in [20, 33, 57] {
        let control = problem(Coordinates::Reduced, intervals);
        let (initial, ..) = carried(&control, &solved);
        let cold = solve(&control);
        let pairs = initial
            .discrete
            .z
            .concat()
            .into_iter()
            .zip(cold.motion.z.concat());
        let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.05, "{intervals}: {apart}");
        let from = optimise(
            &trunk(2),
            &control,
            Some(&solved.motion),
            SolveLimits::default(),
            &mut |_| ControlFlow::Continue(()),
        );
        let from = from.unwrap();
        let count = |o: &Optimum| o.solution.iterations.len();
        println!(
            "{intervals}: {} iterations, cold {}",
            count(&from),
            count(&cold)
        );
        assert!(count(&from) < count(&cold));
        let (a, b) = (from.solution.objective, cold.solution.objective);
        assert!((a - b).abs() < 1e-6 * b, "{a} and {b}");
    }
}

#[test]
fn voltages_keep_their_mean_and_stay_between_their_neighbours() {
    let solved = solve(&problem(Coordinates::Reduced, 40));
    let old = &solved.motion.voltages;
    for intervals in [20, 33, 57, 80] {
        let (initial, ..) = carried(&problem(Coordinates::Reduced, intervals), &solved);
        let new = &initial.discrete.scalars;
        for s in 0..old[0].len() {
            let mean =
                |rows: &[Vec<f64>]| rows.iter().map(|row| row[s]).sum::<f64>() / rows.len() as f64;
            let (a, b) = (mean(old), mean(new));
            assert!((a - b).abs() < 1e-9 * 1350.0, "{intervals}: {a} and {b}");
            let range = |rows: &[Vec<f64>]| {
                let column = rows.iter().map(|row| row[s]);
                column.fold([f64::MAX, f64::MIN], |[a, b], v| [a.min(v), b.max(v)])
            };
            let ([low, high], [a, b]) = (range(old), range(new));
            assert!(
                a >= low - 1e-9 && b <= high + 1e-9,
                "{intervals}: {a} to {b}"
            );
        }
    }
    let most = old.iter().flatten().fold(0.0, |a: f64, &b| a.max(b));
    assert!(most > 100.0, "{most} V");
}

#[test]
fn least_effort_is_found_from_other_grids_and_durations_sooner_and_as_good() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk_effort.json");
    let solve = |changes: &[&str], from: Option<&Optimum>| {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let loaded = read_problem(&file, &changes).unwrap();
        let Task::Control(control) = loaded.task else {
            panic!("a problem of control")
        };
        let motion = from.map(|optimum| &optimum.motion);
        let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
        let allowed = SolveLimits::default();
        let found = optimise(&loaded.system, &control, motion, allowed, &mut go_on);
        let found = found.unwrap();
        assert!(found.solution.status.is_solved());
        found
    };
    let count = |optimum: &Optimum| optimum.solution.iterations.len() - 1;
    let first = solve(&[], None);
    assert!(count(&solve(&[], Some(&first))) <= 1);
    // Voltages that jump at other instants on each grid.
    for (change, most) in [
        ("control.intervals=20", 27),
        ("control.intervals=80", 24),
        ("control.duration=0.63 s", 22),
    ] {
        let cold = solve(&[change], None);
        let warm = solve(&[change], Some(&first));
        let (a, b) = (cold.solution.objective, warm.solution.objective);
        println!(
            "{change}: {} iterations, cold {}",
            count(&warm),
            count(&cold)
        );
        assert!(
            count(&warm) <= most && count(&warm) <= count(&cold),
            "{change}"
        );
        assert!(b <= a * (1.0 + 1e-6), "{change}: {b} in place of {a}");
    }
}
