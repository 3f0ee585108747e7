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
    /// Voltage of a muscle or a driven electrode.
    Voltage,
    /// Force.
    Force,
    /// Torque.
    Torque,
    /// Traction or pressure: a force for an area.
    Traction,
    /// Body force: a force for a volume.
    BodyForce,
    /// Surface charge: a charge for an area.
    SurfaceCharge,
    /// Charge of a muscle.
    Charge,
}

/// A unit, and its size in the unit inside.
type CountedUnit = (&'static str, f64);

impl InputKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Voltage,
        Self::Force,
        Self::Torque,
        Self::Traction,
        Self::BodyForce,
        Self::SurfaceCharge,
        Self::Charge,
    ];

    /// Name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Voltage => "voltage",
            Self::Force => "force",
            Self::Torque => "torque",
            Self::Traction => "traction",
            Self::BodyForce => "body force",
            Self::SurfaceCharge => "surface charge",
            Self::Charge => "charge",
        }
    }

    /// Unit inside, SI unit, and the unit in which objectives and charts count it.
    const fn units(self) -> (&'static str, [CountedUnit; 2]) {
        match self {
            Self::Voltage => ("V", [("V", 1.0), ("kV", 1e3)]),
            Self::Force => ("N", [("N", 1.0), ("N", 1.0)]),
            Self::Torque => ("N mm", [("N m", 1e3), ("N m", 1e3)]),
            Self::Traction => ("MPa", [("Pa", 1e-6), ("kPa", 1e-3)]),
            Self::BodyForce => ("N/mm^3", [("N/m^3", 1e-9), ("kN/m^3", 1e-6)]),
            Self::SurfaceCharge => ("mC/mm^2", [("C/m^2", 1e-3), ("mC/m^2", 1e-6)]),
            Self::Charge => ("mC", [("C", 1e3), ("uC", 1e-3)]),
        }
    }

    /// Unit inside.
    pub const fn unit(self) -> &'static str {
        self.units().0
    }

    /// SI unit, and its size in the unit inside.
    pub const fn si(self) -> CountedUnit {
        self.units().1[0]
    }

    /// Unit in which objectives and charts count it, and its size in the unit inside.
    pub const fn counted(self) -> CountedUnit {
        self.units().1[1]
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
