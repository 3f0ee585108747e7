//! The whole identification: grids are refined until their bias is far below the standard errors, then all is assessed.

use crate::control::problem::{BoundaryState, Identification, Reading, Recording, Regime};
use crate::dynamics::trajectory::Observations;
use crate::dynamics::{DiscreteTrajectory, Start, observations};
use crate::identify::assessment::{
    Experiment, HeldOut, LEVEL, Rises, Whiteness, check_deviations, ljung_box,
};
use crate::identify::error::IdentifyError;
use crate::identify::fit::{Data, Fit, Series};
use crate::identify::information::Information;
use crate::identify::prediction::{Grid, Unknowns, simulated, states_of_rest};
use crate::identify::setup::Problem;
use crate::model::{Model, System, check_parameters, joint_unit};
use crate::stop;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Greatest bias of a constant by the grid, in standard errors, and greatest relative change of those.
const BIAS: f64 = 0.1;
/// A relative change of all constants below this is none, however small the standard errors.
pub const NONE: f64 = 1e-8;
/// Singular value of the derivatives, relative to the largest, of a combination that is determined.
const RANK: f64 = 1e-8;
/// Relative change of a start below which it is the same.
const SAME: f64 = 1e-9;
/// Confidence limits are checked on a grid coarser by this many halvings.
const COARSER: usize = 2;
/// Most halvings of the steps, and most intervals of a recording.
const HALVINGS: usize = 10;
const MOST: usize = 200_000;

/// Bias of the constants by the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Bias {
    /// Change of each constant from the grid before to the last one, in standard errors: more than what is left.
    pub changes: Vec<f64>,
    /// Root of the mean squared change of the predictions, in standard deviations.
    pub readings: f64,
    /// Largest relative change of a standard error of a constant that is determined.
    pub errors: f64,
    /// True if all are below a tenth, or where no constant changes by more than rounding.
    pub is_confirmed: bool,
    /// Number of halvings of the first steps.
    pub halvings: usize,
}

impl Bias {
    /// The largest change.
    pub fn largest(&self) -> f64 {
        self.changes.iter().copied().fold(0.0, f64::max)
    }

    /// Returns true if all changes are below a tenth of the errors.
    pub fn is_small(&self) -> bool {
        self.largest().max(self.readings) < BIAS
    }

    /// Returns true if standard errors change by less than a tenth.
    pub fn keeps_errors(&self) -> bool {
        self.errors < BIAS
    }
}

/// Constants with all that the recordings say of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified {
    /// The fit on the last grid.
    pub fit: Fit,
    /// Recordings that it is fitted to.
    pub fitted: Vec<usize>,
    /// Its information on the constants.
    pub information: Information,
    /// The last grid.
    pub grid: Grid,
    /// Bias by the grid.
    pub bias: Bias,
    /// Squares of the residuals at the ends of the intervals.
    pub rises: Rises,
    /// Residuals of the fitted recordings.
    pub series: Vec<Series>,
    /// Their whiteness.
    pub whiteness: Vec<Option<Whiteness>>,
    /// Probability of so large residuals, where the standard deviations are known.
    pub p: Option<f64>,
    /// Predictions of recordings that were held out.
    pub held_out: Vec<HeldOut>,
    /// Candidates for the next experiment, the best one first.
    pub experiments: Vec<Experiment>,
}

impl Identified {
    /// Returns true if no series of residuals of the fit has correlations beyond chance.
    pub fn is_white(&self) -> bool {
        let tests = self.whiteness.iter().flatten();
        let count = tests.clone().count().max(1) as f64;
        tests.into_iter().all(|test| test.p >= LEVEL / count)
    }
}

