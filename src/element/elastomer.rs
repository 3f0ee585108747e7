//! The material law of an elastomer, passive or dielectric, and the energy of an element of it.

use super::dispatch::{Task, dispatch};
use super::dual::Dual;
use super::geometry::ElementGeometry;
use super::lanes::Lanes;
use super::law::{Field, Passive, Volume};
use super::local::{Local, Output, Pair};
use super::state::ElementState;
use super::variations::Variations;
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
/// NaN where J ≤ 0 at a Gauss point; solvers step back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastomer<F> {
    /// Shear modulus μ in MPa.
    pub shear_modulus: f64,
    /// First Lamé constant λ in MPa.
    pub lame_lambda: f64,
    /// Points at which λ/2 ln²J is evaluated.
    pub volume: Volume,
    /// The electric part: [`Passive`] or [`Dielectric`](crate::element::Dielectric).
    pub field: F,
}

impl<F: Field> Elastomer<F> {
    /// The law without the field.
    pub fn passive(&self) -> Elastomer<Passive> {
        Elastomer {
            shear_modulus: self.shear_modulus,
            lame_lambda: self.lame_lambda,
            volume: self.volume,
            field: Passive,
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
        dispatch(DerivativesTask::<_, _, 0, NODES> {
            law: self,
            shape,
            x,
            potentials,
            out: &mut energy,
        });
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
        dispatch(DerivativesTask::<_, _, 1, NODES> {
            law: self,
            shape,
            x,
            potentials,
            out: local,
        });
    }

    /// Fills everything: energy, gradient, and stiffness, coupling and permittivity.
    pub fn tangent<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
        local: &mut Local<F, NODES>,
    ) {
        dispatch(DerivativesTask::<_, _, 2, NODES> {
            law: self,
            shape,
            x,
            potentials,
            out: local,
        });
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

/// Derivatives to the order `ORDER` at a state.
struct DerivativesTask<'a, F: Field, O, const ORDER: usize, const NODES: usize> {
    law: &'a Elastomer<F>,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    potentials: &'a F::Potentials<NODES>,
    out: &'a mut O,
}

impl<F: Field, O: Output<f64>, const ORDER: usize, const NODES: usize> Task
    for DerivativesTask<'_, F, O, ORDER, NODES>
{
    type Output = ();

    #[inline(always)]
    fn run<S: Simd, const K: usize>(self, unit: S) {
        let mut x = [[0.0; 3]; NODES];
        for i in 0..NODES {
            x[i] = [self.x[i].x, self.x[i].y, self.x[i].z];
        }
        let electric = self.law.field.constants(self.potentials);
        let state = ElementState {
            token: unit,
            shear_modulus: self.law.shear_modulus,
            lame_lambda: self.law.lame_lambda,
            volume: self.law.volume,
            shape: self.shape,
            x: &x,
            electric: electric.as_ref().map(|(constants, phi)| (constants, phi)),
        };
        Variations::<Lanes<S, K>>::write::<ORDER, NODES>(&state, self.out);
    }
}

/// Second derivatives at a state, and their rates along a direction.
struct RatesTask<'a, F: Field, const NODES: usize> {
    law: &'a Elastomer<F>,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    potentials: &'a F::Potentials<NODES>,
    w: &'a [Vector; NODES],
    w_potentials: &'a F::Potentials<NODES>,
    out: Pair<'a, F, NODES>,
}

impl<F: Field, const NODES: usize> Task for RatesTask<'_, F, NODES> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd, const K: usize>(mut self, unit: S) {
        let dual = |value: f64, rate: f64| Dual { value, rate };
        let mut x = [[dual(0.0, 0.0); 3]; NODES];
        for i in 0..NODES {
            for a in 0..3 {
                x[i][a] = dual(self.x[i][a], self.w[i][a]);
            }
        }
        let values = self.law.field.constants(self.potentials);
        let rates = self.law.field.constants(self.w_potentials);
        let mut phi = [dual(0.0, 0.0); NODES];
        if let (Some((_, value)), Some((_, rate))) = (&values, &rates) {
            for i in 0..NODES {
                phi[i] = dual(value[i], rate[i]);
            }
        }
        let state = ElementState {
            token: unit,
            shear_modulus: self.law.shear_modulus,
            lame_lambda: self.law.lame_lambda,
            volume: self.law.volume,
            shape: self.shape,
            x: &x,
            electric: values.as_ref().map(|(constants, _)| (constants, &phi)),
        };
        Variations::<Dual<Lanes<S, K>>>::write::<2, NODES>(&state, &mut self.out);
    }
}
