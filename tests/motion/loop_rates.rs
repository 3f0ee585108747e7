//! Rates of closed loops at a start: completed from those of one joint, against plane geometry.

use crate::closed_loop::{AXIAL, bar};
use crate::common::{column, motion, placed};
use crate::redundant_loops::plane_four_bar;
use nalgebra::{Matrix2, Rotation3, Vector2, Vector3};
use proboscis::control::problem::BoundaryState;
use proboscis::control::resolve_start;
use proboscis::dynamics::observations;
use proboscis::files::read_problem;
use proboscis::model::Model;
use proboscis::model::system::JointKind;
use std::collections::BTreeMap;
use std::path::Path;

/// Rates in rad/ms of crank, coupler and rocker of the plane four-bar, whose crank turns at `crank`, and its kinetic energy.
fn plane(crank: f64) -> ([f64; 3], f64) {
    let [o, a, b, c] = [[0.0, 0.0], [0.3, -0.8], [1.1, -1.0], [1.0, 0.0]].map(Vector2::from);
    let turned = |v: Vector2<f64>| Vector2::new(-v.y, v.x);
    let of_a = turned(a - o) * crank;
    // a moves with the crank, b with coupler and rocker: of_a + ω₂ (b − a)⊥ = ω₃ (b − c)⊥.
    let map = Matrix2::from_columns(&[turned(b - a), -turned(b - c)]);
    let found = map.lu().solve(&-of_a).unwrap();
    let [coupler, rocker] = [found.x, found.y];
    let of_b = turned(b - c) * rocker;
    let rod = |length: f64, rate: f64| length.powi(2) / 12.0 * rate * rate;
    let energy = 0.5
        * ((0.5 * of_a).norm_squared()
            + rod((a - o).norm(), crank)
            + (0.5 * (of_a + of_b)).norm_squared()
            + rod((b - a).norm(), coupler)
            + (0.5 * of_b).norm_squared()
            + rod((b - c).norm(), rocker));
    ([crank, coupler, rocker], energy)
}

fn start(rates: &[(usize, f64)]) -> BoundaryState {
    BoundaryState::JointAngles {
        angles: BTreeMap::new(),
        rates: rates.iter().copied().collect(),
        velocities: BTreeMap::new(),
    }
}

#[test]
fn the_rate_of_one_joint_sets_the_whole_loop_in_motion() {
    let ([crank, coupler, rocker], energy) = plane(2.0);
    assert!(coupler.abs() > 0.1 && rocker.abs() > 0.1);
    for turn in [
        Rotation3::identity(),
        Rotation3::from_euler_angles(0.4, -0.9, 1.3),
    ] {
        let axis = turn * Vector3::z();
        let kinds = [JointKind::Revolute { axis }; 2];
        let model = Model::new(plane_four_bar(&turn, kinds), None, 1e-3, &[]).unwrap();
        let expected = [crank, coupler - crank, rocker - coupler, rocker];
        for named in [&[0][..], &[3], &[1], &[0, 3], &[0, 1, 2, 3]] {
            let rates: Vec<_> = named.iter().map(|&j| (j, expected[j])).collect();
            let start = resolve_start(&model, &start(&rates), "start").unwrap();
            let found = start.rates.as_ref().unwrap();
            let mut instant = placed(&model, &start.z);
            instant.l[..found.len()].copy_from_slice(found);
            // The third joint counts from the coupler to the rocker.
            for j in [0, 1, 3] {
                let rate = model.joint_rate(j, &instant);
                assert!((rate - expected[j]).abs() < 1e-12, "{j}: {rate}");
            }
            let pairs = start.momentum.iter().zip(found);
            let kinetic: f64 = pairs.map(|(p, v)| 0.5 * p * v).sum();
            assert!((kinetic / energy - 1.0).abs() < 1e-12, "{kinetic} {energy}");
            let discrete = motion(&model, &start, 1e-3, 40, &[]);
            let seen = observations(&model, &discrete);
            let total = column(&seen, "total_energy");
            let drift = total.iter().map(|e| (e - total[0]).abs());
            let drift = drift.fold(0.0, f64::max);
            assert!(drift < 1e-4 * energy, "{drift} of {energy}");
        }
        let wrong = start(&[(0, crank), (3, 1.01 * rocker)]);
        let refused = resolve_start(&model, &wrong, "start").unwrap_err();
        assert!(refused.to_string().contains("closed loop"), "{refused}");
    }
}

