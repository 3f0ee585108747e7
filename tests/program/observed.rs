//! Problems from a text in memory, observed while they run and stopped by request.

use crate::runs::{problem, read};
use proboscis::app::{
    CommandInput, CommandOutput, PageWanted, ProgressDisplay, Reached, RunIn, changed_text,
    check_text, checked, inspected, run_observed, solve_from_starts, with_program,
};
use proboscis::report::Figures;
use proboscis::stop::{self, Questions, StopRequest};
use std::path::{Path, PathBuf};
use std::{fs, thread};

/// A file that does not exist, beside the kept problems.
fn nowhere() -> PathBuf {
    Path::new(&problem("pair")).with_file_name("nowhere.json")
}

fn text(name: &str) -> String {
    fs::read_to_string(problem(name)).unwrap()
}

fn solve(
    name: &str,
    text: Option<&str>,
    output: &Path,
    observer: &mut dyn FnMut(Reached<'_>),
) -> CommandOutput {
    let input = match text {
        Some(_) => nowhere(),
        None => problem(name).into(),
    };
    run_observed(&request(input, output), text, observer).unwrap()
}

fn request(input: PathBuf, output: &Path) -> CommandInput {
    CommandInput {
        command: "proboscis".to_owned(),
        input,
        set: Vec::new(),
        output: Some(output.to_owned()),
        max_seconds: None,
        max_iterations: None,
        from: None,
        wanted: None,
        figures: Figures::default(),
        progress: ProgressDisplay::Never,
        page: PageWanted::Written,
        once: false,
    }
}

#[test]
fn a_text_is_solved_as_the_file_and_every_iterate_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let [of_file, of_text] = ["file", "text"].map(|name| folder.path().join(name));
    assert!(!nowhere().exists());
    let mut heard = Vec::new();
    let mut hear = |reached: Reached<'_>| match reached {
        Reached::Iteration(20, report) => heard.push(report.iteration),
        other => panic!("{other:?}"),
    };
    assert!(solve("pair", Some(&text("pair")), &of_text, &mut hear).is_solved);
    assert!(solve("pair", None, &of_file, &mut |_| {}).is_solved);
    let [one, other] = [&of_file, &of_text].map(|f| fs::read(f.join("solution.json")).unwrap());
    assert!(one == other);
    let iterations = read(of_text.join("summary.json"))["iterations"].as_u64();
    assert!(heard.len() > 5 && heard.iter().copied().eq(0..heard.len()));
    assert_eq!(iterations, Some(heard.len() as u64 - 1));
}

#[test]
fn a_request_stops_the_thread_that_listens_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let request = StopRequest::default();
    let listening = thread::scope(|scope| {
        let stopped = scope.spawn(|| {
            stop::listen(&request);
            let mut stop = |reached: Reached<'_>| match reached {
                Reached::Iteration(_, report) if report.iteration == 3 => request.make(),
                _ => {}
            };
            let told = solve("pair", None, &folder.path().join("stopped"), &mut stop);
            (told, stop::requested())
        });
        stopped.join().unwrap()
    });
    assert!(!listening.0.is_solved && listening.1);
    let summary = read(folder.path().join("stopped/summary.json"));
    assert_eq!(summary["status"], "interrupted");
    assert_eq!(summary["iterations"], 3);
    assert!(!stop::requested());
    let again = solve("pair", None, &folder.path().join("again"), &mut |_| {});
    assert!(again.is_solved);
}

#[test]
fn a_request_stops_a_motion_after_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let request = StopRequest::default();
    let mut times = Vec::new();
    thread::scope(|scope| {
        scope.spawn(|| {
            stop::listen(&request);
            let mut stop = |reached: Reached<'_>| match reached {
                Reached::Step(step, time) => {
                    times.push(time);
                    if step == 4 {
                        request.make();
                    }
                }
                other => panic!("{other:?}"),
            };
            solve("pair_constant", None, folder.path(), &mut stop)
        });
    });
    let summary = read(folder.path().join("summary.json"));
    assert_eq!(summary["status"], "interrupted");
    assert_eq!((summary["steps"].as_u64(), times.len()), (Some(4), 4));
    assert_eq!(summary["duration"].as_f64(), Some(times[3] / 1e3));
}

