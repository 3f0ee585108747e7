//! A triangle of a membrane without stress: gradients of the shape functions along orthonormal directions of it, areas and masses.

use crate::element::Inverted;
use crate::math::Vector;
use crate::mesh::interpolation::{Interpolation, Parent};

/// Points of a triangle, whose weights are a third of its area; they are exact for the stiffness of straight ones.
pub const SHEET_POINTS: usize = 3;

const PLACES: [[f64; 2]; SHEET_POINTS] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// A point of a quadratic triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetPoint {
    /// Gradients of the shape functions along both directions in 1/mm.
    pub gradients: [[f64; 2]; 6],
    /// Area in mm².
    pub area: f64,
    /// Both directions and the normal.
    pub frame: [Vector; 3],
}

/// Σ x_i ∂N_i/∂ξ.
fn slopes_of(nodes: &[Vector; 6], slopes: &[[f64; 2]; 6]) -> [Vector; 2] {
    [0, 1].map(|m| nodes.iter().zip(slopes).map(|(x, s)| x * s[m]).sum())
}

impl SheetPoint {
    /// The points of the triangle with these nodes in mm.
    ///
    /// # Errors
    /// It has no area at a point.
    pub fn all(nodes: &[Vector; 6]) -> Result<[Self; SHEET_POINTS], Inverted> {
        let points = [0, 1, 2].map(|point| Self::new(nodes, point));
        let [a, b, c] = points;
        Ok([a?, b?, c?])
    }

    fn new(nodes: &[Vector; 6], point: usize) -> Result<Self, Inverted> {
        let slopes: [[f64; 2]; 6] = Parent::<6>::slopes(&PLACES[point]);
        let [along, other] = slopes_of(nodes, &slopes);
        let across = along.cross(&other);
        let determinant = across.norm();
        let normal = across.try_normalize(0.0);
        let Some(normal) = normal.filter(|normal| normal.iter().all(|x| x.is_finite())) else {
            return Err(Inverted { point, determinant });
        };
        let first = along.normalize();
        let second = normal.cross(&first);
        // The Jacobian has the components (along·first, 0; other·first, other·second) of both slopes.
        let [a, b, c] = [along.dot(&first), other.dot(&first), other.dot(&second)];
        Ok(Self {
            gradients: slopes.map(|[s, t]| [s / a, (t - s * b / a) / c]),
            area: determinant / 6.0,
            frame: [first, second, normal],
        })
    }

    /// The tangents f₁, f₂ that the directions have become.
    pub fn tangents(&self, x: &[Vector; 6]) -> [Vector; 2] {
        slopes_of(x, &self.gradients)
    }
}

/// Integrals of products of shape functions over the triangle with these nodes in mm².
pub fn sheet_masses(nodes: &[Vector; 6]) -> [[f64; 6]; 6] {
    let mut sums = [[0.0; 6]; 6];
    for (at, weight) in Parent::<6>::quadrature() {
        let values: [f64; 6] = Parent::<6>::values(&at);
        let [a, b] = slopes_of(nodes, &Parent::<6>::slopes(&at));
        let area = a.cross(&b).norm() * weight;
        for (row, n) in sums.iter_mut().zip(values) {
            for (sum, m) in row.iter_mut().zip(values) {
                *sum += n * m * area;
            }
        }
    }
    sums
}
