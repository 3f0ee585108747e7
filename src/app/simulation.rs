//! A simulation from file to folder.

use crate::app::blocks;
use crate::app::comparison::Comparison;
use crate::app::displayed_motion::{DisplayedMotion, Motion};
use crate::app::error::CommandError;
use crate::app::kept::unfinished::Unfinished;
use crate::app::kept::{resume_file, solution_file, unfinished};
use crate::app::linear_systems::multigrid;
use crate::app::progress::{Progress, Reached};
use crate::app::request::{CommandInput, CommandOutput, counted};
use crate::app::summary::{STOPPED, Seconds, Summary, leave_out, plan, time_to_write};
use crate::app::{comparison, fields};
use crate::control::problem::{Afterwards, Simulation};
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{DiscreteTrajectory, LocalError, observed};
use crate::files::{Entries, Loaded};
use crate::math::{join, shortest};
use crate::model::Model;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::{self, write_run};
use crate::stop::{self, TimeLimit};
use crate::tasks::{self, Assessment, DisturbedLoops, SimulationRequest, SimulationResult};
use crate::workflow::closed_loop::DisturbedLoop;
use crate::workflow::effects::Plan;
use crate::workflow::integrate::grid;
use crate::workflow::motion::{solved, solved_of};
use crate::workflow::remark::phase;
use crate::workflow::{Simulated, warnings};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Simulates and writes the folder; a motion that ends early is kept as far as it went.
pub(super) fn simulation(
    request: &CommandInput,
    loaded: &Loaded,
    task: &Simulation,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    refuse_halving(request, task)?;
    let problem = resume_file::asked(loaded, task);
    let run = Run {
        request,
        loaded,
        task,
        began,
        // What is kept of halved steps, which begin anew, or of a controller is no motion to go on with.
        resumable: (request.wanted.is_none() && task.controller.is_none()).then_some(&*problem),
    };
    let from = request.from.as_ref();
    let begun = from.map(|from| resume_file::begun(from, &problem, task));
    let begun = begun.transpose()?;
    let read = began.elapsed().as_secs_f64();
    let (result, folder) = integrate(&run, begun, read, observer)?;
    phase("writing");
    let ended = Ended::new(run, result)?;
    let simulated = &ended.result.simulated;
    let writing = Instant::now();
    let mut files = FileSet::in_folder(&folder);
    ended.keep(&mut files)?;
    let (limit, kept) = (time_to_write(request, began), files.count());
    files.limit(&limit);
    let (plan, uncounted) = plan(&simulated.model, ended.result.stopped.is_some());
    let mut summary = ended.summary(read, &plan);
    if let Err(error) = ended.write(&mut summary, &mut files, &limit) {
        let status = limit.reached().ok_or(error)?;
        summary = ended.summary(read, &plan);
        let status = ended.result.stopped.unwrap_or(status);
        leave_out(&mut summary, status, &mut files, kept);
    }
    summary.notes.warn("left_out", uncounted);
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    unfinished::done(&folder);
    Ok(ended.command_output(&folder, &summary))
}

/// Refuses an estimate by halved steps of a motion whose steps follow a tolerance.
fn refuse_halving(request: &CommandInput, task: &Simulation) -> Result<(), CommandError> {
    if task.tolerance.is_none() || request.wanted.is_none() {
        return Ok(());
    }
    Err(CommandError::problem(
        &request.input,
        "simulate.step",
        "steps are halved for --accuracy and --estimate-error: write a step; \"auto\" has a \"tolerance\" instead",
    ))
}

/// A simulation that a command runs.
struct Run<'a> {
    request: &'a CommandInput,
    loaded: &'a Loaded,
    task: &'a Simulation,
    began: Instant,
    /// Text of the problem of a motion that can be resumed.
    resumable: Option<&'a str>,
}

