//! Isochoric energies of compressible elastomers: functions of the invariants of C/J^(2/3).
//!
//! With s = J^(−2/3), Ī₁ = s I₁, Ī₂ = s² I₂, b = FFᵀ, and of each node p_i = F G_i, m_i = s (p_i − ⅓ I₁ g_i), r_i = I₁ p_i − b p_i,
//! the energy ψ(Ī₁) + c (Ī₂ − 3) has
//!
//! ```text
//! P = 2ψ′ s (F − ⅓ I₁ F⁻ᵀ) + 2c s² (I₁ F − b F − ⅔ I₂ F⁻ᵀ)
//!
//! ∂²ψ/∂x_i∂x_j = 2ψ′ s { (G_i·G_j) 1 − ⅔ (p_i⊗g_j + g_i⊗p_j) + 2/9 I₁ g_i⊗g_j + ⅓ I₁ g_j⊗g_i } + 4ψ″ m_i⊗m_j
//! ∂²Ī₂/∂x_i∂x_j = s² { 4 p_i⊗p_j − 2 p_j⊗p_i + 2 (G_i·G_j)(I₁ 1 − b) − 2 (p_i·p_j) 1
//!                      − 8/3 (r_i⊗g_j + g_i⊗r_j) + I₂ (16/9 g_i⊗g_j + 4/3 g_j⊗g_i) }.
//! ```

use super::number::{Nine, Points, Real, Three, apply, contracted, dot, product, scale, transpose};
use crate::energy::{ElasticLaw, NeoHooke};
use std::fmt::Debug;

/// An isochoric law: that of the [`ElasticLaw`] of the same name with Ī₁ and Ī₂ in place of I₁ and I₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IsochoricLaw {
    /// Gent's law. NaN beyond Ī₁ − 3 = Jₘ.
    Gent {
        /// Jₘ.
        limit: f64,
    },
    /// Mooney and Rivlin's law.
    MooneyRivlin {
        /// Part of the shear modulus that belongs to Ī₂.
        share: f64,
    },
    /// Yeoh's law.
    Yeoh {
        /// c₂ in MPa.
        c2: f64,
        /// c₃ in MPa.
        c3: f64,
    },
    /// The first derivative of Gent's law by Jₘ.
    GentSlope {
        /// Jₘ.
        limit: f64,
    },
    /// The second one.
    GentCurvature {
        /// Jₘ.
        limit: f64,
    },
}

impl IsochoricLaw {
    /// The law of invariants; `None` of Ogden's, which is one of principal stretches.
    pub fn new(law: ElasticLaw) -> Option<Self> {
        match law {
            ElasticLaw::Gent { limit } => Some(Self::Gent { limit }),
            ElasticLaw::MooneyRivlin { share } => Some(Self::MooneyRivlin { share }),
            ElasticLaw::Yeoh { c2, c3 } => Some(Self::Yeoh { c2, c3 }),
            ElasticLaw::Ogden { .. } => None,
        }
    }

    /// ψ and its first and second derivative at Ī₁ − 3.
    #[inline(always)]
    pub(super) fn of_strain<N: Real>(&self, mu: f64, strain: N) -> [N; 3] {
        let none = strain.scaled(0.0);
        match *self {
            Self::Gent { limit } => {
                let left = strain.scaled(-1.0 / limit).shifted(1.0);
                let ln = left.ln();
                // The logarithm is NaN beyond the limit, and with it the derivatives.
                let first = (left.recip() + ln.scaled(0.0)).scaled(0.5 * mu);
                let second = (first * left.recip()).scaled(1.0 / limit);
                [ln.scaled(-0.5 * mu * limit), first, second]
            }
            Self::MooneyRivlin { share } => {
                let c = 0.5 * mu * (1.0 - share);
                [strain.scaled(c), none.shifted(c), none]
            }
            Self::Yeoh { c2, c3 } => {
                let inner = strain.scaled(c3).shifted(c2);
                let value = strain * (strain * inner).shifted(0.5 * mu);
                let first = (strain * strain.scaled(3.0 * c3).shifted(2.0 * c2)).shifted(0.5 * mu);
                [value, first, strain.scaled(6.0 * c3).shifted(2.0 * c2)]
            }
            Self::GentSlope { limit } => {
                let left = strain.scaled(-1.0 / limit).shifted(1.0);
                let (ln, r) = (left.ln(), left.recip());
                let c = 0.5 * mu / limit;
                let value = (ln + r).shifted(-1.0).scaled(-0.5 * mu);
                let first = (r - r * r).scaled(c) + ln.scaled(0.0);
                [
                    value,
                    first,
                    (r * r - (r * r * r).scaled(2.0)).scaled(c / limit),
                ]
            }
            Self::GentCurvature { limit } => {
                let left = strain.scaled(-1.0 / limit).shifted(1.0);
                let (r, c) = (left.recip(), 0.5 * mu / limit);
                let more = r.shifted(-1.0);
                let second = (r * r * r * r).scaled(3.0) - (r * r * r).scaled(2.0);
                [
                    (more * more).scaled(c) + left.ln().scaled(0.0),
                    (more * r * r).scaled(2.0 * c / limit),
                    second.scaled(2.0 * c / (limit * limit)),
                ]
            }
        }
    }

