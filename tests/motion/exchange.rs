//! Electrical energy from the sources and mechanical work: their balance with stored energy and charging losses, and with the motion.

use crate::common::random::Random;
use crate::common::{at_reference, column, placed, trunk};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{DiscreteTrajectory, EnergyExchange, Start, observations, simulate};
use proboscis::model::system::{Discretisation, ElementKind, Fidelity, VACUUM_PERMITTIVITY};
use proboscis::model::{Coordinates, Model};
use std::ops::ControlFlow;

/// C = 2 V₀ ε₀ (2 − Λ² + 1/(2Λ²))/t² of a muscle of the trunk, whose rest length is 40 mm.
fn capacitance(model: &Model, z: &[f64], muscle: usize) -> f64 {
    let i = (placed(model, z).x[model.spans[muscle]].norm() / 40.0).powi(2);
    2.0 * 4000.0 * VACUUM_PERMITTIVITY * (2.0 - i + 0.5 / i) / (0.05 * 0.05)
}

/// A trunk of two segments that starts at rest in the reference configuration.
fn moved(
    coordinates: Coordinates,
    (h, steps): (f64, usize),
    voltages: impl Fn(f64) -> Vec<f64>,
) -> (Model, DiscreteTrajectory) {
    let model = Model::new(trunk(2), Some(coordinates), h, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let scalars = |from: f64, to: f64| model.scalars(&voltages(0.5 * (from + to)));
    let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, h, steps, scalars, go_on);
    assert_eq!((failure, discrete.report.halved), (None, 0));
    (model, discrete)
}

#[test]
fn sources_pay_for_work_stored_energy_and_charging() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut random = Random(5);
        let rows: Vec<[f64; 3]> = (0..40)
            .map(|_| [0, 1, 2].map(|_| random.between(200.0, 2200.0)))
            .collect();
        // The third muscle has no voltage at all.
        let voltages = |t: f64| {
            let [a, b, c] = rows[(t / 5.0) as usize];
            vec![a, b, 0.0, c]
        };
        let before = [800.0, 0.0, 0.0, 1700.0];
        let (model, discrete) = moved(coordinates, (5.0, 40), voltages);
        let motion = Trajectory::from_discrete(&model, &discrete);
        let found = EnergyExchange::new(&model.system, &motion, [Some(&before), None]);
        assert!(found.is_complete);
        assert_eq!(
            found.sources.iter().map(|s| s.source).collect::<Vec<_>>(),
            [0, 1, 3]
        );
        for source in &found.sources {
            let m = source.source;
            let c: Vec<f64> = discrete
                .z
                .iter()
                .map(|z| capacitance(&model, z, m))
                .collect();
            let stored = |k: usize, v: f64| 0.5 * c[k] * v * v;
            let (mut work, mut loss, mut last) = (0.0, 0.0, before[m]);
            let mut most = 0.0_f64;
            for (k, &here) in c[..40].iter().enumerate() {
                let v = voltages(5.0 * k as f64 + 2.5)[m];
                // A resistor between a source of constant voltage and a capacitor takes this, whatever it is.
                loss += 0.5 * here * (v - last) * (v - last);
                work += stored(k + 1, v) - stored(k, v);
                let kept = stored(k + 1, v) - stored(0, before[m]);
                let expected = work + kept + loss;
                let energy = source.electrical_energy[k + 1];
                assert!(
                    (energy - expected).abs() < 1e-12 * (loss + kept.abs()),
                    "{m} {k}"
                );
                assert!((source.mechanical_work[k + 1] - work).abs() < 1e-12 * stored(k, v));
                most = most.max(work.abs());
                last = v;
            }
            assert!(most > 1.0 && loss > 1.0, "{most} {loss}");
            assert_eq!(
                [source.electrical_energy[0], source.mechanical_work[0]],
                [0.0; 2]
            );
        }
        let [energy, work] = found.totals().unwrap();
        let sum = |of: fn(&proboscis::dynamics::SourceEnergies) -> &Vec<f64>| -> f64 {
            found.sources.iter().map(|source| of(source)[40]).sum()
        };
        assert!((energy[40] - sum(|s| &s.electrical_energy)).abs() < 1e-12 * energy[40]);
        assert!((work[40] - sum(|s| &s.mechanical_work)).abs() < 1e-12 * energy[40]);
        let names: Vec<_> = found.columns().into_iter().map(|c| c.name).collect();
        assert_eq!(names.len(), 8);
        assert_eq!(
            names[..3],
            [
                "electrical_energy",
                "mechanical_work",
                "muscle1_electrical_energy"
            ]
        );
        // Muscles that were not charged before take as much more as their first charge.
        let uncharged = EnergyExchange::new(&model.system, &motion, [None; 2]);
        let first = capacitance(&model, &discrete.z[0], 0) * rows[0][0] * before[0];
        let more =
            uncharged.sources[0].electrical_energy[40] - found.sources[0].electrical_energy[40];
        assert!((more - first).abs() < 1e-10 * first);
        // What is held afterwards is switched to in the last row.
        let after = [1500.0, 0.0, 0.0, 300.0];
        let held = EnergyExchange::new(&model.system, &motion, [Some(&before), Some(&after)]);
        for (source, other) in held.sources.iter().zip(&found.sources) {
            let m = source.source;
            let [last, next] = [voltages(197.5)[m], after[m]];
            let expected = capacitance(&model, &discrete.z[40], m) * next * (next - last);
            let switch = source.electrical_energy[40] - other.electrical_energy[40];
            assert!((switch - expected).abs() < 1e-12 * source.electrical_energy[40].abs());
            assert_eq!(
                source.electrical_energy[..40],
                other.electrical_energy[..40]
            );
            assert_eq!(source.mechanical_work, other.mechanical_work);
        }
    }
}

