//! Absent effects change no bit.

use crate::common::cases::control;
use crate::common::random::Random;
use crate::common::systems::{GRAVITY, branched};
use crate::trace::with_program;
use proboscis::Signal;
use proboscis::control::BoundaryConditions;
use proboscis::control::problem::{BoundaryState, Control, Limit, Rest};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::model::{FieldPlace, What};
use proboscis::nlp::Nlp;

/// All numbers of a program at a point near its guess: f, ∇f, g, ∇g and the Hessian.
fn numbers(system: &System, control: &Control) -> Vec<f64> {
    with_program(system, control, |program, mut x| {
        let mut random = Random(5);
        x.iter_mut().for_each(|v| *v += 0.05 * random.unit());
        let rows = program.constraints().lower.len();
        let (jacobian, hessian) = (program.jacobian_structure(), program.hessian_structure());
        let mut out = vec![program.objective(&x)];
        let mut take = |count: usize, fill: &mut dyn FnMut(&mut [f64])| {
            let mut values = vec![f64::NAN; count];
            fill(&mut values);
            out.extend(values);
        };
        take(x.len(), &mut |v| program.gradient(&x, v));
        take(rows, &mut |v| program.constraint(&x, v));
        take(jacobian.rows.len(), &mut |v| program.jacobian(&x, v));
        let costates: Vec<f64> = (0..rows).map(|_| random.unit()).collect();
        take(hessian.rows.len(), &mut |v| {
            program.hessian(&x, 0.7, &costates, v);
        });
        assert!(out.iter().all(|v| v.is_finite()));
        out
    })
}

#[test]
fn absent_effects_change_no_bit() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut system = branched();
        system.gravity = None;
        for muscle in &mut system.muscles {
            muscle.material.viscosity = None;
            muscle.section_inertia = false;
        }
        system.joints.iter_mut().for_each(|j| j.damping = None);
        let mut base = control(&system, 3);
        base.coordinates = Some(coordinates);
        let plain = numbers(&system, &base);
        let same = |what: &str, change: &dyn Fn(&mut System, &mut Control)| {
            let (mut system, mut control) = (system.clone(), base.clone());
            change(&mut system, &mut control);
            assert_eq!(
                numbers(&system, &control),
                plain,
                "{what} in {coordinates:?}"
            );
        };
        let differs = |what: &str, change: &dyn Fn(&mut System, &mut Control)| {
            let (mut system, mut control) = (system.clone(), base.clone());
            change(&mut system, &mut control);
            assert_ne!(
                numbers(&system, &control),
                plain,
                "{what} in {coordinates:?}"
            );
        };
        differs("gravity", &|s, _| s.gravity = Some(GRAVITY));
        differs("viscosity", &|s, _| {
            s.muscles[0].material.viscosity = Some(1.0);
        });
        differs("section inertia", &|s, _| {
            s.muscles[0].section_inertia = true;
        });
        differs("mass", &|s, _| s.muscles[0].material.density = None);
        same(
            "a compressibility that a lumped muscle does not read",
            &|s, _| {
                s.muscles[0].material.lame_lambda = Some(3.0);
            },
        );
        same("the section of a muscle without mass", &|s, _| {
            s.muscles[2].section_inertia = true;
        });
        same("the damper of a fixed joint", &|s, _| {
            s.joints[3].damping = Some(5.0);
        });
        same("the field of a passive muscle", &|_, c| {
            c.limits = vec![Limit::below(What::Field(FieldPlace::Muscle(3)), 1e4)];
        });
        same("markers", &|s, _| s.markers.clear());
        let passive = |muscle: usize| {
            let (mut system, control) = (system.clone(), base.clone());
            system.muscles[muscle].material.electric = None;
            numbers(&system, &control)
        };
        for muscle in 0..3 {
            let mut silent = base.clone();
            silent.given.insert(muscle, Signal::Constant(0.0));
            let found = numbers(&system, &silent);
            assert_eq!(found, passive(muscle), "0 V at {muscle} in {coordinates:?}");
            assert_ne!(found, plain);
            // A state of rest that names a voltage of it keeps its electric term.
            let mut volts = vec![0.0; 4];
            volts[muscle] = 300.0;
            silent.start = BoundaryState::RestAtVoltages(volts, Rest::Everything);
            let (model, _) = BoundaryConditions::resolve(&system, &silent, 10.0).unwrap();
            assert!(model.variables.sources().eq(0..3));
        }
        if coordinates == Coordinates::Reduced {
            // Where all pairs meet anyway, an effect of no size adds zeros to the same places.
            same("gravity of no size", &|s, _| {
                s.gravity = Some(GRAVITY * 0.0);
            });
        }
    }
}
