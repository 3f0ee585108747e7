//! Energy of an element, its gradient and its tangent, over any number.
//!
//! With g_i = F⁻ᵀG_i, e = F⁻ᵀE, ω = F⁻¹e, κ = εJ, and θ = J U′(J) of the volumetric energy U,
//!
//! ```text
//! P = μF + (θ − μ − κ/2 e·e) F⁻ᵀ + 2c₂ (FE)⊗E + κ e⊗ω          ∂W/∂x_i = Σ w P G_i
//! D = −2c₁ E − 2c₂ Fᵀ(FE) + κ ω                               ∂W/∂φ_i = Σ w D·G_i
//!
//! ∂²W/∂x_i∂x_j = Σ w { [μ G_i·G_j + 2c₂ (E·G_i)(E·G_j)] 1 + α g_j⊗g_i + β g_i⊗g_j
//!                      + d⊗e − e⊗d − κ (g_i·g_j) e⊗e }
//! ∂²W/∂x_i∂φ_j = −Σ w { 2c₂ [(E·G_i) F G_j + (G_i·G_j) FE] + κ [s_i g_j − s_j g_i + (g_i·g_j) e] }
//! ∂²W/∂φ_i∂φ_j = Σ w { 2c₁ G_i·G_j + 2c₂ (F G_i)·(F G_j) − κ g_i·g_j }
//!
//! α = μ − θ + κ/2 e·e,    β = J θ′(J) + θ − κ/2 e·e,    d = κ (s_j g_i − s_i g_j),    s_i = e·g_i.
//! ```
//!
//! Pointwise θ = λ ln J and β = λ − κ/2 e·e. Of the mean dilatation J̄, θ = J p with p = λ ln J̄/J̄ and β = θ − κ/2 e·e;
//! V λ (1 − ln J̄)/J̄² ∂J̄/∂x_i ⊗ ∂J̄/∂x_j comes on top.
//!
//! A block is its symmetric part plus its skew part, α g_j⊗g_i + β g_i⊗g_j + d⊗e − e⊗d having the axial vector
//! (β − α)/2 g_i × g_j + d × e.

use crate::element::geometry::{ElementGeometry, Kinematics, load, minus_gradient_of};
use crate::element::isochoric::{Isochoric, IsochoricLaw};
use crate::element::law::{Dielectric, Volume};
use crate::element::local::Output;
use crate::element::number::{
    Nine, Points, Real, Three, apply, apply_plain, cross, dot, dot_plain, scale, sums, transpose,
};

/// Quantities at the Gauss points that energy, gradient and tangent share.
#[expect(non_snake_case, reason = "notation of the law")]
pub(super) struct Variations<N: Points> {
    w: N::Plain,
    F: Nine<N>,
    /// F⁻ᵀ.
    T: Nine<N>,
    J: N,
    ln_J: N,
    /// θ = J U′(J).
    theta: N,
    /// J θ′(J) + θ.
    beta: N,
    electric: Option<ElectricField<N>>,
    mean: Option<Mean<N::Uniform>>,
    isochoric: Option<Isochoric<N>>,
}

