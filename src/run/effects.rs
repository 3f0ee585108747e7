//! What a scene calls for, counted: elements, the unknowns each effect reads, and what it couples.

use serde::Serialize;

use crate::functional::{Couplings, Effect, Kind};
use crate::model::{Model, ModelError, Question};
use crate::reduction::Motion;

/// An effect and its size.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct EffectCounts {
    /// Name.
    pub name: String,
    /// `kinetic`, `potential`, `virtual work` or `constraint`.
    pub kind: &'static str,
    /// Elements.
    pub elements: usize,
    /// Coordinates of an instant, voltages and potentials that it reads.
    pub unknowns: usize,
    /// Equations that it adds: constraints at an instant, or Gauss's law for the potentials of an interval.
    pub equations: usize,
    /// Pairs of these unknowns that it couples at one instant.
    pub nonzeros: usize,
}

/// An effect with the pairs of unknowns it couples, the smaller of each pair first, sorted; coordinates by entry, scalars
/// of the site behind them.
struct Coupled {
    effect: Box<dyn Effect>,
    pairs: Vec<[u32; 2]>,
}

/// Counts of all effects of a model.
///
/// # Errors
/// None for a model that exists: the effects are made a second time from its system.
pub fn effect_counts(model: &Model) -> Result<Vec<EffectCounts>, ModelError> {
    let voltages = model.voltages.len();
    let mut counts = Vec::new();
    each(model, |coupled, motion| {
        counts.push(coupled.counts(motion.coordinates, voltages));
    })?;
    Ok(counts)
}

/// Names of the effects that couple two unknowns: coordinates by entry, scalars of the site behind them.
pub(super) fn coupling(model: &Model, i: usize, j: usize) -> Vec<String> {
    let pair = [i.min(j) as u32, i.max(j) as u32];
    let mut names = Vec::new();
    let found = each(model, |coupled, _| {
        if coupled.pairs.binary_search(&pair).is_ok() {
            names.push(coupled.effect.name().to_owned());
        }
    });
    found.map(|()| names).unwrap_or_default()
}

/// Shows the effects of a model one after the other.
fn each(model: &Model, mut show: impl FnMut(&Coupled, &Motion)) -> Result<(), ModelError> {
    let question = Question {
        coordinates: Some(model.coordinates),
        ..model.question.clone()
    };
    let copy = Model::answering(model.system.clone(), question)?;
    let motion = copy.action.motion;
    let (intervals, instants) = (copy.action.intervals.effects, copy.action.instants.effects);
    for effect in intervals.into_iter().chain(instants) {
        show(&Coupled::new(effect, &motion), &motion);
    }
    Ok(())
}

impl Coupled {
    fn new(mut effect: Box<dyn Effect>, motion: &Motion) -> Self {
        let mut couplings = Couplings::default();
        effect.couple(&mut couplings);
        let scalar = |s: usize| motion.coordinates + s;
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let mut add = |a: usize, b: usize| pairs.push([a.min(b) as u32, a.max(b) as u32]);
        // Pairs of vectors come in both orders.
        for &(a, b) in couplings.full.iter().filter(|(a, b)| a <= b) {
            let others = motion.support(b);
            for i in motion.support(a) {
                others.iter().for_each(|&j| add(i, j));
            }
        }
        for &(a, b) in couplings.isotropic.iter().filter(|(a, b)| a <= b) {
            // Directors and nodes couple component by component, joint coordinates all with all.
            let meets = |i, j| match (axis(motion, i), axis(motion, j)) {
                (Some(a), Some(b)) => a == b,
                _ => true,
            };
            let others = motion.support(b);
            for i in motion.support(a) {
                let others = others.iter().filter(|&&j| meets(i, j));
                others.for_each(|&j| add(i, j));
            }
        }
        for &(a, s) in &couplings.mixed {
            let support = motion.support(a).into_iter();
            support.for_each(|i| add(i, scalar(s)));
        }
        for &(s, t) in &couplings.scalars {
            add(scalar(s), scalar(t));
        }
        pairs.sort_unstable();
        pairs.dedup();
        Self { effect, pairs }
    }

    /// Its counts, where so many coordinates and voltages come before multipliers and potentials.
    fn counts(&self, coordinates: usize, voltages: usize) -> EffectCounts {
        let mut unknowns: Vec<u32> = self.pairs.iter().flatten().copied().collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let given = coordinates + voltages;
        let (kind, first) = match self.effect.kind() {
            Kind::Kinetic => ("kinetic", given),
            Kind::Potential => ("potential", given),
            Kind::VirtualWork => ("virtual work", given),
            Kind::Constraint => ("constraint", coordinates),
        };
        let equations = unknowns.iter().filter(|&&i| i as usize >= first);
        let diagonal = self.pairs.iter().filter(|[i, j]| i == j).count();
        EffectCounts {
            name: self.effect.name().to_owned(),
            kind,
            elements: self.effect.elements(),
            unknowns: unknowns.len(),
            equations: equations.count(),
            nonzeros: 2 * self.pairs.len() - diagonal,
        }
    }
}

/// Direction of a coordinate that moves along one; `None` for a joint's.
fn axis(motion: &Motion, i: usize) -> Option<usize> {
    match i.checked_sub(motion.of_bodies) {
        Some(of_node) => Some(motion.of_nodes[of_node].1),
        None => motion.tree.is_none().then_some(i % 3),
    }
}
