//! Observations along a motion: stretches, charges, energies, momenta, constraints and states of parts, one row per instant.
//!
//! Every row holds what is so at its instant. The midpoint rule sees charges, energies and rates in the middle of intervals: between
//! two of them they are interpolated linearly (where voltages switch, that is the mean of both sides). Row 0 is read at q₀ with
//! the rates of its momenta, the last row at q_N under the last voltages with the rates of p_N; all of it is of second order.
//! For a method whose energies are those at instants ([`Reading::Instants`]), every row is read like row 0.
//!
//! The momenta are those at the instant: between the ends the mean of the momentum maps of p⁻ = −D₁L_d − f⁻ of the interval that
//! begins there and of p⁺ = D₂L_d + f⁺ of the one that ends there, of second order. Where no joint holds the system to the ground both
//! are equal; otherwise the impulses of its reactions over half a step to either side lie between them, and the mean has neither.

use crate::coordinates::{Configuration, Interval, Scratch};
use crate::dynamics::at_instant::AtInstant;
use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading};
use crate::dynamics::interval_energies::energies;
use crate::dynamics::momenta::{Places, momentum_maps, moving, vector_momenta};
use crate::dynamics::part_columns::PartColumns;
use crate::dynamics::pieces::{PIECE, in_pieces};
use crate::dynamics::reactions::reactions;
use crate::dynamics::to_instants::{Last, Momenta, means, to_instants};
use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::functional::{Order, TermKind};
use crate::math::{IsOver, Stopped, Vector};
use crate::model::{Model, Role, SolidBlock};
use std::ops::Range;

/// All that is observed along a motion, time, joint coordinates and markers first.
pub fn observations(model: &Model, discrete: &DiscreteTrajectory) -> Observations {
    let mut observations = Trajectory::from_discrete(model, discrete).observe(&model.system);
    let columns = observed(model, discrete, &|| false).expect("nothing stops it");
    observations.columns.extend(columns);
    observations
}

/// Returns the observations in addition to time, joint coordinates and markers; pieces of a long motion in parallel.
///
/// # Errors
/// It was over before the end.
pub fn observed(
    model: &Model,
    discrete: &DiscreteTrajectory,
    is_over: IsOver<'_>,
) -> Result<Vec<Column>, Stopped> {
    let mut columns = by_rows(model, discrete, is_over)?;
    columns.extend(reactions(model, discrete));
    Ok(columns)
}

/// Columns whose rows are made one by one.
fn by_rows(
    model: &Model,
    discrete: &DiscreteTrajectory,
    is_over: IsOver<'_>,
) -> Result<Vec<Column>, Stopped> {
    let count = discrete.z.len();
    let piece = match discrete.reading {
        Reading::Intervals => PIECE,
        // The factorisation of the masses keeps its order from the first instant on.
        Reading::Instants => count.max(1),
    };
    let rows = in_pieces(count, piece, |instants| {
        let mut observer = Observer::new(model);
        observer.begin(discrete, instants.start);
        let row = |k: usize| match k.is_multiple_of(PIECE) && is_over() {
            true => Err(Stopped),
            false => Ok(observer.row(discrete, k)),
        };
        instants.map(row).collect()
    })?;
    let mut observer = Observer::new(model);
    let mut columns = observer.columns();
    for column in &mut columns {
        column.values.reserve_exact(count);
    }
    for row in rows.iter() {
        for (column, value) in columns.iter_mut().zip(&row.values) {
            column.values.push(*value);
        }
    }
    let [of_intervals, of_momenta] = [observer.of_intervals(), observer.of_momenta()];
    let of_parts = columns.len() - observer.parts.columns(model).len()..columns.len();
    for (column, (kind, _)) in columns[of_intervals.end..].iter_mut().zip(observer.works()) {
        let is_lost = kind == TermKind::Dissipation;
        let (mut sum, sign) = (0.0, if is_lost { -1.0 } else { 1.0 });
        for work in &mut column.values {
            sum += sign * *work;
            *work = sum;
        }
    }
    if discrete.reading == Reading::Intervals && discrete.times.len() > 1 {
        let (mut last, times) = (observer.last(discrete), &discrete.times);
        to_instants(times, &mut columns[of_intervals], &last.of_intervals());
        let (parts, of) = (&mut columns[of_parts.clone()], (model, discrete));
        observer.parts.to_instants(of, parts, &mut last.parts);
        let before: Vec<_> = rows.iter().map(|row| row.before).collect();
        means(&discrete.times, &mut columns[of_momenta], &before, &last);
    }
    for (k, row) in rows.iter().enumerate() {
        for (column, added) in columns[of_parts.clone()].iter_mut().zip(&row.switched) {
            column.values[k] += added;
        }
    }
    Ok(columns)
}

