//! A block of finite elements between two electrodes: it contracts under a voltage and oscillates.

use proboscis::prelude::*;

pub(crate) fn main() -> Result<()> {
    let gel = Material::elastomer(kpa(50.0))
        .poisson_ratio(0.45)
        .density(kg_per_m3(1000.0));
    let gel = gel.ideal_dielectric(5.0).viscosity(pa_s(20.0));
    let size = (X + Y) * mm(10.0) + Z * mm(0.5);
    let grid = Grid::uniform(X * 0.0, size, [4, 4, 1]);
    let mut system = System::new("block");
    let block = system.add(
        Solid::on(grid.mesh(), &gel)
            .clamped("z_min")
            .electrode("ground", "z_min", Potential::GROUNDED)
            .electrode("top", "z_max", Potential::DRIVEN),
    );
    let corner = system.add(Marker::on_solid(block, size));
    let rise = Signal::ramp(0.0, kv(8.0), ms(2.0));
    let motion = Simulation::over(ms(20.0))
        .step(ms(0.25))
        .voltage((block, "top"), rise)
        .run(&system)?;
    let heights: Vec<f64> = motion.position(corner).iter().map(|x| x.z).collect();
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let last = heights[heights.len() - 1];
    println!(
        "the corner sinks from {:.3} to {lowest:.3} mm and ends at {last:.3} mm",
        heights[0]
    );
    for remark in motion.remarks() {
        println!("{remark}");
    }
    assert!(lowest < 0.98 * heights[0]);
    Ok(())
}
