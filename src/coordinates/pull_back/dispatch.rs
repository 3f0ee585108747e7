//! The vector unit of the machine, chosen at run time among those whose registers fill rows exactly.

use crate::coordinates::tree::LANES;
use pulp::{Arch, Scalar, Simd, WithSimd};

/// Work that is compiled for each vector unit.
pub(super) trait Task {
    /// Does it; a register has a part of [`LANES`] numbers.
    fn run<S: Simd>(self, unit: S);
}

struct Padded<T>(T);

impl<T: Task> WithSimd for Padded<T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        match LANES % S::F64_LANES {
            0 => self.0.run(unit),
            _ => self.0.run(Scalar::new()),
        }
    }
}

/// Does a task with the vector unit of this machine.
#[inline]
pub(super) fn dispatch<T: Task>(task: T) {
    Arch::new().dispatch(Padded(task));
}
