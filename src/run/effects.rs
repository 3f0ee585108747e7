//! What a scene calls for, counted: elements, the unknowns each effect reads, and what it couples.

use std::collections::HashSet;

use serde::Serialize;

use crate::functional::{Couplings, Effect, Kind};
use crate::model::{Model, ModelError};
use crate::reduction::Motion;

/// An effect and its size.
#[derive(Clone, Debug, Serialize)]
pub struct EffectCounts {
    /// Name.
    pub name: String,
    /// `kinetic`, `potential`, `virtual work` or `constraint`.
    pub kind: &'static str,
    /// Elements.
    pub elements: usize,
    /// Coordinates of an instant and voltages that it reads.
    pub unknowns: usize,
    /// Equations that it adds at an instant.
    pub equations: usize,
    /// Pairs of these unknowns that it couples at one instant.
    pub nonzeros: usize,
    /// The pairs; coordinates by entry, scalars of the site behind them.
    #[serde(skip)]
    pub pairs: HashSet<(usize, usize)>,
}

/// Counts of all effects of a model.
///
/// # Errors
/// None for a model that exists: the effects are made a second time from its system.
pub fn effect_counts(model: &Model) -> Result<Vec<EffectCounts>, ModelError> {
    let copy = Model::new(
        model.system.clone(),
        Some(model.coordinates),
        model.multiplier_time,
        &[],
    )?;
    let motion = copy.action.motion;
    let (intervals, instants) = (copy.action.intervals.effects, copy.action.instants.effects);
    let effects = intervals.into_iter().chain(instants);
    Ok(effects.map(|effect| counts(effect, &motion)).collect())
}

fn counts(mut effect: Box<dyn Effect>, motion: &Motion) -> EffectCounts {
    let mut couplings = Couplings::default();
    effect.couple(&mut couplings);
    let scalar = |s: usize| motion.coordinates + s;
    let mut pairs = HashSet::new();
    let mut add = |a: usize, b: usize| pairs.extend([(a, b), (b, a)]);
    for &(a, b) in &couplings.full {
        for i in motion.support(a) {
            motion.support(b).into_iter().for_each(|j| add(i, j));
        }
    }
    for &(a, b) in &couplings.isotropic {
        // Directors couple component by component, joint coordinates all with all.
        let meets = |i: usize, j: usize| motion.tree.is_some() || i % 3 == j % 3;
        for i in motion.support(a) {
            let others = motion.support(b).into_iter();
            others.filter(|&j| meets(i, j)).for_each(|j| add(i, j));
        }
    }
    for &(a, s) in &couplings.mixed {
        motion
            .support(a)
            .into_iter()
            .for_each(|i| add(i, scalar(s)));
    }
    for &(s, t) in &couplings.scalars {
        add(scalar(s), scalar(t));
    }
    let unknowns: HashSet<usize> = pairs.iter().map(|&(i, _)| i).collect();
    let is_constraint = effect.kind() == Kind::Constraint;
    let equations = unknowns.iter().filter(|&&i| i >= motion.coordinates);
    EffectCounts {
        name: effect.name().to_owned(),
        kind: match effect.kind() {
            Kind::Kinetic => "kinetic",
            Kind::Potential => "potential",
            Kind::VirtualWork => "virtual work",
            Kind::Constraint => "constraint",
        },
        elements: effect.elements(),
        unknowns: unknowns.len(),
        equations: if is_constraint { equations.count() } else { 0 },
        nonzeros: pairs.len(),
        pairs,
    }
}
