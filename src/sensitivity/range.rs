//! Changes of what is held up to which the same bounds are reached, to first order.
//!
//! A bound that is not reached is at the distance s, a multiplier of one that is has the size s. Either becomes zero at the change −s/ṡ, where ṡ is
//! its derivative.

/// The change at which other bounds are reached, in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// The change; infinite where there is none.
    pub change: f64,
    /// The bound that is reached or left there.
    pub bound: Option<String>,
}

/// Changes between which the same bounds are reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Downwards: a change that is not positive.
    pub down: End,
    /// Upwards.
    pub up: End,
}

/// A derivative this small relative to the greatest is rounding.
const ROUNDING: f64 = 1e-9;

/// Multiple of a value beyond which none is asked whether it has a meaning.
const FAR: f64 = 100.0;

/// A distance with its derivative, and a number by which its words are found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin<M> {
    pub(super) distance: f64,
    pub(super) rate: f64,
    pub(super) of: M,
}

impl Range {
    /// The range of these margins.
    pub(super) fn new<M: Copy>(margins: &[Margin<M>], words: impl Fn(M) -> String) -> Self {
        let least = least_rate(margins);
        let end = |sign: f64| {
            let falling = margins.iter().filter(|one| sign * one.rate < -least);
            let change = |one: &Margin<M>| one.distance.max(0.0) / one.rate.abs();
            let first = falling.min_by(|a, b| change(a).total_cmp(&change(b)));
            End {
                change: sign * first.map_or(f64::INFINITY, change),
                bound: first.map(|one| words(one.of)),
            }
        };
        Self {
            down: end(-1.0),
            up: end(1.0),
        }
    }

    /// The part of the range around `value` within which values have a meaning.
    #[must_use]
    pub(super) fn while_true(mut self, value: f64, has_meaning: impl Fn(f64) -> bool) -> Self {
        for end in [&mut self.down, &mut self.up] {
            let far = FAR * value.abs().max(f64::MIN_POSITIVE);
            let (mut good, mut bad) = (0.0, end.change.clamp(-far, far));
            if has_meaning(value + bad) {
                continue;
            }
            while (bad - good).abs() > f64::EPSILON * value.abs() {
                let middle = 0.5 * (good + bad);
                match has_meaning(value + middle) {
                    true => good = middle,
                    false => bad = middle,
                }
            }
            *end = End {
                change: bad,
                bound: Some("it loses its meaning".to_owned()),
            };
        }
        self
    }

    /// Margins that a change ends at once, to either side.
    pub(super) fn ends_at_once<M: Copy>(
        margins: &[Margin<M>],
        distance: f64,
    ) -> impl Iterator<Item = M> {
        let least = least_rate(margins);
        let is_at_once = move |one: &&Margin<M>| one.distance < distance && one.rate.abs() > least;
        margins.iter().filter(is_at_once).map(|one| one.of)
    }
}

/// The derivative up to which all are rounding.
fn least_rate<M>(margins: &[Margin<M>]) -> f64 {
    let rates = margins.iter().map(|one| one.rate.abs());
    ROUNDING * rates.fold(0.0, f64::max)
}
