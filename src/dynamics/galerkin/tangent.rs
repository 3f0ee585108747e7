//! Derivatives of the equations of a step with several points, point by point and sample by sample.

use crate::coordinates::Destination;
use crate::dynamics::galerkin::rule::Rule;
use crate::dynamics::galerkin::state::{GalerkinEquations, StagePoint};
use crate::functional::BlockMask;
use crate::math::Matrix;

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
            let to = (&mut *combined, block);
            self.massless.add_blocks((weights, row, point), blocks, to);
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
