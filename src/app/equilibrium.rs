//! A static equilibrium from file to folder.
//!
//! Paths of equilibria under growing voltages, followed by arc length past the points where stability is lost.

use crate::app::equilibrium_summary::{Rest, at_rest, status};
use crate::app::error::CommandError;
use crate::app::kept::record::{make_folder_of, refuse_foreign};
use crate::app::progress::Progress;
use crate::app::request::{CommandInput, CommandOutput, counted};
use crate::app::summary::{MEASURED, Seconds, Summary, no_equilibrium, plan, refused};
use crate::app::{blocks, fields, vibrations};
use crate::control::problem::{AtRest, Task};
use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::dynamics::{
    DiscreteTrajectory, Equilibrium, Instability, PathStop, StabilityLoss, UNSTABLE, continuation,
    observations, out_of_domain,
};
use crate::files::{Entries, Loaded, driven_voltages, read_problem, read_system};
use crate::model::{Model, Response, Role, System};
use crate::nlp::Status;
use crate::report::atomic::WriteError;
use crate::report::axes::{Axis, Extent};
use crate::report::file_set::FileSet;
use crate::report::lines::{LinePlot, Mark, Series};
use crate::report::origin::Origin;
use crate::report::skins::Skins;
use crate::report::style::Dash;
use crate::report::{Branch, PageContent, Run, style, write_still};
use crate::stop;
use crate::tasks::equilibrium::model_at_rest;
use crate::tasks::{self, EquilibriumResult, EquilibriumTaskError};
use crate::workflow::effects::Plan;
use crate::workflow::remark::phase;
use crate::workflow::warnings;
use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Instant;

