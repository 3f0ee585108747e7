//! Conservation of the discrete motion: momenta and constraints to rounding, energy without drift.

use crate::common::{
    at_reference, bare, body, column, columns, joint, motion, placed, spin, trunk,
};
use nalgebra::{Rotation3, Vector3};
use proboscis::dynamics::{Start, Stepper, energies, observations};
use proboscis::model::system::JointKind;
use proboscis::model::{Coordinates, Model};

/// A step adds rounding errors of a few ε of the quantity, with random signs and at worst all of one sign.
fn rounding(steps: usize, size: f64) -> f64 {
    4.0 * f64::EPSILON * steps as f64 * size
}

/// Spread of a list of vectors about its first.
fn spread(list: &[Vector3<f64>]) -> f64 {
    list.iter()
        .map(|v| (v - list[0]).norm())
        .fold(0.0, f64::max)
}

#[test]
fn a_free_body_keeps_its_momenta_while_it_tumbles() {
    let directors = *Rotation3::from_euler_angles(0.3, -0.7, 1.1).matrix();
    let free = body(
        "stone",
        2.0,
        [1.0, 2.0, 2.5],
        Vector3::new(3.0, -1.0, 2.0),
        directors,
    );
    let h = 0.05;
    let scene = bare(vec![free], Vec::new(), None);
    let model = Model::new(scene, Some(Coordinates::Redundant), h, &[]).unwrap();
    // Nearly about the axis of the middle moment of inertia: the body turns over again and again.
    let omega = directors * Vector3::new(0.02, 3.0, 0.01);
    let velocity = Vector3::new(0.4, 0.1, -0.3);
    let rates = spin(&model.reference[0], velocity, omega);
    let start = Start::with_rates(&model, at_reference(&model), &rates);
    let steps = 2000;
    let discrete = motion(&model, &start, h, steps, &[]);

    let seen = observations(&model, &discrete);
    let linear = columns(&seen, "linear_momentum");
    assert!((linear[0] - velocity * 2.0).norm() < 1e-14);
    assert!(
        spread(&linear) < rounding(steps, linear[0].norm()),
        "{}",
        spread(&linear)
    );

    // About the centre: Σ d_I × p_I; about the origin the moment of the linear momentum joins.
    let about_centre: Vec<_> = discrete
        .z
        .iter()
        .zip(&discrete.momenta)
        .map(|(z, p)| {
            let part = |q: &[f64], i: usize| Vector3::new(q[3 * i], q[3 * i + 1], q[3 * i + 2]);
            (1..4)
                .map(|i| part(z, i).cross(&part(p, i)))
                .sum::<Vector3<f64>>()
        })
        .collect();
    let exact = directors * Vector3::new(0.02 * 1.0, 3.0 * 2.0, 0.01 * 2.5);
    assert!((about_centre[0] - exact).norm() < 1e-14 * exact.norm());
    let angular = columns(&seen, "angular_momentum");
    let size = angular.iter().map(Vector3::norm).fold(0.0, f64::max);
    println!(
        "free body: {} {} {}",
        spread(&linear),
        spread(&about_centre),
        spread(&angular)
    );
    assert!(spread(&about_centre) < rounding(steps, exact.norm()));
    // The arm φ of φ × p grows to some hundred lengths, and with it its rounding.
    assert!(spread(&angular) < rounding(steps, size + 100.0 * linear[0].norm()));

    // It did tumble: its second axis pointed along L and against it.
    let along = |z: &Vec<f64>| Vector3::new(z[6], z[7], z[8]).dot(&exact) / exact.norm();
    let turns: Vec<f64> = discrete.z.iter().map(along).collect();
    assert!(turns.iter().any(|&c| c > 0.99) && turns.iter().any(|&c| c < -0.99));

    // Rigid: six products of directors.
    let violation = column(&seen, "constraint_violation");
    println!(
        "free body constraints: {:e}",
        violation.iter().fold(0.0_f64, |m, &v| m.max(v))
    );
    assert!(violation.iter().all(|&v| v < 1e-14));
}

