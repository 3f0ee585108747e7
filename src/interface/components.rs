//! Springs, tendons, loads and components of other crates, built with defaults.

use crate::interface::builder::builder;
use crate::interface::handle::{Carrier, Handle, Part, named};
use crate::interface::parts::attachment;
use crate::model::components::{
    BlockLoad, Components, Faces, Kind, Load, LoadPlace, Other, Spring,
};
use crate::model::system::{Body, Joint, Muscle, Solid};
use crate::model::{Component, System};
use nalgebra::Vector3;
use std::sync::Arc;

impl Spring {
    /// A spring between two points in mm, without force in the reference configuration, without stiffness or damping so far.
    pub fn between(
        from: (impl Into<Carrier>, Vector3<f64>),
        to: (impl Into<Carrier>, Vector3<f64>),
    ) -> Self {
        Self {
            name: String::new(),
            rest_length: (to.1 - from.1).norm(),
            from: attachment(from.0, from.1),
            to: attachment(to.0, to.1),
            stiffness: None,
            damping: None,
        }
    }
}

builder! {
    impl Spring;
    /// Stiffness in N/mm.
    stiffness(stiffness: f64) |of| of.stiffness = Some(stiffness);
    /// Damping in N ms/mm.
    damping(damping: f64) |of| of.damping = Some(damping);
    /// Length without force in mm.
    rest_length(rest_length: f64) |of| of.rest_length = rest_length;
}

impl<K: Kind> Part for K
where
    Components: AsMut<Vec<K>>,
{
    fn join(mut self, system: &mut System) -> usize {
        let parts: &mut Vec<K> = system.components.as_mut();
        let name = std::mem::take(self.name_mut());
        *self.name_mut() = named(name, K::NAME, parts.len());
        parts.push(self);
        parts.len() - 1
    }
}

impl Load {
    /// A force at a point of a body in mm, along a direction that does not turn.
    pub fn force(body: Handle<Body>, at: Vector3<f64>, direction: Vector3<f64>) -> Self {
        Self::at_point(body, at, direction, false)
    }

    /// A force at a point of a body in mm, along a direction that turns with the body.
    pub fn following_force(body: Handle<Body>, at: Vector3<f64>, direction: Vector3<f64>) -> Self {
        Self::at_point(body, at, direction, true)
    }

    fn at_point(
        body: Handle<Body>,
        at: Vector3<f64>,
        direction: Vector3<f64>,
        follows: bool,
    ) -> Self {
        Self::on(LoadPlace::Point {
            at: attachment(body, at),
            direction: direction.normalize(),
            follows,
        })
    }

    /// A traction on faces of a solid (see [`Mesh::faces_of`](crate::mesh::Mesh::faces_of)), along a direction that does not turn.
    pub fn traction(solid: Handle<Solid>, faces: Faces, direction: Vector3<f64>) -> Self {
        Self::on_block(solid, BlockLoad::Traction(faces, direction.normalize()))
    }

    /// A pressure on faces of a solid, which follows them as they deform.
    pub fn pressure(solid: Handle<Solid>, faces: Faces) -> Self {
        let follows = true;
        Self::on_block(solid, BlockLoad::Pressure { faces, follows })
    }

    /// A pressure on faces of a solid as they are in the reference configuration.
    pub fn dead_pressure(solid: Handle<Solid>, faces: Faces) -> Self {
        let follows = false;
        Self::on_block(solid, BlockLoad::Pressure { faces, follows })
    }

    /// A surface charge on faces of a solid.
    pub fn charge(solid: Handle<Solid>, faces: Faces) -> Self {
        Self::on_block(solid, BlockLoad::Charge(faces))
    }

    /// A body force of a solid, along a direction that does not turn.
    pub fn body_force(solid: Handle<Solid>, direction: Vector3<f64>) -> Self {
        Self::on_block(solid, BlockLoad::BodyForce(direction.normalize()))
    }

    fn on_block(solid: Handle<Solid>, load: BlockLoad) -> Self {
        let block = solid.index();
        Self::on(LoadPlace::Block { block, load })
    }

    fn on(on: LoadPlace) -> Self {
        let name = String::new();
        Self { name, on }
    }

    /// A motor: a torque about the axis of a revolute joint, or a force along that of a prismatic one, from the parent on the child.
    pub fn motor(joint: Handle<Joint>) -> Self {
        Self::on(LoadPlace::Joint(joint.index()))
    }

    /// The charge of a lumped muscle, in place of a voltage.
    pub fn charge_of(muscle: Handle<Muscle>) -> Self {
        Self::on(LoadPlace::Muscle(muscle.index()))
    }
}

impl Part for Arc<dyn Component> {
    fn join(self, system: &mut System) -> usize {
        let others = &mut system.components.others;
        others.push(Other(self));
        others.len() - 1
    }
}
