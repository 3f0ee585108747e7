//! Volumes of the elements of boxes, in double precision: what they add to products with the matrix, and pressures in its vectors.
//!
//! With the derivatives b of a volume and the factor k of b bᵀ in the matrix, a pressure p stands for k b·u: rows of displacements have
//! b (p − k b·u) in addition, and p has the row b·u − p/k. Vectors hold the pressures of all nodes behind their components.

use crate::sparse::multigrid::element_volume::{CORNERS, ElementVolume, corners, neighbour_of};
use crate::sparse::multigrid::field::Field;
use crate::sparse::multigrid::level::Level;
use crate::sparse::multigrid::node_grid::{COMPONENTS, ENTRIES, NEIGHBOURS, NodeBlock};
use std::ops::Range;

/// The power of two, which rounds nothing, that makes a mean of squares one.
pub(super) fn scale_of_mean(mean: f64) -> f64 {
    match mean > 0.0 && mean.is_finite() {
        true => (-0.5 * mean.log2()).round().exp2(),
        false => 1.0,
    }
}

/// Volumes of the elements of all boxes.
#[derive(Debug, Default)]
pub(super) struct Volumes {
    /// By first node; of factor zero where there is no element, or none with a pressure.
    pub(super) list: Vec<ElementVolume>,
    /// Factors of pressures by box.
    scales: Vec<f64>,
}

