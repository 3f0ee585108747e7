//! A system whose components read free parameters of every kind.

use super::cases::{control, joints};
use super::systems::{blocks, branched, tied};
use super::trunk;
use nalgebra::Vector3;
use proboscis::control::problem::{Control, Duration, Guess, Voltages};
use proboscis::functional::MOST_PARAMETERS;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::{
    Attachment, Circuit, Discretisation, ElasticLaw, ElementKind, Fidelity, JointSpring, Marker,
    Material, MaxwellBranch, MaxwellBranches, System,
};
use proboscis::model::{Constant, Follower, MaterialConstant, Parameter};

/// The branched tree under gravity, tied by springs whose ends turn with it and a tendon, with a spring at a joint, a law of elasticity and Maxwell
/// branches.
pub fn robot() -> System {
    let mut system = tied(branched());
    for muscle in &mut system.muscles {
        muscle.material.viscosity = Some(1.3);
    }
    system.gravity = Some(Vector3::new(1e-3, -9.81e-3, 2e-3));
    system.muscles[2].material.law = Some(ElasticLaw::Gent { limit: 30.0 });
    let branch = MaxwellBranch {
        shear_modulus: 0.05,
        relaxation_time: 25.0,
    };
    system.muscles[3].material.maxwell = MaxwellBranches::new(&[branch, branch]).unwrap();
    system.joints[2].spring = Some(JointSpring {
        stiffness: 300.0,
        rest: 0.1,
    });
    system
}

/// A parameter with a guess, half and double of which are its bounds; or about zero by 5.
pub fn parameter(name: &str, constants: &[(Constant, f64)], guess: f64) -> Parameter {
    let [lower, upper] = match guess == 0.0 {
        true => [-5.0, 5.0],
        false => [0.5, 2.0].map(|factor| factor * guess),
    };
    Parameter {
        name: name.into(),
        constants: constants
            .iter()
            .map(|&(constant, factor)| Follower {
                constant,
                factor,
                offset: 0.0,
                higher: [0.0; 2],
            })
            .collect(),
        lower: lower.min(upper),
        upper: upper.max(lower),
        guess,
    }
}

/// A constant of the material of all muscles, from a guess between bounds.
pub fn of_all_muscles(
    system: &System,
    (name, constant): (&str, MaterialConstant),
    [lower, guess, upper]: [f64; 3],
) -> Parameter {
    let all = 0..system.muscles.len();
    Parameter {
        name: name.into(),
        constants: all.map(|m| Follower::from(constant.of_muscle(m))).collect(),
        lower,
        upper,
        guess,
    }
}

/// Parameters of every kind: shared by several muscles, and several in one.
pub fn parameters(system: &System) -> Vec<Parameter> {
    use Constant as C;
    use MaterialConstant as M;
    let place = |end: &Attachment, axis: usize| end.at[axis];
    let muscles = &system.muscles;
    let of = |constant: M, muscle: usize| constant.of_muscle(muscle);
    vec![
        parameter(
            "shear modulus",
            &[(of(M::ShearModulus, 0), 1.0), (of(M::ShearModulus, 2), 1.5)],
            0.12,
        ),
        parameter(
            "viscosity",
            &[
                (of(M::Viscosity, 0), 1.0),
                (of(M::Viscosity, 1), 0.5),
                (of(M::Viscosity, 3), 2.0),
            ],
            0.8,
        ),
        parameter(
            "permittivity",
            &[
                (of(M::C1, 0), -1e-12),
                (of(M::C2, 0), 0.5e-12),
                (of(M::Permittivity, 1), 1.1e-12),
            ],
            26.0,
        ),
        parameter("width", &[(C::Side(0, 0), 1.0), (C::Side(3, 1), 0.8)], 9.0),
        parameter("layer", &[(C::Layer(1), 1.0)], 0.05),
        parameter(
            "arm",
            &[
                (C::End(0, 0, 0), 1.0),
                (C::End(0, 1, 0), 1.0),
                (C::End(2, 1, 2), -0.5),
            ],
            place(&muscles[0].from, 0),
        ),
        parameter("end", &[(C::End(0, 1, 1), 1.0)], place(&muscles[0].to, 1)),
        parameter(
            "density",
            &[(of(M::Density, 0), 1.0), (of(M::Density, 1), 1.2)],
            1.1e-3,
        ),
        parameter("limit", &[(of(M::Law("limit"), 2), 1.0)], 30.0),
        parameter(
            "branch",
            &[
                (of(M::BranchModulus(0), 3), 1.0),
                (of(M::BranchModulus(1), 3), 0.5),
            ],
            0.05,
        ),
        parameter("time", &[(of(M::RelaxationTime(1), 3), 1.0)], 25.0),
        parameter(
            "mass",
            &[
                (C::Mass(2), 1.0),
                (C::Inertia(2, 0), 180.0),
                (C::Inertia(2, 2), 150.0),
            ],
            20.0,
        ),
        parameter("gravity", &[(C::Gravity(1), -1.0)], 9.81e-3),
        parameter("tendon stiffness", &[(C::TendonStiffness(0), 1.0)], 0.012),
        parameter("tendon length", &[(C::TendonLength(0), 1.0)], 80.0),
        parameter("joint stiffness", &[(C::JointStiffness(2), 1.0)], 300.0),
        parameter("joint rest", &[(C::JointRest(2), 1.0)], 0.1),
        parameter(
            "spring end",
            &[(C::SpringEnd(0, 0, 0), 1.0), (C::SpringEnd(0, 1, 2), 0.3)],
            30.0,
        ),
        parameter("spring stiffness", &[(C::SpringStiffness(0), 1.0)], 0.03),
        parameter("spring length", &[(C::SpringLength(0), 1.0)], 35.0),
        parameter(
            "spring damping",
            &[(C::SpringDamping(0), 1.0), (C::SpringDamping(1), 1.0)],
            0.5,
        ),
        parameter("slide damping", &[(C::JointDamping(1), 1.0)], 0.3),
        parameter("hinge damping", &[(C::JointDamping(2), 1.0)], 40.0),
    ]
}

