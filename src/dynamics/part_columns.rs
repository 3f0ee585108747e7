//! Columns of the parts of a system in motion: rates of joints, speeds of markers, tensions and fields of muscles, currents and powers of their sources,
//! powers of loads. What does not exist has no column.
//!
//! Within an interval the voltage V of a source is constant, and its current is `V Ċ`. Where the voltage changes between two intervals,
//! the charge `C (V₂ − V₁)` flows at an instant; it counts as a current over the half intervals beside the instant.

use crate::coordinates::Configuration;
use crate::dynamics::discrete_trajectory::DiscreteTrajectory;
use crate::dynamics::to_instants::{beyond_middles, to_instants};
use crate::dynamics::trajectory::Column;
use crate::math::Vector;
use crate::model::{Model, MuscleReading, joint_unit};

/// The parts whose state is read.
#[derive(Debug)]
pub(super) struct PartColumns {
    joints: Vec<usize>,
    /// Markers that can move, each with its vector.
    markers: Vec<(usize, usize)>,
    muscles: Vec<MuscleReading>,
    /// Sources and scalars of loads.
    loads: Vec<(usize, usize)>,
}

impl PartColumns {
    pub(super) fn new(model: &Model) -> Self {
        Self {
            joints: model.moving_joints(),
            markers: model.moving_markers(),
            muscles: model.muscle_readings(),
            loads: model.working_loads(),
        }
    }

    /// Names and units, in the order of [`Self::values`].
    pub(super) fn columns(&self, model: &Model) -> Vec<Column> {
        let mut columns = Vec::new();
        let mut add = |name: &str, quantity: &str, unit: &'static str| {
            columns.push(Column {
                name: format!("{name}_{quantity}"),
                unit,
                values: Vec::new(),
            });
        };
        let system = &model.system;
        for &joint in &self.joints {
            let unit = match joint_unit(system, joint) {
                "mm" => "mm/ms",
                _ => "rad/ms",
            };
            add(&system.joints[joint].name, "rate", unit);
        }
        for &(marker, _) in &self.markers {
            add(&system.markers[marker].name, "speed", "mm/ms");
        }
        for reading in &self.muscles {
            let name = &system.muscles[reading.muscle].name;
            add(name, "tension", "N");
            if reading.has_voltage() {
                add(name, "field", "V/um");
            }
            if reading.has_source() {
                add(name, "current", "A");
                add(name, "power", "W");
            }
        }
        for circuit in &model.electrode_circuits {
            for (quantity, unit) in [("voltage", "V"), ("current", "A"), ("power", "W")] {
                add(&circuit.name().replace('.', "_"), quantity, unit);
            }
        }
        for &(source, _) in &self.loads {
            add(&model.sources[source].name, "power", "W");
        }
        columns
    }

    /// Turns values in the middle of intervals into values at the rows, of which `last` holds the last ones; the potentials of electrodes behind
    /// resistors are known within intervals only and are extrapolated to both ends.
    pub(super) fn to_instants(
        &self,
        (model, discrete): (&Model, &DiscreteTrajectory),
        columns: &mut [Column],
        last: &mut [f64],
    ) {
        let circuits = &model.electrode_circuits;
        let first = columns.len() - self.loads.len() - 3 * circuits.len();
        let scalars = [0, discrete.intervals() - 1].map(|k| &discrete.scalars[k]);
        for (c, circuit) in circuits.iter().enumerate() {
            let first = first + 3 * c;
            let across = beyond_middles(&discrete.times, &columns[first].values);
            let [start, end] = [0, 1].map(|i| circuit.flow(across[i], scalars[i]));
            for i in 0..3 {
                columns[first + i].values[0] = start[i];
                last[first + i] = end[i];
            }
        }
        to_instants(&discrete.times, columns, last);
    }

    /// Values at a placed configuration with the rates `l` of its coordinates and `w` of its vectors, and the scalars there.
    pub(super) fn values(&self, model: &Model, at: &Configuration, scalars: &[f64]) -> Vec<f64> {
        let rates = self.joints.iter().map(|&j| model.joint_rate(j, at));
        let speeds = self.markers.iter().map(|&(_, vector)| at.w[vector].norm());
        let mut values: Vec<f64> = rates.chain(speeds).collect();
        for reading in &self.muscles {
            values.push(reading.tension(model, at, scalars));
            if reading.has_voltage() {
                values.push(reading.field(model, at, scalars));
            }
            let flow = reading.flow(model, at, scalars);
            values.extend(flow.iter().flat_map(|flow| [flow.current, flow.power]));
        }
        let circuits = model.electrode_circuits.iter();
        values.extend(circuits.flat_map(|circuit| circuit.flow(circuit.voltage(scalars), scalars)));
        let state = [at.x.as_slice(), at.w.as_slice()];
        let loads = self.loads.iter();
        values.extend(loads.map(|&(_, scalar)| model.load_power(scalar, state, scalars)));
        values
    }

    /// Values in the middle of an interval of h ms between two placed instants.
    pub(super) fn of_interval(
        &self,
        model: &Model,
        [a, b]: [&Configuration; 2],
        (scalars, h): (&[f64], f64),
    ) -> Vec<f64> {
        let mut middle = b.clone();
        let ends = a.z.iter().zip(&b.z);
        middle.z = ends.clone().map(|(a, b)| 0.5 * (a + b)).collect();
        middle.l = ends.map(|(a, b)| (b - a) / h).collect();
        let ends = || a.x.iter().zip(&b.x);
        middle.x = ends().map(|(a, b)| (a + b) * 0.5).collect::<Vec<Vector>>();
        middle.w = ends().map(|(a, b)| (b - a) / h).collect();
        let mut values = self.values(model, &middle, scalars);
        // Coordinates instead of vectors, which turn by less in the middle.
        let before = model.joints(a, &vec![0.0; model.joint_readings.len()]);
        let after = model.joints(b, &before);
        for (value, &joint) in values.iter_mut().zip(&self.joints) {
            *value = (after[joint] - before[joint]) / h;
        }
        values
    }

    /// Additions to the values at placed instant k by charges that flow at it.
    pub(super) fn switched(
        &self,
        model: &Model,
        here: &Configuration,
        (discrete, k): (&DiscreteTrajectory, usize),
    ) -> Vec<f64> {
        let mut added = vec![0.0; self.joints.len() + self.markers.len()];
        let beside = k.checked_sub(1).filter(|_| k < discrete.intervals());
        for reading in &self.muscles {
            added.extend([0.0].iter().chain(reading.has_voltage().then_some(&0.0)));
            if reading.has_source() {
                added.extend(beside.map_or([0.0; 2], |before| {
                    let time = 0.5 * (discrete.times[k + 1] - discrete.times[before]);
                    let scalars = [before, k].map(|k| discrete.scalars[k].as_slice());
                    let flow = reading.switched(model, here, scalars);
                    flow.map(|flow| flow / time)
                }));
            }
        }
        let others = 3 * model.electrode_circuits.len() + self.loads.len();
        added.resize(added.len() + others, 0.0);
        added
    }
}
