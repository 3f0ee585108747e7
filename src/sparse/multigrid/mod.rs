//! Krylov method with geometric multigrid for systems on box grids of nodes.
//!
//! Unknowns are components of nodes (displacements and a potential) that are coupled with those of neighbouring nodes alone. The
//! preconditioner of flexible GMRES is one V-cycle in single precision: a forward sweep of block Gauss–Seidel on the way down, a backward
//! sweep on the way up, trilinear transfer, Galerkin coarse matrices, a direct solution on the coarsest grid. Grids become coarser along
//! short edges only, so that thin layers do no harm (`docs/theory.md`, linear systems of finite elements).

mod axis;
mod boxes;
mod element_volume;
mod field;
mod galerkin;
mod hierarchy;
mod krylov;
mod level;
mod lobpcg;
mod matrix_values;
mod node_grid;
mod potentials;
mod pressures;
mod slab;
mod solver;
mod stiffness;
mod volumes;

pub use element_volume::ElementVolume;
pub use node_grid::{GridNode, NodeBlock, NodeGrid};
pub use solver::{Multigrid, MultigridReport, NoSolution};
pub use stiffness::LowestModes;
