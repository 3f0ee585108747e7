//! Shapes of bodies of a URDF file: one about the centre of mass by its key, others as a surface of triangles.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

use crate::files::stl;
use crate::files::urdf::element::LeftOut;
use crate::files::urdf::read::{Geometry, Visual};
use crate::kinematics::Pose;
use crate::mesh::triangulated::Surface;
use crate::model::system::Shape;

/// Distances in m and deviations of directions that are those of rounding.
const NEAR: f64 = 1e-9;

/// Shape of a body.
pub(super) enum Outline {
    /// A key of the body, and its value.
    Key(&'static str, Value),
    /// A surface in m in the ground frame.
    Surface(Surface),
    /// Nothing.
    None,
}

/// Shape of a body with its centre of mass in m, from visuals with their poses in the ground frame.
pub(super) fn outline(
    visuals: &[Visual],
    centre: &Vector3<f64>,
    path: &Path,
    owner: &str,
    left_out: &mut LeftOut,
) -> Outline {
    if let [visual] = visuals
        && let Some((key, value)) = by_key(visual, centre)
    {
        return Outline::Key(key, value);
    }
    let mut surface = Surface::default();
    for Visual { pose, geometry } in visuals {
        match own(geometry, path) {
            Ok(own) => {
                let placed = own.transformed(|x| (pose * Point3::from(x)).coords);
                surface.add(&placed);
            }
            Err(kind) => left_out.add(kind, owner),
        }
    }
    match surface.triangles.is_empty() {
        true => Outline::None,
        false => Outline::Surface(surface),
    }
}

/// The shape about the centre of mass as a key of a body.
fn by_key(visual: &Visual, centre: &Vector3<f64>) -> Option<(&'static str, Value)> {
    let Visual { pose, geometry } = visual;
    if (pose.translation.vector - centre).norm() > NEAR {
        return None;
    }
    let axes = pose.rotation.to_rotation_matrix().into_inner();
    let Geometry::Plain(shape) = geometry else {
        return None;
    };
    match *shape {
        Shape::Sphere { radius } => Some(("sphere", json!({ "radius": radius }))),
        Shape::Cylinder { radius, length } => {
            let axis = rounded(&axes.column(2).into_owned());
            let value = json!({ "length": length, "radius": radius, "axis": axis });
            Some(("cylinder", value))
        }
        Shape::Box { size } => {
            let near = axes.map(|entry| entry.abs().round());
            let is_aligned = (axes.map(f64::abs) - near).amax() < NEAR;
            let turned = near * Vector3::from(size);
            is_aligned.then(|| ("box", json!({ "size": turned.as_slice() })))
        }
        Shape::Surface(_) | Shape::None => None,
    }
}

/// A shape in its own frame in m, or the kind of shape that is left out.
fn own(geometry: &Geometry, path: &Path) -> Result<Surface, String> {
    let mut surface = Surface::default();
    match geometry {
        Geometry::Plain(shape) => shape.add_to(&mut surface, &Pose::GROUND),
        Geometry::Mesh { file, scale } => {
            let found = mesh_file(file, path)
                .ok_or_else(|| format!("the mesh {file:?}, where there is no file,"))?;
            let read = stl::read(&found, 1.0);
            let read = read.map_err(|error| {
                let why = error.to_string();
                format!("the mesh {file:?}, which cannot be read ({why}),")
            })?;
            surface = read.transformed(|x| x.component_mul(&Vector3::from(*scale)));
            if scale.iter().product::<f64>() < 0.0 {
                // A mirror image has its corners the other way round.
                surface
                    .triangles
                    .iter_mut()
                    .for_each(|triangle| triangle.swap(1, 2));
            }
        }
    }
    Ok(surface)
}

/// The file of a mesh: relative to the URDF file, or in the folder with the name of its package, which is one above that file or stands in one.
fn mesh_file(name: &str, path: &Path) -> Option<PathBuf> {
    let beside = path.parent().filter(|folder| *folder != Path::new(""));
    let folder = beside.unwrap_or(Path::new(".")).canonicalize().ok()?;
    let is_file = |file: &PathBuf| file.is_file();
    if let Some(in_package) = name.strip_prefix("package://") {
        let (package, rest) = in_package.split_once('/')?;
        let own = |above: &&Path| above.file_name().is_some_and(|name| name == package);
        let inside = folder.ancestors().filter(own).map(|above| above.join(rest));
        let beside = folder.ancestors().map(|above| above.join(in_package));
        return inside.chain(beside).find(is_file);
    }
    let name = name.strip_prefix("file://").unwrap_or(name);
    Some(folder.join(name)).filter(is_file)
}

/// A direction or place without the rounding of rotations by right angles.
pub(super) fn rounded(vector: &Vector3<f64>) -> [f64; 3] {
    let largest = vector.amax();
    vector
        .map(|entry| match entry.abs() < 1e-15 * largest {
            true => 0.0,
            false => entry + 0.0,
        })
        .into()
}

/// A tensor in the frame of a pose as one in the ground frame.
pub(super) fn turned(tensor: &Matrix3<f64>, pose: &Isometry3<f64>) -> Matrix3<f64> {
    let axes = pose.rotation.to_rotation_matrix().into_inner();
    axes * tensor * axes.transpose()
}
