//! The command line: what is typed, passed on, and answered with a line and an exit status.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use proboscis::app::{self, CommandError, CommandInput, CommandOutput, ProgressDisplay, StartsIn};
use proboscis::files::printable;
use proboscis::ipopt::interrupt;
use proboscis::study::{StudyRequest, study};
use proboscis::workflow::accuracy::AccuracyTarget;
use tracing_subscriber::EnvFilter;

/// Simulation and optimal control of robots driven by dielectric elastomer muscles.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "Exit status: 0 solved; 1 no solution, or stopped early; 2 wrong input."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Solve a problem: find optimal voltages, or do what else its file asks.
    Solve {
        #[command(flatten)]
        problem: InTime,
        /// Stop after so many iterations of the solver; of a control problem only.
        #[arg(long, value_name = "N")]
        max_iterations: Option<usize>,
        /// Solve from so many starting points, its own guess and random ones, and keep the best.
        #[arg(long, value_name = "N", conflicts_with_all = ["accuracy", "estimate_error"])]
        starts: Option<usize>,
        /// Seed of the random starting points.
        #[arg(long, value_name = "SEED", default_value_t = 1, requires = "starts")]
        seed: u64,
        /// Solve from each starting point in a process of its own, in place of threads; with MUMPS it is always so.
        #[arg(long, requires = "starts")]
        processes: bool,
    },
    /// Simulate a problem forward in time, or do what else its file asks.
    Simulate(InTime),
    /// Find the static equilibrium of a problem, or of any scene under given voltages.
    Equilibrium {
        #[command(flatten)]
        problem: Problem,
        /// Voltages such as muscle2=1.7kV,muscle3=1.6kV; 0 where not named.
        #[arg(long, value_name = "MUSCLE=VOLTAGE", value_delimiter = ',')]
        voltages: Option<Vec<String>>,
    },
    /// Show what a problem consists of: effects, unknowns, equations, nonzeros.
    Inspect {
        #[command(flatten)]
        input: Input,
        /// Folder for pictures of Jacobian and Hessian; none are drawn where it is not given.
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
    },
    /// Compare the derivatives of a problem with differences.
    Check {
        #[command(flatten)]
        input: Input,
        /// Stop after so many seconds.
        #[arg(long, value_name = "S", value_parser = seconds)]
        max_seconds: Option<f64>,
    },
    /// Run variants of a problem, to see what accuracy costs in time.
    Study(Variants),
    /// Print a scene without shorthand.
    Expand {
        /// The scene file.
        scene: PathBuf,
    },
    /// Print the JSON Schema of a file.
    Schema {
        /// Which file.
        #[arg(default_value = "problem")]
        file: File,
    },
    /// Write a scene and a problem to start from.
    New {
        #[command(subcommand)]
        what: New,
    },
}

#[derive(Debug, Subcommand)]
enum New {
    /// A trunk of segments with two muscles at each joint, and its rest-to-rest problem.
    Trunk {
        /// Number of segments.
        #[arg(long, default_value_t = 6)]
        segments: usize,
        /// Folder for scene.json and problem.json.
        #[arg(default_value = ".")]
        folder: PathBuf,
    },
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum File {
    /// What exists.
    Scene,
    /// What is asked.
    Problem,
    /// Which variants of it are compared.
    Study,
}

#[derive(Args, Debug)]
struct Variants {
    /// The study file.
    study: PathBuf,
    /// Folder for the results [default: results/studies/<name of the study>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Time each point so many times, in place of what the study says.
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    runs: Option<u16>,
    /// Show no progress.
    #[arg(short, long)]
    quiet: bool,
}

impl Variants {
    fn request(self) -> StudyRequest {
        StudyRequest {
            command: typed(),
            input: self.study,
            output: self.output,
            runs: self.runs.map(usize::from),
            progress: shown(self.quiet),
        }
    }
}

#[derive(Args, Debug)]
struct Input {
    /// The problem file.
    problem: PathBuf,
    /// Override an entry, such as control.intervals=80 or scene.gravity=[0,-9.81,0]; may be repeated.
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
}

#[derive(Args, Debug)]
struct Problem {
    #[command(flatten)]
    input: Input,
    /// Folder for the results [default: results/<name of the problem>].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Stop after so many seconds.
    #[arg(long, value_name = "S", value_parser = seconds)]
    max_seconds: Option<f64>,
    /// Show no progress.
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Args, Debug)]
struct InTime {
    #[command(flatten)]
    problem: Problem,
    /// Double the number of intervals until the error of discretisation is estimated below this part of the objective, and
    /// below this part of the robot's size along the path and at the end.
    #[arg(long, value_name = "ERROR", value_parser = part)]
    accuracy: Option<f64>,
    /// Estimate the error of discretisation by a second run with twice the intervals; what is written stays the same.
    #[arg(long, conflicts_with = "accuracy")]
    estimate_error: bool,
}

