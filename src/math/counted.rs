//! Compact counts in half of the memory.

/// A number of which large meshes have tens of millions.
///
/// # Panics
/// It is too large for that.
pub(crate) fn counted(i: usize) -> u32 {
    u32::try_from(i).expect("entries can be counted")
}
