//! Limits of every kind.

use nalgebra::Vector3;
use proboscis::control::problem::{PathConstraint, Side};
use proboscis::model::{Reaction, Region};

/// A limit of the tension of a muscle.
pub fn tension(muscle: usize) -> PathConstraint {
    PathConstraint::Tension {
        muscle,
        min: -2.0,
        max: 3.0,
    }
}

/// A limit of the force or torque of a joint along an oblique direction.
pub fn reaction(joint: usize, of: Reaction) -> PathConstraint {
    PathConstraint::Reaction {
        joint,
        of,
        along: Vector3::new(0.48, 0.6, 0.64),
        min: -3.0,
        max: 2.0,
    }
}

/// A limit of the speed of a marker.
pub fn speed(marker: usize) -> PathConstraint {
    PathConstraint::MarkerSpeed {
        marker,
        min: 0.02,
        max: 0.6,
    }
}

/// Every limit of charged muscles, of which one is behind a resistor and the charge of another is given.
pub fn charge_limits() -> Vec<PathConstraint> {
    vec![
        PathConstraint::ElectricField {
            muscle: 0,
            max: 4e4,
        },
        PathConstraint::ElectricField {
            muscle: 1,
            max: 5e4,
        },
        PathConstraint::Current {
            muscle: 0,
            min: -2e-5,
            max: 3e-5,
        },
        PathConstraint::Power {
            muscle: 0,
            min: f64::NEG_INFINITY,
            max: 0.04,
        },
        tension(0),
        tension(1),
    ]
}

/// Every kind of limit on the branched tree.
pub fn all_limits() -> Vec<PathConstraint> {
    let near = |centre: [f64; 3], half: f64| Region::Box {
        min: Vector3::from(centre).add_scalar(-half),
        max: Vector3::from(centre).add_scalar(half),
    };
    let ball = |centre: [f64; 3], radius: f64| Region::Sphere {
        centre: Vector3::from(centre),
        radius,
    };
    let marker = |marker: usize, region: Region, side: Side| PathConstraint::Marker {
        marker,
        region,
        side,
    };
    vec![
        PathConstraint::JointAngle {
            joint: 0,
            min: -0.6,
            max: 0.7,
        },
        PathConstraint::JointAngle {
            joint: 1,
            min: f64::NEG_INFINITY,
            max: 9.0,
        },
        PathConstraint::JointRate {
            joint: 0,
            min: f64::NEG_INFINITY,
            max: 0.02,
        },
        PathConstraint::JointRate {
            joint: 1,
            min: -0.4,
            max: 0.5,
        },
        PathConstraint::VoltageRate {
            source: 2,
            min: -80.0,
            max: 60.0,
        },
        PathConstraint::Current {
            muscle: 1,
            min: -2e-6,
            max: 3e-6,
        },
        PathConstraint::Current {
            muscle: 2,
            min: f64::NEG_INFINITY,
            max: 2e-6,
        },
        PathConstraint::Power {
            muscle: 1,
            min: -0.002,
            max: 0.003,
        },
        PathConstraint::Stretch {
            muscle: 0,
            min: 0.7,
            max: 1.2,
        },
        PathConstraint::Stretch {
            muscle: 3,
            min: 0.0,
            max: 1.5,
        },
        tension(0),
        tension(1),
        tension(3),
        PathConstraint::MarkerSpeed {
            marker: 1,
            min: 0.0,
            max: 0.6,
        },
        PathConstraint::ElectricField {
            muscle: 1,
            max: 5e4,
        },
        PathConstraint::ElectricField {
            muscle: 3,
            max: 5e4,
        },
        marker(0, near([20.0, 120.0, 5.0], 60.0), Side::Inside),
        marker(0, ball([20.0, 120.0, 5.0], 70.0), Side::Inside),
        marker(1, near([-60.0, 100.0, 20.0], 15.0), Side::Outside),
        marker(1, ball([-60.0, 100.0, 20.0], 20.0), Side::Outside),
    ]
}
