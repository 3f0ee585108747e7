//! A static equilibrium, and a path of equilibria, in words and in `summary.json`: joint coordinates, marker places, stiffness, and the route to it.

use crate::app::fields;
use crate::app::linear_systems::multigrid;
use crate::dynamics::trajectory::{Column, Observations};
use crate::dynamics::{
    Continuation, Instability, Load, LowestMode, Route, Softening, StabilityLoss,
};
use crate::files::Entries;
use crate::model::Model;
use crate::model::system::{Joint, JointKind};
use crate::report::table;
use crate::tasks::EquilibriumResult;
use crate::workflow::motion::solved;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A static equilibrium, or the last one on the way to the loads asked for.
#[derive(Debug, Serialize)]
pub(super) struct Rest {
    /// Voltage of each muscle and electrode in V.
    voltages: BTreeMap<String, f64>,
    /// Fraction of the voltages asked for that these are, where they were not reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    fraction: Option<f64>,
    /// Largest electric field of an element of a block in its reference configuration in V/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_nominal_field: Option<f64>,
    /// Coordinate of each joint in rad or m.
    joints: BTreeMap<String, f64>,
    /// Place of each marker in m.
    markers: BTreeMap<String, [f64; 3]>,
    /// Stretch of each lumped muscle.
    stretches: BTreeMap<String, f64>,
    /// Eigenvalues of the stiffness in joint coordinates, N m/rad for angles, N/m for displacements; where there are both, N mm for each rad and
    /// each length of the system.
    stiffness: Vec<f64>,
    /// Motion of the softest mode, and the cause of its softness.
    #[serde(skip_serializing_if = "Option::is_none")]
    softest_mode: Option<Softest>,
    /// True if the equilibrium is stable, by them or by the inertia of the tangent; nothing where that is not known.
    is_stable: Option<bool>,
    /// Number of directions in which a disturbance grows.
    unstable_directions: Option<usize>,
    /// The lowest mode, where it decided without factors: then directions are those that were found.
    #[serde(skip_serializing_if = "Option::is_none")]
    lowest_mode: Option<Lowest>,
    /// `growing_loads`, `path_continued` or `damped_motion`.
    route: &'static str,
    /// State at which the path of growing loads loses its stable equilibrium, if this one does not lie on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    lost: Option<Lost>,
    /// Newton iterations.
    newton_iterations: usize,
    /// Counts of an iteration with multigrid, where one led there.
    #[serde(skip_serializing_if = "Option::is_none")]
    multigrid: Option<Entries>,
    /// Unit of the stiffness in the text, and the factor to it from that of the list.
    #[serde(skip)]
    unit: (&'static str, f64),
}

/// The softest mode.
#[derive(Debug, Serialize)]
struct Softest {
    /// Parts that move most.
    moves: String,
    /// `voltages`, `loads` (weights too) or `elastic_forces`; absent where nothing takes from the elastic stiffness.
    #[serde(skip_serializing_if = "Option::is_none")]
    softened_by: Option<&'static str>,
}

/// The lowest eigenvalue of the stiffness of nodes, with potentials that follow.
#[derive(Debug, Serialize)]
struct Lowest {
    /// Its quotient in N/m.
    stiffness: f64,
    /// Distance in N/m within which there is an eigenvalue.
    bound: f64,
    /// Iterations.
    iterations: usize,
}

impl Lowest {
    fn new(mode: &LowestMode) -> Self {
        Self {
            stiffness: 1e3 * mode.stiffness,
            bound: 1e3 * mode.bound,
            iterations: mode.iterations,
        }
    }
}

/// A loss of the stable equilibrium under a growing load.
#[derive(Debug, Serialize)]
struct Lost {
    /// `loads`, which are weights too, or `voltages`.
    load: &'static str,
    /// Fraction of the load.
    fraction: f64,
    /// `pull_in`, `collapse`, `buckling` or `limit_point`.
    kind: &'static str,
}

/// The word in files for how an equilibrium is lost.
pub(super) fn status(loss: StabilityLoss) -> &'static str {
    loss.kind.map_or("limit_point", Instability::key)
}

