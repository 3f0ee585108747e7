//! The contraction of a Newton iteration.

use super::{Contraction, Newton, Verdict};

/// Verdicts on updates `size · rateⁿ` of a tangent that is kept, up to the last one that is made.
fn verdicts(size: f64, rate: f64) -> Vec<Verdict> {
    let mut contraction = Contraction::new(Newton::Modified);
    let mut found = Vec::new();
    while !matches!(found.last(), Some(Verdict::Converged | Verdict::Astray)) {
        assert!(found.len() < 400, "{rate} does not end");
        let update = size * rate.powi(found.len() as i32);
        found.push(contraction.judge(update, !found.is_empty(), false));
    }
    found
}

/// The remainder after n updates of a geometric series is its sum from there on.
#[test]
fn it_has_converged_where_the_sum_of_all_later_updates_is_small() {
    for rate in [0.05, 0.3, 0.7, 0.9] {
        let found = verdicts(0.1, rate);
        let left = |updates: usize| 0.1 * rate.powi(updates as i32) / (1.0 - rate);
        assert!(found.len() > 5, "{rate}");
        assert!(
            left(found.len()) < 1e-10 && left(found.len() - 1) > 1e-10,
            "{rate}"
        );
        let slow = found.iter().filter(|v| **v == Verdict::Slow).count();
        assert_eq!(slow > 0, rate > 0.75, "{rate}");
        assert!(!found.contains(&Verdict::Astray));
    }
}

/// A solution by an iteration may leave a part of an update that the last ratio does not show.
#[test]
fn one_small_ratio_of_an_iteration_is_not_believed() {
    let judged = |mut contraction: Contraction| {
        contraction.judge(1e-4, false, false);
        contraction.judge(1e-9, true, false)
    };
    let newton = Newton::Modified;
    assert_eq!(judged(Contraction::new(newton)), Verdict::Converged);
    let cheap = Contraction::of_cheap_tangents(newton);
    assert_eq!(judged(cheap), Verdict::Shrinks);
}

/// Updates that shrink unevenly leave what the larger one of two ratios tells.
#[test]
fn one_small_ratio_among_others_of_a_kept_tangent_is_not_believed() {
    let judged = |updates: &[(f64, bool)]| {
        let mut contraction = Contraction::new(Newton::Modified);
        let verdicts = updates.iter();
        let verdicts = verdicts.map(|&(size, reused)| contraction.judge(size, reused, false));
        verdicts.collect::<Vec<_>>()
    };
    let [shrinks, end] = [Verdict::Shrinks, Verdict::Converged];
    let begun = [(1e-4, false), (5e-5, true)];
    // By its own ratio 2e-10 would leave 8e-16, by the one before 2e-10.
    let found = judged(&[begun[0], begun[1], (2e-10, true), (5e-11, true)]);
    assert_eq!(found, [shrinks, shrinks, shrinks, end]);
    let found = judged(&[begun[0], begun[1], (5e-11, true)]);
    assert_eq!(found, [shrinks, shrinks, end]);
    // A ratio says nothing of a tangent that is made anew, nor of the updates by it.
    let found = judged(&[begun[0], begun[1], (2e-10, false)]);
    assert_eq!(found, [shrinks, shrinks, end]);
    let found = judged(&[begun[0], begun[1], (2.5e-5, false), (2e-10, true)]);
    assert_eq!(found, [shrinks, shrinks, shrinks, end]);
}

#[test]
fn a_growing_update_of_an_old_tangent_is_not_made_far_from_the_solution() {
    assert_eq!(verdicts(0.1, 1.5), [Verdict::Shrinks, Verdict::Astray]);
    // With the new tangent it begins anew.
    let mut contraction = Contraction::new(Newton::Modified);
    contraction.judge(0.1, true, false);
    assert_eq!(contraction.judge(0.2, true, false), Verdict::Astray);
    assert_eq!(contraction.judge(0.4, false, false), Verdict::Shrinks);
    // A tangent of this point may lead to a longer update, and close to the solution rounding does.
    let mut contraction = Contraction::new(Newton::Full);
    contraction.judge(0.1, false, false);
    assert_eq!(contraction.judge(0.2, false, false), Verdict::Slow);
    let mut contraction = Contraction::new(Newton::Modified);
    contraction.judge(1e-5, true, false);
    assert_eq!(contraction.judge(2e-5, true, false), Verdict::Slow);
}
