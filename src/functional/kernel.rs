//! Kernel: the arguments of elements of one kind, and the evaluation of their derivatives.

use crate::element::Dilatation;
use crate::functional::{Order, Sample, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};

/// Receives the derivatives of one element.
pub trait Scatter {
    /// False if derivatives by parameters alone are not asked for: a sum has no equation of a parameter, so that of the derivatives that are
    /// not contracted it takes those by a vector and a parameter only.
    const OF_PARAMETERS: bool = true;

    /// The one order at which it receives derivatives; all where it is `None`. Nothing is compiled for the others.
    const ORDER: Option<Order> = None;

    /// Those of its scalar.
    fn plain<D: Derivatives>(&mut self, plain: &D);

    /// Those of its scalar contracted with the direction, after those of the scalar itself.
    fn along<D: Derivatives, W: Derivatives>(&mut self, plain: &D, along: &W);

    /// False if it never receives derivatives at the order.
    fn receives(order: Order) -> bool {
        Self::ORDER.is_none_or(|only| only == order)
    }
}

/// An element, of which a [`Group`](crate::functional::Group) has many of one kind: its arguments, and the derivatives of its scalar E by them.
///
/// E is an energy in mJ, a virtual work δx·f in mJ of forces without a potential, or the value of a quantity. An element has `n`
/// vectors of the list. Argument `i` reads vector `i mod n`, so that node forces of an element that reads places and velocities
/// of its nodes share their couplings. How arguments follow from instants, which rows of a virtual work are equations, and where
/// an entry lies is known to the group of the elements alone.
pub trait Kernel: Clone + Send + Sync + 'static {
    /// Storage in which [`prepare`](Self::prepare) keeps data of one element; `()` if nothing is cached.
    type Storage: std::fmt::Debug + Default + Send + Sync;

    /// Polynomial degree of E: derivatives above it vanish and are never asked for.
    const DEGREE: usize = usize::MAX;

    /// Number of leading arguments of most elements that are virtual displacements: 0 for an energy; otherwise E is linear in them, and its scalars
    /// have no equations: they are inputs or parameters.
    const VIRTUAL: usize = 0;

    /// True if a virtual work is that of loads, which supply energy; otherwise its forces dissipate.
    const APPLIED: bool = false;

    /// True if E is a kinetic energy.
    const KINETIC: bool = false;

    /// Number of arguments for each vector of an element.
    const READINGS: usize = 1;

    /// True if second derivatives between two vectors are multiples of the identity.
    const ISOTROPIC: bool = false;

    /// True if E is a sum of functions of the vectors alone, each times a constant or the square of one scalar.
    const OF_SQUARES: bool = false;

    /// True if h E over an interval depends on its length h where places are kept: not where E is of degree one in rates.
    const BY_DURATION: bool = true;

    /// Names of the two parts of its energy in reports, where it has parts.
    const PARTS: Option<[&'static str; 2]> = None;

    /// Number of leading arguments of an element that are virtual displacements.
    #[inline(always)]
    fn virtuals(&self) -> usize {
        Self::VIRTUAL
    }

    /// Returns true if the arguments `i` and `j` have mixed second derivatives.
    fn couples(_i: usize, _j: usize) -> bool {
        true
    }

    /// Number n of vectors of an element.
    fn vectors(&self) -> usize;

    /// Number of its scalars.
    #[inline(always)]
    fn scalars(&self) -> usize {
        0
    }

    /// Returns the vector that argument `i` reads, of n times [`READINGS`](Self::READINGS).
    fn vector(&self, i: usize) -> VectorArg;

    /// Scalar of the site that argument `s` depends on, and the factor of it; `None` for a constant.
    #[inline(always)]
    fn scalar(&self, _s: usize) -> Option<(usize, f64)> {
        None
    }

    /// E at a sample; the work over the interval where E is a virtual work.
    fn energy(&self, sample: &Sample<'_>) -> f64;

    /// The first of the [parts](Self::PARTS) of the energy.
    fn first_part(&self, sample: &Sample<'_>) -> f64 {
        self.energy(sample)
    }

    /// Adds the momenta ∂E/∂ẋ times `scale` at vectors x with rates v, where E is a kinetic energy.
    fn momentum(&self, _scale: f64, _x: &[Vector], _v: &[Vector], _: &mut [Vector]) {}

    /// Adds the derivatives of the momenta along changes `by` of vectors and rates.
    fn momentum_along(
        &self,
        _scale: f64,
        _at: [&[Vector]; 2],
        _by: [&[Vector]; 2],
        _: &mut [Vector],
    ) {
    }

    /// The volume of a hexahedron with one pressure; `None` of other elements.
    fn volume(&self, _: &Sample<'_>) -> Option<Dilatation> {
        None
    }

    /// Second derivatives of that volume.
    fn curved_volume(&self, _: &Sample<'_>) -> Option<[[Matrix; 8]; 8]> {
        None
    }

    /// Computes what takes time: many elements are prepared on all cores, before derivatives are handed over in their order.
    fn prepare(&self, _: Order, _: &Sample<'_>, _storage: &mut Self::Storage) {}

    /// Hands over the derivatives up to an order. At [`Third`](Order::Third) virtual displacements are the direction, so that E
    /// is its own contraction with costates.
    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        sample: &Sample<'_>,
        storage: &Self::Storage,
        to: &mut S,
    );
}
