//! The scene of a URDF robot: bodies of links with a mass, joints between them, and markers at frames without one.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use serde_json::{Map, Value, json};
use std::path::Path;

use crate::files::json::layout::lay_out;
use crate::files::json::scope::{Result, refuse};
use crate::files::scene::spec::SceneSpec;
use crate::files::stl;
use crate::files::urdf::element::LeftOut;
use crate::files::urdf::outline::{Outline, outline, rounded, turned};
use crate::files::urdf::read::{Inertial, Joint, Kind, Robot, Visual};
use crate::files::urdf::tree::Tree;

/// Name of the ground in scenes.
const GROUND: &str = "ground";
/// A product of inertia below this part of the trace of its tensor is one of rounding.
const ROUNDING: f64 = 1e-15;

/// A scene from a URDF file.
#[derive(Debug)]
pub struct FromUrdf {
    /// Text of the scene file.
    pub scene: String,
    /// STL files that it names, relative to it, with their bytes.
    pub meshes: Vec<(String, Vec<u8>)>,
    /// Sentences about what was decided, and what was left out.
    pub notes: Vec<String>,
}

/// The scene of a robot whose file is at `path`.
pub(super) fn scene(
    robot: &Robot<'_>,
    tree: &Tree,
    path: &Path,
    mut left_out: LeftOut,
) -> Result<FromUrdf> {
    let (mut bodies, mut markers) = (Vec::new(), Vec::new());
    let (mut joints, mut meshes, mut notes) = (Vec::new(), Vec::new(), Vec::new());
    for &link in &tree.order {
        let written = &robot.links[link];
        match &written.inertial {
            Some(inertial) => {
                refuse!(if written.name == GROUND, written.element;
                    found "a body of this name", expected "another name");
                let visuals = visuals(link, robot, tree);
                let owner = written.element.owner.as_str();
                let pose = tree.pose[link] * inertial.pose;
                let centre = &pose.translation.vector;
                let shape = outline(&visuals, centre, path, owner, &mut left_out);
                bodies.push(body(&written.name, inertial, &pose, shape, &mut meshes));
            }
            None if tree.parent[link].is_some() => markers.push(json!({
                "name": written.name,
                "body": carrier(tree.carrier[link], robot),
                "at": rounded(&tree.pose[link].translation.vector),
            })),
            None => {}
        }
        if tree.carrier[link].is_none() && !written.visuals.is_empty() {
            left_out.add("<visual> of the ground", &written.element.owner);
        }
        let Some(joint) = tree.joint[link].map(|joint| &robot.joints[joint]) else {
            if written.inertial.is_some() {
                let name = format!("{}_to_ground", written.name);
                joints.push(json!({ "name": name, "fixed": {}, "parent": GROUND, "child": written.name, "at": [0, 0, 0] }));
                notes.push(format!("the root {:?} is fixed to the ground by the joint {name:?}; \"floating\" in place of \"fixed\" frees it", written.name));
            } else {
                notes.push(format!(
                    "the root {:?} has no mass: it is the ground",
                    written.name
                ));
            }
            continue;
        };
        if tree.carrier[link] == Some(link) {
            let parent = tree.parent[link].and_then(|parent| tree.carrier[parent]);
            joints.push(self::joint(joint, &tree.pose[link], carrier(parent, robot)));
        }
    }
    refuse!(if bodies.is_empty(), robot.element;
        found "no link with a mass", expected "<inertial> of a link");
    notes.push("gravity of 9.81 m/s^2 is along -z, as z points upwards in URDF".to_owned());
    notes.extend(left_out.notes());
    let mut scene = json!({
        "$schema": "scene.schema.json",
        "name": robot.name,
        "bodies": bodies,
        "joints": joints,
        "gravity": [0, 0, "-9.81 m/s^2"],
    });
    if !markers.is_empty() {
        scene["markers"] = markers.into();
    }
    // The keys in the order of their documentation.
    let spec = serde_json::from_value::<SceneSpec>(scene);
    let spec = spec.map_err(|error| {
        robot
            .element
            .wrong(error.to_string(), "a robot of ordinary size")
    })?;
    let scene = serde_json::to_string(&spec).expect("a scene is JSON");
    Ok(FromUrdf {
        scene: lay_out(&scene),
        meshes,
        notes,
    })
}

