//! What is observed along a motion: stretches, charges, energies, momenta and constraints, one row per instant.
//!
//! Every row holds what is so at its instant. The midpoint rule sees charges and energies in the middle of intervals: between
//! two of them they are interpolated linearly (where voltages switch, that is the mean of both sides). Row 0 is read at q₀ with
//! the rates of its momenta, the last row at q_N under the last voltages, with the kinetic energy carried on from the last two
//! intervals; all of it is of second order. Where a method means energies at instants ([`Reading::Instants`]), every row is read
//! like row 0. The momenta are the momentum maps of p⁺ = D₂L_d + f⁺, which an invariant motion conserves exactly; reactions of
//! joints enter with the next interval.

use crate::coordinates::{Configuration, Interval, Scratch};
use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading};
use crate::dynamics::interval_energies::energies;
use crate::dynamics::kinetic::Kinetic;
use crate::dynamics::momenta::{Places, momentum_maps, moving, rates, vector_momenta};
use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::functional::{Kind, Order};
use crate::math::{Vector, has_pool};
use crate::model::{Model, Role, SolidBlock};
use rayon::prelude::*;
use std::ops::Range;

/// Instants that one thread observes in a row.
const PIECE: usize = 256;

/// All that is observed along a motion, time, joint coordinates and markers first.
pub fn observations(model: &Model, history: &DiscreteTrajectory) -> Observations {
    let mut observations = Trajectory::from_history(model, history).observe(&model.system);
    observations.columns.extend(observed(model, history));
    observations
}

/// What is observed besides time, joint coordinates and markers; pieces of a long motion at once.
pub fn observed(model: &Model, history: &DiscreteTrajectory) -> Vec<Column> {
    let count = history.z.len();
    let piece = match history.reading {
        Reading::Intervals => PIECE,
        // The factorisation of the masses keeps its order from the first instant on.
        Reading::Instants => count.max(1),
    };
    let pieces = count.div_ceil(piece);
    let rows = |i: usize| {
        let mut observer = Observer::new(model);
        let instants = i * piece..count.min((i + 1) * piece);
        observer.begin(history, instants.start);
        instants
            .map(|k| observer.row(history, k))
            .collect::<Vec<_>>()
    };
    let rows: Vec<_> = match has_pool() {
        true => {
            let pieces = (0..pieces).into_par_iter().with_max_len(1);
            pieces.map(rows).collect()
        }
        false => (0..pieces).map(rows).collect(),
    };
    let mut observer = Observer::new(model);
    let mut columns = observer.columns();
    for column in &mut columns {
        column.values.reserve_exact(count);
    }
    for row in rows.iter().flatten() {
        for (column, value) in columns.iter_mut().zip(row) {
            column.values.push(*value);
        }
    }
    let of_intervals = observer.of_intervals();
    if observer.has(Kind::VirtualWork) {
        let mut dissipated = 0.0;
        for work in &mut columns[of_intervals.end].values {
            dissipated -= *work;
            *work = dissipated;
        }
    }
    if history.reading == Reading::Intervals && history.times.len() > 1 {
        let last = observer.last(history);
        to_instants(&history.times, &mut columns[of_intervals], &last);
    }
    columns
}

/// Turns charges, kinetic, potential and total energy in the middle of the intervals that end at the rows into those at the
/// rows; `last` holds the charges and potential energies of the last one.
fn to_instants(times: &[f64], columns: &mut [Column], last: &Ends) {
    let end = times.len() - 1;
    let length = |k: usize| times[k] - times[k - 1];
    // Kinetic energy half an interval after the middle of the last one.
    let of_kinetic = &columns[last.charges.len()].values;
    let kinetic = match end {
        1 => 2.0 * of_kinetic[1] - of_kinetic[0],
        _ => {
            let slope = (of_kinetic[end] - of_kinetic[end - 1]) / (length(end) + length(end - 1));
            of_kinetic[end] + slope * length(end)
        }
    };
    let kinetic = kinetic.max(0.0);
    let total = kinetic + last.potential.iter().sum::<f64>();
    for column in &mut *columns {
        for k in 1..end {
            let (before, after) = (length(k), length(k + 1));
            let sum = column.values[k] * after + column.values[k + 1] * before;
            column.values[k] = sum / (before + after);
        }
    }
    let ends = last.charges.iter().copied().chain([kinetic]);
    let ends = ends.chain(last.potential.iter().copied()).chain([total]);
    for (column, value) in columns.iter_mut().zip(ends) {
        column.values[end] = value;
    }
}

/// Charges and potential energies at the last instant.
#[derive(Debug)]
struct Ends {
    charges: Vec<f64>,
    potential: Vec<f64>,
}

/// The storage to observe one instant after the other.
struct Observer<'m> {
    model: &'m Model,
    before: Configuration,
    here: Configuration,
    scratch: Scratch,
    /// Made where momenta are read at instants.
    kinetic: Option<Kinetic<'m>>,
    /// What forces on joint coordinates do to the whole system.
    pulls: Vec<[Vector; 2]>,
}

