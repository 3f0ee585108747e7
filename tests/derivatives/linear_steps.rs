//! Linearised steps of the midpoint rule against differences of steps, and derivatives of momenta against differences.

use crate::common::remembering::{remembering, remembering_blocks};
use crate::common::systems::{blocks, branched, charged};
use crate::common::{at_reference, trunk};
use nalgebra::{DMatrix, DVector};
use proboscis::dynamics::{
    Independent, LinearStep, Linearisation, NoState, StepInput, Stepper, momentum_derivatives,
    step_inputs,
};
use proboscis::files::read_problem;
use proboscis::math::Random;
use proboscis::model::{Analysis, Coordinates, Model, Role, System};
use std::path::Path;

const STEP: f64 = 2.5;
/// A charge of a muscle, in mJ/V.
const CHARGE: f64 = 3e-3;

fn model(system: System) -> Model {
    let mut analysis = Analysis::of_motion(STEP);
    analysis.coordinates = Some(Coordinates::Reduced);
    Model::for_analysis(system, analysis).unwrap()
}

/// Independent coordinates near the reference.
fn independent(model: &Model) -> Independent {
    Independent::new(model, &[]).unwrap()
}

/// A four-bar whose joints have springs, also that which closes the loop.
fn four_bar() -> System {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let springs: Vec<String> = (0..4)
        .map(|joint| format!("scene.joints[{joint}].stiffness=0.05"))
        .collect();
    let loaded = read_problem(&root.join("problems/four_bar.json"), &springs).unwrap();
    loaded.system
}

/// A state of motion: coordinates, momenta, and scalars that are given.
struct State {
    z: Vec<f64>,
    momentum: Vec<f64>,
    inputs: Vec<f64>,
}

impl State {
    fn new(model: &Model, voltage: f64) -> Self {
        let mut random = Random::new(7);
        let mut draw = |size: f64| random.between(-size, size);
        let mut z = at_reference(model);
        let n = model.coordinate_count();
        let of_bodies = model.action.map.of_bodies;
        for (i, value) in z[..n].iter_mut().enumerate() {
            *value += match i < of_bodies {
                true => draw(0.1),
                false => draw(if model.is_memory(i) { 1e-3 } else { 0.03 }),
            };
        }
        let independent = independent(model);
        independent.close(model, &mut z, &mut vec![0.0; n]);
        let rates: Vec<f64> = (0..n).map(|_| draw(1e-3)).collect();
        let mut instant = model.action.map.placed(&z);
        let mut momentum = model.action.momentum(&mut instant, &rates);
        model.memory().for_each(|i| momentum[i] = 0.0);
        independent.reduce(model, &z, &mut momentum);
        let voltages = model.variables.range(Role::Voltage);
        let inputs = model.variables.sources_range();
        let size = |s: usize| {
            if voltages.contains(&s) {
                voltage
            } else {
                CHARGE
            }
        };
        let inputs = inputs.map(|s| size(s) * (1.0 + draw(0.1))).collect();
        Self {
            z,
            momentum,
            inputs,
        }
    }

    /// Coordinates, momenta and scalars after a step.
    fn after(&self, model: &Model) -> [Vec<f64>; 3] {
        let mut stepper = Stepper::new(model, &self.z, &self.momentum, Default::default());
        stepper.step(STEP, &self.inputs).unwrap();
        [
            stepper.coordinates().to_vec(),
            stepper.momentum().to_vec(),
            stepper.scalars().to_vec(),
        ]
    }
}

