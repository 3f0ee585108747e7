//! A static equilibrium: joint coordinates, marker places, stiffness.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::control::problem::{AtRest, Task};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    Equilibrium, EquilibriumError, History, Instability, equilibrium, observations,
};
use crate::ipopt::interrupt;
use crate::model::system::{Joint, JointKind};
use crate::model::{Model, System};
use crate::report::atomic;
use crate::report::skins::Skins;
use crate::report::{pose, table};
use crate::run::blocks::Blocks;
use crate::run::effects::Plan;
use crate::run::error::RunError;
use crate::run::fields;
use crate::run::inspect::key;
use crate::run::memory;
use crate::run::motion::solved;
use crate::run::path;
use crate::run::progress::{Progress, phase};
use crate::run::request::{Request, Told};
use crate::run::solve::make_folder;
use crate::run::summary::{MEASURED, Rest, Seconds, Summary};
use crate::scene::{driven_voltages, read_problem, read_system};

/// The equilibrium that a problem asks for; under voltages such as `muscle2=1.7kV` that of a scene, or of the scene of any
/// problem.
///
/// # Errors
/// The file or a voltage is wrong, or the problem asks for something else and no voltages are given.
pub fn equilibrium_of_file(
    request: &Request,
    voltages: Option<&[String]>,
) -> Result<Told, RunError> {
    let began = Instant::now();
    let _progress = Progress::of_phases(request.progress);
    phase("reading");
    if let Some(voltages) = voltages {
        let system = read_system(&request.input, &request.set)?;
        memory::of_elements(&request.input, &system)?;
        let voltages = driven_voltages(voltages, &system)?;
        let task = AtRest {
            voltages,
            coordinates: None,
            path: None,
        };
        let asked = Asked {
            system: &system,
            task: &task,
            folder: request.output.clone(),
        };
        return at(request, &asked, began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    memory::of_elements(&request.input, &loaded.system)?;
    match &loaded.task {
        Task::Equilibrium(task) => {
            let asked = Asked {
                system: &loaded.system,
                task,
                folder: request.output.clone(),
            };
            at(request, &asked, began)
        }
        other => Err(RunError::Problem {
            file: request.input.clone(),
            place: key(other).to_owned(),
            reason: "asks for no equilibrium; name the voltages with --voltages".to_owned(),
        }),
    }
}

/// An equilibrium that is looked for.
pub(super) struct Asked<'a> {
    pub(super) system: &'a System,
    pub(super) task: &'a AtRest,
    /// Where files go, if anywhere.
    pub(super) folder: Option<PathBuf>,
}

/// Finds the equilibrium under voltages, or follows the path there; where it is lost on the way there, the last one is kept.
pub(super) fn at(request: &Request, asked: &Asked<'_>, began: Instant) -> Result<Told, RunError> {
    let left = |seconds| seconds - began.elapsed().as_secs_f64();
    let watch = interrupt::watch(request.max_seconds.map(left));
    if let Some(points) = asked.task.path {
        return path::follow(request, asked, points, began);
    }
    let wrong = |error| RunError::boundary(&request.input, "equilibrium", &error);
    phase("building");
    let model = Model::answering(asked.system.clone(), asked.task.question(asked.system))
        .map_err(|error| wrong(error.into()))?;
    let setup = began.elapsed().as_secs_f64();
    phase("equilibrium");
    let zero = model.coordinates_at(&vec![0.0; model.gauges.len()]);
    let (status, found, failure) =
        match equilibrium(&model, &zero, &model.scalars(&asked.task.voltages)) {
            Ok(found) => ("at_rest", found, None),
            Err(EquilibriumError::LimitPoint {
                fraction,
                kind,
                last,
            }) => {
                let end = End {
                    fraction,
                    kind,
                    field: None,
                };
                (end.status(), *last, Some(end))
            }
            Err(error) => return refused(request, &error, "no equilibrium"),
        };
    drop(watch);
    let n = model.coordinate_count();
    let state = History {
        times: vec![0.0],
        z: vec![found.z.clone()],
        momenta: vec![vec![0.0; n]],
        scalars: vec![found.scalars.clone()],
        ..History::default()
    };
    let field = fields::largest_nominal_field(&model, &state, 0);
    let failure = failure.map(|end| End { field, ..end });
    let motion = Trajectory::from_history(&model, &state);
    let rest = Rest {
        fraction: failure.as_ref().map(|end| end.fraction),
        largest_nominal_field: field,
        ..describe(&model, &state, &motion, &found)
    };
    let told = match &failure {
        None => Told {
            is_solved: true,
            result: text(&model, &rest),
            notes: Vec::new(),
        },
        Some(end) => Told {
            is_solved: false,
            result: "no equilibrium".to_owned(),
            notes: vec![end.message(&rest, asked.folder.as_deref())],
        },
    };
    if let Some(folder) = &asked.folder {
        make_folder(folder)?;
        let origin = request.origin(false);
        let written = fields::write(folder, &model, &state, &origin)?;
        let mut summary = Summary::new(request, status, model.coordinates.name());
        summary.message = told.notes.first().cloned();
        summary.plan = Plan::of(&model, None, MEASURED).map_err(|error| wrong(error.into()))?;
        summary.rest = Some(rest);
        let observed = observations(&model, &state);
        summary.blocks = Blocks::of(&model).map(|b| b.after(&model, &observed, written));
        summary.seconds = Seconds {
            total: began.elapsed().as_secs_f64(),
            setup,
            ..Seconds::default()
        };
        summary.write(folder)?;
        let svg = pose::svg(
            &model.system,
            &motion,
            &Skins::new(&model, &state),
            Some(&motion.voltages[0]),
            &origin,
        );
        atomic::write(&folder.join("configuration.svg"), svg.as_bytes())?;
    }
    Ok(told)
}

/// Why there is no equilibrium at all: a floating block is wrong input, anything else a result without files.
pub(super) fn refused(
    request: &Request,
    error: &EquilibriumError,
    result: &str,
) -> Result<Told, RunError> {
    match error {
        EquilibriumError::Floating { .. } => {
            return Err(RunError::Problem {
                file: request.input.clone(),
                place: "equilibrium".to_owned(),
                reason: error.to_string(),
            });
        }
        EquilibriumError::Stopped(status) => return Err(RunError::Stopped(*status)),
        _ => {}
    }
    Ok(Told {
        is_solved: false,
        result: result.to_owned(),
        notes: vec![error.to_string()],
    })
}

/// Where the equilibria under growing voltages end.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Part of the voltages asked for that was reached.
    fraction: f64,
    kind: Option<Instability>,
    /// Largest field of a block in V/m, in its reference configuration.
    field: Option<f64>,
}

