//! The widest vector unit of the machine, chosen at run time.

use pulp::{Arch, Simd, WithSimd};

/// Work that is compiled for each vector unit.
pub(super) trait Task {
    /// Type of its result.
    type Output;

    /// Does it with eight numbers in `K` registers.
    fn run<S: Simd, const K: usize>(self, unit: S) -> Self::Output;
}

struct Eight<T>(T);

impl<T: Task> WithSimd for Eight<T> {
    type Output = T::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) -> T::Output {
        match S::F64_LANES {
            8 => self.0.run::<S, 1>(unit),
            4 => self.0.run::<S, 2>(unit),
            2 => self.0.run::<S, 4>(unit),
            1 => self.0.run::<S, 8>(unit),
            lanes => unreachable!("vector units have 1, 2, 4 or 8 lanes of 64 bits, not {lanes}"),
        }
    }
}

/// Does a task with the widest vector unit of this machine.
#[inline]
pub(super) fn dispatch<T: Task>(task: T) -> T::Output {
    Arch::new().dispatch(Eight(task))
}
