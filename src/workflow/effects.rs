//! Model terms and their sizes: elements, the unknowns that each term reads, and the pairs that it couples.
//!
//! Pairs of unknowns that an effect couples: coordinates by entry, scalars of the site behind them. They are found unknown by unknown, so that
//! no list of all has to be sorted.

use crate::control::problem::Control;
use crate::coordinates::CoordinateMap;
use crate::functional::{Coupling, Functional, Order, Sample, Term, TermKind};
use crate::model::{Model, Time, Variable};
use crate::workflow::reasons;
use crate::workflow::reasons::{Absent, absent};
use serde::Serialize;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

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
    /// Time of one evaluation with second derivatives in µs, as measured here; of more than 100 000 elements that of a part, multiplied.
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
    let scalars = model.variables.of(Time::Interval);
    let unknowns = Unknowns {
        coordinates: model.coordinate_count(),
        scalars: scalars.iter().map(scalar).collect(),
        matrix,
    };
    let times = measured_times(model, spent);
    let arguments = arguments(model);
    let counts = each(model).zip(times).map(|(effect, microseconds)| {
        let coupled = Coupled::new(effect, &arguments);
        let count = unknowns.counts(&coupled, &arguments);
        EffectCounts {
            why: reasons::why(&count.name, model),
            microseconds,
            ..count
        }
    });
    counts.collect()
}

/// Unknowns of the matrix.
struct Unknowns {
    /// Number of coordinates.
    coordinates: usize,
    /// Scalars of an interval.
    scalars: Vec<Scalar>,
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
    let arguments = arguments(model);
    let couple =
        each(model).filter(|effect| Coupled::new(*effect, &arguments).couples(&arguments, [i, j]));
    couple.map(|effect| effect.name().to_owned()).collect()
}

/// The effects of a model one after the other.
fn each(model: &Model) -> impl Iterator<Item = &dyn Term> {
    let sums = [&model.action.intervals, &model.action.instants];
    sums.into_iter()
        .flat_map(|sum| &sum.terms)
        .map(|effect| effect.as_ref())
}

/// Vectors and scalars of both sites.
fn arguments(model: &Model) -> Arguments<'_> {
    let [of_interval, of_instant] =
        [&model.action.intervals, &model.action.instants].map(|sum| sum.scalars);
    Arguments::new(&model.action.map, of_interval.max(of_instant))
}

impl Unknowns {
    /// Counts of an effect, without reason and time.
    fn counts(&self, coupled: &Coupled<'_>, arguments: &Arguments<'_>) -> EffectCounts {
        let effect = coupled.effect;
        let mut is_read = vec![false; arguments.count()];
        let [mut pairs, mut diagonal, mut jacobian, mut hessian] = [0; 4];
        coupled.each_pair(arguments, |i, j| {
            (is_read[i], is_read[j]) = (true, true);
            let touched = self.touched(effect, [i, j]);
            pairs += 1;
            diagonal += usize::from(i == j);
            jacobian += touched[0];
            hessian += touched[1];
        });
        let kind = match effect.kind() {
            TermKind::Kinetic => "kinetic",
            TermKind::Potential => "potential",
            TermKind::AppliedWork | TermKind::Dissipation => "virtual work",
            TermKind::Constraint => "constraint",
        };
        let is_of_instant = effect.kind() == TermKind::Constraint;
        let scalars = is_read[self.coordinates..].iter().enumerate();
        let equations = scalars
            .filter(|&(s, is_read)| *is_read && (is_of_instant || self.scalars[s].has_equation));
        EffectCounts {
            name: effect.name().to_owned(),
            kind,
            why: String::new(),
            elements: effect.elements(),
            unknowns: is_read.iter().filter(|is_read| **is_read).count(),
            equations: equations.count(),
            nonzeros: 2 * pairs - diagonal,
            jacobian,
            hessian: (self.matrix == Matrix::Program).then_some(hessian),
            microseconds: f64::NAN,
        }
    }

