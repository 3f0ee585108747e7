//! Maxwell branches of the hexahedron against naive formulas: derivatives, and the strain to which a branch relaxes.

#![expect(
    clippy::needless_range_loop,
    reason = "nodes and components are the indices of the formulas"
)]

use crate::common::random::Random;
use crate::hexahedron::{STATES, close, close_flat, list};
use crate::naive_hexahedron::{
    contracted, determinant, gauss, inverse_strain, matrix, of_deformation, product, state,
    transposed,
};
use crate::oracle::{Combination, Flat, oracle_of_sum};
use num_dual::DualNum;
use proboscis::element::{
    BranchLocal, ElementEnergy, ElementGeometry, MaxwellSpring, NodeState, ViscousStrains, relaxed,
};
use proboscis::math::{Matrix, Vector};

const MODULUS: f64 = 1.3;

/// The Gauss point of the element at each place of the naive list.
fn order(shape: &ElementGeometry, points: &[(f64, [[f64; 3]; 8])]) -> Vec<usize> {
    let same = |gradients: &[[f64; 3]; 8], g: usize| {
        let own = shape.gradients_at(g);
        let mut both = own.iter().zip(gradients);
        both.all(|(a, b)| (a - Vector::from(*b)).amax() < 1e-12)
    };
    let find = |(_, gradients): &(f64, [[f64; 3]; 8])| (0..8).find(|&g| same(gradients, g));
    points.iter().map(|point| find(point).unwrap()).collect()
}

/// ∫ μ₁/2 (J^(−2/3) C:C_i⁻¹ − 3) dV; arguments: 24 coordinates, then the strain of each point of the naive list.
fn energy(points: &[(f64, [[f64; 3]; 8])], p: &[f64], w: &[f64]) -> (Flat, Flat) {
    let own = |(k, (_, gradients)): (usize, &(f64, [[f64; 3]; 8]))| {
        let strains = (0..5).map(|m| vec![(24 + 5 * k + m, 1.0)]);
        let deformation = of_deformation(gradients, 0).into_iter();
        deformation.chain(strains).collect()
    };
    let combinations: Vec<Vec<Combination>> = points.iter().enumerate().map(own).collect();
    oracle_of_sum(p, w, &combinations, |k, q| {
        let f = matrix(q);
        let strain = std::array::from_fn(|m| q[9 + m]);
        let first = contracted(product(transposed(f), f), inverse_strain(strain));
        (first / determinant(f).powf(2.0 / 3.0) - 3.0) * (0.5 * MODULUS * points[k].0)
    })
}

fn strains(q: &[f64], order: &[usize]) -> ViscousStrains {
    let mut strains = ViscousStrains::default();
    for (k, &g) in order.iter().enumerate() {
        for m in 0..5 {
            strains[m][g] = q[5 * k + m];
        }
    }
    strains
}

/// What an element writes in the order of the naive arguments.
fn flat(local: &BranchLocal, order: &[usize]) -> Flat {
    let mut gradient = vec![0.0; 64];
    let mut hessian = vec![vec![0.0; 64]; 64];
    for r in 0..24 {
        gradient[r] = local.forces[r / 3][r % 3];
        for c in 0..24 {
            hessian[r][c] = local.stiffness[r / 3][c / 3][(r % 3, c % 3)];
        }
    }
    for (k, &g) in order.iter().enumerate() {
        for m in 0..5 {
            let row = 24 + 5 * k + m;
            gradient[row] = local.rows[m][g];
            for r in 0..24 {
                hessian[r][row] = local.coupling[r / 3][m][r % 3][g];
                hessian[row][r] = hessian[r][row];
            }
            for n in 0..5 {
                hessian[row][24 + 5 * k + n] = local.inner[m][n][g];
            }
        }
    }
    Flat {
        value: local.energy,
        gradient,
        hessian,
    }
}

#[test]
fn derivatives_of_the_spring_of_a_branch() {
    let mut random = Random(31);
    (0..STATES).for_each(|_| compare_at_random(&mut random));
}

fn compare_at_random(random: &mut Random) {
    let law = MaxwellSpring {
        shear_modulus: MODULUS,
    };
    let (nodes, x, _) = state(random);
    let w: [Vector; 8] = std::array::from_fn(|_| random.vector());
    let shape = ElementGeometry::new(&nodes).unwrap();
    let points = gauss(&nodes);
    let order = order(&shape, &points);
    let [q, w_q]: [Vec<f64>; 2] =
        std::array::from_fn(|_| (0..40).map(|_| 0.5 * random.unit()).collect());
    let (p, d) = (
        [list(&x), q.clone()].concat(),
        [list(&w), w_q.clone()].concat(),
    );
    let (plain, along) = energy(&points, &p, &d);
    let [q, w_q] = [q, w_q].map(|q| strains(&q, &order));
    let at = NodeState::new(&shape, &x, &q);
    close("energy", &[law.energy(&at)], &[plain.value]);
    let (mut local, mut rate) = (BranchLocal::default(), BranchLocal::default());
    law.gradient(&at, &mut local);
    close("gradient", &flat(&local, &order).gradient, &plain.gradient);
    law.tangent(&at, &mut local);
    close_flat("tangent", &flat(&local, &order), &plain);
    law.third(&at.along(&w, &w_q), &mut local, &mut rate);
    close_flat("third, plain", &flat(&local, &order), &plain);
    close_flat("third, along", &flat(&rate, &order), &along);
}

#[test]
fn a_relaxed_strain_is_that_of_the_deformation_without_its_volume() {
    let mut random = Random(7);
    for _ in 0..20 {
        let map = Matrix::identity() + Matrix::from_fn(|_, _| 0.4 * random.unit());
        let strain = map.tr_mul(&map) / map.determinant().powf(2.0 / 3.0);
        assert!((strain - Matrix::identity()).amax() > 0.1);
        let inverse = Matrix::from_fn(|i, j| inverse_strain(relaxed(&map))[i][j]);
        assert!((strain * inverse - Matrix::identity()).amax() < 1e-13);
    }
    assert_eq!(relaxed(&Matrix::identity()), [0.0; 5]);
}
