//! The graph of bodies and joints: its connected parts, its loops, and the number of degrees of freedom of a tree.

use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::spec::BodySpec;
use crate::math::DisjointSets;
use crate::model::system::Joint;

/// Every body hangs on the ground or together with a free one, and no free one hangs on the ground.
pub(crate) fn check_connected<'a>(
    bodies: &[BodySpec],
    joints: &[Joint],
    scope: impl Fn(usize) -> Scope<'a>,
) -> Result<()> {
    let parts = parts(bodies.len(), joints);
    let ground = parts[bodies.len()];
    for (index, body) in bodies.iter().enumerate() {
        let grounded = parts[index] == ground;
        refuse!(if body.free && grounded, scope(index);
            found format!("{:?} free, though joints lead to the ground", body.name),
            expected "no \"free\" here");
        let mut part = bodies
            .iter()
            .zip(&parts)
            .filter(|(_, part)| **part == parts[index]);
        refuse!(if !grounded && !part.any(|(body, _)| body.free), scope(index);
            found format!("{:?}, which no chain of joints connects to the ground", body.name),
            expected "a joint that leads to the ground, or \"free\": true");
    }
    Ok(())
}

/// Degrees of freedom where the joints form a tree, a part without ground counting 6; `None` where they close a loop.
pub(crate) fn tree_freedoms(bodies: usize, joints: &[Joint]) -> Option<usize> {
    let mut roots = parts(bodies, joints);
    roots.sort_unstable();
    roots.dedup();
    let free_parts = roots.len() - 1;
    let coordinates = joints.iter().map(|joint| joint.kind.freedoms());
    let is_tree = joints.len() + free_parts == bodies;
    is_tree.then(|| coordinates.sum::<usize>() + 6 * free_parts)
}

/// The part of each body, and of the ground in the last entry, as the smallest number in it.
fn parts(bodies: usize, joints: &[Joint]) -> Vec<usize> {
    let mut sets = DisjointSets::new(bodies + 1);
    for joint in joints {
        sets.join(joint.parent.unwrap_or(bodies), joint.child);
    }
    sets.all()
}
