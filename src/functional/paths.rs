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

use crate::energy::{Cable, Polynomial};
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};
use std::cell::Cell;

/// A path and the energy of its length, whose constants may follow from sought parameters.
#[derive(Clone, Debug)]
pub struct Path {
    /// Constants of the energy.
    pub energy: Cable<Polynomial>,
    /// Vectors of the spans, one after the other.
    pub spans: Vec<usize>,
    /// Parameters that the constants follow, scalars of the interval.
    pub parameters: Vec<usize>,
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
    /// The energy, with seeds at one or two parameters where derivatives by them are asked for.
    fn cable<T: Number>(&self, sample: &Sample<'_>, seeded: impl Fn(usize, f64) -> T) -> Cable<T> {
        let at = |constant: &Polynomial| {
            let mut sum = T::of(constant.value);
            for &(place, factor) in &constant.slopes {
                let value = sample.scalars[self.parameters[place]];
                sum += seeded(place, value).scaled(factor);
            }
            sum
        };
        Cable {
            stiffness: at(&self.energy.stiffness),
            length: at(&self.energy.length),
            smoothing: self.energy.smoothing,
        }
    }

    /// Energy, tension, stiffness and its derivative with their derivatives by parameters `a` and `b`.
    fn by(&self, sample: &Sample<'_>, length: f64, [a, b]: [usize; 2]) -> [HyperDual; 4] {
        let seeded = |place, value| HyperDual {
            a: f64::from(u8::from(place == a)),
            b: f64::from(u8::from(place == b)),
            ..HyperDual::of(value)
        };
        self.cable(sample, seeded).of_length(length)
    }

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
    /// L.
    length: f64,
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

    fn by(&self, parameters: [usize; 2]) -> [HyperDual; 4] {
        self.path.by(self.sample, self.length, parameters)
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

    fn row(&self, s: usize) -> f64 {
        self.by([s; 2])[0].a
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        self.row_span(i).direction * self.by([s; 2])[1].a
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.by([s, t])[0].ab
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

    fn row(&self, s: usize) -> f64 {
        self.0.by([s; 2])[1].a * self.0.stretch
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let (path, a, by) = (self.0, self.0.row_span(i), self.0.by([s; 2]));
        a.direction * (by[2].a * path.stretch) + a.turn * by[1].a
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.0.by([s, t])[1].ab * self.0.stretch
    }
}

impl Kernel for Paths {
    type Element = Path;
    type Storage = ();

    fn vectors(path: &Path) -> usize {
        path.spans.len()
    }

    fn scalars(path: &Path) -> usize {
        path.parameters.len()
    }

    fn vector(path: &Path, i: usize) -> VectorArg {
        VectorArg {
            vector: path.spans[i],
            stencil: Stencil::Mid,
        }
    }

    fn scalar(path: &Path, s: usize) -> Option<(usize, f64)> {
        Some((path.parameters[s], 1.0))
    }

    fn energy(path: &Path, sample: &Sample<'_>) -> f64 {
        let cable = path.cable(sample, |_, value| value);
        cable.of_length(path.length(sample))[0]
    }

    fn derivatives<S: Scatter>(
        path: &Path,
        order: Order,
        sample: &Sample<'_>,
        (): &(),
        to: &mut S,
    ) {
        let length = path.length(sample);
        let cable = path.cable(sample, |_, value| value);
        let [_, tension, stiffness, stiffening] = cable.of_length(length);
        if tension == 0.0 {
            return;
        }
        let mut taut = Taut {
            path,
            sample,
            order,
            length,
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
