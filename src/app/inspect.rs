//! Inspection of a problem before it is solved: its terms, unknowns, equations and nonzeros.

use crate::app::blocks;
use crate::app::error::CommandError;
use crate::app::kept::record::make_folder;
use crate::app::program::joined;
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::app::task::read;
use crate::control::Motions;
use crate::control::problem::{Control, Task};
use crate::identify;
use crate::mesh::triangulated::Surface;
use crate::model::system::{Body, Shape};
use crate::model::{Loops, Model, Role, System};
use crate::nlp::{Entries, Nlp};
use crate::report::canvas::{Align, Stroke, rectangle};
use crate::report::origin::Origin;
use crate::report::view::corners;
use crate::report::{atomic, canvas, style, table};
use crate::sparse::Symmetry;
use crate::tasks::check::moved_markers;
use crate::workflow::WorkflowError;
use crate::workflow::effects::Plan;
use crate::workflow::program::{Counted, Prepared, prepare, resolve};
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;

/// The plan: model terms in numbers, their reasons, and absent terms; with sizes; with a folder also pictures of Jacobian and Hessian.
///
/// # Errors
/// The input is wrong, or a picture cannot be written.
pub fn inspect(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let found = inspected(request, None)?;
    Ok(CommandOutput {
        is_solved: true,
        result: found.words,
        notes: found
            .notes
            .iter()
            .map(|note| format!("note: {note}"))
            .collect(),
    })
}

/// Terms and sizes of a problem.
#[derive(Clone, Debug, Serialize)]
pub struct Inspected {
    /// Name of the scene.
    pub system: String,
    /// `reduced` or `redundant`.
    pub coordinates: &'static str,
    /// Model terms in numbers, and absent terms.
    #[serde(flatten)]
    pub plan: Plan,
    /// Numbers of parts, of unknowns, and of entries of the program of a control problem, by what they count.
    pub sizes: BTreeMap<&'static str, usize>,
    /// Closing constraints of loops that are left out, as they follow from the others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
    /// Several motions by their names, each by itself; the sizes beside them are those of the program of all.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub motions: BTreeMap<String, Self>,
    /// All of it in words.
    #[serde(skip)]
    words: String,
    /// Notes next to it.
    #[serde(skip)]
    notes: Vec<String>,
}

/// Returns the same as numbers. The problem may be given as `text`; the path is then used for messages and relative paths.
///
/// # Errors
/// As of [`inspect`].
pub fn inspected(request: &CommandInput, text: Option<&str>) -> Result<Inspected, CommandError> {
    let loaded = read(&request.input, text, &request.set)?;
    let system = &loaded.system;
    let wrong = |error| {
        CommandError::in_file(&request.input)(WorkflowError::boundary(key(&loaded.task), &error))
    };
    let of_analysis = |analysis| {
        let model = Model::for_analysis(system.clone(), analysis);
        model
            .map(|model| of_model(&model, None))
            .map_err(|error| wrong(error.into()))
    };
    let mut found = match &loaded.task {
        Task::Control(control) => of_control(request, system, control),
        Task::Motions(motions) => of_motions(request, motions),
        Task::Simulate(task) => of_analysis(task.analysis(system, task.step)),
        Task::Equilibrium(task) => of_analysis(task.analysis(system)),
        Task::Identify(task) => {
            let model = identify::first_model(system, task).map_err(|error| {
                CommandError::problem(&request.input, key(&loaded.task), error.to_string())
            })?;
            Ok(of_model(&model, None))
        }
    }?;
    found.notes = moved_markers(system);
    Ok(found)
}

/// Time in s that goes into measuring each effect.
const MEASURED: f64 = 5e-3;

