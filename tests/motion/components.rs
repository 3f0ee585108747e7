//! Springs, tendons and components of other crates: against closed forms, against each other, and as files say them.

use crate::common::{bare, motion, placed, trunk};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{Start, energies, observations};
use proboscis::energy::{Cable, LinearSpring};
use proboscis::functional::{Element, Order, Sample};
use proboscis::model::components::{Other, Spring, Tendon};
use proboscis::model::system::{Attachment, Body, Joint, JointKind, Shape, System};
use proboscis::model::{Analysis, Component, Coordinates, InitiallyMoving, Model, Terms, mid};
use std::f64::consts::TAU;
use std::sync::Arc;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

fn point(body: Option<usize>, x: f64, y: f64, z: f64) -> Attachment {
    Attachment {
        body,
        at: Vector3::new(x, y, z),
    }
}

pub(crate) fn body(name: &str, x: f64) -> Body {
    Body {
        name: name.into(),
        mass: 10.0,
        inertia: [400.0, 500.0, 600.0],
        centre: Vector3::new(x, 0.0, 0.0),
        directors: Matrix3::identity(),
        shape: Shape::None,
    }
}

fn slide(name: &str, child: usize, x: f64) -> Joint {
    Joint {
        name: name.into(),
        kind: JointKind::Prismatic { axis: Vector3::x() },
        parent: None,
        child,
        at: Vector3::new(x, 0.0, 0.0),
        ..Joint::default()
    }
}

/// A mass of 10 g on a slide along x, 30 mm from the end of a spring.
fn oscillator(damping: Option<f64>) -> System {
    let mut system = bare(
        vec![body("mass", 30.0)],
        vec![slide("slide", 0, 30.0)],
        None,
    );
    system.components.springs = vec![Spring {
        name: "spring".into(),
        from: point(None, 0.0, 0.0, 0.0),
        to: point(Some(0), 30.0, 0.0, 0.0),
        stiffness: Some(0.4),
        damping,
        rest_length: 25.0,
    }];
    system
}

pub(crate) fn column(
    model: &Model,
    discrete: &proboscis::dynamics::DiscreteTrajectory,
    name: &str,
) -> Vec<f64> {
    let observed = observations(model, discrete);
    let column = observed.columns.iter().find(|c| c.name == name);
    column.unwrap_or_else(|| panic!("{name}")).values.clone()
}

#[test]
fn a_mass_on_a_spring_swings_as_its_closed_form() {
    for damping in [None, Some(0.5)] {
        for coordinates in BOTH {
            let model = Model::new(oscillator(damping), Some(coordinates), 0.5, &[]).unwrap();
            let z = model.coordinates_at(&[0.0]);
            let start = Start::at_rest(&model, z);
            let discrete = motion(&model, &start, 0.5, 400, &[]);
            // x(t) = 25 + 5 e^(−δt) (cos ωt + δ/ω sin ωt).
            let delta = 0.5 * damping.unwrap_or(0.0) / 10.0;
            let omega = (0.4 / 10.0 - delta * delta).sqrt();
            let exact = |t: f64| {
                let wave = (omega * t).cos() + delta / omega * (omega * t).sin();
                25.0 + 5.0 * (-delta * t).exp() * wave
            };
            let length = column(&model, &discrete, "spring_length");
            let force = column(&model, &discrete, "spring_force");
            assert!(200.0 * omega > 5.0 * TAU, "several periods");
            for (k, &length) in length.iter().enumerate() {
                let t = 0.5 * k as f64;
                // The midpoint rule lags by ωt (ωh)²/12.
                let bound = 1e-3 + 1.5 * 5.0 * omega * t * (omega * 0.5).powi(2) / 12.0;
                assert!((length - exact(t)).abs() < bound, "{t}: {length}");
                assert!((force[k] - 0.4 * (length - 25.0)).abs() < 1e-12);
            }
            let total = column(&model, &discrete, "total_energy");
            let lost = match damping {
                Some(_) => column(&model, &discrete, "dissipated_energy"),
                None => vec![0.0; total.len()],
            };
            let stored = 0.5 * 0.4 * 25.0;
            assert!((total[0] - stored).abs() < 1e-12, "{}", total[0]);
            let balance = total.iter().zip(&lost).map(|(e, d)| (e + d - stored).abs());
            // Between instants energies are interpolated: an error of (ωh)² at most.
            let error = balance.fold(0.0, f64::max);
            assert!(error < 0.01 * stored, "{error} of {stored}");
            if damping.is_some() {
                assert!(lost[400] > 0.9 * stored, "{}", lost[400]);
            }
        }
    }
}

