//! A functional as a function of coordinates.

use crate::coordinates::configuration::Configuration;
use crate::coordinates::map::CoordinateMap;
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::{Destination, PullBack, Pulled, Site};
use crate::functional::{
    BlockMask, Blocks, Functional, Horizon, NodeBlocks, Order, Outer, Output, Sample,
    SumDerivatives,
};
use crate::math::{Matrix, Vector};
use std::sync::OnceLock;

/// Sums over intervals and instants as functions of the coordinates z of the instants and the scalars of the intervals.
#[derive(Debug)]
pub struct Reduced {
    /// Coordinates and the vectors that follow from them.
    pub map: CoordinateMap,
    /// Sum over intervals; its scalars are those of an interval.
    pub intervals: Functional,
    /// Sum over instants; its scalars are multipliers.
    pub instants: Functional,
    laid: OnceLock<Laid>,
}

impl Reduced {
    /// Of vectors that follow from coordinates.
    pub fn new(map: CoordinateMap, intervals: Functional, instants: Functional) -> Self {
        Self {
            map,
            intervals,
            instants,
            laid: OnceLock::new(),
        }
    }

    fn laid(&self) -> &Laid {
        let laid = || Laid::new(&self.map, &self.intervals, &self.instants);
        self.laid.get_or_init(laid)
    }

    /// Returns the pattern of the entries.
    pub fn layout(&self) -> &StepPattern {
        &self.laid().layout
    }

    /// Storage for evaluations up to a order; sweeps, which carry blocks on, need `Third`.
    pub fn scratch(&self, order: Order) -> Scratch {
        let interval = self.intervals.output(order);
        let carried = if order == Order::Third {
            Carried::new(&interval.plain.blocks)
        } else {
            Carried::new(&Blocks::default())
        };
        Scratch {
            carried: [carried.clone(), carried],
            interval,
            instant: self.instants.output(order),
            local: match order {
                Order::Gradient => Vec::new(),
                _ => {
                    let laid = self.laid();
                    vec![0.0; laid.intervals.local().max(laid.instants.local())]
                }
            },
        }
    }

    /// Evaluates the interval between two instants and adds its forces to theirs; at order `Third` along their
    /// directions, with contracted forces and functions of the measures of the site.
    pub fn evaluate_interval(
        &self,
        order: Order,
        [a, b]: [&mut Configuration; 2],
        interval: &Sample<'_>,
        scratch: &mut Scratch,
    ) {
        let sample = interval.between([&*a, &*b]);
        self.intervals
            .evaluate(order, &sample, &mut scratch.interval);
        let out = &scratch.interval;
        add(&mut a.forces, &out.plain.forces[0]);
        add(&mut b.forces, &out.plain.forces[1]);
        if order == Order::Third {
            add(&mut a.contracted, &out.contracted.forces[0]);
            add(&mut b.contracted, &out.contracted.forces[1]);
        }
    }

    /// The same up to second derivatives, which are added to a matrix of nodes.
    pub fn evaluate_at_nodes(
        &self,
        ends: [&mut Configuration; 2],
        interval: &Sample<'_>,
        scratch: &mut Scratch,
        nodes: &mut NodeBlocks,
    ) {
        scratch.interval.plain.nodes = Some(std::mem::take(nodes));
        self.evaluate_interval(Order::Hessian, ends, interval, scratch);
        *nodes = scratch.interval.plain.nodes.take().unwrap_or_default();
    }

    /// Evaluates what acts at rest between two instants, up to second derivatives, and adds its forces to theirs.
    pub fn evaluate_at_rest(
        &self,
        [a, b]: [&mut Configuration; 2],
        interval: &Sample<'_>,
        scratch: &mut Scratch,
        nodes: Option<&mut NodeBlocks>,
    ) {
        let sample = interval.between([&*a, &*b]);
        let out = &mut scratch.interval;
        match nodes {
            Some(nodes) => {
                out.plain.nodes = Some(std::mem::take(nodes));
                self.intervals.evaluate_at_rest(&sample, out);
                *nodes = out.plain.nodes.take().unwrap_or_default();
            }
            None => self.intervals.evaluate_at_rest(&sample, out),
        }
        add(&mut a.forces, &out.plain.forces[0]);
        add(&mut b.forces, &out.plain.forces[1]);
    }

