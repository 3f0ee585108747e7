//! Order two in the step, against exact motions and by self-convergence.

use crate::common::{
    at_reference, bare, body, columns, joint, motion, richardson, spin, trunk, with_velocities,
};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{Start, observations};
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Model};
use std::f64::consts::{FRAC_PI_3, PI};

/// Slope of log error over log h for steps halved from one to the next.
fn slopes(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|w| (w[0] / w[1]).log2()).collect()
}

/// Place of the centre of the first body at the end of each run of `time` in `steps` steps.
fn ends(
    scene: &System,
    coordinates: Coordinates,
    omega: Vector3<f64>,
    time: f64,
    steps: &[usize],
) -> Vec<Vector3<f64>> {
    let end = |&n: &usize| {
        let h = time / n as f64;
        let model = Model::new(scene.clone(), Some(coordinates), h, &[]).unwrap();
        let z = at_reference(&model);
        let velocity = omega.cross(&model.reference[0].centre);
        let start = with_velocities(&model, z, &[[velocity, omega]]);
        let discrete = motion(&model, &start, h, n, &[]);
        let last = crate::common::placed(&model, &discrete.z[n]);
        model.poses(&last)[0].centre
    };
    steps.iter().map(end).collect()
}

/// The limit of places under halved steps.
fn limit(places: &[Vector3<f64>]) -> Vector3<f64> {
    Vector3::from_fn(|i, _| richardson(&places.iter().map(|x| x[i]).collect::<Vec<_>>()))
}

#[test]
fn the_tip_of_a_driven_trunk_converges_with_order_two() {
    let scene = trunk(2);
    assert!(scene.muscles.iter().all(|m| m.material.viscosity.is_some()));
    let time = 200.0;
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let tips: Vec<Vector3<f64>> = [20, 40, 80, 160, 320]
            .iter()
            .map(|&n| {
                let h = time / n as f64;
                let model = Model::new(scene.clone(), Some(coordinates), h, &[]).unwrap();
                let start = Start::at_rest(&model, at_reference(&model));
                let scalars = model.scalars(&[2000.0, 0.0, 0.0, 1500.0]);
                let discrete = motion(&model, &start, h, n, &scalars);
                columns(&observations(&model, &discrete), "tip")[n]
            })
            .collect();
        assert!((tips[4] - Vector3::new(0.0, 100.0, 0.0)).norm() > 5.0);
        let errors: Vec<f64> = tips.windows(2).map(|w| (w[1] - w[0]).norm()).collect();
        println!(
            "trunk {coordinates:?}: {errors:?} slopes {:?}",
            slopes(&errors)
        );
        for slope in slopes(&errors) {
            assert!((slope - 2.0).abs() < 0.1, "{slope}");
        }
    }
}

/// The cone of Betsch and Leyendecker on its tip in steady precession (parameters of plkinon/metis).
struct Cone {
    mass: f64,
    length: f64,
    inertia: f64,
    spin: f64,
}

const PRECESSION: f64 = 10.0;
const G: f64 = 9.81;

impl Cone {
    fn new() -> Self {
        let (a, density) = (0.1_f64, 2700.0);
        let (r, length) = (0.5 * a, 0.75 * a);
        let mass = density * PI * r * r * a / 3.0;
        let transverse = 3.0 / 80.0 * mass * (4.0 * r * r + a * a);
        let axial = 0.3 * mass * r * r;
        let spin = mass * G * length / (axial * PRECESSION)
            + (transverse + mass * length * length - axial) / axial * PRECESSION * FRAC_PI_3.cos();
        assert!((mass - 0.706858347058).abs() < 1e-12 && (spin - 135.6).abs() < 1e-12);
        assert!((transverse - axial).abs() < 1e-18);
        Self {
            mass,
            length,
            inertia: axial,
            spin,
        }
    }

    fn scene(&self) -> System {
        let d3 = Vector3::new(0.0, -FRAC_PI_3.sin(), FRAC_PI_3.cos());
        let directors = Matrix3::from_columns(&[Vector3::x(), d3.cross(&Vector3::x()), d3]);
        let cone = body(
            "cone",
            self.mass,
            [self.inertia; 3],
            d3 * self.length,
            directors,
        );
        let tip = joint("tip", JointKind::Spherical, None, 0, Vector3::zeros());
        bare(vec![cone], vec![tip], Some(Vector3::new(0.0, 0.0, -G)))
    }

    fn omega(&self) -> Vector3<f64> {
        let d3 = Vector3::new(0.0, -FRAC_PI_3.sin(), FRAC_PI_3.cos());
        Vector3::z() * PRECESSION + d3 * self.spin
    }
}

