//! Contact of a round shape with a plane or a sphere across their surfaces: elasticity and damping.
//!
//! The overlap x of both has a ramp s(x), which grows over a width w around zero as a polynomial of t = x/w + ½
//!
//! ```text
//! s = w (t⁶ − 3 t⁵ + 5/2 t⁴),
//! ```
//!
//! with three continuous derivatives, and is x beyond. The elastic energy is `W = k sᵖ⁺¹/(p + 1)`, linear for p = 1 and after Hertz for
//! p = 3/2; the normal force is W′ φ(a ẋ) after Hunt and Crossley, with φ(y) = 1 + y but never negative.
//!
//! All read the overlap from a form q of the vectors of the contact, which is bilinear: q = n·r for a plane with the normal n, at the height
//! q, and q = ½ |r|² for a sphere, at the height √(2 q).

use crate::energy::Energy;
use crate::energy::dot_products::OfDotProducts;
use crate::math::{Derivatives, Jet, Local};
use nalgebra::{Matrix3, SVector, Vector3};

/// Ramp s at x with its three derivatives; without a width it has a corner at zero.
pub(super) fn ramp(x: f64, w: f64) -> [f64; 4] {
    // A place that is no number stays none.
    if x <= -0.5 * w {
        return [0.0; 4];
    }
    if x < 0.5 * w {
        let t = x / w + 0.5;
        let [t2, t3] = [t * t, t * t * t];
        return [
            w * t2 * t2 * (t2 - 3.0 * t + 2.5),
            t3 * (6.0 * t2 - 15.0 * t + 10.0),
            30.0 * t2 * (t2 - 2.0 * t + 1.0) / w,
            60.0 * t * (2.0 * t2 - 3.0 * t + 1.0) / (w * w),
        ];
    }
    [x, 1.0, 0.0, 0.0]
}

/// Value and three derivatives of f∘g from those of f at the value of g, and of g.
pub(super) fn chain(f: [f64; 4], g: [f64; 4]) -> [f64; 4] {
    [
        f[0],
        f[1] * g[1],
        f[2] * g[1] * g[1] + f[1] * g[2],
        f[3] * g[1].powi(3) + 3.0 * f[2] * g[1] * g[2] + f[1] * g[3],
    ]
}

/// Side that a round shape touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// Plane with a normal n that does not turn; the contact reads the span r from a point of it to the centre of the round shape.
    Plane(Vector3<f64>),
    /// Plane of a body: the contact reads r and n.
    MovingPlane,
    /// Sphere: the contact reads the span r between both centres.
    Sphere,
}

impl Surface {
    /// The form q of r and n.
    pub(super) fn form(self, [r, n]: [Vector3<f64>; 2]) -> f64 {
        match self {
            Self::Plane(n) => n.dot(&r),
            Self::MovingPlane => n.dot(&r),
            Self::Sphere => 0.5 * r.dot(&r),
        }
    }

    /// Derivatives of the form by r and n.
    pub(super) fn gradient(self, [r, n]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
        match self {
            Self::Plane(n) => [n, Vector3::zeros()],
            Self::MovingPlane => [n, r],
            Self::Sphere => [r, Vector3::zeros()],
        }
    }

    /// Rates of these derivatives at rates of r and n.
    pub(super) fn bend(self, rates: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
        match self {
            Self::Plane(_) => [Vector3::zeros(); 2],
            Self::MovingPlane | Self::Sphere => self.gradient(rates),
        }
    }

    /// Second derivative of the form by the vectors `a` and `b` of r and n: this times the identity.
    pub(super) fn curvature(self, a: usize, b: usize) -> f64 {
        let is_curved = match self {
            Self::Plane(_) => false,
            Self::MovingPlane => a != b,
            Self::Sphere => a == b,
        };
        f64::from(u8::from(is_curved))
    }

