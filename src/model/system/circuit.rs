//! Circuits between sources and the electrodes that they charge.

/// A resistor in series with the electrodes of a muscle or a block, a leak parallel to them, or both.
///
/// Behind a resistor R the charge Q of the muscle obeys `V = R (Q̇ + U/R_L) + U` with the voltage U = Q/C of the electrodes and the leak
/// R_L. Without a resistor the electrodes have the voltage V of the source, and the leak takes the current V/R_L.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Circuit {
    /// Resistance R in series in V ms/mC, which is Ω.
    pub resistance: Option<f64>,
    /// Resistance R_L parallel to the electrodes in Ω.
    pub leakage: Option<f64>,
}

impl Circuit {
    /// Part R_L/(R + R_L) of the voltage of the source that a leak behind a resistor leaves to the electrodes at rest; none where it is all.
    pub fn division(&self) -> Option<f64> {
        let (series, leak) = self.resistance.zip(self.leakage)?;
        Some(leak / (series + leak))
    }

    /// Resistance in Ω of the source that stands for source, resistor and leak (Thévenin): R without a leak, R R_L/(R + R_L) with
    /// one; none without a resistor.
    pub fn inner_resistance(&self) -> Option<f64> {
        let series = self.resistance?;
        Some(self.division().map_or(series, |part| part * series))
    }

    /// Conductance 1/(R + R_L) in 1/Ω of the way through the leak; none without a leak.
    pub fn leak_conductance(&self) -> Option<f64> {
        let leak = self.leakage?;
        Some(1.0 / (self.resistance.map_or(leak, |series| series + leak)))
    }

    /// Charge in mC that the source supplies, and heat in mJ of resistor and leak, in a time in ms in which the muscle takes a charge in mC
    /// under a voltage in V of the source.
    pub fn exchange(&self, charge: f64, voltage: f64, time: f64) -> (f64, [f64; 2]) {
        let through_leak = self.leak_conductance().map_or(0.0, |g| g * voltage * time);
        let supplied = self.division().map_or(charge, |part| part * charge) + through_leak;
        let heat = |resistance: Option<f64>, charge: f64| {
            resistance.map_or(0.0, |resistance| resistance * charge * charge / time)
        };
        let leaked = supplied - charge;
        let heats = [heat(self.resistance, supplied), heat(self.leakage, leaked)];
        (supplied, heats)
    }
}

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
