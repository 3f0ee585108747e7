//! A rigid body drawn as glass: the walls behind its inside, then those in front of it; a surface of triangles by its outline and its sharp edges.

use crate::kinematics::Pose;
use crate::mesh::triangulated::{Surface, circle};
use crate::model::system::Shape;
use crate::report::canvas::{Canvas, CanvasPoint, Stroke, length};
use crate::report::skins::edges;
use crate::report::solids::Prism;
use crate::report::style::{self, Colour};
use crate::report::view::{View, hull};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// State that a drawing shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tint {
    /// The initial configuration in light grey.
    Reference,
    /// The deflected state in colour.
    Coloured,
}

impl Tint {
    /// The colour of a part that has its own in the deflected state.
    pub(super) fn ink(self, coloured: Colour) -> Colour {
        match self {
            Self::Reference => style::REFERENCE,
            Self::Coloured => coloured,
        }
    }

    fn colour(self) -> Colour {
        self.ink(style::BODY)
    }

    fn edge(self) -> Colour {
        match self {
            Self::Reference => style::REFERENCE.mix(style::INK, 0.1),
            Self::Coloured => style::BODY.mix(style::INK, 0.45),
        }
    }
}

/// Nested bands of light on a curved surface.
const BANDS: usize = 9;

/// Points in mm whose hull is the outline of a body, or of a box around its surface.
pub fn extent_points(shape: &Shape, pose: &Pose) -> Vec<Vector3<f64>> {
    match *shape {
        Shape::Cylinder { length, radius } => ends(pose, length, radius).concat(),
        Shape::Box { size } => Prism::block(pose, size).corners().to_vec(),
        Shape::Sphere { radius } => [Vector3::x(), Vector3::y(), Vector3::z()]
            .iter()
            .flat_map(|e| [pose.centre + e * radius, pose.centre - e * radius])
            .collect(),
        Shape::Surface(ref surface) => {
            let (lower, upper) = surface.bounds();
            let middle = pose.centre + pose.directors * (0.5 * (lower + upper));
            let size = (upper - lower).into();
            let pose = Pose {
                centre: middle,
                ..*pose
            };
            Prism::block(&pose, size).corners().to_vec()
        }
        Shape::None => vec![],
    }
}

/// The far wall and the edges behind.
pub fn draw_back(canvas: &Canvas<'_>, view: &View, shape: &Shape, pose: &Pose, tint: Tint) {
    let outline = outline(view, shape, pose);
    canvas.fill(&outline, tint.colour().mix(style::PAPER, 0.45), 0.72);
    let faint = Stroke::solid(tint.edge(), 0.5).faint(0.45);
    match *shape {
        Shape::Cylinder { length, radius } => {
            for end in ends(pose, length, radius) {
                canvas.outline(&view.places(&end), faint);
            }
        }
        Shape::Box { size } => {
            for face in Prism::block(pose, size).faces() {
                if face.normal.dot(&view.toward) <= 0.0 {
                    canvas.outline(&view.places(&face.corners), faint);
                }
            }
        }
        Shape::Surface(ref surface) => {
            for edge in Silhouette::new(view, surface, pose).behind {
                canvas.line(&edge, faint);
            }
        }
        Shape::Sphere { .. } | Shape::None => {}
    }
}

/// The near wall with its light, and the edges in front.
pub fn draw_front(canvas: &Canvas<'_>, view: &View, shape: &Shape, pose: &Pose, tint: Tint) {
    let outline = outline(view, shape, pose);
    let edge = Stroke::solid(tint.edge(), 0.8);
    canvas.fill(&outline, tint.colour(), 0.08);
    match *shape {
        Shape::Cylinder { length, radius } => {
            for band in bands(view, pose, length, radius) {
                canvas.fill(&view.places(&band), style::PAPER, 0.022);
            }
            let d3 = pose.directors.column(2).into_owned();
            let facing = usize::from(d3.dot(&view.toward) > 0.0);
            let cap = view.places(&ends(pose, length, radius)[facing]);
            canvas.fill(&cap, style::PAPER, 0.22);
            canvas.outline(&cap, Stroke::solid(tint.edge(), 0.7));
        }
        Shape::Box { size } => {
            for face in Prism::block(pose, size).faces() {
                let normal = face.normal.normalize();
                if normal.dot(&view.toward) > 0.0 {
                    let light = normal
                        .dot(&(view.up - view.right * 0.5).normalize())
                        .max(0.0);
                    let places = view.places(&face.corners);
                    canvas.fill(&places, style::PAPER, 0.3 * light);
                    canvas.outline(&places, edge);
                }
            }
        }
        Shape::Sphere { radius } => {
            for i in 0..BANDS {
                let share = 0.9 * (1.0 - i as f64 / BANDS as f64);
                let shift = (view.up - view.right) * (0.25 * radius * (1.0 - share));
                let ring = circle(pose.centre + shift, view.right, view.up, share * radius);
                canvas.fill(&view.places(&ring), style::PAPER, 0.05);
            }
        }
        Shape::Surface(ref surface) => {
            let silhouette = Silhouette::new(view, surface, pose);
            for line in silhouette.before {
                canvas.line(&line, Stroke::solid(tint.edge(), 0.5));
            }
            for line in silhouette.outline {
                canvas.outline(&line, edge);
            }
            return;
        }
        Shape::None => {}
    }
    canvas.outline(&outline, edge);
}

