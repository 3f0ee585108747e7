//! Rigid bodies, lumped muscles and markers for ParaView: `parts/0000.vtp`, `parts/0001.vtp`, … and `parts.pvd`, in SI.

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::mesh::triangulated::Surface;
use crate::model::system::System;
use crate::report::Run;
use crate::report::atomic::WriteError;
use crate::report::drawing::lumped;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::paraview::{PACKED, Series, array, bytes_of, head, line};
use crate::report::skins::shown;
use crate::report::solids::Prism;

/// Folder of the instants, and name of the list of them.
const NAME: &str = "parts";

/// Kind of a part, as a number in the files.
#[derive(Clone, Copy, Debug)]
enum ScenePartKind {
    Body,
    Muscle,
    Marker,
}

/// The parts at one instant: points and triangles in m, markers as points of their own, and numbers of each cell.
#[derive(Debug, Default)]
struct Parts {
    surface: Surface,
    markers: Vec<Vector3<f64>>,
    /// Kind, number among its kind, voltage in V and stretch of each marker, then of each triangle.
    data: Vec<[f64; 4]>,
}

/// Names of the numbers of a cell.
const DATA: [&str; 4] = ["kind", "number", "voltage [V]", "stretch"];

/// Writes the instants that pictures show.
///
/// # Errors
/// A file cannot be written.
pub(super) fn write(files: &mut FileSet, run: &Run<'_>) -> Result<(), WriteError> {
    let Run {
        system,
        trajectory,
        origin,
        ..
    } = *run;
    let mut series = Series::new(NAME, NAME, origin, files)?;
    for k in shown(&trajectory.times, 1) {
        let text = Parts::at(system, trajectory, k).vtp(origin);
        series.add_file(trajectory.times[k] / 1e3, "vtp", text.as_bytes(), files)?;
    }
    series.finish(files)
}

impl Parts {
    fn at(system: &System, trajectory: &Trajectory, k: usize) -> Self {
        let mut parts = Self {
            markers: trajectory.marks[k].iter().map(|mark| mark / 1e3).collect(),
            ..Self::default()
        };
        let number =
            |kind: ScenePartKind, i: usize| [f64::from(kind as u8), i as f64, f64::NAN, f64::NAN];
        for m in 0..parts.markers.len() {
            parts.data.push(number(ScenePartKind::Marker, m));
        }
        for (b, (body, pose)) in system.bodies.iter().zip(&trajectory.poses[k]).enumerate() {
            body.shape.add_to(&mut parts.surface, pose);
            parts.fill(number(ScenePartKind::Body, b));
        }
        let voltages = trajectory.voltages.get(k.saturating_sub(1));
        for m in lumped(system) {
            let muscle = &system.muscles[m];
            let prism = Prism::muscle(system, trajectory, k, m);
            parts.surface.add_box(prism.centre, &prism.halves);
            let rest = (muscle.to.at - muscle.from.at).norm();
            let [kind, number, ..] = number(ScenePartKind::Muscle, m);
            let voltage = voltages.map_or(0.0, |voltages| voltages[m]);
            let stretch = 2.0 * prism.halves[2].norm() / rest;
            parts.fill([kind, number, voltage, stretch]);
        }
        for vertex in &mut parts.surface.vertices {
            *vertex /= 1e3;
        }
        parts
    }

    /// Gives the triangles that have no numbers yet these.
    fn fill(&mut self, numbers: [f64; 4]) {
        let cells = self.markers.len() + self.surface.triangles.len();
        self.data.resize(cells, numbers);
    }

    /// The text of the file.
    fn vtp(&self, origin: &Origin) -> String {
        let mut text = head("PolyData", PACKED, origin);
        let (vertices, triangles) = (&self.surface.vertices, &self.surface.triangles);
        let (marks, points) = (self.markers.len(), vertices.len() + self.markers.len());
        line(
            &mut text,
            format_args!(
                r#"<PolyData><Piece NumberOfPoints="{points}" NumberOfVerts="{marks}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{}">"#,
                triangles.len()
            ),
        );
        text.push_str("<Points>\n");
        let places = self.markers.iter().chain(vertices);
        let places = places.flat_map(|x| [x.x, x.y, x.z]);
        array(&mut text, "Float64", "Points", 3, &bytes_of(places));
        text.push_str("</Points>\n");
        let corners = triangles.as_flattened().iter().map(|corner| marks + corner);
        for (tag, connected, size) in [
            ("Verts", (0..marks).collect::<Vec<_>>(), 1),
            ("Polys", corners.collect(), 3),
        ] {
            line(&mut text, format_args!("<{tag}>"));
            let ends = (1..=connected.len() / size).map(|cell| size * cell);
            let ends = ends.collect::<Vec<_>>();
            for (name, numbers) in [("connectivity", connected), ("offsets", ends)] {
                let bytes = numbers.iter().flat_map(|&n| (n as u64).to_le_bytes());
                array(&mut text, "Int64", name, 1, &bytes.collect::<Vec<u8>>());
            }
            line(&mut text, format_args!("</{tag}>"));
        }
        text.push_str("<CellData>\n");
        for (i, name) in DATA.into_iter().enumerate() {
            let values = self.data.iter().map(|numbers| numbers[i]);
            array(&mut text, "Float64", name, 1, &bytes_of(values));
        }
        text.push_str("</CellData>\n</Piece></PolyData>\n</VTKFile>\n");
        text
    }
}
