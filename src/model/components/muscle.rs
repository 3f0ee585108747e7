//! Terms of lumped muscles.

use crate::energy::{
    Capacitance, CoordinateDamper, DielectricCell, ElasticCell, ElasticLaw, Elasticity, Energy,
    MaxwellCell, NeoHooke, SectionInertia, ViscousCell,
};
use crate::functional::{Element, Mass};
use crate::kinematics::MaterialVector;
use crate::math::{Derivatives, Local, Vector};
use crate::model::components::sought_muscle::SoughtMuscle;
use crate::model::internal::{InternalKind, Internals};
use crate::model::maxwell::MaxwellBranch;
use crate::model::system::{ElectricConstants, Fidelity, Muscle};
use crate::model::terms::{Terms, UNRELAXED, mid, rate};
use nalgebra::SVector;

const INERTIA: &str = "muscle inertia";
const SECTION: &str = "section inertia";
const ELASTICITY: &str = "muscle elasticity";
const ELECTROELASTICITY: &str = "muscle electroelasticity";
/// Elasticity and electroelasticity by a law other than the neo-Hookean one.
const GENERAL: [&str; 2] = [
    "general muscle elasticity",
    "general muscle electroelasticity",
];
const VISCOSITY: &str = "muscle viscosity";
const MAXWELL_ELASTICITY: &str = "maxwell elasticity";
const MAXWELL_VISCOSITY: &str = "maxwell viscosity";
/// Electric energy of muscles whose charge is given, or flows through a circuit.
pub(in crate::model) const CHARGES: &str = "muscle charges";

/// Terms of the muscles of a scene, of which those of finite elements are blocks; `spans` are the vectors of their spans.
pub(in crate::model) fn build(
    muscles: &[Muscle],
    spans: &[usize],
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    for (m, (muscle, &span)) in muscles.iter().zip(spans).enumerate() {
        if muscle.fidelity == Fidelity::Lumped {
            match terms.is_of_motion() {
                true => lumped(muscle, m, span, terms),
                false => lumped(&muscle.at_rest(), m, span, terms),
            }
            match terms.is_instantaneous() {
                true => unrelaxed(muscle, span, terms),
                false => relaxation(muscle, m, span, internals, terms),
            }
        }
    }
    terms.without_branches(
        [MAXWELL_ELASTICITY, MAXWELL_VISCOSITY],
        "no lumped muscle that moves names a Maxwell branch",
    );
    for term in GENERAL {
        terms.without(term, "no lumped muscle names a law of elasticity");
    }
    // What no muscle has said.
    for term in [INERTIA, SECTION, ELASTICITY, ELECTROELASTICITY, VISCOSITY] {
        terms.without(term, "no lumped muscle");
    }
}

/// Between two points that do not move nothing is left of a muscle without voltage.
fn lumped(muscle: &Muscle, source: usize, span: usize, terms: &mut Terms<'_>) {
    // Behind a resistor a source drives a charge.
    let is_direct = !muscle.is_behind_resistor() || !terms.is_of_motion();
    let input = terms.input(source).filter(|_| is_direct);
    if input.is_none() && terms.is_immobile(&[muscle.from, muscle.to]) {
        for term in [INERTIA, SECTION, ELASTICITY, ELECTROELASTICITY, VISCOSITY] {
            terms.without(term, "no lumped muscle that moves");
        }
        return;
    }
    inertia(muscle, span, terms);
    let sought = SoughtMuscle::new(muscle, source, span, terms);
    match muscle.material.law {
        None => {
            let named = [ELASTICITY, ELECTROELASTICITY];
            elasticity(
                muscle,
                (NeoHooke, named),
                sought.as_ref(),
                (input, span),
                terms,
            );
        }
        Some(law) => {
            let is_driven = input.is_some() && muscle.material.electric.is_some();
            terms.note(GENERAL[usize::from(is_driven)], named(law), &muscle.name);
            elasticity(
                muscle,
                (law, GENERAL),
                sought.as_ref(),
                (input, span),
                terms,
            );
            for term in [ELASTICITY, ELECTROELASTICITY] {
                terms.without(term, "every lumped muscle names a law of elasticity");
            }
        }
    }
    viscosity(muscle, sought.as_ref(), span, terms);
}

