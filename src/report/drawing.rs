//! The system in space at an instant on a sheet: bodies as glass around muscles, joints and elastic blocks; and what frames it.

use crate::dynamics::trajectory::Trajectory;
use crate::mesh::triangulated::circle;
use crate::model::system::{Attachment, Fidelity, Joint, System};
use crate::report::Run;
use crate::report::body::{Tint, draw_back, draw_front, extent_points};
use crate::report::canvas::{Canvas, CanvasPoint, Stroke};
use crate::report::moving_lines::{MovingLine, arrows, ties};
use crate::report::skins::{Paint, Skin, draw_skin, shown};
use crate::report::solids::{Prism, slice};
use crate::report::style::{self, Colour};
use crate::report::view::View;
use crate::report::viewpoint::upright;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Lines across a muscle that hint at its layers.
const LAYERS: usize = 12;

/// Muscles of one stretch, which are drawn as prisms; the others have surfaces.
pub(super) fn lumped(system: &System) -> impl Iterator<Item = usize> + '_ {
    let muscles = system.muscles.iter().enumerate();
    muscles.filter_map(|(i, m)| (m.fidelity == Fidelity::Lumped).then_some(i))
}

/// Part that is drawn between the walls of the bodies.
enum Inside<'a> {
    Muscle(usize, Prism),
    Skin(&'a Skin, usize),
}

impl Inside<'_> {
    fn centre(&self) -> Vector3<f64> {
        match self {
            Self::Muscle(_, prism) => prism.centre,
            Self::Skin(skin, at) => {
                let places = &skin.places[*at];
                places.iter().sum::<Vector3<f64>>() / places.len() as f64
            }
        }
    }
}

/// Parts that are drawn, and their view and colours.
pub(super) struct Drawing<'a> {
    pub(super) run: Run<'a>,
    pub(super) view: View,
    /// Voltages in V that colour the muscles.
    pub(super) voltages: Vec<f64>,
    /// Full scale of the colours in V.
    pub(super) scale: f64,
}

