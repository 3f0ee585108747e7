//! Places, speeds, regions and clearances of markers in limits, costs and recordings.

use crate::control::problem::{During, Limit, QuantityCost};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::quantities::entry::{
    CostEntry, LimitEntry, Named, PlaneSpec, Recorded, bounds, check_bounds, itself, limits_of,
    square, weight,
};
use crate::files::problem::quantities::joint::written_direction;
use crate::files::problem::state::moving_marker;
use crate::files::scene::names::names;
use crate::files::scene::point::{CornersSpec, PartialPoint, Point, vector};
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{Length, Quantity as Written, Velocity};
use crate::model::system::System;
use crate::model::{Quantity, Region, What};
use schemars::JsonSchema;
use serde::Deserialize;

/// Region of a marker: exactly one of `inside` and `outside`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerLimitSpec {
    /// Name of the marker.
    pub marker: String,
    /// Region in which it stays.
    #[serde(default)]
    pub inside: Option<RegionSpec>,
    /// Region outside which it stays.
    #[serde(default)]
    pub outside: Option<RegionSpec>,
}

/// A region: exactly one of the two.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Box between two corners.
    #[serde(rename = "box", default)]
    pub cuboid: Option<CornersSpec>,
    /// Ball.
    #[serde(default)]
    pub sphere: Option<BallSpec>,
}

/// A ball.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// Centre, SI unit m.
    pub centre: Point,
    /// Radius, SI unit m.
    pub radius: Written<Length>,
}

/// Limits of the size of the mean velocity of a marker in each interval: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerSpeedLimitSpec {
    /// Name of the marker.
    pub marker: String,
    /// Lower bound, SI unit m/s.
    #[serde(default)]
    pub min: Option<Written<Velocity>>,
    /// Upper bound, SI unit m/s.
    #[serde(default)]
    pub max: Option<Written<Velocity>>,
}

/// Limits of the distance of a marker from a plane, on the side of its normal: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClearanceLimitSpec {
    /// Name of the marker.
    pub marker: String,
    /// The plane.
    pub from: PlaneSpec,
    /// Lower bound, SI unit m.
    #[serde(default)]
    pub min: Option<Written<Length>>,
    /// Upper bound, SI unit m.
    #[serde(default)]
    pub max: Option<Written<Length>>,
}

/// A marker and its path.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackMarkerSpec {
    /// Name of the marker.
    pub marker: String,
    /// The path.
    pub along: PathSpec,
    /// Weight of ∫ |x − r|² dt over the directions of the path, in mm² s; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// Coordinates as functions of time, SI unit m; one or more. Directions that are not written are free.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathSpec {
    /// Along x.
    #[serde(default)]
    pub x: Option<SignalSpec<Length>>,
    /// Along y.
    #[serde(default)]
    pub y: Option<SignalSpec<Length>>,
    /// Along z.
    #[serde(default)]
    pub z: Option<SignalSpec<Length>>,
}

/// A marker and where it is to end.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FinalMarkerSpec {
    /// Name of the marker.
    pub marker: String,
    /// The place, SI unit m; directions that are `null` are free.
    pub at: PartialPoint,
    /// Weight of |x − r|² at the final instant, in mm²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The size of the mean velocity of a marker in the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerSpeedCostSpec {
    /// Name of the marker.
    pub marker: String,
    /// Weight of the squared speed in (m/s)²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The distance of a marker from a plane, on the side of its normal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClearanceCostSpec {
    /// Name of the marker.
    pub marker: String,
    /// The plane.
    pub from: PlaneSpec,
    /// Distance that is asked for, SI unit m; 0 where not written.
    #[serde(default)]
    pub at: Option<Written<Length>>,
    /// Weight of the squared deviation in mm²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

impl LimitEntry for MarkerLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let markers = names(&system.markers, |marker| &marker.name);
        let expected = "the name of a marker";
        let marker = scope.key("marker").find(&self.marker, &markers, expected)?;
        let (inside, outside) = (self.inside.as_ref(), self.outside.as_ref());
        let (written, key, bounds) = scope.exactly_one([
            (
                "inside",
                inside.map(|region| (region, "inside", [f64::NEG_INFINITY, 1.0])),
            ),
            (
                "outside",
                outside.map(|region| (region, "outside", [1.0, f64::INFINITY])),
            ),
        ])?;
        let region = region(written, &scope.key(key))?;
        Ok(limits_of([What::Region { marker, region }], bounds))
    }
}

