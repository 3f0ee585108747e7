//! A user-defined component: a hardening spring with the energy `¼ k |r|⁴`, its formula and its term.

use nalgebra::{SVector, Vector3};
use proboscis::prelude::*;
use proboscis::{Element, Energy, Jet, Terms, mid};
use std::sync::Arc;

/// `¼ k |r|⁴` of a span r.
#[derive(Clone, Copy, Debug)]
struct Hardening {
    stiffness: f64,
}

impl Energy<3> for Hardening {
    type Local<const ORDER: usize> = Jet<3, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> Jet<3, ORDER> {
        let square = Jet::dot(0, 0, p, w);
        square * square * (0.25 * self.stiffness)
    }
}

#[derive(Debug)]
struct Cubic {
    at: Attachment,
    energy: Hardening,
}

impl Component for Cubic {
    fn name(&self) -> &str {
        "cubic spring"
    }

    fn points(&self) -> Vec<Attachment> {
        vec![
            Attachment {
                body: None,
                at: Vector3::zeros(),
            },
            self.at,
        ]
    }

    fn is_prestressed(&self) -> bool {
        self.at.at.norm() > 0.0
    }

    fn build(&self, terms: &mut Terms<'_>) {
        let [origin, at] = [self.points()[0], self.at];
        match terms.span(&origin, &at) {
            None => terms.without("cubic elasticity", "its body does not move"),
            Some(span) => terms.add(
                "cubic elasticity",
                "stiffness of",
                "cubic spring",
                Element {
                    energy: self.energy,
                    vectors: [mid(span)],
                    scalars: [],
                },
            ),
        }
    }
}

pub(crate) fn main() -> Result<()> {
    let mut system = System::new("Duffing oscillator");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    let spring: Arc<dyn Component> = Arc::new(Cubic {
        at: Attachment {
            body: Some(cart.index()),
            at: Vector3::zeros(),
        },
        energy: Hardening { stiffness: 1e-3 },
    });
    system.add(spring);
    let motion = Simulation::over(ms(400.0))
        .step(ms(0.5))
        .start(State::Joints(vec![(slide, mm(5.0))]))
        .run(&system)?;
    // The period of x″ = −(k/m) x³ from the amplitude A: 7.4163 √(m/k)/A.
    let period = 7.416_298_709_205_487 * (50.0_f64 / 1e-3).sqrt() / 5.0;
    let x = motion.joint(slide);
    let quarter = x
        .windows(2)
        .position(|pair| pair[0] > 0.0 && pair[1] <= 0.0);
    match quarter {
        Some(k) => println!(
            "a quarter of the period after {} ms, exactly {:.2} ms",
            motion.times()[k + 1],
            period / 4.0
        ),
        None => println!("less than a quarter of the period of {period:.1} ms"),
    }
    assert!(quarter.is_some_and(|k| (motion.times()[k + 1] - period / 4.0).abs() < 0.5));
    Ok(())
}
