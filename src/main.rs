//! The command line: reads arguments, runs the command, writes its answer, and sets the exit status.

mod arguments;
#[cfg(target_os = "linux")]
mod one_core;
mod words;

use std::env;
use std::io::{self, IsTerminal};
use std::path::Path;
use std::process::ExitCode;

use arguments::{Arguments, Command, File, New, typed};
use clap::{CommandFactory, Parser};
use clap_complete::Shell;
use proboscis::app::{self, CommandError, CommandInput, CommandOutput, RunIn, Template};
use proboscis::files::{lines, message, note, printable_json};
use proboscis::stop;
use proboscis::study::study;
use proboscis::sweep::sweep;
use tracing::Level;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::prelude::*;
use words::{Events, answered, tell};

/// The name of the program.
const NAME: &str = "proboscis";

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    one_core::end();
    let kept = stop::outlive_file_limit();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(other) => return helped(&other),
    };
    app::end_with_parent();
    show_events(arguments.verbose);
    if let Err(error) = kept {
        tracing::warn!("a file that grows beyond the limit of the process will end it: {error}");
    }
    match answer(arguments.command) {
        Ok(output) => {
            output.notes.iter().for_each(|one| tell(&note(one)));
            answered(&lines(&output.result), if output.is_solved { 0 } else { 1 })
        }
        Err(error) => {
            tell(&format!("error: {}", message(&error.to_string())));
            if let Some(excerpt) = error.excerpt() {
                tell(excerpt.trim_end());
            }
            ExitCode::from(error.exit_status())
        }
    }
}

/// The end of a command that asks for help or version, or is none.
fn helped(other: &clap::Error) -> ExitCode {
    let status = u8::try_from(other.exit_code()).unwrap_or(2);
    let mut typed = env::args_os();
    let is_plain = typed.all(|word| note(&word.to_string_lossy()) == word.to_string_lossy());
    if other.use_stderr() && !is_plain {
        tell(note(&other.to_string()).trim_end());
        return ExitCode::from(status);
    }
    let printed = other.print();
    match other.use_stderr() {
        true => ExitCode::from(status),
        false => words::printed(printed, status),
    }
}

/// Shows the events that the environment names, or all of the program's own, or its warnings.
fn show_events(verbose: bool) {
    let named = named_events();
    let is_plain = named.is_none() && !verbose;
    let is_coloured = io::stderr().is_terminal() && env::var_os("NO_COLOR").is_none();
    let level = if verbose { Level::DEBUG } else { Level::WARN };
    let shown = named.unwrap_or_else(|| Targets::new().with_target("proboscis", level));
    let events = tracing_subscriber::fmt::layer()
        .with_writer(Events::on_a_new_line)
        .log_internal_errors(false)
        .with_ansi(is_coloured);
    let events = match is_plain {
        true => events.without_time().with_target(false).boxed(),
        false => events.boxed(),
    };
    tracing_subscriber::registry()
        .with(events.with_filter(shown))
        .init();
}

/// The events for which `RUST_LOG` asks, as `proboscis::ipopt=trace,warn`.
fn named_events() -> Option<Targets> {
    let text = env::var("RUST_LOG").ok().filter(|text| !text.is_empty())?;
    match text.parse() {
        Ok(named) => Some(named),
        Err(error) => {
            tell(&format!("warning: RUST_LOG is ignored: {error}"));
            None
        }
    }
}

