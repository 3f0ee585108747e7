//! The domain of the first-order dielectric: the stretch up to which its charge and stiffness keep their signs.
//!
//! Along a principal direction with stretch Λ the permittivity is ε_eff = −2c₁ − 2c₂ Λ² + ε J/Λ². Where c₂ > 0 it falls with
//! the stretch, and vanishes at
//!
//! ```text
//! Λ² = [−c₁ + √(c₁² + 2 c₂ ε J)]/(2 c₂)
//! ```

#![expect(non_snake_case, reason = "notation of the law")]

use crate::dynamics::trajectory::DiscreteTrajectory;
use crate::math::{Matrix, Vector, largest_eigenvalue_bound};
use crate::model::system::{ElectricConstants, Fidelity};
use crate::model::{Model, SolidBlock};
use nalgebra::SymmetricEigen;

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
    for (e, nodes) in block.solid.mesh.hexahedra.iter().enumerate() {
        let Some(electric) = block.material(e).electric else {
            continue;
        };
        let has_field = nodes.iter().any(|&n| potentials[n] != potentials[nodes[0]]);
        if !block.is_dielectric[e] || !has_field {
            continue;
        }
        let at = nodes.map(|n| x[block.vectors[n]]);
        for g in 0..8 {
            let F: Matrix = block.shapes[e].gradient_of(&at, g);
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
