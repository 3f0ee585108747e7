//! Conversion of a body of a scene file to its principal moments of inertia and directors, and what has to hold bodies.

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::division::mesh_mistake;
use crate::files::scene::mesh::DEFAULT_UNIT;
use crate::files::scene::point::{unit_axis, vector};
use crate::files::scene::spec::{BodyMeshSpec, BodySpec};
use crate::files::stl;
use crate::kinematics::Pose;
use crate::math::DisjointSets;
use crate::mesh::triangulated::Surface;
use crate::model::system::{Body, Joint, Shape, directors_along, is_diagonal, principal};

/// The body that is written.
pub(crate) fn body(spec: &BodySpec, scope: &Scope<'_>) -> Result<Body> {
    check_keys(spec, scope)?;
    let surface = scope.optional("mesh", &spec.mesh, surface)?;
    let body = match (surface, &spec.inertia) {
        (Some(surface), None) => within(surface, spec, scope)?,
        (surface, inertia) => {
            let (shape, directors) = simple(spec, scope)?;
            let body = Body {
                centre: position(spec, scope)?,
                directors,
                ..Body::from_shape(shape)
            };
            match inertia {
                None => body,
                Some(_) => with_tensor(body, surface, &tensor(spec, scope)?),
            }
        }
    };
    let mass = mass(spec, &body.shape, scope)?;
    let inertia = match &spec.inertia {
        None => body.shape.inertia(mass),
        Some(_) => body.inertia,
    };
    Ok(Body {
        name: spec.name.clone(),
        mass,
        inertia,
        ..body
    })
}

/// Checks that there is one mass or density, and one shape or explicit moments or both.
fn check_keys(spec: &BodySpec, scope: &Scope<'_>) -> Result<()> {
    scope.one_key([
        ("mass", spec.mass.is_some()),
        ("density", spec.density.is_some()),
    ])?;
    let shapes = [
        ("cylinder", spec.cylinder.is_some()),
        ("box", spec.cuboid.is_some()),
        ("sphere", spec.sphere.is_some()),
        ("mesh", spec.mesh.is_some()),
    ];
    let [cylinder, cuboid, sphere, mesh] = shapes;
    let is_single = shapes.iter().filter(|(_, there)| *there).count() <= 1;
    if spec.inertia.is_none() {
        scope.one_key([cylinder, cuboid, sphere, mesh, ("inertia", false)])?;
    } else if !is_single {
        scope.one_key(shapes)?;
    }
    let is_alone = spec.inertia.is_none() && spec.products_of_inertia.is_some();
    refuse!(if is_alone, scope.key("products_of_inertia");
        found "products of inertia alone",
        expected "\"inertia\", the diagonal of the tensor, beside it");
    Ok(())
}

/// Shape and directors; d₃ is the axis of a cylinder.
fn simple(spec: &BodySpec, scope: &Scope<'_>) -> Result<(Shape, Matrix3<f64>)> {
    if let Some(cylinder) = &spec.cylinder {
        let scope = scope.key("cylinder");
        let shape = Shape::Cylinder {
            length: scope.key("length").positive(&cylinder.length)?,
            radius: scope.key("radius").positive(&cylinder.radius)?,
        };
        let axis = unit_axis(&cylinder.axis, &scope.key("axis"))?;
        return Ok((shape, directors_along(&axis)));
    }
    if let Some(cuboid) = &spec.cuboid {
        let scope = scope.key("box").key("size");
        let mut size = [0.0; 3];
        for (index, (side, written)) in size.iter_mut().zip(&cuboid.size).enumerate() {
            *side = scope.index(index).positive(written)?;
        }
        return Ok((Shape::Box { size }, Matrix3::identity()));
    }
    if let Some(sphere) = &spec.sphere {
        let radius = scope.key("sphere").key("radius").positive(&sphere.radius)?;
        return Ok((Shape::Sphere { radius }, Matrix3::identity()));
    }
    Ok((Shape::None, Matrix3::identity()))
}

/// The surface of a mesh in the ground frame.
fn surface(scope: &Scope<'_>, spec: &BodyMeshSpec) -> Result<Surface> {
    let unit = scope.optional("unit", &spec.unit, Scope::positive)?;
    let place = scope.key("file");
    let file = place.file(&spec.file, "the path of an STL file")?;
    let surface = stl::read(&file, unit.unwrap_or(DEFAULT_UNIT))
        .map_err(|error| mesh_mistake(&error, &place))?;
    let origin = spec.at.as_ref().map_or_else(Vector3::zeros, vector);
    let Some(rotation) = &spec.rotation else {
        return Ok(surface.transformed(|x| x + origin));
    };
    let axis = unit_axis(&rotation.axis, &scope.key("rotation").key("axis"))?;
    let axis = Unit::new_unchecked(axis);
    let turned = UnitQuaternion::from_axis_angle(&axis, rotation.angle.value());
    Ok(surface.transformed(|x| origin + turned * x))
}

