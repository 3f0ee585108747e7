//! Interpolation between equidistant times: the cubic polynomial through the four nearest ones.

/// First of the points that a value at a time follows from, and their weights; the error is of fourth order in `h`.
pub(super) fn weights(time: f64, [first, h]: [f64; 2], points: usize) -> (usize, Vec<f64>) {
    let count = points.min(4);
    let place = (time - first) / h;
    let begin = (place.floor() - 1.0).clamp(0.0, (points - count) as f64) as usize;
    let s = place - begin as f64;
    let weight = |j: usize| {
        let others = (0..count).filter(|&i| i != j);
        let factor = |i: usize| (s - i as f64) / (j as f64 - i as f64);
        others.map(factor).product()
    };
    (begin, (0..count).map(weight).collect())
}
