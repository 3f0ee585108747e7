//! The part of a matrix by which elements resist changes of their volumes, a product of derivatives of each volume.

use crate::sparse::multigrid::field::Field;
use crate::sparse::multigrid::node_grid::{COMPONENTS, OWN};

/// Corners of an element; the bits of the number of one say which it is along each axis.
pub(super) const CORNERS: usize = 8;

/// The volume of an element: its derivatives b by the places of the corners, and the factor of b bᵀ in the matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementVolume {
    /// Derivatives by corner and component; zero where a value is given.
    pub slopes: [[f64; COMPONENTS]; CORNERS],
    /// The factor.
    pub factor: f64,
}

/// Distance in the numbering of nodes to each corner of an element from its first one.
pub(super) fn corners([n_x, n_y, _]: [usize; 3]) -> [usize; CORNERS] {
    std::array::from_fn(|corner| (corner & 1) + n_x * ((corner >> 1 & 1) + n_y * (corner >> 2)))
}

/// Position among the neighbours of a corner of another corner of the same element.
pub(super) fn neighbour_of(corner: usize, other: usize) -> usize {
    let step = |axis: usize| (other >> axis & 1) as isize - (corner >> axis & 1) as isize;
    (OWN as isize + step(0) + 3 * step(1) + 9 * step(2)) as usize
}

impl ElementVolume {
    /// Its change along a field, of which the first corner is at a place in the list.
    #[inline(always)]
    pub(super) fn along(
        &self,
        corners: &[usize; CORNERS],
        (at, x): (usize, &Field<[f32; COMPONENTS]>),
    ) -> f64 {
        let mut sum = 0.0;
        for (slopes, corner) in self.slopes.iter().zip(corners) {
            let there = &x.values[at + corner];
            for (slope, x) in slopes.iter().zip(there) {
                sum += slope * f64::from(*x);
            }
        }
        sum
    }
}
