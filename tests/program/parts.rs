//! Bodies, muscles and markers as ParaView reads them.

use crate::common::vtk_arrays::unpacked;
use crate::runs::write_motion;
use nalgebra::Vector3;
use proboscis::model::system::Shape;
use proboscis::report::Figures;
use std::fs;

/// The eight bytes of each number of the arrays with a name, in the order of the file.
fn arrays(text: &str, name: &str) -> Vec<Vec<[u8; 8]>> {
    let named = format!("Name=\"{name}\"");
    let arrays = text.split("<DataArray").skip(1);
    let arrays = arrays.filter(|array| array.split('>').next().unwrap().contains(&named));
    let read = |array: &str| {
        let data = array.split_once('>').unwrap().1;
        let bytes = unpacked(data.split('<').next().unwrap());
        let numbers = bytes.chunks_exact(8);
        numbers.map(|number| number.try_into().unwrap()).collect()
    };
    arrays.map(read).collect()
}

fn numbers(text: &str, name: &str) -> Vec<f64> {
    let all = arrays(text, name).concat();
    all.into_iter().map(f64::from_le_bytes).collect()
}

fn integers(text: &str, name: &str) -> Vec<Vec<usize>> {
    let all = arrays(text, name).into_iter();
    let read = |array: Vec<[u8; 8]>| array.into_iter().map(|n| u64::from_le_bytes(n) as usize);
    all.map(|array| read(array).collect()).collect()
}

#[test]
fn bodies_muscles_and_markers_are_where_they_are() {
    let system = crate::common::trunk::system(6);
    let trajectory = crate::common::trunk::swing(&system, 20);
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    fs::write(folder.path().join("parts/0050.vtp"), "of a longer motion").unwrap();
    let figures = Figures {
        parts: true,
        ..Figures::default()
    };
    write_motion(folder.path(), &system, &trajectory, figures);
    let list = fs::read_to_string(folder.path().join("parts.pvd")).unwrap();
    assert_eq!(list.matches("<DataSet").count(), trajectory.times.len());
    assert!(list.contains("timestep=\"0.3\"") && list.contains("file=\"parts/0020.vtp\""));
    assert!(!folder.path().join("parts/0050.vtp").exists());

    let k = 20;
    let text = fs::read_to_string(folder.path().join("parts/0020.vtp")).unwrap();
    let points = numbers(&text, "Points");
    let points: Vec<_> = points
        .chunks_exact(3)
        .map(Vector3::from_column_slice)
        .collect();
    let [kinds, which, voltages, stretches] =
        ["kind", "number", "voltage [V]", "stretch"].map(|name| numbers(&text, name));
    let [marks, triangles] = &integers(&text, "connectivity")[..] else {
        panic!("vertices and polygons");
    };
    let ends = integers(&text, "offsets");
    assert_eq!(ends[1].len(), triangles.len() / 3);
    assert!(
        ends[1]
            .iter()
            .enumerate()
            .all(|(cell, &end)| end == 3 * (cell + 1))
    );
    assert_eq!(kinds.len(), ends[0].len() + ends[1].len());
    // Vertices come first.
    assert_eq!(marks[..], [0]);
    assert!(kinds[0] == 2.0 && (points[0] - trajectory.marks[k][0] / 1e3).norm() < 1e-15);
    let mut seen = [0; 2];
    for (cell, corners) in triangles.chunks_exact(3).enumerate() {
        let cell = cell + marks.len();
        let number = which[cell] as usize;
        let corners = [0, 1, 2].map(|i| 1e3 * points[corners[i]]);
        match kinds[cell] {
            0.0 => {
                let pose = &trajectory.poses[k][number];
                let Shape::Cylinder { length, radius } = system.bodies[number].shape else {
                    panic!("segments are cylinders");
                };
                for corner in corners {
                    let own = pose.directors.transpose() * (corner - pose.centre);
                    assert!((own.z.abs() - length / 2.0).abs() < 1e-9);
                    assert!((own.xy().norm() - radius).abs() < 1e-9);
                }
                assert!(voltages[cell].is_nan() && stretches[cell].is_nan());
                seen[0] += 1;
            }
            1.0 => {
                let muscle = &system.muscles[number];
                let [from, to] =
                    [muscle.from, muscle.to].map(|point| trajectory.point(k, &point, &system));
                let stretch = (to - from).norm() / (muscle.to.at - muscle.from.at).norm();
                assert!((stretches[cell] - stretch).abs() < 1e-12);
                assert!((stretch - 1.0).abs() > 1e-3, "it is not stretched");
                assert_eq!(voltages[cell], trajectory.voltages[k - 1][number]);
                // Corners lie in the planes of both ends.
                let along = (to - from).normalize();
                let near = |corner: &Vector3<f64>, end: Vector3<f64>| {
                    (corner - end).dot(&along).abs() < 1e-9
                };
                assert!(corners.iter().all(|c| near(c, from) || near(c, to)));
                seen[1] += 1;
            }
            other => panic!("{other}"),
        }
    }
    // Twelve triangles of a prism; two of each side and the ends of a cylinder.
    assert_eq!(seen, [6 * (2 * 24 + 2 * 22), 12 * 12]);
}
