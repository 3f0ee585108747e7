//! Waypoints as they are written, and their conversion.

use crate::control::problem::{Duration, QuantityCost, Waypoint};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::At;
use crate::files::problem::goal::{of_bodies, of_markers};
use crate::files::problem::state::OrientationSpec;
use crate::files::scene::point::PartialPoint;
use crate::files::units::quantity::{JointCoordinate, Quantity, Time};
use crate::math::shortest;
use std::collections::BTreeMap;

read_objects! {
    /// Places that the motion reaches at a time on its way, at the instant nearest to it: `markers`, `orientations`, `joint_angles`, or several
    /// of them. With a `weight` it passes near them: their squared distances are costs.
    pub struct WaypointSpec {
        /// Time, SI unit s; or give `part`.
        pub time: Option<Quantity<Time>>,
        /// Part of the duration, above 0 and below 1, which may be free; of a periodic motion 1 is its start and its end.
        pub part: Option<f64>,
        /// Positions by marker, SI unit m; directions that are `null` are free.
        pub markers: Option<BTreeMap<String, PartialPoint>>,
        /// Orientations by body.
        pub orientations: Option<BTreeMap<String, OrientationSpec>>,
        /// Joint coordinates by joint, SI unit rad or m.
        pub joint_angles: Option<BTreeMap<String, Quantity<JointCoordinate>>>,
        /// Weight of the squared distances at that instant, in mm² of markers and prismatic joints and rad² of revolute ones, as costs in the
        /// objective in place of exact conditions; not of `orientations`.
        pub weight: Option<f64>,
    }
}

/// The motion that waypoints are on the way of.
#[derive(Clone, Copy)]
pub(crate) struct Course {
    pub(crate) duration: Duration,
    pub(crate) is_periodic: bool,
}

/// The waypoints that are written: those that are conditions, and the costs that others are.
pub(crate) fn waypoints(
    specs: &[WaypointSpec],
    of: Course,
    at: &At<'_>,
) -> Result<(Vec<Waypoint>, Vec<QuantityCost>)> {
    let (mut exact, mut near) = (Vec::new(), Vec::new());
    for (index, spec) in specs.iter().enumerate() {
        let at = at.index(index);
        let waypoint = spec.waypoint(of, &at)?;
        match spec.weight {
            None => exact.push(waypoint),
            Some(_) if spec.orientations.is_some() => {
                let found = "an orientation with a weight";
                let expected = "an orientation without \"weight\", which is reached exactly";
                return Err(at.key("orientations").wrong(found, expected));
            }
            Some(weight) if weight > 0.0 => near.extend(waypoint.costs(weight)),
            Some(weight) => {
                let place = at.key("weight");
                return Err(place.wrong(weight.to_string(), "a positive weight"));
            }
        }
    }
    Ok((exact, near))
}

impl WaypointSpec {
    fn waypoint(&self, of: Course, at: &At<'_>) -> Result<Waypoint> {
        let (part, name) = self.part_of(of, at)?;
        let waypoint = Waypoint {
            part,
            name,
            places: of_markers(&self.markers, &at.key("markers"))?,
            orientations: of_bodies(&self.orientations, &at.key("orientations"))?,
            angles: at.key("joint_angles").by_joint(&self.joint_angles)?,
        };
        let is_empty = waypoint.places.is_empty()
            && waypoint.orientations.is_empty()
            && waypoint.angles.is_empty();
        refuse!(if is_empty, at;
            found "a waypoint without a place",
            expected "\"markers\", \"orientations\" or \"joint_angles\"");
        Ok(waypoint)
    }

    /// Part of the duration, and the name in messages.
    fn part_of(&self, of: Course, at: &Scope<'_>) -> Result<(f64, String)> {
        let key = at.one_key([("time", self.time.is_some()), ("part", self.part.is_some())])?;
        let (part, name, found, expected) = match (&self.time, of.duration) {
            (Some(time), Duration::Given(duration)) => (
                time.value() / duration,
                format!("waypoint at {time}"),
                time.to_string(),
                "a time after the start and before the end; what is reached at the end is the \"goal\"",
            ),
            (Some(_), Duration::Free { .. }) => {
                let expected = "\"part\", a part of the duration, as the duration is free";
                return Err(at.key(key).wrong("a time", expected));
            }
            (None, _) => {
                let part = self.part.unwrap_or_default();
                let name = format!("waypoint at {} of the duration", shortest(part, 6));
                let expected = match of.is_periodic {
                    true => "a number above 0 and at most 1",
                    false => "a number above 0 and below 1",
                };
                (part, name, part.to_string(), expected)
            }
        };
        // The end of a periodic motion is its start.
        match part > 0.0 && (part < 1.0 || (of.is_periodic && part == 1.0)) {
            true => Ok((part, name)),
            false => Err(at.key(key).wrong(found, expected)),
        }
    }
}
