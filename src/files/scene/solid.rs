//! Conversion of an elastic block of a scene file to nodes, materials, electrodes, supports, velocities and prestretch.

use crate::files::json::scope::{Result, Scope, list, refuse, the_one};
use crate::files::problem::at::ELECTRIC_KEYS;
use crate::files::scene::electrodes::electrodes;
use crate::files::scene::mesh::{Meshed, meshed};
use crate::files::scene::names::{find_body, find_compressible, find_material};
use crate::files::scene::nodes::{extent, face, nodes, place};
use crate::files::scene::point::vector;
use crate::files::scene::spec_solids::{
    AxisName, FixedSpec, PrestretchSpec, SolidSpec, VelocitySpec,
};
use crate::math::Matrix;
use crate::mesh::Mesh;
use crate::model::system::{ElementKind, Glue, Material, Solid, Support, Tie};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// The block that is written; the voltages of its electrodes count from zero.
pub(crate) fn solid(
    spec: &SolidSpec,
    bodies: &[String],
    solids: &[String],
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Solid> {
    let meshed = meshed(spec, scope)?;
    let by_region = by_region(spec, &meshed.mesh, scope)?;
    let mut of_region = Vec::new();
    for (name, place) in &by_region {
        of_region.push(match spec.thickness {
            None => find_compressible(name, materials, place)?,
            Some(_) => find_material(name, materials, place)?,
        });
    }
    let electrodes = electrodes(spec, &meshed, scope)?;
    let passive = of_region
        .iter()
        .position(|material| material.electric.is_none());
    let passive = passive.filter(|_| !electrodes.is_empty());
    refuse!(if let Some((name, place)) = passive.map(|region| &by_region[region]), place;
        found format!("{name:?}, which has no electric term, in a block with electrodes"),
        expected ELECTRIC_KEYS);
    let thickness = scope.optional("thickness", &spec.thickness, Scope::positive)?;
    let Meshed { mesh, .. } = meshed;
    let element = spec
        .element
        .map_or(ElementKind::of_mesh(&mesh), ElementKind::from);
    let (glued, grounded) = glued(spec, &mesh, bodies, solids, &scope.key("glued"))?;
    let mut supports = supports(spec, &mesh, &scope.key("fixed"))?;
    supports.extend(grounded);
    // A glued node moves with its body, whatever else holds its face.
    for support in &mut supports {
        let is_free = |node: &usize| {
            glued
                .iter()
                .all(|glue| glue.nodes.binary_search(node).is_err())
        };
        support.nodes.retain(is_free);
    }
    supports.retain(|support| !support.nodes.is_empty());
    let velocity = spec.velocity.as_ref();
    let velocities = velocity.map_or_else(Vec::new, |velocity| velocities(velocity, &mesh));
    Ok(Solid {
        name: spec.name.clone(),
        mesh,
        materials: of_region,
        element,
        electrodes,
        supports,
        glued,
        tied: Vec::new(),
        velocities,
        thickness,
        prestretch: prestretch(spec.prestretch.as_ref(), &scope.key("prestretch"))?,
    })
}

/// Name of the material of each region, and where it stands.
fn by_region<'s, 'a>(
    spec: &'s SolidSpec,
    mesh: &Mesh,
    scope: &Scope<'a>,
) -> Result<Vec<(&'s String, Scope<'a>)>> {
    let whole = |scope: &Scope<'a>, name| vec![(name, scope.clone()); mesh.region_names.len()];
    the_one!(scope, spec;
        "material" material |scope, name| Ok(whole(scope, name));
        "materials" materials |scope, named| of_regions(named, mesh, scope);
    )
}

/// The same where each region has a material of its own.
fn of_regions<'s, 'a>(
    named: &'s BTreeMap<String, String>,
    mesh: &Mesh,
    scope: &Scope<'a>,
) -> Result<Vec<(&'s String, Scope<'a>)>> {
    let expected = format!(
        "the name of a region: one of {}",
        list(mesh.region_names.iter())
    );
    for region in named.keys() {
        let place = scope.key(region);
        place.find(region, &mesh.region_names, &expected)?;
    }
    let regions = mesh.region_names.iter().map(|region| {
        let missing = || scope.wrong(format!("no material of the region {region:?}"), "one");
        let name = named.get(region).ok_or_else(missing)?;
        Ok((name, scope.key(region)))
    });
    regions.collect()
}

/// The places that are held.
fn supports(spec: &SolidSpec, mesh: &Mesh, scope: &Scope<'_>) -> Result<Vec<Support>> {
    scope.each(&spec.fixed, |fixed, scope| {
        let held = match fixed {
            FixedSpec::Clamped(name) => {
                let nodes = face(name, mesh, scope)?.to_vec();
                let held = [true; 3];
                return Ok(Support { nodes, held });
            }
            FixedSpec::Held(held) => held,
        };
        let nodes = nodes!("a support", held, mesh, scope);
        let directions = held.directions.as_deref();
        let held = directions.map_or([true; 3], along);
        refuse!(if held == [false; 3], scope.key("directions");
            found "no direction", expected "one of \"x\", \"y\", \"z\" or more");
        Ok(Support { nodes, held })
    })
}

/// Returns for x, y, z true if they are among some directions.
fn along(directions: &[AxisName]) -> [bool; 3] {
    [AxisName::X, AxisName::Y, AxisName::Z].map(|axis| directions.contains(&axis))
}

/// The faces that are glued to bodies, and those that are glued to the ground, which clamps them.
fn glued(
    spec: &SolidSpec,
    mesh: &Mesh,
    bodies: &[String],
    solids: &[String],
    scope: &Scope<'_>,
) -> Result<(Vec<Glue>, Vec<Support>)> {
    let mut owners: BTreeMap<usize, &String> = BTreeMap::new();
    let (mut glued, mut grounded) = (Vec::new(), Vec::new());
    for (name, body) in &spec.glued {
        let scope = scope.key(name);
        if is_solid(body, bodies, solids) {
            continue;
        }
        let all = face(name, mesh, &scope)?;
        let mut nodes = Vec::new();
        for &node in all {
            match owners.insert(node, body) {
                None => nodes.push(node),
                Some(other) if other == body => {}
                Some(other) => {
                    let at = place(&mesh.nodes[node]);
                    let found = format!("{body:?}, though {other:?} holds the node at {at} too");
                    return Err(scope.wrong(found, "faces of different bodies that do not meet"));
                }
            }
        }
        match find_body(body, bodies, &scope)? {
            Some(body) => glued.push(Glue {
                nodes,
                body: Some(body),
            }),
            None => grounded.push(Support {
                nodes,
                held: [true; 3],
            }),
        }
    }
    Ok((glued, grounded))
}

/// Returns true if a name is one of a solid: bodies come first.
fn is_solid(name: &String, bodies: &[String], solids: &[String]) -> bool {
    solids.contains(name) && !bodies.contains(name) && name != "ground"
}

/// The nodes of the faces of each solid that are glued to other ones, as sums of nodes there.
pub(crate) fn ties(
    specs: &[SolidSpec],
    all: &[Solid],
    bodies: &[String],
    scope: &Scope<'_>,
) -> Result<Vec<Vec<Tie>>> {
    let names: Vec<String> = all.iter().map(|solid| solid.name.clone()).collect();
    let is_solid = |to: &String| is_solid(to, bodies, &names);
    let is_tied = |spec: &SolidSpec| spec.glued.values().any(is_solid);
    let pairs: Vec<_> = specs.iter().zip(all).collect();
    scope.each(&pairs, |&(spec, of), scope| {
        let mut ties: BTreeMap<usize, Tie> = BTreeMap::new();
        for (name, to) in spec.glued.iter().filter(|(_, to)| is_solid(to)) {
            let Some(solid) = names.iter().position(|other| other == to) else {
                continue;
            };
            let faces = all[solid].mesh.boundary();
            let scope = scope.key("glued").key(name);
            refuse!(if spec.name == *to || is_tied(&specs[solid]), scope;
                found format!("{to:?}, which is glued to a block or a membrane itself"),
                expected "one that is not");
            for &node in face(name, &of.mesh, &scope)? {
                let at = &of.mesh.nodes[node];
                let missing = || {
                    let found = format!("a node at {} off the surface of {to:?}", place(at));
                    scope.wrong(found, "a face that lies on it")
                };
                let on = all[solid].mesh.footing(&faces, at).ok_or_else(missing)?;
                ties.insert(node, Tie { node, solid, on });
            }
        }
        Ok(ties.into_values().collect())
    })
}

/// v₀ + ω × (X − c) + diag(rate) (X − c) of each node in mm/ms.
fn velocities(spec: &VelocitySpec, mesh: &Mesh) -> Vec<Vector3<f64>> {
    let linear = spec.linear.as_ref().map_or_else(Vector3::zeros, vector);
    let angular = spec.angular.as_ref().map_or_else(Vector3::zeros, vector);
    let rate = spec
        .stretch_rate
        .as_ref()
        .map_or_else(Vector3::zeros, vector);
    let [low, high] = extent(mesh);
    let centre = spec.centre.as_ref().map_or((low + high) / 2.0, vector);
    let velocity = |node: &Vector3<f64>| {
        let arm = node - centre;
        linear + angular.cross(&arm) + rate.component_mul(&arm)
    };
    mesh.nodes.iter().map(velocity).collect()
}

pub(super) fn prestretch(
    spec: Option<&PrestretchSpec>,
    scope: &Scope<'_>,
) -> Result<Option<Matrix>> {
    let Some(spec) = spec else {
        return Ok(None);
    };
    let written = [("x", spec.x), ("y", spec.y), ("z", spec.z)];
    for (axis, stretch) in written {
        let wrong = stretch.filter(|stretch| !(*stretch > 0.0 && stretch.is_finite()));
        refuse!(if let Some(stretch) = wrong, scope.key(axis);
            found stretch, expected "a positive stretch");
    }
    let given = || written.iter().filter_map(|(_, stretch)| *stretch);
    let others = 3 - given().count();
    refuse!(if others == 3, scope;
        found "no stretch", expected "\"x\", \"y\" or \"z\", or several of them");
    let other = given().product::<f64>().powf(-1.0 / others.max(1) as f64);
    let stretches = written.map(|(_, stretch)| stretch.unwrap_or(other));
    Ok(Some(Matrix::from_diagonal(&stretches.into())))
}
