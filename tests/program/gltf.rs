//! The glTF file of a motion, read as its standard says, against poses, muscles, markers and surfaces.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use proboscis::dynamics::trajectory::{Observations, Trajectory};
use proboscis::model::system::System;
use proboscis::report::origin::Origin;
use proboscis::report::skins::{Skin, Skins};
use proboscis::report::{Run, gltf};
use serde_json::Value;

type Vector = Vector3<f64>;
/// Vectors of any length.
type Rows = Vec<Vec<f64>>;

/// A file, and the bytes of its buffer.
struct Read {
    file: Value,
    bytes: Vec<u8>,
}

impl Read {
    fn new(text: &str) -> Self {
        let file: Value = serde_json::from_str(text).unwrap();
        let buffer = &file["buffers"][0];
        let (_, data) = buffer["uri"]
            .as_str()
            .unwrap()
            .split_once("base64,")
            .unwrap();
        let bytes = STANDARD.decode(data).unwrap();
        assert_eq!(buffer["byteLength"], bytes.len());
        Self { file, bytes }
    }

    /// Rows of an accessor.
    fn rows(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let accessor = &self.file["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.file["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let [start, length] =
            ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        assert_eq!(start % 4, 0);
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            other => panic!("{other}"),
        };
        assert_eq!(
            accessor["count"].as_u64().unwrap() as usize * width * 4,
            length
        );
        let words = self.bytes[start..start + length].chunks_exact(4);
        let number = |word: &[u8]| match accessor["componentType"].as_u64() {
            Some(5126) => f64::from(f32::from_le_bytes(word.try_into().unwrap())),
            Some(5125) => f64::from(u32::from_le_bytes(word.try_into().unwrap())),
            other => panic!("{other:?}"),
        };
        let numbers: Vec<f64> = words.map(number).collect();
        let rows: Vec<Vec<f64>> = numbers.chunks_exact(width).map(<[f64]>::to_vec).collect();
        for i in 0..width {
            let column = || rows.iter().map(|row| row[i]);
            if let Some(low) = accessor["min"].get(i) {
                assert_eq!(low.as_f64(), column().reduce(f64::min));
                assert_eq!(accessor["max"][i].as_f64(), column().reduce(f64::max));
            }
        }
        rows
    }

    fn node(&self, name: &str) -> (usize, &Value) {
        let nodes = self.file["nodes"].as_array().unwrap();
        let found = nodes.iter().position(|node| node["name"] == name);
        let found = found.unwrap_or_else(|| panic!("no node {name}"));
        (found, &nodes[found])
    }

    /// A property of a node at every instant, and the instants.
    fn animated(&self, name: &str, path: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
        let (node, _) = self.node(name);
        let animation = &self.file["animations"][0];
        let channels = animation["channels"].as_array().unwrap();
        let channel = channels
            .iter()
            .find(|channel| channel["target"]["node"] == node && channel["target"]["path"] == path);
        let channel = channel.unwrap_or_else(|| panic!("{name} has no {path}"));
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        assert_eq!(sampler["interpolation"], "LINEAR");
        let times = self.rows(&sampler["input"]).concat();
        (times, self.rows(&sampler["output"]))
    }

    /// The points of the only primitive of a node, those of its morph targets, and its indices.
    fn mesh(&self, name: &str) -> (Rows, Vec<Rows>, Vec<usize>) {
        let mesh = self.node(name).1["mesh"].as_u64().unwrap() as usize;
        let primitive = &self.file["meshes"][mesh]["primitives"][0];
        assert_eq!(primitive["mode"], 4);
        let points = self.rows(&primitive["attributes"]["POSITION"]);
        let targets = primitive["targets"].as_array();
        let targets = targets.into_iter().flatten();
        let targets = targets
            .map(|target| self.rows(&target["POSITION"]))
            .collect();
        let indices = self.rows(&primitive["indices"]).concat();
        let indices = indices.into_iter().map(|i| i as usize).collect();
        (points, targets, indices)
    }
}

/// v turned by a quaternion (x, y, z, w): v + 2 q × (q × v + w v).
fn turned(q: &[f64], v: &Vector) -> Vector {
    let axis = Vector::new(q[0], q[1], q[2]);
    v + 2.0 * axis.cross(&(axis.cross(v) + q[3] * v))
}

fn vector(row: &[f64]) -> Vector {
    Vector::from_column_slice(row)
}

fn origin() -> Origin {
    Origin {
        command: "proboscis".to_owned(),
        input: "a.json".to_owned(),
        version: Origin::program(),
        ipopt: String::new(),
    }
}

/// The file of a motion.
fn written(system: &System, trajectory: &Trajectory, skins: &Skins) -> String {
    let (observations, origin) = (Observations::default(), origin());
    let run = Run::from_trajectory(system, trajectory, skins, &observations, &origin);
    gltf::text(&run).unwrap()
}

fn swing() -> (System, Trajectory) {
    let system = crate::common::trunk::system(6);
    let trajectory = crate::common::trunk::swing(&system, 20);
    (system, trajectory)
}

