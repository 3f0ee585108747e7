//! Functions of the length of a path of any number of spans: `W(L)`, L = Σ |r̄ᵢ|, at the midpoint of an interval.
//!
//! A span is a vector, or one that parameters move: `r = x + Σ (π − π⁰) e`. Derivatives by parameters are those of forces and of the contraction
//! over numbers that carry them.
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

use crate::energy::{Cable, Coefficient};
use crate::functional::{Kernel, Move, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};
use nalgebra::Vector3;
use std::cell::Cell;

/// A path and the energy of its length, whose constants may follow from free parameters; arguments are one a span, then one a move.
#[derive(Clone, Debug)]
pub struct Path {
    /// Constants of the energy.
    pub energy: Cable<Coefficient>,
    /// Vectors of the spans, one after the other.
    pub spans: Vec<usize>,
    /// Parameters that constants and spans follow, scalars of the interval.
    pub parameters: Vec<usize>,
    /// Those that move spans.
    pub moves: Vec<Move>,
}

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
    fn new(path: &Path, i: usize, order: Order, sample: &Sample<'_>) -> Self {
        let given = |place: usize| sample.scalars[path.parameters[place]];
        let r = path.span(i, sample.vectors, &given);
        let length = r.norm();
        let direction = r / length;
        let w = match order {
            Order::Third => path.span(i, sample.along, &given),
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
    /// Span `i` of vectors, or its rate of those along the direction, at numbers in place of the parameters.
    fn span<T: Number>(
        &self,
        i: usize,
        vectors: [&[Vector]; 2],
        parameter: &impl Fn(usize) -> T,
    ) -> Vector3<T> {
        let mut r = middle(self.spans[i], vectors).map(T::of);
        for one in self.moves.iter().filter(|one| one.of == i) {
            let factor = parameter(one.parameter).shifted(-one.at);
            r += middle(one.vector, vectors).map(|part| factor.scaled(part));
        }
        r
    }

    /// Energy, tension, stiffness and its derivative at numbers in place of the parameters.
    fn taut<T: Number>(&self, sample: &Sample<'_>, parameter: &impl Fn(usize) -> T) -> [T; 4] {
        let mut length = T::zero();
        for i in 0..self.spans.len() {
            length += norm(&self.span(i, sample.vectors, parameter));
        }
        let cable = Cable {
            stiffness: self.energy.stiffness.of(parameter),
            length: self.energy.length.of(parameter),
            smoothing: self.energy.smoothing,
        };
        cable.of_length(length)
    }

    /// Span of an argument, and the move that it is, if it is one.
    fn argument(&self, i: usize) -> (usize, Option<&Move>) {
        match i.checked_sub(self.spans.len()) {
            None => (i, None),
            Some(moved) => (self.moves[moved].of, Some(&self.moves[moved])),
        }
    }
}

fn norm<T: Number>(r: &Vector3<T>) -> T {
    (r.x * r.x + r.y * r.y + r.z * r.z).sqrt()
}

/// A taut path at a sample with derivatives by two of its parameters.
struct Seeded<'a> {
    path: &'a Path,
    sample: &'a Sample<'a>,
    seeds: [usize; 2],
}

