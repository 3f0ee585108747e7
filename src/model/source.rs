//! Sources: the parts that inputs drive, each with the physical kind and unit of its input.

/// Part that an input drives, and the name of the input.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Name in files.
    pub name: String,
    /// Physical kind of the input.
    pub kind: InputKind,
    /// True if it is a voltage that has an effect: a muscle without electric constants takes none.
    pub takes_voltage: bool,
}

/// Physical kind of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// Voltage of a muscle or a driven electrode, in V.
    Voltage,
    /// Force of a load, in N.
    Force,
    /// Torque of a load, in N mm.
    Torque,
}

impl InputKind {
    /// Unit inside.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Voltage => "V",
            Self::Force => "N",
            Self::Torque => "N mm",
        }
    }

    /// SI unit, and its size in the unit inside.
    pub const fn si(self) -> (&'static str, f64) {
        match self {
            Self::Voltage => ("V", 1.0),
            Self::Force => ("N", 1.0),
            Self::Torque => ("N m", 1e3),
        }
    }

    /// Unit in which objectives and charts count it, and its size in the unit inside.
    pub const fn counted(self) -> (&'static str, f64) {
        match self {
            Self::Voltage => ("kV", 1e3),
            Self::Force => ("N", 1.0),
            Self::Torque => ("N m", 1e3),
        }
    }
}

impl Source {
    /// Returns true if it is a load.
    pub fn is_load(&self) -> bool {
        self.kind != InputKind::Voltage
    }

    /// Returns true if its input has an effect.
    pub fn acts(&self) -> bool {
        self.takes_voltage || self.is_load()
    }
}

/// Sources of voltages: those that stand before the loads.
pub fn voltage_sources(sources: &[Source]) -> &[Source] {
    let loads = sources.iter().filter(|source| source.is_load()).count();
    &sources[..sources.len() - loads]
}
