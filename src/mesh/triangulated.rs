//! Triangulated surfaces: outlines of bodies, from files or of simple shapes.

use crate::mesh::Mesh;
use crate::mesh::geometry::{Faces, bounds};
use crate::mesh::interpolation::shapes;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use std::collections::{BTreeMap, HashSet};
use std::f64::consts::TAU;

/// Points around a circle.
pub const AROUND: usize = 48;
/// Sides of a surface of revolution.
const SIDES: usize = 24;

/// Vertices and triangles of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Vertices in mm.
    pub vertices: Vec<Vector3<f64>>,
    /// Vertices of each triangle; of a solid counter-clockwise seen from outside.
    pub triangles: Vec<[usize; 3]>,
}

impl Surface {
    /// The surface of triangles by their corners: corners at one place are one vertex, and a triangle with two of them at one place, which
    /// has no area, is dropped.
    pub fn from_corners(triangles: impl IntoIterator<Item = [Vector3<f64>; 3]>) -> Self {
        let mut surface = Self::default();
        let mut known: FxHashMap<[u64; 3], usize> = FxHashMap::default();
        for corners in triangles {
            let [a, b, c] = corners.map(|corner| {
                // Adding zero turns −0 into 0.
                let place = corner.map(|x| x + 0.0);
                let next = surface.vertices.len();
                let vertex = *known.entry(place.map(f64::to_bits).into()).or_insert(next);
                if vertex == next {
                    surface.vertices.push(place);
                }
                vertex
            });
            if a != b && b != c && c != a {
                surface.triangles.push([a, b, c]);
            }
        }
        surface
    }

    /// The surface with its vertices moved to `map(x)`.
    #[must_use]
    pub fn transformed(mut self, map: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Self {
        self.vertices = self.vertices.into_iter().map(map).collect();
        self
    }

    /// The three corners of each triangle.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = [Vector3<f64>; 3]> + '_ {
        let vertices = &self.vertices;
        let triangles = self.triangles.iter();
        triangles.map(move |triangle| triangle.map(|vertex| vertices[vertex]))
    }

    /// Lower and upper corner in mm of the box around all vertices; `(+∞, −∞)` for none.
    pub fn bounds(&self) -> (Vector3<f64>, Vector3<f64>) {
        bounds(&self.vertices)
    }

    /// Adds another surface.
    pub fn add(&mut self, other: &Self) {
        let first = self.vertices.len();
        self.vertices.extend(&other.vertices);
        let moved = |triangle: &[usize; 3]| triangle.map(|vertex| first + vertex);
        self.triangles.extend(other.triangles.iter().map(moved));
    }

    /// Adds a surface of revolution about the last of three orthonormal `axes` through rings of (height over `centre`, radius), closed by
    /// flat ends.
    pub fn add_rings(
        &mut self,
        centre: Vector3<f64>,
        axes: [Vector3<f64>; 3],
        rings: &[(f64, f64)],
    ) {
        let [d1, d2, d3] = axes;
        let first = self.vertices.len();
        for (height, radius) in rings {
            let centre = centre + d3 * *height;
            let ring = circle(centre, d1, d2, *radius);
            self.vertices.extend(ring.iter().step_by(AROUND / SIDES));
        }
        let vertex = |ring: usize, side: usize| first + ring * SIDES + side % SIDES;
        for ring in 1..rings.len() {
            for side in 0..SIDES {
                let (a, b) = (vertex(ring - 1, side), vertex(ring - 1, side + 1));
                let (c, d) = (vertex(ring, side), vertex(ring, side + 1));
                self.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        let last = rings.len() - 1;
        for side in 1..SIDES - 1 {
            let below = [0, side + 1, side].map(|side| vertex(0, side));
            let above = [0, side, side + 1].map(|side| vertex(last, side));
            self.triangles.extend([below, above]);
        }
    }

    /// Adds a box, see [`faces_of_box`].
    pub fn add_box(&mut self, centre: Vector3<f64>, halves: &[Vector3<f64>; 3]) {
        for (face, mut corners) in faces_of_box(centre, halves).into_iter().enumerate() {
            if face % 2 == 1 {
                corners.reverse();
            }
            let n = self.vertices.len();
            self.vertices.extend(corners);
            self.triangles
                .extend([[n, n + 1, n + 2], [n, n + 2, n + 3]]);
        }
    }
}

/// Corners in order of the faces of a box with these halves of its edges: face `2 i` at + edge `i`, then the one at − edge `i`.
pub fn faces_of_box(centre: Vector3<f64>, halves: &[Vector3<f64>; 3]) -> [[Vector3<f64>; 4]; 6] {
    std::array::from_fn(|face| {
        let (axis, sign) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
        let (a, b) = (halves[(axis + 1) % 3], halves[(axis + 2) % 3]);
        let middle = centre + halves[axis] * sign;
        [
            middle - a - b,
            middle + a - b,
            middle + a + b,
            middle - a + b,
        ]
    })
}

/// Rings of a sphere, as of [`Surface::add_rings`].
pub fn rings_of_sphere(radius: f64) -> Vec<(f64, f64)> {
    (0..=12)
        .map(|i| (TAU / 24.0 * f64::from(i)).sin_cos())
        .map(|(s, c)| (-radius * c, radius * s))
        .collect()
}

/// Circle of `radius` about `centre` in the plane of the orthonormal `a`, `b`; lengths in mm.
pub fn circle(
    centre: Vector3<f64>,
    a: Vector3<f64>,
    b: Vector3<f64>,
    radius: f64,
) -> Vec<Vector3<f64>> {
    (0..AROUND)
        .map(|i| {
            let (s, c) = (TAU * i as f64 / AROUND as f64).sin_cos();
            centre + radius * (c * a + s * b)
        })
        .collect()
}

impl Mesh {
    /// Faces of the boundary all of whose nodes are among these, counter-clockwise seen from outside.
    pub fn faces_of(&self, nodes: &[usize]) -> Faces {
        let nodes: HashSet<usize> = nodes.iter().copied().collect();
        let mut faces = self.boundary();
        faces.retain(|face| face.iter().all(|node| nodes.contains(node)));
        faces
    }

    /// The integral ∫ N n dA of the shape function of each node times the outward normal over faces, in mm².
    pub fn normals_of(&self, faces: &[Vec<usize>]) -> BTreeMap<usize, Vector3<f64>> {
        let mut sums = BTreeMap::new();
        self.integrate(faces, |node, shape, normal| {
            *sums.entry(node).or_insert_with(Vector3::zeros) += normal * shape;
        });
        sums
    }

    /// The integral ∫ N dA of the shape function of each node over faces, in mm².
    pub fn areas_of(&self, faces: &[Vec<usize>]) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        self.integrate(faces, |node, shape, normal| {
            *sums.entry(node).or_default() += normal.norm() * shape;
        });
        sums
    }

    /// Hands over node, shape function and x_,ξ × x_,η times its weight of each point of faces.
    fn integrate(&self, faces: &[Vec<usize>], mut add: impl FnMut(usize, f64, Vector3<f64>)) {
        let rules = [shapes::<4>(), shapes::<6>()];
        for face in faces {
            let rule = &rules[usize::from(face.len() == 6)];
            for point in rule {
                let along = |axis: usize| -> Vector3<f64> {
                    let slopes = point.slopes.iter().zip(face);
                    slopes.map(|(slope, &n)| self.nodes[n] * slope[axis]).sum()
                };
                let normal = along(0).cross(&along(1)) * point.weight;
                for (&node, value) in face.iter().zip(&point.values) {
                    add(node, *value, normal);
                }
            }
        }
    }
}
