//! Interpolation between equidistant times: the cubic polynomial through the four nearest ones between two corners of the inputs.

use std::ops::Range;

/// Fewest points between two corners from which alone a value follows; across a corner where there are fewer.
const FEWEST: usize = 4;
/// Part of a step by which a time may miss a corner.
const OFF: f64 = 1e-6;

/// Points between the corners around a time, a corner counting to what follows; without those at the corners where values jump.
pub(super) fn piece(
    time: f64,
    corners: &[f64],
    ([first, h], points): ([f64; 2], usize),
    jumps: bool,
) -> Range<usize> {
    let begin = corners.iter().copied().filter(|c| *c <= time + OFF * h);
    let end = corners.iter().copied().filter(|c| *c > time + OFF * h);
    let margin = if jumps { OFF } else { -OFF };
    let place = |corner: f64| (corner - first) / h;
    let last = (points - 1) as f64;
    let begin = begin.fold(0.0, |begin: f64, c| begin.max((place(c) + margin).ceil()));
    let end = end.fold(last, |end: f64, c| end.min((place(c) - margin).floor()));
    let piece = begin as usize..(end + 1.0).max(0.0) as usize;
    match piece.len() < FEWEST {
        true => 0..points,
        false => piece,
    }
}

/// First of the points of a piece that a value at a time follows from, their number, and the time after it in steps.
fn local(time: f64, [first, h]: [f64; 2], points: Range<usize>) -> (usize, usize, f64) {
    let count = points.len().min(4);
    let place = (time - first) / h;
    let last = (points.end - count) as f64;
    let begin = (place.floor() - 1.0).clamp(points.start as f64, last) as usize;
    (begin, count, place - begin as f64)
}

/// First of the points of a piece that a value at a time follows from, and their weights; the error is of fourth order in `h`.
pub(super) fn weights(time: f64, grid: [f64; 2], points: Range<usize>) -> (usize, Vec<f64>) {
    let (begin, count, s) = local(time, grid, points);
    let weight = |j: usize| {
        let others = (0..count).filter(|&i| i != j);
        let factor = |i: usize| (s - i as f64) / (j as f64 - i as f64);
        others.map(factor).product()
    };
    (begin, (0..count).map(weight).collect())
}
