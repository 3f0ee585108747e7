//! Loads as they are written, and their conversion.

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::names::names;
use crate::files::scene::nodes::nodes;
use crate::files::scene::point::{CornersSpec, PointSpec, unit_axis};
use crate::files::scene::spec_solids::PlaneSpec;
use crate::math::Vector;
use crate::model::components::{BlockLoad, Faces, Load, LoadPlace};
use crate::model::system::{Joint, Muscle, Solid, Support};

objects! {
    /// A load, whose size a problem gives or seeks: a force at a `point`, a torque or force of a `joint`, such as that of a motor, the charge
    /// of a `muscle`, or a load of a `solid`.
    pub struct LoadSpec {
        /// Name, unique among loads, muscles and blocks.
        pub name: String,
        /// Point of a body at which a force acts, with `direction`; or give `joint` or `solid`.
        pub point: Option<PointSpec>,
        /// Direction of the force or traction in the ground frame, in the reference configuration where it `follows`; its length is ignored.
        pub direction: Option<[f64; 3]>,
        /// Name of a revolute joint, about whose axis a torque acts on the child, or of a prismatic one, along whose axis a force acts.
        pub joint: Option<String>,
        /// Name of a lumped muscle whose electrodes have a given charge instead of a voltage.
        pub muscle: Option<String>,
        /// Name of an elastic block, with `kind`.
        pub solid: Option<String>,
        /// Kind of a load of a `solid`.
        pub kind: Option<BlockLoadKind>,
        /// Face on which it acts.
        pub face: Option<String>,
        /// Faces of the surface in a plane on which it acts.
        pub plane: Option<PlaneSpec>,
        /// Faces of the surface in a box on which it acts.
        #[serde(rename = "box")]
        pub cuboid: Option<CornersSpec>,
        /// True if a force turns with its body, or a pressure acts on the deformed faces along their normals; where not written, a pressure does
        /// and a force does not.
        pub follows: Option<bool>,
    }

    /// Kind of a load of an elastic block. Areas and volumes are those of the reference configuration but for a pressure that follows.
    pub enum BlockLoadKind {
        /// Force for an area along `direction`.
        Traction,
        /// Force for an area against the outward normal.
        Pressure,
        /// Charge for an area.
        SurfaceCharge,
        /// Force for a volume along `direction`; it acts in the whole block.
        BodyForce,
    }
}

/// The parts of a scene on which loads act.
pub(crate) struct Carriers<'a> {
    pub(crate) bodies: &'a [String],
    pub(crate) joints: &'a [Joint],
    pub(crate) muscles: &'a [Muscle],
    pub(crate) solids: &'a [Solid],
}

/// The load that is written.
pub(crate) fn load(spec: &LoadSpec, on: &Carriers<'_>, scope: &Scope<'_>) -> Result<Load> {
    let checked = spec.check_keys(scope);
    let on = the_one!(scope, spec;
        "point" point |at, point| {
            checked?;
            LoadPlace::Point {
                at: point.attachment(on.bodies, at)?,
                direction: spec.direction(scope)?,
                follows: spec.follows.unwrap_or(false),
            }
        };
        "joint" joint |at, name| {
            checked?;
            let all = names(on.joints, |joint| &joint.name);
            LoadPlace::Joint(at.find(name, &all, "the name of a joint")?)
        };
        "muscle" muscle |at, name| {
            checked?;
            let all = names(on.muscles, |muscle| &muscle.name);
            LoadPlace::Muscle(at.find(name, &all, "the name of a muscle")?)
        };
        "solid" solid |at, name| {
            checked?;
            let all = names(on.solids, |solid| &solid.name);
            let block = at.find(name, &all, "the name of an elastic block")?;
            let load = spec.of_solid(&on.solids[block], scope)?;
            LoadPlace::Block { block, load }
        };
    );
    Ok(Load {
        name: spec.name.clone(),
        on,
    })
}

