//! Conversion of the prestretch of a block: stretches along the axes, those that are not written from incompressibility.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::spec_solids::PrestretchSpec;
use crate::math::Matrix;

pub(super) fn prestretch(
    spec: Option<&PrestretchSpec>,
    scope: &Scope<'_>,
) -> Result<Option<Matrix>, SceneError> {
    let Some(spec) = spec else {
        return Ok(None);
    };
    let written = [("x", spec.x), ("y", spec.y), ("z", spec.z)];
    for (axis, stretch) in written {
        if let Some(stretch) = stretch.filter(|stretch| !(*stretch > 0.0 && stretch.is_finite())) {
            return Err(scope
                .key(axis)
                .wrong(stretch.to_string(), "a positive stretch"));
        }
    }
    let given = || written.iter().filter_map(|(_, stretch)| *stretch);
    let others = 3 - given().count();
    if others == 3 {
        return Err(scope.wrong("no stretch", "\"x\", \"y\" or \"z\", or several of them"));
    }
    let other = given().product::<f64>().powf(-1.0 / others.max(1) as f64);
    let stretches = written.map(|(_, stretch)| stretch.unwrap_or(other));
    Ok(Some(Matrix::from_diagonal(&stretches.into())))
}
