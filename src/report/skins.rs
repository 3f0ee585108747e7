//! Surfaces of elastic blocks at the instants that pictures show, and on a sheet.

use crate::coordinates::Configuration;
use crate::dynamics::DiscreteTrajectory;
use crate::model::system::Fidelity;
use crate::model::{Model, SolidBlock};
use crate::report::canvas::{Canvas, CanvasPoint, Stroke, length};
use crate::report::style::{self, Colour};
use crate::report::view::View;
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Most instants that an animation shows.
const FRAMES: usize = 200;
/// Fewest of them, however large the surfaces are.
const LEAST: usize = 6;
/// Places that all instants together may have, so that pages stay small.
const PLACES: usize = 40_000;
/// Cosine of the angle between faces from which on their common edge is drawn strong.
const SHARP: f64 = 0.8;

/// The surface of a block, or of a muscle of finite elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Name of the block or the muscle.
    pub name: String,
    /// The muscle, by its index in the system; `None` for a block of the scene.
    pub muscle: Option<usize>,
    /// True if potentials reach it.
    pub is_charged: bool,
    /// True of a membrane, which is seen from both sides.
    pub is_thin: bool,
    /// Corners of the faces, counter-clockwise seen from outside.
    pub quads: Vec<[usize; 4]>,
    /// For each corner of a face, true if the edge to the next one is an edge of the body, rather than of its elements.
    pub sharp: Vec<[bool; 4]>,
    /// Places of the corners in the reference configuration in mm.
    pub reference: Vec<Vector3<f64>>,
    /// Places of the corners in mm, per instant shown.
    pub places: Vec<Vec<Vector3<f64>>>,
    /// Amount of the potential at the corners in V, per instant shown: that of the interval that ends there.
    pub potentials: Vec<Vec<f64>>,
    /// Amount of the true electric field at the corners in V/mm, per instant shown: a mean over the elements around.
    pub fields: Vec<Vec<f64>>,
    /// Von Mises stress at the corners in N/mm² without that of viscosity, per instant shown: a mean over the elements around.
    pub von_mises: Vec<Vec<f64>>,
}

/// Surfaces of all blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skins {
    /// The instants shown: the first, the last, and some between.
    pub instants: Vec<usize>,
    /// The surfaces; none where nothing is elastic.
    pub list: Vec<Skin>,
}

/// Instants that a picture of `places` moving places shows: the nearest ones to equal spans of time, the last one always.
pub fn shown(times: &[f64], places: usize) -> Vec<usize> {
    let last = times.len().saturating_sub(1);
    let most = PLACES / places.max(1);
    let stride = last.div_ceil(most.clamp(LEAST, FRAMES)).max(1);
    let nearest = |k: usize| {
        let time = times[0] + (times[last] - times[0]) * k as f64 / last.max(1) as f64;
        let after = times.partition_point(|&t| t < time).min(last);
        let before = after.saturating_sub(1);
        match time - times[before] < times[after] - time {
            true => before,
            false => after,
        }
    };
    let mut instants: Vec<_> = (0..last).step_by(stride).map(nearest).collect();
    instants.push(last);
    instants.dedup();
    instants
}

impl Skins {
    /// Surfaces of the blocks of a model along a motion of one instant or more.
    pub fn new(model: &Model, discrete: &DiscreteTrajectory) -> Self {
        let mut muscles = model
            .system
            .muscles
            .iter()
            .enumerate()
            .filter_map(|(i, m)| (m.fidelity != Fidelity::Lumped).then_some(i));
        let mut parts = Vec::new();
        for block in &model.solids {
            let muscle = block.is_muscle().then(|| muscles.next()).flatten();
            parts.push(Skin::immobile(block, muscle));
        }
        let places = parts.iter().map(|(skin, _)| skin.reference.len()).sum();
        let instants = shown(&discrete.times, places);
        let none = vec![0.0; model.action.intervals.scalars];
        for &k in &instants {
            let instant = model.action.map.placed(&discrete.z[k]);
            let scalars = discrete.scalars.get(k.saturating_sub(1)).unwrap_or(&none);
            for (b, (skin, nodes)) in parts.iter_mut().enumerate() {
                let block = &model.solids[b];
                let vectors = nodes.iter().map(|&n| instant.x[block.vectors[n]]);
                skin.places.push(vectors.collect());
                skin.observe(model, b, nodes, &instant, scalars);
                let potentials = match skin.muscle {
                    Some(muscle) => {
                        let s = model.variables.input(muscle);
                        vec![s.map_or(0.0, |s| scalars[s].abs()); nodes.len()]
                    }
                    None => {
                        let all = block.potentials(scalars);
                        nodes.iter().map(|&n| all[n].abs()).collect()
                    }
                };
                skin.potentials.push(potentials);
            }
        }
        Self {
            instants,
            list: parts.into_iter().map(|(skin, _)| skin).collect(),
        }
    }

