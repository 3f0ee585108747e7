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
mod moving_lines;
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

/// Writes the page of a run alone.
///
/// # Errors
/// The file cannot be written.
pub fn write_page(files: &mut FileSet, run: &Run<'_>) -> Result<(), WriteError> {
    files.put(PAGE, page(run))
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
        parts::write(files, run)?;
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
        origin,
        ..
    } = *run;
    let in_space = &Run {
        trajectory: &solids::coloured(system, trajectory, run.observations),
        ..*run
    };
    let drawn = |plot: Option<LinePlot>| Some(plot?.svg(origin));
    let inputs = InputKind::ALL.map(|kind| {
        let svg = move || curves::input_svg(run, kind);
        (curves::input_names(kind).0, svg)
    });
    let before: [(&'static str, Maker<'_>); 5] = [
        ("trajectory.csv", &|| {
            Some(table::trajectory_csv(run.tabulated, origin))
        }),
        ("controls.csv", &|| {
            Some(table::controls_csv(trajectory, system, origin))
        }),
        ("configuration.svg", &|| Some(pose::svg(in_space))),
        ("motion.gltf", &|| animation(in_space)),
        ("snapshots.svg", &|| pose::snapshots(in_space)),
    ];
    let behind: [(&'static str, Maker<'_>); 6] = [
        ("tip_path.svg", &|| {
            (!system.markers.is_empty()).then(|| tip_path::svg(run))
        }),
        ("joint_angles.svg", &|| drawn(curves::joints(run).plot())),
        ("charge.svg", &|| {
            let (label, charges) = curves::charges(run);
            drawn(curves::plot(label, charges).filter(|_| !run.skins.list.is_empty()))
        }),
        ("energy.svg", &|| {
            drawn(curves::plot("energy [mJ]", curves::energies(run)))
        }),
        ("tracking.csv", &|| curves::tracking_csv(run)),
        ("tracking.svg", &|| drawn(curves::deviations(run).plot())),
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
    let csv = table::trajectory_csv(run.observations, run.origin);
    let mut texts = vec![(table, csv), ("configuration.svg", pose::svg(run))];
    texts.extend(animation(run).map(|text| ("motion.gltf", text)));
    write(files, run, page(run), texts)
}

/// The motion as glTF where it is wanted.
fn animation(run: &Run<'_>) -> Option<String> {
    run.figures.gltf.then(|| gltf::text(run)).flatten()
}
