//! Singular configurations: lumped muscles of zero length, inverted elements, muscles and blocks beyond the limit of their law. Steps must
//! neither jump over such places nor end there.
//!
//! Forces are those at the middle of a step, which says nothing of its end: a span that turns by a right angle or more within
//! a step may have passed through zero, and an element that is sound in the middle may be crushed.
//!
//! The domain of the first-order dielectric: the stretch up to which its charge and stiffness keep their signs.
//!
//! Along a principal direction with stretch Λ the permittivity is ε_eff = −2c₁ − 2c₂ Λ² + ε J/Λ². Where c₂ > 0 it falls with
//! the stretch, and vanishes at
//!
//! ```text
//! Λ² = [−c₁ + √(c₁² + 2 c₂ ε J)]/(2 c₂)
//! ```

#![expect(non_snake_case, reason = "notation of the law")]

use crate::coordinates::Configuration;
use crate::dynamics::trajectory::DiscreteTrajectory;
use crate::functional::{Sample, TermKind};
use crate::math::{Vector, largest_eigenvalue_bound};
use crate::model::system::{ElasticLaw, ElectricConstants, Fidelity, Material, Muscle};
use crate::model::{Model, SolidBlock};
use nalgebra::SymmetricEigen;

/// Below this stretch a muscle is named where a step fails; pull-in of an ideal dielectric is at 0.63.
const SHORT: f64 = 0.5;

/// Part of the range of a law near whose ends a muscle is named where a step fails.
const NEAR: f64 = 0.3;

/// Stretch that counts as no length.
pub(super) const NOTHING: f64 = 1e-9;

/// The lumped muscles: index, and vector of the span.
fn lumped(model: &Model) -> impl Iterator<Item = (usize, usize)> + '_ {
    let muscles = model.system.muscles.iter().enumerate();
    muscles
        .filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped)
        .map(|(m, _)| (m, model.spans[m]))
}

/// The first lumped muscle whose span turns by a right angle or more from one placed instant to another.
pub(super) fn reversed(
    model: &Model,
    before: &Configuration,
    after: &Configuration,
) -> Option<usize> {
    let turns = |span: usize| before.x[span].dot(&after.x[span]) <= 0.0;
    lumped(model)
        .find(|&(_, span)| turns(span))
        .map(|(muscle, _)| muscle)
}

