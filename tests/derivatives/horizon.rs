//! The interval length as a variable: at its guess the program is the one with that length given, and the derivative of
//! the action of an interval with h is minus its discrete energy.

use crate::common::cases::cases;
use crate::common::random::Random;
use crate::common::systems::{BRANCHED_VOLTAGES, branched};
use proboscis::control::problem::Duration;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::functional::{BlockMask, Horizon, Order, Sample, TermKind};
use proboscis::math::Vector;
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::Nlp;
use std::collections::HashMap;

/// Entries of a matrix by place, summed.
fn by_place(rows: &[u32], cols: &[u32], values: &[f64]) -> HashMap<(u32, u32), f64> {
    let mut map = HashMap::new();
    for ((&row, &col), value) in rows.iter().zip(cols).zip(values) {
        *map.entry((row, col)).or_insert(0.0) += value;
    }
    map
}

/// f, g, and the two matrices at a point, without the row and column `without`.
type Numbers = (
    f64,
    Vec<f64>,
    HashMap<(u32, u32), f64>,
    HashMap<(u32, u32), f64>,
);

fn numbers(program: &mut Transcription<'_>, x: &[f64], without: Option<u32>) -> Numbers {
    let rows = program.constraints().lower.len();
    let mut random = Random(9);
    let costates: Vec<f64> = (0..rows).map(|_| random.unit()).collect();
    let (j, h) = (program.jacobian_structure(), program.hessian_structure());
    let mut g = vec![0.0; rows];
    program.constraint(x, &mut g);
    let mut values = vec![0.0; j.rows.len()];
    program.jacobian(x, &mut values);
    let mut jacobian = by_place(&j.rows, &j.cols, &values);
    let mut values = vec![0.0; h.rows.len()];
    program.hessian(x, 0.8, &costates, &mut values);
    let mut hessian = by_place(&h.rows, &h.cols, &values);
    if let Some(without) = without {
        let before = (jacobian.len(), hessian.len());
        jacobian.retain(|&(_, col), _| col != without);
        hessian.retain(|&(row, _), _| row != without);
        assert!(jacobian.len() < before.0 && hessian.len() < before.1);
    }
    (program.objective(x), g, jacobian, hessian)
}

#[test]
fn a_free_horizon_at_its_guess_is_the_given_one() {
    let mut seen = 0;
    for case in cases() {
        if !matches!(case.control.duration, Duration::Given(_)) {
            continue;
        }
        for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
            let mut given = case.control.clone();
            given.coordinates = Some(coordinates);
            let Duration::Given(t) = given.duration else {
                unreachable!()
            };
            let mut free = given.clone();
            free.duration = Duration::Free {
                min: 0.5 * t,
                max: 2.0 * t,
                guess: t,
            };
            let h = t / given.intervals as f64;
            let (model, boundary) = BoundaryConditions::resolve(&case.system, &given, h).unwrap();
            let initial = guess(&model, &boundary, &given, h, None);
            let mut plain = Transcription::new(&model, &boundary, &given, &initial).unwrap();
            let mut timed = Transcription::new(&model, &boundary, &free, &initial).unwrap();
            let mut random = Random(2);
            let mut x = plain.start(&initial).x;
            for (i, v) in x.iter_mut().enumerate() {
                // Elements must not be inverted.
                let of_node = plain.variable_name(i).contains("of node");
                *v += if of_node { 0.004 } else { 0.05 } * random.unit();
            }
            let mut longer = x.clone();
            longer.push(1.0);
            assert_eq!(timed.unknowns().horizon(), Some(x.len()));
            let expected = numbers(&mut plain, &x, None);
            let found = numbers(&mut timed, &longer, Some(x.len() as u32));
            assert_eq!(
                found, expected,
                "{} in {coordinates:?} coordinates",
                case.name
            );
            seen += 1;
        }
    }
    assert!(seen > 8);
}

/// An interval between two random configurations of the branched tree.
struct Interval {
    model: Model,
    vectors: [Vec<Vector>; 2],
    scalars: Vec<f64>,
}

