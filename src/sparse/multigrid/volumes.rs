//! Volumes of the elements of boxes and meshes, in double precision: what they add to products with the matrix, and pressures in its vectors.
//!
//! With the derivatives b of a volume and the factor k of b bᵀ in the matrix, a pressure p stands for k b·u: rows of displacements have
//! b (p − k b·u) in addition, and p has the row b·u − p/k. Vectors hold the pressures behind the components of all nodes.

use crate::sparse::multigrid::level::{Level, Transfer};
use crate::sparse::multigrid::node_grid::{
    COMPONENTS, CORNERS, ElementVolume, NodeBlock, VolumePlaces,
};
use crate::sparse::multigrid::pressures::Elements;
use std::ops::Range;

/// The power of two, which rounds nothing, that makes a mean of squares one.
pub(super) fn scale_of_mean(mean: f64) -> f64 {
    match mean > 0.0 && mean.is_finite() {
        true => (-0.5 * mean.log2()).round().exp2(),
        false => 1.0,
    }
}

/// Volumes of the elements of all parts.
#[derive(Debug, Default)]
pub(super) struct Volumes {
    /// By part: of a box by first node, of factor zero where there is no element, of a mesh by element.
    pub(super) list: Vec<ElementVolume>,
    /// Places of the volumes of each part in the list; none of a part without pressures.
    ranges: Vec<Range<usize>>,
    places: Vec<VolumePlaces>,
    /// Factors of pressures by part.
    scales: Vec<f64>,
    /// Work space of one row.
    rest: Vec<NodeBlock>,
}

impl Volumes {
    /// Adds those of a part.
    pub(super) fn add(&mut self, count: usize, places: VolumePlaces) {
        let first = self.list.len();
        self.list.resize(first + count, ElementVolume::default());
        self.ranges.push(first..first + count);
        self.places.push(places);
        self.scales.push(1.0);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Places of a part in the list.
    pub(super) fn range(&self, part: usize) -> Range<usize> {
        self.ranges[part].clone()
    }

    /// Those of a part.
    fn of(&self, part: usize) -> &[ElementVolume] {
        &self.list[self.range(part)]
    }

    /// Place in the list of the volume of an element, with the nodes of the part at its corners that move; `None` where it has none.
    pub(super) fn find(&self, part: usize, moving: &[Option<u32>; CORNERS]) -> Option<usize> {
        let range = self.range(part);
        let is_free = |element: &usize| self.list[range.start + element].factor == 0.0;
        let element = self.places[part].find(moving, is_free)?;
        (element < range.len()).then(|| range.start + element)
    }

    /// Sum of the parts that volumes have in the diagonal.
    pub(super) fn resistance(&self, part: usize) -> f64 {
        let each = self.of(part).iter();
        each.map(|volume| volume.factor.abs() * volume.square())
            .sum()
    }

    /// Finds the scale that makes the answer of displacements to a pressure about one, where their own scale makes their diagonal one.
    pub(super) fn find_scale(&mut self, part: usize, displacement: f64) {
        let squares = self.of(part).iter().map(ElementVolume::square);
        let (sum, count) = squares
            .filter(|square| *square > 0.0)
            .fold((0.0, 0.0), |(sum, count), square| {
                (sum + square, count + 1.0)
            });
        self.scales[part] = scale_of_mean(sum / count * displacement * displacement);
    }

    /// Multiplies rows and columns by their factors.
    pub(super) fn scale(&mut self, part: usize, scales: &[f64; COMPONENTS]) {
        let (pressure, range) = (self.scales[part], self.range(part));
        for volume in &mut self.list[range] {
            volume.factor /= pressure * pressure;
            for slopes in &mut volume.slopes {
                for (slope, scale) in slopes.iter_mut().zip(scales) {
                    *slope *= scale * pressure;
                }
            }
        }
    }

    /// Those of a part as they were before they were scaled.
    pub(super) fn without_scale(
        &self,
        part: usize,
        scales: &[f64; COMPONENTS],
    ) -> impl Iterator<Item = ElementVolume> + use<'_> {
        let scales = *scales;
        let pressure = self.scales[part];
        self.of(part).iter().map(move |volume| ElementVolume {
            slopes: volume
                .slopes
                .map(|slopes| std::array::from_fn(|c| slopes[c] / (scales[c] * pressure))),
            factor: volume.factor * pressure * pressure,
        })
    }