/// Observations at one instant.
struct Row {
    /// By column; what belongs to intervals as the one that ends here sees it, of work the part of that interval.
    values: Vec<f64>,
    /// Momenta at the instant before, as that interval sees them.
    before: Momenta,
    /// Additions to the last columns by charges that flow at the instant.
    switched: Vec<f64>,
}

/// The storage to observe one instant after the other.
struct Observer<'m> {
    model: &'m Model,
    before: Configuration,
    here: Configuration,
    scratch: Scratch,
    at_instant: AtInstant<'m>,
    parts: PartColumns,
    /// Effects of forces on joint coordinates on the whole system.
    pulls: Vec<[Vector; 2]>,
}

impl<'m> Observer<'m> {
    fn new(model: &'m Model) -> Self {
        Self {
            model,
            before: model.action.map.instant(),
            here: model.action.map.instant(),
            scratch: model.action.scratch(Order::Gradient),
            at_instant: AtInstant::new(model),
            parts: PartColumns::new(model),
            pulls: model.pulls(),
        }
    }

    /// Goes to the instant before this one.
    fn begin(&mut self, discrete: &DiscreteTrajectory, k: usize) {
        if let Some(k) = k.checked_sub(1) {
            self.before.z.copy_from_slice(&discrete.z[k]);
            self.model.action.map.place(&mut self.before);
        }
    }

    /// The columns that the midpoint rule sees in the middle of intervals.
    fn of_intervals(&self) -> Range<usize> {
        let columns = self.columns();
        let total = columns.iter().position(|c| c.name == "total_energy");
        let total = total.expect("there is a total energy");
        self.model.system.muscles.len()..total + 1
    }

    /// Columns of the momenta.
    fn of_momenta(&self) -> Range<usize> {
        let columns = self.columns();
        let first = columns.iter().position(|c| c.name == "linear_momentum_x");
        let first = first.expect("there is a momentum");
        first..first + 6
    }

    /// Charges and energies at the last instant under the last voltages, and the momenta there.
    fn last(&mut self, discrete: &DiscreteTrajectory) -> Last {
        let (model, end) = (self.model, discrete.intervals());
        let scalars = &discrete.scalars[end - 1];
        self.here.z.copy_from_slice(&discrete.z[end]);
        model.action.map.place(&mut self.here);
        self.before.clone_from(&self.here);
        let potential = energies(model, &self.here, &self.here, scalars, 1.0).potential;
        let immobile = model.solids.iter();
        let immobile = immobile.flat_map(|block| block.immobile_charges(&self.here.x, scalars));
        let mut charges: Vec<f64> = immobile.collect();
        charges.extend(self.interval(scalars, 1.0));
        let (kinetic, momenta) = self.moves(discrete, end);
        Last {
            charges,
            kinetic,
            potential,
            parts: self.parts.values(model, &self.here, scalars),
            momenta: self.maps(&self.here, &momenta, &vec![Vector::zeros(); momenta.len()]),
        }
    }

    /// Kinds of work that are done, each with the name of its sum.
    fn works(&self) -> impl Iterator<Item = (TermKind, &'static str)> {
        let terms = &self.model.action.intervals.terms;
        let has = |kind| terms.iter().any(|term| term.kind() == kind);
        let all = [
            (TermKind::Dissipation, "dissipated_energy"),
            (TermKind::AppliedWork, "following_load_work"),
        ];
        all.into_iter().filter(move |(kind, _)| has(*kind))
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
            if term.kind() == TermKind::Potential {
                for part in term.energy_parts() {
                    add(format!("{}_energy", part.replace(' ', "_")), "N mm");
                }
            }
        }
        add("total_energy".to_owned(), "N mm");
        for (_, name) in self.works() {
            add(name.to_owned(), "N mm");
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
        for name in self.model.viscous_stretches() {
            add(name, "");
        }
        for name in self.model.electrodes() {
            add(name, "V");
        }
        columns.extend(self.parts.columns(self.model));
        columns
    }

