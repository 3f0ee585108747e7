//! Places, speeds, regions and clearances of markers in limits, costs and recordings; gaps and forces of contacts in limits.

use crate::control::problem::{CostFunction, Limit};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse, the_one};
use crate::files::problem::at::At;
use crate::files::problem::quantities::entry::{
    Cost, CostEntry, LimitEntry, Named, PlaneSpec, Recorded, bounds, bounds_by, costs, limits,
    limits_of, square,
};
use crate::files::problem::quantities::joint::written_direction;
use crate::files::scene::point::{CornersSpec, PartialPoint, Point, vector};
use crate::files::signal::{SignalSpec, signal};
use crate::files::units::quantity::{Force, Length, Quantity as Written, Velocity};
use crate::model::{Quantity, Region, What};

read_objects! {
    /// Region of a marker: exactly one of `inside` and `outside`.
    pub struct MarkerLimitSpec {
        /// Name of the marker.
        pub marker: String,
        /// Region in which it stays.
        pub inside: Option<RegionSpec>,
        /// Region outside which it stays.
        pub outside: Option<RegionSpec>,
    }

    /// A region: exactly one of the two.
    pub struct RegionSpec {
        /// Box between two corners.
        #[serde(rename = "box")]
        pub cuboid: Option<CornersSpec>,
        /// Ball.
        pub sphere: Option<BallSpec>,
    }

    /// A ball.
    pub struct BallSpec {
        /// Centre, SI unit m.
        pub centre: Point,
        /// Radius, SI unit m.
        pub radius: Written<Length>,
    }

    /// Coordinates as functions of time, SI unit m; one or more. Directions that are not written are free.
    pub struct PathSpec {
        /// Along x.
        pub x: Option<SignalSpec<Length>>,
        /// Along y.
        pub y: Option<SignalSpec<Length>>,
        /// Along z.
        pub z: Option<SignalSpec<Length>>,
    }
}

limits! {
    /// Limits of the size of the mean velocity of a marker in each interval: `min`, `max` or both.
    MarkerSpeedLimitSpec {
        /// Name of the marker.
        pub marker: String,
    } within Written<Velocity>, ", SI unit m/s" => |of, at| {
        let marker = at.key("marker").moving_marker(&of.marker)?;
        let [min, max] = bounds_by([&of.min, &of.max], at, |at, speed| at.positive(speed))?;
        // A lower bound of zero is none.
        limits_of([What::Speed(marker)], [min.max(0.0), max])
    };

    /// Limits of the distance of a marker from a plane, on the side of its normal: `min`, `max` or both.
    ClearanceLimitSpec {
        /// Name of the marker.
        pub marker: String,
        /// The plane.
        pub from: PlaneSpec,
    } within Written<Length>, ", SI unit m" => |of, at| {
        let bounds = bounds([&of.min, &of.max], at)?;
        limits_of([clearance(&of.marker, &of.from, at)?], bounds)
    };

    /// Limits of the gap of a contact, negative where both sides overlap: `min`, `max` or both. With a `min` of zero they do not touch.
    GapLimitSpec {
        /// Name of the contact.
        pub contact: String,
    } within Written<Length>, ", SI unit m" => |of, at| {
        let contact = at.key("contact").contact(&of.contact)?;
        limits_of([What::Gap(contact)], bounds([&of.min, &of.max], at)?)
    };

    /// Limits of the normal force of a contact in the middle of every interval, as in its column: `min`, `max` or both.
    ContactForceLimitSpec {
        /// Name of the contact.
        pub contact: String,
    } within Written<Force>, ", SI unit N" => |of, at| {
        let contact = at.key("contact").contact(&of.contact)?;
        limits_of([What::ContactForce(contact)], bounds([&of.min, &of.max], at)?)
    };
}

