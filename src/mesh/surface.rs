//! Surface of a mesh: faces of the boundary whose nodes belong to a set, and the integrals of shape functions over them.

use super::{CORNERS, Mesh};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashSet};

impl Mesh {
    /// Faces of the boundary all of whose nodes are among these, counter-clockwise seen from outside.
    pub fn faces_of(&self, nodes: &[usize]) -> Vec<[usize; 4]> {
        let nodes: HashSet<usize> = nodes.iter().copied().collect();
        let mut faces = self.boundary_quads();
        faces.retain(|face| face.iter().all(|node| nodes.contains(node)));
        faces
    }

    /// The integral ∫ N n dA of the shape function of each node times the outward normal over faces, in mm².
    pub fn normals_of(&self, faces: &[[usize; 4]]) -> BTreeMap<usize, Vector3<f64>> {
        let mut sums = BTreeMap::new();
        self.integrate(faces, |node, shape, normal| {
            *sums.entry(node).or_insert_with(Vector3::zeros) += normal * shape;
        });
        sums
    }

    /// The integral ∫ N dA of the shape function of each node over faces, in mm².
    pub fn areas_of(&self, faces: &[[usize; 4]]) -> BTreeMap<usize, f64> {
        let mut sums = BTreeMap::new();
        self.integrate(faces, |node, shape, normal| {
            *sums.entry(node).or_default() += normal.norm() * shape;
        });
        sums
    }

    /// Hands over node, shape function and x_,ξ × x_,η of each of 2 × 2 Gauss points, which weigh one.
    fn integrate(&self, faces: &[[usize; 4]], mut add: impl FnMut(usize, f64, Vector3<f64>)) {
        for face in faces {
            // The corners of the square are the first ones of the cube.
            let corners: [[f64; 2]; 4] = std::array::from_fn(|a| [CORNERS[a][0], CORNERS[a][1]]);
            for point in corners.map(|corner| corner.map(|c| c / 3.0_f64.sqrt())) {
                let factors = corners.map(|[a, b]| [1.0 + a * point[0], 1.0 + b * point[1]]);
                let along = |axis: usize| -> Vector3<f64> {
                    let corners = corners.iter().zip(&factors).zip(face);
                    corners
                        .map(|((corner, f), &n)| {
                            self.nodes[n] * (0.25 * corner[axis] * f[1 - axis])
                        })
                        .sum()
                };
                let normal = along(0).cross(&along(1));
                for (&node, [a, b]) in face.iter().zip(factors) {
                    add(node, 0.25 * a * b, normal);
                }
            }
        }
    }
}
