//! Friction between shapes with cores: that of spheres, whose centres are the closest points of the cores.
//!
//! With the feet γᵢ of the closest points the formula of spheres reads ρ = r − Σ γᵢ eᵢ in place of the span r, the velocity ṙ − Σ γᵢ ėᵢ of the
//! material points in place of ṙ, and the same of variations. The normal force is that of the form, which differs from ½ |ρ|² at the ends of
//! axes, so that the work is a product of it and of the work of a unit of normal force.

use crate::energy::closest::Form;
use crate::energy::cored::{CoreForce, Factors, Times, reading};
use crate::energy::{ContactFriction, Cores, Energy, FrictionLocal, WithDerivatives};
use crate::math::{Derivatives, Jet};
use nalgebra::{Matrix3, SVector, Vector3};

const PLACE: usize = 1;
const VELOCITY: usize = 2;

/// A virtual work of `N` vectors, of which the first one, the span, is that between the closest points.
#[derive(Clone, Copy, Debug)]
pub struct AtFeet<const N: usize> {
    /// The work of the span between the closest points.
    inner: FrictionLocal<N, 4>,
    /// Weights of the vectors in that span: one of the span between the centres, −γ of axes.
    weights: [f64; N],
    /// Derivatives of the weight of each vector by places of all.
    by_place: [[Vector3<f64>; N]; N],
    /// Derivatives by the place of each vector of the span between the closest points, by reading.
    turns: [[Matrix3<f64>; N]; 3],
    /// Derivatives of the inner work by this span.
    forces: [Vector3<f64>; 3],
    /// Second derivatives of the inner work by this span and all arguments.
    rows: [[[Matrix3<f64>; N]; 3]; 3],
    /// Second derivatives of the weights, times their parts of the work.
    curved: [[Matrix3<f64>; N]; N],
}

impl<const N: usize> AtFeet<N> {
    fn new<const C: usize, const D: usize, const K: usize, const M: usize>(
        friction: &ContactFriction,
        p: &SVector<f64, M>,
        form: &Form<C, D, K>,
        places: &[Option<usize>; N],
    ) -> Self {
        let readings: [[Vector3<f64>; N]; 3] = [0, 1, 2].map(|m| reading(p, m));
        // Products of the span with the axes follow its square.
        let weight = |v: usize| Some(&form.closest.slopes[places[v]?]);
        let weights = std::array::from_fn(|v| weight(v).map_or(0.0, |weight| weight.value));
        let mut inner_arguments = *p;
        for (m, read) in readings.iter().enumerate() {
            let span: Vector3<f64> = (0..N).map(|v| read[v] * weights[v]).sum();
            let mut at = inner_arguments.fixed_rows_mut::<3>(3 * N * m);
            at.copy_from(&span);
        }
        let inner = friction.derivatives::<N, 4, M>(&inner_arguments, |_, vectors| {
            friction.work(vectors, |_, _| Jet::constant(-friction.coefficient))
        });
        let forces = [0, 1, 2].map(|m| inner.force(m * N));
        let mut of_weights = Jet::constant(0.0);
        let mut by_place = [[Vector3::zeros(); N]; N];
        for v in 1..N {
            let Some(weight) = weight(v) else {
                continue;
            };
            let part: f64 = (0..3).map(|m| forces[m].dot(&readings[m][v])).sum();
            of_weights = of_weights + weight.scaled(part);
            by_place[v] = spread(&form.gradient(&weight.gradient), places);
        }
        let curved = form.of(of_weights).hessian;
        let turns = [0, 1, 2].map(|m| {
            std::array::from_fn(|v| {
                let own = if m == PLACE { weights[v] } else { 0.0 };
                let turned = (1..N).map(|axis| readings[m][axis] * by_place[axis][v].transpose());
                Matrix3::from_diagonal_element(own) + turned.sum::<Matrix3<f64>>()
            })
        });
        let row = |m: usize, n: usize| std::array::from_fn(|w| inner.block(m * N, n * N + w));
        Self {
            rows: [0, 1, 2].map(|m| [0, 1, 2].map(|n| row(m, n))),
            inner,
            weights,
            by_place,
            turns,
            forces,
            curved: std::array::from_fn(|v| match places[v] {
                Some(a) => spread(&curved[a], places),
                None => [Matrix3::zeros(); N],
            }),
        }
    }