    /// c, where the energy has a part c (Ī₂ − 3).
    #[inline(always)]
    pub(super) fn of_second_invariant(&self, mu: f64) -> Option<f64> {
        match *self {
            Self::MooneyRivlin { share } => Some(0.5 * mu * share),
            _ => None,
        }
    }

    /// Its first and second derivative by Jₘ, laws without a volumetric energy; `None` where it is not Gent's.
    pub fn by_limit(self) -> Option<[Self; 2]> {
        match self {
            Self::Gent { limit } => {
                Some([Self::GentSlope { limit }, Self::GentCurvature { limit }])
            }
            _ => None,
        }
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::NeoHooke {}
    impl Sealed for super::IsochoricLaw {}
}

/// The law of elasticity of an element: the compressible neo-Hookean one ([`NeoHooke`]), or an [`IsochoricLaw`] beside
/// ½ (λ + ⅔ μ) ln²J.
pub trait ElementLaw: sealed::Sealed + Copy + Debug + Send + Sync + 'static {
    /// The isochoric law, where it is one.
    #[doc(hidden)]
    fn isochoric(&self) -> Option<IsochoricLaw>;

    /// Factors of F:F/2 − ln J and of ½ ln²J in MPa.
    #[doc(hidden)]
    #[inline(always)]
    fn moduli(&self, mu: f64, lambda: f64) -> [f64; 2] {
        match self.isochoric() {
            None => [mu, lambda],
            Some(IsochoricLaw::GentSlope { .. } | IsochoricLaw::GentCurvature { .. }) => [0.0; 2],
            Some(_) => [0.0, lambda + 2.0 / 3.0 * mu],
        }
    }
}

impl ElementLaw for NeoHooke {
    #[inline(always)]
    fn isochoric(&self) -> Option<IsochoricLaw> {
        None
    }
}

impl ElementLaw for IsochoricLaw {
    #[inline(always)]
    fn isochoric(&self) -> Option<IsochoricLaw> {
        Some(*self)
    }
}

/// The isochoric energy at the Gauss points.
#[expect(non_snake_case, reason = "notation of the law")]
pub(super) struct Isochoric<N> {
    /// ψ + c (Ī₂ − 3).
    pub(super) energy: N,
    /// 2ψ′ s.
    first: N,
    /// 4ψ″.
    second: N,
    /// s.
    s: N,
    I1: N,
    /// I₂, b = FFᵀ and c s², where the energy depends on Ī₂.
    of_second: Option<(N, Nine<N>, N)>,
}

