//! Limits and costs of the volume of muscles as free parameters decide it: the multiplier is the slope of the least effort by the bound.

use crate::common::cases::joints;
use crate::motions::{motion, together};
use crate::optimality::{Optimum, solve};
use crate::sought::{arm, pair, turn};
use proboscis::control::problem::{Control, CostFunction, During, Limit, QuantityCost};
use proboscis::control::{BoundaryConditions, BoundaryError, Row};
use proboscis::ipopt::Start;
use proboscis::model::system::System;
use proboscis::model::{Amount, Constant, Follower, Parameter, Quantity, Role, What};
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Both muscles are 10 mm thick and 40 mm long.
const PER_WIDTH: f64 = 2.0 * 10.0 * 40.0;

fn width() -> Parameter {
    let sides = [0, 1].map(|muscle| Follower::from(Constant::Side(muscle, 0)));
    Parameter {
        name: "width".into(),
        constants: sides.to_vec(),
        lower: 2.0,
        upper: 60.0,
        guess: 10.0,
    }
}

fn volume(min: f64, max: f64) -> Limit {
    Limit::new(
        What::Amount {
            muscles: Arc::from([0, 1]),
            amount: Amount::Volume,
        },
        [min, max],
    )
}

/// Least effort with a sought arm and width, and limits.
fn designed(system: &System, limits: &[Limit]) -> Control {
    Control {
        parameters: vec![arm([4.0, 60.0], 15.0), width()],
        limits: limits.to_vec(),
        ..turn(system)
    }
}

/// The arm and the width that were found.
fn found(optimum: &Optimum) -> [f64; 2] {
    assert!(optimum.solution.status.is_solved());
    // The second condition is that of equations.
    let [stationary, _, complementary, signs] = optimum.conditions;
    let conditions = [stationary, complementary, signs];
    assert!(conditions.iter().all(|c| *c < 1e-7), "{conditions:?}");
    let first = optimum.model.variables.range(Role::Parameter).start;
    let scalars = &optimum.discrete.scalars[0];
    [scalars[first], scalars[first + 1]]
}

#[test]
fn a_bound_of_the_volume_is_kept_and_its_multiplier_is_the_slope_of_the_effort() {
    let system = pair();
    let free = solve(&system, &designed(&system, &[]), None, Start::Cold);
    let [_, best] = found(&free);
    // Unlimited, the muscles take all the width that they may have.
    assert!((best / 60.0 - 1.0).abs() < 1e-6, "{best}");
    let most = 0.3 * best * PER_WIDTH;
    let with = |limit: Limit| {
        let from = Some((&free.discrete, free.h, None));
        solve(&system, &designed(&system, &[limit]), from, Start::PRIMAL)
    };
    let limited = with(volume(f64::NEG_INFINITY, most));
    let [_, narrow] = found(&limited);
    let effort = |optimum: &Optimum| optimum.solution.objective;
    println!(
        "widths {best} {narrow}, efforts {} {}",
        effort(&free),
        effort(&limited)
    );
    assert!((narrow * PER_WIDTH / most - 1.0).abs() < 1e-8, "{narrow}");
    assert!(effort(&limited) > 1.001 * effort(&free));
    // The row is V/V_max ≤ 1: its multiplier y is −V_max d effort/dV_max.
    let is_limit = |row: &Row| matches!(row, Row::Limit { .. });
    let row = limited.rows.iter().position(is_limit).expect("a row");
    assert_eq!(limited.rows.iter().filter(|row| is_limit(row)).count(), 1);
    let multiplier = limited.solution.costates.constraints[row];
    let step = 1e-4;
    let [less, more] = [1.0 - step, 1.0 + step].map(|part| {
        let moved = with(volume(f64::NEG_INFINITY, part * most));
        found(&moved);
        effort(&moved)
    });
    let slope = (more - less) / (2.0 * step);
    assert!(multiplier > 1e-3 * effort(&limited), "{multiplier}");
    assert!(
        (multiplier + slope).abs() < 1e-5 * multiplier,
        "{multiplier} {slope}"
    );
    let given = 0.4 * best * PER_WIDTH;
    let [_, prescribed] = found(&with(volume(given, given)));
    assert!(
        (prescribed * PER_WIDTH / given - 1.0).abs() < 1e-8,
        "{prescribed}"
    );
    // As a cost with the weight of the multiplier the volume has the same optimum.
    let costly = |factor: f64, limits: &[Limit]| {
        let mut control = designed(&system, limits);
        control.objective.quantities.push(QuantityCost {
            quantity: Quantity::of(What::Amount {
                muscles: Arc::from([0, 1]),
                amount: Amount::Volume,
            })
            .in_unit(1e3),
            weight: factor * multiplier / (most / 1e3),
            function: CostFunction::Itself,
            during: During::End,
        });
        control
    };
    let paid = |factor: f64, limits: &[Limit]| {
        let from = Some((&limited.discrete, limited.h, None));
        found(&solve(
            &system,
            &costly(factor, limits),
            from,
            Start::PRIMAL,
        ))[1]
    };
    // With the values that were found put in, the volume is no cost that anything changes: it is simulated all the same.
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let control = costly(1.0, &[]);
    let simulated = optimise(&system, &control, None, SolveLimits::default(), &mut go_on).unwrap();
    assert!(simulated.resimulation.is_some());
    assert!((paid(1.0, &[]) / narrow - 1.0).abs() < 1e-6);
    // At three times the price there is less of it, down to a lower bound.
    assert!(paid(3.0, &[]) < 0.9 * narrow);
    let least = volume(0.95 * most, f64::INFINITY);
    let kept = paid(3.0, &[least]) / narrow;
    assert!((kept - 0.95).abs() < 1e-6, "{kept}");
}

