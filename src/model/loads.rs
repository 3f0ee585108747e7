//! Terms of loads: −F e·x on the point of a force, or on the coordinate of a joint.

use crate::energy::DeadLoad;
use crate::functional::Element;
use crate::math::Vector;
use crate::model::components::{Load, LoadPlace};
use crate::model::internal::Internals;
use crate::model::presolved::Presolved;
use crate::model::system::System;
use crate::model::terms::{Terms, mid};

const LOADS: &str = "loads";

/// Returns true if a load acts on something that moves.
pub(super) fn moves(load: &Load, presolved: &Presolved) -> bool {
    match load.on {
        LoadPlace::Point { at, .. } => presolved.carrier(at.body).is_some(),
        LoadPlace::Joint(joint) => presolved.joint(joint).is_some(),
    }
}

/// Terms of the loads of a scene; their inputs are the last ones of `sources`.
pub(super) fn build(
    system: &System,
    presolved: &Presolved,
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    let first = system.first_load();
    for (index, load) in system.components.loads.iter().enumerate() {
        let Some(size) = terms.input(first + index) else {
            terms.without(LOADS, "no load is ever other than 0 on what moves");
            continue;
        };
        let (vector, direction) = match load.on {
            LoadPlace::Point { at, direction } => (terms.point(&at), direction),
            LoadPlace::Joint(joint) => {
                let coordinate = presolved
                    .joint(joint)
                    .and_then(|kept| internals.joint(kept));
                (
                    coordinate.expect("a loaded joint has its coordinate"),
                    Vector::x(),
                )
            }
        };
        let element = Element {
            energy: DeadLoad { direction },
            vectors: [mid(terms.vector(vector))],
            scalars: [size],
        };
        terms.add::<_, 4, 1, 1>(LOADS, "the force of", &load.name, element);
    }
    terms.without(LOADS, "no load");
}
