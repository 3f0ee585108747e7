//! A picture of a sparse matrix: the positions of its entries.

use crate::nlp::Entries;
use crate::report::canvas::{self, Align, Stroke};
use crate::report::origin::Origin;
use crate::report::style;

/// Longer side of the picture in pt.
const SIDE: f64 = 420.0;
/// Margin in pt; the title stands in the upper one.
const MARGIN: f64 = 26.0;
/// Cells along the longer side at most: more entries than that share cells.
const CELLS: usize = 420;

/// Name and size of a matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct MatrixSize<'a> {
    pub(super) name: &'a str,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// An SVG of the entries of a matrix, rows downwards.
pub(super) fn svg(shape: MatrixSize<'_>, entries: &Entries, origin: &Origin) -> String {
    let MatrixSize {
        name,
        rows,
        columns,
    } = shape;
    let longest = rows.max(columns).max(1);
    // A cell holds `share` rows and columns.
    let share = longest.div_ceil(CELLS);
    let cell = SIDE / longest.div_ceil(share) as f64;
    let size = [columns, rows].map(|count| count.div_ceil(share) as f64 * cell);
    let mut cells: Vec<(usize, usize)> = entries
        .rows
        .iter()
        .zip(&entries.cols)
        .map(|(&row, &col)| (row as usize / share, col as usize / share))
        .collect();
    cells.sort_unstable();
    cells.dedup();
    let sheet = size.map(|side| side + 2.0 * MARGIN);
    canvas::svg(sheet, origin, |canvas| {
        let corner = |row: f64, col: f64| [MARGIN + col * cell, MARGIN + row * cell];
        for (row, col) in cells {
            let (row, col) = (row as f64, col as f64);
            let square = [
                corner(row, col),
                corner(row, col + 1.0),
                corner(row + 1.0, col + 1.0),
                corner(row + 1.0, col),
            ];
            canvas.fill(&square, style::hue(0), 1.0);
        }
        let [width, height] = size;
        let frame = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let frame = frame.map(|p| p.map(|x| x + MARGIN));
        canvas.outline(&frame, Stroke::solid(style::INK, 0.8));
        let title = format!("{name}: {rows} × {columns}, {} entries", entries.rows.len());
        let place = [MARGIN, 0.5 * MARGIN];
        canvas.text(place, &title, style::TICK_SIZE, style::INK, Align::Left);
    })
}
