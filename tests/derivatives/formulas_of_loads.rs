//! Energies and virtual works of loads: their derivatives are those of naive formulas.

use crate::formulas::law;
use proboscis::energy::{
    Capacitance, DeadLoad, DielectricCell, ElasticCell, FlowingCharge, FollowingForce, GivenCharge,
    SurfaceCharge,
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
fn charges_of_muscles_have_the_derivatives_of_naive_formulas() {
    let elastic = ElasticCell {
        length: 0.9,
        volume: 1.4,
        shear_modulus: 0.7,
    };
    // Signs and sizes as those of a first-order dielectric: C is positive up to a stretch of 1.4.
    let cell = DielectricCell {
        elastic,
        c1: -0.2,
        c2: 0.15,
        permittivity: 0.9,
        layer: 0.8,
    };
    let capacitance = Capacitance { cell };
    law("given charge", &GivenCharge { capacitance }, 0.3, 1.2);
    let unit = 0.8;
    law(
        "flowing charge",
        &FlowingCharge { capacitance, unit },
        0.3,
        1.2,
    );
}
