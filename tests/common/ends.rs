//! Control problems whose ends are sought with the motion, and what they pass.

use super::cases::{Case, control, joints, partly};
use super::limited::all_limits;
use super::systems::{branched, loaded};
use super::tracked::{energies, tracked};
use super::trunk;
use proboscis::System;
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Objective, Place, SoughtHold, Waypoint,
};
use std::collections::BTreeMap;

/// The list: goals whose holding inputs are sought, costs at an instant on the way, and periodic motions.
pub fn ends() -> Vec<Case> {
    let case = |name, system: System, change: &dyn Fn(&mut Control)| {
        let mut control = control(&system, 3);
        change(&mut control);
        Case {
            name,
            system,
            control,
        }
    };
    let free = Duration::Free {
        min: 10.0,
        max: 90.0,
        guess: 30.0,
    };
    let inputs = Objective {
        effort: 0.7,
        rate: 0.02,
        duration: 0.3,
        ..Objective::default()
    };
    let everything = Objective {
        effort: 0.7,
        rate: 0.02,
        energies: energies(&[(0, 2e3), (1, 3e3)], &[(1, 1e3), (2, 4e3)]),
        ..tracked(&[0, 1], &[(0, true)])
    };
    vec![
        case("branched tree, found hold, all limits", branched(), &|c| {
            c.goal = joints(&[(1, 2.0)]);
            c.sought_hold = SoughtHold::Always;
            c.limits = all_limits();
            c.objective = everything.clone();
        }),
        case("branched tree, found hold, free time", branched(), &|c| {
            c.goal = partly(&[(0, [None, Some(128.0), None])], &[]);
            c.sought_hold = SoughtHold::Always;
            c.objective = inputs.clone();
            c.duration = free;
        }),
        case("branched tree, periodic, all limits", branched(), &|c| {
            c.goal = BoundaryState::Periodic;
            c.limits = all_limits();
            c.objective = Objective {
                rate: 0.02,
                ..tracked(&[0, 1], &[(0, true)])
            };
            c.waypoints = vec![Waypoint {
                part: 1.0,
                angles: BTreeMap::from([(1, 2.0)]),
                ..Waypoint::default()
            }];
        }),
        case("branched tree, periodic, free time", branched(), &|c| {
            c.goal = BoundaryState::Periodic;
            c.objective = inputs.clone();
            c.duration = free;
        }),
        case(
            "branched tree, costs on the way, free time",
            branched(),
            &|c| {
                let near = Waypoint {
                    part: 0.4,
                    places: BTreeMap::from([(0, Place([Some(20.0), None, Some(5.0)]))]),
                    angles: BTreeMap::from([(0, 0.3), (1, 2.0)]),
                    ..Waypoint::default()
                };
                c.objective = Objective {
                    quantities: near.costs(3.0),
                    ..inputs.clone()
                };
                c.duration = free;
            },
        ),
        case("loads, found hold, free time", loaded(trunk(2)), &|c| {
            c.sought_hold = SoughtHold::Always;
            c.duration = free;
            c.objective = inputs.clone();
        }),
    ]
}
