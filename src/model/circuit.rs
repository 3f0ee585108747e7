//! Circuits between the sources of lumped muscles and their electrodes.

/// A resistor in series with the electrodes of a lumped muscle: the voltage V of the source is R Q̇ + Q/C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit {
    /// Resistance R in V ms/mC, which is Ω.
    pub resistance: f64,
}