    /// Entries of Jacobian and Hessian that a pair of unknowns touches in an inner interval, its first instant included.
    fn touched(&self, effect: &dyn Term, [i, j]: [usize; 2]) -> [usize; 2] {
        let both_orders = if i == j { 1 } else { 2 };
        let is_instantaneous = effect.kind() == TermKind::Constraint;
        if is_instantaneous {
            // A multiplier has a column in the balances of its instant, its constraint a row in the coordinates.
            let is_pair_of_coordinates = j < self.coordinates;
            return match (is_pair_of_coordinates, self.matrix) {
                (true, Matrix::Program | Matrix::Rest) => [both_orders, 1],
                // The curvature of a constraint at the end of a step belongs to the next one.
                (true, Matrix::Step) => [0, 0],
                (false, _) => [2, 1],
            };
        }
        let scalar = |i: usize| Some(self.scalars[i.checked_sub(self.coordinates)?]);
        // A program has the balances of an instant with the instants before, here and after, and an interval has two ends.
        let (balances, ends) = match self.matrix {
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

/// Most evaluations of one effect.
const MOST: u32 = 10_000;
/// Number of means, of which the least is reported.
const ROUNDS: u32 = 3;
/// Most elements of an effect that are all evaluated: of more, a part is, and the time is multiplied.
const ELEMENTS: usize = 100_000;

/// Time in µs of one evaluation with second derivatives of each effect at the reference configuration, those of the intervals
/// first; about `spent` seconds or one evaluation go into each, of large ones into a part.
pub(crate) fn measured_times(model: &Model, spent: f64) -> Vec<f64> {
    let action = &model.action;
    let start = model.reference_coordinates();
    let instant = action.map.placed(&start);
    let scalars = vec![0.0; action.intervals.scalars];
    let interval = Sample::of_interval(&scalars, model.analysis.interval);
    let of_interval = interval.between([&instant, &instant]);
    let multipliers = vec![0.0; action.instants.scalars];
    let of_instant = Sample {
        scalars: &multipliers,
        ..of_interval
    };
    let mut times = Vec::new();
    for (sum, sample) in [
        (&action.intervals, &of_interval),
        (&action.instants, &of_instant),
    ] {
        let parts = parts(sum);
        let timed = parts.as_ref().unwrap_or(sum);
        let mut output = timed.output(Order::Hessian);
        let whole = sum.terms.iter().map(|term| term.elements());
        for (all, part) in whole.zip(timed.terms()) {
            let times_as_many = all as f64 / part.0.elements().max(1) as f64;
            let (effect, slots) = part;
            let evaluate =
                || effect.evaluate(Order::Hessian, black_box(sample), slots, &mut output);
            times.push(1e6 * times_as_many * time(evaluate, spent));
        }
    }
    times
}

/// A sum of parts of the effects, so that the couplings of large ones are not laid down; `None` where there is no large one.
fn parts(sum: &Functional) -> Option<Functional> {
    let is_large = |term: &Arc<dyn Term>| term.elements() > ELEMENTS;
    sum.terms.iter().any(is_large).then(|| {
        let part = |term: &Arc<dyn Term>| match is_large(term) {
            true => {
                let read = sum.vectors * ELEMENTS / term.elements();
                let part = term.reading(&|vector| vector < read);
                part.unwrap_or_else(|| term.clone())
            }
            false => term.clone(),
        };
        let terms = sum.terms.iter().map(part).collect();
        Functional::new(terms, Vec::new(), sum.vectors, sum.scalars)
    })
}

/// Time of one evaluation in s.
fn time(mut evaluate: impl FnMut(), spent: f64) -> f64 {
    let mut run = |count: u32| {
        let began = Instant::now();
        (0..count).for_each(|_| evaluate());
        began.elapsed().as_secs_f64() / f64::from(count)
    };
    let once = run(1);
    if once > spent {
        return once;
    }
    let rounds = f64::from(ROUNDS) * once.max(1e-9);
    let count = ((spent / rounds) as u32).clamp(1, MOST);
    (0..ROUNDS).map(|_| run(count)).fold(once, f64::min)
}

/// In place of the number of an unknown.
const NONE: u32 = u32::MAX;

/// The unknowns that vectors and scalars depend on: arguments are the vectors, then the scalars of the site.
#[derive(Debug)]
pub(super) struct Arguments<'a> {
    map: &'a CoordinateMap,
    /// Unknowns of each argument.
    unknowns: Vec<Vec<usize>>,
    /// Arguments of each unknown.
    arguments: Vec<Vec<usize>>,
}

impl<'a> Arguments<'a> {
    /// Of so many scalars of a site.
    pub(super) fn new(map: &'a CoordinateMap, scalars: usize) -> Self {
        let of_vectors = (0..map.vectors.len()).map(|vector| map.support(vector));
        let of_scalars = (0..scalars).map(|s| vec![map.coordinates + s]);
        let unknowns: Vec<Vec<usize>> = of_vectors.chain(of_scalars).collect();
        let mut arguments = vec![Vec::new(); map.coordinates + scalars];
        for (argument, own) in unknowns.iter().enumerate() {
            own.iter()
                .for_each(|&unknown| arguments[unknown].push(argument));
        }
        Self {
            map,
            unknowns,
            arguments,
        }
    }

    /// Number of unknowns.
    pub(super) fn count(&self) -> usize {
        self.arguments.len()
    }

    /// Returns true if two unknowns meet where vectors are multiplied by each other: directors and nodes component by component, joint
    /// coordinates all with all.
    fn meet(&self, i: usize, j: usize) -> bool {
        match (axis(self.map, i), axis(self.map, j)) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        }
    }
}

/// An effect with the arguments that it couples.
pub(super) struct Coupled<'a> {
    pub(super) effect: &'a dyn Term,
    /// The arguments that each one is coupled with, and true where only vectors are multiplied.
    partners: Vec<Vec<(u32, bool)>>,
}

