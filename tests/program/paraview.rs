//! Files for ParaView, read back identical by a naive reader of XML, base64 and zlib.

use crate::common::vtk_arrays::unpacked;
use nalgebra::Vector3;
use proboscis::mesh::grid::Grid as Planes;
use proboscis::report::file_set::FileSet;
use proboscis::report::origin::Origin;
use proboscis::report::paraview::{Field, Series, UnstructuredGrid, pvd, vtu};
use proptest::prelude::*;
use std::borrow::Cow;
use std::fs;

/// The parts of a text between two others.
fn between<'a>(text: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    let parts = text.split(start).skip(1);
    parts.map(|part| part.split(end).next().unwrap()).collect()
}

fn attribute(tag: &str, name: &str) -> String {
    let value = between(tag, &format!(" {name}=\""), "\"")[0];
    let entities = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&amp;", "&"),
    ];
    entities
        .iter()
        .fold(value.to_owned(), |text, (entity, letter)| {
            text.replace(entity, letter)
        })
}

/// Type, components and bytes of an array.
fn array(piece: &str, section: &str, name: &str) -> (String, usize, Vec<u8>) {
    let open = format!("<{section}>");
    let section = between(piece, &open, &format!("</{}", &open[1..]))[0].to_owned();
    let arrays = between(&section, "<DataArray", "</DataArray>");
    let array = arrays.iter().find(|a| attribute(a, "Name") == name);
    let array = array.unwrap_or_else(|| panic!("no {name} in {section}"));
    assert_eq!(attribute(array, "format"), "binary");
    let bytes = unpacked(array.split_once('>').unwrap().1);
    let components = between(array, "NumberOfComponents=\"", "\"");
    let components = components.first().map_or(1, |text| text.parse().unwrap());
    (attribute(array, "type"), components, bytes)
}

fn words(piece: &str, section: &str, name: &str) -> Vec<u64> {
    let (_, _, bytes) = array(piece, section, name);
    let words = bytes.chunks_exact(8);
    words
        .map(|b| u64::from_le_bytes(b.try_into().unwrap()))
        .collect()
}

/// The bits of a field's numbers, so that NaN equals itself.
fn assert_reads(piece: &str, section: &str, field: &Field<'_>) {
    let (kind, components, _) = array(piece, section, field.name);
    assert_eq!((kind.as_str(), components), ("Float64", field.components));
    let bits: Vec<_> = field.values.iter().map(|x| x.to_bits()).collect();
    assert_eq!(words(piece, section, field.name), bits, "{}", field.name);
}

fn field(name: &str, components: usize, values: Vec<f64>) -> Field<'_> {
    Field {
        name,
        components,
        values: Cow::Owned(values),
    }
}

fn origin() -> Origin {
    Origin {
        command: "proboscis simulate finger.json --set time=1?>".to_owned(),
        version: "0.0".to_owned(),
        ..Origin::default()
    }
}

#[test]
fn a_solid_reads_back_as_it_was() {
    let mesh = Planes::uniform(
        Vector3::new(0.1, -0.2, 1e-9),
        Vector3::new(1.0, 2.0, 3.0),
        [3, 2, 1],
    )
    .mesh();
    let (points, cells) = (mesh.nodes.len(), mesh.hexahedra.len());
    let numbers = |count: usize| (0..count).map(|k| (k as f64).sin() / 3.0).collect();
    let point_data = [
        field("electric potential [V]", 1, numbers(points)),
        field("displacement <u> & \"v\" [m]", 3, numbers(3 * points)),
    ];
    let cell_data = [
        field("J", 1, numbers(cells)),
        field("electric field [V/m]", 3, numbers(3 * cells)),
        field("stress [Pa]", 9, numbers(9 * cells)),
    ];
    let grid = UnstructuredGrid {
        points: mesh.nodes.clone(),
        cells: mesh.elements().collect(),
        point_data: point_data.to_vec(),
        cell_data: cell_data.to_vec(),
    };
    let text = String::from_utf8(vtu(&[grid], &origin())).unwrap();

    assert!(text.starts_with("<?xml version=\"1.0\""), "{text}");
    assert!(text.contains("--set time=1? >"), "{text}");
    let file = between(&text, "<VTKFile", ">")[0];
    assert_eq!(attribute(file, "type"), "UnstructuredGrid");
    assert_eq!(attribute(file, "byte_order"), "LittleEndian");
    assert_eq!(attribute(file, "header_type"), "UInt64");
    assert_eq!(attribute(file, "compressor"), "vtkZLibDataCompressor");

    let pieces = between(&text, "<Piece", "</Piece>");
    let [piece] = pieces[..] else {
        panic!("{} pieces", pieces.len())
    };
    assert_eq!(attribute(piece, "NumberOfPoints"), points.to_string());
    assert_eq!(attribute(piece, "NumberOfCells"), cells.to_string());
    let places = mesh.nodes.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
    assert_reads(piece, "Points", &field("Points", 3, places));
    let connectivity: Vec<_> = mesh.hexahedra.iter().flatten().map(|&n| n as u64).collect();
    assert_eq!(words(piece, "Cells", "connectivity"), connectivity);
    let offsets: Vec<_> = (1..=cells as u64).map(|end| 8 * end).collect();
    assert_eq!(words(piece, "Cells", "offsets"), offsets);
    let (kind, _, types) = array(piece, "Cells", "types");
    assert_eq!((kind.as_str(), types), ("UInt8", vec![12; cells]));
    for field in &point_data {
        assert_reads(piece, "PointData", field);
    }
    for field in &cell_data {
        assert_reads(piece, "CellData", field);
    }
}

