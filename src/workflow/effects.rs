//! Model terms and their sizes: elements, the unknowns that each term reads, and the pairs that it couples.

use rayon::slice::ParallelSliceMut;
use serde::Serialize;

use crate::control::problem::Control;
use crate::coordinates::CoordinateMap;
use crate::functional::{Coupling, Term, TermKind};
use crate::math::has_pool;
use crate::model::{Model, Time, Variable};
use crate::workflow::reasons::{self, Absent, absent};
use crate::workflow::stopwatch;

/// An effect and its size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectCounts {
    /// Name.
    pub name: String,
    /// `kinetic`, `potential`, `virtual work` or `constraint`.
    pub kind: &'static str,
    /// Entries of scene and problem that need it.
    pub why: String,
    /// Elements.
    pub elements: usize,
    /// Coordinates of an instant, voltages and potentials that it reads.
    pub unknowns: usize,
    /// Equations that it adds: constraints at an instant, or Gauss's law for the potentials of an interval.
    pub equations: usize,
    /// Pairs of these unknowns that it couples at one instant.
    pub nonzeros: usize,
    /// Entries that it touches: of the program's Jacobian in an inner interval of a control problem, otherwise of the tangent
    /// of a step or of a state of rest.
    pub jacobian: usize,
    /// Entries of the lower triangle of the program's Hessian that it touches in an inner interval; only of a control problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hessian: Option<usize>,
    /// Time of one evaluation with second derivatives in µs, as measured here.
    pub microseconds: f64,
}

/// Terms of a model, and the absent ones.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Plan {
    /// Effects that scene and problem call for.
    pub effects: Vec<EffectCounts>,
    /// Terms that they do not need.
    pub absent: Vec<Absent>,
}

impl Plan {
    /// The plan of a model, each effect measured for `spent` seconds or one evaluation.
    pub fn from_model(model: &Model, control: Option<&Control>, spent: f64) -> Self {
        Self {
            effects: effect_counts(model, control, spent),
            absent: absent(model, control),
        }
    }

    /// The plan of a model without control whose effects are not counted.
    pub fn uncounted(model: &Model) -> Self {
        Self {
            effects: Vec::new(),
            absent: absent(model, None),
        }
    }
}

/// Matrix in which the pairs of an effect are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Matrix {
    /// Jacobian and Hessian of a program.
    Program,
    /// The tangent of a step.
    Step,
    /// The tangent of a state of rest.
    Rest,
}

/// An effect with the pairs of unknowns it couples, the smaller of each pair first, sorted; coordinates by entry, scalars
/// of the site behind them.
struct Coupled<'a> {
    effect: &'a dyn Term,
    pairs: Vec<[u32; 2]>,
}

/// Counts of all effects of a model, each measured for `spent` seconds or one evaluation; of a control problem in its
/// program, otherwise in the tangent.
pub fn effect_counts(model: &Model, control: Option<&Control>, spent: f64) -> Vec<EffectCounts> {
    let matrix = match (control, model.analysis.of_motion) {
        (Some(_), _) => Matrix::Program,
        (None, true) => Matrix::Step,
        (None, false) => Matrix::Rest,
    };
    let scalar = |variable: &Variable| {
        let has_equation = variable.role.has_equation();
        let is_unknown = match control {
            Some(control) => variable
                .source
                .is_none_or(|source| !control.is_given(source)),
            None => has_equation,
        };
        Scalar {
            has_equation,
            is_unknown,
        }
    };
    let unknowns = Unknowns {
        coordinates: model.coordinate_count(),
        scalars: model
            .variables
            .of(Time::Interval)
            .iter()
            .map(scalar)
            .collect(),
        multipliers: model.action.instants.scalars,
        matrix,
    };
    let times = stopwatch::times(model, spent);
    let count = |(coupled, microseconds): (Coupled<'_>, f64)| {
        let count = coupled.counts(&unknowns);
        EffectCounts {
            why: reasons::why(&count.name, model),
            microseconds,
            ..count
        }
    };
    each(model).zip(times).map(count).collect()
}

/// Unknowns of the matrix.
struct Unknowns {
    /// Number of coordinates.
    coordinates: usize,
    /// Scalars of an interval.
    scalars: Vec<Scalar>,
    /// Number of multipliers of an instant.
    multipliers: usize,
    matrix: Matrix,
}

/// Role of a scalar of an interval in the matrix.
#[derive(Clone, Copy)]
struct Scalar {
    has_equation: bool,
    is_unknown: bool,
}

/// Names of the effects that couple two unknowns: coordinates by entry, scalars of the site behind them.
pub fn coupling(model: &Model, i: usize, j: usize) -> Vec<String> {
    let pair = [i.min(j) as u32, i.max(j) as u32];
    let couple = each(model).filter(|coupled| coupled.pairs.binary_search(&pair).is_ok());
    couple.map(|c| c.effect.name().to_owned()).collect()
}

/// The effects of a model one after the other.
fn each(model: &Model) -> impl Iterator<Item = Coupled<'_>> {
    let sums = [&model.action.intervals, &model.action.instants];
    let effects = sums.into_iter().flat_map(|sum| &sum.terms);
    effects.map(|effect| Coupled::new(effect.as_ref(), &model.action.map))
}

