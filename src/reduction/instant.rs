//! All that is known of one instant: coordinates, vectors, tangent, and both along a direction.

use crate::kinematics::Pose;
use crate::math::Vector;

/// Data of one instant, allocated once.
#[derive(Clone, Debug, Default)]
pub struct Instant {
    /// Coordinates u, then multipliers λ.
    pub z: Vec<f64>,
    /// Direction l: one costate for each entry of `z`.
    pub l: Vec<f64>,
    /// Material vectors x = F(u).
    pub x: Vec<Vector>,
    /// w = P l.
    pub w: Vec<Vector>,
    /// Columns ∂x/∂u of articulated vectors, packed vector by vector.
    pub columns: Vec<f64>,
    /// Their derivatives along l.
    pub columns_l: Vec<f64>,
    /// Forces R on the vectors, summed over neighbouring intervals.
    pub forces: Vec<Vector>,
    /// Contracted forces Hᵀ w, likewise.
    pub contracted: Vec<Vector>,
    /// Kinematics of the tree at u.
    pub tree: TreeState,
}

/// Poses, joint axes and twists of a kinematic tree at an instant.
#[derive(Clone, Debug, Default)]
pub struct TreeState {
    /// Pose of each body.
    pub poses: Vec<Pose>,
    /// Axis a of each joint, in the ground frame.
    pub axes: Vec<Vector>,
    /// Point c of each joint.
    pub points: Vec<Vector>,
    /// Derivatives of the axes along l.
    pub axes_l: Vec<Vector>,
    /// Derivatives of the points along l.
    pub points_l: Vec<Vector>,
    /// Spatial twist (ω, velocity of the origin) of each body along l.
    pub twists: Vec<[Vector; 2]>,
    /// Moments N and forces f of the subtree behind each joint, and their derivatives along l.
    pub moments: Vec<Moments>,
    /// Terms of all vectors.
    pub terms: Vec<Vector>,
    /// Their derivatives along l.
    pub terms_l: Vec<Vector>,
    /// Parts of vectors that joints move.
    pub arms: Vec<Vector>,
    /// Their derivatives along l.
    pub arms_l: Vec<Vector>,
}

/// Σ v Rᵀ and Σ R over the bodies behind a joint, and their rates along l.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    /// Σ v Rᵀ about the origin.
    pub moment: crate::math::Matrix,
    /// Σ c R.
    pub force: Vector,
    /// Rate of `moment`.
    pub moment_l: crate::math::Matrix,
    /// Rate of `force`.
    pub force_l: Vector,
}