/// A free hull carries the loop: its velocity stays, and what is named completes the rest.
#[test]
fn a_named_velocity_stays_beside_a_loop() {
    let axis = Vector3::z();
    let mut system = plane_four_bar(&Rotation3::identity(), [JointKind::Revolute { axis }; 2]);
    let free = bar("free", 1.0, AXIAL, Vector3::zeros(), Vector3::y());
    let hull = bar("hull", 5.0, AXIAL, Vector3::zeros(), Vector3::x());
    system.bodies.insert(0, hull);
    system.bodies.push(free);
    for joint in &mut system.joints {
        joint.parent = Some(joint.parent.map_or(0, |body| body + 1));
        joint.child += 1;
    }
    let model = Model::new(system, None, 1e-3, &[]).unwrap();
    assert!(model.has_loops());
    let velocity = [Vector3::new(0.1, 0.0, 0.3), Vector3::new(0.2, -0.1, 0.5)];
    for (body, rate) in [(4, None), (0, None), (0, Some(2.0))] {
        let state = BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: rate.map(|rate| (0, rate)).into_iter().collect(),
            velocities: BTreeMap::from([(body, velocity)]),
        };
        let start = resolve_start(&model, &state, "start").unwrap();
        let rates = start.rates.unwrap();
        let own = &rates[12 * body..12 * body + 3];
        let expected: Vec<f64> = velocity[0].iter().copied().collect();
        assert!(
            own.iter()
                .zip(&expected)
                .all(|(a, b)| (a - b).abs() < 1e-12)
        );
        let mut instant = placed(&model, &start.z);
        instant.l[..rates.len()].copy_from_slice(&rates);
        let found = model.joint_rate(0, &instant);
        assert!((found - rate.unwrap_or(0.0)).abs() < 1e-12, "{found}");
        let rocker = model.joint_rate(3, &instant);
        let ([_, _, expected], _) = plane(rate.unwrap_or(0.0));
        assert!((rocker - expected).abs() < 1e-12, "{rocker} {expected}");
    }
}

/// A crank of 80 mm whose angle is a sine drives a slider by a rod of 300 mm: the rates of both at the start.
#[test]
fn a_prescribed_crank_starts_its_slider() {
    let scene = std::fs::read_to_string("problems/scenes/slider_crank.json").unwrap();
    let mut scene: serde_json::Value = serde_json::from_str(&scene).unwrap();
    scene.as_object_mut().unwrap().remove("loads");
    let sine = serde_json::json!({ "sine": { "amplitude": "60 deg", "period": "1 s" } });
    scene["joints"][0]["motion"] = sine;
    scene["$schema"] = serde_json::Value::Null;
    scene.as_object_mut().unwrap().remove("$schema");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problem.json");
    let problem = serde_json::json!({
        "scene": scene, "simulate": { "duration": "20 ms", "step": "1 ms" },
    });
    std::fs::write(&path, problem.to_string()).unwrap();
    let loaded = read_problem(Path::new(&path), &[]).unwrap();
    let model = Model::new(loaded.system, None, 1.0, &[]).unwrap();
    let start = resolve_start(&model, &start(&[]), "start").unwrap();
    let mut instant = placed(&model, &start.z);
    let found = start.rates.unwrap();
    instant.l[..found.len()].copy_from_slice(&found);
    // x² + (100 + 80 sin θ)² + (120 + 80 cos θ)² = 300², where the pin moves against y.
    let crank = std::f64::consts::PI / 3.0 * std::f64::consts::TAU / 1e3;
    let slider = 100.0 * 80.0 * crank / 200.0;
    assert!(slider > 0.1);
    let rates = [0, 2].map(|joint| model.joint_rate(joint, &instant));
    assert!((rates[0] - crank).abs() < 1e-14, "{rates:?}");
    assert!(
        (rates[1].abs() - slider).abs() < 1e-10,
        "{rates:?} {slider}"
    );
}
