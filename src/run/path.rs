//! The path of equilibria under growing voltages, followed by arc length past the points where stability is lost.

use std::time::Instant;

use serde::Serialize;

use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::dynamics::{Continuation, History, Instability, continuation};
use crate::ipopt::{Status, interrupt};
use crate::model::Model;
use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Mark, Series};
use crate::report::origin::Origin;
use crate::report::{atomic, style, table};
use crate::run::effects::Plan;
use crate::run::error::RunError;
use crate::run::fields;
use crate::run::progress::phase;
use crate::run::request::{Request, Told};
use crate::run::rest::{Asked, refused};
use crate::run::solve::{counted, make_folder};
use crate::run::summary::{MEASURED, Seconds, Summary};

/// What `summary.json` says of a path.
#[derive(Debug, Serialize)]
pub(super) struct Followed {
    /// Number of equilibria.
    points: usize,
    /// Largest fraction of the voltages among them.
    largest_fraction: f64,
    /// Where stability is lost.
    lost: Vec<Loss>,
}

/// A loss of stability.
#[derive(Debug, Serialize)]
struct Loss {
    /// Exact fraction of the voltages.
    fraction: f64,
    /// `pull_in` or `buckling`.
    kind: &'static str,
}

/// Follows the path for `points` equilibria and writes `path.csv`, `path.svg` and the fields.
pub(super) fn follow(
    request: &Request,
    asked: &Asked<'_>,
    points: usize,
    began: Instant,
) -> Result<Told, RunError> {
    let wrong = |error| RunError::boundary(&request.input, "equilibrium", &error);
    let model = Model::answering(asked.system.clone(), asked.task.question(asked.system))
        .map_err(|error| wrong(error.into()))?;
    let setup = began.elapsed().as_secs_f64();
    phase("following the path");
    let start = model.coordinates_at(&vec![0.0; model.gauges.len()]);
    let found = match continuation(&model, &start, &model.scalars(&asked.task.voltages), points) {
        Ok(found) => found,
        Err(error) => return refused(request, &error, "no equilibrium to start from"),
    };
    let stopped = interrupt::stop();
    let lost = found.lost.iter().map(loss).map(|l| {
        let what = if l.kind == "pull_in" {
            "pull-in"
        } else {
            l.kind
        };
        format!("{what} at {:.6} % of the voltages", 100.0 * l.fraction)
    });
    let early = stopped.map(|status| {
        let why = status.word().replace('_', " ");
        format!("the path was not followed to its end ({why})")
    });
    let notes = lost.chain(early);
    let mut told = Told {
        is_solved: stopped.is_none(),
        result: counted(found.points.len(), "equilibrium").replace("equilibriums", "equilibria"),
        notes: notes.collect(),
    };
    let folder = asked.folder.clone().unwrap_or_else(|| request.folder());
    make_folder(&folder)?;
    let origin = request.origin(false);
    // The first equilibrium stands at both ends of an interval of its own, so that each has its potentials.
    let first = &found.points[0];
    let history = History {
        times: std::iter::once(&0.0)
            .chain(&found.fractions)
            .copied()
            .collect(),
        z: std::iter::once(first)
            .chain(&found.points)
            .map(|p| p.z.clone())
            .collect(),
        scalars: found.points.iter().map(|p| p.scalars.clone()).collect(),
        ..History::default()
    };
    let observed = observations(&model, &found, &history);
    let csv = table::trajectory_csv(&observed, &origin);
    atomic::write(&folder.join("path.csv"), csv.as_bytes())?;
    let svg = figure(&model, &found, &history, &origin);
    atomic::write(&folder.join("path.svg"), svg.as_bytes())?;
    fields::write(&folder, &model, &history, &origin)?;
    let word = stopped.map_or("path_followed", Status::word);
    let mut summary = Summary::new(request, word, model.coordinates.name());
    summary.plan = Plan::of(&model, None, MEASURED).map_err(|error| wrong(error.into()))?;
    summary.path = Some(Followed {
        points: found.points.len(),
        largest_fraction: found.fractions.iter().copied().fold(0.0, f64::max),
        lost: found.lost.iter().map(loss).collect(),
    });
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup,
        ..Seconds::default()
    };
    summary.write(&folder)?;
    told.result.push_str(&format!(", {}", folder.display()));
    Ok(told)
}

fn loss(&(_, fraction, kind): &(usize, f64, Instability)) -> Loss {
    Loss {
        fraction,
        kind: kind.key(),
    }
}

/// Fraction, voltages, markers and stability of each equilibrium.
fn observations(model: &Model, found: &Continuation, history: &History) -> Observations {
    let marks = Trajectory::from_history(model, history).marks;
    let mut columns = Vec::new();
    let mut add = |name: String, unit: &'static str, values: Vec<f64>| {
        columns.push(Column { name, unit, values });
    };
    add("fraction".to_owned(), "", found.fractions.clone());
    for (s, &source) in model.voltages.iter().enumerate() {
        let values = found.points.iter().map(|p| p.scalars[s]).collect();
        add(model.sources[source].name.clone(), "V", values);
    }
    for (m, marker) in model.system.markers.iter().enumerate() {
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let values = marks[1..].iter().map(|row| row[m][i]).collect();
            add(format!("{}_{axis}", marker.name), "mm", values);
        }
    }
    let unstable = |p: &crate::dynamics::Equilibrium| p.unstable.map_or(f64::NAN, |n| n as f64);
    let values = found.points.iter().map(unstable).collect();
    add("unstable_directions".to_owned(), "", values);
    Observations { columns }
}

/// `path.svg`: fraction of the voltages over the way of each marker, or of the coordinate that moves most.
fn figure(model: &Model, found: &Continuation, history: &History, origin: &Origin) -> String {
    let marks = Trajectory::from_history(model, history).marks;
    let reference = &model.coordinates_at(&vec![0.0; model.gauges.len()]);
    let way = |m: usize, k: usize| (marks[k + 1][m] - marks[0][m]).norm();
    let curve = |name: &str, m: usize, way: &dyn Fn(usize) -> f64| {
        let points = (0..found.points.len()).map(|k| [way(k), found.fractions[k]]);
        Series::curve(name, points.collect(), style::hue(m)).marked(Mark::Disc)
    };
    let markers = model.system.markers.iter().enumerate();
    let mut series: Vec<Series> = markers
        .map(|(m, marker)| curve(&marker.name, m, &|k| way(m, k)))
        .collect();
    if series.is_empty() {
        let far = |k: usize| {
            let z = found.points[k].z.iter().zip(reference);
            z.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        series.push(curve("largest change of a coordinate", 0, &far));
    }
    LinePlot::new(
        Axis::linear("way from rest [mm]", Extent::FromZero),
        Axis::linear("fraction of the voltages", Extent::FromZero),
        series,
    )
    .svg(origin)
}
