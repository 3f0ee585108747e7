//! Several motions in one optimisation: copies of one, derivatives, growth with their number, constants and inputs in common.

use crate::common::cases::{control, joints};
use crate::common::sought::of_all_muscles;
use crate::common::trunk;
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Combined, Control, CostFunction, Duration, During, Guess, Objective,
    QuantityCost, Voltages,
};
use proboscis::control::{BoundaryConditions, Motion, Motions, Transcription, guess};
use proboscis::dynamics::{Start as Initial, simulate};
use proboscis::kkt::{Plan, Unknown};
use proboscis::model::{MaterialConstant, Model, Parameter, Quantity, System, with_parameters};
use proboscis::nlp::joined::{Joined, SharedVariable};
use proboscis::nlp::{Nlp, Stage, differences};
use proboscis::workflow::{
    Iterate, SolveLimits, SolveRequest, Together, optimise, optimise_together,
};
use std::ops::ControlFlow;

const H: f64 = 5.0;
/// Constants of the material.
const TRUE: [f64; 2] = [0.137, 0.71];

/// Shear modulus and viscosity of all muscles, with these upper bounds.
fn material(system: &System, upper: [f64; 2]) -> Vec<Parameter> {
    let modulus = ("shear modulus", MaterialConstant::ShearModulus);
    let viscosity = ("viscosity", MaterialConstant::Viscosity);
    vec![
        of_all_muscles(system, modulus, [0.05, 0.1, upper[0]]),
        of_all_muscles(system, viscosity, [0.1, 0.5, upper[1]]),
    ]
}

/// Two inputs that excite the joint.
fn voltages(period: f64) -> Voltages {
    let sine = Signal::Sine {
        mean: 900.0,
        amplitude: 900.0,
        frequency: period.recip(),
        phase: 0.4,
    };
    Voltages::from(vec![sine, Signal::ramp(0.0, 900.0, 50.0)])
}

/// The joint coordinate of the motion of the true material, with errors that no constants explain.
fn measured(system: &System, intervals: usize, period: f64, error: f64) -> Signal {
    let system = with_parameters(system, &material(system, [0.5, 5.0]), &TRUE);
    let model = Model::new(system, None, H, &[]).unwrap();
    let zero = vec![0.0; model.joint_readings.len()];
    let start = Initial::at_rest(&model, model.coordinates_at(&zero));
    let scalars = |from: f64, to: f64| model.scalars(&voltages(period).at(0.5 * (from + to)));
    let (discrete, failure) = simulate(&model, &start, H, intervals, scalars, |_| {
        ControlFlow::Continue(())
    });
    assert!(failure.is_none());
    let angle = |z: &Vec<f64>| model.joints(&model.action.map.placed(z), &zero)[0];
    let angles: Vec<f64> = discrete.z.iter().map(angle).collect();
    let largest = angles.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(largest > 0.02, "a motion that moves: {largest}");
    let wrong = |(k, angle): (usize, f64)| angle + error * (1.7 * k as f64).sin();
    Signal::Table {
        times: discrete.times,
        values: angles.into_iter().enumerate().map(wrong).collect(),
    }
}

/// A motion that follows a measured one with given voltages: constants are sought.
fn fitted(system: &System, intervals: usize, period: f64, upper: [f64; 2]) -> Control {
    let reference = measured(system, intervals, period, 1e-3);
    Control {
        duration: Duration::Given(H * intervals as f64),
        goal: BoundaryState::Free,
        course: Some(voltages(period)),
        parameters: material(system, upper),
        objective: Objective {
            quantities: vec![QuantityCost {
                quantity: Quantity::joint(0, 0.0),
                weight: 1.0,
                function: CostFunction::Square { reference },
                during: During::Motion,
            }],
            ..Objective::default()
        },
        guess: Guess::Simulate(voltages(period)),
        ..control(system, intervals)
    }
}

pub(crate) fn motion(name: &str, system: &System, control: Control) -> Motion {
    Motion {
        name: name.into(),
        system: system.clone(),
        control,
    }
}

pub(crate) fn together(list: Vec<Motion>, shared_inputs: &[&str]) -> Together {
    together_by(list, shared_inputs, Combined::Sum)
}

pub(crate) fn together_by(
    list: Vec<Motion>,
    shared_inputs: &[&str],
    combined: Combined,
) -> Together {
    let shared_inputs = shared_inputs.iter().map(|name| name.to_string()).collect();
    let motions = Motions {
        list,
        shared_inputs,
        combined,
    };
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let request = SolveRequest::default();
    optimise_together(&motions.task(), request, go_on).expect("a problem that is right")
}

