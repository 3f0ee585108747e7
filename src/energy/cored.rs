//! Normal forces between shapes with cores: the formulas of spheres, whose form is that of the closest points.
//!
//! The force F is a function of the form q and its rate α. Its damping does the work F δq, a product of both, as friction is one of F and of
//! what a unit of normal force does.

use crate::energy::closest::{AlongForm, Form};
use crate::energy::contact::vector;
use crate::energy::dot_products::OfDotProducts;
use crate::energy::{
    ContactDamping, ContactElasticity, ContactForce, ContactGap, ContactLaw, Cores, Energy,
    WithDerivatives,
};
use crate::math::{Derivatives, Jet, Local};
use nalgebra::{Matrix3, SVector, Vector3};

/// A formula of a contact between shapes with cores; its vectors are the span between the centres and the axes, unit vectors, that of the round
/// shape first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OfCores<E> {
    /// The formula between spheres.
    pub of: E,
    /// The cores.
    pub cores: Cores,
}

/// Vectors of a reading.
pub(super) fn reading<const N: usize, const M: usize>(
    p: &SVector<f64, M>,
    reading: usize,
) -> [Vector3<f64>; N] {
    std::array::from_fn(|v| vector(p, reading * N + v))
}

/// A function of the form at a place and along rates of it.
#[derive(Clone, Copy, Debug)]
pub struct OfClosest<const N: usize> {
    form: OfDotProducts<N>,
    along: AlongForm<N>,
    /// Value and three derivatives.
    of: [f64; 4],
}

impl<E> OfCores<E> {
    /// Places of an element are midpoints; rates are read to third order alone.
    fn function<
        const N: usize,
        const D: usize,
        const K: usize,
        const M: usize,
        const ORDER: usize,
    >(
        &self,
        [p, w]: [&SVector<f64, M>; 2],
        of: impl Fn(f64) -> [f64; 4],
    ) -> OfClosest<N> {
        let vectors = reading(p, 0);
        let form = Form::<N, D, K>::new(&self.cores, vectors);
        let of = of(form.closest.form.value);
        // An open contact has nothing but its value.
        let is_open = of[1..].iter().all(|slope| *slope == 0.0);
        OfClosest {
            form: match is_open {
                true => OfDotProducts::new(vectors),
                false => form.form(),
            },
            along: match ORDER == 3 && !is_open {
                true => form.along(reading(w, 0)),
                false => AlongForm::NONE,
            },
            of,
        }
    }
}

impl<const N: usize> Local for OfClosest<N> {
    fn value(&self) -> f64 {
        self.of[0]
    }

    fn plain<const NV: usize>(&self) -> impl Derivatives {
        *self
    }

    fn along<const NV: usize>(&self) -> impl Derivatives {
        ClosestRates(*self)
    }
}

impl<const N: usize> Derivatives for OfClosest<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        self.form.gradient[i] * self.of[1]
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let [a, b] = [i, j].map(|i| self.form.gradient[i]);
        self.form.hessian[i][j] * self.of[1] + a * (b * self.of[2]).transpose()
    }
}

/// Its rates.
struct ClosestRates<const N: usize>(OfClosest<N>);

impl<const N: usize> Derivatives for ClosestRates<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        let OfClosest { form, along, of } = &self.0;
        along.gradient[i] * of[1] + form.gradient[i] * (of[2] * along.rate)
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let OfClosest { form, along, of } = &self.0;
        let [a, b] = [i, j].map(|i| (form.gradient[i], along.gradient[i]));
        along.hessian[i][j] * of[1]
            + form.hessian[i][j] * (of[2] * along.rate)
            + (a.0 * b.1.transpose() + a.1 * b.0.transpose()) * of[2]
            + a.0 * (b.0 * (of[3] * along.rate)).transpose()
    }
}

/// A function F of the form and its rate, of `N` midpoints and then their rates.
#[derive(Clone, Copy, Debug)]
pub struct CoreForce<const N: usize> {
    pub(super) form: OfDotProducts<N>,
    along: AlongForm<N>,
    /// F by q and α.
    of: Jet<2, 2>,
}

