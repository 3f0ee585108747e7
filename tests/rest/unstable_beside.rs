//! States of rest beside unstable ones: buckled blocks of finite elements, and blocks under pressure that follows their faces.

use crate::common::random::Random;
use crate::stable::{file, model, reference, scene};
use nalgebra::Vector3;
use proboscis::control::problem::Task;
use proboscis::dynamics::{Equilibrium, Route, stable_equilibrium};
use proboscis::files::read_problem;
use proboscis::model::Model;
use serde_json::{Value, json};

/// The place of the first marker in mm.
fn tip(model: &Model, rest: &Equilibrium) -> Vector3<f64> {
    model.action.map.placed(&rest.z).x[model.markers[0]]
}

/// The rest of a problem file.
fn of_file(name: &str) -> (Model, Equilibrium) {
    let loaded = read_problem(&file(name), &[]).unwrap();
    let Task::Equilibrium(task) = loaded.task else {
        panic!("{name} asks for no equilibrium");
    };
    let model = model(loaded.system);
    let found = stable_equilibrium(&model, &reference(&model), &model.scalars(&task.voltages));
    (model, found.unwrap())
}

/// The symmetric part of its stiffness is not positive definite, and still all eigenvalues of the stiffness are positive.
#[test]
fn a_block_under_following_pressure_is_stable_by_the_eigenvalues_of_its_stiffness() {
    let (_, found) = of_file("12_following_pressure_stable");
    assert!(found.may_flutter);
    assert_eq!((found.is_stable(), found.route), (Some(true), Route::Loads));
}

/// The place that a damped motion of another program reaches.
#[test]
fn a_block_under_following_pressure_rests_beside_an_unstable_state() {
    let (model, found) = of_file("12_following_pressure_rests_aside");
    assert_eq!(found.is_stable(), Some(true));
    let away = tip(&model, &found) - Vector3::new(39.0886, -1.6879, 9.4646);
    assert!(away.norm() < 1e-3, "{away}");
}

/// A slender block of one element across that stands on its lower face, with its weight as a multiple of that at which a clamped beam buckles,
/// and a part of it that pulls aside.
fn column(random: &mut Random, aside: f64) -> (Value, f64) {
    let length = 0.05 * random.between(0.5, 2.0);
    let thickness = length / random.between(20.0, 35.0);
    let width = thickness * random.between(2.0, 10.0);
    let (shear, poisson) = (1e5 * random.between(0.5, 2.0), random.between(0.3, 0.45));
    let modulus = 2.0 * shear * (1.0 + poisson);
    // Greenhill: ρ g A L³ = 7.837 E I; elements of this shape are stiffer.
    let critical = 7.837 * modulus * thickness.powi(2) / (12.0 * length.powi(3));
    let weight = critical * random.between(3.0, 6.0) / 1000.0;
    let scene = json!({
        "name": "column",
        "materials": { "soft": { "density": 1000, "shear_modulus": shear, "poisson_ratio": poisson } },
        "solids": [{ "name": "strip", "element": "hex8_q1p0", "material": "soft",
            "box": { "size": [width, thickness, length], "elements": [1, 1, 14] }, "fixed": ["z_min"] }],
        "gravity": [0, aside * weight, -weight],
        "markers": [{ "name": "tip", "solid": "strip", "at": [0, 0, length] }]
    });
    (scene, 1e3 * length)
}

/// A thousandth of the weight that pulls aside leads to the same state along the path of growing weight, which then turns from no symmetry.
#[test]
fn a_column_of_elements_beyond_buckling_rests_bent() {
    let mut buckled = 0;
    for seed in 1..=6 {
        let rest = |aside: f64| {
            let (written, length) = column(&mut Random(seed), aside);
            let model = model(scene(&written));
            let none = model.scalars(&vec![0.0; model.sources.len()]);
            let found = stable_equilibrium(&model, &reference(&model), &none).unwrap();
            (tip(&model, &found), found, length)
        };
        let (upright, found, length) = rest(0.0);
        assert_eq!(found.is_stable(), Some(true), "{seed}");
        buckled += usize::from(matches!(found.route, Route::DampedMotion(_)));
        let side = upright.y.signum();
        let (pulled, beside, _) = rest(1e-3 * side);
        assert_eq!(beside.is_stable(), Some(true), "{seed}");
        let apart = (upright - pulled).norm() / length;
        println!(
            "{seed}: {:?} {:.4} of its length, {apart:.1e} apart",
            found.route,
            upright.y / length
        );
        assert!(apart < 2e-2, "{seed}: {upright} {pulled}");
    }
    assert!(buckled >= 4, "{buckled}");
}