/// Simulates, from where a motion that has `begun` ends, and keeps the steps in the folder of the results, which is returned, until the motion
/// has ended; `read` are the seconds so far.
fn integrate(
    run: &Run<'_>,
    begun: Option<DiscreteTrajectory>,
    read: f64,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<(SimulationResult, PathBuf), CommandError> {
    let (request, task) = (run.request, run.task);
    let asked = SimulationRequest {
        wanted: request.wanted,
        begun,
        seconds: request.max_seconds.map(|s| s - read),
    };
    let file = match run.resumable {
        Some(_) => resume_file::UNFINISHED,
        None => solution_file::UNFINISHED,
    };
    let mut unfinished = Unfinished::new(request, file);
    let progress = Progress::of_steps(request.progress, grid(task).0);
    let mut observe = |steps: usize, model: &Model, discrete: &DiscreteTrajectory| {
        let step = discrete.intervals();
        progress.step(steps, step);
        observer(Reached::Step(step, discrete.times[step]));
        if step == 1 {
            unfinished.begin();
        }
        // The steps so far are final; those of a finer grid begin anew.
        unfinished.consider(0.0, |path| match run.resumable {
            Some(problem) => resume_file::replace(path, discrete, problem),
            None => solution_file::replace(path, model, &solved(model, discrete, None)),
        });
        unfinished.flow()
    };
    let result = tasks::simulate(&run.loaded.system, task, asked, &mut observe)
        .map_err(CommandError::in_file(&request.input))?;
    drop(progress);
    Ok((result, unfinished.made()?))
}

/// A motion with what is observed of it.
struct Observed {
    trajectory: Trajectory,
    observations: Observations,
    assessment: Assessment,
    blocks: Option<Entries>,
}

/// A simulation that has ended.
struct Ended<'a> {
    run: Run<'a>,
    result: SimulationResult,
    /// Closed loops with parts of the disturbance.
    disturbed: DisturbedLoops,
}

impl<'a> Ended<'a> {
    /// Simulates parts of the disturbance that the problem asks for, and adds their deviations to those of the whole.
    fn new(run: Run<'a>, mut result: SimulationResult) -> Result<Self, CommandError> {
        let elapsed = run.began.elapsed().as_secs_f64();
        let seconds = run.request.max_seconds.map(|limit| limit - elapsed);
        let found = tasks::disturbed(&run.loaded.disturbed, &result, seconds);
        let found = found.map_err(CommandError::in_file(&run.request.input))?;
        result.stopped = result.stopped.or(found.stopped);
        if let Some(closed) = &mut result.closed_loop {
            closed.disturbance = found.loops.iter().map(DisturbedLoop::report).collect();
        }
        Ok(Self {
            run,
            result,
            disturbed: found,
        })
    }

    /// Adds the file that a run leaves however it is stopped: the state from which it is resumed, or the motion where it cannot be.
    fn keep(&self, files: &mut FileSet) -> Result<(), WriteError> {
        let Simulated {
            model, discrete, ..
        } = &self.result.simulated;
        let is_motion = discrete.intervals() > 0;
        resume_file::add(files, discrete, self.run.resumable.filter(|_| is_motion))?;
        match is_motion && self.run.resumable.is_none() {
            true => solution_file::add(files, model, &solved(model, discrete, None)),
            false => Ok(()),
        }
    }

    /// Observes, assesses and writes a motion until a limit, and completes its summary.
    fn write(
        &self,
        summary: &mut Summary,
        files: &mut FileSet,
        limit: &TimeLimit,
    ) -> Result<(), WriteError> {
        let origin = self.run.request.origin(false);
        let observed = self.observe(files, limit, &origin)?;
        self.summarise(&observed, summary);
        self.write_pictures(&observed, summary, files, &origin)
    }

    /// Observes and assesses a motion, and writes it with its fields at the same time.
    fn observe(
        &self,
        files: &mut FileSet,
        limit: &TimeLimit,
        origin: &Origin,
    ) -> Result<Observed, WriteError> {
        let Self { run, result, .. } = self;
        let Simulated {
            model, discrete, ..
        } = &result.simulated;
        let folder = files.folder().to_owned();
        // Of many steps each takes long, and most need no other.
        let (columns, (trajectory, written, assessment)) = join(
            || observed(model, discrete, &|| limit.reached().is_some()),
            || {
                let trajectory = Trajectory::from_discrete(model, discrete);
                let write = || {
                    if discrete.intervals() > 0 && run.resumable.is_some() {
                        let kept = solved_of(model, discrete, trajectory.clone(), None);
                        solution_file::add(files, model, &kept)?;
                    }
                    fields::write(files, model, discrete, origin)
                };
                let assess = || {
                    let _watch = stop::watch_by(limit.clone());
                    result.assess(&run.loaded.system, run.task, &trajectory)
                };
                let (written, assessment) = join(write, assess);
                (trajectory, written, assessment)
            },
        );
        let written = written?;
        let columns =
            columns.map_err(|stopped| WriteError::at(folder)(io::Error::other(stopped)))?;
        let mut observations = trajectory.observe(&model.system);
        observations.columns.extend(columns);
        let blocks = blocks::entries(model, &observations, written);
        observations.columns.extend(assessment.exchange.columns());
        Ok(Observed {
            trajectory,
            observations,
            assessment,
            blocks,
        })
    }

