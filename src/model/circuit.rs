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
    /// Its resistances in Ω.
    pub fn parts(&self) -> impl Iterator<Item = f64> {
        self.resistance.into_iter().chain(self.leakage)
    }

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
    pub fn exchange(&self, charge: f64, (voltage, time): (f64, f64)) -> (f64, [f64; 2]) {
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

/// Leak of finite elements that nothing would read, and what is expected, for messages.
const LONE_LEAK: [&str; 2] = [
    "a leak without a resistor, which takes current from the source alone",
    "\"resistance\" beside the \"leakage\" of finite elements, or no circuit",
];

/// Circuit without parts, and what is expected, for messages.
const EMPTY_CIRCUIT: [&str; 2] = [
    "a circuit without parts",
    "\"resistance\", \"leakage\" or both",
];

/// Circuit that drives no charge, and what is expected, for messages.
const NO_CIRCUIT: [&str; 2] = [
    "a circuit of what it does not charge",
    "a muscle with a permittivity, or a driven electrode",
];

impl Circuit {
    /// Returns the reason why something cannot have this circuit, and what is expected: `is_driven` if a source charges it, `is_meshed` if it
    /// consists of finite elements.
    pub fn fault(&self, is_driven: bool, is_meshed: bool) -> Option<[&'static str; 2]> {
        if *self == Self::default() {
            return Some(EMPTY_CIRCUIT);
        }
        if !is_driven {
            return Some(NO_CIRCUIT);
        }
        (is_meshed && self.resistance.is_none()).then_some(LONE_LEAK)
    }
}
