//! Resolution of a motion by a step: the turns of joints and bodies, and the balance of energy.
//!
//! The midpoint rule reads forces at the middle of a step. What a joint or body does beyond that is seen at the ends alone:
//! a free turn by θ is found from sin θ = h ω, which has other roots beyond a right angle, and a joint angle is the same
//! after whole turns. Over a step the potential energy V changes by V(x₁) − V(x₀), while the forces at the middle do the work
//! −∇V(x̄)·(x₁ − x₀). Their sum is the energy that the step makes or loses, of third order in the step and exactly zero where V
//! is quadratic, however fast the oscillation. Voltages are constant within a step and supply nothing there; dissipation
//! takes as much as it does work. A Galerkin method of degree s sums the work of the forces by its quadrature, along its polynomial and, where
//! inputs change within the step, along the polynomial through them: the error is of order 2s + 1, and zero where V is quadratic too.

use crate::coordinates::Configuration;
use crate::dynamics::energies::Work;
use crate::dynamics::error::StepError;
use crate::functional::{Sample, TermKind};
use crate::math::Vector;
use crate::model::Model;
use std::f64::consts::PI;

/// Part of the energy exchanged in a step that may be made or lost in it.
const PART: f64 = 0.25;
/// Relative size of energies that is rounding.
const ROUNDING: f64 = 1e-9;

/// The energy of one step of the midpoint rule or a Galerkin method, in mJ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Energy that is made (or lost, where negative).
    made: f64,
    /// Energy in motion: kinetic at the middle, change of the potential, dissipation.
    exchanged: f64,
    /// Work of forces without a potential.
    work: Work,
    /// Size of the energies that were subtracted from each other, those of single elements included.
    size: f64,
}

/// A point of the quadrature over a step: its weight, what the terms read there and the forces on the vectors at both ends.
pub(super) type Part<'a> = (f64, Sample<'a>, &'a [Vec<Vector>; 2]);

impl Balance {
    /// Of a step from one end to the other, whose equations are a sum over some parts; `typical` is the energy of [`typical_energy`], `supplied`
    /// what inputs that change within the step add to the potential energy.
    pub(super) fn new<'a>(
        model: &Model,
        typical: f64,
        supplied: f64,
        ends: [Sample<'_>; 2],
        parts: impl Iterator<Item = Part<'a>>,
    ) -> Self {
        let terms = &model.action.intervals.terms;
        let (mut change, mut size) = (-supplied, 0.0_f64);
        for term in terms.iter().filter(|t| t.kind() == TermKind::Potential) {
            let [before, after] = ends.map(|end| term.energy(&end));
            change += after - before;
            size += before.abs() + after.abs();
        }
        let (mut kinetic, mut of_forces) = (0.0, 0.0);
        let mut work = Work::default();
        for (weight, sample, [a, b]) in parts {
            for term in terms {
                work.add(weight, term.as_ref(), &sample);
                if term.kind() == TermKind::Kinetic {
                    kinetic += weight * term.energy(&sample);
                }
            }
            let [start, end] = sample.vectors;
            let ways = start.iter().zip(end).map(|(x, y)| y - x);
            let done = ways
                .zip(a.iter().zip(b))
                .map(|(displacement, (a, b))| displacement.dot(&(a + b)));
            // The forces of an interval carry its length, those without a potential included.
            of_forces += weight * done.sum::<f64>() / sample.h;
        }
        let lost = of_forces - (work.applied + work.dissipation);
        Self {
            made: change + lost,
            exchanged: kinetic + change.abs() + work.applied.abs() + work.dissipation.abs(),
            size: typical + size + kinetic,
            work,
        }
    }

    /// Work of forces without a potential over the step.
    pub(super) fn work(&self) -> Work {
        self.work
    }

    /// Energy that the step makes, or loses where negative.
    pub(super) fn made(&self) -> f64 {
        self.made
    }

    /// Energy in motion during the step, at least what is rounding: at rest no other moves.
    pub(super) fn exchanged(&self) -> f64 {
        self.exchanged.max(ROUNDING * self.size)
    }

    /// Returns the reason why a step of `step` ms is not accepted: an element is crushed at its end, or the balance does not close. Forces that
    /// do not exist are not judged.
    pub(super) fn refusal(&self, model: &Model, time: f64, step: f64) -> Option<StepError> {
        let &Self {
            made, exchanged, ..
        } = self;
        if !self.size.is_finite() && !model.solids.is_empty() {
            return Some(StepError::Inverted { time, step });
        }
        let allowed = (PART * exchanged).max(ROUNDING * self.size);
        (made.abs() > allowed).then_some(StepError::Unbalanced {
            time,
            step,
            made,
            exchanged,
        })
    }
}

/// Energy in mJ that stretches all muscles and blocks of a system to some multiple of their size: the sum of shear modulus times
/// volume.
pub(super) fn typical_energy(model: &Model) -> f64 {
    let muscles = model.system.muscles.iter().map(|muscle| {
        let [width, depth] = muscle.cross_section;
        muscle.material.shear_modulus * width * depth * muscle.length()
    });
    let solids = model.system.solids.iter().map(|solid| {
        let volume = (0..3).map(|axis| {
            let along = solid.mesh.nodes.iter().map(|node| node[axis]);
            let ends = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = along.fold(ends, |(low, high), x| (low.min(x), high.max(x)));
            high - low
        });
        let moduli = solid.materials.iter().map(|m| m.shear_modulus);
        volume.product::<f64>() * moduli.fold(0.0, f64::max)
    });
    let components = model.system.components.iter();
    let components = components.map(|component| component.typical_energy());
    muscles.chain(solids).chain(components).sum()
}

/// The first joint that a step turns by more than half a turn, or body that it turns by more than a right angle in space,
/// between two placed instants; with the angle in rad.
pub(super) fn turned(
    model: &Model,
    start: &Configuration,
    end: &Configuration,
) -> Option<(String, f64)> {
    let map = &model.action.map;
    let of_joints = map.tree.as_ref().map_or(0, |tree| tree.coordinates());
    let turns = |&i: &usize| {
        let turn = (end.z[i] - start.z[i]).abs();
        (turn > PI || turn.is_nan()) && !model.is_length(i)
    };
    if let Some(i) = (0..of_joints).find(turns) {
        return Some((
            model.variables.unknown(i).to_string(),
            (end.z[i] - start.z[i]).abs(),
        ));
    }
    let bodies = &model.presolved.system.bodies;
    bodies.iter().enumerate().find_map(|(body, named)| {
        let [before, after] = [start, end].map(|at| map.directors(at, body));
        // 1 + 2 cos θ of the rotation from one to the other.
        let trace = before.dot(&after);
        let angle = (0.5 * (trace - 1.0)).clamp(-1.0, 1.0).acos();
        (trace < 1.0).then(|| (format!("body \"{}\"", named.name), angle))
    })
}
