//! Krylov method with multigrid for systems of the nodes of finite elements: geometric on boxes, by smoothed aggregation on other meshes.
//!
//! Unknowns are components of nodes (displacements and a potential) that are coupled with those of neighbouring nodes alone. The
//! preconditioner of flexible GMRES is one V-cycle in single precision: a forward sweep of block Gauss–Seidel on the way down, a backward
//! sweep on the way up, trilinear transfer or that of smoothed rigid motions of aggregates, Galerkin coarse matrices, a direct solution on the
//! coarsest level. Levels become coarser along short edges only, so that thin layers do no harm (`docs/theory.md`, linear systems of
//! finite elements).

mod aggregation;
mod grid;
mod grid_pressures;
mod krylov;
mod level;
mod lobpcg;
mod mesh;
mod mesh_pressures;
mod node_grid;
mod parts;
mod potentials;
mod pressures;
mod slab;
mod solver;
mod stiffness;
mod triangles;
mod volumes;

pub use node_grid::{ElementVolume, GridNode, NodeBlock, NodeGrid};
pub use solver::{Multigrid, MultigridReport, NoSolution};
pub use stiffness::LowestModes;
pub use triangles::{BlockPlaces, NodeMesh};