impl<'a> Coupled<'a> {
    fn new(effect: &'a dyn Term, map: &CoordinateMap) -> Self {
        let mut couplings = Vec::new();
        effect.couple(&mut |coupling| couplings.extend(coupling.map(ordered)));
        couplings.sort_unstable();
        couplings.dedup();
        let supports: Vec<Vec<usize>> = (0..map.vectors.len()).map(|v| map.support(v)).collect();
        let scalar = |s: usize| map.coordinates + s;
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let mut add = |a: usize, b: usize| pairs.push([a.min(b) as u32, a.max(b) as u32]);
        // Directors and nodes couple component by component, joint coordinates all with all.
        let meets = |i, j| match (axis(map, i), axis(map, j)) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        for coupling in couplings {
            match coupling {
                Coupling::Full(a, b) => {
                    for &i in &supports[a] {
                        supports[b].iter().for_each(|&j| add(i, j));
                    }
                }
                Coupling::Isotropic(a, b) => {
                    for &i in &supports[a] {
                        let others = supports[b].iter().filter(|&&j| meets(i, j));
                        others.for_each(|&j| add(i, j));
                    }
                }
                Coupling::Mixed(a, s) => supports[a].iter().for_each(|&i| add(i, scalar(s))),
                Coupling::Scalars(s, t) => add(scalar(s), scalar(t)),
            }
        }
        let key = |&[i, j]: &[u32; 2]| u64::from(i) << u32::BITS | u64::from(j);
        match has_pool() {
            true => pairs.par_sort_unstable_by_key(key),
            false => pairs.sort_unstable_by_key(key),
        }
        pairs.dedup();
        Self { effect, pairs }
    }

    /// Its counts, without reason and time.
    fn counts(&self, of: &Unknowns) -> EffectCounts {
        let mut is_read = vec![false; of.coordinates + of.scalars.len().max(of.multipliers)];
        for &unknown in self.pairs.as_flattened() {
            is_read[unknown as usize] = true;
        }
        let kind = match self.effect.kind() {
            TermKind::Kinetic => "kinetic",
            TermKind::Potential => "potential",
            TermKind::AppliedWork | TermKind::Dissipation => "virtual work",
            TermKind::Constraint => "constraint",
        };
        let is_of_instant = self.effect.kind() == TermKind::Constraint;
        let scalars = is_read[of.coordinates..].iter().enumerate();
        let equations = scalars
            .filter(|&(s, is_read)| *is_read && (is_of_instant || of.scalars[s].has_equation));
        let diagonal = self.pairs.iter().filter(|[i, j]| i == j).count();
        let touched = self.pairs.iter().map(|pair| self.touched(pair, of));
        let [jacobian, hessian] = touched.fold([0, 0], |[a, b], [c, d]| [a + c, b + d]);
        EffectCounts {
            name: self.effect.name().to_owned(),
            kind,
            why: String::new(),
            elements: self.effect.elements(),
            unknowns: is_read.iter().filter(|is_read| **is_read).count(),
            equations: equations.count(),
            nonzeros: 2 * self.pairs.len() - diagonal,
            jacobian,
            hessian: (of.matrix == Matrix::Program).then_some(hessian),
            microseconds: f64::NAN,
        }
    }

    /// Entries of Jacobian and Hessian that a pair of unknowns touches in an inner interval, its first instant included.
    fn touched(&self, &[i, j]: &[u32; 2], of: &Unknowns) -> [usize; 2] {
        let (i, j) = (i as usize, j as usize);
        let both_orders = if i == j { 1 } else { 2 };
        let is_instantaneous = self.effect.kind() == TermKind::Constraint;
        if is_instantaneous {
            // A multiplier has a column in the balances of its instant, its constraint a row in the coordinates.
            let is_pair_of_coordinates = j < of.coordinates;
            return match (is_pair_of_coordinates, of.matrix) {
                (true, Matrix::Program | Matrix::Rest) => [both_orders, 1],
                // The curvature of a constraint at the end of a step belongs to the next one.
                (true, Matrix::Step) => [0, 0],
                (false, _) => [2, 1],
            };
        }
        let scalar = |i: usize| Some(of.scalars[i.checked_sub(of.coordinates)?]);
        // A program has the balances of an instant with the instants before, here and after, and an interval has two ends.
        let (balances, ends) = match of.matrix {
            Matrix::Program => (3, 2),
            Matrix::Step | Matrix::Rest => (1, 1),
        };
        match (scalar(i), scalar(j)) {
            (None, None) => [balances * both_orders, 1 + both_orders],
            (None, Some(s)) if s.is_unknown => {
                let rows = if s.has_equation { 2 } else { 1 };
                [ends * rows, 2]
            }
            (Some(s), Some(t)) if s.is_unknown && t.is_unknown => {
                let rows = usize::from(s.has_equation) + usize::from(i != j && t.has_equation);
                [rows, 1]
            }
            _ => [0, 0],
        }
    }
}

/// A coupling with its vectors, or its scalars, in ascending order.
fn ordered(coupling: Coupling) -> Coupling {
    match coupling {
        Coupling::Full(a, b) => Coupling::Full(a.min(b), a.max(b)),
        Coupling::Isotropic(a, b) => Coupling::Isotropic(a.min(b), a.max(b)),
        Coupling::Scalars(s, t) => Coupling::Scalars(s.min(t), s.max(t)),
        Coupling::Mixed(..) => coupling,
    }
}

/// Direction of a coordinate that moves along one; `None` for a joint's.
fn axis(map: &CoordinateMap, i: usize) -> Option<usize> {
    match i.checked_sub(map.of_bodies) {
        Some(of_node) => map.of_nodes.get(of_node).map(|&(_, axis)| axis),
        None => map.tree.is_none().then_some(i % 3),
    }
}
