//! The material law of an elastomer, passive or dielectric, and the energy of an element of it.

use super::dual::{Dual, moving};
use super::geometry::ElementGeometry;
use super::isochoric::{ElementLaw, IsochoricLaw};
use super::lanes::{Lanes, Task, dispatch};
use super::law::{Dielectric, Field, Passive, Volume};
use super::local::{Local, Output, Pair};
use super::variations::{ElementState, Variations};
use crate::energy::NeoHooke;
use crate::math::Vector;
use pulp::Simd;

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

    /// Energy W in mJ of the element `shape` with nodes at `x` in mm and their potentials in V.
    pub fn energy<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
    ) -> f64 {
        let mut energy = 0.0;
        self.write::<0, NODES>(shape, x, potentials, &mut energy);
        energy
    }

    /// Fills energy, forces and charges.
    pub fn gradient<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
        local: &mut Local<F, NODES>,
    ) {
        self.write::<1, NODES>(shape, x, potentials, local);
    }

    /// Fills everything: energy, gradient, and stiffness, coupling and permittivity.
    pub fn tangent<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
        local: &mut Local<F, NODES>,
    ) {
        self.write::<2, NODES>(shape, x, potentials, local);
    }

    /// Fills `plain` as [`tangent`](Self::tangent) does, and `along` with the derivatives of all of it along
    /// (w, w_potentials): the second and third derivatives contracted with that direction.
    #[expect(
        clippy::too_many_arguments,
        reason = "a state, a direction, and their two results"
    )]
    pub fn third<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
        w: &[Vector; NODES],
        w_potentials: &F::Potentials<NODES>,
        plain: &mut Local<F, NODES>,
        along: &mut Local<F, NODES>,
    ) {
        dispatch(RatesTask {
            law: self,
            shape,
            x,
            potentials,
            w,
            w_potentials,
            out: Pair { plain, along },
        });
    }
}

impl<F: Field, L: ElementLaw> Elastomer<F, L> {
    fn write<const ORDER: usize, const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
        out: &mut impl Output<f64>,
    ) {
        dispatch(DerivativesTask::<_, _, _, ORDER, NODES> {
            law: self,
            shape,
            x,
            potentials,
            out,
        });
    }
}

/// Derivatives to the order `ORDER` at a state.
struct DerivativesTask<'a, F: Field, L, O, const ORDER: usize, const NODES: usize> {
    law: &'a Elastomer<F, L>,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    potentials: &'a F::Potentials<NODES>,
    out: &'a mut O,
}

impl<F: Field, L: ElementLaw, O: Output<f64>, const ORDER: usize, const NODES: usize> Task
    for DerivativesTask<'_, F, L, O, ORDER, NODES>
{
    #[inline(always)]
    fn run<S: Simd, const K: usize>(self, unit: S) {
        let mut x = [[0.0; 3]; NODES];
        for i in 0..NODES {
            x[i] = [self.x[i].x, self.x[i].y, self.x[i].z];
        }
        let electric = self.law.field.constants(self.potentials);
        let [shear_modulus, lame_lambda] = self.law.moduli();
        let state = ElementState {
            token: unit,
            shear_modulus,
            lame_lambda,
            isochoric: self.law.isochoric(),
            volume: self.law.volume,
            shape: self.shape,
            x: &x,
            electric: electric.as_ref().map(|(constants, phi)| (constants, phi)),
        };
        Variations::<Lanes<S, K>>::write::<ORDER, NODES>(&state, self.out);
    }
}

/// Second derivatives at a state, and their rates along a direction.
struct RatesTask<'a, F: Field, L, const NODES: usize> {
    law: &'a Elastomer<F, L>,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    potentials: &'a F::Potentials<NODES>,
    w: &'a [Vector; NODES],
    w_potentials: &'a F::Potentials<NODES>,
    out: Pair<'a, Local<F, NODES>>,
}

impl<F: Field, L: ElementLaw, const NODES: usize> Task for RatesTask<'_, F, L, NODES> {
    #[inline(always)]
    fn run<S: Simd, const K: usize>(mut self, unit: S) {
        let dual = |value: f64, rate: f64| Dual { value, rate };
        let x = moving(self.x, self.w);
        let values = self.law.field.constants(self.potentials);
        let rates = self.law.field.constants(self.w_potentials);
        let mut phi = [dual(0.0, 0.0); NODES];
        if let (Some((_, value)), Some((_, rate))) = (&values, &rates) {
            for i in 0..NODES {
                phi[i] = dual(value[i], rate[i]);
            }
        }
        let [shear_modulus, lame_lambda] = self.law.moduli();
        let state = ElementState {
            token: unit,
            shear_modulus,
            lame_lambda,
            isochoric: self.law.isochoric(),
            volume: self.law.volume,
            shape: self.shape,
            x: &x,
            electric: values.as_ref().map(|(constants, _)| (constants, &phi)),
        };
        Variations::<Dual<Lanes<S, K>>>::write::<2, NODES>(&state, &mut self.out);
    }
}
