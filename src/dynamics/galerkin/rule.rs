//! The methods other than the midpoint rule, defined by their samples and by the data that they carry from step to step.
//!
//! A step has points 0 (its start), 1, …, s (its end) with vectors x⁰ … x^s, and samples at which the sum over an interval is
//! evaluated. A sample i looks at the place x and the rate v of a combination of the points, as an interval of the same
//! length h between x_a = x − h v/2 and x_b = x + h v/2 would: that interval has x as its midpoint and v as its rate. With the
//! forces f_a, f_b of this interval, hence p = (f_b − f_a)/2 = ∂T/∂v and f_a + f_b = h ∂L/∂x, the rows of point r are
//!
//! ```text
//! Galerkin           P_rᵀ [ p_k δ_r0 + Σ_i b_i Σ_{S=a,b} w_S,ri f_S,i ],   w_a = l_r(c_i) − l′_r(c_i)/2,   w_b = l_r(c_i) + l′_r(c_i)/2
//! implicit Euler     P₁ᵀ [ p₀ − p₁ + h ∂L/∂x(x¹, v¹) ]  =  P₁ᵀ [ p₀ + 3/2 f_a + 1/2 f_b ],   v¹ = (x¹ − x⁰)/h
//! generalised alpha  P₁ᵀ [ f_a + f_b − h M a¹ ]
//! ```
//!
//! The Galerkin rows are the discrete Euler–Lagrange equations of L_d = h Σ b_i L(q(c_i h), q̇(c_i h)) on polynomials through
//! the points; the midpoint rule is the same with s = 1 and one sample at c = ½. The generalised-α method is that of
//! M. Arnold and O. Brüls, Multibody System Dynamics 18, 185–202 (2007), whose constraints hold at the end of the step.
//!
//! Vectors without mass, those of Maxwell branches and of charges, in a Galerkin step.
//!
//! They carry no momentum, so that the residual g of their equation need not vanish at the end of a step. With the rows of other vectors it
//! would return in the next step with the opposite sign, and grow. Their rows are `Σ_i b_i q_r(c_i) g(c_i)` with the polynomials q_r of degree
//! s − 1 through the points 0 … s − 1: a continuous Galerkin method, whose damping factor is the diagonal Padé approximation of the
//! exponential, of order 2s and below one for every relaxation time. As q_r is one at its point, zero at the others, and some share at the
//! end, the rows of a point are the usual ones and that share of those of the end.

use crate::dynamics::galerkin::lobatto::{Lobatto, lagrange};
use crate::functional::{Blocks, SumDerivatives};
use crate::kinematics::{Carrier, MaterialVector};
use crate::math::Vector;
use crate::model::Model;
use std::slice;

/// Part of the equations that differs from method to method.
#[derive(Clone, Debug)]
pub(super) enum Rule {
    /// Galerkin's variational integrator.
    Galerkin(Lobatto),
    /// Implicit Euler, with the momenta of the vectors at the start of the step.
    Euler(Vec<Vector>),
    /// Generalised α.
    Alpha(Alpha),
}

/// Weights of a sample: of the points that it reads and that its forces act on, for the sides a and b.
#[derive(Clone, Debug)]
pub(super) struct Weights {
    /// Time in the step at which its voltages are read, from 0 to 1.
    pub(super) part: f64,
    /// Of the quadrature.
    pub(super) quadrature: f64,
    /// x_S = Σ take x^ν, by side and point.
    pub(super) take: [Vec<f64>; 2],
    /// Rows of point r get give f_S, by side and point.
    pub(super) give: [Vec<f64>; 2],
}

impl Rule {
    /// Number of points in addition to the start.
    pub(super) fn degree(&self) -> usize {
        match self {
            Self::Galerkin(lobatto) => lobatto.points.len() - 1,
            Self::Euler(_) | Self::Alpha(_) => 1,
        }
    }

    /// Returns the times of the points in the step, from 0 to 1.
    pub(super) fn points(&self) -> Vec<f64> {
        match self {
            Self::Galerkin(lobatto) => lobatto.points.clone(),
            Self::Euler(_) | Self::Alpha(_) => vec![0.0, 1.0],
        }
    }

    /// Point of the rows that go with the unknowns of point ν ≥ 1.
    pub(super) fn row(&self, point: usize) -> usize {
        match self {
            Self::Galerkin(_) => point - 1,
            Self::Euler(_) | Self::Alpha(_) => point,
        }
    }

