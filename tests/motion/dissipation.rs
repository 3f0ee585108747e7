//! Dissipation by viscosity and dampers.

use crate::common::{at_reference, bare, body, column, joint, motion, richardson, trunk};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{Start, observations};
use proboscis::model::system::{Joint, JointKind};
use proboscis::model::{Coordinates, Model};

/// Energies and the energy dissipated until then at the instants after the first, from a bent start under voltages.
fn balance(h: f64, steps: usize, viscosity: f64) -> (Vec<f64>, Vec<f64>) {
    let mut scene = trunk(2);
    for muscle in &mut scene.muscles {
        muscle.material.viscosity = Some(viscosity);
    }
    let model = Model::new(scene, Some(Coordinates::Reduced), h, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[0.2, -0.15]));
    let scalars = model.scalars(&[1500.0, 0.0, 500.0, 800.0]);
    let seen = observations(&model, &motion(&model, &start, h, steps, &scalars));
    let list = |name: &str| column(&seen, name)[1..].to_vec();
    (list("total_energy"), list("dissipated_energy"))
}

#[test]
fn energy_falls_by_what_viscosity_dissipates() {
    // Both belong to the instants: E_k + D_k is constant to O(h²).
    let error = |h: f64, steps: usize| {
        let (energy, dissipated) = balance(h, steps, 1.0);
        // From the second half on the errors of the fast start have the same weight on all grids.
        let sums: Vec<f64> = (0..steps).map(|k| energy[k] + dissipated[k]).collect();
        let initial = balance(1e-3, 1, 1.0).0[0];
        let worst = sums.iter().map(|e| (e - initial).abs()).fold(0.0, f64::max);
        (worst, dissipated[steps - 1])
    };
    let errors = [(2.0, 250), (1.0, 500), (0.5, 1000)].map(|(h, n)| error(h, n));
    println!("balance: {errors:?}");
    let taken = errors[2].1;
    assert!(taken > 0.1);
    assert!(errors[2].0 < 1e-2 * taken);
    for pair in errors.windows(2) {
        let order = (pair[0].0 / pair[1].0).log2();
        assert!((order - 2.0).abs() < 0.2, "{order}");
    }
}

#[test]
fn energy_never_rises_under_constant_voltages() {
    let (energy, dissipated) = balance(2.0, 500, 40.0);
    let fall = energy[0] - energy[499];
    let rise = energy
        .windows(2)
        .map(|w| w[1] - w[0])
        .fold(f64::NEG_INFINITY, f64::max);
    println!("falls by {fall}, never more than {rise:e} up");
    assert!(fall > 0.1);
    assert!(rise <= 1e-12 * fall.abs().max(energy[0].abs()), "{rise:e}");
    assert!(dissipated.windows(2).all(|w| w[1] >= w[0]));
    assert!(dissipated[499] > 0.9 * fall);
}

fn damped(kind: JointKind, damping: f64) -> Joint {
    Joint {
        damping: Some(damping),
        ..joint("pivot", kind, None, 0, Vector3::zeros())
    }
}

#[test]
fn a_damped_hinge_decays_exponentially() {
    let (mass, arm, inertia, damping) = (3.0, 10.0, 50.0, 7.0);
    let about_pivot = inertia + mass * arm * arm;
    let (rate, time) = (0.02, 40.0);
    let decay = damping / about_pivot;
    assert!(decay * time > 0.5);
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let angle = |n: usize| {
            let bob = body(
                "bob",
                mass,
                [30.0, 40.0, inertia],
                Vector3::x() * arm,
                Matrix3::identity(),
            );
            let hinge = damped(JointKind::Revolute { axis: Vector3::z() }, damping);
            let h = time / n as f64;
            let model = Model::new(
                bare(vec![bob], vec![hinge], None),
                Some(coordinates),
                h,
                &[],
            )
            .unwrap();
            let rates = match coordinates {
                Coordinates::Reduced => vec![rate],
                Coordinates::Redundant => model
                    .rates_at(&[0.0], &[rate], &Default::default())
                    .unwrap(),
            };
            let start = Start::with_rates(&model, at_reference(&model), &rates);
            let discrete = motion(&model, &start, h, n, &[]);
            let seen = observations(&model, &discrete);
            (
                column(&seen, "pivot")[n],
                column(&seen, "angular_momentum_z")[n],
            )
        };
        // θ = θ̇₀ (1 − e^{−dt/I})/(d/I), L = I θ̇₀ e^{−dt/I}.
        let left = (-decay * time).exp();
        let exact = rate * (1.0 - left) / decay;
        let [a, b, c] = [20, 40, 80].map(angle);
        let errors = [a, b, c].map(|x| (x.0 - exact).abs());
        println!("hinge {coordinates:?}: {errors:?}");
        assert!(errors[0] > 1e-8);
        assert!(((errors[1] / errors[2]).log2() - 2.0).abs() < 0.1);
        let limit = richardson(&[a.0, b.0, c.0]);
        assert!(
            (limit - exact).abs() < 1e-9 * exact,
            "{limit} against {exact}"
        );
        // The axle pushes only through its point, so the momentum about it is that of the whole.
        let limit = richardson(&[a.1, b.1, c.1]);
        let momentum = about_pivot * rate * left;
        println!("  momentum {limit} against {momentum}");
        assert!((limit - momentum).abs() < 1e-8 * momentum);
    }
}

#[test]
fn a_damped_slider_decays_by_the_same_factor_in_every_step() {
    let (mass, damping, h, velocity) = (3.0, 0.4, 2.0, 0.7);
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let axis = Vector3::new(1.0, 2.0, -1.0).normalize();
        let sledge = body(
            "sledge",
            mass,
            [1.0, 2.0, 2.0],
            Vector3::zeros(),
            Matrix3::identity(),
        );
        let rail = damped(JointKind::Prismatic { axis }, damping);
        let model = Model::new(
            bare(vec![sledge], vec![rail], None),
            Some(coordinates),
            h,
            &[],
        )
        .unwrap();
        let rates = match coordinates {
            Coordinates::Reduced => vec![velocity],
            Coordinates::Redundant => model
                .rates_at(&[0.0], &[velocity], &Default::default())
                .unwrap(),
        };
        let start = Start::with_rates(&model, at_reference(&model), &rates);
        let seen = observations(&model, &motion(&model, &start, h, 50, &[]));
        let place = column(&seen, "pivot");
        let momentum = ["x", "y", "z"].map(|i| column(&seen, &format!("linear_momentum_{i}")));
        // m v_{k+½} = m v_{k−½} − (d h/2)(v_{k−½} + v_{k+½}), and v_½ = v₀/(1 + d h/(2m)).
        let half = 0.5 * damping * h / mass;
        let mut v = velocity / (1.0 + half);
        let mut y = 0.0;
        for (k, &seen) in place.iter().enumerate().skip(1) {
            y += h * v;
            assert!((seen - y).abs() < 1e-12, "{seen} against {y}");
            // p⁺ = m v − (d h/2) v along the axis: the rail pulls from the ground.
            for i in 0..3 {
                let expected = mass * (1.0 - half) * v * axis[i];
                assert!((momentum[i][k] - expected).abs() < 1e-12);
            }
            v *= (1.0 - half) / (1.0 + half);
        }
        assert!(v < 0.1 * velocity);
    }
}
