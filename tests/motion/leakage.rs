//! Leaks parallel to the electrodes of lumped muscles: closed forms, a motion by another method, energies, rest, and files.

use crate::charge::{CAPACITANCE, driven, plain, units};
use crate::common::{column, motion, placed};
use crate::component_files::read;
use crate::maxwell::{BOTH, LENGTH, internal, model};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{
    DiscreteTrajectory, EnergyExchange, Start, observations, stable_equilibrium,
};
use proboscis::model::system::{Circuit, System};
use proboscis::model::{Analysis, Coordinates, Model};

/// The slider behind a resistor and with a leak, by their time constants with the capacitance at rest in ms.
fn leaking(mass: f64, [series, leak]: [Option<f64>; 2]) -> System {
    let mut system = plain(mass);
    let resistance = |time: f64| time / CAPACITANCE;
    system.muscles[0].circuit = Some(Circuit {
        resistance: series.map(resistance),
        leakage: leak.map(resistance),
    });
    system
}

/// A mass that does not move.
const HEAVY: f64 = 1e18;

/// A start at rest with a charge in mC.
fn charged_with(model: &Model, charge: f64) -> Start {
    let mut z = model.coordinates_at(&[0.0]);
    let stretch_of_unit = units()[1];
    z[internal(model)].fill(charge / stretch_of_unit);
    Start::at_rest(model, z)
}

fn charges(model: &Model, discrete: &DiscreteTrajectory) -> Vec<f64> {
    model.circuit_charges(&discrete.z).remove(&0).unwrap()
}

/// Energy from the source, mechanical work, and heat of resistor and leak at the end, in mJ.
fn exchanged(model: &Model, discrete: &DiscreteTrajectory) -> [f64; 4] {
    let trajectory = Trajectory::from_discrete(model, discrete);
    let exchange = EnergyExchange::new(&model.system, &trajectory, [None, None]);
    let last = |name: &str| {
        let columns = exchange.columns();
        let of = columns.iter().find(|column| column.name == name);
        of.map_or(0.0, |column| *column.values.last().unwrap())
    };
    [
        "electrical_energy",
        "mechanical_work",
        "muscle_resistor_heat",
        "muscle_leakage_heat",
    ]
    .map(last)
}

/// Time constants of resistor and leak, charge at the start and voltage, and the charge in time.
type Case<'c> = ([f64; 2], [f64; 2], &'c dyn Fn(f64) -> f64);

#[test]
fn a_charge_leaks_and_charges_as_in_closed_form() {
    let volts = 1000.0;
    // With the time constants 30 ms of the resistor and 90 ms of the leak the muscle charges to three quarters in 22.5 ms; with a
    // resistor that passes next to nothing it discharges through its leak.
    let charging = |t: f64| 0.75 * volts * CAPACITANCE * (1.0 - (-t / 22.5).exp());
    let discharging = |t: f64| volts * CAPACITANCE * (-t / 90.0).exp();
    let cases: [Case<'_>; 2] = [
        ([30.0, 90.0], [0.0, volts], &charging),
        ([9e15, 90.0], [volts * CAPACITANCE, 0.0], &discharging),
    ];
    for coordinates in BOTH {
        for (times, [first, voltage], exact) in cases {
            let errors = [2.0, 1.0].map(|h| {
                let model = model(&leaking(HEAVY, times.map(Some)), coordinates, h);
                let start = charged_with(&model, first);
                let discrete = motion(&model, &start, h, (60.0 / h) as usize, &[voltage]);
                let found = *charges(&model, &discrete).last().unwrap();
                assert!((found / first.max(1e-9) - 1.0).abs() > 0.3);
                found / exact(60.0) - 1.0
            });
            assert!(errors[1].abs() < 1e-3, "{errors:?}");
            let ratio = errors[0] / errors[1];
            assert!((3.9..4.1).contains(&ratio), "{coordinates:?}: {errors:?}");
        }
    }
}

