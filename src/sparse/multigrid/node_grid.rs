//! A box grid of nodes with the unknowns at each node.
//!
//! Coarsening along one axis: every other plane stays, and the last one; values between are interpolated.

use nalgebra::Matrix4;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Components of a node: three displacements and a potential.
pub(super) const COMPONENTS: usize = 4;
/// Entries of a block.
pub(super) const ENTRIES: usize = COMPONENTS * COMPONENTS;
/// Neighbours of a node, itself included.
pub(super) const NEIGHBOURS: usize = 27;
/// The node itself among its neighbours.
pub(super) const OWN: usize = 13;

/// A block of the matrix: entries between the components of two nodes, by column.
pub type NodeBlock = [f64; ENTRIES];

/// A box grid of nodes, which count along the first axis first.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeGrid {
    /// Places of the node planes along each axis in mm, ascending, two or more.
    pub planes: [Vec<f64>; 3],
    /// Unknowns of each node by component; `None` where the value is given.
    pub unknowns: Vec<[Option<u32>; COMPONENTS]>,
    /// True if elements have pressures, as they resist changes of their volumes by far more than anything else.
    pub has_pressures: bool,
}

impl NodeGrid {
    /// Number of planes along each axis.
    pub(super) fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.planes[axis].len())
    }
}

/// Bits of the index of a plane in the code of a node.
const BITS: u32 = 20;
/// Most planes along an axis of all boxes.
pub(super) const PLANES: usize = (1 << BITS) - 4;
/// Difference of codes of a node and its last neighbour.
const ONE: u64 = 1 | 1 << BITS | 1 << (2 * BITS);

/// A node among those of all boxes and meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridNode {
    number: u32,
    /// Number of the block with a neighbour below in all directions, as if all before it were there.
    block: u32,
    /// Numbers of planes with neighbours along the first two axes.
    widths: [u8; 2],
    /// Indices of its planes, where it has some; boxes stand one above the other, and do not touch.
    code: u64,
}

impl GridNode {
    /// A node of a box with planes along each axis at these indices; its row begins with a block, and `below` planes belong to other boxes.
    pub(super) fn on_box(
        number: usize,
        block: usize,
        counts: [usize; 3],
        at: [usize; 3],
        below: usize,
    ) -> Self {
        let planes = [0, 1, 2].map(|axis| near(counts[axis], at[axis]));
        let widths = [0, 1].map(|axis| planes[axis].len());
        let missing = [0, 1, 2].map(|axis| planes[axis].start + 1 - at[axis]);
        let before = missing[0] + widths[0] * (missing[1] + widths[1] * missing[2]);
        let [x, y, z] = [at[0], at[1], below + at[2]].map(|plane| plane as u64);
        Self {
            number: number as u32,
            block: (block as u32).wrapping_sub(before as u32),
            widths: widths.map(|width| width as u8),
            code: x | y << BITS | z << (2 * BITS),
        }
    }

    /// Its number.
    pub(super) fn number(self) -> usize {
        self.number as usize
    }

    /// The node of a mesh without a grid with this number.
    pub(super) fn of_mesh(number: usize) -> Self {
        Self {
            number: number as u32,
            block: 0,
            widths: [0; 2],
            code: u64::MAX,
        }
    }

    /// Returns true if it is a node of a box.
    pub(super) fn is_on_box(self) -> bool {
        self.code != u64::MAX
    }

    /// Number of the block of its rows and the columns of another node of a box; `None` where they are no neighbours.
    #[inline(always)]
    pub(super) fn neighbour_block(self, other: Self) -> Option<usize> {
        let steps = other.code.wrapping_sub(self.code).wrapping_add(ONE);
        let [x, y] = [steps, steps >> BITS].map(|step| step & ((1 << BITS) - 1));
        let z = steps >> (2 * BITS);
        let [width_x, width_y] = self.widths.map(u64::from);
        let is_neighbour = x <= 2 && y <= 2 && z <= 2;
        let place = (x + width_x * (y + width_y * z)) as u32;
        is_neighbour.then(|| self.block.wrapping_add(place) as usize)
    }
}

/// A bit for each component of a node whose value is unknown.
pub(super) fn free_components(unknowns: &[Option<u32>; COMPONENTS]) -> u8 {
    let bits = unknowns.iter().enumerate();
    bits.fold(0, |free, (component, unknown)| {
        free | u8::from(unknown.is_some()) << component
    })
}

/// Axis indices of a node.
pub(super) fn indices([n_x, n_y, _]: [usize; 3], node: usize) -> [usize; 3] {
    [node % n_x, node / n_x % n_y, node / (n_x * n_y)]
}

/// Number of the node at axis indices.
pub(super) fn node_at([n_x, n_y, _]: [usize; 3], [x, y, z]: [usize; 3]) -> usize {
    x + n_x * (y + n_y * z)
}

/// Planes next to one of so many, and itself.
pub(super) fn near(planes: usize, plane: usize) -> Range<usize> {
    plane.saturating_sub(1)..planes.min(plane + 2)
}

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
    pub(super) fn of_mesh(elements: &[Vec<u32>], free: &[u8]) -> Self {
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

/// A block of the matrix, by column.
pub(super) type Block = [f32; COMPONENTS * COMPONENTS];

/// Values of the components of a node.
pub(super) type AtNode = [f32; COMPONENTS];

/// Adds a block times a vector.
#[inline(always)]
pub(super) fn add(sum: &mut AtNode, block: &Block, x: &AtNode) {
    for (column, x) in block.chunks_exact(COMPONENTS).zip(x) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += entry * x;
        }
    }
}

