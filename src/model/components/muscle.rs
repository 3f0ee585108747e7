//! Terms of lumped muscles.

use crate::energy::{ElasticConstants, ElasticLaw, Energy, Law, NeoHooke};
use crate::functional::Mass;
use crate::kinematics::MaterialVector;
use crate::math::{Derivatives, Local, Vector};
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::construction::Construction;
use crate::model::layout::internal::{InternalKind, Internals};
use crate::model::system::{Fidelity, Muscle};
use crate::model::terms::{Call, Terms, UNRELAXED, mid, rate};
use nalgebra::SVector;
use std::borrow::Cow;

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
const OF_MASS: &str = "density of";
/// Parts of the ends of a muscle of which its middle is the sum.
const MIDDLE: [f64; 2] = [0.5; 2];
/// Electric energy of muscles whose charge is given, or flows through a circuit.
pub(in crate::model) const CHARGES: &str = "muscle charges";

/// Terms of the muscles of a scene, of which those of finite elements are blocks.
pub(in crate::model) fn build(of: &Construction<'_>, terms: &mut Terms<'_>) {
    for (m, muscle) in of.system.muscles.iter().enumerate() {
        if muscle.fidelity == Fidelity::Lumped {
            lumped(muscle, m, of.spans[m], terms);
            relaxation(muscle, m, of.spans[m], of.internals, terms);
        }
    }
    terms.without_branches([MAXWELL_ELASTICITY, MAXWELL_VISCOSITY]);
}

/// Between two points that do not move nothing is left of a muscle without voltage.
fn lumped(muscle: &Muscle, source: usize, span: usize, terms: &mut Terms<'_>) {
    if input(muscle, source, terms).is_none() && terms.is_immobile(&[muscle.from, muscle.to]) {
        terms.without_each(
            [INERTIA, SECTION, ELASTICITY, ELECTROELASTICITY, VISCOSITY],
            "no lumped muscle that moves",
        );
        return;
    }
    inertia(muscle, source, span, terms);
    material(muscle, source, span, terms);
}

/// Terms of the forces of a lumped muscle along its span but for those of charges.
pub(in crate::model) fn forces(of: &Construction<'_>, index: usize, terms: &mut Terms<'_>) {
    let (muscle, span) = (&of.system.muscles[index], of.spans[index]);
    material(muscle, index, span, terms);
    relaxation(muscle, index, span, of.internals, terms);
}

/// The scalar of the voltage between its electrodes: behind a resistor a source drives a charge.
fn input(muscle: &Muscle, source: usize, terms: &Terms<'_>) -> Option<usize> {
    let is_direct = !muscle.is_behind_resistor() || !terms.is_of_motion();
    terms.input(source).filter(|_| is_direct)
}

/// Elasticity, with the forces of a voltage, and viscosity.
fn material(muscle: &Muscle, source: usize, span: usize, terms: &mut Terms<'_>) {
    let input = input(muscle, source, terms);
    let muscle = match terms.is_of_motion() {
        true => Cow::Borrowed(muscle),
        false => muscle.at_rest(),
    };
    let constants = constants(&muscle, source, terms);
    match muscle.material.law {
        None => {
            let named = [ELASTICITY, ELECTROELASTICITY];
            elasticity(&constants, NeoHooke, named, input, span, terms);
        }
        Some(law) => {
            let is_driven = input.is_some() && muscle.material.electric.is_some();
            terms.note(GENERAL[usize::from(is_driven)], named(law), &muscle.name);
            let mut constants = constants.clone();
            let law = constants.law(law);
            elasticity(&constants, law, GENERAL, input, span, terms);
            terms.without_each(
                [ELASTICITY, ELECTROELASTICITY],
                "every lumped muscle names a law of elasticity",
            );
        }
    }
    viscosity(&constants, span, terms);
}

/// The constants of a muscle, by its index.
pub(in crate::model) fn constants<'a>(
    muscle: &'a Muscle,
    index: usize,
    terms: &mut Terms<'_>,
) -> MuscleConstants<'a> {
    by_parts(muscle, index, [-1.0, 1.0], terms)
}

