//! Functions of the length of a path of any number of spans: `W(L)`, L = Σ |r̄ᵢ|, at the midpoint of an interval.
//!
//! With the directions uᵢ = r̄ᵢ/|r̄ᵢ| and Kᵢ = (1 − uᵢ uᵢᵀ)/|r̄ᵢ|
//!
//! ```text
//! ∂W/∂rᵢ = W′ uᵢ,     ∂²W/∂rᵢ∂rⱼ = W″ uᵢ uⱼᵀ + δᵢⱼ W′ Kᵢ,
//! ```
//!
//! and along w, with L_w = Σ uᵢ·wᵢ and the rates u̇ᵢ = Kᵢ wᵢ, K̇ᵢ = −(u̇ᵢ uᵢᵀ + uᵢ u̇ᵢᵀ + (uᵢ·wᵢ) Kᵢ)/|r̄ᵢ|:
//!
//! ```text
//! (∂²W)˙ᵢⱼ = W‴ L_w uᵢ uⱼᵀ + W″ (u̇ᵢ uⱼᵀ + uᵢ u̇ⱼᵀ) + δᵢⱼ (W″ L_w Kᵢ + W′ K̇ᵢ).
//! ```

use crate::energy::Cable;
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use std::cell::Cell;

/// A path and the energy of its length.
#[derive(Clone, Debug)]
pub struct Path {
    /// The energy.
    pub energy: Cable,
    /// Vectors of the spans, one after the other.
    pub spans: Vec<usize>,
}

/// The kind of elements that are paths: one argument a span, as many as a path has.
#[derive(Debug)]
pub enum Paths {}

/// A span at the midpoint of an interval, and its rates along the direction.
#[derive(Clone, Copy)]
struct Span {
    /// r̄/|r̄|.
    direction: Vector,
    /// |r̄|.
    length: f64,
    /// Rate of the direction.
    turn: Vector,
    /// Rate of the length.
    stretch: f64,
}

fn middle(vector: usize, vectors: [&[Vector]; 2]) -> Vector {
    (vectors[0][vector] + vectors[1][vector]) * 0.5
}

impl Span {
    fn new(vector: usize, order: Order, sample: &Sample<'_>) -> Self {
        let r = middle(vector, sample.vectors);
        let length = r.norm();
        let direction = r / length;
        let w = match order {
            Order::Third => middle(vector, sample.along),
            _ => Vector::zeros(),
        };
        let stretch = direction.dot(&w);
        Self {
            direction,
            length,
            turn: (w - direction * stretch) / length,
            stretch,
        }
    }

    /// Second derivative of the length.
    fn curvature(&self) -> Matrix {
        let u = &self.direction;
        (Matrix::identity() - u * u.transpose()) / self.length
    }

    /// Its rate along the direction.
    fn curvature_rate(&self) -> Matrix {
        let (u, t) = (&self.direction, &self.turn);
        let turned = t * u.transpose();
        -(turned + turned.transpose() + self.curvature() * self.stretch) / self.length
    }
}

impl Path {
    fn length(&self, sample: &Sample<'_>) -> f64 {
        let spans = self.spans.iter();
        spans.map(|&v| middle(v, sample.vectors).norm()).sum()
    }
}

/// A taut path at a sample.
struct Taut<'a> {
    path: &'a Path,
    sample: &'a Sample<'a>,
    order: Order,
    /// W′.
    tension: f64,
    /// W″.
    stiffness: f64,
    /// W‴.
    stiffening: f64,
    /// L_w.
    stretch: f64,
    /// The span whose row was asked for last: rows are read one after the other.
    row: Cell<Option<(usize, Span)>>,
}

impl Taut<'_> {
    fn span(&self, i: usize) -> Span {
        Span::new(self.path.spans[i], self.order, self.sample)
    }

    fn row_span(&self, i: usize) -> Span {
        let kept = self.row.get().filter(|&(row, _)| row == i);
        let (_, span) = kept.unwrap_or_else(|| (i, self.span(i)));
        self.row.set(Some((i, span)));
        span
    }
}

impl Derivatives for Taut<'_> {
    fn force(&self, i: usize) -> Vector {
        self.row_span(i).direction * self.tension
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let (a, b) = (self.row_span(i), self.span(j));
        let mut block = a.direction * b.direction.transpose() * self.stiffness;
        if i == j {
            block += a.curvature() * self.tension;
        }
        block
    }
}

/// Rates of the derivatives of a taut path along the direction.
struct Rates<'a>(&'a Taut<'a>);

impl Derivatives for Rates<'_> {
    fn force(&self, i: usize) -> Vector {
        let (path, a) = (self.0, self.0.row_span(i));
        a.direction * (path.stiffness * path.stretch) + a.turn * path.tension
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let (path, a, b) = (self.0, self.0.row_span(i), self.0.span(j));
        let turned = a.turn * b.direction.transpose() + a.direction * b.turn.transpose();
        let along = a.direction * b.direction.transpose();
        let mut rate = turned * path.stiffness + along * (path.stiffening * path.stretch);
        if i == j {
            rate += a.curvature() * (path.stiffness * path.stretch);
            rate += a.curvature_rate() * path.tension;
        }
        rate
    }
}

impl Kernel for Paths {
    type Element = Path;
    type Storage = ();

    fn vectors(path: &Path) -> usize {
        path.spans.len()
    }

    fn scalars(_: &Path) -> usize {
        0
    }

    fn vector(path: &Path, i: usize) -> VectorArg {
        VectorArg {
            vector: path.spans[i],
            stencil: Stencil::Mid,
        }
    }

    fn scalar(_: &Path, _s: usize) -> Option<(usize, f64)> {
        None
    }

    fn energy(path: &Path, sample: &Sample<'_>) -> f64 {
        path.energy.of_length(path.length(sample))[0]
    }

    fn derivatives<S: Scatter>(
        path: &Path,
        order: Order,
        sample: &Sample<'_>,
        (): &(),
        to: &mut S,
    ) {
        let [_, tension, stiffness, stiffening] = path.energy.of_length(path.length(sample));
        if tension == 0.0 {
            return;
        }
        let mut taut = Taut {
            path,
            sample,
            order,
            tension,
            stiffness,
            stiffening,
            stretch: 0.0,
            row: Cell::new(None),
        };
        to.plain(&taut);
        if order == Order::Third {
            taut.stretch = (0..path.spans.len()).map(|i| taut.span(i).stretch).sum();
            to.along(&taut, &Rates(&taut));
        }
    }
}