    /// Product of the derivatives of the volume at a place, without their scale, and displacements to which this pressure belongs.
    pub(super) fn change(&self, place: usize, pressure: f64) -> f64 {
        let part = self.ranges.iter().position(|range| range.contains(&place));
        match part.filter(|_| self.list[place].factor != 0.0) {
            Some(part) => pressure / (self.list[place].factor * self.scales[part]),
            None => 0.0,
        }
    }

    /// Hands volumes over to the finest level, whose matrix is that of the rest.
    pub(super) fn take_out<T: Transfer>(
        &mut self,
        part: usize,
        blocks: &[NodeBlock],
        level: &mut Level<T>,
    ) {
        let Some(pressures) = &mut level.pressures else {
            return;
        };
        let mut rest = std::mem::take(&mut self.rest);
        let (volumes, places) = (self.of(part), &self.places[part]);
        for (element, volume) in volumes.iter().enumerate() {
            let (slopes, compliance) = volume.in_single_precision();
            pressures.take(element, &places.corners(element), &slopes, compliance);
        }
        let (rows, mut number) = (level.matrix.rows.clone(), 0);
        level.matrix.each_mut(|node, _, block| {
            let range = rows.range(node);
            if number == range.start {
                rest.clear();
                rest.extend_from_slice(&blocks[range.clone()]);
                for [element, _] in pressures.elements.of_node(node) {
                    if let Some(volume) = volumes.get(element) {
                        let corners = places.corners(element);
                        let place = |column| rows.find(node, column).map(|at| at - range.start);
                        volume.take_from(node, &corners, &mut rest, place);
                    }
                }
            }
            *block = rest[number - range.start].map(|entry| entry as f32);
            number += 1;
        });
        self.rest = rest;
    }

    /// Adds to a product what pressures do, and writes their rows; `node` is the first one of the part.
    pub(super) fn apply(&self, part: usize, node: usize, x: &[f32], product: &mut [f64]) {
        let behind = product.len() - self.list.len();
        for (element, place) in self.range(part).enumerate() {
            let (volume, at) = (&self.list[place], behind + place);
            if volume.factor == 0.0 {
                product[at] = 0.0;
                continue;
            }
            let corners = self.places[part].corners(element).map(|c| node + c);
            let along = volume.along(&corners, x);
            let p = f64::from(x[at]);
            product[at] = along - p / volume.factor;
            volume.add_force(p - volume.factor * along, &corners, product);
        }
    }

    /// Adds to a residual of displacements what follows for them where pressures are eliminated.
    pub(super) fn condense(&self, part: usize, node: usize, residual: &mut [f64]) {
        let behind = residual.len() - self.list.len();
        for (element, place) in self.range(part).enumerate() {
            let volume = &self.list[place];
            if volume.factor != 0.0 {
                let corners = self.places[part].corners(element).map(|c| node + c);
                let p = volume.factor * std::mem::take(&mut residual[behind + place]);
                volume.add_force(p, &corners, residual);
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

    /// Its derivatives, and the inverse of its factor, which is zero where there is no volume.
    fn in_single_precision(&self) -> ([[f32; COMPONENTS]; CORNERS], f32) {
        let compliance = match self.factor == 0.0 {
            true => 0.0,
            false => self.factor.recip() as f32,
        };
        let slopes = self.slopes;
        let slopes = slopes.map(|slopes| slopes.map(|slope| slope as f32));
        (slopes, compliance)
    }

    /// Adds the forces of a pressure at the corners.
    #[inline(always)]
    fn add_force(&self, p: f64, corners: &[usize; CORNERS], to: &mut [f64]) {
        for (slopes, corner) in self.slopes.iter().zip(corners) {
            let there = &mut to[COMPONENTS * corner..][..COMPONENTS];
            for (sum, slope) in there.iter_mut().zip(slopes) {
                *sum += slope * p;
            }
        }
    }

    /// Leaves its part out of the row of a node at one of its corners, whose blocks are found by `place`.
    fn take_from(
        &self,
        node: usize,
        corners: &[usize; CORNERS],
        row: &mut [NodeBlock],
        place: impl Fn(usize) -> Option<usize>,
    ) {
        if self.factor == 0.0 {
            return;
        }
        let of_node = corners.iter().position(|corner| *corner == node);
        let own = &self.slopes[of_node.expect("a corner of the element")];
        for (column, there) in corners.iter().zip(&self.slopes) {
            let place = place(*column).expect("nodes of an element are coupled");
            for (entry, value) in row[place].iter_mut().enumerate() {
                *value -= self.factor * own[entry % COMPONENTS] * there[entry / COMPONENTS];
            }
        }
    }
}
