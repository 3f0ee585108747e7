//! An effect that a scene does not call for leaves no trace: variables, rows and nonzeros have closed forms, and numbers
//! are those of a scene in which the effect never existed.

use crate::common::cases::{control, rest_to_rest};
use crate::common::random::Random;
use crate::common::systems::{GRAVITY, branched};
use crate::common::tracked::{energies, tracked};
use crate::common::trunk;
use proboscis::control::problem::{BoundaryState, Control, Duration, Limit, Objective};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::math::Signal;
use proboscis::model::Coordinates;
use proboscis::model::system::{JointKind, System};
use proboscis::model::{FieldPlace, What};
use proboscis::nlp::Nlp;

/// Sizes of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Counts {
    variables: usize,
    rows: usize,
    jacobian: usize,
    hessian: usize,
}

pub(crate) fn with_program<T>(
    system: &System,
    control: &Control,
    read: impl FnOnce(&mut Transcription<'_>, Vec<f64>) -> T,
) -> T {
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let x = program.start(&initial).x;
    read(&mut program, x)
}

fn counts(system: &System, control: &Control) -> Counts {
    with_program(system, control, |program, x| Counts {
        variables: x.len(),
        rows: program.constraints().lower.len(),
        jacobian: program.jacobian_structure().rows.len(),
        hessian: program.hessian_structure().rows.len(),
    })
}

/// The trunk of n segments over N intervals, rest to rest: n angles at the N − 1 inner instants, 2n voltages in N intervals.
///
/// The last body makes every angle meet every other: n² entries in each of the blocks of equal and neighbouring instants.
/// The spans at joint i move with the angles 1 … i, so voltages meet 2 (1 + … + n) = n (n + 1) angles at each end.
fn closed_form(n: usize, intervals: usize) -> Counts {
    let (inner, pairs) = (intervals - 1, n * (n + 1));
    Counts {
        variables: inner * n + 2 * n * intervals,
        rows: n * (intervals + 1),
        // Rows k with z_{k−1}, z_k, z_{k+1}; the ends of each interval with its voltages.
        jacobian: 3 * inner * n * n + 2 * intervals * pairs,
        // Lower triangle of equal instants, all of neighbours, each voltage with the free end angles, and with itself.
        hessian: inner * pairs / 2 + (inner - 1) * n * n + 2 * inner * pairs + intervals * 2 * n,
    }
}

#[test]
fn the_trunk_has_its_closed_form() {
    for (n, intervals) in [(1, 5), (2, 4), (6, 40)] {
        let found = counts(&trunk(n), &rest_to_rest(n, intervals, 600.0));
        assert_eq!(
            found,
            closed_form(n, intervals),
            "{n} segments, {intervals} intervals"
        );
    }
    assert_eq!(
        (closed_form(6, 40).variables, closed_form(6, 40).rows),
        (714, 246)
    );
}

#[test]
fn the_redundant_trunk_has_its_closed_form() {
    for (n, intervals) in [(1, 5), (2, 4), (6, 40)] {
        let mut control = rest_to_rest(n, intervals, 600.0);
        control.coordinates = Some(Coordinates::Redundant);
        let found = counts(&trunk(n), &control);
        // 12 coordinates a body at inner instants; 6 multipliers a body and 5 a revolute joint at all instants.
        let (q, m) = (12 * n, 11 * n);
        assert_eq!(
            found.variables,
            (intervals - 1) * q + (intervals + 1) * m + intervals * 2 * n
        );
        // Balances at all instants, constraints where something is free.
        assert_eq!(found.rows, (intervals + 1) * q + (intervals - 1) * m);
        if n == 6 {
            assert_eq!((found.variables, found.rows), (5994, 5526));
        }
        if n == 1 {
            // One body on the ground. Both spans read its centre, d₃ and d₂ (the offset lies along x): these 9 coordinates
            // meet one another; d₁ meets itself by inertia alone (3). At an instant d₁ also meets d₂ and d₃ component by
            // component, by orthogonality (12).
            let (cross, same) = (81 + 3, 81 + 3 + 12);
            // Of 6 products of directors three read one, three two; the axis is fixed in the ground, so that each of 2 axis
            // rows reads one director of the body; each of 3 place rows has places for all of centre and d₃.
            let gradients = 3 * 3 + 3 * 6 + 2 * 3 + 3 * 6;
            let (inner, voltages) = (intervals - 1, 2 * 9);
            let jacobian = inner * (same + 2 * cross)
                + (intervals + 1) * gradients
                + inner * gradients
                + 2 * intervals * voltages;
            assert_eq!(found.jacobian, jacobian);
        }
    }
}

#[test]
fn effects_cost_what_they_add() {
    let (n, intervals) = (3, 6);
    let (system, base) = (trunk(n), rest_to_rest(n, intervals, 100.0));
    let plain = closed_form(n, intervals);
    let inner = intervals - 1;
    let change = |change: &dyn Fn(&mut System, &mut Control)| {
        let (mut system, mut control) = (system.clone(), base.clone());
        change(&mut system, &mut control);
        counts(&system, &control)
    };
    assert_eq!(change(&|_, _| {}), plain);
    // Linear in places: no second derivatives. Quadratic or of pairs that meet already: no new places.
    assert_eq!(change(&|s, _| s.gravity = Some(GRAVITY)), plain);
    assert_eq!(
        change(&|s, _| s.muscles.iter_mut().for_each(|m| m.section_inertia = true)),
        plain
    );
    assert_eq!(
        change(&|s, _| s.muscles.iter_mut().for_each(|m| m.material.density = None)),
        plain
    );
    assert_eq!(
        change(&|s, _| s
            .muscles
            .iter_mut()
            .for_each(|m| m.material.viscosity = None)),
        plain
    );
    assert_eq!(
        change(&|s, _| s.joints.iter_mut().for_each(|j| j.damping = Some(30.0))),
        plain
    );
    // A locked joint takes its angle away: a trunk of one joint less, with two spans on its last body, whose voltages meet
    // the angles that are left.
    let less = closed_form(n - 1, intervals);
    let met = 2 * (n - 1);
    let locked = Counts {
        variables: less.variables + 2 * intervals,
        rows: less.rows,
        jacobian: less.jacobian + 2 * intervals * met,
        hessian: less.hessian + 2 * inner * met + 2 * intervals,
    };
    assert_eq!(
        change(&|s, _| s.joints[n - 1].kind = JointKind::Fixed),
        locked
    );
    // A passive muscle at joint 2 takes its voltage away, which two angles at each end met.
    let passive = Counts {
        variables: plain.variables - intervals,
        rows: plain.rows,
        jacobian: plain.jacobian - 2 * intervals * 2,
        hessian: plain.hessian - 2 * inner * 2 - intervals,
    };
    assert_eq!(
        change(&|s, _| s.muscles[2].material.electric = None),
        passive
    );
    // The interval length: a column in all rows, a row of the Hessian.
    let free = Counts {
        variables: plain.variables + 1,
        rows: plain.rows,
        jacobian: plain.jacobian + plain.rows,
        hessian: plain.hessian + plain.variables + 1,
    };
    let span = Duration::Free {
        min: 10.0,
        max: 1e3,
        guess: 100.0,
    };
    assert_eq!(change(&|_, c| c.duration = span), free);
    // Differences of voltages: one place for each voltage of each interior jump.
    let rate = Counts {
        hessian: plain.hessian + inner * 2 * n,
        ..plain
    };
    assert_eq!(
        change(&|_, c| c.objective = Objective {
            rate: 1.0,
            ..c.objective.clone()
        }),
        rate
    );
    // The electrical energy: the same for the voltages of its sources. Coordinates and voltages meet in the energy of muscles.
    let electrical = Counts {
        hessian: plain.hessian + inner * 2,
        ..plain
    };
    assert_eq!(
        change(&|_, c| c.objective.energies = energies(&[(1, 1.0), (4, 1.0)], &[])),
        electrical
    );
    assert_eq!(
        change(&|_, c| c.objective.energies = energies(&[], &[(1, 1.0), (4, 1.0)])),
        plain
    );
    // What is followed couples coordinates of one instant, all of which inertia couples: no row, column or place is added.
    assert_eq!(
        change(&|_, c| c.objective = tracked(&[0], &[(1, true)])),
        plain
    );
    // Stretch of a muscle at joint 3 at the inner instants, read off three angles.
    let stretch = Counts {
        rows: plain.rows + inner,
        jacobian: plain.jacobian + 3 * inner,
        ..plain
    };
    let limit = Limit::new(What::Stretch(4), [0.5, 1.5]);
    assert_eq!(change(&|_, c| c.limits = vec![limit.clone()]), stretch);
    // Field of a muscle at joint 2: two angles at each end of each interval, or at one of them, and the voltage.
    let field = Counts {
        rows: plain.rows + 3 * intervals,
        jacobian: plain.jacobian + 2 * inner * 2 + 2 * inner * 2 + 3 * intervals,
        ..plain
    };
    let limit = Limit::below(What::Field(FieldPlace::Muscle(2)), 1e5);
    assert_eq!(change(&|_, c| c.limits = vec![limit.clone()]), field);
    // Joint limits are bounds of variables.
    let limit = Limit::new(
        What::Joint {
            joint: 1,
            near: 0.0,
        },
        [-1.0, 1.0],
    );
    assert_eq!(change(&|_, c| c.limits = vec![limit.clone()]), plain);
}

#[test]
fn a_limit_has_rows_where_something_is_open() {
    let (n, intervals) = (3, 6);
    let (system, mut base) = (trunk(n), rest_to_rest(n, intervals, 100.0));
    let limited = |base: &Control, limit: Limit| {
        let mut control = base.clone();
        control.limits = vec![limit];
        let (all, plain) = (counts(&system, &control), counts(&system, base));
        (all.rows - plain.rows, all.jacobian - plain.jacobian)
    };
    // A goal that leaves the last joint open: a muscle there is limited at the end too, one before it is not.
    let given = |joints: &[usize]| BoundaryState::JointAngles {
        angles: joints.iter().map(|&j| (j, 0.01)).collect(),
        rates: std::collections::BTreeMap::new(),
        velocities: Default::default(),
    };
    base.goal = given(&[0, 1]);
    let stretch = |muscle: usize| Limit::new(What::Stretch(muscle), [0.5, 1.5]);
    let inner = intervals - 1;
    assert_eq!(limited(&base, stretch(4)), (intervals, 3 * inner + 1));
    assert_eq!(limited(&base, stretch(2)), (inner, 2 * inner));
    // A voltage that is given leaves no row where start and goal give the places.
    base.goal = given(&[0, 1, 2]);
    base.given.insert(2, Signal::Constant(300.0));
    let field = Limit::below(What::Field(FieldPlace::Muscle(2)), 1e5);
    let rows = intervals + 2 * inner;
    assert_eq!(limited(&base, field), (rows, 8 * inner));
}

#[test]
fn a_given_voltage_is_no_unknown() {
    let (n, intervals) = (3, 6);
    let (system, base) = (trunk(n), rest_to_rest(n, intervals, 100.0));
    let plain = closed_form(n, intervals);
    // The voltage of a muscle at joint 2, which two angles at each end met.
    let without = Counts {
        variables: plain.variables - intervals,
        rows: plain.rows,
        jacobian: plain.jacobian - 2 * intervals * 2,
        hessian: plain.hessian - 2 * (intervals - 1) * 2 - intervals,
    };
    for volts in [0.0, 400.0] {
        let mut control = base.clone();
        control.given.insert(3, Signal::Constant(volts));
        assert_eq!(counts(&system, &control), without, "{volts} V");
    }
    // Its jumps are no places either.
    let mut control = base.clone();
    control.objective.rate = 1.0;
    control.given.insert(3, Signal::Constant(400.0));
    let hessian = without.hessian + (intervals - 1) * (2 * n - 1);
    assert_eq!(counts(&system, &control), Counts { hessian, ..without });
}

#[test]
fn equations_under_a_given_voltage_are_those_at_this_voltage() {
    let (system, base) = (branched(), control(&branched(), 3));
    let rows = |control: &Control| {
        with_program(&system, control, |program, mut x| {
            let mut random = Random(9);
            let names: Vec<String> = (0..x.len()).map(|i| program.variable_name(i)).collect();
            let scales: Vec<f64> = (0..x.len()).map(|i| program.column_scale(i)).collect();
            for ((x, name), scale) in x.iter_mut().zip(&names).zip(scales) {
                *x += 0.01 * random.unit();
                // One voltage in the unit of its variable, and what noise it took.
                if name.starts_with("voltage of stem to slider") {
                    *x = 750.0 / scale;
                }
                if name.starts_with("voltage of") {
                    random = Random(9);
                }
            }
            let mut g = vec![f64::NAN; program.constraints().lower.len()];
            program.constraint(&x, &mut g);
            let cost = program.objective(&x);
            let unscaled = |(r, g): (usize, f64)| g / program.row_scale(r);
            let rows: Vec<f64> = g.into_iter().enumerate().map(unscaled).collect();
            (x.len(), rows, cost)
        })
    };
    let mut given = base.clone();
    given.given.insert(1, Signal::Constant(750.0));
    let ((all, sought, cost), (fewer, prescribed, same_cost)) = (rows(&base), rows(&given));
    assert_eq!(fewer + 3, all);
    assert!(sought.iter().filter(|g| g.abs() > 1e-3).count() > 3);
    for (a, b) in sought.iter().zip(&prescribed) {
        assert!((a - b).abs() <= 1e-14 * (1.0 + a.abs()), "{a} {b}");
    }
    // A given voltage costs nothing; three intervals of 10 ms at 0.75 kV did.
    let less = 3.0 * 10e-3 * 0.75_f64.powi(2);
    assert!(same_cost > 0.0 && (cost - less - same_cost).abs() <= 1e-14 * cost);
}