    /// Returns the observations at instant k.
    fn row(&mut self, discrete: &DiscreteTrajectory, k: usize) -> Row {
        let model = self.model;
        let none = vec![0.0; model.action.intervals.scalars];
        let scalars = discrete.scalars.get(k.saturating_sub(1)).unwrap_or(&none);
        self.here.z.copy_from_slice(&discrete.z[k]);
        model.action.map.place(&mut self.here);
        let is_at_instant = k == 0 || discrete.reading == Reading::Instants;
        let h = match is_at_instant {
            true => {
                self.before = self.here.clone();
                1.0
            }
            false => discrete.times[k] - discrete.times[k - 1],
        };
        let mut energies = energies(model, &self.before, &self.here, scalars, h);
        if discrete.reading == Reading::Instants {
            let works = k.checked_sub(1).and_then(|k| discrete.works.get(k));
            energies.work = works.copied().unwrap_or_default();
        }
        let charges = self.interval(scalars, h);
        let ([before, momenta], parts) = match is_at_instant {
            true => {
                let momenta;
                (energies.kinetic, momenta) = self.moves(discrete, k);
                let none = vec![Vector::zeros(); momenta.len()];
                let maps = [[0.0; 6], self.maps(&self.here, &momenta, &none)];
                (maps, self.parts.values(model, &self.here, scalars))
            }
            false => {
                let ends = [&self.before, &self.here];
                let parts = self.parts.of_interval(model, ends, (scalars, h));
                (self.of_interval(h), parts)
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
        row.extend(self.works().map(|(kind, _)| match kind {
            TermKind::AppliedWork => energies.work.applied,
            _ => energies.work.dissipation,
        }));
        row.extend(momenta);
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
        let viscous = model.viscous_coordinates();
        row.extend(viscous.map(|coordinate| self.here.z[coordinate].exp()));
        row.extend(model.electrode_voltages(&self.here, scalars));
        row.extend(parts);
        let switched = self.parts.switched(model, &self.here, (discrete, k));
        std::mem::swap(&mut self.before, &mut self.here);
        Row {
            values: row,
            before,
            switched,
        }
    }

    /// Kinetic energy ½ p·v at instant k, and the momenta of all vectors with its rates v.
    fn moves(&mut self, discrete: &DiscreteTrajectory, k: usize) -> (f64, Vec<Vector>) {
        let momentum = self
            .at_instant
            .momentum(discrete, k, &self.here, &mut self.scratch);
        let at_instant = &mut self.at_instant;
        let rates = at_instant.rates(discrete, k, &mut self.here, &momentum);
        let products = momentum.iter().zip(&rates).map(|(p, v)| p * v);
        let kinetic = 0.5 * products.sum::<f64>();
        (kinetic, moving(self.model, &mut self.here, &rates))
    }

    /// The momentum maps of p⁻ at the beginning of the interval that ends here, and of p⁺ at its end, from the forces of the interval.
    fn of_interval(&self, h: f64) -> [Momenta; 2] {
        let ends = || self.before.x.iter().zip(&self.here.x);
        let middles: Vec<Vector> = ends().map(|(a, b)| (a + b) * 0.5).collect();
        let rates: Vec<Vector> = ends().map(|(a, b)| (b - a) / h).collect();
        let momenta = vector_momenta(self.model, &middles, &rates);
        let impulses = |instant: &Configuration, sign: f64| -> Vec<Vector> {
            let pairs = instant.forces.iter().zip(&momenta);
            pairs.map(|(f, p)| f * sign - p).collect()
        };
        let at = |instant, sign| self.maps(instant, &momenta, &impulses(instant, sign));
        [at(&self.before, -1.0), at(&self.here, 1.0)]
    }

    /// Momentum maps of momenta and impulses of all vectors of an instant.
    fn maps(&self, instant: &Configuration, momenta: &[Vector], impulses: &[Vector]) -> Momenta {
        let places = Places {
            poses: &self.model.condensed_poses(instant),
            x: &instant.x,
            pulls: &self.pulls,
        };
        let [p, l] = momentum_maps(&self.model.vectors, &places, momenta, impulses);
        [p.x, p.y, p.z, l.x, l.y, l.z]
    }

    /// Charges −∂W/∂V of the interval that ends here; leaves its forces on both instants.
    fn interval(&mut self, scalars: &[f64], h: f64) -> Vec<f64> {
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
        self.model.charges(&scratch.interval.plain.rows, h)
    }

    /// max |g| over the constraints that the coordinates leave open, those that loops leave out among them.
    fn violation(&mut self) -> f64 {
        let model = self.model;
        model
            .action
            .evaluate_instant(Order::Gradient, &mut self.here, &[], &mut self.scratch);
        let rows = &self.scratch.instant.plain.rows;
        let kept = rows.iter().fold(0.0_f64, |m, row| m.max(row.abs())) / model.multiplier_time;
        kept.max(model.loop_violation(&self.here))
    }
}
