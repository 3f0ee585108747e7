//! Interface of the levels of a hierarchy: what a V-cycle asks of them, whatever their nodes are.

use crate::sparse::multigrid::node_grid::COMPONENTS;

/// A level with its matrix in single precision, and the transfer to the next coarser one.
pub(super) trait GridLevel {
    /// Inverts the diagonal blocks; returns the node whose block is singular, if there is one.
    fn invert(&mut self) -> Result<(), usize>;

    /// Makes the matrix of the next coarser level.
    fn coarsen(&mut self, coarse: &mut Self);

    /// A forward sweep from zero, then what it leaves of the right-hand side.
    fn sweep_down(&mut self);

    /// Makes what is left the right-hand side of the next coarser level.
    fn restrict(&self, coarse: &mut Self);

    /// Adds the solution of the next coarser level.
    fn correct(&mut self, coarse: &Self);

    /// A backward sweep.
    fn sweep_up(&mut self);

    /// For each node, a bit for each component without a given value.
    fn free(&self) -> &[u8];

    /// The right-hand side, as the coarsest level is solved for it.
    fn condensed_rhs(&mut self) -> &[[f32; COMPONENTS]];

    /// Takes the solution of the coarsest level.
    fn take_solution(&mut self, x: impl Iterator<Item = [f32; COMPONENTS]>);

    /// Calls `visit` with row, column and value of each entry of the matrix, in a fixed order.
    fn visit(&self, visit: &mut dyn FnMut(usize, usize, f64));

    /// Bytes of its matrix and what belongs to it.
    fn bytes(&self) -> usize;
}
