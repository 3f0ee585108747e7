//! Configuration of one instant: coordinates, vectors, tangent, and both along a direction.

use crate::kinematics::Pose;
use crate::math::Vector;

/// Data of one instant, allocated once.
#[derive(Clone, Debug, Default)]
pub struct Configuration {
    /// Coordinates u, then multipliers λ, then the charts of the tree: data that no equation changes.
    pub z: Vec<f64>,
    /// Direction l: one costate for each coordinate and multiplier.
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

/// Poses, axes and twists of the links of a kinematic tree at an instant.
#[derive(Clone, Debug, Default)]
pub struct TreeState {
    /// Pose of each frame: the bodies, then the frames between screws.
    pub poses: Vec<Pose>,
    /// Screw of each link: (ω, velocity of the origin) where its coordinate changes by one a second.
    pub screws: Vec<[Vector; 2]>,
    /// Derivatives of the screws along l.
    pub screws_l: Vec<[Vector; 2]>,
    /// Axis a of each link, in the ground frame.
    pub axes: Vec<Vector>,
    /// Point c of each link.
    pub points: Vec<Vector>,
    /// Derivatives of the axes along l.
    pub axes_l: Vec<Vector>,
    /// Derivatives of the points along l.
    pub points_l: Vec<Vector>,
    /// Spatial twist (ω, velocity of the origin) of each frame along l.
    pub twists: Vec<[Vector; 2]>,
    /// Moments N and forces f of the subtree behind each link, and their derivatives along l.
    pub moments: Vec<Moments>,
    /// Torque about the origin and force on the subtree behind each link.
    pub wrenches: Vec<[Vector; 2]>,
    /// Terms of all vectors.
    pub terms: Vec<Vector>,
    /// Their derivatives along l.
    pub terms_l: Vec<Vector>,
    /// Parts of vectors that links move.
    pub arms: Vec<Vector>,
    /// Their derivatives along l.
    pub arms_l: Vec<Vector>,
}

/// Σ v Rᵀ and Σ R over the bodies behind a link, and their rates along l.
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
