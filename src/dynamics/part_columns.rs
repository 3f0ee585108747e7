//! Columns of the parts of a system in motion: rates of joints, speeds of markers, tensions and fields of muscles, currents and powers of their sources,
//! powers of loads, forces of contacts. What does not exist has no column.
//!
//! The current of a source of the voltage V is `V Ċ + C V̇`, of which the second part is added at instants. Where the voltage switches between
//! two intervals, the charge `C (V₂ − V₁)` flows at an instant; it counts as a current over the half intervals beside the instant.
//!
//! Forces and torques that joints transmit, from the balance of momentum of the bodies on one side of each.
//!
//! The midpoint rule changes the momentum of these bodies at instant k by the impulses of the forces in the halves of the intervals
//! beside it; what is missing is the impulse of the joint during that time, and its mean the reaction at the instant, of second order.
//! First and last row are extrapolated linearly. Motors, springs, stops and dampers of a joint act through it and are included.

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::momenta::{Kinetic, last_momentum, rates};
use crate::dynamics::trajectory::{Column, DiscreteTrajectory, Reading, Side};
use crate::functional::{Order, Output, Sample};
use crate::math::Vector;
use crate::model::{JOINT_DAMPING, JointSection, Model, MuscleReading, joint_unit};
use nalgebra::DVector;

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
        for contact in &model.contacts {
            for (quantity, unit) in contact.columns() {
                add(&contact.name, quantity, unit);
            }
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
            values.extend(flow.into_iter().flatten());
        }
        let circuits = model.electrode_circuits.iter();
        values.extend(circuits.flat_map(|circuit| circuit.flow(circuit.voltage(scalars), scalars)));
        let state = [at.x.as_slice(), at.w.as_slice()];
        let loads = self.loads.iter();
        values.extend(loads.map(|&(_, scalar)| model.load_power(scalar, state, scalars)));
        values.extend(model.contacts.iter().flat_map(|one| one.values(state)));
        values
    }

    /// Values in the middle of an interval of h ms between two placed instants.
    pub(super) fn of_interval(
        &self,
        model: &Model,
        [a, b]: [&Configuration; 2],
        scalars: &[f64],
        h: f64,
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
        sides: &[Side],
        time: f64,
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

/// Momentum of each coordinate at instant k, which is placed `here`: as recorded, at the start as the first interval asks for
/// it, and otherwise that of the last instant.
pub(super) fn momentum(
    model: &Model,
    discrete: &DiscreteTrajectory,
    k: usize,
    here: &Configuration,
    scratch: &mut Scratch,
) -> Vec<f64> {
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
        &Sample::of_interval(scalars, discrete.times[1] - discrete.times[0]),
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
/// meet the constraints, for which `kinetic` is made where it is needed.
pub(super) fn rates_at<'m>(
    model: &'m Model,
    kinetic: &mut Option<Kinetic<'m>>,
    discrete: &DiscreteTrajectory,
    k: usize,
    here: &mut Configuration,
    momentum: &[f64],
) -> Vec<f64> {
    if let (0, Some(known)) = (k, &discrete.rates) {
        return known.clone();
    }
    if model.prescribed.is_empty() && momentum.iter().all(|p| *p == 0.0) {
        return vec![0.0; momentum.len()];
    }
    let time = discrete.begun + discrete.times[k];
    let is_constrained = model.action.map.multipliers > 0;
    if discrete.reading != Reading::Intervals || is_constrained {
        let kinetic = kinetic.get_or_insert_with(|| Kinetic::new(model));
        if let Some(rates) = kinetic.rates(here, time, momentum) {
            return rates;
        }
    }
    rates(model, here, time, momentum)
}

/// Columns of the reactions of all joints outside of loops; none of methods whose energies are those at instants.
pub(super) fn reactions(model: &Model, discrete: &DiscreteTrajectory) -> Vec<Column> {
    let sections = match discrete.reading {
        Reading::Intervals => model.joint_sections(),
        Reading::Instants | Reading::States => Vec::new(),
    };
    if sections.is_empty() {
        return Vec::new();
    }
    let mut columns = columns(model, &sections);
    let rows = match discrete.intervals() {
        0 => return Vec::new(),
        _ if discrete.times.len() == 1 => {
            let [before, after] = Impulses::new(model, &sections).between([0, 0], discrete, 1.0);
            vec![before + after]
        }
        _ => of_motion(model, &sections, discrete),
    };
    for (i, column) in columns.iter_mut().enumerate() {
        column.values = rows.iter().map(|row| row[i]).collect();
    }
    columns
}

fn columns(model: &Model, sections: &[JointSection]) -> Vec<Column> {
    let of_section = |section: &JointSection| {
        let name = &model.system.joints[section.joint].name;
        let torque = section.has_torque.then_some(("torque", "N mm"));
        let quantities = [("force", "N")].into_iter().chain(torque);
        let column = |quantity: &str, unit: &'static str, axis: &str| Column {
            name: format!("{name}_{quantity}_{axis}"),
            unit,
            values: Vec::new(),
        };
        let all =
            quantities.flat_map(|(of, unit)| ["x", "y", "z"].map(|axis| column(of, unit, axis)));
        all.collect::<Vec<_>>()
    };
    sections.iter().flat_map(of_section).collect()
}

