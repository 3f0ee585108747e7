//! Validation of a system that is made by a program: the checks that a reader of files makes entry by entry.

use crate::math::Vector;
use crate::model::circuit::Circuit;
use crate::model::components::{BlockLoad, LoadPlace};
use crate::model::error::{SystemError, positive, require};
use crate::model::system::{
    Attachment, Discretisation, ElasticLaw, Fidelity, Joint, JointKind, Material, Muscle, System,
};
use std::collections::BTreeSet;

/// Rounding of moments that satisfy the triangle inequality with equality, and of unit vectors.
const ROUNDING: f64 = 1e-12;
/// Sine of the angle to the span of a muscle below which a direction is along it.
const ALONG: f64 = 1e-6;

impl System {
    /// Checks names, masses, lengths, axes, materials, and that parts refer to bodies that exist.
    ///
    /// # Errors
    /// The first part that makes no sense.
    pub fn check(&self) -> Result<(), SystemError> {
        self.check_names()?;
        self.check_bodies()?;
        self.check_joints()?;
        self.check_muscles()?;
        for component in self.components.iter() {
            for point in component.points() {
                self.check_point(component.name(), &point)?;
            }
            component.check()?;
        }
        self.check_loads()?;
        for solid in &self.solids {
            let sound = solid.mesh.check();
            require(
                sound.is_ok(),
                &solid.name,
                || sound.map_or_else(|error| error.to_string(), |()| String::new()),
                "a mesh that can be computed with",
            )?;
            let sets = solid.electrodes.iter().map(|e| &e.nodes);
            for nodes in sets.chain(solid.supports.iter().map(|s| &s.nodes)) {
                require(
                    !nodes.is_empty() && nodes.iter().all(|&n| n < solid.mesh.nodes.len()),
                    &solid.name,
                    || "an electrode or support without nodes".to_owned(),
                    "the name of a set of the mesh",
                )?;
            }
            for electrode in &solid.electrodes {
                check_circuit(
                    &solid.name,
                    electrode.circuit,
                    [electrode.is_driven(), true],
                )?;
            }
            solid.check_prestretch()?;
            for material in &solid.materials {
                positive(&solid.name, "shear modulus", material.shear_modulus)?;
                material.check_law(&solid.name)?;
                material.check_range(&solid.name)?;
                check_branches(&solid.name, material)?;
                material.check_of_elements(&solid.name)?;
            }
        }
        for marker in &self.markers {
            self.check_point(&marker.name, &marker.point)?;
            require(
                marker.solid.is_none_or(|s| s < self.solids.len()),
                &marker.name,
                || "a solid that the system does not have".to_owned(),
                "one of its solids",
            )?;
        }
        Ok(())
    }

    fn check_loads(&self) -> Result<(), SystemError> {
        for load in &self.components.loads {
            match &load.on {
                LoadPlace::Point { at, direction, .. } => {
                    self.check_point(&load.name, at)?;
                    check_direction(&load.name, direction)?;
                }
                LoadPlace::Block { block, load: on } => {
                    let solid = self.solids.get(*block);
                    let count = solid.map_or(0, |solid| solid.mesh.nodes.len());
                    let mut nodes = on.faces().iter().flatten();
                    let is_body_force = matches!(on, BlockLoad::BodyForce(_));
                    require(
                        nodes.all(|node| *node < count) && on.faces().is_empty() == is_body_force,
                        &load.name,
                        || "a load without faces of its solid".to_owned(),
                        "faces of a solid of the system",
                    )?;
                    match on {
                        BlockLoad::Traction(_, along) | BlockLoad::BodyForce(along) => {
                            check_direction(&load.name, along)?;
                        }
                        BlockLoad::Charge(faces) => require(
                            solid.is_some_and(|solid| solid.takes_charge(faces)),
                            &load.name,
                            || NO_CHARGE[0].to_owned(),
                            NO_CHARGE[1],
                        )?,
                        BlockLoad::Pressure { .. } => {}
                    }
                }
                LoadPlace::Muscle(muscle) => {
                    let named = self.muscles.get(*muscle);
                    let all = self.components.loads.iter();
                    let same = all.filter(|other| other.on == load.on).count();
                    require(
                        named.is_some_and(Muscle::takes_charge) && same == 1,
                        &load.name,
                        || NO_MUSCLE_CHARGE[0].to_owned(),
                        NO_MUSCLE_CHARGE[1],
                    )?;
                }
                LoadPlace::Joint(joint) => {
                    let has = |joint: &Joint| joint.has_coordinate();
                    require(
                        self.joints.get(*joint).is_some_and(has),
                        &load.name,
                        || "a load on a joint that has no coordinate".to_owned(),
                        "a revolute or prismatic joint of the system",
                    )?;
                }
            }
        }
        Ok(())
    }