/// Two faces that share an edge, at each instant somewhere else.
fn sheet(instants: usize) -> Skins {
    let corner = |i: usize, k: usize| {
        let (s, c) = (0.7 * k as f64 + i as f64).sin_cos();
        Vector::new(10.0 * i as f64 + s, 4.0 * c, s * c)
    };
    let at = |k: usize| (0..6).map(|i| corner(i, k)).collect::<Vec<_>>();
    Skins {
        instants: (0..instants).collect(),
        list: vec![Skin {
            quads: vec![[0, 1, 3, 2], [2, 3, 5, 4]],
            sharp: vec![[true; 4]; 2],
            reference: at(0),
            places: (0..instants).map(at).collect(),
            potentials: vec![vec![0.0; 6]; instants],
            ..Skin::default()
        }],
    }
}

/// Numbers of the file have 24 bits, lengths are below 1 m.
const CLOSE: f64 = 1e-7;

#[test]
fn bodies_muscles_and_markers_move_as_they_do() {
    let (system, trajectory) = swing();
    let read = Read::new(&written(&system, &trajectory, &Skins::default()));
    let mut greatest: f64 = 0.0;
    for (b, body) in system.bodies.iter().enumerate() {
        let (times, places) = read.animated(&body.name, "translation");
        let (_, turns) = read.animated(&body.name, "rotation");
        assert_eq!(places.len(), trajectory.times.len());
        for (k, poses) in trajectory.poses.iter().enumerate() {
            assert!((1e3 * times[k] - trajectory.times[k]).abs() < 1e-4);
            let pose = &poses[b];
            let local = Vector::new(3.0, -7.0, 11.0);
            let expected = (pose.centre + pose.directors * local) / 1e3;
            let found = vector(&places[k]) + turned(&turns[k], &(local / 1e3));
            assert!((found - expected).norm() < CLOSE, "{} at {k}", body.name);
            greatest = greatest.max((expected - (trajectory.poses[0][b].centre) / 1e3).norm());
            if k > 0 {
                let dot: f64 = turns[k].iter().zip(&turns[k - 1]).map(|(a, b)| a * b).sum();
                assert!(dot > 0.5, "the long way round");
            }
        }
    }
    assert!(greatest > 0.02, "they hardly move: {greatest}");
    for muscle in &system.muscles {
        let (_, places) = read.animated(&muscle.name, "translation");
        let (_, turns) = read.animated(&muscle.name, "rotation");
        let (_, scales) = read.animated(&muscle.name, "scale");
        let rest = (muscle.to.at - muscle.from.at).norm();
        let volume = muscle.cross_section[0] * muscle.cross_section[1] * rest / 1e9;
        for k in 0..trajectory.times.len() {
            for (point, side) in [(&muscle.from, -1.0), (&muscle.to, 1.0)] {
                let end = Vector::new(0.0, 0.0, side * scales[k][2]);
                let found = vector(&places[k]) + turned(&turns[k], &end);
                let expected = trajectory.point(k, point, &system) / 1e3;
                assert!((found - expected).norm() < CLOSE, "{} at {k}", muscle.name);
            }
            let stretched: f64 = 8.0 * scales[k].iter().product::<f64>();
            assert!(
                (stretched / volume - 1.0).abs() < 1e-5,
                "{stretched} {volume}"
            );
        }
        let (points, ..) = read.mesh(&muscle.name);
        assert!(points.iter().flatten().all(|x| x.abs() == 1.0));
    }
    let (_, places) = read.animated("tip", "translation");
    for (k, place) in places.iter().enumerate() {
        assert!((vector(place) - trajectory.marks[k][0] / 1e3).norm() < CLOSE);
    }
    assert!(
        !read.file["scenes"][0]["nodes"]
            .as_array()
            .unwrap()
            .is_empty()
    );
}

#[test]
fn surfaces_take_the_places_of_each_instant() {
    let (system, trajectory) = swing();
    let count = trajectory.times.len();
    let skins = sheet(count);
    let read = Read::new(&written(&system, &trajectory, &skins));
    let (points, targets, indices) = read.mesh("block 1");
    assert_eq!(indices, [0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4]);
    let (_, weights) = read.animated("block 1", "weights");
    let weights = weights.concat();
    assert_eq!(weights.len(), count * targets.len());
    let mut greatest: f64 = 0.0;
    for k in 0..count {
        for (i, point) in points.iter().enumerate() {
            let mut found = vector(point);
            for (t, target) in targets.iter().enumerate() {
                found += vector(&target[i]) * weights[k * targets.len() + t];
            }
            let expected = skins.list[0].places[k][i] / 1e3;
            assert!((found - expected).norm() < CLOSE, "{i} at {k}");
            greatest = greatest.max((expected - vector(point)).norm());
        }
    }
    assert!(greatest > 1e-3);
}

#[test]
fn a_single_instant_has_no_animation_and_what_is_not_finite_is_left_out() {
    let (system, mut trajectory) = swing();
    trajectory.poses[7][2].centre.x = f64::NAN;
    let text = written(&system, &trajectory, &Skins::default());
    let (times, _) = Read::new(&text).animated("tip", "translation");
    assert_eq!(times.len(), trajectory.times.len() - 1);
    trajectory.times.truncate(1);
    let text = written(&system, &trajectory, &sheet(1));
    let read = Read::new(&text);
    assert!(read.file.get("animations").is_none());
    let (_, node) = read.node("tip");
    for i in 0..3 {
        let place = node["translation"][i].as_f64().unwrap();
        assert!((place - trajectory.marks[0][0][i] / 1e3).abs() < CLOSE);
    }
    let (points, targets, _) = read.mesh("block 1");
    assert!(points.len() == 6 && targets.is_empty());
}
