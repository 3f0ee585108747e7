//! Equilibria as a program in Rust asks for them.

use nalgebra::Vector3;
use proboscis::prelude::*;

/// A cart of 50 g on a slide along x, between the ground and a spring of 200 N/m.
fn cart() -> (System, Handle<Joint>, Handle<Load>) {
    let mut system = System::new("cart");
    let cart = system.add(Body::cuboid([mm(20.0); 3]).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    let spring = Spring::between((GROUND, -X * mm(60.0)), (cart, -X * mm(10.0)));
    system.add(spring.stiffness(n_per_m(200.0)));
    let push = system.add(Load::force(cart, Vector3::zeros(), X));
    (system, slide, push)
}

#[test]
fn a_spring_yields_to_a_force() {
    let (system, slide, push) = cart();
    let still = Equilibrium::new().load(push, 0.4).find(&system).unwrap();
    assert_eq!(still.times(), [0.0]);
    let [x] = still.joint(slide)[..] else {
        panic!("more than one instant")
    };
    let exact = 0.4 / n_per_m(200.0);
    assert!((x - exact).abs() < 1e-9 * exact, "{x} for {exact}");
}

#[test]
fn a_lost_equilibrium_keeps_the_last_one() {
    let rubber = Material::elastomer(kpa(100.0))
        .density(kg_per_m3(1000.0))
        .relative_permittivity(3.0);
    let mut system = System::new("stack");
    let mass = system.add(Body::cuboid([mm(10.0); 3]).mass(g(10.0)).at(Y * mm(45.0)));
    let slide = system.add(Joint::prismatic(Y).between(GROUND, mass));
    let muscle = Muscle::of(&rubber)
        .from(GROUND, Vector3::zeros())
        .to(mass, Y * mm(40.0));
    let muscle = system.add(muscle.section(mm(10.0), mm(10.0)).layer(mm(0.1)));
    let at = |volts: f64| Equilibrium::new().voltage(muscle, volts).find(&system);
    let lost = at(kv(20.0)).unwrap_err();
    let Error::StabilityLost { fraction, motion } = lost else {
        panic!("{lost}")
    };
    assert!(fraction > 0.05 && fraction < 0.95, "{fraction}");
    let critical = kv(20.0) * fraction;
    let short = motion.joint(slide)[0];
    let before = at(0.999 * critical).unwrap().joint(slide)[0];
    assert!(short < before && before < -1.0, "{short} after {before}");
    let beyond = at(1.001 * critical).unwrap_err();
    assert!(matches!(beyond, Error::StabilityLost { .. }), "{beyond}");
}

#[test]
fn what_is_no_number_is_refused() {
    let (system, _, push) = cart();
    let wrong = Equilibrium::new().load(push, f64::NAN).find(&system);
    let text = wrong.unwrap_err().to_string();
    assert!(text.contains("expected a finite number"), "{text}");
}

/// Stretches of an ideal dielectric under 30 V/µm of the published law of one branch: at once, and after a long time.
#[test]
fn a_response_is_instantaneous_or_relaxed() {
    let rubber = |branches: bool| {
        let rubber = Material::elastomer(kpa(100.0)).ideal_dielectric(3.0);
        match branches {
            true => rubber.maxwell(kpa(50.0), ms(100.0)),
            false => rubber,
        }
    };
    let stretched = |branches: bool, response: fn(Equilibrium) -> Equilibrium| {
        let mut system = System::new("stack");
        let mass = system.add(Body::cuboid([mm(10.0); 3]).mass(g(10.0)).at(Y * mm(45.0)));
        let slide = system.add(Joint::prismatic(Y).between(GROUND, mass));
        let muscle = Muscle::of(&rubber(branches)).from(GROUND, Vector3::zeros());
        let muscle = muscle.to(mass, Y * mm(40.0)).layer(um(50.0));
        let muscle = system.add(muscle.section(mm(10.0), mm(10.0)));
        let found = response(Equilibrium::new().voltage(muscle, 1500.0)).find(&system)?;
        Ok::<_, Error>(1.0 + found.joint(slide)[0] / mm(40.0))
    };
    let relaxed = stretched(true, |equilibrium| equilibrium).unwrap();
    let at_once = stretched(true, Equilibrium::instantaneous).unwrap();
    assert!((relaxed - 0.9025085022).abs() < 1e-9, "{relaxed}");
    assert!((at_once - 0.9399464523).abs() < 1e-9, "{at_once}");
    let refused = stretched(false, Equilibrium::instantaneous).unwrap_err();
    let text = refused.to_string();
    assert!(text.contains("a scene with Maxwell branches"), "{text}");
}

#[test]
fn wrong_constants_of_components_are_refused() {
    let (system, ..) = cart();
    let told = |change: &dyn Fn(&mut System)| {
        let mut wrong = system.clone();
        change(&mut wrong);
        wrong.check().unwrap_err().to_string()
    };
    assert_eq!(system.check(), Ok(()));
    let spring = |change: fn(&mut Spring)| {
        told(&|system: &mut System| change(&mut system.components.springs[0]))
    };
    let wrong = "springs.spring1.stiffness: found -1, expected zero or a positive value";
    assert_eq!(spring(|s| s.stiffness = Some(-1.0)), wrong);
    assert!(spring(|s| s.damping = Some(f64::NAN)).contains("spring1.damping: found NaN"));
    assert!(spring(|s| s.rest_length = -2.0).contains("zero or a positive length"));
    assert!(spring(|s| s.to.at = s.from.at).contains("spring1.to.at: found the place of"));
    let twin = |system: &mut System| {
        let twin = system.components.springs[0].clone();
        system.components.springs.push(twin);
    };
    assert!(told(&twin).contains("springs.spring1.name: found \"spring1\" a second time"));

    let tendon = |change: fn(&mut Tendon)| {
        told(&|system: &mut System| {
            let spring = system.components.springs[0].clone();
            let mut tendon = Tendon {
                name: "cable".to_owned(),
                through: vec![spring.from, spring.to],
                stiffness: 1.0,
                rest_length: 50.0,
                smoothing: 0.0,
            };
            change(&mut tendon);
            system.components.tendons.push(tendon);
        })
    };
    assert!(tendon(|t| t.stiffness = 0.0).contains("cable.stiffness: found 0"));
    assert!(tendon(|t| t.rest_length = f64::INFINITY).contains("cable.rest_length: found inf"));
    assert!(tendon(|t| t.smoothing = 101.0).contains("twice the rest length"));
    assert!(tendon(|t| t.through.truncate(1)).contains("2 points or more"));
    assert!(tendon(|t| t.through[1] = t.through[0]).contains("the point before"));
}
