//! Universal, cylindrical and planar joints: against hinges and slides in a row, in all coordinates, from either side.

use crate::common::pairs::pairs;
use crate::common::random::Random;
use crate::common::{at_reference, bare, body, distance, joint, motion, placed, richardson, spin};
use nalgebra::{Matrix3, Vector3};
use proboscis::control::problem::BoundaryState;
use proboscis::control::resolve_start;
use proboscis::dynamics::Start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::system::{Body, Joint, JointKind, System};
use proboscis::model::{Coordinates, Model, Screw};
use std::collections::BTreeMap;

const AT: Vector3<f64> = Vector3::new(0.2, -0.1, 0.3);
/// Mass and moments of inertia of a body between two joints of the twin.
const NEARLY_NONE: f64 = 1e-14;

fn kinds() -> [JointKind; 3] {
    let normal = Vector3::new(0.48, 0.6, 0.64);
    let across = Vector3::new(0.8, 0.0, -0.6);
    [
        JointKind::Universal {
            axes: [normal, across],
        },
        JointKind::Cylindrical { axis: normal },
        JointKind::Planar { normal },
    ]
}

/// A body on joints in a row at one point, and a second one on a hinge behind it.
fn robot(kinds: &[JointKind]) -> System {
    let centre = Vector3::new(0.5, 0.3, 0.1);
    let between = |i: usize| {
        body(
            &format!("between{i}"),
            NEARLY_NONE,
            [NEARLY_NONE; 3],
            AT,
            Matrix3::identity(),
        )
    };
    let mut bodies: Vec<Body> = (1..kinds.len()).map(between).collect();
    let first = bodies.len();
    bodies.push(body(
        "near",
        2.0,
        [0.3, 0.5, 0.7],
        centre,
        Matrix3::identity(),
    ));
    bodies.push(body(
        "far",
        1.0,
        [0.2, 0.3, 0.4],
        centre * 2.0,
        Matrix3::identity(),
    ));
    let on = |(i, kind): (usize, &JointKind)| -> Joint {
        joint(&format!("joint{i}"), *kind, i.checked_sub(1), i, AT)
    };
    let mut joints: Vec<Joint> = kinds.iter().enumerate().map(on).collect();
    let axis = Vector3::y();
    joints.push(joint(
        "hinge",
        JointKind::Revolute { axis },
        Some(first),
        first + 1,
        centre * 1.4,
    ));
    bare(bodies, joints, Some(Vector3::new(0.0, 0.0, -1.0)))
}

/// One joint for each screw.
fn in_a_row(kind: JointKind) -> Vec<JointKind> {
    let one = |screw: &Screw| match *screw {
        Screw::Turn(axis) => JointKind::Revolute { axis },
        Screw::Slide(axis) => JointKind::Prismatic { axis },
    };
    kind.screws().0.iter().map(one).collect()
}

/// Rates of the directors of both bodies, of which the joint between them rests.
fn director_rates(model: &Model, kind: JointKind, rates: &[f64]) -> Vec<f64> {
    let (screws, _) = kind.screws();
    let poses = model.reference.iter();
    let of = |pose: &proboscis::kinematics::Pose| {
        let (mut velocity, mut omega) = (Vector3::zeros(), Vector3::zeros());
        for (screw, &rate) in screws.iter().zip(rates) {
            match screw {
                Screw::Turn(axis) => {
                    omega += axis * rate;
                    velocity += axis.cross(&(pose.centre - AT)) * rate;
                }
                Screw::Slide(axis) => velocity += axis * rate,
            }
        }
        spin(pose, velocity, omega)
    };
    poses.flat_map(of).collect()
}

