//! Motions of spherical joints and free bodies: through every orientation, against another program, with their momenta.

use crate::common::systems::satellite;
use crate::common::{
    at_reference, bare, body, column, columns, distance, joint, motion, placed, richardson,
    with_velocities,
};
use nalgebra::{Rotation3, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{DiscreteTrajectory, Integrator, Solving, observations, simulate_by};
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Model};
use std::ops::ControlFlow;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

/// Motions of a system from the same velocities of its bodies in both coordinates, and their largest difference.
fn both(
    system: &System,
    velocities: &[[Vector3<f64>; 2]],
    integrator: Integrator,
    h: f64,
    steps: usize,
    voltages: &[f64],
) -> ([(Model, DiscreteTrajectory); 2], f64) {
    let runs = BOTH.map(|coordinates| {
        let model = Model::new(system.clone(), Some(coordinates), h, &[]).unwrap();
        let start = with_velocities(&model, at_reference(&model), velocities);
        let solving = Solving {
            integrator,
            ..Solving::default()
        };
        let scalars = model.scalars(voltages);
        let (discrete, failure) = simulate_by(
            solving,
            &model,
            &start,
            h,
            steps,
            |_, _| scalars.clone(),
            |_| ControlFlow::Continue(()),
        );
        assert_eq!(failure, None);
        assert_eq!(discrete.report.halved, 0);
        (model, discrete)
    });
    let [a, b] = [0, 1].map(|i| Trajectory::from_discrete(&runs[i].0, &runs[i].1));
    let apart = distance(&a, &b, runs[0].0.length());
    (runs, apart)
}

#[test]
fn a_free_body_tumbles_through_every_orientation() {
    let directors = *Rotation3::from_euler_angles(0.3, -0.7, 1.1).matrix();
    let centre = Vector3::new(3.0, -1.0, 2.0);
    let stone = body("stone", 2.0, [1.0, 2.0, 2.5], centre, directors);
    let scene = bare(vec![stone], Vec::new(), None);
    // Nearly about the axis of the middle moment of inertia: the body turns over again and again.
    let omega = directors * Vector3::new(0.02, 3.0, 0.01);
    let velocity = Vector3::new(0.4, 0.1, -0.3);
    let steps = 2000;
    let (runs, apart) = both(
        &scene,
        &[[velocity, omega]],
        Integrator::Midpoint,
        0.05,
        steps,
        &[],
    );
    // Errors of the start grow along the unstable axis.
    println!("tumbling: {apart:e}");
    assert!(apart < 1e-6, "{apart:e}");
    let (model, discrete) = &runs[0];
    let seen = observations(model, discrete);
    let linear = columns(&seen, "linear_momentum");
    for p in &linear {
        assert!((p - velocity * 2.0).amax() < 1e-11, "{p}");
    }
    let exact = directors * Vector3::new(0.02 * 1.0, 3.0 * 2.0, 0.01 * 2.5);
    let track = Trajectory::from_discrete(model, discrete);
    let angular = columns(&seen, "angular_momentum");
    let about_centre = angular[0] - centre.cross(&(velocity * 2.0));
    assert!((about_centre - exact).norm() < 1e-12, "{about_centre}");
    for l in &angular {
        assert!((l - angular[0]).norm() < 1e-9, "{}", l - angular[0]);
    }
    let energy = column(&seen, "total_energy");
    let inertial = 0.5 * (0.02_f64.powi(2) + 2.0 * 9.0 + 2.5 * 0.01_f64.powi(2));
    let expected = inertial + velocity.norm_squared();
    assert!((energy[0] - expected).abs() < 1e-12 * expected);
    // At both ends the kinetic energy is that of the momentum there, elsewhere that of the neighbouring intervals.
    let spread = energy[1..steps]
        .iter()
        .map(|e| (e - energy[1]).abs() / expected);
    let spread = spread.fold(0.0, f64::max);
    println!("energy moves by {spread:e}");
    assert!(spread < 1e-3);
    // Its second axis pointed along L and against it, and it turned far more than once.
    let along = |k: usize| track.poses[k][0].directors.column(1).dot(&exact) / exact.norm();
    let list: Vec<f64> = (0..=steps).map(along).collect();
    assert!(list.iter().any(|&c| c > 0.99) && list.iter().any(|&c| c < -0.99));
    let turned: f64 = (0..steps)
        .map(|k| {
            track.poses[k][0]
                .directors
                .tr_mul(&track.poses[k + 1][0].directors)
        })
        .map(|r| Rotation3::from_matrix_unchecked(r).angle())
        .sum();
    assert!(turned > 30.0 * std::f64::consts::TAU, "{turned}");
}