/// The constants of a muscle whose elements read the sum of its ends by parts.
fn by_parts<'a>(
    muscle: &'a Muscle,
    index: usize,
    parts: [f64; 2],
    terms: &mut Terms<'_>,
) -> MuscleConstants<'a> {
    let read = terms.sought().read();
    let bodies = [&muscle.from, &muscle.to].map(|end| terms.carrier(end));
    MuscleConstants::new(muscle, index, read, parts, bodies, |moved| {
        terms.vector(moved)
    })
}

/// A uniform rod: m/6 (|va|² + va·vb + |vb|²) = m/2 |v_mid|² + m/24 |ṙ|², its weight, and the inertia of its section.
fn inertia(muscle: &Muscle, index: usize, span: usize, terms: &mut Terms<'_>) {
    let name = &muscle.name;
    let Some(mass) = muscle.mass() else {
        terms.without(INERTIA, "no lumped muscle names a density");
        return terms.without(SECTION, "no muscle with a density names section_inertia");
    };
    let ends = [&muscle.from, &muscle.to].map(|end| terms.point(end));
    let middle = MaterialVector::combine(0.5, &ends[0], 0.5, &ends[1]);
    let mut of_span = constants(muscle, index, terms);
    let section = of_span.section();
    let is_given = of_span.are_given();
    match is_given {
        true => terms.weigh(&middle, &mass.into(), terms.sought().read()),
        false => sought_weight(muscle, index, &middle, terms),
    }
    if !terms.is_of_motion() {
        terms.without_each([INERTIA, SECTION], "a state of rest has no inertia");
        return;
    }
    let middle = terms.vector(middle);
    if is_given {
        terms.collect(INERTIA, OF_MASS, name, Mass::point(middle, mass));
        terms.collect(INERTIA, OF_MASS, name, Mass::point(span, mass / 12.0));
    } else {
        let constants = by_parts(muscle, index, MIDDLE, terms);
        for (mut constants, vector, factor) in [
            (constants, middle, 1.0),
            (of_span.clone(), span, 1.0 / 12.0),
        ] {
            if let Some(mass) = constants.mass(factor) {
                terms.add_mass(Call(INERTIA, OF_MASS, name), vector, mass, constants.read());
            }
        }
    }
    match section.filter(|_| muscle.section_inertia) {
        None => terms.without(SECTION, "no muscle with a density names section_inertia"),
        Some(section) => {
            let element = of_span.element(section, [mid(span), rate(span)], []);
            terms.add_law(SECTION, "density and section_inertia of", name, element);
        }
    }
}

