//! Free parameters in optimal control: a muscle arm between bounds, and where a parameter is refused.

use crate::common::cases::{control, joints};
use crate::common::tracked::energies;
use crate::common::trunk;
use crate::optimality::{Optimum, solve};
use proboscis::State;
use proboscis::control::problem::{BoundaryState, Control, Duration, Limit, Rest};
use proboscis::control::{BoundaryConditions, BoundaryError};
use proboscis::ipopt::Start;
use proboscis::model::system::{Discretisation, ElementKind, Fidelity, System};
use proboscis::model::{
    Constant, Coordinates, Follower, MaterialConstant, Role, What, with_parameters,
};
use proboscis::prelude::{
    Body, GROUND, Joint, Material, Muscle, Parameter, X, g, kpa, kv, mm, ms, um,
};

/// A heavy body on one joint between two muscles without mass.
pub(crate) fn pair() -> System {
    let mut system = trunk(1);
    let body = &mut system.bodies[0];
    body.mass *= 15.0;
    body.inertia = body.inertia.map(|moment| 15.0 * moment);
    for muscle in &mut system.muscles {
        muscle.material.density = None;
    }
    system
}

/// The distance of both muscles from the axis, as one parameter.
pub(crate) fn arm(bounds: [f64; 2], guess: f64) -> Parameter {
    let end = |muscle: usize, end: usize, factor: f64| Follower {
        constant: Constant::End(muscle, end, 0),
        factor,
        offset: 0.0,
        higher: [0.0; 2],
    };
    Parameter {
        name: "arm".into(),
        constants: vec![
            end(0, 0, 1.0),
            end(0, 1, 1.0),
            end(1, 0, -1.0),
            end(1, 1, -1.0),
        ],
        lower: bounds[0],
        upper: bounds[1],
        guess,
    }
}

/// Least effort from rest to rest at an angle.
pub(crate) fn turn(system: &System) -> Control {
    Control {
        duration: Duration::Given(100.0),
        goal: joints(&[(0, 0.2)]),
        ..control(system, 15)
    }
}

/// The effort with a given arm, from the motion that was found: there are other optima, in which the muscles pull in another order.
fn effort(arm_length: f64, found: &Optimum) -> f64 {
    let system = with_parameters(&pair(), &[arm([1.0, 99.0], 15.0)], &[arm_length]);
    let from = Some((&found.discrete, found.h, None));
    let found = solve(&system, &turn(&system), from, Start::PRIMAL);
    assert!(found.solution.status.is_solved());
    found.solution.objective
}

#[test]
fn a_free_arm_lowers_the_effort_and_meets_the_conditions() {
    let system = pair();
    let with = |bounds, guess| Control {
        parameters: vec![arm(bounds, guess)],
        ..turn(&system)
    };
    let found = solve(&system, &with([4.0, 60.0], 15.0), None, Start::Cold);
    assert!(found.solution.status.is_solved());
    let scalars = found.model.variables.range(Role::Parameter);
    let best = found.discrete.scalars[0][scalars.start];
    println!(
        "arm {best}, {:?}, effort {}",
        found.conditions, found.solution.objective
    );
    assert!(best > 4.1 && best < 59.0);
    assert!(found.multipliers[0] > 1e-6);
    assert!(
        found.conditions.iter().all(|c| *c < 1e-7),
        "{:?}",
        found.conditions
    );
    // The same effort with the arm given, more with any other one: from there on one interval more is at the bound of the voltages,
    // so that the effort has a kink.
    let least = found.solution.objective;
    assert!((effort(best, &found) - least).abs() < 1e-8 * least);
    assert!(effort(15.0, &found) > 1.001 * least);
    let [shorter, longer] = [0.98, 1.02].map(|factor| effort(factor * best, &found));
    assert!(shorter > least && longer > least);
    // A bound that it would like to pass holds it.
    let bound = 0.5 * (best + 15.0);
    let bounds = if best < 15.0 {
        [bound, 30.0]
    } else {
        [4.0, bound]
    };
    let held = solve(
        &system,
        &with(bounds, 15.0_f64.clamp(bounds[0], bounds[1])),
        None,
        Start::Cold,
    );
    let at = held.discrete.scalars[0][scalars.start];
    assert!((at - bound).abs() < 1e-5 * bound, "{at} {bound}");
    assert!(held.solution.objective > least && held.conditions.iter().all(|c| *c < 1e-7));
}

