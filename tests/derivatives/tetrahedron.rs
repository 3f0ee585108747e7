//! The quadratic tetrahedron against naive oracles: shape functions by the inverse of a Vandermonde matrix, the law over dual numbers.

use crate::common::random::Random;
use crate::hexahedron::{DIELECTRIC, Kind, State, all_derivatives, close};
use crate::naive_hexahedron::{determinant, inverse};
use nalgebra::SMatrix;
use proboscis::element::{ElementGeometry, Passive, Viscosity, ViscousLocal};
use proboscis::functional::areas;
use proboscis::math::{Matrix, Vector};
use proboscis::mesh::interpolation::{Element, Parent, Point};

/// Nodes in the parent cell, in the order of VTK.
const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

/// 1, ξ, η, ζ, ξ², η², ζ², ξη, ηζ, ζξ.
fn monomials([x, y, z]: [f64; 3]) -> [f64; 10] {
    [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x]
}

fn slopes_of_monomials([x, y, z]: [f64; 3]) -> [[f64; 3]; 10] {
    let zero = [0.0; 3];
    let first = [zero, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let squares = [
        [2.0 * x, 0.0, 0.0],
        [0.0, 2.0 * y, 0.0],
        [0.0, 0.0, 2.0 * z],
    ];
    let mixed = [[y, x, 0.0], [0.0, z, y], [z, 0.0, x]];
    let all = [&first[..], &squares, &mixed].concat();
    all.try_into().unwrap()
}

/// Rows are coefficients of the monomials of a shape function.
fn coefficients() -> SMatrix<f64, 10, 10> {
    let at_nodes = SMatrix::<f64, 10, 10>::from_fn(|node, k| monomials(NODES[node])[k]);
    at_nodes.try_inverse().unwrap().transpose()
}

fn values(at: [f64; 3]) -> [f64; 10] {
    let value = coefficients() * SMatrix::<f64, 10, 1>::from(monomials(at));
    value.into()
}

fn slopes(at: [f64; 3]) -> [[f64; 3]; 10] {
    let of = slopes_of_monomials(at);
    let slopes = coefficients() * SMatrix::<f64, 10, 3>::from_fn(|k, m| of[k][m]);
    std::array::from_fn(|i| [0, 1, 2].map(|m| slopes[(i, m)]))
}

fn jacobian(nodes: &[Vector; 10], at: [f64; 3]) -> [[f64; 3]; 3] {
    let slopes = slopes(at);
    let entry = |a: usize, m: usize| nodes.iter().zip(&slopes).map(|(x, s)| x[a] * s[m]).sum();
    [0, 1, 2].map(|a| [0, 1, 2].map(|m| entry(a, m)))
}

/// A curved tetrahedron and a state of it.
fn state(random: &mut Random) -> State<10> {
    let shear = Matrix::identity() + Matrix::from_fn(|_, _| 0.2 * random.unit());
    let nodes = NODES.map(|x| shear * Vector::from(x) + random.vector() * 0.04);
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.15 * random.unit());
    let x = nodes.map(|x| map * x + random.vector() * 0.04);
    (nodes, x, std::array::from_fn(|_| random.unit()))
}

/// Weight and gradients at the Gauss points.
fn gauss(nodes: &[Vector; 10]) -> Vec<(f64, [[f64; 3]; 10])> {
    let points = Parent::<10>::POINTS.iter();
    let point = |&(at, weight): &Point<3>| {
        let jacobian = jacobian(nodes, at);
        let inverse = inverse(jacobian);
        let gradients = slopes(at)
            .map(|slope| std::array::from_fn(|a| (0..3).map(|m| slope[m] * inverse[m][a]).sum()));
        (weight * determinant(jacobian), gradients)
    };
    points.map(point).collect()
}

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

#[test]
fn gauss_points_integrate_the_third_degree_and_no_further() {
    let mut worst = [0.0_f64; 5];
    for i in 0..5 {
        for j in 0..5 - i {
            for k in 0..5 - i - j {
                let exact = factorial(i) * factorial(j) * factorial(k) / factorial(i + j + k + 3);
                let powers = [i, j, k].map(|p| p as i32);
                let term = |&(at, w): &Point<3>| {
                    w * (0..3).map(|m| at[m].powi(powers[m])).product::<f64>()
                };
                let sum: f64 = Parent::<10>::POINTS.iter().map(term).sum();
                let worst = &mut worst[(i + j + k) as usize];
                *worst = worst.max((sum / exact - 1.0).abs());
            }
        }
    }
    assert!(worst[..4].iter().all(|error| *error < 1e-14), "{worst:?}");
    assert!(worst[4] > 1e-3, "{worst:?}");
    assert_eq!(Parent::<10>::PLACES, NODES);
}

fn kind() -> Kind<10> {
    Kind {
        random: Random(11),
        state,
        gauss,
    }
}

#[test]
fn derivatives_of_a_passive_law() {
    all_derivatives(kind(), Passive, None, |_| ());
}

#[test]
fn derivatives_of_a_dielectric_law() {
    all_derivatives(kind(), DIELECTRIC, Some(DIELECTRIC), |phi| phi);
}

