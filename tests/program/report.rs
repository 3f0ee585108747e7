//! Results of a run: tables read back, figures are well-formed, files are whole or absent.

use std::fs;

use crate::common::tracked::tracked;
use nalgebra::Vector3;
use proboscis::dynamics::trajectory::{Column, Observations, Trajectory};
use proboscis::model::system::{InputKind, JointKind, Shape, System};
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::file_set::FileSet;
use proboscis::report::lines::{LinePlot, Mark, Series};
use proboscis::report::origin::Origin;
use proboscis::report::skins::Skins;
use proboscis::report::{
    PageContent, Run, curves, pose, quoting, style, table, tip_path, write_run,
};

fn origin() -> Origin {
    Origin {
        command: "proboscis control a<b>.json\n--out x".to_owned(),
        input: "a<b>.json".to_owned(),
        version: Origin::program(),
        ipopt: "3.14".to_owned(),
    }
}

/// Numbers of a CSV below its two header lines.
fn numbers(csv: &str) -> Vec<Vec<f64>> {
    let rows = csv.lines().skip(2);
    rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect()
}

/// Every tag closes, nothing is outside the root, no number is missing.
pub(crate) fn assert_well_formed(svg: &str) {
    assert!(svg.starts_with("<svg "));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let mut open = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        assert!(!tag.contains('<'), "{tag}");
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap());
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && rest.trim().is_empty());
}

/// Returns the number of polylines of this colour.
pub(crate) fn polylines(svg: &str, colour: style::Colour) -> usize {
    let stroke = format!("stroke=\"{}\"", colour.hex().to_uppercase());
    let lines = svg.lines();
    lines
        .filter(|line| line.starts_with("<polyline") && line.contains(&stroke))
        .count()
}

pub(crate) fn swing() -> (System, Trajectory) {
    let system = crate::common::trunk::system(6);
    let trajectory = crate::common::trunk::swing(&system, 20);
    (system, trajectory)
}

#[test]
fn points_are_carried_by_their_body_and_the_ground_stays() {
    let (system, trajectory) = swing();
    let muscle = &system.muscles[0];
    assert_eq!(trajectory.point(20, &muscle.from, &system), muscle.from.at);
    let tip = system.markers[0].point;
    assert!((trajectory.point(0, &tip, &system) - tip.at).norm() < 1e-9);
    // The joint belongs to both of its bodies.
    let joint = &system.joints[3];
    let [mut a, mut b] = [tip, tip];
    (a.body, a.at) = (joint.parent, joint.at);
    (b.body, b.at) = (Some(joint.child), joint.at);
    let gap = trajectory.point(20, &a, &system) - trajectory.point(20, &b, &system);
    assert!((trajectory.point(20, &a, &system) - joint.at).norm() > 1.0);
    assert!(gap.norm() < 1e-9);
}

#[test]
fn coordinates_are_named_after_their_joints() {
    let (mut system, mut trajectory) = swing();
    assert_eq!(trajectory.coordinates(&system).len(), 6);
    system.joints[1].kind = JointKind::Spherical;
    system.joints[2].kind = JointKind::Fixed;
    system.joints[3].kind = JointKind::Prismatic { axis: Vector3::y() };
    trajectory.joints = vec![vec![0.0; 4]; 21];
    let names = trajectory.coordinates(&system);
    let names: Vec<_> = names.iter().map(|c| (c.name.as_str(), c.unit)).collect();
    // Spherical and fixed joints have no coordinate.
    let expected = [
        ("joint1", "rad"),
        ("joint4", "mm"),
        ("joint5", "rad"),
        ("joint6", "rad"),
    ];
    assert_eq!(names, expected);
}

#[test]
fn tables_read_back_identical() {
    let (system, trajectory) = swing();
    let observations = trajectory.observe(&system);
    let csv = table::trajectory_csv(&observations, &origin());
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some(format!("# {}; every column at the time of its row", origin().line()).as_str())
    );
    let header = lines.next().unwrap();
    assert!(header.starts_with("time [ms],joint1 [rad],"));
    assert!(header.ends_with("tip_x [mm],tip_y [mm],tip_z [mm]"));
    let rows = numbers(&csv);
    assert_eq!(rows.len(), 21);
    for (i, column) in observations.columns.iter().enumerate() {
        let read: Vec<_> = rows.iter().map(|row| row[i]).collect();
        assert_eq!(read, column.values);
    }

    let csv = table::controls_csv(&trajectory, &system, &origin());
    let rows = numbers(&csv);
    assert_eq!(rows.len(), 20);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row[..2], trajectory.times[k..k + 2]);
        assert_eq!(row[2..], trajectory.voltages[k]);
    }
}

