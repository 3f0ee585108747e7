//! Numbers, meshes, nodes and the animation of a glTF file; numbers stand in one buffer within the text.

use crate::kinematics::Pose;
use crate::mesh::triangulated::Surface;
use crate::model::system::Shape;
use crate::report::origin::Origin;
use crate::report::style::Colour;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{UnitQuaternion, Vector3};
use serde_json::{Value, json};

/// Numbers of the standard for kinds of numbers, buffers and primitives.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;

/// Placement of a node, in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub(super) translation: Vector3<f64>,
    pub(super) rotation: UnitQuaternion<f64>,
    pub(super) scale: Vector3<f64>,
}

impl Placed {
    /// Neither turned nor stretched.
    pub(super) fn at(translation: Vector3<f64>) -> Self {
        Self {
            translation,
            rotation: UnitQuaternion::identity(),
            scale: Vector3::repeat(1.0),
        }
    }
}

/// Part of a node that changes over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moving {
    /// Its place.
    Shifted,
    /// Place and orientation.
    Rigid,
    /// Its scale too.
    Stretched,
}

/// Connection of points.
#[derive(Clone, Debug)]
pub(super) enum Mode {
    Line,
    Triangles(Vec<[usize; 3]>),
}

/// A file under construction.
#[derive(Debug, Default)]
pub(super) struct Document {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
    /// Accessor of the times of the animation; none of a single instant.
    times: Option<usize>,
}

impl Document {
    /// An empty file of instants in s.
    pub(super) fn new(times: &[f64]) -> Self {
        let mut document = Self::default();
        if times.len() > 1 {
            let times: Vec<[f64; 1]> = times.iter().map(|&t| [t]).collect();
            document.times = Some(document.floats("SCALAR", &times, None));
        }
        document
    }