#[test]
fn pairs_move_like_hinges_and_slides_in_a_row() {
    let mut random = Random(5);
    for kind in kinds() {
        let build = |kinds: &[JointKind], coordinates| {
            Model::new(robot(kinds), Some(coordinates), 0.01, &[]).unwrap()
        };
        let reduced = build(&[kind], Coordinates::Reduced);
        let redundant = build(&[kind], Coordinates::Redundant);
        let twin = build(&in_a_row(kind), Coordinates::Reduced);
        let mut rates: Vec<f64> = (0..kind.freedoms()).map(|_| 2.0 * random.unit()).collect();
        assert!(rates.iter().all(|rate| rate.abs() > 0.01));
        let directors = director_rates(&redundant, kind, &rates);
        rates.push(0.0);
        let run = |model: &Model, rates: &[f64]| {
            let start = Start::with_rates(model, at_reference(model), rates);
            let discrete = motion(model, &start, 0.01, 200, &[]);
            Trajectory::from_discrete(model, &discrete)
        };
        let moved = run(&reduced, &rates);
        let same = run(&redundant, &directors);
        let mut row = run(&twin, &rates);
        same_columns(&moved, &row, kind);
        for poses in &mut row.poses {
            poses.drain(..kind.freedoms() - 1);
        }
        let first = moved.poses[0][1].centre;
        assert!(
            moved
                .poses
                .iter()
                .any(|poses| (poses[1].centre - first).norm() > 1.0)
        );
        let apart = [distance(&moved, &same, 1.0), distance(&moved, &row, 1.0)];
        println!(
            "{kind:?}: redundant {:e}, in a row {:e}",
            apart[0], apart[1]
        );
        assert!(apart[0] < 1e-10 && apart[1] < 1e-10, "{apart:?}");
    }
}

