//! Loads.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::names::{attachment, names};
use crate::files::scene::point::PointSpec;
use crate::files::scene::point::unit_axis;
use crate::model::components::{Load, LoadPlace};
use crate::model::system::Joint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force at a point along a direction that does not turn, or a torque or force of a joint, such as that of a motor. A problem says how
/// large it is.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadSpec {
    /// Name, unique among loads, muscles and blocks.
    pub name: String,
    /// Point of a body at which a force acts, with `direction`; or give `joint`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<PointSpec>,
    /// Direction of the force in the ground frame; its length is ignored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Name of a revolute joint, about whose axis a torque acts on the child, or of a prismatic one, along whose axis a force acts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
}

/// The load that is written.
pub(crate) fn load(
    spec: &LoadSpec,
    bodies: &[String],
    joints: &[Joint],
    scope: &Scope<'_>,
) -> Result<Load, SceneError> {
    enum Written<'a> {
        Point(&'a PointSpec),
        Joint(&'a String),
    }
    let on = match scope.exactly_one([
        ("point", spec.point.as_ref().map(Written::Point)),
        ("joint", spec.joint.as_ref().map(Written::Joint)),
    ])? {
        Written::Point(point) => {
            let place = scope.key("point");
            let at = attachment(&point.body, &point.at, bodies, &place)?;
            if at.body.is_none() {
                let found = "\"ground\", which no force moves";
                return Err(place.key("body").wrong(found, "the name of a body"));
            }
            let Some(direction) = &spec.direction else {
                return Err(scope.wrong("no key \"direction\"", "the direction of the force"));
            };
            let direction = unit_axis(direction, &scope.key("direction"))?;
            LoadPlace::Point { at, direction }
        }
        Written::Joint(name) => {
            let place = scope.key("joint");
            if spec.direction.is_some() {
                let expected = "no such key, as the axis of the joint is the direction";
                return Err(scope.key("direction").wrong("\"direction\"", expected));
            }
            let all = names(joints, |joint| &joint.name);
            let index = place.find(name, &all, "the name of a joint")?;
            if !joints[index].has_coordinate() {
                let found = format!("{name:?}, which is neither revolute nor prismatic, or locked");
                return Err(place.wrong(found, "a joint with one coordinate"));
            }
            LoadPlace::Joint(index)
        }
    };
    Ok(Load {
        name: spec.name.clone(),
        on,
    })
}