/// Does something with the programs of motions.
pub(crate) fn with_programs<R>(
    list: &[Motion],
    work: impl FnOnce(Vec<(String, Transcription<'_>)>, Vec<Vec<f64>>) -> R,
) -> R {
    let resolved: Vec<(Model, BoundaryConditions)> = list
        .iter()
        .map(|one| {
            let h = one.control.duration.first() / one.control.intervals as f64;
            BoundaryConditions::resolve(&one.system, &one.control, h).unwrap()
        })
        .collect();
    let (mut programs, mut points) = (Vec::new(), Vec::new());
    for (one, (model, boundary)) in list.iter().zip(&resolved) {
        let h = one.control.duration.first() / one.control.intervals as f64;
        let initial = guess(model, boundary, &one.control, h, None);
        let program = Transcription::new(model, boundary, &one.control, &initial).unwrap();
        points.push(program.start(&initial).x);
        programs.push((one.name.clone(), program));
    }
    work(programs, points)
}

/// The last variables of each program, as constants of the scene are, are shared.
pub(crate) fn last(count: usize, programs: &[(String, Transcription<'_>)]) -> Vec<SharedVariable> {
    let place = |k: usize| {
        let of = |(_, program): &(String, Transcription<'_>)| {
            (program.variables().lower.len() - count + k, 1.0)
        };
        SharedVariable::of_all(programs.iter().map(of))
    };
    (0..count).map(place).collect()
}

pub(crate) fn copies(system: &System, problem: &Control, count: usize) -> Vec<Motion> {
    let copy = |k: usize| motion(&format!("copy{k}"), system, problem.clone());
    (0..count).map(copy).collect()
}

#[test]
fn one_program_alone_keeps_its_numbers() {
    let system = trunk(1);
    let list = copies(&system, &fitted(&system, 20, 60.0, [0.5, 5.0]), 1);
    let numbers = |program: &mut dyn Nlp, x: &[f64]| -> Vec<u64> {
        let (n, m) = (x.len(), program.constraints().lower.len());
        let lengths = [program.jacobian_structure(), program.hessian_structure()];
        let [jacobian, hessian] = lengths.map(|entries| entries.rows.len());
        let mut all = vec![program.objective(x), program.objective_scale()];
        let mut part = |length: usize, write: &mut dyn FnMut(&mut [f64])| {
            let mut values = vec![f64::NAN; length];
            write(&mut values);
            all.extend(values);
        };
        let y: Vec<f64> = (0..m).map(|i| (i as f64).sin()).collect();
        part(n, &mut |values| program.gradient(x, values));
        part(m, &mut |values| program.constraint(x, values));
        part(jacobian, &mut |values| program.jacobian(x, values));
        part(hessian, &mut |values| program.hessian(x, 0.7, &y, values));
        all.iter().map(|value| value.to_bits()).collect()
    };
    with_programs(&list, |mut programs, points| {
        let alone = numbers(&mut programs[0].1, &points[0]);
        let structures = |program: &dyn Nlp| {
            let both = [program.jacobian_structure(), program.hessian_structure()];
            (
                both,
                program.stages(),
                program.squares(),
                program.variables().clone(),
            )
        };
        let before = structures(&programs[0].1);
        let mut joined = Joined::new(programs, &[]);
        assert_eq!(before, structures(&joined));
        let x = joined.places().values(&[&points[0]]);
        assert_eq!(alone, numbers(&mut joined, &x));
    });
}

#[test]
fn derivatives_of_several_programs_agree_with_differences() {
    let system = trunk(1);
    let mut other = system.clone();
    other.muscles[0].layer_thickness *= 1.2;
    let list = [
        motion("a", &system, fitted(&system, 12, 30.0, [0.5, 5.0])),
        motion("b", &other, fitted(&other, 10, 20.0, [0.5, 5.0])),
        motion("c", &system, fitted(&system, 11, 25.0, [0.5, 5.0])),
    ];
    with_programs(&list, |programs, points| {
        // A factor of two stands for programs in which a shared variable has another scale.
        let mut shared = last(2, &programs);
        shared[1].0[1].as_mut().unwrap().1 = 2.0;
        let mut joined = Joined::new(programs, &shared);
        let x = joined
            .places()
            .values(&points.iter().map(|x| &**x).collect::<Vec<_>>());
        assert_eq!(x.len(), points.iter().map(Vec::len).sum::<usize>() - 4);
        let report = differences::check(&mut joined, &x, 3);
        assert!(report.is_consistent(), "{report}");
        assert_eq!(joined.variable_name(x.len() - 1), "viscosity");
        assert!(
            joined.variable_name(0).starts_with("a: "),
            "{}",
            joined.variable_name(0)
        );
        assert!(
            joined
                .constraint_name(joined.constraints().lower.len() - 1)
                .starts_with("c: ")
        );
    });
}

#[test]
fn copies_of_one_motion_are_that_motion() {
    const COUNT: usize = 3;
    let system = trunk(1);
    // The bound of the viscosity is active.
    let problem = fitted(&system, 20, 60.0, [0.5, 0.6]);
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let one = optimise(&system, &problem, None, SolveLimits::default(), go_on).unwrap();
    assert!(one.is_solved());
    let all = together(copies(&system, &problem, COUNT), &[]);
    let scale = one.solution.objective;
    assert!(scale > 1e-8, "a fit that is not exact: {scale}");
    let near = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-9 * size, "{a} {b}");
    near(
        all.whole.objective,
        COUNT as f64 * scale,
        COUNT as f64 * scale,
    );
    let found = |optimum: &proboscis::workflow::Optimum| -> Vec<f64> {
        optimum
            .motion
            .parameters
            .iter()
            .map(|found| found.value)
            .collect()
    };
    let [modulus, viscosity] = found(&one)[..] else {
        panic!("two constants");
    };
    assert!(
        modulus > 0.06 && modulus < 0.45,
        "a bound is not active: {modulus}"
    );
    near(viscosity, 0.6, 10.0);
    let mut multiplier = 0.0;
    for optimum in &all.optima {
        assert!(optimum.is_solved());
        near(optimum.solution.objective, scale, scale);
        for (a, b) in found(optimum).into_iter().zip(found(&one)) {
            near(a, b, b);
        }
        let rows =
            |optimum: &proboscis::workflow::Optimum| optimum.motion.costates.clone().unwrap();
        let (own, single) = (rows(optimum), rows(&one));
        let largest = single.rows.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        assert!(largest > 0.0);
        own.rows
            .iter()
            .zip(&single.rows)
            .for_each(|(a, b)| near(*a, *b, 100.0 * largest));
        for (a, b) in optimum
            .motion
            .z
            .iter()
            .flatten()
            .zip(one.motion.z.iter().flatten())
        {
            near(*a, *b, 1.0);
        }
        multiplier += own.upper.last().unwrap();
    }
    let of_one = *one.motion.costates.as_ref().unwrap().upper.last().unwrap();
    assert!(of_one > 1e-6, "the bound is active: {of_one}");
    near(
        multiplier,
        COUNT as f64 * of_one,
        1e3 * COUNT as f64 * of_one,
    );
}

/// Entries of the program, and multiplications of a factorisation, of motions that share variables.
pub(crate) fn costs(
    list: &[Motion],
    shared: impl FnOnce(&[(String, Transcription<'_>)]) -> Vec<SharedVariable>,
) -> [f64; 3] {
    with_programs(list, |programs, _| {
        let shared = shared(&programs);
        let joined = Joined::new(programs, &shared);
        let (jacobian, hessian) = (joined.jacobian_structure(), joined.hessian_structure());
        let n = joined.variables().lower.len();
        let stages = joined.stages().expect("a horizon");
        let variable = |stage: &Stage| match *stage {
            Stage::Of(stage) => Unknown::Variable(stage),
            Stage::Multiplier(stage) => Unknown::Multiplier(stage),
            Stage::Border => Unknown::Border,
        };
        let mut unknowns: Vec<Unknown> = stages.iter().map(variable).collect();
        unknowns.resize(n + joined.constraints().lower.len(), Unknown::Equality);
        let below = |row: &u32| row + n as u32;
        let mut rows: Vec<u32> = jacobian.rows.iter().map(below).collect();
        let mut cols = jacobian.cols.clone();
        rows.extend(&hessian.rows);
        cols.extend(&hessian.cols);
        let diagonal = 0..unknowns.len() as u32;
        rows.extend(diagonal.clone());
        cols.extend(diagonal);
        let plan = Plan::new(unknowns.len(), &rows, &cols, Some(&unknowns));
        let nonzeros = [jacobian.rows.len(), hessian.rows.len()].map(|count| count as f64);
        [nonzeros[0], nonzeros[1], plan.multiplications()]
    })
}

#[test]
fn work_grows_in_proportion_to_the_number_of_motions() {
    let system = trunk(1);
    let given = fitted(&system, 20, 60.0, [0.5, 5.0]);
    // A duration of its own is a variable of each motion that couples all of its instants.
    let free = Control {
        duration: Duration::Free {
            min: 50.0,
            max: 200.0,
            guess: 100.0,
        },
        course: None,
        goal: joints(&[(0, 0.05)]),
        objective: Objective {
            effort: 1.0,
            ..Objective::default()
        },
        guess: Guess::Interpolate,
        ..given.clone()
    };
    for (problem, shared) in [(&given, 2), (&free, 0)] {
        let of = |count: usize| costs(&copies(&system, problem, count), |list| last(shared, list));
        let (few, many) = (of(4), of(64));
        for (small, large) in few.into_iter().zip(many) {
            assert!(small > 0.0);
            let growth = large / small;
            assert!(growth < 16.5 && growth > 15.0, "{few:?} {many:?}");
        }
    }
}

#[test]
fn one_value_of_each_constant_is_found_for_sixteen_motions() {
    let system = trunk(1);
    let period = |k: usize| 40.0 + k as f64;
    let list: Vec<Motion> = (0..16)
        .map(|k| {
            motion(
                &format!("m{k}"),
                &system,
                fitted(&system, 10, period(k), [0.5, 5.0]),
            )
        })
        .collect();
    let all = together(list, &[]);
    assert!(
        all.optima
            .iter()
            .all(|optimum| optimum.solution.status.is_solved())
    );
    let of = |k: usize| [0, 1].map(|i| all.optima[k].motion.parameters[i].value);
    assert!((1..16).all(|k| of(k) == of(0)));
}
