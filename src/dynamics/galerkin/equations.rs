//! The equations of a step of every rule.
//!
//! Derivatives of the equations of a step with several points, point by point and sample by sample.

use crate::coordinates::{Configuration, Destination};
use crate::dynamics::energies::{Work, energies};
use crate::dynamics::galerkin::lobatto::lagrange;
use crate::dynamics::galerkin::rule::Rule;
use crate::dynamics::galerkin::state::{GalerkinEquations, StagePoint, between};
use crate::dynamics::momenta::vector_momenta;
use crate::dynamics::resolution::Balance;
use crate::dynamics::solving::Drive;
use crate::dynamics::stepper::{Equations, Now};
use crate::functional::{BlockMask, NodeBlocks, Order};
use crate::math::{Matrix, Vector};
use crate::model::Model;
use std::slice;

impl Equations for GalerkinEquations<'_> {
    fn begin(&mut self, step: [f64; 2], drive: &dyn Drive) {
        let inputs = self.model.variables.inputs();
        for sample in &mut self.samples {
            let voltages = drive.at(step, sample.weights.part);
            sample.scalars[inputs.clone()].copy_from_slice(&voltages);
        }
        if self.dissipates && !matches!(self.rule, Rule::Galerkin(_)) {
            self.middle[inputs].copy_from_slice(&drive.at(step, 0.5));
        }
    }

    /// The polynomial through the last points, carried on.
    fn guess(&mut self, h: f64) {
        let times: Vec<f64> = self.trail.iter().map(|(time, _)| *time).collect();
        let points = self.rule.points();
        let m = self.model.action.map.unknowns();
        let (start, others) = self.points.split_at_mut(1);
        for (point, at) in others.iter_mut().zip(points.into_iter().skip(1)) {
            point.z[..m].fill(0.0);
            point.z[m..].copy_from_slice(&start[0].z[m..]);
            let weights = lagrange(&times, self.time + at * h);
            for ((_, u), weight) in self.trail.iter().zip(weights) {
                for (z, u) in point.z.iter_mut().zip(u) {
                    *z += u * weight;
                }
            }
            self.model.prescribe(self.time + at * h, &mut point.z);
        }
        let algebraic = self.model.variables.algebraic();
        self.saved.0.clone_from(&self.multipliers);
        for (saved, sample) in self.saved.1.iter_mut().zip(&self.samples) {
            saved.copy_from_slice(&sample.scalars[algebraic.clone()]);
        }
    }

    fn evaluate(&mut self, order: Order, h: f64, residual: &mut [f64], _: Option<&mut NodeBlocks>) {
        self.sample(order, h);
        let model = self.model;
        let action = &model.action;
        let map = &action.map;
        let (n, m) = (map.coordinates, map.unknowns());
        residual.fill(0.0);
        if order >= Order::Hessian {
            self.values.fill(0.0);
        }
        let last = self.points.len() - 1;
        for point in 0..=last {
            self.forces(point);
        }
        self.add_carried(h);
        for (i, multipliers) in self.multipliers.iter().enumerate() {
            let at = self.rule.row(i + 1);
            self.points[at].z[n..m].copy_from_slice(multipliers);
        }
        for at in 0..=last {
            let instant = &mut self.points[at];
            let values = &mut self.values[self.places.same(at)..];
            action.evaluate_instant(order, instant, &[], &mut self.scratch);
            action.pull_back_instant(order, instant, 0, &mut self.scratch, values);
            if at > 0 {
                let rows = &mut residual[(at - 1) * m + n..at * m];
                rows.copy_from_slice(&self.scratch.instant.plain.rows);
            }
        }
        for point in 1..=last {
            let at = self.rule.row(point);
            let rows = &mut residual[(point - 1) * m..(point - 1) * m + n];
            if at == 0 {
                rows.copy_from_slice(&self.momentum);
            }
            let instant = &self.points[at];
            map.pull_back(&instant.columns, &instant.forces, rows);
        }
        let algebraic = model.variables.algebraic();
        let of_samples = residual[last * m..].chunks_mut(algebraic.len().max(1));
        for (rows, sample) in of_samples.zip(&self.samples) {
            rows.copy_from_slice(&sample.out.plain.rows[algebraic.clone()]);
        }
        if order >= Order::Hessian {
            self.tangent_of_points(h);
            if !algebraic.is_empty() {
                self.tangent_of_scalars();
            }
        }
    }

    fn values(&self) -> &[f64] {
        &self.values
    }

    fn update(&mut self, update: &[f64]) {
        let map = &self.model.action.map;
        let (n, m) = (map.coordinates, map.unknowns());
        let points = self.points[1..].iter_mut().zip(&mut self.multipliers);
        for ((point, multipliers), update) in points.zip(update.chunks(m.max(1))) {
            for (z, update) in point.z[..n].iter_mut().zip(update) {
                *z -= update;
            }
            for (multiplier, update) in multipliers.iter_mut().zip(&update[n..]) {
                *multiplier -= update;
            }
        }
        let algebraic = self.model.variables.algebraic();
        let updates = update[(self.points.len() - 1) * m..].chunks(algebraic.len().max(1));
        for (sample, update) in self.samples.iter_mut().zip(updates) {
            let scalars = &mut sample.scalars[algebraic.clone()];
            for (scalar, update) in scalars.iter_mut().zip(update) {
                *scalar -= update;
            }
        }
    }

    fn restore(&mut self) {
        self.multipliers.clone_from(&self.saved.0);
        let algebraic = self.model.variables.algebraic();
        for (saved, sample) in self.saved.1.iter().zip(&mut self.samples) {
            sample.scalars[algebraic.clone()].copy_from_slice(saved);
        }
    }

    fn model(&self) -> &Model {
        self.model
    }

    fn place_end(&mut self) {
        if let Some(end) = self.points.last_mut() {
            self.model.action.map.place(end);
        }
    }

    fn ends(&self) -> [&Configuration; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]]
    }

    fn balance(&mut self, h: f64) -> Option<Balance> {
        if !matches!(self.rule, Rule::Galerkin(_)) {
            return None;
        }
        self.sample(Order::Gradient, h);
        let supplied = self.supplied(h);
        let last = self.points.len() - 1;
        let ends = [0, last].map(|i| {
            between(
                [&self.points[i].x; 2].map(|x| x.as_slice()),
                &self.samples[i].scalars,
                h,
            )
        });
        let parts = self.samples.iter().map(|point| {
            let [a, b] = &point.x;
            (
                point.weights.quadrature,
                between([a, b], &point.scalars, h),
                &point.out.plain.forces,
            )
        });
        let balance = Balance::new(self.model, self.typical_energy, supplied, ends, parts);
        self.work = self.dissipates.then(|| balance.work());
        Some(balance)
    }

    fn visit_state(&mut self, visit: &mut dyn FnMut(&'static str, &mut [f64])) {
        visit("time", slice::from_mut(&mut self.time));
        visit("z", &mut self.points[0].z);
        visit("momentum", &mut self.momentum);
        let mut count = [self.trail.len() as f64];
        visit("points", &mut count);
        self.resize_trail(count[0]);
        for (time, u) in &mut self.trail {
            visit("point time", slice::from_mut(time));
            visit("point", u);
        }
        for multipliers in &mut self.multipliers {
            visit("multipliers", multipliers);
        }
        for sample in &mut self.samples {
            visit("scalars", &mut sample.scalars);
        }
        for carried in self.rule.carried() {
            for vector in carried {
                visit("carried", vector.as_mut_slice());
            }
        }
    }

    fn take_state(&mut self) {
        self.model.action.map.place(&mut self.points[0]);
    }

    fn accept(&mut self, h: f64) -> bool {
        // The balance of energy of a Galerkin method has read them.
        let has_balance = matches!(self.rule, Rule::Galerkin(_));
        if !has_balance {
            self.sample(Order::Gradient, h);
        }
        let model = self.model;
        let last = self.points.len() - 1;
        let forces = self
            .samples
            .iter()
            .flat_map(|s| &s.out.plain.forces)
            .flatten();
        if !forces.into_iter().all(|f| f.iter().all(|c| c.is_finite())) {
            return false;
        }
        if self.dissipates && !has_balance {
            let [start, end] = self.ends();
            self.work = Some(energies(self.model, start, end, &self.middle, h).work);
        }
        let momenta: Vec<Vector> = match &mut self.rule {
            Rule::Galerkin(_) => {
                self.forces(last);
                self.points[last].forces.clone()
            }
            Rule::Euler(momenta) => {
                let [a, b] = &self.samples[0].out.plain.forces;
                for (momentum, (a, b)) in momenta.iter_mut().zip(a.iter().zip(b)) {
                    *momentum = (b - a) * 0.5;
                }
                momenta.clone()
            }
            Rule::Alpha(alpha) => {
                let [start, end] = [&self.points[0].x, &self.points[1].x];
                alpha.accept(h, start, end);
                vector_momenta(model, end, alpha.rates())
            }
        };
        let map = &model.action.map;
        self.remember(h);
        if map.recentre(&mut self.points[last]) {
            self.follow_charts();
        }
        self.momentum.fill(0.0);
        map.pull_back(&self.points[last].columns, &momenta, &mut self.momentum);
        for &coordinate in &self.massless.coordinates {
            self.momentum[coordinate] = 0.0;
        }
        if let Rule::Galerkin(_) = self.rule {
            let (n, m) = (map.coordinates, map.unknowns());
            let multipliers = &self.multipliers[last - 1];
            self.points[last].z[n..m].copy_from_slice(multipliers);
        }
        self.points.swap(0, last);
        self.time += h;
        true
    }

    fn unknown_name(&self, unknown: usize) -> String {
        let points = self.points.len() - 1;
        let variables = &self.model.variables;
        variables.unknown_of(points, unknown).to_string()
    }

    fn now(&self) -> Now<'_> {
        Now {
            time: self.time,
            z: &self.points[0].z,
            momentum: &self.momentum,
            scalars: &self.samples[self.samples.len() - 1].scalars,
            multipliers: match self.rule {
                Rule::Galerkin(_) => &self.multipliers[0],
                Rule::Euler(_) | Rule::Alpha(_) => &[],
            },
        }
    }

    fn work(&self) -> Option<Work> {
        self.work
    }
}

