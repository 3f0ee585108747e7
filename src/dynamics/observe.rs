//! Observations along a motion: stretches, charges, energies, momenta, constraints and states of parts, one row per instant.
//!
//! Every row holds what is so at its instant. The midpoint rule sees charges, energies and rates in the middle of intervals: between
//! two of them they are interpolated linearly. The first and the last row are read at q₀ and q_N under the inputs there, with the rates of
//! their momenta; all of it is of second order. For a method whose energies are those at instants ([`Reading::Instants`]), every row is read
//! so, under the inputs of both sides of the instant ([`sides`]), with the order of the method.
//!
//! The momenta are those at the instant: between the ends the mean of the momentum maps of p⁻ = −D₁L_d − f⁻ of the interval that
//! begins there and of p⁺ = D₂L_d + f⁺ of the one that ends there, of second order. Where no joint holds the system to the ground both
//! are equal; otherwise the impulses of its reactions over half a step to either side lie between them, and the mean has neither.

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::energies::{Work, energies};
use crate::dynamics::momenta::{Kinetic, Places, momentum_maps, moving, vector_momenta};
use crate::dynamics::part_columns::{PartColumns, momentum, rates_at, reactions};
use crate::dynamics::trajectory::{
    Column, DiscreteTrajectory, Observations, Reading, Side, Trajectory, sides,
};
use crate::functional::{Order, Sample, TermKind};
use crate::math::{IsOver, Stopped, Vector, has_pool};
use crate::model::{Model, Role, SolidBlock};
use rayon::prelude::*;
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
        Reading::Instants | Reading::States => count.max(1),
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
    let mut columns = columns(model, &observer.parts);
    for column in &mut columns {
        column.values.reserve_exact(count);
    }
    for row in rows.iter() {
        for (column, value) in columns.iter_mut().zip(&row.values) {
            column.values.push(*value);
        }
    }
    let place = |name: &str| {
        let place = columns.iter().position(|column| column.name == name);
        place.expect("a column of all models")
    };
    let of_intervals = model.system.muscles.len()..place("total_energy") + 1;
    let momentum = place("linear_momentum_x");
    let of_parts = columns.len() - observer.parts.columns(model).len()..columns.len();
    for (column, (kind, _)) in columns[of_intervals.end..].iter_mut().zip(works(model)) {
        let is_lost = kind == TermKind::Dissipation;
        let (mut sum, sign) = (0.0, if is_lost { -1.0 } else { 1.0 });
        for work in &mut column.values {
            sum += sign * *work;
            *work = sum;
        }
    }
    if discrete.reading == Reading::Intervals && discrete.times.len() > 1 {
        let (last, times) = (observer.last(discrete), &discrete.times);
        to_instants(times, &mut columns[of_intervals], &last.of_intervals());
        to_instants(times, &mut columns[of_parts.clone()], &last.parts);
        let before: Vec<_> = rows.iter().map(|row| row.before).collect();
        means(
            &discrete.times,
            &mut columns[momentum..momentum + 6],
            &before,
            &last,
        );
    }
    for (k, row) in rows.iter().enumerate() {
        for (column, added) in columns[of_parts.clone()].iter_mut().zip(&row.charging) {
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
    /// Additions to the last columns by voltages that change.
    charging: Vec<f64>,
}

/// The storage to observe one instant after the other.
struct Observer<'m> {
    model: &'m Model,
    before: Configuration,
    here: Configuration,
    scratch: Scratch,
    /// Made where rates follow from momenta under constraints.
    kinetic: Option<Kinetic<'m>>,
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
            kinetic: None,
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

    /// Values at the last instant.
    fn last(&mut self, discrete: &DiscreteTrajectory) -> State {
        let end = discrete.intervals();
        self.here.z.copy_from_slice(&discrete.z[end]);
        self.model.action.map.place(&mut self.here);
        self.state(discrete, end, &sides(self.model, discrete, end))
    }

    /// Values at instant k, which is placed, by the inputs of its sides.
    fn state(&mut self, discrete: &DiscreteTrajectory, k: usize, sides: &[Side]) -> State {
        let model = self.model;
        self.before.clone_from(&self.here);
        let potential = weighted(sides, |scalars| {
            energies(model, &self.here, &self.here, scalars, 1.0).potential
        });
        let charges = weighted(sides, |scalars| {
            let mut charges = immobile_charges(model, &self.here.x, scalars);
            charges.extend(self.interval(scalars, 1.0));
            charges
        });
        let (kinetic, momenta) = self.moves(discrete, k);
        let parts = weighted(sides, |scalars| {
            self.parts.values(model, &self.here, scalars)
        });
        let none = vec![Vector::zeros(); momenta.len()];
        let momenta = self.maps(&self.here, &momenta, &none);
        State {
            charges,
            kinetic,
            potential,
            momenta,
            parts,
        }
    }

    /// Returns the observations at instant k.
    fn row(&mut self, discrete: &DiscreteTrajectory, k: usize) -> Row {
        let model = self.model;
        self.here.z.copy_from_slice(&discrete.z[k]);
        model.action.map.place(&mut self.here);
        let sides = sides(model, discrete, k);
        let interval = k.checked_sub(1);
        let (state, before, work) = match (interval, discrete.reading) {
            (Some(interval), Reading::Intervals) => self.of_interval(discrete, interval),
            _ => {
                let work = interval.and_then(|interval| discrete.works.get(interval));
                let work = work.copied().unwrap_or_default();
                (self.state(discrete, k, &sides), [0.0; 6], work)
            }
        };

        let mut row = Vec::new();
        let muscles = model.spans.iter().zip(&model.system.muscles);
        row.extend(muscles.map(|(&span, m)| self.here.x[span].norm() / m.length()));
        row.extend(state.of_intervals());
        row.extend(works(model).map(|(kind, _)| match kind {
            TermKind::AppliedWork => work.applied,
            _ => work.dissipation,
        }));
        row.extend(state.momenta);
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
        row.extend(weighted(&sides, |scalars| {
            model.electrode_voltages(&self.here, scalars)
        }));
        row.extend(state.parts);
        let time = interval.map_or(0.0, |interval| {
            let next = discrete.times.get(k + 1).unwrap_or(&discrete.times[k]);
            0.5 * (next - discrete.times[interval])
        });
        let charging = self.parts.charging(model, &self.here, &sides, time);
        std::mem::swap(&mut self.before, &mut self.here);
        Row {
            values: row,
            before,
            charging,
        }
    }

    /// Values in the middle of an interval, at whose end the system is placed, with the momenta at this end; the momenta at its start, and the work
    /// over it.
    fn of_interval(
        &mut self,
        discrete: &DiscreteTrajectory,
        interval: usize,
    ) -> (State, Momenta, Work) {
        let (model, scalars) = (self.model, &discrete.scalars[interval]);
        let h = discrete.times[interval + 1] - discrete.times[interval];
        let energies = energies(model, &self.before, &self.here, scalars, h);
        let ends = self.before.x.iter().zip(&self.here.x);
        let middles: Vec<Vector> = ends.map(|(a, b)| (a + b) * 0.5).collect();
        let mut charges = immobile_charges(model, &middles, scalars);
        charges.extend(self.interval(scalars, h));
        let [before, momenta] = self.momenta_of_interval(h);
        let ends = [&self.before, &self.here];
        let state = State {
            charges,
            kinetic: energies.kinetic,
            potential: energies.potential,
            momenta,
            parts: self.parts.of_interval(model, ends, scalars, h),
        };
        (state, before, energies.work)
    }

    /// Kinetic energy ½ p·v at instant k, and the momenta of all vectors with its rates v.
    fn moves(&mut self, discrete: &DiscreteTrajectory, k: usize) -> (f64, Vec<Vector>) {
        let momentum = momentum(self.model, discrete, k, &self.here, &mut self.scratch);
        let (kinetic, here) = (&mut self.kinetic, &mut self.here);
        let rates = rates_at(self.model, kinetic, discrete, k, here, &momentum);
        let products = momentum.iter().zip(&rates).map(|(p, v)| p * v);
        let kinetic = 0.5 * products.sum::<f64>();
        (kinetic, moving(self.model, &mut self.here, &rates))
    }

    /// The momentum maps of p⁻ at the beginning of the interval that ends here, and of p⁺ at its end, from the forces of the interval.
    fn momenta_of_interval(&self, h: f64) -> [Momenta; 2] {
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
            &Sample::of_interval(scalars, h),
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

/// Charges of the electrodes that no voltage drives, with the vectors at places x.
fn immobile_charges(model: &Model, x: &[Vector], scalars: &[f64]) -> Vec<f64> {
    let blocks = model.solids.iter();
    blocks
        .flat_map(|block| block.immobile_charges(x, scalars))
        .collect()
}

/// Means of values under the scalars of sides by their weights.
fn weighted(sides: &[Side], mut of: impl FnMut(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut sums = Vec::new();
    for side in sides {
        let values = of(&side.scalars);
        sums.resize(values.len(), 0.0);
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += side.weight * value;
        }
    }
    sums
}

/// Instants that one thread observes in a row.
const PIECE: usize = 256;

/// Rows `0..count` in order, made by pieces of a length.
///
/// # Errors
/// One of the pieces was stopped.
fn in_pieces<T: Send>(
    count: usize,
    piece: usize,
    make: impl Fn(Range<usize>) -> Result<Vec<T>, Stopped> + Sync,
) -> Result<Vec<T>, Stopped> {
    let made = |i: usize| make(i * piece..count.min((i + 1) * piece));
    let pieces = 0..count.div_ceil(piece);
    let rows: Vec<Vec<T>> = match has_pool() {
        true => {
            let pieces = pieces.into_par_iter().with_max_len(1);
            pieces.map(made).collect::<Result<_, _>>()
        }
        false => pieces.map(made).collect(),
    }?;
    Ok(rows.into_iter().flatten().collect())
}

/// Linear and angular momentum by axis.
type Momenta = [f64; 6];

/// Values at one instant.
#[derive(Debug)]
struct State {
    charges: Vec<f64>,
    kinetic: f64,
    potential: Vec<f64>,
    momenta: Momenta,
    /// Values of the [parts](crate::dynamics::part_columns::PartColumns).
    parts: Vec<f64>,
}

impl State {
    /// Charges, kinetic, potential and total energy, in the order of their columns.
    fn of_intervals(&self) -> Vec<f64> {
        let total = self.kinetic + self.potential.iter().sum::<f64>();
        let values = self.charges.iter().copied().chain([self.kinetic]);
        let values = values.chain(self.potential.iter().copied());
        values.chain([total]).collect()
    }
}

/// Turns values in the middle of the intervals that end at the rows into values at the rows; `last` holds those of the last one.
fn to_instants(times: &[f64], columns: &mut [Column], last: &[f64]) {
    let end = times.len() - 1;
    let length = |k: usize| times[k] - times[k - 1];
    for (column, value) in columns.iter_mut().zip(last) {
        for k in 1..end {
            let (before, after) = (length(k), length(k + 1));
            let sum = column.values[k] * after + column.values[k + 1] * before;
            column.values[k] = sum / (before + after);
        }
        column.values[end] = *value;
    }
}

/// Turns momenta as the interval before each row sees them into means of both intervals next to it, each weighted by the length of
/// the other, so that a constant reaction cancels; `before` holds what the interval that ends at a row sees at the row before.
fn means(times: &[f64], columns: &mut [Column], before: &[Momenta], last: &State) {
    let end = times.len() - 1;
    for (i, column) in columns.iter_mut().enumerate() {
        for k in 1..end {
            let [earlier, later] = [times[k] - times[k - 1], times[k + 1] - times[k]];
            let sum = column.values[k] * later + before[k + 1][i] * earlier;
            column.values[k] = sum / (earlier + later);
        }
        column.values[end] = last.momenta[i];
    }
}

/// Names and units of the columns, in the order of the values of a row.
fn columns(model: &Model, parts: &PartColumns) -> Vec<Column> {
    let mut columns = Vec::new();
    let mut add = |name: String, unit: &'static str| {
        columns.push(Column {
            name,
            unit,
            values: Vec::new(),
        });
    };
    let system = &model.system;
    for muscle in &system.muscles {
        add(format!("{}_stretch", muscle.name), "");
    }
    let blocks = model.solids.iter();
    for (block, electrode) in blocks.flat_map(SolidBlock::immobile_electrodes) {
        add(format!("{block}_{electrode}_charge"), "mC");
    }
    for voltage in model.variables.with(Role::Voltage) {
        let name = voltage.name.replace('.', "_");
        add(format!("{name}_charge"), "mC");
    }
    add("kinetic_energy".to_owned(), "N mm");
    for term in &model.action.intervals.terms {
        if term.kind() == TermKind::Potential {
            for part in term.energy_parts() {
                add(format!("{}_energy", part.replace(' ', "_")), "N mm");
            }
        }
    }
    add("total_energy".to_owned(), "N mm");
    for (_, name) in works(model) {
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
    for name in model.viscous_stretches() {
        add(name, "");
    }
    for name in model.electrodes() {
        add(name, "V");
    }
    columns.extend(parts.columns(model));
    columns
}

/// Kinds of work that are done, each with the name of its sum.
fn works(model: &Model) -> impl Iterator<Item = (TermKind, &'static str)> {
    let terms = &model.action.intervals.terms;
    let has = |kind| terms.iter().any(|term| term.kind() == kind);
    let all = [
        (TermKind::Dissipation, "dissipated_energy"),
        (TermKind::AppliedWork, "following_load_work"),
    ];
    all.into_iter().filter(move |(kind, _)| has(*kind))
}