/// The linearised step from a state, and the same by differences.
fn both(model: &Model, state: &State) -> [LinearStep; 2] {
    let inputs = step_inputs(model);
    let independent = independent(model);
    let mut linearisation = Linearisation::new(model, &independent, &inputs);
    let [z, mut momentum, scalars] = state.after(model);
    let exact = linearisation.step([&state.z, &z], &scalars, STEP).unwrap();
    independent.reduce(model, &z, &mut momentum);
    let greatest = momentum.iter().fold(0.0_f64, |a, p| a.max(p.abs()));
    for (own, simulated) in exact.momentum.iter().zip(&momentum) {
        assert!((own - simulated).abs() < 1e-9 * greatest);
    }
    let (coordinates, momenta) = (
        linearisation.coordinates().to_vec(),
        linearisation.momenta().to_vec(),
    );
    let next = |state: State| {
        let [z, momentum, _] = state.after(model);
        linearisation.state(&z, &momentum)
    };
    let moved = |change: &dyn Fn(&mut State)| {
        let mut state = State {
            z: state.z.clone(),
            momentum: state.momentum.clone(),
            inputs: state.inputs.clone(),
        };
        change(&mut state);
        independent.close(
            model,
            &mut state.z,
            &mut vec![0.0; model.coordinate_count()],
        );
        next(state)
    };
    let column = |size: f64, change: &dyn Fn(&mut State, f64)| {
        // Of fourth order.
        let [a, b, c, d] = [size, -size, 2.0 * size, -2.0 * size]
            .map(|by| DVector::from_vec(moved(&|state| change(state, by))));
        (8.0 * (a - b) - (c - d)) / (12.0 * size)
    };
    let n = linearisation.size();
    let mut by_state = exact.by_state.clone();
    // Of many columns some are enough.
    let stride = if n > 60 { 9 } else { 1 };
    for (c, &i) in coordinates.iter().enumerate().step_by(stride) {
        by_state.set_column(c, &column(1e-4, &|state, by| state.z[i] += by));
    }
    for (c, &i) in momenta.iter().enumerate().step_by(stride) {
        let size = 1e-3 * state.momentum.iter().fold(0.0_f64, |a, p| a.max(p.abs()));
        let by = column(size, &|state, by| state.momentum[i] += by);
        by_state.set_column(coordinates.len() + c, &by);
    }
    let mut by_inputs = DMatrix::zeros(n, inputs.len());
    for (c, input) in inputs.iter().enumerate() {
        let by = |state: &mut State, by: f64| {
            let value = &mut state.inputs[input.scalar];
            *value = match input.is_squared {
                true => (*value * *value + by).sqrt(),
                false => *value + by,
            };
        };
        let size = if input.is_squared {
            1e4
        } else {
            0.1 * state.inputs[input.scalar]
        };
        by_inputs.set_column(c, &column(size, &by));
    }
    let differences = LinearStep {
        by_state,
        by_inputs,
        momentum: exact.momentum.clone(),
    };
    [exact, differences]
}

/// Greatest deviation of a block of rows and columns relative to its greatest entry.
fn deviation(a: &DMatrix<f64>, b: &DMatrix<f64>, [rows, columns]: [usize; 2]) -> f64 {
    let mut worst = 0.0_f64;
    for rows in [0..rows, rows..a.nrows()] {
        for columns in [0..columns, columns..a.ncols()] {
            let view = |m: &DMatrix<f64>| m.view_range(rows.clone(), columns.clone()).into_owned();
            let (a, b) = (view(a), view(b));
            if a.is_empty() {
                continue;
            }
            assert!(b.amax() > 0.0, "a block of differences is zero");
            worst = worst.max((&a - &b).amax() / b.amax());
        }
    }
    worst
}

fn check(name: &str, system: System, voltage: f64, squares: usize) {
    let model = model(system);
    let inputs = step_inputs(&model);
    let is_squared = |input: &&StepInput| input.is_squared;
    assert_eq!(inputs.iter().filter(is_squared).count(), squares, "{name}");
    let [exact, differences] = both(&model, &State::new(&model, voltage));
    let n = independent(&model).coordinates().len();
    let of_state = deviation(&exact.by_state, &differences.by_state, [n, n]);
    assert!(of_state < 1e-6, "{name}: {of_state:e} of A");
    for c in 0..inputs.len() {
        let column = |step: &LinearStep| step.by_inputs.columns(c, 1).into_owned();
        let of_input = deviation(&column(&exact), &column(&differences), [n, 1]);
        assert!(of_input < 1e-6, "{name}: {of_input:e} of column {c} of B");
    }
}

#[test]
fn linear_steps_of_lumped_muscles() {
    check("pair", trunk(1), 1000.0, 2);
    check("trunk", trunk(3), 1000.0, 6);
    check("tree", branched(), 900.0, 3);
}

#[test]
fn linear_steps_of_what_remembers() {
    check("branches", remembering(), 900.0, 3);
    check("charges", charged(), 900.0, 1);
}

