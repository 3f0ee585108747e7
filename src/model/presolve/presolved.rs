//! Presolved system: welded bodies are merged, immobile parts belong to the ground, and sources without voltage drive
//! nothing.
//!
//! The muscles, blocks and markers of the presolved system are those of the scene in its order; bodies and joints are fewer.

use crate::kinematics::Pose;
use crate::math::{DisjointSets, Matrix, Vector};
use crate::model::analysis::Analysis;
use crate::model::presolve::immobile::{self, Immobile};
use crate::model::system::bodies::eigen;
use crate::model::system::{
    Body, Electrode, Joint, JointKind, Material, Muscle, Potential, Shape, Solid, Support, System,
};
use crate::model::terms::Carriers;

/// Location of a body of the scene in the presolved system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyLocation {
    /// It is this body of the presolved system.
    Body(usize),
    /// It is fixed to this body.
    Welded {
        /// The body.
        to: usize,
        /// Its pose in the directors of that body, from the centre there.
        at: Pose,
    },
    /// It is fixed to the ground, or nothing moves it.
    Ground,
}

/// A system reduced to the parts that are solved for.
#[derive(Clone, Debug)]
pub struct Presolved {
    /// The system.
    pub system: System,
    /// Location of each body of the scene.
    pub bodies: Vec<BodyLocation>,
    /// Joint of the scene of each joint.
    pub joints: Vec<usize>,
    /// Immobile parts.
    pub immobile: Immobile,
}

impl Presolved {
    /// Presolves a system for an analysis.
    pub fn new(system: &System, analysis: &Analysis) -> Self {
        let mut rest = system.clone();
        set_to_zero(&mut rest, analysis);
        let immobile = immobile::immobile(system, &rest, analysis);
        for (solid, &is_immobile) in rest.solids.iter_mut().zip(&immobile.solids) {
            if is_immobile {
                clamp(solid);
            }
        }
        let group = groups(system, &immobile);
        let ground = system.bodies.len();
        let mut bodies = Vec::new();
        let mut of_group = vec![None; ground + 1];
        for b in (0..ground).filter(|&b| group[b] == b) {
            let members: Vec<usize> = (b..ground).filter(|&m| group[m] == b).collect();
            of_group[b] = Some(bodies.len());
            bodies.push(weld(&members, &system.bodies));
        }
        let index = |b: Option<usize>| b.and_then(|b| of_group[group[b]]);
        let place = |(b, body): (usize, &Body)| match index(Some(b)) {
            None => BodyLocation::Ground,
            Some(to) if bodies[to] == *body => BodyLocation::Body(to),
            Some(to) => {
                let pose = bodies[to].pose();
                let at = Pose {
                    centre: pose.local(&body.centre),
                    directors: pose.directors.tr_mul(&body.directors),
                };
                BodyLocation::Welded { to, at }
            }
        };
        let places = system.bodies.iter().enumerate().map(place).collect();
        let mut joints = Vec::new();
        rest.joints.clear();
        for (j, joint) in system.joints.iter().enumerate() {
            if let Some(joint) = between(joint, index(joint.parent), index(Some(joint.child))) {
                joints.push(j);
                rest.joints.push(joint);
            }
        }
        for muscle in &mut rest.muscles {
            for end in [&mut muscle.from, &mut muscle.to] {
                end.body = index(end.body);
            }
        }
        for glue in rest.solids.iter_mut().flat_map(|s| &mut s.glued) {
            glue.body = index(glue.body);
        }
        for marker in &mut rest.markers {
            marker.point.body = index(marker.point.body);
        }
        rest.bodies = bodies;
        Self {
            system: rest,
            bodies: places,
            joints,
            immobile,
        }
    }

    /// Poses of the bodies of the scene from those of the presolved system.
    pub fn poses(&self, poses: &[Pose], reference: &[Body]) -> Vec<Pose> {
        let pose = |(place, body): (&BodyLocation, &Body)| match *place {
            BodyLocation::Ground => body.pose(),
            BodyLocation::Body(b) => poses[b],
            BodyLocation::Welded { to, at } => Pose {
                centre: poses[to].point(&at.centre),
                directors: poses[to].directors * at.directors,
            },
        };
        self.bodies.iter().zip(reference).map(pose).collect()
    }

    /// Body of the presolved system that carries a body of the scene; `None` is the ground.
    pub fn carrier(&self, body: Option<usize>) -> Option<usize> {
        match self.bodies[body?] {
            BodyLocation::Ground => None,
            BodyLocation::Body(to) | BodyLocation::Welded { to, .. } => Some(to),
        }
    }

    /// Returns true if an end of a muscle is on a body that moves.
    pub fn moves(&self, muscle: &Muscle) -> bool {
        let mut ends = [muscle.from, muscle.to].into_iter();
        ends.any(|end| self.carrier(end.body).is_some())
    }

    /// Poses of the presolved bodies from those of the bodies of the scene; `reference` where none is known.
    pub fn condense(&self, poses: &[Pose], reference: &[Pose]) -> Vec<Pose> {
        let mut presolved = reference.to_vec();
        for (place, pose) in self.bodies.iter().zip(poses) {
            match *place {
                BodyLocation::Ground => {}
                BodyLocation::Body(b) => presolved[b] = *pose,
                BodyLocation::Welded { to, at } => {
                    let directors = pose.directors * at.directors.transpose();
                    let centre = pose.centre - directors * at.centre;
                    presolved[to] = Pose { centre, directors };
                }
            }
        }
        presolved
    }

    /// Values by joint of the presolved system from values by joint of the scene.
    pub fn by_joint(&self, values: &[f64]) -> Vec<f64> {
        self.joints.iter().map(|&j| values[j]).collect()
    }

