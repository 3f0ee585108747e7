//! Electrical energy from the sources and mechanical work of their muscles, summed from the start of a motion.
//!
//! The voltage goes from `V_a` to `V_b` in an interval in which a lumped muscle changes its capacitance from `C_a` to `C_b` (docs/theory.md, 3.5);
//! charge flows within the interval, and at an instant where the voltage switches from V₋ to V₊:
//!
//! ```text
//! electrical energy  ½ (V_a + V_b) (C_b V_b − C_a V_a)  and  V₊ C (V₊ − V₋),     mechanical work  ½ V_a V_b (C_b − C_a).
//! ```
//!
//! Behind a resistor the charge Q is known at the instants. The source supplies its energy, of which the resistor takes a part:
//!
//! ```text
//! electrical energy  V_k (Q_{k+1} − Q_k),     mechanical work  −½ (½ (Q_k + Q_{k+1}))² (1/C_{k+1} − 1/C_k).
//! ```
//!
//! A leak takes charge from the source too ([`Circuit::exchange`]).
//!
//! Of electrodes of finite elements behind a resistor the charge is known too, and the work within the elements is not.
//!
//! The last row of a motion whose voltages afterwards are known includes the switch to them. Both belong to the instants at the ends of an interval. The potentials within finite elements are known in the middle of intervals
//! only, so sources that drive finite elements without a resistor are not listed.

use crate::dynamics::trajectory::{Column, Trajectory};
use crate::model::System;
use crate::model::components::capacitance;
use crate::model::system::{Circuit, InputKind};

/// Energies that all sources exchange with a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnergyExchange {
    /// The sources of lumped muscles whose voltage is ever other than zero.
    pub sources: Vec<SourceEnergies>,
    /// True if these are all sources whose voltage is ever other than zero.
    pub is_complete: bool,
}

/// Energies that one source exchanges with a motion, from the start to each instant.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceEnergies {
    /// Index of the source, which is that of its muscle.
    pub source: usize,
    /// Its name.
    pub name: String,
    /// Electrical energy from the source in mJ; negative where more flows back.
    pub electrical_energy: Vec<f64>,
    /// Work of the electrical forces in mJ; empty of finite elements.
    pub mechanical_work: Vec<f64>,
    /// Heat of its resistor, if it has one, and of its leak in mJ; none without a leak.
    pub heats: Vec<(&'static str, Vec<f64>)>,
}

impl EnergyExchange {
    /// Of a motion; `ends` are the voltages in V by source that charged the muscles before the start, none where they were not charged, and
    /// those that are held after the end, where they are known.
    pub fn new(system: &System, motion: &Trajectory, ends: [Option<&[f64]>; 2]) -> Self {
        let mut out = Self {
            sources: Vec::new(),
            is_complete: true,
        };
        for (source, named) in system.sources().into_iter().enumerate() {
            let [before, after] = ends.map(|row| row.map(|row| row[source]));
            let voltages = motion.voltages.iter().map(|row| row[source]);
            let mut voltages = voltages.chain(before).chain(after);
            let is_zero = voltages.all(|voltage| voltage == 0.0);
            // Other electrodes drive a current through the resistor of a source at zero volts.
            if is_zero && !system.has_electrodes_behind_resistor(source) {
                continue;
            }
            let muscle = system.muscles.get(source);
            if named.is_load() {
                out.is_complete &= named.kind != InputKind::Charge;
                continue;
            }
            match muscle.and_then(capacitance) {
                Some(of) => {
                    let lengths = lengths(system, motion, source);
                    let capacitances: Vec<f64> = lengths.iter().map(|&l| of.at_length(l)).collect();
                    let voltages = motion.voltages.iter().map(|row| row[source]);
                    let charges = motion.charges.get(&source);
                    let [electrical_energy, mechanical_work] = match charges {
                        Some(charges) => through_resistor(&capacitances, charges, voltages),
                        None => {
                            let voltages = motion.voltages_at_ends(source);
                            sums(&capacitances, voltages, [before, after])
                        }
                    };
                    let mut energies = SourceEnergies {
                        source,
                        name: named.name,
                        electrical_energy,
                        mechanical_work,
                        heats: Vec::new(),
                    };
                    let circuit = muscle.and_then(|muscle| muscle.circuit);
                    if let Some(circuit) = circuit.filter(|circuit| circuit.leakage.is_some()) {
                        energies.leak(&circuit, charges, motion);
                    }
                    out.sources.push(energies);
                }
                None => {
                    out.is_complete = false;
                    let circuit = system.electrode_circuit(source);
                    let charged = circuit.zip(motion.charges.get(&source));
                    out.sources.extend(charged.map(|(circuit, charges)| {
                        let name = named.name.replace('.', "_");
                        SourceEnergies::of_electrodes(source, name, &circuit, charges, motion)
                    }));
                }
            }
        }
        out
    }

    /// Electrical energy and mechanical work of all sources up to each instant, in mJ; none where there is no source, or where one
    /// drives finite elements.
    pub fn totals(&self) -> Option<[Vec<f64>; 2]> {
        let (first, others) = self.sources.split_first().filter(|_| self.is_complete)?;
        let mut totals = [
            first.electrical_energy.clone(),
            first.mechanical_work.clone(),
        ];
        for other in others {
            let added = [&other.electrical_energy, &other.mechanical_work];
            for (total, added) in totals.iter_mut().zip(added) {
                total.iter_mut().zip(added).for_each(|(sum, e)| *sum += e);
            }
        }
        Some(totals)
    }

