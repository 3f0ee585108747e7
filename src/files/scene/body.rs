//! Conversion of a body of a scene file to its principal moments of inertia and directors.

use nalgebra::{Matrix3, Vector3};

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::point::{unit_axis, vector};
use crate::files::scene::spec::BodySpec;
use crate::model::system::{Body, Shape, directors_along};

/// Rounding of moments that satisfy the triangle inequality with equality.
const ROUNDING: f64 = 1e-12;

/// The body that is written.
pub(crate) fn body(spec: &BodySpec, scope: &Scope<'_>) -> Result<Body, SceneError> {
    let mass = scope.key("mass").positive(&spec.mass)?;
    let (shape, directors) = shape(spec, scope)?;
    let inertia = match &spec.inertia {
        None => shape.inertia(mass),
        Some(_) => explicit_inertia(spec, &directors, scope)?,
    };
    if !inertia
        .iter()
        .all(|moment| moment.is_finite() && *moment > 0.0)
    {
        let found = format!("a body with the moments of inertia {inertia:?} g mm^2");
        return Err(scope.wrong(found, "a body of ordinary size"));
    }
    Ok(Body {
        name: spec.name.clone(),
        mass,
        inertia,
        centre: vector(&spec.position),
        directors,
        shape,
    })
}

/// Shape and directors; d₃ is the axis of a cylinder.
fn shape(spec: &BodySpec, scope: &Scope<'_>) -> Result<(Shape, Matrix3<f64>), SceneError> {
    let shapes = [
        ("cylinder", spec.cylinder.is_some()),
        ("box", spec.cuboid.is_some()),
        ("sphere", spec.sphere.is_some()),
    ];
    if spec.inertia.is_none() || shapes.iter().filter(|(_, there)| *there).count() > 1 {
        let [cylinder, cuboid, sphere] = shapes.map(|(key, there)| (key, there.then_some(())));
        if spec.inertia.is_some() {
            scope.exactly_one([cylinder, cuboid, sphere])?;
        }
        scope.exactly_one([
            cylinder,
            cuboid,
            sphere,
            ("inertia", spec.inertia.as_ref().map(|_| ())),
        ])?;
    }
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

/// Moments about the ground axes, put in the order of the directors.
fn explicit_inertia(
    spec: &BodySpec,
    directors: &Matrix3<f64>,
    scope: &Scope<'_>,
) -> Result<[f64; 3], SceneError> {
    let scope = scope.key("inertia");
    let mut moments = Vector3::zeros();
    for (index, written) in spec.inertia.iter().flatten().enumerate() {
        moments[index] = scope.index(index).positive(written)?;
    }
    let largest = moments.max();
    if moments.sum() - 2.0 * largest < -ROUNDING * largest {
        let found = format!("{:?} g mm^2", moments.as_slice());
        let expected = "moments of which none is larger than the sum of the two others";
        return Err(scope.wrong(found, expected));
    }
    let permuted = directors.map(f64::abs).transpose();
    if permuted.iter().any(|entry| *entry != 0.0 && *entry != 1.0) {
        let found = "moments about the ground axes beside a cylinder with an oblique axis";
        let expected = "a cylinder along a ground axis, or no explicit inertia";
        return Err(scope.wrong(found, expected));
    }
    Ok((permuted * moments).into())
}