impl<const N: usize> CoreForce<N> {
    /// F of a form along rates of its vectors.
    pub(super) fn new<const D: usize, const K: usize>(
        form: &Form<N, D, K>,
        rates: [Vector3<f64>; N],
        of: impl Fn(Jet<2, 2>, Jet<2, 2>) -> Jet<2, 2>,
    ) -> Self {
        let along = form.along(rates);
        let at = SVector::from([form.closest.form.value, along.rate]);
        let [q, alpha] = [0, 1].map(|k| Jet::argument(k, &at, &SVector::zeros()));
        Self {
            form: form.form(),
            along,
            of: of(q, alpha),
        }
    }

    /// Derivatives of F by a vector through q and α, of which the first is a factor of its own derivatives too.
    fn slope(&self, by: [f64; 2], v: usize) -> Vector3<f64> {
        self.form.gradient[v] * by[0] + self.along.gradient[v] * by[1]
    }
}

impl<const N: usize> WithDerivatives for CoreForce<N> {
    fn scalar(&self) -> f64 {
        self.of.value
    }
}

impl<const N: usize> Derivatives for CoreForce<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        let by = &self.of.gradient;
        match i < N {
            true => self.slope([by[0], by[1]], i),
            false => self.form.gradient[i - N] * by[1],
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let (by, twice) = (&self.of.gradient, &self.of.hessian);
        let [v, w] = [i % N, j % N];
        // Derivatives of those of F by q and α.
        let [of_q, of_alpha] = [0, 1].map(|a| match j < N {
            true => self.slope([twice[(a, 0)], twice[(a, 1)]], w),
            false => self.form.gradient[w] * twice[(a, 1)],
        });
        let (g, along) = (self.form.gradient[v], self.along.gradient[v]);
        match (i < N, j < N) {
            (true, true) => {
                self.form.hessian[v][w] * by[0]
                    + self.along.hessian[v][w] * by[1]
                    + g * of_q.transpose()
                    + along * of_alpha.transpose()
            }
            (false, true) | (true, false) => {
                let turned = self.form.hessian[v][w] * by[1];
                match i < N {
                    true => turned + g * of_q.transpose() + along * of_alpha.transpose(),
                    false => turned + g * of_alpha.transpose(),
                }
            }
            (false, false) => g * of_alpha.transpose(),
        }
    }
}

/// The variation δq; arguments: variations, midpoints and rates of `N` vectors.
#[derive(Clone, Copy, Debug)]
pub struct FormVariation<const N: usize> {
    form: OfDotProducts<N>,
    along: AlongForm<N>,
}

impl<const N: usize> WithDerivatives for FormVariation<N> {
    fn scalar(&self) -> f64 {
        self.along.rate
    }
}

impl<const N: usize> Derivatives for FormVariation<N> {
    fn force(&self, i: usize) -> Vector3<f64> {
        match i / N {
            0 => self.form.gradient[i],
            1 => self.along.gradient[i - N],
            _ => Vector3::zeros(),
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        match [i / N, j / N] {
            [0, 1] | [1, 0] => self.form.hessian[i % N][j % N],
            [1, 1] => self.along.hessian[i - N][j - N],
            _ => Matrix3::zeros(),
        }
    }
}

/// A function F of `C` midpoints and rates times a virtual work of `N` vectors, among which those of F have places; none of an open contact.
#[derive(Clone, Copy, Debug)]
pub struct Times<W, const N: usize, const C: usize>(pub(super) Option<Factors<W, N, C>>);

/// Both factors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors<W, const N: usize, const C: usize> {
    pub(super) force: CoreForce<C>,
    pub(super) work: W,
    /// Vectors of F by those of the work.
    pub(super) places: [Option<usize>; N],
}

impl<W: WithDerivatives, const N: usize, const C: usize> Factors<W, N, C> {
    /// The argument of F that an argument of the work is.
    fn argument(&self, i: usize) -> Option<usize> {
        let place = self.places[i % N]?;
        Some((i / N).checked_sub(1)? * C + place)
    }

    fn gradient(&self, i: usize) -> Vector3<f64> {
        let own = self.work.force(i) * self.force.scalar();
        match self.argument(i) {
            Some(argument) => own + self.force.force(argument) * self.work.scalar(),
            None => own,
        }
    }

