//! Instants of hexahedral meshes for ParaView: `.vtu` files and the `.pvd` file that lists them over time.
//!
//! An instant is an XML unstructured grid of VTK with all solids in one piece; numbers stand inline as 64-bit little-endian
//! numbers in base64, packed block by block by zlib, so that each reads back identical. Units are the caller's; results of a run are in SI.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use nalgebra::Vector3;
use std::borrow::Cow;
use std::fmt::Write;
use std::fs;
use std::io::Write as _;

use crate::mesh::cell::Cell;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::quoting::escape;

/// Attribute of a file whose numbers are packed.
pub(super) const PACKED: &str = r#" compressor="vtkZLibDataCompressor""#;
/// Bytes that are packed at once.
const BLOCK: usize = 1 << 20;

/// A named quantity at the points or in the cells of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<'a> {
    /// Name in ParaView, such as `stress [Pa]`.
    pub name: &'a str,
    /// 1 for a scalar, 3 for a vector, 9 for a tensor row by row.
    pub components: usize,
    /// Components of the first point or cell, then those of the next.
    pub values: Cow<'a, [f64]>,
}

/// One solid at an instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnstructuredGrid<'a> {
    /// Places of the points.
    pub points: Vec<Vector3<f64>>,
    /// Points of each cell, ordered as in a [`Mesh`](crate::mesh::Mesh).
    pub cells: Vec<&'a [usize]>,
    /// Quantities at the points.
    pub point_data: Vec<Field<'a>>,
    /// Quantities in the cells.
    pub cell_data: Vec<Field<'a>>,
}

/// The `.vtu` file of solids at one instant: points and cells of the first, then those of the next, each with the points of
/// its own.
///
/// A field stands at all points or cells of a file; where a solid lacks it, its values are NaN.
///
/// # Panics
///
/// If the values of a field are not as many as its components times points or cells, if fields of one name differ in
/// their components, or if a cell has a point that does not exist.
pub fn vtu(grids: &[UnstructuredGrid<'_>], origin: &Origin) -> Vec<u8> {
    let mut text = head("UnstructuredGrid", PACKED, origin);
    text.push_str("<UnstructuredGrid>\n");
    if !grids.is_empty() {
        piece(&mut text, grids);
    }
    text.push_str("</UnstructuredGrid>\n</VTKFile>\n");
    text.into_bytes()
}

/// The `.pvd` file that lists instants: time in s and name of the file, relative to this one.
pub fn pvd(instants: &[(f64, String)], origin: &Origin) -> String {
    let mut text = head("Collection", "", origin);
    text.push_str("<Collection>\n");
    for (time, file) in instants {
        let file = escaped(file);
        line(
            &mut text,
            format_args!(r#"<DataSet timestep="{time:?}" group="" part="0" file="{file}"/>"#),
        );
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

/// A motion: `folder/0000.vtu`, `folder/0001.vtu`, … and `name.pvd`, which is the file to open.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    name: &'static str,
    folder: &'static str,
    origin: &'a Origin,
    instants: Vec<(f64, String)>,
}

impl<'a> Series<'a> {
    /// An empty series, whose folder is made where it is missing.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn new(
        name: &'static str,
        folder: &'static str,
        origin: &'a Origin,
        files: &FileSet,
    ) -> Result<Self, WriteError> {
        let path = files.folder().join(folder);
        fs::create_dir_all(&path).map_err(WriteError::at(&path))?;
        atomic::tidy(&path);
        Ok(Self {
            name,
            folder,
            origin,
            instants: Vec::new(),
        })
    }

    /// Writes the solids at a time in s as the next file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(
        &mut self,
        time: f64,
        grids: &[UnstructuredGrid<'_>],
        files: &mut FileSet,
    ) -> Result<(), WriteError> {
        self.add_file(time, "vtu", &vtu(grids, self.origin), files)
    }

    /// Adds the next file, of a time in s, with this ending.
    pub(super) fn add_file(
        &mut self,
        time: f64,
        ending: &str,
        bytes: &[u8],
        files: &mut FileSet,
    ) -> Result<(), WriteError> {
        let number = self.instants.len();
        let file = format!("{}/{number:04}.{ending}", self.folder);
        files.add(&file, bytes)?;
        self.instants.push((time, file));
        Ok(())
    }

    /// Writes the list of the instants so far, and removes those of a longer motion that stood here before.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(&self, files: &mut FileSet) -> Result<(), WriteError> {
        remove_from(self.instants.len(), self.folder, files);
        let name = format!("{}.pvd", self.name);
        files.add(name, pvd(&self.instants, self.origin).as_bytes())
    }
}

/// Removes the instants from a number on that a folder of a series has.
pub(crate) fn remove_from(first: usize, folder: &str, files: &mut FileSet) {
    let there = fs::read_dir(files.folder().join(folder)).into_iter();
    for entry in there.flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let number = name.split('.').next().map(str::parse::<usize>);
        if matches!(number, Some(Ok(number)) if number >= first) {
            files.remove(format!("{folder}/{name}"));
        }
    }
}