fn answer(command: Command) -> Result<CommandOutput, CommandError> {
    match command {
        Command::Solve {
            problem,
            max_iterations,
            starts,
            seed,
            processes,
            once,
        } => {
            let json = problem.json();
            let request = CommandInput {
                max_iterations,
                ..problem.request()
            };
            let run_in = match processes {
                true => RunIn::Processes,
                false => RunIn::Threads,
            };
            output_of(json, &request, |request| match starts {
                Some(starts) => app::solve_from_starts(request, None, starts, seed, run_in),
                None if once => app::run_once(request),
                None => app::run(request),
            })
        }
        Command::Simulate(problem) => {
            let json = problem.json();
            output_of(json, &problem.request(), app::simulate)
        }
        Command::Equilibrium { problem, voltages } => {
            let json = problem.json();
            output_of(json, &problem.request(), |request| {
                app::equilibrium_of_file(request, voltages.as_deref(), None)
            })
        }
        Command::Modes {
            problem,
            voltages,
            count,
        } => {
            let json = problem.json();
            output_of(json, &problem.request(), |request| {
                app::equilibrium_of_file(request, voltages.as_deref(), Some(count))
            })
        }
        Command::Inspect { input, output } => app::inspect(&CommandInput {
            output,
            ..input.request()
        }),
        Command::Check { input, max_seconds } => {
            stop::install(tell);
            app::check(&CommandInput {
                max_seconds,
                ..input.request()
            })
        }
        Command::Study(variants) => {
            stop::install(tell);
            let (request, runs) = variants.request();
            study(&request, runs)
        }
        Command::Sweep(variants) => {
            stop::install(tell);
            let (request, shard, run_in) = variants.request();
            sweep(&request, shard, run_in)
        }
        Command::Report { results, output } => app::compare(&typed(), &results, &output),
        Command::Expand { scene } => app::expand(&scene).map(text),
        Command::Materials { name } => app::materials(name.as_deref()).map(text),
        Command::Schema { file } => Ok(text(schema(file))),
        Command::New { what } => new_files(what),
        Command::Completions { shell } => Ok(text(completions(shell))),
        Command::Man { folder } => manual(&folder).map(text),
    }
}

/// The output of a command that prints a text.
fn text(result: String) -> CommandOutput {
    CommandOutput {
        is_solved: true,
        result,
        notes: Vec::new(),
    }
}

/// JSON Schema of the files of a kind.
fn schema(file: File) -> String {
    match file {
        File::Scene => app::schema().0,
        File::Problem => app::schema().1,
        File::Study => app::study_schema(),
        File::Sweep => app::sweep_schema(),
    }
}

/// Writes the files of a new robot.
fn new_files(what: New) -> Result<CommandOutput, CommandError> {
    let (template, folder) = match what {
        New::Trunk { segments, files } => (Template::Trunk { segments }, files.folder),
        New::Arm(files) => (Template::Arm, files.folder),
        New::Finger(files) => (Template::Finger, files.folder),
        New::Gripper(files) => (Template::Gripper, files.folder),
        New::Satellite(files) => (Template::Satellite, files.folder),
        New::Urdf { urdf, files } => return app::new_from_urdf(&urdf, &files.folder),
    };
    app::new_files(template, &folder)
}

/// The script by which a shell completes commands.
fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), NAME, &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Runs a command that writes a folder of results, and prints its message or its summary.
fn output_of(
    json: bool,
    request: &CommandInput,
    run: impl FnOnce(&CommandInput) -> Result<CommandOutput, CommandError>,
) -> Result<CommandOutput, CommandError> {
    stop::install(tell);
    let output = match run(request) {
        // What was found is told in the summary, which is written.
        Err(error) if json && error.unanswered().is_some() => CommandOutput {
            is_solved: false,
            result: String::new(),
            notes: vec![format!("error: {}", message(&error.to_string()))],
        },
        other => other?,
    };
    Ok(match json {
        true => CommandOutput {
            result: printable_json(&app::written_summary(request)?),
            ..output
        },
        false => output,
    })
}

/// Writes the manual pages, and returns their names.
fn manual(folder: &Path) -> Result<String, CommandError> {
    let mut names = Vec::new();
    let mut command = Arguments::command();
    command.build();
    page(&command, folder, &mut names)?;
    Ok(names.join("\n"))
}

/// Writes the page of a command and of those below it.
fn page(
    command: &clap::Command,
    folder: &Path,
    names: &mut Vec<String>,
) -> Result<(), CommandError> {
    let manual = clap_mangen::Man::new(command.clone());
    let mut written = Vec::new();
    manual.render(&mut written).expect("room for a page");
    let path = folder.join(manual.get_filename());
    app::write_file(&path, &written)?;
    names.push(path.display().to_string());
    let below = command.get_subcommands();
    below
        .filter(|one| one.get_name() != "help")
        .try_for_each(|one| page(one, folder, names))
}
