//! Limits of every kind.

use nalgebra::Vector3;
use proboscis::control::problem::Limit;
use proboscis::model::{FieldPlace, Plane, Pulling, Reaction, Region, What};

/// A limit of the tension of a muscle.
pub fn tension(muscle: usize) -> Limit {
    Limit::new(What::Tension(Pulling::Muscle(muscle)), [-2.0, 3.0])
}

/// A limit of the force or torque of a joint along an oblique direction.
pub fn reaction(joint: usize, of: Reaction) -> Limit {
    Limit::new(
        What::Reaction {
            joint,
            of,
            along: Vector3::new(0.48, 0.6, 0.64),
        },
        [-3.0, 2.0],
    )
}

/// A limit of the speed of a marker.
pub fn speed(marker: usize) -> Limit {
    Limit::new(What::Speed(marker), [0.02, 0.6])
}

/// Limits of the gaps and normal forces of three contacts.
pub fn gaps() -> Vec<Limit> {
    let of = |contact| {
        [
            Limit::new(What::Gap(contact), [-20.0, 90.0]),
            Limit::below(What::ContactForce(contact), 0.9),
        ]
    };
    (0..3).flat_map(of).collect()
}

/// Every limit of charged muscles, of which one is behind a resistor and the charge of another is given.
pub fn charge_limits() -> Vec<Limit> {
    vec![
        Limit::below(What::Field(FieldPlace::Muscle(0)), 4e4),
        Limit::below(What::Field(FieldPlace::Muscle(1)), 5e4),
        Limit::new(What::Current(0), [-2e-5, 3e-5]),
        Limit::new(What::Power(0), [f64::NEG_INFINITY, 0.04]),
        tension(0),
        tension(1),
    ]
}

/// Every kind of limit on the branched tree.
pub fn all_limits() -> Vec<Limit> {
    let near = |centre: [f64; 3], half: f64| Region::Box {
        min: Vector3::from(centre).add_scalar(-half),
        max: Vector3::from(centre).add_scalar(half),
    };
    let ball = |centre: [f64; 3], radius: f64| Region::Sphere {
        centre: Vector3::from(centre),
        radius,
    };
    let marker = |marker: usize, region: Region, side: [f64; 2]| {
        Limit::new(What::Region { marker, region }, side)
    };
    vec![
        Limit::new(
            What::Joint {
                joint: 0,
                near: 0.0,
            },
            [-0.6, 0.7],
        ),
        Limit::new(
            What::Joint {
                joint: 1,
                near: 0.0,
            },
            [f64::NEG_INFINITY, 9.0],
        ),
        Limit::of_rate(
            What::Joint {
                joint: 0,
                near: 0.0,
            },
            [f64::NEG_INFINITY, 0.02],
        ),
        Limit::of_rate(
            What::Joint {
                joint: 1,
                near: 0.0,
            },
            [-0.4, 0.5],
        ),
        Limit::of_rate(What::Voltage(2), [-80.0, 60.0]),
        Limit::new(What::Current(1), [-2e-6, 3e-6]),
        Limit::new(What::Current(2), [f64::NEG_INFINITY, 2e-6]),
        Limit::new(What::Power(1), [-0.002, 0.003]),
        Limit::new(What::Stretch(0), [0.7, 1.2]),
        Limit::new(What::Stretch(3), [0.0, 1.5]),
        tension(0),
        tension(1),
        tension(3),
        Limit::new(What::Speed(1), [0.0, 0.6]),
        Limit::new(
            What::Clearance {
                marker: 1,
                plane: Plane {
                    body: Some(0),
                    point: Vector3::new(10.0, 20.0, -5.0),
                    normal: Vector3::new(0.6, 0.0, 0.8),
                },
            },
            [-500.0, 400.0],
        ),
        Limit::below(What::Field(FieldPlace::Muscle(1)), 5e4),
        Limit::below(What::Field(FieldPlace::Muscle(3)), 5e4),
        marker(0, near([20.0, 120.0, 5.0], 60.0), [f64::NEG_INFINITY, 1.0]),
        marker(0, ball([20.0, 120.0, 5.0], 70.0), [f64::NEG_INFINITY, 1.0]),
        marker(1, near([-60.0, 100.0, 20.0], 15.0), [1.0, f64::INFINITY]),
        marker(1, ball([-60.0, 100.0, 20.0], 20.0), [1.0, f64::INFINITY]),
    ]
}
