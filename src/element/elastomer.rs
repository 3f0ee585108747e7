//! The material law of an elastomer, passive or dielectric, and the energy of an element of it.

use super::evaluation::{ElementEnergy, NodeState};
use super::isochoric::{ElementLaw, IsochoricLaw};
use super::law::{Dielectric, Field, Passive, Volume};
use super::local::{Local, Output};
use super::number::Points;
use super::variations::{ElementState, Variations};
use crate::energy::NeoHooke;

/// A compressible neo-Hookean elastomer, with the electric part of its energy where it is [`Dielectric`](crate::element::Dielectric).
///
/// Per reference volume, with F = Σ x_i ⊗ G_i, E = −Σ φ_i G_i, J = det F,
///
/// ```text
/// Ω = μ/2 (F:F − 3) − μ ln J + λ/2 ln²J  +  c₁ |E|² + c₂ |F E|² − ½ ε |cof(F) E|²/J.
/// ```
///
/// With an [`IsochoricLaw`] ψ the first three terms are ψ(Ī₁, Ī₂) + ½ (λ + ⅔ μ) ln²J, which has the same moduli μ and λ at F = 1.
///
/// NaN where J ≤ 0 at a Gauss point; solvers step back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastomer<F, L = NeoHooke> {
    /// Shear modulus μ in MPa.
    pub shear_modulus: f64,
    /// First Lamé constant λ in MPa.
    pub lame_lambda: f64,
    /// Points at which λ/2 ln²J is evaluated.
    pub volume: Volume,
    /// The electric part: [`Passive`] or [`Dielectric`](crate::element::Dielectric).
    pub field: F,
    /// Law of elasticity: [`NeoHooke`], or an [`IsochoricLaw`](crate::element::IsochoricLaw).
    pub law: L,
}

impl<L> Elastomer<Dielectric, L> {
    /// μ and λ in MPa, c₁, c₂ and ε in N/V².
    pub fn constants(&self) -> [f64; 5] {
        let field = &self.field;
        [
            self.shear_modulus,
            self.lame_lambda,
            field.c1,
            field.c2,
            field.permittivity,
        ]
    }

    /// The same with other constants, in the order of [`constants`](Self::constants).
    #[must_use]
    pub fn with_constants(self, constants: [f64; 5]) -> Self {
        let [shear_modulus, lame_lambda, c1, c2, permittivity] = constants;
        Self {
            shear_modulus,
            lame_lambda,
            field: Dielectric {
                c1,
                c2,
                permittivity,
            },
            ..self
        }
    }
}

impl<F: Field, L: ElementLaw> Elastomer<F, L> {
    /// The same constants with another law of elasticity.
    pub fn by<M>(self, law: M) -> Elastomer<F, M> {
        Elastomer {
            shear_modulus: self.shear_modulus,
            lame_lambda: self.lame_lambda,
            volume: self.volume,
            field: self.field,
            law,
        }
    }

    /// Factors of F:F/2 − ln J and of ½ ln²J in MPa.
    #[inline(always)]
    pub(super) fn moduli(&self) -> [f64; 2] {
        self.law.moduli(self.shear_modulus, self.lame_lambda)
    }

    /// The isochoric law with its shear modulus, where it is one.
    #[inline(always)]
    pub(super) fn isochoric(&self) -> Option<(IsochoricLaw, f64)> {
        self.law.isochoric().map(|law| (law, self.shear_modulus))
    }

    /// The law without the field.
    pub fn passive(&self) -> Elastomer<Passive, L> {
        self.with(Passive)
    }

    /// The same elasticity with another field.
    pub fn with<G>(&self, field: G) -> Elastomer<G, L> {
        Elastomer {
            shear_modulus: self.shear_modulus,
            lame_lambda: self.lame_lambda,
            volume: self.volume,
            field,
            law: self.law,
        }
    }
}

impl<F: Field, L: ElementLaw, const NODES: usize> ElementEnergy<NODES> for Elastomer<F, L> {
    type Arguments = F::Potentials<NODES>;
    type Local = Local<F, NODES>;

    #[inline(always)]
    fn write<N: Points, const ORDER: usize>(
        &self,
        token: N::Token,
        at: &NodeState<'_, F::Potentials<NODES>, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let [values, rates] = at
            .arguments
            .map(|potentials| self.field.constants(potentials));
        let mut phi = [N::uniform(0.0, 0.0); NODES];
        if let (Some((_, values)), Some((_, rates))) = (&values, &rates) {
            for i in 0..NODES {
                phi[i] = N::uniform(values[i], rates[i]);
            }
        }
        let [shear_modulus, lame_lambda] = self.moduli();
        let state = ElementState {
            token,
            shear_modulus,
            lame_lambda,
            isochoric: self.isochoric(),
            volume: self.volume,
            shape: at.shape,
            x: &at.places::<N>(),
            electric: values.as_ref().map(|(constants, _)| (constants, &phi)),
        };
        Variations::<N>::write::<ORDER, NODES>(&state, out);
    }
}
