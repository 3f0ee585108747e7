//! Factorisation: each front takes the updates of those below it, eliminates its own rows and leaves its update.

use crate::math::{IsOver, join_if};
use crate::sparse::fronts::tree::{Front, STRIP, Tree};
use crate::sparse::{Precision, Singular};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::traits::RealField;
use faer::traits::ext::ComplexFieldExt;
use faer::{Accum, MatMut, Par};

/// A factorisation of one matrix.
pub(super) struct Elimination<'a> {
    pub(super) tree: &'a Tree,
    /// Values of the matrix by slot.
    pub(super) values: &'a [f64],
    pub(super) is_over: IsOver<'a>,
}

/// Reason why a front is not eliminated.
pub(super) enum Undone {
    Singular(Singular),
    Stopped,
}

impl Elimination<'_> {
    /// Memory for the pivots of one front.
    pub(super) fn memory<T: Number>(&self) -> MemBuffer {
        let most = self.tree.fronts.iter().map(|front| front.own).max();
        MemBuffer::new(cholesky_in_place_scratch::<T>(
            most.unwrap_or_default(),
            Par::Seq,
            Default::default(),
        ))
    }

    /// Factorises a subtree: its panels are filled, and the update of its last front, packed, begins the space.
    pub(super) fn run<T: Number>(
        &self,
        f: usize,
        panels: &mut [T],
        space: &mut [T],
        memory: &mut MemBuffer,
    ) -> Result<(), Undone> {
        let front = &self.tree.fronts[f];
        let (below, panel) = panels.split_at_mut(panels.len() - front.panel());
        let mut start = 0;
        if let Some(sides) = front.sides {
            let [a, b] = sides.fronts;
            let (a_panels, b_panels) = below.split_at_mut(self.tree.fronts[a].panels);
            if sides.at_once {
                let (a_space, b_space) = space.split_at_mut(sides.second);
                let (first, second) = join_if(
                    true,
                    || self.run(a, a_panels, a_space, memory),
                    || self.run(b, b_panels, b_space, &mut self.memory::<T>()),
                );
                first.and(second)?;
            } else {
                self.run(a, a_panels, space, memory)?;
                self.run(b, b_panels, &mut space[sides.second..], memory)?;
            }
            start = sides.second + self.tree.fronts[b].triangle();
        }
        let (taken, space_left) = space.split_at_mut(start);
        let (update, strip) = space_left.split_at_mut(front.square());
        panel.fill(T::default());
        update.fill(T::default());
        for &(slot, place) in &self.tree.entries[front.entries.clone()] {
            panel[place as usize] = T::near(self.values[slot as usize]);
        }
        if let Some(sides) = front.sides {
            let [a, b] = sides.fronts.map(|side| &self.tree.fronts[side]);
            assemble(a, taken, front, panel, update);
            assemble(b, &taken[sides.second..], front, panel, update);
        }
        self.eliminate(front, panel, update, strip, memory)?;
        pack(front.boundary.len(), start, space);
        Ok(())
    }

    fn go_on(&self) -> Result<(), Undone> {
        match (self.is_over)() {
            true => Err(Undone::Stopped),
            false => Ok(()),
        }
    }

    /// Eliminates the rows of a front and subtracts what that makes of its update, the lower triangle of it.
    fn eliminate<T: Number>(
        &self,
        front: &Front,
        panel: &mut [T],
        update: &mut [T],
        strip: &mut [T],
        memory: &mut MemBuffer,
    ) -> Result<(), Undone> {
        let (own, kept) = (front.own, front.boundary.len());
        if own == 0 {
            return Ok(());
        }
        self.go_on()?;
        let panel = MatMut::from_column_major_slice_mut(panel, own + kept, own);
        let (mut pivots, mut rest) = panel.split_at_row_mut(own);
        let factor = cholesky_in_place(
            pivots.rb_mut(),
            Default::default(),
            Par::Seq,
            MemStack::new(memory),
            Default::default(),
        );
        // A zero pivot tells no column: the matrix may be regular, and its order unlucky.
        factor.map_err(|_| Undone::Singular(Singular { column: 0 }))?;
        if kept == 0 {
            return Ok(());
        }
        let pivots = pivots.rb();
        solve_unit_lower_triangular_in_place(pivots, rest.rb_mut().transpose_mut(), Par::Seq);
        let mut update = MatMut::from_column_major_slice_mut(update, kept, kept);
        for start in (0..own).step_by(STRIP) {
            self.go_on()?;
            let width = STRIP.min(own - start);
            let mut columns = rest.rb_mut().subcols_mut(start, width);
            let strip = &mut strip[..kept * width];
            let mut products = MatMut::from_column_major_slice_mut(strip, kept, width);
            products.copy_from(&columns);
            for j in 0..width {
                let inverse = pivots[(start + j, start + j)].recip();
                let column = columns.rb_mut().col_mut(j).try_as_col_major_mut();
                let column = column.expect("contiguous columns").as_slice_mut();
                column.iter_mut().for_each(|value| *value *= inverse);
            }
            matmul(
                update.rb_mut(),
                BlockStructure::TriangularLower,
                Accum::Add,
                columns.rb(),
                BlockStructure::Rectangular,
                products.rb().transpose(),
                BlockStructure::Rectangular,
                -faer::traits::math_utils::one::<T>(),
                Par::Seq,
            );
        }
        Ok(())
    }
}

/// Moves the lower triangle of a square of numbers to the beginning, column by column.
fn pack<T: Copy>(size: usize, start: usize, space: &mut [T]) {
    let mut to = 0;
    for j in 0..size {
        let column = start + j * size;
        space.copy_within(column + j..column + size, to);
        to += size - j;
    }
}

/// Adds the update of a front below to the panel and the update of a front.
fn assemble<T: Number>(
    below: &Front,
    from: &[T],
    front: &Front,
    panel: &mut [T],
    update: &mut [T],
) {
    let (rows, kept, width) = (front.rows(), front.boundary.len(), below.boundary.len());
    let mut columns = from;
    for (j, &col) in below.above.iter().enumerate() {
        let (column, rest) = columns.split_at(width - j);
        columns = rest;
        let col = col as usize;
        // Rows after the diagonal stand after it here too: both lists ascend.
        let (to, skipped) = match col.checked_sub(front.own) {
            None => (&mut panel[col * rows..(col + 1) * rows], 0),
            Some(col) => (&mut update[col * kept..(col + 1) * kept], front.own),
        };
        for (value, &row) in column.iter().zip(&below.above[j..]) {
            to[row as usize - skipped] += *value;
        }
    }
}

/// A number of a factor.
pub(crate) trait Number: RealField + Copy + Default {
    /// Its precision.
    const PRECISION: Precision;
    /// LDLᵀ with such numbers, as a table names it.
    const LDLT: &'static str;

    /// The nearest number.
    fn near(value: f64) -> Self;

    /// The number in double precision.
    fn value(self) -> f64;
}

impl Number for f64 {
    const PRECISION: Precision = Precision::Double;
    const LDLT: &'static str = "LDLᵀ by fronts";

    fn near(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }
}

impl Number for f32 {
    const PRECISION: Precision = Precision::Single;
    const LDLT: &'static str = "LDLᵀ by fronts in single precision";

    fn near(value: f64) -> Self {
        value as Self
    }

    fn value(self) -> f64 {
        self.into()
    }
}
