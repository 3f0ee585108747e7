//! Conversion of limits of what joints transmit to path constraints.

use crate::control::problem::PathConstraint;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::source_limits::bounds;
use crate::files::problem::spec_limits::{ReactionForceLimitSpec, ReactionTorqueLimitSpec};
use crate::files::scene::names::names;
use crate::files::scene::point::unit_axis;
use crate::model::Reaction;
use crate::model::system::System;

pub(super) fn reaction_force(
    spec: &ReactionForceLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<PathConstraint, SceneError> {
    let [min, max] = bounds([&spec.min, &spec.max], scope)?;
    Ok(PathConstraint::Reaction {
        joint: joint(&spec.joint, system, scope)?,
        of: Reaction::Force,
        along: unit_axis(&spec.along, &scope.key("along"))?,
        min,
        max,
    })
}

pub(super) fn reaction_torque(
    spec: &ReactionTorqueLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<PathConstraint, SceneError> {
    let joint = joint(&spec.joint, system, scope)?;
    if !system.joints[joint].has_torque() {
        let found = format!("{:?}, a spherical joint", spec.joint);
        let expected = "a joint that transmits a torque";
        return Err(scope.key("joint").wrong(found, expected));
    }
    let [min, max] = bounds([&spec.min, &spec.max], scope)?;
    Ok(PathConstraint::Reaction {
        joint,
        of: Reaction::Torque,
        along: unit_axis(&spec.about, &scope.key("about"))?,
        min,
        max,
    })
}

/// Index of a joint.
fn joint(name: &str, system: &System, scope: &Scope<'_>) -> Result<usize, SceneError> {
    let joints = names(&system.joints, |joint| &joint.name);
    scope
        .key("joint")
        .find(name, &joints, "the name of a joint")
}