fn outline(view: &View, shape: &Shape, pose: &Pose) -> Vec<[f64; 2]> {
    match *shape {
        Shape::Sphere { radius } => view.places(&circle(pose.centre, view.right, view.up, radius)),
        Shape::Surface(ref surface) => Silhouette::new(view, surface, pose).polygon(),
        _ => hull(view.places(&extent_points(shape, pose))),
    }
}

/// The two end circles of a cylinder, at −d₃ and +d₃.
fn ends(pose: &Pose, length: f64, radius: f64) -> [Vec<Vector3<f64>>; 2] {
    let [d1, d2, d3] = [0, 1, 2].map(|i| pose.directors.column(i).into_owned());
    [-0.5, 0.5].map(|side| circle(pose.centre + d3 * (side * length), d1, d2, radius))
}

/// Bands of a cylinder's near wall, each within the one before, around where the light falls.
fn bands(view: &View, pose: &Pose, length: f64, radius: f64) -> Vec<Vec<Vector3<f64>>> {
    let d3 = pose.directors.column(2).into_owned();
    let near = view.toward - d3 * d3.dot(&view.toward);
    if near.norm() < 1e-6 {
        return vec![];
    }
    let near = near.normalize();
    let side = d3.cross(&near);
    let left = -side.dot(&view.right).signum();
    let surface = |angle: f64, end: f64| {
        let (s, c) = angle.sin_cos();
        pose.centre + d3 * (end * length / 2.0) + radius * (c * near + s * side)
    };
    (0..BANDS)
        .map(|i| {
            let half = 1.15 * (1.0 - i as f64 / BANDS as f64);
            let arc = |j: usize| 0.35 * left + half * (j as f64 / 8.0 - 1.0);
            let lower = (0..=16).map(|j| surface(arc(j), -1.0));
            let upper = (0..=16).rev().map(|j| surface(arc(j), 1.0));
            lower.chain(upper).collect()
        })
        .collect()
}

/// Cosine of the smallest angle between neighbours that meet in an edge that is drawn: 30°.
const SHARP: f64 = 0.866;
/// Edges shorter than this in pt are not drawn.
const FINEST: f64 = 0.5;

/// Lines of a surface on a sheet.
struct Silhouette {
    /// Closed lines around the triangles that look at the viewer; what they wind around is covered.
    outline: Vec<Vec<CanvasPoint>>,
    /// Sharp edges between triangles that look away.
    behind: Vec<[CanvasPoint; 2]>,
    /// Other sharp edges.
    before: Vec<[CanvasPoint; 2]>,
}

impl Silhouette {
    /// Lines of the surface of a body in a pose.
    fn new(view: &View, surface: &Surface, pose: &Pose) -> Self {
        let places = surface.vertices.iter();
        let places = places.map(|x| view.place(&(pose.centre + pose.directors * x)));
        let places: Vec<_> = places.collect();
        let toward = pose.directors.transpose() * view.toward;
        let normals: Vec<Vector3<f64>> = surface
            .corners()
            .map(|[a, b, c]| (b - a).cross(&(c - a)))
            .map(|normal| normal.try_normalize(0.0).unwrap_or_default())
            .collect();
        let is_front = |triangle: usize| normals[triangle].dot(&toward) > 0.0;
        let mut rim: BTreeMap<[usize; 2], i32> = BTreeMap::new();
        for (triangle, vertices) in surface.triangles.iter().enumerate() {
            for i in 0..3 {
                let (from, to) = (vertices[i], vertices[(i + 1) % 3]);
                let edge = [from.min(to), from.max(to)];
                if is_front(triangle) {
                    *rim.entry(edge).or_default() += if from < to { 1 } else { -1 };
                }
            }
        }
        let (mut behind, mut before) = (Vec::new(), Vec::new());
        for (edge, triangles) in &edges(&surface.triangles) {
            let ends = edge.map(|vertex| places[vertex]);
            let is_sharp = match triangles[..] {
                [a, b] => normals[a].dot(&normals[b]) < SHARP,
                _ => true,
            };
            if !is_sharp || length(ends) < FINEST {
                continue;
            }
            match triangles.iter().any(|&triangle| is_front(triangle)) {
                true => before.push(ends),
                false => behind.push(ends),
            }
        }
        let outline = loops(&rim);
        let outline = outline
            .iter()
            .map(|path| path.iter().map(|&v| places[v]).collect());
        Self {
            outline: outline.collect(),
            behind,
            before,
        }
    }

    /// The outline as one polygon: closed lines, each from the beginning of the first one and back to it.
    fn polygon(&self) -> Vec<CanvasPoint> {
        let Some(start) = self.outline.first().and_then(|path| path.first()) else {
            return Vec::new();
        };
        let closed = |path: &Vec<CanvasPoint>| {
            let first = path.first().copied();
            path.iter()
                .copied()
                .chain(first)
                .chain([*start])
                .collect::<Vec<_>>()
        };
        self.outline.iter().flat_map(closed).collect()
    }
}

/// The closed paths of edges with the number of their passes: positive from the lower vertex to the higher one.
fn loops(rim: &BTreeMap<[usize; 2], i32>) -> Vec<Vec<usize>> {
    let mut next: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (&[low, high], &passes) in rim {
        let (from, to) = if passes > 0 { (low, high) } else { (high, low) };
        for _ in 0..passes.abs() {
            next.entry(from).or_default().push(to);
        }
    }
    let mut paths = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut path = Vec::new();
        let mut at = start;
        while let Some(targets) = next.get_mut(&at) {
            path.push(at);
            let to = targets.pop().expect("a vertex without targets is removed");
            if targets.is_empty() {
                next.remove(&at);
            }
            at = to;
        }
        paths.push(path);
    }
    paths
}