impl Interval {
    fn new() -> Self {
        let model = Model::new(branched(), Some(Coordinates::Reduced), 10.0, &[]).unwrap();
        let mut random = Random(21);
        let vectors = [0.1, 0.4].map(|size| {
            let joints: Vec<f64> = (0..4).map(|_| size * random.unit()).collect();
            let mut instant = model.action.map.instant();
            instant.z = model.coordinates_at(&joints);
            model.action.map.place(&mut instant);
            instant.x
        });
        let scalars = model.scalars(&BRANCHED_VOLTAGES);
        Self {
            model,
            vectors,
            scalars,
        }
    }

    fn frame<'a>(&'a self, vectors: [&'a [Vector]; 2], h: f64, horizon: Horizon) -> Sample<'a> {
        Sample {
            vectors,
            along: vectors,
            scalars: &self.scalars,
            scalars_along: &[0.0; 3],
            h,
            horizon,
            sides: BlockMask::ALL,
            outer: &[],
        }
    }

    /// Kinetic and potential energy.
    fn energies(&self, vectors: [&[Vector]; 2], h: f64) -> [f64; 2] {
        let frame = self.frame(vectors, h, Horizon::Given);
        let of = |kind: TermKind| {
            let effects = self.model.action.intervals.terms.iter();
            effects
                .filter(|e| e.kind() == kind)
                .map(|e| e.energy(&frame))
                .sum()
        };
        [of(TermKind::Kinetic), of(TermKind::Potential)]
    }

    /// Forces at both instants, and their derivatives with h, of potentials and inertia alone.
    fn forces(&self, h: f64) -> ([Vec<Vector>; 2], [Vec<Vector>; 2], Vec<f64>) {
        let action = &self.model.action;
        let mut out = action.intervals.output(Order::Hessian);
        let [a, b] = &self.vectors;
        let frame = self.frame([a, b], h, Horizon::Free);
        for (effect, slots) in action.intervals.terms() {
            if !effect.kind().is_virtual_work() {
                effect.evaluate(Order::Hessian, &frame, slots, &mut out);
            }
        }
        (
            out.plain.forces,
            out.plain.horizon_forces,
            out.plain.horizon_rows,
        )
    }
}

#[test]
fn the_action_falls_with_its_length_at_the_rate_of_its_energy() {
    let interval = Interval::new();
    let [a, b] = &interval.vectors;
    let action = |h: f64| {
        let [kinetic, potential] = interval.energies([a, b], h);
        h * (kinetic - potential)
    };
    let h = 8.0;
    let [kinetic, potential] = interval.energies([a, b], h);
    assert!(kinetic > 1e-3 && potential.abs() > 1e-3);
    // Central differences: an error of h²/6 times a third derivative, and rounding over the step.
    let step = 1e-3;
    let slope = (action(h + step) - action(h - step)) / (2.0 * step);
    let energy = kinetic + potential;
    assert!(
        (slope + energy).abs() < 1e-6 * (kinetic + potential.abs()),
        "{slope} against {}",
        -energy
    );
}

#[test]
fn forces_change_with_the_length_as_the_energy_with_places() {
    let interval = Interval::new();
    let h = 8.0;
    let (_, by_length, rows_by_length) = interval.forces(h);
    let largest = by_length
        .iter()
        .flatten()
        .map(nalgebra::Matrix::amax)
        .fold(0.0, f64::max);
    assert!(largest > 1e-3);
    let energy = |vectors: &[Vec<Vector>; 2]| {
        let [a, b] = vectors;
        interval.energies([a, b], h).iter().sum::<f64>()
    };
    let step = 1e-4;
    let ahead = interval.forces(h + step).0;
    let behind = interval.forces(h - step).0;
    for side in 0..2 {
        for v in 0..interval.vectors[0].len() {
            for i in 0..3 {
                let found = by_length[side][v][i];
                // −∂E/∂x.
                let moved = |by: f64| {
                    let mut vectors = interval.vectors.clone();
                    vectors[side][v][i] += by;
                    energy(&vectors)
                };
                let expected = -(moved(step) - moved(-step)) / (2.0 * step);
                assert!(
                    (found - expected).abs() < 1e-6 * largest,
                    "{found} against {expected}"
                );
                // The difference of forces at two lengths.
                let expected = (ahead[side][v][i] - behind[side][v][i]) / (2.0 * step);
                assert!(
                    (found - expected).abs() < 1e-6 * largest,
                    "{found} against {expected}"
                );
            }
        }
    }
    assert!(rows_by_length.iter().any(|r| r.abs() > 1e-9));
}