fn of_model(model: &Model, control: Option<&Control>) -> Inspected {
    let plan = Plan::from_model(model, control, MEASURED);
    let system = &model.system;
    let count = |role| model.variables.count(role);
    let mut sizes = vec![
        ("bodies", system.bodies.len()),
        ("joints", system.joints.len()),
        ("muscles", system.muscles.len()),
        ("markers", system.markers.len()),
        ("coordinates of an instant", count(Role::Coordinate)),
        ("multipliers of an instant", count(Role::Multiplier)),
        ("voltages of an interval", count(Role::Voltage)),
    ];
    if count(Role::Load) > 0 {
        sizes.push(("loads of an interval", count(Role::Load)));
    }
    if let Some(mobility) = model.loops.mobility {
        sizes.push(("degrees of freedom with loops closed", mobility));
    }
    let prescribed = ("prescribed coordinates", model.prescribed.len());
    let kinds = system.components.counts().into_iter().chain([prescribed]);
    sizes.splice(3..3, kinds.filter(|(_, count)| *count > 0));
    if !system.solids.is_empty() {
        sizes.insert(3, ("elastic blocks", system.solids.len()));
    }
    let blocks = blocks::sizes(model);
    if !blocks.is_empty() {
        sizes.extend([
            ("potentials of an interval", count(Role::Potential)),
            ("nodes", blocks.values().map(|block| block.nodes).sum()),
            (
                "elements",
                blocks.values().map(|block| block.elements).sum(),
            ),
        ]);
    }
    let tangent = match (model.analysis.of_motion, control) {
        (true, None) => factorisation(model),
        _ => "",
    };
    let reasons = plan.effects.iter().map(|e| (&e.name, &e.why));
    let missing = plan.absent.iter().map(|a| (&a.name, &a.why));
    let words = format!(
        "{}, {} coordinates\n\n{}\n{}\n{}\n{}{}{tangent}{}{}",
        system.name,
        model.coordinates.name(),
        active(&plan),
        listed("active because of", reasons),
        listed("inactive", missing),
        left_out(&model.loops),
        numbers(&sizes),
        unit_questions(system),
        meshed_bodies(system)
    );
    Inspected {
        system: system.name.clone(),
        coordinates: model.coordinates.name(),
        plan,
        sizes: sizes.into_iter().collect(),
        left_out: model.loops.left_out().map(str::to_owned).collect(),
        motions: BTreeMap::new(),
        words,
        notes: Vec::new(),
    }
}

/// Mass, centre of mass and principal moments of inertia of bodies from meshes.
fn meshed_bodies(system: &System) -> String {
    let is_meshed = |body: &&Body| matches!(body.shape, Shape::Surface(_));
    let bodies = system.bodies.iter().filter(is_meshed);
    let line = |body: &Body| {
        let [x, y, z] = body.centre.into();
        let [a, b, c] = body.inertia;
        format!(
            "{}: {:.4} g, centre of mass ({x:.3}, {y:.3}, {z:.3}) mm, moments of inertia {a:.4}, {b:.4}, {c:.4} g mm²\n",
            body.name, body.mass
        )
    };
    bodies.map(line).collect()
}

/// Names the closing constraints that are left out, and warns of a singular reference.
fn left_out(loops: &Loops) -> String {
    let mut text = String::new();
    if !loops.is_empty() {
        let names = loops.left_out().map(|name| format!("  {name}\n"));
        let names: String = names.collect();
        text = format!(
            "left out of loops, as they follow from the other constraints along the motion\n{names}\n"
        );
    }
    if let Some(warning) = &loops.warning {
        text.push_str(&format!("warning: {warning}\n\n"));
    }
    text
}

/// Names the factorisation of the tangent of a step.
fn factorisation(model: &Model) -> &'static str {
    match model.step_symmetry() {
        Symmetry::Symmetric => {
            "tangent of a step: symmetric, LDLᵀ, as every coordinate is a node's and every force has a potential\n"
        }
        Symmetry::Unsymmetric => {
            "tangent of a step: not symmetric, LU; LDLᵀ of its symmetric part where the modified Newton method corrects the rest\n"
        }
    }
}

/// The effects in numbers.
fn active(plan: &Plan) -> String {
    let has_hessian = plan.effects.iter().any(|e| e.hessian.is_some());
    let mut header = vec!["effect", "kind", "elements", "unknowns", "equations"];
    header.push(if has_hessian { "Jacobian" } else { "tangent" });
    if has_hessian {
        header.push("Hessian");
    }
    header.push("µs");
    let mut rows = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for effect in &plan.effects {
        let mut row = vec![effect.name.clone(), effect.kind.to_owned()];
        let counts = [effect.elements, effect.unknowns, effect.equations];
        row.extend(counts.map(|n| n.to_string()));
        row.push(effect.jacobian.to_string());
        row.extend(effect.hessian.map(|n| n.to_string()));
        row.push(format!("{:.2}", effect.microseconds));
        rows.push(row);
    }
    table::aligned(&rows)
}

