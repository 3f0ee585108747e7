//! Surfaces in STL files, binary or text: triangles by their corners in single precision, without a unit.

use nalgebra::Vector3;
use std::io::Cursor;
use std::path::Path;
use stl_io::{Normal, Triangle, Vertex, create_stl_reader, write_stl};

use crate::files::json::document::{NoBytes, of_file};
use crate::mesh::error::{MeshError, MeshPlace};
use crate::mesh::triangulated::Surface;

/// Largest number of triangles of a surface.
pub const MOST_TRIANGLES: usize = 1_000_000;
/// Bytes before the triangles of a binary file, and of each triangle.
const HEAD: usize = 84;
const OF_TRIANGLE: usize = 50;
/// Bytes of the title of a binary file.
const TITLE: usize = 80;

/// Reads a file with lengths in `unit` mm; that the surface is closed is not checked.
///
/// # Errors
/// The file cannot be read, or is no STL file, or has no triangles or too many.
pub fn read(path: &Path, unit: f64) -> Result<Surface, MeshError> {
    let file = path.display().to_string();
    match of_file(path) {
        Ok(bytes) => parse(bytes, &file, unit),
        Err(NoBytes::Unreadable(cause)) => Err(MeshError::Unreadable {
            file,
            cause: cause.to_string(),
        }),
        Err(NoBytes::TooLarge(found, expected)) => {
            Err(MeshPlace::Whole.wrong(format!("{found} in {file:?}"), expected))
        }
    }
}

/// Reads the bytes of a file, see [`read`]; errors call it `file`.
///
/// # Errors
/// As of [`read`].
pub fn parse(mut bytes: Vec<u8>, file: &str, unit: f64) -> Result<Surface, MeshError> {
    let wrong = |found: String, expected: &str| {
        MeshPlace::Whole.wrong(format!("{file:?}, {found}"), expected)
    };
    let solids = match binary_count(&bytes) {
        // A title that begins like a file of text would be taken for one.
        Some(_) => {
            bytes[..TITLE].fill(0);
            vec![bytes]
        }
        None => solids(&bytes).ok_or_else(|| {
            let found = match bytes.is_empty() {
                true => "which is empty",
                false => "which is neither text that begins with \"solid\" nor binary with as many triangles as its head states",
            };
            wrong(found.to_owned(), "an STL file")
        })?,
    };
    let mut triangles = Vec::new();
    for solid in solids {
        let mut solid = Cursor::new(solid);
        let reader = create_stl_reader(&mut solid);
        let reader = reader.map_err(|error| wrong(format!("{error}"), "an STL file"))?;
        for triangle in reader {
            let number = triangles.len() + 1;
            let in_file = |error: std::io::Error| format!("triangle {number}: {error}");
            let triangle = triangle.map_err(|error| wrong(in_file(error), "a triangle"))?;
            if number > MOST_TRIANGLES {
                let found = format!("which has more than {MOST_TRIANGLES} triangles");
                return Err(wrong(found, "a surface with fewer triangles"));
            }
            triangles.push(
                triangle
                    .vertices
                    .map(|Vertex { 0: at }| Vector3::from(at.map(f64::from)) * unit),
            );
        }
    }
    let places = triangles.as_flattened().iter();
    let outside = places
        .clone()
        .position(|at| !at.iter().all(|x| x.is_finite()));
    if let Some(corner) = outside {
        let found = format!("triangle {}: a corner that is not finite", corner / 3 + 1);
        return Err(wrong(found, "finite places"));
    }
    match triangles.is_empty() {
        true => Err(wrong("which has no triangles".to_owned(), "a surface")),
        false => Ok(Surface::from_corners(triangles)),
    }
}

/// Number of triangles of a binary file: the number in its head, which its length confirms.
fn binary_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(TITLE..HEAD)?.try_into().ok()?;
    let count = u32::from_le_bytes(count) as usize;
    (bytes.len() == OF_TRIANGLE.checked_mul(count)?.checked_add(HEAD)?).then_some(count)
}

/// The solids of a file of text, each as a file of its own as `stl_io` reads it: with a title, in small letters.
fn solids(bytes: &[u8]) -> Option<Vec<Vec<u8>>> {
    let text = String::from_utf8_lossy(bytes).to_lowercase();
    let text = text.trim_start_matches('\u{feff}').trim_start();
    if !text.starts_with("solid") {
        return None;
    }
    let mut all: Vec<String> = Vec::new();
    let mut is_open = false;
    for line in text.lines() {
        match line.split_whitespace().next() {
            Some("solid") if !is_open => {
                all.push("solid \n".to_owned());
                is_open = true;
            }
            None => {}
            Some(word) => {
                is_open &= word != "endsolid";
                let text = all.last_mut()?;
                text.push_str(line);
                text.push('\n');
            }
        }
    }
    Some(all.into_iter().map(String::into_bytes).collect())
}

/// The bytes of a binary file of a surface with lengths in `unit` mm.
pub fn bytes_of(surface: &Surface, unit: f64) -> Vec<u8> {
    let triangles: Vec<Triangle> = surface
        .corners()
        .map(|corners| {
            let [a, b, c] = corners;
            let normal = (b - a).cross(&(c - a));
            let normal = normal.try_normalize(0.0).unwrap_or_default();
            let single = |x: Vector3<f64>| x.map(|x| x as f32).into();
            Triangle {
                normal: Normal::new(single(normal)),
                vertices: corners.map(|corner| Vertex::new(single(corner / unit))),
            }
        })
        .collect();
    let mut bytes = Vec::new();
    write_stl(&mut bytes, triangles.iter()).expect("writing into memory does not fail");
    bytes
}
