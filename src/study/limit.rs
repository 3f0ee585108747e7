//! Limit of a sequence under refinement: observed order and Richardson's extrapolation.
//!
//! Errors C hᵖ of three successive values at h₁ > h₂ > h₃ leave
//!
//! ```text
//! |x₁ − x₂| / |x₂ − x₃| = (h₁ᵖ − h₂ᵖ) / (h₂ᵖ − h₃ᵖ),     x = x₃ + (x₃ − x₂) h₃ᵖ / (h₂ᵖ − h₃ᵖ),
//! ```
//!
//! the first of which gives p, whether or not the ratio of the steps is the same. Values that turn back show no order.

/// Orders that are believed.
const SENSIBLE: [f64; 2] = [0.5, 8.0];
/// Least part of the last difference by which the finest value is taken to be off where no order is observed: that of first order and halved sizes.
const LEAST: f64 = 1.0;
/// Differences below this part of the values are rounding.
const ROUNDING: f64 = 1e-12;
/// Local slopes of a curve that differ by more from the slope of the rest do not belong to its straight part.
const STRAIGHT: f64 = 0.4;
/// A curve that falls more slowly shows no order.
const FLAT: f64 = 0.2;

/// Method by which a limit was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum How {
    /// Extrapolated from the last three values.
    Extrapolated,
    /// The finest value, as the last differences are rounding.
    Rounding,
    /// The finest value, as no sensible order was observed.
    NoOrder,
    /// The finest value, as there are fewer than three.
    TooFew,
}

impl How {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Extrapolated => "extrapolated from the three finest values",
            Self::Rounding => "the finest value: the last ones differ by round-off only",
            Self::NoOrder => {
                "the finest value: no order between 0.5 and 8 is observed, so nothing can be extrapolated, and its error is estimated from the last differences by the order 0.5"
            }
            Self::TooFew => {
                "the finest value: there are fewer than three, and its error is estimated from the last difference by the order 0.5"
            }
        }
    }
}

/// The limit of a sequence of values.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceLimit {
    /// The limit.
    pub value: Vec<f64>,
    /// Method by which it was found.
    pub how: How,
    /// The order observed in each three successive values; none where it is not sensible.
    pub orders: Vec<Option<f64>>,
    /// Change of the limit by the last value, where it could be extrapolated before; otherwise the distance of the finest value from it. Where there is no
    /// order, an estimate: the larger one of the last two differences, as errors of the least order that is believed have it. None of a single value.
    pub uncertainty: Option<f64>,
    /// Differences that are no larger are rounding.
    pub rounding: f64,
}

impl SequenceLimit {
    /// Errors that are no larger say nothing about the values, as the limit itself is no better.
    pub fn floor(&self) -> f64 {
        let is_confirmed = matches!(self.orders.as_slice(), [.., Some(_), Some(_)]);
        match (self.how, is_confirmed) {
            // The last error is how far the limit was extrapolated, by construction.
            (How::Extrapolated, false) => self.rounding,
            _ => self.uncertainty.unwrap_or(f64::INFINITY).max(self.rounding),
        }
    }
}

/// Greatest distance of two lists of points with `width` coordinates each.
pub fn distance(a: &[f64], b: &[f64], width: usize) -> f64 {
    let pairs = a.chunks(width).zip(b.chunks(width));
    let apart = |(a, b): (&[f64], &[f64])| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    pairs.map(apart).fold(0.0, f64::max)
}