fn load(load: Load) -> &'static str {
    match load {
        Load::Forces => "loads",
        Load::Voltages => "voltages",
    }
}

fn kind(loss: StabilityLoss) -> &'static str {
    loss.kind.map_or("a limit point", Instability::words)
}

/// Unit of stiffness where coordinates are angles and places.
const MIXED: &str = "N mm, coordinates in rad and lengths of the system";

/// Describes an equilibrium; the last one where growing loads lose it.
pub(super) fn describe(result: &EquilibriumResult, observed: &Observations) -> Rest {
    let EquilibriumResult {
        model,
        found,
        loss: failure,
        discrete: state,
        trajectory: motion,
        ..
    } = result;
    let failure = *failure;
    let system = &model.system;
    let kept = solved(model, state, None);
    let joints = system.joints.iter().zip(&kept.joints[0]);
    let markers = system.markers.iter().zip(&motion.marks[0]);
    let voltages = model.sources.iter().zip(&motion.voltages[0]);
    let driven = voltages.filter(|(source, _)| source.takes_voltage);
    let prismatic = |joint: &Joint| matches!(joint.kind, JointKind::Prismatic { .. });
    let moving = || system.joints.iter().filter(|joint| joint.has_coordinate());
    let (slides, turns) = (
        moving().any(prismatic),
        moving().any(|joint| !prismatic(joint)),
    );
    // From N mm/rad and N/mm to SI, and from there to the text.
    let (factor, unit) = match (slides, turns) {
        (false, _) => (1e-3, ("N mm/rad", 1e3)),
        (true, false) => (1e3, ("N/mm", 1e-3)),
        (true, true) => (1.0, (MIXED, 1.0)),
    };
    let stretches = observed.columns.iter().filter_map(|column| {
        let muscle = column.name.strip_suffix("_stretch")?;
        let value = column.values.first().filter(|v| v.is_finite())?;
        Some((muscle.to_owned(), *value))
    });
    Rest {
        voltages: driven.map(|(s, v)| (s.name.clone(), *v)).collect(),
        fraction: failure.map(|loss| match loss.load {
            Load::Forces => 0.0,
            Load::Voltages => loss.fraction,
        }),
        largest_nominal_field: fields::largest_nominal_field(model, state, 0),
        joints: joints
            .filter(|(joint, _)| joint.has_coordinate())
            .map(|(joint, &value)| {
                let unit = if prismatic(joint) { 1e3 } else { 1.0 };
                (joint.name.clone(), value / unit)
            })
            .collect(),
        markers: markers
            .map(|(marker, place)| (marker.name.clone(), (place / 1e3).into()))
            .collect(),
        stretches: stretches.collect(),
        stiffness: found.stiffness.iter().map(|k| factor * k).collect(),
        softest_mode: found.softest.as_ref().map(|mode| Softest {
            moves: mode.moves.clone(),
            softened_by: mode.softening.map(|softening| match softening {
                Softening::Voltages => "voltages",
                Softening::Loads => "loads",
                Softening::Elastic => "elastic_forces",
            }),
        }),
        is_stable: found.is_stable(),
        unstable_directions: found.unstable,
        route: match (failure, found.route) {
            (Some(_), _) | (None, Route::Loads) => "growing_loads",
            (None, Route::Beyond(_)) => "path_continued",
            (None, Route::DampedMotion(_)) => "damped_motion",
        },
        lost: failure.or(found.loss()).map(|loss| Lost {
            load: load(loss.load),
            fraction: loss.fraction,
            kind: status(loss),
        }),
        lowest_mode: found.lowest.as_ref().map(Lowest::new),
        multigrid: found
            .on_grids
            .and_then(|(report, fallbacks)| multigrid(report, fallbacks)),
        newton_iterations: found.iterations,
        unit,
    }
}

