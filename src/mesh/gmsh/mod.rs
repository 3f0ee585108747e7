//! Meshes from Gmsh: `.msh` files of format 2.2 and 4.1, in ASCII or binary.
//!
//! - **Reading** turns the lines of either format into the same contents: nodes, elements and groups by their
//!   numbers in the file.
//! - **Assembling** turns these into a [`Mesh`]: physical volumes become regions, physical surfaces, curves and points
//!   become sets of nodes.
//!
//! Nodes and elements are in the order of their numbers in the file, so that both formats of one mesh read equal.

mod assemble;
mod binary;
mod contents;
mod version2;
mod version4;

use super::Mesh;
use super::error::MeshError;
use crate::math::refuse;
pub use contents::UNGROUPED;
use contents::{Contents, Format, Group};
use contents::{Line, Lines, quoted};
use std::collections::BTreeMap;
use std::path::Path;

const FORMATS: &str = "a mesh in format 2.2 or 4.1";
const SECTION: &str = "a section such as $Nodes";

/// Reads a file with lengths in `unit` mm; the mesh is [checked](Mesh::check).
///
/// Physical volumes become regions in the order of their numbers, elements of none become the region [`UNGROUPED`], the
/// last one. Physical surfaces, curves and points become sets; what has no name is called `volume_7`, `surface_7`,
/// `curve_7` or `point_7` by its number, and groups of one name are one set. Nodes that no volume uses are dropped.
/// Linear tetrahedra get a node in the middle of each edge, which is in the sets that have the edge.
///
/// # Panics
///
/// If the unit is not a positive number.
///
/// # Errors
/// The file cannot be read, or is no mesh of hexahedra or tetrahedra that can be computed with.
pub fn read(path: &Path, unit: f64) -> Result<Mesh, MeshError> {
    let file = path.display().to_string();
    match std::fs::read(path) {
        Ok(bytes) => parse(&bytes, &file, unit),
        Err(cause) => Err(MeshError::Unreadable {
            file,
            cause: cause.to_string(),
        }),
    }
}

/// Reads the bytes of a file, see [`read`]; errors call it `file`.
///
/// # Errors
/// As of [`read`].
pub fn parse(bytes: &[u8], file: &str, unit: f64) -> Result<Mesh, MeshError> {
    assert!(
        unit > 0.0 && unit.is_finite(),
        "a unit of {unit} mm is no length"
    );
    // Names of other encodings lose letters.
    let text = String::from_utf8_lossy(bytes);
    let mut lines = Lines::new(file, &text);
    let (format, is_binary) = format(&mut lines)?;
    if !is_binary {
        return contents(&mut lines, format)?.assemble(file, unit);
    }
    let text = binary::as_text(bytes, file, format)?;
    let file = format!("{file} as text");
    let mut lines = Lines::new(&file, &text);
    self::format(&mut lines)?;
    contents(&mut lines, format)?.assemble(&file, unit)
}

/// The format, and true if the file is binary.
fn format(lines: &mut Lines<'_>) -> Result<(Format, bool), MeshError> {
    let first = lines.next("$MeshFormat")?;
    match first.text {
        "$MeshFormat" => {}
        "$NOD" => return Err(first.wrong("format 1", FORMATS)),
        other => return Err(first.wrong(quoted(other), "$MeshFormat, the head of a .msh file")),
    }
    let line = lines.next("the version of the format")?;
    let mut words =
        line.words("the version, 0 for ASCII or 1 for binary, and the size of a number: 4.1 0 8");
    let version = words.word()?;
    let binary = words.word()?;
    words.word()?;
    words.end()?;
    let format = match version {
        "2" | "2.0" | "2.1" | "2.2" => Format::Two,
        "4.1" => Format::Four,
        other => return Err(line.wrong(format!("format {other}"), FORMATS)),
    };
    match binary {
        "0" => lines.end("$EndMeshFormat")?,
        "1" => return Ok((format, true)),
        other => return Err(line.wrong(quoted(other), "0 for ASCII or 1 for binary")),
    }
    Ok((format, false))
}

fn contents(lines: &mut Lines<'_>, format: Format) -> Result<Contents, MeshError> {
    let mut contents = Contents::default();
    let mut entities = None;
    let (mut nodes, mut elements) = (None, None);
    while let Some(line) = lines.next_or_end() {
        match line.text {
            "$PhysicalNames" => contents.names.extend(physical_names(lines)?),
            "$Entities" if format == Format::Four => {
                once(&line, entities.is_some())?;
                refuse!(if elements.is_some(), line;
                    found "$Entities after $Elements", expected "it before them");
                entities = Some(version4::entities(lines)?);
            }
            "$PartitionedEntities" => {
                return Err(line.wrong("a partitioned mesh", "a mesh of one partition"));
            }
            "$Nodes" => {
                once(&line, nodes.is_some())?;
                nodes = Some(match format {
                    Format::Two => version2::nodes(lines)?,
                    Format::Four => version4::nodes(lines)?,
                });
            }
            "$Elements" => {
                once(&line, elements.is_some())?;
                contents.line = line.number;
                elements = Some(match format {
                    Format::Two => version2::elements(lines)?,
                    Format::Four => version4::elements(lines, entities.as_ref())?,
                });
            }
            other => match other.strip_prefix('$') {
                Some(name) if !name.starts_with("End") => lines.skip(&format!("$End{name}"))?,
                _ => return Err(line.wrong(quoted(other), SECTION)),
            },
        }
    }
    contents.nodes = nodes.ok_or_else(|| lines.at_end("the section $Nodes"))?;
    contents.elements = elements.ok_or_else(|| lines.at_end("the section $Elements"))?;
    Ok(contents)
}

fn once(line: &Line<'_>, again: bool) -> Result<(), MeshError> {
    refuse!(if again, line; found format!("a second {}", line.text), expected "it once");
    Ok(())
}

/// `$PhysicalNames`: a count, then lines of dimension, number and quoted name.
fn physical_names(lines: &mut Lines<'_>) -> Result<BTreeMap<Group, String>, MeshError> {
    let line = lines.next("the number of physical names")?;
    let mut words = line.words("the number of physical names");
    let count: usize = words.number()?;
    words.end()?;
    let mut names = BTreeMap::new();
    for _ in 0..count {
        let shape = "a physical group: dimension, number, \"name\"";
        let line = lines.record(shape)?;
        let mut words = line.words(shape);
        let dimension: usize = words.number()?;
        let number: i64 = words.number()?;
        let name = line.text.split_once('"').and_then(|(_, rest)| {
            let (name, _) = rest.rsplit_once('"')?;
            Some(name.trim())
        });
        match name {
            Some(name) if name.contains(char::is_control) => {
                return Err(line.wrong(quoted(name), "a name without control characters"));
            }
            Some(name) if dimension <= 3 => {
                if !name.is_empty() {
                    names.insert((dimension, number.unsigned_abs()), name.to_owned());
                }
            }
            _ => return Err(line.wrong(quoted(line.text), shape)),
        }
    }
    lines.end("$EndPhysicalNames")?;
    Ok(names)
}
