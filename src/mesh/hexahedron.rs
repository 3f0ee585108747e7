//! The trilinear hexahedron: N_i = ⅛ (1 ± ξ)(1 ± η)(1 ± ζ) over [−1, 1]³, 2 × 2 × 2 Gauss points.

use super::interpolation::{Element, Interpolation, Parent, Point};

/// Nodes of a hexahedron in the parent cube [−1, 1]³; also the signs of the Gauss points, of which each lies towards a node.
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Lower face, upper face, then the sides.
pub(super) const FACES: [&[usize]; 6] = [
    &[0, 3, 2, 1],
    &[4, 5, 6, 7],
    &[0, 1, 5, 4],
    &[1, 2, 6, 5],
    &[2, 3, 7, 6],
    &[3, 0, 4, 7],
];

/// 1/√3, the place of the Gauss points; their weights are 1.
const POINT: f64 = 0.577_350_269_189_625_8;

/// 1 + ξ_i ξ in direction `m`.
fn factor<const DIMENSIONS: usize>(i: usize, at: &[f64; DIMENSIONS], m: usize) -> f64 {
    1.0 + CORNERS[i][m] * at[m]
}

impl Interpolation<3, 8> for Parent<8> {
    fn values(at: &[f64; 3]) -> [f64; 8] {
        std::array::from_fn(|i| 0.125 * factor(i, at, 0) * factor(i, at, 1) * factor(i, at, 2))
    }

    fn slopes(at: &[f64; 3]) -> [[f64; 3]; 8] {
        let slope = |i: usize, m: usize| {
            0.125 * CORNERS[i][m] * factor(i, at, (m + 1) % 3) * factor(i, at, (m + 2) % 3)
        };
        std::array::from_fn(|i| [0, 1, 2].map(|m| slope(i, m)))
    }

    fn quadrature() -> Vec<Point<3>> {
        Self::POINTS.to_vec()
    }
}

impl Element<8> for Parent<8> {
    const PLACES: [[f64; 3]; 8] = CORNERS;
    const CENTRE: [f64; 3] = [0.0; 3];
    const POINTS: [Point<3>; 8] = {
        let mut points = [([0.0; 3], 1.0); 8];
        let mut i = 0;
        while i < 24 {
            points[i / 3].0[i % 3] = CORNERS[i / 3][i % 3] * POINT;
            i += 1;
        }
        points
    };
}

/// A bilinear face.
impl Interpolation<2, 4> for Parent<4> {
    fn values(at: &[f64; 2]) -> [f64; 4] {
        std::array::from_fn(|i| 0.25 * factor(i, at, 0) * factor(i, at, 1))
    }

    fn slopes(at: &[f64; 2]) -> [[f64; 2]; 4] {
        let slope = |i: usize, m: usize| 0.25 * CORNERS[i][m] * factor(i, at, 1 - m);
        std::array::from_fn(|i| [0, 1].map(|m| slope(i, m)))
    }

    fn quadrature() -> Vec<Point<2>> {
        // The corners of the square are the first ones of the cube.
        let at = |corner: &[f64; 3]| [corner[0], corner[1]].map(|c| c / 3.0_f64.sqrt());
        CORNERS[..4]
            .iter()
            .map(|corner| (at(corner), 1.0))
            .collect()
    }
}