#[test]
fn linear_steps_of_finite_elements() {
    check("strains", remembering_blocks(), 300.0, 1);
    check("blocks", blocks(), 300.0, 3);
}

#[test]
fn linear_steps_of_closed_loops() {
    check("four-bar", four_bar(), 1000.0, 1);
    let model = model(four_bar());
    // Three hinges of the tree, and the one that closes the loop with its spring: one degree of freedom.
    assert_eq!(model.coordinate_count(), 4);
    assert_eq!(independent(&model).coordinates().len(), 1);
}

/// A squared voltage of zero has an effect, by its square, as any other.
#[test]
fn zero_voltages_have_authority() {
    let model = model(trunk(2));
    let inputs = step_inputs(&model);
    let mut state = State::new(&model, 0.0);
    state.inputs.fill(0.0);
    let [z, _, scalars] = state.after(&model);
    let independent = independent(&model);
    let mut linearisation = Linearisation::new(&model, &independent, &inputs);
    let step = linearisation.step([&state.z, &z], &scalars, STEP).unwrap();
    let next = |square: f64| {
        let mut inputs = state.inputs.clone();
        inputs[0] = square.sqrt();
        let state = State {
            inputs,
            z: state.z.clone(),
            momentum: state.momentum.clone(),
        };
        let [z, momentum, _] = state.after(&model);
        linearisation.state(&z, &momentum)
    };
    let (none, some) = (next(0.0), next(1e3));
    let scale = step.by_inputs.column(0).amax();
    assert!(scale > 0.0);
    let n = linearisation.coordinates().len();
    for (i, (none, some)) in none.iter().zip(&some).enumerate().skip(n) {
        let by = (some - none) / 1e3;
        assert!((by - step.by_inputs[(i, 0)]).abs() < 1e-3 * scale);
    }
}

#[test]
fn momenta_by_coordinates_and_rates() {
    of_momenta(&model(remembering()));
    of_momenta(&model(four_bar()));
}

fn of_momenta(model: &Model) {
    let State { z, .. } = State::new(model, 0.0);
    let n = model.coordinate_count();
    let independent = independent(model);
    let free = independent.coordinates();
    let own = |i: usize| f64::from(u8::from(free.contains(&i)));
    let given: Vec<f64> = (0..n).map(|i| 1e-3 * (1.0 + i as f64) * own(i)).collect();
    // Those of all coordinates by the independent ones.
    let all = |z: &[f64]| {
        let mut rates = given.clone();
        independent.close(model, &mut z.to_vec(), &mut rates);
        rates
    };
    let [by_rates, by_coordinates] = momentum_derivatives(model, &independent, &z, &all(&z));
    let momentum = |z: &[f64]| {
        let mut instant = model.action.map.placed(z);
        let mut momentum = model.action.momentum(&mut instant, &all(z));
        independent.reduce(model, z, &mut momentum);
        momentum
    };
    let product = &by_rates * DVector::from_column_slice(&given);
    for (a, b) in product.iter().zip(momentum(&z)) {
        assert!((a - b).abs() < 1e-12 * product.amax());
    }
    assert!(by_coordinates.amax() > 0.0);
    for &c in free {
        let ends = [1e-5, -1e-5].map(|by| {
            let mut z = z.clone();
            z[c] += by;
            independent.close(model, &mut z, &mut vec![0.0; n]);
            momentum(&z)
        });
        for r in 0..n {
            let by = (ends[0][r] - ends[1][r]) / 2e-5;
            let own = by_coordinates[(r, c)];
            assert!(
                (by - own).abs() < 1e-8 * by_coordinates.amax(),
                "{r} {c}: {own} {by}"
            );
        }
    }
}

#[test]
fn no_state_of_redundant_coordinates() {
    let mut analysis = Analysis::of_motion(STEP);
    analysis.coordinates = Some(Coordinates::Redundant);
    let redundant = Model::for_analysis(trunk(1), analysis).unwrap();
    let error = Independent::new(&redundant, &[]).unwrap_err();
    assert_eq!(error, NoState::Redundant);
    let turning = model(crate::common::systems::satellite());
    let error = Independent::new(&turning, &[]).unwrap_err();
    assert_eq!(error, NoState::Charts);
}
