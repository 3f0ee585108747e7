//! Moving parts of a page: bodies and lumped muscles as solids that are moved, elastic blocks as surfaces whose corners move.

use crate::kinematics::Pose;
use crate::mesh::triangulated::Surface;
use crate::model::system::{Attachment, Joint, JointKind};
use crate::report::drawing::{ground_plate, held_faces, lumped};
use crate::report::moving_lines::{MovingLine, arrows, ties};
use crate::report::skins::{Skin, shown};
use crate::report::solids::Prism;
use crate::report::style::Colour;
use crate::report::viewpoint::upright;
use crate::report::{Run, solids, style};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::borrow::Borrow;

/// Length in mm of the axis that shows the direction of a joint.
const AXIS: f64 = 1.0;
/// Most points of the path of a marker.
const POINTS: usize = 2000;

/// The scene of a run at the instants shown.
pub(super) fn scene(run: &Run<'_>) -> Value {
    let coloured = solids::coloured(run.system, run.trajectory, run.observations);
    let run = &Run {
        trajectory: &coloured,
        ..*run
    };
    let times = &run.trajectory.times;
    let instants = match run.skins.list.is_empty() {
        true => shown(times, 0),
        false => run.skins.instants.clone(),
    };
    let stage = Stage {
        run,
        instants: &instants,
    };
    let mut parts = stage.bodies();
    parts.extend(stage.muscles());
    parts.extend(run.skins.list.iter().map(|skin| stage.block(skin)));
    let upright = upright(run.system);
    json!({
        "name": run.name,
        "span": run.branch.is_none().then(|| [times[0] / 1e3, times[times.len() - 1] / 1e3]),
        "branch": run.branch.map(|branch| json!({ "fractions": numbers(branch.fractions.iter().copied()), "shown": branch.shown })),
        "times": numbers(instants.iter().map(|&k| times[k] / 1e3)),
        "toward": (upright.inverse() * run.view().toward).as_slice(),
        "upright": upright.matrix().as_slice(),
        "voltage": run.voltage_scale() / 1e3,
        "parts": parts,
        "ties": stage.lines(),
        "joints": stage.joints(),
        "markers": stage.markers(),
        "goal": run.goal.map(|poses| places(poses.iter().flat_map(moved))),
        "ground": {
            "plate": places(ground_plate(run.system)),
            "faces": places(held_faces(run.system).iter().flatten()),
        },
        "names": [run.name, run.comparison.map_or("", |(name, _)| name)],
    })
}

/// Columns of the motion of a body: directors and centre.
fn moved(pose: &Pose) -> [Vector3<f64>; 4] {
    let [a, b, c] = [0, 1, 2].map(|i| pose.directors.column(i).into_owned());
    [a, b, c, pose.centre]
}

struct Stage<'a> {
    run: &'a Run<'a>,
    /// The instants shown.
    instants: &'a [usize],
}