impl<'m> Observer<'m> {
    fn new(model: &'m Model) -> Self {
        Self {
            model,
            before: model.action.motion.instant(),
            here: model.action.motion.instant(),
            scratch: model.action.scratch(Order::Gradient),
            kinetic: None,
            pulls: model.presolved.system.joint_pulls(),
        }
    }

    /// Goes to the instant before this one.
    fn begin(&mut self, history: &DiscreteTrajectory, k: usize) {
        if let Some(k) = k.checked_sub(1) {
            self.before.z.copy_from_slice(&history.z[k]);
            self.model.action.motion.place(&mut self.before);
        }
    }

    /// The columns that the midpoint rule sees in the middle of intervals.
    fn of_intervals(&self) -> Range<usize> {
        let columns = self.columns();
        let total = columns.iter().position(|c| c.name == "total_energy");
        let total = total.expect("there is a total energy");
        self.model.system.muscles.len()..total + 1
    }

    /// Charges and potential energies at the last instant under the last voltages.
    fn last(&mut self, history: &DiscreteTrajectory) -> Ends {
        let model = self.model;
        let scalars = &history.scalars[history.intervals() - 1];
        self.here.z.copy_from_slice(&history.z[history.intervals()]);
        model.action.motion.place(&mut self.here);
        self.before.clone_from(&self.here);
        let potential = energies(model, &self.here, &self.here, scalars, 1.0).potential;
        let immobile = model.solids.iter();
        let immobile = immobile.flat_map(|block| block.immobile_charges(&self.here.x, scalars));
        let mut charges: Vec<f64> = immobile.collect();
        charges.extend(self.interval(scalars, 1.0).0);
        Ends { charges, potential }
    }

    fn has(&self, kind: Kind) -> bool {
        let mut terms = self.model.action.intervals.terms.iter();
        terms.any(|term| term.kind() == kind)
    }

