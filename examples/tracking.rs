//! An arm between two muscles: its joint follows a sine, and the tracking error is printed.

use proboscis::prelude::*;

pub(crate) fn main() -> Result<()> {
    let silicone = Material::elastomer(kpa(100.0)).density(kg_per_m3(1000.0));
    let silicone = silicone.relative_permittivity(3.0).viscosity(pa_s(1000.0));
    let mut system = System::new("arm");
    let body = Body::cylinder(mm(50.0), mm(20.0)).mass(g(30.0));
    let arm = system.add(body.at(Y * mm(25.0)).along(Y));
    let hinge = system.add(Joint::revolute(Z).between(GROUND, arm));
    let mut muscles = Vec::new();
    for side in [X, -X] {
        let end = |y: f64| side * mm(15.0) + Y * mm(y);
        let muscle = Muscle::of(&silicone).section(mm(10.0), mm(10.0));
        let muscle = muscle.layer(um(50.0)).from(GROUND, end(-20.0));
        muscles.push(system.add(muscle.to(arm, end(20.0))));
    }

    let sine = Signal::Sine {
        mean: 0.0,
        amplitude: 0.1,
        frequency: s(1.0).recip(),
        phase: 0.0,
    };
    let optimum = Control::over(s(1.0), 50)
        .goal(State::Free)
        .voltage_bounds(0.0, kv(3.0))
        .track_joint(hinge, sine, 1e3)
        .electrical_energy(&muscles, 1.0)
        .solve(&system)?;
    let error = &optimum.tracking[0].error;
    println!(
        "{}: {:.1e} rad rms, at most {:.1e} rad",
        optimum.status, error.rms, error.maximum
    );
    for muscle in muscles {
        let energy = optimum.motion.electrical_energy(muscle).last();
        println!("electrical energy of a muscle: {energy:.3?} mJ");
    }
    assert!(optimum.is_solved() && error.maximum < 0.01);
    Ok(())
}