    /// The summary before the motion is observed and assessed.
    fn summary(&self, read: f64, plan: &Plan) -> Summary {
        let Self { run, result, .. } = self;
        let simulated = &result.simulated;
        let coordinates = simulated.model.coordinates.name();
        let mut summary = Summary::new(run.request, result.word(), coordinates);
        summary.plan = plan.clone();
        summary.message = simulated.failure.as_ref().map(ToString::to_string);
        summary.task = self.entries(None);
        summary.accuracy.clone_from(&result.accuracy);
        summary.seconds = Seconds {
            solver: simulated.seconds,
            ..Seconds::since(run.began, read + simulated.setup)
        };
        summary
    }

    /// The numbers of the simulation with the sum of its local errors, an estimate of its distance from the exact motion.
    fn entries(&self, neglected: Option<LocalError>) -> Entries {
        let Simulated {
            discrete, error, ..
        } = &self.result.simulated;
        let (steps, report) = (discrete.intervals(), discrete.report);
        let neglected = neglected.map(|error| {
            Entries::default()
                // Of the point where it is greatest, in m.
                .with("sum", error.error / 1e3)
                // Way of the point that goes farthest, in m.
                .with("path", error.path / 1e3)
                .with("relative", error.relative())
                // Order of the method.
                .with("order", error.order)
                // True if differences of the motion fall with their order; otherwise the estimate is no more than a warning.
                .with("is_resolved", error.is_resolved)
        });
        Entries::default()
            .with("steps", steps)
            .with("duration", discrete.times[steps] / 1e3)
            .with_some("local_error", neglected)
            .with("integrator", self.run.task.solving.integrator.name())
            .with_some("tolerance", self.run.task.tolerance)
            // In the unit of the tolerance; absent of equal steps.
            .with_some("estimated_error", error.map(|estimated| estimated.error))
            // True if steps of two other lengths confirm the estimate.
            .with_some(
                "is_confirmed",
                error.map(|estimated| estimated.is_confirmed),
            )
            .with("newton_iterations", report.iterations)
            .with("halved_steps", report.halved)
            .with("linear_solver", &discrete.solver)
            .with_some("multigrid", multigrid(report.multigrid, report.fallbacks))
            .with("factorisations", report.factorisations)
            // In rows and tangents.
            .with("assembly_seconds", report.assembly)
            .with("factorisation_seconds", report.factorisation)
            .with("solution_seconds", report.solution)
    }

    /// Adds what is observed to the summary, and the notes on it.
    fn summarise(&self, observed: &Observed, summary: &mut Summary) {
        let assessment = &observed.assessment;
        summary.task = self.entries(assessment.neglected);
        summary.domain.clone_from(&assessment.outside);
        summary.blocks.clone_from(&observed.blocks);
        summary.energies = blocks::energies(&assessment.exchange);
        summary.notes.clone_from(&assessment.remarks);
        summary.closed_loop.clone_from(&self.result.closed_loop);
        summary.notes.note("units", self.run.loaded.notes.clone());
        let left_out = self.disturbed.left_out.iter().cloned();
        summary.notes.warn("disturbance", left_out);
    }