impl LoadSpec {
    /// Refuses keys that mean nothing where they stand.
    fn check_keys(&self, scope: &Scope<'_>) -> Result<()> {
        use BlockLoadKind::{BodyForce, Pressure, SurfaceCharge};
        let no_direction = match (&self.joint, &self.muscle, self.kind) {
            (Some(_), ..) => Some("as the axis of the joint is the direction"),
            (_, Some(_), _) | (.., Some(SurfaceCharge)) => Some("as a charge has no direction"),
            (.., Some(Pressure)) => Some("as a pressure acts along the normal"),
            _ => None,
        };
        let is_plain = self.joint.is_none() && self.muscle.is_none();
        let turns = is_plain && matches!(self.kind, None | Some(Pressure));
        let is_of_block = self.solid.is_some();
        let no_kind = (!is_of_block).then_some("as only a load of a \"solid\" has it");
        let no_face = match self.kind {
            Some(BodyForce) => Some("as a body force acts in the whole block"),
            _ => no_kind,
        };
        let not_following = (!turns).then_some("as only a force at a point and a pressure follow");
        let all = [
            ("direction", self.direction.is_some(), no_direction),
            ("kind", self.kind.is_some(), no_kind),
            ("face", self.face.is_some(), no_face),
            ("plane", self.plane.is_some(), no_face),
            ("box", self.cuboid.is_some(), no_face),
            ("follows", self.follows.is_some(), not_following),
        ];
        for (key, is_written, why) in all {
            refuse!(if let (true, Some(why)) = (is_written, why), scope.key(key);
                found format!("{key:?}"), expected format!("no such key, {why}"));
        }
        Ok(())
    }

    fn direction(&self, scope: &Scope<'_>) -> Result<Vector> {
        let missing = || scope.wrong("no key \"direction\"", "the direction of the force");
        let direction = self.direction.as_ref().ok_or_else(missing)?;
        unit_axis(direction, &scope.key("direction"))
    }

    /// The load of a block.
    fn of_solid(&self, solid: &Solid, scope: &Scope<'_>) -> Result<BlockLoad> {
        let expected = "\"traction\", \"pressure\", \"surface_charge\" or \"body_force\"";
        let missing = || scope.wrong("no key \"kind\"", expected);
        Ok(match self.kind.ok_or_else(missing)? {
            BlockLoadKind::Traction => {
                BlockLoad::Traction(self.faces(solid, scope)?, self.direction(scope)?)
            }
            BlockLoadKind::Pressure => BlockLoad::Pressure {
                faces: self.faces(solid, scope)?,
                follows: self.follows.unwrap_or(true),
            },
            BlockLoadKind::SurfaceCharge => BlockLoad::Charge(self.faces(solid, scope)?),
            BlockLoadKind::BodyForce => BlockLoad::BodyForce(self.direction(scope)?),
        })
    }

    /// Faces of the surface all of whose nodes lie in the place that is written; a force on them moves a node.
    fn faces(&self, solid: &Solid, scope: &Scope<'_>) -> Result<Faces> {
        let owner = format!("load {:?}", self.name);
        let nodes = nodes!(&owner, self, &solid.mesh, scope);
        let faces = solid.mesh.faces_of(&nodes);
        refuse!(if faces.is_empty(), scope;
            found format!("{owner} where no face of an element lies on the surface"),
            expected "a part of the surface of the block");
        let is_held = |support: &Support, node: &usize| {
            support.held == [true; 3] && support.nodes.binary_search(node).is_ok()
        };
        let is_held = |node: &usize| solid.supports.iter().any(|s| is_held(s, node));
        let is_force = self.kind != Some(BlockLoadKind::SurfaceCharge);
        refuse!(if is_force && faces.iter().flatten().all(is_held), scope;
            found format!("{owner} on nodes that are all held"),
            expected "a part of the surface that moves");
        Ok(faces)
    }
}