/// The equilibrium that a problem asks for; under voltages such as `muscle2=1.7kV` that of a scene, or of the scene of any
/// problem. With a number of `modes` the vibrations about it too, without voltages that about the state of rest under none.
///
/// # Errors
/// The file or a voltage is wrong, or the problem asks for something else and no voltages are given.
pub fn equilibrium_of_file(
    request: &CommandInput,
    voltages: Option<&[String]>,
    modes: Option<usize>,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let _progress = Progress::of_solve(request.progress);
    phase("reading");
    refuse_foreign(request)?;
    if let Some(voltages) = voltages {
        // The file of an equilibrium says how branches respond; of others the scene alone is read.
        let (system, response) = match read_problem(&request.input, &request.set) {
            Ok(Loaded {
                system,
                task: Task::Equilibrium(task),
                ..
            }) => (system, task.response),
            _ => (
                read_system(&request.input, &request.set)?,
                Response::Relaxed,
            ),
        };
        let voltages = driven_voltages(voltages, &system)?;
        let task = AtRest {
            voltages,
            coordinates: None,
            response,
            path: None,
            vibrations: None,
        };
        return at(request, None, &system, &task.with_modes(modes), began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    match (&loaded.task, modes) {
        (Task::Equilibrium(task), _) => {
            let task = task.with_modes(modes);
            at(request, Some(&loaded), &loaded.system, &task, began)
        }
        (_, Some(_)) => equilibrium_of_file(request, Some(&[]), modes),
        (other, None) => Err(no_equilibrium(request, other)),
    }
}

/// Finds the equilibrium under voltages, or follows the path there, and writes the folder; where it is lost on the way there,
/// the last one is kept.
pub(super) fn at(
    request: &CommandInput,
    loaded: Option<&Loaded>,
    system: &System,
    task: &AtRest,
    began: Instant,
) -> Result<CommandOutput, CommandError> {
    let read = began.elapsed().as_secs_f64();
    let watch = stop::watch(request.max_seconds.map(|seconds| seconds - read));
    if let Some(points) = task.path {
        return follow(request, loaded, system, task, points, began);
    }
    let result = match tasks::equilibrium(system, task) {
        Ok(result) => result,
        Err(EquilibriumTaskError::NotFound(error)) => {
            return refused(request, &error, "no equilibrium");
        }
        Err(EquilibriumTaskError::Workflow(error)) => {
            return Err(CommandError::in_file(&request.input)(error));
        }
    };
    drop(watch);
    let EquilibriumResult {
        model,
        loss,
        discrete,
        ..
    } = &result;
    let observed = observed(&result);
    let rest = Rest::new(&result, &observed);
    let folder = make_folder_of(request)?;
    let writing = Instant::now();
    let origin = request.origin(false);
    let mut files = FileSet::in_folder(&folder);
    let written = fields::write(&mut files, model, discrete, &origin)?;
    let status = loss.map_or(result.found.status(), status);
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = match loss {
        Some(loss) => Some(rest.lost_words(*loss, &folder)),
        None => (status == UNSTABLE).then(|| rest.verdict()),
    };
    summary.domain.clone_from(&result.outside);
    summary.notes.clone_from(&result.remarks);
    summary.plan = Plan::from_model(model, None, MEASURED);
    summary.blocks = blocks::entries(model, &observed, written);
    summary.seconds = Seconds::since(began, read + result.setup);
    let output = command_output(&summary, &rest, &folder);
    summary.task = rest.entries();
    let title = title(*loss, status);
    let mut page = summary.page(title, loaded);
    page.rows = rest.rows();
    let vibrating = result.vibrations.as_ref();
    let played = vibrating.is_some_and(|found| !found.modes.vibrations.is_empty());
    let skins = Skins::new(model, discrete);
    let run = Run {
        name: "rest",
        held: Some(&result.trajectory.voltages[0]),
        figures: request.figures,
        page: request.page.of(&page).filter(|_| !played),
        ..Run::from_trajectory(
            &model.system,
            &result.trajectory,
            &skins,
            &observed,
            &origin,
        )
    };
    write_still(&mut files, "equilibrium.csv", &run)?;
    if let Some(found) = vibrating {
        vibrations::write(found, &mut files, page, request, &origin)?;
    }
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    Ok(output)
}

/// Columns of the table: the state, and its vibrations.
fn observed(result: &EquilibriumResult) -> Observations {
    let mut observed = at_rest(observations(&result.model, &result.discrete));
    let modes = result.vibrations.iter().flat_map(vibrations::columns);
    observed.columns.extend(modes);
    observed
}

/// Title of the page.
fn title(loss: Option<StabilityLoss>, status: &str) -> &'static str {
    match loss {
        None if status == UNSTABLE => "An unstable equilibrium",
        None => "Static equilibrium",
        Some(_) => "The last equilibrium",
    }
}

/// The answer of the command; an equilibrium that is unstable or was lost has a message.
fn command_output(summary: &Summary, rest: &Rest<'_>, folder: &Path) -> CommandOutput {
    let message = summary.message.iter().cloned();
    let is_solved = summary.message.is_none();
    CommandOutput {
        is_solved,
        result: match summary.status == UNSTABLE {
            _ if is_solved => format!("{}, {}", rest.text(), folder.display()),
            true => format!("unstable equilibrium, {}", folder.display()),
            false => "no equilibrium".to_owned(),
        },
        notes: message.chain(summary.notes.lines()).collect(),
    }
}

/// Follows the path for `count` equilibria and writes `path.csv`, `path.svg`, the fields, and figure and page of the last
/// equilibrium before stability is lost, or of the last one.
fn follow(
    request: &CommandInput,
    loaded: Option<&Loaded>,
    system: &System,
    task: &AtRest,
    count: usize,
    began: Instant,
) -> Result<CommandOutput, CommandError> {
    let model = model_at_rest(system, task).map_err(CommandError::in_file(&request.input))?;
    let setup = began.elapsed().as_secs_f64();
    phase("following the path");
    let scalars = model.scalars(&task.voltages);
    let found = match continuation(&model, &model.reference_coordinates(), &scalars, count) {
        Ok(found) => found,
        Err(error) => return refused(request, &error, "no equilibrium to start from"),
    };
    let stopped = stop::reason();
    let folder = make_folder_of(request)?;
    let origin = request.origin(false);
    let path = EquilibriumPath::new(&model, &found);
    let writing = Instant::now();
    let mut files = FileSet::in_folder(&folder);
    let plot = path.figure();
    files.add("path.svg", plot.svg(&origin).as_bytes())?;
    fields::write(&mut files, &model, &path.discrete, &origin)?;
    let word = stopped.map_or("path_followed", Status::word);
    let mut summary = Summary::new(request, word, model.coordinates.name());
    let (plan, uncounted) = plan(&model, stopped.is_some());
    summary.plan = plan;
    summary.notes.warn("left_out", uncounted);
    summary.task = Entries::default().with("path", entries(&found));
    summary.domain = warnings::outside_domain(&out_of_domain(&model, &path.discrete));
    let note = warnings::domain_note(&summary.domain, false);
    summary.notes.warn("outside_domain", note);
    summary.seconds = Seconds::since(began, setup);
    let mut page = summary.page("Path of equilibria", loaded);
    page.rows = rows(&found, path.stops[path.shown()].fraction);
    page.plots.push(("Path".to_owned(), plot));
    path.write(request, &page, &mut files, &origin)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    let losses = losses(&found).map(|(words, place)| format!("{words} at {place}"));
    let early = stopped.map(|status| {
        let why = status.word().replace('_', " ");
        format!("the path was not followed to its end ({why})")
    });
    let count = counted(points(&found), "equilibrium").replace("equilibriums", "equilibria");
    Ok(CommandOutput {
        is_solved: stopped.is_none(),
        result: format!("{count}, {}", folder.display()),
        notes: losses.chain(early).chain(summary.notes.lines()).collect(),
    })
}

/// Words on the losses of stability, and their places on the path.
fn losses(found: &[PathStop]) -> impl Iterator<Item = (&'static str, String)> {
    let place = |fraction: f64| format!("{:.6} % of the voltages", 100.0 * fraction);
    let words = move |stop: &PathStop| Some((stop.lost?.words(), place(stop.fraction)));
    found.iter().filter_map(words)
}

/// Number of equilibria on the path, beside those where stability is lost between them.
fn points(found: &[PathStop]) -> usize {
    found.iter().filter(|stop| stop.lost.is_none()).count()
}

/// Largest fraction of the voltages on the path.
fn largest_fraction(found: &[PathStop]) -> f64 {
    found.iter().map(|stop| stop.fraction).fold(0.0, f64::max)
}

/// The path in `summary.json`.
fn entries(found: &[PathStop]) -> Entries {
    let lost = found.iter().filter_map(|stop| {
        let lost = Entries::default().with("fraction", stop.fraction);
        Some(lost.with("kind", stop.lost?.key()))
    });
    Entries::default()
        .with("points", points(found))
        .with("largest_fraction", largest_fraction(found))
        .with_each("lost", lost)
}

/// Rows of the page; `shown` is the fraction of the voltages of the equilibrium that is drawn.
fn rows(found: &[PathStop], shown: f64) -> Vec<(String, String)> {
    let percent = |fraction: f64| format!("{:.6} %", 100.0 * fraction);
    let largest = percent(largest_fraction(found));
    let ends = [
        ("equilibria", points(found).to_string()),
        ("largest fraction of the voltages", largest),
    ];
    let shown = (
        "configuration",
        format!("the equilibrium at {}", percent(shown)),
    );
    let all = ends.into_iter().chain(losses(found)).chain([shown]);
    all.map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Equilibria as a motion by their fractions of the voltages.
fn in_turn(model: &Model, stops: &[PathStop]) -> DiscreteTrajectory {
    let states = stops.iter().map(|stop| (stop.fraction, &stop.rest));
    Equilibrium::in_turn(model, 0.0, states)
}

/// A path of equilibria as a motion in which time is the fraction of the voltages.
struct EquilibriumPath<'a> {
    model: &'a Model,
    stops: &'a [PathStop],
    /// The first equilibrium stands at both ends of an interval of its own, so that each has its potentials.
    discrete: DiscreteTrajectory,
}

impl<'a> EquilibriumPath<'a> {
    fn new(model: &'a Model, stops: &'a [PathStop]) -> Self {
        Self {
            model,
            discrete: in_turn(model, stops),
            stops,
        }
    }

    /// Index of the equilibrium that is shown: the last one before stability is lost, or the last one.
    fn shown(&self) -> usize {
        let lost = self.stops.iter().position(|stop| stop.lost.is_some());
        lost.unwrap_or(self.stops.len() - 1)
    }

    /// Writes `path.csv`, and figure and page of the equilibrium that is shown.
    fn write(
        &self,
        request: &CommandInput,
        page: &PageContent,
        files: &mut FileSet,
        origin: &Origin,
    ) -> Result<(), WriteError> {
        let Self {
            model,
            stops,
            discrete,
        } = self;
        let shown = self.shown();
        let rest = &stops[shown].rest;
        let state =
            DiscreteTrajectory::in_steps(1.0, vec![rest.z.clone()], vec![rest.scalars.clone()]);
        let motion = Trajectory::from_discrete(model, &state);
        let way = Trajectory::from_discrete(model, &in_turn(model, &stops[..=shown]));
        let steps = DiscreteTrajectory {
            times: (0..=stops.len()).map(|k| 1e3 * (k as f64 - 1.0)).collect(),
            ..discrete.clone()
        };
        let fractions: Vec<f64> = stops.iter().map(|stop| stop.fraction).collect();
        let branch = Branch {
            trajectory: &Trajectory::from_discrete(model, &steps),
            skins: &Skins::new(model, &steps),
            fractions: &fractions,
            shown,
        };
        let (skins, observed) = (Skins::new(model, &state), self.observed());
        let run = Run {
            name: "rest",
            held: Some(&motion.voltages[0]),
            equilibria: Some(&way),
            branch: Some(branch),
            figures: request.figures,
            page: request.page.of(page),
            ..Run::from_trajectory(&model.system, &motion, &skins, &observed, origin)
        };
        write_still(files, "path.csv", &run)
    }

    /// Fraction, voltages, markers, stretches, charges, energies and stability of each equilibrium, and a mark if stability is lost
    /// there.
    fn observed(&self) -> Observations {
        let Self {
            model,
            stops,
            discrete,
        } = self;
        let mut columns = Vec::new();
        let mut add = |name: String, unit: &'static str, values: Vec<f64>| {
            columns.push(Column { name, unit, values });
        };
        let each = |value: &dyn Fn(&PathStop) -> f64| stops.iter().map(value).collect();
        add("fraction".to_owned(), "", each(&|stop| stop.fraction));
        let voltages = model.variables.with(Role::Voltage);
        for (voltage, s) in voltages.iter().zip(model.variables.range(Role::Voltage)) {
            let values = each(&|stop| stop.rest.scalars[s]);
            add(voltage.name.clone(), "V", values);
        }
        for mut column in at_rest(observations(model, discrete)).columns {
            column.values.remove(0);
            add(column.name, column.unit, column.values);
        }
        let unstable = |stop: &PathStop| stop.rest.unstable.map_or(f64::NAN, |n| n as f64);
        add("unstable_directions".to_owned(), "", each(&unstable));
        let lost = |stop: &PathStop| f64::from(u8::from(stop.lost.is_some()));
        add("stability_lost".to_owned(), "", each(&lost));
        Observations { columns }
    }

    /// Parts of a path along which equilibria are stable, or are not, or it is not known; each begins at the end of the one before.
    fn branches(&self) -> Vec<(Option<bool>, RangeInclusive<usize>)> {
        let is_stable = |k: usize| self.stops[k].rest.is_stable();
        let mut found = Vec::new();
        let mut from = 0;
        for to in 1..=self.stops.len() {
            if to == self.stops.len() || is_stable(to) != is_stable(to - 1) {
                found.push((is_stable(to - 1), from..=to - 1));
                from = to - 1;
            }
        }
        found
    }

    /// `path.svg`: fraction of the voltages over the distance of each marker from rest, or of the coordinate that moves most; where stability is
    /// lost it is marked.
    fn figure(&self) -> LinePlot {
        let Self {
            model,
            stops,
            discrete,
        } = self;
        let marks = Trajectory::from_discrete(model, discrete).marks;
        let reference = &model.reference_coordinates();
        let distance = |m: usize, k: usize| (marks[k + 1][m] - marks[0][m]).norm();
        let mut series = Vec::new();
        let mut curve = |name: &str, m: usize, distance: &dyn Fn(usize) -> f64| {
            let place = |k: usize| [distance(k), stops[k].fraction];
            let mut named = Vec::new();
            for (is_stable, stretch) in self.branches() {
                let points = stretch.map(place).collect();
                let (dash, name) = match is_stable {
                    Some(true) => (Dash::Solid, name.to_owned()),
                    Some(false) => (Dash::Dashed, format!("{name}, unstable")),
                    None => (Dash::Dashed, format!("{name}, stability not known")),
                };
                // The legend has each once.
                let is_new = !named.contains(&is_stable);
                named.push(is_stable);
                let curve = Series::curve(
                    if is_new { name } else { String::new() },
                    points,
                    style::hue(m),
                );
                series.push(curve.marked(Mark::Disc).dashed(dash));
            }
            let lost = (0..stops.len()).filter(|&k| stops[k].lost.is_some());
            let (points, labels): (Vec<_>, Vec<_>) = lost
                .map(|k| {
                    let words = stops[k].lost.map_or("", Instability::words);
                    let label = format!("{words} at {:.2} %", 100.0 * stops[k].fraction);
                    (place(k), label)
                })
                .unzip();
            if !points.is_empty() {
                let mark = Series::curve("", points, style::INK).marked(Mark::Ring);
                series.push(mark.unjoined().labelled(labels));
            }
        };
        for (m, marker) in model.system.markers.iter().enumerate() {
            curve(&marker.name, m, &|k| distance(m, k));
        }
        if model.system.markers.is_empty() {
            let far = |k: usize| {
                let z = stops[k].rest.z.iter().zip(reference);
                z.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            curve("largest change of a coordinate", 0, &far);
        }
        LinePlot::new(
            Axis::linear("distance from rest [mm]", Extent::FromZero),
            Axis::linear("fraction of the voltages", Extent::FromZero),
            series,
        )
    }
}