#[test]
fn energies_of_a_muscle_that_stands_balance_to_rounding() {
    let voltages: Vec<f64> = (0..60).map(|k| f64::from(1000 * (k % 7 / 3))).collect();
    let model = model(
        &leaking(HEAVY, [30.0, 90.0].map(Some)),
        Coordinates::Reduced,
        2.0,
    );
    let discrete = driven(&model, &charged_with(&model, 0.0), 2.0, &voltages);
    let [supplied, work, of_resistor, of_leak] = exchanged(&model, &discrete);
    let charge = *charges(&model, &discrete).last().unwrap();
    let stored = charge * charge / (2.0 * CAPACITANCE);
    assert!(stored > 1.0 && of_resistor > 1.0 && of_leak > 1.0 && work.abs() < 1e-9);
    let sum = stored + of_resistor + of_leak;
    assert!((sum / supplied - 1.0).abs() < 1e-12, "{sum} {supplied}");
}

#[test]
fn a_swing_with_a_leak_is_that_of_another_method() {
    // tests/reference/leak.py: displacement, charge, energy from the source, heat of resistor and of leak.
    let exact = [
        -4.39362827153,
        0.0894095404992,
        389.005201225,
        178.943959312,
        126.977852287,
    ];
    let voltage = 0.7 * units()[0];
    for coordinates in BOTH {
        let errors = [0.2, 0.1].map(|h| {
            let model = model(&leaking(20.0, [6.0, 18.0].map(Some)), coordinates, h);
            let start = charged_with(&model, 0.0);
            let discrete = motion(&model, &start, h, (30.0 / h).round() as usize, &[voltage]);
            let place = model.joints(&placed(&model, discrete.z.last().unwrap()), &[0.0])[0];
            let charges = charges(&model, &discrete);
            let charge = *charges.last().unwrap();
            let [supplied, work, of_resistor, of_leak] = exchanged(&model, &discrete);
            // What is neither heat nor at the electrodes does not exist.
            let stretch = |z: &Vec<f64>| 1.0 + model.joints(&placed(&model, z), &[0.0])[0] / LENGTH;
            let to_electrodes: f64 = (0..discrete.intervals())
                .map(|k| {
                    let middle = |f: &dyn Fn(usize) -> f64| 0.5 * (f(k) + f(k + 1));
                    let stretch = middle(&|k| stretch(&discrete.z[k]));
                    let across = middle(&|k| charges[k]) * stretch * stretch / CAPACITANCE;
                    across * (charges[k + 1] - charges[k])
                })
                .sum();
            let sum = to_electrodes + of_resistor + of_leak;
            assert!((sum / supplied - 1.0).abs() < 1e-9, "{sum} {supplied}");
            let last = 1.0 + place / LENGTH;
            let stored = charge * charge * last * last / (2.0 * CAPACITANCE);
            let balance = (stored + work + of_resistor + of_leak) / supplied - 1.0;
            let found = [place, charge, supplied, of_resistor, of_leak];
            let off = |i: usize| found[i] / exact[i] - 1.0;
            [off(0), off(1), off(2), off(3), off(4), balance]
        });
        for (coarse, fine) in errors[0].iter().zip(errors[1]) {
            let is_second_order = (3.7..4.3).contains(&(coarse / fine));
            assert!(fine.abs() < 5e-3 && is_second_order, "{errors:?}");
        }
    }
}

#[test]
fn a_leak_at_the_source_costs_energy_and_changes_no_motion() {
    let voltages: Vec<f64> = (0..300).map(|k| f64::from(k * 5)).collect();
    let time = 40.0;
    let run = |system: &System| {
        let model = model(system, Coordinates::Reduced, 0.1);
        let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
        let discrete = driven(&model, &start, 0.1, &voltages);
        let current = column(&observations(&model, &discrete), "muscle_current").to_vec();
        let supplied = exchanged(&model, &discrete);
        (model, discrete, current, supplied)
    };
    let (sound, first, without, [before, ..]) = run(&plain(20.0));
    let (leaky, second, with, [after, _, of_resistor, of_leak]) =
        run(&leaking(20.0, [None, Some(time)]));
    assert_eq!(first.z, second.z);
    assert_eq!(sound.present, leaky.present);
    let square: f64 = voltages.iter().map(|v| v * v).sum();
    let heat = square * 0.1 * CAPACITANCE / time;
    assert!(of_resistor == 0.0 && (of_leak / heat - 1.0).abs() < 1e-12);
    assert!(((after - before) / heat - 1.0).abs() < 1e-10);
    // Between two intervals the voltage is the mean of both.
    let leak = 0.5 * (voltages[99] + voltages[100]) * CAPACITANCE / time;
    assert!(((with[100] - without[100]) / leak - 1.0).abs() < 1e-9);
}

