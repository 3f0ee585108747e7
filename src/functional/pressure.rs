//! Pressure that follows faces of elements: the virtual work `Σ δx_a·f_a` of a pressure p against the outward normals of deformed
//! faces,
//!
//! ```text
//! f_a = −p ∫ N_a x_,ξ × x_,η dξ dη = −½ p Σ_bc A_abc x_b × x_c,     A_abc = ∫ N_a (N_b,ξ N_c,η − N_c,ξ N_b,η) dξ dη.
//! ```
//!
//! The table A belongs to the parent cell, so that forces are exact for any warped face.

use crate::functional::finite_elements::middle;
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use crate::mesh::interpolation::{Interpolation, Parent};
use std::sync::Arc;

/// The table A of a kind of face.
pub type Areas<const NODES: usize> = Arc<[[[f64; NODES]; NODES]; NODES]>;

/// The table A of the faces with so many nodes.
pub fn areas<const NODES: usize>() -> Areas<NODES>
where
    Parent<NODES>: Interpolation<2, NODES>,
{
    let mut table = [[[0.0; NODES]; NODES]; NODES];
    for (at, weight) in Parent::<NODES>::quadrature() {
        let (values, slopes) = (Parent::<NODES>::values(&at), Parent::<NODES>::slopes(&at));
        for (value, table) in values.into_iter().zip(&mut table) {
            for (b, row) in table.iter_mut().enumerate() {
                for (c, entry) in row.iter_mut().enumerate() {
                    let area = slopes[b][0] * slopes[c][1] - slopes[c][0] * slopes[b][1];
                    *entry += weight * value * area;
                }
            }
        }
    }
    Arc::new(table)
}

/// One face under a pressure; arguments are the virtual displacements of the nodes and their places.
#[derive(Clone, Debug)]
pub struct PressureFace<const NODES: usize> {
    /// Vectors of the nodes, counter-clockwise seen from outside.
    pub nodes: [usize; NODES],
    /// The table A.
    pub areas: Areas<NODES>,
    /// Scalar of the pressure in MPa.
    pub pressure: usize,
}

/// The matrix of v × ·.
fn cross(v: &Vector) -> Matrix {
    v.cross_matrix()
}

impl<const NODES: usize> PressureFace<NODES> {
    /// Forces of a pressure of one on the nodes at places x.
    fn forces(&self, x: &[Vector; NODES]) -> [Vector; NODES] {
        let mut forces = [Vector::zeros(); NODES];
        for b in 0..NODES {
            for c in b + 1..NODES {
                let area = x[b].cross(&x[c]);
                for (force, table) in forces.iter_mut().zip(self.areas.iter()) {
                    *force -= area * table[b][c];
                }
            }
        }
        forces
    }
}

/// Derivatives of the virtual work: rows are virtual displacements, columns places.
struct Plain<'a, const NODES: usize> {
    areas: &'a [[[f64; NODES]; NODES]; NODES],
    pressure: f64,
    x: [Vector; NODES],
    /// Forces of a pressure of one.
    forces: [Vector; NODES],
}

impl<const NODES: usize> Derivatives for Plain<'_, NODES> {
    fn force(&self, i: usize) -> Vector {
        self.forces[i] * self.pressure
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let places = self.x.iter().zip(&self.areas[i][j - NODES]);
        let sum: Vector = places.map(|(x, table)| x * *table).sum();
        cross(&sum) * self.pressure
    }

    fn column(&self, i: usize, _: usize) -> Vector {
        self.forces[i]
    }
}

/// Derivatives of the virtual work of the direction w by places.
struct Along<'a, const NODES: usize> {
    plain: &'a Plain<'a, NODES>,
    w: [Vector; NODES],
}

impl<const NODES: usize> Along<'_, NODES> {
    /// Σ_a w_a A_abc.
    fn weighted(&self, b: usize, c: usize) -> Vector {
        let directions = self.w.iter().zip(self.plain.areas);
        directions.map(|(w, table)| w * table[b][c]).sum()
    }
}

impl<const NODES: usize> Derivatives for Along<'_, NODES> {
    fn force(&self, i: usize) -> Vector {
        self.column(i, 0) * self.plain.pressure
    }

    fn row(&self, _: usize) -> f64 {
        let both = self.w.iter().zip(&self.plain.forces);
        both.map(|(w, force)| w.dot(force)).sum()
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        cross(&self.weighted(i - NODES, j - NODES)) * self.plain.pressure
    }

    fn column(&self, i: usize, _: usize) -> Vector {
        let places = self.plain.x.iter().enumerate();
        places
            .map(|(c, x)| self.weighted(i - NODES, c).cross(x))
            .sum()
    }
}

impl<const NODES: usize> Kernel for PressureFace<NODES> {
    type Storage = ();

    const DEGREE: usize = 4;
    const VIRTUAL: usize = NODES;
    const READINGS: usize = 2;
    const APPLIED: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        (i < NODES) != (j < NODES) || i >= NODES && i != j
    }

    fn vectors(&self) -> usize {
        NODES
    }

    fn scalars(&self) -> usize {
        1
    }

    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(self.nodes[i % NODES])
    }

    fn scalar(&self, _: usize) -> Option<(usize, f64)> {
        Some((self.pressure, 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let [before, after] = sample.vectors;
        let forces = self.forces(&middle(sample.vectors, &self.nodes));
        let moves = self.nodes.iter().map(|&v| after[v] - before[v]);
        let work: f64 = moves.zip(&forces).map(|(step, f)| step.dot(f)).sum();
        sample.scalars[self.pressure] * work
    }

    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        let x = middle(sample.vectors, &self.nodes);
        let plain = Plain {
            areas: &self.areas,
            pressure: sample.scalars[self.pressure],
            x,
            forces: self.forces(&x),
        };
        to.plain(&plain);
        if order == Order::Third {
            let w = middle(sample.along, &self.nodes);
            to.along(&plain, &Along { plain: &plain, w });
        }
    }
}