    /// Values at the end of a step of the polynomials through its other points, in the order of these; none of methods of one point, whose
    /// equations hold there.
    pub(super) fn shares(&self) -> Vec<f64> {
        match self {
            Self::Galerkin(lobatto) => {
                let others = &lobatto.points[..lobatto.points.len() - 1];
                lagrange(others, 1.0)
            }
            Self::Euler(_) | Self::Alpha(_) => Vec::new(),
        }
    }

    /// Lists of vectors that it carries from step to step.
    pub(super) fn carried(&mut self) -> &mut [Vec<Vector>] {
        match self {
            Self::Galerkin(_) => &mut [],
            Self::Euler(momenta) => slice::from_mut(momenta),
            Self::Alpha(alpha) => &mut alpha.state,
        }
    }

    /// Weights of all samples.
    pub(super) fn samples(&self) -> Vec<Weights> {
        match self {
            Self::Galerkin(lobatto) => {
                let sample = |i: usize| {
                    let at = |side: f64| {
                        let slopes = lobatto.derivatives[i].iter().enumerate();
                        let weights =
                            slopes.map(|(v, slope)| f64::from(v == i) + side * 0.5 * slope);
                        weights.collect::<Vec<_>>()
                    };
                    let take = [at(-1.0), at(1.0)];
                    Weights {
                        part: lobatto.points[i],
                        quadrature: lobatto.weights[i],
                        give: take.clone(),
                        take,
                    }
                };
                (0..lobatto.points.len()).map(sample).collect()
            }
            Self::Euler(_) => vec![at_end(1.0, [1.5, 0.5])],
            Self::Alpha(alpha) => vec![at_end(alpha.gamma / alpha.beta, [1.0, 1.0])],
        }
    }
}

/// A sample at the end of the step, with the rate `rate` (x¹ − x⁰)/h in addition to what is carried.
fn at_end(rate: f64, give: [f64; 2]) -> Weights {
    Weights {
        part: 1.0,
        quadrature: 1.0,
        take: [
            vec![0.5 * rate, 1.0 - 0.5 * rate],
            vec![-0.5 * rate, 1.0 + 0.5 * rate],
        ],
        give: give.map(|weight| vec![0.0, weight]),
    }
}

/// The generalised-α method: parameters, and the data that it carries.
#[derive(Clone, Debug)]
pub(super) struct Alpha {
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
    /// Rates v, accelerations a and their averages α of all vectors at the start of the step.
    state: [Vec<Vector>; 3],
}

impl Alpha {
    /// Parameters by the spectral radius at infinity (Chung & Hulbert, J. Appl. Mech. 60, 1993); rates and accelerations at
    /// the start.
    pub(super) fn new(spectral_radius: f64, v: Vec<Vector>, a: Vec<Vector>) -> Self {
        let rho = spectral_radius;
        let (alpha_m, alpha_f) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        let gamma = 0.5 + alpha_f - alpha_m;
        Self {
            alpha_m,
            alpha_f,
            gamma,
            beta: 0.25 * (gamma + 0.5).powi(2),
            state: [v, a.clone(), a],
        }
    }

    /// Factor of x¹/h² in the acceleration at the end of the step.
    pub(super) fn inertia(&self) -> f64 {
        (1.0 - self.alpha_m) / (self.beta * (1.0 - self.alpha_f))
    }

    /// Rate of vector `i` at the end less γ/β (x¹ − x⁰)/h.
    pub(super) fn carried_rate(&self, i: usize, h: f64) -> Vector {
        let [v, _, alpha] = &self.state;
        let ratio = self.gamma / self.beta;
        v[i] * (1.0 - ratio) + alpha[i] * (h * (1.0 - 0.5 * ratio))
    }

    /// Average of the accelerations α at the end, when the vector has gone `displacement` in the step.
    fn average(&self, i: usize, h: f64, displacement: Vector) -> Vector {
        let [v, _, alpha] = &self.state;
        (displacement - v[i] * h) / (self.beta * h * h) - alpha[i] * ((0.5 - self.beta) / self.beta)
    }