    fn check_names(&self) -> Result<(), SystemError> {
        let bodies = self.bodies.iter().map(|part| &part.name);
        let joints = self.joints.iter().map(|part| &part.name);
        let muscles = self.muscles.iter().map(|part| &part.name);
        let solids = self.solids.iter().map(|part| &part.name);
        let markers = self.markers.iter().map(|part| &part.name);
        let lists: [Vec<&str>; 5] = [
            bodies.map(String::as_str).collect(),
            joints.map(String::as_str).collect(),
            muscles.chain(solids).map(String::as_str).collect(),
            markers.map(String::as_str).collect(),
            self.components.iter().map(|part| part.name()).collect(),
        ];
        for list in lists {
            let mut seen = BTreeSet::new();
            for name in list {
                let is_new = seen.insert(name);
                require(
                    is_new && !name.is_empty(),
                    name,
                    || "a name that another part of its kind has, or none".to_owned(),
                    "a name of its own",
                )?;
            }
        }
        Ok(())
    }

    fn check_bodies(&self) -> Result<(), SystemError> {
        for body in &self.bodies {
            positive(&body.name, "mass", body.mass)?;
            for moment in body.inertia {
                positive(&body.name, "moment of inertia", moment)?;
            }
            let largest = body.inertia.iter().fold(0.0_f64, |m, &v| m.max(v));
            let sum: f64 = body.inertia.iter().sum();
            require(
                sum - 2.0 * largest >= -ROUNDING * largest,
                &body.name,
                || format!("moments of inertia {:?}", body.inertia),
                "moments of which none is larger than the sum of the two others",
            )?;
            let gram = body.directors.tr_mul(&body.directors);
            let is_rotation = (gram - nalgebra::Matrix3::identity()).amax() < 1e-9
                && body.directors.determinant() > 0.0;
            require(
                is_rotation && body.centre.iter().all(|x| x.is_finite()),
                &body.name,
                || "a pose that is no rotation and finite place".to_owned(),
                "a direction that is not zero, and a finite place",
            )?;
        }
        Ok(())
    }

    fn check_joints(&self) -> Result<(), SystemError> {
        for joint in &self.joints {
            for body in joint.parent.into_iter().chain([joint.child]) {
                self.check_body(&joint.name, body)?;
            }
            require(
                joint.parent != Some(joint.child),
                &joint.name,
                || "one body on both sides".to_owned(),
                "two bodies, or a body and the ground",
            )?;
            for axis in joint.kind.axes() {
                require(
                    (axis.norm() - 1.0).abs() < ROUNDING,
                    &joint.name,
                    || format!("the axis {:?}", axis.as_slice()),
                    "a direction",
                )?;
            }
            if let JointKind::Universal { axes: [a, b] } = joint.kind {
                require(
                    a.dot(&b).abs() < ROUNDING,
                    &joint.name,
                    || format!("axes with a cosine of {}", a.dot(&b)),
                    "axes that are perpendicular to each other",
                )?;
            }
            if let Some(damping) = joint.damping {
                positive(&joint.name, "damping", damping)?;
            }
            if let Some(stops) = joint.stops {
                positive(&joint.name, "stiffness", stops.stiffness)?;
                let [low, high] = stops.at;
                let width = stops.smoothing;
                require(
                    joint.has_coordinate() && low < high && width >= 0.0 && width.is_finite(),
                    &joint.name,
                    || format!("stops at {low} and {high} with a width of {width}"),
                    "stops of a revolute or prismatic joint that grow, with a width from 0 on",
                )?;
            }
            if let Some(motion) = &joint.motion {
                require(
                    joint.has_coordinate() && motion.is_sound(),
                    &joint.name,
                    || format!("the prescribed motion {motion:?}"),
                    "a motion of a revolute or prismatic joint, of finite numbers and increasing times",
                )?;
            }
            if let Some(spring) = joint.spring {
                positive(&joint.name, "stiffness", spring.stiffness)?;
                require(
                    joint.has_coordinate() && spring.rest.is_finite(),
                    &joint.name,
                    || format!("a spring at rest at {}", spring.rest),
                    "a spring of a revolute or prismatic joint, at rest at a finite coordinate",
                )?;
            }
        }
        Ok(())
    }

