//! Waypoints as they are written, and their conversion.

use crate::control::problem::{Duration, Waypoint};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::goal::places;
use crate::files::problem::spec_states::OrientationSpec;
use crate::files::problem::state::by_joint;
use crate::files::scene::point::PartialPoint;
use crate::files::units::quantity::{Angle, JointCoordinate, Length, Quantity, Time};
use crate::math::shortest;
use crate::model::system::System;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Places that the motion reaches at a time on its way, at the instant nearest to it: `markers`, `orientations`, `joint_angles`, or several
/// of them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WaypointSpec {
    /// Time, SI unit s; or give `part`.
    #[serde(default)]
    pub time: Option<Quantity<Time>>,
    /// Part of the duration, above 0 and below 1, which may be free.
    #[serde(default)]
    pub part: Option<f64>,
    /// Positions by marker, SI unit m; directions that are `null` are free.
    #[serde(default)]
    pub markers: Option<BTreeMap<String, PartialPoint>>,
    /// Orientations by body.
    #[serde(default)]
    pub orientations: Option<BTreeMap<String, OrientationSpec>>,
    /// Joint coordinates by joint, SI unit rad or m.
    #[serde(default)]
    pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
}

/// The waypoints that are written.
pub(crate) fn waypoints(
    specs: &[WaypointSpec],
    duration: Duration,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Waypoint>, SceneError> {
    let each = specs.iter().enumerate();
    each.map(|(index, spec)| spec.waypoint(duration, system, &scope.index(index)))
        .collect()
}

impl WaypointSpec {
    fn waypoint(
        &self,
        duration: Duration,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Waypoint, SceneError> {
        let (part, name) = self.part_of(duration, scope)?;
        let written = (self.markers.as_ref(), self.orientations.as_ref());
        let (places, orientations) = places(written, system, scope)?;
        let kinds = [Angle::kind(), Length::kind()];
        let waypoint = Waypoint {
            part,
            name,
            places,
            orientations,
            angles: by_joint(
                &self.joint_angles,
                &kinds,
                system,
                &scope.key("joint_angles"),
            )?,
        };
        let is_empty = waypoint.places.is_empty()
            && waypoint.orientations.is_empty()
            && waypoint.angles.is_empty();
        match is_empty {
            true => Err(scope.wrong(
                "a waypoint without a place",
                "\"markers\", \"orientations\" or \"joint_angles\"",
            )),
            false => Ok(waypoint),
        }
    }

    /// Part of the duration, and the name in messages.
    fn part_of(&self, duration: Duration, scope: &Scope<'_>) -> Result<(f64, String), SceneError> {
        let key = scope.exactly_one([
            ("time", self.time.as_ref().map(|_| "time")),
            ("part", self.part.map(|_| "part")),
        ])?;
        let (part, name, found, expected) = match (&self.time, duration) {
            (Some(time), Duration::Given(duration)) => (
                time.value() / duration,
                format!("waypoint at {time}"),
                time.to_string(),
                "a time after the start and before the end; what is reached at the end is the \"goal\"",
            ),
            (Some(_), Duration::Free { .. }) => {
                let expected = "\"part\", a part of the duration, as the duration is free";
                return Err(scope.key(key).wrong("a time", expected));
            }
            (None, _) => {
                let part = self.part.unwrap_or_default();
                let name = format!("waypoint at {} of the duration", shortest(part, 6));
                (part, name, part.to_string(), "a number above 0 and below 1")
            }
        };
        match part > 0.0 && part < 1.0 {
            true => Ok((part, name)),
            false => Err(scope.key(key).wrong(found, expected)),
        }
    }
}
