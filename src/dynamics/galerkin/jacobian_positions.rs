//! Positions of the derivatives of the equations of a step with several points.

use crate::dynamics::tangent::EntryList;
use crate::model::Model;

/// Segments of the values: one of instants for each point, one for each pair of rows and points, those of each sample.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// Point of the rows that go with each point ν = 1 … s.
    rows: Vec<usize>,
    same: usize,
    cross: usize,
    mixed: usize,
    scalars: usize,
    samples: usize,
    /// Length of the values.
    pub(super) values: usize,
}

impl Places {
    /// Lays the segments down, and the entries of the matrix that take them.
    pub(super) fn new(model: &Model, rows: &[usize], samples: usize) -> (Self, EntryList) {
        let layout = model.action.layout();
        let map = &model.action.map;
        let has_scalars = !model.variables.algebraic().is_empty();
        let [same, cross] = [&layout.same, &layout.cross].map(|p| p.entries().len());
        let [mixed, scalars] = match has_scalars {
            true => [&layout.mixed, &layout.scalars].map(|p| p.entries().len()),
            false => [0, 0],
        };
        let degree = rows.len();
        let mut places = Self {
            rows: rows.to_vec(),
            same,
            cross,
            mixed,
            scalars,
            samples,
            values: 0,
        };
        places.values = places.scalars(samples);
        let (n, m) = (map.coordinates, map.unknowns());
        let mut entries = EntryList::default();
        let block = |point: usize| (point - 1) * m;
        for row in 1..=degree {
            for point in 1..=degree {
                let pattern = match rows[row - 1] == point {
                    true => &layout.same,
                    false => &layout.cross,
                };
                let at = places.pair(row, point);
                for (slot, (i, j)) in pattern.entries().enumerate() {
                    if i < n && j < n {
                        entries.add(at + slot, (block(row) + i, block(point) + j));
                    }
                }
            }
            let (of_rows, of_point) = (places.same(rows[row - 1]), places.same(row));
            for (slot, (i, j)) in layout.same.entries().enumerate() {
                // Multipliers act where the rows are, constraints hold at the point.
                if i < n && j >= n {
                    entries.add(of_rows + slot, (block(row) + i, block(row) + j));
                }
                if i >= n && j < n {
                    entries.add(of_point + slot, (block(row) + i, block(row) + j));
                }
            }
        }
        if has_scalars {
            places.add_scalars(model, samples, &mut entries);
        }
        (places, entries)
    }

    /// Scalars with an equation of each sample against the points, and against each other.
    fn add_scalars(&self, model: &Model, samples: usize, entries: &mut EntryList) {
        let layout = model.action.layout();
        let m = model.action.map.unknowns();
        for sample in 0..samples {
            let place = |s: usize| model.variables.place_of(self.rows.len(), sample, s);
            for point in 1..=self.rows.len() {
                let [rows, columns] = self.mixed(sample, point);
                let block = (point - 1) * m;
                for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                    if let Some(s) = place(s) {
                        entries.add(rows + slot, (block + i, s));
                        entries.add(columns + slot, (s, block + i));
                    }
                }
            }
            for (slot, (s, t)) in layout.scalars.entries().enumerate() {
                if let (Some(s), Some(t)) = (place(s), place(t)) {
                    let at = self.scalars(sample) + slot;
                    entries.add(at, (s, t));
                    if s != t {
                        entries.add(at, (t, s));
                    }
                }
            }
        }
    }

    /// Second derivatives at a point.
    pub(super) fn same(&self, point: usize) -> usize {
        point * self.same
    }

    /// Rows that go with one point by the coordinates of another; those of the point itself where the rows are its own.
    pub(super) fn pair(&self, row: usize, point: usize) -> usize {
        if self.rows[row - 1] == point {
            return self.same(point);
        }
        let degree = self.rows.len();
        self.same(degree + 1) + ((row - 1) * degree + point - 1) * self.cross
    }

    /// Rows that go with a point by the scalars of a sample, and rows of these by the coordinates of the point.
    pub(super) fn mixed(&self, sample: usize, point: usize) -> [usize; 2] {
        let degree = self.rows.len();
        let first = self.same(degree + 1) + degree * degree * self.cross;
        let at = first + (sample * degree + point - 1) * 2 * self.mixed;
        [at, at + self.mixed]
    }

    /// Scalars of a sample against each other.
    pub(super) fn scalars(&self, sample: usize) -> usize {
        self.mixed(self.samples, 1)[0] + sample * self.scalars
    }
}
