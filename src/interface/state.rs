//! States at the ends of a motion.

use crate::control::problem::{BoundaryState, Orientation, Place, Rest};
use crate::interface::error::{Entry, Result, row};
use crate::interface::handle::{Handle, Input};
use crate::math::refuse;
use crate::model::System;
use crate::model::system::{Body, Joint, Marker};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A state at the start or at the end of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// The reference configuration at rest.
    Reference,
    /// The stable static equilibrium under voltages in V and loads in N or N mm, zero where not named.
    RestAt(Vec<(Input, f64)>),
    /// Joint coordinates in rad or mm, at rest; at a start zero where not named, at a goal free.
    Joints(Vec<(Handle<Joint>, f64)>),
    /// Joint coordinates in rad or mm, and rates in rad/ms or mm/ms; at a start zero where not named, at a goal of all joints.
    Moving(Vec<(Handle<Joint>, f64, f64)>),
    /// Places of markers in mm, everything at rest; a goal only.
    Markers(Vec<(Handle<Marker>, Vector3<f64>)>),
    /// Places of markers in mm, in the directions that have one, and orientations of bodies, everything at rest; a goal only.
    Places {
        /// Places.
        markers: Vec<(Handle<Marker>, [Option<f64>; 3])>,
        /// Orientations.
        bodies: Vec<(Handle<Body>, Orientation)>,
    },
    /// Anything, in motion or at rest; a goal only.
    Free,
    /// The start, which is sought: the motion is periodic, and its [`Control::start`](crate::interface::Control::start) is where the solver
    /// begins; a goal only.
    Periodic,
}

impl State {
    /// The stable static equilibrium under voltages in V and loads in N or N mm, zero where not named.
    pub fn rest_at<I: Into<Input>>(voltages: impl IntoIterator<Item = (I, f64)>) -> Self {
        let voltages = voltages.into_iter();
        Self::RestAt(voltages.map(|(input, v)| (input.into(), v)).collect())
    }

    /// The stable static equilibrium without voltages.
    pub fn rest() -> Self {
        Self::RestAt(Vec::new())
    }

    pub(super) fn resolve(&self, system: &System) -> Result<BoundaryState> {
        Ok(match self {
            Self::Reference => BoundaryState::at_joints(BTreeMap::new()),
            Self::RestAt(voltages) => {
                let row = row(voltages, "state", system)?;
                BoundaryState::RestAtVoltages(row, Rest::Everything)
            }
            Self::Joints(values) => BoundaryState::at_joints(of_joints(values, system)?),
            Self::Moving(values) => {
                let angles = values.iter().map(|&(joint, value, _)| (joint, value));
                let rates = values.iter().map(|&(joint, _, rate)| (joint, rate));
                BoundaryState::JointAngles {
                    angles: of_joints(&Vec::from_iter(angles), system)?,
                    rates: of_joints(&Vec::from_iter(rates), system)?,
                    velocities: BTreeMap::new(),
                }
            }
            Self::Free => BoundaryState::Free,
            Self::Periodic => BoundaryState::Periodic,
            Self::Places { markers, bodies } => {
                for (marker, place) in markers {
                    let finite = place.iter().flatten().all(|x| x.is_finite());
                    refuse!(unless marker.index() < system.markers.len() && finite, Entry("state");
                        found format!("{place:?} of marker {}", marker.index()),
                        expected "a finite place of a marker");
                }
                for (body, orientation) in bodies {
                    let holds = body.index() < system.bodies.len() && orientation.is_sound();
                    refuse!(unless holds, Entry("state");
                        found format!("{orientation:?} of body {}", body.index()),
                        expected "unit vectors and a finite angle");
                }
                let places = markers.iter().map(|&(m, place)| (m.index(), Place(place)));
                let turned = bodies.iter().map(|&(b, turned)| (b.index(), turned));
                at_places(places.collect(), turned.collect())
            }
            Self::Markers(places) => {
                for (marker, place) in places {
                    let finite = place.iter().all(|x| x.is_finite());
                    refuse!(unless marker.index() < system.markers.len() && finite, Entry("state");
                        found format!("{:?} of marker {}", place.as_slice(), marker.index()),
                        expected "a finite place of a marker");
                }
                let places = places.iter().map(|&(m, place)| (m.index(), place.into()));
                at_places(places.collect(), BTreeMap::new())
            }
        })
    }
}

/// Finite values by joints that have one coordinate.
fn of_joints(values: &[(Handle<Joint>, f64)], system: &System) -> Result<BTreeMap<usize, f64>> {
    for &(joint, value) in values {
        let named = system.joints.get(joint.index());
        let holds = named.is_some_and(Joint::has_coordinate) && value.is_finite();
        refuse!(unless holds, Entry("state");
            found format!("{value} of joint {}", joint.index()),
            expected "a finite value of a joint with one coordinate");
    }
    let values = values.iter();
    Ok(values
        .map(|&(joint, value)| (joint.index(), value))
        .collect())
}

/// Everything at rest, at places of markers and orientations of bodies.
fn at_places(
    places: BTreeMap<usize, Place>,
    orientations: BTreeMap<usize, Orientation>,
) -> BoundaryState {
    BoundaryState::Markers {
        places,
        orientations,
        rest: Rest::Everything,
        hold: None,
    }
}
