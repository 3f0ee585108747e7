//! A list of control problems that together call for every effect, joint, limit, goal and objective.

use super::ends::ends;
pub use super::limited::{all_limits, charge_limits, gaps, tension};
use super::measuring::measuring;
use super::pairs::pairs;
use super::remembering::{remembering, remembering_blocks};
use super::systems::{
    GRAVITY, ball, blocks, branched, charged, loaded, pressed, satellite, sprung, stiffening,
    stiffening_blocks, tied, touching, touching_blocks, touching_shapes,
};
use super::timed::timed;
use super::tracked::{energies, tracked};
use super::trunk;
use nalgebra::Vector3;
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Guess, Limit, Objective, Orientation, Place, Rest, Solver,
    SoughtHold,
};
use proboscis::math::Signal;
use proboscis::model::Coordinates;
use proboscis::model::system::{ElectricConstants, Material, System, VACUUM_PERMITTIVITY};
use proboscis::model::{FieldPlace, Pulling, What};
use std::collections::BTreeMap;

/// A system and what is asked of it.
pub struct Case {
    /// For messages.
    pub name: &'static str,
    /// The system.
    pub system: System,
    /// The problem, in reduced coordinates.
    pub control: Control,
}

/// The joint coordinates of a goal.
pub fn joints(list: &[(usize, f64)]) -> BoundaryState {
    BoundaryState::JointAngles {
        angles: list.iter().copied().collect(),
        rates: BTreeMap::new(),
        velocities: Default::default(),
    }
}

/// Least effort from rest without voltages over `intervals` intervals of 10 ms; joint coordinates are free at the end.
pub fn control(system: &System, intervals: usize) -> Control {
    Control {
        duration: Duration::Given(10.0 * intervals as f64),
        intervals,
        input_intervals: 1,
        is_refined: false,
        varied: Vec::new(),
        outcomes: Vec::new(),
        start: BoundaryState::RestAtVoltages(vec![0.0; system.sources().len()], Rest::Everything),
        goal: joints(&[]),
        voltage_bounds: [0.0, 3000.0],
        load_bounds: BTreeMap::new(),
        given: BTreeMap::new(),
        course: None,
        parameters: Vec::new(),
        continues: [false; 2],
        sought_hold: SoughtHold::default(),
        hold: Default::default(),
        objective: Objective {
            effort: 1.0,
            ..Objective::default()
        },
        limits: Vec::new(),
        waypoints: Vec::new(),
        coordinates: Some(Coordinates::Reduced),
        guess: Guess::Interpolate,
        solver: Solver {
            tolerance: 1e-10,
            max_iterations: 500,
            linear_solver: Default::default(),
            ipopt: BTreeMap::new(),
        },
    }
}

/// Rest at the voltages that the reference trunk is held with.
pub fn hold(segments: usize) -> Vec<f64> {
    let pair = |i: usize| {
        if i.is_multiple_of(2) {
            [0.0, 1700.0]
        } else {
            [1600.0, 0.0]
        }
    };
    (0..segments).flat_map(pair).collect()
}

/// Motion from rest without voltages to rest at the hold voltages.
pub fn rest_to_rest(segments: usize, intervals: usize, duration: f64) -> Control {
    Control {
        duration: Duration::Given(duration),
        goal: BoundaryState::RestAtVoltages(hold(segments), Rest::Everything),
        ..control(&trunk(segments), intervals)
    }
}

/// The marker of the block at a place, at rest, while the rest of the block may still move.
fn corner_goal() -> BoundaryState {
    BoundaryState::Markers {
        places: BTreeMap::from([(1, Vector3::new(10.0, 60.0, 39.5).into())]),
        orientations: BTreeMap::new(),
        rest: Rest::Bodies,
        hold: None,
    }
}

/// Parts of places of markers and orientations of bodies, at rest.
pub fn partly(
    markers: &[(usize, [Option<f64>; 3])],
    bodies: &[(usize, Orientation)],
) -> BoundaryState {
    let places = markers
        .iter()
        .map(|&(marker, place)| (marker, Place(place)));
    BoundaryState::Markers {
        places: places.collect(),
        orientations: bodies.iter().copied().collect(),
        rest: Rest::Everything,
        hold: None,
    }
}

/// A direction fixed to a body that points to an oblique one.
pub fn direction() -> Orientation {
    Orientation::Towards {
        axis: Vector3::y(),
        towards: Vector3::new(0.2, 0.95, -0.1).normalize(),
    }
}

/// Nothing is asked of the nodes at the end: all their coordinates are free, and no balance closes the last instant.
pub fn open_end() -> BoundaryState {
    BoundaryState::Markers {
        places: BTreeMap::new(),
        orientations: BTreeMap::new(),
        rest: Rest::Bodies,
        hold: None,
    }
}

