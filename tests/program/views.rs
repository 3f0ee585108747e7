//! Viewpoints of figures, and the parts inside their frames.

use crate::page::page_data;
use crate::report::{assert_well_formed, polylines};
use crate::runs::{problem, run, write_motion};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::system::System;
use proboscis::report::skins::Skins;
use proboscis::report::view::{View, hull};
use proboscis::report::viewpoint::Viewpoint;
use proboscis::report::{Figures, style};
use std::fs;

type Vector = Vector3<f64>;

/// The trunk as a rigid whole, turned about an axis through a point on it.
fn turning(axis: Vector) -> (System, Trajectory) {
    let system = crate::common::trunk::system(6);
    let mut trajectory = crate::common::trunk::swing(&system, 20);
    let axis = Unit::new_normalize(axis);
    for k in 0..trajectory.times.len() {
        let turn = Rotation3::from_axis_angle(&axis, 0.05 * k as f64);
        for (pose, body) in trajectory.poses[k].iter_mut().zip(&system.bodies) {
            pose.centre = turn * body.pose().centre;
            pose.directors = turn * body.directors;
        }
        for (mark, marker) in trajectory.marks[k].iter_mut().zip(&system.markers) {
            *mark = turn * marker.point.at;
        }
    }
    (system, trajectory)
}

/// Area in mm² of the hull of all places of centres and markers, as a view shows it.
fn seen(trajectory: &Trajectory, view: &View) -> f64 {
    let centres = trajectory.poses.iter().flatten().map(|pose| pose.centre);
    let all: Vec<Vector> = centres
        .chain(trajectory.marks.iter().flatten().copied())
        .collect();
    let outline = hull(view.places(&all));
    let ends = outline
        .iter()
        .zip(outline.iter().cycle().skip(1).take(outline.len()));
    0.5 * ends
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum::<f64>()
        .abs()
}

/// The view from a direction that shows most, of many.
fn best(trajectory: &Trajectory) -> f64 {
    let mut most = 0.0_f64;
    for i in 0..60 {
        for j in 0..=30 {
            let (azimuth, height) = (0.105 * f64::from(i), -1.5 + 0.1 * f64::from(j));
            let [sa, ca] = [azimuth.sin(), azimuth.cos()];
            let toward = Vector::new(sa * height.cos(), height.sin(), ca * height.cos());
            most = most.max(seen(trajectory, &View::toward(toward)));
        }
    }
    most
}

/// The trunk as a curve that leans by `lean` mm at its end, at an angle about y and to a height of its own at each instant.
fn bending(lean: impl Fn(f64) -> [f64; 2]) -> (System, Trajectory) {
    let system = crate::common::trunk::system(6);
    let mut trajectory = crate::common::trunk::swing(&system, 20);
    let length = system.markers[0].point.at.y;
    for k in 0..trajectory.times.len() {
        let [x, z] = lean(k as f64 / 20.0);
        let bent = |at: Vector| at + Vector::new(x, 0.0, z) * (at.y / length).powi(2);
        for (pose, body) in trajectory.poses[k].iter_mut().zip(&system.bodies) {
            pose.centre = bent(body.pose().centre);
        }
        for (mark, marker) in trajectory.marks[k].iter_mut().zip(&system.markers) {
            *mark = bent(marker.point.at);
        }
    }
    (system, trajectory)
}

/// Lean of a trunk in mm at a part of the motion.
type Lean<'a> = &'a dyn Fn(f64) -> [f64; 2];

