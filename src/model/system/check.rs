//! Rules of a system and its parts, which files and programs in Rust have in common: each says where it does not hold by the keys of files.

use crate::math::{
    DIRECTION, Fault, Key, Vector, WHOLE, not_negative, positive, refuse, shortest, unique,
};
use crate::mesh::cell::Cell;
use crate::model::components::component::Component;
use crate::model::components::{BlockLoad, Load, LoadPlace};
use crate::model::system::circuit::Circuit;
use crate::model::system::{
    Attachment, Body, Discretisation, ElasticLaw, Fidelity, Joint, JointKind, JointSpring,
    Material, Muscle, Solid, System,
};
use thiserror::Error;

/// Rounding of moments that satisfy the triangle inequality with equality, and of unit vectors.
const ROUNDING: f64 = 1e-12;
/// Sine of the angle to the span of a muscle below which a direction is along it.
const ALONG: f64 = 1e-6;
/// Spans shorter than this in mm have no direction.
const SHORTEST_SPAN: f64 = 1e-9;
/// Lengths of a muscle that a side of its section may have: a wider one is a slip of a unit.
const WIDEST: f64 = 100.0;
/// Most elements of one mesh; a slip of the pen asks for more.
pub const MOST_ELEMENTS: usize = 1_000_000;
/// Density in g/mm³ beyond that of any matter on earth: osmium has 0.02259.
const DENSEST: f64 = 0.1;

/// A rule that does not hold, or none.
type Checked = Result<(), Fault>;
/// A part of a system: its list, its index there, and its name.
type Named<'a> = (&'static str, usize, &'a str);

impl System {
    /// Checks names, masses, lengths, axes, materials, and that parts refer to bodies that exist.
    ///
    /// # Errors
    /// The first part that makes no sense.
    pub fn check(&self) -> Result<(), SystemError> {
        let bodies = named("bodies", &self.bodies, |body| &body.name);
        let joints = named("joints", &self.joints, |joint| &joint.name);
        let muscles = named("muscles", &self.muscles, |muscle| &muscle.name);
        let solids = named("solids", &self.solids, |solid| &solid.name);
        let markers = named("markers", &self.markers, |marker| &marker.name);
        let loads = named("loads", &self.components.loads, |load| &load.name);
        let others = [
            named("springs", &self.components.springs, |spring| &spring.name),
            named("tendons", &self.components.tendons, |tendon| &tendon.name),
            named("contacts", &self.components.contacts, |one| &one.name),
            named("others", &self.components.others, |other| other.0.name()),
        ];
        let others = others.concat();
        // Muscles, blocks and loads are inputs.
        let inputs = [&muscles[..], &solids, &loads].concat();
        for list in [&bodies, &joints, &inputs, &markers, &others] {
            let names: Vec<&str> = list.iter().map(|(_, _, name)| *name).collect();
            unique(&names, &[]).map_err(|(index, fault)| refused(list[index], fault))?;
        }
        each(&bodies, |index| self.bodies[index].check())?;
        each(&joints, |index| self.check_joint(&self.joints[index]))?;
        each(&muscles, |index| {
            let muscle = &self.muscles[index];
            self.check_point("from", &muscle.from)?;
            self.check_point("to", &muscle.to)?;
            muscle.check()
        })?;
        each(&solids, |index| self.solids[index].check())?;
        each(&markers, |index| {
            let marker = &self.markers[index];
            self.check_point("", &marker.point)?;
            check_index(
                "solid",
                "solid",
                marker.solid.unwrap_or(0),
                self.solids.len().max(1),
            )
        })?;
        each(&loads, |index| self.check_load(index))?;
        for (part, component) in others.into_iter().zip(self.components.iter()) {
            let points = component.points();
            let mut points = points.iter().map(|point| self.check_point("", point));
            let checked = points.try_for_each(|checked| checked);
            checked
                .and_then(|()| self.check_nodes(component))
                .and_then(|()| component.check())
                .map_err(|fault| refused(part, fault))?;
        }
        Ok(())
    }

