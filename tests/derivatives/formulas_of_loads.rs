//! Energies and virtual works of loads, bounds of inputs and rates of joints: their derivatives are those of naive formulas.

use crate::formulas::{DIELECTRIC, law};
use proboscis::energy::{
    AngleStep, Capacitance, DeadLoad, DielectricCell, FlowingCharge, FlowingChargeField,
    FollowingForce, GivenCharge, GivenChargeField, MeanCharge, Multiple, PeakExcess,
    ProjectionStep, SourceCurrent, SourcePower, StoredEnergy, SurfaceCharge,
};
use proboscis::math::Vector;

#[test]
fn loads_have_the_derivatives_of_naive_formulas() {
    let force = Vector::new(0.3, -0.7, 0.9);
    law("dead load", &DeadLoad { force }, 0.2, 1.1);
    law("following force", &FollowingForce, 0.2, 1.1);
    law("surface charge", &SurfaceCharge { weight: 0.7 }, 0.2, 1.1);
}

#[test]
fn peaks_and_rates_have_the_derivatives_of_naive_formulas() {
    law("peak", &Multiple { unit: 0.7 }, 0.2, 1.1);
    law("angle step", &AngleStep, 0.3, 1.0);
    law("projection step", &ProjectionStep, 0.3, 1.0);
    law("peak excess", &PeakExcess { unit: 0.7 }, 0.2, 1.1);
}

#[test]
fn charges_of_muscles_have_the_derivatives_of_naive_formulas() {
    let cell = DIELECTRIC;
    let capacitance = Capacitance { cell };
    law("given charge", &GivenCharge { capacitance }, 0.3, 1.3);
    let unit = 0.8;
    law(
        "flowing charge",
        &FlowingCharge { capacitance, unit },
        0.3,
        1.3,
    );
}

#[test]
fn limits_of_charged_muscles_have_the_derivatives_of_naive_formulas() {
    // Positive at every stretch.
    let cell = DielectricCell {
        c1: -0.3,
        c2: -0.2,
        ..DIELECTRIC
    };
    let capacitance = Capacitance { cell };
    let field = GivenChargeField {
        capacitance,
        voltage: 0.6,
    };
    law("field of a given charge", &field, 0.3, 1.3);
    let unit = 0.8;
    law(
        "field of a flowing charge",
        &FlowingChargeField { field, unit },
        0.3,
        1.3,
    );
    let current = SourceCurrent {
        capacitance,
        unit_of_charge: unit,
        resistance: 0.7,
        unit: 1.2,
    };
    law("current of a source", &current, 0.3, 1.3);
    law("power of a source", &SourcePower(current), 0.3, 1.3);
    law("mean charge", &MeanCharge(capacitance), 0.3, 1.3);
    law("stored energy", &StoredEnergy(capacitance), 0.3, 1.3);
}
