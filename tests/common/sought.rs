//! A system whose components read sought parameters of every kind.

use super::cases::{control, joints};
use super::systems::{branched, tied};
use proboscis::control::problem::{Control, Duration, Guess, Voltages};
use proboscis::model::system::{Attachment, System};
use proboscis::model::{Constant, DielectricLaw, Follower, Parameter};

/// The branched tree without masses of muscles, tied by springs whose ends turn with it.
pub fn robot() -> System {
    let mut system = tied(branched());
    for muscle in &mut system.muscles {
        muscle.material.density = None;
        muscle.section_inertia = false;
        muscle.material.viscosity = Some(1.3);
    }
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
            })
            .collect(),
        lower: lower.min(upper),
        upper: upper.max(lower),
        guess,
    }
}

/// Parameters of every kind: shared by several muscles, and several in one.
pub fn parameters(system: &System) -> Vec<Parameter> {
    use Constant as C;
    let place = |end: &Attachment, axis: usize| end.at[axis];
    let muscles = &system.muscles;
    vec![
        parameter(
            "shear modulus",
            &[(C::ShearModulus(0), 1.0), (C::ShearModulus(2), 1.5)],
            0.12,
        ),
        parameter(
            "viscosity",
            &[
                (C::Viscosity(0), 1.0),
                (C::Viscosity(1), 0.5),
                (C::Viscosity(3), 2.0),
            ],
            0.8,
        ),
        parameter(
            "permittivity",
            &[
                (C::Permittivity(0, DielectricLaw::FirstOrder), 1.0),
                (C::Permittivity(1, DielectricLaw::Ideal), 1.1),
            ],
            3.4,
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