/// The shortest lumped muscle of a placed instant, if it is rather short: its name and its stretch.
pub(super) fn shortest<'m>(model: &'m Model, at: &Configuration) -> Option<(&'m str, f64)> {
    let all = lumped(model).map(|(m, span)| {
        let muscle = &model.system.muscles[m];
        (muscle.name.as_str(), at.x[span].norm() / muscle.length())
    });
    let short = all.filter(|(_, s)| *s < SHORT);
    short.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// A lumped muscle or block that has no energy by its law at coordinates, or a muscle whose ends meet there, in words.
pub fn part_without_energy(model: &Model, coordinates: &[f64]) -> Option<String> {
    let instant = model.action.map.placed(coordinates);
    let without_length = || {
        let (name, stretch) = shortest(model, &instant)?;
        (stretch < NOTHING)
            .then(|| format!("the ends of muscle \"{name}\" meet there, where it has no energy"))
    };
    beyond_law(model, &instant).or_else(without_length)
}

/// Words on a lumped muscle at a stretch within a part of the range of its law, from 0 at its ends to 1 at rest, or beyond; `None` elsewhere.
fn muscle_at_limit(muscle: &Muscle, stretch: f64, part: f64) -> Option<String> {
    let [low, high] = muscle.material.law?.stretches()?;
    let is_inside = low + part * (1.0 - low) < stretch && stretch < high - part * (high - 1.0);
    let name = &muscle.name;
    (!is_inside).then(|| format!(
        "muscle \"{name}\" has the stretch {stretch:.4}; Gent's limit leaves its law an energy between {low:.4} and {high:.4} only"
    ))
}

/// Words on a muscle that has no energy at a stretch.
pub fn muscle_beyond_law(muscle: &Muscle, stretch: f64) -> Option<String> {
    muscle_at_limit(muscle, stretch, 0.0)
}

/// Words on a block with its nodes at `x` within the same part of Jₘ, or beyond.
fn block_at_limit(block: &SolidBlock, x: &[Vector], part: f64) -> Option<String> {
    let has_limit = |material: &Material| matches!(material.law, Some(ElasticLaw::Gent { .. }));
    if !block.solid.materials.iter().any(has_limit) {
        return None;
    }
    let strain = |element: usize, limit: f64| {
        let [points, _] = block.strains();
        let points = (0..points).map(|g| {
            let gradient = block.deformation(element, g, x);
            gradient.norm_squared() * gradient.determinant().powf(-2.0 / 3.0) - 3.0
        });
        (points.fold(f64::NEG_INFINITY, f64::max), limit)
    };
    let elements =
        (0..block.solid.mesh.element_count()).filter_map(|e| match block.material(e).law? {
            ElasticLaw::Gent { limit } => Some(strain(e, limit)),
            _ => None,
        });
    let (strain, limit) = elements.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
    let name = &block.solid.name;
    (strain >= (1.0 - part) * limit).then(|| format!(
        "block \"{name}\" has I1 - 3 = {strain:.4} at a Gauss point; Gent's limit leaves its law an energy below {limit} only"
    ))
}

/// Words on the first lumped muscle or block of a placed instant that is within a part of the range of its law, from 0 at its ends to 1 at rest, or
/// beyond.
fn at_limit(model: &Model, at: &Configuration, part: f64) -> Option<String> {
    let muscle = lumped(model).find_map(|(m, span)| {
        let muscle = &model.system.muscles[m];
        muscle_at_limit(muscle, at.x[span].norm() / muscle.length(), part)
    });
    let mut blocks = model.solids.iter();
    muscle.or_else(|| blocks.find_map(|block| block_at_limit(block, &at.x, part)))
}

/// Words on the first lumped muscle or block of a placed instant that has no energy by its law.
pub(super) fn beyond_law(model: &Model, at: &Configuration) -> Option<String> {
    at_limit(model, at, 0.0)
}

/// Words on the first lumped muscle or block of a placed instant to which a step that fails there is laid, as the limit of its law is near.
pub(super) fn near_limit(model: &Model, at: &Configuration) -> Option<String> {
    at_limit(model, at, NEAR)
}

/// Returns true if an elastic block has no energy at a placed instant: an element is inverted.
pub(super) fn is_inverted(model: &Model, at: &Configuration, scalars: &[f64]) -> bool {
    if model.solids.is_empty() {
        return false;
    }
    let interval = Sample::of_interval(scalars, 1.0);
    let sample = interval.between([at, at]);
    let mut terms = model.action.intervals.terms.iter();
    terms.any(|e| e.kind() == TermKind::Potential && !e.energy(&sample).is_finite())
}

/// The first interval of a motion in which the span of a lumped muscle turns by a right angle or more, and the muscle.
pub fn reversed_muscle(model: &Model, discrete: &DiscreteTrajectory) -> Option<(usize, usize)> {
    let map = &model.action.map;
    let mut pairs = discrete.z.windows(2).enumerate();
    pairs.find_map(|(k, ends)| {
        let muscle = reversed(model, &map.placed(&ends[0]), &map.placed(&ends[1]))?;
        Some((k, muscle))
    })
}

/// The greatest voltage in V, where forces without a value are laid to numbers and not to an inverted element: there is none, or the square of
/// the voltage is not finite.
pub(super) fn overflow(model: &Model, scalars: &[f64]) -> Option<f64> {
    let voltages = scalars.get(model.variables.inputs()).unwrap_or_default();
    let greatest = voltages.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let is_beyond = !greatest.powi(2).is_finite();
    (model.solids.is_empty() || is_beyond).then_some(greatest)
}

/// A muscle or block that leaves the domain under voltage.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfDomain {
    /// The muscle or block.
    pub name: String,
    /// Largest stretch.
    pub stretch: f64,
    /// End of the domain, at the volume of that place.
    pub limit: f64,
    /// Instant of the largest stretch in ms.
    pub time: f64,
    /// First instant outside in ms.
    pub first: f64,
}

/// Stretch at which the permittivity along it vanishes where the volume is J times the reference volume; `None` where it does
/// not, or is not even positive at rest.
pub fn largest_stretch(electric: &ElectricConstants, J: f64) -> Option<f64> {
    let ElectricConstants {
        c1,
        c2,
        permittivity,
    } = *electric;
    if c2 <= 0.0 || permittivity - 2.0 * c1 - 2.0 * c2 <= 0.0 {
        return None;
    }
    let square = (-c1 + (c1 * c1 + 2.0 * c2 * permittivity * J).sqrt()) / (2.0 * c2);
    Some(square.sqrt())
}

/// Returns the parts that leave the domain at the instants of a motion, in the order of muscles and blocks. The voltages of an instant are
/// those of the interval that ends there.
pub fn out_of_domain(model: &Model, discrete: &DiscreteTrajectory) -> Vec<OutOfDomain> {
    let muscles = model.system.muscles.iter().enumerate();
    let lumped: Vec<Watched<'_>> = muscles
        .filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped)
        .filter_map(|(m, muscle)| {
            let limit = largest_stretch(muscle.material.electric.as_ref()?, 1.0)?;
            let scalar = model.variables.input(m)?;
            let of = Of::Muscle {
                span: model.spans[m],
                length: muscle.length(),
                scalar,
                limit,
            };
            Some(Watched::new(&muscle.name, of))
        })
        .collect();
    let blocks = model.solids.iter().filter(|block| {
        let electric = block.solid.materials.iter().filter_map(|m| m.electric);
        block.is_dielectric.contains(&true)
            && electric
                .into_iter()
                .any(|e| largest_stretch(&e, 1.0).is_some())
    });
    let blocks = blocks.map(|block| Watched::new(&block.solid.name, Of::Block(block)));
    let mut watched: Vec<Watched<'_>> = lumped.into_iter().chain(blocks).collect();
    if watched.is_empty() {
        return Vec::new();
    }
    let mut instant = model.action.map.instant();
    for (k, z) in discrete.z.iter().enumerate() {
        let Some(scalars) = discrete.scalars.get(k.saturating_sub(1)) else {
            continue;
        };
        instant.z.copy_from_slice(z);
        model.action.map.vectors(&mut instant);
        for one in &mut watched {
            one.look(&instant.x, scalars, discrete.times[k]);
        }
    }
    watched.into_iter().filter_map(|one| one.found).collect()
}

