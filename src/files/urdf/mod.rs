//! Robots from URDF, the XML format of ROS: links and joints become the bodies and joints of a scene.
//!
//! - `element`: elements of XML with places, numbers and vectors; what is not taken over, and mistakes; `read`: links and joints as they are written.
//! - `tree`: poses of the links in the reference configuration; `scene`: the scene; `outline`: shapes of bodies.
//!
//! Parts that a scene cannot hold are left out, each named.

mod element;
mod outline;
mod read;
mod scene;
mod tree;

pub use scene::FromUrdf;

use roxmltree::Document;
use std::path::Path;

use crate::files::json::document::{NoBytes, of_file};
use crate::files::json::error::{Mistake, Result, SceneError};
use crate::files::urdf::element::LeftOut;

/// Reads a file.
///
/// # Errors
/// It cannot be read, or is no tree of links and joints that a scene can hold.
pub fn read_urdf(path: &Path) -> Result<FromUrdf> {
    let wrong = |found: &str, expected: &str| -> SceneError {
        Mistake::of_file(path.display().to_string(), found, expected).into()
    };
    let bytes = of_file(path).map_err(|error| match error {
        NoBytes::Unreadable(cause) => wrong(&format!("no readable file ({cause})"), "a URDF file"),
        NoBytes::TooLarge(found, expected) => wrong(&found, &expected),
    })?;
    let text = String::from_utf8(bytes);
    let text = text.map_err(|_| wrong("bytes that are no UTF-8", "a URDF file"))?;
    parse_urdf(path, &text)
}

/// Reads the text of a file; `path` is that of the file, to which paths of meshes are relative.
///
/// # Errors
/// As of [`read_urdf`].
pub fn parse_urdf(path: &Path, text: &str) -> Result<FromUrdf> {
    let document = Document::parse(text).map_err(|error| {
        let place = format!("{}:{}", path.display(), error.pos().row);
        let expected = "a URDF file; a file of xacro is expanded by xacro first";
        Mistake::of_file(place, format!("no XML ({error})"), expected)
    })?;
    let mut left_out = LeftOut::default();
    let robot = read::robot(path, &document, &mut left_out)?;
    let tree = tree::tree(&robot)?;
    scene::scene(&robot, &tree, path, left_out)
}