    fn check_nodes(&self, component: &dyn Component) -> Checked {
        let mut nodes = component.nodes().into_iter();
        nodes.try_for_each(|[solid, node]| {
            check_index("node", "solid", solid, self.solids.len())?;
            check_index("node", "node", node, self.solids[solid].mesh.nodes.len())
        })
    }

    fn check_joint(&self, joint: &Joint) -> Checked {
        self.check_body("parent", joint.parent)?;
        self.check_body("child", Some(joint.child))?;
        joint.check()
    }

    fn check_load(&self, index: usize) -> Checked {
        let loads = &self.components.loads;
        match &loads[index].on {
            LoadPlace::Point { at, direction, .. } => {
                self.check_point("point", at)?;
                refuse!(if at.body.is_none(), Key("point.body");
                    found "\"ground\", which no force moves", expected "the name of a body");
                check_direction("direction", direction)
            }
            LoadPlace::Block { block, load } => {
                check_index("solid", "solid", *block, self.solids.len())?;
                self.solids[*block].check_load(load)
            }
            LoadPlace::Muscle(muscle) => {
                check_index("muscle", "muscle", *muscle, self.muscles.len())?;
                refuse!(unless self.muscles[*muscle].takes_charge(), Key("muscle");
                    found "a charge that its muscle does not take",
                    expected "a lumped muscle with a permittivity and without a circuit, and one charge for each");
                let is_same = |other: &Load| other.on == loads[index].on;
                refuse!(if loads[..index].iter().any(is_same), Key("muscle");
                    found "a second charge of one muscle", expected "one charge for each");
                Ok(())
            }
            LoadPlace::Joint(joint) => {
                check_index("joint", "joint", *joint, self.joints.len())?;
                let joint = &self.joints[*joint];
                refuse!(unless joint.has_coordinate(), Key("joint");
                    found format!("{:?}, which is neither revolute nor prismatic, or locked", joint.name),
                    expected "a joint with one coordinate");
                Ok(())
            }
        }
    }

    fn check_body(&self, at: &str, body: Option<usize>) -> Checked {
        body.map_or(Ok(()), |body| {
            check_index(at, "body", body, self.bodies.len())
        })
    }

    fn check_point(&self, at: &str, point: &Attachment) -> Checked {
        self.check_body(at, point.body)?;
        check_place(at, &point.at)
    }
}

/// The parts of a list with their names.
fn named<'a, P>(
    list: &'static str,
    parts: &'a [P],
    name: impl Fn(&'a P) -> &'a str,
) -> Vec<Named<'a>> {
    let parts = parts.iter().enumerate();
    parts
        .map(|(index, part)| (list, index, name(part)))
        .collect()
}

