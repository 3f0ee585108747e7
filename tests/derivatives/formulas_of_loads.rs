//! Energies and virtual works of loads: their derivatives are those of naive formulas.

use crate::formulas::law;
use proboscis::energy::{DeadLoad, FollowingForce, SurfaceCharge};
use proboscis::math::Vector;

#[test]
fn loads_have_the_derivatives_of_naive_formulas() {
    let force = Vector::new(0.3, -0.7, 0.9);
    law("dead load", &DeadLoad { force }, 0.2, 1.1);
    law("following force", &FollowingForce, 0.2, 1.1);
    law("surface charge", &SurfaceCharge { weight: 0.7 }, 0.2, 1.1);
}