    /// Returns the position of an instant among those shown; of the last of them for others.
    pub fn position(&self, instant: usize) -> usize {
        let found = self.instants.iter().position(|&k| k == instant);
        found.unwrap_or(self.instants.len().saturating_sub(1))
    }

    /// Highest potential in V of the blocks of the scene at all instants shown.
    pub fn highest(&self) -> f64 {
        let blocks = self.list.iter().filter(|skin| skin.muscle.is_none());
        let all = blocks.flat_map(|skin| skin.potentials.iter().flatten());
        all.copied().fold(0.0, f64::max)
    }
}

impl Skin {
    /// A surface at no instants yet, and the nodes of the mesh that its corners are.
    fn immobile(block: &SolidBlock, muscle: Option<usize>) -> (Self, Vec<usize>) {
        let mesh = &block.solid.mesh;
        let mut nodes = Vec::new();
        let mut corner = HashMap::new();
        let mut number = |node: usize| {
            *corner.entry(node).or_insert_with(|| {
                nodes.push(node);
                nodes.len() - 1
            })
        };
        let boundary = mesh.boundary_quads();
        let quads: Vec<_> = boundary.iter().map(|quad| quad.map(&mut number)).collect();
        let reference: Vec<_> = nodes.iter().map(|&node| mesh.nodes[node]).collect();
        let skin = Self {
            name: block.solid.name.clone(),
            muscle,
            is_charged: block.terminals.iter().any(Option::is_some),
            is_thin: block.solid.is_membrane(),
            sharp: sharp(&quads, &reference),
            quads,
            reference,
            ..Self::default()
        };
        (skin, nodes)
    }

    /// Adds fields and stresses of an instant at the nodes that the corners are.
    fn observe(
        &mut self,
        model: &Model,
        number: usize,
        nodes: &[usize],
        at: &Configuration,
        scalars: &[f64],
    ) {
        let block = &model.solids[number];
        let (places, potentials) = (block.places(&at.x), block.potentials(scalars));
        let mut sums = vec![[0.0; 3]; places.len()];
        let at_surface = nodes.iter().copied().collect::<HashSet<_>>();
        for (e, corners) in block.solid.mesh.elements().enumerate() {
            if !corners.iter().any(|node| at_surface.contains(node)) {
                continue;
            }
            let mut fields = block.fields(e, &places, &potentials);
            if let Some(stress) = model.branch_stress(number, e, at) {
                fields.stress += stress;
            }
            let values = [1.0, fields.electric_field.norm(), fields.von_mises()];
            for &node in corners {
                for (sum, value) in sums[node].iter_mut().zip(values) {
                    *sum += value;
                }
            }
        }
        let mean = |i: usize| nodes.iter().map(|&n| sums[n][i] / sums[n][0]).collect();
        self.fields.push(mean(1));
        self.von_mises.push(mean(2));
    }
}

/// Outward normal of a face, as long as twice its area.
pub fn normal(corners: &[Vector3<f64>; 4]) -> Vector3<f64> {
    (corners[2] - corners[0]).cross(&(corners[3] - corners[1]))
}

/// The edges of faces, from the lower vertex to the higher one, with the faces that meet there.
pub(super) fn edges<const N: usize>(faces: &[[usize; N]]) -> BTreeMap<[usize; 2], Vec<usize>> {
    let mut edges: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for (face, vertices) in faces.iter().enumerate() {
        for i in 0..N {
            edges.entry(edge_of(vertices, i)).or_default().push(face);
        }
    }
    edges
}

/// The edge of a face that begins at a corner.
fn edge_of<const N: usize>(face: &[usize; N], corner: usize) -> [usize; 2] {
    let (a, b) = (face[corner], face[(corner + 1) % N]);
    [a.min(b), a.max(b)]
}

/// Edges at which faces meet at an angle.
fn sharp(quads: &[[usize; 4]], places: &[Vector3<f64>]) -> Vec<[bool; 4]> {
    let unit = |quad: &[usize; 4]| normal(&quad.map(|corner| places[corner])).normalize();
    let normals: Vec<_> = quads.iter().map(unit).collect();
    let edges = edges(quads);
    let is_sharp = |edge: [usize; 2]| match edges[&edge][..] {
        [a, b] => normals[a].dot(&normals[b]) < SHARP,
        _ => true,
    };
    let of_face = |quad: &[usize; 4]| std::array::from_fn(|i| is_sharp(edge_of(quad, i)));
    quads.iter().map(of_face).collect()
}

/// Width of the edges of elements as a part of their length, and at most in pt.
const EDGE: [f64; 2] = [0.02, 0.4];
/// Elements whose edges are shorter than this in pt are drawn without.
const FINEST: f64 = 2.0;
/// Part of the scale of colours that a patch of one colour may span, where faces are few.
const STEP: f64 = 0.03;
/// Most patches along a side of a face.
const PATCHES: usize = 12;
/// Maximum number of faces that are cut into patches.
const FEW: usize = 1000;

