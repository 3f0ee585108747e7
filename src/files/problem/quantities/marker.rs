//! Places, speeds, regions and clearances of markers in limits, costs and recordings.

use crate::control::problem::{CostFunction, Limit};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse, the_one};
use crate::files::problem::at::At;
use crate::files::problem::quantities::entry::{
    Cost, CostEntry, LimitEntry, Named, PlaneSpec, Recorded, bounds, bounds_by, limits_of, square,
};
use crate::files::problem::quantities::joint::written_direction;
use crate::files::scene::point::{CornersSpec, PartialPoint, Point, vector};
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{Length, Quantity as Written, Velocity};
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

    /// Limits of the size of the mean velocity of a marker in each interval: `min`, `max` or both.
    pub struct MarkerSpeedLimitSpec {
        /// Name of the marker.
        pub marker: String,
        /// Lower bound, SI unit m/s.
        pub min: Option<Written<Velocity>>,
        /// Upper bound, SI unit m/s.
        pub max: Option<Written<Velocity>>,
    }

    /// Limits of the distance of a marker from a plane, on the side of its normal: `min`, `max` or both.
    pub struct ClearanceLimitSpec {
        /// Name of the marker.
        pub marker: String,
        /// The plane.
        pub from: PlaneSpec,
        /// Lower bound, SI unit m.
        pub min: Option<Written<Length>>,
        /// Upper bound, SI unit m.
        pub max: Option<Written<Length>>,
    }

    /// A marker and its path.
    pub struct TrackMarkerSpec {
        /// Name of the marker.
        pub marker: String,
        /// The path.
        pub along: PathSpec,
        /// Weight of ∫ |x − r|² dt over the directions of the path, in mm² s; 1 where not written.
        pub weight: Option<f64>,
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

    /// A marker and where it is to end.
    pub struct FinalMarkerSpec {
        /// Name of the marker.
        pub marker: String,
        /// The place, SI unit m; directions that are `null` are free.
        pub at: PartialPoint,
        /// Weight of |x − r|² at the final instant, in mm²; 1 where not written.
        pub weight: Option<f64>,
    }

    /// The size of the mean velocity of a marker in the intervals.
    pub struct MarkerSpeedCostSpec {
        /// Name of the marker.
        pub marker: String,
        /// Weight of the squared speed in (m/s)²; 1 where not written.
        pub weight: Option<f64>,
    }

    /// The distance of a marker from a plane, on the side of its normal.
    pub struct ClearanceCostSpec {
        /// Name of the marker.
        pub marker: String,
        /// The plane.
        pub from: PlaneSpec,
        /// Distance that is asked for, SI unit m; 0 where not written.
        pub at: Option<Written<Length>>,
        /// Weight of the squared deviation in mm²; 1 where not written.
        pub weight: Option<f64>,
    }
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

impl LimitEntry for MarkerSpeedLimitSpec {
    /// A lower bound of zero is none.
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let marker = at.key("marker").moving_marker(&self.marker)?;
        let [min, max] = bounds_by([&self.min, &self.max], at, |at, speed| at.positive(speed))?;
        Ok(limits_of([What::Speed(marker)], [min.max(0.0), max]))
    }
}

impl LimitEntry for ClearanceLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], at)?;
        Ok(limits_of(
            [clearance(&self.marker, &self.from, at)?],
            bounds,
        ))
    }
}

/// The distance of a marker from a plane.
fn clearance(marker: &str, from: &PlaneSpec, at: &At<'_>) -> Result<What> {
    let marker = at.key("marker").marker(marker)?;
    let plane = from.plane(&at.key("from"))?;
    Ok(What::Clearance { marker, plane })
}

impl CostEntry for ClearanceCostSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let distance = self.at.as_ref().map_or(0.0, Written::value);
        let what = clearance(&self.marker, &self.from, at)?;
        Ok(vec![square(Quantity::of(what), distance)])
    }
}

impl CostEntry for MarkerSpeedCostSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let marker = at.key("marker").moving_marker(&self.marker)?;
        let speed = Quantity::squared_speed(marker);
        Ok(vec![(speed, CostFunction::Itself)])
    }
}

impl CostEntry for TrackMarkerSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let marker = at.key("marker").moving_marker(&self.marker)?;
        let place = at.key("along");
        let PathSpec { x, y, z } = &self.along;
        let mut costs = Vec::new();
        for (axis, (key, along)) in [("x", x), ("y", y), ("z", z)].into_iter().enumerate() {
            if let Some(along) = along {
                let reference = signal(along, &Length::kind(), &place.key(key))?;
                costs.push(square(Quantity::marker_place(marker, axis), reference));
            }
        }
        refuse!(if costs.is_empty(), place; found "no direction", expected "\"x\", \"y\" or \"z\"");
        Ok(costs)
    }
}

impl CostEntry for FinalMarkerSpec {
    fn costs(&self, at: &At<'_>) -> Result<Vec<Cost>> {
        let marker = at.key("marker").moving_marker(&self.marker)?;
        let given = self.at.iter().enumerate();
        let cost = |(axis, place): (usize, &Option<Written<Length>>)| {
            let quantity = Quantity::marker_place(marker, axis);
            Some(square(quantity, place.as_ref()?.value()))
        };
        let costs: Vec<Cost> = given.filter_map(cost).collect();
        refuse!(if costs.is_empty(), at.key("at");
            found "no coordinate", expected "one that is not null, or more");
        Ok(costs)
    }
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
        unit: ("m", 1e-3),
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
    Ok(of.recorded("clearance", quantity, (Length::kind(), ("m", 1e-3))))
}
