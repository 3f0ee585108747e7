//! Conversion of path limits of a problem file to indices, bounds and regions.

use crate::control::problem::{PathConstraint, Side};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::bounds::check_bounds;
use crate::files::problem::source_limits::{amount_limit, bounds, source_limits};
use crate::files::problem::spec_limits::{
    ElectricFieldLimitSpec, LimitSpec, MarkerLimitSpec, MarkerSpeedLimitSpec,
    ReactionForceLimitSpec, ReactionTorqueLimitSpec, RegionSpec, StretchLimitSpec,
    TensionLimitSpec,
};
use crate::files::problem::spec_source_limits::All;
use crate::files::problem::state::{
    ELECTRIC_KEYS, joint_value, joint_with_coordinate, moving_marker,
};
use crate::files::scene::names::names;
use crate::files::scene::point::{unit_axis, vector};
use crate::files::units::quantity::{
    Angle, AngularVelocity, Kind, Length, PhysicalQuantity, Quantity, Velocity,
};
use crate::model::system::{Fidelity, System};
use crate::model::{Reaction, Region};

/// Keys of an entry, each with itself where it is written.
macro_rules! written {
    ($spec:ident: $($key:ident),* $(,)?) => {
        [$((stringify!($key), $spec.$key.as_ref().map(|_| stringify!($key)))),*]
    };
}

/// The limits of a list of entries.
pub(crate) fn limits(
    list: &[LimitSpec],
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let mut limits = Vec::new();
    for (index, spec) in list.iter().enumerate() {
        let scope = scope.index(index);
        let own = limit(spec, system, &scope)?.into_iter();
        match spec.part {
            None => limits.extend(own),
            Some(part) if is_timeless(spec) => {
                let expected = "no part: constants are the same at all times";
                return Err(scope.key("part").wrong(part.to_string(), expected));
            }
            Some(part) if part > 0.0 && part <= 1.0 => {
                limits.extend(own.map(|limit| limit.at_part(part)));
            }
            Some(part) => {
                let expected = "a part of the duration, above 0 and at most 1, the end";
                return Err(scope.key("part").wrong(part.to_string(), expected));
            }
        }
    }
    Ok(limits)
}

/// True if it bounds what follows from constants alone.
fn is_timeless(spec: &LimitSpec) -> bool {
    spec.muscle_volume.is_some() || spec.muscle_mass.is_some()
}

