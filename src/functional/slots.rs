//! Places of the derivatives of one element.

/// No slot.
pub(super) const NONE: u32 = u32::MAX;

/// The slots of one element: pairs of vectors, then of vectors and scalars, then of scalars.
#[derive(Clone, Copy)]
pub(super) struct Slots<'a, const NV: usize, const NS: usize>(pub(super) &'a [u32]);

impl<const NV: usize, const NS: usize> Slots<'_, NV, NS> {
    pub(super) const COUNT: usize = NV * NV + NV * NS + NS * NS;

    pub(super) fn vectors(self, i: usize, j: usize) -> Option<usize> {
        let slot = self.0[NV * i + j];
        (slot != NONE).then_some(slot as usize)
    }

    pub(super) fn mixed(self, i: usize, s: usize) -> usize {
        self.0[NV * NV + NS * i + s] as usize
    }

    pub(super) fn scalars(self, s: usize, t: usize) -> Option<usize> {
        let slot = self.0[NV * NV + NV * NS + NS * s + t];
        (slot != NONE).then_some(slot as usize)
    }
}
