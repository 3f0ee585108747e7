//! Hexahedra in states that are known: fields, a patch, a free block.

use crate::common::random::Random;
use crate::hexahedron::{DIELECTRIC, close, forces, largest, law, list};
use crate::naive_hexahedron::{Naive, cube, gauss};
use num_dual::Dual64;
use proboscis::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Local, NodeState, Viscosity, Volume,
};
use proboscis::energy::NeoHooke;
use proboscis::math::{Matrix, Vector};

#[test]
fn fields_are_means_of_the_law() {
    // Stress and displacement by dual numbers of the energy density: a brick in a homogeneous state.
    let edges = Vector::new(1.3, 0.8, 1.1);
    let nodes = cube().map(|x| x.component_mul(&edges));
    let shape = ElementGeometry::new(&nodes).unwrap();
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

// Properties of patches and states.

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
            let shape = ElementGeometry::new(&reference).unwrap();
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

/// Rows of docs/theory.md, 12.2: E in V/mm, lateral stretch, stretch along the field, J.
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
    let shape = ElementGeometry::new(&nodes).unwrap();
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
            law: NeoHooke,
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
                law.tangent(&NodeState::new(&shape, &x, &phi), &mut local);
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