/// The limits that one entry stands for.
fn limit(
    spec: &LimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let key = scope.exactly_one(written![
        spec: joint_angle, joint_rate, stretch, tension, electric_field, marker, reaction_force, reaction_torque,
        marker_speed, current, power, voltage_rate, muscle_volume, muscle_mass,
    ])?;
    let scope = scope.key(key);
    let mut limits = source_limits(spec, system, &scope)?;
    limits.extend(amount_limit(spec, system, &scope)?);
    if let Some(spec) = &spec.joint_angle {
        let kinds = [Angle::kind(), Length::kind()];
        let bounds = [spec.min.as_ref(), spec.max.as_ref()];
        let (joint, [min, max]) = of_joint(&spec.joint, bounds, kinds, (system, &scope))?;
        limits.push(PathConstraint::JointAngle { joint, min, max });
    }
    if let Some(spec) = &spec.joint_rate {
        let kinds = [AngularVelocity::kind(), Velocity::kind()];
        let bounds = [spec.min.as_ref(), spec.max.as_ref()];
        let (joint, [min, max]) = of_joint(&spec.joint, bounds, kinds, (system, &scope))?;
        limits.push(PathConstraint::JointRate { joint, min, max });
    }
    if let Some(spec) = &spec.stretch {
        limits.push(stretch(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.tension {
        limits.extend(tensions(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.electric_field {
        limits.extend(electric_field(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.reaction_force {
        limits.push(reaction_force(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.reaction_torque {
        limits.push(reaction_torque(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.marker_speed {
        limits.push(marker_speed(spec, system, &scope)?);
    }
    if let Some(spec) = &spec.marker {
        limits.push(marker(spec, system, &scope)?);
    }
    Ok(limits)
}

/// A joint, and the bounds of its coordinate or rate, of which one at least is written.
fn of_joint<M: PhysicalQuantity>(
    joint: &str,
    [min, max]: [Option<&Quantity<M>>; 2],
    kinds: [Kind; 2],
    (system, scope): (&System, &Scope<'_>),
) -> Result<(usize, [f64; 2]), SceneError> {
    let joint = joint_with_coordinate(joint, system, &scope.key("joint"))?;
    let bound = |key: &str, quantity: Option<&Quantity<M>>, absent: f64| match quantity {
        Some(quantity) => joint_value(quantity, &kinds, joint, system, &scope.key(key)),
        None => Ok(absent),
    };
    let bounds = [
        bound("min", min, f64::NEG_INFINITY)?,
        bound("max", max, f64::INFINITY)?,
    ];
    let is_written = min.is_some() || max.is_some();
    check_bounds(bounds[0], bounds[1], is_written, scope)?;
    Ok((joint, bounds))
}

fn stretch(
    spec: &StretchLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<PathConstraint, SceneError> {
    let muscles = names(&system.muscles, |muscle| &muscle.name);
    let expected = "the name of a muscle";
    let muscle = scope.key("muscle").find(&spec.muscle, &muscles, expected)?;
    for (key, bound) in [("min", spec.min), ("max", spec.max)] {
        if let Some(bound) = bound.filter(|bound| *bound <= 0.0) {
            return Err(scope
                .key(key)
                .wrong(bound.to_string(), "a positive stretch"));
        }
    }
    let (min, max) = (spec.min.unwrap_or(0.0), spec.max.unwrap_or(f64::INFINITY));
    check_bounds(min, max, spec.min.is_some() || spec.max.is_some(), scope)?;
    Ok(PathConstraint::Stretch { muscle, min, max })
}

/// The limit of a speed; a lower bound of zero is none.
fn marker_speed(
    spec: &MarkerSpeedLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<PathConstraint, SceneError> {
    let marker = moving_marker(&spec.marker, system, &scope.key("marker"))?;
    let bound = |key: &str, bound: &Option<Quantity<Velocity>>, absent: f64| match bound {
        Some(bound) => scope.key(key).positive(bound),
        None => Ok(absent),
    };
    let (min, max) = (
        bound("min", &spec.min, 0.0)?,
        bound("max", &spec.max, f64::INFINITY)?,
    );
    check_bounds(min, max, spec.min.is_some() || spec.max.is_some(), scope)?;
    Ok(PathConstraint::MarkerSpeed { marker, min, max })
}

/// One lumped muscle, or all.
pub(super) fn lumped_muscles(
    (muscle, muscles): (&Option<String>, Option<All>),
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<usize>, SceneError> {
    const EXPECTED: &str = "a lumped muscle";
    let is_lumped = |&m: &usize| system.muscles[m].fidelity == Fidelity::Lumped;
    let one = muscle.as_ref().map(Some);
    let chosen = [("muscle", one), ("muscles", muscles.map(|_| None))];
    let muscles: Vec<usize> = match scope.exactly_one(chosen)? {
        None => (0..system.muscles.len()).filter(is_lumped).collect(),
        Some(name) => {
            let (place, names) = (scope.key("muscle"), names(&system.muscles, |m| &m.name));
            let muscle = place.find(name, &names, "the name of a muscle")?;
            if !is_lumped(&muscle) {
                let found = format!("{name:?}, a muscle of finite elements");
                return Err(place.wrong(found, EXPECTED));
            }
            vec![muscle]
        }
    };
    match muscles.is_empty() {
        true => Err(scope.key("muscles").wrong("no lumped muscle", EXPECTED)),
        false => Ok(muscles),
    }
}

fn tensions(
    spec: &TensionLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let [min, max] = bounds([&spec.min, &spec.max], scope)?;
    let muscles = lumped_muscles((&spec.muscle, spec.muscles), system, scope)?;
    let limit = |muscle| PathConstraint::Tension { muscle, min, max };
    Ok(muscles.into_iter().map(limit).collect())
}

/// Error text of a field limit without a part.
const NOTHING: &str = "nothing that a field reaches";

fn electric_field(
    spec: &ElectricFieldLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let max = scope.key("max").positive(&spec.max)?;
    let one = |name: &Option<String>| name.clone().map(Some);
    let all = |all: Option<All>| all.map(|_| None);
    let chosen = [
        ("muscle", one(&spec.muscle)),
        ("muscles", all(spec.muscles)),
        ("solid", one(&spec.solid)),
        ("solids", all(spec.solids)),
    ];
    let key = chosen.iter().find(|(_, choice)| choice.is_some());
    let key = key.map_or("", |(key, _)| key);
    let name = scope.exactly_one(chosen)?;
    let place = scope.key(key);
    if spec.region.is_some() && key != "solid" {
        let found = "a region without \"solid\"";
        return Err(scope.key("region").wrong(found, "a region of one block"));
    }
    let nothing = |expected: String| place.wrong(NOTHING, expected);
    if key.starts_with("muscle") {
        return muscle_fields(name.as_ref(), max, system, &place);
    }
    let (blocks, region) = match &name {
        None => ((0..system.solids.len()).collect(), None),
        Some(name) => {
            let names = names(&system.solids, |solid| &solid.name);
            let block = place.find(name, &names, "the name of an elastic block")?;
            let regions = &system.solids[block].mesh.region_names;
            let of = scope.key("region");
            let region = spec.region.as_ref();
            let region = region.map(|name| of.find(name, regions, "the name of a region"));
            (vec![block], region.transpose()?)
        }
    };
    let has_field = |&block: &usize| {
        let solid = &system.solids[block];
        let mut elements = solid
            .mesh
            .regions
            .iter()
            .zip(system.elements_with_field(block));
        elements.any(|(of, has_field)| has_field && region.is_none_or(|region| *of == region))
    };
    let blocks: Vec<usize> = blocks.into_iter().filter(has_field).collect();
    if blocks.is_empty() {
        let expected = format!("elements of {ELECTRIC_KEYS} between electrodes");
        return Err(nothing(expected));
    }
    let limit = |block| PathConstraint::BlockField { block, region, max };
    Ok(blocks.into_iter().map(limit).collect())
}

/// Limits of the fields of one muscle, or of all.
fn muscle_fields(
    name: Option<&String>,
    max: f64,
    system: &System,
    place: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let muscles = match name {
        Some(name) => vec![muscle_with_field(name, system, place)?],
        None => (0..system.muscles.len())
            .filter(|&muscle| system.muscles[muscle].material.electric.is_some())
            .collect(),
    };
    if muscles.is_empty() {
        let beside = match system.solids.is_empty() {
            true => "",
            false => "; the field of elastic blocks is limited by \"solid\" or \"solids\"",
        };
        let expected = format!("a muscle of {ELECTRIC_KEYS}{beside}");
        return Err(place.wrong(NOTHING, expected));
    }
    let limit = |muscle| match system.meshed_muscles().position(|m| m == muscle) {
        None => PathConstraint::ElectricField { muscle, max },
        Some(index) => PathConstraint::BlockField {
            block: system.solids.len() + index,
            region: None,
            max,
        },
    };
    Ok(muscles.into_iter().map(limit).collect())
}

/// Index of a muscle with an electric term.
fn muscle_with_field(name: &str, system: &System, scope: &Scope<'_>) -> Result<usize, SceneError> {
    let muscles = names(&system.muscles, |muscle| &muscle.name);
    let index = scope.find(name, &muscles, "the name of a muscle")?;
    if system.muscles[index].material.electric.is_some() {
        return Ok(index);
    }
    let found = format!("{name:?}, whose material has no electric term");
    Err(scope.wrong(found, format!("a muscle of {ELECTRIC_KEYS}")))
}

fn marker(
    spec: &MarkerLimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<PathConstraint, SceneError> {
    let markers = names(&system.markers, |marker| &marker.name);
    let expected = "the name of a marker";
    let marker = scope.key("marker").find(&spec.marker, &markers, expected)?;
    let (region_spec, side, key) = scope.exactly_one([
        (
            "inside",
            spec.inside
                .as_ref()
                .map(|region| (region, Side::Inside, "inside")),
        ),
        (
            "outside",
            spec.outside
                .as_ref()
                .map(|region| (region, Side::Outside, "outside")),
        ),
    ])?;
    let region = region(region_spec, &scope.key(key))?;
    Ok(PathConstraint::Marker {
        marker,
        region,
        side,
    })
}

fn region(spec: &RegionSpec, scope: &Scope<'_>) -> Result<Region, SceneError> {
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