fn piece(text: &mut String, grids: &[UnstructuredGrid<'_>]) {
    let points: usize = grids.iter().map(|grid| grid.points.len()).sum();
    let cells: usize = grids.iter().map(|grid| grid.cells.len()).sum();
    line(
        text,
        format_args!(r#"<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">"#),
    );

    text.push_str("<Points>\n");
    let places = grids.iter().flat_map(|grid| &grid.points);
    let places = places.flat_map(|x| [x.x, x.y, x.z]);
    array(text, "Float64", "Points", 3, &bytes_of(places));
    text.push_str("</Points>\n<Cells>\n");
    array(text, "Int64", "connectivity", 1, &connectivity(grids));
    let elements = || grids.iter().flat_map(|grid| grid.cells.iter().copied());
    let ends = elements().scan(0, |end, points| {
        *end += points.len() as u64;
        Some(*end)
    });
    let ends = ends.flat_map(u64::to_le_bytes).collect::<Vec<u8>>();
    array(text, "Int64", "offsets", 1, &ends);
    let types: Vec<u8> = elements().map(|points| Cell::of(points).of_vtk()).collect();
    array(text, "UInt8", "types", 1, &types);
    text.push_str("</Cells>\n");

    data(text, "PointData", grids, |grid| {
        (&grid.point_data, grid.points.len())
    });
    data(text, "CellData", grids, |grid| {
        (&grid.cell_data, grid.cells.len())
    });
    text.push_str("</Piece>\n");
}

/// Quantities at all points or in all cells, in the order of their first appearance; `of` are those of a grid with the number of its places.
fn data<'g, 'a>(
    text: &mut String,
    tag: &str,
    grids: &'g [UnstructuredGrid<'a>],
    of: fn(&'g UnstructuredGrid<'a>) -> (&'g [Field<'a>], usize),
) {
    let mut names: Vec<(&str, usize)> = Vec::new();
    for (fields, count) in grids.iter().map(of) {
        for field in fields {
            let Field {
                name, components, ..
            } = *field;
            let (found, expected) = (field.values.len(), components * count);
            assert_eq!(found, expected, "number of values of the field {name:?}");
            match names.iter().find(|(known, _)| *known == name) {
                Some(&(_, known)) => {
                    assert_eq!(known, components, "components of the field {name:?}");
                }
                None => names.push((name, components)),
            }
        }
    }
    line(text, format_args!("<{tag}>"));
    for (name, components) in names {
        let mut bytes = Vec::new();
        for (fields, count) in grids.iter().map(of) {
            let known = fields.iter().find(|field| field.name == name);
            let lacking = vec![f64::NAN; components * count];
            let values = known.map_or(&lacking[..], |field| &field.values);
            bytes.extend(bytes_of(values.iter().copied()));
        }
        array(text, "Float64", name, components, &bytes);
    }
    line(text, format_args!("</{tag}>"));
}

/// Points of the cells, counted over all solids.
fn connectivity(grids: &[UnstructuredGrid<'_>]) -> Vec<u8> {
    let (mut bytes, mut before) = (Vec::new(), 0);
    for grid in grids {
        for &point in grid.cells.iter().copied().flatten() {
            let points = grid.points.len();
            assert!(point < points, "a cell has point {point} of {points}");
            bytes.extend(((before + point) as u64).to_le_bytes());
        }
        before += grid.points.len();
    }
    bytes
}

/// Numbers inline: the number of blocks, their length in bytes, that of a last one that is shorter, and the lengths of all when packed, as 64-bit
/// numbers in one base64 text; the packed blocks in another.
pub(super) fn array(text: &mut String, kind: &str, name: &str, components: usize, bytes: &[u8]) {
    let (mut lengths, mut packed) = (Vec::new(), Vec::new());
    for block in bytes.chunks(BLOCK) {
        let before = packed.len();
        let mut to = ZlibEncoder::new(&mut packed, Compression::fast());
        to.write_all(block)
            .and_then(|()| to.finish().map(drop))
            .expect("there is room");
        lengths.push(packed.len() - before);
    }
    let whole = [lengths.len(), BLOCK, bytes.len() % BLOCK];
    let header = whole.into_iter().chain(lengths);
    let header: Vec<u8> = header.flat_map(|n| (n as u64).to_le_bytes()).collect();
    let name = escaped(name);
    // Readers take an array that says 1 for a table of one column.
    let components = match components {
        1 => String::new(),
        _ => format!(r#" NumberOfComponents="{components}""#),
    };
    line(
        text,
        format_args!(r#"<DataArray type="{kind}" Name="{name}"{components} format="binary">"#),
    );
    STANDARD.encode_string(header, text);
    STANDARD.encode_string(packed, text);
    text.push_str("\n</DataArray>\n");
}

pub(super) fn bytes_of(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(f64::to_le_bytes).collect()
}

/// The XML declaration, the origin as a processing instruction (a comment must not hold the `--` of a command), and the
/// opening tag with further attributes.
pub(super) fn head(kind: &str, attributes: &str, origin: &Origin) -> String {
    let origin = origin.line().replace("?>", "? >");
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<?origin {origin}?>
<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64"{attributes}>
"#
    )
}

pub(super) fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    writeln!(text, "{arguments}").expect("writing to a string does not fail");
}

/// Text of an XML attribute; control characters become spaces.
fn escaped(text: &str) -> String {
    escape(text).replace(char::is_control, " ")
}
