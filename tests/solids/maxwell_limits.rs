//! Maxwell branches of finite elements: short and long relaxation times, states of rest, memory.

use crate::maxwell::{
    BRANCHES, EDGE, LAMBDAS, MODULUS, cube, equilibrium_of, extrapolated, from_reference, height,
    input, length, model, motion, rubber, slider,
};
use proboscis::dynamics::{Integrator, Start, stable_equilibrium};
use proboscis::model::Response;
use proboscis::model::system::Material;

#[test]
fn a_branch_that_relaxes_at_once_is_viscosity_and_one_that_never_does_is_elasticity() {
    let (stress, lambda, h, steps) = (0.06, 400.0, 0.1, 60);
    let ramp = h * f64::from(steps);
    let after = |material: Material| {
        let model = model(&cube(material), h);
        let start = from_reference(&model);
        let grid = (h, steps as usize);
        let midpoint = Integrator::default();
        let discrete = motion((&model, &start), grid, (stress, ramp), midpoint);
        height(&model, discrete.z.last().unwrap())
    };
    let rest = |response| {
        let system = cube(rubber(lambda, &[[0.05, 1.0]]));
        let (model, z) = equilibrium_of(&system, stress, response);
        height(&model, &z)
    };
    let [relaxed, at_once] = [Response::Relaxed, Response::Instantaneous].map(rest);
    assert!(relaxed - at_once > 0.05, "{relaxed} {at_once}");
    let short = [0.4, 0.2, 0.1].map(|tau| {
        let viscous = Material {
            viscosity: Some(2.0 * 0.05 * tau),
            ..rubber(lambda, &[])
        };
        let (alike, branch) = (after(viscous), after(rubber(lambda, &[[0.05, tau]])));
        let lag = relaxed - alike;
        assert!(
            lag > 10.0 * (branch - alike).abs(),
            "{relaxed} {alike} {branch}"
        );
        (branch - alike).abs()
    });
    for pair in short.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{short:?}");
    }
    let long = [1e3, 2e3, 4e3].map(|tau| (after(rubber(lambda, &[[0.05, tau]])) - at_once).abs());
    assert!(long[2] > 1e-6, "{long:?}");
    for pair in long.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "{long:?}");
    }
}

#[test]
fn rest_is_relaxed_or_instantaneous() {
    let list = [[0.05, 8.0], [0.03, 60.0]];
    let stress = 0.07;
    let [relaxed, at_once] = [Response::Relaxed, Response::Instantaneous].map(|response| {
        let (model, z) =
            equilibrium_of(&slider(rubber(1.0, &list)), stress * EDGE * EDGE, response);
        let lumped = length(&model, &z);
        // P = μ (Λ − Λ⁻²) of the moduli that carry.
        let mu = match response {
            Response::Relaxed => MODULUS,
            Response::Instantaneous => MODULUS + 0.08,
        };
        assert!((mu * (lumped - lumped.powi(-2)) - stress).abs() < 1e-10);
        let cubes = LAMBDAS.map(|lambda| {
            let (model, z) = equilibrium_of(&cube(rubber(lambda, &list)), stress, response);
            vec![height(&model, &z)]
        });
        let limit = extrapolated(cubes.to_vec())[0];
        assert!((limit - lumped).abs() < 1e-10, "{limit} {lumped}");
        lumped
    });
    assert!(relaxed - at_once > 0.1, "{relaxed} {at_once}");
}

#[test]
fn a_state_of_rest_is_one_of_the_motion_and_is_remembered() {
    let system = cube(rubber(0.4, &BRANCHES));
    let (resting, z) = equilibrium_of(&system, 0.07, Response::Relaxed);
    let expected = height(&resting, &z);
    let model = model(&system, 1.0);
    let inputs = model.scalars(&input(&model, 0.07, 1.0));
    let found = stable_equilibrium(&model, &model.reference_coordinates(), &inputs).unwrap();
    assert!((height(&model, &found.z) - expected).abs() < 1e-9);
    assert!(expected > 1.2);
    let at = model.action.map.internal();
    assert_eq!(at.len(), 2 * 8 * 5);
    // It stays there, and what it remembers is that of the places of the nodes.
    let discrete = motion(
        (&model, &Start::at_rest(&model, found.z.clone())),
        (1.0, 20),
        (0.07, 1e-9),
        Integrator::default(),
    );
    for (a, b) in discrete.z.last().unwrap().iter().zip(&found.z) {
        assert!((a - b).abs() < 1e-8, "{a} {b}");
    }
    assert!(found.z[at.clone()].iter().any(|q| q.abs() > 0.1));
}

#[test]
fn a_motion_goes_on_from_its_end_with_what_it_remembers() {
    let system = cube(rubber(0.4, &BRANCHES));
    let model = model(&system, 0.5);
    let (load, midpoint) = ((0.06, 10.0), Integrator::default());
    let whole = motion((&model, &from_reference(&model)), (0.5, 40), load, midpoint);
    let first = motion((&model, &from_reference(&model)), (0.5, 20), load, midpoint);
    // The load has grown.
    let load = (0.06, 1e-9);
    let (z, momenta) = (first.z.last().unwrap(), first.momenta.last().unwrap());
    let start = Start::moving(&model, z.clone(), momenta.clone());
    let second = motion((&model, &start), (0.5, 20), load, midpoint);
    let [a, b] = [&whole, &second].map(|motion| motion.z.last().unwrap());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    // Without memory it would go another way.
    let mut forgotten = z.clone();
    forgotten[model.action.map.internal()].fill(0.0);
    let start = Start::moving(&model, forgotten, momenta.clone());
    let other = motion((&model, &start), (0.5, 20), load, midpoint);
    let apart = height(&model, a) - height(&model, other.z.last().unwrap());
    assert!(apart.abs() > 1e-3, "{apart}");
}
