//! Viscosity of finite elements: the virtual work `−h Σ δx̄·f(x̄, v)` of the stress σ = η d.
//!
//! The forces are linear in the velocities, so the work over an interval does not depend on its length: there is nothing to
//! derive by it.

use crate::element::{ElementGeometry, Viscosity, ViscousContraction, ViscousLocal};
use crate::functional::batches::Batches;
use crate::functional::hexahedra::middle;
use crate::functional::{Couplings, Kind, Order, Output, Sample, Term};
use crate::math::{Matrix, Vector};

/// One viscous hexahedron.
#[derive(Clone, Debug)]
pub struct ViscousHexahedron {
    /// Gradients of the shape functions.
    pub shape: ElementGeometry,
    /// The law.
    pub law: Viscosity,
    /// Vectors of the nodes.
    pub nodes: [usize; 8],
}

/// Viscous hexahedra.
#[derive(Debug)]
pub struct ViscousHexahedra {
    name: String,
    elements: Vec<ViscousHexahedron>,
    locals: Batches<ViscousLocal>,
}

/// Difference quotients over the interval.
fn rates(vectors: [&[Vector]; 2], nodes: &[usize; 8], h: f64) -> [Vector; 8] {
    nodes.map(|v| (vectors[1][v] - vectors[0][v]) / h)
}

/// Signs of x_k and x_{k+1} in a difference.
const SIGNS: [f64; 2] = [-1.0, 1.0];

/// Slots of an element: all pairs of its nodes.
fn of(slots: &[u32], element: usize) -> &[u32] {
    &slots[64 * element..64 * (element + 1)]
}

impl ViscousHexahedra {
    /// Hexahedra under one name.
    pub fn new(name: &str, elements: Vec<ViscousHexahedron>) -> Self {
        Self {
            name: name.to_owned(),
            elements,
            locals: Batches::default(),
        }
    }

    fn state(element: &ViscousHexahedron, frame: &Sample<'_>) -> [[Vector; 8]; 2] {
        let x = middle(frame.vectors, &element.nodes);
        [x, rates(frame.vectors, &element.nodes, frame.h)]
    }

    /// Adds what `block(i, j, row, col)` gives of the nodes i, j at the instants k + row, k + col.
    fn add_blocks(
        slots: &[u32],
        frame: &Sample<'_>,
        blocks: &mut [[Matrix; 4]],
        block: impl Fn(usize, usize, usize, usize) -> Matrix,
    ) {
        for (i, row) in slots.chunks_exact(8).enumerate() {
            for (j, &slot) in row.iter().enumerate() {
                for side in (0..4).filter(|&side| frame.sides.blocks[side]) {
                    blocks[slot as usize][side] += block(i, j, side / 2, side % 2);
                }
            }
        }
    }

    fn add(
        &self,
        index: usize,
        local: &ViscousLocal,
        level: Order,
        frame: &Sample<'_>,
        slots: &[u32],
        out: &mut Output,
    ) {
        let h = frame.h;
        for (&v, force) in self.elements[index].nodes.iter().zip(&local.forces) {
            out.plain.forces[0][v] -= force * (0.5 * h);
            out.plain.forces[1][v] -= force * (0.5 * h);
        }
        if level >= Order::Hessian {
            let blocks = &mut out.plain.blocks.full;
            Self::add_blocks(of(slots, index), frame, blocks, |i, j, _, col| {
                local.by_place[i][j] * (-0.25 * h) - local.by_velocity[i][j] * (0.5 * SIGNS[col])
            });
        }
    }

    fn add_contraction(
        &self,
        index: usize,
        s: &ViscousContraction,
        frame: &Sample<'_>,
        slots: &[u32],
        out: &mut Output,
    ) {
        let h = frame.h;
        for (i, &v) in self.elements[index].nodes.iter().enumerate() {
            for (side, sign) in SIGNS.into_iter().enumerate() {
                out.contracted.forces[side][v] -=
                    s.by_place[i] * (0.5 * h) + s.by_velocity[i] * sign;
            }
        }
        let blocks = &mut out.contracted.blocks.full;
        Self::add_blocks(of(slots, index), frame, blocks, |i, j, row, col| {
            s.place_place[i][j] * (-0.25 * h)
                - s.place_velocity[i][j] * (0.5 * SIGNS[col])
                - s.place_velocity[j][i].transpose() * (0.5 * SIGNS[row])
        });
    }
}

impl Term for ViscousHexahedra {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.elements.len()
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for ViscousHexahedron { nodes, .. } in &self.elements {
            for &a in nodes {
                slots.extend(nodes.map(|b| couplings.add_full(a, b) as u32));
            }
        }
    }

    fn kind(&self) -> Kind {
        Kind::VirtualWork
    }

    fn energy(&self, frame: &Sample<'_>) -> f64 {
        let work = |element: &ViscousHexahedron| {
            let [x, v] = Self::state(element, frame);
            -frame.h * element.law.power(&element.shape, &x, &v)
        };
        self.elements.iter().map(work).sum()
    }

    fn momentum(&self, _x: &[Vector], _v: &[Vector], _out: &mut [Vector]) {}

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        let compute = |element: &ViscousHexahedron, local: &mut ViscousLocal| {
            let [x, v] = Self::state(element, frame);
            match level {
                Order::Gradient => element
                    .law
                    .forces(&element.shape, &x, &v, &mut local.forces),
                _ => element.law.tangent(&element.shape, &x, &v, local),
            }
        };
        self.locals.each(&self.elements, compute, |index, local| {
            self.add(index, local, level, frame, slots, out);
        });
        if level < Order::Third {
            return;
        }
        let mut contraction = ViscousContraction::default();
        for (index, element) in self.elements.iter().enumerate() {
            let [x, v] = Self::state(element, frame);
            let w = middle(frame.along, &element.nodes);
            element
                .law
                .contraction(&element.shape, &x, &v, &w, &mut contraction);
            self.add_contraction(index, &contraction, frame, slots, out);
        }
    }
}