/// Squared distance of the ends of a muscle of a trunk of one body at an angle about z, over that at rest.
fn stretch(system: &System, muscle: usize, angle: f64) -> f64 {
    let of = &system.muscles[muscle];
    let hinge = system.joints[0].at;
    let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), angle);
    assert!(of.from.body.is_none() && of.to.body == Some(0));
    let end = hinge + turn * (of.to.at - hinge);
    (end - of.from.at).norm() / (of.to.at - of.from.at).norm()
}

/// The stretch follows from the arm: where it is limited, the arm is shorter than the best one.
#[test]
fn a_free_arm_keeps_a_limit_of_a_stretch_that_it_changes() {
    let system = pair();
    let free = Control {
        parameters: vec![arm([4.0, 60.0], 15.0)],
        ..turn(&system)
    };
    let largest = |found: &Optimum| {
        let scalars = found.model.variables.range(Role::Parameter);
        let arm_length = found.discrete.scalars[0][scalars.start];
        let anew = with_parameters(&system, &free.parameters, &[arm_length]);
        let angles = found.discrete.z.iter().map(|z| z[0]);
        let stretches = angles.flat_map(|angle| [0, 1].map(|m| stretch(&anew, m, angle)));
        (arm_length, stretches.fold(0.0, f64::max))
    };
    let best = solve(&system, &free, None, Start::Cold);
    let (longer, without) = largest(&best);
    let max = 1.0 + 0.7 * (without - 1.0);
    let limit = |muscle| Limit::new(What::Stretch(muscle), [0.2, max]);
    let limited = Control {
        limits: vec![limit(0), limit(1)],
        ..free.clone()
    };
    let found = solve(&system, &limited, None, Start::Cold);
    assert!(best.solution.status.is_solved() && found.solution.status.is_solved());
    let (shorter, with) = largest(&found);
    println!("arm {longer} with {without}, {shorter} with {with}, at most {max}");
    assert!(without > 1.02 && shorter < 0.95 * longer);
    assert!((with - max).abs() < 1e-6);
    assert!(found.solution.objective > best.solution.objective);
    // Rows are no equations alone.
    let [stationarity, _, products, signs] = found.conditions;
    assert!([stationarity, products, signs].iter().all(|c| *c < 1e-7));
}