#[test]
fn motions_with_one_design_have_one_row() {
    let system = pair();
    let control = |angle: f64, limits: &[Limit]| Control {
        goal: joints(&[(0, angle)]),
        ..designed(&system, limits)
    };
    let limit = [volume(f64::NEG_INFINITY, 9.0 * PER_WIDTH)];
    let of = |second: &[Limit], system_of_second: &System| {
        let first = motion("far", &system, control(0.2, &limit));
        let near = motion("near", system_of_second, control(-0.1, second));
        together(vec![first, near], &[])
    };
    let both = of(&limit, &system);
    let one = of(&[], &system);
    assert_eq!(both.whole.constraints, one.whole.constraints);
    assert_eq!(
        both.whole.objective.to_bits(),
        one.whole.objective.to_bits()
    );
    let width = |optimum: &proboscis::workflow::Optimum| optimum.motion.parameters[1].value;
    assert!(
        both.optima
            .iter()
            .all(|o| (width(o) / 9.0 - 1.0).abs() < 1e-8)
    );
    // Of another material it is the same volume, of another thickness another one.
    let mut soft = system.clone();
    soft.muscles[0].material.shear_modulus *= 0.9;
    assert_eq!(of(&limit, &soft).whole.constraints, one.whole.constraints);
    let mut thin = system.clone();
    thin.muscles[0].cross_section[1] *= 0.9;
    assert_eq!(
        of(&limit, &thin).whole.constraints,
        one.whole.constraints + 1
    );
}

#[test]
fn a_given_volume_keeps_its_limit_without_a_row_or_is_refused() {
    let system = pair();
    let with = |limit: Limit| Control {
        parameters: vec![],
        ..designed(&system, &[limit])
    };
    let resolve = |control: &Control| BoundaryConditions::resolve(&system, control, 5.0);
    let kept = solve(
        &system,
        &with(volume(1.0, 10.0 * PER_WIDTH)),
        None,
        Start::Cold,
    );
    assert!(!kept.rows.iter().any(|row| matches!(row, Row::Limit { .. })));
    let refused = resolve(&with(volume(1.0, 9.0 * PER_WIDTH)));
    let Err(BoundaryError::Refused { place, reason }) = refused else {
        panic!("{refused:?}");
    };
    assert_eq!(place, "limits");
    let told = "volume of 2 muscles is 8.0000 cm^3, and its limit is at most 7.2000 cm^3; no free parameter changes it";
    assert_eq!(reason, told);
    let mut paid = turn(&system);
    paid.objective.quantities.push(QuantityCost {
        quantity: Quantity::of(What::Amount {
            muscles: Arc::from([1]),
            amount: Amount::Volume,
        })
        .in_unit(1e3),
        weight: 1.0,
        function: CostFunction::Itself,
        during: During::End,
    });
    let Err(BoundaryError::Refused { place, reason }) = resolve(&paid) else {
        panic!("a cost of what is given");
    };
    assert_eq!(place, "objective");
    assert_eq!(reason, "no free parameter changes the volume of muscle2");
}

/// A limit that an iterate breaks, and that free parameters may keep, is none of a problem without these.
#[test]
fn an_iterate_beyond_the_limit_of_a_volume_is_no_mistake_of_the_problem() {
    let system = pair();
    let most = 0.9 * 10.0 * PER_WIDTH;
    let control = designed(&system, &[volume(f64::NEG_INFINITY, most)]);
    let run = |iterations: usize| {
        let limits = SolveLimits {
            iterations: Some(iterations),
            seconds: None,
        };
        let mut each = |_: &Iterate<'_>| ControlFlow::Continue(());
        optimise(&system, &control, None, limits, &mut each).expect("a point")
    };
    let begun = run(0);
    assert_eq!(begun.word(), "iteration_limit");
    let width = |found: &proboscis::workflow::Optimum| found.motion.parameters[1].value;
    assert!(width(&begun) * PER_WIDTH > 1.05 * most);
    let whole = run(200);
    assert!(whole.is_solved() && width(&whole) * PER_WIDTH < most * (1.0 + 1e-6));
}
