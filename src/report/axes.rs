//! One axis of a plot: its range, its ticks, and the positions of values.

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences, equal distances.
    Linear,
    /// Equal ratios, equal distances; values that are not positive are not drawn.
    Log,
}

/// Extent of an axis beyond its data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// First value to last value, as for time.
    Tight,
    /// A little further on both sides.
    Padded,
    /// A little below zero to a little beyond the largest, for values that are never negative.
    FromZero,
}

/// Label, scale and extent of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit, such as `time [s]`.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Extent beyond the data.
    pub extent: Extent,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, extent: Extent) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Linear,
            extent,
        }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Log,
            extent: Extent::Padded,
        }
    }

    /// Position of a value on the axis before it is laid on paper: x or log₁₀ x; NaN where there is none.
    pub fn position(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log if value > 0.0 => value.log10(),
            Scale::Log => f64::NAN,
        }
    }

    /// Range of positions that holds all finite values.
    pub fn range(&self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let positions = values.map(|v| self.position(v)).filter(|p| p.is_finite());
        let [low, high] = positions.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], p| {
            [a.min(p), b.max(p)]
        });
        if low > high {
            return [0.0, 1.0];
        }
        // A constant still gets an axis around it.
        let least = match self.scale {
            Scale::Linear => 1e-9_f64.max(1e-3 * low.abs().max(high.abs())),
            Scale::Log => 0.5,
        };
        let pad = 0.05 * (high - low).max(least);
        match self.extent {
            Extent::Tight if high > low => [low, high],
            Extent::FromZero if low >= 0.0 => {
                let high = if high > 0.0 { high } else { 1.0 };
                [-0.03 * high, 1.06 * high]
            }
            _ => [low - pad, high + pad],
        }
    }

    /// Labelled ticks within a range of positions, about `count` of them, and unlabelled ones between.
    pub fn ticks(&self, range: [f64; 2], count: f64) -> Ticks {
        match self.scale {
            Scale::Linear => linear_ticks(range, count),
            Scale::Log => log_ticks(range, count),
        }
    }
}

/// Ticks of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// Position and label.
    pub major: Vec<(f64, String)>,
    /// Positions between.
    pub minor: Vec<f64>,
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear_ticks([low, high]: [f64; 2], count: f64) -> Ticks {
    let step = nice_step((high - low) / count);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    let largest = low.abs().max(high.abs());
    let label = |i: i64| {
        let value = i as f64 * step;
        if i == 0 {
            "0".to_owned()
        } else if !(1e-3..1e5).contains(&largest) {
            scientific(value)
        } else {
            format!("{value:.decimals$}").replace('-', "−")
        }
    };
    Ticks {
        major: (first..=last)
            .map(|i| (i as f64 * step, label(i)))
            .collect(),
        minor: vec![],
    }
}

/// The powers of ten; between few of them also their multiples by 2 and 5.
fn log_ticks([low, high]: [f64; 2], count: f64) -> Ticks {
    let mut ticks = Ticks::default();
    let decades = high - low;
    let stride = (decades / count).ceil().max(1.0) as i64;
    for power in low.floor() as i64..=high.ceil() as i64 {
        for digit in 1..10 {
            let position = power as f64 + f64::from(digit).log10();
            if !(low - 1e-9..=high + 1e-9).contains(&position) {
                continue;
            }
            let labelled = match digit {
                1 => power.rem_euclid(stride) == 0,
                2 | 5 => decades < 1.5,
                _ => false,
            };
            if labelled {
                let factor = if digit == 1 {
                    ""
                } else {
                    &format!("{digit}·")
                };
                let label = format!("{factor}10{}", superscript(power));
                ticks.major.push((position, label));
            } else if stride == 1 || digit == 1 {
                ticks.minor.push(position);
            }
        }
    }
    ticks
}

/// The least of 1, 2, 5 times a power of ten that is not below `rough`.
fn nice_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|m| m * power >= rough * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// A number as mantissa and power of ten.
fn scientific(value: f64) -> String {
    let text = format!("{value:.1e}").replace('-', "−");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let power = power.replace('−', "-").parse().unwrap_or(0);
    let mantissa = mantissa.trim_end_matches(".0");
    format!("{mantissa}·10{}", superscript(power))
}

fn superscript(power: i64) -> String {
    let digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
    let raise = |c: char| match c {
        '-' => '⁻',
        _ => digits.chars().nth(c as usize - '0' as usize).unwrap_or(c),
    };
    power.to_string().chars().map(raise).collect()
}