    /// Both of all sources, then of each one.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        let mut add = |prefix: &str, [energy, work]: [Vec<f64>; 2]| {
            let both = [("electrical_energy", energy), ("mechanical_work", work)];
            for (name, values) in both.into_iter().filter(|(_, values)| !values.is_empty()) {
                let name = format!("{prefix}{name}");
                let unit = "N mm";
                columns.push(Column { name, unit, values });
            }
        };
        if let Some(totals) = self.totals() {
            add("", totals);
        }
        for source in &self.sources {
            let both = [&source.electrical_energy, &source.mechanical_work].map(Clone::clone);
            add(&format!("{}_", source.name), both);
        }
        for source in &self.sources {
            let heats = source.heats.iter().map(|(part, values)| Column {
                name: format!("{}_{part}_heat", source.name),
                unit: "N mm",
                values: values.clone(),
            });
            columns.extend(heats);
        }
        columns
    }
}

impl SourceEnergies {
    /// Of electrodes of finite elements behind a resistor with these charges, without the work within the elements.
    fn of_electrodes(
        source: usize,
        name: String,
        circuit: &Circuit,
        charges: &Vec<f64>,
        motion: &Trajectory,
    ) -> Self {
        let voltages = motion.voltages.iter().map(|row| row[source]);
        let still = vec![1.0; charges.len()];
        let [electrical_energy, _] = through_resistor(&still, charges, voltages);
        let mut energies = Self {
            source,
            name,
            electrical_energy,
            mechanical_work: Vec::new(),
            heats: Vec::new(),
        };
        energies.leak(circuit, Some(charges), motion);
        let has_part = |(part, _): &(&str, _)| *part == "resistor" || circuit.leakage.is_some();
        energies.heats.retain(has_part);
        energies
    }

    /// Adds what the source supplies to a leak, and the heat of the circuit; `charges` are those of a muscle behind a resistor.
    fn leak(&mut self, circuit: &Circuit, charges: Option<&Vec<f64>>, motion: &Trajectory) {
        let (mut sum, mut heats) = (0.0, [0.0; 2]);
        let mut columns = [vec![0.0], vec![0.0]];
        for (k, row) in motion.voltages.iter().enumerate() {
            let time = motion.times[k + 1] - motion.times[k];
            let charge = charges.map_or(0.0, |charges| charges[k + 1] - charges[k]);
            let (supplied, heat) = circuit.exchange(charge, row[self.source], time);
            sum += row[self.source] * (supplied - charge);
            self.electrical_energy[k + 1] += sum;
            for ((sum, heat), column) in heats.iter_mut().zip(heat).zip(&mut columns) {
                *sum += heat;
                column.push(*sum);
            }
        }
        let [of_resistor, of_leak] = columns;
        let resistor = circuit.resistance.map(|_| ("resistor", of_resistor));
        self.heats = resistor.into_iter().collect();
        self.heats.push(("leakage", of_leak));
    }
}

/// Length of a muscle in mm at each instant.
fn lengths(system: &System, motion: &Trajectory, muscle: usize) -> Vec<f64> {
    let muscle = &system.muscles[muscle];
    let instants = 0..motion.poses.len();
    let [from, to] = [&muscle.from, &muscle.to];
    let span = |k: usize| motion.point(k, to, system) - motion.point(k, from, system);
    instants.map(|k| span(k).norm()).collect()
}

/// Electrical energy and mechanical work from the start to each instant.
fn sums(
    capacitances: &[f64],
    voltages: impl Iterator<Item = [f64; 2]>,
    [before, after]: [Option<f64>; 2],
) -> [Vec<f64>; 2] {
    let mut sums = [vec![0.0], vec![0.0]];
    let [mut electrical, mut mechanical] = [0.0; 2];
    let mut last = before.unwrap_or(0.0);
    for (c, [from, to]) in capacitances.windows(2).zip(voltages) {
        electrical += from * c[0] * (from - last);
        electrical += 0.5 * (from + to) * (c[1] * to - c[0] * from);
        mechanical += 0.5 * from * to * (c[1] - c[0]);
        last = to;
        sums[0].push(electrical);
        sums[1].push(mechanical);
    }
    if let (Some(energy), Some(c), Some(after)) = (sums[0].last_mut(), capacitances.last(), after) {
        *energy += c * after * (after - last);
    }
    sums
}

/// The same of a muscle behind a resistor with these charges at the instants.
fn through_resistor(
    capacitances: &[f64],
    charges: &[f64],
    voltages: impl Iterator<Item = f64>,
) -> [Vec<f64>; 2] {
    let mut sums = [vec![0.0], vec![0.0]];
    let [mut electrical, mut mechanical] = [0.0; 2];
    let ends = capacitances.windows(2).zip(charges.windows(2));
    for ((c, q), voltage) in ends.zip(voltages) {
        let middle = 0.5 * (q[0] + q[1]);
        electrical += voltage * (q[1] - q[0]);
        mechanical -= 0.5 * middle * middle * (1.0 / c[1] - 1.0 / c[0]);
        sums[0].push(electrical);
        sums[1].push(mechanical);
    }
    sums
}
