//! Rates of closed loops at a start: completed from those of one joint, against plane geometry.

use crate::closed_loop::{AXIAL, bar};
use crate::common::random::Random;
use crate::common::{column, motion, placed};
use crate::redundant_loops::plane_four_bar;
use nalgebra::{DMatrix, DVector, Matrix2, Rotation3, Vector2, Vector3};
use proboscis::control::problem::BoundaryState;
use proboscis::control::resolve_start;
use proboscis::dynamics::observations;
use proboscis::files::read_problem;
use proboscis::model::system::JointKind;
use proboscis::model::{Coordinates, Model};
use serde_json::json;
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
            let start = resolve_start(&model, &start(&rates)).unwrap();
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
        let refused = resolve_start(&model, &wrong).unwrap_err();
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
    let model = Model::new(system, Some(Coordinates::Redundant), 1e-3, &[]).unwrap();
    assert!(model.has_loops());
    let velocity = [Vector3::new(0.1, 0.0, 0.3), Vector3::new(0.2, -0.1, 0.5)];
    for (body, rate) in [(4, None), (0, None), (0, Some(2.0))] {
        let state = BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: rate.map(|rate| (0, rate)).into_iter().collect(),
            velocities: BTreeMap::from([(body, velocity)]),
        };
        let start = resolve_start(&model, &state).unwrap();
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
    let start = resolve_start(&model, &start(&[])).unwrap();
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

/// A plane linkage: points of its joints and the two bodies of each, of which none is the ground, and centre, mass and inertia of its bodies.
struct Linkage {
    joints: Vec<(Vector2<f64>, Option<usize>, usize)>,
    bodies: Vec<(Vector2<f64>, f64, f64)>,
}

impl Linkage {
    /// A four-bar with a second loop on its coupler, and a pendulum on it.
    fn random(random: &mut Random) -> Self {
        let near = |random: &mut Random, x: f64, y: f64| {
            Vector2::new(x, y) + 8.0 * Vector2::new(random.unit(), random.unit())
        };
        let mut at = |x, y| near(random, x, y);
        let points = [
            (at(0.0, 0.0), None, 0),
            (at(5.0, 40.0), Some(0), 1),
            (at(60.0, 45.0), Some(1), 2),
            (at(70.0, -5.0), None, 2),
            (at(40.0, 50.0), Some(1), 3),
            (at(45.0, 90.0), Some(3), 4),
            (at(100.0, 60.0), None, 4),
            (at(30.0, 45.0), Some(1), 5),
        ];
        let joints = points.to_vec();
        let bodies = (0..6).map(|body| {
            let own = joints
                .iter()
                .filter(|joint| joint.1 == Some(body) || joint.2 == body);
            let own: Vec<Vector2<f64>> = own.map(|joint| joint.0).collect();
            let mean = own.iter().sum::<Vector2<f64>>() / own.len() as f64;
            let centre = mean + 5.0 * Vector2::new(random.unit(), random.unit());
            (centre, random.between(5.0, 30.0), random.between(1e3, 1e4))
        });
        let bodies = bodies.collect();
        Self { joints, bodies }
    }

    /// Rate of each joint with the least kinetic energy, where those of some are given: by the velocity and the turn of every body as unknowns and
    /// two conditions at each joint.
    fn least(&self, given: &[(usize, f64)]) -> Vec<f64> {
        let (unknowns, conditions) = (3 * self.bodies.len(), 2 * self.joints.len() + given.len());
        let mut matrix = DMatrix::zeros(unknowns + conditions, unknowns + conditions);
        let mut right = DVector::zeros(unknowns + conditions);
        for (b, &(_, mass, inertia)) in self.bodies.iter().enumerate() {
            for (i, value) in [mass, mass, inertia].into_iter().enumerate() {
                matrix[(3 * b + i, 3 * b + i)] = value;
            }
        }
        let mut set = |row: usize, column: usize, value: f64| {
            matrix[(unknowns + row, column)] = value;
            matrix[(column, unknowns + row)] = value;
        };
        for (j, &(point, parent, child)) in self.joints.iter().enumerate() {
            for (body, sign) in [(Some(child), 1.0), (parent, -1.0)] {
                let Some(body) = body else { continue };
                let arm = point - self.bodies[body].0;
                for (axis, turn) in [-arm.y, arm.x].into_iter().enumerate() {
                    set(2 * j + axis, 3 * body + axis, sign);
                    set(2 * j + axis, 3 * body + 2, sign * turn);
                }
            }
        }
        for (k, &(j, rate)) in given.iter().enumerate() {
            let (_, parent, child) = self.joints[j];
            let row = 2 * self.joints.len() + k;
            set(row, 3 * child + 2, 1.0);
            if let Some(parent) = parent {
                set(row, 3 * parent + 2, -1.0);
            }
            right[unknowns + row] = rate;
        }
        let found = matrix.lu().solve(&right).unwrap();
        let turn = |body: Option<usize>| body.map_or(0.0, |body| found[3 * body + 2]);
        let rates = self.joints.iter();
        rates
            .map(|&(_, parent, child)| turn(Some(child)) - turn(parent))
            .collect()
    }

