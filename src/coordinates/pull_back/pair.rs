//! A coupled pair of articulated vectors.

/// Kind of the block of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockKind {
    Full,
    /// A multiple of the identity; it comes from an energy, and is the same for the pair in the other order.
    Isotropic,
}

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) slot: u32,
    /// Slot of the pair in the other order.
    pub(super) transposed: u32,
    /// Offsets at which the columns of both start.
    pub(super) first: [u32; 2],
}