impl Stage<'_> {
    fn bodies(&self) -> Vec<Value> {
        let bodies = self.run.system.bodies.iter().enumerate();
        let part = bodies.map(|(b, body)| {
            let mut mesh = Surface::default();
            body.shape.add_to(&mut mesh, &Pose::GROUND);
            let poses = self.instants.iter();
            let motion = poses.flat_map(|&k| moved(&self.run.trajectory.poses[k][b]));
            json!({
                "kind": "body",
                "name": body.name,
                "vertices": places(&mesh.vertices),
                "triangles": indices(mesh.triangles.iter().flatten().copied()),
                "motion": places(motion),
            })
        });
        part.collect()
    }

    /// Cubes from −1 to 1 that are moved to the prisms of the muscles.
    fn muscles(&self) -> Vec<Value> {
        let (system, trajectory) = (self.run.system, self.run.trajectory);
        let part = |i: usize| {
            let muscle = &system.muscles[i];
            let prisms = self.instants.iter();
            let motion = prisms.flat_map(|&k| {
                let prism = Prism::muscle(system, trajectory, k, i);
                prism.halves.into_iter().chain([prism.centre])
            });
            let rest = (muscle.to.at - muscle.from.at).norm();
            let stretch = |&k: &usize| {
                let ends = [&muscle.from, &muscle.to].map(|p| trajectory.point(k, p, system));
                (ends[1] - ends[0]).norm() / rest
            };
            // kV, and kV/mm, which is MV/m.
            let voltage = |&k: &usize| self.voltage(k, i).abs() / 1e3;
            let field = |k: &usize| voltage(k) / (muscle.layer_thickness * stretch(k));
            let mut quantities = json!({ "stretch": numbers(self.instants.iter().map(stretch)) });
            if muscle.material.electric.is_some() {
                quantities["voltage"] = numbers(self.instants.iter().map(voltage));
                quantities["field"] = numbers(self.instants.iter().map(field));
            }
            json!({
                "kind": "muscle",
                "name": muscle.name,
                "motion": places(motion),
                "quantities": quantities,
            })
        };
        lumped(system).map(part).collect()
    }

    /// Voltage in V of a source in the interval that ends at an instant.
    fn voltage(&self, k: usize, source: usize) -> f64 {
        let voltages = self.run.trajectory.voltages.get(k.saturating_sub(1));
        voltages.map_or(0.0, |v| v[source])
    }

    fn block(&self, skin: &Skin) -> Value {
        let all = |values: &[Vec<f64>], factor: f64| {
            numbers(values.iter().flatten().map(|value| factor * value))
        };
        let mut quantities = json!({ "stress": all(&skin.von_mises, 1e3) });
        if skin.is_charged {
            quantities["voltage"] = all(&skin.potentials, 1e-3);
            quantities["field"] = all(&skin.fields, 1e-3);
        }
        let edges = |is_sharp: bool| {
            let sides = skin
                .quads
                .iter()
                .zip(&skin.sharp)
                .flat_map(move |(quad, sharp)| {
                    (0..4).filter_map(move |i| {
                        let (a, b) = (quad[i], quad[(i + 1) % 4]);
                        // Two faces share an inner edge.
                        (sharp[i] == is_sharp && (is_sharp || a < b)).then_some([a, b])
                    })
                });
            indices(sides.flatten())
        };
        json!({
            "kind": "block",
            "name": skin.name,
            "vertices": places(&skin.reference),
            "faces": indices(skin.quads.iter().flatten().copied()),
            "edges": edges(true),
            "inner": edges(false),
            "places": places(skin.places.iter().flatten()),
            "quantities": quantities,
        })
    }

    /// Springs, tendons and other components, and arrows of loads.
    fn lines(&self) -> Vec<Value> {
        let line = |line: &MovingLine<'_>, colour: Colour| {
            let most = line.places.iter().map(Vec::len).max().unwrap_or(0);
            // A line of fewer points stays at its last one.
            let points = line.places.iter().flat_map(|line| {
                (0..most).filter_map(|i| line.get(i.min(line.len().saturating_sub(1))))
            });
            json!({ "count": most, "places": places(points), "colour": colour.hex() })
        };
        let ties = ties(self.run, self.instants).into_iter();
        let ties = ties.map(|tie| line(&tie, style::TIE_ON_PAGE));
        let arrows = arrows(self.run, self.instants).into_iter();
        let arrows = arrows.map(|arrow| line(&arrow, arrow.colour));
        ties.chain(arrows).collect()
    }

    /// Place of each joint, and of a point along its axis.
    fn joints(&self) -> Vec<Value> {
        let (system, trajectory) = (self.run.system, self.run.trajectory);
        let joint = |joint: &Joint| {
            let axis = match joint.kind {
                JointKind::Revolute { axis }
                | JointKind::Prismatic { axis }
                | JointKind::Cylindrical { axis } => Some(axis),
                _ => None,
            };
            let at = |shift: Vector3<f64>| {
                let point = Attachment {
                    body: Some(joint.child),
                    at: joint.at + shift,
                };
                let instants = self.instants.iter();
                places(instants.map(|&k| trajectory.point(k, &point, system)))
            };
            json!({
                "name": joint.name,
                "places": at(Vector3::zeros()),
                "axis": axis.map(|axis| at(AXIS * axis)),
                "bodies": [joint.parent, Some(joint.child)],
            })
        };
        system.joints.iter().map(joint).collect()
    }

    /// Paths of the markers, with their references and those of the motion that is compared.
    fn markers(&self) -> Vec<Value> {
        let (system, motion) = (self.run.system, self.run.trajectory);
        let kept = chosen(motion.times.len());
        let markers = system.markers.iter().enumerate().map(|(m, marker)| {
            let compared = self.run.comparison.map(|(_, other)| {
                let path = other.path(m);
                places(chosen(path.len()).map(|k| &path[k]))
            });
            let path = motion.path(m);
            let mut tracked = self.run.tracked.iter();
            let tracked = tracked.find(|one| one.kind == "marker" && one.name == marker.name);
            let followed = tracked.map(|one| {
                let place = |k: usize| {
                    let mut place = path[k];
                    for along in &one.paths {
                        if let Some(axis) = along.axis {
                            place[axis] = along.reference[k];
                        }
                    }
                    place
                };
                places(kept.clone().map(place))
            });
            let marked = self.run.targets.iter().chain(self.run.waypoints);
            let targets: Vec<_> = marked.filter(|(index, _)| *index == m).collect();
            json!({
                "name": marker.name,
                "target": (!targets.is_empty()).then(|| places(targets.iter().map(|(_, place)| place))),
                "colour": style::hue(m).hex(),
                "times": numbers(kept.clone().map(|k| motion.times[k] / 1e3)),
                "path": places(kept.clone().map(|k| &path[k])),
                "compared": compared,
                "followed": followed,
            })
        });
        markers.collect()
    }
}

/// Thins the points of a path to those that can be seen, the first and the last among them.
fn chosen(count: usize) -> impl Iterator<Item = usize> + Clone {
    let last = count.saturating_sub(1);
    let most = last.min(POINTS);
    (0..=most).map(move |i| (i * last) / most.max(1))
}

/// Numbers in single precision; NaN stays NaN.
pub(super) fn numbers(values: impl IntoIterator<Item = f64>) -> Value {
    let values = values.into_iter();
    packed(values.flat_map(|value| (value as f32).to_le_bytes()))
}

/// Indices below 2³².
fn indices(values: impl IntoIterator<Item = usize>) -> Value {
    let values = values.into_iter();
    packed(values.flat_map(|value| (value as u32).to_le_bytes()))
}

fn packed(bytes: impl Iterator<Item = u8>) -> Value {
    STANDARD.encode(bytes.collect::<Vec<u8>>()).into()
}

/// Coordinates of places in mm, one after the other.
fn places(places: impl IntoIterator<Item = impl Borrow<Vector3<f64>>>) -> Value {
    let places = places.into_iter();
    numbers(places.flat_map(|place| <[f64; 3]>::from(*place.borrow())))
}
