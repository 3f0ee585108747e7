//! Maxwell branches in their limits: values of the published law to many digits, creep, and short and long relaxation times.

use crate::common::{motion, placed};
use crate::components::column;
use crate::maxwell::{
    BOTH, LENGTH, MODULUS, branches, end, model, slider, stress, suddenly, swing,
};
use proboscis::dynamics::{DiscreteTrajectory, Integrator, Solving, Start, simulate_by};
use proboscis::model::system::{ElectricConstants, MaxwellBranches, System, VACUUM_PERMITTIVITY};
use proboscis::model::{Coordinates, Model};
use std::ops::ControlFlow;

/// A motion under a constant voltage by a Galerkin method of order 6.
fn of_order_six(
    model: &Model,
    start: &Start,
    (step, steps): (f64, usize),
    voltage: f64,
) -> DiscreteTrajectory {
    let solving = Solving {
        integrator: Integrator::Galerkin { degree: 3 },
        ..Solving::default()
    };
    let scalars = model.scalars(&[voltage]);
    let (discrete, failure) = simulate_by(
        solving,
        model,
        start,
        step,
        steps,
        |_, _| scalars.clone(),
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    discrete
}

#[test]
fn relaxed_stresses_are_the_published_ones_to_eight_digits() {
    let expected = [
        (50.0, -0.1009831352878),
        (100.0, -0.0919727479142),
        (300.0, -0.0785351251941),
        (1000.0, -0.0762521092895),
    ];
    let system = slider(1e14, branches(&[[0.05, 100.0]]));
    for coordinates in BOTH {
        let model = model(&system, coordinates, 2.5);
        let start = suddenly(&model, -0.2 * LENGTH);
        let discrete = of_order_six(&model, &start, (2.5, 400), 0.0);
        let viscous = column(&model, &discrete, "muscle_viscous_stretch1");
        for (time, exact) in expected {
            let found = stress(0.8, 0.05, viscous[(time / 2.5) as usize].ln());
            assert!(
                (found / exact - 1.0).abs() < 1e-8,
                "{time}: {found} {exact}"
            );
        }
    }
}

#[test]
fn a_swing_with_two_branches_has_the_digits_of_runge_and_kutta() {
    let list = [[0.05, 8.0], [0.03, 60.0]];
    let exact = swing(20.0, &list, [6.0, 0.0, 0.0, 0.0], 40.0);
    let exact = [exact[0], exact[2], exact[3]];
    let system = slider(20.0, branches(&list));
    for coordinates in BOTH {
        let model = model(&system, coordinates, 0.05);
        let start = suddenly(&model, 6.0);
        let found = end(&model, &of_order_six(&model, &start, (0.05, 800), 0.0));
        for (a, b) in found.iter().zip(exact) {
            assert!((a / b - 1.0).abs() < 1e-8, "{coordinates:?}: {a} {b}");
        }
    }
}

/// Creep of a muscle of an ideal dielectric under 30 V/µm, without mass: stretches from the published law.
#[test]
fn a_muscle_without_mass_creeps_under_its_field_as_published() {
    // ε E₀² of ε_r = 3.
    let field = 3e4;
    let pressure = 3.0 * VACUUM_PERMITTIVITY * field * field;
    assert!((pressure - 0.023906307).abs() < 1e-9);
    let expected = [
        (50.0, 0.9305445213),
        (100.0, 0.9234749302),
        (300.0, 0.9090147681),
    ];
    let mut system = slider(1e-10, branches(&[[0.05, 100.0]]));
    system.muscles[0].material.electric = Some(ElectricConstants::ideal(3.0));
    let voltage = field * system.muscles[0].layer_thickness;
    for coordinates in BOTH {
        let at = |h: f64| {
            let model = model(&system, coordinates, h);
            // The stretch at once, which the branch has not felt: 10 digits of the published 0.9399464523.
            let start = suddenly(&model, (0.9399464523 - 1.0) * LENGTH);
            let steps = (300.0 / h) as usize;
            let discrete = motion(&model, &start, h, steps, &[voltage]);
            let stretch = column(&model, &discrete, "muscle_stretch");
            expected.map(|(time, _)| stretch[(time / h).round() as usize])
        };
        let [coarse, fine] = [at(1.0), at(0.5)];
        for (i, (time, exact)) in expected.into_iter().enumerate() {
            let errors = [coarse[i] - exact, fine[i] - exact];
            assert!(errors[1].abs() < 2e-8, "{time}: {errors:?}");
            let limit = (4.0 * errors[1] - errors[0]) / 3.0;
            assert!(limit.abs() < 1e-8, "{coordinates:?} {time}: {errors:?}");
        }
    }
}

/// Place of the slider after 20 ms from a displacement of 6 mm.
fn after(system: &System, start: impl Fn(&Model) -> Start) -> f64 {
    let model = model(system, Coordinates::Reduced, 0.1);
    let discrete = of_order_six(&model, &start(&model), (0.1, 200), 0.0);
    let z = discrete.z.last().unwrap();
    model.joints(&placed(&model, z), &[0.0])[0]
}

#[test]
fn a_branch_that_relaxes_at_once_is_viscosity_and_one_that_never_does_is_elasticity() {
    let modulus = 0.05;
    let relaxed = |model: &Model| Start::at_rest(model, model.coordinates_at(&[6.0]));
    // 3 τ μ₁ of z is 3/2 η of Λ̇/Λ.
    let short = [0.2, 0.1, 0.05].map(|tau| {
        let branch = after(&slider(20.0, branches(&[[modulus, tau]])), relaxed);
        let mut viscous = slider(20.0, MaxwellBranches::default());
        viscous.muscles[0].material.viscosity = Some(2.0 * modulus * tau);
        let plain = after(&slider(20.0, MaxwellBranches::default()), relaxed);
        let alike = after(&viscous, relaxed);
        assert!(
            (alike - plain).abs() > 10.0 * (branch - alike).abs(),
            "{plain} {alike} {branch}"
        );
        (branch - alike).abs()
    });
    // The difference is of the second order in τ: of the viscosity itself, and of the lag behind it.
    for pair in short.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{short:?}");
    }
    let fresh = |model: &Model| suddenly(model, 6.0);
    let long = [4e3, 8e3, 16e3].map(|tau| {
        let branch = after(&slider(20.0, branches(&[[modulus, tau]])), fresh);
        let mut stiff = slider(20.0, MaxwellBranches::default());
        stiff.muscles[0].material.shear_modulus = MODULUS + modulus;
        (branch - after(&stiff, fresh)).abs()
    });
    assert!(long[0] > 1e-5, "{long:?}");
    for pair in long.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "{long:?}");
    }
}