#[test]
fn tables_quote_names_and_keep_extreme_numbers() {
    let values = vec![f64::MIN_POSITIVE, -f64::MAX, 0.1 + 0.2, -0.0];
    let observations = Observations {
        columns: vec![Column {
            name: "a \"b\", c".to_owned(),
            unit: "",
            values: values.clone(),
        }],
    };
    let csv = table::trajectory_csv(&observations, &origin());
    assert_eq!(csv.lines().nth(1), Some("\"a \"\"b\"\", c\""));
    let read: Vec<_> = numbers(&csv).concat().iter().map(|x| x.to_bits()).collect();
    assert_eq!(read, values.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
}

#[test]
fn aligned_text_lines_up() {
    let rows = [["η", "10"], ["name", "2"]].map(|row| row.map(str::to_owned).to_vec());
    assert_eq!(table::aligned(&rows), "η     10\nname   2\n");
}

/// A figure of a motion without elastic blocks.
fn figure<T>(system: &System, trajectory: &Trajectory, make: impl FnOnce(&Run<'_>) -> T) -> T {
    let (skins, observations, origin) = (Skins::default(), Observations::default(), origin());
    make(&Run::from_trajectory(
        system,
        trajectory,
        &skins,
        &observations,
        &origin,
    ))
}

/// The figure of its voltages.
fn voltages(system: &System, trajectory: &Trajectory) -> String {
    let svg = |run: &Run<'_>| curves::input_svg(run, InputKind::Voltage);
    figure(system, trajectory, svg).unwrap()
}

#[test]
fn agonists_are_solid_and_antagonists_dashed() {
    let system = crate::common::trunk::system(6);
    let mut trajectory = crate::common::trunk::swing(&system, 20);
    let solid_alone = |trajectory: &Trajectory| {
        let mut system = system.clone();
        system.muscles.truncate(1);
        voltages(&system, trajectory)
    };
    for (k, voltages) in trajectory.voltages.iter_mut().enumerate() {
        *voltages = (0..12).map(|i| 100.0 * (i + k) as f64).collect();
    }
    let svg = voltages(&system, &trajectory);
    assert_well_formed(&svg);
    let (colour, _) = style::muscle(0);
    assert_eq!(style::muscle(1).0, colour);
    // One polyline for the curve and one in the legend; dashes are polylines of their own.
    assert_eq!(polylines(&solid_alone(&trajectory), colour), 2);
    assert!(polylines(&svg, colour) > 20);
}

#[test]
fn voltage_figures_hold_from_one_to_forty_muscles() {
    for segments in [1, 6, 20] {
        let system = crate::common::trunk::system(segments);
        let trajectory = crate::common::trunk::swing(&system, 5);
        let svg = voltages(&system, &trajectory);
        assert_well_formed(&svg);
        for muscle in &system.muscles {
            assert!(svg.contains(&format!(">\n{}\n<", muscle.name)));
        }
    }
    let looks: Vec<_> = (0..40).map(style::muscle).collect();
    for (i, look) in looks.iter().enumerate() {
        assert!(!looks[..i].contains(look), "muscle {i}");
    }
}

#[test]
fn what_is_not_finite_is_not_drawn() {
    let (system, mut trajectory) = swing();
    for k in [0, 7, 20] {
        trajectory.voltages[k.min(19)].fill(f64::NAN);
        trajectory.joints[k].fill(f64::INFINITY);
        trajectory.poses[k][5].centre.x = f64::NAN;
    }
    let curve = vec![[0.0, 1.0], [1e-3, 2.0], [1e-2, f64::NAN], [1e2, 1e-6]];
    let series = Series::curve("error", curve, style::INK).marked(Mark::Disc);
    let plot = LinePlot::new(Axis::log("work"), Axis::log("error"), vec![series]);
    for svg in [
        voltages(&system, &trajectory),
        figure(&system, &trajectory, |run| {
            tip_path::svg(&Run {
                waypoints: &[(0, Vector3::new(1.0, 2.0, 3.0))],
                ..*run
            })
        }),
        figure(&system, &trajectory, pose::svg),
        plot.svg(&origin()),
    ] {
        assert_well_formed(&svg);
    }
    assert!(plot.svg(&origin()).contains("10⁻²"));
}

#[test]
fn every_shape_is_drawn() {
    let (mut system, trajectory) = swing();
    let shapes = [
        Shape::Box {
            size: [30.0, 30.0, 50.0],
        },
        Shape::Sphere { radius: 25.0 },
        Shape::None,
    ];
    for (body, shape) in system.bodies.iter_mut().zip(shapes) {
        body.shape = shape;
    }
    let svg = figure(&system, &trajectory, pose::svg);
    assert_well_formed(&svg);
    assert!(svg.contains("voltage [kV]") && svg.contains("path of tip"));
}

#[test]
fn ticks_are_round_numbers_within_the_range() {
    let labels = |axis: Axis, range| {
        let ticks = axis.ticks(range, 5.0).major;
        let labels = ticks.into_iter().map(|(_, label)| label);
        labels.collect::<Vec<_>>()
    };
    let linear = || Axis::linear("", Extent::Tight);
    assert_eq!(labels(linear(), [0.0, 0.6]), ["0", "0.2", "0.4", "0.6"]);
    assert_eq!(labels(linear(), [-120.0, 5.0]), ["−100", "−50", "0"]);
    assert_eq!(
        labels(linear(), [0.0, 3e-7]),
        ["0", "1·10⁻⁷", "2·10⁻⁷", "3·10⁻⁷"]
    );
    assert_eq!(
        labels(Axis::log(""), [-3.2, 0.1]),
        ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]
    );
}

#[test]
fn a_run_leaves_all_its_files_and_the_page_escapes_names() {
    let (mut system, trajectory) = swing();
    system.name = "<script>alert(1)</script> & co".to_owned();
    system.muscles[0].name = "</script><b>muscle</b>".to_owned();
    let mut observations = trajectory.observe(&system);
    observations.columns.push(Column {
        name: "kinetic_energy".to_owned(),
        unit: "N mm",
        values: trajectory.times.clone(),
    });
    let mut control = crate::common::cases::control(&system, trajectory.intervals());
    control.objective = tracked(&[0], &[(1, true)]);
    let tracked = proboscis::workflow::tracked(&system, &control, &trajectory, None);
    let (skins, origin) = (Skins::default(), origin());
    let run = Run {
        comparison: Some(("again", &trajectory)),
        tracked: &tracked,
        page: Some(&PageContent {
            title: "A <title>".to_owned(),
            rows: vec![("status".to_owned(), "a < b".to_owned())],
            ..PageContent::default()
        }),
        ..Run::from_trajectory(&system, &trajectory, &skins, &observations, &origin)
    };
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("results").join("swing");
    fs::create_dir_all(&inner).unwrap();
    let mut set = FileSet::in_folder(&inner);
    write_run(&mut set, &run).unwrap();
    // None has its name before all are finished.
    assert!(!inner.join("trajectory.csv").exists());
    set.finish().unwrap();
    let mut names: Vec<String> = fs::read_dir(&inner)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let mut expected = [
        "trajectory.csv",
        "controls.csv",
        "configuration.svg",
        "snapshots.svg",
        "voltages.svg",
        "tip_path.svg",
        "joint_angles.svg",
        "energy.svg",
        "tracking.csv",
        "tracking.svg",
        "report.html",
    ];
    expected.sort_unstable();
    assert_eq!(names, expected);
    let table = fs::read_to_string(inner.join("tracking.csv")).unwrap();
    let mut lines = table.lines().skip(1);
    let header = "time [ms],tip_x [mm],tip_x_reference [mm],tip_y [mm],tip_y_reference [mm],tip_z [mm],\
                  tip_z_reference [mm],tip_deviation [mm],joint2 [rad],joint2_reference [rad],joint2_deviation [rad]";
    assert_eq!(lines.next(), Some(header));
    for (k, line) in lines.enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let mark = trajectory.marks[k][0];
        assert_eq!([cells[1], cells[3], cells[5]], [mark.x, mark.y, mark.z]);
        let far = [cells[2], cells[4], cells[6]];
        let far = (mark - Vector3::from(far)).norm();
        assert!(far > 1.0 && (cells[7] - far).abs() < 1e-12 * far);
        assert_eq!(cells[8], trajectory.joints[k][1]);
    }
    assert_eq!(table.lines().count(), 2 + trajectory.times.len());
    for path in names.iter().map(|name| inner.join(name)) {
        let text = fs::read_to_string(&path).unwrap();
        if path.extension().is_some_and(|e| e == "svg") {
            assert_well_formed(&text);
            assert!(text.contains("Ipopt 3.14"));
        }
    }
    let html = fs::read_to_string(inner.join("report.html")).unwrap();
    assert!(html.contains(
        "<title>&lt;script&gt;alert(1)&lt;/script&gt; &amp; co: A &lt;title&gt;</title>"
    ));
    assert!(!html.contains("<b>muscle") && !html.contains("alert(1)</script>"));
    assert!(html.contains("\"rows\":[[\"status\",\"a \\u003c b\"]]"));
    assert_eq!(quoting::escape("\"'"), "&quot;&#39;");
}

#[test]
fn origins_stay_on_one_line() {
    let line = origin().line();
    assert!(!line.contains('\n'));
    for part in ["proboscis 0.", "a<b>.json --out x", "Ipopt 3.14"] {
        assert!(line.contains(part), "{part} in {line}");
    }
}
