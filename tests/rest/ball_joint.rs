//! A body on a ball joint that springs hold under weight, in turned scenes, against the path of its equilibria in small steps of the weight.

use crate::common::random::Random;
use crate::stable::{model, reference, scene};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, Vector3};
use proboscis::dynamics::{Route, stable_equilibrium};
use serde_json::json;

/// Length in m, and the mass in kg.
const LENGTH: f64 = 0.1;
const MASS: f64 = 0.05;
/// Largest and smallest step of the weight, and the angle by which one may turn the body.
const LARGEST: f64 = 1e-2;
const SMALLEST: f64 = 1e-6;
const FAR: f64 = 0.02;

/// Springs without force in the reference configuration: from the ground to the body, and their stiffness in N/m.
struct Top {
    springs: Vec<(Vector3<f64>, Vector3<f64>, f64)>,
    gravity: Vector3<f64>,
}

impl Top {
    fn new(random: &mut Random) -> Self {
        let count = if random.unit() > 0.0 { 3 } else { 4 };
        let first = random.between(0.0, 0.5);
        let spring = |k: usize| {
            let angle = first + std::f64::consts::TAU * k as f64 / count as f64;
            let at = |turn: f64, y: f64| {
                Vector3::new(0.02 * (angle + turn).cos(), y, 0.02 * (angle + turn).sin())
            };
            (at(0.0, -0.02), at(0.2, 0.02))
        };
        let springs = (0..count).map(|k| {
            let (a, b) = spring(k);
            (a, b, random.between(5.0, 40.0))
        });
        let springs = springs.collect();
        let down = Vector3::from_fn(|_, _| random.unit());
        Self {
            springs,
            gravity: 9.81 * down.normalize(),
        }
    }

    /// Slope and curvature of the energy in J under a part of the weight by rotation vectors ω, by which a place q turns to q + ω×q + ½ ω×(ω×q).
    fn derivatives(&self, at: &Rotation3<f64>, part: f64) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut slope, mut curvature) = (Vector3::zeros(), Matrix3::zeros());
        // Curvature of d·q.
        let linear = |q: Vector3<f64>, d: Vector3<f64>| {
            let both = q * d.transpose();
            0.5 * (both + both.transpose()) - Matrix3::from_diagonal_element(q.dot(&d))
        };
        for (a, b, stiffness) in &self.springs {
            let q = at * b;
            let (length, at_rest) = ((q - a).norm(), (b - a).norm());
            // Of ½k(l − l₀)², where l² changes by −2 a·q.
            let by_square = 0.5 * stiffness * (1.0 - at_rest / length);
            let of_square = q.cross(a) * -2.0;
            slope += of_square * by_square;
            curvature += linear(q, *a) * (-2.0 * by_square);
            let bend = 0.25 * stiffness * at_rest / length.powi(3);
            curvature += of_square * of_square.transpose() * bend;
        }
        let centre = at * Vector3::new(0.0, 0.5 * LENGTH, 0.0);
        let weight = self.gravity * (part * MASS);
        slope -= centre.cross(&weight);
        curvature -= linear(centre, weight);
        (slope, curvature)
    }

    /// The rotation under all of the weight with the eigenvalues of its stiffness, or the part at which the path loses its stability: steps
    /// of which none turns the body far.
    fn path(&self) -> Result<(Rotation3<f64>, Vector3<f64>), f64> {
        let (mut at, mut part, mut step) = (Rotation3::identity(), 0.0, LARGEST);
        while part < 1.0 {
            let target = f64::min(part + step, 1.0);
            let Some(next) = self.rest_near(&at, target) else {
                step *= 0.5;
                if step < SMALLEST {
                    return Err(part);
                }
                continue;
            };
            (at, part) = (next, target);
            step = f64::min(2.0 * step, LARGEST);
        }
        let (_, curvature) = self.derivatives(&at, 1.0);
        Ok((at, SymmetricEigen::new(curvature).eigenvalues))
    }

    /// The stable rotation near another under a part of the weight.
    fn rest_near(&self, from: &Rotation3<f64>, part: f64) -> Option<Rotation3<f64>> {
        let mut at = *from;
        for _ in 0..20 {
            let (slope, curvature) = self.derivatives(&at, part);
            let update = -curvature.try_inverse()? * slope;
            if update.norm() > FAR {
                return None;
            }
            at = Rotation3::new(update) * at;
            if update.norm() < 1e-9 {
                break;
            }
        }
        let (_, curvature) = self.derivatives(&at, part);
        let least = SymmetricEigen::new(curvature).eigenvalues.min();
        (least > 0.0).then_some(at)
    }

    /// The scene turned about the joint.
    fn written(&self, turn: &Rotation3<f64>) -> serde_json::Value {
        let place = |p: Vector3<f64>| {
            let p = turn * p;
            [p.x, p.y, p.z]
        };
        let springs = self.springs.iter().enumerate().map(|(k, (a, b, stiffness))| {
            json!({
                "name": format!("spring{k}"), "stiffness": stiffness,
                "from": { "body": "ground", "at": place(*a) }, "to": { "body": "top", "at": place(*b) },
            })
        });
        let gravity = turn * self.gravity;
        json!({
            "name": "top",
            "bodies": [{
                "name": "top", "mass": MASS, "position": place(Vector3::new(0.0, 0.5 * LENGTH, 0.0)),
                "inertia": [4e-5, 4e-5, 4e-5],
            }],
            "joints": [{ "name": "ball", "parent": "ground", "child": "top", "at": [0, 0, 0], "spherical": {} }],
            "springs": springs.collect::<Vec<_>>(),
            "gravity": [gravity.x, gravity.y, gravity.z],
        })
    }
}

