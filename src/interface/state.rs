//! States at the ends of a motion.

use crate::control::problem::{BoundaryState, Rest};
use crate::interface::error::{Result, require, source};
use crate::interface::handle::Handle;
use crate::interface::input::Input;
use crate::model::System;
use crate::model::system::{Joint, Marker};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A state at the start or at the end of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// The reference configuration at rest.
    Reference,
    /// The stable static equilibrium under voltages in V, zero where not named.
    RestAt(Vec<(Input, f64)>),
    /// Joint coordinates in rad or mm, at rest; at a start zero where not named, at a goal free.
    Joints(Vec<(Handle<Joint>, f64)>),
    /// Places of markers in mm, everything at rest; a goal only.
    Markers(Vec<(Handle<Marker>, Vector3<f64>)>),
}

impl State {
    /// The stable static equilibrium under voltages in V, zero where not named.
    pub fn rest_at<I: Into<Input>>(voltages: impl IntoIterator<Item = (I, f64)>) -> Self {
        let voltages = voltages.into_iter();
        Self::RestAt(voltages.map(|(input, v)| (input.into(), v)).collect())
    }

    /// The stable static equilibrium without voltages.
    pub fn rest() -> Self {
        Self::RestAt(Vec::new())
    }

    pub(super) fn resolve(&self, system: &System, sources: usize) -> Result<BoundaryState> {
        Ok(match self {
            Self::Reference => of_joints(BTreeMap::new()),
            Self::RestAt(voltages) => {
                let mut row = vec![0.0; sources];
                for (input, voltage) in voltages {
                    let found = || format!("{voltage} V of {input:?}");
                    require(voltage.is_finite(), "state", found, "a finite voltage")?;
                    row[source(input, system)?] = *voltage;
                }
                BoundaryState::RestAtVoltages(row)
            }
            Self::Joints(values) => {
                for &(joint, value) in values {
                    let joints = &system.joints;
                    let named = joints.get(joint.index());
                    let holds = named.is_some_and(|j| j.has_coordinate()) && value.is_finite();
                    let found = || format!("{value} of joint {}", joint.index());
                    let expected = "a finite value of a joint with one coordinate";
                    require(holds, "state", found, expected)?;
                }
                let values = values.iter().map(|&(joint, value)| (joint.index(), value));
                of_joints(values.collect())
            }
            Self::Markers(places) => {
                for (marker, place) in places {
                    let finite = place.iter().all(|x| x.is_finite());
                    let holds = marker.index() < system.markers.len() && finite;
                    let found = || format!("{:?} of marker {}", place.as_slice(), marker.index());
                    require(holds, "state", found, "a finite place of a marker")?;
                }
                let places = places
                    .iter()
                    .map(|&(marker, place)| (marker.index(), place));
                BoundaryState::Markers {
                    places: places.collect(),
                    rest: Rest::Everything,
                    hold: None,
                }
            }
        })
    }
}

fn of_joints(angles: BTreeMap<usize, f64>) -> BoundaryState {
    BoundaryState::JointAngles {
        angles,
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    }
}
