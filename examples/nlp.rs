//! The nonlinear program of a control problem: values and exact sparse derivatives for another solver.

use proboscis::Nlp;
use proboscis::prelude::*;

pub(crate) fn main() -> Result<()> {
    let silicone = Material::elastomer(kpa(100.0)).density(kg_per_m3(1000.0));
    let silicone = silicone.relative_permittivity(3.0).viscosity(pa_s(1000.0));
    let mut arm = System::new("arm");
    let body = Body::cylinder(mm(50.0), mm(20.0))
        .mass(g(30.0))
        .at(Y * mm(25.0))
        .along(Y);
    let body = arm.add(body);
    arm.add(Joint::revolute(Z).between(GROUND, body));
    let muscles = [X, -X].map(|side| {
        let end = |y: f64| side * mm(15.0) + Y * mm(y);
        let muscle = Muscle::of(&silicone)
            .section(mm(10.0), mm(10.0))
            .layer(um(50.0));
        arm.add(muscle.from(GROUND, end(-20.0)).to(body, end(20.0)))
    });
    let problem = Control::over(ms(300.0), 20)
        .goal(State::rest_at([(muscles[0], kv(1.5))]))
        .voltage_bounds(0.0, kv(3.0))
        .effort(1.0);
    problem.with_program(&arm, |program: &mut dyn Nlp, x| {
        let (variables, rows) = (program.variables().clone(), program.constraints().clone());
        let structure = program.jacobian_structure();
        let mut g = vec![0.0; rows.lower.len()];
        let mut values = vec![0.0; structure.rows.len()];
        program.constraint(x, &mut g);
        program.jacobian(x, &mut values);
        println!(
            "{} variables, {} constraints",
            variables.lower.len(),
            rows.lower.len()
        );
        println!("objective {:.6} at the start", program.objective(x));
        println!("violated by at most {:.2e}", rows.violation(&g));
        let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        println!(
            "{} entries of the Jacobian, the largest {largest:.3}",
            values.len()
        );
        println!("{} of the Hessian", program.hessian_structure().rows.len());
    })
}
