//! An element by textbook formulas with loops over dual numbers, and the hexahedron.

use crate::common::random::Random;
use crate::oracle::{Combination, Flat, Number, added, oracle_of_outer, oracle_of_sum};
use num_dual::DualNum;
use proboscis::element::{Dielectric, Volume};
use proboscis::math::{Matrix, Vector};

/// Signs of the nodes of the parent cube in the order of VTK.
pub(crate) const SIGNS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

pub(crate) fn cube() -> [Vector; 8] {
    SIGNS.map(|s| Vector::from(s).map(|c| 0.5 * (c + 1.0)))
}

fn distorted(random: &mut Random, nodes: &[Vector; 8], amount: f64) -> [Vector; 8] {
    nodes.map(|x| x + random.vector() * amount)
}

/// A distorted hexahedron and a state of it.
pub(crate) fn state(random: &mut Random) -> ([Vector; 8], [Vector; 8], [f64; 8]) {
    let edges = Vector::from_fn(|_, _| random.between(0.8, 1.3));
    let nodes = distorted(random, &cube().map(|x| x.component_mul(&edges)), 0.12);
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.15 * random.unit());
    let x = distorted(random, &nodes.map(|x| map * x), 0.1);
    (nodes, x, std::array::from_fn(|_| random.unit()))
}

// The naive element.

pub(crate) type M<D> = [[D; 3]; 3];

pub(crate) fn determinant<D: DualNum<f64> + Copy>(m: M<D>) -> D {
    m[0][0] * m[1][1] * m[2][2] + m[0][1] * m[1][2] * m[2][0] + m[0][2] * m[1][0] * m[2][1]
        - m[0][2] * m[1][1] * m[2][0]
        - m[0][1] * m[1][0] * m[2][2]
        - m[0][0] * m[1][2] * m[2][1]
}

pub(crate) fn inverse<D: DualNum<f64> + Copy>(m: M<D>) -> M<D> {
    let det = determinant(m);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            // The minor without row j and column i, in cyclic order.
            let (a, b) = ((j + 1) % 3, (j + 2) % 3);
            let (c, d) = ((i + 1) % 3, (i + 2) % 3);
            (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / det
        })
    })
}

pub(crate) fn product<D: DualNum<f64> + Copy>(a: M<D>, b: M<D>) -> M<D> {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).fold(D::zero(), |sum, k| sum + a[i][k] * b[k][j]))
    })
}

pub(crate) fn transposed<D: Copy>(a: M<D>) -> M<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// a : b.
pub(crate) fn contracted<D: DualNum<f64> + Copy>(a: M<D>, b: M<D>) -> D {
    (0..9).fold(D::zero(), |sum, k| sum + a[k / 3][k % 3] * b[k / 3][k % 3])
}

/// Weight and gradients at each Gauss point, in any order.
pub(crate) fn gauss(nodes: &[Vector; 8]) -> Vec<(f64, [[f64; 3]; 8])> {
    let mut points = Vec::new();
    for xi in [-1.0, 1.0] {
        for eta in [-1.0, 1.0] {
            for zeta in [-1.0, 1.0] {
                let at = [xi, eta, zeta].map(|s: f64| s / 3.0_f64.sqrt());
                let slopes: [[f64; 3]; 8] = SIGNS.map(|s| {
                    let [a, b, c] = [0, 1, 2].map(|m| (1.0 + s[m] * at[m]) / 2.0);
                    [s[0] / 2.0 * b * c, s[1] / 2.0 * a * c, s[2] / 2.0 * a * b]
                });
                let mut jacobian = [[0.0; 3]; 3];
                for i in 0..8 {
                    for a in 0..3 {
                        for m in 0..3 {
                            jacobian[a][m] += nodes[i][a] * slopes[i][m];
                        }
                    }
                }
                let inverse = inverse(jacobian);
                let gradients = slopes.map(|slope| {
                    std::array::from_fn(|a| (0..3).map(|m| slope[m] * inverse[m][a]).sum())
                });
                points.push((determinant(jacobian), gradients));
            }
        }
    }
    points
}

/// F = Σ x_i ⊗ G_i of the first numbers.
pub(crate) fn deformation<D: DualNum<f64> + Copy>(p: &[D], gradients: &[[f64; 3]]) -> M<D> {
    std::array::from_fn(|a| {
        std::array::from_fn(|m| {
            (0..gradients.len()).fold(D::zero(), |sum, i| sum + p[3 * i + a] * gradients[i][m])
        })
    })
}

/// The nine entries of F of coordinates that begin at a place among all arguments.
pub(crate) fn of_deformation(gradients: &[[f64; 3]], first: usize) -> Vec<Combination> {
    let nodes = gradients.len();
    let entry = |k: usize| (0..nodes).map(move |i| (first + 3 * i + k / 3, gradients[i][k % 3]));
    (0..9).map(|k| entry(k).collect()).collect()
}