/// A uniform rod: m/6 (|va|² + va·vb + |vb|²) = m/2 |v_mid|² + m/24 |ṙ|², its weight, and the inertia of its section.
fn inertia(muscle: &Muscle, span: usize, terms: &mut Terms<'_>) {
    let name = &muscle.name;
    let Some(mass) = muscle.mass() else {
        terms.without(INERTIA, "no lumped muscle names a density");
        return terms.without(SECTION, "no muscle with a density names section_inertia");
    };
    let ends = [&muscle.from, &muscle.to].map(|end| terms.point(end));
    let middle = MaterialVector::combine(0.5, &ends[0], 0.5, &ends[1]);
    terms.weigh(&middle, mass);
    if !terms.is_of_motion() {
        for term in [INERTIA, SECTION] {
            terms.without(term, "a state of rest has no inertia");
        }
        return;
    }
    let middle = terms.vector(middle);
    terms.collect(INERTIA, "density of", name, Mass::point(middle, mass));
    terms.collect(INERTIA, "density of", name, Mass::point(span, mass / 12.0));
    if !muscle.section_inertia {
        return terms.without(SECTION, "no muscle with a density names section_inertia");
    }
    let [x, y] = muscle.cross_section;
    let energy = SectionInertia {
        length: muscle.length(),
        moment: mass * (x * x + y * y) / 192.0,
    };
    let element = Element {
        energy,
        vectors: [mid(span), rate(span)],
        scalars: [],
    };
    terms.add_kinetic(SECTION, "density and section_inertia of", name, element);
}

/// A law as the reason for a term.
fn named(law: ElasticLaw) -> &'static str {
    match law {
        ElasticLaw::Gent { .. } => "Gent's law of",
        ElasticLaw::MooneyRivlin { .. } => "Mooney and Rivlin's law of",
        ElasticLaw::Yeoh { .. } => "Yeoh's law of",
        ElasticLaw::Ogden { .. } => "Ogden's law of",
    }
}

pub(in crate::model) fn elastic<L>(muscle: &Muscle, law: L) -> ElasticCell<L> {
    ElasticCell {
        length: muscle.length(),
        volume: muscle.volume(),
        shear_modulus: muscle.material.shear_modulus,
        law,
    }
}

pub(in crate::model) fn dielectric<L>(
    muscle: &Muscle,
    electric: ElectricConstants,
    law: L,
) -> DielectricCell<L> {
    DielectricCell {
        elastic: elastic(muscle, law),
        c1: electric.c1,
        c2: electric.c2,
        permittivity: electric.permittivity,
        layer: muscle.layer_thickness,
    }
}

/// Capacitance of a lumped muscle; none of a muscle of finite elements, or without electric constants.
pub fn capacitance(muscle: &Muscle) -> Option<Capacitance> {
    let electric = muscle.material.electric?;
    let cell = dielectric(muscle, electric, NeoHooke);
    (muscle.fidelity == Fidelity::Lumped).then_some(Capacitance { cell })
}

/// Force in N with which a lumped muscle pulls its ends together, at a span r with its rate, a voltage between the electrodes, and the
/// logarithms of the viscous stretches of its branches: `∂W/∂r·r/|r|` with the viscous force.
pub(in crate::model) fn tension(
    muscle: &Muscle,
    [r, rate]: [&Vector; 2],
    voltage: Option<f64>,
    viscous: impl Iterator<Item = f64>,
) -> f64 {
    let mut force = match muscle.material.law {
        None => potential_force((muscle, NeoHooke), r, voltage),
        Some(law) => potential_force((muscle, law), r, voltage),
    };
    for (constants, z) in muscle.material.maxwell.list().iter().zip(viscous) {
        let energy = branch_cell(muscle, constants);
        force += first_force(&energy, [r.x, r.y, r.z, z, 0.0, 0.0]);
    }
    if let Some(viscosity) = muscle.material.viscosity {
        // A virtual work: its force is that on the muscle.
        let v = rate;
        let arguments = [0.0, 0.0, 0.0, r.x, r.y, r.z, v.x, v.y, v.z];
        force -= first_force(&viscous_cell(muscle, viscosity), arguments);
    }
    force.dot(r) / r.norm()
}

/// Elastic force and that of a voltage, by a law of elasticity.
fn potential_force<L: Elasticity>(
    (muscle, law): (&Muscle, L),
    r: &Vector,
    voltage: Option<f64>,
) -> Vector {
    match (muscle.material.electric, voltage) {
        (Some(electric), Some(v)) => {
            first_force(&dielectric(muscle, electric, law), [r.x, r.y, r.z, v])
        }
        _ => first_force(&elastic(muscle, law), [r.x, r.y, r.z]),
    }
}

/// Derivative of an energy by its first vector.
fn first_force<E: Energy<M>, const M: usize>(energy: &E, arguments: [f64; M]) -> Vector {
    let local = energy.at::<1>(&SVector::from(arguments), &SVector::zeros());
    local.plain::<1>().force(0)
}

