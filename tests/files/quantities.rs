//! Numbers with units: every spelling, and conversions against another library.

use proboscis::files::units::quantity::{
    Angle, Density, ElectricField, Length, PhysicalQuantity, Quantity, RotationalDamping, Time,
    Viscosity, Voltage,
};
use proptest::prelude::*;

pub(crate) fn value<M: PhysicalQuantity>(text: &str) -> f64 {
    Quantity::<M>::try_from_text(text)
        .unwrap_or_else(|found| panic!("found {found}"))
        .value()
}

fn refused<M: PhysicalQuantity>(text: &str) {
    assert!(
        Quantity::<M>::try_from_text(text).is_err(),
        "{text} was read"
    );
}

#[test]
fn units_are_read_in_all_spellings() {
    assert_eq!(value::<Length>("50 mm"), 50.0);
    assert_eq!(value::<Length>("50um"), 0.05);
    assert_eq!(value::<Length>("50 µm"), 0.05);
    assert_eq!(value::<Voltage>("1.7 kV"), 1700.0);
    assert_eq!(value::<Time>("2 min"), 120_000.0);
    assert_eq!(value::<ElectricField>("80 V/um"), 80_000.0);
    assert_eq!(value::<ElectricField>("80 MV/m"), 80_000.0);
    for text in [
        "1000 kg/m^3",
        "1000 kg/m³",
        "1000 kg m^-3",
        "1000 kg·m⁻³",
        "1 g/cm^3",
        "1 t/m3",
    ] {
        assert_eq!(value::<Density>(text), 1e-3, "{text}");
    }
    for text in [
        "1000 Pa s",
        "1000 Pa · s",
        "1000 Pa*s",
        "1 kPa s",
        "1 MPa ms",
        "1000 N s/m^2",
        "1000 kg/m/s",
    ] {
        assert_eq!(value::<Viscosity>(text), 1.0, "{text}");
    }
    assert_eq!(value::<RotationalDamping>("1e-6 N m s/rad"), 1.0);
    assert_eq!(value::<RotationalDamping>("1 N mm ms"), 1.0);
    assert!((value::<Angle>("180 deg") - std::f64::consts::PI).abs() <= 2.0 * f64::EPSILON * 4.0);
    for text in [
        "", "mm", "50", "50 mm mm", "50 mm/", "50 / mm", "50 m^", "50 m^999", "50 rad", "5 kkm",
        "nan m", "inf m", "1e999 m", "50 mm ?",
    ] {
        refused::<Length>(text);
    }
    refused::<Angle>("1 m/m");
    refused::<Angle>("1 1");
    refused::<Length>("5 m rad");
}

#[test]
fn conversions_agree_with_uom() {
    use uom::si::{angle, electric_field, electric_potential, f64 as si, mass_density};
    let voltage = si::ElectricPotential::new::<electric_potential::kilovolt>(1.7);
    let field = si::ElectricField::new::<electric_field::volt_per_millimeter>(80.0);
    let density = si::MassDensity::new::<mass_density::gram_per_cubic_centimeter>(1.2);
    let turn = si::Angle::new::<angle::degree>(17.0);
    for (ours, theirs) in [
        (value::<Voltage>("1.7 kV"), voltage.value),
        (value::<ElectricField>("80 V/mm"), field.value / 1e3),
        (value::<Density>("1.2 g/cm^3"), density.value / 1e6),
        (value::<Angle>("17 deg"), turn.value),
    ] {
        // One rounding on either side of each of two steps.
        assert!(
            (ours - theirs).abs() <= 4.0 * f64::EPSILON * theirs,
            "{ours} {theirs}"
        );
    }
}

proptest! {
    #[test]
    fn a_quantity_is_the_same_in_every_prefix(number in -1e6..1e6_f64, index in 0..7_usize) {
        let (prefix, factor) = [("", 1.0), ("k", 1e-3), ("m", 1e3), ("u", 1e6), ("n", 1e9), ("M", 1e-6), ("c", 1e2)][index];
        let scaled = number * factor;
        for (si, prefixed) in [
            (value::<Length>(&format!("{number} m")), value::<Length>(&format!("{scaled} {prefix}m"))),
            (value::<Voltage>(&format!("{number} V")), value::<Voltage>(&format!("{scaled} {prefix}V"))),
            (value::<ElectricField>(&format!("{number} V/m")), value::<ElectricField>(&format!("{scaled} {prefix}V/m"))),
        ] {
            // Three roundings: of the factor, of the product, of the conversion.
            prop_assert!((si - prefixed).abs() <= 3.0 * f64::EPSILON * si.abs());
        }
    }

    #[test]
    fn arbitrary_text_never_panics(text in "\\PC{0,40}") {
        let _ = Quantity::<Length>::try_from_text(&text);
        let _ = Quantity::<Angle>::try_from_text(&format!("1 {text}"));
    }
}
