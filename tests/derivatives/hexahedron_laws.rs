//! Hexahedra by laws of elasticity other than the neo-Hookean one: derivatives of naive formulas, moduli, stress of a stretched bar, Gent's limit.

use crate::common::random::Random;
use crate::hexahedron::{DIELECTRIC, STATES, close, close_flat, flat, law, list};
use crate::naive_hexahedron::{
    Naive, cube, determinant, gauss, inverse, product, state, transposed,
};
use num_dual::{Dual64, DualNum};
use proboscis::element::{
    Dielectric, ElementEnergy, ElementGeometry, Field, IsochoricLaw, Local, NodeState, Passive,
    Volume,
};
use proboscis::math::{Matrix, Vector};

const LAWS: [IsochoricLaw; 3] = [
    IsochoricLaw::Gent { limit: 9.0 },
    IsochoricLaw::MooneyRivlin { share: 0.3 },
    IsochoricLaw::Yeoh { c2: -0.3, c3: 0.2 },
];
const VOLUMES: [Volume; 2] = [Volume::Pointwise, Volume::Mean];

/// ψ through Ī₁ = tr C/J^(2/3) and Ī₂ = J^(2/3) tr C⁻¹.
fn isochoric<D: DualNum<f64> + Copy>(law: IsochoricLaw, mu: f64, f: [[D; 3]; 3]) -> D {
    let trace = |m: [[D; 3]; 3]| m[0][0] + m[1][1] + m[2][2];
    let c = product(transposed(f), f);
    let root = determinant(f).powf(2.0 / 3.0);
    let (i1, i2) = (trace(c) / root - 3.0, trace(inverse(c)) * root - 3.0);
    match law {
        IsochoricLaw::Gent { limit } => (-i1 / limit + 1.0).ln() * (-0.5 * mu * limit),
        IsochoricLaw::MooneyRivlin { share } => {
            i1 * (0.5 * mu * (1.0 - share)) + i2 * (0.5 * mu * share)
        }
        IsochoricLaw::Yeoh { c2, c3 } => i1 * (0.5 * mu) + i1.powi(2) * c2 + i1.powi(3) * c3,
        IsochoricLaw::GentSlope { .. } | IsochoricLaw::GentCurvature { .. } => unreachable!(),
    }
}

fn all_derivatives<F: Field>(
    field: F,
    electric: Option<Dielectric>,
    potentials: fn([f64; 8]) -> F::Potentials<8>,
) {
    let mut random = Random(23);
    let n = if electric.is_some() { 32 } else { 24 };
    let states = LAWS.repeat(STATES);
    for (isochoric_law, volume) in states.into_iter().flat_map(|l| VOLUMES.map(|v| (l, v))) {
        let law = law(volume, field).by(isochoric_law);
        let (mu, lambda) = (law.shear_modulus, law.lame_lambda);
        let (nodes, x, phi) = state(&mut random);
        let w: [Vector; 8] = std::array::from_fn(|_| random.vector());
        let w_phi: [f64; 8] = std::array::from_fn(|_| random.unit());
        let shape = ElementGeometry::new(&nodes).unwrap();
        // Without shear modulus the bulk modulus and the field are left.
        let naive = Naive {
            mu: 0.0,
            lambda: lambda + 2.0 / 3.0 * mu,
            electric,
            volume,
            points: gauss(&nodes),
        };
        let all = |x: &[Vector; 8], phi: &[f64; 8]| -> Vec<f64> {
            list(x).into_iter().chain(*phi).take(n).collect()
        };
        let (p, d) = (all(&x, &phi), all(&w, &w_phi));
        let (plain, along) = naive.derivatives(&p, &d, |f| isochoric(isochoric_law, mu, f));
        let (phi, w_phi) = (potentials(phi), potentials(w_phi));
        let name = format!("{isochoric_law:?} {volume:?} {n}");
        let at = NodeState::new(&shape, &x, &phi);
        let energy = law.energy(&at);
        close(&format!("{name} energy"), &[energy], &[plain.value]);
        let (mut local, mut rate) = (Local::default(), Local::default());
        law.gradient(&at, &mut local);
        close(
            &format!("{name} gradient"),
            &flat(&local).gradient,
            &plain.gradient,
        );
        law.tangent(&at, &mut local);
        close_flat(&format!("{name} tangent"), &flat(&local), &plain);
        law.third(&at.along(&w, &w_phi), &mut local, &mut rate);
        close_flat(&format!("{name} third, along"), &flat(&rate), &along);
    }
}

#[test]
fn derivatives_of_passive_isochoric_laws() {
    all_derivatives(Passive, None, |_| ());
}

#[test]
fn derivatives_of_dielectric_isochoric_laws() {
    all_derivatives(DIELECTRIC, Some(DIELECTRIC), |phi| phi);
}