impl Drawing<'_> {
    /// The plate of the ground.
    pub(super) fn ground(&self, canvas: &Canvas<'_>) {
        let places = self.view.places(&ground_plate(self.run.system));
        let thickness = 4.0;
        let lower: Vec<CanvasPoint> = places.iter().map(|p| [p[0], p[1] + thickness]).collect();
        canvas.fill(&lower, style::REFERENCE.mix(style::INK, 0.25), 1.0);
        canvas.fill(&places, style::GRID, 1.0);
        canvas.outline(&places, Stroke::solid(style::REFERENCE, 0.6));
    }

    /// Bodies as glass around muscles and joints, far parts first.
    pub(super) fn instant(&self, canvas: &Canvas<'_>, k: usize, tint: Tint) {
        let view = &self.view;
        let Run {
            system,
            trajectory,
            skins,
            ..
        } = self.run;
        let poses = &trajectory.poses[k];
        let mut bodies: Vec<_> = system.bodies.iter().zip(poses).collect();
        bodies.sort_by(|(_, a), (_, b)| view.depth(&a.centre).total_cmp(&view.depth(&b.centre)));
        for (body, pose) in &bodies {
            draw_back(canvas, view, &body.shape, pose, tint);
        }
        let prisms = lumped(system);
        let prisms = prisms.map(|i| Inside::Muscle(i, Prism::muscle(system, trajectory, k, i)));
        let position = skins.position(k);
        let skins = skins.list.iter();
        let skins = skins.map(|skin| Inside::Skin(skin, position));
        let mut inside: Vec<_> = prisms
            .chain(skins)
            .map(|inside| (inside.centre(), inside))
            .collect();
        inside.sort_by(|(a, _), (b, _)| view.depth(a).total_cmp(&view.depth(b)));
        let axis_depth = |centre: &Vector3<f64>| {
            let near = self.joint_places(k).into_iter().min_by(|a, b| {
                let distance = |p: &Vector3<f64>| (p - centre).norm();
                distance(a).total_cmp(&distance(b))
            });
            near.map_or(f64::NEG_INFINITY, |joint| view.depth(&joint))
        };
        let (behind, before): (Vec<_>, Vec<_>) = inside
            .into_iter()
            .partition(|(centre, _)| view.depth(centre) < axis_depth(centre));
        let draw = |inside: &Inside<'_>| match inside {
            Inside::Muscle(i, prism) => self.muscle(canvas, prism, self.colour(*i, tint)),
            Inside::Skin(skin, at) => self.skin(canvas, skin, *at, tint),
        };
        behind.iter().for_each(|(_, inside)| draw(inside));
        self.joints(canvas, k, tint);
        self.lines(canvas, &ties(&self.run, &[k]), 1.0, tint);
        before.iter().for_each(|(_, inside)| draw(inside));
        for (body, pose) in &bodies {
            draw_front(canvas, view, &body.shape, pose, tint);
        }
        self.lines(canvas, &arrows(&self.run, &[k]), 1.4, tint);
    }

    /// Colour of a muscle by its voltage.
    fn colour(&self, muscle: usize, tint: Tint) -> Colour {
        match tint {
            Tint::Reference => style::GRID,
            Tint::Coloured => style::voltage(self.voltages[muscle].abs() / self.scale),
        }
    }

    /// The surfaces of blocks in the reference configuration.
    pub(super) fn reference_skins(&self, canvas: &Canvas<'_>) {
        for skin in &self.run.skins.list {
            draw_skin(canvas, &self.view, skin, &skin.reference, Paint::Reference);
        }
    }

    /// The surface of a block at one of the instants shown, coloured by its potentials, of a muscle by its voltage.
    fn skin(&self, canvas: &Canvas<'_>, skin: &Skin, at: usize, tint: Tint) {
        let paint = match (skin.muscle, skin.potentials.get(at)) {
            (_, _) if tint == Tint::Reference => Paint::Reference,
            (Some(muscle), _) => Paint::Even(self.colour(muscle, tint)),
            (None, Some(potentials)) if skin.is_charged => Paint::Potential {
                potentials,
                scale: self.scale,
            },
            _ => Paint::Even(style::PASSIVE),
        };
        draw_skin(canvas, &self.view, skin, &skin.places[at], paint);
    }

    /// The faces that look at the viewer, lit from the upper left, with lines that hint at the layers.
    fn muscle(&self, canvas: &Canvas<'_>, prism: &Prism, colour: Colour) {
        let view = &self.view;
        let light = (view.toward + view.up * 0.9 - view.right * 0.7).normalize();
        let edge = colour.mix(style::INK, 0.35);
        for face in prism.faces() {
            let normal = face.normal.normalize();
            if normal.dot(&view.toward) <= 0.0 {
                continue;
            }
            let shade = 0.34 * (1.0 - normal.dot(&light).max(0.0));
            let places = view.places(&face.corners);
            canvas.fill(&places, colour.mix(style::INK, shade), 1.0);
            let is_side = normal.dot(&prism.halves[2]).abs() < 0.5 * prism.halves[2].norm();
            if is_side {
                for layer in 1..LAYERS {
                    let height = 2.0 * layer as f64 / LAYERS as f64 - 1.0;
                    let across = slice(&face.corners, &prism.halves[2], prism.centre, height);
                    let line = Stroke::solid(edge, 0.35).faint(0.55);
                    canvas.line(&view.places(&across), line);
                }
            }
            canvas.outline(&places, Stroke::solid(edge, 0.5));
        }
    }

    fn joint_places(&self, k: usize) -> Vec<Vector3<f64>> {
        let reference = |j: &Joint| Attachment {
            body: Some(j.child),
            at: j.at,
        };
        let Run {
            system, trajectory, ..
        } = self.run;
        let joints = system.joints.iter();
        joints
            .map(|j| trajectory.point(k, &reference(j), system))
            .collect()
    }

    /// A line through the joints of each body, and a disc at each joint.
    fn joints(&self, canvas: &Canvas<'_>, k: usize, tint: Tint) {
        let ink = Stroke::solid(tint.ink(style::INK.mix(style::PAPER, 0.25)), 1.1);
        let places = self.view.places(&self.joint_places(k));
        for (joint, place) in self.run.system.joints.iter().zip(&places) {
            for body in [Some(joint.child), joint.parent].into_iter().flatten() {
                let centre = self.run.trajectory.poses[k][body].centre;
                canvas.line(&[*place, self.view.place(&centre)], ink);
            }
        }
        for place in places {
            canvas.disc(place, 2.6, style::PAPER, ink);
        }
    }

    /// Springs, tendons and other components, or arrows of loads, at one instant.
    fn lines(&self, canvas: &Canvas<'_>, lines: &[MovingLine<'_>], width: f64, tint: Tint) {
        for line in lines {
            let stroke = Stroke::solid(tint.ink(line.colour), width);
            canvas.line(&self.view.places(&line.places[0]), stroke);
        }
    }

    /// The path of each marker, with its beginning and end.
    pub(super) fn paths(&self, canvas: &Canvas<'_>, paths: &[Vec<Vector3<f64>>]) {
        for (marker, path) in paths.iter().enumerate() {
            let ink = marker_colour(marker, paths.len());
            let rim = Stroke::solid(ink, 1.1);
            let places = self.view.places(path);
            canvas.line(&places, rim);
            if let [first, _, ..] = places[..] {
                canvas.disc(first, 2.8, style::PAPER, rim);
            }
            if let [.., last] = places[..] {
                canvas.disc(last, 2.4, ink, rim);
            }
        }
    }
}

