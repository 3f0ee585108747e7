//! Iterations with multigrid from the command line: their counts, and scenes without grids.

use crate::commands::summary;
use crate::common::signals::{Listening as _, interrupt};
use crate::runs::{problem, run, workshop};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const MULTIGRID: [&str; 2] = ["--set", "simulate.linear_solver=multigrid"];

#[test]
fn the_summary_has_iterations_grids_and_memory() {
    let folder = workshop();
    let folder = folder.path();
    let path = problem("block");
    let small = [
        "--set",
        "scene.solids.block.box.elements=[3,3,12]",
        "--set",
        "simulate.duration=1 ms",
    ];
    let words = |rest: &[&'static str], to: &'static str| {
        let mut words = vec!["simulate", &path];
        words.extend(small);
        words.extend(rest);
        words.extend(["-o", to]);
        let (status, said, notes) = run(folder, &words);
        assert_eq!(status, 0, "{said}{notes}");
        summary(folder, to)
    };
    let found = words(&MULTIGRID, "iterated");
    assert_eq!(found["linear_solver"], "GMRES with multigrid");
    let counts = &found["multigrid"];
    let count = |name: &str| counts[name].as_u64().unwrap();
    assert!(
        count("krylov_iterations") > 4 && count("levels") == 2,
        "{counts}"
    );
    assert!(
        count("bytes") > 100_000 && count("hierarchies") > 0,
        "{counts}"
    );
    assert_eq!(count("fallbacks"), 0);
    let found = words(&["--set", "simulate.linear_solver=auto"], "direct");
    assert!(found.get("multigrid").is_none(), "{found}");
}

#[test]
fn a_scene_without_grids_is_refused() {
    let folder = workshop();
    let path = problem("pair_constant");
    let words = [&["simulate", &path][..], &MULTIGRID, &["-o", "none"]].concat();
    let (status, _, said) = run(folder.path(), &words);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("simulate.linear_solver"), "{said}");
    assert!(said.contains("elastic blocks"), "{said}");
}

/// A voltage that hardly moves the block, so that a step takes one iteration.
#[cfg(unix)]
const STILL: &str = "simulate.voltages={\"block.stack\":\"1 V\"}";

/// Couplings of 10⁶ unknowns take several seconds to count, which nobody waits for behind a stop.
#[cfg(unix)]
#[test]
fn effects_of_a_large_block_are_not_counted_behind_a_stop() {
    let folder = workshop();
    let path = problem("block");
    let stopped = |elements: &str, duration: &str, to: &'static str| {
        let duration = format!("simulate.duration={duration}");
        let elements = format!("scene.solids.block.box.elements={elements}");
        let mut child = Command::new(assert_cmd::cargo::cargo_bin("proboscis"))
            .current_dir(folder.path())
            .args(["simulate", &path, "--set", &elements, "-o", to])
            .args(["--set", &duration, "--set", STILL])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn_listening()
            .unwrap();
        // The folder is made when the first step is told.
        while !folder.path().join(to).exists() {
            assert_eq!(child.try_wait().unwrap(), None, "it has ended");
            sleep(Duration::from_millis(20));
        }
        interrupt(&child);
        assert_eq!(child.wait().unwrap().code(), Some(1));
        let found = summary(folder.path(), to);
        assert_eq!(found["status"], "interrupted");
        let effects = found["effects"].as_array().map_or(0, Vec::len);
        (
            effects,
            found.to_string().contains("effects are not counted"),
        )
    };
    assert_eq!(stopped("[3,3,12]", "10 s", "small"), (3, false));
    assert_eq!(stopped("[18,18,72]", "10 ms", "large"), (0, true));
}