#[test]
fn a_taut_tendon_between_two_points_is_a_spring() {
    let of_spring = oscillator(None);
    let mut of_tendon = of_spring.clone();
    let spring = of_tendon.components.springs.remove(0);
    of_tendon.components.tendons = vec![Tendon {
        name: "tendon".into(),
        through: vec![spring.from, spring.to],
        stiffness: 0.4,
        rest_length: 25.0,
        smoothing: 0.0,
    }];
    let lengths = [&of_spring, &of_tendon].map(|system| {
        let model = Model::new(system.clone(), None, 0.5, &[]).unwrap();
        let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
        // Up to the length without force, where the tendon goes slack.
        let discrete = motion(&model, &start, 0.5, 14, &[]);
        let name = format!("{}_length", system.components.iter().next().unwrap().name());
        column(&model, &discrete, &name)
    });
    let [spring, tendon] = &lengths;
    assert!(spring[14] < 26.5 && spring[14] > 25.0, "{}", spring[14]);
    for (a, b) in spring.iter().zip(tendon) {
        assert!((a - b).abs() < 1e-12 * a, "{a} {b}");
    }
}

#[test]
fn a_slack_tendon_pulls_at_nothing() {
    let mut system = oscillator(None);
    let spring = system.components.springs.remove(0);
    system.components.tendons = vec![Tendon {
        name: "tendon".into(),
        through: vec![spring.from, spring.to],
        stiffness: 0.4,
        rest_length: 31.0,
        smoothing: 0.0,
    }];
    let model = Model::new(system, None, 0.5, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
    let discrete = motion(&model, &start, 0.5, 20, &[]);
    assert_eq!(discrete.z[20], discrete.z[0]);
    assert_eq!(column(&model, &discrete, "tendon_tension"), vec![0.0; 21]);
}

/// Two masses on slides that a tendon joins around an eye of the ground.
fn around_an_eye() -> System {
    let mut system = bare(
        vec![body("near", 20.0), body("far", 60.0)],
        vec![slide("first", 0, 20.0), slide("second", 1, 60.0)],
        None,
    );
    system.components.tendons = vec![Tendon {
        name: "cord".into(),
        through: vec![
            point(Some(0), 20.0, 0.0, 0.0),
            point(None, 40.0, 0.0, 0.0),
            point(Some(1), 60.0, 0.0, 0.0),
        ],
        stiffness: 0.3,
        rest_length: 40.0,
        smoothing: 0.0,
    }];
    system
}

#[test]
fn a_tendon_ties_bodies_around_an_eye_of_the_ground() {
    // The far mass is thrown outwards: the near one follows, though no term has both without the eye.
    let analysis = |body: Option<usize>| Analysis {
        initially_moving: Some(InitiallyMoving {
            bodies: body.into_iter().collect(),
            ..InitiallyMoving::default()
        }),
        ..Analysis::of_motion(0.5)
    };
    let model = Model::for_analysis(around_an_eye(), analysis(Some(1))).unwrap();
    assert_eq!(model.coordinate_count(), 2);
    let start = Start::with_rates(&model, model.coordinates_at(&[0.0; 2]), &[0.0, 1.0]);
    let discrete = motion(&model, &start, 0.5, 60, &[]);
    assert!(discrete.z[60][0] > 1.0, "{:?}", discrete.z[60]);
    // Where nobody throws it nothing moves, and the tendon is no term.
    let model = Model::for_analysis(around_an_eye(), analysis(None)).unwrap();
    assert_eq!(model.coordinate_count(), 0);
    assert!(model.present.is_empty());
    let why = model
        .left_out
        .iter()
        .find(|l| l.term == "tendon elasticity");
    assert_eq!(why.unwrap().why, "no tendon that moves");
    // A prestressed one moves both by itself.
    let mut system = around_an_eye();
    system.components.tendons[0].rest_length = 39.0;
    let model = Model::for_analysis(system, analysis(None)).unwrap();
    assert_eq!(model.coordinate_count(), 2);
    let tendons = model.present.iter().find(|p| p.term == "tendon elasticity");
    assert_eq!(tendons.unwrap().of, ["cord"]);
}

#[test]
fn forces_of_a_path_are_those_of_its_length() {
    // Σ |r| of a tendon over three bodies against differences of its own, at some configuration.
    let mut system = trunk(3);
    let through = vec![
        point(None, 12.0, -30.0, 3.0),
        point(Some(0), 13.0, 20.0, 5.0),
        point(Some(1), 9.0, 75.0, -4.0),
        point(Some(2), 10.0, 120.0, 2.0),
    ];
    system.muscles.clear();
    system.components.tendons = vec![Tendon {
        name: "cord".into(),
        through: through.clone(),
        stiffness: 0.02,
        rest_length: 100.0,
        smoothing: 0.0,
    }];
    let model = Model::new(system.clone(), Some(Coordinates::Reduced), 1.0, &[]).unwrap();
    let energy = |z: &[f64]| {
        let poses = model.poses(&placed(&model, z));
        let places: Vec<Vector3<f64>> = through
            .iter()
            .map(|p| p.place(&poses, |b| system.bodies[b].pose()))
            .collect();
        let length: f64 = places.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
        0.5 * 0.02 * (length - 100.0).powi(2)
    };
    let z = [0.3, -0.4, 0.5];
    let here = placed(&model, &z);
    let told = energies(&model, &here, &here, &[], 1.0).potential;
    assert_eq!(told.len(), 1);
    assert!((told[0] - energy(&z)).abs() < 1e-12 * told[0] && told[0] > 1.0);
    // The forces of an interval of 1 ms that stands, half of them at either end.
    let mut scratch = model.action.scratch(Order::Gradient);
    let (mut a, mut b) = (here.clone(), here.clone());
    for instant in [&mut a, &mut b] {
        instant.forces.fill(Vector3::zeros());
    }
    let interval = Sample::of_interval(&[], 1.0);
    let ends = [&mut a, &mut b];
    model
        .action
        .evaluate_interval(Order::Gradient, ends, &interval, &mut scratch);
    let mut forces = [0.0; 3];
    for instant in [&mut a, &mut b] {
        model.action.map.tangent(instant);
        let mut rows = [0.0; 3];
        model.action.map.rows(instant, &mut rows);
        forces.iter_mut().zip(rows).for_each(|(f, row)| *f += row);
    }
    for i in 0..3 {
        let moved = |d: f64| {
            let mut z = z;
            z[i] += d;
            energy(&z)
        };
        let slope = (moved(1e-4) - moved(-1e-4)) / 2e-4;
        let force = forces[i];
        assert!(slope.abs() > 0.05, "{i}: {slope}");
        assert!(
            (force + slope).abs() < 1e-6 * slope.abs(),
            "{i}: {force} {slope}"
        );
    }
}

/// A component of another crate: a spring of zero length that holds a point of a body at its place.
#[derive(Debug)]
struct Anchor {
    at: Attachment,
}

impl Component for Anchor {
    fn name(&self) -> &str {
        "anchor"
    }

    fn points(&self) -> Vec<Attachment> {
        vec![point(None, 0.0, 0.0, 0.0), self.at]
    }

    fn is_prestressed(&self) -> bool {
        true
    }

    fn build(&self, terms: &mut Terms<'_>) {
        let origin = point(None, 0.0, 0.0, 0.0);
        let Some(span) = terms.span(&origin, &self.at) else {
            return terms.without("anchors", "its body does not move");
        };
        let energy = LinearSpring {
            stiffness: 0.4,
            length: 0.0,
        };
        let element = Element {
            energy,
            vectors: [mid(span)],
            scalars: [],
        };
        terms.add("anchors", "a place of", "anchor", element);
    }
}

#[test]
fn a_component_of_another_crate_works() {
    let mut system = oscillator(None);
    system.components.springs.clear();
    let anchor = Anchor {
        at: point(Some(0), 30.0, 0.0, 0.0),
    };
    system.components.others = vec![Other(Arc::new(anchor))];
    let model = Model::new(system, None, 0.5, &[]).unwrap();
    let anchors = model.present.iter().find(|p| p.term == "anchors");
    assert_eq!(anchors.unwrap().why, "a place of");
    let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
    // Half a period of √(k/m) = 0.2 /ms brings the mass to the other side of the origin.
    let steps = (0.5 * TAU / 0.2 / 0.05).round() as usize;
    let discrete = motion(&model, &start, 0.05, steps, &[]);
    assert!(
        (discrete.z[steps][0] + 60.0).abs() < 0.01,
        "{:?}",
        discrete.z[steps]
    );
}

#[test]
fn the_stiffness_of_a_tendon_grows_over_its_width() {
    let cable = Cable {
        stiffness: 0.4,
        length: 50.0,
        smoothing: 6.0,
    };
    let jumping = Cable {
        smoothing: 0.0,
        ..cable
    };
    // Slack below the width, beyond it the tension of a cable without one.
    assert_eq!(cable.of_length(47.0), [0.0; 4]);
    assert!((cable.of_length(53.0)[1] - jumping.of_length(53.0)[1]).abs() < 1e-14);
    assert_eq!(cable.of_length(60.0)[1..], jumping.of_length(60.0)[1..]);
    // Each is the slope of the one before, also across both ends of the width: central differences of error d²/6.
    let d = 1e-3;
    for i in 0..=80 {
        let length = 46.0 + 0.1 * f64::from(i);
        let [below, here, above] = [-d, 0.0, d].map(|d| cable.of_length(length + d));
        for order in 0..3 {
            let slope = (above[order] - below[order]) / (2.0 * d);
            assert!(
                (slope - here[order + 1]).abs() < 1e-4,
                "{order} at {length}"
            );
        }
    }
    assert!(cable.of_length(50.0)[3] > 0.09);
}