    /// Writes tables, figures and page, next to the solution that the voltages come from, and adds what they show to the summary.
    fn write_pictures(
        &self,
        observed: &Observed,
        summary: &mut Summary,
        files: &mut FileSet,
        origin: &Origin,
    ) -> Result<(), WriteError> {
        let Simulated {
            model, discrete, ..
        } = &self.result.simulated;
        let Observed {
            trajectory,
            observations,
            assessment,
            ..
        } = observed;
        let (run, result) = (&self.run, &self.result);
        let (request, task, system) = (run.request, run.task, &run.loaded.system);
        let path = task.voltages.solution();
        let earlier = path.and_then(|path| comparison::earlier(model, path));
        summary.comparison = path
            .zip(earlier.as_ref())
            .map(|(path, earlier)| Comparison::new(model, path, trajectory, earlier));
        let motion = Motion {
            model,
            discrete,
            trajectory,
            observations,
        };
        let shown = DisplayedMotion::from_motion(motion, &run.loaded.output, true, summary, files)?;
        let mut content = summary.page("Simulation", Some(run.loaded));
        content.rows = rows(summary, task, model, discrete, assessment.neglected);
        let earlier = earlier.map(|earlier| shown.beside(earlier));
        let closed = result.closed_loop.as_ref();
        let open = closed.and_then(|closed| closed.open_loop.clone());
        let open = open.map(|open| shown.beside(open));
        let tracked = shown.tracked(closed.map_or(&[], |closed| &closed.tracked));
        let earlier = earlier.as_ref().map(|e| ("the solution", e));
        let held = held(task, result.reached());
        let pictures = report::Run {
            name: match closed {
                Some(_) => "with feedback",
                None => "simulation",
            },
            comparison: open.as_ref().map(|o| ("without feedback", o)).or(earlier),
            tracked: &tracked,
            disturbed: &self.disturbed.loops,
            held: held.as_deref(),
            figures: request.figures,
            page: request.page.of(&content),
            ..shown.run(system, origin)
        };
        write_run(files, &pictures)
    }

    /// The answer of the command.
    fn command_output(&self, folder: &Path, summary: &Summary) -> CommandOutput {
        let mut notes: Vec<String> = summary.message.iter().cloned().collect();
        notes.extend(summary.comparison.iter().flat_map(Comparison::notes));
        notes.extend(summary.notes.lines());
        if STOPPED.contains(&&*summary.status) && self.run.resumable.is_some() {
            notes.extend(resume_file::command(
                self.run.request,
                &self.run.loaded.task,
            ));
        }
        let mut is_solved = summary.status == "simulated";
        let mut word = match is_solved {
            true => "simulated".to_owned(),
            false => {
                let status = summary.status.replace('_', " ");
                match self.result.word() {
                    "simulated" => format!("simulated, not all written ({status})"),
                    _ => format!("not simulated to the end ({status})"),
                }
            }
        };
        if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
            notes.extend(accuracy.notes());
            (word, is_solved) = accuracy.outcome(&word);
        }
        CommandOutput {
            is_solved,
            result: format!(
                "{word}: {}, {} s of motion, {:.2} s, {}",
                counted(self.result.simulated.discrete.intervals(), "step"),
                shortest(self.result.reached() / 1e3, 9),
                summary.seconds.total,
                folder.display()
            ),
            notes,
        }
    }
}

/// Rows of the page; `neglected` is the sum of the local errors of the steps.
pub(super) fn rows(
    summary: &Summary,
    task: &Simulation,
    model: &Model,
    discrete: &DiscreteTrajectory,
    neglected: Option<LocalError>,
) -> Vec<(String, String)> {
    let reached = discrete.times[discrete.intervals()];
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = vec![
        row("steps", warnings::counted(discrete, task)),
        row("duration", format!("{} s", reached / 1e3)),
        row("method", method(task)),
        row("coordinates", model.coordinates.name().to_owned()),
    ];
    rows.extend(summary.rows());
    rows.extend(neglected.map(|error| {
        let words = format!(
            "{:.2e} m, {:.2} % of the path",
            error.error / 1e3,
            100.0 * error.relative()
        );
        row("sum of the local errors of the steps", words)
    }));
    rows
}

/// The method of a simulation in words.
fn method(task: &Simulation) -> String {
    let name = task.solving.integrator.name();
    match task.tolerance {
        Some(tolerance) => format!(
            "{name}, steps by a tolerance of {tolerance:e} (unequal steps keep momentum maps, not the energy over long times)"
        ),
        None => name,
    }
}

/// Voltages in V that the solution or table says to hold from the end of the motion on, which it reached.
pub(super) fn held(task: &Simulation, reached: f64) -> Option<Vec<f64>> {
    let table = task.voltages.table.as_ref()?;
    let is_held = table.afterwards == Afterwards::Held && reached >= table.time * (1.0 - 1e-9);
    is_held.then(|| task.voltages.at(table.time))
}
