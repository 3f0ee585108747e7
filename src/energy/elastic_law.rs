//! Laws of elasticity of a muscle and of a membrane: energies as functions of its squared stretch, or of those in its plane.
//!
//! An incompressible muscle of the stretch Λ has the principal stretches Λ, Λ^(−1/2), Λ^(−1/2), so that with I = Λ²
//!
//! ```text
//! I₁ = I + 2/√I,    I₂ = 2√I + 1/I,    Σ λᵃ = I^(a/2) + 2 I^(−a/4).
//! ```
//!
//! An incompressible [membrane](crate::energy::ElasticMembrane) has, with I = λ₁² + λ₂², D = λ₁²λ₂² and c = I/(2√D),
//!
//! ```text
//! I₁ = I + 1/D,    Σ λᵃ = 2 D^(a/4) y(c) + D^(−a/2),    y(c) = cosh(a/2 arccosh c),
//! ```
//!
//! of which y is smooth at c = 1, where both stretches are one.

use crate::energy::Coefficient;
use crate::math::{Fault, Jet, Key, Number, refuse};
use nalgebra::{SVector, Vector1};
use std::f64::consts::PI;
use std::fmt::Debug;

/// A function of I and D of a membrane.
pub type OfPlane<const ORDER: usize, T> = Jet<2, ORDER, T>;

/// A law of elasticity, the neo-Hookean one or another.
pub trait Elasticity<T: Number = f64>: Copy + Debug + Send + Sync + 'static {
    /// Energy in mJ of the volume V₀ in mm³ with the shear modulus μ in MPa as a function of I: value and three derivatives.
    fn of_squared_stretch(&self, shear_modulus: T, volume: T, i: T) -> [T; 4];

    /// Energy of a unit of volume of a membrane in MPa, as a function of I and D.
    fn of_plane<const ORDER: usize>(
        &self,
        shear_modulus: T,
        i: OfPlane<ORDER, T>,
        d: OfPlane<ORDER, T>,
    ) -> OfPlane<ORDER, T>;
}

/// A law of elasticity whose constants are functions of free parameters.
pub trait ElasticConstants: Clone + Send + Sync + 'static {
    /// The law over numbers.
    type Over<T: Number>: Elasticity<T>;

    /// The law at parameters.
    fn with<T: Number>(&self, parameters: &[T]) -> Self::Over<T>;
}

impl ElasticConstants for NeoHooke {
    type Over<T: Number> = Self;

    fn with<T: Number>(&self, _: &[T]) -> Self {
        Self
    }
}

impl ElasticConstants for ElasticLaw<Coefficient> {
    type Over<T: Number> = ElasticLaw<T>;

    fn with<T: Number>(&self, parameters: &[T]) -> ElasticLaw<T> {
        self.map(|_, constant| constant.at(parameters))
    }
}

/// The neo-Hookean law `μ/2 (I₁ − 3)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NeoHooke;

impl<T: Number> Elasticity<T> for NeoHooke {
    #[inline(always)]
    fn of_squared_stretch(&self, shear_modulus: T, volume: T, i: T) -> [T; 4] {
        let c = shear_modulus.scaled(0.5) * volume;
        let r = i.recip();
        let s = r.sqrt();
        [
            c * (s.scaled(2.0) + i).shifted(-3.0),
            c * (T::one() - s * r),
            c.scaled(1.5) * s * r * r,
            c.scaled(-3.75) * s * r * r * r,
        ]
    }

    fn of_plane<const ORDER: usize>(
        &self,
        shear_modulus: T,
        i: OfPlane<ORDER, T>,
        d: OfPlane<ORDER, T>,
    ) -> OfPlane<ORDER, T> {
        (i + d.recip()).shifted(-3.0) * shear_modulus.scaled(0.5)
    }
}

/// A law beside the neo-Hookean one. The shear modulus μ of small strains is a constant of the material, for every law the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElasticLaw<T = f64> {
    /// Gent: `−μ/2 Jₘ ln(1 − (I₁ − 3)/Jₘ)`, which stiffens without bound as I₁ − 3 approaches Jₘ. NaN beyond.
    Gent {
        /// Jₘ.
        limit: T,
    },
    /// Mooney and Rivlin: `μ/2 [(1 − s)(I₁ − 3) + s (I₂ − 3)]`.
    MooneyRivlin {
        /// s, the part of the shear modulus that belongs to I₂.
        share: T,
    },
    /// Yeoh: `μ/2 (I₁ − 3) + c₂ (I₁ − 3)² + c₃ (I₁ − 3)³`.
    Yeoh {
        /// c₂ in MPa.
        c2: T,
        /// c₃ in MPa.
        c3: T,
    },
    /// Ogden with two terms: `2μ [(1 − s)/α₁² Σ(λ^α₁ − 1) + s/α₂² Σ(λ^α₂ − 1)]`.
    Ogden {
        /// α₁ and α₂.
        exponents: [T; 2],
        /// s, the part of the shear modulus that belongs to the second term.
        share: T,
    },
}

