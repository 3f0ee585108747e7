//! The hexahedron against naive oracles: textbook formulas with loops over dual numbers, shape functions written anew.

#![expect(
    clippy::needless_range_loop,
    reason = "nodes and components are the indices of the formulas"
)]

use crate::common::random::Random;
#[allow(unreachable_pub, reason = "other tests use it through a module")]
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
    let edges = Vector::from_fn(|_, _| random.between(0.8, 1.3));
    let nodes = distorted(random, &cube().map(|x| x.component_mul(&edges)), 0.12);
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

// Laws of one element.

/// The forces, or the charges, of an element at a state.
fn forces<F: Field>(
    law: &Elastomer<F>,
    shape: &Shape,
    x: &[Vector; 8],
    phi: &F::Potentials,
) -> Local<F> {
    let mut local = Local::default();
    law.gradient(shape, x, phi, &mut local);
    local
}

#[test]
fn weights_and_masses() {
    let mut random = Random(3);
    let (nodes, _, _) = state(&mut random);
    let shape = Shape::new(&nodes).unwrap();
    let volume: f64 = gauss(&nodes).iter().map(|(w, _)| w).sum();
    close("volume", &[shape.volume()], &[volume]);
    let mass = shape.mass(1.4);
    close("mass", &[mass.concat().iter().sum()], &[1.4 * volume]);
    for i in 0..8 {
        for j in 0..8 {
            assert_eq!(mass[i][j], mass[j][i]);
        }
    }
    close("loads", &[shape.loads().iter().sum()], &[volume]);

    // The consistent mass of a box: ρV/216 · 8, 4, 2, 1 along an edge, a face diagonal, a space diagonal.
    let edges = Vector::new(1.3, 0.8, 1.1);
    let brick = Shape::new(&cube().map(|x| x.component_mul(&edges))).unwrap();
    let mass = brick.mass(1.4);
    for i in 0..8 {
        for j in 0..8 {
            let apart = (0..3).filter(|&m| SIGNS[i][m] != SIGNS[j][m]).count() as i32;
            let exact = 1.4 * edges.product() / 216.0 * 2.0_f64.powi(3 - apart);
            close("mass of a box", &[mass[i][j]], &[exact]);
        }
    }
    close(
        "loads of a box",
        &brick.loads(),
        &[edges.product() / 8.0; 8],
    );
}

#[test]
fn a_hexahedron_inside_out_is_refused() {
    let mut nodes = cube();
    nodes.swap(0, 4);
    nodes.swap(1, 5);
    nodes.swap(2, 6);
    nodes.swap(3, 7);
    let error = Shape::new(&nodes).unwrap_err();
    assert!((error.determinant + 0.125).abs() < 1e-15, "{error}");
}

#[test]
fn rotations_cost_no_energy() {
    let mut random = Random(9);
    let rotation = *nalgebra::Rotation3::new(Vector::new(0.7, -1.5, 2.4)).matrix();
    let shift = Vector::new(3.0, -1.0, 2.0);
    for volume in [Volume::Pointwise, Volume::Mean] {
        let (nodes, x, phi) = state(&mut random);
        let shape = Shape::new(&nodes).unwrap();
        let turned = |x: &[Vector; 8]| x.map(|x| rotation * x + shift);

        let passive = law(volume, Passive);
        assert!(passive.energy(&shape, &turned(&nodes), &()).abs() < 1e-13);
        let free = forces(&passive, &shape, &turned(&nodes), &());
        assert!(largest(&list(&free.forces)) < 1e-13);

        let dielectric = law(volume, DIELECTRIC);
        let here = forces(&dielectric, &shape, &x, &phi);
        let there = forces(&dielectric, &shape, &turned(&x), &phi);
        close("energy", &[there.energy], &[here.energy]);
        close("charges", &there.electric.charges, &here.electric.charges);
        close(
            "forces",
            &list(&there.forces),
            &list(&here.forces.map(|f| rotation * f)),
        );
        let sum: Vector = here.forces.iter().sum();
        let moment: Vector = x.iter().zip(&here.forces).map(|(x, f)| x.cross(f)).sum();
        assert!(sum.norm() < 1e-13 && moment.norm() < 1e-13);
        assert!(here.electric.charges.iter().sum::<f64>().abs() < 1e-13);
    }
}

