//! Measured quantities of a program of the library: costs along the motion, limits along it and at its end.

use proboscis::prelude::*;

/// A segment on a hinge between two muscles.
fn arm() -> (System, Handle<Joint>, [Handle<Muscle>; 2], Handle<Marker>) {
    let silicone = Material::elastomer(kpa(100.0))
        .density(kg_per_m3(1000.0))
        .relative_permittivity(3.0)
        .viscosity(pa_s(1000.0));
    let mut arm = System::new("arm");
    let link = Body::cylinder(mm(50.0), mm(20.0)).mass(g(30.0));
    let link = arm.add(link.at(Y * mm(25.0)).along(Y));
    let hinge = arm.add(Joint::revolute(Z).between(GROUND, link));
    let muscles = [X, -X].map(|side| {
        let end = |y: f64| side * mm(15.0) + Y * mm(y);
        let muscle = Muscle::of(&silicone)
            .section(mm(10.0), mm(10.0))
            .layer(um(50.0));
        arm.add(muscle.from(GROUND, end(-20.0)).to(link, end(20.0)))
    });
    let tip = arm.add(Marker::on(link, Y * mm(50.0)).named("tip"));
    (arm, hinge, muscles, tip)
}

#[test]
fn a_program_follows_and_bounds_measured_quantities() {
    let (arm, hinge, muscles, tip) = arm();
    let free = Control::over(s(0.2), 20)
        .goal(State::Free)
        .voltage_bounds(0.0, kv(3.0))
        .effort(1e-3);
    let h = 0.2 / 20.0;
    let problem = free
        .clone()
        .track_joint_rate(hinge, 0.6, 1.0)
        .track_tension(muscles[1], 0.5, 0.1)
        .low_field(muscles[0], 1e-4)
        .low_speed(tip, 0.1)
        .marker_speed_within(tip, 0.0..=0.04)
        .reaction_within(hinge, Y, -20.0..=20.0)
        .joint_rate_within(hinge, -0.2e-3..=-0.2e-3)
        .only_at(1.0);
    let found = problem.solve(&arm).unwrap();
    assert!(found.is_solved(), "{}: {:?}", found.status, found.message);
    let angles = found.motion.joint(hinge);
    let rates: Vec<f64> = angles
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / h)
        .collect();
    assert!((rates[19] + 0.2).abs() < 1e-6, "{rates:?}");
    // It follows the rate in between.
    assert!(rates[10] > 0.3 && rates[10] < 0.8, "{rates:?}");
    let places = found.motion.position(tip);
    let speeds = places
        .windows(2)
        .map(|pair| 1e-3 * (pair[1] - pair[0]).norm() / h);
    let most = speeds.fold(0.0, f64::max);
    assert!(most > 0.01 && most < 0.04 + 1e-7, "{most}");
    let refused = |problem: Control, words: &str| {
        let told = problem.solve(&arm).unwrap_err().to_string();
        assert!(told.contains(words), "{told}");
    };
    let late = free.clone().marker_speed_within(tip, 0.0..=1.0);
    refused(late.only_at(1.5), "a range of a part of the system");
    let along = free.clone().reaction_within(hinge, Y * 2.0, -1.0..=1.0);
    refused(along, "a range of a part of the system");
    // Without a resistor the voltage jumps.
    let current = free.clone().track_current(muscles[0], 0.0, 1.0);
    refused(current, "a positive weight");
    refused(free.low_speed(tip, -1.0), "a positive weight");
}
