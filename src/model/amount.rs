//! Volume and mass of muscles at rest, and their units.

use crate::model::system::{Muscle, System};

/// Volume or mass of muscles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Amount {
    /// Volume in mm³.
    Volume,
    /// Mass in g; muscles without a density have none.
    Mass,
}

impl Amount {
    /// Words for messages.
    pub fn words(self, muscles: &[usize], system: &System) -> String {
        let what = match self {
            Self::Volume => "volume",
            Self::Mass => "mass",
        };
        match muscles {
            [one] => format!("{what} of {}", system.muscles[*one].name),
            several => format!("{what} of {} muscles", several.len()),
        }
    }

    /// Unit for messages, and its size in mm³ or g.
    pub const fn unit(self) -> (&'static str, f64) {
        match self {
            Self::Volume => ("cm^3", 1e3),
            Self::Mass => ("g", 1.0),
        }
    }

    /// Value of given muscles, in mm³ or g.
    pub fn of(self, muscles: &[usize], system: &System) -> f64 {
        let one = |muscle: &Muscle| match self {
            Self::Volume => muscle.volume(),
            Self::Mass => muscle.mass().unwrap_or(0.0),
        };
        muscles.iter().map(|&m| one(&system.muscles[m])).sum()
    }
}
