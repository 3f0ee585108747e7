//! Pairs of unknowns that terms couple, against a list of all of them.

use crate::presolved::each_plan;
use proboscis::coordinates::Dependence;
use proboscis::functional::{Coupling, Term};
use proboscis::model::Model;
use proboscis::workflow::coupling;
use std::collections::BTreeSet;

/// Pairs of unknowns that a term couples, from each of its couplings: coordinates by entry, scalars behind them.
fn pairs(model: &Model, term: &dyn Term) -> BTreeSet<[usize; 2]> {
    let map = &model.action.map;
    let of = |vector: usize| -> Vec<(usize, Option<usize>)> {
        match &map.vectors[vector] {
            Dependence::Linear { parts, .. } => {
                parts.iter().map(|p| (p.coordinate, Some(p.axis))).collect()
            }
            Dependence::Articulated(_) => {
                map.support(vector).into_iter().map(|i| (i, None)).collect()
            }
        }
    };
    let scalar = |s: usize| vec![(map.coordinates + s, None)];
    let mut found = BTreeSet::new();
    term.couple(&mut |coupling| {
        let (rows, columns, by_axis) = match coupling {
            None => return,
            Some(Coupling::Full(a, b)) => (of(a), of(b), false),
            Some(Coupling::Isotropic(a, b)) => (of(a), of(b), true),
            Some(Coupling::Mixed(a, s)) => (of(a), scalar(s), false),
            Some(Coupling::Scalars(s, t)) => (scalar(s), scalar(t), false),
        };
        for &(i, along) in &rows {
            for &(j, other) in &columns {
                if !by_axis || along.is_none() || other.is_none() || along == other {
                    found.insert([i.min(j), i.max(j)]);
                }
            }
        }
    });
    found
}

#[test]
fn pairs_of_unknowns_are_counted_once() {
    let mut coupled = 0;
    each_plan(|name, model, plan| {
        let sums = [&model.action.intervals, &model.action.instants];
        let terms = sums.into_iter().flat_map(|sum| &sum.terms);
        assert_eq!(terms.clone().count(), plan.effects.len());
        for (term, effect) in terms.zip(&plan.effects) {
            let pairs = pairs(model, term.as_ref());
            let diagonal = pairs.iter().filter(|[i, j]| i == j).count();
            let read: BTreeSet<usize> = pairs.iter().flatten().copied().collect();
            let expected = (read.len(), 2 * pairs.len() - diagonal);
            let found = (effect.unknowns, effect.nonzeros);
            assert_eq!(found, expected, "{} of {}", effect.name, name);
            let [first, last] = [pairs.first(), pairs.last()];
            for [i, j] in first.into_iter().chain(last) {
                assert!(coupling(model, *j, *i).contains(&effect.name));
            }
            coupled += pairs.len();
        }
    });
    assert!(coupled > 10_000, "{coupled}");
}
