//! Compact index: half the memory of a `usize`.

/// A number of which large meshes have tens of millions.
///
/// # Panics
/// It is too large for that.
pub(crate) fn compact_index(i: usize) -> u32 {
    u32::try_from(i).expect("entries can be counted")
}
