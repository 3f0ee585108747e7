//! Conversion of a box, a surface or a Gmsh file of a scene file to a mesh.

use nalgebra::Vector3;

use crate::files::json::error::{Result, SceneError};
use crate::files::json::scope::{Scope, refuse, the_one};
use crate::files::scene::point::vector;
use crate::files::scene::spec_solids::{DivisionSpec, ElementSpec, GridSpec, LayerSpec, SolidSpec};
use crate::files::scene::surface::surface;
use crate::mesh::cell::Cell;
use crate::mesh::error::{MeshError, MeshPlace};
use crate::mesh::grid::Grid;
use crate::mesh::{Mesh, gmsh};
use crate::model::system::ElementKind;
use crate::model::{MOST_ELEMENTS, check_elements};

/// Unit of a mesh file in mm where none is written: the metre.
pub(crate) const DEFAULT_UNIT: f64 = 1e3;

/// A mesh, and for boxes the node planes along x, y, z in mm.
pub(crate) struct Meshed {
    pub(crate) mesh: Mesh,
    pub(crate) planes: Option<[Vec<f64>; 3]>,
}

/// The mesh of a block, checked.
pub(crate) fn meshed(spec: &SolidSpec, scope: &Scope<'_>) -> Result<Meshed> {
    let (meshed, place) = the_one!(scope, spec;
        "box" cuboid |place, cuboid| {
            refuse!(if let Some(unit) = &spec.unit, scope.key("unit");
                found unit, expected "no such key: the lengths of a box have units of their own");
            (boxed(cuboid, spec.element, place)?, place.clone())
        };
        "surface" surface |place, of| {
            refuse!(if let Some(unit) = &spec.unit, scope.key("unit");
                found unit, expected "no such key: the lengths of a surface have units of their own");
            let mesh = surface(of, place)?;
            (Meshed { mesh, planes: None }, place.clone())
        };
        "mesh" mesh |place, path| (from_file(path, spec, scope)?, place.clone());
    );
    let checked = meshed.mesh.check();
    checked.map_err(|error| mesh_mistake(&error, &place))?;
    Ok(meshed)
}

fn from_file(path: &str, spec: &SolidSpec, scope: &Scope<'_>) -> Result<Meshed> {
    let unit = scope.optional("unit", &spec.unit, Scope::positive)?;
    let unit = unit.unwrap_or(DEFAULT_UNIT);
    let scope = scope.key("mesh");
    let file = scope.file(path, "the path of a Gmsh file")?;
    let mesh = gmsh::read(&file, unit).map_err(|error| mesh_mistake(&error, &scope))?;
    Ok(Meshed { mesh, planes: None })
}

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

fn boxed(spec: &GridSpec, element: Option<ElementSpec>, scope: &Scope<'_>) -> Result<Meshed> {
    let mut size = Vector3::zeros();
    for (axis, length) in spec.size.iter().enumerate() {
        size[axis] = scope.key("size").index(axis).positive(length)?;
    }
    let corner = spec.corner.as_ref().map_or_else(Vector3::zeros, vector);
    let scope = scope.key("elements");
    let mut layers = [Vec::new(), Vec::new(), Vec::new()];
    for (axis, division) in spec.elements.iter().enumerate() {
        layers[axis] = self::layers(division, size[axis], &scope.index(axis))?;
    }
    let count = |layers: &Vec<(f64, usize)>| layers.iter().map(|layer| layer.1).sum();
    let elements = check_elements(layers.each_ref().map(count));
    elements.map_err(|fault| scope.refuse(&spec.elements, &fault))?;
    let grid = Grid::layers(corner, size, layers.clone()).map_err(|error| {
        let axis = match error {
            MeshError::Wrong {
                place: MeshPlace::Layers(axis),
                ..
            } => "xyz".find(axis).unwrap_or(0),
            _ => 0,
        };
        mesh_mistake(&error, &scope.index(axis))
    })?;
    let mut mesh = grid.mesh();
    // Elements count along x first, then y, then z.
    let cells = |axis: usize| grid.planes[axis].len() - 1;
    let cell = |element: usize, axis: usize| {
        let stride: usize = (0..axis).map(cells).product();
        element / stride % cells(axis)
    };
    name_regions(&mut mesh, &spec.elements, cell, &scope)?;
    let element = ElementKind::from(element.unwrap_or_default());
    if element.cell() == Cell::Tetrahedron {
        mesh = mesh.in_tetrahedra();
    }
    Ok(Meshed {
        mesh,
        planes: Some(grid.planes),
    })
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
