//! Viscous forces of the hexahedron against a naive oracle.

use crate::common::random::Random;
use crate::hexahedron::{STATES, close, largest, list};
use crate::naive_hexahedron::{
    M, contracted, deformation, determinant, gauss, inverse, matrix, of_deformation, product,
    state, transposed,
};
use crate::oracle::{Number, oracle_of_sum};
use num_dual::{Dual64, DualNum};
use proboscis::element::{ElementGeometry, Viscosity, ViscousContraction, ViscousLocal};
use proboscis::math::{Matrix, Vector};

// Viscosity.

/// w P_vis of P_vis = ½ J η (F⁻ᵀ Ḟᵀ F⁻ᵀ + Ḟ C⁻¹) of docs/theory.md, 2.3.
fn stress<D: DualNum<f64> + Copy>(factor: f64, f: M<D>, rate: M<D>) -> M<D> {
    let inverse_c = inverse(product(transposed(f), f));
    let t = transposed(inverse(f));
    let first = product(product(t, transposed(rate)), t);
    let second = product(rate, inverse_c);
    let scale = determinant(f) * (0.5 * factor);
    std::array::from_fn(|a| std::array::from_fn(|m| (first[a][m] + second[a][m]) * scale))
}

/// The forces f_i = ∫ P_vis G_i dV of places x and velocities v.
fn viscous_forces<D: DualNum<f64> + Copy>(
    points: &[(f64, [[f64; 3]; 8])],
    eta: f64,
    x: &[D],
    v: &[D],
) -> Vec<D> {
    let mut forces = vec![D::zero(); 24];
    for (w, gradients) in points {
        let [f, rate] = [x, v].map(|p| deformation(p, gradients));
        let stress = stress(eta * w, f, rate);
        for (k, force) in forces.iter_mut().enumerate() {
            for (entry, gradient) in stress[k % 3].iter().zip(gradients[k / 3]) {
                *force += *entry * gradient;
            }
        }
    }
    forces
}

fn blocks(blocks: &[[Matrix; 8]; 8]) -> Vec<f64> {
    let entry = |r: usize, c: usize| blocks[r / 3][c / 3][(r % 3, c % 3)];
    (0..24 * 24).map(|k| entry(k / 24, k % 24)).collect()
}

#[test]
fn viscous_forces_and_their_derivatives() {
    let mut random = Random(11);
    (0..STATES).for_each(|_| compare_at_random(&mut random));
}

fn compare_at_random(random: &mut Random) {
    let law = Viscosity { viscosity: 1.7 };
    let (nodes, x, _) = state(random);
    let [v, y]: [[Vector; 8]; 2] =
        std::array::from_fn(|_| std::array::from_fn(|_| random.vector()));
    let shape = ElementGeometry::new(&nodes).unwrap();
    let points = gauss(&nodes);

    // All derivatives of y·f by (x, v); y is a direction.
    let p = [list(&x), list(&v)].concat();
    let own = |(_, gradients): &(f64, [[f64; 3]; 8])| {
        [0, 24]
            .map(|first| of_deformation(gradients, first))
            .concat()
    };
    let combinations: Vec<_> = points.iter().map(own).collect();
    let (s, _) = oracle_of_sum(&p, &[0.0; 48], &combinations, |k, q| {
        let (w, gradients) = &points[k];
        let virtual_rate = deformation(&list(&y), gradients).map(|row| row.map(Number::from));
        let stress = stress(law.viscosity * w, matrix(q), matrix(&q[9..]));
        contracted(stress, virtual_rate)
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

    // f_i, its derivatives by dual numbers.
    let mut local = ViscousLocal::default();
    law.tangent(&shape, &x, &v, &mut local);
    let mut forces = [Vector::zeros(); 8];
    law.forces(&shape, &x, &v, &mut forces);
    let along = |column: usize| -> Vec<Dual64> {
        let number = |k: usize| Dual64::new(p[k], f64::from(k == column));
        let arguments: Vec<_> = (0..48).map(number).collect();
        viscous_forces(&points, law.viscosity, &arguments[..24], &arguments[24..])
    };
    let columns: Vec<Vec<Dual64>> = (0..48).map(along).collect();
    let values: Vec<f64> = columns[0].iter().map(|force| force.re).collect();
    close("f", &list(&forces), &values);
    close("f of the tangent", &list(&local.forces), &values);
    let slopes = |from: usize| -> Vec<f64> {
        let entry = |k: usize| columns[from + k % 24][k / 24].eps;
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
