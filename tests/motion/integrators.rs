//! Methods beside the midpoint rule: their orders, their invariants, and one limit for all of them.

use crate::common::{at_reference, bare, body, columns, joint, placed, spin, trunk};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{
    DiscreteTrajectory, Integrator, Solving, Start, observations, simulate_by,
};
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Model, Role};
use std::ops::ControlFlow;

const ALPHA: Integrator = Integrator::GeneralisedAlpha {
    spectral_radius: 0.8,
};

fn galerkin(degree: usize) -> Integrator {
    Integrator::Galerkin { degree }
}

fn run(
    integrator: Integrator,
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    scalars: &[f64],
) -> DiscreteTrajectory {
    let solving = Solving {
        integrator,
        ..Solving::default()
    };
    let held = |_: f64, _: f64| scalars.to_vec();
    let (discrete, failure) = simulate_by(solving, model, start, h, steps, held, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    assert_eq!(discrete.report.halved, 0);
    discrete
}

/// A point mass on a rod, from (−1, 0) at rest, in m, kg and s; all laws are free of units.
fn pendulum() -> System {
    let mass = body("mass", 1.0, [0.0; 3], -Vector3::x(), Matrix3::identity());
    let axis = Vector3::z();
    let pivot = joint(
        "pivot",
        JointKind::Revolute { axis },
        None,
        0,
        Vector3::zeros(),
    );
    bare(vec![mass], vec![pivot], Some(Vector3::new(0.0, -9.81, 0.0)))
}

/// Place of the pendulum at a time: φ″ = 9.81 cos φ from φ = 0, φ measured from −x to −y, by Runge and Kutta's method.
fn exact_pendulum(time: f64) -> Vector3<f64> {
    let steps = 100_000;
    let h = time / f64::from(steps);
    let slope = |[phi, rate]: [f64; 2]| [rate, 9.81 * phi.cos()];
    let mut y = [0.0, 0.0];
    for _ in 0..steps {
        let at = |k: [f64; 2], s: f64| [y[0] + s * k[0], y[1] + s * k[1]];
        let a = slope(y);
        let b = slope(at(a, 0.5 * h));
        let c = slope(at(b, 0.5 * h));
        let d = slope(at(c, h));
        for i in 0..2 {
            y[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
    }
    Vector3::new(-y[0].cos(), -y[0].sin(), 0.0)
}

/// Error of the centre of the only body at the end of a time in n steps.
fn error_of_pendulum(
    integrator: Integrator,
    coordinates: Coordinates,
    n: usize,
    exact: &Vector3<f64>,
) -> f64 {
    let h = 1.0 / n as f64;
    let model = Model::new(pendulum(), Some(coordinates), h, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let discrete = run(integrator, &model, &start, h, n, &[]);
    (model.poses(&placed(&model, &discrete.z[n]))[0].centre - exact).norm()
}

#[test]
fn galerkin_integrators_of_a_pendulum_have_twice_their_degree_as_order() {
    let exact = exact_pendulum(1.0);
    assert!((exact - Vector3::new(0.9862917511, -0.1650108531, 0.0)).amax() < 1e-10);
    // Errors with 20 steps, of an independent code.
    for (degree, expected) in [(1, 7.317e-3), (2, 6.219e-6), (3, 6.670e-9)] {
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let of = |n| error_of_pendulum(galerkin(degree), coordinates, n, &exact);
            let [coarse, error, fine] = [10, 20, 40].map(of);
            let slopes = [(coarse / error).log2(), (error / fine).log2()];
            println!("{degree} {coordinates:?}: {error:e}, {slopes:?}");
            assert!(
                (error / expected - 1.0).abs() < 1e-3,
                "{error:e} against {expected:e}"
            );
            for slope in slopes {
                assert!((slope - 2.0 * degree as f64).abs() < 0.15, "{slope}");
            }
        }
    }
}

#[test]
fn engineering_methods_have_their_orders_on_a_pendulum() {
    let exact = exact_pendulum(1.0);
    for (integrator, order) in [(Integrator::ImplicitEuler, 1.0), (ALPHA, 2.0)] {
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let of = |n| error_of_pendulum(integrator, coordinates, n, &exact);
            let errors = [400, 800, 1600].map(of);
            assert!(errors[2] > 1e-6);
            let slopes = [0, 1].map(|i| f64::log2(errors[i] / errors[i + 1]));
            println!("{}: {errors:?}, {slopes:?}", integrator.name());
            for slope in slopes {
                assert!((slope - order).abs() < 0.1, "{slope}");
            }
        }
    }
}

/// Tip of a driven trunk with viscosity and dampers after 100 ms.
fn tip(integrator: Integrator, coordinates: Coordinates, n: usize) -> Vector3<f64> {
    let mut scene = trunk(2);
    assert!(scene.muscles.iter().all(|m| m.material.viscosity.is_some()));
    for joint in &mut scene.joints {
        joint.damping = Some(2.0);
    }
    let h = 100.0 / n as f64;
    let model = Model::new(scene, Some(coordinates), h, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let scalars = model.scalars(&[2000.0, 0.0, 0.0, 1500.0]);
    let discrete = run(integrator, &model, &start, h, n, &scalars);
    columns(&observations(&model, &discrete), "tip")[n]
}

#[test]
fn all_methods_have_one_limit_on_a_damped_trunk() {
    let limit = tip(galerkin(4), Coordinates::Reduced, 160);
    assert!((limit - Vector3::new(0.0, 100.0, 0.0)).norm() > 5.0);
    let cases = [
        (Integrator::Midpoint, 2.0, [40, 80]),
        (Integrator::ImplicitEuler, 1.0, [400, 800]),
        (ALPHA, 2.0, [80, 160]),
        (galerkin(1), 2.0, [40, 80]),
        (galerkin(2), 4.0, [20, 40]),
        (galerkin(3), 6.0, [10, 20]),
    ];
    for (integrator, order, steps) in cases {
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let errors = steps.map(|n| (tip(integrator, coordinates, n) - limit).norm());
            let slope = f64::log2(errors[0] / errors[1]);
            println!("{} {coordinates:?}: {errors:?}, {slope}", integrator.name());
            assert!(
                (slope - order).abs() < 0.25,
                "{}: {slope}",
                integrator.name()
            );
        }
    }
}

#[test]
fn newton_meets_exact_tangents() {
    // Quadratic convergence: a step of a moving trunk with viscosity takes few iterations.
    for integrator in [galerkin(2), galerkin(3), ALPHA, Integrator::ImplicitEuler] {
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let model = Model::new(trunk(3), Some(coordinates), 10.0, &[]).unwrap();
            let start = Start::at_rest(&model, at_reference(&model));
            let scalars = model.scalars(&[2000.0, 0.0, 0.0, 1500.0, 900.0, 0.0]);
            let discrete = run(integrator, &model, &start, 10.0, 20, &scalars);
            let mean = discrete.report.iterations as f64 / 20.0;
            println!(
                "{} {coordinates:?}: {mean} iterations a step",
                integrator.name()
            );
            assert!(mean > 1.5 && mean <= 4.2, "{}: {mean}", integrator.name());
        }
    }
}

#[test]
fn variational_methods_conserve_the_angular_momentum_of_a_free_body() {
    let free = body(
        "stone",
        2.0,
        [1.0, 2.0, 2.5],
        Vector3::new(0.3, -0.2, 0.5),
        Matrix3::identity(),
    );
    let scene = bare(vec![free], Vec::new(), None);
    let h = 0.05;
    let model = Model::new(scene, Some(Coordinates::Redundant), h, &[]).unwrap();
    let pose = model.reference[0];
    let (omega, velocity) = (Vector3::new(0.4, 1.1, -0.7), Vector3::new(0.1, 0.0, 0.2));
    let start = Start::with_rates(&model, at_reference(&model), &spin(&pose, velocity, omega));
    let climb = |integrator| {
        let discrete = run(integrator, &model, &start, h, 400, &[]);
        let seen = observations(&model, &discrete);
        let angular = columns(&seen, "angular_momentum");
        let turned = discrete.z[400][3] - discrete.z[0][3];
        assert!(angular[0].norm() > 1.0 && turned.abs() > 1e-3);
        (angular[400] - angular[0]).norm()
    };
    for degree in [2, 3] {
        let lost = climb(galerkin(degree));
        println!("galerkin {degree}: {lost:e}");
        assert!(lost < 1e-10, "{lost:e}");
    }
    // The measure sees what is lost.
    let lost = climb(Integrator::ImplicitEuler);
    assert!(lost > 1e-3, "{lost:e}");
}

#[test]
fn variational_methods_keep_energy_and_engineering_methods_lose_it() {
    let mut scene = trunk(2);
    for muscle in &mut scene.muscles {
        muscle.material.viscosity = None;
    }
    let (h, steps) = (2.0, 2500);
    let model = Model::new(scene, None, h, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let scalars = model.scalars(&[1500.0, 0.0, 0.0, 1200.0]);
    let energy = |integrator| {
        let discrete = run(integrator, &model, &start, h, steps, &scalars);
        let seen = observations(&model, &discrete);
        let kinetic = crate::common::column(&seen, "kinetic_energy");
        let scale = kinetic.iter().fold(0.0_f64, |m, e| m.max(*e));
        assert!(scale > 1e-3);
        let total = crate::common::column(&seen, "total_energy");
        let errors: Vec<f64> = total.iter().map(|e| (e - total[0]) / scale).collect();
        let worst = |part: &[f64]| part.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        (
            worst(&errors[..steps / 4]),
            worst(&errors[3 * steps / 4..]),
            errors[steps],
        )
    };
    for (degree, bound) in [(2, 2e-3), (3, 2e-5)] {
        let (early, late, _) = energy(galerkin(degree));
        println!("galerkin {degree}: {early:e}, {late:e}");
        assert!(
            early > 1e-12 && late < bound && late < 2.0 * early,
            "{early:e} {late:e}"
        );
    }
    let (_, _, euler) = energy(Integrator::ImplicitEuler);
    let (_, _, alpha) = energy(ALPHA);
    println!("euler {euler}, alpha {alpha}");
    assert!(euler < -0.5 && alpha < -1e-3);
}

#[test]
fn elastic_blocks_with_potentials_have_the_same_limit() {
    let time = 2.0;
    let end = |integrator, n: usize| {
        let h = time / n as f64;
        let model = Model::new(
            crate::common::solid::system(vec![crate::common::solid::clamped(Some(0.05))]),
            None,
            h,
            &[],
        )
        .unwrap();
        assert!(model.variables.count(Role::Potential) > 0);
        let start = Start::at_rest(&model, model.coordinates_at(&[]));
        let discrete = run(
            integrator,
            &model,
            &start,
            h,
            n,
            &[0.5 * crate::common::solid::VOLTAGE],
        );
        let count = model.coordinate_count();
        discrete.z[n][..count].to_vec()
    };
    let distance = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
    };
    let limit = end(galerkin(3), 80);
    let rest = end(galerkin(3), 1);
    assert!(distance(&limit, &rest) > 1e-3);
    for (integrator, order, steps) in [
        (Integrator::Midpoint, 2.0, [40, 80]),
        (galerkin(2), 4.0, [20, 40]),
        (ALPHA, 2.0, [40, 80]),
    ] {
        let errors = steps.map(|n| distance(&end(integrator, n), &limit));
        let slope = f64::log2(errors[0] / errors[1]);
        println!("{}: {errors:?}, {slope}", integrator.name());
        assert!(
            (slope - order).abs() < 0.5,
            "{}: {slope}",
            integrator.name()
        );
    }
}
