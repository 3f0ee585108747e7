//! Electric quantities of the nodes at the Gauss points, which couplings and permittivities share.

use super::algebra::{Nine, Three, apply_plain, cross, dot, dot_plain, scale};
use super::kinematics::load;
use super::law::Dielectric;
use super::number::{Points, Real};
use super::state::{ElectricField, ElementState};

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
        (w, F): (N::Plain, &Nine<N>),
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
