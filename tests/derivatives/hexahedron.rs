//! The hexahedron against naive oracles: textbook formulas with loops over dual numbers, shape functions written anew.

#![expect(
    clippy::needless_range_loop,
    reason = "nodes and components are the indices of the formulas"
)]

use crate::common::random::Random;
use crate::naive_hexahedron::{Naive, SIGNS, cube, gauss, state};
use crate::oracle::{Flat, Number};
use proboscis::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Field, Local, NodeState, Passive,
    Viscosity, Volume,
};
use proboscis::energy::NeoHooke;
use proboscis::math::{Matrix, Vector};
use proboscis::mesh::interpolation::{Element, Parent};

/// Rounding of some thousands of operations at values of order one.
const TOLERANCE: f64 = 2e-12;
/// Random states at which each law is looked at.
pub(crate) const STATES: usize = 3;

pub(crate) fn flat<F: Field, const NODES: usize>(local: &Local<F, NODES>) -> Flat {
    let mut electric = local.electric.clone();
    let electric = F::electric(&mut electric);
    let of_places = 3 * NODES;
    let n = if electric.is_some() {
        4 * NODES
    } else {
        of_places
    };
    let mut gradient = vec![0.0; n];
    let mut hessian = vec![vec![0.0; n]; n];
    for r in 0..of_places {
        gradient[r] = local.forces[r / 3][r % 3];
        for c in 0..of_places {
            hessian[r][c] = local.stiffness[r / 3][c / 3][(r % 3, c % 3)];
        }
    }
    if let Some(electric) = electric {
        for i in 0..NODES {
            gradient[of_places + i] = electric.charges[i];
            for j in 0..NODES {
                hessian[of_places + i][of_places + j] = electric.permittivity[i][j];
            }
            for r in 0..of_places {
                hessian[r][of_places + i] = electric.coupling[r / 3][i][r % 3];
                hessian[of_places + i][r] = electric.coupling[r / 3][i][r % 3];
            }
        }
    }
    Flat {
        value: local.energy,
        gradient,
        hessian,
    }
}

pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |max, v| v.abs().max(max))
}