#[test]
fn moduli_of_small_strains_are_those_of_the_neo_hookean_element() {
    let shape = ElementGeometry::new(&cube()).unwrap();
    let mut random = Random(5);
    // Work of homogeneous strains; what else an element can do differs where the mean dilatation has the bulk modulus or λ.
    let strains: Vec<Vec<f64>> = (0..9)
        .map(|_| {
            let map = Matrix::from_fn(|_, _| random.unit());
            list(&cube().map(|x| map * x))
        })
        .collect();
    let works = |hessian: &[Vec<f64>]| -> Vec<f64> {
        let work = |u: &Vec<f64>| {
            let row = |(row, u_r): (&Vec<f64>, &f64)| {
                u_r * row.iter().zip(u).map(|(h, u_c)| h * u_c).sum::<f64>()
            };
            hessian.iter().zip(u).map(row).sum()
        };
        strains.iter().map(work).collect()
    };
    for volume in VOLUMES {
        let neo_hooke = law(volume, Passive);
        let (mut expected, mut local) = (Local::default(), Local::default());
        let x = cube();
        let at = NodeState::new(&shape, &x, &());
        neo_hooke.tangent(&at, &mut expected);
        for isochoric in LAWS {
            let law = neo_hooke.by(isochoric);
            law.tangent(&at, &mut local);
            let name = format!("{isochoric:?} {volume:?}");
            let is_small = |f: &f64| f.abs() < 1e-14;
            assert!(list(&local.forces).iter().all(is_small), "{name}");
            let [found, known] = [&local, &expected].map(|local| works(&flat(local).hessian));
            close(&name, &found, &known);
        }
    }
}

#[test]
fn stress_of_a_stretched_bar_is_that_of_its_energy() {
    let shape = ElementGeometry::new(&cube()).unwrap();
    let stretches = [1.6, 0.8, 0.85];
    for (isochoric_law, volume) in LAWS.into_iter().flat_map(|l| VOLUMES.map(|v| (l, v))) {
        let law = law(volume, Passive).by(isochoric_law);
        let x = cube().map(|x| x.component_mul(&Vector::from(stretches)));
        let found = law.fields(&shape, &x, &()).stress;
        let volume: f64 = stretches.iter().product();
        let mut expected = Matrix::zeros();
        for a in 0..3 {
            let f = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let value = if i == j { stretches[i] } else { 0.0 };
                    Dual64::new(value, f64::from(u8::from(i == a && j == a)))
                })
            });
            let bulk = law.lame_lambda + 2.0 / 3.0 * law.shear_modulus;
            let energy = isochoric(isochoric_law, law.shear_modulus, f)
                + determinant(f).ln().powi(2) * (0.5 * bulk);
            expected[(a, a)] = energy.eps * stretches[a] / volume;
        }
        close(
            &format!("{isochoric_law:?}"),
            found.as_slice(),
            expected.as_slice(),
        );
    }
}

/// Cauchy stress in MPa by tests/reference/fe/laws.py.
const FELUPE: [(IsochoricLaw, [[f64; 3]; 3]); 2] = [
    (
        IsochoricLaw::MooneyRivlin { share: 0.3 },
        [
            [0.798053753338834, 0.376840330649942, -0.416094651599566],
            [0.376840330649942, -0.480438513331945, 0.590597872683916],
            [-0.416094651599566, 0.590597872683916, 0.246231710986117],
        ],
    ),
    (
        IsochoricLaw::Yeoh { c2: -0.3, c3: 0.2 },
        [
            [0.646579621953746, 0.241710741801175, -0.325379844732352],
            [0.241710741801176, -0.283077077281545, 0.362566112701764],
            [-0.325379844732352, 0.362566112701764, 0.200344406320806],
        ],
    ),
];

#[test]
fn stress_is_that_of_felupe() {
    let shape = ElementGeometry::new(&cube()).unwrap();
    let map = Matrix::from([[1.3, 0.1, -0.2], [0.2, 0.8, 0.1], [-0.1, 0.3, 1.1]]);
    for (isochoric, expected) in FELUPE {
        let law = law(Volume::Pointwise, Passive).by(isochoric);
        let found = law.fields(&shape, &cube().map(|x| map * x), &()).stress;
        close(
            &format!("{isochoric:?}"),
            found.as_slice(),
            expected.as_flattened(),
        );
    }
}

#[test]
fn gents_limit_leaves_an_element_no_energy() {
    let shape = ElementGeometry::new(&cube()).unwrap();
    let law = law(Volume::Pointwise, Passive).by(IsochoricLaw::Gent { limit: 1.0 });
    for (stretch, exists) in [(1.5, true), (2.5, false)] {
        let x = cube().map(|x| x.component_mul(&Vector::new(stretch, 1.0, 1.0 / stretch)));
        let mut local = Local::default();
        law.tangent(&NodeState::new(&shape, &x, &()), &mut local);
        let all = flat(&local);
        assert_eq!(all.value.is_finite(), exists);
        assert_eq!(all.gradient.iter().any(|f| f.is_finite()), exists);
        assert_eq!(all.hessian.concat().iter().any(|f| f.is_finite()), exists);
    }
}
