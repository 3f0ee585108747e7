//! The elephant trunk: six segments and twelve muscles, under constant voltages and under optimal ones.

use proboscis::prelude::*;

pub(crate) fn main() -> Result<()> {
    let silicone = Material::elastomer(kpa(100.0)).density(kg_per_m3(1000.0));
    let silicone = silicone.relative_permittivity(3.0).viscosity(pa_s(1000.0));
    let mut trunk = System::new("trunk");
    let (mut below, mut muscles) = (GROUND, Vec::new());
    for i in 0..6 {
        let base = Y * mm(50.0 * f64::from(i));
        let body = Body::cylinder(mm(50.0), mm(20.0)).mass(g(30.0));
        let segment = trunk.add(body.at(base + Y * mm(25.0)).along(Y));
        let (axis, out) = if i % 2 == 0 { (Z, X) } else { (X, Z) };
        trunk.add(Joint::revolute(axis).between(below, segment).at(base));
        for side in [out, -out] {
            let end = |y: f64| base + side * mm(15.0) + Y * mm(y);
            let muscle = Muscle::of(&silicone)
                .section(mm(10.0), mm(10.0))
                .layer(um(50.0));
            muscles.push(trunk.add(muscle.from(below, end(-20.0)).to(segment, end(20.0))));
        }
        below = segment.into();
    }
    let tip = trunk.add(Marker::on(below, Y * mm(300.0)));

    let held = [1, 2, 5, 6, 9, 10].map(|m| (muscles[m], kv(if m % 4 == 1 { 1.7 } else { 1.6 })));
    let mut swing = Simulation::over(s(1.0)).step(ms(10.0));
    for (muscle, voltage) in held {
        swing = swing.voltage(muscle, Signal::ramp(0.0, voltage, ms(200.0)));
    }
    println!(
        "swung, the tip ends at {:.1?} mm",
        swing.run(&trunk)?.position(tip).last()
    );

    let problem = Control::over(s(0.6), 40)
        .goal(State::rest_at(held))
        .effort(1.0);
    let problem = problem
        .voltage_bounds(0.0, kv(3.0))
        .field_below(&muscles, v_per_um(80.0));
    let optimum = problem.solve(&trunk)?;
    println!("{}: objective {:.4}", optimum.status, optimum.objective);
    println!(
        "steered, it ends at {:.1?} mm",
        optimum.motion.position(tip).last()
    );
    Ok(())
}
