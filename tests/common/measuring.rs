//! Problems with costs of measured quantities, and with limits at single times.

use super::cases::{Case, control};
use super::limited::{all_limits, reaction, speed, tension};
use super::remembering::remembering;
use super::systems::{blocks, branched, charged};
use super::tracked::{measured, measured_source};
use proboscis::control::problem::{BoundaryState, Control, Duration};
use proboscis::math::Signal;
use proboscis::model::Reaction;
use proboscis::model::system::{Circuit, System};

/// Blocks of which a muscle and an electrode are behind resistors, one with a leak.
fn resisted() -> System {
    let mut system = blocks();
    let circuit = |leakage| Circuit {
        resistance: Some(3e8),
        leakage,
    };
    system.muscles[0].circuit = Some(circuit(Some(9e8)));
    system.solids[0].electrodes[2].circuit = Some(circuit(None));
    system
}

/// The list.
pub fn measuring() -> Vec<Case> {
    let case = |name, system: System, change: &dyn Fn(&mut Control)| {
        let mut control = control(&system, 3);
        change(&mut control);
        Case {
            name,
            system,
            control,
        }
    };
    let force = |joint| reaction(joint, Reaction::Force);
    let torque = |joint| reaction(joint, Reaction::Torque);
    let free = Duration::Free {
        min: 10.0,
        max: 90.0,
        guess: 30.0,
    };
    vec![
        case("branched tree, reactions", branched(), &|c| {
            c.limits = vec![force(0), force(1), force(2).at_part(1.0)];
        }),
        case("branched tree, reaction torques", branched(), &|c| {
            c.limits = vec![torque(0), torque(1), torque(2).at_part(1.0)];
        }),
        case("branched tree, reactions, free time", branched(), &|c| {
            c.limits = vec![force(0), force(1), force(2).at_part(1.0)];
            c.limits.extend([torque(1), torque(2)]);
            c.duration = free;
            c.objective.rate = 0.3;
        }),
        case("charges, reactions, free time", charged(), &|c| {
            c.limits = vec![force(0), torque(0)];
            c.duration = free;
            c.given.insert(4, Signal::Constant(1e-4));
        }),
        case("blocks behind resistors, free time", resisted(), &|c| {
            c.goal = BoundaryState::Free;
            c.duration = free;
        }),
        case(
            "branched tree that remembers, measured costs",
            remembering(),
            &|c| {
                c.objective.quantities = measured(&[0, 2], &[], &[], &[]);
            },
        ),
        case("charges, measured costs, free time", charged(), &|c| {
            c.duration = free;
            c.objective.quantities = measured(&[0, 1], &[], &[], &[1]);
            c.objective.quantities.extend(measured_source(0));
            c.load_bounds.insert(4, [1e-5, 3e-4]);
        }),
        case(
            "branched tree, measured costs, free time",
            branched(),
            &|c| {
                c.objective.quantities =
                    measured(&[0, 1, 3], &[(0, true), (1, false)], &[0], &[1, 3]);
                c.duration = free;
            },
        ),
        case("branched tree, limits at single times", branched(), &|c| {
            let limits = all_limits().into_iter();
            c.limits = limits.map(|limit| limit.at_part(1.0)).collect();
            c.limits.push(speed(0).at_part(0.5));
            c.limits.push(tension(1).at_part(0.4));
        }),
    ]
}