    /// Height as a function of the form, with three derivatives.
    fn height(self, q: f64) -> [f64; 4] {
        match self {
            Self::Plane(_) | Self::MovingPlane => [q, 1.0, 0.0, 0.0],
            Self::Sphere => {
                let [height, square] = [(2.0 * q).sqrt(), 2.0 * q];
                let slope = height.recip();
                [
                    height,
                    slope,
                    -slope / square,
                    3.0 * slope / (square * square),
                ]
            }
        }
    }
}

/// Normal force of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLaw {
    /// Side that the round shape touches.
    pub surface: Surface,
    /// Height in mm at which both touch without an overlap.
    pub distance: f64,
    /// Stiffness k in N/mmᵖ.
    pub stiffness: f64,
    /// Exponent p of the force.
    pub exponent: f64,
    /// Width w in mm over which the stiffness grows; zero where it jumps.
    pub smoothing: f64,
    /// Damping a in ms/mm; zero for none.
    pub damping: f64,
    /// Width of φ = 1 + a ẋ around zero over which it comes to zero.
    pub release: f64,
}

/// Overlap, force and its growth by damping at one place of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Overlap x in mm, negative where a gap is open.
    pub overlap: f64,
    /// Normal force in N.
    pub force: f64,
}

impl ContactLaw {
    /// Elastic energy of an overlap with three derivatives.
    fn of_overlap(&self, x: f64) -> [f64; 4] {
        let s = ramp(x, self.smoothing);
        if s[0] == 0.0 {
            return [0.0; 4];
        }
        let (k, p) = (self.stiffness, self.exponent);
        let power = k * s[0].powf(p);
        let [slope, bend] = [p * power / s[0], p * (p - 1.0) * power / (s[0] * s[0])];
        // Of a linear force, even where the quotient overflows.
        let bend = if p == 1.0 { 0.0 } else { bend };
        chain([power * s[0] / (p + 1.0), power, slope, bend], s)
    }

    /// Growth φ of the force at a rate of the overlap with three derivatives.
    fn growth(&self, rate: f64) -> [f64; 4] {
        let a = self.damping;
        chain(ramp(1.0 + a * rate, self.release), [rate, a, 0.0, 0.0])
    }

    /// Gap as a function of the form q with three derivatives.
    fn gap(&self, q: f64) -> [f64; 4] {
        let mut gap = self.surface.height(q);
        gap[0] -= self.distance;
        gap
    }

    /// Slope ∂H/∂q of the height, elastic force f and its growth φ as jets to second order of q and its rate α.
    pub(super) fn force<const M: usize>(&self, q: &Jet<M, 2>, alpha: &Jet<M, 2>) -> [Jet<M, 2>; 3] {
        let gap @ [_, h1, h2, h3] = self.gap(q.value);
        let overlap = gap.map(|x| -x);
        let [_, f, f1, f2] = self.of_overlap(overlap[0]);
        let slope = q.map([h1, h2, h3, 0.0]);
        let force = q.map(chain([f, f1, f2, 0.0], overlap));
        let rate = -(slope * *alpha);
        [slope, force, rate.map(self.growth(rate.value))]
    }

    /// Overlap and normal force at r and n and their rates.
    pub fn touch(&self, [at, rates]: [[Vector3<f64>; 2]; 2]) -> Touch {
        let [by_r, by_n] = self.surface.gradient(at);
        let rate = by_r.dot(&rates[0]) + by_n.dot(&rates[1]);
        self.touch_at(self.surface.form(at), rate)
    }

    /// Returns true if there is no force at the form.
    pub(super) fn is_open(&self, form: f64) -> bool {
        self.of_overlap(-self.gap(form)[0])[1] == 0.0
    }

    /// Overlap and normal force at the form and its rate.
    pub(super) fn touch_at(&self, form: f64, rate: f64) -> Touch {
        let [gap, slope, ..] = self.gap(form);
        let overlap = -gap;
        let rate = -slope * rate;
        Touch {
            overlap,
            force: self.of_overlap(overlap)[1] * self.growth(rate)[0],
        }
    }
}