/// The body that a surface encloses.
fn within(surface: Surface, spec: &BodySpec, scope: &Scope<'_>) -> Result<Body> {
    refuse!(if spec.position.is_some(), scope.key("position");
        found "a position of a body whose centre of mass follows from its mesh",
        expected "\"at\" of the mesh, the place of its origin");
    let place = scope.key("mesh").key("file");
    Body::within(surface).map_err(|error| mesh_mistake(&error, &place))
}

fn position(spec: &BodySpec, scope: &Scope<'_>) -> Result<Vector3<f64>> {
    let missing = || scope.wrong("no \"position\"", "the place of its centre of mass");
    spec.position.as_ref().map(vector).ok_or_else(missing)
}

/// The mass in g.
fn mass(spec: &BodySpec, shape: &Shape, scope: &Scope<'_>) -> Result<f64> {
    let Some(density) = &spec.density else {
        return Ok(spec.mass.as_ref().expect("one of the two").value());
    };
    let scope = scope.key("density");
    let density = scope.positive(density)?;
    let missing = || {
        let found = "a density of a body without a volume";
        scope.wrong(found, "a cylinder, box, sphere or closed mesh, or \"mass\"")
    };
    Ok(density * shape.volume().ok_or_else(missing)?)
}

/// The tensor of inertia about the axes of the ground frame that is written.
fn tensor(spec: &BodySpec, scope: &Scope<'_>) -> Result<Matrix3<f64>> {
    let mut tensor = Matrix3::zeros();
    let place = scope.key("inertia");
    for (index, written) in spec.inertia.iter().flatten().enumerate() {
        tensor[(index, index)] = place.index(index).positive(written)?;
    }
    if let Some([xy, xz, yz]) = &spec.products_of_inertia {
        for (row, column, entry) in [(0, 1, xy), (0, 2, xz), (1, 2, yz)] {
            tensor[(row, column)] = entry.value();
            tensor[(column, row)] = entry.value();
        }
    }
    Ok(tensor)
}

/// A body with a tensor of inertia; a shape whose axes are not principal axes is drawn as a surface, and so is a mesh.
fn with_tensor(body: Body, surface: Option<Surface>, tensor: &Matrix3<f64>) -> Body {
    let own = body.directors.transpose() * tensor * body.directors;
    let (inertia, directors) = match is_diagonal(&own) {
        true => (own.diagonal().into(), body.directors),
        false => principal(tensor),
    };
    let pose = Pose {
        centre: body.centre,
        directors,
    };
    let shape = match (surface, &body.shape) {
        (Some(surface), _) => Shape::surface(surface, &pose),
        (None, Shape::Cylinder { .. } | Shape::Box { .. }) if directors != body.directors => {
            let mut surface = Surface::default();
            body.shape.add_to(&mut surface, &body.pose());
            Shape::surface(surface, &pose)
        }
        (None, shape) => shape.clone(),
    };
    Body {
        inertia,
        directors,
        shape,
        ..body
    }
}

/// Every body hangs on the ground or together with a free one, and no free one hangs on the ground.
pub(crate) fn check_connected<'a>(
    bodies: &[BodySpec],
    joints: &[Joint],
    scope: impl Fn(usize) -> Scope<'a>,
) -> Result<()> {
    // The part of each body, and of the ground in the last entry.
    let mut sets = DisjointSets::new(bodies.len() + 1);
    for joint in joints {
        sets.join(joint.parent.unwrap_or(bodies.len()), joint.child);
    }
    let parts = sets.all();
    let ground = parts[bodies.len()];
    for (index, body) in bodies.iter().enumerate() {
        let grounded = parts[index] == ground;
        refuse!(if body.free && grounded, scope(index);
            found format!("{:?} free, though joints lead to the ground", body.name),
            expected "no \"free\" here");
        let mut part = bodies
            .iter()
            .zip(&parts)
            .filter(|(_, part)| **part == parts[index]);
        refuse!(if !grounded && !part.any(|(body, _)| body.free), scope(index);
            found format!("{:?}, which no chain of joints connects to the ground", body.name),
            expected "a joint that leads to the ground, or \"free\": true");
    }
    Ok(())
}
