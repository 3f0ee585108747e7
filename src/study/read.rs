//! A study file read and checked: every point is a problem with its overrides, read before the first one runs.

use crate::app::without_dots;
use crate::control::problem::{Duration, Task};
use crate::files::changes::Changes;
use crate::files::study::{MethodSpec, ReferenceSpec, RefineSpec, StudySpec};
use crate::files::{Document, Loaded, SceneError, Scope, number_and_unit, read_problem};
use crate::math::refuse;
use crate::study::measure::{self, StudyMeasure, StudyTask};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Fewest timed runs of a point.
const RUNS: usize = 5;
/// Fewest points of a reference: those a limit is extrapolated from.
const POINTS: usize = 3;

/// A study, checked.
#[derive(Debug)]
pub struct Study {
    /// Title of the page.
    pub title: String,
    /// Subject of the comparison and its reason.
    pub about: Option<String>,
    /// Task of its problems.
    pub asked: StudyTask,
    /// The methods that are compared, in their order.
    pub methods: Vec<Method>,
    /// Index of the method against whose limit errors are measured; none where each method has its own limit.
    pub reference: Option<usize>,
    /// Points of that method that are run for the reference alone; where there are none, its points in the study are the reference.
    pub of_reference: Vec<StudyPoint>,
    /// Names of the markers whose places are compared.
    pub markers: Vec<String>,
    /// Quantities that are measured.
    pub measures: Vec<StudyMeasure>,
    /// Number of timed runs of each point.
    pub runs: usize,
}

/// A method: one curve.
#[derive(Debug)]
pub struct Method {
    /// Name in legends and tables.
    pub name: String,
    /// Name of the refinement.
    pub refined: String,
    /// The points, coarsest first.
    pub points: Vec<StudyPoint>,
}

/// A point: one problem.
#[derive(Debug)]
pub struct StudyPoint {
    /// The value that is refined, as it is written.
    pub label: String,
    /// Length that goes to zero as the points are refined.
    pub size: f64,
    /// The problem file as seen from the current folder.
    pub problem: PathBuf,
    /// Overrides `path=value`, as of `--set`.
    pub set: Vec<String>,
    /// The problem, read with them.
    pub loaded: Loaded,
}

/// Reads a study and all problems it asks for.
///
/// # Errors
/// The study, one of its problems or overrides is wrong.
pub fn read_study(path: &Path) -> Result<Study, SceneError> {
    let document = Document::read(path)?;
    let spec: StudySpec = document.parse()?;
    let scope = Scope::of(&document);
    refuse!(if spec.methods.is_empty(), scope.key("methods");
        found "no method", expected "1 method or more");
    let names: Vec<String> = spec.methods.iter().map(|m| m.name.clone()).collect();
    let place = |index: usize| scope.key("methods").index(index).key("name");
    scope.unique(&names, &[], place)?;
    let methods = (0..spec.methods.len())
        .map(|index| method(&spec, index, &scope))
        .collect::<Result<Vec<_>, _>>()?;
    let (reference, of_reference) = match &spec.reference {
        None => own(&methods, &scope)?,
        Some(reference) => of_one(&spec, reference, &methods, &scope)?,
    };
    let asked = same_question(&methods, &of_reference, &scope)?;
    let runs = spec.runs.unwrap_or(RUNS);
    refuse!(if runs < RUNS, scope.key("runs");
        found runs, expected format!("{RUNS} runs or more"));
    Ok(Study {
        markers: markers(&spec, &methods, &scope)?,
        measures: measures(&spec, asked, &methods, &scope)?,
        runs,
        title: spec.title,
        about: spec.about,
        asked,
        methods,
        reference,
        of_reference,
    })
}

