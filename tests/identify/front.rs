//! The front door of identifications: built by parts, with tensions, a payload and mistakes.

use crate::oscillator::{DAMPING, MASS, STIFFNESS, place, times};
use proboscis::control::problem::SoughtStart;
use proboscis::prelude::*;

/// An oscillator with a payload of some mass in g on its cart.
fn loaded(payload: f64) -> (System, Handle<Joint>, Handle<Spring>, Handle<Body>) {
    let mut system = System::new("oscillator");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(40.0)));
    let load = system.add(Body::sphere(mm(5.0)).mass(g(payload)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    system.add(JointKind::Fixed.between(cart, load));
    let spring = Spring::between((GROUND, -X * mm(50.0)), (cart, X * mm(0.0)));
    let spring = system.add(spring.stiffness(n_per_m(120.0)));
    system.joints[slide.index()].damping = Some(1.0);
    (system, slide, spring, cart)
}

/// Places in mm at times in ms of an oscillator of some mass, from 5 mm.
fn readings(mass: f64) -> Vec<(f64, f64)> {
    let factor = MASS / mass;
    let at = |t: f64| place(t, [factor * STIFFNESS, factor * DAMPING], [5.0, 0.0]);
    times(31, 150.0).into_iter().map(|t| (t, at(t))).collect()
}

#[test]
fn tensions_and_a_payload_tell_constants_by_the_front_door() {
    let (system, slide, spring, cart) = loaded(1e-6);
    let start = || State::Joints(vec![(slide, mm(5.0))]);
    // On a clock at which the motion begins after a second.
    let late = || readings(MASS).into_iter().map(|(t, x)| (1e3 + t, x));
    let pull = |(t, x): (f64, f64)| (t, STIFFNESS * x);
    let alone = Recording::new("alone")
        .start(start())
        .joint(slide, late(), mm(0.001))
        .tension(spring, late().map(pull), 0.0002);
    let open = Identification::of([]).recording(alone.clone()).run(&system);
    let error = open.unwrap_err().to_string();
    assert!(error.contains("time_offset"), "{error}");
    let alone = alone.time_offset(1e3);
    let (other, ..) = loaded(30.0);
    let with_load = Recording::new("loaded")
        .of(other)
        .start(start())
        .sought_start(SoughtStart::Coordinates)
        .joint(slide, readings(MASS + 30.0), mm(0.001));
    let parameters = [
        Parameter::new("stiffness", 0.05..=0.9, 0.12).is(spring.stiffness()),
        Parameter::new("damping", 0.1..=5.0, 1.0).is(slide.damping()),
        Parameter::new("mass", 10.0..=200.0, 40.0).is(cart.mass()),
    ];
    let asked = Identification::of(parameters.clone()).step(5.0);
    let asked = asked.recording(alone.clone()).recording(with_load);
    let found = asked.run(&system).unwrap();
    assert!(found.information.undetermined.is_empty());
    let truth = [STIFFNESS, DAMPING, MASS];
    for (value, truth) in found.fit.of_constants().iter().zip(truth) {
        assert!((value / truth - 1.0).abs() < 1e-5, "{value} {truth}");
    }
    let held_out = Identification::of(parameters).recording(alone.held_out());
    let error = held_out.run(&system).unwrap_err().to_string();
    assert!(
        error.contains("one or more to which constants are fitted"),
        "{error}"
    );
    let crossed = Parameter::new("stiffness", 0.9..=0.05, 0.12).is(spring.stiffness());
    let error = Identification::of([crossed]).run(&system).unwrap_err();
    assert!(error.to_string().contains("within bounds"), "{error}");
}
