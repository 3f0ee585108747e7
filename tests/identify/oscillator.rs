//! A damped oscillator on a slide, its motion in closed form, and recordings of it.

use proboscis::control::problem::{
    BoundaryState, Channel, Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::math::Random;
use proboscis::model::system::ElectricConstants;
use proboscis::model::{Constant, Follower, MaterialConstant, Parameter, Quantity};
use proboscis::prelude::{
    Body, GROUND, Joint, Material, Muscle, Spring, System, X, g, mm, n_per_m, um,
};
use std::collections::BTreeMap;

/// Mass in g, stiffness in N/mm and damping in N ms/mm.
pub(crate) const MASS: f64 = 50.0;
pub(crate) const STIFFNESS: f64 = 0.2;
pub(crate) const DAMPING: f64 = 0.6;

/// A cart on a damped slide, held by a spring.
pub(crate) fn system() -> System {
    let mut system = System::new("oscillator");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(MASS)));
    system.add(Joint::prismatic(X).between(GROUND, cart));
    let spring = Spring::between((GROUND, -X * mm(50.0)), (cart, X * mm(0.0)));
    system.add(spring.stiffness(n_per_m(1e3 * STIFFNESS)));
    system.joints[0].damping = Some(DAMPING);
    system
}

/// A cart on a slide that a muscle of a material pulls.
pub(crate) fn pulled_cart(name: &str, material: &Material) -> System {
    let mut system = System::new(name);
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
    system.add(Joint::prismatic(X).between(GROUND, cart));
    let muscle = Muscle::of(material)
        .section(mm(10.0), mm(10.0))
        .layer(um(50.0));
    system.add(muscle.from(GROUND, -X * mm(40.0)).to(cart, X * mm(0.0)));
    system
}

/// Place in mm at a time in ms after a start from rest or with a velocity in mm/ms.
pub(crate) fn place(time: f64, [stiffness, damping]: [f64; 2], [x, v]: [f64; 2]) -> f64 {
    let decay = 0.5 * damping / MASS;
    let omega = (stiffness / MASS - decay * decay).sqrt();
    let sine = (v + decay * x) / omega;
    (-decay * time).exp() * (x * (omega * time).cos() + sine * (omega * time).sin())
}

pub(crate) fn parameter(name: &str, constant: Constant, guess: f64) -> Parameter {
    Parameter {
        name: name.into(),
        constants: vec![Follower::from(constant)],
        lower: 0.02 * guess,
        upper: 20.0 * guess,
        guess,
    }
}

/// Stiffness and damping from twice and half their values.
pub(crate) fn parameters() -> Vec<Parameter> {
    vec![
        parameter("stiffness", Constant::SpringStiffness(0), 2.0 * STIFFNESS),
        parameter("damping", Constant::JointDamping(0), 0.5 * DAMPING),
    ]
}

/// Equidistant times from zero on.
pub(crate) fn times(count: usize, last: f64) -> Vec<f64> {
    let part = |k: usize| k as f64 / (count - 1) as f64;
    (0..count).map(|k| last * part(k)).collect()
}

pub(crate) fn joint(x: f64, v: f64) -> BoundaryState {
    BoundaryState::JointAngles {
        angles: BTreeMap::from([(0, x)]),
        rates: BTreeMap::from([(0, v)]),
        velocities: BTreeMap::new(),
    }
}

pub(crate) fn slide(readings: Vec<Reading>, is_deviation_known: bool) -> Channel {
    Channel {
        name: "x".into(),
        parts: vec![(1.0, Quantity::joint(0, 0.0))],
        unit: ("m", 1e-3),
        is_deviation_known,
        readings,
    }
}

/// A recording of the closed form with errors of a known deviation.
pub(crate) fn recording(
    name: &str,
    start: [f64; 2],
    (count, last): (usize, f64),
    mut noise: Option<(f64, &mut Random)>,
) -> Recording {
    let deviation = noise.as_ref().map_or(1.0, |(deviation, _)| *deviation);
    let reading = |time: f64| {
        let error = noise
            .as_mut()
            .map_or(0.0, |(deviation, random)| *deviation * random.normal());
        Reading {
            time,
            value: place(time, [STIFFNESS, DAMPING], start) + error,
            deviation,
        }
    };
    let readings = times(count, last).into_iter().map(reading).collect();
    let is_known = deviation != 1.0;
    Recording {
        name: name.into(),
        scene: None,
        regime: Regime::Motion,
        voltages: Voltages::default(),
        start: joint(start[0], start[1]),
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels: vec![slide(readings, is_known)],
    }
}

pub(crate) fn task(recordings: Vec<Recording>) -> Identification {
    Identification {
        parameters: parameters(),
        recordings,
        priors: Vec::new(),
        candidates: Vec::new(),
        step: None,
        coordinates: None,
    }
}

/// Relative permittivity of some muscles.
pub(crate) fn permittivity(
    muscles: usize,
    of: fn(f64) -> ElectricConstants,
    guess: f64,
) -> Parameter {
    use MaterialConstant::{C1, C2, Permittivity};
    let [none, one] = [of(0.0), of(1.0)].map(|e| [e.c1, e.c2, e.permittivity]);
    let mut out = parameter("permittivity", Permittivity.of_muscle(0), guess);
    out.constants.clear();
    for muscle in 0..muscles {
        for (i, constant) in [C1, C2, Permittivity].into_iter().enumerate() {
            if one[i] != none[i] {
                out.constants.push(Follower {
                    constant: constant.of_muscle(muscle),
                    factor: one[i] - none[i],
                    offset: none[i],
                    higher: [0.0; 2],
                });
            }
        }
    }
    out
}