/// Compares the coordinates of a joint in tables with those of hinges and slides in a row.
fn same_columns(moved: &Trajectory, row: &Trajectory, kind: JointKind) {
    let columns = moved.observe(&robot(&[kind])).columns;
    let of_joint: Vec<_> = columns
        .iter()
        .filter(|column| column.name.starts_with("joint0_"))
        .collect();
    assert_eq!(of_joint.len(), kind.freedoms());
    let turns = [0.0, 2.0 * std::f64::consts::PI];
    for (i, column) in of_joint.into_iter().enumerate() {
        let greatest = column.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        println!("{} reaches {greatest} {}", column.name, column.unit);
        assert!(greatest > 0.1, "{}", column.name);
        for (value, joints) in column.values.iter().zip(&row.joints) {
            let apart = (value - joints[i]).abs();
            let apart = turns.map(|turn| (apart - turn).abs());
            assert!(apart[0].min(apart[1]) < 1e-9, "{}: {apart:?}", column.name);
        }
        let steps = column.values.windows(2).map(|w| (w[1] - w[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 1.0, "{} jumps", column.name);
    }
}

#[test]
fn pairs_move_alike_from_either_side_and_in_all_coordinates() {
    let run = |system: System, coordinates| {
        let model = Model::new(system, Some(coordinates), 0.2, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let inputs = vec![1500.0; model.sources.len()];
        let discrete = motion(&model, &start, 0.2, 100, &model.scalars(&inputs));
        Trajectory::from_discrete(&model, &discrete)
    };
    let moved = run(pairs(), Coordinates::Reduced);
    let first = moved.poses[0][2].centre;
    assert!(
        moved
            .poses
            .iter()
            .any(|poses| (poses[2].centre - first).norm() > 1.0)
    );
    let same = run(pairs(), Coordinates::Redundant);
    let mut turned = pairs();
    for joint in &mut turned.joints[1..] {
        let parent = joint.parent.replace(joint.child);
        joint.child = parent.unwrap();
    }
    let turned = run(turned, Coordinates::Reduced);
    let apart = [
        distance(&moved, &same, 100.0),
        distance(&moved, &turned, 100.0),
    ];
    println!(
        "redundant {:e}, from the other side {:e}",
        apart[0], apart[1]
    );
    assert!(apart[0] < 1e-10 && apart[1] < 1e-10, "{apart:?}");
}

#[test]
fn coordinates_of_pairs_follow_from_poses() {
    let model = Model::new(pairs(), None, 1.0, &[]).unwrap();
    assert_eq!(model.coordinates, Coordinates::Reduced);
    assert_eq!(model.coordinate_count(), 2 + 2 + 3);
    let names: Vec<String> = (0..7)
        .map(|i| model.variables.unknown(i).to_string())
        .collect();
    assert_eq!(names[0], "rotation about x of joint1");
    assert_eq!(names[1], "rotation about axis 2 of joint1");
    let mut random = Random(3);
    for _ in 0..5 {
        let mut z = at_reference(&model);
        z.iter_mut().for_each(|value| *value = 1.4 * random.unit());
        let poses = model.poses(&placed(&model, &z));
        let found = model.coordinates_of_poses(&poses, &[0.0; 3]);
        let apart = z.iter().zip(&found).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-12, "{z:?} {found:?}");
    }
}

#[test]
fn a_spatial_slider_crank_on_a_universal_joint_moves_as_published() {
    // IFToMM benchmark in SI units: crank on a hinge about x, ball, rod, universal joint, slider along x. Place of the slider
    // at 0.5 s by an exact reduction to one degree of freedom; F. González has 0.184952803 there.
    let exact = 0.184952630;
    let x = Vector3::x();
    let [hinge, ball, slider] = [
        Vector3::new(0.0, 0.1, 0.12),
        Vector3::new(0.0, 0.1, 0.2),
        Vector3::new(0.2, 0.0, 0.0),
    ];
    let along = (slider - ball).normalize();
    let across = x.cross(&along).normalize();
    let directors = Matrix3::from_columns(&[along, across, along.cross(&across)]);
    let one = Matrix3::identity();
    let bodies = vec![
        body("crank", 0.12, [1e-4, 1e-4, 1e-5], 0.5 * (hinge + ball), one),
        body(
            "rod",
            0.5,
            [4e-4, 4e-3, 4e-3],
            0.5 * (ball + slider),
            directors,
        ),
        body("slider", 2.0, [1e-4; 3], slider, one),
    ];
    let axes = [x, across];
    let joints = vec![
        joint("drive", JointKind::Revolute { axis: x }, None, 0, hinge),
        joint("ball", JointKind::Spherical, Some(0), 1, ball),
        joint("guide", JointKind::Prismatic { axis: x }, None, 2, slider),
        joint("cross", JointKind::Universal { axes }, Some(2), 1, slider),
    ];
    let system = bare(bodies, joints, Some(Vector3::z() * -9.81));
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let model = Model::new(system.clone(), Some(coordinates), 0.005, &[]).unwrap();
        assert!(model.loops.is_empty() && model.loops.mobility == Some(1));
        let start = match coordinates {
            // The others follow from the rate of the crank.
            Coordinates::Reduced => {
                let state = BoundaryState::JointAngles {
                    angles: BTreeMap::new(),
                    rates: BTreeMap::from([(0, 6.0)]),
                    velocities: BTreeMap::new(),
                };
                resolve_start(&model, &state).unwrap()
            }
            Coordinates::Redundant => {
                let of_rod = Vector3::new(1.92, -0.96, 0.48);
                let [crank, rod, block] = [0, 1, 2].map(|b| &model.reference[b]);
                let turn = 6.0 * x;
                let passes = turn.cross(&(ball - hinge)) + of_rod.cross(&(rod.centre - ball));
                let rates = [
                    spin(crank, turn.cross(&(crank.centre - hinge)), turn),
                    spin(rod, passes, of_rod),
                    spin(block, 0.24 * x, Vector3::zeros()),
                ];
                Start::with_rates(&model, at_reference(&model), &rates.concat())
            }
        };
        let places = [200, 400, 800].map(|steps| {
            let discrete = motion(&model, &start, 0.5 / steps as f64, steps, &[]);
            let motion = Trajectory::from_discrete(&model, &discrete);
            motion.poses[steps][2].centre.x
        });
        let errors = places.map(|place| (place - exact).abs());
        let limit = (richardson(&places) - exact).abs();
        println!("slider-crank: {exact} by {errors:?}, limit {limit:e}");
        assert!(((errors[1] / errors[2]).log2() - 2.0).abs() < 0.2);
        assert!(limit < 1e-8, "{limit:e}");
    }
}