#[test]
fn a_heavy_top_nutates_as_another_program_says() {
    // scipy.integrate.solve_ivp(DOP853, rtol 1e-13, atol 1e-14) of Euler's equations for the rotation matrix and the angular
    // velocity of the body: J = (3000, 3000, 2000) g mm², 20 g at 30 mm from the tip, released at 0.5 rad from the vertical
    // with a spin of 0.25 rad/ms. Its axis every 100 ms; it falls below the horizontal and rises again, to its cusp.
    let exact = [
        (100.0, [0.4691810096, -0.7482609037, 0.4690147121]),
        (200.0, [0.5814884841, 0.8135514643, 0.0022710950]),
        (400.0, [-0.4670707575, 0.4080294781, 0.7844468449]),
    ];
    let tilt = *Rotation3::from_axis_angle(&Vector3::x_axis(), 0.5).matrix();
    let axis: Vector3<f64> = tilt.column(2).into();
    let top = body("top", 20.0, [3e3, 3e3, 2e3], axis * 30.0, tilt);
    let foot = joint("foot", JointKind::Spherical, None, 0, Vector3::zeros());
    let scene = bare(vec![top], vec![foot], Some(Vector3::z() * -9.81e-3));
    for (time, exact) in exact {
        let places = [1, 2, 4, 8].map(|fine| {
            let steps = (time / 2.0) as usize * fine;
            let h = time / steps as f64;
            let model = Model::new(scene.clone(), None, h, &[]).unwrap();
            assert_eq!(model.coordinates, Coordinates::Reduced);
            let start = with_velocities(
                &model,
                at_reference(&model),
                &[[Vector3::zeros(), axis * 0.25]],
            );
            let discrete = motion(&model, &start, h, steps, &[]);
            model.poses(&placed(&model, &discrete.z[steps]))[0].centre / 30.0
        });
        let limit = Vector3::from_fn(|i, _| richardson(&places.map(|x| x[i])));
        let errors = places.map(|x| (x - Vector3::from(exact)).norm());
        let error = (limit - Vector3::from(exact)).amax();
        println!("top at {time}: {errors:?}, limit {error:e}");
        assert!(errors[0] > 1e-4);
        for pair in errors.windows(2) {
            assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.1, "{errors:?}");
        }
        assert!(error < 2e-7, "{error:e}");
    }
}

#[test]
fn a_satellite_with_a_trunk_keeps_its_momenta() {
    let system = satellite();
    let turning = [[
        Vector3::new(0.02, 0.0, 0.01),
        Vector3::new(0.004, 0.002, -0.006),
    ]];
    // All bodies turn about the first one.
    let centre = system.bodies[0].centre;
    let velocities: Vec<[Vector3<f64>; 2]> = system
        .bodies
        .iter()
        .map(|b| {
            let [velocity, omega] = turning[0];
            [velocity + omega.cross(&(b.centre - centre)), omega]
        })
        .collect();
    let voltages = [2000.0, 300.0, 0.0, 1500.0];
    for integrator in [
        Integrator::Midpoint,
        Integrator::Galerkin { degree: 2 },
        Integrator::ImplicitEuler,
        Integrator::GeneralisedAlpha {
            spectral_radius: 0.8,
        },
    ] {
        let is_midpoint = integrator == Integrator::Midpoint;
        let steps = if is_midpoint { 400 } else { 100 };
        let (runs, apart) = both(&system, &velocities, integrator, 4.0, steps, &voltages);
        println!("satellite by {}: {apart:e}", integrator.name());
        assert!(apart < 1e-8, "{apart:e}");
        if !is_midpoint {
            continue;
        }
        let seen = runs
            .each_ref()
            .map(|(model, discrete)| observations(model, discrete));
        for name in ["linear_momentum", "angular_momentum"] {
            let list = columns(&seen[0], name);
            let drift = list
                .iter()
                .map(|v| (v - list[0]).norm())
                .fold(0.0, f64::max);
            println!("  {name} {:e} moves by {drift:e}", list[0].norm());
            assert!(list[0].norm() > 1.0 && drift < 1e-10 * list[0].norm().max(1e3));
        }
        for (x, y) in seen[0].columns.iter().zip(&seen[1].columns) {
            assert_eq!(x.name, y.name);
            let size = x.values.iter().fold(1e-3_f64, |m, v| m.max(v.abs()));
            let apart = x.values.iter().zip(&y.values).map(|(a, b)| (a - b).abs());
            let apart = apart.fold(0.0, f64::max);
            assert!(
                x.name == "constraint_violation" || apart < 1e-7 * size,
                "{}: {apart:e} of {size:e}",
                x.name
            );
        }
        let bend = column(&seen[0], "joint2");
        assert!(bend.iter().any(|a| a.abs() > 0.1));
    }
}