/// The vector at place `i` of arguments, three each; zero beyond them.
pub(super) fn vector<const M: usize>(p: &SVector<f64, M>, i: usize) -> Vector3<f64> {
    match 3 * i < M {
        true => p.fixed_rows::<3>(3 * i).into(),
        false => Vector3::zeros(),
    }
}

/// Elastic energy W of a contact; arguments: r, and n of a plane of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactElasticity(pub ContactLaw);

impl ContactElasticity {
    /// The energy as a function of the form q with three derivatives.
    pub(super) fn of(&self, q: f64) -> [f64; 4] {
        let overlap = self.0.gap(q).map(|x| -x);
        chain(self.0.of_overlap(overlap[0]), overlap)
    }
}

/// A function of the form of a contact, at a place and along rates of it.
#[derive(Clone, Copy, Debug)]
pub struct OfForm {
    surface: Surface,
    gradient: [Vector3<f64>; 2],
    bend: [Vector3<f64>; 2],
    /// Rate of the form.
    rate: f64,
    /// Value and three derivatives.
    of: [f64; 4],
}

impl OfForm {
    fn new<const M: usize>(
        surface: Surface,
        of: impl Fn(f64) -> [f64; 4],
        [p, w]: [&SVector<f64, M>; 2],
    ) -> Self {
        let [at, along] = [p, w].map(|x| [0, 1].map(|i| vector(x, i)));
        let gradient = surface.gradient(at);
        Self {
            surface,
            gradient,
            bend: surface.bend(along),
            rate: gradient[0].dot(&along[0]) + gradient[1].dot(&along[1]),
            of: of(surface.form(at)),
        }
    }
}

impl Local for OfForm {
    fn value(&self) -> f64 {
        self.of[0]
    }

    fn plain<const NV: usize>(&self) -> impl Derivatives {
        *self
    }

    fn along<const NV: usize>(&self) -> impl Derivatives {
        FormRates(*self)
    }
}

impl Derivatives for OfForm {
    fn force(&self, i: usize) -> Vector3<f64> {
        self.gradient[i] * self.of[1]
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let [a, b] = [i, j].map(|i| self.gradient[i]);
        Matrix3::from_diagonal_element(self.of[1] * self.surface.curvature(i, j))
            + a * (b * self.of[2]).transpose()
    }
}

/// Its rates.
struct FormRates(OfForm);

impl Derivatives for FormRates {
    fn force(&self, i: usize) -> Vector3<f64> {
        let of = &self.0;
        of.bend[i] * of.of[1] + of.gradient[i] * (of.of[2] * of.rate)
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        let of = &self.0;
        let [a, b] = [i, j].map(|i| (of.gradient[i], of.bend[i]));
        Matrix3::from_diagonal_element(of.of[2] * of.rate * of.surface.curvature(i, j))
            + (a.0 * b.1.transpose() + a.1 * b.0.transpose()) * of.of[2]
            + a.0 * (b.0 * (of.of[3] * of.rate)).transpose()
    }
}

/// Virtual work of the damping of a contact, `f (φ − 1) δH` of the height H; arguments: variations of r, and n of a plane of a body, then
/// their midpoints, then their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactDamping(pub ContactLaw);

impl ContactDamping {
    /// The work of `K` − 1 arguments, with the normal of a plane that does not turn behind them.
    fn local<const K: usize, const M: usize>(&self, p: &SVector<f64, M>) -> OfDotProducts<K> {
        let law = &self.0;
        let mut vectors = std::array::from_fn(|i| vector(p, i));
        let [virtual_rate, form, rate]: [&[[usize; 2]]; 3] = match law.surface {
            Surface::Plane(normal) => {
                vectors[K - 1] = normal;
                [&[[0, 3]], &[[1, 3]], &[[2, 3]]]
            }
            Surface::Sphere => [&[[0, 1]], &[[1, 1]], &[[2, 1]]],
            Surface::MovingPlane => [&[[0, 3], [1, 2]], &[[2, 3]], &[[4, 3], [5, 2]]],
        };
        let mut work = OfDotProducts::new(vectors);
        work.add([virtual_rate], [form, rate], |[q, alpha]| {
            let [slope, force, growth] = law.force(&q, &alpha);
            [force * growth.shifted(-1.0) * slope]
        });
        work
    }
}