/// Lists names under a heading with their texts, in two columns.
fn listed<'a>(heading: &str, lines: impl Iterator<Item = (&'a String, &'a String)>) -> String {
    let lines: Vec<_> = lines.collect();
    let widths = lines.iter().map(|(name, _)| name.chars().count());
    let width = widths.max().unwrap_or(0);
    let mut text = format!("{heading}\n");
    for (name, why) in lines {
        text.push_str(&format!("  {name:<width$}  {why}\n"));
    }
    text
}

fn of_control(
    request: &CommandInput,
    system: &System,
    control: &Control,
) -> Result<Inspected, CommandError> {
    let (model, boundary) =
        resolve(system, control).map_err(CommandError::in_file(&request.input))?;
    let Prepared { program, start, .. } = prepare(&model, &boundary, control, None, Counted::Yes)
        .map_err(CommandError::in_file(&request.input))?;
    let (jacobian, hessian) = (program.jacobian_structure(), program.hessian_structure());
    let [variables, constraints] =
        [program.variables(), program.constraints()].map(|bounds| bounds.count());
    let intervals = match control.is_refined {
        true => "intervals of the first grid",
        false => "intervals",
    };
    let mut sizes = vec![(intervals, control.intervals)];
    sizes.extend(program_sizes(&program));
    let mut found = of_model(&model, Some(control));
    found.words.push_str(&format!(
        "\n{}start of the solver: {start:?}\n",
        numbers(&sizes)
    ));
    found.sizes.extend(sizes);
    let notes = boundary.notes.iter();
    notes.for_each(|note| found.words.push_str(&format!("note: {note}\n")));
    if let Some(folder) = &request.output {
        make_folder(folder)?;
        let origin = request.origin(false);
        let pictures = [
            ("jacobian.svg", "Jacobian", constraints, &jacobian),
            ("hessian.svg", "Hessian", variables, &hessian),
        ];
        for (file, name, rows, entries) in pictures {
            let svg = sparsity_svg(name, [rows, variables], entries, &origin);
            atomic::write(&folder.join(file), svg.as_bytes())?;
        }
    }
    Ok(found)
}