/// The limit of values at falling sizes, coarsest first; none of no value.
pub fn limit(sizes: &[f64], values: &[Vec<f64>], width: usize) -> Option<SequenceLimit> {
    let finest = values.last()?;
    let largest = finest.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let rounding = ROUNDING * largest;
    let each: Vec<_> = sizes.windows(3).zip(values.windows(3)).collect();
    let orders: Vec<_> = each
        .iter()
        .map(|(h, x)| {
            let apart = [(0, 1), (1, 2)].map(|(i, j)| distance(&x[i], &x[j], width));
            order([h[0], h[1], h[2]], apart, rounding).filter(|_| is_one_way(&x[0], &x[1], &x[2]))
        })
        .collect();
    let extrapolated = |k: usize| {
        let (h, x) = each[k];
        let factor = orders[k].map(|p| h[2].powf(p) / (h[1].powf(p) - h[2].powf(p)))?;
        let pairs = x[2].iter().zip(&x[1]);
        Some(
            pairs
                .map(|(a, b)| a + (a - b) * factor)
                .collect::<Vec<f64>>(),
        )
    };
    let before = values.len().checked_sub(2);
    let apart = before.map(|k| distance(&values[k], finest, width));
    let last = each.len().checked_sub(1);
    let (how, value, uncertainty) = match last.map(|last| (last, extrapolated(last))) {
        Some((last, Some(value))) => {
            let before = last.checked_sub(1).and_then(extrapolated);
            let apart = distance(&value, before.as_ref().unwrap_or(finest), width);
            (How::Extrapolated, value, Some(apart))
        }
        Some(_) if apart.is_some_and(|apart| apart <= rounding) => {
            (How::Rounding, finest.clone(), apart)
        }
        found => {
            let how = found.map_or(How::TooFew, |_| How::NoOrder);
            let estimated = apart.map(|_| estimated(sizes, values, width));
            (how, finest.clone(), estimated)
        }
    };
    Some(SequenceLimit {
        value,
        how,
        orders,
        uncertainty,
        rounding,
    })
}

/// An estimate of the error of the finest of two values or more that show no order: errors C hᵖ are `h₂ᵖ/(h₁ᵖ − h₂ᵖ)` times the last difference, and the
/// less the order, the larger. The difference before counts where it is larger: values may come near to each other by chance.
fn estimated(sizes: &[f64], values: &[Vec<f64>], width: usize) -> f64 {
    let n = values.len();
    let [coarse, fine] = [sizes[n - 2], sizes[n - 1]].map(|size| size.powf(SENSIBLE[0]));
    let pairs = values[n.saturating_sub(3)..].windows(2);
    let differences = pairs.map(|pair| distance(&pair[0], &pair[1], width));
    let largest = differences.fold(0.0, f64::max);
    largest * (fine / (coarse - fine)).max(LEAST)
}

/// Returns true if values go on as they went before, as errors C hᵖ do.
fn is_one_way(a: &[f64], b: &[f64], c: &[f64]) -> bool {
    let steps = a.iter().zip(b).zip(c).map(|((a, b), c)| (b - a) * (c - b));
    steps.sum::<f64>() > 0.0
}

/// The order that two successive differences show; none where it is not sensible, or where they are rounding.
fn order(h: [f64; 3], [coarse, fine]: [f64; 2], rounding: f64) -> Option<f64> {
    if fine <= rounding || coarse <= rounding {
        return None;
    }
    let ratio = |p: f64| (h[0].powf(p) - h[1].powf(p)) / (h[1].powf(p) - h[2].powf(p));
    let (mut low, mut high) = (SENSIBLE[0], SENSIBLE[1]);
    let wanted = coarse / fine;
    // The ratio grows with the order.
    if !(ratio(low)..=ratio(high)).contains(&wanted) {
        return None;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match ratio(middle) < wanted {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(0.5 * (low + high))
}

/// The order that a curve of errors shows: its slope by least squares over its straight part, the fine end of it.
///
/// Points (size, error), coarsest first; errors that are not above `floor` are left out. None where the curve is flat or levels
/// off, or has fewer than two points.
pub fn observed_order(points: &[[f64; 2]], floor: f64) -> Option<f64> {
    let shown = points
        .iter()
        .filter(|p| p[1].is_finite() && p[1] > floor && p[1] > 0.0);
    let logs: Vec<[f64; 2]> = shown.map(|p| p.map(f64::ln)).collect();
    let mut part = logs.as_slice();
    while part.len() > 3 {
        let [a, b] = [part[0], part[1]];
        let local = (a[1] - b[1]) / (a[0] - b[0]);
        let rest = slope(&part[1..])?;
        if (local - rest).abs() <= STRAIGHT {
            break;
        }
        part = &part[1..];
    }
    // A curve that levels off at its fine end has met an error that is not refined.
    let last = slope(&part[part.len().saturating_sub(2)..])?;
    slope(part).filter(|p| *p > FLAT && (last - p).abs() <= STRAIGHT)
}

/// Slope of the line of least squares through points.
fn slope(points: &[[f64; 2]]) -> Option<f64> {
    if points.len() < 2 {
        return None;
    }
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let over: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let under: f64 = points.iter().map(|p| (p[0] - x).powi(2)).sum();
    Some(over / under)
}
