//! Riccati recursion and the gain that holds, against closed forms and a naive recursion.

use nalgebra::DMatrix;
use proboscis::feedback::{Costs, NotHeld, held_gain, riccati_step, spectral_radius};
use proboscis::math::Random;

fn one(value: f64) -> DMatrix<f64> {
    DMatrix::from_element(1, 1, value)
}

/// x₊ = x + u, Q = R = 1: S = 1 + S − S²/(1 + S), so that S is the golden ratio and K = 1/S.
#[test]
fn golden_ratio() {
    let costs = Costs {
        state: one(1.0),
        inputs: one(1.0),
    };
    let held = held_gain([&one(1.0), &one(1.0)], &costs).unwrap();
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    assert!((held.cost[(0, 0)] - golden).abs() < 1e-14);
    assert!((held.gain[(0, 0)] - 0.618_033_988_7).abs() < 1e-10);
    assert!((held.radius - (2.0 - golden)).abs() < 1e-12);
    assert!((held.open_radius - 1.0).abs() < 1e-12);
    assert!(held.residual < 1e-14);
}

struct Drawn {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    costs: Costs,
}

fn drawn(random: &mut Random, n: usize, m: usize) -> Drawn {
    let mut matrix =
        |rows, columns| DMatrix::from_fn(rows, columns, |_, _| random.between(-1.0, 1.0));
    let (a, b) = (1.5 * matrix(n, n), matrix(n, m));
    let (q, r) = (matrix(n, n), matrix(m, m));
    let costs = Costs {
        state: q.transpose() * q,
        inputs: r.transpose() * r + DMatrix::identity(m, m),
    };
    Drawn { a, b, costs }
}

/// S = Q + Aᵀ S A − Aᵀ S B (R + Bᵀ S B)⁻¹ Bᵀ S A.
fn naive(system: &Drawn, s: &DMatrix<f64>) -> [DMatrix<f64>; 2] {
    let Drawn { a, b, costs } = system;
    let inner = &costs.inputs + b.transpose() * s * b;
    let gain = inner.try_inverse().unwrap() * b.transpose() * s * a;
    let next = &costs.state + a.transpose() * s * a - a.transpose() * s * b * &gain;
    [gain, next]
}

#[test]
fn recursion_as_written_down() {
    let mut random = Random::new(3);
    for (n, m) in [(1, 1), (2, 1), (4, 2), (7, 7), (9, 3)] {
        let system = drawn(&mut random, n, m);
        let mut s = DMatrix::identity(n, n);
        for _ in 0..5 {
            let step = riccati_step([&system.a, &system.b], &system.costs, &s).unwrap();
            let [gain, next] = naive(&system, &s);
            assert!(gain.amax() > 0.0);
            assert!((&step.gain - &gain).amax() < 1e-9 * gain.amax());
            assert!((&step.cost - &next).amax() < 1e-9 * next.amax());
            s = next;
        }
    }
}

/// The limit of the recursion is what doubling finds, and it brings unstable systems to rest.
#[test]
fn doubling_finds_the_limit() {
    let mut random = Random::new(5);
    let mut unstable = 0;
    for (n, m) in [(1, 1), (2, 1), (3, 2), (5, 2), (8, 3), (12, 12)] {
        let system = drawn(&mut random, n, m);
        let held = held_gain([&system.a, &system.b], &system.costs).unwrap();
        let mut s = DMatrix::identity(n, n);
        for _ in 0..20_000 {
            let [_, next] = naive(&system, &s);
            let next = 0.5 * (&next + next.transpose());
            let change = (&next - &s).amax();
            s = next;
            if change < 1e-13 * s.amax() {
                break;
            }
        }
        let [gain, _] = naive(&system, &s);
        assert!((&held.cost - &s).amax() < 1e-8 * s.amax(), "{n} {m}");
        assert!((&held.gain - &gain).amax() < 1e-8 * gain.amax(), "{n} {m}");
        assert!(held.radius < 1.0);
        unstable += usize::from(held.open_radius > 1.0);
        let eigenvalues = system.a.complex_eigenvalues();
        let greatest = eigenvalues.iter().fold(0.0_f64, |a, z| a.max(z.norm()));
        assert!((held.open_radius - greatest).abs() < 1e-9 * greatest);
    }
    assert!(unstable > 3);
}

/// What no input reaches stays as it is: it diverges, or keeps its size.
#[test]
fn no_gain_without_authority() {
    let costs = Costs {
        state: one(1.0),
        inputs: one(1.0),
    };
    let lost = held_gain([&one(1.2), &one(0.0)], &costs).unwrap_err();
    assert_eq!(lost, NotHeld::Unsolved);
    let free = Costs {
        state: one(0.0),
        ..costs
    };
    let NotHeld::Unstable(radius) = held_gain([&one(1.2), &one(1.0)], &free).unwrap_err() else {
        panic!("nothing that costs nothing is steered");
    };
    assert!((radius - 1.2).abs() < 1e-12);
}

#[test]
fn radius_of_powers() {
    let jordan = DMatrix::from_row_slice(2, 2, &[0.9, 1.0, 0.0, 0.9]);
    assert!((spectral_radius(&jordan) - 0.9).abs() < 1e-9);
    let nilpotent = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
    assert_eq!(spectral_radius(&nilpotent), 0.0);
    assert!(spectral_radius(&one(f64::NAN)).is_nan());
}