/// Fits the constants of a task to its recordings and assesses them; `told` hears of each fit.
///
/// # Errors
/// The data do not allow it, or a recording cannot be simulated.
pub fn identify(
    system: &System,
    task: &Identification,
    told: &mut dyn FnMut(&Fit, &Grid),
) -> Result<Identified, IdentifyError> {
    check(system, task)?;
    let problem = Problem { system, task };
    let fitted: Vec<usize> = (0..task.recordings.len())
        .filter(|&r| !task.recordings[r].is_held_out)
        .collect();
    let unknowns = begin(problem, &fitted)?;
    let (found, information, grids, bias) = refined(problem, &fitted, unknowns, told)?;
    let grid = grids.last().expect("the first one").clone();
    let coarser = &grids[grids.len().saturating_sub(1 + COARSER)];
    let rises = Rises::new(problem, &fitted, &found, &information, coarser)?;
    let held_out = (0..task.recordings.len()).filter(|r| !fitted.contains(r));
    let predicted = held_out.map(|r| HeldOut::new(problem, r, &found, &information, &grid));
    let held_out = predicted.collect::<Result<_, _>>()?;
    let experiments = Experiment::all(problem, &found, bias.halvings)?;
    let series = found.data.series(task, &fitted, &found.prediction.values);
    let p = found.data.is_known().then(|| {
        let freedom = found.freedom().max(1) as f64;
        ChiSquared::new(freedom)
            .expect("a positive number")
            .sf(found.sum())
    });
    Ok(Identified {
        whiteness: series
            .iter()
            .map(|one| ljung_box(&one.standardised()))
            .collect(),
        series,
        p,
        fit: found,
        fitted,
        information,
        grid,
        bias,
        rises,
        held_out,
        experiments,
    })
}

/// Refuses constants that cannot be sought, in the scene of any recording.
fn check(system: &System, task: &Identification) -> Result<(), IdentifyError> {
    check_parameters(system, &task.parameters).map_err(IdentifyError::NotSought)?;
    let recordings = task.recordings.iter().chain(&task.candidates);
    let mut scenes = recordings.filter_map(|one| one.scene.as_ref());
    scenes.try_for_each(|own| {
        check_parameters(&own.system, &own.parameters).map_err(IdentifyError::NotSought)
    })
}

/// Refuses starts whose coordinates depend on a constant otherwise than by a state of rest, whose derivatives are known: memories of given
/// coordinates that read a length.
fn fixed_starts(problem: Problem<'_>, recording: &Recording) -> Result<(), IdentifyError> {
    if matches!(recording.start, BoundaryState::RestAtVoltages(..))
        || recording.regime == Regime::Rest
    {
        return Ok(());
    }
    let guesses = problem.guesses();
    let at = |values: &[f64]| -> Result<Start, IdentifyError> {
        let setup = problem.setup(recording, values, [recording.duration(), 4.0])?;
        Ok(setup.given_start()?.0)
    };
    let start = at(&guesses)?;
    for (j, parameter) in problem.task.parameters.iter().enumerate() {
        let mut values = guesses.clone();
        values[j] = match parameter.guess < parameter.upper {
            true => {
                let further = parameter.guess + parameter.size();
                0.5 * (parameter.guess + parameter.upper.min(further))
            }
            false => parameter.lower,
        };
        let other = at(&values)?;
        let mut pairs = start.z.iter().zip(&other.z);
        if pairs.any(|(a, b)| (a - b).abs() > SAME * a.abs().max(b.abs())) {
            let name = &parameter.name;
            return Err(recording.refused(format!(
                "its start depends on {name}; expected a start at rest, with \"sought_start\": \"state\" where it moves"
            )));
        }
    }
    Ok(())
}

/// The model of the first recording, with constants at their guesses.
///
/// # Errors
/// It does not exist.
pub fn first_model(system: &System, task: &Identification) -> Result<Model, IdentifyError> {
    check(system, task)?;
    let problem = Problem { system, task };
    let recording = &task.recordings[0];
    // A single state of rest has no duration.
    let duration = Some(recording.duration()).filter(|duration| *duration > 0.0);
    let grid = [duration.unwrap_or(1.0), 4.0];
    Ok(problem.setup(recording, &problem.guesses(), grid)?.model)
}