fn method(spec: &StudySpec, index: usize, scope: &Scope<'_>) -> Result<Method, SceneError> {
    let written = &spec.methods[index];
    let own = scope.key("methods").index(index);
    let (refine, place) = match (&written.refine, &spec.refine) {
        (Some(refine), _) => (refine, own.key("refine")),
        (None, Some(refine)) => (refine, scope.key("refine")),
        (None, None) => return Err(own.wrong("no key \"refine\"", "it here or in the study")),
    };
    Ok(Method {
        name: written.name.clone(),
        refined: refine.name.clone(),
        points: points(spec, index, refine, &place, scope)?,
    })
}

/// The points of a method under a list of refinements that stands in a place.
fn points(
    spec: &StudySpec,
    index: usize,
    refine: &RefineSpec,
    place: &Scope<'_>,
    scope: &Scope<'_>,
) -> Result<Vec<StudyPoint>, SceneError> {
    let MethodSpec { problem, set, .. } = &spec.methods[index];
    let own = scope.key("methods").index(index);
    let (written, at) = match problem {
        Some(path) => (path, own.key("problem")),
        None => (&spec.problem, scope.key("problem")),
    };
    let file = seen_from_here(&at.file(written, "the path of a problem file")?);
    let (labels, sizes) = sizes(refine, place)?;
    let point = |k: usize, (label, size): (String, f64)| {
        let mut changes = Changes::default();
        changes.extend(&spec.set, &scope.key("set"))?;
        changes.extend(set, &own.key("set"))?;
        for (key, values) in &refine.set {
            changes.push(key, &values[k], place.key("set").key(key).index(k))?;
        }
        let loaded =
            read_problem(&file, &changes.words).map_err(|error| changes.at_fault(error, &file))?;
        Ok(StudyPoint {
            label,
            size,
            problem: file.clone(),
            set: changes.words,
            loaded,
        })
    };
    let each = labels.into_iter().zip(sizes).enumerate();
    each.map(|(k, of)| point(k, of)).collect()
}

/// The method against whose limit errors are measured, and its points for this alone.
type Reference = (Option<usize>, Vec<StudyPoint>);

/// Each method against its own limit.
fn own(methods: &[Method], scope: &Scope<'_>) -> Result<Reference, SceneError> {
    let few = |method: &Method| method.points.len() < POINTS;
    refuse!(if let Some(index) = methods.iter().position(few), scope.key("methods").index(index);
        found format!("{} points", methods[index].points.len()),
        expected format!("{POINTS} or more, from which a limit is extrapolated, or a \"reference\" in the study"));
    Ok((None, Vec::new()))
}

/// All against the limit of one.
fn of_one(
    spec: &StudySpec,
    reference: &ReferenceSpec,
    methods: &[Method],
    scope: &Scope<'_>,
) -> Result<Reference, SceneError> {
    let own = scope.key("reference");
    let names: Vec<String> = methods.iter().map(|one| one.name.clone()).collect();
    let method = own.key("method");
    let method = method.find(&reference.method, &names, "the name of a method")?;
    let (points, count, place) = match &reference.refine {
        None => (Vec::new(), methods[method].points.len(), own),
        Some(refine) => {
            let place = own.key("refine");
            let points = points(spec, method, refine, &place, scope)?;
            let count = points.len();
            (points, count, place)
        }
    };
    refuse!(if count < POINTS, place;
        found format!("{count} {}", if count == 1 { "point" } else { "points" }),
        expected format!("{POINTS} or more, from which a limit is extrapolated"));
    Ok((Some(method), points))
}

