//! The hexahedron against naive oracles: textbook formulas with loops over dual numbers, shape functions written anew.

mod common;

use common::random::Random;
use num_dual::{Dual, Dual64, DualNum, HyperDual};
use proboscis::element::{
    Dielectric, Elastomer, Field, Local, Passive, Shape, Viscosity, ViscousContraction,
    ViscousLocal, Volume,
};
use proboscis::math::{Matrix, Vector};

/// Rounding of some thousands of operations at values of order one.
const TOLERANCE: f64 = 2e-12;
/// Random states at which each law is looked at.
const STATES: usize = 3;

/// Signs of the nodes of the parent cube in the order of VTK.
const SIGNS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

fn cube() -> [Vector; 8] {
    SIGNS.map(|s| Vector::from(s).map(|c| 0.5 * (c + 1.0)))
}

fn distorted(random: &mut Random, nodes: &[Vector; 8], amount: f64) -> [Vector; 8] {
    nodes.map(|x| x + random.vector() * amount)
}

/// A distorted hexahedron and a state of it.
fn state(random: &mut Random) -> ([Vector; 8], [Vector; 8], [f64; 8]) {
    let box_of_edges = cube().map(|x| Vector::new(1.3 * x.x, 0.8 * x.y, 1.1 * x.z));
    let nodes = distorted(random, &box_of_edges, 0.12);
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.15 * random.unit());
    let x = distorted(random, &nodes.map(|x| map * x), 0.1);
    (nodes, x, std::array::from_fn(|_| random.unit()))
}

// The naive element.

type M<D> = [[D; 3]; 3];

fn determinant<D: DualNum<f64> + Copy>(m: M<D>) -> D {
    m[0][0] * m[1][1] * m[2][2] + m[0][1] * m[1][2] * m[2][0] + m[0][2] * m[1][0] * m[2][1]
        - m[0][2] * m[1][1] * m[2][0]
        - m[0][1] * m[1][0] * m[2][2]
        - m[0][0] * m[1][2] * m[2][1]
}

fn inverse<D: DualNum<f64> + Copy>(m: M<D>) -> M<D> {
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

fn product<D: DualNum<f64> + Copy>(a: M<D>, b: M<D>) -> M<D> {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).fold(D::zero(), |sum, k| sum + a[i][k] * b[k][j]))
    })
}

fn transposed<D: Copy>(a: M<D>) -> M<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// a : b.
fn contracted<D: DualNum<f64> + Copy>(a: M<D>, b: M<D>) -> D {
    (0..9).fold(D::zero(), |sum, k| sum + a[k / 3][k % 3] * b[k / 3][k % 3])
}