/// Reactions at all instants.
fn of_motion(
    model: &Model,
    sections: &[JointSection],
    discrete: &DiscreteTrajectory,
) -> Vec<DVector<f64>> {
    let times = &discrete.times;
    let end = discrete.intervals();
    let mut impulses = Impulses::new(model, sections);
    let mut halves = Vec::with_capacity(end);
    for k in 0..end {
        let h = times[k + 1] - times[k];
        halves.push(impulses.between([k, k + 1], discrete, h));
    }
    let inner = (1..end).map(|k| {
        let impulse = &halves[k - 1][1] + &halves[k][0];
        impulse / (0.5 * (times[k + 1] - times[k - 1]))
    });
    let inner: Vec<DVector<f64>> = inner.collect();
    let part = |a: usize, b: usize, c: usize| (times[a] - times[b]) / (times[b] - times[c]);
    let beyond = |a: &DVector<f64>, b: &DVector<f64>, part: f64| a + (a - b) * part;
    let ends = match inner.as_slice() {
        // One interval: the mean over it.
        [] => {
            let mean = (&halves[0][0] + &halves[0][1]) / (times[1] - times[0]);
            [mean.clone(), mean]
        }
        [only] => [only.clone(), only.clone()],
        [first, second, ..] => {
            let [before, last] = [&inner[end - 3], &inner[end - 2]];
            [
                beyond(first, second, part(0, 1, 2)),
                beyond(last, before, part(end, end - 1, end - 2)),
            ]
        }
    };
    let [first, last] = ends;
    [first].into_iter().chain(inner).chain([last]).collect()
}

/// The storage of impulses of an interval.
struct Impulses<'m> {
    model: &'m Model,
    sections: &'m [JointSection],
    out: Output,
}

impl<'m> Impulses<'m> {
    fn new(model: &'m Model, sections: &'m [JointSection]) -> Self {
        let out = model.action.intervals.output(Order::Gradient);
        Self {
            model,
            sections,
            out,
        }
    }

    /// Impulses of the joints at both ends of an interval of h ms that balance its forces.
    fn between(
        &mut self,
        ends: [usize; 2],
        discrete: &DiscreteTrajectory,
        h: f64,
    ) -> [DVector<f64>; 2] {
        let Self {
            model,
            sections,
            out,
        } = self;
        let action = &model.action;
        let scalars = &discrete.scalars[ends[0]];
        let placed = ends.map(|k| action.map.placed(&discrete.z[k]));
        let sample = Sample {
            vectors: [&placed[0].x, &placed[1].x],
            h,
            ..Sample::of_instant(&placed[0].x, scalars)
        };
        out.plain.clear(false);
        for (term, slots) in action.intervals.terms() {
            if term.name() != JOINT_DAMPING {
                term.evaluate(Order::Gradient, &sample, slots, out);
            }
        }
        [0, 1].map(|side| {
            let poses = model.condensed_poses(&placed[side]);
            let wrenches = model.wrenches(&poses, &out.plain.forces[side]);
            let reaction = |section: &JointSection| {
                let [force, torque] = section.reaction(&wrenches, &poses);
                let torque = section.has_torque.then_some(torque);
                let parts = [force].into_iter().chain(torque);
                parts.flat_map(|v| [v.x, v.y, v.z]).collect::<Vec<_>>()
            };
            let reactions: Vec<f64> = sections.iter().flat_map(reaction).collect();
            reactions.into()
        })
    }
}