fn refusal(system: &System, control: &Control) -> String {
    match BoundaryConditions::resolve(system, control, 10.0) {
        Err(error @ BoundaryError::Parameter { .. }) => error.to_string(),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn parameters_are_refused_where_they_may_not_act() {
    let system = pair();
    let with = |parameters: Vec<Parameter>| Control {
        parameters,
        ..turn(&system)
    };
    let of = |constant: Constant, lower: f64, guess: f64, upper: f64| Parameter {
        name: "p".into(),
        constants: vec![constant.into()],
        lower,
        upper,
        guess,
    };
    let modulus = || of(MaterialConstant::ShearModulus.of_muscle(1), 0.05, 0.1, 0.2);
    let says = |control: Control, words: &str| {
        let text = refusal(&system, &control);
        assert!(text.contains(words), "{text}");
    };
    assert!(BoundaryConditions::resolve(&system, &with(vec![modulus()]), 10.0).is_ok());
    says(
        with(vec![of(
            MaterialConstant::ShearModulus.of_muscle(1),
            0.05,
            0.3,
            0.2,
        )]),
        "within the bounds",
    );
    says(
        with(vec![of(
            MaterialConstant::ShearModulus.of_muscle(1),
            -0.1,
            0.1,
            0.2,
        )]),
        "positive",
    );
    says(
        with(vec![of(Constant::SpringLength(0), 1.0, 2.0, 3.0)]),
        "no spring",
    );
    says(
        with(vec![of(Constant::JointDamping(0), 1.0, 2.0, 3.0)]),
        "no damping",
    );
    let twice = Parameter {
        name: "q".into(),
        ..modulus()
    };
    says(with(vec![modulus(), twice]), "the same constant");
    says(with(vec![modulus(), modulus()]), "the same name");
    // A muscle at zero voltage has no electric energy, which alone reads its layers.
    let silent = Control {
        given: [(1, proboscis::Signal::Constant(0.0))].into(),
        ..with(vec![of(Constant::Layer(1), 0.01, 0.05, 0.1)])
    };
    says(silent, "nothing that moves reads it");
    // Equilibria under voltage depend on the modulus; without voltage they do not.
    let at_rest = Control {
        start: BoundaryState::RestAtVoltages(vec![0.0, 900.0], Rest::Everything),
        coordinates: Some(Coordinates::Redundant),
        ..with(vec![modulus()])
    };
    says(at_rest, "state of rest at the start depends on it");
    // Steps of charges from there are not offered, those of voltages are.
    let limited = |limit: Limit| Control {
        start: BoundaryState::RestAtVoltages(vec![0.0, 900.0], Rest::Everything),
        limits: vec![limit],
        ..with(vec![modulus()])
    };
    let (min, max) = (-1e3, 1e3);
    says(
        limited(Limit::new(What::Current(1), [min, max])),
        "is counted from there",
    );
    says(
        limited(Limit::new(What::Power(1), [min, max])),
        "is counted from there",
    );
    let rate = limited(Limit::of_rate(What::Voltage(1), [min, max]));
    assert!(BoundaryConditions::resolve(&system, &rate, 10.0).is_ok());
    // Energies of a muscle whose capacitance depends on one; not on its modulus, nor that of another muscle.
    let paid = |source: usize, parameter: Parameter| {
        let mut control = with(vec![parameter]);
        control.objective.energies = energies(&[(source, 1.0)], &[]);
        control
    };
    let layer = || of(Constant::Layer(1), 0.01, 0.05, 0.1);
    says(paid(1, layer()), "of the objective depends on it");
    says(
        paid(0, arm([4.0, 60.0], 15.0)),
        "of the objective depends on it",
    );
    for control in [paid(1, modulus()), paid(0, layer())] {
        assert!(BoundaryConditions::resolve(&system, &control, 10.0).is_ok());
    }
    // A mass that depends on one, where the motion starts with a velocity.
    let mut heavy = pair();
    heavy.muscles[1].material.density = Some(1e-3);
    let control = with(vec![arm([4.0, 60.0], 15.0)]);
    assert!(BoundaryConditions::resolve(&heavy, &control, 10.0).is_ok());
    let moving = Control {
        start: BoundaryState::JointAngles {
            angles: [].into(),
            rates: [(0, 1e-3)].into(),
            velocities: [].into(),
        },
        ..control
    };
    let text = refusal(&heavy, &moving);
    assert!(text.contains("momentum at the start"), "{text}");
    // A prestretched muscle of finite elements is free of stress across, by its constants.
    let mut stretched = pair();
    let muscle = &mut stretched.muscles[1];
    muscle.fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 1],
        layers: 1,
        element: ElementKind::Hex8,
    });
    muscle.material.lame_lambda = Some(0.4);
    let control = with(vec![modulus()]);
    assert!(BoundaryConditions::resolve(&stretched, &control, 10.0).is_ok());
    stretched.muscles[1].prestretch = Some(1.2);
    let text = refusal(&stretched, &control);
    assert!(text.contains("across the prestretch"), "{text}");
}

#[test]
fn the_library_seeks_a_thickness_as_it_is_known() {
    let silicone = Material::elastomer(kpa(100.0)).relative_permittivity(3.0);
    let mut system = System::new("slider");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    let muscle = Muscle::of(&silicone)
        .section(mm(10.0), mm(10.0))
        .layer(um(50.0));
    let muscle = system.add(muscle.from(GROUND, -X * mm(40.0)).to(cart, X * mm(0.0)));
    let goal = State::Joints(vec![(slide, mm(1.0))]);
    let problem = proboscis::Control::over(ms(100.0), 12)
        .goal(goal)
        .voltage_bounds(0.0, kv(9.0))
        .effort(1.0);
    let given = problem.clone().solve(&system).unwrap();
    assert!(given.is_solved() && given.objective > 1e-4 && given.parameters.is_empty());
    let layer = Parameter::new("layer", um(30.0)..=um(80.0), um(50.0)).is(muscle.layer_thickness());
    let found = problem.seek(layer).solve(&system).unwrap();
    assert!(found.is_solved());
    // Voltage and thickness enter as their ratio alone: the thinnest layers take least voltage, in proportion.
    let [parameter] = &found.parameters[..] else {
        panic!("one parameter");
    };
    assert!(parameter.is_at_bound && (parameter.value - um(30.0)).abs() < 1e-6 * um(30.0));
    let ratio = found.objective / given.objective;
    assert!((ratio - 0.36).abs() < 1e-5, "{ratio}");
}
