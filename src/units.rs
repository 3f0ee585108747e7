//! Units of the quantities inside: g, mm, ms, N, mJ, MPa, V, rad.
//!
//! ```
//! use proboscis::units::*;
//! assert_eq!(kpa(100.0), 0.1); // MPa
//! assert_eq!(pa_s(1000.0), 1.0); // MPa ms
//! ```

/// Declares one function a unit.
macro_rules! units {
    ($($(#[$about:meta])* $name:ident = $factor:expr;)*) => {$(
        $(#[$about])*
        #[must_use]
        pub const fn $name(value: f64) -> f64 {
            value * $factor
        }
    )*};
}

units! {
    /// Lengths in m.
    m = 1e3;
    /// Lengths in mm.
    mm = 1.0;
    /// Lengths in µm.
    um = 1e-3;
    /// Masses in kg.
    kg = 1e3;
    /// Masses in g.
    g = 1.0;
    /// Times in s.
    s = 1e3;
    /// Times in ms.
    ms = 1.0;
    /// Frequencies in Hz.
    hz = 1e-3;
    /// Voltages in V.
    v = 1.0;
    /// Voltages in kV.
    kv = 1e3;
    /// Electric fields in V/µm.
    v_per_um = 1e3;
    /// Stresses in kPa.
    kpa = 1e-3;
    /// Stresses in MPa.
    mpa = 1.0;
    /// Viscosities in Pa s.
    pa_s = 1e-3;
    /// Densities in kg/m³.
    kg_per_m3 = 1e-6;
    /// Accelerations in m/s².
    m_per_s2 = 1e-3;
    /// Stiffnesses in N/m.
    n_per_m = 1e-3;
    /// Damping in N s/m.
    n_s_per_m = 1.0;
    /// Damping of angles in N m s/rad.
    n_m_s = 1e6;
    /// Angles in degrees.
    deg = std::f64::consts::PI / 180.0;
}
