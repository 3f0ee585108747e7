//! Arguments of the command line: commands, options and their meaning.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use clap_complete::Shell;
use proboscis::app::{CommandInput, PageWanted, ProgressDisplay, RunIn};
use proboscis::report::viewpoint::Viewpoint;
use proboscis::report::{Figures, quoting};
use proboscis::sweep::Shard;
use proboscis::workflow::accuracy::AccuracyTarget;

/// Simulation and optimal control of robots driven by dielectric elastomer muscles.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Exit status: 0 solved; 1 no solution, or stopped early; 2 wrong input."
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Show events of solver and simulator on standard error; set RUST_LOG for finer filtering.
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run the task of a problem file: find optimal voltages, simulate, or find a state of rest.
    Solve {
        #[command(flatten)]
        problem: InTime,
        /// Maximum number of iterations of the solver; for control problems only.
        #[arg(long, value_name = "N")]
        max_iterations: Option<usize>,
        /// Solve from this number of starting points, the guess of the problem and random ones, and keep the best.
        #[arg(long, value_name = "N", conflicts_with_all = ["accuracy", "estimate_error", "from"])]
        starts: Option<usize>,
        /// Seed of the random starting points.
        #[arg(long, value_name = "SEED", default_value_t = 1, requires = "starts")]
        seed: u64,
        /// Solve from each starting point in a process of its own instead of a thread; always so with MUMPS.
        #[arg(long, requires = "starts")]
        processes: bool,
        /// Do nothing if the folder holds this result already, with all its files unchanged.
        #[arg(long, conflicts_with_all = ["starts", "from"])]
        once: bool,
    },
    /// Run a simulation problem forward in time; control problems are run by solve.
    Simulate(InTime),
    /// Find a stable static equilibrium of a problem, or of any scene under given voltages; exit status 1 where none is found.
    Equilibrium {
        #[command(flatten)]
        problem: Problem,
        /// Voltages such as muscle2=1.7kV,muscle3=1.6kV; 0 where not named.
        #[arg(long, value_name = "MUSCLE=VOLTAGE", value_delimiter = ',')]
        voltages: Option<Vec<String>>,
    },
    /// Find natural frequencies, damping ratios and shapes of vibrations about the state of rest of a problem, or of any scene under given voltages.
    Modes {
        #[command(flatten)]
        problem: Problem,
        /// Voltages such as muscle2=1.7kV,muscle3=1.6kV; 0 where not named.
        #[arg(long, value_name = "MUSCLE=VOLTAGE", value_delimiter = ',')]
        voltages: Option<Vec<String>>,
        /// Number of vibrations, those of lowest frequencies.
        #[arg(long, value_name = "N", default_value_t = 6)]
        count: usize,
    },
    /// Show the model of a problem: terms, unknowns, equations, nonzeros.
    Inspect {
        #[command(flatten)]
        input: Input,
        /// Folder for pictures of Jacobian and Hessian; without it none are drawn.
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Compare the derivatives of a problem with differences.
    Check {
        #[command(flatten)]
        input: Input,
        /// Time limit in seconds.
        #[arg(long, value_name = "S", value_parser = seconds)]
        max_seconds: Option<f64>,
    },
    /// Run variants of a problem to compare accuracy and computing time.
    Study(Variants),
    /// Solve many variants of a problem; variants that are solved already are skipped.
    Sweep(Sweep),
    /// Show results side by side on one page: overlaid curves, and a table of differences.
    Report {
        /// Folders of results, two or more.
        #[arg(required = true, num_args = 2.., value_name = "RESULT")]
        results: Vec<PathBuf>,
        /// Folder for the page.
        #[arg(short, long, value_name = "DIR", default_value = "results/report")]
        output: PathBuf,
    },
    /// Print a scene without shorthand.
    Expand {
        /// The scene file.
        scene: PathBuf,
    },
    /// List the materials with published constants, or print one of them with its source.
    Materials {
        /// Name of the material.
        name: Option<String>,
    },
    /// Print the JSON Schema of a file.
    Schema {
        /// Kind of file.
        #[arg(default_value = "problem")]
        file: File,
    },
    /// Write a scene and a problem as templates, with schemas for an editor, and print the next command.
    New {
        #[command(subcommand)]
        what: New,
    },
    /// Print the completion script of a shell.
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages of all commands.
    Man {
        /// Folder for them.
        #[arg(default_value = ".")]
        folder: PathBuf,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum New {
    /// A trunk of segments with two muscles at each joint, and its rest-to-rest problem.
    Trunk {
        /// Number of segments.
        #[arg(long, default_value_t = 6)]
        segments: usize,
        #[command(flatten)]
        files: NewFiles,
    },
    /// An arm of three links under gravity, with two muscles at each joint, steered to a posture.
    Arm(NewFiles),
    /// A finger of finite elements with two electrodes, which bends.
    Finger(NewFiles),
    /// A gripper of two fingers with two phalanges each, which closes.
    Gripper(NewFiles),
    /// A satellite that carries a trunk and tumbles freely.
    Satellite(NewFiles),
    /// The bodies and joints of a URDF file, which fall from rest; names on standard error what is left out.
    Urdf {
        /// The URDF file.
        urdf: PathBuf,
        #[command(flatten)]
        files: NewFiles,
    },
}

#[derive(Args, Debug)]
pub(crate) struct NewFiles {
    /// Folder for scene.json, problem.json and their schemas.
    #[arg(default_value = ".")]
    pub(crate) folder: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum File {
    /// Scene file.
    Scene,
    /// Problem file.
    Problem,
    /// Study file.
    Study,
    /// Sweep file.
    Sweep,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Export {
    /// motion.gltf: an animation of bodies, muscles, markers and elastic blocks, for Blender and other programs.
    Gltf,
    /// parts.pvd: bodies, muscles and markers for ParaView; elastic blocks always have such files.
    Paraview,
}

#[derive(Args, Debug)]
pub(crate) struct Variants {
    /// The study file.
    study: PathBuf,
    /// Folder for the results [default: results/studies/<name of the study>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Number of timed runs of each point, in place of that of the study.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    runs: Option<u16>,
    /// Show no progress.
    #[arg(short, long)]
    quiet: bool,
}

impl Variants {
    /// Its request, and the number of runs.
    pub(crate) fn request(self) -> (CommandInput, Option<usize>) {
        let request = of_variants("studies", self.study, self.output, self.quiet);
        (request, self.runs.map(usize::from))
    }
}

/// A request on the file of several variants, with results in a folder of that name where none is given.
fn of_variants(kind: &str, input: PathBuf, output: Option<PathBuf>, quiet: bool) -> CommandInput {
    let name = input.file_stem().unwrap_or_default();
    let own = Path::new("results").join(kind).join(name);
    CommandInput {
        command: typed(),
        input,
        output: Some(output.unwrap_or(own)),
        progress: shown(quiet),
        ..CommandInput::default()
    }
}

#[derive(Args, Debug)]
pub(crate) struct Sweep {
    /// The sweep file.
    sweep: PathBuf,
    /// Folder for the results [default: results/sweeps/<name of the sweep>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Solve each n-th variant from the i-th one, as one of n machines; the table lists all variants in the folder.
    #[arg(long, value_name = "i/n", default_value = "1/1")]
    shard: Shard,
    /// Engine that solves the variants.
    #[arg(long, value_name = "ENGINE", default_value = "threads")]
    engine: RunIn,
    /// Time limit in seconds.
    #[arg(long, value_name = "S", value_parser = seconds)]
    max_seconds: Option<f64>,
    /// Show no progress.
    #[arg(short, long)]
    quiet: bool,
}

impl Sweep {
    /// Its request, and the part of the variants that is solved with an engine.
    pub(crate) fn request(self) -> (CommandInput, Shard, RunIn) {
        let request = CommandInput {
            max_seconds: self.max_seconds,
            ..of_variants("sweeps", self.sweep, self.output, self.quiet)
        };
        (request, self.shard, self.engine)
    }
}

#[derive(Args, Debug)]
pub(crate) struct Input {
    /// The problem file; - for standard input.
    problem: PathBuf,
    /// Override an entry, such as control.intervals=80 or scene.gravity=[0,-9.81,0]; may be repeated, the last of a path counts.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
}

#[derive(Args, Debug)]
pub(crate) struct Problem {
    #[command(flatten)]
    input: Input,
    /// Folder for the results [default: results/<name of the problem>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Time limit in seconds.
    #[arg(long, value_name = "S", value_parser = seconds)]
    max_seconds: Option<f64>,
    /// Viewpoint of figures.
    #[arg(long, value_name = "VIEW", default_value = "oblique")]
    view: Viewpoint,
    /// Also write the motion in this format.
    #[arg(long, value_name = "FORMAT")]
    export: Vec<Export>,
    /// Print the summary, as in summary.json, in place of text.
    #[arg(long)]
    json: bool,
    /// Write no report.html.
    #[arg(long)]
    no_report: bool,
    /// Show no progress.
    #[arg(short, long, conflicts_with = "verbose")]
    quiet: bool,
}

#[derive(Args, Debug)]
pub(crate) struct InTime {
    #[command(flatten)]
    problem: Problem,
    /// Double the number of intervals until the error of discretisation is estimated below this part of the objective, and
    /// below this part of the robot's size along the path and at the end.
    #[arg(long, value_name = "ERROR", value_parser = part)]
    accuracy: Option<f64>,
    /// Estimate the error of discretisation by a second run with twice the intervals; the files written stay the same.
    #[arg(long, conflicts_with = "accuracy")]
    estimate_error: bool,
    /// Resume from the result in a folder, such as that of a stopped run: a simulation to the bit, a solve from its last point.
    #[arg(long, value_name = "DIR")]
    from: Option<PathBuf>,
}

impl InTime {
    pub(crate) const fn json(&self) -> bool {
        self.problem.json()
    }

    pub(crate) fn request(self) -> CommandInput {
        let wanted = match (self.accuracy, self.estimate_error) {
            (Some(error), _) => Some(AccuracyTarget::Below(error)),
            (None, true) => Some(AccuracyTarget::Estimate),
            (None, false) => None,
        };
        CommandInput {
            wanted,
            from: self.from,
            ..self.problem.request()
        }
    }
}

impl Input {
    pub(crate) fn request(self) -> CommandInput {
        CommandInput {
            command: typed(),
            input: self.problem,
            set: self.set,
            ..CommandInput::default()
        }
    }
}

impl Problem {
    /// Returns true if the summary is asked for in place of words.
    pub(crate) const fn json(&self) -> bool {
        self.json
    }

    pub(crate) fn request(self) -> CommandInput {
        CommandInput {
            output: self.output,
            max_seconds: self.max_seconds,
            figures: Figures {
                view: self.view,
                gltf: self.export.contains(&Export::Gltf),
                parts: self.export.contains(&Export::Paraview),
            },
            progress: shown(self.quiet),
            page: match self.no_report {
                true => PageWanted::LeftOut,
                false => PageWanted::Written,
            },
            ..self.input.request()
        }
    }
}

/// The command that was typed.
pub(crate) fn typed() -> String {
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| word.to_string_lossy().into_owned());
    let command = ["proboscis".to_owned()].into_iter().chain(words);
    quoting::command(command)
}

fn shown(quiet: bool) -> ProgressDisplay {
    match quiet {
        true => ProgressDisplay::Never,
        false => ProgressDisplay::OnTerminal,
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 => Ok(value),
        _ => Err("expected a positive number of seconds".to_owned()),
    }
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("expected a number between 0 and 1, such as 1e-3".to_owned()),
    }
}