/// Least effort over three intervals from a bent posture, or voltages given over time.
pub fn problem(system: &System, is_free: bool, course: Option<Voltages>) -> Control {
    let mut control = control(system, 3);
    control.start = joints(&[(0, 0.2), (1, 3.0), (2, -0.3)]);
    control.goal = joints(&[]);
    control.parameters = parameters(system);
    control.guess = Guess::Interpolate;
    control.course = course;
    if is_free {
        control.duration = Duration::Free {
            min: 10.0,
            max: 90.0,
            guess: 30.0,
        };
    }
    control
}

/// A muscle and a block of finite elements under gravity, and constants of both in which their energies and viscous works are linear.
pub fn elements() -> (System, Vec<Parameter>) {
    use MaterialConstant as M;
    let mut system = blocks();
    system.gravity = Some(Vector3::new(1e-3, -9.81e-3, 2e-3));
    // The unit of potentials is that of the stiffest material: one that nothing is made of, so that no parameter changes it.
    let solid = &mut system.solids[0];
    let stiff = Material {
        shear_modulus: 100.0,
        ..solid.materials[0]
    };
    solid.materials.push(stiff);
    solid.mesh.region_names.push("nothing".into());
    let of_both = |constant: M| [(constant.of_muscle(0), 1.0), (constant.of_block(0, 0), 1.3)];
    let parameters = vec![
        parameter("modulus", &of_both(M::ShearModulus), 0.12),
        parameter("lambda", &[(M::LameLambda.of_block(0, 1), 1.0)], 2.5),
        parameter(
            "ratio",
            &[
                (M::C1.of_muscle(0), -1e-12),
                (M::C2.of_muscle(0), 0.5e-12),
                (M::Permittivity.of_block(0, 0), 0.4e-12),
            ],
            20.0,
        ),
        Parameter {
            constants: vec![
                M::Viscosity.of_muscle(0).into(),
                Follower {
                    higher: [0.2, 0.1],
                    ..M::Viscosity.of_block(0, 0).into()
                },
            ],
            ..parameter("viscosity", &[], 0.9)
        },
        parameter("density", &of_both(M::Density), 1.2e-3),
    ];
    (system, parameters)
}

/// A segment of a trunk, one muscle of which is a finite element with a Maxwell branch, and the constants of the branch.
pub fn relaxing() -> (System, Vec<Parameter>) {
    use MaterialConstant as M;
    let mut system = trunk(1);
    system.muscles.truncate(1);
    let muscle = &mut system.muscles[0];
    muscle.fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 1],
        layers: 1,
        element: ElementKind::Hex8,
    });
    let branch = MaxwellBranch {
        shear_modulus: 0.03,
        relaxation_time: 9.0,
    };
    muscle.material.lame_lambda = Some(0.4);
    muscle.material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    let parameters = vec![
        parameter("branch", &[(M::BranchModulus(0).of_muscle(0), 1.0)], 0.04),
        parameter("time", &[(M::RelaxationTime(0).of_muscle(0), 1.0)], 12.0),
    ];
    (system, parameters)
}

/// The robot with a muscle behind a resistor with a leak and one that is prestretched, and constants of both.
pub fn wired() -> (System, Vec<Parameter>) {
    let mut system = robot();
    system.muscles[1].circuit = Some(Circuit {
        resistance: Some(2e7),
        leakage: Some(9e7),
    });
    system.muscles[2].prestretch = Some(1.2);
    let parameters = vec![
        parameter("resistance", &[(Constant::Resistance(1), 1.0)], 2e7),
        parameter("leak", &[(Constant::Leakage(1), 1.0)], 9e7),
        parameter("prestretch", &[(Constant::Prestretch(2), 1.0)], 1.2),
    ];
    (system, parameters)
}

