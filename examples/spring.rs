//! A mass on a slide between two springs, compared with the closed form of its oscillation.

use proboscis::prelude::*;
use std::f64::consts::TAU;

pub(crate) fn main() -> Result<()> {
    let (mass, stiffness, amplitude) = (g(50.0), n_per_m(200.0), mm(5.0));
    let mut system = System::new("oscillator");
    let cart = system.add(Body::cuboid([mm(20.0); 3]).mass(mass));
    let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    for side in [X, -X] {
        let spring = Spring::between((GROUND, side * mm(60.0)), (cart, side * mm(10.0)));
        system.add(spring.stiffness(stiffness));
    }
    let period = TAU * (mass / (2.0 * stiffness)).sqrt();
    let motion = Simulation::over(3.0 * period)
        .step(period / 400.0)
        .start(State::Joints(vec![(slide, amplitude)]))
        .run(&system)?;
    let found = motion.joint(slide);
    let errors = motion.times().iter().zip(&found).map(|(t, x)| {
        let exact = amplitude * (TAU * t / period).cos();
        (x - exact).abs()
    });
    let greatest = errors.fold(0.0, f64::max);
    println!("period {period:.1} ms, greatest error {greatest:.1e} mm");
    assert!(greatest < 1e-2 * amplitude);
    Ok(())
}