/// Checks that all points have the same task: the same kind of problem, and motions of the same length.
fn same_question(
    methods: &[Method],
    of_reference: &[StudyPoint],
    scope: &Scope<'_>,
) -> Result<StudyTask, SceneError> {
    let key = |index| scope.key("methods").index(index);
    let each = methods.iter().enumerate();
    let each = each.flat_map(|(i, method)| method.points.iter().map(move |point| (i, point)));
    let each = each.map(|(i, point)| (key(i), point));
    let reference = of_reference.iter();
    let all = each.chain(reference.map(|point| (scope.key("reference"), point)));
    let mut first: Option<(StudyTask, Option<f64>)> = None;
    for (place, point) in all {
        let Some((asked, duration)) = task_of(&point.loaded.task) else {
            let expected = "a simulation, an equilibrium or optimal control of one motion";
            return Err(place.wrong("a problem of another kind", expected));
        };
        let is_path = matches!(&point.loaded.task, Task::Equilibrium(task) if task.path.is_some());
        refuse!(if is_path, place;
            found "a path of equilibria", expected "one equilibrium: no \"path\"");
        let &mut (kind, length) = first.get_or_insert((asked, duration));
        refuse!(if kind != asked, place;
            found asked.name(), expected format!("{}, as of the first point", kind.name()));
        // The same number, but for the way it is written.
        let differ = |(a, b): (f64, f64)| (a - b).abs() > 1e-9 * a;
        let [found, expected] = [duration, length].map(|d| d.unwrap_or_default() / 1e3);
        refuse!(if length.zip(duration).is_some_and(differ), place;
            found format!("a duration of {found} s"),
            expected format!("{expected} s, as of the first point"));
    }
    let (asked, _) = first.expect("there is a method, and each has a point");
    Ok(asked)
}

/// The kind of a task, and its length in ms where that is given; none of an identification.
fn task_of(task: &Task) -> Option<(StudyTask, Option<f64>)> {
    Some(match task {
        Task::Simulate(task) => (StudyTask::Motion, Some(task.duration)),
        Task::Equilibrium(_) => (StudyTask::Rest, None),
        Task::Control(task) => match task.duration {
            Duration::Given(duration) => (StudyTask::Control, Some(duration)),
            Duration::Free { .. } => (StudyTask::Control, None),
        },
        Task::Identify(_) | Task::Motions(_) => return None,
    })
}

/// Markers that every scene has.
fn markers(
    spec: &StudySpec,
    methods: &[Method],
    scope: &Scope<'_>,
) -> Result<Vec<String>, SceneError> {
    let of = |point: &StudyPoint| -> Vec<String> {
        let markers = point.loaded.system.markers.iter();
        markers.map(|marker| marker.name.clone()).collect()
    };
    let wanted = match &spec.markers {
        Some(names) => names.clone(),
        None => of(&methods[0].points[0]),
    };
    let place = |index: usize| match &spec.markers {
        Some(_) => scope.key("markers").index(index),
        None => scope.clone(),
    };
    scope.unique(&wanted, &[], place)?;
    for point in methods.iter().flat_map(|method| &method.points) {
        let there = of(point);
        for (index, name) in wanted.iter().enumerate() {
            let expected = format!("a marker of each scene, as of {}", point.problem.display());
            place(index).find(name, &there, &expected)?;
        }
    }
    Ok(wanted)
}

/// Returns the measures: those that the study names, or all that there are.
fn measures(
    spec: &StudySpec,
    asked: StudyTask,
    methods: &[Method],
    scope: &Scope<'_>,
) -> Result<Vec<StudyMeasure>, SceneError> {
    let points = || methods.iter().flat_map(|method| &method.points);
    let all = measure::available(asked, points().map(|point| &point.loaded));
    let Some(named) = &spec.measures else {
        return Ok(all);
    };
    let wanted = named.iter().enumerate().map(|(index, &measure)| {
        let place = scope.key("measures").index(index);
        refuse!(if named[..index].contains(&measure), place;
            found format!("\"{measure}\" again"), expected "each measure once");
        let names: Vec<_> = all.iter().map(|m| format!("\"{m}\"")).collect();
        refuse!(if !all.contains(&measure), place;
            found format!("\"{measure}\", which {} does not have", asked.name()),
            expected format!("one of {}", names.join(", ")));
        Ok(measure)
    });
    let wanted: Vec<_> = wanted.collect::<Result<_, _>>()?;
    refuse!(if wanted.is_empty(), scope.key("measures");
        found "an empty list", expected "1 measure or more");
    Ok(wanted)
}