#[test]
fn both_volumes_agree_on_homogeneous_deformations() {
    let mut random = Random(13);
    let (nodes, _, phi) = state(&mut random);
    let shape = Shape::new(&nodes).unwrap();
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.2 * random.unit());
    let x = nodes.map(|x| map * x);
    let [a, b] = [Volume::Pointwise, Volume::Mean].map(|volume| {
        let law = law(volume, DIELECTRIC);
        (forces(&law, &shape, &x, &phi), law.fields(&shape, &x, &phi))
    });
    close("energy", &[a.0.energy], &[b.0.energy]);
    close("forces", &list(&a.0.forces), &list(&b.0.forces));
    close("stress", a.1.stress.as_slice(), b.1.stress.as_slice());
    close("F", a.1.deformation_gradient.as_slice(), map.as_slice());
    close("J", &[a.1.jacobian_determinant], &[map.determinant()]);

    // A state that is not homogeneous tells them apart.
    let (nodes, x, _) = state(&mut random);
    let shape = Shape::new(&nodes).unwrap();
    let [a, b] = [Volume::Pointwise, Volume::Mean].map(|v| law(v, Passive).energy(&shape, &x, &()));
    assert!((a - b).abs() > 1e-4);
}

#[test]
fn an_inverted_state_is_nan_everywhere() {
    let nodes = cube();
    let shape = Shape::new(&nodes).unwrap();
    // One corner pushed through the opposite one: J < 0 at some points, the mean dilatation stays positive.
    let mut corner = nodes;
    corner[6] = Vector::new(-0.4, -0.4, -0.4);
    let flipped = nodes.map(|x| Vector::new(x.x, x.y, -x.z));
    let flat_state = nodes.map(|x| Vector::new(x.x, x.y, 0.0));
    for x in [corner, flipped, flat_state] {
        for volume in [Volume::Pointwise, Volume::Mean] {
            let law = law(volume, DIELECTRIC);
            let mut local = Local::default();
            law.tangent(&shape, &x, &[0.3; 8], &mut local);
            let Flat {
                value,
                gradient,
                hessian,
            } = flat(&local);
            assert!(value.is_nan(), "{volume:?}");
            assert!(
                gradient.iter().all(|v| v.is_nan()),
                "{volume:?} {gradient:?}"
            );
            assert!(hessian.concat().iter().all(|v| v.is_nan()), "{volume:?}");
            assert!(law.energy(&shape, &x, &[0.3; 8]).is_nan());
            let mut forces = [Vector::zeros(); 8];
            Viscosity { viscosity: 1.0 }.forces(&shape, &x, &nodes, &mut forces);
            assert!(list(&forces).iter().all(|v| v.is_nan()));
        }
    }
}

