//! Closed loops whose constraints repeat each other: what is left out, against twins without redundancy and published motions.

use crate::closed_loop::{AXIAL, bar};
use crate::common::{at_reference, bare, column, distance, joint, motion, placed};
use nalgebra::{Rotation3, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{DiscreteTrajectory, Start, energies, observations};
use proboscis::model::system::{Joint, JointKind, System};
use proboscis::model::{Coordinates, Model, ModelError};

pub(crate) fn hinge(
    name: &str,
    axis: Vector3<f64>,
    parent: Option<usize>,
    child: usize,
    at: Vector3<f64>,
) -> Joint {
    joint(name, JointKind::Revolute { axis }, parent, child, at)
}

pub(crate) fn model(system: System) -> Model {
    let model = Model::new(system, None, 0.01, &[]).unwrap();
    assert_eq!(model.coordinates, Coordinates::Reduced);
    model
}

pub(crate) fn in_directors(system: System) -> Model {
    Model::new(system, Some(Coordinates::Redundant), 0.01, &[]).unwrap()
}

pub(crate) fn left_out(model: &Model) -> Vec<&str> {
    model.loops.left_out().collect()
}

/// A motion from rest, whose constraints hold to rounding, those that are left out among them.
fn falls(model: &Model, h: f64, steps: usize) -> DiscreteTrajectory {
    let start = Start::at_rest(model, at_reference(model));
    let discrete = motion(model, &start, h, steps, &[]);
    holds(model, &discrete);
    discrete
}

pub(crate) fn holds(model: &Model, discrete: &DiscreteTrajectory) {
    let seen = observations(model, discrete);
    let violation = column(&seen, "constraint_violation");
    let worst = violation.iter().copied().fold(0.0, f64::max);
    assert!(worst < 1e-12, "{worst:e}");
}

/// Crank, coupler and rocker in a plane turned by `turn`; kinds of the joints of the coupler.
pub(crate) fn plane_four_bar(turn: &Rotation3<f64>, kinds: [JointKind; 2]) -> System {
    let at = |x: f64, y: f64| turn * Vector3::new(x, y, 0.0);
    let [o, a, b, c] = [at(0.0, 0.0), at(0.3, -0.8), at(1.1, -1.0), at(1.0, 0.0)];
    let bodies = vec![
        bar("crank", 1.0, AXIAL, o, a),
        bar("coupler", 1.0, AXIAL, a, b),
        bar("rocker", 1.0, AXIAL, c, b),
    ];
    let axis = turn * Vector3::z();
    let joints = vec![
        hinge("hinge1", axis, None, 0, o),
        joint("hinge2", kinds[0], Some(0), 1, a),
        joint("hinge3", kinds[1], Some(1), 2, b),
        hinge("hinge4", axis, None, 2, c),
    ];
    bare(bodies, joints, Some(at(0.0, -9.81)))
}

#[test]
fn four_hinges_in_a_plane_move_like_two_hinges_and_two_balls() {
    for turn in [
        Rotation3::identity(),
        Rotation3::from_euler_angles(0.4, -0.9, 1.3),
        Rotation3::from_euler_angles(-1.1, 0.2, 0.7),
    ] {
        let axis = turn * Vector3::z();
        let hinges = model(plane_four_bar(&turn, [JointKind::Revolute { axis }; 2]));
        let balls = model(plane_four_bar(&turn, [JointKind::Spherical; 2]));
        let names = ["hinge4 axis 1", "hinge4 axis 2", "hinge4 point 3"];
        assert_eq!(left_out(&hinges), names);
        assert_eq!(hinges.loops.mobility, Some(1));
        assert_eq!(hinges.loops.warning, None);
        // The coupler of the twin turns about itself, too.
        assert!(left_out(&balls).is_empty());
        assert_eq!(balls.loops.mobility, Some(2));
        let run = |model: &Model| Trajectory::from_discrete(model, &falls(model, 0.01, 300));
        let (a, b) = (run(&hinges), run(&balls));
        assert!(a.joints.iter().any(|row| row[0].abs() > 0.5));
        let difference = distance(&a, &b, 1.0);
        println!("hinges against balls: {difference:e}");
        assert!(difference < 1e-10, "{difference:e}");
    }
}

#[test]
fn an_instant_that_violates_what_was_left_out_opens_the_loop() {
    let axis = Vector3::z();
    let hinges = [JointKind::Revolute { axis }; 2];
    let model = in_directors(plane_four_bar(&Rotation3::identity(), hinges));
    let mut z = at_reference(&model);
    assert_eq!(model.open_loop(&z, 1e-12), None);
    // The rocker, along the axis.
    z[2 * 12 + 2] += 0.011;
    let (name, gap) = model.open_loop(&z, 1e-7).expect("it is open");
    // Relative to the length of the system.
    assert_eq!(
        (name.as_str(), (gap - 0.01).abs() < 1e-12),
        ("hinge4 point 3", true)
    );
}

#[test]
fn two_hinges_on_one_axis_are_a_door() {
    let height = Vector3::z() * 0.5;
    let door = || bar("door", 2.0, AXIAL, Vector3::zeros(), Vector3::x());
    let down = Some(Vector3::new(0.0, -9.81, 0.0));
    let lower = hinge("lower", Vector3::z(), None, 0, -height);
    let upper = hinge("upper", Vector3::z(), None, 0, height);
    let both = model(bare(vec![door()], vec![lower.clone(), upper], down));
    assert_eq!(left_out(&both).len(), 5);
    assert_eq!(both.loops.mobility, Some(1));
    let one = bare(vec![door()], vec![lower], down);
    let one = model(one);
    assert_eq!(one.loops.mobility, None);
    let run = |model: &Model| Trajectory::from_discrete(model, &falls(model, 0.01, 200));
    let (a, b) = (run(&both), run(&one));
    assert!(b.joints.iter().any(|row| row[0].abs() > 1.0));
    assert!(distance(&a, &b, 1.0) < 1e-11);
}

#[test]
fn axes_that_are_not_quite_parallel_are_refused() {
    let tilted = |angle: f64| {
        let axis = Vector3::new(angle.sin(), 0.0, angle.cos());
        let kinds = [
            JointKind::Revolute { axis: Vector3::z() },
            JointKind::Revolute { axis },
        ];
        Model::new(
            plane_four_bar(&Rotation3::identity(), kinds),
            None,
            0.01,
            &[],
        )
    };
    for angle in [1e-4, 1e-6] {
        let error = tilted(angle).err();
        let Some(ModelError::OpenLoop { joints, gap }) = &error else {
            panic!("tilt {angle}: {error:?}");
        };
        println!("tilt {angle}: a gap of {gap:e}");
        assert_eq!(joints, "\"hinge4\"");
        assert!(*gap > 1e-4 * angle && *gap < angle, "{gap:e}");
    }
    // Farther apart they make a frame in which nothing moves.
    let frame = tilted(0.1).unwrap();
    assert_eq!(frame.loops.mobility, Some(0));
    assert!(
        frame
            .loops
            .warning
            .is_some_and(|text| text.contains("no degree of freedom"))
    );
    // What rounding makes of an axis is none.
    assert_eq!(left_out(&tilted(1e-12).unwrap()).len(), 3);
}

#[test]
fn bars_in_line_are_warned_about() {
    // A parallelogram laid flat: a second motion branches off, in which the bars cross.
    let place = |x: f64| Vector3::new(x, 0.0, 0.0);
    let z = Vector3::z();
    let bodies = vec![
        bar("crank", 1.0, AXIAL, place(0.0), place(1.0)),
        bar("coupler", 1.0, AXIAL, place(1.0), place(3.0)),
        bar("rocker", 1.0, AXIAL, place(2.0), place(3.0)),
    ];
    let joints = vec![
        hinge("hinge1", z, None, 0, place(0.0)),
        hinge("hinge2", z, Some(0), 1, place(1.0)),
        hinge("hinge3", z, Some(1), 2, place(3.0)),
        hinge("hinge4", z, None, 2, place(2.0)),
    ];
    let flat = model(bare(bodies, joints, None));
    assert_eq!(left_out(&flat).len(), 3);
    assert_eq!(flat.loops.mobility, Some(1));
    let warning = flat.loops.warning.as_deref().unwrap_or_default();
    assert!(
        warning.contains("2 degrees of freedom there and 1 along the motion"),
        "{warning}"
    );
    // Two bars stretched between the ground and the ground: they yield to first order only.
    let bodies = vec![
        bar("left", 1.0, AXIAL, place(0.0), place(1.0)),
        bar("right", 1.0, AXIAL, place(1.0), place(2.0)),
    ];
    let joints = vec![
        hinge("hinge1", z, None, 0, place(0.0)),
        hinge("hinge2", z, Some(0), 1, place(1.0)),
        hinge("hinge3", z, None, 1, place(2.0)),
    ];
    let taut = model(bare(bodies, joints, None));
    assert_eq!(left_out(&taut).len(), 3);
    let warning = taut.loops.warning.as_deref().unwrap_or_default();
    assert!(warning.contains("first order"), "{warning}");
}

#[test]
fn a_sarrus_linkage_leads_its_platform_along_a_line() {
    // Two chains of three hinges, about x and about y.
    let at = Vector3::new;
    let chain = [
        [at(0.0, 1.0, 0.0), at(0.0, 1.6, 0.6), at(0.0, 1.0, 1.1)],
        [at(1.0, 0.0, 0.0), at(1.5, 0.0, 0.4), at(1.0, 0.0, 1.1)],
    ];
    let mut bodies = vec![bar(
        "platform",
        2.0,
        0.2,
        at(-0.2, 0.0, 1.1),
        at(0.3, 0.0, 1.1),
    )];
    let mut joints = Vec::new();
    for ([low, middle, high], axis) in chain.into_iter().zip([Vector3::x(), Vector3::y()]) {
        let first = bodies.len();
        let name = |part: &str| format!("{part}{first}");
        bodies.push(bar(&name("lower"), 1.0, AXIAL, low, middle));
        bodies.push(bar(&name("upper"), 1.0, AXIAL, middle, high));
        joints.push(hinge(&name("foot"), axis, None, first, low));
        joints.push(hinge(&name("knee"), axis, Some(first), first + 1, middle));
        joints.push(hinge(&name("hip"), axis, Some(first + 1), 0, high));
    }
    let sarrus = model(bare(bodies, joints, Some(at(0.0, 0.0, -9.81))));
    assert_eq!(left_out(&sarrus).len(), 1);
    assert_eq!(sarrus.loops.mobility, Some(1));
    let motion = Trajectory::from_discrete(&sarrus, &falls(&sarrus, 0.005, 80));
    let platform: Vec<_> = motion.poses.iter().map(|poses| poses[0]).collect();
    let (first, last) = (platform[0], platform[80]);
    assert!(last.centre.z < first.centre.z - 0.3);
    for pose in &platform {
        let aside = (pose.centre - first.centre).xy().amax();
        let turned = (pose.directors - first.directors).amax();
        assert!(aside < 1e-12 && turned < 1e-12, "{aside:e} {turned:e}");
    }
}

#[test]
fn the_bricard_mechanism_has_one_degree_of_freedom() {
    // IFToMM A04: five rods of 1 m and 1 kg on six hinges.
    let at = Vector3::new;
    let places = [
        at(0.0, 0.0, 0.0),
        at(1.0, 0.0, 0.0),
        at(1.0, -1.0, 0.0),
        at(1.0, -1.0, 1.0),
        at(0.0, -1.0, 1.0),
        at(0.0, 0.0, 1.0),
    ];
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let axes = [y, z, x, y, z, x];
    let names = ["rod1", "rod2", "rod3", "rod4", "rod5"];
    let axial = 0.1_f64.powi(2) / 6.0;
    let rods = (0..5).map(|i| bar(names[i], 1.0, axial, places[i], places[i + 1]));
    let hinges = (0..6_usize).map(|i| {
        let parent = i.checked_sub(1);
        let name = format!("hinge{}", i + 1);
        match i {
            5 => hinge(&name, axes[i], None, 4, places[i]),
            _ => hinge(&name, axes[i], parent, i, places[i]),
        }
    });
    let bricard = model(bare(rods.collect(), hinges.collect(), Some(-9.81 * y)));
    assert_eq!(bricard.loops.mobility, Some(1));
    // The one that is nowhere needed to hold the others.
    assert_eq!(left_out(&bricard), ["hinge6 axis 1"]);
    let drifts = [0.02, 0.01].map(|h| {
        let steps = (10.0 / h) as usize;
        let discrete = falls(&bricard, h, steps);
        let energy = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| placed(&bricard, &discrete.z[k]));
            energies(&bricard, &a, &b, &[], h)
        };
        let rest = placed(&bricard, &discrete.z[0]);
        let initial = energies(&bricard, &rest, &rest, &[], h).total();
        let all: Vec<_> = (0..steps).map(energy).collect();
        assert!(all.iter().any(|e| e.kinetic > 1.0));
        let errors = all.iter().map(|e| (e.total() - initial).abs());
        errors.fold(0.0, f64::max)
    });
    println!("energy of the Bricard mechanism over 10 s: {drifts:?}");
    assert!(((drifts[0] / drifts[1]).log2() - 2.0).abs() < 0.2);
}
