//! Bounds of limits as they are written.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;

/// Checks that a bound is written and that bounds are not crossed.
pub(super) fn check_bounds(
    min: f64,
    max: f64,
    there: bool,
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    if !there {
        return Err(scope.wrong("no bound", "\"min\", \"max\" or both"));
    }
    if min > max {
        let found = "\"max\" below \"min\"";
        return Err(scope.key("max").wrong(found, "bounds that are not crossed"));
    }
    Ok(())
}