/// Weight and gradients at each Gauss point, in any order.
fn gauss(nodes: &[Vector; 8]) -> Vec<(f64, [[f64; 3]; 8])> {
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

/// F = Σ x_i ⊗ G_i of the first 24 numbers.
fn deformation<D: DualNum<f64> + Copy>(p: &[D], gradients: &[[f64; 3]; 8]) -> M<D> {
    std::array::from_fn(|a| {
        std::array::from_fn(|m| {
            (0..8).fold(D::zero(), |sum, i| sum + p[3 * i + a] * gradients[i][m])
        })
    })
}

/// The energy of physics.md 2.1 through C and C⁻¹, arguments: 24 coordinates, then 8 potentials.
struct Naive {
    mu: f64,
    lambda: f64,
    electric: Option<Dielectric>,
    volume: Volume,
    points: Vec<(f64, [[f64; 3]; 8])>,
}

impl Naive {
    fn energy<D: DualNum<f64> + Copy>(&self, p: &[D]) -> D {
        let mut energy = D::zero();
        let mut volume = 0.0;
        let mut deformed = D::zero();
        for (w, gradients) in &self.points {
            let f = deformation(p, gradients);
            let c = product(transposed(f), f);
            let j = determinant(f);
            volume += w;
            deformed += j * *w;
            let mut density =
                (c[0][0] + c[1][1] + c[2][2] - 3.0) * (0.5 * self.mu) - j.ln() * self.mu;
            if self.volume == Volume::Pointwise {
                density += j.ln().powi(2) * (0.5 * self.lambda);
            }
            if let Some(k) = self.electric {
                let e: [D; 3] = std::array::from_fn(|m| {
                    (0..8).fold(D::zero(), |sum, i| sum - p[24 + i] * gradients[i][m])
                });
                let square: M<D> = std::array::from_fn(|a| std::array::from_fn(|b| e[a] * e[b]));
                density += (square[0][0] + square[1][1] + square[2][2]) * k.c1
                    + contracted(c, square) * k.c2
                    - j * contracted(inverse(c), square) * (0.5 * k.permittivity);
            }
            energy += density * *w;
        }
        if self.volume == Volume::Mean {
            energy += (deformed / volume).ln().powi(2) * (0.5 * self.lambda * volume);
        }
        energy
    }
}

/// A flat copy of what an element writes: value, gradient, Hessian of 24 or 32 arguments.
struct Flat {
    value: f64,
    gradient: Vec<f64>,
    hessian: Vec<Vec<f64>>,
}

fn flat<F: Field>(local: &Local<F>) -> Flat {
    let mut electric = local.electric.clone();
    let electric = F::electric(&mut electric);
    let n = if electric.is_some() { 32 } else { 24 };
    let mut gradient = vec![0.0; n];
    let mut hessian = vec![vec![0.0; n]; n];
    for r in 0..24 {
        gradient[r] = local.forces[r / 3][r % 3];
        for c in 0..24 {
            hessian[r][c] = local.stiffness[r / 3][c / 3][(r % 3, c % 3)];
        }
    }
    if let Some(electric) = electric {
        for i in 0..8 {
            gradient[24 + i] = electric.charges[i];
            for j in 0..8 {
                hessian[24 + i][24 + j] = electric.permittivity[i][j];
            }
            for r in 0..24 {
                hessian[r][24 + i] = electric.coupling[r / 3][i][r % 3];
                hessian[24 + i][r] = electric.coupling[r / 3][i][r % 3];
            }
        }
    }
    Flat {
        value: local.energy,
        gradient,
        hessian,
    }
}

/// Value, gradient and Hessian of a formula, and their rates along `w`, by nested dual numbers.
fn oracle(
    p: &[f64],
    w: &[f64],
    f: impl Fn(&[HyperDual<Dual64, f64>]) -> HyperDual<Dual64, f64>,
) -> (Flat, Flat) {
    let n = p.len();
    let empty = || Flat {
        value: 0.0,
        gradient: vec![0.0; n],
        hessian: vec![vec![0.0; n]; n],
    };
    let (mut plain, mut along) = (empty(), empty());
    let number = |on: bool| Dual::new(f64::from(on), 0.0);
    for r in 0..n {
        for c in 0..=r {
            let arguments: Vec<_> = (0..n)
                .map(|k| {
                    let value = Dual64::new(p[k], w[k]);
                    HyperDual::new(value, number(k == r), number(k == c), number(false))
                })
                .collect();
            let result = f(&arguments);
            for (out, part) in [
                (&mut plain, (|d: Dual64| d.re) as fn(Dual64) -> f64),
                (&mut along, |d: Dual64| d.eps),
            ] {
                out.value = part(result.re);
                out.gradient[r] = part(result.eps1);
                out.hessian[r][c] = part(result.eps1eps2);
                out.hessian[c][r] = part(result.eps1eps2);
            }
        }
    }
    (plain, along)
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |max, v| v.abs().max(max))
}

/// Vectors agree to a fraction of their largest entry, which is not zero.
fn close(name: &str, a: &[f64], b: &[f64]) {
    let size = largest(b);
    assert_eq!(a.len(), b.len(), "{name}");
    assert!(size > 1e-3, "{name} is as small as {size}");
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(
            (a - b).abs() <= TOLERANCE * size,
            "{name}[{k}]: {a} for {b}"
        );
    }
}

fn close_flat(name: &str, a: &Flat, b: &Flat) {
    close(&format!("{name} energy"), &[a.value], &[b.value]);
    close(&format!("{name} gradient"), &a.gradient, &b.gradient);
    close(
        &format!("{name} hessian"),
        &a.hessian.concat(),
        &b.hessian.concat(),
    );
}

const DIELECTRIC: Dielectric = Dielectric {
    c1: -0.7,
    c2: 0.45,
    permittivity: 0.6,
};

fn law<F>(volume: Volume, field: F) -> Elastomer<F> {
    Elastomer {
        shear_modulus: 1.3,
        lame_lambda: 2.9,
        volume,
        field,
    }
}