/// Adds a block in double precision times a vector.
#[inline(always)]
pub(super) fn add_double<T: Copy + Into<f64>>(
    sum: &mut [f64; COMPONENTS],
    block: &NodeBlock,
    x: &[T; COMPONENTS],
) {
    for (column, x) in block.chunks_exact(COMPONENTS).zip(x) {
        let x: f64 = (*x).into();
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += entry * x;
        }
    }
}

/// The values of a node with this inverse of its diagonal block, of which its neighbours have this sum.
#[inline(always)]
pub(super) fn solved(inverse: &Block, rhs: &AtNode, sum: &AtNode) -> AtNode {
    let left: AtNode = std::array::from_fn(|c| rhs[c] - sum[c]);
    let mut solution = AtNode::default();
    add(&mut solution, inverse, &left);
    solution
}

/// The inverse of a block on the diagonal, in which rows and columns of given values are zero; `None` where it is singular.
pub(super) fn inverse_of(block: &Block) -> Option<Block> {
    let mut own = Matrix4::from_fn(|row, col| f64::from(block[COMPONENTS * col + row]));
    // Of given values the whole row is zero.
    let given = [0, 1, 2, 3].map(|component| own[(component, component)] == 0.0);
    for component in (0..COMPONENTS).filter(|&c| given[c]) {
        own[(component, component)] = 1.0;
    }
    let mut found = own.try_inverse()?;
    for component in (0..COMPONENTS).filter(|&c| given[c]) {
        found[(component, component)] = 0.0;
    }
    let mut inverse = Block::default();
    for (entry, value) in inverse.iter_mut().zip(found.iter()) {
        *entry = *value as f32;
    }
    let is_finite = inverse.iter().all(|entry| entry.is_finite());
    is_finite.then_some(inverse)
}

/// Adds the transpose of a block times a vector.
#[inline(always)]
pub(super) fn add_transposed(sum: &mut AtNode, block: &Block, x: &AtNode) {
    for (column, sum) in block.chunks_exact(COMPONENTS).zip(sum) {
        for (x, entry) in x.iter().zip(column) {
            *sum += entry * x;
        }
    }
}

/// Adds the product of two blocks.
#[inline(always)]
pub(super) fn add_product(sum: &mut Block, a: &Block, b: &Block) {
    for column in 0..COMPONENTS {
        for middle in 0..COMPONENTS {
            let factor = b[COMPONENTS * column + middle];
            for row in 0..COMPONENTS {
                sum[COMPONENTS * column + row] += a[COMPONENTS * middle + row] * factor;
            }
        }
    }
}

/// Adds the product of the transpose of a block and another one.
#[inline(always)]
pub(super) fn add_transposed_product(sum: &mut Block, a: &Block, b: &Block) {
    let mut turned = Block::default();
    for column in 0..COMPONENTS {
        for row in 0..COMPONENTS {
            turned[COMPONENTS * column + row] = a[COMPONENTS * row + column];
        }
    }
    add_product(sum, &turned, b);
}

/// Largest ratio of spacings at which an axis becomes coarser together with the one of the shortest spacing.
const EVEN: f64 = 1.7;

/// Transfer between the planes of one axis and those of a coarser grid.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Planes that stay.
    pub(super) kept: Vec<usize>,
    /// Coarse planes from which each plane is interpolated, with weights; a weight of zero where there is one alone.
    pub(super) parents: Vec<[(usize, f32); 2]>,
    /// Planes to which each coarse plane contributes.
    pub(super) children: Vec<Vec<(usize, f32)>>,
}

impl Axis {
    /// Of these planes, every other one of which stays, or all.
    fn new(planes: &[f64], is_coarser: bool) -> Self {
        let last = planes.len() - 1;
        let mut kept: Vec<usize> = (0..=last).step_by(if is_coarser { 2 } else { 1 }).collect();
        if kept.last() != Some(&last) {
            kept.push(last);
        }
        let parents = (0..=last).map(|plane| {
            let after = kept.partition_point(|&k| k < plane);
            if kept[after] == plane {
                return [(after, 1.0), (after, 0.0)];
            }
            let [below, above] = [kept[after - 1], kept[after]].map(|k| planes[k]);
            let part = ((planes[plane] - below) / (above - below)) as f32;
            [(after - 1, 1.0 - part), (after, part)]
        });
        let parents: Vec<_> = parents.collect();
        let mut children = vec![Vec::new(); kept.len()];
        for (plane, of) in parents.iter().enumerate() {
            for &(coarse, weight) in of.iter().filter(|(_, weight)| *weight > 0.0) {
                children[coarse].push((plane, weight));
            }
        }
        Self {
            kept,
            parents,
            children,
        }
    }
}

/// Transfers to the next coarser grid; `None` where no axis can become coarser.
pub(super) fn coarsening(planes: &[Vec<f64>; 3]) -> Option<[Axis; 3]> {
    let spacing = |planes: &Vec<f64>| {
        let spans = (planes.len() - 1) as f64;
        (planes.len() > 2).then(|| (planes[planes.len() - 1] - planes[0]) / spans)
    };
    let spacings = planes.each_ref().map(spacing);
    let shortest = spacings.iter().flatten().copied().reduce(f64::min)?;
    let is_coarser = |axis: usize| spacings[axis].is_some_and(|s| s < EVEN * shortest);
    Some([0, 1, 2].map(|axis| Axis::new(&planes[axis], is_coarser(axis))))
}
