//! A start for motions that touch, found by simulations: under random inputs, of which those come closest to goal and limits.
//!
//! A solver sees no contact that stays open along its guess, and none that stays closed opens on its way. A simulation makes and breaks them
//! where the inputs do. The inputs are linear between values at a few times. Generation after generation these values are normally
//! distributed about the mean of those that missed least, with their deviation: the cross-entropy method (Rubinstein 1999).

use crate::control::problem::{Control, ControlTask, Duration, Guess};
use crate::control::{InitialGuess, guess};
use crate::math::{Random, Signal, cores};
use crate::model::{Model, Role};
use crate::nlp::Nlp;
use crate::workflow::error::WorkflowError;
use crate::workflow::optimum::Budget;
use crate::workflow::parallel_map::parallel_map;
use crate::workflow::program::{Counted, interval, prepare, resolve};
use crate::workflow::remark::phase;

/// Times at which an input has a value of its own.
const KNOTS: usize = 6;
/// Motions of a generation, those that make the next one, and the most generations.
const MOTIONS: usize = 24;
const PARENTS: usize = 5;
const GENERATIONS: usize = 10;
/// Parts of the miss of idle inputs that are near enough, and too far to be a start.
const NEAR: f64 = 0.2;
const FAR: f64 = 0.5;

/// The problem of a motion with the guess of the inputs that miss its goal and limits least; `None` of several motions, of a start or a duration
/// that is sought, of a guess of its own, and where all inputs miss by far.
///
/// # Errors
/// Start or goal is wrong.
pub(super) fn simulated_start(
    task: &ControlTask<'_>,
    budget: &Budget,
) -> Result<Option<Control>, WorkflowError> {
    let [motion] = task.motions[..] else {
        return Ok(None);
    };
    let control = motion.control;
    let is_new = motion.earlier.is_none() && control.guess == Guess::Interpolate;
    if !is_new || !control.knows_start() || !matches!(control.duration, Duration::Given(_)) {
        return Ok(None);
    }
    phase("looking for a start by simulations");
    let (model, boundary) = resolve(motion.system, control)?;
    let mut program = prepare(&model, &boundary, control, None, Counted::Yes)?.program;
    let moved = |control: &Control| guess(&model, &boundary, control, interval(control), None);
    let mut miss = |motion: &InitialGuess| {
        let x = program.encode(&motion.discrete, motion.h);
        let mut g = vec![0.0; program.constraints().count()];
        program.constraint(&x, &mut g);
        let squares = (0..g.len()).map(|i| program.constraints().excess(i, g[i]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let ranges = ranges(&model, control);
    let nearest_zero = |[low, high]: &[f64; 2]| [0.0_f64.clamp(*low, *high); KNOTS];
    let idle: Vec<f64> = ranges.iter().flat_map(nearest_zero).collect();
    let of_idle = miss(&moved(&with_guess(control, &idle)));
    let mut families = Families::new(&ranges);
    for generation in 0..GENERATIONS {
        if budget.is_over() {
            break;
        }
        let values = families.generation();
        let moved = |values: &Vec<f64>| moved(&with_guess(control, values));
        let found = parallel_map(&values, cores(), moved, |_, _| {});
        let misses = found.iter();
        let misses = misses.map(|found| found.as_ref().map_or(f64::INFINITY, &mut miss));
        families.follow(misses.zip(values));
        let least = families.parents[0].0;
        tracing::info!(generation, of_idle, least, "search");
        if least <= NEAR * of_idle {
            break;
        }
    }
    let mut best = families.parents.iter().take(1);
    let best = best.find(|(miss, _)| *miss <= FAR * of_idle);
    Ok(best.map(|(_, values)| with_guess(control, values)))
}

/// Values of the inputs, and their distributions.
struct Families<'r> {
    ranges: &'r [[f64; 2]],
    /// Mean and deviation of each value; none of the first generation, which is distributed evenly.
    normal: Vec<[f64; 2]>,
    /// Those that missed least, with their misses.
    parents: Vec<(f64, Vec<f64>)>,
    random: Random,
}

impl<'r> Families<'r> {
    fn new(ranges: &'r [[f64; 2]]) -> Self {
        Self {
            ranges,
            normal: Vec::new(),
            parents: Vec::new(),
            random: Random::new(0),
        }
    }

    /// The values of another generation.
    fn generation(&mut self) -> Vec<Vec<f64>> {
        let Self {
            ranges,
            normal,
            random,
            ..
        } = self;
        let mut values = || {
            let all = 0..KNOTS * ranges.len();
            let value = all.map(|i| {
                let [low, high] = ranges[i / KNOTS];
                match normal.get(i) {
                    Some([mean, deviation]) => {
                        (mean + deviation * random.normal()).clamp(low, high)
                    }
                    None => random.between(low, high),
                }
            });
            value.collect()
        };
        (0..MOTIONS).map(|_| values()).collect()
    }

    /// Takes a generation in, of which the next one comes.
    fn follow(&mut self, generation: impl Iterator<Item = (f64, Vec<f64>)>) {
        self.parents.extend(generation);
        self.parents.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.parents.truncate(PARENTS);
        let normal = (0..KNOTS * self.ranges.len()).map(|i| {
            let mean = |of: &dyn Fn(f64) -> f64| {
                let values = self.parents.iter().map(|(_, values)| of(values[i]));
                values.sum::<f64>() / self.parents.len() as f64
            };
            let middle = mean(&|value| value);
            [middle, mean(&|value| (value - middle).powi(2)).sqrt()]
        });
        self.normal = normal.collect();
    }
}

/// Ranges of the inputs by source; of an unbounded one up to its size.
fn ranges(model: &Model, control: &Control) -> Vec<[f64; 2]> {
    let mut ranges = vec![[0.0; 2]; model.sources.len()];
    let roles = [Role::Voltage, Role::Load].into_iter();
    for input in roles.flat_map(|role| model.variables.with(role)) {
        let size = control.size(input, model);
        let [low, high] = control.bounds(input);
        if let Some(source) = input.source {
            ranges[source] = [low.max(-size), high.min(size)];
        }
    }
    ranges
}

/// The problem with the guess of these inputs, by source.
fn with_guess(control: &Control, values: &[f64]) -> Control {
    let end = control.duration.first();
    let times = (0..KNOTS).map(|k| end * k as f64 / (KNOTS - 1) as f64);
    let times: Vec<f64> = times.collect();
    let signals = values.chunks(KNOTS).map(|values| Signal::Table {
        times: times.clone(),
        values: values.to_vec(),
    });
    Control {
        guess: Guess::Simulate(signals.collect::<Vec<_>>().into()),
        ..control.clone()
    }
}