/// Checks each of some parts.
fn each(parts: &[Named<'_>], check: impl Fn(usize) -> Checked) -> Result<(), SystemError> {
    let mut parts = parts.iter();
    parts.try_for_each(|part| check(part.1).map_err(|fault| refused(*part, fault)))
}

/// A fault of a part.
fn refused(part: Named<'_>, fault: Fault) -> SystemError {
    let (list, index, name) = part;
    let name = name.to_owned();
    SystemError {
        list,
        index,
        name,
        fault: fault.into(),
    }
}

/// A part by its index; that of a handle of another system may be beyond the list.
fn check_index(at: &str, kind: &str, index: usize, count: usize) -> Checked {
    refuse!(unless index < count, Key(at);
        found format!("{kind} {index} of {count}"), expected format!("a {kind} of the system"));
    Ok(())
}

fn check_place(at: &str, place: &Vector) -> Checked {
    let is_finite = place.iter().all(|x| x.is_finite());
    refuse!(unless is_finite, Key(at);
        found format!("the place {:?}", place.as_slice()), expected "a finite place");
    Ok(())
}

fn check_direction(at: &str, direction: &Vector) -> Checked {
    let is_unit = (direction.norm() - 1.0).abs() < 1e-9;
    refuse!(unless is_unit, Key(at);
        value format!("{:?}", direction.as_slice()), expected DIRECTION);
    Ok(())
}

impl Body {
    fn check(&self) -> Checked {
        positive("mass", self.mass)?;
        let moments = &self.inertia;
        let sum: f64 = moments.iter().sum();
        let largest = moments.iter().fold(0.0, |m: f64, v| m.max(*v));
        let holds = moments.iter().all(|m| *m > 0.0 && m.is_finite())
            && sum - 2.0 * largest >= -ROUNDING * largest;
        refuse!(unless holds, Key("inertia");
            found format!("principal moments of {moments:?} g mm^2"),
            expected "positive moments of which none is larger than the sum of the two others");
        let gram = self.directors.tr_mul(&self.directors);
        let is_rotation = (gram - nalgebra::Matrix3::identity()).amax() < 1e-9
            && self.directors.determinant() > 0.0;
        refuse!(unless is_rotation, WHOLE; found "axes that are no rotation", expected DIRECTION);
        check_place("position", &self.centre)
    }
}

impl JointKind {
    /// Refuses damping, a spring, stops and a motion, of which each may be there, of a joint that does not have exactly one coordinate.
    ///
    /// # Errors
    /// The first that is there.
    pub fn check_coordinate(&self, there: [bool; 4]) -> Result<(), Fault> {
        let has_one = matches!(self, Self::Revolute { .. } | Self::Prismatic { .. });
        let why = "as the joint is neither revolute nor prismatic";
        for (at, is_there) in ["damping", "stiffness", "stops.stiffness"]
            .into_iter()
            .zip(there)
        {
            refuse!(unless has_one || !is_there, Key(at);
                value at, expected format!("no such constant, {why}"));
        }
        refuse!(unless has_one || !there[3], Key("motion");
            found "motion", expected format!("no motion, {why}"));
        Ok(())
    }
}

/// Refuses axes of a universal joint whose cosine is not zero within a tolerance.
///
/// # Errors
/// It is not.
pub fn check_axes(at: &str, cosine: f64, tolerance: f64) -> Result<(), Fault> {
    refuse!(unless cosine.abs() <= tolerance, Key(at);
        found format!("axes at {} deg", shortest(cosine.acos().to_degrees(), 5)),
        expected "axes at 90 deg to each other");
    Ok(())
}

impl Joint {
    /// Checks its constants.
    ///
    /// # Errors
    /// The first one that makes no sense.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        let child = format!("body {}", self.child);
        if self.parent == Some(self.child) {
            let (why, expected) = (", which is the parent too", "another body than the parent");
            return Err(Fault::of("child", child, why, expected));
        }
        for axis in self.kind.axes() {
            check_direction("axis", &axis)?;
        }
        if let JointKind::Universal { axes: [a, b] } = self.kind {
            check_axes("universal.axes", a.dot(&b), ROUNDING)?;
        }
        let has = [
            self.damping.is_some(),
            self.spring.is_some(),
            self.stops.is_some(),
            self.motion.is_some(),
        ];
        self.kind.check_coordinate(has)?;
        not_negative("damping", self.damping.unwrap_or(0.0))?;
        if let Some(JointSpring { stiffness, rest }) = self.spring {
            not_negative("stiffness", stiffness)?;
            refuse!(unless rest.is_finite(), Key("rest");
                value rest, expected "a finite coordinate");
        }
        if let Some(stops) = &self.stops {
            not_negative("stops.stiffness", stops.stiffness)?;
            let ([low, high], width) = (stops.at, stops.smoothing);
            let is_there = low.is_finite() || high.is_finite();
            refuse!(unless is_there, Key("stops");
                found "neither \"min\" nor \"max\"", expected "one of them, or both");
            refuse!(unless low < high, Key("stops.max"); value high, expected "more than \"min\"");
            let is_width = width >= 0.0 && width.is_finite();
            refuse!(unless is_width, Key("stops.smoothing");
                value width, expected "zero or a positive width");
        }
        let motion = &self.motion;
        let is_sound = motion.as_ref().is_none_or(|motion| motion.is_sound());
        refuse!(unless is_sound, Key("motion");
            found format!("{motion:?}"), expected "finite numbers and increasing times");
        Ok(())
    }
}

