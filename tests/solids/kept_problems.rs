//! Kept problems of blocks on boxes by multigrid and by factors. As they are, they are compared by `make compare-solvers`.

use proboscis::control::problem::{AtRest, Simulation, Task};
use proboscis::dynamics::{
    MultigridUse, Newton, Solving, stable_equilibrium, stable_equilibrium_by,
};
use proboscis::files::read_problem;
use proboscis::model::{Model, System};
use proboscis::sparse::Backend;
use proboscis::tasks::{SimulationRequest, simulate};
use proboscis::workflow::Simulated;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Problems whose unknowns are those of box grids.
const ON_GRIDS: [&str; 12] = [
    "bending_actuator",
    "bending_actuator_step",
    "block",
    "cad_finger",
    "clamped_stack",
    "clamped_stack_step",
    "creeping_block_at_once",
    "free_flight",
    "pressed_beam",
    "prestretched_membrane",
    "pull_in",
    "stiffening_block",
];

/// Coarser meshes of some.
const COARSER: [(&str, &str); 5] = [
    ("bending_actuator", LAYERS),
    ("bending_actuator_step", LAYERS),
    ("block", "scene.solids.block.box.elements=[3,3,12]"),
    ("clamped_stack", "scene.solids.block.box.elements=[2,2,8]"),
    (
        "clamped_stack_step",
        "scene.solids.block.box.elements=[2,2,8]",
    ),
];
const LAYERS: &str = "scene.solids.beam.box.elements=[10,1,2]";

/// Problem files, by name.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    let found = std::fs::read_dir(folder).unwrap();
    let mut files: Vec<PathBuf> = found.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|end| end == "json"));
    files.sort();
    files
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    parts.fold(0.0, f64::max)
}

/// Error of a step with a tangent that is kept, relative to the length: `dynamics/contraction.rs` ends its iteration there.
const OF_STEP: f64 = 1e-10;

/// Compares motions with a new tangent in each iteration, and with one that is kept; returns the number of systems for which factors took over.
fn motions(system: &System, mut task: Simulation, steps: Option<usize>) -> usize {
    if let Some(steps) = steps {
        task.duration = task.duration.min(steps as f64 * task.step);
    }
    let run = |solving: Solving| {
        let task = Simulation {
            solving,
            ..task.clone()
        };
        let request = SimulationRequest::default();
        let observer = &mut |_: usize, _: &Model, _: &_| ControlFlow::Continue(());
        simulate(system, &task, request, observer)
            .unwrap()
            .simulated
    };
    let direct = run(Solving {
        backend: Some(Backend::Faer),
        newton: Newton::Full,
        ..Solving::default()
    });
    let mut fallbacks = 0;
    for newton in [Newton::Full, Newton::Modified] {
        let iterated = run(Solving {
            newton,
            multigrid: MultigridUse::Always,
            ..Solving::default()
        });
        let halved = [&direct, &iterated].map(|one| one.discrete.report.halved);
        if halved[0] != halved[1] {
            // Halves are other steps. Which ones Newton's method needs depends on its updates: potentials come to Gauss's law first on grids.
            println!("  {newton:?}: halved {halved:?} times: a tenth of the steps");
            task.step *= 0.1;
            task.duration *= 0.1;
            return motions(system, task, steps);
        }
        fallbacks += iterated.discrete.report.fallbacks;
        let allowed = match newton {
            Newton::Full => 1e-9,
            Newton::Modified => f64::max(1e-9, OF_STEP * direct.discrete.intervals() as f64),
        };
        compare_motions(&direct, &iterated, allowed);
    }
    fallbacks
}