impl InTime {
    fn request(self) -> CommandInput {
        let wanted = match (self.accuracy, self.estimate_error) {
            (Some(error), _) => Some(AccuracyTarget::Below(error)),
            (None, true) => Some(AccuracyTarget::Estimate),
            (None, false) => None,
        };
        CommandInput {
            wanted,
            ..self.problem.request()
        }
    }
}

impl Input {
    fn request(self) -> CommandInput {
        CommandInput {
            command: typed(),
            input: self.problem,
            set: self.set,
            output: None,
            max_seconds: None,
            max_iterations: None,
            wanted: None,
            progress: ProgressDisplay::Never,
        }
    }
}

impl Problem {
    fn request(self) -> CommandInput {
        CommandInput {
            output: self.output,
            max_seconds: self.max_seconds,
            progress: shown(self.quiet),
            ..self.input.request()
        }
    }
}

/// The command as typed.
fn typed() -> String {
    let words = std::env::args_os().skip(1);
    let words = words.map(|word| word.to_string_lossy().into_owned());
    let command = ["proboscis".to_owned()].into_iter().chain(words);
    command.collect::<Vec<_>>().join(" ")
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

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    tracing_subscriber::fmt()
        .with_writer(io::stderr)
        .with_env_filter(EnvFilter::from_default_env())
        .init();
    match answer(arguments.command) {
        Ok(told) => {
            for note in &told.notes {
                eprintln!("{note}");
            }
            // Whoever reads the answer may have gone, as `head` does.
            writeln!(io::stdout(), "{}", told.result.trim_end()).ok();
            ExitCode::from(if told.is_solved { 0 } else { 1 })
        }
        Err(error) => {
            eprintln!("error: {}", printable(&error.to_string()));
            if let Some(excerpt) = error.excerpt() {
                eprintln!("{}", excerpt.trim_end());
            }
            ExitCode::from(error.exit_status())
        }
    }
}

fn answer(command: Command) -> Result<CommandOutput, CommandError> {
    let text = |result: String| CommandOutput {
        is_solved: true,
        result,
        notes: Vec::new(),
    };
    match command {
        Command::Solve {
            problem,
            max_iterations,
            starts,
            seed,
            processes,
        } => {
            interrupt::install();
            let request = CommandInput {
                max_iterations,
                ..problem.request()
            };
            let run_in = match processes {
                true => StartsIn::Processes,
                false => StartsIn::Threads,
            };
            match starts {
                Some(starts) => app::solve_from_starts(&request, starts, seed, run_in),
                None => app::run(&request),
            }
        }
        Command::Simulate(problem) => {
            interrupt::install();
            app::run(&problem.request())
        }
        Command::Equilibrium { problem, voltages } => {
            interrupt::install();
            app::equilibrium_of_file(&problem.request(), voltages.as_deref())
        }
        Command::Inspect { input, output } => app::inspect(&CommandInput {
            output,
            ..input.request()
        }),
        Command::Check { input, max_seconds } => {
            interrupt::install();
            app::check(&CommandInput {
                max_seconds,
                ..input.request()
            })
        }
        Command::Study(variants) => {
            interrupt::install();
            study(&variants.request())
        }
        Command::Expand { scene } => app::expand(&scene).map(text),
        Command::Schema { file } => {
            let (scene, problem) = app::schema();
            Ok(text(match file {
                File::Scene => scene,
                File::Problem => problem,
                File::Study => app::study_schema(),
            }))
        }
        Command::New {
            what: New::Trunk { segments, folder },
        } => {
            let files = app::new_trunk(segments, &folder)?;
            let names = files.iter().map(|path| path.display().to_string());
            Ok(text(names.collect::<Vec<_>>().join("\n")))
        }
    }
}