/// Colour of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Paint<'a> {
    /// The initial configuration: outlines on light grey.
    Reference,
    /// One colour.
    Even(Colour),
    /// Amounts of the potential at the corners in V, and the full scale of the colours.
    Potential {
        /// By corner.
        potentials: &'a [f64],
        /// Full scale in V.
        scale: f64,
    },
}

/// Draws the faces that look at the viewer, of a membrane all, far ones first, lit from the upper left.
pub(super) fn draw_skin(
    canvas: &Canvas<'_>,
    view: &View,
    skin: &Skin,
    places: &[Vector3<f64>],
    paint: Paint<'_>,
) {
    let light = (view.toward + view.up * 0.9 - view.right * 0.7).normalize();
    let mut faces = Vec::new();
    for (quad, sharp) in skin.quads.iter().zip(&skin.sharp) {
        let corners = quad.map(|corner| places[corner]);
        let outward = normal(&corners);
        let faces_viewer = outward.dot(&view.toward) > 0.0;
        if faces_viewer || skin.is_thin {
            let normal = if faces_viewer { outward } else { -outward };
            let depth = corners.iter().map(|corner| view.depth(corner)).sum::<f64>();
            faces.push((depth, quad, sharp, corners, normal.normalize()));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_reference = paint == Paint::Reference;
    let few = faces.len() < FEW;
    for (_, quad, sharp, corners, normal) in faces {
        let strength = if is_reference { 0.12 } else { 0.34 };
        let shade = strength * (1.0 - normal.dot(&light).max(0.0));
        let sheet = corners.map(|corner| view.place(&corner));
        let patch = |corners: &[CanvasPoint; 4], colour: Colour| {
            let fill = colour.mix(style::INK, shade);
            canvas.fill(corners, fill, 1.0);
            // A seam between neighbours is painted over.
            canvas.outline(corners, Stroke::solid(fill, 0.3));
        };
        let middle = match paint {
            Paint::Reference => style::GRID,
            Paint::Even(colour) => colour,
            Paint::Potential { potentials, scale } => {
                let values = quad.map(|corner| potentials[corner] / scale);
                if few {
                    for (corners, value) in patches(&sheet, &values) {
                        patch(&corners, style::voltage(value));
                    }
                }
                style::voltage(values.iter().sum::<f64>() / 4.0)
            }
        };
        if !few || !matches!(paint, Paint::Potential { .. }) {
            patch(&sheet, middle);
        }
        let fill = middle.mix(style::INK, shade);
        for i in 0..4 {
            let next = (i + 1) % 4;
            // Its neighbour draws an edge within a surface the other way round.
            if !sharp[i] && quad[i] > quad[next] {
                continue;
            }
            let ends = [sheet[i], sheet[next]];
            if let Some(stroke) = edge(fill, sharp[i], length(ends), is_reference) {
                canvas.line(&ends, stroke);
            }
        }
    }
}

/// A face in parts between which a quantity changes little, with its value in the middle of each.
fn patches(corners: &[CanvasPoint; 4], values: &[f64; 4]) -> Vec<([CanvasPoint; 4], f64)> {
    let count = |a: [usize; 2], b: [usize; 2]| {
        let change = |[from, to]: [usize; 2]| (values[to] - values[from]).abs();
        let parts = (change(a).max(change(b)) / STEP).ceil();
        (parts as usize).clamp(1, PATCHES)
    };
    let counts = [count([0, 1], [3, 2]), count([0, 3], [1, 2])];
    // Bilinear between the corners.
    let weights = |u: f64, v: f64| [(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v];
    let place = |u: f64, v: f64| {
        let parts = || weights(u, v).into_iter().zip(corners);
        [0, 1].map(|i| parts().map(|(w, corner)| w * corner[i]).sum())
    };
    let part = |i: usize, j: usize| {
        let [m, n] = counts.map(|count| count as f64);
        let at = |a: f64, b: f64| [(i as f64 + a) / m, (j as f64 + b) / n];
        let ends = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let [u, v] = at(0.5, 0.5);
        let value = weights(u, v).iter().zip(values).map(|(w, x)| w * x).sum();
        (ends.map(|[u, v]| place(u, v)), value)
    };
    let all = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    all.map(|(i, j)| part(i, j)).collect()
}

/// Returns the stroke of an edge: strong where it is the body's, faint where it is an element's.
fn edge(fill: Colour, is_sharp: bool, length: f64, is_reference: bool) -> Option<Stroke> {
    match (is_reference, is_sharp) {
        (true, true) => Some(Stroke::solid(style::REFERENCE, 0.6)),
        (true, false) => None,
        (false, true) => Some(Stroke::solid(fill.mix(style::INK, 0.55), 0.7)),
        (false, false) if length < FINEST => None,
        (false, false) => {
            let width = (EDGE[0] * length).min(EDGE[1]);
            Some(Stroke::solid(fill.mix(style::INK, 0.35), width).faint(0.6))
        }
    }
}
