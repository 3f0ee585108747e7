//! Robots from URDF: shapes, frames without a mass, parts that are left out, mistakes, and texts of any kind.

use crate::scene::folder;
use nalgebra::{Matrix3, Vector3};
use proboscis::files::urdf::{FromUrdf, parse_urdf, read_urdf};
use proboscis::files::{read_scene, stl};
use proboscis::mesh::triangulated::Surface;
use proboscis::model::System;
use proboscis::model::system::{JointKind, Shape};
use proptest::prelude::*;
use proptest::sample::Index;
use std::fs;
use std::path::Path;

const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"/>
  <link name="base">
    <inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
  </link>
  <link name="turned">
    <inertial><origin xyz="0 0 0.2"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.002"/></inertial>
    <visual><origin xyz="0 0 0.2"/><geometry><box size="0.1 0.2 0.4"/></geometry></visual>
    <collision><geometry><box size="0.1 0.2 0.4"/></geometry></collision>
  </link>
  <link name="flange"><visual><origin xyz="0 0 0.05"/><geometry><cylinder radius="0.05" length="0.1"/></geometry></visual></link>
  <link name="slide">
    <inertial><mass value="0.5"/><inertia ixx="0.001" iyy="0.001" izz="0.001"/></inertial>
    <visual><geometry><mesh filename="package://arm/part.stl" scale="0.001 0.001 0.002"/></geometry></visual>
  </link>
  <joint name="j1" type="revolute">
    <origin xyz="0 0 0.3" rpy="0 1.5707963267948966 0"/><parent link="base"/><child link="turned"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/><dynamics damping="0.1" friction="0.2"/>
  </joint>
  <joint name="j2" type="fixed"><origin xyz="0 0 0.4"/><parent link="turned"/><child link="flange"/></joint>
  <joint name="j3" type="prismatic"><origin xyz="0 0 0.1"/><parent link="flange"/><child link="slide"/><axis xyz="0 1 0"/><mimic joint="j1"/></joint>
  <transmission name="t"/>
</robot>"#;