impl Muscle {
    fn check(&self) -> Checked {
        let (span, length) = (self.to.at - self.from.at, self.length());
        refuse!(unless span.norm() >= SHORTEST_SPAN, Key("to.at");
            found "the place where the muscle starts, which makes its length zero",
            expected "another place than \"from\"");
        let stretch = self.prestretch.unwrap_or(1.0);
        let is_stretch = stretch > 0.0 && stretch.is_finite();
        refuse!(unless is_stretch, Key("prestretch"); value stretch, expected "a positive stretch");
        for (index, side) in self.cross_section.into_iter().enumerate() {
            let at = format!("cross_section[{index}]");
            positive(&at, side)?;
            if side > WIDEST * length {
                let why = format!(", {:.0} lengths of the muscle", side / length);
                let expected = format!(
                    "a side of no more than {WIDEST} lengths of the muscle, {}; a number without a unit is in m",
                    millimetres(length)
                );
                return Err(Fault::of(at, side, &why, expected));
            }
        }
        positive("layer_thickness", self.layer_thickness)?;
        // The length of a stack of one layer is known to rounding.
        let is_inside = self.layer_thickness <= length * (1.0 + 1e-9);
        refuse!(unless is_inside, Key("layer_thickness");
        value self.layer_thickness,
        expected format!(
            "a layer no thicker than the muscle is long, {}, such as \"50 um\"; a number without a unit is in m",
            millimetres(length)
        ));
        self.material
            .check()
            .map_err(|fault| fault.under("material"))?;
        if let Some(circuit) = self.circuit {
            let checked = circuit.check(self.takes_circuit(), self.is_meshed());
            checked.map_err(|fault| fault.under("circuit"))?;
        }
        match &self.fidelity {
            Fidelity::Lumped => Ok(()),
            Fidelity::FiniteElements(mesh) => self.check_elements(mesh, &span),
        }
    }

    fn check_elements(&self, mesh: &Discretisation, span: &Vector) -> Checked {
        refuse!(if self.section_inertia, Key("section_inertia");
            found "\"section_inertia\" of a muscle of finite elements",
            expected "no such key, as all inertia of finite elements counts");
        refuse!(unless mesh.element.cell() == Cell::Hexahedron, Key("element");
            found format!("a kind of {}", mesh.element.cell().names()), expected "one of hexahedra, into which a muscle is cut");
        check_elements(mesh.elements).map_err(|fault| fault.under("elements"))?;
        let (along, layers) = (mesh.elements[2], mesh.layers);
        refuse!(unless layers > 0 && along.is_multiple_of(layers), Key("layers");
            value layers, expected format!("a divisor of the {along} elements along the span"));
        if let Some(side) = mesh.first_side {
            let is_across = span.cross(&side).norm() > ALONG * span.norm() * side.norm();
            let found = format!("{:?}", side.as_slice());
            let expected = "a direction across the span";
            let along = || Fault::of("first_side", found, ", along the span", expected);
            is_across.then_some(()).ok_or_else(along)?;
        }
        let checked = self.material.check_of_elements();
        checked.map_err(|fault| fault.under("material"))
    }
}

/// A length in mm.
fn millimetres(length: f64) -> String {
    format!("{} mm", shortest(length, 6))
}

