//! Viscous forces of one element, their contraction with virtual displacements, and the derivatives of both.

use crate::math::{Matrix, Vector};

/// Viscous forces of one element and their derivatives.
#[derive(Clone, Debug)]
pub struct ViscousLocal<const NODES: usize = 8> {
    /// f_i in N, which balance external forces as ∂W/∂x_i do: the virtual work on the nodes is −Σ δx_i·f_i.
    pub forces: [Vector; NODES],
    /// ∂f_i/∂x_j in N/mm, rows belong to i; not symmetric.
    pub by_place: [[Matrix; NODES]; NODES],
    /// ∂f_i/∂v_j in N ms/mm, rows belong to i; symmetric, both triangles are filled.
    pub by_velocity: [[Matrix; NODES]; NODES],
}

/// s = Σ y_i·f_i(x, v) of one element for given y_i, and its derivatives; ∂²s/∂v∂v is zero.
#[derive(Clone, Debug)]
pub struct ViscousContraction<const NODES: usize = 8> {
    /// s.
    pub value: f64,
    /// ∂s/∂x_i.
    pub by_place: [Vector; NODES],
    /// ∂s/∂v_i.
    pub by_velocity: [Vector; NODES],
    /// ∂²s/∂x_i∂x_j, rows belong to i; both triangles are filled.
    pub place_place: [[Matrix; NODES]; NODES],
    /// ∂²s/∂x_i∂v_j, rows belong to i; not symmetric.
    pub place_velocity: [[Matrix; NODES]; NODES],
}

impl<const NODES: usize> Default for ViscousLocal<NODES> {
    fn default() -> Self {
        Self {
            forces: [Vector::zeros(); NODES],
            by_place: [[Matrix::zeros(); NODES]; NODES],
            by_velocity: [[Matrix::zeros(); NODES]; NODES],
        }
    }
}

impl<const NODES: usize> Default for ViscousContraction<NODES> {
    fn default() -> Self {
        Self {
            value: 0.0,
            by_place: [Vector::zeros(); NODES],
            by_velocity: [Vector::zeros(); NODES],
            place_place: [[Matrix::zeros(); NODES]; NODES],
            place_velocity: [[Matrix::zeros(); NODES]; NODES],
        }
    }
}
