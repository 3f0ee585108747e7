//! Lines in space that move: springs, tendons and outlines of contacts, and arrows of loads.
//!
//! The arrow of a load is along the force from the point on which it acts, against a face under a pressure, or about the axis of the joint as an
//! arc, as long as the load is large relative to its largest size in the motion. Surface charges have none.

use crate::mesh::cell::flat_parts;
use crate::model::Component;
use crate::model::components::{BlockLoad, Contact, Load, LoadPlace};
use crate::model::system::{Attachment, JointKind, System};
use crate::report::Run;
use crate::report::body::extent_points;
use crate::report::skins::normal;
use crate::report::style::{self, Colour};
use crate::report::view::corners;
use nalgebra::{Rotation3, Unit, Vector3};
use std::collections::HashSet;

/// Turns of a spring.
const TURNS: usize = 8;
/// Points of a turn.
const PER_TURN: usize = 14;
/// Radius of a spring, as a part of its length in the reference configuration.
const COIL: f64 = 0.06;
/// Straight ends of a spring, as parts of its length.
const END: f64 = 0.12;

/// A line that moves.
pub(super) struct MovingLine<'a> {
    /// Name of the component or the load.
    pub(super) name: &'a str,
    pub(super) colour: Colour,
    /// Its points in mm at each of some instants.
    pub(super) places: Vec<Vec<Vector3<f64>>>,
}

/// Springs, tendons and other components at some instants.
pub(super) fn ties<'a>(run: &Run<'a>, instants: &[usize]) -> Vec<MovingLine<'a>> {
    let tie = |(component, points): (&'a dyn Component, Vec<Attachment>)| {
        let line = |&k: &usize| {
            let at = points
                .iter()
                .map(|p| run.trajectory.point(k, p, run.system));
            let at: Vec<_> = at.collect();
            match at[..] {
                [from, to] if component.is_coiled() => {
                    coil(&from, &to, COIL * (points[1].at - points[0].at).norm())
                }
                _ => at,
            }
        };
        MovingLine {
            name: component.name(),
            colour: style::TIE,
            places: instants.iter().map(line).collect(),
        }
    };
    let components = &run.system.components;
    let outlines = |one: &'a dyn Component| one.outlines().into_iter().map(move |line| (one, line));
    let contacts = &components.contacts;
    let touching = contacts.iter().flat_map(|one: &'a Contact| {
        let lines = one.drawn_among(contacts).into_iter();
        lines.map(move |line| (one as &dyn Component, line))
    });
    let lines = components.iter().flat_map(outlines).chain(touching);
    lines.map(tie).collect()
}

/// The arrows of loads that ever act at some instants, of each always as many points.
pub(super) fn arrows<'a>(run: &Run<'a>, instants: &[usize]) -> Vec<MovingLine<'a>> {
    let (system, rows) = (run.system, &run.trajectory.voltages);
    let length = LENGTH * size(system);
    let loads = system.components.loads.iter().zip(system.first_load()..);
    let line = |(load, source): (&'a Load, usize)| {
        let largest = rows.iter().map(|row| row[source].abs());
        let largest = Some(largest.fold(0.0, f64::max)).filter(|size| *size > 0.0)?;
        let arrow = LoadArrow {
            run,
            load,
            faces: faces(system, load),
            length,
        };
        let at = |&k: &usize| arrow.at(k, rows[k.min(rows.len() - 1)][source] / largest);
        Some(MovingLine {
            name: &load.name,
            colour: style::muscle(source).0,
            places: instants.iter().map(at).collect::<Option<_>>()?,
        })
    };
    loads.filter_map(line).collect()
}

/// A helix between two points, with straight ends.
fn coil(from: &Vector3<f64>, to: &Vector3<f64>, radius: f64) -> Vec<Vector3<f64>> {
    let span = to - from;
    let least = span.iamin();
    let Some(across) = span.cross(&Vector3::ith(least, 1.0)).try_normalize(0.0) else {
        return vec![*from, *to];
    };
    let other = span.normalize().cross(&across);
    let count = TURNS * PER_TURN;
    let turn = |i: usize| {
        let s = i as f64 / count as f64;
        let angle = std::f64::consts::TAU * TURNS as f64 * s;
        // The radius grows from the axis and goes back to it within half a turn.
        let grown = (2.0 * TURNS as f64 * s.min(1.0 - s)).min(1.0);
        let out = across * angle.cos() + other * angle.sin();
        from + span * (END + (1.0 - 2.0 * END) * s) + out * (radius * grown)
    };
    let turns = (0..=count).map(turn);
    [*from].into_iter().chain(turns).chain([*to]).collect()
}

/// Length of the longest arrow, as a part of the size of the system.
const LENGTH: f64 = 0.25;
/// Radius of an arc, as a part of the longest arrow.
const RADIUS: f64 = 0.5;
/// Angle in rad of the longest arc.
const ARC: f64 = 1.5 * std::f64::consts::PI;
/// Length of the head of an arrow, as a part of the longest one, and its half width as a part of that.
const HEAD: [f64; 2] = [0.22, 0.4];
/// Segments of the shaft.
const SEGMENTS: usize = 24;

/// A load, ready to be drawn at any instant.
struct LoadArrow<'a> {
    run: &'a Run<'a>,
    load: &'a Load,
    /// The faces of the surface of its block at which its arrow is.
    faces: Vec<usize>,
    /// Length of the longest arrow in mm.
    length: f64,
}

