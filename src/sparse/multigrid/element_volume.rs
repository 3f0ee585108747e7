//! The part of a matrix by which elements resist changes of their volumes, a product of derivatives of each volume.

use crate::sparse::multigrid::node_grid::{COMPONENTS, OWN};
use rustc_hash::FxHashMap;

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

/// Position in the number of a corner of each node of an element, which are listed around its lower face, then around its upper one.
const CORNER_OF: [usize; CORNERS] = [0, 1, 3, 2, 4, 5, 7, 6];
/// In place of a node that does not move.
const STILL: u32 = u32::MAX;

/// Nodes of a part at the corners of its elements.
#[derive(Debug)]
pub(super) enum VolumePlaces {
    /// Those of a box count like their first nodes; distances to the corners.
    Box([usize; CORNERS]),
    /// Nodes by corner, and elements by their nodes that move.
    Mesh(Vec<[u32; CORNERS]>, FxHashMap<[u32; CORNERS], Vec<u32>>),
}

impl VolumePlaces {
    /// Of a mesh of elements, whose nodes have a bit for each component without a given value.
    pub(super) fn of_mesh(elements: &[[u32; CORNERS]], free: &[u8]) -> Self {
        let mut by_nodes = FxHashMap::<_, Vec<u32>>::default();
        let mut list = Vec::with_capacity(elements.len());
        for (element, nodes) in elements.iter().enumerate() {
            let mut corners = [0; CORNERS];
            for (node, corner) in nodes.iter().zip(CORNER_OF) {
                corners[corner] = *node;
            }
            list.push(corners);
            let moving = corners.map(|node| (free[node as usize] & 0b111 != 0).then_some(node));
            by_nodes
                .entry(key(&moving))
                .or_default()
                .push(element as u32);
        }
        Self::Mesh(list, by_nodes)
    }

    /// Nodes at the corners of an element.
    #[inline(always)]
    pub(super) fn corners(&self, element: usize) -> [usize; CORNERS] {
        match self {
            Self::Box(steps) => steps.map(|step| element + step),
            Self::Mesh(list, _) => list[element].map(|node| node as usize),
        }
    }

    /// The element of a box of which a node is a corner; `None` where there is none, and of a mesh.
    pub(super) fn of_corner(&self, node: usize, corner: usize) -> Option<usize> {
        match self {
            Self::Box(steps) => node.checked_sub(steps[corner]),
            Self::Mesh(..) => None,
        }
    }

    /// The element with these nodes that move, by corner; of several that are still to be found any will do.
    pub(super) fn find(
        &self,
        moving: &[Option<u32>; CORNERS],
        is_free: impl Fn(&usize) -> bool,
    ) -> Option<usize> {
        match self {
            Self::Box(steps) => {
                let known = moving.iter().zip(steps);
                let mut known = known.filter_map(|(node, step)| Some((*node)? as usize - step));
                known.next()
            }
            Self::Mesh(_, by_nodes) => {
                let found = by_nodes.get(&key(moving))?.iter();
                found.map(|&element| element as usize).find(is_free)
            }
        }
    }
}

/// Nodes that move in ascending order.
fn key(moving: &[Option<u32>; CORNERS]) -> [u32; CORNERS] {
    let mut nodes = moving.map(|node| node.unwrap_or(STILL));
    nodes.sort_unstable();
    nodes
}

impl ElementVolume {
    /// Its change along a vector, with the nodes at its corners.
    #[inline(always)]
    pub(super) fn along(&self, corners: &[usize; CORNERS], x: &[f32]) -> f64 {
        let mut sum = 0.0;
        for (slopes, corner) in self.slopes.iter().zip(corners) {
            let there = &x[COMPONENTS * corner..][..COMPONENTS];
            for (slope, x) in slopes.iter().zip(there) {
                sum += slope * f64::from(*x);
            }
        }
        sum
    }
}
