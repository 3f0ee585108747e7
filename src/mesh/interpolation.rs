//! Interpolation between the nodes of an element: shape functions N_i(ξ) in a parent cell, and points of quadrature.
//!
//! Formulas have the number of nodes in their types. A kind of element is a file with its shape functions, and a line of
//! [`Cell`](super::cell::Cell), which meshes and pictures ask.

/// A place in a parent cell of so many dimensions, and the weight of a function there.
pub type Point<const DIMENSIONS: usize> = ([f64; DIMENSIONS], f64);

/// Parent cell of the elements and faces with so many nodes.
#[derive(Clone, Copy, Debug)]
pub struct Parent<const NODES: usize>;

/// Shape functions.
pub trait Interpolation<const DIMENSIONS: usize, const NODES: usize> {
    /// N_i.
    fn values(at: &[f64; DIMENSIONS]) -> [f64; NODES];

    /// ∂N_i/∂ξ.
    fn slopes(at: &[f64; DIMENSIONS]) -> [[f64; DIMENSIONS]; NODES];

    /// Points whose sums are exact for products of two shape functions where ∂X/∂ξ is constant.
    fn quadrature() -> Vec<Point<DIMENSIONS>>;
}

/// Shape functions of an element, and the points at which it has its law.
pub trait Element<const NODES: usize>: Interpolation<3, NODES> {
    /// Nodes in the parent cell.
    const PLACES: [[f64; 3]; NODES];
    /// The centre.
    const CENTRE: [f64; 3];
    /// Gauss points.
    const POINTS: [Point<3>; 8];
}

/// Shape functions and their slopes at a point of a face.
pub(super) struct FacePoint {
    pub(super) weight: f64,
    pub(super) values: Vec<f64>,
    pub(super) slopes: Vec<[f64; 2]>,
}

/// Those of the faces with so many nodes.
pub(super) fn shapes<const NODES: usize>() -> Vec<FacePoint>
where
    Parent<NODES>: Interpolation<2, NODES>,
{
    let points = Parent::<NODES>::quadrature().into_iter();
    let shape = |(at, weight): Point<2>| FacePoint {
        weight,
        values: Parent::<NODES>::values(&at).to_vec(),
        slopes: Parent::<NODES>::slopes(&at).to_vec(),
    };
    points.map(shape).collect()
}

/// Five Gauss points between 0 and 1 with their weights.
const GAUSS: [[f64; 2]; 5] = [
    [0.046_910_077_030_668_004, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_24],
    [0.5, 0.284_444_444_444_444_44],
    [0.769_234_655_052_841_6, 0.239_314_335_249_683_24],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

/// Products of Gauss points in a square or a cube that is collapsed to a triangle or a tetrahedron, ξ₁ = s₁, ξ₂ = s₂ (1 − s₁),
/// ξ₃ = s₃ (1 − s₁)(1 − s₂) (A. H. Stroud, Approximate Calculation of Multiple Integrals, 1971).
pub(super) fn collapsed<const D: usize>() -> Vec<Point<D>> {
    let count = GAUSS.len().pow(D as u32);
    let point = |number: usize| {
        let (mut at, mut weight, mut left) = ([0.0; D], 1.0, 1.0);
        for (m, at) in at.iter_mut().enumerate() {
            let [s, w] = GAUSS[number / GAUSS.len().pow(m as u32) % GAUSS.len()];
            *at = s * left;
            weight *= w * left;
            left *= 1.0 - s;
        }
        (at, weight)
    };
    (0..count).map(point).collect()
}