impl<T> ElasticLaw<T> {
    /// A constant of the law by its name, that of files.
    pub fn get_mut(&mut self, name: &str) -> Option<&mut T> {
        match (self, name) {
            (Self::Gent { limit }, "limit") => Some(limit),
            (Self::MooneyRivlin { share } | Self::Ogden { share, .. }, "share") => Some(share),
            (Self::Yeoh { c2, .. }, "c2") => Some(c2),
            (Self::Yeoh { c3, .. }, "c3") => Some(c3),
            (Self::Ogden { exponents, .. }, "exponents[0]") => Some(&mut exponents[0]),
            (Self::Ogden { exponents, .. }, "exponents[1]") => Some(&mut exponents[1]),
            _ => None,
        }
    }

    /// The law of the constants that a function makes of the names, those of files, and the values of these.
    pub fn map<U>(&self, mut of: impl FnMut(&'static str, &T) -> U) -> ElasticLaw<U> {
        match self {
            Self::Gent { limit } => ElasticLaw::Gent {
                limit: of("limit", limit),
            },
            Self::MooneyRivlin { share } => ElasticLaw::MooneyRivlin {
                share: of("share", share),
            },
            Self::Yeoh { c2, c3 } => ElasticLaw::Yeoh {
                c2: of("c2", c2),
                c3: of("c3", c3),
            },
            Self::Ogden { exponents, share } => ElasticLaw::Ogden {
                exponents: [
                    of("exponents[0]", &exponents[0]),
                    of("exponents[1]", &exponents[1]),
                ],
                share: of("share", share),
            },
        }
    }
}

impl ElasticLaw {
    /// Its name in files.
    fn name(&self) -> &'static str {
        match self {
            Self::Gent { .. } => "gent",
            Self::MooneyRivlin { .. } => "mooney_rivlin",
            Self::Yeoh { .. } => "yeoh",
            Self::Ogden { .. } => "ogden",
        }
    }

    /// Checks its constants.
    ///
    /// # Errors
    /// The first one without a meaning.
    pub fn check(&self) -> Result<(), Fault> {
        let checked = self.check_constants();
        checked.map_err(|fault| fault.under(self.name()))
    }

    fn check_constants(&self) -> Result<(), Fault> {
        let part = |share: f64| {
            refuse!(unless (0.0..=1.0).contains(&share), Key("share");
                value share, expected "a part of the shear modulus from 0 to 1");
            Ok(())
        };
        match *self {
            Self::Gent { limit } => {
                refuse!(unless limit > 0.0 && limit.is_finite(), Key("limit");
                    value limit, expected "a positive number, Jm of Gent's law");
                Ok(())
            }
            Self::MooneyRivlin { share } => part(share),
            Self::Yeoh { c2, c3 } => {
                let grows = c3 > 0.0 || (c3 == 0.0 && c2 >= 0.0);
                let holds = grows && c2.is_finite() && c3.is_finite();
                refuse!(unless holds, Key("c3");
                    found format!("{c3} MPa with c2 = {c2} MPa"),
                    expected "a finite stress, and an energy that grows without bound: c3 > 0, or c3 = 0 and c2 >= 0");
                Ok(())
            }
            Self::Ogden { exponents, share } => {
                let holds = exponents.iter().all(|a| *a != 0.0 && a.is_finite());
                refuse!(unless holds, Key("exponents");
                    found format!("{exponents:?}"), expected "two numbers that are not zero");
                part(share)
            }
        }
    }

    /// The stretches between which a muscle has an energy, where not all have one: the positive zeros of Λ³ − (3 + Jₘ) Λ + 2.
    pub fn stretches(&self) -> Option<[f64; 2]> {
        let Self::Gent { limit } = *self else {
            return None;
        };
        let third = (3.0 + limit) / 3.0;
        let angle = (-third.powf(-1.5)).acos() / 3.0;
        let root = |angle: f64| 2.0 * third.sqrt() * angle.cos();
        Some([root(angle - 2.0 * PI / 3.0), root(angle)])
    }
}

/// `fⁿ`.
fn power<const M: usize, const ORDER: usize, T: Number>(
    f: &Jet<M, ORDER, T>,
    n: T,
) -> Jet<M, ORDER, T> {
    let (r, p) = (f.value.recip(), f.value.powf(n));
    let (first, second) = (n * p * r, n * n.shifted(-1.0) * p * r * r);
    f.map([p, first, second, n.shifted(-2.0) * second * r])
}

/// Terms of the series of y(c) up to c = 1.5, after which they are below rounding.
const TERMS: usize = 40;

