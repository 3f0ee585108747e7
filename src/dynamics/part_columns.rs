//! Columns of the parts of a system in motion: rates of joints, speeds of markers, tensions and fields of muscles, currents and powers of their sources,
//! powers of loads. What does not exist has no column.
//!
//! The current of a source of the voltage V is `V Ċ + C V̇`, of which the second part is added at instants. Where the voltage switches between
//! two intervals, the charge `C (V₂ − V₁)` flows at an instant; it counts as a current over the half intervals beside the instant.

use crate::coordinates::{Configuration, Interval, Scratch};
use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading, Side};
use crate::dynamics::kinetic::Kinetic;
use crate::dynamics::momenta::{last_momentum, rates};
use crate::dynamics::trajectory::Column;
use crate::functional::Order;
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

    /// Additions to the values at a placed instant with these sides by the charges of sources whose voltages change; `time` is half of both intervals
    /// beside it.
    pub(super) fn charging(
        &self,
        model: &Model,
        here: &Configuration,
        (sides, time): (&[Side], f64),
    ) -> Vec<f64> {
        let mut added = vec![0.0; self.joints.len() + self.markers.len()];
        for reading in &self.muscles {
            added.extend([0.0].iter().chain(reading.has_voltage().then_some(&0.0)));
            if reading.has_source() {
                let mut flow = [0.0; 2];
                for side in sides {
                    let charging = reading.charging(model, here, [&side.scalars, &side.rates]);
                    flow = [0, 1].map(|i| flow[i] + side.weight * charging[i]);
                }
                if let [before, after] = sides {
                    let both = [&before.scalars[..], &after.scalars[..]];
                    let switched = reading.switched(model, here, both);
                    flow = [0, 1].map(|i| flow[i] + switched[i] / time);
                }
                added.extend(flow);
            }
        }
        let others = 3 * model.electrode_circuits.len() + self.loads.len();
        added.resize(added.len() + others, 0.0);
        added
    }
}

/// The storage to read them.
#[derive(Debug)]
pub(super) struct AtInstant<'m> {
    model: &'m Model,
    /// Made where rates follow from momenta under constraints.
    kinetic: Option<Kinetic<'m>>,
}

impl<'m> AtInstant<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        Self {
            model,
            kinetic: None,
        }
    }

    /// Momentum of each coordinate at instant k, which is placed `here`: as recorded, at the start as the first interval asks for
    /// it, and otherwise that of the last instant.
    pub(super) fn momentum(
        &self,
        discrete: &DiscreteTrajectory,
        k: usize,
        here: &Configuration,
        scratch: &mut Scratch,
    ) -> Vec<f64> {
        let model = self.model;
        if let Some(momentum) = discrete.momenta.get(k) {
            return momentum.clone();
        }
        let n = model.coordinate_count();
        if k > 0 {
            return last_momentum(model, discrete).unwrap_or_else(|| vec![f64::NAN; n]);
        }
        let Some(scalars) = discrete.scalars.first() else {
            return vec![0.0; n];
        };
        let (mut a, mut b) = (here.clone(), here.clone());
        b.z.copy_from_slice(&discrete.z[1]);
        model.action.map.place(&mut b);
        a.forces.fill(Vector::zeros());
        model.action.evaluate_interval(
            Order::Gradient,
            [&mut a, &mut b],
            &Interval::given(scalars, discrete.times[1] - discrete.times[0]),
            scratch,
        );
        model
            .action
            .evaluate_instant(Order::Gradient, &mut a, &[], scratch);
        let mut rows = vec![0.0; model.action.map.unknowns()];
        model.action.rows(&mut a, scratch, &mut rows);
        rows[..n].iter().map(|row| -row).collect()
    }

    /// Rates of the coordinates at instant k, which is placed `here`: as recorded at the start, or those of the momentum that
    /// meet the constraints.
    pub(super) fn rates(
        &mut self,
        discrete: &DiscreteTrajectory,
        k: usize,
        here: &mut Configuration,
        momentum: &[f64],
    ) -> Vec<f64> {
        let model = self.model;
        if let (0, Some(known)) = (k, &discrete.rates) {
            return known.clone();
        }
        if model.prescribed.is_empty() && momentum.iter().all(|p| *p == 0.0) {
            return vec![0.0; momentum.len()];
        }
        let time = discrete.begun + discrete.times[k];
        let is_constrained = model.action.map.multipliers > 0;
        if discrete.reading != Reading::Intervals || is_constrained {
            let kinetic = self.kinetic.get_or_insert_with(|| Kinetic::new(model));
            if let Some(rates) = kinetic.rates(here, time, momentum) {
                return rates;
            }
        }
        rates(model, here, time, momentum)
    }
}
