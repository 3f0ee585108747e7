//! Loads: forces at points and on joint coordinates whose size is an input, given in time or sought.

use crate::energy::DeadLoad;
use crate::functional::Element;
use crate::math::Vector;
use crate::model::attachment::Attachment;
use crate::model::internal::Internals;
use crate::model::presolved::Presolved;
use crate::model::system::{InputKind, JointKind, System};
use crate::model::terms::{Terms, mid};

const LOADS: &str = "loads";

/// A force or torque on the system.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Unique name, that of its input.
    pub name: String,
    /// Place where it acts.
    pub on: LoadPlace,
}

/// Place where a load acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadPlace {
    /// A force in N at a point of a body, along a direction that does not turn.
    Point {
        /// Point.
        at: Attachment,
        /// Unit vector in the ground frame.
        direction: Vector,
    },
    /// A torque in N mm about the axis of a revolute joint, or a force in N along that of a prismatic one, from the parent on the child:
    /// a motor.
    Joint(usize),
}

impl Load {
    /// Physical kind of its size.
    pub fn kind(&self, system: &System) -> InputKind {
        match self.on {
            LoadPlace::Joint(joint)
                if !matches!(system.joints[joint].kind, JointKind::Prismatic { .. }) =>
            {
                InputKind::Torque
            }
            _ => InputKind::Force,
        }
    }

    /// Bodies on which it acts.
    pub fn bodies(&self, system: &System) -> Vec<usize> {
        match self.on {
            LoadPlace::Point { at, .. } => at.body.into_iter().collect(),
            LoadPlace::Joint(joint) => {
                let joint = &system.joints[joint];
                joint.parent.into_iter().chain([joint.child]).collect()
            }
        }
    }

    /// Returns true if it acts on something that moves.
    pub(in crate::model) fn moves(&self, presolved: &Presolved) -> bool {
        match self.on {
            LoadPlace::Point { at, .. } => presolved.carrier(at.body).is_some(),
            LoadPlace::Joint(joint) => presolved.joint(joint).is_some(),
        }
    }
}

/// Terms of the loads of a scene; their inputs are the last ones of `sources`.
pub(in crate::model) fn build(
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