/// Limits of the tensions of a spring and a tendon.
fn pulls() -> Vec<Limit> {
    let tension = |part, bounds| Limit::new(What::Tension(part), bounds);
    vec![
        tension(Pulling::Spring(0), [-3.0, 2.0]),
        tension(Pulling::Tendon(0), [f64::NEG_INFINITY, 4.0]),
    ]
}

/// The list.
pub fn cases() -> Vec<Case> {
    let case = |name, system: System, change: &dyn Fn(&mut Control)| {
        let mut control = control(&system, 3);
        change(&mut control);
        Case {
            name,
            system,
            control,
        }
    };
    let with = |change: &dyn Fn(&mut System), mut system: System| {
        change(&mut system);
        system
    };
    let materials = |change: &dyn Fn(&mut Material), system: &mut System| {
        for muscle in &mut system.muscles {
            change(&mut muscle.material);
        }
    };
    let free = Duration::Free {
        min: 10.0,
        max: 90.0,
        guess: 30.0,
    };
    let every_objective = || Objective {
        effort: 0.7,
        rate: 0.02,
        duration: 0.3,
        ..Objective::default()
    };
    let mut list = vec![
        case("pair at rest", trunk(1), &|c| {
            c.goal = BoundaryState::RestAtVoltages(hold(1), Rest::Everything);
        }),
        case("two segments", trunk(2), &|_| {}),
        case("three segments, smooth", trunk(3), &|c| {
            c.goal = BoundaryState::RestAtVoltages(hold(3), Rest::Everything);
            c.objective = Objective {
                rate: 0.3,
                ..Objective::default()
            };
        }),
        case(
            "gravity and section inertia, free time",
            with(
                &|s| {
                    s.gravity = Some(GRAVITY);
                    s.muscles.iter_mut().for_each(|m| m.section_inertia = true);
                },
                trunk(2),
            ),
            &|c| {
                c.duration = free;
                c.objective = every_objective();
            },
        ),
        case(
            "ideal dielectric without mass and viscosity",
            with(
                &|s| {
                    materials(
                        &|m| {
                            m.density = None;
                            m.viscosity = None;
                            m.electric = Some(ElectricConstants {
                                c1: 0.0,
                                c2: 0.0,
                                permittivity: 5.0 * VACUUM_PERMITTIVITY,
                            });
                        },
                        s,
                    );
                },
                trunk(2),
            ),
            &|c| c.goal = joints(&[(1, 0.2)]),
        ),
        case("loads", loaded(trunk(2)), &|_| {}),
        case("loads, free time", loaded(trunk(2)), &|c| {
            c.duration = free;
            c.objective.rate = 0.3;
        }),
        case("springs and a tendon", tied(trunk(2)), &|_| {}),
        case("springs and a tendon, tensions", tied(trunk(2)), &|c| {
            c.limits = pulls();
            c.objective = every_objective();
        }),
        case(
            "springs and a tendon, tensions, free time",
            tied(trunk(2)),
            &|c| {
                c.limits = pulls();
                c.objective = every_objective();
                c.duration = free;
            },
        ),
        case("springs and a tendon, free time", tied(trunk(2)), &|c| {
            c.duration = free;
            c.objective = every_objective();
        }),
        case(
            "a tendon that grows taut",
            with(
                &|s| s.components.tendons[0].smoothing = 100.0,
                tied(trunk(2)),
            ),
            &|_| {},
        ),
        case("contacts", touching(trunk(2)), &|_| {}),
        case("contacts, free time", touching(trunk(2)), &|c| {
            c.duration = free;
            c.objective = every_objective();
        }),
        case("contacts of shapes", touching_shapes(trunk(2)), &|_| {}),
        case(
            "contacts of shapes, free time",
            touching_shapes(trunk(2)),
            &|c| {
                c.duration = free;
                c.limits = gaps();
            },
        ),
        case("branched tree", branched(), &|_| {}),
        case("branched tree with joint springs", sprung(), &|_| {}),
        case("branched tree that remembers", remembering(), &|c| {
            c.limits = vec![tension(0), tension(2)];
        }),
        case("branched tree that stiffens", stiffening(), &|c| {
            c.limits = vec![tension(0), tension(1), tension(3)];
        }),
        case("charges", charged(), &|c| {
            c.objective.energies = energies(&[(0, 2e3)], &[]);
            c.load_bounds.insert(4, [1e-5, 3e-4]);
        }),
        case("charges, free time", charged(), &|c| {
            c.duration = free;
            c.objective.rate = 0.3;
            c.objective.energies = energies(&[(0, 2e3), (2, 3e3)], &[(2, 1e3)]);
            c.given.insert(4, Signal::Constant(1e-4));
        }),
        case("charges as inputs, all limits", charged(), &|c| {
            c.load_bounds.insert(4, [1e-5, 3e-4]);
            c.limits = charge_limits();
        }),
        case("charges, all limits, free time", charged(), &|c| {
            c.duration = free;
            c.limits = charge_limits();
            c.given.insert(0, Signal::Constant(500.0));
            c.given.insert(4, Signal::Constant(1e-4));
        }),
        case(
            "branched tree that remembers, free time",
            remembering(),
            &|c| {
                c.duration = free;
                c.objective = every_objective();
                c.goal = joints(&[(1, 2.0)]);
                c.limits = vec![tension(0), tension(2)];
            },
        ),
        case(
            "branched tree with joint springs, free time",
            sprung(),
            &|c| {
                c.duration = free;
                c.objective = every_objective();
                c.goal = joints(&[(1, 2.0)]);
            },
        ),
        case("blocks that stiffen", stiffening_blocks(), &|c| {
            c.goal = corner_goal();
        }),
        case("blocks that remember", remembering_blocks(), &|c| {
            c.goal = open_end();
        }),
        case("blocks, marker at rest", blocks(), &|c| {
            c.goal = corner_goal();
        }),
        case("blocks that touch", touching_blocks(), &|c| {
            c.goal = corner_goal();
            c.limits = gaps();
        }),
        case("blocks with loads", pressed(), &|c| c.goal = corner_goal()),
        case("blocks with loads, free time", pressed(), &|c| {
            (c.duration, c.goal) = (free, corner_goal());
        }),
        case("blocks, marker at rest, free time", blocks(), &|c| {
            c.duration = free;
            c.objective = Objective {
                quantities: tracked(&[1], &[]).quantities,
                ..every_objective()
            };
            let field = |block: usize, region: Option<usize>| {
                Limit::below(What::Field(FieldPlace::Block { block, region }), 1e4)
            };
            c.limits = vec![
                Limit::new(What::Stretch(0), [0.7, 1.2]),
                field(0, Some(0)),
                field(1, None),
            ];
            c.goal = corner_goal();
        }),
        case("branched tree, free time", branched(), &|c| {
            c.duration = free;
            c.objective = every_objective();
        }),
        case("branched tree, all limits", branched(), &|c| {
            c.limits = all_limits();
        }),
        case("branched tree, all limits, free time", branched(), &|c| {
            c.limits = all_limits();
            c.duration = free;
            c.objective = every_objective();
            c.goal = joints(&[(1, 2.0)]);
        }),
        case("branched tree that follows", branched(), &|c| {
            c.objective = tracked(&[0, 1], &[(0, true), (1, false), (2, true)]);
        }),
        case("branched tree that follows, free time", branched(), &|c| {
            c.objective = tracked(&[0, 1], &[(0, true), (1, false), (2, true)]);
            c.duration = free;
        }),
        case("branched tree, energies, all limits", branched(), &|c| {
            c.objective = Objective {
                energies: energies(&[(0, 2e3), (1, 3e3)], &[(1, 1e3), (2, 4e3)]),
                ..tracked(&[0], &[(0, true)])
            };
            c.limits = all_limits();
        }),
        case("two segments, energies, free time", trunk(2), &|c| {
            c.objective = Objective {
                energies: energies(&[(0, 1e3), (3, 2e3)], &[(0, 2e3)]),
                ..every_objective()
            };
            c.goal = BoundaryState::RestAtVoltages(hold(2), Rest::Everything);
            c.duration = free;
        }),
        case("branched tree, free end", branched(), &|c| {
            c.objective = tracked(&[0], &[(0, true)]);
            c.goal = BoundaryState::Free;
        }),
        case(
            "branched tree, part of a place and a direction",
            branched(),
            &|c| {
                c.goal = partly(&[(0, [None, Some(128.0), None])], &[(1, direction())]);
            },
        ),
        case("satellite, orientation, free time", satellite(), &|c| {
            let axis = Vector3::new(0.48, 0.6, 0.64);
            let turned = Orientation::Turned { axis, angle: 0.3 };
            c.start = joints(&[(0, 0.1)]);
            c.goal = partly(&[], &[(0, turned)]);
            c.duration = free;
        }),
        case("ball in a socket", ball(), &|c| {
            c.start = joints(&[(1, 0.2)]);
            c.goal = joints(&[(1, 0.3), (2, -0.2)]);
        }),
        case("universal, cylindrical, planar", pairs(), &|c| {
            c.start = joints(&[]);
            c.goal = partly(&[(0, [None, Some(70.0), None])], &[]);
            c.duration = free;
        }),
        case("satellite, free time", satellite(), &|c| {
            c.start = joints(&[(0, 0.1)]);
            c.duration = free;
            c.objective = every_objective();
        }),
        case("branched tree to a marker", branched(), &|c| {
            c.goal = BoundaryState::Markers {
                places: BTreeMap::from([(0, Vector3::new(25.0, 128.0, 12.0).into())]),
                orientations: BTreeMap::new(),
                rest: Rest::Everything,
                hold: None,
            };
        }),
    ];
    list.extend(ends());
    list.extend(measuring());
    list.extend(timed());
    list
}
