//! Every problem of the list, in both coordinates: ∇²Ŝ and ∇³Ŝ[y] are the differences of ∇Ŝ and ∇²Ŝ; where only
//! potentials act, ∇²Ŝ is symmetric. `horizon` shows that a problem of given duration has the program of a free one, but for a
//! column: one that is listed with a free duration too is left to that.

use crate::common::cases::{cases, control};
use crate::common::random::Random;
use crate::common::trunk;
use proboscis::control::problem::Duration;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::functional::{Order, Sample};
use proboscis::model::system::System;
use proboscis::model::{Coordinates, Model, Role};
use proboscis::nlp::{Bounds, Entries, Nlp, differences};

/// Noise on the variables of a guess, all of which are scaled to about one.
const NOISE: f64 = 0.07;
/// Noise on the places of nodes.
const NODE_NOISE: f64 = 0.004;

#[test]
fn derivatives_are_differences() {
    let cases = cases();
    for case in &cases {
        let free = format!("{}, free time", case.name);
        if cases.iter().any(|other| other.name == free) {
            continue;
        }
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let mut control = case.control.clone();
            control.coordinates = Some(coordinates);
            let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
            let h = t / control.intervals as f64;
            let (model, boundary) = BoundaryConditions::resolve(&case.system, &control, h).unwrap();
            let initial = guess(&model, &boundary, &control, h, None);
            let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
            let mut random = Random(11);
            let mut x = program.start(&initial).x;
            for (i, value) in x.iter_mut().enumerate() {
                // Nodes are measured by the whole system, and elements must not be inverted.
                let of_node = program.variable_name(i).contains("of node");
                let noise = if of_node { NODE_NOISE } else { NOISE };
                *value += noise * random.unit();
            }
            let report = differences::check(&mut program, &x, 5);
            println!(
                "{} {coordinates:?}: {} variables, {report}",
                case.name,
                x.len()
            );
            assert!(
                report.is_consistent(),
                "{} in {coordinates:?} coordinates: {report}",
                case.name
            );
            not_trivial(case.name, &mut program, &x);
        }
    }
}

/// Nothing that is compared is zero all over: each row has a slope, each variable shows somewhere in the Jacobian, and
/// the Hessian along the costates is not the objective's alone.
pub(crate) fn not_trivial(name: &str, program: &mut Transcription<'_>, x: &[f64]) {
    let (jacobian, hessian) = (program.jacobian_structure(), program.hessian_structure());
    let rows = program.constraints().lower.len();
    let mut values = vec![0.0; jacobian.rows.len()];
    program.jacobian(x, &mut values);
    let mut row_sizes = vec![0.0_f64; rows];
    let mut col_sizes = vec![0.0_f64; x.len()];
    for ((&row, &col), value) in jacobian.rows.iter().zip(&jacobian.cols).zip(&values) {
        row_sizes[row as usize] += value.abs();
        col_sizes[col as usize] += value.abs();
    }
    for (r, size) in row_sizes.iter().enumerate() {
        assert!(
            *size > 0.0,
            "{name}: {} reads nothing",
            program.constraint_name(r)
        );
    }
    for (c, size) in col_sizes.iter().enumerate() {
        assert!(
            *size > 0.0,
            "{name}: {} moves nothing",
            program.variable_name(c)
        );
    }
    let mut curvature = vec![0.0; hessian.rows.len()];
    program.hessian(x, 0.0, &vec![1.0; rows], &mut curvature);
    assert!(
        curvature.iter().any(|v| v.abs() > 1e-3),
        "{name}: no curvature"
    );
}

/// Second derivatives of the action at random coordinates as a dense matrix over (z₀, z₁).
fn dense(system: &System, coordinates: Coordinates) -> nalgebra::DMatrix<f64> {
    let model = Model::new(system.clone(), Some(coordinates), 10.0, &[]).unwrap();
    let action = &model.action;
    let mut random = Random(3);
    let joints = |random: &mut Random| {
        (0..system.joints.len())
            .map(|_| 0.4 * random.unit())
            .collect::<Vec<_>>()
    };
    let (mut a, mut b) = (action.map.instant(), action.map.instant());
    for instant in [&mut a, &mut b] {
        instant.z = model.coordinates_at(&joints(&mut random));
        for multiplier in &mut instant.z[model.coordinate_count()..] {
            *multiplier = random.unit();
        }
        action.map.place(instant);
    }
    let voltages = model.variables.range(Role::Voltage);
    let size = |s: usize| if voltages.contains(&s) { 2e3 } else { 0.02 };
    let scalars = (0..model.action.intervals.scalars).map(|s| size(s) * random.unit());
    let scalars: Vec<f64> = scalars.collect();
    let layout = action.layout();
    let mut values = vec![0.0; layout.values(1)];
    let mut scratch = action.scratch(Order::Hessian);
    let level = Order::Hessian;
    let interval = Sample::of_interval(&scalars, 10.0);
    action.evaluate_interval(level, [&mut a, &mut b], &interval, &mut scratch);
    action.pull_back_interval(level, [&a, &b], &interval, 0, &mut scratch, &mut values);
    for (k, instant) in [&mut a, &mut b].into_iter().enumerate() {
        action.evaluate_instant(level, instant, &[], &mut scratch);
        action.pull_back_instant(level, instant, k, &mut scratch, &mut values);
    }
    let n = action.map.unknowns();
    let mut matrix = nalgebra::DMatrix::zeros(2 * n, 2 * n);
    for (slot, (i, j)) in layout.same.entries().enumerate() {
        matrix[(i, j)] += values[layout.same_at(0) + slot];
        matrix[(n + i, n + j)] += values[layout.same_at(1) + slot];
    }
    for (slot, (i, j)) in layout.cross.entries().enumerate() {
        matrix[(n + i, j)] += values[layout.lower_at(0) + slot];
        matrix[(i, n + j)] += values[layout.upper_at(0) + slot];
    }
    matrix
}