/// Name of the body that carries a link.
fn carrier<'a>(link: Option<usize>, robot: &'a Robot<'_>) -> &'a str {
    link.map_or(GROUND, |link| &robot.links[link].name)
}

/// Shapes of a link and of those without a mass that are fixed to it, in the ground frame.
fn visuals(link: usize, robot: &Robot<'_>, tree: &Tree) -> Vec<Visual> {
    let carried = (0..robot.links.len()).filter(|&other| tree.carrier[other] == Some(link));
    let placed = carried.flat_map(|other| {
        let visuals = robot.links[other].visuals.iter();
        visuals.map(move |visual| Visual {
            pose: tree.pose[other] * visual.pose,
            ..visual.clone()
        })
    });
    placed.collect()
}

/// A body whose centre of mass and frame of inertia have a pose in the ground frame.
fn body(
    name: &str,
    inertial: &Inertial,
    pose: &Isometry3<f64>,
    shape: Outline,
    meshes: &mut Vec<(String, Vec<u8>)>,
) -> Value {
    let mut body = Map::new();
    body.insert("name".to_owned(), name.into());
    body.insert("mass".to_owned(), inertial.mass.into());
    let centre = rounded(&pose.translation.vector);
    body.insert("position".to_owned(), json!(centre));
    let tensor: Matrix3<f64> = turned(&inertial.tensor, pose);
    body.insert("inertia".to_owned(), json!(tensor.diagonal().as_slice()));
    let least = ROUNDING * tensor.trace();
    let products = [tensor[(0, 1)], tensor[(0, 2)], tensor[(1, 2)]];
    let products = products.map(|entry| if entry.abs() < least { 0.0 } else { entry });
    if products != [0.0; 3] {
        body.insert("products_of_inertia".to_owned(), json!(products));
    }
    match shape {
        Outline::Key(key, value) => {
            body.insert(key.to_owned(), value);
        }
        Outline::Surface(surface) => {
            let file = format!("meshes/{}.stl", file_name(name, meshes.len()));
            body.insert("mesh".to_owned(), json!({ "file": file }));
            meshes.push((file, stl::bytes_of(&surface, 1.0)));
        }
        Outline::None => {}
    }
    body.into()
}

/// A name for a file: letters, digits and dashes, with its number where others may be alike.
fn file_name(name: &str, number: usize) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-".contains(letter);
    match !name.is_empty() && name.len() < 100 && name.chars().all(is_plain) {
        true => name.to_owned(),
        false => format!("mesh.{}", number + 1),
    }
}

/// A joint whose frame, that of its child, has a pose in the ground frame.
fn joint(written: &Joint<'_>, pose: &Isometry3<f64>, parent: &str) -> Value {
    let axis = |axis: Vector3<f64>| rounded(&(pose.rotation * axis));
    let (key, value) = match written.kind {
        Kind::Revolute(along) => ("revolute", json!({ "axis": axis(along) })),
        Kind::Prismatic(along) => ("prismatic", json!({ "axis": axis(along) })),
        Kind::Planar(normal) => ("planar", json!({ "normal": axis(normal) })),
        Kind::Floating => ("floating", json!({})),
        Kind::Fixed => ("fixed", json!({})),
    };
    let at = pose * Point3::origin();
    let mut joint = json!({
        "name": written.name,
        key: value,
        "parent": parent,
        "child": written.child,
        "at": rounded(&at.coords),
    });
    if written.damping > 0.0 {
        joint["damping"] = written.damping.into();
    }
    joint
}
