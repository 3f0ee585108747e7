//! A static equilibrium in words and in `summary.json`: joint coordinates, marker places, stiffness, and the route to it.

use crate::app::fields;
use crate::app::linear_systems::multigrid;
use crate::app::request::counted;
use crate::app::vibrations;
use crate::dynamics::trajectory::{Column, Observations};
use crate::dynamics::{Instability, Load, LowestMode, Route, Softening, StabilityLoss};
use crate::files::Entries;
use crate::model::system::{Joint, JointKind};
use crate::report::table;
use crate::tasks::EquilibriumResult;
use crate::workflow::motion::solved;
use std::collections::BTreeMap;
use std::path::Path;

/// A static equilibrium, or the last one on the way to the loads asked for.
#[derive(Debug)]
pub(super) struct Rest<'a> {
    result: &'a EquilibriumResult,
    /// Voltage of each muscle and electrode in V.
    voltages: BTreeMap<&'a str, f64>,
    /// Coordinate of each joint in rad or m.
    joints: BTreeMap<&'a str, f64>,
    /// Place of each marker in m.
    markers: BTreeMap<&'a str, [f64; 3]>,
    /// Stretch of each lumped muscle.
    stretches: BTreeMap<&'a str, f64>,
    /// Eigenvalues of the stiffness in joint coordinates, N m/rad for angles, N/m for displacements; where there are both, N mm for each rad and
    /// each length of the system.
    stiffness: Vec<f64>,
    /// Unit of the stiffness in the text, and the factor to it from that of the list.
    unit: (&'static str, f64),
    /// Largest electric field of an element of a block in its reference configuration in V/m.
    largest_nominal_field: Option<f64>,
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

impl<'a> Rest<'a> {
    /// Describes an equilibrium; the last one where growing loads lose it.
    pub(super) fn new(result: &'a EquilibriumResult, observed: &'a Observations) -> Self {
        let EquilibriumResult {
            model,
            found,
            discrete,
            trajectory,
            ..
        } = result;
        let system = &model.system;
        let coordinates = &solved(model, discrete, None).joints[0];
        let moving = system.joints.iter().zip(coordinates);
        let moving = moving.filter(|(joint, _)| joint.has_coordinate());
        let prismatic = |joint: &Joint| matches!(joint.kind, JointKind::Prismatic { .. });
        let slides = moving.clone().any(|(joint, _)| prismatic(joint));
        let turns = moving.clone().any(|(joint, _)| !prismatic(joint));
        // From N mm/rad and N/mm to SI, and from there to the text.
        let (factor, unit) = match (slides, turns) {
            (false, _) => (1e-3, ("N mm/rad", 1e3)),
            (true, false) => (1e3, ("N/mm", 1e-3)),
            (true, true) => (1.0, (MIXED, 1.0)),
        };
        let joints = moving.map(|(joint, &value)| {
            let unit = if prismatic(joint) { 1e3 } else { 1.0 };
            (joint.name.as_str(), value / unit)
        });
        let markers = system.markers.iter().zip(&trajectory.marks[0]);
        let voltages = model.sources.iter().zip(&trajectory.voltages[0]);
        let driven = voltages.filter(|(source, _)| source.takes_voltage);
        let stretches = observed.columns.iter().filter_map(|column| {
            let muscle = column.name.strip_suffix("_stretch")?;
            let value = column.values.first().filter(|v| v.is_finite())?;
            Some((muscle, *value))
        });
        Self {
            voltages: driven.map(|(s, v)| (s.name.as_str(), *v)).collect(),
            joints: joints.collect(),
            markers: markers
                .map(|(marker, place)| (marker.name.as_str(), (place / 1e3).into()))
                .collect(),
            stretches: stretches.collect(),
            stiffness: found.stiffness.iter().map(|k| factor * k).collect(),
            unit,
            largest_nominal_field: fields::largest_nominal_field(model, discrete, 0),
            result,
        }
    }

    /// Its part of the summary.
    pub(super) fn entries(&self) -> Entries {
        let EquilibriumResult { found, loss, .. } = self.result;
        let fraction = loss.map(|loss| match loss.load {
            Load::Forces => 0.0,
            Load::Voltages => loss.fraction,
        });
        let softest = found.softest.as_ref().map(|mode| {
            let softened_by = mode.softening.map(|softening| match softening {
                Softening::Voltages => "voltages",
                Softening::Loads => "loads",
                Softening::Elastic => "elastic_forces",
            });
            Entries::default()
                .with("moves", &mode.moves)
                // Absent where nothing takes from the elastic stiffness.
                .with_some("softened_by", softened_by)
        });
        // Of the stiffness of nodes, with potentials that follow; in N/m.
        let lowest = found.lowest.as_ref().map(|mode| {
            Entries::default()
                .with("stiffness", 1e3 * mode.stiffness)
                // There is an eigenvalue within this distance.
                .with("bound", 1e3 * mode.bound)
                .with("iterations", mode.iterations)
        });
        let route = match (loss, found.route) {
            (Some(_), _) | (None, Route::Loads) => "growing_loads",
            (None, Route::Beyond(_)) => "path_continued",
            (None, Route::DampedMotion(_)) => "damped_motion",
        };
        let lost = self.lost().map(|loss| {
            Entries::default()
                .with("load", load(loss.load))
                .with("fraction", loss.fraction)
                .with("kind", status(loss))
        });
        let grids = found.on_grids;
        let grids = grids.and_then(|(report, fallbacks)| multigrid(report, fallbacks));
        Entries::default()
            .with("voltages", &self.voltages)
            // Of the voltages asked for, where they were not reached.
            .with_some("fraction", fraction)
            .with_some("largest_nominal_field", self.largest_nominal_field)
            .with("joints", &self.joints)
            .with("markers", &self.markers)
            .with("stretches", &self.stretches)
            .with("stiffness", &self.stiffness)
            .with_some("softest_mode", softest)
            // Nothing where it is not known.
            .with("is_stable", found.is_stable())
            // Directions in which a disturbance grows; those that were found where the lowest mode decided.
            .with("unstable_directions", found.unstable)
            .with_some("lowest_mode", lowest)
            .with("route", route)
            .with_some("lost", lost)
            .with("newton_iterations", found.iterations)
            .with_some("multigrid", grids)
            .with_some(
                "vibrations",
                self.result.vibrations.as_ref().map(vibrations::entries),
            )
    }

    /// State at which the path of growing loads loses its stable equilibrium, if this one does not lie on it.
    fn lost(&self) -> Option<StabilityLoss> {
        self.result.loss.or(self.result.found.loss())
    }

    /// `183.5 N mm/rad: joint1, stretch of muscle2 (at 0.7)`.
    fn softest(&self) -> Option<String> {
        let moves = &self.result.found.softest.as_ref()?.moves;
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

    /// Voltages that are not zero in kV.
    fn driven(&self) -> impl Iterator<Item = (&str, f64)> {
        let all = self.voltages.iter().filter(|(_, v)| **v != 0.0);
        all.map(|(name, v)| (*name, v / 1e3))
    }

    /// `stable equilibrium`, and how it was found.
    pub(super) fn verdict(&self) -> String {
        let found = &self.result.found;
        let mut text = match found.is_stable() {
            Some(true) => "stable equilibrium",
            Some(false) => "unstable equilibrium",
            None => "equilibrium; its stability is not known",
        }
        .to_owned();
        if let (Some(false), Some(count @ 1..)) = (found.is_stable(), found.unstable) {
            let cause = match found.softest.as_ref().and_then(|mode| mode.softening) {
                Some(Softening::Voltages) => "pull-in",
                Some(Softening::Loads) => "collapse under load",
                Some(Softening::Elastic) | None => "buckling",
            };
            let directions = counted(count, "direction");
            text.push_str(&match &found.lowest {
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
        if let Some(LowestMode {
            stiffness, bound, ..
        }) = &found.lowest
        {
            text.push_str(&format!(
                "; by the lowest mode, {stiffness:.4e} ± {bound:.1e} N/mm for the vector of all nodes"
            ));
        }
        let place = match (self.result.loss, found.route) {
            (Some(_), _) | (None, Route::Loads) => return text,
            (None, Route::Beyond(_)) => "on the continued path",
            (None, Route::DampedMotion(_)) => "by damped motion from an unstable state",
        };
        if let Some(lost) = self.lost() {
            let (what, kind) = (load(lost.load), status(lost).replace('_', " "));
            let kind = kind.replace("pull in", "pull-in");
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

    /// One line: the kind of loss, its loads, the parts that give way, and the last state.
    pub(super) fn lost_words(&self, loss: StabilityLoss, folder: &Path) -> String {
        let mut text = format!(
            "no equilibrium was found, neither on the path of growing loads nor by damped motion from it: {} at {:.6} % of the {}",
            kind(loss),
            100.0 * loss.fraction,
            load(loss.load)
        );
        for (name, kilovolts) in self.driven() {
            text.push_str(&format!(", {name} = {kilovolts:.6} kV"));
        }
        let softest = self.result.found.softest.as_ref();
        if let Some(mode) = softest.filter(|m| !m.moves.is_empty()) {
            text.push_str(&format!("; softest motion: {}", mode.moves));
        }
        if let Some(field) = self.largest_nominal_field.filter(|field| *field > 0.0) {
            text.push_str(&format!("; largest nominal field {:.3} MV/m", field / 1e6));
        }
        text.push_str(&format!("; the state there is in {}", folder.display()));
        text
    }

    /// Rows of the page.
    pub(super) fn rows(&self) -> Vec<(String, String)> {
        let verdict = match self.result.loss {
            None => self.verdict(),
            Some(_) => "the last equilibrium of the path of growing loads".to_owned(),
        };
        let on = self.driven();
        let on: Vec<String> = on.map(|(name, v)| format!("{name} {v:.4} kV")).collect();
        let rows = [
            ("verdict", Some(verdict)),
            ("voltages", (!on.is_empty()).then(|| on.join(", "))),
            ("softest mode", self.softest()),
            ("muscle stretches", self.stretched()),
        ];
        let rows = rows.into_iter();
        let rows = rows.filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let modes = self.result.vibrations.iter().flat_map(vibrations::rows);
        rows.chain(modes).collect()
    }

    /// The equilibrium as lines of a table.
    pub(super) fn text(&self) -> String {
        let system = &self.result.model.system;
        let mut rows = Vec::new();
        for joint in system.joints.iter().filter(|j| j.has_coordinate()) {
            // What rounds to zero has no sign.
            let value = self.joints[&*joint.name];
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
        for marker in &system.markers {
            let [x, y, z] = self.markers[&*marker.name].map(|x| format!("{:.6}", 1e3 * x));
            rows.push(vec![marker.name.clone(), x, y, z, "mm".to_owned()]);
        }
        let mut text = table::aligned(&rows);
        if let Some(stretches) = self.stretched() {
            text.push_str(&format!("muscle stretches  {stretches}\n"));
        }
        if !self.stiffness.is_empty() {
            let (unit, factor) = self.unit;
            let values = self.stiffness.iter();
            let values: Vec<_> = values.map(|k| format!("{:.6}", factor * k)).collect();
            text.push_str(&format!("stiffness  {} {unit}\n", values.join("  ")));
        }
        if let Some(mode) = self.softest() {
            text.push_str(&format!("softest mode  {mode}\n"));
        }
        if let Some(found) = &self.result.vibrations {
            text.push_str(&vibrations::text(found));
        }
        text + &self.verdict()
    }
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
