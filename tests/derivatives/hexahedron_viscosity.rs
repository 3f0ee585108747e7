//! Viscous forces of the hexahedron against a naive oracle.

use crate::common::random::Random;
use crate::hexahedron::{close, largest, list, oracle};
use crate::naive_hexahedron::{
    M, contracted, deformation, determinant, gauss, inverse, product, state, transposed,
};
use num_dual::{Dual64, DualNum};
use proboscis::element::{ElementGeometry, Viscosity, ViscousContraction, ViscousLocal};
use proboscis::math::{Matrix, Vector};

// Viscosity.

/// Σ y_i·f_i = ∫ P_vis : Ẏ dV with P_vis = ½ J η (F⁻ᵀ Ḟᵀ F⁻ᵀ + Ḟ C⁻¹) of docs/theory.md, 2.3; arguments x, v.
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

fn blocks(blocks: &[[Matrix; 8]; 8]) -> Vec<f64> {
    let entry = |r: usize, c: usize| blocks[r / 3][c / 3][(r % 3, c % 3)];
    (0..24 * 24).map(|k| entry(k / 24, k % 24)).collect()
}

#[test]
fn viscous_forces_and_their_derivatives() {
    let mut random = Random(11);
    let law = Viscosity { viscosity: 1.7 };
    let (nodes, x, _) = state(&mut random);
    let [v, y]: [[Vector; 8]; 2] =
        std::array::from_fn(|_| std::array::from_fn(|_| random.vector()));
    let shape = ElementGeometry::new(&nodes).unwrap();
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

#[test]
fn viscosity_is_objective_under_a_finite_rotation() {
    let mut random = Random(5);
    let law = Viscosity { viscosity: 1.7 };
    let (nodes, start, _) = state(&mut random);
    let shape = ElementGeometry::new(&nodes).unwrap();
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