    /// The linkage as a scene whose joints are in some order, some of them from the child to the parent, where `motions` prescribes rates.
    fn model(&self, order: &[usize], turned: &[bool], motions: &[(usize, f64)]) -> Model {
        let name = |body: Option<usize>| body.map_or("ground".to_owned(), |b| format!("b{b}"));
        let place = |at: Vector2<f64>| json!([1e-3 * at.x, 1e-3 * at.y, 0.0]);
        let joints = order.iter().map(|&j| {
            let (at, parent, child) = self.joints[j];
            let ends = match parent {
                Some(parent) if turned[j] => [name(Some(child)), name(Some(parent))],
                _ => [name(parent), name(Some(child))],
            };
            let mut joint = json!({
                "name": format!("j{j}"), "revolute": { "axis": [0, 0, 1] }, "at": place(at), "parent": ends[0], "child": ends[1],
            });
            if let Some((_, rate)) = motions.iter().find(|motion| motion.0 == j) {
                let amplitude = rate / std::f64::consts::TAU;
                joint["motion"] = json!({ "sine": { "amplitude": amplitude, "period": 1e-3 } });
            }
            joint
        });
        let bodies = self.bodies.iter().enumerate().map(|(b, &(centre, mass, inertia))| {
            json!({
                "name": name(Some(b)), "mass": 1e-3 * mass, "position": place(centre), "sphere": { "radius": "5 mm" },
                "inertia": [1e-9 * inertia, 1e-9 * inertia, 1e-9 * inertia],
            })
        });
        let scene = json!({ "name": "linkage", "bodies": bodies.collect::<Vec<_>>(), "joints": joints.collect::<Vec<_>>() });
        let system = crate::component_files::read(&scene.to_string()).unwrap();
        Model::new(system, None, 1.0, &[]).unwrap()
    }
}

/// Rates of the joints of a linkage at the start, whatever the order of the joints, have the least kinetic energy.
#[test]
fn open_rates_have_the_least_kinetic_energy_in_every_order_of_joints() {
    let mut random = Random(62);
    for _ in 0..12 {
        let linkage = Linkage::random(&mut random);
        let count = linkage.joints.len();
        for (named, motions) in [
            (vec![(0, 0.004)], vec![]),
            (vec![(4, -0.003)], vec![]),
            (vec![(7, 0.005)], vec![]),
            (vec![(5, 0.002), (7, 0.001)], vec![]),
            (vec![], vec![(3, 0.004)]),
            (vec![(6, 0.002)], vec![(7, 0.003)]),
        ] {
            let given: Vec<(usize, f64)> = named.iter().chain(&motions).copied().collect();
            // The linkage has two degrees of freedom and the pendulum.
            let expected = linkage.least(&given);
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_by_key(|_| (1e9 * random.unit()) as i64);
            let turned: Vec<bool> = (0..count).map(|_| random.unit() > 0.3).collect();
            let turned: Vec<bool> = match motions.is_empty() {
                true => turned,
                false => vec![false; count],
            };
            let model = linkage.model(&order, &turned, &motions);
            assert!(model.has_loops());
            let sign = |j: usize| match linkage.joints[j].1 {
                Some(_) if turned[j] => -1.0,
                _ => 1.0,
            };
            let place = |j: usize| order.iter().position(|&o| o == j).unwrap();
            let named: Vec<_> = named
                .iter()
                .map(|&(j, rate)| (place(j), sign(j) * rate))
                .collect();
            let start = resolve_start(&model, &start(&named)).unwrap();
            let mut instant = placed(&model, &start.z);
            let found = start.rates.unwrap();
            instant.l[..found.len()].copy_from_slice(&found);
            let size = expected
                .iter()
                .fold(0.0_f64, |size, rate| size.max(rate.abs()));
            let moving = model.moving_joints();
            assert!(moving.len() >= 6);
            for j in (0..count).filter(|&j| moving.contains(&place(j))) {
                let rate = sign(j) * model.joint_rate(place(j), &instant);
                let off = (rate - expected[j]).abs();
                assert!(
                    off < 1e-9 * size,
                    "{given:?} {order:?} joint {j}: {rate} {expected:?}"
                );
            }
        }
    }
}