fn region(spec: &RegionSpec, scope: &Scope<'_>) -> Result<Region> {
    scope.exactly_one([
        ("box", spec.cuboid.as_ref().map(|_| ())),
        ("sphere", spec.sphere.as_ref().map(|_| ())),
    ])?;
    match (&spec.cuboid, &spec.sphere) {
        (None, Some(ball)) => Ok(Region::Sphere {
            centre: vector(&ball.centre),
            radius: scope.key("sphere").key("radius").positive(&ball.radius)?,
        }),
        (Some(corners), _) => {
            let (min, max) = (vector(&corners.min), vector(&corners.max));
            for index in 0..3 {
                if min[index] >= max[index] {
                    let place = scope.key("box").key("max").index(index);
                    let expected = format!("more than {} of \"min\"", corners.min[index]);
                    return Err(place.wrong(corners.max[index].to_string(), expected));
                }
            }
            Ok(Region::Box { min, max })
        }
        (None, None) => Err(scope.wrong("no region", "\"box\" or \"sphere\"")),
    }
}

impl LimitEntry for MarkerSpeedLimitSpec {
    /// A lower bound of zero is none.
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let marker = moving_marker(&self.marker, system, &scope.key("marker"))?;
        let bound = |key: &str, bound: &Option<Written<Velocity>>, absent: f64| match bound {
            Some(bound) => scope.key(key).positive(bound),
            None => Ok(absent),
        };
        let bounds = [
            bound("min", &self.min, 0.0)?,
            bound("max", &self.max, f64::INFINITY)?,
        ];
        let bounds = check_bounds(bounds, self.min.is_some() || self.max.is_some(), scope)?;
        Ok(limits_of([What::Speed(marker)], bounds))
    }
}

impl LimitEntry for ClearanceLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], scope)?;
        Ok(limits_of(
            [clearance(&self.marker, &self.from, system, scope)?],
            bounds,
        ))
    }
}

/// The distance of a marker from a plane; the scope has both.
fn clearance(marker: &str, from: &PlaneSpec, system: &System, scope: &Scope<'_>) -> Result<What> {
    let markers = names(&system.markers, |marker| &marker.name);
    let place = scope.key("marker");
    let marker = place.find(marker, &markers, "the name of a marker")?;
    let plane = from.plane(system, &scope.key("from"))?;
    Ok(What::Clearance { marker, plane })
}

impl CostEntry for ClearanceCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let at = self.at.as_ref().map_or(0.0, Written::value);
        let what = clearance(&self.marker, &self.from, system, scope)?;
        Ok(vec![square(Quantity::of(what), at, weight, during)])
    }
}

impl CostEntry for MarkerSpeedCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let marker = moving_marker(&self.marker, system, &scope.key("marker"))?;
        Ok(vec![itself(
            Quantity::squared_speed(marker),
            weight,
            during,
        )])
    }
}

impl CostEntry for TrackMarkerSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let marker = moving_marker(&self.marker, system, &scope.key("marker"))?;
        let weight = weight(self.weight, scope)?;
        let place = scope.key("along");
        let axes = [
            ("x", &self.along.x),
            ("y", &self.along.y),
            ("z", &self.along.z),
        ];
        let mut costs = Vec::new();
        for (axis, (key, along)) in axes.into_iter().enumerate() {
            if let Some(along) = along {
                let reference = signal(along, &Length::kind(), &place.key(key))?;
                let quantity = Quantity::marker_place(marker, axis);
                costs.push(square(quantity, reference, weight, during));
            }
        }
        match costs.is_empty() {
            true => Err(place.wrong("no direction", "\"x\", \"y\" or \"z\"")),
            false => Ok(costs),
        }
    }
}

impl CostEntry for FinalMarkerSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let marker = moving_marker(&self.marker, system, &scope.key("marker"))?;
        let weight = weight(self.weight, scope)?;
        let given = self.at.iter().enumerate();
        let given = given.filter_map(|(axis, at)| Some((axis, at.as_ref()?.value())));
        let cost = |(axis, at): (usize, f64)| {
            square(Quantity::marker_place(marker, axis), at, weight, during)
        };
        let costs: Vec<QuantityCost> = given.map(cost).collect();
        match costs.is_empty() {
            true => {
                let expected = "one that is not null, or more";
                Err(scope.key("at").wrong("no coordinate", expected))
            }
            false => Ok(costs),
        }
    }
}

pub(super) fn place(of: &Named<'_>) -> Result<Recorded> {
    let marker = moving_marker(of.name, of.system, of.place)?;
    let along = written_direction(of.along, &of.scope.key("along"))?;
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
    let marker = moving_marker(of.name, of.system, of.place)?;
    let Some(from) = of.from else {
        let place = of.scope.key("from");
        return Err(place.wrong(
            "no plane",
            "a plane: \"point\" and \"normal\", of a \"body\" or the ground",
        ));
    };
    let plane = from.plane(of.system, &of.scope.key("from"))?;
    let quantity = Quantity::of(What::Clearance { marker, plane });
    let unit = (Length::kind(), ("m", 1e-3));
    Ok(Recorded::named("clearance", of.name, quantity, unit))
}
