//! A static equilibrium: joint coordinates, marker places, stiffness.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use crate::control::Solved;
use crate::control::problem::Task;
use crate::dynamics::{Equilibrium, History, equilibrium};
use crate::model::system::{Joint, JointKind, Marker};
use crate::model::{Coordinates, Model, System};
use crate::report::atomic;
use crate::report::{pose, table};
use crate::run::effects::effect_counts;
use crate::run::error::RunError;
use crate::run::inspect::key;
use crate::run::motion::{has_coordinate, solved, trajectory};
use crate::run::request::{Request, Told};
use crate::run::solve::make_folder;
use crate::run::summary::{Rest, Seconds, Summary};
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
    if let Some(voltages) = voltages {
        let system = read_system(&request.input, &request.set)?;
        let voltages = driven_voltages(voltages, &system)?;
        return at(request, &system, &voltages, None, began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    match &loaded.task {
        Task::Equilibrium(voltages, coordinates) => {
            at(request, &loaded.system, voltages, *coordinates, began)
        }
        other => Err(RunError::Problem {
            file: request.input.clone(),
            place: key(other).to_owned(),
            reason: "asks for no equilibrium; name the voltages with --voltages".to_owned(),
        }),
    }
}

/// Finds the equilibrium under voltages (V, one per muscle); writes files where a folder was asked for.
pub(super) fn at(
    request: &Request,
    system: &System,
    voltages: &[f64],
    coordinates: Option<Coordinates>,
    began: Instant,
) -> Result<Told, RunError> {
    let wrong = |error| RunError::boundary(&request.input, "equilibrium", &error);
    let model =
        Model::new(system.clone(), coordinates, 1.0, &[]).map_err(|error| wrong(error.into()))?;
    let setup = began.elapsed().as_secs_f64();
    let zero = model.coordinates_at(&vec![0.0; model.gauges.len()]);
    let found = match equilibrium(&model, &zero, &model.scalars(voltages)) {
        Ok(found) => found,
        Err(error) => {
            return Ok(Told {
                is_solved: false,
                result: "no equilibrium".to_owned(),
                notes: vec![error.to_string()],
            });
        }
    };
    let state = History {
        times: vec![0.0],
        z: vec![found.z.clone()],
        ..History::default()
    };
    let state = solved(&model, &state, None);
    let rest = describe(&model, &state, &found);
    let result = text(&model, &rest);
    if let Some(folder) = &request.output {
        make_folder(folder)?;
        let mut summary = Summary::new(request, "at_rest", model.coordinates.name());
        summary.effects = effect_counts(&model).map_err(|error| wrong(error.into()))?;
        summary.rest = Some(rest);
        summary.seconds = Seconds {
            total: began.elapsed().as_secs_f64(),
            setup,
            ..Seconds::default()
        };
        summary.write(folder)?;
        write_picture(request, folder, &model, &state, voltages)?;
    }
    Ok(Told {
        is_solved: true,
        result,
        notes: Vec::new(),
    })
}

fn write_picture(
    request: &Request,
    folder: &Path,
    model: &Model,
    state: &Solved,
    voltages: &[f64],
) -> Result<(), RunError> {
    let motion = trajectory(model, state);
    let svg = pose::svg(
        &model.system,
        &motion,
        Some(voltages),
        &request.origin(false),
    );
    atomic::write(&folder.join("configuration.svg"), svg.as_bytes())?;
    Ok(())
}

fn describe(model: &Model, state: &Solved, found: &Equilibrium) -> Rest {
    let system = &model.system;
    let joints = system.joints.iter().zip(&state.joints[0]);
    let motion = trajectory(model, state);
    let place = |marker: &Marker| {
        let place = motion.point(0, &marker.point, system) / 1e3;
        (marker.name.clone(), place.into())
    };
    let prismatic = |joint: &Joint| matches!(joint.kind, JointKind::Prismatic { .. });
    let only_angles = !system.joints.iter().any(prismatic);
    Rest {
        joints: joints
            .filter(|(joint, _)| has_coordinate(joint))
            .map(|(joint, &value)| {
                let unit = if prismatic(joint) { 1e3 } else { 1.0 };
                (joint.name.clone(), value / unit)
            })
            .collect::<BTreeMap<_, _>>(),
        markers: system.markers.iter().map(place).collect(),
        // N mm/rad; where displacements take part the coordinates are mixed and the numbers those of g, mm, ms.
        stiffness: match only_angles {
            true => found.stiffness.iter().map(|k| k / 1e3).collect(),
            false => found.stiffness.clone(),
        },
        is_stable: found.is_stable(),
        newton_iterations: found.iterations,
    }
}

/// The equilibrium as lines of a table.
fn text(model: &Model, rest: &Rest) -> String {
    let mut rows = Vec::new();
    for joint in model.system.joints.iter().filter(|j| has_coordinate(j)) {
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
        None => "equilibrium; its stability is not known in redundant coordinates",
    });
    text
}
