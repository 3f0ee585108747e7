//! Controls of robots with prescribed joints: a closed form, and what a start or goal may not contradict.

use crate::loads::{cart, loaded, solved};
use proboscis::control::problem::{BoundaryState, Control, Duration};
use proboscis::math::Signal;
use proboscis::model::system::{Joint, JointKind};
use proboscis::nlp::Status;
use proboscis::workflow::{SolveLimits, optimise};
use proboscis::{Body, System};
use std::ops::ControlFlow;

/// The cart of 1 kg on a base that is carried on by 0.5 m.
pub(crate) fn carried(intervals: usize, coordinates: &str, motion: Signal) -> (System, Control) {
    let (mut system, control) = cart(intervals, &[], coordinates);
    let base = Body {
        name: "base".to_owned(),
        ..system.bodies[0].clone()
    };
    system.bodies.push(base);
    system.joints[0].parent = Some(1);
    system.joints.push(Joint {
        name: "belt".to_owned(),
        motion: Some(motion),
        child: 1,
        kind: JointKind::Prismatic {
            axis: nalgebra::Vector3::x(),
        },
        ..Joint::default()
    });
    (system, control)
}

/// By 0.5 m in a time, from rest to rest.
fn smooth(duration: f64) -> Signal {
    let times: Vec<f64> = (0..=400).map(|k| duration * f64::from(k) / 400.0).collect();
    let part = |time: &f64| {
        let s = time / duration;
        500.0 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    };
    Signal::Table {
        values: times.iter().map(part).collect(),
        times,
    }
}

#[test]
fn a_cart_on_a_belt_costs_what_its_way_in_space_costs() {
    // The motor moves 1 kg by 1 m along the belt, which moves on by 0.5 m: F = m ẍ, 12 (1.5)² N² s.
    for coordinates in ["reduced", "redundant"] {
        let errors = [20, 40].map(|intervals| {
            let (system, control) = carried(intervals, coordinates, smooth(1000.0));
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            let verified = optimum.resimulation.as_ref().expect("it is simulated");
            assert_eq!(verified.failure, None);
            for (k, joints) in optimum.motion.joints.iter().enumerate() {
                let time = 1000.0 * k as f64 / intervals as f64;
                assert!((joints[1] - smooth(1000.0).at(time)).abs() < 1e-9);
            }
            optimum.solution.objective - 27.0
        });
        assert!(
            errors[0].abs() < 0.3 && errors[1].abs() > 1e-6,
            "{errors:?}"
        );
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.2, "{coordinates}: {errors:?}");
    }
}

#[test]
fn starts_and_goals_agree_with_what_is_prescribed() {
    let refused = |system: &System, control: &Control| {
        let limits = SolveLimits::default();
        let found = optimise(system, control, None, limits, &mut |_| {
            ControlFlow::Continue(())
        });
        found.unwrap_err().to_string()
    };
    let (system, control) = carried(20, "reduced", Signal::ramp(0.0, 500.0, 2000.0));
    let error = refused(&system, &control);
    assert!(
        error.contains("\"belt\"") && error.contains("goes on"),
        "{error}"
    );

    let free = |min: f64| Duration::Free {
        min,
        max: 2000.0,
        guess: 1000.0,
    };
    let (system, mut control) = carried(20, "reduced", smooth(1000.0));
    control.duration = free(900.0);
    let error = refused(&system, &control);
    assert!(error.contains("goes on"), "{error}");
    control.goal = BoundaryState::Periodic;
    let error = refused(&system, &control);
    assert!(error.contains("needs a duration that is given"), "{error}");

    let jump = Signal::Ramp {
        from: 0.0,
        to: 500.0,
        start: 700.0,
        duration: 0.0,
    };
    let (system, mut control) = carried(20, "reduced", jump);
    control.goal = BoundaryState::Free;
    control.duration = free(900.0);
    let error = refused(&system, &control);
    assert!(error.contains("jumps at 700 ms"), "{error}");

    let named = |place: &str, value: &str| {
        let changes = [
            r#"scene.joints=[{"name": "shoulder", "revolute": {"axis": [0, 0, 1]}, "parent": "ground",
               "child": "arm", "at": [0, 0, 0], "motion": "30 deg"}]"#
                .to_owned(),
            r#"control.start={"joint_angles": {}}"#.to_owned(),
            format!(r#"control.{place}={{"joint_angles": {{"shoulder": "{value}"}}}}"#),
        ];
        loaded(&changes)
    };
    for place in ["start", "goal"] {
        let (system, control) = named(place, "20 deg");
        let error = refused(&system, &control);
        let words = ["\"shoulder\"", "0.5236 rad there", "found 0.3491 rad"];
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}
