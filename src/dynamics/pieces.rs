//! Rows of a long motion, made in pieces in parallel.

use std::ops::Range;

use rayon::prelude::*;

use crate::math::{Stopped, has_pool};

/// Instants that one thread observes in a row.
pub(super) const PIECE: usize = 256;

/// Rows `0..count` in order, made by pieces of a length.
///
/// # Errors
/// One of the pieces was stopped.
pub(super) fn in_pieces<T: Send>(
    count: usize,
    piece: usize,
    make: impl Fn(Range<usize>) -> Result<Vec<T>, Stopped> + Sync,
) -> Result<Vec<T>, Stopped> {
    let made = |i: usize| make(i * piece..count.min((i + 1) * piece));
    let pieces = 0..count.div_ceil(piece);
    let rows: Vec<Vec<T>> = match has_pool() {
        true => {
            let pieces = pieces.into_par_iter().with_max_len(1);
            pieces.map(made).collect::<Result<_, _>>()
        }
        false => pieces.map(made).collect(),
    }?;
    Ok(rows.into_iter().flatten().collect())
}