#[test]
fn solids_stand_one_after_the_other() {
    let mesh = Planes::uniform(Vector3::zeros(), Vector3::repeat(1.0), [1, 1, 1]).mesh();
    let apart = mesh.clone().transformed(|x| x + Vector3::x() * 2.0);
    let potential = [field("potential", 1, (0..8).map(f64::from).collect())];
    let stretch = [field("stretch", 3, vec![1.0, 2.0, 3.0])];
    let grids = [
        UnstructuredGrid {
            points: mesh.nodes.clone(),
            cells: mesh.elements().collect(),
            point_data: potential.to_vec(),
            cell_data: Vec::new(),
        },
        UnstructuredGrid {
            points: apart.nodes.clone(),
            cells: apart.elements().collect(),
            point_data: Vec::new(),
            cell_data: stretch.to_vec(),
        },
    ];
    let text = String::from_utf8(vtu(&grids, &origin())).unwrap();
    let pieces = between(&text, "<Piece", "</Piece>");
    let [piece] = pieces[..] else {
        panic!("{} pieces", pieces.len())
    };
    assert_eq!(attribute(piece, "NumberOfPoints"), "16");
    assert_eq!(attribute(piece, "NumberOfCells"), "2");
    let places = mesh.nodes.iter().chain(&apart.nodes);
    let places = places.flat_map(|x| [x.x, x.y, x.z]).collect();
    assert_reads(piece, "Points", &field("Points", 3, places));
    let nodes = words(piece, "Cells", "connectivity");
    assert_eq!(
        nodes,
        [0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 11, 10, 12, 13, 15, 14]
    );
    // A field that a solid lacks is NaN there.
    let values = [potential[0].values.to_vec(), vec![f64::NAN; 8]].concat();
    assert_reads(piece, "PointData", &field("potential", 1, values));
    let values = [vec![f64::NAN; 3], stretch[0].values.to_vec()].concat();
    assert_reads(piece, "CellData", &field("stretch", 3, values));
}

/// Numbers are packed a mebibyte at a time: no more than that, no less, and a little more.
#[test]
fn many_numbers_read_back_from_their_blocks() {
    let points = vec![Vector3::zeros(); 1 << 14];
    for (components, further) in [(8, 0), (16, 0), (17, 0), (8, 1)] {
        let points = &points[..points.len() - further];
        let count = components * points.len();
        let values = (0..count).map(|k| (k % 7 + k / 100_000) as f64).collect();
        let point_data = [field("many", components, values)];
        let grid = UnstructuredGrid {
            points: points.to_vec(),
            point_data: point_data.to_vec(),
            ..UnstructuredGrid::default()
        };
        let text = String::from_utf8(vtu(&[grid], &origin())).unwrap();
        assert!(text.len() < count, "{} bytes", text.len());
        let piece = between(&text, "<Piece", "</Piece>")[0];
        assert_reads(piece, "PointData", &point_data[0]);
    }
}

#[test]
fn a_series_lists_what_it_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("deep").join("motion");
    let mesh = Planes::uniform(Vector3::zeros(), Vector3::repeat(1.0), [1, 1, 1]).mesh();
    let grids = [UnstructuredGrid {
        points: mesh.nodes.clone(),
        cells: mesh.elements().collect(),
        ..UnstructuredGrid::default()
    }];
    let origin = origin();
    fs::create_dir_all(&folder).unwrap();
    let mut files = FileSet::in_folder(&folder);
    let mut series = Series::new("trajectory", "instants", &origin, &files).unwrap();
    let times = [0.0, 1e-3, 0.1 + 0.2];
    for time in times {
        series.add(time, &grids, &mut files).unwrap();
    }
    series.finish(&mut files).unwrap();
    files.finish().unwrap();
    let list = fs::read_to_string(folder.join("trajectory.pvd")).unwrap();
    let sets = between(&list, "<DataSet", "/>");
    assert_eq!(sets.len(), times.len());
    for (set, time) in sets.iter().zip(times) {
        assert_eq!(attribute(set, "timestep").parse(), Ok(time));
        let path = folder.join(attribute(set, "file"));
        assert_eq!(fs::read(path).unwrap(), vtu(&grids, &origin));
    }
}

#[test]
fn no_solid_and_no_instant_are_files_too() {
    let text = String::from_utf8(vtu(&[], &Origin::default())).unwrap();
    assert!(text.ends_with("<UnstructuredGrid>\n</UnstructuredGrid>\n</VTKFile>\n"));
    assert!(pvd(&[], &Origin::default()).contains("<Collection>\n</Collection>"));
}

#[test]
#[should_panic(expected = "a cell has point 7 of 0")]
fn a_cell_without_its_points_is_a_mistake() {
    let grid = UnstructuredGrid {
        cells: vec![&[7; 8]],
        ..UnstructuredGrid::default()
    };
    vtu(&[grid], &Origin::default());
}

#[test]
#[should_panic(expected = "number of values of the field \"stress\"")]
fn a_field_of_the_wrong_length_is_a_mistake() {
    let data = [field("stress", 9, vec![0.0; 8])];
    let grid = UnstructuredGrid {
        point_data: data.to_vec(),
        ..UnstructuredGrid::default()
    };
    vtu(&[grid], &Origin::default());
}

proptest! {
    #[test]
    fn every_number_reads_back(bits in prop::collection::vec(any::<u64>(), 0..20), name in ".*") {
        let points = vec![Vector3::zeros(); bits.len()];
        let values = bits.iter().copied().map(f64::from_bits).collect();
        let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let data = [field(&name, 1, values)];
        let grid = UnstructuredGrid { points: points.clone(), point_data: data.to_vec(), ..UnstructuredGrid::default() };
        let text = String::from_utf8(vtu(&[grid], &Origin::default())).unwrap();
        assert_reads(between(&text, "<Piece", "</Piece>")[0], "PointData", &data[0]);
    }
}