/// Files of a folder but those that are always written.
fn tables_and_figures(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| {
        let name = entry.unwrap().file_name();
        name.to_string_lossy().into_owned()
    });
    let kept = ["summary.json", "continuation.npz", "solution.json"];
    let mut others: Vec<_> = names.filter(|name| !kept.contains(&&**name)).collect();
    others.sort();
    others
}

/// Rows of `trajectory.csv`.
fn rows(folder: &Path) -> String {
    let table = fs::read_to_string(folder.join("trajectory.csv")).unwrap();
    table.split_once('\n').unwrap().1.to_owned()
}

#[test]
fn writing_ends_with_the_time_and_goes_on_from_what_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    let mut steps = 0;
    let mut count = |_: Reached<'_>| steps += 1;
    assert!(solve("pair_constant", None, &whole, &mut count).is_solved);
    assert!(steps > 10);
    fs::create_dir(&out).unwrap();
    // The last step; a step on the way, where one second stands for two questions; and for as many as it takes.
    for (last, grace, written) in [(steps, 0, false), (4, 2, false), (4, u64::MAX, true)] {
        for name in tables_and_figures(&whole) {
            fs::copy(whole.join(&name), out.join(&name)).unwrap();
        }
        let questions = Questions::allowed(u64::MAX);
        questions.grant(grace);
        let mut stop = |reached: Reached<'_>| match reached {
            Reached::Step(step, _) if step == last => questions.end_after(0),
            _ => {}
        };
        let watch = stop::watch_questions(&questions);
        let told = solve("pair_constant", None, &out, &mut stop);
        drop(watch);
        let summary = read(out.join("summary.json"));
        assert_eq!(summary["status"], "time_limit", "{told:?}");
        assert_eq!(summary["steps"].as_u64(), Some(last as u64));
        assert!(!told.is_solved, "{told:?}");
        let is_warned = told.notes.iter().any(|note| note.contains("left out"));
        assert_eq!(is_warned, !written, "{told:?}");
        match written {
            true => assert_eq!(tables_and_figures(&out), tables_and_figures(&whole)),
            false => assert!(tables_and_figures(&out).is_empty()),
        }
        let mut on = request(problem("pair_constant").into(), &out);
        on.from = Some(out.clone());
        let told = run_observed(&on, None, &mut |_| {}).unwrap();
        assert!(told.is_solved, "{told:?}");
        assert!(rows(&out) == rows(&whole) && rows(&out).lines().count() > steps);
    }
}

#[test]
fn an_optimum_is_kept_where_its_writing_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    let run = |out: &Path, questions: &Questions| {
        let _watch = stop::watch_questions(questions);
        solve("pair", None, out, &mut |_| {})
    };
    let all = Questions::allowed(u64::MAX);
    assert!(run(&whole, &all).is_solved);
    // Before the last files.
    let questions = Questions::allowed(all.asked() - 3);
    questions.grant(0);
    let told = run(&out, &questions);
    assert!(
        !told.is_solved && told.result.starts_with("solved (time limit)"),
        "{told:?}"
    );
    let warning = told.notes.iter().find(|note| note.contains("left out"));
    assert!(
        warning.is_some_and(|note| note.starts_with("warning: ")),
        "{told:?}"
    );
    assert_eq!(read(out.join("summary.json"))["status"], "time_limit");
    assert!(tables_and_figures(&out).is_empty() && tables_and_figures(&whole).len() > 3);
    let [one, other] = [&out, &whole].map(|f| fs::read(f.join("solution.json")).unwrap());
    assert!(one == other);
}

#[test]
fn a_text_is_checked_and_its_program_handed_out() {
    let path = nowhere();
    assert_eq!(check_text(&path, &text("pair"), &[]).unwrap(), "control");
    let other = check_text(&path, &text("pair_constant"), &[]).unwrap();
    assert_eq!(other, "simulate");
    let wrong = text("pair").replace("\"intervals\": 20", "\"intervals\": -3");
    let error = check_text(&path, &wrong, &[]).unwrap_err();
    assert_eq!(error.place(), "control.intervals");
    assert!(error.to_string().contains("nowhere.json"), "{error}");
    let error = with_program(&path, &text("pair_constant"), |_, _| ()).unwrap_err();
    assert_eq!(error.place(), "simulate");
    let [n, m, start] = with_program(&path, &text("pair"), |program, start| {
        [
            program.variables().lower.len(),
            program.constraints().lower.len(),
            start.len(),
        ]
    })
    .unwrap();
    assert!(n > m && m > 20 && n == start);
}

