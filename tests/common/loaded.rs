//! Systems under every kind of load.

use super::systems::blocks;
use nalgebra::Vector3;
use proboscis::model::components::{BlockLoad, Load, LoadPlace};
use proboscis::model::system::{Attachment, System};

/// A force that does not turn and one that follows on the last segment of a trunk of two segments, and a motor at its first joint.
pub fn loaded(mut system: System) -> System {
    let at = Attachment {
        body: Some(1),
        at: Vector3::new(4.0, 85.0, 3.0),
    };
    let direction = Vector3::new(2.0, -1.0, 3.0).normalize();
    let load = |name: &str, on| Load {
        name: name.into(),
        on,
    };
    let force = |follows| LoadPlace::Point {
        at,
        direction,
        follows,
    };
    system.components.loads = vec![
        load("push", force(false)),
        load("motor", LoadPlace::Joint(0)),
        load("jet", force(true)),
    ];
    system
}

/// Every load of a block on the block of [`blocks`], and a force that follows its last body.
pub fn pressed() -> System {
    let mut system = blocks();
    let mesh = &system.solids[0].mesh;
    let faces = |set: &str| mesh.faces_of(&mesh.sets[set]);
    let along = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    let pressure = |set: &str, follows| BlockLoad::Pressure {
        faces: faces(set),
        follows,
    };
    let all = [
        ("air", pressure("x_max", true)),
        ("plate", pressure("z_min", false)),
        ("shear", BlockLoad::Traction(faces("x_min"), along)),
        ("body", BlockLoad::BodyForce(along)),
        ("ions", BlockLoad::Charge(faces("x_max"))),
    ];
    let load = |(name, load): (&str, BlockLoad)| Load {
        name: name.into(),
        on: LoadPlace::Block { block: 0, load },
    };
    system.components.loads = all.into_iter().map(load).collect();
    system
}