    fn check_muscles(&self) -> Result<(), SystemError> {
        for muscle in &self.muscles {
            let name = &muscle.name;
            self.check_point(name, &muscle.from)?;
            self.check_point(name, &muscle.to)?;
            if let Some(stretch) = muscle.prestretch {
                positive(name, "prestretch", stretch)?;
            }
            positive(name, "length", muscle.length())?;
            if let Fidelity::FiniteElements(Discretisation {
                first_side: Some(side),
                ..
            }) = muscle.fidelity
            {
                let across = (muscle.to.at - muscle.from.at).cross(&side).norm();
                require(
                    across > ALONG * muscle.length() * side.norm(),
                    name,
                    || format!("a first side along {:?}", side.as_slice()),
                    "a direction across the span",
                )?;
            }
            for side in muscle.cross_section {
                positive(name, "side of the cross-section", side)?;
            }
            positive(name, "layer thickness", muscle.layer_thickness)?;
            let material = &muscle.material;
            positive(name, "shear modulus", material.shear_modulus)?;
            for value in material.density.into_iter().chain(material.viscosity) {
                positive(name, "density or viscosity", value)?;
            }
            material.check_law(name)?;
            material.check_range(name)?;
            check_branches(name, material)?;
            check_circuit(
                name,
                muscle.circuit,
                [muscle.takes_circuit(), muscle.is_meshed()],
            )?;
            if muscle.fidelity.elements() > 0 {
                material.check_of_elements(name)?;
            }
        }
        Ok(())
    }

    fn check_body(&self, part: &str, body: usize) -> Result<(), SystemError> {
        require(
            body < self.bodies.len(),
            part,
            || format!("body {body} of {}", self.bodies.len()),
            "a body of the system",
        )
    }

    fn check_point(&self, part: &str, point: &Attachment) -> Result<(), SystemError> {
        if let Some(body) = point.body {
            self.check_body(part, body)?;
        }
        require(
            point.at.iter().all(|x| x.is_finite()),
            part,
            || format!("the place {:?}", point.at.as_slice()),
            "a finite place",
        )
    }
}

/// Charge that acts on nothing, and what is expected, for messages.
pub const NO_CHARGE: [&str; 2] = [
    "a charge that no potential feels",
    "faces of a dielectric that touches an electrode at a voltage, other than those of this electrode",
];

/// Charge that no muscle takes, and what is expected, for messages.
pub const NO_MUSCLE_CHARGE: [&str; 2] = [
    "a charge that its muscle does not take",
    "a lumped muscle with a permittivity and without a circuit, and one charge for each",
];

fn check_direction(name: &str, direction: &Vector) -> Result<(), SystemError> {
    require(
        (direction.norm() - 1.0).abs() < 1e-9,
        name,
        || format!("the direction {direction:?}"),
        "a direction of length one",
    )
}

/// Checks the constants of the Maxwell branches of a material.
fn check_branches(name: &str, material: &Material) -> Result<(), SystemError> {
    for branch in material.maxwell.list() {
        let modulus = "shear modulus of a Maxwell branch";
        positive(name, modulus, branch.shear_modulus)?;
        positive(name, "relaxation time", branch.relaxation_time)?;
    }
    Ok(())
}

/// Checks the resistances of a circuit, and that what it drives can have one.
fn check_circuit(
    name: &str,
    circuit: Option<Circuit>,
    [is_driven, is_meshed]: [bool; 2],
) -> Result<(), SystemError> {
    let Some(circuit) = circuit else {
        return Ok(());
    };
    for resistance in circuit.parts() {
        positive(name, "resistance", resistance)?;
    }
    let fault = circuit.fault(is_driven, is_meshed);
    let [found, expected] = fault.unwrap_or_default();
    require(fault.is_none(), name, || found.to_owned(), expected)
}

impl Material {
    /// Checks the stretches for which its constants hold.
    pub(super) fn check_range(&self, name: &str) -> Result<(), SystemError> {
        require(
            self.stretch_range
                .is_none_or(|[low, high]| 0.0 < low && low < high && high < f64::INFINITY),
            name,
            || format!("the stretch range {:?}", self.stretch_range),
            "two positive stretches, the smaller one first",
        )
    }

    /// Checks the constants of a law of elasticity.
    pub(super) fn check_law(&self, name: &str) -> Result<(), SystemError> {
        match self.law.and_then(|law| law.fault()) {
            None => Ok(()),
            Some(fault) => {
                let found = || format!("{} {}", fault.constant, fault.found);
                require(false, name, found, fault.expected)
            }
        }
    }

    /// Checks that finite elements can be made of a material: it is compressible, and follows no law of principal
    /// stretches.
    pub(super) fn check_of_elements(&self, name: &str) -> Result<(), SystemError> {
        require(
            !matches!(self.law, Some(ElasticLaw::Ogden { .. })),
            name,
            || "Ogden's law of finite elements".to_owned(),
            "a law of the invariants of the strain: only lumped muscles follow Ogden's",
        )?;
        require(
            self.lame_lambda.is_some_and(f64::is_finite),
            name,
            || "a material without Poisson ratio".to_owned(),
            "one, as finite elements are compressible",
        )
    }
}