    /// Acceleration of vector `i` at the end of a step in which it has gone `displacement`.
    pub(super) fn acceleration(&self, i: usize, h: f64, displacement: Vector) -> Vector {
        let [_, a, alpha] = &self.state;
        let averages =
            self.average(i, h, displacement) * (1.0 - self.alpha_m) + alpha[i] * self.alpha_m;
        (averages - a[i] * self.alpha_f) / (1.0 - self.alpha_f)
    }

    /// Carries on after a step in which the vectors went from `x` to `y`.
    pub(super) fn accept(&mut self, h: f64, x: &[Vector], y: &[Vector]) {
        for i in 0..x.len() {
            let displacement = y[i] - x[i];
            let rate = displacement * (self.gamma / self.beta / h) + self.carried_rate(i, h);
            let (acceleration, average) = (
                self.acceleration(i, h, displacement),
                self.average(i, h, displacement),
            );
            let [v, a, alpha] = &mut self.state;
            (v[i], a[i], alpha[i]) = (rate, acceleration, average);
        }
    }

    /// Rates of the vectors now.
    pub(super) fn rates(&self) -> &[Vector] {
        &self.state[0]
    }
}

/// The vectors without mass and the pairs whose rows belong to them.
#[derive(Clone, Debug)]
pub(super) struct Massless {
    /// Coordinates.
    pub(super) coordinates: Vec<usize>,
    /// The vectors of them.
    vectors: Vec<usize>,
    /// Slots of couplings with full and with isotropic blocks.
    slots: [Vec<usize>; 2],
    /// Share of the end by point of the rows; none of a method that carries no residual.
    shares: Vec<f64>,
}

impl Massless {
    pub(super) fn new(model: &Model, rule: &Rule) -> Self {
        let coordinates: Vec<usize> = model.memory().collect();
        let is_massless = |vector: &MaterialVector| {
            let mut terms = vector.terms.iter();
            terms.any(|term| matches!(term.carrier, Carrier::Coordinate(i) if model.is_memory(i)))
        };
        let is_massless: Vec<bool> = model.vectors.iter().map(is_massless).collect();
        let vectors: Vec<usize> = (0..is_massless.len()).filter(|&v| is_massless[v]).collect();
        let couplings = model.action.intervals.couplings();
        let of_rows = |pairs: &[(usize, usize)]| {
            let slots = pairs.iter().enumerate();
            let own = slots.filter(|(_, (row, _))| is_massless[*row]);
            own.map(|(slot, _)| slot).collect()
        };
        Self {
            slots: [&couplings.full, &couplings.isotropic].map(|pairs| of_rows(pairs)),
            shares: match vectors.is_empty() {
                true => Vec::new(),
                false => rule.shares(),
            },
            coordinates,
            vectors,
        }
    }

    /// The vectors of the coordinates without mass.
    pub(super) fn vectors(&self) -> &[usize] {
        &self.vectors
    }

    /// Weight of the forces of a side of a sample on the end in the rows of a point; `None` where they have none.
    fn weight(&self, weights: &Weights, side: usize, row: usize) -> Option<f64> {
        let share = self.shares.get(row)?;
        let end = weights.give[side].last()?;
        Some(weights.quadrature * end * share).filter(|weight| *weight != 0.0)
    }

    /// Adds the share of the forces of a sample to those of the rows of a point.
    pub(super) fn add_forces(
        &self,
        weights: &Weights,
        row: usize,
        from: &SumDerivatives,
        forces: &mut [Vector],
    ) {
        for (side, all) in from.forces.iter().enumerate() {
            if let Some(weight) = self.weight(weights, side, row) {
                for &vector in &self.vectors {
                    forces[vector] += all[vector] * weight;
                }
            }
        }
    }

    /// Adds the share of the blocks of a sample by the vectors of a point to one block of the rows of another.
    pub(super) fn add_blocks(
        &self,
        weights: &Weights,
        [row, point]: [usize; 2],
        from: &Blocks,
        to: &mut Blocks,
        block: usize,
    ) {
        for side in 0..4 {
            let take = weights.take[side % 2][point];
            let Some(weight) = self.weight(weights, side / 2, row) else {
                continue;
            };
            for &slot in &self.slots[0] {
                to.full[slot][block] += from.full[slot][side] * (weight * take);
            }
            for &slot in &self.slots[1] {
                to.isotropic[slot][block] += from.isotropic[slot][side] * (weight * take);
            }
        }
    }
}