pub(in crate::model) fn viscous_cell(muscle: &Muscle, viscosity: f64) -> ViscousCell {
    ViscousCell {
        coefficient: 1.5 * viscosity * muscle.volume(),
    }
}

pub(in crate::model) fn branch_cell(muscle: &Muscle, constants: &MaxwellBranch) -> MaxwellCell {
    MaxwellCell {
        length: muscle.length(),
        volume: muscle.volume(),
        shear_modulus: constants.shear_modulus,
    }
}

fn elasticity<L: Elasticity>(
    muscle: &Muscle,
    (law, [elasticity, electroelasticity]): (L, [&'static str; 2]),
    sought: Option<&SoughtMuscle<'_>>,
    (input, span): (Option<usize>, usize),
    terms: &mut Terms<'_>,
) {
    let (vectors, name) = ([mid(span)], &muscle.name);
    match (muscle.material.electric, input) {
        (Some(electric), Some(voltage)) => {
            let element = Element {
                energy: dielectric(muscle, electric, law),
                vectors,
                scalars: [voltage],
            };
            let why = "electric constants and a voltage of";
            let named = (electroelasticity, why);
            if !sought.is_some_and(|sought| sought.energy(input, named, terms)) {
                terms.add(electroelasticity, why, name, element);
            }
            terms.without(elasticity, "every lumped muscle takes a voltage");
        }
        (electric, _) => {
            let why = match electric {
                Some(_) if muscle.is_behind_resistor() && terms.is_of_motion() => "a circuit of",
                Some(_) => "0 V all the time at",
                None => "no electric constants of",
            };
            let element = Element {
                energy: elastic(muscle, law),
                vectors,
                scalars: [],
            };
            if !sought.is_some_and(|sought| sought.energy(None, (elasticity, why), terms)) {
                terms.add(elasticity, why, name, element);
            }
            terms.without(
                electroelasticity,
                "no lumped muscle takes a voltage other than 0",
            );
        }
    }
}

fn viscosity(
    muscle: &Muscle,
    sought: Option<&SoughtMuscle<'_>>,
    span: usize,
    terms: &mut Terms<'_>,
) {
    match muscle.material.viscosity {
        _ if !terms.is_of_motion() => {
            terms.without(VISCOSITY, "a state of rest dissipates nothing");
        }
        None => terms.without(VISCOSITY, "no lumped muscle names a viscosity"),
        Some(viscosity) => {
            let element = Element {
                energy: viscous_cell(muscle, viscosity),
                vectors: [mid(span), mid(span), rate(span)],
                scalars: [],
            };
            let named = (VISCOSITY, "viscosity of");
            if !sought.is_some_and(|sought| sought.viscosity(viscosity, named, terms)) {
                terms.add(VISCOSITY, "viscosity of", &muscle.name, element);
            }
        }
    }
}

/// Springs of Maxwell branches that have no stress in the reference configuration.
fn unrelaxed(muscle: &Muscle, span: usize, terms: &mut Terms<'_>) {
    if terms.is_immobile(&[muscle.from, muscle.to]) {
        return;
    }
    for constants in muscle.material.maxwell.list() {
        let energy = ElasticCell {
            length: (muscle.to.at - muscle.from.at).norm(),
            volume: muscle.volume(),
            shear_modulus: constants.shear_modulus,
            law: NeoHooke,
        };
        let element = Element {
            energy,
            vectors: [mid(span)],
            scalars: [],
        };
        terms.add(MAXWELL_ELASTICITY, UNRELAXED, &muscle.name, element);
    }
}

/// Maxwell branches: a spring of the elastic stretch and a damper of the viscous one, whose logarithm is an internal coordinate.
fn relaxation(
    muscle: &Muscle,
    index: usize,
    span: usize,
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    for (branch, constants) in muscle.material.maxwell.list().iter().enumerate() {
        let kind = InternalKind::Branch {
            muscle: index,
            branch,
        };
        let Some(viscous) = internals.vector(kind) else {
            continue;
        };
        let viscous = terms.vector(viscous);
        let why = "Maxwell branches of";
        let element = Element {
            energy: branch_cell(muscle, constants),
            vectors: [mid(span), mid(viscous)],
            scalars: [],
        };
        terms.add::<_, 6, 2, 0>(MAXWELL_ELASTICITY, why, &muscle.name, element);
        let damper = CoordinateDamper {
            coefficient: 3.0
                * constants.relaxation_time
                * constants.shear_modulus
                * muscle.volume(),
        };
        let element = Element {
            energy: damper,
            vectors: [mid(viscous), rate(viscous)],
            scalars: [],
        };
        terms.add::<_, 6, 2, 0>(MAXWELL_VISCOSITY, why, &muscle.name, element);
    }
}
