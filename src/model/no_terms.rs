//! Creates an empty collection of terms.

use crate::kinematics::{Pose, Vectors};
use crate::model::analysis::Analysis;
use crate::model::free_parameters::Sought;
use crate::model::presolved::Presolved;
use crate::model::system::System;
use crate::model::terms::{Carriers, Terms};
use crate::model::variables::Variables;

/// Carriers of the bodies of a scene in its presolved system, whose bodies have reference poses.
pub(super) fn carriers<'a>(
    (system, presolved, reference): (&System, &Presolved, &'a [Pose]),
) -> Carriers<'a> {
    let bodies = 0..system.bodies.len();
    let carriers = bodies.map(|body| presolved.carrier(Some(body)));
    Carriers {
        of: carriers.collect(),
        reference,
    }
}

/// No terms, to which those of parts are added.
pub(super) fn no_terms<'a>(
    of @ (system, ..): (&System, &Presolved, &'a [Pose]),
    (analysis, sought): (&Analysis, Sought),
    variables: &'a Variables,
    vectors: &'a mut Vectors,
) -> Terms<'a> {
    let called = (analysis.of_motion, analysis.response, sought);
    Terms::new(carriers(of), system.gravity, called, variables, vectors)
}
