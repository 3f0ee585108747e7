//! Prestretched lumped muscles against the closed forms of an incompressible cell.

use nalgebra::Vector3;
use proboscis::dynamics::stable_equilibrium;
use proboscis::model::Model;
use proboscis::model::system::ElectricConstants;
use proboscis::prelude::*;

/// Distance of the ends of a muscle in mm.
const DISTANCE: f64 = 40.0;
/// Sides of the cross-section and thickness of a layer at rest in mm.
const SIDE: f64 = 10.0;
const LAYER: f64 = 0.05;
/// Shear modulus in MPa, and permittivity of a relative one of 3 in N/V².
const MODULUS: f64 = 0.1;
const PERMITTIVITY: f64 = 3.0 * 8.8541878128e-12;

/// Tension in N of a cell that was `prestretch` times as long as at rest when its ends were r = 40 mm apart.
fn tension(prestretch: f64, r: f64, volts: f64) -> f64 {
    let stretch = prestretch * r / DISTANCE;
    let field = volts / LAYER;
    let stress = MODULUS * (stretch - stretch.powi(-2));
    SIDE * SIDE * (stress + PERMITTIVITY * field * field * stretch.powi(-3))
}

/// The root of a falling function between two points.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    assert!(f(low) > 0.0 && f(high) < 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match f(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

fn muscle(prestretch: f64) -> Muscle {
    let rubber = Material {
        electric: Some(ElectricConstants::ideal(3.0)),
        ..Material::elastomer(MODULUS)
    };
    let muscle = Muscle::of(&rubber).section(SIDE, SIDE).layer(LAYER);
    muscle.prestretch(prestretch)
}

/// A mass on a slide along x at the end of a muscle.
fn slider(prestretch: f64) -> (System, Handle<Body>, Handle<Joint>, Handle<Muscle>) {
    let mut system = System::new("slider");
    let mass = system.add(Body::cuboid([mm(20.0); 3]).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, mass));
    let muscle = muscle(prestretch).from(GROUND, -X * DISTANCE);
    let muscle = system.add(muscle.to(mass, Vector3::zeros()));
    (system, mass, slide, muscle)
}

#[test]
fn antagonists_rest_and_are_as_stiff_as_their_closed_form() {
    for prestretch in [1.0, 1.3, 2.0] {
        let (mut system, mass, slide, left) = slider(prestretch);
        let right = muscle(prestretch).from(GROUND, X * DISTANCE);
        system.add(right.to(mass, Vector3::zeros()));
        let volts = 1500.0;
        let pull = |x: f64| {
            tension(prestretch, DISTANCE - x, 0.0) - tension(prestretch, DISTANCE + x, volts)
        };
        let exact = root(-20.0, 0.0, pull);
        assert!(exact < -0.1, "{exact}");
        let still = Equilibrium::new().voltage(left, volts).find(&system);
        let found = still.unwrap().joint(slide)[0];
        assert!(
            (found - exact).abs() < 1e-10 * DISTANCE,
            "{found} for {exact}"
        );

        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let scalars = model.scalars(&[volts, 0.0]);
        let rest = stable_equilibrium(&model, &model.reference_coordinates(), &scalars).unwrap();
        // d/dx of the naive tensions, by a step at which rounding and truncation are below 1e-10.
        let step = 1e-2;
        let slope = |h: f64| (pull(exact - h) - pull(exact + h)) / (2.0 * h);
        let stiffness = (64.0 * slope(step) - 20.0 * slope(2.0 * step) + slope(4.0 * step)) / 45.0;
        let error = (rest.stiffness[0] - stiffness).abs();
        assert!(
            stiffness > 1.0 && error < 1e-9 * stiffness,
            "{error} of {stiffness}"
        );
    }
}

/// Nothing but their prestretch sets passive muscles in motion.
#[test]
fn unequal_passive_antagonists_pull_their_mass_to_one_side() {
    let stretches = [1.5, 1.2];
    let mut system = System::new("passive");
    let mass = system.add(Body::cuboid([mm(20.0); 3]).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, mass));
    for (side, stretch) in [-X, X].into_iter().zip(stretches) {
        let passive = Muscle {
            material: Material::elastomer(MODULUS),
            ..muscle(stretch)
        };
        let passive = passive.from(GROUND, side * DISTANCE);
        system.add(passive.to(mass, Vector3::zeros()));
    }
    let pull = |x: f64| {
        let [left, right] = stretches;
        tension(right, DISTANCE - x, 0.0) - tension(left, DISTANCE + x, 0.0)
    };
    let exact = root(-20.0, 0.0, pull);
    assert!(exact < -1.0, "{exact}");
    let found = Equilibrium::new().find(&system).unwrap().joint(slide)[0];
    assert!(
        (found - exact).abs() < 1e-10 * DISTANCE,
        "{found} for {exact}"
    );

    // From the reference configuration the mass falls towards it.
    let run = Simulation::over(0.1).step(0.01).start(State::Reference);
    let fall = *run.run(&system).unwrap().joint(slide).last().unwrap();
    let exact = 0.5 * pull(0.0) / g(50.0) * 0.1 * 0.1;
    assert!(exact < -1e-4, "{exact}");
    assert!(
        (fall - exact).abs() < 1e-3 * exact.abs(),
        "{fall} for {exact}"
    );
}

/// A dead load P keeps the prestretch p: P/A = μ (p − p⁻²). The field (V/t)² = (P/A − μ (λ − λ⁻²)) λ³/ε is largest where
/// 4 λ³ − 3 (p − p⁻²) λ² = 1.
#[test]
fn pull_in_depends_on_prestretch_as_the_closed_form_says() {
    let mut before = 0.0;
    for prestretch in [1.0, 1.2, 1.5, 2.0] {
        let (mut system, mass, _, muscle) = slider(prestretch);
        let push = system.add(Load::force(mass, Vector3::zeros(), X));
        let load = prestretch - f64::powi(prestretch, -2);
        let stretch = root(0.1, prestretch, |s| {
            1.0 + 3.0 * load * s * s - 4.0 * s.powi(3)
        });
        let squared = (load - (stretch - stretch.powi(-2))) * stretch.powi(3);
        let exact = LAYER * (MODULUS * squared / PERMITTIVITY).sqrt();
        let force = SIDE * SIDE * MODULUS * load;
        let at = |volts: f64| {
            let inputs = Equilibrium::new().voltage(muscle, volts);
            inputs.load(push, force).find(&system)
        };
        assert!(exact > before, "{exact} V at {prestretch}");
        before = exact;
        at(exact * (1.0 - 1e-6)).unwrap();
        let beyond = at(exact * (1.0 + 1e-6));
        assert!(matches!(beyond, Err(Error::StabilityLost { .. })));
    }
}

#[test]
fn a_prestretch_that_is_none_is_refused() {
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let (system, ..) = slider(wrong);
        let text = Equilibrium::new().find(&system).unwrap_err().to_string();
        assert!(text.contains("prestretch"), "{text}");
    }
}