/// Compares a motion by an iteration with that by factors.
fn compare_motions(direct: &Simulated, iterated: &Simulated, allowed: f64) {
    let length = direct.model.length();
    let [a, b] = [&direct.discrete, &iterated.discrete];
    assert!(direct.failure.is_none() && iterated.failure.is_none());
    assert!(b.report.multigrid.iterations > 0 && a.report.multigrid.iterations == 0);
    assert_eq!(a.z.len(), b.z.len());
    let greatest = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
    let moved = greatest(&mut a.z.iter().map(|z| apart(z, &a.z[0])));
    let error = greatest(&mut a.z.iter().zip(&b.z).map(|(a, b)| apart(a, b)));
    let scalars = a.scalars.iter().zip(&b.scalars);
    let potentials = greatest(&mut scalars.map(|(a, b)| apart(a, b)));
    let largest = greatest(&mut a.scalars.iter().flatten().map(|v| v.abs()));
    println!(
        "  moved {:.1e}, apart {:.1e} of the length, {:.1e} of the voltage, {:?}",
        moved / length,
        error / length,
        potentials / largest.max(1.0),
        b.report
    );
    assert!(moved > 1e-6 * length);
    assert!(error < allowed * length, "{error:e} of {length}");
    assert!(potentials <= 1e-9 * largest.max(1.0), "{potentials:e}");
}

/// Compares states of rest under a part of the voltages for which there is one.
fn rests(system: &System, task: &AtRest) -> usize {
    let model = Model::for_analysis(system.clone(), task.analysis(system)).unwrap();
    let start = model.reference_coordinates();
    for part in [1.0, 0.5] {
        let voltages: Vec<f64> = task.voltages.iter().map(|v| part * v).collect();
        let scalars = model.scalars(&voltages);
        let Ok(direct) = stable_equilibrium(&model, &start, &scalars) else {
            continue;
        };
        let iterated =
            stable_equilibrium_by(&model, &start, &scalars, MultigridUse::Always).unwrap();
        let error = apart(&direct.z, &iterated.z);
        let largest = voltages.iter().fold(0.0, |m, v| f64::max(m, v.abs()));
        let potentials = apart(&direct.scalars, &iterated.scalars);
        println!(
            "  at {part}: apart {:.1e} of the length, {:.1e} of the voltage, {:?}",
            error / model.length(),
            potentials / largest,
            iterated.on_grids
        );
        assert!(apart(&direct.z, &start) > 1e-6 * model.length());
        assert!(error < 1e-9 * model.length(), "{error:e}");
        assert!(potentials < 1e-9 * largest, "{potentials:e}");
        assert_eq!(direct.unstable, iterated.unstable);
        return iterated.on_grids.unwrap().1;
    }
    panic!("there is no equilibrium");
}

/// Compares all of them, in at most so many steps.
fn compare(small: bool, steps: Option<usize>) {
    let mut compared = Vec::new();
    for path in files() {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let mut overrides = Vec::new();
        if small {
            let coarser = COARSER.iter().filter(|(coarser, _)| *coarser == name);
            overrides.extend(coarser.map(|(_, change)| (*change).to_owned()));
        }
        let Ok(problem) = read_problem(&path, &overrides) else {
            continue;
        };
        let system = &problem.system;
        if system.solids.is_empty() || !system.bodies.is_empty() || !system.muscles.is_empty() {
            continue;
        }
        let analysis = match &problem.task {
            Task::Simulate(task) => task.analysis(system, task.step),
            Task::Equilibrium(task) => task.analysis(system),
            _ => {
                println!("{name}: neither a motion nor a rest");
                continue;
            }
        };
        let model = Model::for_analysis(system.clone(), analysis).unwrap();
        if let Err(why) = model.node_grids() {
            println!("{name}: {why}");
            continue;
        }
        println!("{name}: {} unknowns", model.variables.unknown_count());
        let fallbacks = match problem.task {
            Task::Simulate(task) => motions(system, task, steps),
            Task::Equilibrium(task) => rests(system, &task),
            _ => unreachable!("sorted out above"),
        };
        println!("  {fallbacks} systems by factors");
        compared.push(name);
    }
    assert_eq!(compared, ON_GRIDS);
}

#[test]
fn kept_problems_are_those_of_the_direct_solver_in_their_first_steps() {
    compare(true, Some(3));
}

#[test]
#[ignore = "long: run by make compare-solvers"]
fn kept_problems_are_those_of_the_direct_solver() {
    compare(false, None);
}