#[test]
fn a_leak_behind_a_resistor_divides_the_voltage_at_rest() {
    let voltage = 0.8 * units()[0];
    let divided = leaking(20.0, [30.0, 90.0].map(Some));
    let place = |system: &System, voltage: f64, of_motion: bool| {
        let analysis = match of_motion {
            true => Analysis::of_motion(1.0),
            false => Analysis::of_rest(),
        };
        let model = Model::for_analysis(system.clone(), analysis).unwrap();
        let zero = model.coordinates_at(&[0.0]);
        let found = stable_equilibrium(&model, &zero, &model.scalars(&[voltage])).unwrap();
        let rest = DiscreteTrajectory {
            times: vec![0.0],
            z: vec![found.z.clone()],
            momenta: vec![vec![0.0; model.coordinate_count()]],
            scalars: vec![found.scalars.clone()],
            ..DiscreteTrajectory::default()
        };
        let seen = observations(&model, &rest);
        let of = |name: &str| column(&seen, name)[0];
        let names = ["muscle_charge", "muscle_tension", "muscle_field"];
        let mut values = vec![model.joints(&placed(&model, &found.z), &[0.0])[0]];
        values.extend(names.map(of));
        values.push(of("muscle_current") - voltage * CAPACITANCE / 120.0);
        values
    };
    let expected = place(&plain(20.0), 0.75 * voltage, true);
    assert!(expected[0] < -1.0 && expected[3] > 10.0, "{expected:?}");
    for of_motion in [true, false] {
        let found = place(&divided, voltage, of_motion);
        for i in 0..4 {
            let off = (found[i] - expected[i]).abs();
            assert!(
                off < 1e-8 * expected[i].abs().max(1.0),
                "{found:?} {expected:?}"
            );
        }
        assert!(found[4].abs() < 1e-9, "{found:?}");
    }
}

const SCENE: &str = r#"{ "name": "leak",
  "materials": { "rubber": { "shear_modulus": "100 kPa", "relative_permittivity": 3 }, "plain": { "shear_modulus": "100 kPa" } },
  "bodies": [{ "name": "b", "mass": "10 g", "sphere": { "radius": "5 mm" }, "position": ["40 mm", 0, 0] }],
  "joints": [{ "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": ["40 mm", 0, 0] }],
  "muscles": [{ "name": "m", "material": "rubber", "from": { "body": "ground", "at": [0, 0, 0] },
                "to": { "body": "b", "at": ["40 mm", 0, 0] }, "cross_section": ["10 mm", "10 mm"],
                "layer_thickness": "50 um", "circuit": CIRCUIT }]LOADS }"#;

#[test]
fn files_name_leaks() {
    let scene = |circuit: &str| SCENE.replace("CIRCUIT", circuit).replace("LOADS", "");
    let both = r#"{ "resistance": "2 MOhm", "leakage": "1 GOhm" }"#;
    let circuit = read(&scene(both)).unwrap().muscles[0].circuit.unwrap();
    assert_eq!(
        [circuit.resistance, circuit.leakage],
        [Some(2e6), Some(1e9)]
    );
    let leak = r#"{ "leakage": "1 GOhm" }"#;
    let system = read(&scene(leak)).unwrap();
    assert!(system.has_source_voltage(0) && !system.muscles[0].is_behind_resistor());
    let load = r#", "loads": [{ "name": "q", "muscle": "m" }]"#;
    for (text, words) in [
        (scene("{}"), "muscles[0].circuit"),
        (scene(r#"{ "leakage": "0 Ohm" }"#), "circuit.leakage"),
        (scene(r#"{ "leakage": "1 GN" }"#), "a resistance, such as"),
        (
            scene(leak).replace(r#""material": "rubber""#, r#""material": "plain""#),
            "muscles[0].circuit",
        ),
        (
            SCENE.replace("CIRCUIT", leak).replace("LOADS", load),
            "loads[0].muscle",
        ),
    ] {
        let refused = read(&text).expect_err(words);
        assert!(refused.to_string().contains(words), "{refused}");
    }
}
