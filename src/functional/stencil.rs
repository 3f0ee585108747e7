//! Stencil of an argument in time: the midpoint rule, and nothing else.

use crate::math::Vector;

/// Reading of a vector over one interval `[t_k, t_{k+1}]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stencil {
    /// x_k.
    Here,
    /// x_{k+1}.
    Next,
    /// (x_k + x_{k+1})/2.
    Mid,
    /// (x_{k+1} − x_k)/h.
    Rate,
    /// x_{k+1} − x_k.
    Difference,
}

impl Stencil {
    /// The reading of a vector.
    #[inline(always)]
    pub fn of(self, vector: usize) -> VectorArg {
        let stencil = self;
        VectorArg { vector, stencil }
    }

    /// Weights of the two instants for the interval length h.
    #[inline(always)]
    pub fn weights(self, h: f64) -> [f64; 2] {
        match self {
            Self::Here => [1.0, 0.0],
            Self::Next => [0.0, 1.0],
            Self::Mid => [0.5, 0.5],
            Self::Rate => [-1.0 / h, 1.0 / h],
            Self::Difference => [-1.0, 1.0],
        }
    }

    /// Returns true if it reads the instant k + side.
    #[inline(always)]
    pub fn reads(self, side: usize) -> bool {
        match self {
            Self::Here => side == 0,
            Self::Next => side == 1,
            Self::Mid | Self::Rate | Self::Difference => true,
        }
    }
}

/// Vector that an argument reads, with its stencil in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VectorArg {
    /// Index of the vector.
    pub vector: usize,
    /// Stencil in time.
    pub stencil: Stencil,
}

impl VectorArg {
    /// Its value, from the vectors at both instants of an interval of length h.
    #[inline(always)]
    pub fn read(self, h: f64, vectors: [&[Vector]; 2]) -> Vector {
        let [a, b] = self.stencil.weights(h);
        match self.stencil {
            Stencil::Here => vectors[0][self.vector],
            Stencil::Next => vectors[1][self.vector],
            _ => vectors[0][self.vector] * a + vectors[1][self.vector] * b,
        }
    }
}

/// A constant plus a factor times a scalar of the interval: the potential of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScalarArg {
    /// The constant in V.
    pub constant: f64,
    /// Scalar and factor.
    pub scalar: Option<(usize, f64)>,
}

impl ScalarArg {
    /// Its value.
    #[inline]
    pub fn read(self, scalars: &[f64]) -> f64 {
        self.constant + self.scalar.map_or(0.0, |(s, factor)| factor * scalars[s])
    }

    /// Its rate, from those of the scalars.
    #[inline]
    pub fn rate(self, along: &[f64]) -> f64 {
        self.scalar.map_or(0.0, |(s, factor)| factor * along[s])
    }
}