#[test]
fn auto_sees_a_trunk_from_its_side_whichever_way_it_bends() {
    let ways: [(&str, Lean<'_>); 4] = [
        ("to one side", &|t| [90.0 * t, 0.0]),
        ("to both, more to x", &|t| {
            [90.0 * (7.0 * t).sin(), 40.0 * (5.0 * t).sin()]
        }),
        ("around", &|t| {
            [60.0 * (6.3 * t).sin(), 50.0 * (6.3 * t).cos()]
        }),
        ("to a diagonal", &|t| [50.0 * t, 50.0 * t]),
    ];
    for (way, lean) in ways {
        let (system, trajectory) = bending(lean);
        let moved = (0..20).map(|k| (trajectory.marks[k + 1][0] - trajectory.marks[k][0]).norm());
        assert!(moved.sum::<f64>() > 60.0, "{way}");
        let view = Viewpoint::Auto.view(&system, &trajectory, &Skins::default());
        let (found, most) = (seen(&trajectory, &view), best(&trajectory));
        assert!(found > 0.9 * most, "{way}: {found} of {most} mm²");
        assert!(view.up.y > 0.95, "{way}: {:?}", view.up);
    }
}

/// An arm of revolute joints about one axis.
#[test]
fn auto_looks_along_the_axis_of_a_planar_arm() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    assert_eq!(run(place, &["new", "arm", "arm"]).0, 0);
    let task = r#"{ "scene": "scene.json", "simulate": { "duration": "0.2 s", "step": "5 ms", "voltages": { "right1": "2.5 kV", "left3": "2.5 kV" } } }"#;
    fs::write(place.join("arm/swing.json"), task).unwrap();
    let (status, _, error) = run(
        place,
        &["simulate", "arm/swing.json", "--view", "auto", "-o", "out"],
    );
    assert_eq!(status, 0, "{error}");
    let html = fs::read_to_string(place.join("out/report.html")).unwrap();
    let scene = &page_data(&html)["scenes"][0];
    let toward: Vec<f64> = serde_json::from_value(scene["toward"].clone()).unwrap();
    assert!(toward[2].abs() > 1.0 - 1e-9, "{toward:?}");
}

#[test]
fn auto_looks_across_the_plane_of_a_motion() {
    for axis in [
        Vector::new(0.0, 0.0, 1.0),
        Vector::new(1.0, 0.0, 0.0),
        Vector::new(-1.0, 0.0, -3.0),
        Vector::new(2.0, 0.4, -1.0),
    ] {
        let (system, trajectory) = turning(axis);
        let moved = trajectory.marks[0][0] - trajectory.marks[20][0];
        assert!(moved.norm() > 50.0);
        // Points move in planes across the axis; the trunk itself lies in one of them but for the last axis.
        let view = Viewpoint::Auto.view(&system, &trajectory, &Skins::default());
        let along = view.toward.dot(&axis.normalize()).abs();
        let least = if axis.y == 0.0 { 1.0 - 1e-9 } else { 0.9 };
        assert!(along > least, "{axis:?}: {:?}", view.toward);
        assert!(seen(&trajectory, &view) > 0.9 * best(&trajectory));
        assert!((view.right.cross(&view.up) - view.toward).norm() < 1e-12);
        assert!(view.up.y > 0.0 && (view.up.norm() - 1.0).abs() < 1e-12);
    }
    // Across y it is the plane of x and z, as of figures of paths.
    let (system, mut trajectory) = turning(Vector::z());
    for k in 0..trajectory.times.len() {
        for place in &mut trajectory.marks[k] {
            *place = Vector::new(place.y, -place.z, -place.x);
        }
        for pose in &mut trajectory.poses[k] {
            let turned = |v: Vector| Vector::new(v.y, -v.z, -v.x);
            pose.centre = turned(pose.centre);
            pose.directors = Matrix3::from_columns(
                &[0, 1, 2].map(|i| turned(pose.directors.column(i).into_owned())),
            );
        }
    }
    let view = Viewpoint::Auto.view(&system, &trajectory, &Skins::default());
    assert!((view.right - Vector::x()).norm() < 1e-9 && (view.up - Vector::z()).norm() < 1e-9);
}

#[test]
fn named_views_have_their_axes() {
    let (mut system, trajectory) = turning(Vector::x());
    let [x, y, z] = [Vector::x(), Vector::y(), Vector::z()];
    let named = [Viewpoint::Front, Viewpoint::Side, Viewpoint::Top];
    // What gravity pulls along another axis stands all the same: a robot of URDF has z upwards. Along none of them it is a slope.
    for (gravity, axes) in [
        (None, [[x, y], [-z, y], [x, -z]]),
        (Some(-y), [[x, y], [-z, y], [x, -z]]),
        (Some(-z), [[x, z], [y, z], [x, y]]),
        (Some(-x), [[-y, x], [-z, x], [-y, -z]]),
        (Some(-(y + z)), [[x, y], [-z, y], [x, -z]]),
    ] {
        system.gravity = gravity;
        for (viewpoint, [right, up]) in named.into_iter().zip(axes) {
            let view = viewpoint.view(&system, &trajectory, &Skins::default());
            let apart = (view.right - right).norm() + (view.up - up).norm();
            assert!(apart < 1e-14, "{gravity:?} {viewpoint:?}: {view:?}");
        }
    }
}

