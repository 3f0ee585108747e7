//! A regulator along an optimal motion: the costs of deviations, of which its gains are the least; and the noise of what it measures.

use crate::feedback::{Law, Reading};

/// Costs of deviations from a motion. Each is the factor of a sum of squares: of deviations in degrees or mm, of rates in 100 degrees/s or
/// 100 mm/s, of inputs as parts of their ranges, and of integrals over 0.1 s of the first.
#[derive(Clone, Debug, PartialEq)]
pub struct Regulator {
    /// Of coordinates.
    pub coordinates: f64,
    /// Of their rates.
    pub rates: f64,
    /// Of the places of markers, by marker.
    pub markers: Vec<(usize, f64)>,
    /// Of inputs; positive.
    pub inputs: f64,
    /// Of the integrals of deviations of joint coordinates; zero: none are formed.
    pub integral: f64,
    /// Greatest length in ms of the steps that are linearised.
    pub step: f64,
    /// Time in ms from a measurement to its effect, which is predicted; whole intervals count, upwards.
    pub delay: f64,
    /// Factor of the costs at the end: of holding the goal for ever, or of the deviations there where it is not held.
    pub terminal: f64,
    /// Measurements in place of the state.
    pub observer: Option<Observation>,
}

/// Measurements from which an observer finds the state, with their standard deviations, and those of what disturbs the motion in each interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Joints whose coordinates are measured, in rad or mm.
    pub joints: Vec<(usize, f64)>,
    /// Markers whose places are measured, in mm.
    pub markers: Vec<(usize, f64)>,
    /// Of each input, or of its square, as a part of its range.
    pub inputs: f64,
    /// Of each rate, in 100 degrees/s or 100 mm/s.
    pub rates: f64,
    /// Of the change of a constant disturbance on each joint, as a part of the greatest force of the inputs on it; `None`: no force lasts.
    pub lasting: Option<f64>,
}

impl Observation {
    /// Disturbances of inputs and of rates where none are given.
    pub const USUAL: [f64; 2] = [0.05, 0.1];
}

impl Default for Regulator {
    fn default() -> Self {
        Self {
            coordinates: 1.0,
            rates: 0.0,
            markers: Vec::new(),
            inputs: 0.01,
            integral: 0.0,
            step: 1.0,
            delay: 0.0,
            terminal: 1.0,
            observer: None,
        }
    }
}

impl Regulator {
    /// Intervals of a length in ms that the delay takes.
    pub fn delayed(&self, h: f64) -> usize {
        (self.delay / h - 1e-9).ceil().max(0.0) as usize
    }

    /// Deviation of an angle that costs as much as one of a mm, in rad.
    pub const DEGREE: f64 = std::f64::consts::PI / 180.0;
    /// Time in ms in which a rate makes that deviation.
    pub const RATE_TIME: f64 = 10.0;
    /// Time in ms of an integral.
    pub const INTEGRAL_TIME: f64 = 100.0;
}

/// Standard deviations of the noise of measured quantities; zero: none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Of angles in rad.
    pub angle: f64,
    /// Of lengths in mm.
    pub length: f64,
    /// Of rates of angles in rad/ms.
    pub angular_velocity: f64,
    /// Of rates of lengths in mm/ms.
    pub velocity: f64,
    /// Seed of the numbers that are drawn.
    pub seed: u64,
}

impl Noise {
    /// The key of noise of a kind of which a law reads nothing; `None` where all is read.
    pub fn unread(&self, law: &Law) -> Option<&'static str> {
        let of_state = |place: usize| {
            let one = &law.measured[place];
            one.memory.is_none().then_some((one.is_rate, one.is_length))
        };
        let of_reading = |one: &Reading| match one {
            Reading::State(place) => of_state(*place),
            Reading::Marker(..) => Some((false, true)),
        };
        let kinds: Vec<(bool, bool)> = match &law.observer {
            None => (0..law.measured.len()).filter_map(of_state).collect(),
            Some(observer) => observer.readings.iter().filter_map(of_reading).collect(),
        };
        let all = [
            ("angle", self.angle, (false, false)),
            ("length", self.length, (false, true)),
            ("angular_velocity", self.angular_velocity, (true, false)),
            ("velocity", self.velocity, (true, true)),
        ];
        let mut unread = all
            .into_iter()
            .filter(|(_, size, kind)| *size > 0.0 && !kinds.contains(kind));
        unread.next().map(|(key, ..)| key)
    }

    /// Words on noise that nothing reads: found, and expected.
    pub const UNREAD: [&str; 2] = [
        "noise of a kind that nothing measures",
        "noise of what the controller measures",
    ];
}