#[test]
fn bodies_that_pull_at_each_other_keep_their_momenta() {
    let at = Vector3::new;
    let directors = *Rotation3::from_euler_angles(-0.4, 0.8, 0.5).matrix();
    let bodies = vec![
        body("a", 20.0, [2e3, 3e3, 4e3], at(0.0, 0.0, 0.0), directors),
        body(
            "b",
            30.0,
            [5e3, 4e3, 3e3],
            at(60.0, 10.0, 0.0),
            directors.transpose(),
        ),
    ];
    let mut scene = bare(bodies, Vec::new(), None);
    let mut muscle = trunk(1).muscles[0].clone();
    assert!(muscle.material.viscosity.is_some() && muscle.material.density.is_some());
    muscle.section_inertia = true;
    for (name, from, to) in [
        ("upper", at(5.0, 8.0, 3.0), at(50.0, 12.0, 6.0)),
        ("lower", at(3.0, -9.0, 0.0), at(55.0, -4.0, -7.0)),
    ] {
        (muscle.name, muscle.from.body, muscle.to.body) = (name.into(), Some(0), Some(1));
        (muscle.from.at, muscle.to.at) = (from, to);
        scene.muscles.push(muscle.clone());
    }
    let h = 2.0;
    let model = Model::new(scene, Some(Coordinates::Redundant), h, &[]).unwrap();
    let [a, b] = [model.reference[0], model.reference[1]];
    let mut rates = spin(&a, at(0.05, 0.0, 0.1), at(0.0, 0.01, 0.02));
    rates.extend(spin(&b, at(-0.03, 0.1, 0.0), at(0.01, 0.0, -0.01)));
    let start = Start::with_rates(&model, at_reference(&model), &rates);
    let steps = 500;
    let discrete = motion(&model, &start, h, steps, &[2000.0, 500.0]);
    let seen = observations(&model, &discrete);
    // The muscles do work and the energy goes, the momenta stay.
    let stretch = column(&seen, "upper_stretch");
    assert!(stretch.iter().any(|s| (s - 1.0).abs() > 0.05));
    assert!(*column(&seen, "dissipated_energy").last().unwrap() > 0.01);
    for name in ["linear_momentum", "angular_momentum"] {
        let list = columns(&seen, name);
        println!(
            "pair: {name} {} moves by {:e}",
            list[0].norm(),
            spread(&list)
        );
        assert!(list[0].norm() > 1.0);
        // Arms of 100 mm and parts that cancel in the sum.
        let size = 100.0 * columns(&seen, "linear_momentum")[0].norm();
        assert!(spread(&list) < rounding(steps, size.max(list[0].norm())));
    }
}

#[test]
fn a_top_keeps_its_momentum_about_the_vertical() {
    let directors = *Rotation3::from_euler_angles(0.9, 0.2, 0.0).matrix();
    let axis: Vector3<f64> = directors.column(2).into();
    let h = 1e-3;
    let top = body("top", 0.7, [5e-4, 5e-4, 4e-4], axis * 0.075, directors);
    let tip = joint("tip", JointKind::Spherical, None, 0, Vector3::zeros());
    let scene = bare(vec![top], vec![tip], Some(Vector3::new(0.0, 0.0, -9.81)));
    let model = Model::new(scene, Some(Coordinates::Redundant), h, &[]).unwrap();
    let omega = axis * 120.0 + Vector3::new(1.0, 2.0, 3.0);
    let rates = spin(&model.reference[0], omega.cross(&(axis * 0.075)), omega);
    let start = Start::with_rates(&model, at_reference(&model), &rates);
    let steps = 1000;
    let discrete = motion(&model, &start, h, steps, &[]);
    let angular = columns(&observations(&model, &discrete), "angular_momentum");
    // Gravity turns L about the vertical and leaves its height.
    assert!(spread(&angular) > 0.2 * angular[0].norm());
    let heights = angular.iter().map(|l| (l.z - angular[0].z).abs());
    let worst = heights.fold(0.0, f64::max);
    println!("top: L_z {} moves by {worst:e}", angular[0].z);
    assert!(worst < rounding(steps, angular[0].norm()));
}