#[test]
fn a_change_in_the_scene_of_a_file_is_written_into_the_problem() {
    let path = nowhere();
    let set = |words: &[&str]| {
        words
            .iter()
            .map(|&word| word.to_owned())
            .collect::<Vec<_>>()
    };
    let parsed = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    let asked = set(&["control.intervals=7"]);
    let apart = parsed(&changed_text(&path, &text("pair"), &asked).unwrap());
    assert_eq!(apart["control"]["intervals"], 7);
    assert_eq!(apart["scene"], parsed(&text("pair"))["scene"]);
    let stiff = set(&["scene.materials.silicone.shear_modulus=90 kPa"]);
    let changed = changed_text(&path, &text("pair"), &stiff).unwrap();
    let modulus = &parsed(&changed)["scene"]["materials"]["silicone"]["shear_modulus"];
    assert_eq!(modulus, "90 kPa");
    assert_eq!(check_text(&path, &changed, &[]).unwrap(), "control");
    let wrong = set(&["scene.materials.silicone.shear_modulus=90 mm"]);
    let error = changed_text(&path, &text("pair"), &wrong).unwrap_err();
    assert_eq!(error.place(), "materials.silicone.shear_modulus");

    // The mesh beside the scene is found from beside the problem.
    let folder = tempfile::tempdir().unwrap();
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/block_v4.msh");
    fs::create_dir(folder.path().join("scenes")).unwrap();
    fs::copy(mesh, folder.path().join("scenes/block.msh")).unwrap();
    let scene = r#"{"name": "block", "materials": {"silicone": {"density": 1000, "shear_modulus": "100 kPa", "lame_lambda": "400 kPa"}},
        "solids": [{"name": "cube", "material": "silicone", "mesh": "block.msh", "unit": "1 mm"}]}"#;
    fs::write(folder.path().join("scenes/scene.json"), scene).unwrap();
    let here = folder.path().join("problem.json");
    let asked = r#"{"scene": "scenes/scene.json", "simulate": {"duration": "1 ms"}}"#;
    let soft = set(&["scene.materials.silicone.shear_modulus=50 kPa"]);
    let changed = changed_text(&here, asked, &soft).unwrap();
    assert_eq!(
        parsed(&changed)["scene"]["solids"][0]["mesh"],
        "scenes/block.msh"
    );
    assert_eq!(check_text(&here, &changed, &[]).unwrap(), "simulate");
}

#[test]
fn a_text_is_inspected_and_its_derivatives_are_compared() {
    let request = request(nowhere(), Path::new(""));
    let request = CommandInput {
        output: None,
        ..request
    };
    let found = inspected(&request, Some(&text("pair"))).unwrap();
    let n = with_program(&nowhere(), &text("pair"), |_, start| start.len()).unwrap();
    assert_eq!((found.sizes["variables"], found.sizes["muscles"]), (n, 2));
    assert_eq!(found.coordinates, "reduced");
    assert!(
        found
            .plan
            .effects
            .iter()
            .any(|effect| effect.name == "muscle electroelasticity")
    );
    let found = checked(&request, Some(&text("pair"))).unwrap();
    let report = &found.report;
    assert!(found.agrees && report.wrong.is_empty() && report.checked == n && found.variables == n);
    assert!(report.jacobian > 0.0 && report.hessian < 1e-5);
}

#[test]
fn a_request_stops_the_solves_that_a_thread_has_begun() {
    let folder = tempfile::tempdir().unwrap();
    let asked = request(nowhere(), folder.path());
    let starts = |request: &StopRequest| {
        stop::listen(request);
        solve_from_starts(&asked, Some(&text("pair")), 3, 1, RunIn::Here).unwrap()
    };
    let [before, none] = [StopRequest::default(), StopRequest::default()];
    before.make();
    let [stopped, solved] = [before, none]
        .map(|request| thread::scope(|scope| scope.spawn(|| starts(&request)).join().unwrap()));
    assert!(!stopped.is_solved && solved.is_solved);
    let table = fs::read_to_string(folder.path().join("starts.csv")).unwrap();
    assert_eq!(table.matches(",solved,").count(), 3, "{table}");
}