impl Volumes {
    /// Of so many nodes in boxes.
    pub(super) fn new(nodes: usize, boxes: usize) -> Self {
        Self {
            list: vec![ElementVolume::default(); nodes],
            scales: vec![1.0; boxes],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Those of a box.
    fn of(&self, nodes: Range<usize>) -> &[ElementVolume] {
        self.list.get(nodes).unwrap_or_default()
    }

    /// Sum of the parts that volumes have in the diagonal.
    pub(super) fn resistance(&self, nodes: Range<usize>) -> f64 {
        let each = self.of(nodes).iter();
        each.map(|volume| volume.factor.abs() * volume.square())
            .sum()
    }

    /// Finds the scale that makes the answer of displacements to a pressure about one, where their own scale makes their diagonal one.
    pub(super) fn find_scale(&mut self, part: usize, nodes: Range<usize>, displacement: f64) {
        let squares = self.of(nodes).iter().map(ElementVolume::square);
        let (sum, count) = squares
            .filter(|square| *square > 0.0)
            .fold((0.0, 0.0), |(sum, count), square| {
                (sum + square, count + 1.0)
            });
        if let Some(scale) = self.scales.get_mut(part) {
            *scale = scale_of_mean(sum / count * displacement * displacement);
        }
    }

    /// Multiplies rows and columns by their factors.
    pub(super) fn scale(&mut self, part: usize, nodes: Range<usize>, scales: &[f64; COMPONENTS]) {
        let Some(pressure) = self.scales.get(part) else {
            return;
        };
        for volume in &mut self.list[nodes] {
            volume.factor /= pressure * pressure;
            for slopes in &mut volume.slopes {
                for (slope, scale) in slopes.iter_mut().zip(scales) {
                    *slope *= scale * pressure;
                }
            }
        }
    }

    /// Those of a box as they were before they were scaled.
    pub(super) fn without_scale(
        &self,
        part: usize,
        nodes: Range<usize>,
        scales: &[f64; COMPONENTS],
    ) -> impl Iterator<Item = ElementVolume> + use<'_> {
        let scales = *scales;
        let pressure = self.scales.get(part).copied().unwrap_or(1.0);
        self.of(nodes).iter().map(move |volume| ElementVolume {
            slopes: volume
                .slopes
                .map(|slopes| std::array::from_fn(|c| slopes[c] / (scales[c] * pressure))),
            factor: volume.factor * pressure * pressure,
        })
    }

    /// Product of the derivatives of a volume, without their scale, and displacements to which this pressure belongs.
    pub(super) fn change(&self, part: usize, element: usize, pressure: f64) -> f64 {
        match self.list[element].factor == 0.0 {
            true => 0.0,
            false => pressure / (self.list[element].factor * self.scales[part]),
        }
    }

    /// Hands volumes over to the finest grid, whose matrix is that of the rest.
    pub(super) fn take_out(&self, nodes: Range<usize>, blocks: &[NodeBlock], level: &mut Level) {
        let volumes = self.of(nodes);
        let Some(pressures) = &mut level.pressures else {
            return;
        };
        let corners = corners(level.counts);
        let lists = pressures.slopes.iter_mut().zip(&mut pressures.compliance);
        for ((slopes, compliance), volume) in lists.zip(volumes) {
            *slopes = volume.slopes.map(|slopes| slopes.map(|slope| slope as f32));
            *compliance = match volume.factor == 0.0 {
                true => 0.0,
                false => volume.factor.recip() as f32,
            };
        }
        for (node, blocks) in blocks.chunks_exact(NEIGHBOURS).enumerate() {
            let mut rest = [[0.0; ENTRIES]; NEIGHBOURS];
            rest.copy_from_slice(blocks);
            for (corner, to_corner) in corners.iter().enumerate() {
                let element = node.checked_sub(*to_corner);
                if let Some(volume) = element.and_then(|element| volumes.get(element)) {
                    volume.take_from(corner, &mut rest);
                }
            }
            let finest = &mut level.matrix[NEIGHBOURS * node..][..NEIGHBOURS];
            for (to, from) in finest.iter_mut().zip(&rest) {
                *to = from.map(|entry| entry as f32);
            }
        }
    }

    /// Adds to a product what pressures do, and writes their rows; the field has the displacements of the box.
    pub(super) fn apply(
        &self,
        (nodes, counts): (Range<usize>, [usize; 3]),
        field: &Field,
        x: &[f32],
        product: &mut [f64],
    ) {
        let corners = corners(counts);
        let behind = COMPONENTS * self.list.len();
        for (element, volume) in self.of(nodes.clone()).iter().enumerate() {
            let at = nodes.start + element;
            if volume.factor == 0.0 {
                product[behind + at] = 0.0;
                continue;
            }
            let along = volume.along(&corners, (field.margin + element, field));
            let p = f64::from(x[behind + at]);
            product[behind + at] = along - p / volume.factor;
            volume.add_force(p - volume.factor * along, at, &corners, product);
        }
    }

    /// Adds to a residual of displacements what follows for them where pressures are eliminated.
    pub(super) fn condense(
        &self,
        (nodes, counts): (Range<usize>, [usize; 3]),
        residual: &mut [f64],
    ) {
        let corners = corners(counts);
        let behind = COMPONENTS * self.list.len();
        for (element, volume) in self.of(nodes.clone()).iter().enumerate() {
            let at = nodes.start + element;
            if volume.factor != 0.0 {
                let p = volume.factor * std::mem::take(&mut residual[behind + at]);
                volume.add_force(p, at, &corners, residual);
            }
        }
    }
}

impl ElementVolume {
    /// Sum of the squares of its derivatives.
    fn square(&self) -> f64 {
        self.slopes
            .as_flattened()
            .iter()
            .map(|slope| slope * slope)
            .sum()
    }

    /// Adds the forces of a pressure at the corners; its first one is at a place.
    #[inline(always)]
    fn add_force(&self, p: f64, at: usize, corners: &[usize; CORNERS], to: &mut [f64]) {
        for (slopes, corner) in self.slopes.iter().zip(corners) {
            let there = &mut to[COMPONENTS * (at + corner)..][..COMPONENTS];
            for (sum, slope) in there.iter_mut().zip(slopes) {
                *sum += slope * p;
            }
        }
    }

    /// Leaves its part out of the row of a corner.
    fn take_from(&self, corner: usize, row: &mut [[f64; ENTRIES]; NEIGHBOURS]) {
        if self.factor == 0.0 {
            return;
        }
        let own = &self.slopes[corner];
        for (other, there) in self.slopes.iter().enumerate() {
            let block = &mut row[neighbour_of(corner, other)];
            for (entry, value) in block.iter_mut().enumerate() {
                *value -= self.factor * own[entry % COMPONENTS] * there[entry / COMPONENTS];
            }
        }
    }
}
