//! Rigid motions of elastic blocks that nothing holds.

use crate::coordinates::NodePlace;
use crate::kinematics::{Carrier, MaterialVector, VectorTerm};
use crate::math::Vector;
use crate::model::solid_block::SolidBlock;

/// A part of a block that can move without resistance: its name and the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Floating {
    /// The block.
    pub name: String,
    /// Such as `translation along x`.
    pub motion: String,
}

/// The first part of the blocks that neither supports nor bodies hold.
pub(super) fn floating(
    blocks: &[SolidBlock],
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<Floating> {
    blocks.iter().find_map(|block| {
        let mesh = &block.solid.mesh;
        mesh.parts().iter().find_map(|part| {
            let mut members: Vec<usize> = part.iter().flat_map(|&e| mesh.hexahedra[e]).collect();
            members.sort_unstable();
            members.dedup();
            let motion = free_motion(&members, block, vectors, nodes)?;
            Some(Floating {
                name: block.solid.name.clone(),
                motion,
            })
        })
    })
}

/// A rigid motion of nodes that leaves every held direction alone, to first order.
fn free_motion(
    members: &[usize],
    block: &SolidBlock,
    vectors: &[MaterialVector],
    nodes: &[NodePlace],
) -> Option<String> {
    let mesh = &block.solid.mesh;
    let centre = members.iter().map(|&n| mesh.nodes[n]).sum::<Vector>() / members.len() as f64;
    let size = members
        .iter()
        .map(|&n| (mesh.nodes[n] - centre).norm())
        .fold(f64::MIN_POSITIVE, f64::max);
    let mut gram = nalgebra::Matrix6::<f64>::zeros();
    for &node in members {
        let VectorTerm { carrier, .. } = vectors[block.vectors[node]].terms[0];
        let is_glued = block.solid.glued.iter().any(|g| g.nodes.contains(&node));
        let held = match carrier {
            Carrier::Node(number) if !is_glued => nodes[number].free.map(|free| !free),
            _ => [true; 3],
        };
        let arm = (mesh.nodes[node] - centre) / size;
        for axis in (0..3).filter(|&axis| held[axis]) {
            let direction = Vector::ith(axis, 1.0);
            let turned = arm.cross(&direction);
            let row = nalgebra::Vector6::new(
                direction.x,
                direction.y,
                direction.z,
                turned.x,
                turned.y,
                turned.z,
            );
            gram += row * row.transpose();
        }
    }
    let eigen = nalgebra::SymmetricEigen::new(gram);
    let (least, value) = eigen.eigenvalues.argmin();
    if value > 1e-9 {
        return None;
    }
    let mode = eigen.eigenvectors.column(least);
    let names = ["x", "y", "z"];
    let strongest = mode.iamax();
    Some(match strongest {
        0..3 => format!("translation along {}", names[strongest]),
        _ => format!("rotation about {}", names[strongest - 3]),
    })
}
