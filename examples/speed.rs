//! Throwaway timing.
use proboscis::control::problem::*;
use proboscis::control::{Boundary, Transcription, guess};
use proboscis::dynamics::{Start, Stepper};
use proboscis::nlp::Nlp;
use std::time::Instant;
#[path = "../tests/common/mod.rs"]
mod common;
fn main() {
    let n = 40;
    let mut hold = vec![0.0; 12];
    for m in [1, 5, 9] {
        hold[m] = 1700.0;
    }
    for m in [2, 6, 10] {
        hold[m] = 1600.0;
    }
    let coordinates = if std::env::args().any(|a| a == "redundant") {
        proboscis::model::Coordinates::Redundant
    } else {
        proboscis::model::Coordinates::Reduced
    };
    let control = Control {
        duration: Duration::Given(600.0),
        intervals: n,
        start: State::RestAtVoltages(vec![0.0; 12]),
        goal: State::RestAtVoltages(hold.clone()),
        voltage_bounds: [0.0, 3000.0],
        objective: Objective {
            effort: 1.0,
            rate: 0.0,
            duration: 0.0,
        },
        limits: vec![],
        coordinates: Some(coordinates),
        guess: Guess::Interpolate,
        solver: Solver {
            tolerance: 1e-10,
            max_iterations: 500,
            ipopt: Default::default(),
        },
    };
    let (model, boundary) = Boundary::resolve(&common::trunk(6), &control, 15.0).unwrap();
    let initial = guess(&model, &boundary, &control, 15.0, None);
    let mut p = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let mut x = p.start(&initial).x;
    let y: Vec<f64> = (0..p.constraints().lower.len())
        .map(|i| (i as f64).sin())
        .collect();
    let mut jac = vec![0.0; p.jacobian_structure().rows.len()];
    let mut hes = vec![0.0; p.hessian_structure().rows.len()];
    let mut g = y.clone();
    let reps: usize = std::env::args()
        .filter_map(|a| a.parse().ok())
        .next()
        .unwrap_or(500);
    for round in 0..3 {
        let c = Instant::now();
        for r in 0..reps {
            x[3] += 1e-9 * (r % 2) as f64;
            p.constraint(&x, &mut g);
        }
        let tc = c.elapsed();
        let c = Instant::now();
        for _ in 0..reps {
            p.jacobian(&x, &mut jac);
        }
        let tj = c.elapsed();
        let c = Instant::now();
        for _ in 0..reps {
            p.hessian(&x, 1.0, &y, &mut hes);
        }
        let th = c.elapsed();
        let per = |t: std::time::Duration| t.as_secs_f64() * 1e6 / (reps * n) as f64;
        println!(
            "round {round}: constraint {:.2} jacobian {:.2} hessian {:.2} us/interval; nnz {} {}",
            per(tc),
            per(tj),
            per(th),
            jac.len(),
            hes.len()
        );
    }
    let s: f64 = hes.iter().map(|v| v.abs()).sum();
    let t: f64 = jac.iter().map(|v| v.abs()).sum();
    println!("sums {s:.12e} {t:.12e}");
    for _ in 0..3 {
        let solution = proboscis::ipopt::solve(
            &mut p,
            &proboscis::ipopt::Point {
                x: x.clone(),
                costates: None,
            },
            &proboscis::ipopt::Options {
                tolerance: 1e-8,
                ..Default::default()
            },
            &mut |_| std::ops::ControlFlow::Continue(()),
        )
        .unwrap();
        let t = solution.seconds;
        println!(
            "{:?} {} it, solver {:.4}, callbacks {:.4}, ratio {:.3} {:?}",
            solution.status,
            solution.iterations.len(),
            t.solver,
            t.total - t.solver,
            (t.total - t.solver) / t.solver,
            solution.evaluations
        );
    }
    let start = Start::at_rest(&model, model.coordinates_at(&[0.0; 6]));
    let scalars = model.scalars(&hold);
    let mut stepper = Stepper::new(&model, &start.z, &start.momentum);
    let steps = 2000;
    let c = Instant::now();
    for _ in 0..steps {
        stepper.step(10.0, &scalars).unwrap();
    }
    println!(
        "step {:.1} us, {:?}",
        c.elapsed().as_secs_f64() * 1e6 / steps as f64,
        stepper.report()
    );
}
