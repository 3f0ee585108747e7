//! Blocks of equations with as many unknowns or more, factored panel by panel within their envelope.
//!
//! A block is A with its unknowns exchanged so that `P Aᵀ = L [U; 0]`: exchanges of rows of Aᵀ choose the unknowns that the equations
//! determine, those before the equations' number. A panel exchanges rows once, and L holds what stood there then: it is a product of one
//! factor for each panel, with exchanges between them.

use std::fmt;
use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::{Accum, MatMut, MatRef, Par};

use super::bandwidth_order::{Envelope, Panel};

/// Least pivot against the entries of its equation; less is an error of rounding.
const REGULAR: f64 = 1e-14;

/// A block with its factors.
#[derive(Clone, Debug)]
pub(super) struct BlockLu {
    pub(super) envelope: Envelope,
    /// Aᵀ by columns, one for each equation.
    values: Vec<f64>,
    /// The row with which each pivot was exchanged.
    pub(super) exchanges: Vec<u32>,
}

/// Memory to factor one block after the other.
pub(super) struct Room {
    /// Greatest entry of each equation.
    largest: Vec<f64>,
    /// Rows of a panel after its exchanges and where they are, then which row stands where.
    forward: Vec<u32>,
    inverse: Vec<u32>,
    standing: Vec<u32>,
    memory: MemBuffer,
}

impl fmt::Debug for Room {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Room")
            .field("equations", &self.largest.len())
            .finish_non_exhaustive()
    }
}

impl Room {
    /// For any of these blocks.
    pub(super) fn for_blocks(blocks: &[BlockLu]) -> Self {
        let panels = blocks.iter().flat_map(|block| &block.envelope.panels);
        let scratch = panels.map(|panel| {
            let (rows, columns) = (panel.height(), panel.equations.len());
            factor::lu_in_place_scratch::<u32, f64>(rows, columns, Par::Seq, Default::default())
        });
        let memory = scratch.fold(Default::default(), |all, one| one.or(all));
        let most = |size: fn(&Envelope) -> usize| {
            let sizes = blocks.iter().map(|block| size(&block.envelope));
            sizes.max().unwrap_or(0)
        };
        let rows = most(|envelope| envelope.stride);
        Self {
            largest: vec![0.0; most(|envelope| envelope.equations)],
            forward: vec![0; rows],
            inverse: vec![0; rows],
            standing: vec![0; rows],
            memory: MemBuffer::new(memory),
        }
    }
}

impl BlockLu {
    /// A block with entries in this envelope.
    pub(super) fn new(envelope: Envelope) -> Self {
        Self {
            values: vec![0.0; envelope.len()],
            exchanges: vec![0; envelope.equations],
            envelope,
        }
    }

    /// Makes it zero.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds to an entry.
    pub(super) fn add(&mut self, equation: usize, unknown: usize, value: f64) {
        self.values[unknown + equation * self.envelope.stride] += value;
    }

    /// Factors it; false where its equations depend on each other, or are no finite numbers.
    pub(super) fn factor(&mut self, room: &mut Room) -> bool {
        for panel in &self.envelope.panels {
            for j in panel.equations.clone() {
                let column = column(&self.values, self.envelope.stride, panel.rows.clone(), j);
                let most = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                room.largest[j] = most;
            }
        }
        for panel in &self.envelope.panels {
            let exchanges = &mut self.exchanges[panel.equations.clone()];
            eliminate(
                panel,
                &mut self.values,
                self.envelope.stride,
                exchanges,
                room,
            );
        }
        let pivots = self.values.iter().step_by(self.envelope.stride + 1);
        let mut pivots = room
            .largest
            .iter()
            .zip(pivots.take(self.envelope.equations));
        pivots.all(|(largest, pivot)| pivot.abs() > REGULAR * largest)
    }

    /// Rows of the column of an equation.
    pub(super) fn column(&self, rows: Range<usize>, equation: usize) -> &[f64] {
        column(&self.values, self.envelope.stride, rows, equation)
    }

    /// Rows of the columns of a panel.
    pub(super) fn rectangle(&self, rows: Range<usize>, panel: &Panel) -> MatRef<'_, f64> {
        let (start, stride) = (panel.equations.start, self.envelope.stride);
        let values = &self.values[rows.start + start * stride..];
        let (rows, columns) = (rows.len(), panel.equations.len());
        MatRef::from_column_major_slice_with_stride(values, rows, columns, stride)
    }
}

fn column(values: &[f64], stride: usize, rows: Range<usize>, equation: usize) -> &[f64] {
    &values[rows.start + equation * stride..][..rows.len()]
}

/// Subtracts the product of two matrices.
pub(super) fn subtract_product(from: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    matmul(from, Accum::Add, a, b, -1.0, Par::Seq);
}

/// Eliminates the equations of one panel.
fn eliminate(
    panel: &Panel,
    values: &mut [f64],
    stride: usize,
    exchanges: &mut [u32],
    room: &mut Room,
) {
    let (start, width, height) = (panel.equations.start, panel.equations.len(), panel.height());
    let values = &mut values[start + start * stride..];
    let columns = panel.end - start;
    let all = MatMut::from_column_major_slice_with_stride_mut(values, height, columns, stride);
    let (mut factors, mut others) = all.split_at_col_mut(width);
    let (forward, inverse) = (&mut room.forward[..height], &mut room.inverse[..height]);
    factor::lu_in_place(
        factors.as_mut(),
        forward,
        inverse,
        Par::Seq,
        MemStack::new(&mut room.memory),
        Default::default(),
    );
    // The same as exchanges, one for each pivot.
    let standing = &mut room.standing[..height];
    for (i, row) in standing.iter_mut().enumerate() {
        *row = i as u32;
        inverse[i] = i as u32;
    }
    for (i, exchange) in exchanges.iter_mut().enumerate() {
        let (now, wanted) = (standing[i], forward[i]);
        let at = inverse[wanted as usize];
        standing.swap(i, at as usize);
        (inverse[now as usize], inverse[wanted as usize]) = (at, i as u32);
        *exchange = start as u32 + at;
    }
    if others.ncols() == 0 {
        return;
    }
    for mut column in others.as_mut().col_iter_mut() {
        for (i, &exchange) in exchanges.iter().enumerate() {
            let at = exchange as usize - start;
            let value = column[i];
            column[i] = column[at];
            column[at] = value;
        }
    }
    let (square, below) = factors.as_ref().split_at_row(width);
    let (mut right, rest) = others.split_at_row_mut(width);
    triangular::solve_unit_lower_triangular_in_place(square, right.as_mut(), Par::Seq);
    if below.nrows() > 0 {
        subtract_product(rest, below, right.as_ref());
    }
}
