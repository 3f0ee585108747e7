//! Conversion of a surface of a scene file to a mesh of triangles.

use nalgebra::Vector3;

use crate::files::json::error::Result;
use crate::files::json::scope::{Scope, refuse, the_one};
use crate::files::scene::division::{layers, mesh_mistake, name_regions};
use crate::files::scene::point::vector;
use crate::files::scene::spec_solids::{AxisName, DivisionSpec, SurfaceSpec};
use crate::files::units::quantity::{Length, Quantity};
use crate::mesh::Mesh;
use crate::mesh::grid::Grid;
use crate::mesh::surface::Surface;
use crate::model::check_elements;
use std::collections::BTreeMap;

/// The surface, and the divisions of its cells with their place.
struct Divided<'s, 'a> {
    surface: Surface,
    divisions: &'s [DivisionSpec],
    scope: Scope<'a>,
}

/// The surface in one region, or in those of its layers, which are sets too.
pub(super) fn surface(spec: &SurfaceSpec, scope: &Scope<'_>) -> Result<Mesh> {
    let Divided {
        surface,
        divisions,
        scope: of_elements,
    } = divided(spec, scope)?;
    let [first, second] = surface.cells();
    let elements = check_elements([first, second, 1]);
    elements.map_err(|fault| of_elements.refuse(&divisions, &fault))?;
    let (mut mesh, cells) = surface.mesh();
    name_regions(
        &mut mesh,
        divisions,
        |element, axis| cells[element][axis],
        &of_elements,
    )?;
    if mesh.region_names.len() > 1 {
        add_regions(&mut mesh);
    }
    let centre = spec.centre.as_ref().map_or_else(Vector3::zeros, vector);
    Ok(mesh.transformed(|x| {
        centre
            + match spec.axis {
                None | Some(AxisName::Z) => x,
                Some(AxisName::X) => Vector3::new(x.z, x.x, x.y),
                Some(AxisName::Y) => Vector3::new(x.y, x.z, x.x),
            }
    }))
}

/// Adds the nodes of each region as a set.
fn add_regions(mesh: &mut Mesh) {
    let mut sets: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (nodes, &region) in mesh.triangles.iter().zip(&mesh.regions) {
        let set = sets.entry(mesh.region_names[region].clone()).or_default();
        set.extend(nodes);
    }
    for set in sets.values_mut() {
        set.sort_unstable();
        set.dedup();
    }
    mesh.sets.extend(sets);
}

/// The number of elements in a direction that has no layers.
fn number(division: &DivisionSpec, least: usize, scope: &Scope<'_>) -> Result<usize> {
    match division {
        DivisionSpec::Equal(count) if *count >= least => Ok(*count),
        DivisionSpec::Equal(count) => {
            Err(scope.wrong(count.to_string(), format!("{least} elements or more")))
        }
        DivisionSpec::Layers(_) => Err(scope.wrong("layers", "a number of elements around")),
    }
}

/// Planes of nodes of a division from one place to another.
fn planes(division: &DivisionSpec, [from, to]: [f64; 2], scope: &Scope<'_>) -> Result<Vec<f64>> {
    let layers = layers(division, to - from, scope)?;
    let counts = [layers.iter().map(|layer| layer.1).sum(), 1, 1];
    let checked = check_elements(counts);
    checked.map_err(|fault| scope.refuse(division, &fault))?;
    let (corner, size) = (
        Vector3::new(from, 0.0, 0.0),
        Vector3::new(to - from, 1.0, 1.0),
    );
    let one = || vec![(1.0, 1)];
    let grid = Grid::layers(corner, size, [layers, one(), one()]);
    let [planes, ..] = grid.map_err(|error| mesh_mistake(&error, scope))?.planes;
    Ok(planes)
}

fn divided<'s, 'a>(spec: &'s SurfaceSpec, scope: &Scope<'a>) -> Result<Divided<'s, 'a>> {
    let length = |place: &Scope<'_>, length: &Quantity<Length>| place.positive(length);
    the_one!(scope, spec;
        "rectangle" rectangle |place, of| {
            let (sizes, scope) = (place.key("size"), place.key("elements"));
            let mut both = [Vec::new(), Vec::new()];
            for (axis, both) in both.iter_mut().enumerate() {
                let half = length(&sizes.index(axis), &of.size[axis])? / 2.0;
                *both = planes(&of.elements[axis], [-half, half], &scope.index(axis))?;
            }
            Ok(Divided { surface: Surface::Rectangle(both), divisions: &of.elements, scope })
        };
        "disc" disc |place, of| {
            let radius = length(&place.key("radius"), &of.radius)?;
            let radii = planes(&of.elements, [0.0, radius], &place.key("elements"))?;
            let divisions = std::slice::from_ref(&of.elements);
            Ok(Divided { surface: Surface::Disc(radii), divisions, scope: place.key("elements") })
        };
        "annulus" annulus |place, of| {
            let (at, scope) = (place.key("radii"), place.key("elements"));
            let [inner, outer] = [0, 1].map(|end| length(&at.index(end), &of.radii[end]));
            let (inner, outer) = (inner?, outer?);
            refuse!(if outer <= inner, at;
                found format!("{inner} mm and {outer} mm"), expected "the inner radius, then the outer one");
            let radii = planes(&of.elements[0], [inner, outer], &scope.index(0))?;
            let around = number(&of.elements[1], 3, &scope.index(1))?;
            Ok(Divided { surface: Surface::Annulus(radii, around), divisions: &of.elements, scope })
        };
        "tube" tube |place, of| {
            let radius = length(&place.key("radius"), &of.radius)?;
            let along = length(&place.key("length"), &of.length)?;
            let scope = place.key("elements");
            let around = number(&of.elements[0], 3, &scope.index(0))?;
            let planes = planes(&of.elements[1], [0.0, along], &scope.index(1))?;
            let surface = Surface::Tube(radius, around, planes);
            Ok(Divided { surface, divisions: &of.elements, scope })
        };
        "sphere" sphere |place, of| {
            let radius = length(&place.key("radius"), &of.radius)?;
            let scope = place.key("elements");
            refuse!(if of.elements == 0, scope; found of.elements, expected "1 element or more");
            Ok(Divided { surface: Surface::Sphere(radius, of.elements), divisions: &[], scope })
        };
    )
}