    /// A matt material.
    pub(super) fn material(&mut self, name: &str, colour: Colour, opacity: f32) -> usize {
        let linear = |channel: u8| (f64::from(channel) / 255.0).powf(2.2);
        let Colour(r, g, b) = colour;
        let mut material = json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": {
                "baseColorFactor": [linear(r), linear(g), linear(b), opacity],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.8,
            },
        });
        if opacity < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        added(&mut self.materials, material)
    }

    /// A mesh of triangles.
    pub(super) fn mesh(&mut self, name: &str, surface: &Surface, material: usize) -> usize {
        let primitive = self.primitive(
            &surface.vertices,
            &Mode::Triangles(surface.triangles.clone()),
            material,
        );
        let mesh = json!({ "name": name, "primitives": [primitive] });
        added(&mut self.meshes, mesh)
    }

    /// A node that moves; its places at the instants.
    pub(super) fn moving(
        &mut self,
        name: &str,
        mesh: Option<usize>,
        placed: &[Placed],
        moving: Moving,
    ) {
        let first = placed[0];
        let mut turned: Vec<[f64; 4]> = Vec::new();
        for at in placed {
            let [i, j, k, w] = at.rotation.coords.into();
            // A quaternion and its negative are one rotation: the nearer one to that before, so that what lies between is short.
            let dot = |q: &[f64; 4]| q[0] * i + q[1] * j + q[2] * k + q[3] * w;
            let sign = turned.last().map_or(1.0, |before| dot(before).signum());
            turned.push([i, j, k, w].map(|x| sign * x));
        }
        let mut node = json!({ "name": name, "translation": first.translation.as_slice() });
        if let Some(mesh) = mesh {
            node["mesh"] = mesh.into();
        }
        if moving != Moving::Shifted {
            node["rotation"] = json!(turned[0]);
        }
        if moving == Moving::Stretched {
            node["scale"] = json!(first.scale.as_slice());
        }
        let node = added(&mut self.nodes, node);
        let places: Vec<[f64; 3]> = placed.iter().map(|at| at.translation.into()).collect();
        self.channel(node, "translation", "VEC3", &places);
        if moving != Moving::Shifted {
            self.channel(node, "rotation", "VEC4", &turned);
        }
        if moving == Moving::Stretched {
            let scales: Vec<[f64; 3]> = placed.iter().map(|at| at.scale.into()).collect();
            self.channel(node, "scale", "VEC3", &scales);
        }
    }

    /// A node whose mesh deforms; the places in m of its points at the instants.
    pub(super) fn deforming(
        &mut self,
        name: &str,
        places: &[Vec<Vector3<f64>>],
        mode: Mode,
        material: usize,
    ) {
        let base = &places[0];
        let mut primitive = self.primitive(base, &mode, material);
        let later = &places[1..];
        let mut targets = Vec::new();
        for places in later {
            let moved: Vec<[f64; 3]> = places
                .iter()
                .zip(base)
                .map(|(x, at)| (x - at).into())
                .collect();
            let accessor = self.floats("VEC3", &moved, Some(ARRAY_BUFFER));
            targets.push(json!({ "POSITION": accessor }));
        }
        let mut mesh = json!({ "name": name });
        if !targets.is_empty() {
            primitive["targets"] = targets.into();
            mesh["weights"] = json!(vec![0.0; later.len()]);
        }
        mesh["primitives"] = json!([primitive]);
        let mesh = added(&mut self.meshes, mesh);
        let node = added(&mut self.nodes, json!({ "name": name, "mesh": mesh }));
        // At instant k the target k alone, at the first one none.
        let weight = |k: usize, target: usize| [f64::from(u8::from(k == target + 1))];
        let weights = (0..places.len()).flat_map(|k| (0..later.len()).map(move |t| weight(k, t)));
        self.channel(node, "weights", "SCALAR", &weights.collect::<Vec<_>>());
    }

    /// The text of the file.
    pub(super) fn text(self, name: &str, origin: &Origin) -> String {
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let encoded = STANDARD.encode(&self.bytes);
        let mut document = json!({
            "asset": { "version": "2.0", "generator": format!("proboscis {}", Origin::program()), "extras": { "origin": origin.line() } },
            "scene": 0,
            "scenes": [{ "name": name, "nodes": nodes }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": self.materials,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{
                "byteLength": self.bytes.len(),
                "uri": format!("data:application/octet-stream;base64,{encoded}"),
            }],
        });
        if !self.channels.is_empty() {
            document["animations"] =
                json!([{ "name": "motion", "channels": self.channels, "samplers": self.samplers }]);
        }
        // Lists without entries are no glTF.
        let object = document.as_object_mut().expect("it is an object");
        object.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        if object.get("nodes").is_none() {
            object["scenes"] = json!([{ "name": name }]);
        }
        document.to_string()
    }

    fn primitive(&mut self, places: &[Vector3<f64>], mode: &Mode, material: usize) -> Value {
        let places: Vec<[f64; 3]> = places.iter().map(|&place| place.into()).collect();
        let position = self.floats("VEC3", &places, Some(ARRAY_BUFFER));
        let mut primitive = json!({
            "attributes": { "POSITION": position },
            "material": material,
            "mode": LINE_STRIP,
        });
        if let Mode::Triangles(triangles) = mode {
            let corners = triangles.as_flattened().iter();
            let bytes = corners.flat_map(|&corner| (corner as u32).to_le_bytes());
            let view = self.view(bytes.collect(), Some(ELEMENT_ARRAY_BUFFER));
            let count = 3 * triangles.len();
            let accessor = json!({
                "bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR",
            });
            primitive["indices"] = added(&mut self.accessors, accessor).into();
            primitive["mode"] = TRIANGLES.into();
        }
        primitive
    }

    /// A property of a node over time, where there is an animation.
    fn channel<const N: usize>(
        &mut self,
        node: usize,
        path: &str,
        kind: &str,
        values: &[[f64; N]],
    ) {
        let Some(times) = self.times else {
            return;
        };
        let output = self.floats(kind, values, None);
        let sampler = added(
            &mut self.samplers,
            json!({ "input": times, "output": output, "interpolation": "LINEAR" }),
        );
        self.channels
            .push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
    }

    /// An accessor of numbers with its bounds.
    fn floats<const N: usize>(
        &mut self,
        kind: &str,
        values: &[[f64; N]],
        target: Option<u32>,
    ) -> usize {
        let (mut low, mut high) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        let mut bytes = Vec::new();
        for value in values {
            for i in 0..N {
                let number = value[i] as f32;
                low[i] = low[i].min(number);
                high[i] = high[i].max(number);
                bytes.extend(number.to_le_bytes());
            }
        }
        let view = self.view(bytes, target);
        let exact = |bounds: [f32; N]| bounds.map(f64::from).to_vec();
        let accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": kind,
            "min": exact(low), "max": exact(high),
        });
        added(&mut self.accessors, accessor)
    }

    fn view(&mut self, bytes: Vec<u8>, target: Option<u32>) -> usize {
        let mut view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        added(&mut self.views, view)
    }
}

/// Adds to a list; its place there.
fn added(list: &mut Vec<Value>, value: Value) -> usize {
    list.push(value);
    list.len() - 1
}

/// Length in m of a length in mm.
pub(super) const METRE: f64 = 1e-3;

/// A body in its own frame, in m.
pub(super) fn body(shape: &Shape) -> Surface {
    let mut mesh = Surface::default();
    shape.add_to(&mut mesh, &Pose::GROUND);
    for vertex in &mut mesh.vertices {
        *vertex *= METRE;
    }
    mesh
}

/// A ball about the origin.
pub(super) fn sphere(radius: f64) -> Surface {
    body(&Shape::Sphere {
        radius: radius / METRE,
    })
}

/// A cube of edge 2 about the origin.
pub(super) fn cube() -> Surface {
    let mut mesh = Surface::default();
    let halves = [Vector3::x(), Vector3::y(), Vector3::z()];
    mesh.add_box(Vector3::zeros(), &halves);
    mesh
}

/// Two triangles for each quadrilateral.
pub(super) fn triangles(quads: &[[usize; 4]]) -> Vec<[usize; 3]> {
    let halves = |&[a, b, c, d]: &[usize; 4]| [[a, b, c], [a, c, d]];
    quads.iter().flat_map(halves).collect()
}
