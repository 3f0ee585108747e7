//! Pressure that follows faces of elements: the virtual work `Σ δx_a·f_a` of a pressure p against the outward normals of deformed
//! bilinear faces,
//!
//! ```text
//! f_a = −p ∫ N_a x_,ξ × x_,η dξ dη = −½ p Σ_bc A_abc x_b × x_c,     A_abc = ∫ N_a (N_b,ξ N_c,η − N_c,ξ N_b,η) dξ dη.
//! ```
//!
//! The table A belongs to the square, so that forces are exact for any warped face.

use crate::functional::finite_elements::middle;
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use crate::mesh::CORNERS;

/// One face under a pressure; arguments are the virtual displacements of the nodes and their places.
#[derive(Clone, Debug)]
pub struct PressureFace {
    /// Vectors of the nodes, counter-clockwise seen from outside.
    pub nodes: [usize; 4],
    /// Scalar of the pressure in MPa.
    pub pressure: usize,
}

/// The table A.
const TABLE: [[[f64; 4]; 4]; 4] = {
    let mut table = [[[0.0; 4]; 4]; 4];
    let mut i = 0;
    while i < 64 {
        let (a, b, c) = (i / 16, i / 4 % 4, i % 4);
        table[a][b][c] = product(a, b, c) - product(a, c, b);
        i += 1;
    }
    table
};

/// ∫ N_a N_b,ξ N_c,η dξ dη; the corners of the square are the first ones of the cube.
const fn product(a: usize, b: usize, c: usize) -> f64 {
    let [along, across] = [
        CORNERS[a][0] * CORNERS[c][0] / 3.0,
        CORNERS[a][1] * CORNERS[b][1] / 3.0,
    ];
    CORNERS[b][0] * CORNERS[c][1] * (1.0 + along) * (1.0 + across) / 16.0
}

/// The matrix of v × ·.
fn cross(v: &Vector) -> Matrix {
    v.cross_matrix()
}

/// Forces of a pressure of one on the nodes at places x.
fn forces(x: &[Vector; 4]) -> [Vector; 4] {
    let mut forces = [Vector::zeros(); 4];
    for b in 0..4 {
        for c in b + 1..4 {
            let area = x[b].cross(&x[c]);
            for (force, table) in forces.iter_mut().zip(&TABLE) {
                *force -= area * table[b][c];
            }
        }
    }
    forces
}

/// Derivatives of the virtual work: rows are virtual displacements, columns places.
struct Plain {
    pressure: f64,
    x: [Vector; 4],
    /// Forces of a pressure of one.
    forces: [Vector; 4],
}

impl Derivatives for Plain {
    fn force(&self, i: usize) -> Vector {
        self.forces[i] * self.pressure
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let places = self.x.iter().zip(&TABLE[i][j - 4]);
        let sum: Vector = places.map(|(x, table)| x * *table).sum();
        cross(&sum) * self.pressure
    }

    fn column(&self, i: usize, _: usize) -> Vector {
        self.forces[i]
    }
}

/// Derivatives of the virtual work of the direction w by places.
struct Along<'a> {
    plain: &'a Plain,
    w: [Vector; 4],
}

impl Along<'_> {
    /// Σ_a w_a A_abc.
    fn weighted(&self, b: usize, c: usize) -> Vector {
        let directions = self.w.iter().zip(&TABLE);
        directions.map(|(w, table)| w * table[b][c]).sum()
    }
}

impl Derivatives for Along<'_> {
    fn force(&self, i: usize) -> Vector {
        self.column(i, 0) * self.plain.pressure
    }

    fn row(&self, _: usize) -> f64 {
        let both = self.w.iter().zip(&self.plain.forces);
        both.map(|(w, force)| w.dot(force)).sum()
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        cross(&self.weighted(i - 4, j - 4)) * self.plain.pressure
    }

    fn column(&self, i: usize, _: usize) -> Vector {
        let places = self.plain.x.iter().enumerate();
        places.map(|(c, x)| self.weighted(i - 4, c).cross(x)).sum()
    }
}

impl Kernel for PressureFace {
    type Storage = ();

    const DEGREE: usize = 4;
    const VIRTUAL: usize = 4;
    const READINGS: usize = 2;
    const APPLIED: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        (i < 4) != (j < 4) || i >= 4 && i != j
    }

    fn vectors(&self) -> usize {
        4
    }

    fn scalars(&self) -> usize {
        1
    }

    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(self.nodes[i % 4])
    }

    fn scalar(&self, _: usize) -> Option<(usize, f64)> {
        Some((self.pressure, 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let [before, after] = sample.vectors;
        let forces = forces(&middle(sample.vectors, &self.nodes));
        let moves = self.nodes.iter().map(|&v| after[v] - before[v]);
        let work: f64 = moves.zip(&forces).map(|(step, f)| step.dot(f)).sum();
        sample.scalars[self.pressure] * work
    }

    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        let x = middle(sample.vectors, &self.nodes);
        let plain = Plain {
            pressure: sample.scalars[self.pressure],
            x,
            forces: forces(&x),
        };
        to.plain(&plain);
        if order == Order::Third {
            let w = middle(sample.along, &self.nodes);
            to.along(&plain, &Along { plain: &plain, w });
        }
    }
}