costs! {
    /// A marker and its path.
    TrackMarkerSpec {
        /// Name of the marker.
        pub marker: String,
        /// The path.
        pub along: PathSpec,
    } weight of "∫ |x − r|² dt over the directions of the path, in mm² s" => |of, at| {
        let marker = at.key("marker").moving_marker(&of.marker)?;
        let place = at.key("along");
        let PathSpec { x, y, z } = &of.along;
        let mut costs = Vec::new();
        for (axis, (key, along)) in [("x", x), ("y", y), ("z", z)].into_iter().enumerate() {
            if let Some(along) = along {
                let reference = signal(along, &Length::kind(), &place.key(key))?;
                costs.push(square(Quantity::marker_place(marker, axis), reference));
            }
        }
        refuse!(if costs.is_empty(), place; found "no direction", expected "\"x\", \"y\" or \"z\"");
        costs
    };

    /// A marker and where it is to end.
    FinalMarkerSpec {
        /// Name of the marker.
        pub marker: String,
        /// The place, SI unit m; directions that are `null` are free.
        pub at: PartialPoint,
    } weight of "|x − r|² at the final instant, in mm²" => |of, at| {
        let marker = at.key("marker").moving_marker(&of.marker)?;
        let given = of.at.iter().enumerate();
        let cost = |(axis, place): (usize, &Option<Written<Length>>)| {
            let quantity = Quantity::marker_place(marker, axis);
            Some(square(quantity, place.as_ref()?.value()))
        };
        let costs: Vec<Cost> = given.filter_map(cost).collect();
        refuse!(if costs.is_empty(), at.key("at");
            found "no coordinate", expected "one that is not null, or more");
        costs
    };

    /// The size of the mean velocity of a marker in the intervals.
    MarkerSpeedCostSpec {
        /// Name of the marker.
        pub marker: String,
    } weight of "the squared speed in (m/s)²" => |of, at| {
        let marker = at.key("marker").moving_marker(&of.marker)?;
        vec![(Quantity::squared_speed(marker), CostFunction::Itself)]
    };

    /// The distance of a marker from a plane, on the side of its normal.
    ClearanceCostSpec {
        /// Name of the marker.
        pub marker: String,
        /// The plane.
        pub from: PlaneSpec,
        /// Distance that is asked for, SI unit m; 0 where not written.
        pub at: Option<Written<Length>>,
    } weight of "the squared deviation in mm²" => |of, at| {
        let distance = of.at.as_ref().map_or(0.0, Written::value);
        let what = clearance(&of.marker, &of.from, at)?;
        vec![square(Quantity::of(what), distance)]
    };
}

impl LimitEntry for MarkerLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let marker = at.key("marker").marker(&self.marker)?;
        let (region, bounds) = the_one!(at, self;
            "inside" inside |at, of| (region(of, at)?, [f64::NEG_INFINITY, 1.0]);
            "outside" outside |at, of| (region(of, at)?, [1.0, f64::INFINITY]);
        );
        Ok(limits_of([What::Region { marker, region }], bounds))
    }
}

fn region(spec: &RegionSpec, at: &At<'_>) -> Result<Region> {
    the_one!(at, spec;
        "box" cuboid |at, corners| {
            let (min, max) = (vector(&corners.min), vector(&corners.max));
            for index in 0..3 {
                refuse!(if min[index] >= max[index], at.key("max").index(index);
                    found corners.max[index],
                    expected format!("more than {} of \"min\"", corners.min[index]));
            }
            Ok(Region::Box { min, max })
        };
        "sphere" sphere |at, ball| Ok(Region::Sphere {
            centre: vector(&ball.centre),
            radius: at.key("radius").positive(&ball.radius)?,
        });
    )
}

/// The distance of a marker from a plane.
fn clearance(marker: &str, from: &PlaneSpec, at: &At<'_>) -> Result<What> {
    let marker = at.key("marker").marker(marker)?;
    let plane = from.plane(&at.key("from"))?;
    Ok(What::Clearance { marker, plane })
}

pub(super) fn place(of: &Named<'_>) -> Result<Recorded> {
    let marker = of.place.moving_marker(of.name)?;
    let along = written_direction(of.along, &of.at.key("along"))?;
    let part = |(axis, a): (usize, &f64)| (*a, Quantity::marker_place(marker, axis));
    let along = along.iter().enumerate().filter(|(_, a)| **a != 0.0);
    Ok(Recorded {
        of: of.name.to_owned(),
        name: of.name.to_owned(),
        parts: along.map(part).collect(),
        kind: Length::kind(),
    })
}

pub(super) fn distance(of: &Named<'_>) -> Result<Recorded> {
    let marker = of.place.moving_marker(of.name)?;
    let place = of.at.key("from");
    let missing = || {
        let expected = "a plane: \"point\" and \"normal\", of a \"body\" or the ground";
        place.wrong("no plane", expected)
    };
    let plane = of.from.ok_or_else(missing)?.plane(&place)?;
    let quantity = Quantity::of(What::Clearance { marker, plane });
    Ok(of.recorded("clearance", quantity, Length::kind()))
}
