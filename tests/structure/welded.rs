//! Welded and fixed bodies leave no unknown.

use crate::common::cases::joints;
use crate::common::systems::{GRAVITY, branched};
use crate::common::{bare, body, joint, placed, trunk};
use crate::presolved::{BOTH, moved, names, under};
use nalgebra::{Matrix3, Vector3};
use proboscis::model::system::{Body, JointKind};
use proboscis::model::{Analysis, BodyLocation, Coordinates, Model, Role};

/// A box of edges along the axes.
pub(crate) fn cuboid(name: &str, mass: f64, size: [f64; 3], centre: Vector3<f64>) -> Body {
    let [a, b, c] = size.map(|edge| edge * edge * mass / 12.0);
    body(
        name,
        mass,
        [b + c, c + a, a + b],
        centre,
        Matrix3::identity(),
    )
}

fn multipliers(model: &Model) -> usize {
    model.variables.count(Role::Multiplier)
}

#[test]
fn two_welded_halves_move_like_the_whole() {
    let whole = [10.0, 40.0, 20.0];
    let half = [10.0, 20.0, 20.0];
    let at = |y: f64| Vector3::new(0.0, y, 3.0);
    let axis = Vector3::new(0.6, 0.0, 0.8);
    let root = |child| {
        joint(
            "root",
            JointKind::Revolute { axis },
            None,
            child,
            Vector3::zeros(),
        )
    };
    let one = bare(
        vec![cuboid("all", 60.0, whole, at(20.0))],
        vec![root(0)],
        Some(GRAVITY),
    );
    let halves = vec![
        cuboid("far", 30.0, half, at(30.0)),
        cuboid("near", 30.0, half, at(10.0)),
    ];
    let weld = joint("weld", JointKind::Fixed, Some(1), 0, at(20.0));
    let two = bare(halves, vec![weld, root(1)], Some(GRAVITY));
    for coordinates in BOTH {
        let mut task = under(Vec::new(), coordinates);
        task.start = joints(&[(0, 0.9)]);
        let (model, expected) = moved(&one, &task);
        task.start = joints(&[(1, 0.9)]);
        let (welded, found) = moved(&two, &task);
        // One body: 12 coordinates, 6 constraints of its own and 5 of the joint.
        if coordinates == Coordinates::Redundant {
            assert_eq!((welded.coordinate_count(), multipliers(&welded)), (12, 11));
        }
        assert_eq!(welded.coordinate_count(), model.coordinate_count());
        let place = |model: &Model, z: &[f64]| model.poses(&placed(model, z));
        let (mut way, mut worst) = (0.0_f64, 0.0_f64);
        for (a, b) in expected.z.iter().zip(&found.z) {
            let (all, parts) = (place(&model, a)[0], place(&welded, b));
            let middle = (parts[0].centre + parts[1].centre) * 0.5;
            worst = worst.max((all.centre - middle).norm());
            for part in &parts {
                worst = worst.max((part.directors - all.directors).norm());
            }
            let between = parts[0].centre - parts[1].centre;
            worst = worst.max((between - all.directors * Vector3::new(0.0, 20.0, 0.0)).norm());
            way = way.max((all.centre - place(&model, &expected.z[0])[0].centre).norm());
        }
        assert!(way > 1.0 && worst < 1e-9, "{way} {worst}");
    }
}

#[test]
fn welded_and_fixed_bodies_have_no_unknown() {
    // The cap of the branched tree sits on its slider: three bodies, two revolute joints and a slider of 5 constraints each.
    let redundant = Analysis {
        coordinates: Some(Coordinates::Redundant),
        ..Analysis::of_motion(1.0)
    };
    let model = Model::for_analysis(branched(), redundant.clone()).unwrap();
    assert_eq!(model.coordinate_count(), 3 * 12);
    assert_eq!(multipliers(&model), 3 * 6 + 3 * 5);
    assert!(matches!(
        model.presolved.bodies[3],
        BodyLocation::Welded { to: 1, .. }
    ));
    let there = names(&model);
    assert!(there.contains("joint points") && there.contains("rigid bodies"));

    // A body that is fixed to the ground is ground, whichever way its joint and the next one are written.
    for flipped in [false, true] {
        let mut fixed = trunk(3);
        fixed.joints[0].kind = JointKind::Fixed;
        // Muscles between two points of the ground do nothing.
        fixed.muscles.drain(..2);
        if flipped {
            let joint = &mut fixed.joints[1];
            (joint.parent, joint.child) = (Some(1), 0);
        }
        let mut expected = trunk(3);
        expected.muscles.drain(..2);
        expected.bodies.remove(0);
        expected.joints.remove(0);
        let ground = |b: Option<usize>| b.and_then(|b| b.checked_sub(1));
        for joint in &mut expected.joints {
            (joint.parent, joint.child) = (ground(joint.parent), joint.child - 1);
        }
        for muscle in &mut expected.muscles {
            (muscle.from.body, muscle.to.body) = (ground(muscle.from.body), ground(muscle.to.body));
        }
        expected.markers[0].point.body = Some(1);
        for coordinates in BOTH {
            let task = under(vec![0.0, 900.0, 800.0, 0.0], coordinates);
            let ((model, found), (other, by_hand)) =
                (moved(&fixed, &task), moved(&expected, &task));
            assert_eq!(model.coordinate_count(), other.coordinate_count());
            assert_eq!(multipliers(&model), multipliers(&other));
            assert_eq!(model.presolved.bodies[0], BodyLocation::Ground);
            if !flipped {
                assert_eq!(found.z, by_hand.z);
            } else {
                // The joint goes the other way round.
                let tips = [(&model, &found), (&other, &by_hand)].map(|(model, discrete)| {
                    let z = &discrete.z[20];
                    placed(model, z).x[model.markers[0]]
                });
                assert!((tips[0] - Vector3::new(0.0, 150.0, 0.0)).norm() > 0.1);
                let mirrored = model.joints(&placed(&model, &found.z[20]), &[0.0; 3]);
                let straight = other.joints(&placed(&other, &by_hand.z[20]), &[0.0; 2]);
                assert!((tips[0] - tips[1]).norm() < 1e-8);
                assert!((mirrored[1] + straight[0]).abs() < 1e-10 && straight[0].abs() > 1e-4);
            }
        }
    }
}