fn all_derivatives<F: Field>(
    field: F,
    electric: Option<Dielectric>,
    potentials: fn([f64; 8]) -> F::Potentials,
) {
    let mut random = Random(7);
    let n = if electric.is_some() { 32 } else { 24 };
    for volume in [Volume::Pointwise, Volume::Mean] {
        let law = law(volume, field);
        for _ in 0..STATES {
            let (nodes, x, phi) = state(&mut random);
            let (w, w_phi): ([Vector; 8], [f64; 8]) = (
                std::array::from_fn(|_| random.vector()),
                std::array::from_fn(|_| random.unit()),
            );
            let shape = Shape::new(&nodes).unwrap();
            let naive = Naive {
                mu: law.shear_modulus,
                lambda: law.lame_lambda,
                electric,
                volume,
                points: gauss(&nodes),
            };
            let list = |x: &[Vector; 8], phi: &[f64; 8]| -> Vec<f64> {
                let x = x.iter().flat_map(|x| [x.x, x.y, x.z]);
                x.chain(*phi).take(n).collect()
            };
            let (p, d) = (list(&x, &phi), list(&w, &w_phi));
            let (plain, along) = oracle(&p, &d, |p| naive.energy(p));

            let (phi, w_phi) = (potentials(phi), potentials(w_phi));
            let name = format!("{volume:?} {n}");
            let mut local = Local::default();
            law.tangent(&shape, &x, &phi, &mut local);
            close_flat(&format!("{name} tangent"), &flat(&local), &plain);
            let mut gradient = Local::default();
            law.gradient(&shape, &x, &phi, &mut gradient);
            close(
                &format!("{name} energy"),
                &[gradient.energy],
                &[plain.value],
            );
            close(
                &format!("{name} gradient"),
                &flat(&gradient).gradient,
                &plain.gradient,
            );
            let energy = law.energy(&shape, &x, &phi);
            close(&format!("{name} energy"), &[energy], &[plain.value]);
            let mut rate = Local::default();
            law.third(&shape, &x, &phi, &w, &w_phi, &mut local, &mut rate);
            close_flat(&format!("{name} third, plain"), &flat(&local), &plain);
            close_flat(&format!("{name} third, along"), &flat(&rate), &along);
        }
    }
}

#[test]
fn derivatives_of_a_passive_law() {
    all_derivatives(Passive, None, |_| ());
}

#[test]
fn derivatives_of_a_dielectric_law() {
    all_derivatives(DIELECTRIC, Some(DIELECTRIC), |phi| phi);
}

// Viscosity.

/// Σ y_i·f_i = ∫ P_vis : Ẏ dV with P_vis = ½ J η (F⁻ᵀ Ḟᵀ F⁻ᵀ + Ḟ C⁻¹) of physics.md 2.3; arguments x, v.
fn viscous_work<D: DualNum<f64> + Copy>(
    points: &[(f64, [[f64; 3]; 8])],
    eta: f64,
    x: &[D],
    v: &[D],
    y: &[D],
) -> D {
    points.iter().fold(D::zero(), |work, (w, gradients)| {
        let [f, rate, virtual_rate] = [x, v, y].map(|p| deformation(p, gradients));
        let inverse_c = inverse(product(transposed(f), f));
        let t = transposed(inverse(f));
        let first = product(product(t, transposed(rate)), t);
        let second = product(rate, inverse_c);
        let stress: M<D> =
            std::array::from_fn(|a| std::array::from_fn(|m| first[a][m] + second[a][m]));
        work + determinant(f) * contracted(stress, virtual_rate) * (0.5 * eta * w)
    })
}

fn list(x: &[Vector; 8]) -> Vec<f64> {
    x.iter().flat_map(|x| [x.x, x.y, x.z]).collect()
}

fn blocks(blocks: &[[Matrix; 8]; 8]) -> Vec<f64> {
    let entry = |r: usize, c: usize| blocks[r / 3][c / 3][(r % 3, c % 3)];
    (0..24 * 24).map(|k| entry(k / 24, k % 24)).collect()
}