    /// Derivatives by an argument of the span between the closest points, by reading.
    fn parts(&self, reading: usize, v: usize) -> [Matrix3<f64>; 3] {
        let own = Matrix3::from_diagonal_element(self.weights[v]);
        [0, 1, 2].map(|m| match reading {
            PLACE => self.turns[m][v],
            _ if m == reading => own,
            _ => Matrix3::zeros(),
        })
    }
}

/// Values by vectors of the form as values by vectors of the work.
fn spread<T: Copy + Default, const N: usize, const C: usize>(
    of: &[T; C],
    places: &[Option<usize>; N],
) -> [T; N] {
    places.map(|place| place.map_or_else(T::default, |place| of[place]))
}

impl<const N: usize> WithDerivatives for AtFeet<N> {
    fn scalar(&self) -> f64 {
        self.inner.scalar()
    }
}

impl<const N: usize> Derivatives for AtFeet<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        let parts = self.parts(i / N, i % N);
        let of_span = (0..3).map(|m| parts[m].tr_mul(&self.forces[m]));
        let direct = match i % N {
            0 => Vector3::zeros(),
            _ => self.inner.force(i),
        };
        direct + of_span.sum::<Vector3<f64>>()
    }

    #[inline(never)]
    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let ([a, b], [v, w]) = ([i / N, j / N], [i % N, j % N]);
        let [left, right] = [self.parts(a, v), self.parts(b, w)];
        let mut block = Matrix3::zeros();
        if v > 0 && w > 0 {
            block += self.inner.block(i, j);
        }
        for m in 0..3 {
            if v > 0 {
                block += self.rows[m][a][v].tr_mul(&right[m]);
            }
            let mut row = Matrix3::zeros();
            if w > 0 {
                row += self.rows[m][b][w];
            }
            for (n, right) in right.iter().enumerate() {
                row += self.rows[m][n][0] * right;
            }
            block += left[m].tr_mul(&row);
        }
        if b == PLACE {
            block += self.forces[a] * self.by_place[v][w].transpose();
        }
        if a == PLACE {
            block += self.by_place[w][v] * self.forces[b].transpose();
        }
        if a == PLACE && b == PLACE {
            block += self.curved[v][w];
        }
        block
    }
}

/// Virtual work of friction; arguments: variations of the span between the centres, of three directors of the round shape where it turns or has an
/// axis, and of three of the other shape, then their midpoints, then their rates. Axes are the first directors; `C` counts the vectors of the form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoreFriction<const C: usize> {
    /// Friction between spheres.
    pub friction: ContactFriction,
    /// The cores.
    pub cores: Cores,
}

impl<const C: usize> CoreFriction<C> {
    fn local<const N: usize, const D: usize, const K: usize, const M: usize>(
        &self,
        p: &SVector<f64, M>,
    ) -> Times<AtFeet<N>, N, C> {
        let places = self.cores.places::<N>();
        let read = |m: usize| {
            let all: [Vector3<f64>; N] = reading(p, m);
            let mut of_form = [Vector3::zeros(); C];
            for (vector, place) in all.iter().zip(places) {
                if let Some(place) = place {
                    of_form[place] = *vector;
                }
            }
            of_form
        };
        let form = Form::<C, D, K>::new(&self.cores, read(PLACE));
        let law = &self.friction.law;
        if law.is_open(form.closest.form.value) {
            return Times(None);
        }
        Times(Some(Factors {
            force: CoreForce::new(&form, read(VELOCITY), |q, alpha| law.grown(&q, &alpha)),
            work: AtFeet::new(&self.friction, p, &form, &places),
            places,
        }))
    }
}

/// Implements friction for numbers of vectors of the form, of their products, of both vectors and rates, and of vectors and arguments of the work.
macro_rules! friction_of_cores {
    ($($of_form:literal $products:literal $both:literal: $($vectors:literal of $arguments:literal)*;)*) => {
        $($(
            impl Energy<$arguments> for CoreFriction<$of_form> {
                type Local<const ORDER: usize> = Times<AtFeet<$vectors>, $vectors, $of_form>;

                const VIRTUAL: usize = $vectors;
                const READINGS: usize = 3;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $arguments>,
                    _: &SVector<f64, $arguments>,
                ) -> Self::Local<ORDER> {
                    self.local::<$vectors, $products, $both, $arguments>(p)
                }
            }
        )*)*
    };
}

friction_of_cores! {
    2 2 4: 4 of 36 7 of 63;
    3 4 6: 7 of 63;
    4 4 8: 4 of 36 7 of 63;
    5 8 10: 7 of 63;
}