    /// Adds the second derivatives of the interval evaluated last to the values of step k: ∇² at order `Hessian`, the
    /// lower triangle of ∇³ along the directions at order `Third`.
    pub fn pull_back_interval(
        &self,
        order: Order,
        ends: [&Configuration; 2],
        interval: &Sample<'_>,
        k: usize,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) {
        if order == Order::Gradient {
            return;
        }
        let laid = self.laid();
        let (plan, layout) = (&laid.intervals, &laid.layout);
        let target = &Destination {
            blocks: [
                layout.same_at(k),
                layout.upper_at(k),
                layout.lower_at(k),
                layout.same_at(k + 1),
            ],
            mixed: [layout.mixed_at(k, 0), layout.mixed_at(k, 1)],
            scalars: layout.scalars_at(k),
        };
        let Output { plain, contracted } = &scratch.interval;
        let local = &mut scratch.local;
        let to = &mut Pulled::new(ends, interval.sides, target, local, values);
        plan.add(order, &scratch.interval, to);
        if interval.horizon == Horizon::Given {
            return;
        }
        let part = match order {
            Order::Third => contracted,
            _ => plain,
        };
        for (side, instant) in ends.into_iter().enumerate() {
            let rows = &mut values[layout.horizon_at(k + side)..][..layout.unknowns];
            let forces = &part.horizon_forces[side];
            self.map.pull_back(&instant.columns, forces, rows);
            if order == Order::Third {
                let forces = &plain.horizon_forces[side];
                self.map.pull_back_along(&instant.columns_l, forces, rows);
            }
        }
        let rows = &mut values[layout.horizon_scalars_at(k)..];
        for (value, row) in rows.iter_mut().zip(&part.horizon_rows) {
            *value += row;
        }
    }

    /// Adds Pᵀ B P of the blocks of any part of the sum over intervals, between two instants, to the values at the places
    /// of a target.
    pub fn pull_back_part(
        &self,
        ends: [&Configuration; 2],
        part: &SumDerivatives,
        sides: BlockMask,
        target: &Destination,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) {
        let to = &mut Pulled::new(ends, sides, target, &mut scratch.local, values);
        self.laid().intervals.hessian(part, to);
    }

    /// Pulls back the blocks that the last interval of a sweep carried on to the final instant k.
    pub fn pull_back_last(
        &self,
        order: Order,
        last: &Configuration,
        k: usize,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) {
        if order == Order::Gradient {
            return;
        }
        scratch.interval.plain.clear(true);
        scratch.interval.contracted.clear(true);
        scratch.carry(order);
        let laid = self.laid();
        let target = &Destination {
            blocks: [laid.layout.same_at(k); 4],
            mixed: [usize::MAX; 2],
            scalars: laid.layout.scalars_at(k),
        };
        let local = &mut scratch.local;
        let to = &mut Pulled::new([last, last], BlockMask::HERE, target, local, values);
        laid.intervals.add(order, &scratch.interval, to);
    }

    /// Evaluates an instant and adds its forces.
    pub fn evaluate_instant(
        &self,
        order: Order,
        instant: &mut Configuration,
        outer: &[Outer],
        scratch: &mut Scratch,
    ) {
        let n = self.map.coordinates;
        let scalars = &instant.z[n..self.map.unknowns()];
        let sample = Sample {
            along: [&instant.w, &instant.w],
            scalars_along: &instant.l[n..],
            sides: BlockMask::HERE,
            outer,
            ..Sample::of_instant(&instant.x, scalars)
        };
        self.instants.evaluate(order, &sample, &mut scratch.instant);
        add(&mut instant.forces, &scratch.instant.plain.forces[0]);
        if order == Order::Third {
            add(
                &mut instant.contracted,
                &scratch.instant.contracted.forces[0],
            );
        }
    }

    /// Adds the second derivatives of the instant evaluated last, and the curvature of its coordinates under all forces
    /// on it, to the values of instant k; orders as for an interval.
    pub fn pull_back_instant(
        &self,
        order: Order,
        instant: &mut Configuration,
        k: usize,
        scratch: &mut Scratch,
        values: &mut [f64],
    ) {
        if order == Order::Gradient {
            return;
        }
        let laid = self.laid();
        let same = laid.layout.same_at(k);
        let target = &Destination {
            blocks: [same; 4],
            mixed: [same, usize::MAX],
            scalars: usize::MAX,
        };
        let (ends, local) = ([&*instant; 2], &mut scratch.local);
        let to = &mut Pulled::new(ends, BlockMask::HERE, target, local, values);
        laid.instants.add(order, &scratch.instant, to);
        let (tree, values) = (&self.map.tree, &mut values[same..]);
        match order {
            Order::Third => tree.curvature_along(instant, &laid.curvature, values),
            _ => tree.curvature(instant, &laid.curvature, values),
        }
    }

    /// Momentum Pᵀ ∂T/∂ẋ of each coordinate of a placed instant with rates `rates` of the coordinates.
    pub fn momentum(&self, instant: &mut Configuration, rates: &[f64]) -> Vec<f64> {
        let mut momenta = vec![Vector::zeros(); instant.x.len()];
        let mut rows = vec![0.0; self.map.coordinates];
        self.momentum_into(instant, rates, &mut momenta, &mut rows);
        rows
    }