#[test]
fn viscous_forces_and_their_derivatives() {
    let mut random = Random(11);
    let law = Viscosity { viscosity: 1.7 };
    for _ in 0..STATES {
        let (nodes, x, _) = state(&mut random);
        let [v, y]: [[Vector; 8]; 2] =
            std::array::from_fn(|_| std::array::from_fn(|_| random.vector()));
        let shape = Shape::new(&nodes).unwrap();
        let points = gauss(&nodes);

        // All derivatives of y·f by (x, v); y is a direction, so the plain forces come from unit directions.
        let p = [list(&x), list(&v)].concat();
        let (s, _) = oracle(&p, &[0.0; 48], |p| {
            let y: Vec<_> = list(&y).into_iter().map(|y| p[0] * 0.0 + y).collect();
            viscous_work(&points, law.viscosity, &p[..24], &p[24..], &y)
        });
        let mut out = ViscousContraction::default();
        law.contraction(&shape, &x, &v, &y, &mut out);
        close("s", &[out.value], &[s.value]);
        close("∂s/∂x", &list(&out.by_place), &s.gradient[..24]);
        close("∂s/∂v", &list(&out.by_velocity), &s.gradient[24..]);
        let part = |rows: usize, columns: usize| -> Vec<f64> {
            let row = |r: usize| s.hessian[rows + r][columns..columns + 24].to_vec();
            (0..24).flat_map(row).collect()
        };
        close("∂²s/∂x∂x", &blocks(&out.place_place), &part(0, 0));
        close("∂²s/∂x∂v", &blocks(&out.place_velocity), &part(0, 24));
        assert!(largest(&part(24, 24)) < 1e-12, "s is linear in v");

        // f_i by unit directions, its derivatives by dual numbers.
        let mut local = ViscousLocal::default();
        law.tangent(&shape, &x, &v, &mut local);
        let mut forces = [Vector::zeros(); 8];
        law.forces(&shape, &x, &v, &mut forces);
        let derivative = |row: usize, column: usize| -> Dual64 {
            let number = |k: usize| Dual64::new(p[k], f64::from(k == column));
            let arguments: Vec<_> = (0..48).map(number).collect();
            let unit: Vec<_> = (0..24).map(|k| Dual64::from(f64::from(k == row))).collect();
            let (x, v) = arguments.split_at(24);
            viscous_work(&points, law.viscosity, x, v, &unit)
        };
        let values: Vec<f64> = (0..24).map(|r| derivative(r, 0).re).collect();
        close("f", &list(&forces), &values);
        close("f of the tangent", &list(&local.forces), &values);
        let slopes = |from: usize| -> Vec<f64> {
            let entry = |k: usize| derivative(k / 24, from + k % 24).eps;
            (0..24 * 24).map(entry).collect()
        };
        close("∂f/∂x", &blocks(&local.by_place), &slopes(0));
        close("∂f/∂v", &blocks(&local.by_velocity), &slopes(24));

        let power: f64 = forces.iter().zip(&v).map(|(f, v)| f.dot(v)).sum();
        close("power", &[law.power(&shape, &x, &v)], &[power]);
        assert!(power > 0.0);
    }
}

#[test]
fn viscosity_is_objective_under_a_finite_rotation() {
    let mut random = Random(5);
    let law = Viscosity { viscosity: 1.7 };
    let (nodes, start, _) = state(&mut random);
    let shape = Shape::new(&nodes).unwrap();
    let rotation = *nalgebra::Rotation3::new(Vector::new(0.7, -0.5, 0.4)).matrix();
    let shift = Vector::new(3.0, -1.0, 2.0);
    let h = 0.1;
    let end = start.map(|x| rotation * x + shift);
    let middle: [Vector; 8] = std::array::from_fn(|i| (start[i] + end[i]) * 0.5);
    let velocity: [Vector; 8] = std::array::from_fn(|i| (end[i] - start[i]) / h);
    let mut forces = [Vector::zeros(); 8];
    law.forces(&shape, &middle, &velocity, &mut forces);
    let rounding = 1e-14 * largest(&list(&velocity)) * law.viscosity;
    assert!(largest(&list(&forces)) < rounding * 10.0, "{forces:?}");
    assert!(law.power(&shape, &middle, &velocity).abs() < rounding);

    // The same with stretching is not free of force.
    let stretching: [Vector; 8] = std::array::from_fn(|i| velocity[i] + end[i]);
    law.forces(&shape, &middle, &stretching, &mut forces);
    assert!(largest(&list(&forces)) > 0.1);
}