/// Gap of a contact in mm, negative where both sides overlap; arguments as of its elasticity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactGap(pub ContactLaw);

impl ContactGap {
    /// The gap as a function of the form q with three derivatives.
    pub(super) fn of(&self, q: f64) -> [f64; 4] {
        self.0.gap(q)
    }
}

/// Normal force of a contact in a unit; arguments: midpoints of r, and n of a plane of a body, then their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactForce {
    /// The law.
    pub law: ContactLaw,
    /// Unit in N.
    pub unit: f64,
}

impl ContactForce {
    /// The force of `K` − 1 arguments, with the normal of a plane that does not turn behind them.
    fn local<const K: usize, const M: usize>(&self, p: &SVector<f64, M>) -> OfDotProducts<K> {
        let mut vectors = std::array::from_fn(|i| vector(p, i));
        let products: [&[[usize; 2]]; 2] = match self.law.surface {
            Surface::Plane(normal) => {
                vectors[K - 1] = normal;
                [&[[0, 2]], &[[1, 2]]]
            }
            Surface::Sphere => [&[[0, 0]], &[[0, 1]]],
            Surface::MovingPlane => [&[[0, 1]], &[[2, 1], [0, 3]]],
        };
        let mut out = OfDotProducts::new(vectors);
        let [q, alpha] = out.arguments(products);
        let [_, force, growth] = self.law.force(&q, &alpha);
        out.add_function(products, (force * growth).scaled(self.unit.recip()));
        out
    }
}

/// Implements functions of the form for numbers of vectors.
macro_rules! functions_of_form {
    ($($formula:ident, $($arguments:literal)*;)*) => {
        $($(
            impl Energy<$arguments> for $formula {
                type Local<const ORDER: usize> = OfForm;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $arguments>,
                    w: &SVector<f64, $arguments>,
                ) -> OfForm {
                    OfForm::new(self.0.surface, |q| self.of(q), [p, w])
                }
            }
        )*)*
    };
}

functions_of_form! {
    ContactElasticity, 3 6;
    ContactGap, 3 6;
}

/// Implements the force for numbers of vectors, each of which is read twice: its midpoint and rate.
macro_rules! normal_force {
    ($($vectors:literal of $arguments:literal as $local:ty;)*) => {
        $(
            impl Energy<$arguments> for ContactForce {
                type Local<const ORDER: usize> = $local;

                const READINGS: usize = 2;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $arguments>,
                    _: &SVector<f64, $arguments>,
                ) -> $local {
                    self.local(p)
                }
            }
        )*
    };
}

normal_force! {
    1 of 6 as OfDotProducts<3>;
    2 of 12 as OfDotProducts<5>;
}

/// Implements a virtual work for numbers of vectors, each of which is read three times: its variation, midpoint and rate.
macro_rules! virtual_work {
    ($($formula:ty, $vectors:literal of $arguments:literal as $local:ty;)*) => {
        $(
            impl Energy<$arguments> for $formula {
                type Local<const ORDER: usize> = $local;

                const VIRTUAL: usize = $vectors;
                const READINGS: usize = 3;

                fn at<const ORDER: usize>(
                    &self,
                    p: &SVector<f64, $arguments>,
                    _: &SVector<f64, $arguments>,
                ) -> $local {
                    self.local(p)
                }
            }
        )*
    };
}

pub(super) use virtual_work;

virtual_work! {
    ContactDamping, 1 of 9 as OfDotProducts<4>;
    ContactDamping, 2 of 18 as OfDotProducts<7>;
}