/// Adds the weight of a muscle whose mass is free, or whose ends are, where there is gravity.
fn sought_weight(muscle: &Muscle, index: usize, middle: &MaterialVector, terms: &mut Terms<'_>) {
    let mut constants = by_parts(muscle, index, MIDDLE, terms);
    if let Some(mass) = constants.mass(1.0) {
        terms.weigh(middle, &mass, constants.read());
    }
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

/// Force in N with which a lumped muscle pulls its ends together, at a span r with its rate, a voltage between the electrodes, and the
/// logarithms of the viscous stretches of its branches: `∂W/∂r·r/|r|` with the viscous force.
pub(in crate::model) fn tension(
    muscle: &Muscle,
    [r, rate]: [&Vector; 2],
    voltage: Option<f64>,
    viscous: impl Iterator<Item = f64>,
) -> f64 {
    let mut of = MuscleConstants::given(muscle);
    let mut force = match muscle.material.law {
        None => potential_force(muscle, NeoHooke, r, voltage),
        Some(law) => potential_force(muscle, law.map(|_, &c| c.into()), r, voltage),
    };
    let branches = muscle.material.maxwell.list().iter().enumerate();
    for ((branch, constants), z) in branches.zip(viscous) {
        let law = of.branch_spring(branch, constants);
        force += first_force(&law, [r.x, r.y, r.z, z, 0.0, 0.0]);
    }
    if let Some(viscosity) = muscle.material.viscosity {
        // A virtual work: its force is that on the muscle.
        let v = rate;
        let arguments = [0.0, 0.0, 0.0, r.x, r.y, r.z, v.x, v.y, v.z];
        force -= first_force(&of.viscous(viscosity), arguments);
    }
    force.dot(r) / r.norm()
}

/// Elastic force and that of a voltage, by a law of elasticity.
fn potential_force<L: ElasticConstants>(
    muscle: &Muscle,
    law: L,
    r: &Vector,
    voltage: Option<f64>,
) -> Vector {
    let mut of = MuscleConstants::given(muscle);
    match (muscle.material.electric, voltage) {
        (Some(electric), Some(v)) => first_force(&of.driven(electric, law), [r.x, r.y, r.z, v]),
        _ => first_force(&of.elastic(law), [r.x, r.y, r.z]),
    }
}

/// Derivative of the formula of a law by its first vector.
fn first_force<L: Law<M>, const M: usize>(law: &L, arguments: [f64; M]) -> Vector {
    let energy = law.formula::<f64>(&[]);
    let local = energy.at::<1>(&SVector::from(arguments), &SVector::zeros());
    local.plain::<1>().force(0)
}

fn elasticity<L: ElasticConstants>(
    constants: &MuscleConstants<'_>,
    law: L,
    names: [&'static str; 2],
    input: Option<usize>,
    span: usize,
    terms: &mut Terms<'_>,
) {
    let [elasticity, electroelasticity] = names;
    let muscle = constants.muscle();
    let (vectors, name) = ([mid(span)], &muscle.name);
    match (muscle.material.electric, input) {
        (Some(electric), Some(voltage)) => {
            let element = constants.with(|own| own.driven(electric, law), vectors, [voltage]);
            let why = "electric constants and a voltage of";
            terms.add_law(electroelasticity, why, name, element);
            terms.without(elasticity, "every lumped muscle takes a voltage");
        }
        (electric, _) => {
            let why = match electric {
                Some(_) if muscle.is_behind_resistor() && terms.is_of_motion() => "a circuit of",
                Some(_) => "0 V all the time at",
                None => "no electric constants of",
            };
            let element = constants.with(|own| own.elastic(law), vectors, []);
            terms.add_law(elasticity, why, name, element);
            terms.without(
                electroelasticity,
                "no lumped muscle takes a voltage other than 0",
            );
        }
    }
}

fn viscosity(constants: &MuscleConstants<'_>, span: usize, terms: &mut Terms<'_>) {
    let muscle = constants.muscle();
    match muscle.material.viscosity {
        _ if !terms.is_of_motion() => {
            terms.without(VISCOSITY, "a state of rest dissipates nothing");
        }
        None => terms.without(VISCOSITY, "no lumped muscle names a viscosity"),
        Some(viscosity) => {
            let vectors = [mid(span), mid(span), rate(span)];
            let element = constants.with(|own| own.viscous(viscosity), vectors, []);
            terms.add_law(VISCOSITY, "viscosity of", &muscle.name, element);
        }
    }
}

/// Springs of Maxwell branches that have no stress in the reference configuration.
fn unrelaxed(muscle: &Muscle, index: usize, span: usize, terms: &mut Terms<'_>) {
    if terms.is_immobile(&[muscle.from, muscle.to]) {
        return;
    }
    let known = constants(muscle, index, terms);
    for (branch, of) in muscle.material.maxwell.list().iter().enumerate() {
        let element = known.with(|own| own.unrelaxed_spring(branch, of), [mid(span)], []);
        terms.add_law(MAXWELL_ELASTICITY, UNRELAXED, &muscle.name, element);
    }
}

/// Maxwell branches: a spring of the elastic stretch and a damper of the viscous one, whose logarithm is an internal coordinate; springs
/// alone where they have not relaxed.
fn relaxation(
    muscle: &Muscle,
    index: usize,
    span: usize,
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    if terms.is_instantaneous() {
        return unrelaxed(muscle, index, span, terms);
    }
    let why = "Maxwell branches of";
    for (branch, of) in muscle.material.maxwell.list().iter().enumerate() {
        let kind = InternalKind::Branch {
            muscle: index,
            branch,
        };
        let Some(viscous) = internals.vector(kind) else {
            continue;
        };
        let viscous = terms.vector(viscous);
        let known = constants(muscle, index, terms);
        let vectors = [mid(span), mid(viscous)];
        let element = known.with(|own| own.branch_spring(branch, of), vectors, []);
        terms.add_law(MAXWELL_ELASTICITY, why, &muscle.name, element);
        let (still, vectors) = (known.still(), [mid(viscous), rate(viscous)]);
        let element = still.with(|own| own.branch_damper(branch, of), vectors, []);
        terms.add_law(MAXWELL_VISCOSITY, why, &muscle.name, element);
    }
}
