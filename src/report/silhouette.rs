//! A surface of triangles as lines on a sheet: its outline, and the edges at which it bends.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::kinematics::Pose;
use crate::mesh::triangulated::Surface;
use crate::report::canvas::CanvasPoint;
use crate::report::view::View;

/// Cosine of the smallest angle between neighbours that meet in an edge that is drawn: 30°.
const SHARP: f64 = 0.866;
/// Edges shorter than this in pt are not drawn.
const FINEST: f64 = 0.5;

/// Lines of a surface on a sheet.
pub(super) struct Silhouette {
    /// Closed lines around the triangles that look at the viewer; what they wind around is covered.
    pub(super) outline: Vec<Vec<CanvasPoint>>,
    /// Sharp edges between triangles that look away.
    pub(super) behind: Vec<[CanvasPoint; 2]>,
    /// Other sharp edges.
    pub(super) before: Vec<[CanvasPoint; 2]>,
}

impl Silhouette {
    /// Lines of the surface of a body in a pose.
    pub(super) fn new(view: &View, surface: &Surface, pose: &Pose) -> Self {
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
        // Triangles at each edge.
        let mut sides: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        let mut rim: BTreeMap<[usize; 2], i32> = BTreeMap::new();
        for (triangle, vertices) in surface.triangles.iter().enumerate() {
            for i in 0..3 {
                let (from, to) = (vertices[i], vertices[(i + 1) % 3]);
                let edge = [from.min(to), from.max(to)];
                sides.entry(edge).or_default().push(triangle);
                if is_front(triangle) {
                    *rim.entry(edge).or_default() += if from < to { 1 } else { -1 };
                }
            }
        }
        let (mut behind, mut before) = (Vec::new(), Vec::new());
        for (edge, triangles) in &sides {
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
    pub(super) fn polygon(&self) -> Vec<CanvasPoint> {
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

fn length([a, b]: [CanvasPoint; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}