impl Rest {
    /// `183.5 N mm/rad: joint1, stretch of muscle2 (at 0.7)`.
    fn softest(&self) -> Option<String> {
        let moves = &self.softest_mode.as_ref()?.moves;
        let (unit, factor) = self.unit;
        let number = self.stiffness.first();
        let number = number.map(|k| format!("{:.6} {unit}", factor * k));
        let parts = [number, Some(moves.clone()).filter(|m| !m.is_empty())];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(": "))
    }

    /// Smallest and largest stretch with their muscles.
    fn stretched(&self) -> Option<String> {
        let least = self.stretches.iter().min_by(|a, b| a.1.total_cmp(b.1))?;
        let most = self.stretches.iter().max_by(|a, b| a.1.total_cmp(b.1))?;
        Some(match self.stretches.len() {
            1 => format!("{:.6} ({})", least.1, least.0),
            _ => format!("{:.6} ({}) to {:.6} ({})", least.1, least.0, most.1, most.0),
        })
    }

    /// `stable equilibrium`, and how it was found.
    pub(super) fn verdict(&self) -> String {
        let mut text = match self.is_stable {
            Some(true) => "stable equilibrium",
            Some(false) => "unstable equilibrium",
            None => "equilibrium; its stability is not known",
        }
        .to_owned();
        if let (Some(false), Some(count @ 1..)) = (self.is_stable, self.unstable_directions) {
            let cause = match self.softest_mode.as_ref().and_then(|mode| mode.softened_by) {
                Some("voltages") => "pull-in",
                Some("loads") => "collapse under load",
                _ => "buckling",
            };
            let directions = match count {
                1 => "1 direction".to_owned(),
                _ => format!("{count} directions"),
            };
            text.push_str(&match &self.lowest_mode {
                None => format!(
                    ": a disturbance grows in {directions} ({cause}); no stable one was found on the path of growing loads, on its \
                     continuation, or by damped motion from them"
                ),
                Some(_) => format!(
                    ": a disturbance grows in at least {directions} ({cause}); a stable one was not sought, for which \
                     the matrix is too large to be factorised"
                ),
            });
        }
        if let Some(Lowest {
            stiffness, bound, ..
        }) = &self.lowest_mode
        {
            text.push_str(&format!(
                "; by the lowest mode, {:.4e} ± {:.1e} N/mm for the vector of all nodes",
                1e-3 * stiffness,
                1e-3 * bound
            ));
        }
        if let (Some(lost), false) = (&self.lost, self.route == "growing_loads") {
            let place = match self.route {
                "path_continued" => "on the continued path",
                _ => "by damped motion from an unstable state",
            };
            let what = lost.load;
            let kind = lost.kind.replace('_', " ").replace("pull in", "pull-in");
            text.push_str(&match lost.fraction > 0.0 {
                true => format!(
                    " {place}: growing {what} lose theirs at {:.4} % ({kind})",
                    100.0 * lost.fraction
                ),
                false => format!(" {place}: the reference has none"),
            });
        }
        text
    }
}

/// One line: the kind of loss, its loads, the parts that give way, and the last state.
pub(super) fn lost(rest: &Rest, loss: StabilityLoss, folder: &Path) -> String {
    let mut text = format!(
        "no equilibrium was found, neither on the path of growing loads nor by damped motion from it: {} at {:.6} % of the {}",
        kind(loss),
        100.0 * loss.fraction,
        load(loss.load)
    );
    let on = rest.voltages.iter().filter(|(_, v)| **v != 0.0);
    for (name, v) in on {
        text.push_str(&format!(", {name} = {:.6} kV", v / 1e3));
    }
    if let Some(mode) = rest.softest_mode.as_ref().filter(|m| !m.moves.is_empty()) {
        text.push_str(&format!("; softest motion: {}", mode.moves));
    }
    if let Some(field) = rest.largest_nominal_field.filter(|field| *field > 0.0) {
        text.push_str(&format!("; largest nominal field {:.3} MV/m", field / 1e6));
    }
    text.push_str(&format!("; the state there is in {}", folder.display()));
    text
}