    /// Names and units, in the order of [`Self::row`].
    fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        let mut add = |name: String, unit: &'static str| {
            columns.push(Column {
                name,
                unit,
                values: Vec::new(),
            });
        };
        let system = &self.model.system;
        for muscle in &system.muscles {
            add(format!("{}_stretch", muscle.name), "");
        }
        let electrodes = self
            .model
            .solids
            .iter()
            .flat_map(SolidBlock::immobile_electrodes);
        for (block, electrode) in electrodes {
            add(format!("{block}_{electrode}_charge"), "mC");
        }
        for voltage in self.model.variables.with(Role::Voltage) {
            let name = voltage.name.replace('.', "_");
            add(format!("{name}_charge"), "mC");
        }
        add("kinetic_energy".to_owned(), "N mm");
        for term in &self.model.action.intervals.terms {
            if term.kind() == Kind::Potential {
                for part in term.energy_parts() {
                    add(format!("{}_energy", part.replace(' ', "_")), "N mm");
                }
            }
        }
        add("total_energy".to_owned(), "N mm");
        if self.has(Kind::VirtualWork) {
            add("dissipated_energy".to_owned(), "N mm");
        }
        for (name, unit) in [("linear_momentum", "N ms"), ("angular_momentum", "N mm ms")] {
            for axis in ["x", "y", "z"] {
                add(format!("{name}_{axis}"), unit);
            }
        }
        add("constraint_violation".to_owned(), "");
        for component in system.components.iter() {
            for (quantity, unit) in component.columns() {
                add(format!("{}_{quantity}", component.name()), unit);
            }
        }
        columns
    }

    /// The values of the columns at instant k, of the dissipated energy the work of the interval before it.
    fn row(&mut self, history: &DiscreteTrajectory, k: usize) -> Vec<f64> {
        let model = self.model;
        let none = vec![0.0; model.action.intervals.scalars];
        let scalars = history.scalars.get(k.saturating_sub(1)).unwrap_or(&none);
        self.here.z.copy_from_slice(&history.z[k]);
        model.action.motion.place(&mut self.here);
        let by_momentum = k == 0 || history.reading == Reading::Instants;
        let (h, at_instant) = if by_momentum {
            self.before = self.here.clone();
            (1.0, Some(self.momentum(history, k)))
        } else {
            (history.times[k] - history.times[k - 1], None)
        };
        let mut energies = energies(model, &self.before, &self.here, scalars, h);
        if history.reading == Reading::Instants {
            let works = k.checked_sub(1).and_then(|k| history.works.get(k));
            energies.work = works.copied().unwrap_or_default();
        }
        let (charges, forces) = self.interval(scalars, h);
        let (momenta, impulses) = match at_instant {
            Some(momentum) => {
                let rates = self.rates(history, k, &momentum);
                let products = momentum.iter().zip(&rates).map(|(p, v)| p * v);
                energies.kinetic = 0.5 * products.sum::<f64>();
                let momenta = moving(model, &mut self.here, &rates);
                let none = vec![Vector::zeros(); momenta.len()];
                (momenta, none)
            }
            None => {
                let ends = || self.before.x.iter().zip(&self.here.x);
                let middles: Vec<Vector> = ends().map(|(a, b)| (a + b) * 0.5).collect();
                let rates: Vec<Vector> = ends().map(|(a, b)| (b - a) / h).collect();
                let momenta = vector_momenta(model, &middles, &rates);
                let impulses = forces.iter().zip(&momenta).map(|(f, p)| f - p).collect();
                (momenta, impulses)
            }
        };

        let mut row = Vec::new();
        let muscles = model.spans.iter().zip(&model.system.muscles);
        row.extend(muscles.map(|(&span, m)| self.here.x[span].norm() / m.length()));
        let ends = self.before.x.iter().zip(&self.here.x);
        let middles: Vec<Vector> = ends.map(|(a, b)| (a + b) * 0.5).collect();
        for block in &model.solids {
            row.extend(block.immobile_charges(&middles, scalars));
        }
        row.extend(charges);
        row.push(energies.kinetic);
        row.extend(&energies.potential);
        row.push(energies.total());
        if self.has(Kind::VirtualWork) {
            row.push(energies.work);
        }
        let poses = model.condensed_poses(&self.here);
        let places = Places {
            poses: &poses,
            x: &self.here.x,
            pulls: &self.pulls,
        };
        for map in momentum_maps(&model.vectors, &places, &momenta, &impulses) {
            row.extend(map.iter());
        }
        row.push(self.violation());
        if model.system.components.iter().next().is_some() {
            let bodies = model.poses(&self.here);
            let reference = |body: usize| model.system.bodies[body].pose();
            for component in model.system.components.iter() {
                let points = component.points();
                let places = points.iter().map(|point| point.place(&bodies, reference));
                row.extend(component.observe(&places.collect::<Vec<_>>()));
            }
        }
        std::mem::swap(&mut self.before, &mut self.here);
        row
    }

    /// Charges −∂W/∂V of the interval that ends here, and the momenta p⁺ of all vectors.
    fn interval(&mut self, scalars: &[f64], h: f64) -> (Vec<f64>, Vec<Vector>) {
        let Self {
            before,
            here,
            scratch,
            ..
        } = self;
        before.forces.fill(Vector::zeros());
        here.forces.fill(Vector::zeros());
        self.model.action.evaluate_interval(
            Order::Gradient,
            [before, here],
            &Interval::given(scalars, h),
            scratch,
        );
        let rows = &scratch.interval.plain.rows[self.model.variables.range(Role::Voltage)];
        let charges = rows.iter().map(|row| row / h);
        (charges.collect(), here.forces.clone())
    }

    /// Rates of the coordinates at instant k: as recorded at the start, or those of the momentum.
    fn rates(&mut self, history: &DiscreteTrajectory, k: usize, momentum: &[f64]) -> Vec<f64> {
        let model = self.model;
        if let (0, Some(known)) = (k, &history.rates) {
            return known.clone();
        }
        if history.reading == Reading::Instants {
            let kinetic = self.kinetic.get_or_insert_with(|| Kinetic::new(model));
            if let Some(rates) = kinetic.rates(&mut self.here, momentum) {
                return rates;
            }
        }
        rates(model, &mut self.here, momentum)
    }

    /// Momentum of each coordinate at instant k: as recorded, or at the start as the first interval asks for it.
    fn momentum(&mut self, history: &DiscreteTrajectory, k: usize) -> Vec<f64> {
        let model = self.model;
        if let Some(momentum) = history.momenta.get(k) {
            return momentum.clone();
        }
        let n = model.coordinate_count();
        let Some(scalars) = history.scalars.first() else {
            return vec![0.0; n];
        };
        let (mut a, mut b) = (self.here.clone(), self.here.clone());
        b.z.copy_from_slice(&history.z[1]);
        model.action.motion.place(&mut b);
        a.forces.fill(Vector::zeros());
        model.action.evaluate_interval(
            Order::Gradient,
            [&mut a, &mut b],
            &Interval::given(scalars, history.times[1] - history.times[0]),
            &mut self.scratch,
        );
        model
            .action
            .evaluate_instant(Order::Gradient, &mut a, &[], &mut self.scratch);
        let mut rows = vec![0.0; model.action.motion.unknowns()];
        model.action.rows(&mut a, &self.scratch, &mut rows);
        rows[..n].iter().map(|row| -row).collect()
    }

    /// max |g| over the constraints that the coordinates leave open.
    fn violation(&mut self) -> f64 {
        let model = self.model;
        model
            .action
            .evaluate_instant(Order::Gradient, &mut self.here, &[], &mut self.scratch);
        let rows = &self.scratch.instant.plain.rows;
        rows.iter().fold(0.0_f64, |m, row| m.max(row.abs())) / model.multiplier_time
    }
}