impl GalerkinEquations<'_> {
    /// Sums the blocks of all samples between the rows of one point and the vectors of another into one of the four blocks.
    fn combine(&mut self, row: usize, point: usize, block: usize, h: f64) {
        let combined = &mut self.combined.blocks;
        combined.full.fill([Matrix::zeros(); 4]);
        combined.isotropic.fill([0.0; 4]);
        for StagePoint { weights, out, .. } in &self.samples {
            let blocks = &out.plain.blocks;
            for side in 0..4 {
                let weight = weights.quadrature
                    * weights.give[side / 2][row]
                    * weights.take[side % 2][point];
                if weight == 0.0 {
                    continue;
                }
                for (sum, term) in combined.full.iter_mut().zip(&blocks.full) {
                    sum[block] += term[side] * weight;
                }
                for (sum, term) in combined.isotropic.iter_mut().zip(&blocks.isotropic) {
                    sum[block] += term[side] * weight;
                }
            }
            self.massless
                .add_blocks(weights, [row, point], blocks, combined, block);
        }
        if let Rule::Alpha(alpha) = &self.rule {
            let factor = alpha.inertia() / h;
            for (sum, mass) in combined.isotropic.iter_mut().zip(&self.masses.isotropic) {
                sum[block] -= mass[3] * factor;
            }
        }
    }

    /// Writes the derivatives of the rows at the points by the coordinates of the points.
    pub(super) fn tangent_of_points(&mut self, h: f64) {
        for row in 1..self.points.len() {
            for point in 1..self.points.len() {
                let at = self.rule.row(row);
                let (block, sides) = match at == point {
                    true => (0, BlockMask::HERE),
                    false => (1, BlockMask::FORWARD),
                };
                self.combine(at, point, block, h);
                let target = Destination {
                    blocks: [self.places.pair(row, point); 4],
                    mixed: [usize::MAX; 2],
                    scalars: usize::MAX,
                };
                let ends = [&self.points[at], &self.points[point]];
                self.model.action.pull_back_part(
                    ends,
                    &self.combined,
                    sides,
                    &target,
                    &mut self.scratch,
                    &mut self.values,
                );
            }
        }
    }

    /// Writes the derivatives by the scalars of the samples, and those of their equations.
    pub(super) fn tangent_of_scalars(&mut self) {
        let none = BlockMask {
            blocks: [false; 4],
            ..BlockMask::ALL
        };
        for (i, sample) in self.samples.iter().enumerate() {
            let weights = &sample.weights;
            let mixed = &sample.out.plain.blocks.mixed;
            for point in 1..self.points.len() {
                let at = self.rule.row(point);
                let combined = &mut self.combined.blocks.mixed;
                for (sum, [a, b]) in combined.iter_mut().zip(mixed) {
                    let of = |weights: &[Vec<f64>; 2], point: usize| {
                        a * weights[0][point] + b * weights[1][point]
                    };
                    sum[0] = of(&weights.give, at) * weights.quadrature;
                    sum[1] = of(&weights.take, point);
                }
                let target = Destination {
                    blocks: [usize::MAX; 4],
                    mixed: self.places.mixed(i, point),
                    scalars: usize::MAX,
                };
                let ends = [&self.points[at], &self.points[point]];
                self.model.action.pull_back_part(
                    ends,
                    &self.combined,
                    none,
                    &target,
                    &mut self.scratch,
                    &mut self.values,
                );
            }
            let target = Destination {
                blocks: [usize::MAX; 4],
                mixed: [usize::MAX; 2],
                scalars: self.places.scalars(i),
            };
            let here = &self.points[0];
            self.model.action.pull_back_part(
                [here, here],
                &sample.out.plain,
                none,
                &target,
                &mut self.scratch,
                &mut self.values,
            );
        }
    }
}
