//! A box grid of nodes with the unknowns at each node.

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
    /// Indices of its planes, where it has some; boxes stand one above the other, and do not touch.
    code: u64,
}

impl GridNode {
    /// The node with this number at these planes.
    pub(super) fn new(number: usize, [x, y, z]: [usize; 3]) -> Self {
        let [x, y, z] = [x, y, z].map(|plane| plane as u64);
        Self {
            number: number as u32,
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
            code: u64::MAX,
        }
    }

    /// Number of the block of its rows and the columns of another node of a box; `None` where they are no neighbours.
    #[inline(always)]
    pub(super) fn neighbour_block(self, other: Self) -> Option<usize> {
        let steps = other.code.wrapping_sub(self.code).wrapping_add(ONE);
        let [x, y] = [steps, steps >> BITS].map(|step| step & ((1 << BITS) - 1));
        let z = steps >> (2 * BITS);
        let is_neighbour = x <= 2 && y <= 2 && z <= 2;
        let neighbour = (9 * z + 3 * y + x) as usize;
        is_neighbour.then(|| NEIGHBOURS * self.number as usize + neighbour)
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

/// Position among the neighbours of a node of the one at these indices; `None` where it is no neighbour.
pub(super) fn neighbour(of: [usize; 3], other: [usize; 3]) -> Option<usize> {
    let mut place = 0;
    for axis in [2, 1, 0] {
        let step = (other[axis] + 1).checked_sub(of[axis])?;
        if step > 2 {
            return None;
        }
        place = 3 * place + step;
    }
    Some(place)
}

/// Distance in the numbering of nodes to each neighbour.
pub(super) fn offsets([n_x, n_y, _]: [usize; 3]) -> [isize; NEIGHBOURS] {
    let (n_x, n_xy) = (n_x as isize, (n_x * n_y) as isize);
    std::array::from_fn(|place| {
        let step = |divisor: usize| (place / divisor % 3) as isize - 1;
        step(1) + n_x * step(3) + n_xy * step(9)
    })
}
