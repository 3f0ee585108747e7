//! A simulation from file to folder.

use std::path::PathBuf;
use std::time::Instant;

use crate::app::blocks::BlockSizes;
use crate::app::comparison::{self, Comparison};
use crate::app::displayed_motion::{DisplayedMotion, Motion};
use crate::app::energy_summary::EnergySummary;
use crate::app::error::CommandError;
use crate::app::fields;
use crate::app::messages::counted;
use crate::app::moved_markers::moved_markers;
use crate::app::page;
use crate::app::progress::{Progress, Reached};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::resume_file;
use crate::app::simulation_page::{afterwards, held, rows};
use crate::app::solution_file;
use crate::app::summary::{self, MEASURED, Seconds, Summary};
use crate::app::unfinished::{self, Unfinished};
use crate::control::problem::Simulation;
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{
    DiscreteTrajectory, EnergyExchange, LocalError, OutOfDomain, StepError, local_error_of,
    observed, out_of_domain,
};
use crate::files::Loaded;
use crate::ipopt::{Status, interrupt};
use crate::math::join;
use crate::model::Model;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::{self, write_run};
use crate::workflow::EstimatedError;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::domain;
use crate::workflow::effects::Plan;
use crate::workflow::grids::integrate_to;
use crate::workflow::integrate::{grid, integrate_on};
use crate::workflow::motion::{solved, solved_of};
use crate::workflow::phase::phase;
use crate::workflow::steps;
use crate::workflow::stops;

/// Simulates and writes the folder; a motion that ends early is kept as far as it went.
pub(super) fn simulation(
    (request, asked): (&CommandInput, &[(String, String)]),
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
        // Steps that are halved begin anew: what is kept of them is no motion to go on with.
        resumable: request.wanted.is_none().then_some(&*problem),
    };
    let mut ended = integrate(&run, &problem, observer)?;
    phase("writing");
    let writing = Instant::now();
    let plan = Plan::from_model(&ended.model, None, MEASURED);
    let mut files = FileSet::in_folder(&ended.folder);
    let origin = request.origin(false);
    let observed = Observed::new(&run, &ended, &mut files, &origin)?;
    let mut summary = Summary::new(request, ended.word(), ended.model.coordinates.name());
    summary.plan = plan;
    summary.accuracy = ended.accuracy.take();
    summarise(&run, &ended, &observed, &mut summary);
    write_pictures(
        &run,
        &ended,
        &observed,
        (&mut summary, asked),
        &mut files,
        &origin,
    )?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    unfinished::done(&ended.folder);
    Ok(command_output(&run, &ended, &summary))
}

/// Refuses an estimate by halved steps of a motion whose steps follow a tolerance.
fn refuse_halving(request: &CommandInput, task: &Simulation) -> Result<(), CommandError> {
    if task.tolerance.is_none() || request.wanted.is_none() {
        return Ok(());
    }
    Err(CommandError::Problem {
        file: request.input.clone(),
        place: "simulate.step".to_owned(),
        reason: "steps are halved for --accuracy and --estimate-error: write a step; \"auto\" has a \"tolerance\" instead"
            .to_owned(),
    })
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

/// A simulation that has ended.
struct Ended {
    model: Model,
    discrete: DiscreteTrajectory,
    failure: Option<StepError>,
    /// Status of a run that was stopped before its end.
    stopped: Option<Status>,
    /// Error of steps by a tolerance, and of steps that were halved.
    error: Option<EstimatedError>,
    accuracy: Option<Accuracy>,
    /// Seconds before the first step, and in the steps.
    setup: f64,
    seconds: f64,
    folder: PathBuf,
}

impl Ended {
    /// Its status.
    fn word(&self) -> &'static str {
        match (&self.failure, self.stopped) {
            (Some(_), _) => "step_failed",
            (None, Some(stopped)) => stopped.word(),
            (None, None) => "simulated",
        }
    }

    /// Length of its motion in ms.
    fn reached(&self) -> f64 {
        self.discrete.times[self.discrete.intervals()]
    }
}