#[test]
fn a_top_rests_at_the_end_of_its_path_in_every_frame() {
    let mut random = Random(5);
    let (mut stays, mut lost) = (0, 0);
    for case in 0..30 {
        let top = Top::new(&mut random);
        let exact = top.path();
        let mut first: Option<(Vector3<f64>, Vec<f64>, Route)> = None;
        for k in 0..4 {
            let angle = f64::from(k);
            let turn = Rotation3::from_euler_angles(0.9 * angle, -1.7 * angle, 2.3 * angle);
            let model = model(scene(&top.written(&turn)));
            let rest = stable_equilibrium(&model, &reference(&model), &[]).unwrap();
            let pose = &model.poses(&model.action.map.placed(&rest.z))[0];
            let centre = turn.inverse() * pose.centre / 1e3;
            match (&exact, rest.loss()) {
                (Ok((at, values)), None) => {
                    let wanted = at * Vector3::new(0.0, 0.5 * LENGTH, 0.0);
                    assert!(
                        (centre - wanted).norm() < 1e-7,
                        "{case}, {k}: {centre} {wanted}"
                    );
                    let mut values: Vec<f64> = values.iter().map(|v| 1e3 * v).collect();
                    values.sort_by(f64::total_cmp);
                    for (a, b) in values.iter().zip(&rest.stiffness) {
                        assert!(
                            (a - b).abs() < 1e-4 * values[2],
                            "{case}: {values:?} {rest:?}"
                        );
                    }
                }
                (Err(part), Some(loss)) => {
                    let apart = (loss.fraction - part).abs();
                    assert!(apart < 1e-3, "{case}: {loss:?} at {part}");
                }
                (exact, loss) => panic!("{case}, {k}: {loss:?} for {exact:?}"),
            }
            match &first {
                None => first = Some((centre, rest.stiffness, rest.route)),
                Some((place, stiffness, _)) => {
                    assert!(
                        (place - centre).norm() < 1e-7,
                        "{case}, {k}: {place} {centre}"
                    );
                    for (a, b) in stiffness.iter().zip(&rest.stiffness) {
                        assert!((a - b).abs() < 1e-5 * stiffness[2], "{case}, {k}: {a} {b}");
                    }
                }
            }
        }
        match exact {
            Ok(_) => stays += 1,
            Err(_) => lost += 1,
        }
    }
    assert!(stays > 5 && lost > 5, "{stays} {lost}");
}
