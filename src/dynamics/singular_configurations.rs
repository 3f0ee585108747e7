//! Singular configurations: lumped muscles of zero length, inverted elements, muscles and blocks beyond the limit of their law. Steps must
//! neither jump over such places nor end there.
//!
//! Forces are those at the middle of a step, which says nothing of its end: a span that turns by a right angle or more within
//! a step may have passed through zero, and an element that is sound in the middle may be crushed.

use crate::coordinates::{Configuration, Interval};
use crate::dynamics::trajectory::DiscreteTrajectory;
use crate::functional::TermKind;
use crate::math::Vector;
use crate::model::system::{ElasticLaw, Fidelity, Material, Muscle};
use crate::model::{Model, SolidBlock};
use std::fmt;

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

/// The shortest lumped muscle of a placed instant, if it is rather short: its index and its stretch.
pub(super) fn shortest(model: &Model, at: &Configuration) -> Option<(usize, f64)> {
    let stretch = |(m, span): (usize, usize)| {
        let length = model.system.muscles[m].length();
        (m, at.x[span].norm() / length)
    };
    let short = lumped(model).map(stretch).filter(|(_, s)| *s < SHORT);
    short.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The first lumped muscle whose ends meet at coordinates.
pub fn muscle_without_length(model: &Model, coordinates: &[f64]) -> Option<usize> {
    let instant = model.action.map.placed(coordinates);
    let (muscle, stretch) = shortest(model, &instant)?;
    (stretch < NOTHING).then_some(muscle)
}

/// A lumped muscle or a block that Gent's law leaves no energy.
#[derive(Clone, Debug, PartialEq)]
pub enum BeyondLaw {
    /// A lumped muscle.
    Muscle {
        /// Its name.
        name: String,
        /// Its stretch.
        stretch: f64,
        /// Stretches between which there is an energy.
        range: [f64; 2],
    },
    /// A block of finite elements.
    Block {
        /// Its name.
        name: String,
        /// Greatest Ī₁ − 3 at its Gauss points.
        strain: f64,
        /// Jₘ, below which there is an energy.
        limit: f64,
    },
}

impl BeyondLaw {
    /// Of a muscle at a stretch within a part of the range of its law, from 0 at its ends to 1 at rest, or beyond; `None` elsewhere.
    fn within(muscle: &Muscle, stretch: f64, part: f64) -> Option<Self> {
        let [low, high] = muscle.material.law?.stretches()?;
        let is_inside = low + part * (1.0 - low) < stretch && stretch < high - part * (high - 1.0);
        (!is_inside).then(|| Self::Muscle {
            name: muscle.name.clone(),
            stretch,
            range: [low, high],
        })
    }

    /// Of a muscle that has no energy at a stretch.
    pub fn at(muscle: &Muscle, stretch: f64) -> Option<Self> {
        Self::within(muscle, stretch, 0.0)
    }

    /// Of a block with its nodes at `x` within the same part of Jₘ, or beyond.
    fn of_block(block: &SolidBlock, x: &[Vector], part: f64) -> Option<Self> {
        let has_limit = |material: &Material| matches!(material.law, Some(ElasticLaw::Gent { .. }));
        if !block.solid.materials.iter().any(has_limit) {
            return None;
        }
        let strain = |element: usize, limit: f64| {
            let nodes = block.nodes(element).map(|v| x[v]);
            let shape = &block.shapes[element];
            let points = (0..shape.weights().len()).map(|g| {
                let gradient = shape.gradient_of(&nodes, g);
                gradient.norm_squared() * gradient.determinant().powf(-2.0 / 3.0) - 3.0
            });
            (points.fold(f64::NEG_INFINITY, f64::max), limit)
        };
        let elements = (0..block.shapes.len()).filter_map(|e| match block.material(e).law? {
            ElasticLaw::Gent { limit } => Some(strain(e, limit)),
            _ => None,
        });
        let (strain, limit) = elements.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)))?;
        (strain >= (1.0 - part) * limit).then(|| Self::Block {
            name: block.solid.name.clone(),
            strain,
            limit,
        })
    }
}

impl fmt::Display for BeyondLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Muscle {
                name,
                stretch,
                range: [low, high],
            } => write!(
                f,
                "muscle \"{name}\" has the stretch {stretch:.4}; Gent's limit leaves its law an energy between {low:.4} and {high:.4} only"
            ),
            Self::Block {
                name,
                strain,
                limit,
            } => write!(
                f,
                "block \"{name}\" has I1 - 3 = {strain:.4} at a Gauss point; Gent's limit leaves its law an energy below {limit} only"
            ),
        }
    }
}

/// The first lumped muscle or block of a placed instant that is within a part of the range of its law, from 0 at its ends to 1 at rest, or
/// beyond.
fn at_limit(model: &Model, at: &Configuration, part: f64) -> Option<BeyondLaw> {
    let muscle = lumped(model).find_map(|(m, span)| {
        let muscle = &model.system.muscles[m];
        BeyondLaw::within(muscle, at.x[span].norm() / muscle.length(), part)
    });
    let mut blocks = model.solids.iter();
    muscle.or_else(|| blocks.find_map(|block| BeyondLaw::of_block(block, &at.x, part)))
}

/// The first lumped muscle or block of a placed instant that has no energy by its law.
pub(super) fn beyond_law(model: &Model, at: &Configuration) -> Option<BeyondLaw> {
    at_limit(model, at, 0.0)
}

/// The first lumped muscle or block of a placed instant to which a step that fails there is laid, as the limit of its law is near.
pub(super) fn near_limit(model: &Model, at: &Configuration) -> Option<BeyondLaw> {
    at_limit(model, at, NEAR)
}

/// The first lumped muscle or block that has no energy by its law at coordinates.
pub fn part_beyond_law(model: &Model, coordinates: &[f64]) -> Option<BeyondLaw> {
    beyond_law(model, &model.action.map.placed(coordinates))
}

/// Returns true if an elastic block has no energy at a placed instant: an element is inverted.
pub(super) fn is_inverted(model: &Model, at: &Configuration, scalars: &[f64]) -> bool {
    if model.solids.is_empty() {
        return false;
    }
    let interval = Interval::given(scalars, 1.0);
    let sample = interval.sample([at, at]);
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
