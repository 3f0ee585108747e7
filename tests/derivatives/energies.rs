//! Energies of sources as costs: their sum is that of the intervals, by charges read off the poses, and the Hessian is that of differences.

use crate::common::cases::{control, partly};
use crate::common::systems::branched;
use crate::common::tracked::energies;
use crate::costs::{at_random, compare_hessian};
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Objective, Rest, SourceEnergy,
};
use proboscis::model::system::{Attachment, Muscle, System};
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::Nlp;

/// Q/V of a muscle at an instant, as −∂²/∂V² of its energy V₀ [c₁ + c₂ Λ² − ε/(2Λ²)] (V/t)².
fn capacitance(system: &System, model: &Model, z: &[f64], muscle: &Muscle) -> f64 {
    let poses = model.poses(&model.action.map.placed(z));
    let place = |point: &Attachment| match point.body {
        None => point.at,
        Some(body) => {
            let (of, pose) = (&system.bodies[body], &poses[body]);
            pose.centre + pose.directors * of.directors.transpose() * (point.at - of.centre)
        }
    };
    let at_rest = (muscle.to.at - muscle.from.at).norm();
    let stretch = (place(&muscle.to) - place(&muscle.from)).norm() / at_rest;
    let volume = at_rest * muscle.cross_section[0] * muscle.cross_section[1];
    let constants = muscle.material.electric.unwrap();
    let density = constants.c1 + constants.c2 * stretch.powi(2)
        - 0.5 * constants.permittivity / stretch.powi(2);
    -2.0 * volume * density / muscle.layer_thickness.powi(2)
}

/// Motions from a charged rest to voltages that hold the goal, or from no charge to an end that nothing holds; free or given duration in both
/// coordinates; long enough for both halves of a horizon, which has them where its duration is given.
fn problems() -> Vec<Control> {
    let mut list = Vec::new();
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        for intervals in [3, 17] {
            let mut held = control(&branched(), intervals);
            held.duration = Duration::Given(36.0);
            held.coordinates = Some(coordinates);
            held.start =
                BoundaryState::RestAtVoltages(vec![700.0, 0.0, 400.0, 0.0], Rest::Everything);
            held.goal = partly(&[(0, [None, Some(128.0), None])], &[]);
            if let BoundaryState::Markers { hold, .. } = &mut held.goal {
                *hold = Some(vec![300.0, 800.0, 0.0, 0.0]);
            }
            held.objective = Objective {
                energies: energies(&[(0, 2e3), (1, 3e3)], &[(1, 1e3), (2, 4e3)]),
                ..Objective::default()
            };
            let mut free = control(&branched(), intervals);
            free.coordinates = held.coordinates;
            free.objective = held.objective.clone();
            free.duration = Duration::Free {
                min: 10.0,
                max: 90.0,
                guess: 36.0,
            };
            free.start = crate::common::cases::joints(&[(0, 0.1)]);
            list.push(held);
            if intervals == 3 {
                list.push(free);
            }
        }
    }
    list
}

#[test]
fn the_sum_is_that_of_charges_and_stored_energies() {
    let system = branched();
    for control in problems() {
        at_random(&control, |model, program, x| {
            let motion = program.decode(&x);
            let [before, after] = match &control.goal {
                BoundaryState::Markers { hold, .. } => {
                    [vec![700.0, 0.0, 400.0, 0.0], hold.clone().unwrap()]
                }
                _ => [vec![0.0; 4], vec![0.0; 4]],
            };
            let mut expected = 0.0;
            for cost in &control.objective.energies {
                let s = cost.source;
                let scalar = model.variables.input(s).unwrap();
                let muscle = &system.muscles[s];
                let c = |k: usize| capacitance(&system, model, &motion.z[k], muscle);
                let mut last = before[s];
                let mut energy = 0.0;
                for (k, scalars) in motion.scalars.iter().enumerate() {
                    let v = scalars[scalar];
                    energy += match cost.energy {
                        // Voltage times what flows.
                        SourceEnergy::Electrical => v * (c(k + 1) * v - c(k) * last),
                        SourceEnergy::Mechanical => 0.5 * v * v * (c(k + 1) - c(k)),
                    };
                    last = v;
                }
                if cost.energy == SourceEnergy::Electrical {
                    energy += after[s] * c(motion.z.len() - 1) * (after[s] - last);
                }
                assert!(energy.abs() > 1e-4, "{cost:?}: {energy}");
                expected += cost.weight * energy / 1e3;
            }
            let found = program.objective(&x);
            assert!(expected.abs() > 1e-2, "{expected}");
            assert!(
                (found - expected).abs() < 1e-11 * expected.abs(),
                "{found} {expected}"
            );
        });
    }
}

#[test]
fn the_hessian_of_energies_alone_is_that_of_differences() {
    for control in problems() {
        at_random(&control, |_, program, x| compare_hessian(program, &x));
    }
}