/// Colour of a marker among a number of them.
pub(super) fn marker_colour(marker: usize, count: usize) -> Colour {
    match count {
        1 => style::INK,
        _ => style::hue(marker),
    }
}

/// Points in mm whose outline is that of all that is seen over a motion.
pub(super) fn points(run: &Run<'_>) -> Vec<Vector3<f64>> {
    let Run {
        system,
        trajectory,
        skins,
        ..
    } = *run;
    let mut points = ground_plate(system);
    let instants = shown(&trajectory.times, 1);
    for &k in &instants {
        for (body, pose) in system.bodies.iter().zip(&trajectory.poses[k]) {
            points.extend(extent_points(&body.shape, pose));
        }
        for i in lumped(system) {
            points.extend(Prism::muscle(system, trajectory, k, i).corners());
        }
    }
    let lines = ties(run, &instants).into_iter();
    let lines = lines.chain(arrows(run, &instants));
    points.extend(lines.flat_map(|line| line.places).flatten());
    let corners = skins.list.iter().flat_map(|skin| &skin.places);
    points.extend(corners.chain(&trajectory.marks).flatten());
    points
}

/// A motion of one instant, the reference configuration, without joint coordinates and voltages.
pub(super) fn reference(system: &System) -> Trajectory {
    let marks = system.markers.iter().map(|marker| marker.point.at);
    Trajectory {
        times: vec![0.0],
        poses: vec![system.bodies.iter().map(|body| body.pose()).collect()],
        marks: vec![marks.collect()],
        ..Trajectory::default()
    }
}

/// Faces of elastic blocks that the ground holds in all directions, in mm.
pub(super) fn held_faces(system: &System) -> Vec<[Vector3<f64>; 4]> {
    let faces = system.solids.iter().flat_map(|solid| {
        let fixed = solid.supports.iter().filter(|s| s.held == [true; 3]);
        let glued = solid.glued.iter().filter(|glue| glue.body.is_none());
        let nodes = fixed.map(|s| &s.nodes).chain(glued.map(|glue| &glue.nodes));
        let held: HashSet<usize> = nodes.flatten().copied().collect();
        let faces = solid.mesh.boundary_quads().into_iter();
        let faces = faces.filter(move |face| face.iter().all(|node| held.contains(node)));
        faces.map(|face| face.map(|node| solid.mesh.nodes[node]))
    });
    faces.collect()
}

/// A disc in the ground below the points that are held by it, in mm; empty where nothing is.
pub(super) fn ground_plate(system: &System) -> Vec<Vector3<f64>> {
    let muscles = system.muscles.iter().flat_map(|m| [m.from, m.to]);
    let components = system.components.iter().flat_map(|c| c.points());
    let joints = system.joints.iter().filter(|j| j.parent.is_none());
    let mut held: Vec<_> = muscles
        .chain(components)
        .filter(|point| point.body.is_none())
        .map(|point| point.at)
        .chain(joints.map(|j| j.at))
        .collect();
    if held.is_empty() {
        return vec![];
    }
    let upright = upright(system);
    held.iter_mut()
        .for_each(|point| *point = upright.inverse() * *point);
    let centre = held.iter().sum::<Vector3<f64>>() / held.len() as f64;
    let lowest = held.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let spread = held.iter().map(|p| (p - centre).xz().norm());
    let radius = 1.6 * spread.fold(0.0, f64::max) + 8.0;
    let middle = upright * Vector3::new(centre.x, lowest, centre.z);
    let [across, along] = [Vector3::x(), Vector3::z()].map(|axis| upright * axis);
    circle(middle, across, along, radius)
}