/// The first unknowns, of data that can tell them.
fn begin(problem: Problem<'_>, fitted: &[usize]) -> Result<Unknowns, IdentifyError> {
    let task = problem.task;
    for recording in &task.recordings {
        fixed_starts(problem, recording)?;
    }
    let data = Data::new(task, fitted);
    for candidate in &task.candidates {
        fixed_starts(problem, candidate)
            .and_then(|()| check_deviations(candidate, &data, "whose deviation is estimated"))
            .map_err(IdentifyError::of_candidate)?;
    }
    let count = |&r: &usize| problem.count_of_start(&task.recordings[r]);
    let held_out = (0..task.recordings.len()).filter(|&r| task.recordings[r].is_held_out);
    for r in held_out {
        let (recording, of_start) = (&task.recordings[r], count(&r)?);
        if recording.count() <= of_start {
            return Err(recording.refused(format!(
                "{of_start} unknowns of the start are fitted to {} of its readings, which leaves nothing to check; expected more readings",
                recording.count()
            )));
        }
    }
    let counts: Vec<usize> = fitted.iter().map(count).collect::<Result<_, _>>()?;
    let mut next = counts.into_iter();
    let unknowns = Unknowns::new(task, |_| next.next().expect("one of each that is fitted"));
    let readings: usize = fitted.iter().map(|&r| task.recordings[r].count()).sum();
    let readings = readings + task.priors.len();
    if readings <= unknowns.values.len() {
        return Err(IdentifyError::TooFew {
            readings,
            unknowns: unknowns.values.len(),
        });
    }
    let is_still = |&r: &usize| {
        let recording = &task.recordings[r];
        let mut channels = recording.channels.iter();
        let same = |pair: &[Reading]| pair[0].value == pair[1].value;
        recording.regime == Regime::Motion
            && channels.all(|channel| channel.readings.windows(2).all(same))
    };
    match fitted.iter().all(is_still) {
        true => Err(IdentifyError::NothingMoves),
        false => Ok(unknowns),
    }
}

/// Fits on grids of halved steps, which are told, until constants change by less than a tenth of their standard errors.
fn refined(
    problem: Problem<'_>,
    fitted: &[usize],
    unknowns: Unknowns,
    told: &mut dyn FnMut(&Fit, &Grid),
) -> Result<(Fit, Information, Vec<Grid>, Bias), IdentifyError> {
    let task = problem.task;
    let mut grid = Grid::first(task, &task.recordings);
    let mut grids = vec![grid.clone()];
    let mut found = problem.fit(fitted, unknowns, 0, &grid)?;
    unread(task, &found)?;
    let mut information = Information::of_fit(task, &found);
    told(&found, &grid);
    let mut bias = Bias {
        changes: vec![f64::INFINITY; task.parameters.len()],
        is_confirmed: fitted
            .iter()
            .all(|&r| task.recordings[r].regime == Regime::Rest),
        readings: 0.0,
        errors: 0.0,
        halvings: 0,
    };
    if bias.is_confirmed {
        bias.changes.fill(0.0);
    }
    while !bias.is_confirmed && bias.halvings < HALVINGS {
        if stop::reason().is_some() {
            break;
        }
        let finer = grid.halved();
        if finer.intervals.iter().any(|&n| n > MOST) {
            break;
        }
        let before = found.clone();
        found = problem.fit(fitted, before.unknowns.clone(), 0, &finer)?;
        grid = finer;
        grids.push(grid.clone());
        told(&found, &grid);
        information = Information::of_fit(task, &found);
        bias.halvings += 1;
        // Errors by the derivatives of both grids, whatever the scatter that each leaves.
        let alike = Fit {
            data: found.data.clone(),
            ..before.clone()
        };
        let known = Information::of_fit(task, &alike);
        bias.compare(&before, &known, &found, &information);
    }
    Ok((found, information, grids, bias))
}

impl Bias {
    fn compare(
        &mut self,
        before: &Fit,
        known: &Information,
        after: &Fit,
        information: &Information,
    ) {
        self.errors = 0.0;
        let mut is_none = information.is_determined.contains(&true);
        let change = &after.prediction.values - &before.prediction.values;
        let change = change.component_div(&after.data.deviations);
        let of_readings = shift(&after.weighted(), &change);
        let pairs = before.of_constants().iter().zip(after.of_constants());
        for (j, (a, b)) in pairs.enumerate() {
            let [earlier, error] = [known, information].map(|one| one.covariance[(j, j)].sqrt());
            if information.is_determined[j] && error > 0.0 {
                self.errors = self.errors.max((earlier / error - 1.0).abs());
            }
            // Of a constant that is not determined combinations may be, which move with the readings.
            self.changes[j] = match information.is_determined[j] && error > 0.0 {
                true => (a - b).abs() / error,
                false => of_readings,
            };
            is_none &= !information.is_determined[j] || (a - b).abs() <= NONE * b.abs();
        }
        self.readings = change.norm() / (change.len() as f64).sqrt();
        self.is_confirmed = is_none || (self.is_small() && self.keeps_errors());
    }
}