#[test]
fn fields_are_means_of_the_law() {
    // Stress and displacement by dual numbers of the energy density: a brick in a homogeneous state.
    let edges = Vector::new(1.3, 0.8, 1.1);
    let nodes = cube().map(|x| x.component_mul(&edges));
    let shape = Shape::new(&nodes).unwrap();
    let mut random = Random(21);
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.2 * random.unit());
    let field = random.vector();
    let x = nodes.map(|x| map * x);
    let phi = nodes.map(|x| -field.dot(&x));
    let rate = Matrix::from_fn(|_, _| random.unit());
    let v = nodes.map(|x| rate * x);
    let law = law(Volume::Pointwise, DIELECTRIC);
    let fields = law.fields(&shape, &x, &phi);
    let points = gauss(&nodes);
    let naive = Naive {
        mu: law.shear_modulus,
        lambda: law.lame_lambda,
        electric: Some(DIELECTRIC),
        volume: Volume::Pointwise,
        points,
    };
    // Of a homogeneous variation, ∂W is V P:∂F − V D·∂E.
    let slope = |w: [Vector; 8], w_phi: [f64; 8]| {
        let number = |(value, rate): (f64, f64)| Dual64::new(value, rate);
        let mut p: Vec<Dual64> = list(&x).into_iter().zip(list(&w)).map(number).collect();
        p.extend(phi.into_iter().zip(w_phi).map(number));
        naive.energy(&p).eps / shape.volume()
    };
    let unit = |a: usize, m: usize| Matrix::from_fn(|r, c| f64::from(r == a && c == m));
    let piola = Matrix::from_fn(|a, m| slope(nodes.map(|x| unit(a, m) * x), [0.0; 8]));
    let displacement = Vector::from_fn(|m, _| slope([Vector::zeros(); 8], nodes.map(|x| x[m])));
    let j = map.determinant();
    let stress = piola * map.transpose() / j;
    close("stress", fields.stress.as_slice(), stress.as_slice());
    close(
        "displacement",
        fields.electric_displacement.as_slice(),
        (map * displacement / j).as_slice(),
    );
    close(
        "E",
        fields.reference_electric_field.as_slice(),
        field.as_slice(),
    );
    let spatial = map.transpose().try_inverse().unwrap() * field;
    close("e", fields.electric_field.as_slice(), spatial.as_slice());
    let s = fields.stress;
    let mises = 0.5 * ((s.m11 - s.m22).powi(2) + (s.m22 - s.m33).powi(2) + (s.m33 - s.m11).powi(2))
        + 3.0 * (s.m12.powi(2) + s.m23.powi(2) + s.m31.powi(2));
    close("von Mises", &[fields.von_mises()], &[mises.sqrt()]);
    let l = rate * map.try_inverse().unwrap();
    let viscous = Viscosity { viscosity: 1.7 }.stress(&shape, &x, &v);
    close(
        "viscous stress",
        viscous.as_slice(),
        ((l + l.transpose()) * 0.85).as_slice(),
    );
}

// Laws of patches and states.

/// A cube of seven hexahedra around a distorted inner one, after MacNeal & Harder, Finite Elem. Anal. Des. 1, 3–20 (1985).
fn patch() -> (Vec<Vector>, Vec<[usize; 8]>) {
    let inner = [
        [0.249, 0.342, 0.192],
        [0.826, 0.288, 0.288],
        [0.850, 0.649, 0.263],
        [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643],
        [0.677, 0.305, 0.683],
        [0.788, 0.693, 0.644],
        [0.165, 0.745, 0.702],
    ];
    let mut nodes = cube().to_vec();
    nodes.extend(inner.map(Vector::from));
    let (o, i) = (|k: usize| k, |k: usize| 8 + k);
    let hexahedra = vec![
        [0, 1, 2, 3, 4, 5, 6, 7].map(i),
        [o(0), o(1), o(2), o(3), i(0), i(1), i(2), i(3)],
        [i(4), i(5), i(6), i(7), o(4), o(5), o(6), o(7)],
        [o(0), o(1), i(1), i(0), o(4), o(5), i(5), i(4)],
        [o(1), o(2), i(2), i(1), o(5), o(6), i(6), i(5)],
        [o(2), o(3), i(3), i(2), o(6), o(7), i(7), i(6)],
        [o(3), o(0), i(0), i(3), o(7), o(4), i(4), i(7)],
    ];
    (nodes, hexahedra)
}