/// A matrix of its entries, row by row.
pub(crate) fn matrix<D: Copy>(q: &[D]) -> M<D> {
    std::array::from_fn(|a| std::array::from_fn(|m| q[3 * a + m]))
}

/// The energy of docs/theory.md, 2.1 through C and C⁻¹, arguments: coordinates, then potentials.
pub(crate) struct Naive<const NODES: usize = 8> {
    pub(crate) mu: f64,
    pub(crate) lambda: f64,
    pub(crate) electric: Option<Dielectric>,
    pub(crate) volume: Volume,
    pub(crate) points: Vec<(f64, [[f64; 3]; NODES])>,
}

impl<const NODES: usize> Naive<NODES> {
    pub(crate) fn energy<D: DualNum<f64> + Copy>(&self, p: &[D]) -> D {
        let mut energy = D::zero();
        let mut deformed = D::zero();
        for (w, gradients) in &self.points {
            let f = deformation(p, gradients);
            deformed += determinant(f) * *w;
            let e = self.electric.map(|_| {
                std::array::from_fn(|m| {
                    (0..NODES).fold(D::zero(), |sum, i| sum - p[3 * NODES + i] * gradients[i][m])
                })
            });
            energy += self.density(f, e) * *w;
        }
        if self.volume == Volume::Mean {
            energy += self.of_volume(deformed);
        }
        energy
    }

    /// Energy per volume of F and E, without that of a mean dilatation.
    fn density<D: DualNum<f64> + Copy>(&self, f: M<D>, e: Option<[D; 3]>) -> D {
        let c = product(transposed(f), f);
        let j = determinant(f);
        let mut density = (c[0][0] + c[1][1] + c[2][2] - 3.0) * (0.5 * self.mu) - j.ln() * self.mu;
        if self.volume == Volume::Pointwise {
            density += j.ln().powi(2) * (0.5 * self.lambda);
        }
        if let Some((k, e)) = self.electric.zip(e) {
            let square: M<D> = std::array::from_fn(|a| std::array::from_fn(|b| e[a] * e[b]));
            density += (square[0][0] + square[1][1] + square[2][2]) * k.c1
                + contracted(c, square) * k.c2
                - j * contracted(inverse(c), square) * (0.5 * k.permittivity);
        }
        density
    }

    /// Energy of the mean dilatation of a deformed volume.
    fn of_volume<D: DualNum<f64> + Copy>(&self, deformed: D) -> D {
        let volume: f64 = self.points.iter().map(|(w, _)| w).sum();
        (deformed / volume).ln().powi(2) * (0.5 * self.lambda * volume)
    }

    /// Derivatives of the energy, with a further one per volume, at `p` along `w`.
    pub(crate) fn derivatives(
        &self,
        p: &[f64],
        w: &[f64],
        further: impl Fn(M<Number>) -> Number,
    ) -> (Flat, Flat) {
        let field = |gradients: &[[f64; 3]; NODES], m: usize| -> Combination {
            let potentials = (0..NODES).map(|i| (3 * NODES + i, -gradients[i][m]));
            potentials.collect()
        };
        let own = |(_, gradients): &(f64, [[f64; 3]; NODES])| {
            let mut own = of_deformation(gradients, 0);
            if self.electric.is_some() {
                own.extend((0..3).map(|m| field(gradients, m)));
            }
            own
        };
        let combinations: Vec<_> = self.points.iter().map(own).collect();
        let sum = oracle_of_sum(p, w, &combinations, |k, q| {
            let e = self.electric.map(|_| [q[9], q[10], q[11]]);
            (self.density(matrix(q), e) + further(matrix(q))) * self.points[k].0
        });
        if self.volume == Volume::Pointwise {
            return sum;
        }
        let deformed = oracle_of_sum(p, w, &combinations, |k, q| {
            determinant(matrix(q)) * self.points[k].0
        });
        added(sum, &oracle_of_outer(&deformed, |v| self.of_volume(v)))
    }
}

/// C_i⁻¹ = UᵀDU of the coordinates (z₁, z₂, a, b, c) of a viscous strain C_i.
pub(crate) fn inverse_strain<D: DualNum<f64> + Copy>([z1, z2, a, b, c]: [D; 5]) -> M<D> {
    let (zero, one) = (D::zero(), D::one());
    let upper = [[one, a, b], [zero, one, c], [zero, zero, one]];
    let stretches = [z1, z2, -z1 - z2].map(|z| z.exp());
    let scaled = std::array::from_fn(|k| upper[k].map(|entry| entry * stretches[k]));
    product(transposed(upper), scaled)
}
