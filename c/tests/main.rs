//! A program in C beside the library: the same inputs, and messages of what is wrong.

use proboscis::app::{FileHorizon, SiController};
use proboscis::workflow::receding::Source;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// Folder of the program under test, where the library for C is.
fn folder() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().to_owned()
}

/// The program in C, compiled once.
fn compiled() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(compile)
}

fn compile() -> PathBuf {
    let (here, folder) = (Path::new(env!("CARGO_MANIFEST_DIR")), folder());
    let program = folder.join("controller_of_c");
    let library = [folder.clone(), folder.parent().unwrap().to_owned()];
    let library = library
        .iter()
        .find(|one| one.join("libproboscis_c.so").exists());
    let library = library.expect("the library for C").display().to_string();
    let made = Command::new("cc")
        .args([
            "-std=c99",
            "-pedantic",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-O2",
        ])
        .arg(here.join("tests/controller.c"))
        .arg("-I")
        .arg(here.join("include"))
        .arg(format!("-L{library}"))
        .arg(format!("-Wl,-rpath,{library}"))
        .args(["-lproboscis_c", "-lm", "-o"])
        .arg(&program)
        .output()
        .unwrap();
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    program
}

fn problem(name: &str) -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.join("../problems").join(name)
}

fn run(program: &Path, problem: &Path, input: &str) -> Output {
    let mut child = Command::new(program)
        .arg(problem)
        .arg("6")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).ok();
    child.wait_with_output().unwrap()
}

#[test]
fn inputs_of_c_are_those_of_the_library() {
    let program = compiled();
    let pair = problem("pair.json");
    let horizon = FileHorizon::new(&pair, None, 6).unwrap();
    let mut controller = SiController::new(&horizon);
    let (mut text, mut expected) = (String::new(), Vec::new());
    let mut others = 0;
    for k in 0..30 {
        let time = horizon.interval() * f64::from(k);
        let state = [
            0.15 * (f64::from(k) / 30.0) + 1e-3,
            2.0 * f64::from(k % 3) - 2.0,
        ];
        let state = match k {
            12 => [f64::NAN, 0.0],
            _ => state,
        };
        let measured = (k != 9).then_some(&state[..]);
        match measured {
            Some([a, b]) => text.push_str(&format!("{time:?} {a:?} {b:?}\n")),
            _ => text.push_str(&format!("{time:?} late\n")),
        }
        let (source, inputs) = controller.step(time, measured);
        others += i32::from(source != Source::Plan);
        expected.push((
            Source::ALL.iter().position(|one| *one == source).unwrap(),
            inputs.to_vec(),
        ));
        controller.prepare();
    }
    assert_eq!(others, 2);
    let out = run(program, &pair, &text);
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let told = String::from_utf8(out.stdout).unwrap();
    let mut lines = told.lines();
    assert_eq!(lines.next(), Some("0.01 2 2"));
    let names: Vec<&str> = lines.by_ref().take(4).collect();
    let expected_names = [
        "coordinate of joint1 in rad",
        "rate of coordinate of joint1 in rad/s",
        "muscle1 in V",
        "muscle2 in V",
    ];
    assert_eq!(names, expected_names);
    for (source, inputs) in expected {
        let line: Vec<f64> = lines
            .next()
            .unwrap()
            .split(' ')
            .map(|one| one.parse().unwrap())
            .collect();
        assert_eq!(line[0], source as f64);
        assert_eq!(line[1..], inputs, "the same bits");
    }
    assert_eq!(lines.next(), Some("-1"));
}

#[test]
fn what_is_wrong_has_a_message() {
    let program = compiled();
    for (name, told) in [
        ("none.json", "none.json"),
        ("pair_constant.json", "only \"control\""),
        ("pair_feedback.json", "integral"),
    ] {
        let out = run(program, &problem(name), "");
        assert_eq!(out.status.code(), Some(1));
        let text = String::from_utf8(out.stdout).unwrap();
        assert!(text.contains(told), "{text}");
    }
}

/// A horizon that no memory holds has a message, and a time that is no time inputs.
#[test]
fn what_is_too_large_ends_no_program() {
    let pair = problem("pair.json");
    let refused = FileHorizon::new(&pair, None, 1_000_000_000).unwrap_err();
    let told = "found a horizon of 1000000000 intervals, expected no more than 10000 intervals";
    assert!(refused.to_string().contains(told), "{refused}");
    let text = "0.0 0.0 0.0\ninf 0.0 0.0\n1e30 0.0 0.0\n0.01 0.0 0.0\n";
    let out = run(compiled(), &pair, text);
    let told = String::from_utf8(out.stdout).unwrap();
    let steps: Vec<&str> = told.lines().skip(5).collect();
    assert_eq!(steps.len(), 5, "{told}");
    assert_eq!(steps[0], steps[1]);
    assert!(steps[..4].iter().all(|one| one.starts_with("0 ")), "{told}");
}