#[test]
fn patch_test() {
    let (nodes, hexahedra) = patch();
    let mut random = Random(17);
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.2 * random.unit());
    let field = random.vector();
    for volume in [Volume::Pointwise, Volume::Mean] {
        let law = law(volume, DIELECTRIC);
        let mut sums = vec![Vector::zeros(); 16];
        let mut charges = [0.0; 16];
        let mut total = 0.0;
        let mut stresses = Vec::new();
        for hexahedron in &hexahedra {
            let reference = hexahedron.map(|k| nodes[k]);
            let shape = Shape::new(&reference).unwrap();
            total += shape.volume();
            let (x, phi) = (
                reference.map(|x| map * x),
                reference.map(|x| -field.dot(&x)),
            );
            let local = forces(&law, &shape, &x, &phi);
            for (i, &k) in hexahedron.iter().enumerate() {
                sums[k] += local.forces[i];
                charges[k] += local.electric.charges[i];
            }
            stresses.push(law.fields(&shape, &x, &phi).stress);
        }
        close("volume", &[total], &[1.0]);
        for stress in &stresses {
            close("stress", stress.as_slice(), stresses[0].as_slice());
        }
        assert!(largest(&list(sums[..8].try_into().unwrap())) > 0.1);
        assert!(largest(&list(sums[8..].try_into().unwrap())) < 1e-14);
        assert!(largest(&charges[..8]) > 0.1 && largest(&charges[8..]) < 1e-14);
    }
}

/// Rows of physics.md 8.2: E in V/mm, lateral stretch, stretch along the field, J.
const FREE_BLOCK: [[f64; 4]; 5] = [
    [2.0e4, 1.0004972444, 0.9987764628, 0.9997699817],
    [5.0e4, 1.0030833599, 0.9924433383, 0.9985728935],
    [1.0e5, 1.0120016140, 0.9709880991, 0.9944348077],
    [1.5e5, 1.0258763833, 0.9387560116, 0.9879678114],
    [2.0e5, 1.0435550148, 0.8996092950, 0.9796808815],
];

#[test]
fn a_free_block_contracts_in_its_field() {
    let nodes = cube().map(|x| x * 0.1);
    let shape = Shape::new(&nodes).unwrap();
    for volume in [Volume::Pointwise, Volume::Mean] {
        let law = Elastomer {
            shear_modulus: 233.0,
            lame_lambda: 999.8,
            volume,
            field: Dielectric {
                c1: 5e-8,
                c2: 1e-9,
                permittivity: 8.854e-12,
            },
        };
        for [field, lateral, along, j] in FREE_BLOCK {
            let phi = nodes.map(|x| field * x.z);
            // Symmetry planes hold a coordinate where it is zero; the others are free.
            let free: Vec<(usize, usize)> = (0..24)
                .map(|k| (k / 3, k % 3))
                .filter(|&(i, a)| nodes[i][a] > 0.0)
                .collect();
            let mut x = nodes;
            let mut local = Local::default();
            for _ in 0..20 {
                law.tangent(&shape, &x, &phi, &mut local);
                let residual = nalgebra::DVector::from_fn(free.len(), |r, _| {
                    local.forces[free[r].0][free[r].1]
                });
                let jacobian = nalgebra::DMatrix::from_fn(free.len(), free.len(), |r, c| {
                    let ((i, a), (j, b)) = (free[r], free[c]);
                    local.stiffness[i][j][(a, b)]
                });
                let step = jacobian.lu().solve(&residual).unwrap();
                for (r, &(i, a)) in free.iter().enumerate() {
                    x[i][a] -= step[r];
                }
            }
            assert!(largest(&list(&local.forces)) < 1e-12);
            // The table is rounded to ten decimals.
            for (i, a) in free {
                let stretch = x[i][a] / nodes[i][a];
                let expected = if a == 2 { along } else { lateral };
                assert!(
                    (stretch - expected).abs() < 1e-9,
                    "{stretch} for {expected}"
                );
            }
            let fields = law.fields(&shape, &x, &phi);
            assert!((fields.jacobian_determinant - j).abs() < 1e-9);
            assert!(
                fields.stress.norm() < 1e-9,
                "traction-free: {}",
                fields.stress
            );
        }
    }
}