/// A muscle or block that may leave the domain.
struct Watched<'m> {
    name: &'m str,
    of: Of<'m>,
    found: Option<OutOfDomain>,
}

enum Of<'m> {
    Muscle {
        span: usize,
        length: f64,
        scalar: usize,
        limit: f64,
    },
    Block(&'m SolidBlock),
}

impl<'m> Watched<'m> {
    fn new(name: &'m str, of: Of<'m>) -> Self {
        Self {
            name,
            of,
            found: None,
        }
    }

    /// Looks at an instant.
    fn look(&mut self, x: &[Vector], scalars: &[f64], time: f64) {
        let worst = match &self.of {
            &Of::Muscle {
                span,
                length,
                scalar,
                limit,
            } => {
                let stretch = x[span].norm() / length;
                (scalars[scalar] != 0.0 && stretch > limit).then_some((stretch, limit))
            }
            Of::Block(block) => worst_of_block(block, x, scalars),
        };
        let Some((stretch, limit)) = worst else {
            return;
        };
        let first = self.found.as_ref().map_or(time, |found| found.first);
        if self
            .found
            .as_ref()
            .is_none_or(|found| found.stretch < stretch)
        {
            self.found = Some(OutOfDomain {
                name: self.name.to_owned(),
                stretch,
                limit,
                time,
                first,
            });
        }
    }
}

/// The largest principal stretch at the Gauss points of the elements outside the domain that have a field, and its limit.
fn worst_of_block(block: &SolidBlock, x: &[Vector], scalars: &[f64]) -> Option<(f64, f64)> {
    let potentials = block.potentials(scalars);
    let mut worst: Option<(f64, f64)> = None;
    for (e, nodes) in block.solid.mesh.elements().enumerate() {
        let Some(electric) = block.material(e).electric else {
            continue;
        };
        let has_field = nodes.iter().any(|&n| potentials[n] != potentials[nodes[0]]);
        if !block.is_dielectric[e] || !has_field {
            continue;
        }
        for g in 0..8 {
            let F = block.deformation(e, g, x);
            let Some(limit) = largest_stretch(&electric, F.determinant()) else {
                continue;
            };
            let C = F.transpose() * F;
            if largest_eigenvalue_bound(&C) <= limit * limit {
                continue;
            }
            let stretch = SymmetricEigen::new(C).eigenvalues.max().sqrt();
            if stretch > limit && worst.is_none_or(|(before, _)| before < stretch) {
                worst = Some((stretch, limit));
            }
        }
    }
    worst
}

/// Part of a stretch that is not told: that of rounding, and of rests that are found to a tolerance.
const SLACK: f64 = 1e-3;

/// A muscle beyond the range of its material.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfRange {
    /// The muscle.
    pub name: String,
    /// Smallest and largest stretch for which the constants hold.
    pub range: [f64; 2],
    /// Stretch that is furthest beyond, by its ratio to the end of the range.
    pub stretch: f64,
    /// Instant of this stretch in ms.
    pub time: f64,
}

/// Returns the muscles that leave the ranges of their materials at the instants of a motion.
pub fn out_of_range(model: &Model, discrete: &DiscreteTrajectory) -> Vec<OutOfRange> {
    let muscles = model.system.muscles.iter().enumerate();
    let mut watched: Vec<_> = muscles
        .filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped)
        .filter_map(|(m, muscle)| {
            let range = muscle.material.stretch_range?;
            let none = OutOfRange {
                name: muscle.name.clone(),
                range,
                stretch: 1.0,
                time: 0.0,
            };
            Some((model.spans[m], muscle.length(), 1.0 + SLACK, none))
        })
        .collect();
    if watched.is_empty() {
        return Vec::new();
    }
    let mut instant = model.action.map.instant();
    for (z, &time) in discrete.z.iter().zip(&discrete.times) {
        instant.z.copy_from_slice(z);
        model.action.map.vectors(&mut instant);
        for (span, length, furthest, found) in &mut watched {
            let stretch = instant.x[*span].norm() / *length;
            let [low, high] = found.range;
            let beyond = (low / stretch).max(stretch / high);
            if beyond > *furthest {
                *furthest = beyond;
                (found.stretch, found.time) = (stretch, time);
            }
        }
    }
    let is_beyond = |furthest: f64| furthest > 1.0 + SLACK;
    let watched = watched.into_iter();
    watched
        .filter_map(|(_, _, furthest, found)| is_beyond(furthest).then_some(found))
        .collect()
}