/// The mean dilatation.
#[derive(Clone, Copy)]
struct Mean<U> {
    /// V λ/2 ln²J̄.
    energy: U,
    /// λ (1 − ln J̄)/(J̄² V), the factor of ∂(VJ̄)/∂x_i ⊗ ∂(VJ̄)/∂x_j.
    factor: U,
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<N: Points> Variations<N> {
    /// Writes the energy; its gradient if `ORDER` ≥ 1; its tangent if `ORDER` ≥ 2.
    #[inline(always)]
    pub(super) fn write<const ORDER: usize, const NODES: usize>(
        state: &ElementState<'_, N, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let point = Self::new(state);
        out.energy(point.energy(state));
        if ORDER >= 1 {
            point.gradient(state, out);
        }
        if ORDER >= 2 {
            point.tangent(state, out);
        }
    }

    #[inline(always)]
    fn new<const NODES: usize>(state: &ElementState<'_, N, NODES>) -> Self {
        let token = state.token;
        let Kinematics { w, F, T, J } = Kinematics::<N>::new(token, state.shape, state.x);
        let ln_J = J.ln();
        let lambda = state.lame_lambda;
        let (theta, beta, mean) = match state.volume {
            Volume::Pointwise => (ln_J.scaled(lambda), N::constant(token, lambda), None),
            Volume::Mean => {
                let volume = state.shape.volume();
                let mean = J.times(w).sum().scaled(1.0 / volume);
                let (ln, inverse) = (mean.ln(), mean.recip());
                let pressure = (ln * inverse).scaled(lambda);
                let theta = J * N::splat(token, pressure);
                let mean = Mean {
                    energy: (ln * ln).scaled(0.5 * lambda * volume),
                    factor: ((-ln).shifted(1.0) * inverse * inverse).scaled(lambda / volume),
                };
                (theta, theta, Some(mean))
            }
        };
        let electric = match state.electric {
            None => None,
            Some((constants, phi)) => {
                let E = minus_gradient_of::<N, NODES>(token, state.shape, phi);
                let spatial = apply(&T, E);
                let kappa = J.scaled(constants.permittivity);
                Some(ElectricField {
                    reference: E,
                    spatial,
                    pulled: apply(&transpose(&T), spatial),
                    pushed: apply(&F, E),
                    kappa,
                    pressure: (kappa * dot(spatial, spatial)).scaled(0.5),
                })
            }
        };
        let isochoric = match state.isochoric {
            None => None,
            Some((law, mu)) => Some(Isochoric::new(law, mu, &F, ln_J)),
        };
        Self {
            w,
            F,
            T,
            J,
            ln_J,
            theta,
            beta,
            electric,
            mean,
            isochoric,
        }
    }

    #[inline(always)]
    fn energy<const NODES: usize>(&self, state: &ElementState<'_, N, NODES>) -> N::Uniform {
        let F = &self.F;
        let square = dot(F[0], F[0]) + dot(F[1], F[1]) + dot(F[2], F[2]);
        let strain = square.shifted(-3.0).scaled(0.5) - self.ln_J;
        let mut density = strain.scaled(state.shear_modulus);
        if self.mean.is_none() {
            density = density + (self.ln_J * self.ln_J).scaled(0.5 * state.lame_lambda);
        }
        if let (Some(field), Some((constants, _))) = (&self.electric, state.electric) {
            let (E, y) = (field.reference, field.pushed);
            density = density + dot(E, E).scaled(constants.c1) + dot(y, y).scaled(constants.c2)
                - field.pressure;
        }
        if let Some(isochoric) = &self.isochoric {
            density = density + isochoric.energy;
        }
        let energy = density.times(self.w).sum();
        match self.mean {
            Some(mean) => energy + mean.energy,
            None => energy,
        }
    }

    #[inline(always)]
    fn gradient<const NODES: usize>(
        &self,
        state: &ElementState<'_, N, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let token = state.token;
        let mu = state.shear_modulus;
        let mut isotropic = self.theta.shifted(-mu);
        if let Some(field) = &self.electric {
            isotropic = isotropic - field.pressure;
        }
        let zero = N::constant(token, 0.0);
        let mut P = [[zero; 3]; 3];
        let mut D = [zero; 3];
        for a in 0..3 {
            for m in 0..3 {
                P[a][m] = self.F[a][m]
                    .scaled(mu)
                    .plus_product(isotropic, self.T[a][m]);
            }
        }
        if let (Some(field), Some((constants, _))) = (&self.electric, state.electric) {
            let pushed = scale(field.pushed, N::constant(token, 2.0 * constants.c2));
            let induced = scale(field.spatial, field.kappa);
            for a in 0..3 {
                for m in 0..3 {
                    P[a][m] = P[a][m]
                        .plus_product(pushed[a], field.reference[m])
                        .plus_product(induced[a], field.pulled[m]);
                }
            }
            let pulled = apply(&transpose(&self.F), pushed);
            for m in 0..3 {
                D[m] = (field.kappa * field.pulled[m])
                    - field.reference[m].scaled(2.0 * constants.c1)
                    - pulled[m];
                D[m] = D[m].times(self.w);
            }
        }
        if let Some(isochoric) = &self.isochoric {
            isochoric.add_stress(&self.F, &self.T, &mut P);
        }
        for row in &mut P {
            for entry in row {
                *entry = entry.times(self.w);
            }
        }
        for (i, gradient) in state.shape.gradients().iter().enumerate() {
            let G = load::<N>(token, gradient);
            out.force(i, sums(apply_plain(&P, G)));
            if self.electric.is_some() {
                out.charge(i, dot_plain(D, G).sum());
            }
        }
    }

    #[inline(always)]
    fn tangent<const NODES: usize>(
        &self,
        state: &ElementState<'_, N, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let token = state.token;
        let zero = N::constant(token, 0.0);
        let w = self.w;
        let gradients = state.shape.gradients();
        let mut alpha = (-self.theta).shifted(state.shear_modulus);
        let mut beta = self.beta;
        if let Some(field) = &self.electric {
            alpha = alpha + field.pressure;
            beta = beta - field.pressure;
        }
        let even = (alpha + beta).scaled(0.5).times(w);
        let odd = (beta - alpha).scaled(0.5).times(w);
        let w_mu = N::Plain::load(token, state.shape.weights()).scaled(state.shear_modulus);

        let mut g = [[zero; 3]; NODES];
        let mut even_g = [[zero; 3]; NODES];
        let mut odd_g = [[zero; 3]; NODES];
        for i in 0..NODES {
            g[i] = apply_plain(&self.T, load::<N>(token, &gradients[i]));
            even_g[i] = scale(g[i], even);
            odd_g[i] = scale(g[i], odd);
        }
        let mut charged = Charged::zero(token);
        let electric = match (&self.electric, state.electric) {
            (Some(field), Some((constants, _))) => {
                charged.fill(self.w, &self.F, state, field, constants, &g);
                Some(&charged)
            }
            _ => None,
        };
        let dilatation = match self.mean {
            None => None,
            Some(mean) => {
                let w_J = self.J.times(w);
                let mut slopes = [sums([zero; 3]); NODES];
                for i in 0..NODES {
                    slopes[i] = sums(scale(g[i], w_J));
                }
                Some((mean.factor, slopes))
            }
        };

        let isochoric = match &self.isochoric {
            None => None,
            Some(isochoric) => {
                let mut nodes = [isochoric.node([zero; 3], [zero; 3]); NODES];
                for i in 0..NODES {
                    let G = load::<N>(token, &gradients[i]);
                    nodes[i] = isochoric.node(apply_plain(&self.F, G), g[i]);
                }
                Some((isochoric, nodes))
            }
        };

        for i in 0..NODES {
            let Gi = load::<N>(token, &gradients[i]);
            for j in 0..=i {
                let Gj = load::<N>(token, &gradients[j]);
                let plain = dot(Gi, Gj);
                let mut diagonal = zero.plus_plain(plain * w_mu);
                let (u, v) = (even_g[i], g[j]);
                let mut normal = [
                    (u[0] * v[0]).scaled(2.0),
                    (u[1] * v[1]).scaled(2.0),
                    (u[2] * v[2]).scaled(2.0),
                ];
                let mut shear = [
                    (u[1] * v[2]).plus_product(u[2], v[1]),
                    (u[2] * v[0]).plus_product(u[0], v[2]),
                    (u[0] * v[1]).plus_product(u[1], v[0]),
                ];
                let mut odd = cross(odd_g[i], g[j]);
                if let Some(c) = electric {
                    diagonal = diagonal.plus_product(c.c2_along[i], c.along[j]);
                    let inner = dot(g[i], g[j]);
                    let e = c.e;
                    let k = scale(e, inner * c.kappa);
                    for a in 0..3 {
                        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                        normal[a] = normal[a].minus_product(k[a], e[a]);
                        shear[a] = shear[a].minus_product(k[b], e[c]);
                    }
                    let (si, sj) = (c.s[i], c.s[j]);
                    let (pi, pj) = (&c.flux[i], &c.flux[j]);
                    let mut skew = [zero; 3];
                    for a in 0..3 {
                        odd[a] = odd[a]
                            .plus_product(sj, c.turned[i][a])
                            .minus_product(si, c.turned[j][a]);
                        skew[a] = (si * pj[a]).minus_product(sj, pi[a]);
                    }
                    let mut ij = [zero; 3];
                    let mut ji = [zero; 3];
                    for a in 0..3 {
                        let common = k[a].plus_times(c.c2_pushed[a], plain);
                        ij[a] = -(common + skew[a]).plus_product(c.c2_along[i], c.pushed[j][a]);
                        ji[a] = -(common - skew[a]).plus_product(c.c2_along[j], c.pushed[i][a]);
                    }
                    out.coupling(i, j, sums(ij));
                    if i != j {
                        out.coupling(j, i, sums(ji));
                    }
                    let energy = dot(c.pushed[i], c.pushed[j]).times(c.c2);
                    let energy = energy.plus_plain(plain * c.c1);
                    out.permittivity(i, j, energy.minus_product(inner, c.kappa).sum());
                }
                for entry in &mut normal {
                    *entry = *entry + diagonal;
                }
                let ([xx, yy, zz], [yz, zx, xy]) = (sums(normal), sums(shear));
                let [ax, ay, az] = sums(odd);
                let mut block = [
                    [xx, xy + az, zx - ay],
                    [xy - az, yy, yz + ax],
                    [zx + ay, yz - ax, zz],
                ];
                if let Some((factor, slopes)) = &dilatation {
                    for a in 0..3 {
                        for b in 0..3 {
                            block[a][b] =
                                block[a][b].plus_product(slopes[i][a] * *factor, slopes[j][b]);
                        }
                    }
                }
                if let Some((isochoric, nodes)) = &isochoric {
                    let plain = zero.plus_plain(plain);
                    let more = isochoric.block([&nodes[i], &nodes[j]], [g[i], g[j]], plain);
                    for a in 0..3 {
                        for b in 0..3 {
                            block[a][b] = block[a][b] + more[a][b].times(w).sum();
                        }
                    }
                }
                out.stiffness(i, j, block);
            }
        }
    }
}

/// Electric quantities of the nodes at the Gauss points.
pub(super) struct Charged<N: Points, const NODES: usize> {
    /// 2 w c₁.
    pub(super) c1: N::Plain,
    /// 2 w c₂.
    pub(super) c2: N::Plain,
    /// w κ.
    pub(super) kappa: N,
    pub(super) e: Three<N>,
    /// 2 w c₂ FE.
    pub(super) c2_pushed: Three<N>,
    /// E·G_i.
    pub(super) along: [N; NODES],
    /// 2 w c₂ E·G_i.
    pub(super) c2_along: [N; NODES],
    /// e·g_i.
    pub(super) s: [N; NODES],
    /// w κ g_i.
    pub(super) flux: [[N; 3]; NODES],
    /// w κ g_i × e.
    pub(super) turned: [[N; 3]; NODES],
    /// F G_i.
    pub(super) pushed: [[N; 3]; NODES],
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<N: Points, const NODES: usize> Charged<N, NODES> {
    #[inline(always)]
    pub(super) fn zero(token: N::Token) -> Self {
        let zero = N::constant(token, 0.0);
        Self {
            c1: N::Plain::constant(token, 0.0),
            c2: N::Plain::constant(token, 0.0),
            kappa: zero,
            e: [zero; 3],
            c2_pushed: [zero; 3],
            along: [zero; NODES],
            c2_along: [zero; NODES],
            s: [zero; NODES],
            flux: [[zero; 3]; NODES],
            turned: [[zero; 3]; NODES],
            pushed: [[zero; 3]; NODES],
        }
    }

    /// In place: a copy of this much would be felt.
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        w: N::Plain,
        F: &Nine<N>,
        state: &ElementState<'_, N, NODES>,
        field: &ElectricField<N>,
        constants: &Dielectric,
        g: &[[N; 3]; NODES],
    ) {
        let token = state.token;
        let weights = N::Plain::load(token, state.shape.weights());
        self.c1 = weights.scaled(2.0 * constants.c1);
        self.c2 = weights.scaled(2.0 * constants.c2);
        self.kappa = field.kappa.times(w);
        self.e = field.spatial;
        for a in 0..3 {
            self.c2_pushed[a] = field.pushed[a].times(self.c2);
        }
        for (i, gradient) in state.shape.gradients().iter().enumerate() {
            let G = load::<N>(token, gradient);
            self.along[i] = dot_plain(field.reference, G);
            self.c2_along[i] = self.along[i].times(self.c2);
            self.s[i] = dot(field.spatial, g[i]);
            self.flux[i] = scale(g[i], self.kappa);
            self.turned[i] = cross(self.flux[i], field.spatial);
            self.pushed[i] = apply_plain(F, G);
        }
    }
}

/// A law and the state at which it is evaluated.
pub(super) struct ElementState<'a, N: Points, const NODES: usize> {
    pub(super) token: N::Token,
    pub(super) shear_modulus: f64,
    pub(super) lame_lambda: f64,
    /// Absent at compile time for a neo-Hookean law.
    pub(super) isochoric: Option<(IsochoricLaw, f64)>,
    pub(super) volume: Volume,
    pub(super) shape: &'a ElementGeometry<NODES>,
    pub(super) x: &'a [[N::Uniform; 3]; NODES],
    /// Absent at compile time for a passive law.
    pub(super) electric: Option<(&'a Dielectric, &'a [N::Uniform; NODES])>,
}

/// The electric field at the Gauss points.
#[derive(Clone, Copy)]
pub(super) struct ElectricField<N> {
    /// E.
    pub(super) reference: Three<N>,
    /// e = F⁻ᵀE.
    pub(super) spatial: Three<N>,
    /// ω = F⁻¹e.
    pub(super) pulled: Three<N>,
    /// FE.
    pub(super) pushed: Three<N>,
    /// κ = εJ.
    pub(super) kappa: N,
    /// κ/2 e·e.
    pub(super) pressure: N,
}
