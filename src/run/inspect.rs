//! What a problem consists of, before it is solved.

use std::path::Path;

use crate::control::problem::{Control, Task};
use crate::model::{Model, System};
use crate::nlp::Nlp;
use crate::report::atomic;
use crate::report::table;
use crate::run::blocks::Blocks;
use crate::run::effects::effect_counts;
use crate::run::error::RunError;
use crate::run::memory;
use crate::run::optimise::{Prepared, prepare, resolve};
use crate::run::request::{Request, Told};
use crate::run::solve::make_folder;
use crate::run::spy;
use crate::scene::read_problem;

/// Effects, unknowns, equations and nonzeros as a table; with a folder also pictures of Jacobian and Hessian.
///
/// # Errors
/// The input is wrong, or a picture cannot be written.
pub fn inspect(request: &Request) -> Result<Told, RunError> {
    let loaded = read_problem(&request.input, &request.set)?;
    let system = &loaded.system;
    memory::of_elements(&request.input, system)?;
    let wrong = |error| RunError::boundary(&request.input, key(&loaded.task), &error);
    let result = match &loaded.task {
        Task::Control(control) => of_control(request, system, control)?,
        Task::Simulate(task) => {
            let model = Model::answering(system.clone(), task.question(system, task.step))
                .map_err(|error| wrong(error.into()))?;
            of_model(&request.input, &model)?
        }
        Task::Equilibrium(task) => {
            let model = Model::answering(system.clone(), task.question(system))
                .map_err(|error| wrong(error.into()))?;
            of_model(&request.input, &model)?
        }
    };
    Ok(Told {
        is_solved: true,
        result,
        notes: Vec::new(),
    })
}

/// Key of a task in its file.
pub(super) fn key(task: &Task) -> &'static str {
    match task {
        Task::Control(_) => "control",
        Task::Simulate(_) => "simulate",
        Task::Equilibrium(..) => "equilibrium",
    }
}

fn of_model(file: &Path, model: &Model) -> Result<String, RunError> {
    let counts =
        effect_counts(model).map_err(|error| RunError::boundary(file, "scene", &error.into()))?;
    let mut rows = vec![
        [
            "effect",
            "kind",
            "elements",
            "unknowns",
            "equations",
            "nonzeros",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    rows.extend(counts.iter().map(|effect| {
        let mut row = vec![effect.name.clone(), effect.kind.to_owned()];
        let numbers = [
            effect.elements,
            effect.unknowns,
            effect.equations,
            effect.nonzeros,
        ];
        row.extend(numbers.map(|n| n.to_string()));
        row
    }));
    let system = &model.system;
    let mut sizes = vec![
        ("bodies", system.bodies.len()),
        ("joints", system.joints.len()),
        ("muscles", system.muscles.len()),
        ("markers", system.markers.len()),
        ("coordinates of an instant", model.coordinate_count()),
        ("multipliers of an instant", model.multiplier_names.len()),
        ("voltages of an interval", model.voltages.len()),
    ];
    if !system.solids.is_empty() {
        sizes.insert(3, ("elastic blocks", system.solids.len()));
    }
    if let Some(blocks) = Blocks::of(model) {
        sizes.extend([
            ("potentials of an interval", blocks.potentials),
            ("nodes", blocks.nodes),
            ("elements", blocks.elements),
        ]);
    }
    Ok(format!(
        "{}, {} coordinates\n\n{}\n{}",
        system.name,
        model.coordinates.name(),
        table::aligned(&rows),
        numbers(&sizes)
    ))
}

fn of_control(request: &Request, system: &System, control: &Control) -> Result<String, RunError> {
    let (model, boundary) = resolve(&request.input, system, control)?;
    let Prepared { program, start, .. } =
        prepare(&request.input, &model, &boundary, control, None)?;
    let (jacobian, hessian) = (program.jacobian_structure(), program.hessian_structure());
    let rows = program.constraints();
    let equalities = rows.lower.iter().zip(&rows.upper).filter(|(l, u)| l == u);
    let (variables, constraints) = (program.variables().lower.len(), rows.lower.len());
    let equalities = equalities.count();
    let sizes = [
        ("intervals", control.intervals),
        ("variables", variables),
        ("constraints", constraints),
        ("of them inequalities", constraints - equalities),
        (
            "degrees of freedom left",
            variables.saturating_sub(equalities),
        ),
        ("nonzeros of the Jacobian", jacobian.rows.len()),
        (
            "nonzeros of the Hessian (lower triangle)",
            hessian.rows.len(),
        ),
    ];
    let mut text = of_model(&request.input, &model)?;
    text.push_str(&format!(
        "\n{}start of the solver: {start:?}\n",
        numbers(&sizes)
    ));
    if let Some(folder) = &request.output {
        make_folder(folder)?;
        let origin = request.origin(false);
        let pictures = [
            ("jacobian.svg", "Jacobian", constraints, &jacobian),
            ("hessian.svg", "Hessian", variables, &hessian),
        ];
        for (file, name, rows, entries) in pictures {
            let shape = spy::Shape {
                name,
                rows,
                columns: variables,
            };
            let svg = spy::svg(shape, entries, &origin);
            atomic::write(&folder.join(file), svg.as_bytes())?;
        }
    }
    Ok(text)
}

fn numbers(sizes: &[(&str, usize)]) -> String {
    let rows: Vec<_> = sizes
        .iter()
        .map(|(name, count)| vec![(*name).to_owned(), count.to_string()])
        .collect();
    table::aligned(&rows)
}