/// The system of a URDF file.
fn system(found: &FromUrdf) -> System {
    let (folder, _) = folder(&found.scene, "{}");
    fs::create_dir(folder.path().join("meshes")).unwrap();
    for (name, bytes) in &found.meshes {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let read = read_scene(&folder.path().join("scene.json"));
    read.unwrap_or_else(|error| panic!("{error}\n{}", found.scene))
}

/// The robot with a box of 10 × 20 × 30 as its mesh.
fn arm() -> FromUrdf {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("arm/urdf");
    fs::create_dir_all(&inside).unwrap();
    let mut part = Surface::default();
    let axes = [Vector3::x() * 5.0, Vector3::y() * 10.0, Vector3::z() * 15.0];
    part.add_box(Vector3::zeros(), &axes);
    fs::write(
        folder.path().join("arm/part.stl"),
        stl::bytes_of(&part, 1.0),
    )
    .unwrap();
    let file = inside.join("arm.urdf");
    fs::write(&file, ROBOT).unwrap();
    read_urdf(&file).unwrap()
}

fn bounds(system: &System, body: usize) -> (Vector3<f64>, Vector3<f64>) {
    let mut surface = Surface::default();
    let body = &system.bodies[body];
    body.shape.add_to(&mut surface, &body.pose());
    surface.bounds()
}

#[test]
fn links_and_joints_become_bodies_and_joints() {
    let found = arm();
    let system = system(&found);
    let names: Vec<_> = system
        .bodies
        .iter()
        .map(|body| body.name.as_str())
        .collect();
    assert_eq!(names, ["base", "turned", "slide"]);
    assert_eq!(system.bodies[0].shape, Shape::Sphere { radius: 100.0 });
    // `turned` has its z along x of the ground: 0.2 m, and 0.4 m to the flange.
    let turned = &system.bodies[1];
    assert!((turned.centre - Vector3::new(200.0, 0.0, 300.0)).norm() < 1e-9);
    let tensor = turned.directors
        * Matrix3::from_diagonal(&turned.inertia.into())
        * turned.directors.transpose();
    let expected = Matrix3::from_diagonal(&Vector3::new(2e6, 1e7, 1e7));
    assert!((tensor - expected).norm() < 1e-12 * 1e7, "{tensor}");
    // Its box and the cylinder of the flange are one surface.
    let (lower, upper) = bounds(&system, 1);
    assert!(
        (lower - Vector3::new(0.0, -100.0, 250.0)).norm() < 1e-3,
        "{lower}"
    );
    assert!(
        (upper - Vector3::new(500.0, 100.0, 350.0)).norm() < 1e-3,
        "{upper}"
    );
    // A mesh of millimetres, stretched along z, which is x of the ground.
    let (lower, upper) = bounds(&system, 2);
    assert!(
        (lower - Vector3::new(470.0, -10.0, 295.0)).norm() < 1e-3,
        "{lower}"
    );
    assert!(
        (upper - Vector3::new(530.0, 10.0, 305.0)).norm() < 1e-3,
        "{upper}"
    );
    let files: Vec<_> = found.meshes.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(files, ["meshes/turned.stl", "meshes/slide.stl"]);

    let joints: Vec<_> = system
        .joints
        .iter()
        .map(|j| (j.name.as_str(), j.parent, j.child))
        .collect();
    assert_eq!(
        joints,
        [
            ("base_to_ground", None, 0),
            ("j1", Some(0), 1),
            ("j3", Some(1), 2)
        ]
    );
    let JointKind::Revolute { axis } = system.joints[1].kind else {
        panic!("{:?}", system.joints[1])
    };
    assert!((axis - Vector3::x()).norm() < 1e-15, "{axis}");
    assert_eq!(system.joints[1].damping, Some(0.1 * 1e6));
    let marker = &system.markers[0];
    assert_eq!(
        (marker.name.as_str(), marker.point.body),
        ("flange", Some(1))
    );
    assert!((marker.point.at - Vector3::new(400.0, 0.0, 300.0)).norm() < 1e-9);
}

#[test]
fn what_is_left_out_is_named() {
    let notes = arm().notes.join("\n");
    for told in [
        "the root \"base\" is fixed to the ground",
        "gravity",
        "<collision> of the link \"turned\"",
        "<limit> of effort of the joint \"j1\"",
        "<limit> of velocity of the joint \"j1\"",
        "<limit> of the range (\"stops\" of a joint need a stiffness) of the joint \"j1\"",
        "<material> of the robot",
        "<mimic> of the joint \"j3\"",
        "<transmission> of the robot",
        "friction of the joint \"j1\"",
    ] {
        assert!(notes.contains(told), "{told} in {notes}");
    }
    // Without the package its mesh is left out, and nothing else.
    let found = parse_urdf(Path::new("arm.urdf"), ROBOT).unwrap();
    let missing = "left out: the mesh \"package://arm/part.stl\", where there is no file, of the link \"slide\"";
    assert!(
        found.notes.iter().any(|note| note == missing),
        "{:?}",
        found.notes
    );
    assert_eq!(found.notes.len(), 1 + notes.lines().count());
    assert_eq!(system(&found).bodies[2].shape, Shape::None);
}

#[test]
fn shapes_and_tensors_that_are_not_taken_are_named() {
    let link = |inside: &str| {
        format!(
            r#"<robot name="r"><link name="base">{inside}</link>
            <link name="arm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
            <joint name="j" type="continuous"><parent link="base"/><child link="arm"/></joint></robot>"#
        )
    };
    for (inside, told) in [
        (
            "<visual><geometry><box size=\"1 1 1\"/><sphere radius=\"1\"/></geometry></visual>",
            "all but one shape of a <geometry> of the link \"base\"",
        ),
        (
            "<visual><geometry/></visual>",
            "a <geometry> without a shape of the link \"base\"",
        ),
        (
            "<inertial><mass value=\"0\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>",
            "the <inertia> beside a mass of zero of the link \"base\"",
        ),
    ] {
        let found = parse_urdf(Path::new("r.urdf"), &link(inside)).unwrap();
        assert!(
            found.notes.iter().any(|note| note.contains(told)),
            "{told} in {:?}",
            found.notes
        );
    }
}

/// Each mistake has one line with its place, what was found and what is expected.
#[test]
fn mistakes_have_one_message() {
    let cases = [
        ("<robot name=\"arm\">", "<robot", "no XML", "a URDF file"),
        (
            "<robot name=\"arm\">",
            "<robot name=\"&undefined;\">",
            "no XML",
            "a URDF file",
        ),
        (
            "<link name=\"base\">",
            "<link>",
            "<link> without \"name\"",
            "\"name\"",
        ),
        (
            "<link name=\"slide\">",
            "<link name=\"base\">",
            "a second time",
            "a name of its own",
        ),
        ("<mass value=\"2\"/>", "", "no <mass>", "<mass>"),
        (
            "<mass value=\"2\"/>",
            "<mass value=\"2\"/><mass value=\"2\"/>",
            "a second <mass>",
            "it once",
        ),
        (
            "<mass value=\"2\"/>",
            "<mass value=\"-2\"/>",
            "a mass of -2 kg",
            "not negative",
        ),
        (
            "<mass value=\"2\"/>",
            "<mass value=\"two\"/>",
            "value=\"two\"",
            "a number",
        ),
        (
            "<mass value=\"2\"/>",
            "<mass value=\"inf\"/>",
            "value=\"inf\"",
            "a number",
        ),
        (
            "<mass value=\"0.5\"/>",
            "<mass value=\"0\"/>",
            "no mass, though the joint \"j3\" moves it",
            "<inertial> with a mass",
        ),
        ("ixx=\"0.1\"", "", "without \"ixx\"", "\"ixx\""),
        (
            "ixx=\"0.1\"",
            "ixx=\"0.5\"",
            "principal moments",
            "none is larger than the sum",
        ),
        (
            "ixx=\"0.1\"",
            "ixx=\"0\"",
            "principal moments",
            "positive moments",
        ),
        (
            "xyz=\"0 0 0.2\"",
            "xyz=\"0 x 0 0.2\"",
            "xyz=\"0 x 0 0.2\"",
            "3 numbers",
        ),
        (
            "xyz=\"0 0 0.2\"",
            "xyz=\"0 0.2\"",
            "xyz=\"0 0.2\"",
            "3 numbers",
        ),
        (
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 0 0\"/>",
            "xyz=[0.0, 0.0, 0.0]",
            "a direction",
        ),
        (
            "<sphere radius=\"0.1\"/>",
            "<sphere radius=\"0\"/>",
            "radius=0",
            "a positive length",
        ),
        (
            "size=\"0.1 0.2 0.4\"",
            "size=\"0.1 -0.2 0.4\"",
            "size=",
            "positive lengths",
        ),
        (
            "type=\"revolute\"",
            "type=\"hinge\"",
            "type=\"hinge\"",
            "revolute, continuous",
        ),
        (
            "<child link=\"turned\"/>",
            "<child link=\"trned\"/>",
            "\"trned\"",
            "the name of a link",
        ),
        (
            "<child link=\"slide\"/>",
            "<child link=\"turned\"/>",
            "a second joint with the child \"turned\"",
            "one joint to each child",
        ),
        (
            "<parent link=\"base\"/>",
            "<parent link=\"slide\"/>",
            "loop",
            "a tree of links",
        ),
        (
            "damping=\"0.1\"",
            "damping=\"-0.1\"",
            "damping=-0.1",
            "not negative",
        ),
        (
            "<link name=\"turned\">",
            "<link name=\"lonely\"/><link name=\"turned\">",
            "a second link without a parent",
            "one link, the root",
        ),
    ];
    for (old, new, found, expected) in cases {
        assert!(ROBOT.contains(old), "{old}");
        let text = ROBOT.replacen(old, new, 1);
        let error = parse_urdf(Path::new("arm.urdf"), &text).expect_err(new);
        let message = error.to_string();
        assert!(message.starts_with("arm.urdf:"), "{message}");
        assert!(message.contains(found), "{found} in {message}");
        assert!(message.contains(expected), "{expected} in {message}");
        assert!(!message.contains('\n'), "{message}");
    }
    for (text, found) in [
        ("<robot name=\"r\"/>", "no <link>"),
        ("<robot><link name=\"a\"/></robot>", "no link with a mass"),
        ("<sdf/>", "<sdf>"),
        ("", "no XML"),
    ] {
        let message = parse_urdf(Path::new("r.urdf"), text)
            .expect_err(text)
            .to_string();
        assert!(message.contains(found), "{found} in {message}");
    }
    let message = read_urdf(Path::new("nowhere/r.urdf"))
        .unwrap_err()
        .to_string();
    assert!(message.contains("no readable file"), "{message}");
}

proptest! {
    #[test]
    fn texts_of_any_kind_never_panic(text in "\\PC{0,80}", at in any::<Index>(), length in 0..40_usize) {
        let _ = parse_urdf(Path::new("r.urdf"), &text);
        let is_edge = |at: &usize| ROBOT.is_char_boundary(*at);
        let start = at.index(ROBOT.len());
        let end = (start + length).min(ROBOT.len());
        if [start, end].iter().all(is_edge) {
            for insert in [&text[..], "", "1e300", "-1", "nan", "\"", "/>", "<link name=\"x\"/>"] {
                let changed = format!("{}{insert}{}", &ROBOT[..start], &ROBOT[end..]);
                if let Err(error) = parse_urdf(Path::new("r.urdf"), &changed) {
                    prop_assert!(!error.found().is_empty() && !error.expected().is_empty());
                }
            }
        }
    }

    #[test]
    fn numbers_of_any_size_never_panic(number in any::<f64>(), at in any::<Index>()) {
        let places: Vec<_> = ROBOT.match_indices("0.").map(|(at, _)| at).collect();
        let at = places[at.index(places.len())];
        let changed = format!("{}{number}{}", &ROBOT[..at], &ROBOT[at + 2..]);
        if let Ok(found) = parse_urdf(Path::new("r.urdf"), &changed) {
            let (folder, _) = folder(&found.scene, "{}");
            let _ = read_scene(&folder.path().join("scene.json"));
        }
    }
}