/// y(c) = cosh(ν arccosh c) and three derivatives, by the series of `₂F₁(−ν, ν; ½; (1 − c)/2)` near one and by `(c² − 1) y″ + c y′ = ν² y`
/// elsewhere.
fn mean_of_powers<T: Number>(nu: T, c: T) -> [T; 4] {
    let z = c.shifted(-1.0).scaled(-0.5);
    if z.real().abs() > 0.25 {
        let square = (c * c).shifted(-1.0);
        let root = square.sqrt();
        let [grown, shrunk] = [nu, -nu].map(|nu| ((c + root).ln() * nu).exp());
        let y = (grown + shrunk).scaled(0.5);
        let first = nu * (grown - shrunk).scaled(0.5).over(root);
        let second = (nu * nu * y - c * first).over(square);
        let third = ((nu * nu).shifted(-1.0) * first - c.scaled(3.0) * second).over(square);
        return [y, first, second, third];
    }
    // By Horner's rule from the last coefficient on, each from the one before.
    let mut coefficients = [T::one(); TERMS];
    for next in 1..TERMS {
        let n = (next - 1) as f64;
        let ratio = (-(nu * nu))
            .shifted(n * n)
            .scaled(1.0 / ((n + 0.5) * (n + 1.0)));
        coefficients[next] = coefficients[next - 1] * ratio;
    }
    let mut sums = [T::zero(); 4];
    for coefficient in coefficients.into_iter().rev() {
        for order in (1..4).rev() {
            sums[order] = sums[order] * z + sums[order - 1];
        }
        sums[0] = sums[0] * z + coefficient;
    }
    // The sums are derivatives by z over factorials, and dz/dc = −½.
    let [y, first, second, third] = sums;
    [
        y,
        first.scaled(-0.5),
        second.scaled(0.5),
        third.scaled(-0.75),
    ]
}

impl<T: Number> ElasticLaw<T> {
    /// Energy of a unit of volume by I₁ − 3 and by Σ λᵃ − 3 of an exponent a.
    fn density<const M: usize, const ORDER: usize>(
        &self,
        shear_modulus: T,
        strain: impl Fn() -> Jet<M, ORDER, T>,
        powers: impl Fn(T) -> Jet<M, ORDER, T>,
    ) -> Jet<M, ORDER, T> {
        // The energy for μ = 1 of Σ(λᵃ − 1) for two exponents, of which the second has the share s.
        let of_powers = |exponents: [T; 2], share: T| {
            let of = |exponent: T, share: T| {
                powers(exponent) * share.scaled(2.0).over(exponent * exponent)
            };
            of(exponents[0], T::one() - share) + of(exponents[1], share)
        };
        let half = shear_modulus.scaled(0.5);
        match *self {
            Self::Gent { limit } => {
                let left = (strain() * T::of(-1.0).over(limit)).shifted(1.0);
                // The derivatives exist beyond the limit, where there is no energy.
                let left = if left.value.real() > 0.0 {
                    left
                } else {
                    left.scaled(f64::NAN)
                };
                left.ln() * (-half * limit)
            }
            Self::MooneyRivlin { share } => {
                of_powers([2.0, -2.0].map(T::of), share) * shear_modulus
            }
            Self::Yeoh { c2, c3 } => {
                let strain = strain();
                let more = strain.squared() * c2 + strain.powi(3) * c3;
                strain * half + more
            }
            Self::Ogden { exponents, share } => of_powers(exponents, share) * shear_modulus,
        }
    }
}

impl<T: Number> Elasticity<T> for ElasticLaw<T> {
    fn of_squared_stretch(&self, shear_modulus: T, volume: T, i: T) -> [T; 4] {
        let i = Jet::<1, 3, T>::argument(0, &Vector1::new(i), &SVector::repeat(T::one()));
        let strain = || (i + i.sqrt().recip().scaled(2.0)).shifted(-3.0);
        let powers = |a: T| {
            (power(&i, a.scaled(0.5)) + power(&i, a.scaled(-0.25)).scaled(2.0)).shifted(-3.0)
        };
        let jet = self.density(shear_modulus, strain, powers) * volume;
        [jet.value, jet.gradient.x, jet.hessian.x, jet.hessian_w.x]
    }

    fn of_plane<const ORDER: usize>(
        &self,
        shear_modulus: T,
        i: OfPlane<ORDER, T>,
        d: OfPlane<ORDER, T>,
    ) -> OfPlane<ORDER, T> {
        let strain = || (i + d.recip()).shifted(-3.0);
        let powers = |a: T| {
            let c = i * d.sqrt().recip().scaled(0.5);
            let mean = c.map(mean_of_powers(a.scaled(0.5), c.value));
            let in_plane = (power(&d, a.scaled(0.25)) * mean).scaled(2.0);
            (in_plane + power(&d, a.scaled(-0.5))).shifted(-3.0)
        };
        self.density(shear_modulus, strain, powers)
    }
}