    /// Joint of the presolved system that is this one of the scene.
    pub fn joint(&self, joint: usize) -> Option<usize> {
        self.joints.iter().position(|&j| j == joint)
    }
}

/// Without voltage a muscle is passive and a driven electrode is grounded.
fn set_to_zero(system: &mut System, analysis: &Analysis) {
    for &source in &analysis.zero_inputs {
        if let Some(muscle) = system.muscles.get_mut(source) {
            let material = muscle.material;
            muscle.material = Material {
                electric: None,
                ..material
            };
        }
    }
    for solid in &mut system.solids {
        let mut electrodes: Vec<Electrode> = Vec::new();
        for electrode in std::mem::take(&mut solid.electrodes) {
            let is_silent = matches!(electrode.potential, Potential::Driven { source, .. }
                if analysis.zero_inputs.contains(&source));
            if !is_silent {
                electrodes.push(electrode);
                continue;
            }
            // Electrodes of one name are one.
            let same = |e: &&mut Electrode| {
                e.name == electrode.name && e.potential == Potential::Given(0.0)
            };
            match electrodes.iter_mut().find(same) {
                Some(same) => same.nodes.extend(electrode.nodes),
                None => electrodes.push(Electrode {
                    potential: Potential::Given(0.0),
                    ..electrode
                }),
            }
        }
        solid.electrodes = electrodes;
    }
}

/// Holds all nodes of a block.
pub(crate) fn clamp(solid: &mut Solid) {
    solid.supports = vec![Support {
        nodes: (0..solid.mesh.nodes.len()).collect(),
        held: [true; 3],
    }];
}

/// The first body that each body is rigidly connected to, itself included; the number of bodies for those of the ground.
fn groups(system: &System, immobile: &Immobile) -> Vec<usize> {
    let ground = system.bodies.len();
    // The ground is number 0 of the sets, so that it names what hangs on it; body b is number b + 1.
    let at = |body: Option<usize>| body.map_or(0, |b| b + 1);
    let mut sets = DisjointSets::new(ground + 1);
    for (b, &is_immobile) in immobile.bodies.iter().enumerate() {
        if is_immobile {
            sets.join(0, at(Some(b)));
        }
    }
    let before = sets.clone().all();
    let fixed = |joint: &&Joint| joint.kind == JointKind::Fixed;
    for joint in system.joints.iter().filter(fixed) {
        sets.join(at(joint.parent), at(Some(joint.child)));
    }
    let group = sets.all();
    // A group that a moving joint closes on itself stays as it is: its joint says what a start has to fit.
    let within =
        |group: &[usize], joint: &Joint| group[at(joint.parent)] == group[at(Some(joint.child))];
    let moving = system.joints.iter().filter(|joint| !fixed(joint));
    let closed: Vec<usize> = moving
        .filter(|joint| within(&group, joint) && !within(&before, joint))
        .map(|joint| group[at(Some(joint.child))])
        .collect();
    let first = |number: usize| {
        let sets = match closed.contains(&group[number]) {
            true => &before,
            false => &group,
        };
        sets[number].checked_sub(1).unwrap_or(ground)
    };
    (1..=ground).chain([0]).map(first).collect()
}

/// A joint between bodies of the presolved system; `None` where it is within one.
fn between(joint: &Joint, parent: Option<usize>, child: Option<usize>) -> Option<Joint> {
    if parent == child {
        return None;
    }
    if let Some(child) = child {
        return Some(Joint {
            parent,
            child,
            ..joint.clone()
        });
    }
    // Seen from the other side the same coordinate goes along the opposite axis.
    let kind = match joint.kind {
        JointKind::Revolute { axis } => JointKind::Revolute { axis: -axis },
        JointKind::Prismatic { axis } => JointKind::Prismatic { axis: -axis },
        JointKind::Universal { axes: [a, b] } => JointKind::Universal { axes: [-b, -a] },
        JointKind::Cylindrical { axis } => JointKind::Cylindrical { axis: -axis },
        JointKind::Planar { normal } => JointKind::Planar { normal: -normal },
        other @ (JointKind::Spherical | JointKind::Floating | JointKind::Fixed) => other,
    };
    Some(Joint {
        parent: None,
        child: parent.expect("not both sides are ground"),
        kind,
        ..joint.clone()
    })
}

/// One body of several: masses and moments of inertia add, about the common centre.
fn weld(members: &[usize], bodies: &[Body]) -> Body {
    let all = || members.iter().map(|&m| &bodies[m]);
    if let [only] = members {
        return bodies[*only].clone();
    }
    let mass: f64 = all().map(|b| b.mass).sum();
    let centre = all().map(|b| b.centre * b.mass).sum::<Vector>() / mass;
    let tensor = |body: &Body| {
        let own = Matrix::from_diagonal(&Vector::from(body.inertia));
        let arm = body.centre - centre;
        let away = Matrix::identity() * arm.norm_squared() - arm * arm.transpose();
        body.directors * own * body.directors.transpose() + away * body.mass
    };
    let (inertia, directors) = eigen(&all().map(tensor).sum::<Matrix>());
    let names: Vec<&str> = all().map(|b| b.name.as_str()).collect();
    Body {
        name: names.join("+"),
        mass,
        inertia,
        centre,
        directors,
        shape: Shape::None,
    }
}

impl Presolved {
    /// Carriers of the bodies of the scene, in the presolved system whose bodies have reference poses.
    pub(crate) fn carriers<'a>(&self, reference: &'a [Pose]) -> Carriers<'a> {
        let bodies = 0..self.bodies.len();
        let of = bodies.map(|body| self.carrier(Some(body))).collect();
        Carriers { of, reference }
    }
}