/// Vectors agree to a fraction of their largest entry, which is not zero.
pub(crate) fn close(name: &str, a: &[f64], b: &[f64]) {
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

pub(crate) fn close_flat(name: &str, a: &Flat, b: &Flat) {
    close(&format!("{name} energy"), &[a.value], &[b.value]);
    close(&format!("{name} gradient"), &a.gradient, &b.gradient);
    close(
        &format!("{name} hessian"),
        &a.hessian.concat(),
        &b.hessian.concat(),
    );
}

pub(crate) const DIELECTRIC: Dielectric = Dielectric {
    c1: -0.7,
    c2: 0.45,
    permittivity: 0.6,
};

pub(crate) fn law<F>(volume: Volume, field: F) -> Elastomer<F> {
    Elastomer {
        shear_modulus: 1.3,
        lame_lambda: 2.9,
        volume,
        field,
        law: NeoHooke,
    }
}

/// Places in the reference and now, and potentials.
pub(crate) type State<const NODES: usize> = ([Vector; NODES], [Vector; NODES], [f64; NODES]);

/// Weights and gradients.
type GaussPoints<const NODES: usize> = Vec<(f64, [[f64; 3]; NODES])>;

/// A kind of element by naive formulas.
pub(crate) struct Kind<const NODES: usize> {
    pub(crate) random: Random,
    pub(crate) state: fn(&mut Random) -> State<NODES>,
    pub(crate) gauss: fn(&[Vector; NODES]) -> GaussPoints<NODES>,
}

/// All derivatives of a law at random states of a kind of element.
pub(crate) fn all_derivatives<F: Field, const NODES: usize>(
    kind: Kind<NODES>,
    field: F,
    electric: Option<Dielectric>,
    potentials: fn([f64; NODES]) -> F::Potentials<NODES>,
) where
    Parent<NODES>: Element<NODES>,
{
    let Kind {
        mut random,
        state,
        gauss,
    } = kind;
    let n = if electric.is_some() {
        4 * NODES
    } else {
        3 * NODES
    };
    for volume in [Volume::Pointwise, Volume::Mean].repeat(STATES) {
        let law = law(volume, field);
        let (nodes, x, phi) = state(&mut random);
        let (w, w_phi): ([Vector; NODES], [f64; NODES]) = (
            std::array::from_fn(|_| random.vector()),
            std::array::from_fn(|_| random.unit()),
        );
        let shape = ElementGeometry::new(&nodes).unwrap();
        let naive = Naive {
            mu: law.shear_modulus,
            lambda: law.lame_lambda,
            electric,
            volume,
            points: gauss(&nodes),
        };
        let list = |x: &[Vector; NODES], phi: &[f64; NODES]| -> Vec<f64> {
            let x = x.iter().flat_map(|x| [x.x, x.y, x.z]);
            x.chain(*phi).take(n).collect()
        };
        let (p, d) = (list(&x, &phi), list(&w, &w_phi));
        let (plain, along) = naive.derivatives(&p, &d, |_| Number::from(0.0));

        let (phi, w_phi) = (potentials(phi), potentials(w_phi));
        let name = format!("{volume:?} {n}");
        let mut local = Local::default();
        let at = NodeState::new(&shape, &x, &phi);
        law.tangent(&at, &mut local);
        close_flat(&format!("{name} tangent"), &flat(&local), &plain);
        let mut gradient = Local::default();
        law.gradient(&at, &mut gradient);
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
        let energy = law.energy(&at);
        close(&format!("{name} energy"), &[energy], &[plain.value]);
        let mut rate = Local::default();
        law.third(&at.along(&w, &w_phi), &mut local, &mut rate);
        close_flat(&format!("{name} third, plain"), &flat(&local), &plain);
        close_flat(&format!("{name} third, along"), &flat(&rate), &along);
    }
}

fn kind() -> Kind<8> {
    Kind {
        random: Random(7),
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

pub(crate) fn list(x: &[Vector; 8]) -> Vec<f64> {
    x.iter().flat_map(|x| [x.x, x.y, x.z]).collect()
}

// Properties of one element.

/// The forces, or the charges, of an element at a state.
pub(crate) fn forces<F: Field>(
    law: &Elastomer<F>,
    shape: &ElementGeometry,
    x: &[Vector; 8],
    phi: &F::Potentials<8>,
) -> Local<F> {
    let mut local = Local::default();
    law.gradient(&NodeState::new(shape, x, phi), &mut local);
    local
}

#[test]
fn weights_and_masses() {
    let mut random = Random(3);
    let (nodes, _, _) = state(&mut random);
    let shape = ElementGeometry::new(&nodes).unwrap();
    let volume: f64 = gauss(&nodes).iter().map(|(w, _)| w).sum();
    close("volume", &[shape.volume()], &[volume]);
    let mass = ElementGeometry::mass(&nodes, 1.4);
    close("mass", &[mass.concat().iter().sum()], &[1.4 * volume]);
    for i in 0..8 {
        for j in 0..8 {
            assert_eq!(mass[i][j], mass[j][i]);
        }
    }
    close(
        "loads",
        &[ElementGeometry::loads(&nodes).iter().sum()],
        &[volume],
    );

    // The consistent mass of a box: ρV/216 · 8, 4, 2, 1 along an edge, a face diagonal, a space diagonal.
    let edges = Vector::new(1.3, 0.8, 1.1);
    let brick = cube().map(|x| x.component_mul(&edges));
    let mass = ElementGeometry::mass(&brick, 1.4);
    for i in 0..8 {
        for j in 0..8 {
            let apart = (0..3).filter(|&m| SIGNS[i][m] != SIGNS[j][m]).count() as i32;
            let exact = 1.4 * edges.product() / 216.0 * 2.0_f64.powi(3 - apart);
            close("mass of a box", &[mass[i][j]], &[exact]);
        }
    }
    close(
        "loads of a box",
        &ElementGeometry::loads(&brick),
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
    let error = ElementGeometry::new(&nodes).unwrap_err();
    assert!((error.determinant + 0.125).abs() < 1e-15, "{error}");
}

#[test]
fn rotations_cost_no_energy() {
    let mut random = Random(9);
    let rotation = *nalgebra::Rotation3::new(Vector::new(0.7, -1.5, 2.4)).matrix();
    let shift = Vector::new(3.0, -1.0, 2.0);
    for volume in [Volume::Pointwise, Volume::Mean] {
        let (nodes, x, phi) = state(&mut random);
        let shape = ElementGeometry::new(&nodes).unwrap();
        let turned = |x: &[Vector; 8]| x.map(|x| rotation * x + shift);

        let passive = law(volume, Passive);
        assert!(
            passive
                .energy(&NodeState::new(&shape, &turned(&nodes), &()))
                .abs()
                < 1e-13
        );
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
    let shape = ElementGeometry::new(&nodes).unwrap();
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
    let shape = ElementGeometry::new(&nodes).unwrap();
    let [a, b] = [Volume::Pointwise, Volume::Mean]
        .map(|v| law(v, Passive).energy(&NodeState::new(&shape, &x, &())));
    assert!((a - b).abs() > 1e-4);
}

#[test]
fn an_inverted_state_is_nan_everywhere() {
    let nodes = cube();
    let shape = ElementGeometry::new(&nodes).unwrap();
    // One corner pushed through the opposite one: J < 0 at some points, the mean dilatation stays positive.
    let mut corner = nodes;
    corner[6] = Vector::new(-0.4, -0.4, -0.4);
    let flipped = nodes.map(|x| Vector::new(x.x, x.y, -x.z));
    let flat_state = nodes.map(|x| Vector::new(x.x, x.y, 0.0));
    for x in [corner, flipped, flat_state] {
        for volume in [Volume::Pointwise, Volume::Mean] {
            let law = law(volume, DIELECTRIC);
            let mut local = Local::default();
            let at = NodeState::new(&shape, &x, &[0.3; 8]);
            law.tangent(&at, &mut local);
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
            assert!(law.energy(&at).is_nan());
            let mut forces = [Vector::zeros(); 8];
            Viscosity { viscosity: 1.0 }.forces(&shape, &x, &nodes, &mut forces);
            assert!(list(&forces).iter().all(|v| v.is_nan()));
        }
    }
}
