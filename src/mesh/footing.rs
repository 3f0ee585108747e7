//! Places on the surface of a mesh as sums of those of its nodes: `x = Σ N_i x_i` of the face that they lie on.

use super::Mesh;
use super::interpolation::{Interpolation, Parent};
use nalgebra::{Matrix2, Vector2, Vector3};

/// Part of the longest edge of a face within which a place lies on it.
const ON_FACE: f64 = 1e-3;

/// Part of the parent cell by which a place of a face may lie outside.
const BEYOND: f64 = 1e-6;

/// Steps to the nearest place of a face, of which straight ones take one.
const STEPS: usize = 20;

/// Nodes and the parts that they have in a place.
pub type Footing = Vec<(usize, f64)>;

impl Mesh {
    /// Parts of the nodes of the one of some faces on which a place lies; `None` where there is none.
    pub fn footing(&self, faces: &[Vec<usize>], at: &Vector3<f64>) -> Option<Footing> {
        let nodes = (0..self.nodes.len()).map(|node| (node, (self.nodes[node] - at).norm()));
        let (node, distance) = nodes.min_by(|a, b| a.1.total_cmp(&b.1))?;
        if distance <= ON_FACE * BEYOND * self.size() {
            return Some(vec![(node, 1.0)]);
        }
        faces.iter().find_map(|face| {
            let places: Vec<_> = face.iter().map(|&node| self.nodes[node]).collect();
            let size = places.iter().map(|x| (x - places[0]).norm());
            let size = size.fold(0.0, f64::max);
            if (at - places[0]).norm() > 2.0 * size {
                return None;
            }
            let parts = match face.len() {
                4 => foot::<4>(&places, at, |xi| xi.amax() <= 1.0 + BEYOND, size),
                _ => {
                    let inside =
                        |xi: &Vector2<f64>| xi.min() >= -BEYOND && xi.sum() <= 1.0 + BEYOND;
                    foot::<6>(&places, at, inside, size)
                }
            };
            parts.map(|parts| face.iter().copied().zip(parts).collect())
        })
    }
}

/// Shape functions at the place of a face nearest to a point, where that is on the face.
fn foot<const NODES: usize>(
    places: &[Vector3<f64>],
    at: &Vector3<f64>,
    is_inside: impl Fn(&Vector2<f64>) -> bool,
    size: f64,
) -> Option<Vec<f64>>
where
    Parent<NODES>: Interpolation<2, NODES>,
{
    let mut xi = match NODES {
        4 => Vector2::zeros(),
        _ => Vector2::repeat(1.0 / 3.0),
    };
    for _ in 0..STEPS {
        let point = [xi.x, xi.y];
        let (values, slopes) = (
            Parent::<NODES>::values(&point),
            Parent::<NODES>::slopes(&point),
        );
        let place: Vector3<f64> = places.iter().zip(values).map(|(x, n)| x * n).sum();
        let tangent = |m: usize| -> Vector3<f64> {
            places
                .iter()
                .zip(&slopes)
                .map(|(x, slope)| x * slope[m])
                .sum()
        };
        let (a, b, left) = (tangent(0), tangent(1), at - place);
        let gram = Matrix2::new(a.dot(&a), a.dot(&b), a.dot(&b), b.dot(&b));
        xi += gram.try_inverse()? * Vector2::new(a.dot(&left), b.dot(&left));
    }
    let values = Parent::<NODES>::values(&[xi.x, xi.y]);
    let place: Vector3<f64> = places.iter().zip(values).map(|(x, n)| x * n).sum();
    (is_inside(&xi) && (at - place).norm() <= ON_FACE * size).then(|| values.to_vec())
}