/// The robot without branches, of one muscle of which all constants of one law are sought: as many as an element has room for.
pub fn crowded() -> (System, Vec<Parameter>) {
    use Constant as C;
    use MaterialConstant as M;
    let mut system = robot();
    let muscle = &mut system.muscles[0];
    muscle.material.maxwell = MaxwellBranches::default();
    muscle.material.law = Some(ElasticLaw::Ogden {
        exponents: [2.0, -2.5],
        share: 0.2,
    });
    muscle.prestretch = Some(1.1);
    let ends = (0..6).map(|i| C::End(0, i / 3, i % 3));
    let material = [
        M::ShearModulus,
        M::C1,
        M::C2,
        M::Permittivity,
        M::Law("exponents[0]"),
        M::Law("exponents[1]"),
        M::Law("share"),
    ];
    let others = [C::Prestretch(0), C::Side(0, 0), C::Side(0, 1), C::Layer(0)];
    let all = ends.chain(material.map(|c| c.of_muscle(0))).chain(others);
    let c1 = M::C1.of_muscle(0);
    let stiffness = C::SpringStiffness(0).value(&mut system).expect("a spring");
    let parameters = all.map(|constant| {
        let value = constant
            .value(&mut system)
            .expect("a constant of the muscle");
        // A voltage pulls by c₁ not at all: its parameter is the stiffness of a spring too.
        let other = (C::SpringStiffness(0), stiffness / value);
        let constants = [(constant, 1.0), other];
        let count = 1 + usize::from(constant == c1);
        parameter(&format!("{constant:?}"), &constants[..count], value)
    });
    let parameters: Vec<Parameter> = parameters.collect();
    assert_eq!(parameters.len(), MOST_PARAMETERS);
    (system, parameters)
}

/// The robot with a floating body, forces and a marker, and parameters that move joints, bodies, points of its tendon and all that is on them; a
/// moment of inertia goes with the square and the cube of one.
pub fn lengthened() -> (System, Vec<Parameter>) {
    use Constant as C;
    let mut system = robot();
    // A span of the tendon between points of one body.
    let through = &mut system.components.tendons[0].through;
    let last = *through.last().unwrap();
    through.push(Attachment {
        at: last.at + Vector3::new(1.0, 4.0, -2.0),
        ..last
    });
    let last = through.len() - 1;
    system.muscles[0].section_inertia = true;
    system.muscles[3].material.maxwell = MaxwellBranches::default();
    let mut free = system.bodies[1].clone();
    free.name = "kite".into();
    free.centre = Vector3::new(30.0, 90.0, -5.0);
    system.bodies.push(free);
    let kite = system.bodies.len() - 1;
    let end = |body, at: [f64; 3]| Attachment {
        body,
        at: Vector3::from(at),
    };
    let mut string = system.components.springs[0].clone();
    string.name = "string".into();
    string.from = end(Some(2), [1.0, 70.0, 2.0]);
    string.to = end(Some(kite), [28.0, 85.0, 0.0]);
    system.components.springs.push(string);
    let load = |name: &str, body, follows| Load {
        name: name.into(),
        on: LoadPlace::Point {
            at: end(Some(body), [4.0, 60.0, 3.0]),
            direction: Vector3::new(0.6, 0.0, 0.8),
            follows,
        },
    };
    system.components.loads = vec![load("dead", 2, false), load("following", 1, true)];
    system.markers = vec![Marker {
        name: "tip".into(),
        point: end(Some(2), [2.0, 95.0, 1.0]),
        solid: None,
    }];
    let of = |constants: &[(C, f64)], guess: f64| parameter("", constants, guess);
    let places = |list: &[(C, f64)], system: &mut System, name: &str| {
        // At the guess each constant is what it is in the system.
        let mut made = of(list, 50.0);
        made.name = name.into();
        for one in &mut made.constants {
            one.offset = one.constant.value(system).unwrap() - 50.0 * one.factor;
        }
        made
    };
    let stem = [
        (C::BodyPlace(0, 1), 0.5),
        (C::JointPlace(1, 1), 1.0),
        (C::JointPlace(2, 1), 1.0),
        (C::BodyPlace(1, 1), 1.2),
        (C::End(0, 1, 1), 1.0),
        (C::SpringEnd(0, 1, 0), 0.7),
        (C::TendonPoint(0, 1, 0), 0.1),
        (C::TendonPoint(0, last, 2), -0.2),
        (C::MarkerPlace(0, 1), 1.5),
    ];
    let mut stem = places(&stem, &mut system, "stem");
    let inertia = C::Inertia(0, 1);
    let given = inertia.value(&mut system).unwrap();
    stem.constants.push(Follower {
        constant: inertia,
        factor: 0.0,
        offset: 0.5 * given,
        higher: [0.3 * given / 2500.0, 0.2 * given / 125_000.0],
    });
    let aside = [
        (C::JointPlace(0, 2), 0.3),
        (C::JointPlace(2, 0), -0.4),
        (C::BodyPlace(2, 2), 0.6),
        (C::BodyPlace(kite, 0), 1.0),
        (C::MarkerPlace(0, 2), 0.9),
    ];
    let aside = places(&aside, &mut system, "aside");
    let mut mass = parameter("mass", &[(C::Mass(0), 1.0)], 20.0);
    mass.constants.push(Follower {
        constant: C::TendonStiffness(0),
        factor: 0.0,
        offset: 0.005,
        higher: [0.005 / 400.0, 0.0],
    });
    (system, vec![stem, aside, mass])
}