#[test]
fn potentials_have_symmetric_second_derivatives() {
    let viscous = crate::common::systems::branched();
    let mut conservative = viscous.clone();
    for muscle in &mut conservative.muscles {
        muscle.material.viscosity = None;
    }
    for joint in &mut conservative.joints {
        joint.damping = None;
    }
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let skew = |system: &System| {
            let h = dense(system, coordinates);
            assert!(h.amax() > 1.0);
            (&h - h.transpose()).amax() / h.amax()
        };
        // Sums of some hundred products in different orders.
        assert!(skew(&conservative) < 1e-13, "{:e}", skew(&conservative));
        assert!(skew(&viscous) > 1e-6, "{:e}", skew(&viscous));
    }
}

/// Fault that is put into a program.
#[derive(Clone, Copy, Debug)]
enum Spoiled {
    Nothing,
    Gradient,
    JacobianEntry,
    HessianEntry,
    HessianMissing,
    SigmaIgnored,
    CostatesScaled,
    CostatesIgnored,
}

/// A program with a mistake in its derivatives.
struct Mistaken<'p, 'm> {
    program: &'p mut Transcription<'m>,
    mistake: Spoiled,
}

/// The largest entry, spoiled by one part in a thousand.
fn spoil(values: &mut [f64]) {
    let largest = (0..values.len()).max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()));
    values[largest.unwrap()] *= 1.001;
}

impl Nlp for Mistaken<'_, '_> {
    fn variables(&self) -> &Bounds {
        self.program.variables()
    }

    fn constraints(&self) -> &Bounds {
        self.program.constraints()
    }

    fn jacobian_structure(&self) -> Entries {
        self.program.jacobian_structure()
    }

    fn hessian_structure(&self) -> Entries {
        let mut entries = self.program.hessian_structure();
        if let Spoiled::HessianMissing = self.mistake {
            // The first place holds another entry's value.
            (entries.rows[0], entries.cols[0]) = (entries.rows[1], entries.cols[1]);
        }
        entries
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.program.objective(x)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.program.gradient(x, grad);
        if let Spoiled::Gradient = self.mistake {
            spoil(grad);
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.program.constraint(x, g);
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.program.jacobian(x, values);
        if let Spoiled::JacobianEntry = self.mistake {
            spoil(values);
        }
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        let (sigma, factor) = match self.mistake {
            Spoiled::SigmaIgnored => (1.0, 1.0),
            Spoiled::CostatesScaled => (sigma, 1.01),
            Spoiled::CostatesIgnored => (sigma, 0.0),
            _ => (sigma, 1.0),
        };
        let costates: Vec<f64> = costates.iter().map(|y| factor * y).collect();
        self.program.hessian(x, sigma, &costates, values);
        if let Spoiled::HessianEntry = self.mistake {
            spoil(values);
        }
    }
}

#[test]
fn mistakes_are_caught() {
    let system = trunk(2);
    let control = control(&system, 3);
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, 10.0).unwrap();
    let initial = guess(&model, &boundary, &control, 10.0, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let mut random = Random(17);
    let x: Vec<f64> = program
        .start(&initial)
        .x
        .iter()
        .map(|x| x + NOISE * random.unit())
        .collect();
    for mistake in [
        Spoiled::Nothing,
        Spoiled::Gradient,
        Spoiled::JacobianEntry,
        Spoiled::HessianEntry,
        Spoiled::HessianMissing,
        Spoiled::SigmaIgnored,
        Spoiled::CostatesScaled,
        Spoiled::CostatesIgnored,
    ] {
        let mut mistaken = Mistaken {
            program: &mut program,
            mistake,
        };
        let report = differences::check(&mut mistaken, &x, 23);
        let sound = matches!(mistake, Spoiled::Nothing);
        assert_eq!(report.is_consistent(), sound, "{mistake:?}: {report}");
    }
}
