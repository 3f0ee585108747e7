//! Iterations with multigrid from the command line: their counts, and scenes without grids.

use crate::commands::summary;
use crate::runs::{problem, run, workshop};

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
