//! Conversion of a box, a surface or a Gmsh file of a scene file to a mesh.

use nalgebra::Vector3;

use crate::files::json::error::Result;
use crate::files::json::scope::{Scope, refuse, the_one};
use crate::files::scene::division::{layers as divided, mesh_mistake, name_regions};
use crate::files::scene::point::vector;
use crate::files::scene::spec_solids::{ElementSpec, GridSpec, SolidSpec};
use crate::files::scene::surface::surface;
use crate::mesh::cell::Cell;
use crate::mesh::error::{MeshError, MeshPlace};
use crate::mesh::grid::Grid;
use crate::mesh::{Mesh, gmsh};
use crate::model::check_elements;
use crate::model::system::ElementKind;

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

fn boxed(spec: &GridSpec, element: Option<ElementSpec>, scope: &Scope<'_>) -> Result<Meshed> {
    let mut size = Vector3::zeros();
    for (axis, length) in spec.size.iter().enumerate() {
        size[axis] = scope.key("size").index(axis).positive(length)?;
    }
    let corner = spec.corner.as_ref().map_or_else(Vector3::zeros, vector);
    let scope = scope.key("elements");
    let mut layers = [Vec::new(), Vec::new(), Vec::new()];
    for (axis, division) in spec.elements.iter().enumerate() {
        layers[axis] = divided(division, size[axis], &scope.index(axis))?;
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
