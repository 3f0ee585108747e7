//! Divisions of directions of a mesh in a scene file: layers, and the regions that they name; errors of meshes.

use crate::files::json::error::{Result, SceneError};
use crate::files::json::scope::{Scope, refuse};
use crate::files::scene::spec_solids::{DivisionSpec, LayerSpec};
use crate::mesh::Mesh;
use crate::mesh::error::{MeshError, MeshPlace};
use crate::model::MOST_ELEMENTS;

/// Converts an error of a mesh to one at the place in the scene that asks for it.
pub(crate) fn mesh_mistake(error: &MeshError, scope: &Scope<'_>) -> SceneError {
    match error {
        MeshError::Unreadable { file, cause } => {
            let found = format!("{file:?}, which cannot be read ({cause})");
            scope.wrong(found, "a readable file")
        }
        MeshError::Wrong {
            place,
            found,
            expected,
        } => match place {
            MeshPlace::Line(..) | MeshPlace::Element(..) => {
                scope.wrong(format!("{found} in {place}"), expected)
            }
            MeshPlace::Layers(_) | MeshPlace::Whole => scope.wrong(found, expected),
        },
    }
}

/// Thickness in mm and elements of the layers of a division of a length.
pub(super) fn layers(
    division: &DivisionSpec,
    length: f64,
    scope: &Scope<'_>,
) -> Result<Vec<(f64, usize)>> {
    match division {
        DivisionSpec::Equal(elements) => Ok(vec![(length, *elements)]),
        DivisionSpec::Layers(written) => layered(written, scope),
    }
}

/// Thickness in mm and elements of the layers along one direction.
fn layered(layers: &[LayerSpec], scope: &Scope<'_>) -> Result<Vec<(f64, usize)>> {
    scope.each(layers, |layer, scope| {
        refuse!(if layer.elements == 0 || layer.elements > MOST_ELEMENTS, scope.key("elements");
            found layer.elements, expected "1 element or more");
        let thickness = scope.key("thickness").positive(&layer.thickness)?;
        Ok((thickness, layer.elements))
    })
}

/// Gives each element the region of its layer, in the one direction that names regions; `cell` is the number of an element along a direction.
pub(super) fn name_regions(
    mesh: &mut Mesh,
    divisions: &[DivisionSpec],
    cell: impl Fn(usize, usize) -> usize,
    scope: &Scope<'_>,
) -> Result<()> {
    let mut named = None;
    for (axis, division) in divisions.iter().enumerate() {
        let DivisionSpec::Layers(layers) = division else {
            continue;
        };
        let Some(first) = layers.iter().position(|layer| layer.region.is_some()) else {
            continue;
        };
        let place = scope.index(axis).index(first).key("region");
        refuse!(if named.replace((axis, layers)).is_some(), place;
            found "a region in a second direction", expected "regions along one direction only");
    }
    let Some((axis, layers)) = named else {
        return Ok(());
    };
    let mut names = Vec::new();
    let mut of_element = Vec::new();
    for (index, layer) in layers.iter().enumerate() {
        let Some(name) = &layer.region else {
            let place = scope.index(axis).index(index);
            return Err(place.wrong("a layer without a region", "a region for each layer"));
        };
        let region = names.iter().position(|other| other == name);
        let region = region.unwrap_or_else(|| {
            names.push(name.clone());
            names.len() - 1
        });
        of_element.extend(std::iter::repeat_n(region, layer.elements));
    }
    for (element, region) in mesh.regions.iter_mut().enumerate() {
        *region = of_element[cell(element, axis)];
    }
    mesh.region_names = names;
    Ok(())
}
