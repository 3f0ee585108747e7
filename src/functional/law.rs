//! Elements of laws: formulas whose constants are functions of free parameters.

use crate::energy::Law;
use crate::functional::{Element, VectorArg};

/// Most parameters that one element reads: as many as a law has constants, each of which follows one or is given. A muscle under voltage by a
/// law of two terms has six components of its ends, a prestretch, two sides, a layer, a modulus, three constants of the law and three of the
/// field.
pub const MOST_PARAMETERS: usize = 17;

/// A parameter that moves a point which an element reads.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Place of the moved vector among those of the element.
    pub of: usize,
    /// The vector e along which it moves.
    pub vector: usize,
    /// Place of the parameter among those of the element.
    pub parameter: usize,
    /// Its value π⁰ at which the vector is what it is without the move.
    pub at: f64,
}

/// One element: a law, its arguments, and the parameters that it reads.
#[derive(Clone, Debug)]
pub struct LawElement<L, const NV: usize, const NS: usize> {
    /// The law.
    pub law: L,
    /// Vectors, in the order of the arguments.
    pub vectors: [VectorArg; NV],
    /// Scalars of the interval, after the vectors.
    pub scalars: [usize; NS],
    /// Parameters, scalars of the interval, no more than [`MOST_PARAMETERS`].
    pub parameters: Vec<usize>,
    /// Those that move points.
    pub moves: Vec<Move>,
}

impl<L, const NV: usize, const NS: usize> LawElement<L, NV, NS> {
    /// The element of a formula that it is where it reads no parameter.
    pub fn given<const M: usize>(&self) -> Option<Element<L::Formula<f64>, NV, NS>>
    where
        L: Law<M>,
    {
        self.parameters.is_empty().then(|| Element {
            energy: self.law.formula(&[]),
            vectors: self.vectors,
            scalars: self.scalars,
        })
    }
}