/// p_i, m_i, and where the energy depends on Ī₂ r_i, of a node.
#[derive(Clone, Copy)]
pub(super) struct IsochoricNode<N> {
    p: Three<N>,
    m: Three<N>,
    r: Option<Three<N>>,
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<N: Points> Isochoric<N> {
    #[inline(always)]
    pub(super) fn new(law: IsochoricLaw, mu: f64, F: &Nine<N>, ln_J: N) -> Self {
        let s = ln_J.scaled(-2.0 / 3.0).exp();
        let I1 = contracted(F, F);
        let [value, first, second] = law.of_strain(mu, (I1 * s).shifted(-3.0));
        let mut energy = value;
        let of_second = match law.of_second_invariant(mu) {
            None => None,
            Some(c) => {
                let b = product(F, &transpose(F));
                let I2 = (I1 * I1 - contracted(&b, &b)).scaled(0.5);
                energy = energy + (I2 * s * s).shifted(-3.0).scaled(c);
                Some((I2, b, (s * s).scaled(c)))
            }
        };
        Self {
            energy,
            first: (first * s).scaled(2.0),
            second: second.scaled(4.0),
            s,
            I1,
            of_second,
        }
    }

    /// Adds its stress to P.
    #[inline(always)]
    pub(super) fn add_stress(&self, F: &Nine<N>, T: &Nine<N>, P: &mut Nine<N>) {
        let third = self.I1.scaled(1.0 / 3.0);
        for a in 0..3 {
            for m in 0..3 {
                let of_first = F[a][m].minus_product(third, T[a][m]);
                P[a][m] = P[a][m].plus_product(self.first, of_first);
            }
        }
        if let Some((I2, b, c)) = &self.of_second {
            let bF = product(b, F);
            let (twice, part) = (c.scaled(2.0), I2.scaled(2.0 / 3.0));
            for a in 0..3 {
                for m in 0..3 {
                    let of_second = (self.I1 * F[a][m] - bF[a][m]).minus_product(part, T[a][m]);
                    P[a][m] = P[a][m].plus_product(twice, of_second);
                }
            }
        }
    }

    /// The vectors of a node with p_i and g_i.
    #[inline(always)]
    pub(super) fn node(&self, p: Three<N>, g: Three<N>) -> IsochoricNode<N> {
        let third = self.I1.scaled(1.0 / 3.0);
        let mut m = p;
        for a in 0..3 {
            m[a] = p[a].minus_product(third, g[a]) * self.s;
        }
        let r = match &self.of_second {
            None => None,
            Some((_, b, _)) => {
                let bp = apply(b, p);
                let mut r = scale(p, self.I1);
                for a in 0..3 {
                    r[a] = r[a] - bp[a];
                }
                Some(r)
            }
        };
        IsochoricNode { p, m, r }
    }

    /// The second derivative by the places of two nodes, with their g_i and g_j, and with G_i·G_j.
    #[inline(always)]
    pub(super) fn block(
        &self,
        [i, j]: [&IsochoricNode<N>; 2],
        [gi, gj]: [Three<N>; 2],
        plain: N,
    ) -> Nine<N> {
        let mut block = [[plain.scaled(0.0); 3]; 3];
        let (symmetric, swapped) = (self.I1.scaled(2.0 / 9.0), self.I1.scaled(1.0 / 3.0));
        let pp = dot(i.p, j.p);
        for a in 0..3 {
            for b in 0..3 {
                let (gg, swap) = (gi[a] * gj[b], gj[a] * gi[b]);
                let mixed = (i.p[a] * gj[b]).plus_product(gi[a], j.p[b]);
                let mut first =
                    (symmetric * gg).plus_product(swapped, swap) - mixed.scaled(2.0 / 3.0);
                if a == b {
                    first = first + plain;
                }
                let mut sum = (self.first * first).plus_product(self.second, i.m[a] * j.m[b]);
                if let (Some((I2, left, c)), Some(ri), Some(rj)) = (&self.of_second, i.r, j.r) {
                    let along = (i.p[a] * j.p[b]).scaled(4.0) - (j.p[a] * i.p[b]).scaled(2.0);
                    let mixed = (ri[a] * gj[b]).plus_product(gi[a], rj[b]).scaled(8.0 / 3.0);
                    let volume = gg.scaled(16.0 / 9.0) + swap.scaled(4.0 / 3.0);
                    let mut second = (along - mixed).plus_product(*I2, volume);
                    second = second - (plain * left[a][b]).scaled(2.0);
                    if a == b {
                        second = second + (plain * self.I1 - pp).scaled(2.0);
                    }
                    sum = sum.plus_product(*c, second);
                }
                block[a][b] = sum;
            }
        }
        block
    }
}