    fn hessian(&self, i: usize, j: usize) -> Matrix3<f64> {
        let mut block = self.work.block(i, j) * self.force.scalar();
        let [a, b] = [i, j].map(|i| self.argument(i));
        if let Some(a) = a {
            block += self.force.force(a) * self.work.force(j).transpose();
        }
        if let Some(b) = b {
            block += self.work.force(i) * self.force.force(b).transpose();
        }
        if let (Some(a), Some(b)) = (a, b) {
            block += self.force.block(a, b) * self.work.scalar();
        }
        block
    }
}

impl<W: WithDerivatives, const N: usize, const C: usize> WithDerivatives for Times<W, N, C> {
    fn scalar(&self) -> f64 {
        let factors = self.0.as_ref();
        factors.map_or(0.0, |of| of.force.scalar() * of.work.scalar())
    }
}

impl<W: WithDerivatives, const N: usize, const C: usize> Derivatives for Times<W, N, C> {
    fn force(&self, i: usize) -> Vector3<f64> {
        let factors = self.0.as_ref();
        factors.map_or_else(Vector3::zeros, |of| of.gradient(i))
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let factors = self.0.as_ref();
        factors.map_or_else(Matrix3::zeros, |of| of.hessian(i, j))
    }
}

impl ContactLaw {
    /// Force f φ at the form and its rate.
    pub(super) fn grown(&self, q: &Jet<2, 2>, alpha: &Jet<2, 2>) -> Jet<2, 2> {
        let [_, force, growth] = self.force(q, alpha);
        force * growth
    }
}

/// Implements formulas of cores for numbers of vectors, with those of their products, of both vectors and rates, and of arguments.
macro_rules! of_cores {
    ($($vectors:literal $products:literal $both:literal: $once:literal $twice:literal $thrice:literal;)*) => {
        $(
            of_cores!(@function ContactElasticity $vectors $products $both $once);
            of_cores!(@function ContactGap $vectors $products $both $once);

            impl Energy<$twice> for OfCores<ContactForce> {
                type Local<const ORDER: usize> = CoreForce<$vectors>;

                const READINGS: usize = 2;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $twice>,
                    _: &SVector<f64, $twice>,
                ) -> CoreForce<$vectors> {
                    let form = Form::<$vectors, $products, $both>::new(&self.cores, reading(p, 0));
                    let unit = self.of.unit.recip();
                    let force = |q, alpha| self.of.law.grown(&q, &alpha).scaled(unit);
                    CoreForce::new(&form, reading(p, 1), force)
                }
            }

            impl Energy<$thrice> for OfCores<ContactDamping> {
                type Local<const ORDER: usize> = Times<FormVariation<$vectors>, $vectors, $vectors>;

                const VIRTUAL: usize = $vectors;
                const READINGS: usize = 3;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $thrice>,
                    _: &SVector<f64, $thrice>,
                ) -> Self::Local<ORDER> {
                    let form = Form::<$vectors, $products, $both>::new(&self.cores, reading(p, 1));
                    if self.of.0.is_open(form.closest.form.value) {
                        return Times(None);
                    }
                    let force = CoreForce::new(&form, reading(p, 2), |q, alpha| {
                        let [slope, force, growth] = self.of.0.force(&q, &alpha);
                        force * growth.shifted(-1.0) * slope
                    });
                    let work = FormVariation {
                        form: force.form,
                        along: form.along(reading(p, 0)),
                    };
                    Times(Some(Factors {
                        force,
                        work,
                        places: std::array::from_fn(Some),
                    }))
                }
            }
        )*
    };
    (@function $formula:ident $vectors:literal $products:literal $both:literal $arguments:literal) => {
        impl Energy<$arguments> for OfCores<$formula> {
            type Local<const ORDER: usize> = OfClosest<$vectors>;

            fn at<const ORDER: usize>(
                &self,
                p: &SVector<f64, $arguments>,
                w: &SVector<f64, $arguments>,
            ) -> OfClosest<$vectors> {
                self.function::<$vectors, $products, $both, $arguments, ORDER>([p, w], |q| self.of.of(q))
            }
        }
    };
}

of_cores! {
    2 2 4: 6 12 18;
    3 4 6: 9 18 27;
    4 4 8: 12 24 36;
    5 8 10: 15 30 45;
}