/// Places of all points of an SVG and the size of its sheet, in its own units.
fn places(svg: &str) -> (Vec<[f64; 2]>, [f64; 2]) {
    let sheet = svg.split("viewBox=\"0 0 ").nth(1).unwrap();
    let sheet = sheet.split('"').next().unwrap();
    let number = |text: &str| -> f64 { text.parse().unwrap() };
    let (width, height) = sheet.split_once(' ').unwrap();
    let points = svg.split("points=\"").skip(1);
    let points = points.flat_map(|points| points.split('"').next().unwrap().split_whitespace());
    let points = points.map(|point| {
        let (x, y) = point.split_once(',').unwrap();
        [number(x), number(y)]
    });
    (points.collect(), [number(width), number(height)])
}

#[test]
fn stills_of_a_motion_are_at_equal_distances_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let arguments = [
        "simulate",
        &problem("pair_constant"),
        "-o",
        out.to_str().unwrap(),
        "--view",
        "top",
        "--export",
        "gltf",
    ];
    let (status, said, errors) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{said}{errors}");
    let svg = fs::read_to_string(out.join("snapshots.svg")).unwrap();
    assert_well_formed(&svg);
    let times = svg
        .lines()
        .map(str::trim)
        .filter_map(|line| line.strip_suffix(" s"));
    let times: Vec<f64> = times.filter_map(|text| text.parse().ok()).collect();
    let table = fs::read_to_string(out.join("trajectory.csv")).unwrap();
    let last: f64 = table
        .lines()
        .last()
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert_eq!(times.len(), 6);
    for (i, time) in times.iter().enumerate() {
        let part = i as f64 / 5.0;
        assert!(
            (1e3 * time - part * last).abs() < 0.02 * last,
            "{times:?} of {last}"
        );
    }
    let path = fs::read_to_string(out.join("tip_path.svg")).unwrap();
    assert!(path.contains("x [mm]") && path.contains("z [mm]") && !path.contains("y [mm]"));
    assert!(out.join("motion.gltf").exists());
}

#[test]
fn rest_has_its_reference_and_each_marker_a_colour_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = [
        "equilibrium",
        &problem("pair_constant"),
        "--voltages",
        "muscle2=2kV",
        "--set",
        "scene.markers=[{\"name\":\"near\",\"body\":\"segment1\",\"at\":[0,\"30 mm\",0]}]",
        "-o",
        "out",
    ];
    let (status, said, errors) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{said}{errors}");
    let svg = fs::read_to_string(folder.path().join("out/configuration.svg")).unwrap();
    assert_well_formed(&svg);
    for words in [
        "reference",
        "at rest",
        "displacement of near",
        "displacement of tip",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    // Each has its path and its line of the legend.
    for marker in 0..2 {
        assert_eq!(polylines(&svg, style::hue(marker)), 2, "marker {marker}");
    }
    assert!(!folder.path().join("out/snapshots.svg").exists());
}

#[test]
fn figures_have_room_for_the_whole_motion() {
    let system = crate::common::trunk::system(6);
    let mut trajectory = crate::common::trunk::swing(&system, 20);
    // It jumps over its own height, and is back in the end.
    for k in 5..15 {
        for pose in &mut trajectory.poses[k] {
            pose.centre.y += 600.0;
        }
        trajectory.marks[k][0].y += 600.0;
    }
    let folder = tempfile::tempdir().unwrap();
    write_motion(folder.path(), &system, &trajectory, Figures::default());
    for name in ["snapshots.svg", "configuration.svg"] {
        let svg = fs::read_to_string(folder.path().join(name)).unwrap();
        let (places, [width, height]) = places(&svg);
        // The sheet itself comes first; what would be outside of it stands on its edge.
        let inside = |[x, y]: &[f64; 2]| *x > 0.0 && *x < width && *y > 0.0 && *y < height;
        assert!(places[4..].iter().all(inside), "{name}");
        assert!(places.len() > 1000);
    }
}
