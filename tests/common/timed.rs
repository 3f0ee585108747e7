//! Control problems of a free duration in which inputs and joints are functions of time.

use super::cases::{Case, control, joints};
use super::limited::all_limits;
use super::loaded::loaded;
use super::systems::{branched, charged};
use super::tracked::{energies, signals, tracked};
use super::trunk;
use proboscis::System;
use proboscis::control::problem::{
    Afterwards, BoundaryState, Control, Duration, Objective, SoughtHold, TableEnd, Voltages,
};
use proboscis::math::Signal;

/// The list: voltages, loads, charges and motions of every kind of function, with costs, limits and energies that read them.
pub fn timed() -> Vec<Case> {
    let case = |name, system: System, change: &dyn Fn(&mut Control)| {
        let mut control = control(&system, 3);
        control.duration = Duration::Free {
            min: 10.0,
            max: 90.0,
            guess: 30.0,
        };
        change(&mut control);
        Case {
            name,
            system,
            control,
        }
    };
    let inputs = Objective {
        effort: 0.7,
        rate: 0.02,
        duration: 0.3,
        ..Objective::default()
    };
    let give = |c: &mut Control, sources: &[usize], mean: f64, size: f64| {
        let functions = signals(mean, size).into_iter().skip(1);
        c.given.extend(sources.iter().copied().zip(functions));
    };
    let moving = |joint: usize, kind: usize, mut system: System| {
        system.joints[joint].motion = Some(signals(0.1, 0.3)[kind].clone());
        system
    };
    vec![
        case("loads in time, free time", loaded(trunk(2)), &|c| {
            give(c, &[4, 5, 6], 0.3, 0.4);
            c.objective = inputs.clone();
        }),
        case(
            "all limits under voltages in time, free time",
            branched(),
            &|c| {
                give(c, &[1, 0], 900.0, 400.0);
                c.limits = all_limits();
                c.goal = joints(&[(1, 2.0)]);
                c.objective = Objective {
                    rate: 0.02,
                    energies: energies(&[(0, 2e3), (1, 3e3)], &[(1, 1e3), (2, 4e3)]),
                    ..tracked(&[0, 1], &[(0, true)])
                };
            },
        ),
        case("charge in time, free time", charged(), &|c| {
            give(c, &[0], 900.0, 400.0);
            give(c, &[4], 1e-4, 5e-5);
            c.objective = inputs.clone();
        }),
        case(
            "found hold under a voltage in time, free time",
            branched(),
            &|c| {
                // It ends before the shortest motion does.
                c.given.insert(2, Signal::ramp(900.0, 1300.0, 8.0));
                c.goal = joints(&[(1, 2.0)]);
                c.sought_hold = SoughtHold::Always;
                c.objective = inputs.clone();
            },
        ),
        case(
            "joint in time, all limits, free time",
            moving(0, 2, branched()),
            &|c| {
                c.start = joints(&[]);
                c.goal = BoundaryState::Free;
                c.limits = all_limits();
                c.objective = tracked(&[0, 1], &[(0, true), (1, false), (2, true)]);
            },
        ),
    ]
}

/// A function of each source that is constant in intervals which end at these times: a row for each interval, and one for the time afterwards.
pub fn in_steps(ends: &[f64], rows: &[Vec<f64>], afterwards: Afterwards) -> Voltages {
    let steps = |source: usize| Signal::Steps {
        ends: ends.to_vec(),
        values: rows.iter().map(|row| row[source]).collect(),
    };
    Voltages {
        signals: (0..rows[0].len()).map(steps).collect(),
        table: Some(TableEnd {
            time: ends[ends.len() - 1],
            afterwards,
            solution: None,
        }),
    }
}
