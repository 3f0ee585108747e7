//! The true electric field at a point of a finite element as a measure of the intervals.

use crate::element::{FieldPoint, SpatialField};
use crate::functional::{Couplings, Measure, Part, Sample, ScalarArg, Stencil};
use crate::math::Vector;

/// |e|²/E² at a point of an element, with the nodes at one time of an interval and the potentials of the interval.
#[derive(Debug)]
pub struct ElementField {
    point: FieldPoint,
    nodes: [usize; 8],
    terminals: [ScalarArg; 8],
    at: Stencil,
}

impl ElementField {
    /// A point of an element with these nodes, whose potentials come from these terminals.
    pub fn new(
        point: FieldPoint,
        nodes: [usize; 8],
        terminals: [ScalarArg; 8],
        at: Stencil,
    ) -> Self {
        Self {
            point,
            nodes,
            terminals,
            at,
        }
    }

    fn field(&self, frame: &Sample<'_>) -> SpatialField {
        let [a, b] = self.at.weights(frame.h);
        let [here, next] = frame.vectors;
        let x = self.nodes.map(|v| match self.at {
            Stencil::Here => here[v],
            Stencil::Next => next[v],
            _ => here[v] * a + next[v] * b,
        });
        let potentials = self.terminals.map(|ScalarArg { constant, scalar }| {
            constant + scalar.map_or(0.0, |(s, factor)| factor * frame.scalars[s])
        });
        self.point.at(&x, &potentials)
    }

    /// Nodes whose potential is an unknown or a voltage: node, scalar, factor.
    fn wired(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let wires = self.terminals.iter().enumerate();
        wires.filter_map(|(i, wire)| wire.scalar.map(|(s, factor)| (i, s, factor)))
    }

    fn add_first(
        &self,
        field: &SpatialField,
        c: f64,
        h: f64,
        forces: &mut [Vec<Vector>; 2],
        rows: &mut [f64],
    ) {
        let weights = self.at.weights(h);
        for (i, &v) in self.nodes.iter().enumerate() {
            let force = field.by_place(i) * c;
            for side in (0..2).filter(|&side| self.at.reads(side)) {
                forces[side][v] += force * weights[side];
            }
        }
        for (i, s, factor) in self.wired() {
            rows[s] += c * factor * field.by_potential(i);
        }
    }
}

impl Measure for ElementField {
    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        let nodes = self.nodes;
        for &a in &nodes {
            slots.extend(nodes.map(|b| couplings.add_full(a, b) as u32));
        }
        for (_, s, _) in self.wired() {
            slots.extend(nodes.map(|node| couplings.add_mixed(node, s) as u32));
            for (_, t, _) in self.wired().filter(|&(_, t, _)| t <= s) {
                slots.push(couplings.add_scalars(s, t) as u32);
            }
        }
    }

    fn vectors(&self) -> Vec<usize> {
        self.nodes.to_vec()
    }

    fn scalars(&self) -> Vec<usize> {
        let mut scalars: Vec<usize> = self.wired().map(|(_, s, _)| s).collect();
        scalars.sort_unstable();
        scalars.dedup();
        scalars
    }

    fn reads(&self, side: usize) -> bool {
        self.at.reads(side)
    }

    fn value(&self, frame: &Sample<'_>) -> f64 {
        self.field(frame).value()
    }

    fn gradient(&self, frame: &Sample<'_>, forces: &mut [Vec<Vector>; 2], rows: &mut [f64]) {
        self.add_first(&self.field(frame), 1.0, frame.h, forces, rows);
    }

    fn add_weighted(&self, weight: f64, frame: &Sample<'_>, slots: &[u32], part: &mut Part) {
        let mut slots = slots.iter().map(|&slot| slot as usize);
        let mut next = || slots.next().expect("a slot for each coupling");
        let field = self.field(frame);
        self.add_first(&field, weight, frame.h, &mut part.forces, &mut part.rows);
        let weights = self.at.weights(frame.h);
        for i in 0..8 {
            for j in 0..8 {
                let block = field.by_places(i, j) * weight;
                let to = &mut part.blocks.full[next()];
                for side in (0..4).filter(|&side| frame.sides.blocks[side]) {
                    let share = weights[side / 2] * weights[side % 2];
                    if share != 0.0 {
                        to[side] += block * share;
                    }
                }
            }
        }
        for (j, s, factor) in self.wired() {
            for i in 0..8 {
                let column = field.by_place_and_potential(i, j) * (weight * factor);
                let to = &mut part.blocks.mixed[next()];
                to[0] += column * weights[0];
                to[1] += column * weights[1];
            }
            // Pairs of different scalars are met twice, once in each order, and kept once.
            for (i, _, other) in self.wired().filter(|&(_, t, _)| t <= s) {
                part.blocks.scalars[next()] += weight * factor * other * field.by_potentials(i, j);
            }
        }
    }
}