impl End {
    /// The word in files.
    fn status(&self) -> &'static str {
        self.kind.map_or("limit_point", Instability::key)
    }

    /// One line: what is lost, at which voltages, and where the last state is.
    fn message(&self, rest: &Rest, folder: Option<&Path>) -> String {
        let why = match self.kind {
            Some(Instability::PullIn) => "pull-in",
            Some(Instability::Buckling) => "buckling",
            None => "a limit point",
        };
        let on = rest.voltages.iter().filter(|(_, v)| **v != 0.0);
        let voltages: Vec<_> = on
            .map(|(name, v)| format!("{name} = {:.6} kV", v / 1e3))
            .collect();
        let mut text = format!(
            "no equilibrium under these voltages: {why} at {:.6} % of them, {}",
            100.0 * self.fraction,
            voltages.join(", ")
        );
        if let Some(field) = self.field {
            text.push_str(&format!("; largest nominal field {:.3} MV/m", field / 1e6));
        }
        if let Some(folder) = folder {
            text.push_str(&format!("; the state there is in {}", folder.display()));
        }
        text
    }
}

fn describe(model: &Model, state: &History, motion: &Trajectory, found: &Equilibrium) -> Rest {
    let system = &model.system;
    let kept = solved(model, state, None);
    let joints = system.joints.iter().zip(&kept.joints[0]);
    let markers = system.markers.iter().zip(&motion.marks[0]);
    let voltages = model.sources.iter().zip(&motion.voltages[0]);
    let driven = voltages.filter(|(source, _)| source.takes_voltage);
    let prismatic = |joint: &Joint| matches!(joint.kind, JointKind::Prismatic { .. });
    let only_angles = !system.joints.iter().any(prismatic);
    Rest {
        voltages: driven.map(|(s, v)| (s.name.clone(), *v)).collect(),
        fraction: None,
        largest_nominal_field: None,
        joints: joints
            .filter(|(joint, _)| joint.has_coordinate())
            .map(|(joint, &value)| {
                let unit = if prismatic(joint) { 1e3 } else { 1.0 };
                (joint.name.clone(), value / unit)
            })
            .collect::<BTreeMap<_, _>>(),
        markers: markers
            .map(|(marker, place)| (marker.name.clone(), (place / 1e3).into()))
            .collect(),
        // N mm/rad; where displacements take part the coordinates are mixed and the numbers those of g, mm, ms.
        stiffness: match only_angles {
            true => found.stiffness.iter().map(|k| k / 1e3).collect(),
            false => found.stiffness.clone(),
        },
        is_stable: found.is_stable(),
        unstable_directions: found.unstable,
        newton_iterations: found.iterations,
    }
}

/// The equilibrium as lines of a table.
fn text(model: &Model, rest: &Rest) -> String {
    let mut rows = Vec::new();
    for joint in model.system.joints.iter().filter(|j| j.has_coordinate()) {
        // What rounds to zero has no sign.
        let value = rest.joints[&joint.name];
        let value = if value.abs() < 5e-10 { 0.0 } else { value };
        let (value, unit) = match joint.kind {
            JointKind::Prismatic { .. } => (format!("{:.6}", 1e3 * value), "mm".to_owned()),
            _ => (
                format!("{value:.9}"),
                format!("rad ({:.4}°)", value.to_degrees()),
            ),
        };
        rows.push(vec![joint.name.clone(), value, unit]);
    }
    for marker in &model.system.markers {
        let [x, y, z] = rest.markers[&marker.name].map(|x| format!("{:.6}", 1e3 * x));
        rows.push(vec![marker.name.clone(), x, y, z, "mm".to_owned()]);
    }
    let mut text = table::aligned(&rows);
    if !rest.stiffness.is_empty() {
        let values: Vec<_> = rest.stiffness.iter().map(|k| format!("{k:.6e}")).collect();
        text.push_str(&format!("stiffness  {}\n", values.join("  ")));
    }
    text.push_str(match rest.is_stable {
        Some(true) => "stable equilibrium",
        Some(false) => "unstable equilibrium",
        None => "equilibrium; its stability is not known",
    });
    if let (Some(false), Some(count @ 1..)) = (rest.is_stable, rest.unstable_directions) {
        text.push_str(&format!(
            ": the potential energy falls in {count} directions (buckling)"
        ));
    }
    text
}
