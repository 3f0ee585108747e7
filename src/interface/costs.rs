//! What a control problem minimises beside its voltages: squared deviations of markers and joints.

use crate::control::Signal;
use crate::control::problem::{CostFunction, During, QuantityCost};
use crate::interface::control::Control;
use crate::interface::handle::Handle;
use crate::model::Quantity;
use crate::model::system::{Joint, Marker};
use nalgebra::Vector3;

impl Control {
    /// A marker follows functions of time in mm, in the directions x, y and z that have one: minimises ∫ |x − r|² dt in mm² s, with a
    /// weight.
    pub fn track(
        mut self,
        marker: Handle<Marker>,
        along: [Option<Signal>; 3],
        weight: f64,
    ) -> Self {
        let marker = marker.index();
        for (axis, reference) in along.into_iter().enumerate() {
            let quantity = Quantity::MarkerPlace { marker, axis };
            self = self.square(quantity, reference, During::Motion, weight);
        }
        self
    }

    /// The coordinate of a joint follows a function of time in rad or mm: minimises ∫ (θ − r)² dt in rad² s or mm² s, with a weight.
    pub fn track_joint(self, joint: Handle<Joint>, along: impl Into<Signal>, weight: f64) -> Self {
        let quantity = of_joint(joint);
        self.square(quantity, Some(along.into()), During::Motion, weight)
    }

    /// A marker ends near a place in mm: minimises |x − r|² at the end in mm², with a weight.
    pub fn end_near(mut self, marker: Handle<Marker>, place: Vector3<f64>, weight: f64) -> Self {
        let marker = marker.index();
        for (axis, &at) in place.iter().enumerate() {
            let quantity = Quantity::MarkerPlace { marker, axis };
            self = self.square(quantity, Some(at.into()), During::End, weight);
        }
        self
    }

    /// A joint ends near a coordinate in rad or mm: minimises (θ − r)² at the end, with a weight.
    pub fn end_joint_near(self, joint: Handle<Joint>, at: f64, weight: f64) -> Self {
        self.square(of_joint(joint), Some(at.into()), During::End, weight)
    }

    fn square(
        self,
        quantity: Quantity,
        reference: Option<Signal>,
        during: During,
        weight: f64,
    ) -> Self {
        let cost = |reference| QuantityCost {
            quantity,
            weight,
            function: CostFunction::Square { reference },
            during,
        };
        match reference.map(cost) {
            Some(cost) => self.minimise(cost),
            None => self,
        }
    }
}

fn of_joint(joint: Handle<Joint>) -> Quantity {
    let joint = joint.index();
    Quantity::Joint { joint, near: 0.0 }
}
