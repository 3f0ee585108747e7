//! Viscous forces of one hexahedron, their contraction with virtual displacements, and the derivatives of both.

use crate::math::{Matrix, Vector};

/// Viscous forces of one hexahedron and their derivatives.
#[derive(Clone, Debug)]
pub struct ViscousLocal {
    /// f_i in N, which balance external forces as ∂W/∂x_i do: the virtual work on the nodes is −Σ δx_i·f_i.
    pub forces: [Vector; 8],
    /// ∂f_i/∂x_j in N/mm, rows belong to i; not symmetric.
    pub by_place: [[Matrix; 8]; 8],
    /// ∂f_i/∂v_j in N ms/mm, rows belong to i; symmetric, both triangles are filled.
    pub by_velocity: [[Matrix; 8]; 8],
}

/// s = Σ y_i·f_i(x, v) of one hexahedron for given y_i, and its derivatives; ∂²s/∂v∂v is zero.
#[derive(Clone, Debug)]
pub struct ViscousContraction {
    /// s.
    pub value: f64,
    /// ∂s/∂x_i.
    pub by_place: [Vector; 8],
    /// ∂s/∂v_i.
    pub by_velocity: [Vector; 8],
    /// ∂²s/∂x_i∂x_j, rows belong to i; both triangles are filled.
    pub place_place: [[Matrix; 8]; 8],
    /// ∂²s/∂x_i∂v_j, rows belong to i; not symmetric.
    pub place_velocity: [[Matrix; 8]; 8],
}

impl Default for ViscousLocal {
    fn default() -> Self {
        Self {
            forces: [Vector::zeros(); 8],
            by_place: [[Matrix::zeros(); 8]; 8],
            by_velocity: [[Matrix::zeros(); 8]; 8],
        }
    }
}

impl Default for ViscousContraction {
    fn default() -> Self {
        Self {
            value: 0.0,
            by_place: [Vector::zeros(); 8],
            by_velocity: [Vector::zeros(); 8],
            place_place: [[Matrix::zeros(); 8]; 8],
            place_velocity: [[Matrix::zeros(); 8]; 8],
        }
    }
}