#[test]
fn the_motion_has_what_the_muscles_work() {
    let voltages = |t: f64| match t {
        t if t < 60.0 => vec![2000.0, 0.0, 700.0, 1500.0],
        t if t < 120.0 => vec![300.0, 1800.0, 0.0, 900.0],
        _ => vec![0.0, 1200.0, 2000.0, 0.0],
    };
    let error = |steps: usize| {
        let h = 180.0 / steps as f64;
        let (model, discrete) = moved(Coordinates::Reduced, (h, steps), voltages);
        let motion = Trajectory::from_discrete(&model, &discrete);
        let exchange = EnergyExchange::new(&model.system, &motion, [None; 2]);
        let seen = observations(&model, &discrete);
        // The energy of the system less the electric part −½ C V² of that of the muscles.
        let energy = |k: usize, t: f64| {
            let v = voltages(t);
            let electric = |m: usize| -0.5 * capacitance(&model, &discrete.z[k], m) * v[m] * v[m];
            column(&seen, "total_energy")[k] - (0..4).map(electric).sum::<f64>()
        };
        let gained =
            energy(steps, 180.0) - energy(0, 0.0) + column(&seen, "dissipated_energy")[steps];
        let work = exchange.totals().unwrap()[1][steps];
        assert!(work > 1.0, "{work}");
        (gained - work).abs() / work
    };
    let errors = [36, 72, 144].map(error);
    println!("{errors:?}");
    assert!(errors[2] < 2e-3 && errors[0] > 1e-5);
    assert!(
        errors[1] < 0.3 * errors[0] && errors[2] < 0.3 * errors[1],
        "{errors:?}"
    );
}

#[test]
fn what_drives_finite_elements_is_left_out() {
    let mut system = trunk(1);
    let (model, discrete) = moved(Coordinates::Reduced, (5.0, 1), |_| vec![0.0; 4]);
    let mut motion = Trajectory::from_discrete(&model, &discrete);
    motion.voltages = vec![vec![1000.0, 500.0]];
    motion.poses.iter_mut().for_each(|poses| poses.truncate(1));
    let whole = EnergyExchange::new(&system, &motion, [None; 2]);
    assert!(whole.is_complete && whole.totals().unwrap()[0][1] > 0.1);
    system.muscles[0].fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 2],
        layers: 2,
        element: ElementKind::Hex8,
    });
    let part = EnergyExchange::new(&system, &motion, [None; 2]);
    assert_eq!((part.sources.len(), part.sources[0].source), (1, 1));
    assert!(!part.is_complete && part.totals().is_none());
    let names: Vec<_> = part.columns().into_iter().map(|c| c.name).collect();
    assert_eq!(
        names,
        ["muscle2_electrical_energy", "muscle2_mechanical_work"]
    );
    motion.voltages[0][0] = 0.0;
    assert!(EnergyExchange::new(&system, &motion, [None; 2]).is_complete);
    motion.voltages[0][1] = 0.0;
    let still = EnergyExchange::new(&system, &motion, [None; 2]);
    assert!(still.sources.is_empty() && still.totals().is_none());
}