/// Refuses a mesh without elements in some direction, or with too many.
///
/// # Errors
/// The direction, or the whole.
pub fn check_elements(elements: [usize; 3]) -> Result<(), Fault> {
    for (axis, count) in elements.into_iter().enumerate() {
        refuse!(unless count > 0, Key(format_args!("[{axis}]"));
            value count, expected "1 element or more");
    }
    let mut counts = elements.iter();
    let total = counts.try_fold(1_usize, |total, &count| total.checked_mul(count));
    let is_built = total.is_some_and(|total| total <= MOST_ELEMENTS);
    refuse!(unless is_built, WHOLE;
        found format!("{elements:?}"),
        expected format!("no more than {MOST_ELEMENTS} elements in all"));
    Ok(())
}

impl Solid {
    fn check(&self) -> Checked {
        let whole = |error| Fault::new("", error, "a mesh that can be computed with");
        self.mesh.check().map_err(whole)?;
        let (kind, cell) = (self.element, self.mesh.cell());
        refuse!(unless kind.cell() == cell, Key("element");
            found format!("a kind of {}", kind.cell().names()),
            expected format!("one of {}, of which the mesh consists", cell.names()));
        let is_surface = cell == Cell::Triangle;
        refuse!(if is_surface && !self.is_membrane(), Key("thickness");
            found "a mesh of triangles without a thickness",
            expected "the thickness of a membrane without stress");
        refuse!(if !is_surface && self.is_membrane(), Key("thickness");
            found format!("the thickness of a mesh of {}", cell.names()),
            expected "no such key: membranes of triangles have a thickness");
        if let Some(thickness) = self.thickness {
            positive("thickness", thickness)?;
        }
        let of_electrodes = self.electrodes.iter().map(|e| &e.nodes);
        let mut sets = of_electrodes.chain(self.supports.iter().map(|s| &s.nodes));
        let count = self.mesh.nodes.len();
        let are_sets = sets.all(|set| !set.is_empty() && set.iter().all(|&n| n < count));
        refuse!(unless are_sets, WHOLE;
            found "an electrode or support without nodes",
            expected "the name of a set of the mesh");
        for electrode in &self.electrodes {
            let circuit = electrode
                .circuit
                .map(|circuit| circuit.check(electrode.is_driven(), true));
            let checked = circuit.unwrap_or(Ok(()));
            checked.map_err(|fault| fault.under("circuit").under(&electrode.name))?;
        }
        self.check_prestretch()?;
        for material in &self.materials {
            let of_elements = || match cell {
                Cell::Triangle => Ok(()),
                _ => material.check_of_elements(),
            };
            let checked = material.check().and_then(|()| of_elements());
            checked.map_err(|fault| fault.under("material"))?;
        }
        Ok(())
    }

    fn check_load(&self, load: &BlockLoad) -> Checked {
        let count = self.mesh.nodes.len();
        let mut nodes = load.faces().iter().flatten();
        let is_body_force = matches!(load, BlockLoad::BodyForce(_));
        let has_faces = nodes.all(|n| *n < count) && load.faces().is_empty() == is_body_force;
        refuse!(unless has_faces, WHOLE;
            found "a load without faces of its solid",
            expected "a part of the surface of the block");
        match load {
            BlockLoad::Traction(_, along) | BlockLoad::BodyForce(along) => {
                check_direction("direction", along)
            }
            BlockLoad::Charge(faces) => {
                refuse!(unless self.takes_charge(faces), WHOLE;
                    found "a charge that no potential feels",
                    expected "faces of a dielectric that touches an electrode at a voltage, other than those of this electrode");
                Ok(())
            }
            BlockLoad::Pressure { .. } => Ok(()),
        }
    }
}