/// Length in standard deviations of that part of a change of readings which unknowns can take: no combination of them moves by more standard
/// errors.
fn shift(jacobian: &DMatrix<f64>, change: &DVector<f64>) -> f64 {
    let size = |column: &usize| jacobian.column(*column).norm();
    let scaled = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] / size(&j).max(f64::MIN_POSITIVE)
    });
    let svd = scaled.svd(true, false);
    let least = RANK * svd.singular_values.amax();
    let of = svd.u.as_ref().map(|u| u.column_iter());
    let pairs = of.into_iter().flatten().zip(svd.singular_values.iter());
    let taken = pairs.filter(|(_, value)| **value > least);
    let squares = taken.map(|(u, _)| u.dot(change).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Refuses constants on which no reading depends.
fn unread(task: &Identification, found: &Fit) -> Result<(), IdentifyError> {
    let derivatives = &found.prediction.derivatives;
    let of_recordings = derivatives.rows(0, derivatives.nrows() - task.priors.len());
    let columns = of_recordings.column_iter();
    for (parameter, column) in task.parameters.iter().zip(columns) {
        if column.iter().all(|value| *value == 0.0) {
            let name = parameter.name.clone();
            return Err(IdentifyError::Unread { name });
        }
    }
    Ok(())
}

/// A recording as the fit predicts it.
#[derive(Debug)]
pub struct FittedMotion {
    /// Index of the recording.
    pub recording: usize,
    /// Its model with the fitted constants.
    pub model: Model,
    /// The motion, or the states of rest at the times of readings.
    pub discrete: DiscreteTrajectory,
    /// All that is observed of it.
    pub observations: Observations,
}

impl FittedMotion {
    /// All recordings as the fit predicts them, those that are held out too, each as far as no stop ends its simulation.
    pub fn all(problem: Problem<'_>, found: &Identified) -> Vec<Self> {
        // What the fit has simulated can be simulated again, unless it is stopped.
        let of = |recording| Self::new(problem, found, recording).ok();
        (0..problem.task.recordings.len()).filter_map(of).collect()
    }

    fn new(problem: Problem<'_>, found: &Identified, index: usize) -> Result<Self, IdentifyError> {
        let recording = &problem.task.recordings[index];
        let held_out = found.held_out.iter().find(|one| one.recording == index);
        let unknowns = &found.fit.unknowns;
        let (coarse, start) = match held_out {
            Some(one) => (one.intervals, &*one.start),
            None => (found.grid.intervals[index], unknowns.of_start(index)),
        };
        let intervals = 2 * coarse;
        let setup = problem.on_grid(recording, found.fit.of_constants(), intervals)?;
        let discrete = match recording.regime {
            Regime::Rest => states_of_rest(&setup)?,
            Regime::Motion => simulated(&setup, &setup.start(start)?.0, intervals).0,
        };
        Ok(Self {
            recording: index,
            observations: observations(&setup.model, &discrete),
            model: setup.model,
            discrete,
        })
    }

    /// Name, unit, coordinate and rate at its start of each joint that has one coordinate, in International units.
    pub fn start(&self) -> impl Iterator<Item = (&str, &'static str, f64, f64)> {
        let system = &self.model.system;
        let first = |name: &str| {
            let mut columns = self.observations.columns.iter();
            let column = columns.find(|column| column.name == name)?;
            column.values.first().copied()
        };
        let joints = system.joints.iter().enumerate();
        joints.filter_map(move |(joint, of)| {
            let (value, rate) = (first(&of.name)?, first(&format!("{}_rate", of.name))?);
            let (unit, length, velocity) = match joint_unit(system, joint) {
                "mm" => ("m", 1e-3, 1.0),
                _ => ("rad", 1.0, 1e3),
            };
            Some((of.name.as_str(), unit, length * value, velocity * rate))
        })
    }
}