/// Mean of a list.
fn mean(list: &[f64]) -> f64 {
    list.iter().sum::<f64>() / list.len() as f64
}

#[test]
fn the_energy_of_the_undamped_trunk_does_not_drift() {
    let mut scene = trunk(6);
    for muscle in &mut scene.muscles {
        muscle.material.viscosity = None;
    }
    let h = 5.0;
    let (blocks, block) = (50, 1000);
    let model = Model::new(scene, Some(Coordinates::Reduced), h, &[]).unwrap();
    let voltages: Vec<f64> = (0..12)
        .map(|m| if m % 4 == 0 { 1500.0 } else { 300.0 })
        .collect();
    let scalars = model.scalars(&voltages);
    let start = Start::at_rest(&model, at_reference(&model));
    let mut stepper = Stepper::new(&model, &start.z, &start.momentum, Default::default());
    let mut before = placed(&model, &start.z);
    let mut first = None;
    let mut errors = Vec::with_capacity(blocks * block);
    let mut kinetic: f64 = 0.0;
    for _ in 0..blocks * block {
        stepper.step(h, &scalars).unwrap();
        let energy = energies(&model, &before, stepper.instant(), &scalars, h);
        kinetic = kinetic.max(energy.kinetic);
        errors.push(energy.total() - *first.get_or_insert(energy.total()));
        before.clone_from(stepper.instant());
    }
    assert_eq!(stepper.report().halved, 0);

    // The energy at midpoints oscillates with O(h²) and is bounded by it over 250 s.
    let deviation = {
        let m = mean(&errors);
        mean(&errors.iter().map(|e| (e - m) * (e - m)).collect::<Vec<_>>()).sqrt()
    };
    let bound = errors.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    // Regression line through the means of blocks: what it climbs over the whole time, against its own uncertainty.
    let means: Vec<f64> = errors.chunks(block).map(mean).collect();
    let centred: Vec<f64> = (0..blocks)
        .map(|i| i as f64 - 0.5 * (blocks - 1) as f64)
        .collect();
    let square: f64 = centred.iter().map(|t| t * t).sum();
    let slope = centred.iter().zip(&means).map(|(t, e)| t * e).sum::<f64>() / square;
    let m = mean(&means);
    let residual: f64 = centred
        .iter()
        .zip(&means)
        .map(|(t, e)| (e - m - slope * t).powi(2))
        .sum();
    let uncertainty = (residual / (blocks - 2) as f64 / square).sqrt();
    println!(
        "trunk: kinetic {kinetic}, deviation {deviation:e}, bound {bound:e}, slope {slope:e} ± {uncertainty:e} per block, {:e} in all",
        slope * blocks as f64
    );
    assert!(kinetic > 1.0);
    assert!(
        deviation > 1e-4 * kinetic,
        "the test needs errors that could drift"
    );
    assert!(bound < 10.0 * deviation);
    assert!(slope.abs() < 4.0 * uncertainty);
    assert!(slope.abs() * (blocks as f64) < 1e-3 * deviation);
}

#[test]
fn redundant_coordinates_stay_on_their_constraints() {
    let h = 5.0;
    let model = Model::new(trunk(6), Some(Coordinates::Redundant), h, &[]).unwrap();
    let voltages: Vec<f64> = (0..12)
        .map(|m| if m % 4 == 0 { 2000.0 } else { 0.0 })
        .collect();
    let start = Start::at_rest(&model, at_reference(&model));
    let discrete = motion(&model, &start, h, 400, &model.scalars(&voltages));
    let seen = observations(&model, &discrete);
    assert!(column(&seen, "joint1").iter().any(|a| a.abs() > 0.1));
    let worst = column(&seen, "constraint_violation")
        .iter()
        .fold(0.0_f64, |m, &v| m.max(v));
    println!("trunk constraints: {worst:e}");
    // Points of joints lie up to 300 mm from the origin.
    assert!(worst < 1e3 * f64::EPSILON * 300.0, "{worst:e}");
}