impl Seeded<'_> {
    fn parameter(&self, place: usize) -> HyperDual {
        let [a, b] = self.seeds.map(|seed| f64::from(u8::from(place == seed)));
        let value = self.sample.scalars[self.path.parameters[place]];
        let mut number = HyperDual::of(value);
        (number.value.part, number.part.value) = (a, b);
        number
    }

    fn taut(&self) -> [HyperDual; 4] {
        self.path.taut(self.sample, &|place| self.parameter(place))
    }

    /// Direction and length of span `i`, and its rate.
    fn span(&self, i: usize) -> (Vector3<HyperDual>, HyperDual, Vector3<HyperDual>) {
        let parameter = |place| self.parameter(place);
        let r = self.path.span(i, self.sample.vectors, &parameter);
        let length = norm(&r);
        let rate = self.path.span(i, self.sample.along, &parameter);
        (r * length.recip(), length, rate)
    }

    /// L_w.
    fn stretch(&self) -> HyperDual {
        let spans = (0..self.path.spans.len()).map(|i| self.span(i));
        spans.fold(HyperDual::of(0.0), |sum, (u, _, w)| sum + u.dot(&w))
    }

    /// A force on the span of argument `i` as one on the argument.
    fn on_argument(
        &self,
        i: usize,
        force: impl Fn(usize) -> Vector3<HyperDual>,
    ) -> Vector3<HyperDual> {
        let (span, moved) = self.path.argument(i);
        match moved {
            None => force(span),
            Some(one) => force(span) * self.parameter(one.parameter).shifted(-one.at),
        }
    }

    /// ∂W/∂rᵢ of the span i.
    fn force(&self, i: usize) -> Vector3<HyperDual> {
        self.span(i).0 * self.taut()[1]
    }

    /// The derivative of the contraction by rᵢ.
    fn force_rate(&self, i: usize) -> Vector3<HyperDual> {
        let [_, tension, stiffness, _] = self.taut();
        let (u, length, w) = self.span(i);
        let turn = (w - u * u.dot(&w)) * length.recip();
        u * (stiffness * self.stretch()) + turn * tension
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
        Span::new(self.path, i, self.order, self.sample)
    }

    /// Derivatives by two parameters.
    fn by(&self, seeds: [usize; 2]) -> Seeded<'_> {
        Seeded {
            path: self.path,
            sample: self.sample,
            seeds,
        }
    }

    /// Span of argument `i`, and its factor.
    fn argument(&self, i: usize) -> (usize, f64) {
        let (span, moved) = self.path.argument(i);
        let value = |one: &Move| self.sample.scalars[self.path.parameters[one.parameter]] - one.at;
        (span, moved.map_or(1.0, value))
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
        let (i, factor) = self.argument(i);
        self.row_span(i).direction * (self.tension * factor)
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let ((i, of_row), (j, of_column)) = (self.argument(i), self.argument(j));
        let (a, b) = (self.row_span(i), self.span(j));
        let mut block = a.direction * b.direction.transpose() * self.stiffness;
        if i == j {
            block += a.curvature() * self.tension;
        }
        block * (of_row * of_column)
    }

    fn row(&self, s: usize) -> f64 {
        self.by([s; 2]).taut()[0].value.part
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let by = self.by([s; 2]);
        by.on_argument(i, |i| by.force(i)).map(|by| by.value.part)
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.by([s, t]).taut()[0].part.part
    }
}

/// Rates of the derivatives of a taut path along the direction.
struct Rates<'a>(&'a Taut<'a>);

impl Rates<'_> {
    /// The contraction W′ L_w.
    fn contraction(&self, seeds: [usize; 2]) -> HyperDual {
        let by = self.0.by(seeds);
        by.taut()[1] * by.stretch()
    }
}

impl Derivatives for Rates<'_> {
    fn force(&self, i: usize) -> Vector {
        let (i, factor) = self.0.argument(i);
        let (path, a) = (self.0, self.0.row_span(i));
        (a.direction * (path.stiffness * path.stretch) + a.turn * path.tension) * factor
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let ((i, of_row), (j, of_column)) = (self.0.argument(i), self.0.argument(j));
        let (path, a, b) = (self.0, self.0.row_span(i), self.0.span(j));
        let turned = a.turn * b.direction.transpose() + a.direction * b.turn.transpose();
        let along = a.direction * b.direction.transpose();
        let mut rate = turned * path.stiffness + along * (path.stiffening * path.stretch);
        if i == j {
            rate += a.curvature() * (path.stiffness * path.stretch);
            rate += a.curvature_rate() * path.tension;
        }
        rate * (of_row * of_column)
    }

    fn row(&self, s: usize) -> f64 {
        self.contraction([s; 2]).value.part
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let by = self.0.by([s; 2]);
        by.on_argument(i, |i| by.force_rate(i))
            .map(|by| by.value.part)
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.contraction([s, t]).part.part
    }
}

impl Kernel for Path {
    type Storage = ();

    fn vectors(&self) -> usize {
        self.spans.len() + self.moves.len()
    }

    fn scalars(&self) -> usize {
        self.parameters.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(match self.argument(i) {
            (span, None) => self.spans[span],
            (_, Some(one)) => one.vector,
        })
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        Some((self.parameters[s], 1.0))
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        self.taut(sample, &|place| sample.scalars[self.parameters[place]])[0]
    }

    fn derivatives<S: Scatter>(&self, order: Order, sample: &Sample<'_>, (): &(), to: &mut S) {
        let given = |place: usize| sample.scalars[self.parameters[place]];
        let [_, tension, stiffness, stiffening] = self.taut(sample, &given);
        if tension == 0.0 {
            return;
        }
        let mut taut = Taut {
            path: self,
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
            taut.stretch = (0..self.spans.len()).map(|i| taut.span(i).stretch).sum();
            to.along(&taut, &Rates(&taut));
        }
    }
}
