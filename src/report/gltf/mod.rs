//! A motion as a file of glTF 2.0, which Blender and browsers show: `motion.gltf`, in m and s, y upwards.
//!
//! - `document`: numbers, meshes and nodes of such a file.
//!
//! Bodies, lumped muscles and markers are nodes that move, turn and stretch. Surfaces of elastic blocks, springs and tendons are meshes
//! with a morph target for each instant, of which the weights are 0 and 1: between instants their points move on straight lines.

mod document;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::dynamics::trajectory::Trajectory;
use crate::kinematics::Pose;
use crate::model::system::{Marker, Shape};
use crate::report::Run;
use crate::report::drawing::{lumped, marker_colour};
use crate::report::gltf::document::{
    Document, METRE, Mode, Moving, Placed, body, cube, sphere, triangles,
};
use crate::report::moving_lines::{arrows, ties};
use crate::report::skins::{Skins, shown};
use crate::report::solids::Prism;
use crate::report::style;
use crate::report::view::corners;

/// Opacity of bodies, so that muscles within show.
const GLASS: f32 = 0.35;
/// Radius of a marker as a part of the size of the system.
const MARKER: f64 = 0.008;

/// `motion.gltf`: the system at the instants that pictures show; of a single instant without animation. None where nothing is finite.
pub fn text(run: &Run<'_>) -> Option<String> {
    let motion = Motion {
        run,
        instants: instants(run.trajectory, run.skins),
    };
    let times = motion.each(|k| run.trajectory.times[k] / 1e3);
    if times.is_empty() {
        return None;
    }
    let mut document = Document::new(&times);
    motion.add_bodies(&mut document);
    motion.add_muscles(&mut document);
    motion.add_markers(&mut document);
    motion.add_surfaces(&mut document);
    motion.add_lines(&mut document);
    Some(document.text(&run.system.name, run.origin))
}

/// A motion at the instants that are shown.
struct Motion<'a> {
    run: &'a Run<'a>,
    instants: Vec<usize>,
}

impl Motion<'_> {
    /// A value at each instant.
    fn each<T>(&self, value: impl Fn(usize) -> T) -> Vec<T> {
        self.instants.iter().map(|&k| value(k)).collect()
    }

    fn add_bodies(&self, document: &mut Document) {
        let glass = document.material("body", style::BODY, GLASS);
        for (b, part) in self.run.system.bodies.iter().enumerate() {
            let shape = body(&part.shape);
            let mesh = match part.shape {
                Shape::None => None,
                _ => Some(document.mesh(&part.name, &shape, glass)),
            };
            let poses = self.each(|k| of_pose(&self.run.trajectory.poses[k][b]));
            document.moving(&part.name, mesh, &poses, Moving::Rigid);
        }
    }

    /// Lumped muscles.
    fn add_muscles(&self, document: &mut Document) {
        let (unit, system) = (cube(), self.run.system);
        for m in lumped(system) {
            let name = &system.muscles[m].name;
            let material = document.material(name, style::muscle(m).0, 1.0);
            let mesh = document.mesh(name, &unit, material);
            let prism = |k| of_prism(&Prism::muscle(system, self.run.trajectory, k, m));
            document.moving(name, Some(mesh), &self.each(prism), Moving::Stretched);
        }
    }

    fn add_markers(&self, document: &mut Document) {
        let (markers, trajectory) = (&self.run.system.markers, self.run.trajectory);
        let ball = sphere(MARKER * METRE * size(trajectory, &self.instants));
        for (m, Marker { name, .. }) in markers.iter().enumerate() {
            let material = document.material(name, marker_colour(m, markers.len()), 1.0);
            let mesh = document.mesh(name, &ball, material);
            let places = self.each(|k| Placed::at(trajectory.marks[k][m] * METRE));
            document.moving(name, Some(mesh), &places, Moving::Shifted);
        }
    }

    /// Surfaces of elastic blocks.
    fn add_surfaces(&self, document: &mut Document) {
        for (s, skin) in self.run.skins.list.iter().enumerate() {
            let (name, colour) = match skin.muscle {
                Some(muscle) => {
                    let name = self.run.system.muscles[muscle].name.clone();
                    (name, style::muscle(muscle).0)
                }
                None => (format!("block {}", s + 1), style::PASSIVE),
            };
            let material = document.material(&name, colour, 1.0);
            let places = self.each(|k| metres(&skin.places[self.run.skins.position(k)]));
            let mode = Mode::Triangles(triangles(&skin.quads));
            document.deforming(&name, &places, mode, material);
        }
    }

    /// Springs, tendons and arrows of loads.
    fn add_lines(&self, document: &mut Document) {
        let ties = ties(self.run, &self.instants).into_iter();
        for line in ties.chain(arrows(self.run, &self.instants)) {
            let material = document.material(line.name, line.colour, 1.0);
            let mut places: Vec<_> = line.places.iter().map(|places| metres(places)).collect();
            // A coil that has no direction is a line of two points.
            if places.iter().any(|points| points.len() != places[0].len()) {
                places = places.iter().map(|p| vec![p[0], p[p.len() - 1]]).collect();
            }
            document.deforming(line.name, &places, Mode::Line, material);
        }
    }
}

/// Instants at which all is finite, of those whose surfaces are known.
fn instants(trajectory: &Trajectory, skins: &Skins) -> Vec<usize> {
    let all = match skins.list[..] {
        [] => shown(&trajectory.times, 1),
        _ => skins.instants.clone(),
    };
    let is_finite = |k: &usize| {
        let poses = trajectory.poses[*k].iter();
        let poses = poses.flat_map(|pose| pose.centre.iter().chain(pose.directors.iter()));
        let position = skins.position(*k);
        let places = skins.list.iter().flat_map(|skin| &skin.places[position]);
        let places = places.chain(&trajectory.marks[*k]);
        let mut numbers = poses.chain(places.flat_map(|place| place.iter()));
        numbers.all(|x| x.is_finite())
    };
    all.into_iter().filter(is_finite).collect()
}

/// Greatest distance in mm between two sides of the box around centres and markers.
fn size(trajectory: &Trajectory, instants: &[usize]) -> f64 {
    let places = instants.iter().flat_map(|&k| {
        let poses = trajectory.poses[k].iter().map(|pose| pose.centre);
        poses.chain(trajectory.marks[k].iter().copied())
    });
    corners(places).map_or(1.0, |[low, high]| (high - low).max().max(1.0))
}

fn of_pose(pose: &Pose) -> Placed {
    Placed {
        rotation: turned(pose.directors),
        ..Placed::at(pose.centre * METRE)
    }
}

/// A prism is a cube of edge 2, stretched and turned.
fn of_prism(prism: &Prism) -> Placed {
    let lengths = prism.halves.map(|half| half.norm());
    let axes = [0, 1, 2].map(|i| prism.halves[i] / lengths[i].max(f64::MIN_POSITIVE));
    Placed {
        rotation: turned(Matrix3::from_columns(&axes)),
        scale: Vector3::from(lengths) * METRE,
        ..Placed::at(prism.centre * METRE)
    }
}

fn turned(axes: Matrix3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

fn metres(places: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    places.iter().map(|place| place * METRE).collect()
}