#[test]
fn a_top_precesses_steadily() {
    let cone = Cone::new();
    let scene = cone.scene();
    let d3 = Vector3::new(0.0, -FRAC_PI_3.sin(), FRAC_PI_3.cos());
    let (sin, cos) = (PRECESSION * 0.2_f64).sin_cos();
    let exact = Vector3::new(d3.x * cos - d3.y * sin, d3.x * sin + d3.y * cos, d3.z) * cone.length;
    // Errors |φ − φ_exact|/l at t = 0.2 of the midpoint director integrator, verified by a second code, in all digits.
    let table = [
        (100, 4.010443e-3),
        (200, 9.858103e-4),
        (400, 2.454423e-4),
        (800, 6.129803e-5),
    ];
    let mut errors = Vec::new();
    for (n, expected) in table {
        let [end, reduced] = [Coordinates::Redundant, Coordinates::Reduced]
            .map(|coordinates| ends(&scene, coordinates, cone.omega(), 0.2, &[n])[0]);
        assert!(
            (end - reduced).amax() < 1e-12,
            "{:e}",
            (end - reduced).amax()
        );
        let error = (end - exact).norm() / cone.length;
        let digit = 10_f64.powf(f64::log10(expected).floor() - 6.0);
        println!("top {n}: {error:.6e} against {expected:.6e}");
        assert!(
            (error - expected).abs() <= 0.51 * digit,
            "{error:e} against {expected:e}"
        );
        errors.push(error);
        if n == 200 {
            let printed = Vector3::new(0.05901517, 0.02705823, 0.03755079);
            assert!((end - printed).amax() < 0.51e-8, "{end}");
        }
    }
    for slope in slopes(&errors) {
        assert!((slope - 2.0).abs() < 0.1, "{slope}");
    }

    let h = 1e-3;
    let model = Model::new(scene, Some(Coordinates::Redundant), h, &[]).unwrap();
    let pose = model.reference[0];
    let rates = spin(&pose, cone.omega().cross(&pose.centre), cone.omega());
    let start = Start::with_rates(&model, at_reference(&model), &rates);
    let seen = observations(&model, &motion(&model, &start, h, 200, &[]));
    let angular = columns(&seen, "angular_momentum");
    // L = (0, −0.04503947, 0.07106577) at the start, L_z = 0.0710657710673 for ever.
    assert!((angular[0] - Vector3::new(0.0, -0.04503947, 0.07106577)).amax() < 0.51e-8);
    for l in &angular {
        assert!((l.z - 0.0710657710673).abs() < 1e-13, "{}", l.z);
    }
    // Energy 5.66905519063 = 5.40901967621 + 0.260035514424.
    let first = |name: &str| crate::common::column(&seen, name)[0];
    assert!((first("kinetic_energy") - 5.40901967621).abs() < 1e-11);
    assert!((first("gravity_energy") - 0.260035514424).abs() < 1e-12);
    assert!((first("total_energy") - 5.66905519063).abs() < 1e-11);
}

#[test]
fn the_heavy_top_follows_its_exact_motion() {
    // Géradin and Cardona; centre of mass from an integration of order eight to 1e-13, printed to 8 digits.
    let exact = [
        (0.02, Vector3::new(0.09198595, 0.99574111, -0.00618336)),
        (0.1, Vector3::new(0.42129666, 0.89457197, -0.1491647)),
        (0.2, Vector3::new(0.60555056, 0.59895768, -0.52398303)),
    ];
    let top = body(
        "top",
        15.0,
        [0.234375, 0.46875, 0.234375],
        Vector3::y(),
        Matrix3::identity(),
    );
    let foot = joint("foot", JointKind::Spherical, None, 0, Vector3::zeros());
    let scene = bare(vec![top], vec![foot], Some(Vector3::new(0.0, 0.0, -9.81)));
    let omega = Vector3::new(0.0, 150.0, -4.61538);
    for (time, expected) in exact {
        let n = f64::round(time / 2e-3) as usize;
        let steps = [n, 2 * n, 4 * n, 8 * n];
        let [places, reduced] = [Coordinates::Redundant, Coordinates::Reduced]
            .map(|coordinates| ends(&scene, coordinates, omega, time, &steps));
        for (a, b) in places.iter().zip(&reduced) {
            assert!((a - b).amax() < 1e-10, "{:e}", (a - b).amax());
        }
        let errors: Vec<f64> = places.iter().map(|x| (x - expected).norm()).collect();
        let error = (limit(&places) - expected).amax();
        println!(
            "heavy top {time}: {errors:?} slopes {:?}, limit {error:e}",
            slopes(&errors)
        );
        assert!(errors[0] > 1e-5);
        for slope in slopes(&errors) {
            assert!((slope - 2.0).abs() < 0.1, "{slope}");
        }
        assert!(error < 2e-8, "{error:e}");
    }
}

#[test]
fn the_plane_pendulum_follows_its_exact_motion() {
    // IFToMM A01: m = 1, L = 1, g = 9.81, from (−1, 0) at rest; elliptic functions.
    let exact = [
        (1.0, Vector3::new(0.9862917511, -0.1650108531, 0.0)),
        (5.0, Vector3::new(-0.9423054350, -0.3347543384, 0.0)),
        (10.0, Vector3::new(-0.2750874626, -0.9614192051, 0.0)),
        // A quarter of the period: straight down.
        (0.25 * 2.3678419475762373, Vector3::new(0.0, -1.0, 0.0)),
    ];
    let mass = body("mass", 1.0, [0.0; 3], -Vector3::x(), Matrix3::identity());
    let pivot = joint(
        "pivot",
        JointKind::Revolute { axis: Vector3::z() },
        None,
        0,
        Vector3::zeros(),
    );
    let scene = bare(vec![mass], vec![pivot], Some(Vector3::new(0.0, -9.81, 0.0)));
    for (time, expected) in exact {
        let n = f64::ceil(time * 125.0) as usize;
        let steps = [n, 2 * n, 4 * n, 8 * n];
        let [reduced, redundant] = [Coordinates::Reduced, Coordinates::Redundant]
            .map(|c| ends(&scene, c, Vector3::zeros(), time, &steps));
        for (a, b) in reduced.iter().zip(&redundant) {
            assert!((a - b).amax() < 1e-9, "{}", (a - b).amax());
        }
        let errors: Vec<f64> = reduced.iter().map(|x| (x - expected).norm()).collect();
        let error = (limit(&reduced) - expected).amax();
        println!(
            "pendulum {time}: {errors:?} slopes {:?}, limit {error:e}",
            slopes(&errors)
        );
        assert!(errors[0] > 1e-6);
        assert!((slopes(&errors)[2] - 2.0).abs() < 0.1);
        assert!(error < 1e-8, "{error:e}");
    }
}