/// Simulates, in the steps of the task or in finer ones; `problem` is the text of the problem that a motion is resumed by.
fn integrate(
    run: &Run<'_>,
    problem: &str,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<Ended, CommandError> {
    let (request, system, task) = (run.request, &run.loaded.system, run.task);
    let from = request.from.as_ref();
    let begun = from.map(|from| resume_file::begun(from, problem, task));
    let begun = begun.transpose()?;
    let read = run.began.elapsed().as_secs_f64();
    let left = request.max_seconds.map(|s| s - read);
    let file = match run.resumable {
        Some(_) => resume_file::UNFINISHED,
        None => solution_file::UNFINISHED,
    };
    let mut unfinished = Unfinished::in_folder(request.folder(), file);
    let watch = interrupt::watch(left);
    let (simulated, accuracy) = {
        let (steps, _) = grid(task);
        let progress = Progress::of_steps(request.progress, steps);
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
        let found = match request.wanted {
            None => integrate_on(system, task, begun, |model, discrete| {
                observe(steps, model, discrete)
            })
            .map(|simulated| (simulated, None)),
            Some(wanted) => integrate_to(system, task, wanted, left, &mut observe)
                .map(|found| (found.run, Some(found.accuracy))),
        };
        found.map_err(CommandError::in_file(&request.input))?
    };
    // A finer grid that was stopped leaves the motion on the one before as it is.
    let reached = simulated.discrete.times[simulated.discrete.intervals()];
    let is_early = reached < task.duration * (1.0 - 1e-12);
    let stopped = interrupt::stop().filter(|_| is_early);
    drop(watch);
    Ok(Ended {
        folder: unfinished.made()?,
        model: simulated.model,
        discrete: simulated.discrete,
        failure: simulated.failure,
        stopped,
        error: simulated.error,
        accuracy,
        setup: read + simulated.setup,
        seconds: simulated.seconds,
    })
}

/// The motion of a simulation with what is observed of it.
struct Observed {
    motion: Trajectory,
    observations: Observations,
    exchange: EnergyExchange,
    outside: Vec<OutOfDomain>,
    /// The sum of the local errors of the steps.
    neglected: Option<LocalError>,
    blocks: Option<BlockSizes>,
}

impl Observed {
    /// Observes a motion, and writes it with its fields at the same time.
    fn new(
        run: &Run<'_>,
        ended: &Ended,
        files: &mut FileSet,
        origin: &Origin,
    ) -> Result<Self, WriteError> {
        let Ended {
            model, discrete, ..
        } = ended;
        let order = run.task.solving.integrator.order();
        let ends = [run.task.start.voltages(), None];
        // Of many steps each takes long, and most need no other.
        let (columns, (motion, written, (outside, neglected, exchange))) = join(
            || observed(model, discrete),
            || {
                let motion = Trajectory::from_discrete(model, discrete);
                let write = || {
                    let is_motion = motion.intervals() > 0;
                    if is_motion {
                        let kept = solved_of(model, discrete, motion.clone(), None);
                        solution_file::add(files, model, &kept)?;
                    }
                    let resumable = run.resumable.filter(|_| is_motion);
                    resume_file::add(files, discrete, resumable)?;
                    fields::write(files, model, discrete, origin)
                };
                let see = || {
                    (
                        out_of_domain(model, discrete),
                        local_error_of(model, (discrete, &motion), order),
                        EnergyExchange::new(&model.system, &motion, ends),
                    )
                };
                let (written, seen) = join(write, see);
                (motion, written, seen)
            },
        );
        let written = written?;
        let mut observations = motion.observe(&model.system);
        observations.columns.extend(columns);
        let blocks = BlockSizes::from_model(model);
        let blocks = blocks.map(|b| b.after(model, &observations, written));
        observations.columns.extend(exchange.columns());
        Ok(Self {
            motion,
            observations,
            exchange,
            outside,
            neglected,
            blocks,
        })
    }
}

/// Adds the numbers of a simulation to its summary, and the notes on them.
fn summarise(run: &Run<'_>, ended: &Ended, observed: &Observed, summary: &mut Summary) {
    let (task, discrete) = (run.task, &ended.discrete);
    summary.message = ended.failure.as_ref().map(ToString::to_string);
    summary.simulation = Some(summary::Simulation::new(
        (discrete, ended.error),
        task,
        observed.neglected,
    ));
    summary.domain = domain::records(&observed.outside);
    summary.blocks.clone_from(&observed.blocks);
    summary.seconds = Seconds {
        total: run.began.elapsed().as_secs_f64(),
        setup: ended.setup,
        solver: ended.seconds,
        ..Seconds::default()
    };
    summary.energies = EnergySummary::new(&observed.exchange);
    let remarks = &mut summary.notes;
    remarks.note("start", task.start.notes().iter().cloned());
    remarks.note("moved_marker", moved_markers(&run.loaded.system));
    remarks.warn("singular_loops", ended.model.loops.warning.clone());
    remarks.note("voltages_end", afterwards(task));
    remarks.note("step_divided", steps::divided(task));
    remarks.warn("outside_domain", domain::note(&summary.domain, true));
    remarks.note("stops", stops::notes(&run.loaded.system, &observed.motion));
    let coarse = steps::warning(observed.neglected, discrete, task);
    remarks.warn("coarse_steps", coarse);
    remarks.warn("tolerance_exceeded", steps::beyond(ended.error, task));
    remarks.warn("energy_balance", steps::unbalanced(discrete));
}

/// Writes tables, figures and page, next to the solution that the voltages come from, and adds what they show to the summary.
fn write_pictures(
    run: &Run<'_>,
    ended: &Ended,
    observed: &Observed,
    (summary, asked): (&mut Summary, &[(String, String)]),
    files: &mut FileSet,
    origin: &Origin,
) -> Result<(), WriteError> {
    let Ended {
        model, discrete, ..
    } = ended;
    let (request, task, system) = (run.request, run.task, &run.loaded.system);
    let path = task.voltages.solution();
    let earlier = path.and_then(|path| comparison::earlier(model, path));
    summary.comparison = path
        .zip(earlier.as_ref())
        .map(|(path, earlier)| Comparison::new(model, path, &observed.motion, earlier));
    let motion = Motion {
        model,
        discrete,
        trajectory: &observed.motion,
        observations: &observed.observations,
    };
    let shown = DisplayedMotion::from_motion(motion, &run.loaded.output, true, files)?;
    summary.notes.note("shown", shown.notes.iter().cloned());
    summary.shown = shown.part;
    let mut content = page::content("Simulation", summary, asked);
    content.rows = rows(summary, task, (model, discrete), observed.neglected);
    let earlier = earlier.map(|earlier| shown.beside(earlier));
    let pictures = report::Run {
        name: "simulation",
        comparison: earlier.as_ref().map(|e| ("the solution", e)),
        held: held(task, ended.reached()),
        figures: request.figures,
        page: request.page.of(&content),
        ..shown.run(system, origin)
    };
    write_run(files, &pictures)
}

/// The answer of the command.
fn command_output(run: &Run<'_>, ended: &Ended, summary: &Summary) -> CommandOutput {
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    notes.extend(summary.comparison.iter().flat_map(Comparison::notes));
    notes.extend(summary.notes.lines());
    if ended.stopped.is_some() && run.resumable.is_some() {
        notes.extend(resume_file::command(run.request, &run.loaded.task));
    }
    let mut is_solved = summary.status == "simulated";
    let mut word = match is_solved {
        true => "simulated".to_owned(),
        false => {
            let status = summary.status.replace('_', " ");
            format!("not simulated to the end ({status})")
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
            counted(ended.discrete.intervals(), "step"),
            ended.reached() / 1e3,
            summary.seconds.total,
            ended.folder.display()
        ),
        notes,
    }
}