impl<'a> Coupled<'a> {
    /// The couplings of an effect.
    pub(super) fn new(effect: &'a dyn Term, of: &Arguments<'_>) -> Self {
        let vectors = of.map.vectors.len();
        let mut partners = vec![Vec::new(); of.unknowns.len()];
        effect.couple(&mut |coupling| {
            let (a, b, by_axis) = match coupling {
                None => return,
                Some(Coupling::Full(a, b)) => (a, b, false),
                Some(Coupling::Isotropic(a, b)) => (a, b, true),
                Some(Coupling::Mixed(a, s)) => (a, vectors + s, false),
                Some(Coupling::Scalars(s, t)) => (vectors + s, vectors + t, false),
            };
            for (one, other) in [(a, b), (b, a)] {
                add(&mut partners[one], (other as u32, by_axis));
            }
        });
        Self { effect, partners }
    }

    /// Hands over the unknowns that one is coupled with, some of them more than once.
    fn each_partner(&self, of: &Arguments<'_>, i: usize, mut to: impl FnMut(usize)) {
        for &argument in &of.arguments[i] {
            for &(partner, by_axis) in &self.partners[argument] {
                for &j in &of.unknowns[partner as usize] {
                    if !by_axis || of.meet(i, j) {
                        to(j);
                    }
                }
            }
        }
    }

    /// Hands over each pair once, the smaller unknown first.
    pub(super) fn each_pair(&self, of: &Arguments<'_>, mut to: impl FnMut(usize, usize)) {
        let mut met_by = vec![NONE; of.count()];
        for i in 0..of.count() {
            self.each_partner(of, i, |j| {
                if j >= i && std::mem::replace(&mut met_by[j], i as u32) != i as u32 {
                    to(i, j);
                }
            });
        }
    }

    /// Returns true if two unknowns are coupled.
    pub(super) fn couples(&self, of: &Arguments<'_>, [i, j]: [usize; 2]) -> bool {
        let mut is_met = false;
        self.each_partner(of, i, |partner| is_met |= partner == j);
        is_met
    }
}

/// Adds an item to a list, which keeps each one once before it takes more memory.
fn add<T: Copy + Ord>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.sort_unstable();
        list.dedup();
        list.reserve(list.len());
    }
    list.push(item);
}

/// Direction of a coordinate that moves along one; `None` for a joint's.
fn axis(map: &CoordinateMap, i: usize) -> Option<usize> {
    match i.checked_sub(map.of_bodies) {
        Some(of_node) => map.of_nodes.get(of_node).map(|&(_, axis)| axis),
        None => (!map.is_articulated()).then_some(i % 3),
    }
}