impl Circuit {
    /// Checks its resistances, and that something can have it: `is_driven` if a source charges that, `is_meshed` if it consists of finite
    /// elements.
    ///
    /// # Errors
    /// The first rule that does not hold.
    pub(crate) fn check(&self, is_driven: bool, is_meshed: bool) -> Result<(), Fault> {
        let named = [("resistance", self.resistance), ("leakage", self.leakage)];
        let mut parts = named.into_iter().filter_map(|(at, part)| Some((at, part?)));
        parts.try_for_each(|(at, part)| positive(at, part))?;
        refuse!(unless *self != Self::default(), WHOLE;
            found "a circuit without parts", expected "\"resistance\", \"leakage\" or both");
        refuse!(unless is_driven, WHOLE;
            found "a circuit of what it does not charge",
            expected "a muscle with a permittivity, or a driven electrode");
        refuse!(unless !is_meshed || self.resistance.is_some(), WHOLE;
            found "a leak without a resistor, which takes current from the source alone",
            expected "\"resistance\" beside the \"leakage\" of finite elements, or no circuit");
        Ok(())
    }
}

impl Material {
    /// Checks its constants.
    ///
    /// # Errors
    /// The first one that makes no sense.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        positive("shear_modulus", self.shear_modulus)?;
        if let Some(density) = self.density {
            positive("density", density)?;
            refuse!(unless density <= DENSEST, Key("density");
                value density,
                expected "a density below 1e5 kg/m^3: that of silicone is \"1000 kg/m^3\", or \"1 g/cm^3\"");
        }
        self.viscosity
            .map_or(Ok(()), |viscosity| positive("viscosity", viscosity))?;
        let law = self.law.map_or(Ok(()), |law| law.check());
        law.map_err(|fault| fault.under("law"))?;
        // The bulk modulus λ + 2 μ/3 is positive.
        let lambda = self.lame_lambda.unwrap_or(0.0);
        let is_stable = lambda > -2.0 / 3.0 * self.shear_modulus && lambda.is_finite();
        refuse!(unless is_stable, Key("lame_lambda");
            value lambda, expected "a stress larger than -2/3 of the shear modulus");
        for (index, branch) in self.maxwell.list().iter().enumerate() {
            positive(
                format_args!("maxwell[{index}].shear_modulus"),
                branch.shear_modulus,
            )?;
            positive(
                format_args!("maxwell[{index}].relaxation_time"),
                branch.relaxation_time,
            )?;
        }
        let [low, high] = self.stretch_range.unwrap_or([1.0; 2]);
        let is_range = low > 0.0 && low <= 1.0 && high >= 1.0 && high.is_finite();
        refuse!(unless is_range, Key("stretch_range");
            found format!("[{low}, {high}]"),
            expected "two stretches with 1 between them, such as [0.6, 2]");
        Ok(())
    }

    /// Checks that finite elements can be made of it: it is compressible, and follows no law of principal stretches.
    ///
    /// # Errors
    /// It does not.
    pub(crate) fn check_of_elements(&self) -> Result<(), Fault> {
        if let Some(ElasticLaw::Ogden { .. }) = self.law {
            let why = ", which follows Ogden's law";
            let expected = "a law of the invariants of the strain, as \"yeoh\": only lumped muscles follow Ogden's";
            return Err(Fault::of("", "a material", why, expected));
        }
        let why = ", which has neither \"lame_lambda\" nor \"poisson_ratio\"";
        let expected = "a material with one of them, as finite elements need it";
        let none = || Fault::of("", "a material", why, expected);
        self.lame_lambda.map(|_| ()).ok_or_else(none)
    }
}

/// A part of a system that makes no sense.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{list}.{}: found {}, expected {}", self.place(), fault.finding(), fault.expected)]
pub struct SystemError {
    /// List of the system that has the part, such as `springs`.
    pub list: &'static str,
    /// Its index there.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// The rule that does not hold.
    pub fault: Box<Fault>,
}

impl SystemError {
    /// The place of the fault in the list: `spring1.stiffness`.
    fn place(&self) -> String {
        self.fault.clone().under(&self.name).at
    }
}
