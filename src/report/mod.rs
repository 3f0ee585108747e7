//! Results of a run: tables, figures and a page.
pub mod atomic;
pub mod axes;
pub mod body;
pub mod canvas;
pub mod curves;
mod drawing;
pub mod file_set;
pub mod gltf;
pub mod legend;
pub mod lines;
mod load_arrows;
pub mod origin;
pub mod page;
pub mod paraview;
mod parts;
pub mod pose;
pub mod quoting;
mod run;
pub mod sampled;
pub mod sensitivities;
pub mod skins;
pub mod solids;
pub mod style;
pub mod table;
pub mod tip_path;
pub mod view;
pub mod viewpoint;

pub use run::{Branch, Figures, PageContent, Run};

use rayon::prelude::*;

use crate::math::{has_pool, join};
use crate::model::system::InputKind;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::lines::LinePlot;

/// Name of the page.
const PAGE: &str = "report.html";

/// Writes tables, figures and page; a page of an earlier run does not stay next to other results.
///
/// A figure without data (voltages of no muscles, energies that were not observed) is not written.
///
/// # Errors
/// A file cannot be written.
pub fn write_run(files: &mut FileSet, run: &Run<'_>) -> Result<(), WriteError> {
    let (page, texts) = join(|| page(run), || tables_and_figures(run));
    write(files, run, page, texts)
}

/// The page of a run where it is wanted.
fn page(run: &Run<'_>) -> Option<String> {
    let content = run.page?;
    Some(page::html(&run.system.name, &[*run], content, run.origin))
}

/// Writes files with their texts, those of ParaView and the page.
fn write(
    files: &mut FileSet,
    run: &Run<'_>,
    page: Option<String>,
    texts: Vec<(&str, String)>,
) -> Result<(), WriteError> {
    if run.figures.parts {
        parts::write(files, run.system, run.trajectory, run.origin)?;
    }
    let mut texts = texts.into_iter();
    texts.try_for_each(|(name, text)| files.add(name, text.as_bytes()))?;
    files.put(PAGE, page)
}

/// Makes the text of a file where there is something to show.
type Maker<'a> = &'a (dyn Fn() -> Option<String> + Sync);

/// Names and texts of all files but the page, several at once.
fn tables_and_figures(run: &Run<'_>) -> Vec<(&'static str, String)> {
    let Run {
        system,
        trajectory,
        skins,
        observations,
        origin,
        tracked,
        waypoints,
        ..
    } = *run;
    let view = run.figures.view;
    let coloured = &*solids::coloured(system, trajectory, observations);
    let mut motions: Vec<_> = run.comparison.into_iter().collect();
    motions.push((run.name, trajectory));
    let times = &trajectory.times;
    let drawn = |plot: Option<LinePlot>| Some(plot?.svg(origin));
    let trajectory_csv = || Some(table::trajectory_csv(run.tabulated, origin));
    let controls_csv = || Some(table::controls_csv(trajectory, system, origin));
    let configuration = || Some(pose::svg(system, coloured, skins, &run.shown(), origin));
    let animation = || gltf::text(system, coloured, skins, origin);
    let animation = || run.figures.gltf.then(animation).flatten();
    let stills = || pose::snapshots(system, coloured, skins, view, origin);
    let inputs = InputKind::ALL.map(|kind| {
        let svg = move || Some(curves::input_svg(system, trajectory, kind, origin)?.1);
        (curves::input_names(kind).0, svg)
    });
    let paths = || tip_path::svg(system, &motions, tracked, waypoints, view, origin);
    let paths = || (!system.markers.is_empty()).then(paths);
    let joints = || drawn(curves::joints(system, trajectory).plot());
    let charges = || {
        let (label, charges) = curves::charges(system, trajectory, observations);
        drawn(curves::plot(label, charges).filter(|_| !skins.list.is_empty()))
    };
    let energies = || curves::energies(trajectory, observations);
    let energies = || drawn(curves::plot("energy [mJ]", energies()));
    let tracking_csv = || curves::tracking_csv(times, tracked, origin);
    let tracking = || drawn(curves::deviations(times, tracked).plot());
    let before: [(&'static str, Maker<'_>); 5] = [
        ("trajectory.csv", &trajectory_csv),
        ("controls.csv", &controls_csv),
        ("configuration.svg", &configuration),
        ("motion.gltf", &animation),
        ("snapshots.svg", &stills),
    ];
    let behind: [(&'static str, Maker<'_>); 6] = [
        ("tip_path.svg", &paths),
        ("joint_angles.svg", &joints),
        ("charge.svg", &charges),
        ("energy.svg", &energies),
        ("tracking.csv", &tracking_csv),
        ("tracking.svg", &tracking),
    ];
    let inputs = inputs.iter().map(|(name, make)| (*name, make as Maker<'_>));
    let makers: Vec<_> = before.into_iter().chain(inputs).chain(behind).collect();
    let made = |(name, make): &(&'static str, Maker<'_>)| Some((*name, make()?));
    match has_pool() {
        true => makers.par_iter().with_max_len(1).filter_map(made).collect(),
        false => makers.iter().filter_map(made).collect(),
    }
}

/// Writes table, figure and page of a state of rest, a motion of one instant.
///
/// # Errors
/// A file cannot be written.
pub fn write_still(files: &mut FileSet, table: &str, run: &Run<'_>) -> Result<(), WriteError> {
    let (system, trajectory, skins, origin) = (run.system, run.trajectory, run.skins, run.origin);
    let csv = table::trajectory_csv(run.observations, origin);
    let svg = pose::svg(system, trajectory, skins, &run.shown(), origin);
    let mut texts = vec![(table, csv), ("configuration.svg", svg)];
    if run.figures.gltf {
        let text = gltf::text(system, trajectory, skins, origin);
        texts.extend(text.map(|text| ("motion.gltf", text)));
    }
    write(files, run, page(run), texts)
}