/// Places and weights of a midpoint rule with `n` cells along each axis of the parent cell, extrapolated once.
fn fine(n: usize, of: &dyn Fn([f64; 3]) -> f64) -> f64 {
    let rule = |n: usize| -> f64 {
        let h = 1.0 / n as f64;
        let at = |i: usize| (i as f64 + 0.5) * h;
        let mut sum = 0.0;
        for [i, j, k] in (0..n * n * n).map(|c| [c % n, c / n % n, c / n / n]) {
            // A collapsed cube.
            let [a, b, c] = [i, j, k].map(at);
            let weight = (1.0 - a) * (1.0 - a) * (1.0 - b);
            sum += weight * of([a, b * (1.0 - a), c * (1.0 - a) * (1.0 - b)]);
        }
        sum * h * h * h
    };
    (4.0 * rule(2 * n) - rule(n)) / 3.0
}

#[test]
fn masses_and_loads_are_integrals() {
    let mut random = Random(5);
    let (nodes, _, _) = state(&mut random);
    let mass = ElementGeometry::mass(&nodes, 1.4);
    let loads = ElementGeometry::loads(&nodes);
    let determinant = |at: [f64; 3]| determinant(jacobian(&nodes, at));
    for (i, j) in [(0, 0), (0, 3), (4, 9), (2, 5), (7, 7)] {
        let exact = fine(24, &|at| {
            1.4 * values(at)[i] * values(at)[j] * determinant(at)
        });
        assert!(
            (mass[i][j] - exact).abs() < 2e-7,
            "{i} {j}: {} for {exact}",
            mass[i][j]
        );
        assert_eq!(mass[i][j], mass[j][i]);
    }
    for (i, load) in loads.iter().enumerate() {
        let row: f64 = mass[i].iter().sum();
        close("loads", &[1.4 * load + 1.0], &[row + 1.0]);
    }
    // The consistent mass of a straight element: ρV/420 times 6, 1, −4, −6, 32, 16 and 8.
    let shear = Matrix::new(1.2, 0.3, -0.1, 0.2, 0.9, 0.1, 0.0, 0.2, 1.1);
    let straight = NODES.map(|x| shear * Vector::from(x));
    let mass = ElementGeometry::mass(&straight, 420.0 * 6.0 / shear.determinant());
    let expected = [((0, 0), 6.0), ((0, 1), 1.0), ((0, 4), -4.0), ((0, 5), -6.0)];
    for ((i, j), entry) in expected {
        close("straight", &[mass[i][j]], &[entry]);
    }
    close(
        "straight",
        &[mass[4][4], mass[4][5], mass[4][9]],
        &[32.0, 16.0, 8.0],
    );
}

#[test]
fn a_linear_state_has_a_uniform_gradient() {
    let mut random = Random(19);
    let (nodes, ..) = state(&mut random);
    let shape = ElementGeometry::new(&nodes).unwrap();
    let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.3 * random.unit());
    let x = nodes.map(|x| map * x + Vector::new(1.0, 2.0, 3.0));
    for g in 0..8 {
        let error = shape.gradient_of(&x, g) - map;
        assert!(error.amax() < 1e-13, "{error}");
    }
    let mut turned = nodes;
    turned.swap(0, 1);
    assert!(ElementGeometry::new(&turned).unwrap_err().determinant < 0.0);
}

#[test]
fn viscous_forces_are_those_of_a_uniform_rate() {
    // σ = η d over a straight element: forces ∫ σ ∇N dV, of which those of corners vanish.
    let rate = Matrix::new(0.1, 0.3, 0.0, -0.2, 0.2, 0.4, 0.1, 0.0, -0.1);
    let nodes = NODES.map(Vector::from);
    let shape = ElementGeometry::new(&nodes).unwrap();
    let law = Viscosity { viscosity: 0.7 };
    let velocities = nodes.map(|x| rate * x);
    let mut local = ViscousLocal::default();
    law.tangent(&shape, &nodes, &velocities, &mut local);
    let stress = (rate + rate.transpose()) * 0.35;
    let force = |i: usize| {
        let weighted = |&(at, w): &Point<3>| stress * Vector::from(slopes(at)[i]) * w;
        Parent::<10>::POINTS.iter().map(weighted).sum::<Vector>()
    };
    for i in 0..10 {
        assert!((local.forces[i] - force(i)).amax() < 1e-15, "{i}");
        let by_rates: Vector = (0..10)
            .map(|j| local.by_velocity[i][j] * velocities[j])
            .sum();
        assert!((by_rates - force(i)).amax() < 1e-15, "{i}");
    }
}

#[test]
fn areas_of_a_face_close_a_tetrahedron() {
    // ½ Σ A_abc x_b × x_c summed over a is the vector area: over all faces of a curved element it vanishes.
    let mut random = Random(23);
    let (nodes, ..) = state(&mut random);
    let areas = areas::<6>();
    let faces = [
        [0, 2, 1, 6, 5, 4],
        [0, 1, 3, 4, 8, 7],
        [1, 2, 3, 5, 9, 8],
        [0, 3, 2, 7, 9, 6],
    ];
    let (mut sum, mut volume) = (Vector::zeros(), 0.0);
    for face in faces {
        let x = face.map(|node: usize| nodes[node]);
        for a in 0..6 {
            for b in 0..6 {
                for c in 0..6 {
                    let area = x[b].cross(&x[c]) * (0.5 * areas[a][b][c]);
                    sum += area;
                    volume += x[a].dot(&area) / 3.0;
                }
            }
        }
    }
    assert!(sum.amax() < 1e-14, "{sum}");
    let exact = fine(24, &|at| determinant(jacobian(&nodes, at)));
    assert!((volume - exact).abs() < 1e-8, "{volume} for {exact}");
}