/// Rows of the page.
pub(super) fn rows(rest: &Rest, status: &str) -> Vec<(String, String)> {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let mut rows = vec![row("status", status.replace('_', " "))];
    rows.push(row(
        "verdict",
        match &rest.fraction {
            None => rest.verdict(),
            Some(_) => "the last equilibrium of the path of growing loads".to_owned(),
        },
    ));
    let on = rest.voltages.iter().filter(|(_, v)| **v != 0.0);
    let on: Vec<String> = on
        .map(|(name, v)| format!("{name} {:.4} kV", v / 1e3))
        .collect();
    if !on.is_empty() {
        rows.push(row("voltages", on.join(", ")));
    }
    rows.extend(rest.softest().map(|text| row("softest mode", text)));
    rows.extend(rest.stretched().map(|text| row("muscle stretches", text)));
    rows
}

/// The equilibrium as lines of a table.
pub(super) fn text(model: &Model, rest: &Rest) -> String {
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
    if let Some(stretches) = rest.stretched() {
        text.push_str(&format!("muscle stretches  {stretches}\n"));
    }
    if !rest.stiffness.is_empty() {
        let (unit, factor) = rest.unit;
        let values: Vec<_> = rest
            .stiffness
            .iter()
            .map(|k| format!("{:.6}", factor * k))
            .collect();
        text.push_str(&format!("stiffness  {} {unit}\n", values.join("  ")));
    }
    if let Some(mode) = rest.softest() {
        text.push_str(&format!("softest mode  {mode}\n"));
    }
    text.push_str(&rest.verdict());
    text
}

/// Reduces observations to those of a state of rest: neither time nor rates nor what follows from them.
pub(super) fn at_rest(mut observed: Observations) -> Observations {
    let moves = |name: &str| {
        let of_motion = ["linear_momentum", "angular_momentum", "kinetic_energy"];
        let others = ["time", "dissipated_energy", "following_load_work"];
        others.contains(&name) || of_motion.iter().any(|word| name.starts_with(word))
    };
    let is_rate = |unit: &str| ["rad/ms", "mm/ms", "A", "W"].contains(&unit);
    let is_of_motion = |column: &Column| moves(&column.name) || is_rate(column.unit);
    observed.columns.retain(|column| !is_of_motion(column));
    observed
}

/// A path in `summary.json`.
#[derive(Debug, Serialize)]
pub(super) struct PathSummary {
    /// Number of equilibria.
    points: usize,
    /// Largest fraction of the voltages on the path: of these equilibria and of those where stability is lost between them.
    largest_fraction: f64,
    /// Points at which stability is lost.
    pub(super) lost: Vec<StabilityLossRecord>,
}

/// A loss of stability.
#[derive(Debug, Serialize)]
pub(super) struct StabilityLossRecord {
    /// Exact fraction of the voltages.
    pub(super) fraction: f64,
    /// `pull_in` or `buckling`.
    kind: &'static str,
    /// The same in words.
    #[serde(skip)]
    pub(super) words: &'static str,
}

impl PathSummary {
    pub(super) fn new(found: &Continuation) -> Self {
        let loss = |&(_, fraction, kind): &(usize, f64, Instability)| StabilityLossRecord {
            fraction,
            kind: kind.key(),
            words: kind.words(),
        };
        let lost = found.lost.iter().map(|&(_, fraction, _)| fraction);
        let all = found.fractions.iter().copied().chain(lost);
        Self {
            points: found.points.len(),
            largest_fraction: all.fold(0.0, f64::max),
            lost: found.lost.iter().map(loss).collect(),
        }
    }

    /// Rows of the page; `shown` is the fraction of the voltages of the equilibrium that is drawn.
    pub(super) fn rows(&self, shown: f64) -> Vec<(String, String)> {
        let mut rows = vec![
            ("equilibria".to_owned(), self.points.to_string()),
            (
                "largest fraction of the voltages".to_owned(),
                format!("{:.6} %", 100.0 * self.largest_fraction),
            ),
        ];
        rows.extend(self.lost.iter().map(|loss| {
            let place = format!("{:.6} % of the voltages", 100.0 * loss.fraction);
            (loss.words.to_owned(), place)
        }));
        let place = format!("the equilibrium at {:.6} %", 100.0 * shown);
        rows.push(("configuration".to_owned(), place));
        rows
    }
}