/// A path without `..` and `.`, where it leads to the same file.
fn seen_from_here(path: &Path) -> PathBuf {
    let plain = without_dots(path);
    match (plain.canonicalize(), path.canonicalize()) {
        (Ok(a), Ok(b)) if a == b => plain,
        _ => path.to_owned(),
    }
}

/// Labels of the points of a refinement, and lengths that fall towards zero.
fn sizes(refine: &RefineSpec, scope: &Scope<'_>) -> Result<(Vec<String>, Vec<f64>), SceneError> {
    let set = scope.key("set");
    let Some((first, values)) = refine.set.iter().next() else {
        return Err(set.wrong("no override", "1 override or more"));
    };
    refuse!(if values.is_empty(), set.key(first);
        found "an empty list", expected "1 value or more");
    for (key, others) in &refine.set {
        refuse!(if others.len() != values.len(), set.key(key);
            found format!("{} values", others.len()),
            expected format!("{}, as many as of {first:?}", values.len()));
    }
    let (labels, numbers, place) = match (&refine.sizes, refine.set.len()) {
        (Some(sizes), _) => {
            let place = scope.key("sizes");
            refuse!(if sizes.len() != values.len(), place;
                found format!("{} sizes", sizes.len()),
                expected format!("{}, one per point", values.len()));
            let labels = sizes.iter().map(|&size| label(size)).collect();
            (labels, sizes.clone(), place)
        }
        (None, 1) => {
            let place = set.key(first);
            let read = of_one_unit(values);
            let Some((labels, numbers)) = read else {
                let found = format!("values of {first:?} that are neither numbers nor of one unit");
                let expected = "\"sizes\", which tell how fine each point is";
                return Err(scope.wrong(found, expected));
            };
            (labels, numbers, place)
        }
        (None, _) => {
            let expected = "\"sizes\", which tell how fine each point is";
            return Err(scope.wrong("several overrides that are refined together", expected));
        }
    };
    let negative = numbers.iter().position(|size| *size <= 0.0);
    refuse!(if let Some(k) = negative, place.index(k);
        found numbers[k], expected "a positive size");
    let grows = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    let falls = numbers.windows(2).all(|pair| pair[0] > pair[1]);
    // A length or a tolerance that grows is refined the other way round.
    let are_counts = refine.sizes.is_some()
        || (numbers[0] >= 1.0 && values.iter().all(|value| value.is_number()));
    match (grows, falls) {
        (true, _) if !are_counts && numbers.len() > 1 => Err(place.wrong(
            labels.join(", "),
            "values that fall, the coarsest point first: growing ones are counts, 1 or more without a unit",
        )),
        (true, _) => Ok((labels, numbers.iter().map(|n| n.recip()).collect())),
        (_, true) => Ok((labels, numbers)),
        _ => Err(place.wrong(
            labels.join(", "),
            "sizes that only grow, or only fall: the coarsest point first",
        )),
    }
}

/// A number as it is called: `0.001`, `1e-4`.
fn label(number: f64) -> String {
    match number.abs() {
        x if x != 0.0 && !(1e-3..1e6).contains(&x) => format!("{number:e}"),
        _ => number.to_string(),
    }
}

/// Values as they are written, and as numbers, where these are of one unit.
fn of_one_unit(values: &[Value]) -> Option<(Vec<String>, Vec<f64>)> {
    let parts: Option<Vec<_>> = values.iter().map(number_and_unit).collect();
    let (numbers, units): (Vec<_>, Vec<_>) = parts?.into_iter().unzip();
    let is_same = units.iter().all(|unit| *unit == units[0]);
    let text = |(value, number): (&Value, &f64)| match value.as_str() {
        Some(text) => text.to_owned(),
        None => label(*number),
    };
    let texts = values.iter().zip(&numbers).map(text).collect();
    is_same.then_some((texts, numbers))
}
