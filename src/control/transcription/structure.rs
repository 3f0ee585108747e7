//! Structures of Jacobian and Hessian: the entries of the periodic values that they keep.

use crate::control::BoundaryError;
use crate::control::numbering::Row;
use crate::control::transcription::energy_rows::Jump;
use crate::control::transcription::limit_rows::SCALAR;
use crate::control::transcription::{Gather, Transcription};
use crate::ipopt::interrupt;
use crate::model::Role;
use crate::nlp::Entries;

impl Transcription<'_> {
    fn jacobian_of(&self) -> Result<Vec<(usize, usize, usize)>, BoundaryError> {
        let layout = self.model.action.layout();
        let u = &self.unknowns;
        let mut list = Vec::new();
        for k in 0..=self.intervals {
            go_on()?;
            for (slot, (i, j)) in layout.same.entries().enumerate() {
                list.push((u.row(k, i), u.unknown(k, j), layout.same_at(k) + slot));
            }
            for i in 0..layout.unknowns {
                list.push((u.row(k, i), u.horizon(), layout.horizon_at(k) + i));
            }
            if k == self.intervals {
                break;
            }
            for (slot, (i, j)) in layout.cross.entries().enumerate() {
                list.push((u.row(k + 1, i), u.unknown(k, j), layout.lower_at(k) + slot));
                list.push((u.row(k, i), u.unknown(k + 1, j), layout.upper_at(k) + slot));
            }
            for side in 0..2 {
                for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                    list.push((
                        u.row(k + side, i),
                        u.scalar(k, s),
                        layout.mixed_at(k, side) + slot,
                    ));
                    list.push((
                        u.row_of_scalar(k, s),
                        u.unknown(k + side, i),
                        layout.mixed_at(k, side) + slot,
                    ));
                }
            }
            for (slot, (s, t)) in layout.scalars.entries().enumerate() {
                let place = layout.scalars_at(k) + slot;
                list.push((u.row_of_scalar(k, s), u.scalar(k, t), place));
                if s != t {
                    list.push((u.row_of_scalar(k, t), u.scalar(k, s), place));
                }
            }
            for s in 0..layout.interval_scalars {
                list.push((
                    u.row_of_scalar(k, s),
                    u.horizon(),
                    layout.horizon_scalars_at(k) + s,
                ));
            }
        }
        let mut place = layout.values(self.intervals);
        let first = self.unknowns.rows.len() - self.limit_rows.len();
        for (r, &(limit, k)) in self.limit_rows.iter().enumerate() {
            for &(side, i) in &self.limits[limit].entries {
                let col = if side == SCALAR {
                    u.scalar(k, i)
                } else {
                    u.unknown(k + side, i)
                };
                list.push((Some(first + r), col, place));
                place += 1;
            }
        }
        let list = list.into_iter();
        let known = list.filter_map(|(row, col, place)| Some((row?, col?, place)));
        Ok(known.collect())
    }

    pub(super) fn lay_jacobian(&mut self) -> Result<(), BoundaryError> {
        // The horizon column has no entry in the rows of constraints, which are instantaneous.
        let horizon = self.unknowns.horizon();
        let lasts = |row: Row| {
            let variable = row.of(&self.model.variables);
            variable.is_some_and(|variable| variable.role != Role::Multiplier)
        };
        let exists = |&(row, col, _): &(usize, usize, usize)| {
            Some(col) != horizon || lasts(self.unknowns.rows[row])
        };
        let list: Vec<_> = self.jacobian_of()?.into_iter().filter(exists).collect();
        go_on()?;
        for (row, col, place) in list {
            self.jacobian_entries.rows.push(row as u32);
            self.jacobian_entries.cols.push(col as u32);
            self.jacobian.push(Gather { place, scale: 1.0 });
        }
        Ok(())
    }

    pub(super) fn lay_hessian(&mut self) -> Result<(), BoundaryError> {
        let layout = self.model.action.layout();
        let u = &self.unknowns;
        let mut list: Vec<(Option<usize>, Option<usize>, usize)> = Vec::new();
        for k in 0..=self.intervals {
            go_on()?;
            for (slot, (i, j)) in layout
                .same
                .entries()
                .enumerate()
                .filter(|(_, (i, j))| i >= j)
            {
                list.push((u.unknown(k, i), u.unknown(k, j), layout.same_at(k) + slot));
            }
            for i in 0..self.model.coordinate_count() {
                list.push((u.horizon(), u.unknown(k, i), layout.horizon_at(k) + i));
            }
            if k == self.intervals {
                break;
            }
            for (slot, (i, j)) in layout.cross.entries().enumerate() {
                list.push((
                    u.unknown(k + 1, i),
                    u.unknown(k, j),
                    layout.lower_at(k) + slot,
                ));
            }
            for side in 0..2 {
                for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                    list.push((
                        u.scalar(k, s),
                        u.unknown(k + side, i),
                        layout.mixed_at(k, side) + slot,
                    ));
                }
            }
            for (slot, (s, t)) in layout.scalars.entries().enumerate() {
                list.push((u.scalar(k, s), u.scalar(k, t), layout.scalars_at(k) + slot));
            }
            for s in 0..layout.interval_scalars {
                list.push((
                    u.horizon(),
                    u.scalar(k, s),
                    layout.horizon_scalars_at(k) + s,
                ));
            }
        }
        list.push((
            u.horizon(),
            u.horizon(),
            layout.horizon_square_at(self.intervals),
        ));
        go_on()?;
        let mut entries = Entries::default();
        for (row, col, place) in list {
            let (Some(row), Some(col)) = (row, col) else {
                continue;
            };
            entries.rows.push(row.max(col) as u32);
            entries.cols.push(row.min(col) as u32);
            let scale = self.variable_scales[row] * self.variable_scales[col];
            self.hessian.push(Gather { place, scale });
        }
        // Voltages that meet those of the interval before, with the energies that couple them.
        let coupling = self.voltages.iter().filter_map(|&(s, _)| {
            let mut rows = self.energies.iter();
            let energy = rows.position(|row| row.scalar == s && row.couples_intervals());
            let is_any = self.cost.couples_intervals() || energy.is_some();
            is_any.then_some((s, energy))
        });
        let coupling: Vec<_> = coupling.collect();
        for k in 1..self.intervals {
            for &(s, energy) in &coupling {
                if let (Some(row), Some(col)) = (u.scalar(k, s), u.scalar(k - 1, s)) {
                    entries.rows.push(row as u32);
                    entries.cols.push(col as u32);
                    self.jumps.push(Jump { k, energy });
                }
            }
        }
        self.hessian_entries = entries;
        go_on()
    }
}

/// Returns an error if it is time to stop.
fn go_on() -> Result<(), BoundaryError> {
    match interrupt::stop() {
        Some(status) => Err(BoundaryError::Stopped(status)),
        None => Ok(()),
    }
}
