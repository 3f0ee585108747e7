//! Functions of time: voltages, and references of quantities.

use std::f64::consts::TAU;

/// A voltage in V, a length in mm or an angle in rad as a function of the time in ms.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    /// The same all the time.
    Constant(f64),
    /// Linear between two values, constant before and after.
    Ramp {
        /// Value up to the start.
        from: f64,
        /// Value from the end on.
        to: f64,
        /// Time at which it begins in ms.
        start: f64,
        /// Time that it takes in ms; a step where it is zero.
        duration: f64,
    },
    /// `mean + amplitude sin(2π f t + phase)`.
    Sine {
        /// Mean.
        mean: f64,
        /// Amplitude.
        amplitude: f64,
        /// Frequency f in 1/ms.
        frequency: f64,
        /// Phase in rad.
        phase: f64,
    },
    /// Linear between values at times, constant before and after.
    Table {
        /// Times in ms, growing, one or more.
        times: Vec<f64>,
        /// A value at each.
        values: Vec<f64>,
    },
    /// Constant in intervals.
    Steps {
        /// End of each interval in ms, growing.
        ends: Vec<f64>,
        /// Values, one more than ends: the last one is that afterwards.
        values: Vec<f64>,
    },
}

impl Signal {
    /// A ramp from the beginning.
    pub fn ramp(from: f64, to: f64, duration: f64) -> Self {
        Self::Ramp {
            from,
            to,
            start: 0.0,
            duration,
        }
    }

    /// Time in ms after which a table says nothing more.
    pub fn last_known(&self) -> Option<f64> {
        match self {
            Self::Table { times, .. } if times.len() > 1 => times.last().copied(),
            _ => None,
        }
    }

    /// The same function times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut out = self.clone();
        out.heights().into_iter().for_each(|x| *x *= factor);
        out
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        self.derivatives(time)[0]
    }

    /// Value, rate per ms and second derivative at a time; at a corner those of the time after it.
    pub fn derivatives(&self, time: f64) -> [f64; 3] {
        let [value, rate] = match self {
            Self::Constant(value) => [*value, 0.0],
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => match time - start {
                late if late >= *duration => [*to, 0.0],
                early if early < 0.0 => [*from, 0.0],
                part => [from + (to - from) * part / duration, (to - from) / duration],
            },
            Self::Sine {
                mean,
                amplitude,
                frequency,
                phase,
            } => {
                let turns = TAU * frequency;
                let angle = turns * time + phase;
                let (sin, cos) = (angle.sin(), angle.cos());
                let rate = amplitude * turns * cos;
                return [
                    mean + amplitude * sin,
                    rate,
                    -amplitude * turns * turns * sin,
                ];
            }
            Self::Steps { ends, values } => [values[ends.partition_point(|&end| end <= time)], 0.0],
            Self::Table { times, values } => {
                let next = times.partition_point(|&t| t <= time);
                match (next.checked_sub(1), times.get(next)) {
                    (None, _) => [values[0], 0.0],
                    (Some(last), None) => [values[last], 0.0],
                    (Some(before), Some(&end)) => {
                        let (change, length) = (values[next] - values[before], end - times[before]);
                        let part = (time - times[before]) / length;
                        [values[before] + change * part, change / length]
                    }
                }
            }
        };
        [value, rate, 0.0]
    }

    /// Returns true if it is written as one value for all the time.
    pub fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_))
    }

    /// Returns true if it is zero all the time.
    pub fn is_zero(&self) -> bool {
        self.clone().heights().iter().all(|x| **x == 0.0)
    }

    /// The values of which the function is made, in which it is linear.
    fn heights(&mut self) -> Vec<&mut f64> {
        match self {
            Self::Constant(value) => vec![value],
            Self::Ramp { from, to, .. } => vec![from, to],
            Self::Sine {
                mean, amplitude, ..
            } => vec![mean, amplitude],
            Self::Table { values, .. } | Self::Steps { values, .. } => values.iter_mut().collect(),
        }
    }

    /// Returns true if all its numbers are finite, its times grow, and it has a value.
    pub fn is_sound(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_finite(),
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => [from, to, start, duration].iter().all(|v| v.is_finite()) && *duration >= 0.0,
            Self::Sine {
                mean,
                amplitude,
                frequency,
                phase,
            } => [mean, amplitude, frequency, phase]
                .iter()
                .all(|v| v.is_finite()),
            Self::Table { times, values }
            | Self::Steps {
                ends: times,
                values,
            } => {
                let all = || times.iter().chain(values);
                let grows = times.windows(2).all(|pair| pair[0] < pair[1]);
                let afterwards = usize::from(matches!(self, Self::Steps { .. }));
                !times.is_empty()
                    && times.len() + afterwards == values.len()
                    && grows
                    && all().all(|v| v.is_finite())
            }
        }
    }

    /// Time in ms at which it jumps.
    pub fn jump(&self) -> Option<f64> {
        match self {
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => (*duration == 0.0 && from != to).then_some(*start),
            _ => None,
        }
    }

    /// The value, where it is the same from one time in ms to another.
    pub fn constant_within(&self, [from, to]: [f64; 2]) -> Option<f64> {
        if let Self::Sine {
            mean, amplitude, ..
        } = self
        {
            return (*amplitude == 0.0).then_some(*mean);
        }
        let value = self.at(from);
        let corners = self.corners();
        let mut times = corners.iter().filter(|t| (from..to).contains(*t));
        let is_constant = self.at(to) == value && times.all(|t| self.at(*t) == value);
        is_constant.then_some(value)
    }

    /// Times in ms at which it is not smooth.
    pub fn corners(&self) -> Vec<f64> {
        match self {
            Self::Constant(_) | Self::Sine { .. } => Vec::new(),
            Self::Ramp {
                start, duration, ..
            } => vec![*start, start + duration],
            Self::Table { times, .. } | Self::Steps { ends: times, .. } => times.clone(),
        }
    }
}

/// Times in order, each once.
pub fn in_order(times: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

impl From<f64> for Signal {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

/// A generator that begins with a seed: `splitmix64` of S. Vigna (public domain).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Equal seeds give equal numbers.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number of the interval [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        let unit = (z >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// A number of the normal distribution of mean 0 and deviation 1, by the method of Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let [a, b] = [self.between(0.0, 1.0), self.between(0.0, 1.0)];
        (-2.0 * (1.0 - a).ln()).sqrt() * (TAU * b).cos()
    }
}