    /// The same, written to rows; `momenta` is room for those of the vectors.
    pub fn momentum_into(
        &self,
        instant: &mut Configuration,
        rates: &[f64],
        momenta: &mut [Vector],
        rows: &mut [f64],
    ) {
        instant.l.fill(0.0);
        instant.l[..rates.len()].copy_from_slice(rates);
        self.map.along(instant);
        momenta.fill(Vector::zeros());
        for term in &self.intervals.terms {
            term.momentum(&instant.x, &instant.w, momenta);
        }
        rows.fill(0.0);
        self.map.pull_back(&instant.columns, momenta, rows);
    }

    /// Adds Pᵀ R to the first rows and the rows of the multipliers to the others.
    ///
    /// The instant has to be evaluated last.
    pub fn rows(&self, instant: &mut Configuration, scratch: &Scratch, rows: &mut [f64]) {
        self.map.rows(instant, rows);
        for (row, value) in rows[self.map.coordinates..]
            .iter_mut()
            .zip(&scratch.instant.plain.rows)
        {
            *row += value;
        }
    }
}

/// Adds one list of vectors to another.
fn add(sum: &mut [Vector], list: &[Vector]) {
    for (s, v) in sum.iter_mut().zip(list) {
        *s += v;
    }
}

/// Entries and the way to them, laid down where they are asked for.
#[derive(Debug)]
pub(super) struct Laid {
    pub(super) intervals: PullBack,
    pub(super) instants: PullBack,
    pub(super) curvature: Vec<[usize; 2]>,
    pub(super) layout: StepPattern,
}

impl Laid {
    pub(super) fn new(map: &CoordinateMap, intervals: &Functional, instants: &Functional) -> Self {
        let mut layout = StepPattern {
            unknowns: map.unknowns(),
            interval_scalars: intervals.scalars,
            ..StepPattern::default()
        };
        let mut plan =
            |sum: &Functional, site| PullBack::new(sum.couplings(), map, &mut layout, site);
        let intervals = plan(intervals, Site::Intervals);
        let instants = plan(instants, Site::Instants);
        let entries = map.tree.curvature_entries();
        let curvature = entries
            .map(|(i, k)| [layout.same.slot(i, k), layout.same.slot(k, i)])
            .collect();
        layout.shrink_to_fit();
        Self {
            intervals,
            instants,
            curvature,
            layout,
        }
    }
}

impl Sample<'_> {
    /// The same between two instants.
    pub fn between<'c>(&'c self, [a, b]: [&'c Configuration; 2]) -> Sample<'c> {
        Sample {
            vectors: [&a.x, &b.x],
            along: [&a.w, &b.w],
            ..*self
        }
    }
}

/// Storage that one evaluation needs, allocated once for each thread.
///
/// In a sweep over a horizon the blocks of an instant are summed over both neighbouring intervals before they are pulled
/// back: [`Scratch::carry`] after each interval, and [`Reduced::pull_back_last`](crate::coordinates::Reduced::pull_back_last) at the end.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Derivatives of the last interval.
    pub interval: Output,
    /// Derivatives of the last instant.
    pub instant: Output,
    pub(super) carried: [Carried; 2],
    pub(super) local: Vec<f64>,
}

/// Blocks (k+1, k+1) of the interval before.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    full: Vec<Matrix>,
    isotropic: Vec<f64>,
}

impl Carried {
    pub(super) fn new(blocks: &Blocks) -> Self {
        Self {
            full: vec![Matrix::zeros(); blocks.full.len()],
            isotropic: vec![0.0; blocks.isotropic.len()],
        }
    }

    /// Adds the carried blocks to those of the first instant, and takes those of the second.
    fn exchange(&mut self, blocks: &mut Blocks) {
        for (carried, block) in self.full.iter_mut().zip(&mut blocks.full) {
            block[0] += std::mem::replace(carried, block[3]);
        }
        for (carried, block) in self.isotropic.iter_mut().zip(&mut blocks.isotropic) {
            block[0] += std::mem::replace(carried, block[3]);
        }
    }
}

impl Scratch {
    /// Forgets carried blocks, before a sweep.
    pub fn start(&mut self) {
        for carried in &mut self.carried {
            carried.full.fill(Matrix::zeros());
            carried.isotropic.fill(0.0);
        }
    }

    /// Moves the blocks of the second instant of the interval evaluated last to the next interval.
    pub fn carry(&mut self, order: Order) {
        if order >= Order::Hessian {
            self.carried[0].exchange(&mut self.interval.plain.blocks);
        }
        if order == Order::Third {
            self.carried[1].exchange(&mut self.interval.contracted.blocks);
        }
    }
}