impl LoadArrow<'_> {
    /// Its arrow at an instant, in mm, for a part of its largest size in the motion; none of a load that has no arrow.
    fn at(&self, k: usize, part: f64) -> Option<Vec<Vector3<f64>>> {
        let Run {
            system, trajectory, ..
        } = *self.run;
        let place = |point: Attachment| trajectory.point(k, &point, system);
        let along = |point: Attachment, axis: &Vector3<f64>| {
            let tip = Attachment {
                at: point.at + axis,
                ..point
            };
            place(tip) - place(point)
        };
        let (at, axis, is_turn) = match &self.load.on {
            LoadPlace::Point {
                at,
                direction,
                follows,
            } => match follows {
                true => (place(*at), along(*at, direction), false),
                false => (place(*at), *direction, false),
            },
            LoadPlace::Block { block, load } => {
                let (middle, inward) = self.middle(*block, k)?;
                match load {
                    BlockLoad::Pressure { .. } => {
                        (middle - inward * (self.length * part), inward, false)
                    }
                    BlockLoad::Traction(_, axis) | BlockLoad::BodyForce(axis) => {
                        (middle, *axis, false)
                    }
                    BlockLoad::Charge(_) => return None,
                }
            }
            LoadPlace::Muscle(_) => return None,
            LoadPlace::Joint(joint) => {
                let joint = &system.joints[*joint];
                let on = |at| Attachment {
                    body: Some(joint.child),
                    at,
                };
                let at = place(on(joint.at));
                match &joint.kind {
                    JointKind::Revolute { axis } => (at, along(on(joint.at), axis), true),
                    JointKind::Prismatic { axis } => (at, along(on(joint.at), axis), false),
                    _ => (at, Vector3::zeros(), false),
                }
            }
        };
        let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        let shaft = |s: f64| match is_turn {
            false => at + axis * (self.length * part * s),
            true => {
                let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), ARC * part * s);
                at + turn * across * (RADIUS * self.length)
            }
        };
        let side = if is_turn { axis } else { across };
        Some(with_head(shaft, &side, self.length * part.abs()))
    }

    /// The middle of its faces of a block at an instant, and the unit vector against their mean normal; none where the block is not drawn.
    fn middle(&self, block: usize, k: usize) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let skin = self.run.skins.list.get(block)?;
        let places = &skin.places[self.run.skins.position(k)];
        let corners = self
            .faces
            .iter()
            .map(|&face| skin.quads[face].map(|corner| places[corner]));
        let (mut middle, mut inward) = (Vector3::zeros(), Vector3::zeros());
        for corners in corners {
            middle += corners.iter().sum::<Vector3<f64>>() / (4 * self.faces.len()) as f64;
            inward -= normal(&corners);
        }
        let inward = inward.try_normalize(0.0).unwrap_or_else(Vector3::x);
        Some((middle, inward))
    }
}

/// Numbers among the faces of the surface of its block of those at which the arrow of a load is: the one nearest to the middle of those on
/// which it acts; of a body force all.
fn faces(system: &System, load: &Load) -> Vec<usize> {
    let LoadPlace::Block { block, load } = &load.on else {
        return Vec::new();
    };
    let mesh = &system.solids[*block].mesh;
    let surface = mesh.boundary_quads();
    let centre = |face: &[usize; 4]| {
        face.map(|node| mesh.nodes[node])
            .iter()
            .sum::<Vector3<f64>>()
            / 4.0
    };
    let of_load: HashSet<[usize; 4]> = load
        .faces()
        .iter()
        .flat_map(|face| flat_parts(face))
        .collect();
    let acts = |(_, face): &(usize, &[usize; 4])| of_load.contains(*face);
    let middle = of_load.iter().map(centre).sum::<Vector3<f64>>() / of_load.len() as f64;
    let away = |face: &[usize; 4]| (centre(face) - middle).norm();
    let acting = surface.iter().enumerate().filter(acts);
    let nearest = acting.min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)));
    nearest.map_or((0..surface.len()).collect(), |(number, _)| vec![number])
}

/// Points of a shaft from s = 0 to 1, then of the four barbs of its head, two of them along a side.
fn with_head(
    shaft: impl Fn(f64) -> Vector3<f64>,
    side: &Vector3<f64>,
    length: f64,
) -> Vec<Vector3<f64>> {
    let at = |i: usize| shaft(i as f64 / SEGMENTS as f64);
    let mut points: Vec<_> = (0..=SEGMENTS).map(at).collect();
    let tip = points[SEGMENTS];
    let along = tip - points[SEGMENTS - 1];
    let along = along.try_normalize(0.0).unwrap_or_default();
    let other = along.cross(side);
    let back = HEAD[0] * length;
    for out in [*side, -side, other, -other] {
        points.push(tip - along * back + out * (HEAD[1] * back));
        points.push(tip);
    }
    points
}

/// Diagonal in mm of the box around the bodies, blocks, joints and loads in the reference configuration; 1 where it is a point.
fn size(system: &System) -> f64 {
    let bodies = system.bodies.iter();
    let bodies = bodies.flat_map(|body| extent_points(&body.shape, &body.pose()));
    let joints = system.joints.iter().map(|joint| joint.at);
    let loads = system.components.loads.iter();
    let loads = loads.filter_map(|load| match load.on {
        LoadPlace::Point { at, .. } => Some(at.at),
        LoadPlace::Joint(_) | LoadPlace::Muscle(_) | LoadPlace::Block { .. } => None,
    });
    let nodes = system
        .solids
        .iter()
        .flat_map(|solid| solid.mesh.nodes.iter().copied());
    match corners(bodies.chain(joints).chain(loads).chain(nodes)) {
        Some([low, high]) if low != high => (high - low).norm(),
        _ => 1.0,
    }
}