/// Sizes of a nonlinear program.
fn program_sizes(program: &dyn Nlp) -> [(&'static str, usize); 6] {
    let rows = program.constraints();
    let equalities = rows.lower.iter().zip(&rows.upper).filter(|(l, u)| l == u);
    let (variables, constraints) = (program.variables().count(), rows.lower.len());
    let equalities = equalities.count();
    [
        ("variables", variables),
        ("constraints", constraints),
        ("of them inequalities", constraints - equalities),
        (
            "degrees of freedom left",
            variables.saturating_sub(equalities),
        ),
        (
            "nonzeros of the Jacobian",
            program.jacobian_structure().count(),
        ),
        (
            "nonzeros of the Hessian (lower triangle)",
            program.hessian_structure().count(),
        ),
    ]
}

/// Each motion by itself, and the program of all; pictures go to folders of their names.
fn of_motions(request: &CommandInput, motions: &Motions) -> Result<Inspected, CommandError> {
    let task = motions.task();
    let (mut each, mut words) = (BTreeMap::new(), String::new());
    for (motion, control) in task.motions.iter().zip(&task.with_limits_once()) {
        let name = motion.name;
        let own = CommandInput {
            output: request.output.as_ref().map(|folder| folder.join(name)),
            ..request.clone()
        };
        let found = of_control(&own, motion.system, control)?;
        words.push_str(&format!("motion \"{name}\": {}\n", found.words));
        each.insert(name.to_owned(), found);
    }
    let whole = joined(&request.input, &task, |program, _| program_sizes(program))?;
    let mut sizes = vec![("motions", motions.list.len())];
    sizes.extend(whole);
    let first = &each[&motions.list[0].name];
    Ok(Inspected {
        system: first.system.clone(),
        coordinates: first.coordinates,
        plan: Plan::default(),
        left_out: Vec::new(),
        words: format!("{words}all motions as one program\n{}", numbers(&sizes)),
        sizes: sizes.into_iter().collect(),
        motions: each,
        notes: Vec::new(),
    })
}

fn numbers(sizes: &[(&str, usize)]) -> String {
    let rows: Vec<_> = sizes
        .iter()
        .map(|(name, count)| vec![(*name).to_owned(), count.to_string()])
        .collect();
    table::aligned(&rows)
}

/// Longer side of the picture in pt.
const SIDE: f64 = 420.0;
/// Margin in pt; the title stands in the upper one.
const MARGIN: f64 = 26.0;
/// Cells along the longer side at most: more entries than that share cells.
const CELLS: usize = 420;

/// An SVG of the entries of a matrix of this name and numbers of rows and columns, rows downwards.
fn sparsity_svg(name: &str, shape: [usize; 2], entries: &Entries, origin: &Origin) -> String {
    let [rows, columns] = shape;
    let longest = rows.max(columns).max(1);
    // A cell holds `share` rows and columns.
    let share = longest.div_ceil(CELLS);
    let cell = SIDE / longest.div_ceil(share) as f64;
    let size = [columns, rows].map(|count| count.div_ceil(share) as f64 * cell);
    let cells = entries.places();
    let cells = cells.map(|(row, col)| (row / share, col / share));
    let mut cells: Vec<(usize, usize)> = cells.collect();
    cells.sort_unstable();
    cells.dedup();
    let sheet = size.map(|side| side + 2.0 * MARGIN);
    canvas::svg(sheet, origin, |canvas| {
        let corner = |row: usize, col: usize| [col, row].map(|k| MARGIN + k as f64 * cell);
        for (row, col) in cells {
            let square = rectangle(corner(row, col), corner(row + 1, col + 1));
            canvas.fill(&square, style::hue(0), 1.0);
        }
        let frame = rectangle([MARGIN; 2], size.map(|side| side + MARGIN));
        canvas.outline(&frame, Stroke::solid(style::INK, 0.8));
        let title = format!("{name}: {rows} × {columns}, {} entries", entries.rows.len());
        let place = [MARGIN, 0.5 * MARGIN];
        canvas.text(place, &title, style::TICK_SIZE, Align::Left);
    })
}

/// Robots larger than this, in mm, get a question about their unit.
const HUGE: f64 = 5e3;
/// Robots smaller than this, in mm, get a question about their unit.
const TINY: f64 = 0.1;

/// Lines about the size of the robot and of its meshes in the reference configuration.
fn unit_questions(system: &System) -> String {
    let Some(all) = corners(places(system)) else {
        return String::new();
    };
    let mut text = format!("extent of the robot: {}\n", dimensions(all));
    for solid in &system.solids {
        let own = corners(solid.mesh.nodes.iter().copied()).map(dimensions);
        let own = own.unwrap_or_default();
        text.push_str(&format!("extent of {}: {own}\n", solid.name));
    }
    let largest = (all[1] - all[0]).max();
    if !(TINY..=HUGE).contains(&largest) {
        let length = match largest > HUGE {
            true => format!("{} m long", rounded(largest / 1e3)),
            false => format!("{} µm long", rounded(largest * 1e3)),
        };
        text.push_str(&format!(
            "note: the robot is {length}; are the units right? A number without a unit is in m, and so is a mesh file without \"unit\"\n"
        ));
    }
    text
}

fn dimensions([lower, upper]: [Vector3<f64>; 2]) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| rounded(upper[axis] - lower[axis]));
    let least = 1e-9 * (upper - lower).max();
    let [a, b, c] = [0, 1, 2].map(|axis| match lower[axis] {
        place if place.abs() < least => 0.0,
        place => rounded(place),
    });
    format!("{x} × {y} × {z} mm from ({a}, {b}, {c}) mm")
}

/// Four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value) + 0.0
}

/// Corners of boxes around bodies, ends of muscles, joints and nodes.
fn places(system: &System) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let bodies = system.bodies.iter().flat_map(|body| {
        let half = match body.shape {
            Shape::Surface(_) => {
                let mut surface = Surface::default();
                body.shape.add_to(&mut surface, &body.pose());
                let (lower, upper) = surface.bounds();
                return [lower, upper];
            }
            Shape::Cylinder { length, radius } => Vector3::new(radius, radius, 0.5 * length),
            Shape::Box { size } => Vector3::from(size) / 2.0,
            Shape::Sphere { radius } => Vector3::repeat(radius),
            Shape::None => Vector3::zeros(),
        };
        let reach = body.directors.abs() * half;
        [body.centre - reach, body.centre + reach]
    });
    let ends = system.muscles.iter().flat_map(|m| [m.from.at, m.to.at]);
    let joints = system.joints.iter().map(|joint| joint.at);
    let components = system.components.iter();
    let points = components.flat_map(|component| component.points().into_iter().map(|p| p.at));
    let nodes = system
        .solids
        .iter()
        .flat_map(|s| s.mesh.nodes.iter().copied());
    bodies.chain(ends).chain(joints).chain(points).chain(nodes)
}
