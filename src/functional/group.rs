//! Elements that share one formula: static inside, one virtual call outside.
//!
//! An element turns the derivatives of its energy E(p) with respect to its arguments p = (x̄ …, v …, s …) into those of
//! `h E` with respect to the vectors at both instants, the scalars, and the interval length where that is an argument.
//! With v = Δ/h and Π the projection on the rates, for G = h E(y, Δ/h)
//!
//! ```text
//! ∂G/∂h = E − ∇E·Πv,     ∂/∂h (∇G) = ∇E − Π∇E − ∇²E Πv  (through the stencil weights),     ∂²G/∂h² = Πv·∇²E Πv / h.
//! ```

use crate::energy::Energy;
use crate::functional::slots::{NONE, Slots};
use crate::functional::{Couplings, Horizon, Order, Output, Part, Sample, Stencil, VectorArg};
use crate::math::{Jet, Matrix, Vector};
use nalgebra::SVector;
use std::fmt;

/// One element: a formula and what it reads.
#[derive(Clone, Debug)]
pub struct Element<E, const NV: usize, const NS: usize> {
    /// The formula.
    pub energy: E,
    /// Vectors, in the order of the arguments.
    pub vectors: [VectorArg; NV],
    /// Scalars of the site, after the vectors.
    pub scalars: [usize; NS],
}

/// Elements sharing one formula of `M = 3 NV + NS` arguments.
pub struct Group<E, const M: usize, const NV: usize, const NS: usize> {
    pub(super) name: String,
    pub(super) scale: f64,
    pub(super) site: Site,
    pub(super) elements: Vec<Element<E, NV, NS>>,
}

/// Where a group lives in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Site {
    Intervals,
    Instants,
}

impl<E, const M: usize, const NV: usize, const NS: usize> fmt::Debug for Group<E, M, NV, NS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} elements)", self.name, self.elements.len())
    }
}

impl<E: Energy<M>, const M: usize, const NV: usize, const NS: usize> Group<E, M, NV, NS> {
    /// `scale · h · Σ E` over an interval.
    pub fn intervals(name: &str, scale: f64, elements: Vec<Element<E, NV, NS>>) -> Self {
        Self::new(name, scale, Site::Intervals, elements)
    }

    /// `scale · Σ E` at an instant.
    pub fn instants(name: &str, scale: f64, elements: Vec<Element<E, NV, NS>>) -> Self {
        Self::new(name, scale, Site::Instants, elements)
    }

    fn new(name: &str, scale: f64, site: Site, elements: Vec<Element<E, NV, NS>>) -> Self {
        const { assert!(M == 3 * NV + NS) };
        Self {
            name: name.to_owned(),
            scale,
            site,
            elements,
        }
    }

    pub(super) fn couple_element(
        &self,
        element: &Element<E, NV, NS>,
        couplings: &mut Couplings,
        slots: &mut Vec<u32>,
    ) {
        let has_second = E::DEGREE >= 2;
        for (i, a) in element.vectors.iter().enumerate() {
            for (j, b) in element.vectors.iter().enumerate() {
                slots.push(match (has_second && E::couples(i, j), E::ISOTROPIC) {
                    (false, _) => NONE,
                    (true, true) => couplings.add_isotropic(a.vector, b.vector) as u32,
                    (true, false) => couplings.add_full(a.vector, b.vector) as u32,
                });
            }
        }
        for a in &element.vectors {
            slots.extend(element.scalars.map(|s| match has_second {
                true => couplings.add_mixed(a.vector, s) as u32,
                false => NONE,
            }));
        }
        // Multipliers do not meet in second derivatives.
        let has_scalars = has_second && self.site == Site::Intervals;
        for (i, &s) in element.scalars.iter().enumerate() {
            for (j, &t) in element.scalars.iter().enumerate() {
                slots.push(match has_scalars && j <= i {
                    true => couplings.add_scalars(s, t) as u32,
                    false => NONE,
                });
            }
        }
    }

    /// The elements with their slots.
    pub(super) fn with_slots<'a>(
        &'a self,
        slots: &'a [u32],
    ) -> impl Iterator<Item = (&'a Element<E, NV, NS>, Slots<'a, NV, NS>)> {
        let slots = slots.chunks_exact(Slots::<NV, NS>::COUNT).map(Slots);
        self.elements.iter().zip(slots)
    }

    fn factor(&self, h: f64) -> f64 {
        match self.site {
            Site::Intervals => self.scale * h,
            Site::Instants => self.scale,
        }
    }

    /// Whether the argument `i` is a vector that gives equations.
    fn is_row(i: usize) -> bool {
        E::VIRTUAL == 0 || i < E::VIRTUAL
    }

    /// Arguments at the frame and their rates along its direction; a virtual displacement takes the rate as value.
    #[inline]
    pub(super) fn arguments(
        element: &Element<E, NV, NS>,
        frame: &Sample<'_>,
        level: Order,
    ) -> (SVector<f64, M>, SVector<f64, M>) {
        let mut p = SVector::<f64, M>::zeros();
        let mut w = SVector::<f64, M>::zeros();
        for (i, arg) in element.vectors.iter().enumerate() {
            let [a, b] = arg.stencil.weights(frame.h);
            let sample = |v: [&[Vector]; 2]| match arg.stencil {
                Stencil::Here => v[0][arg.vector],
                Stencil::Next => v[1][arg.vector],
                _ => v[0][arg.vector] * a + v[1][arg.vector] * b,
            };
            let virtual_displacement = i < E::VIRTUAL;
            if !virtual_displacement {
                p.fixed_rows_mut::<3>(3 * i)
                    .copy_from(&sample(frame.vectors));
            }
            if level == Order::Third {
                let rate = sample(frame.along);
                if virtual_displacement {
                    p.fixed_rows_mut::<3>(3 * i).copy_from(&rate);
                } else {
                    w.fixed_rows_mut::<3>(3 * i).copy_from(&rate);
                }
            }
        }
        for (i, &s) in element.scalars.iter().enumerate() {
            p[3 * NV + i] = frame.scalars[s];
            if level == Order::Third {
                w[3 * NV + i] = frame.scalars_along[s];
            }
        }
        (p, w)
    }

    /// Adds `c · gradient` of the arguments that pass `keep` to the forces and rows.
    #[inline]
    pub(super) fn add_gradient(
        element: &Element<E, NV, NS>,
        g: &SVector<f64, M>,
        c: f64,
        h: f64,
        keep: impl Fn(usize) -> bool,
        forces: &mut [Vec<Vector>; 2],
        rows: &mut [f64],
    ) {
        for (i, arg) in element.vectors.iter().enumerate() {
            if keep(i) {
                let weights = arg.stencil.weights(h);
                let gi = g.fixed_rows::<3>(3 * i) * c;
                for (side, forces) in forces.iter_mut().enumerate() {
                    if arg.stencil.reads(side) {
                        forces[arg.vector] += gi * weights[side];
                    }
                }
            }
        }
        for (i, &s) in element.scalars.iter().enumerate() {
            rows[s] += c * g[3 * NV + i];
        }
    }

    /// Adds `c · hessian` between the vector arguments that pass `keep`, and with and between scalars.
    #[inline]
    pub(super) fn add_hessian(
        (element, slots): (&Element<E, NV, NS>, Slots<'_, NV, NS>),
        hessian: &nalgebra::SMatrix<f64, M, M>,
        c: f64,
        frame: &Sample<'_>,
        keep: impl Fn(usize, usize) -> bool,
        part: &mut Part,
    ) {
        for (i, a) in element.vectors.iter().enumerate() {
            let wa = a.stencil.weights(frame.h);
            for (j, b) in element.vectors.iter().enumerate() {
                let Some(slot) = slots.vectors(i, j).filter(|_| keep(i, j)) else {
                    continue;
                };
                let wb = b.stencil.weights(frame.h);
                for side in 0..4 {
                    let weight = c * wa[side / 2] * wb[side % 2];
                    if !frame.sides.blocks[side] || weight == 0.0 {
                        continue;
                    }
                    if E::ISOTROPIC {
                        part.blocks.isotropic[slot][side] += weight * hessian[(3 * i, 3 * j)];
                    } else {
                        let block: Matrix = hessian.fixed_view::<3, 3>(3 * i, 3 * j) * weight;
                        part.blocks.full[slot][side] += block;
                    }
                }
            }
            for s in 0..NS {
                let column: Vector = hessian.fixed_view::<3, 1>(3 * i, 3 * NV + s) * c;
                let slot = slots.mixed(i, s);
                part.blocks.mixed[slot][0] += column * wa[0];
                part.blocks.mixed[slot][1] += column * wa[1];
            }
        }
        for s in 0..NS {
            for t in 0..=s {
                if let Some(slot) = slots.scalars(s, t) {
                    part.blocks.scalars[slot] += c * hessian[(3 * NV + s, 3 * NV + t)];
                }
            }
        }
    }

    /// The part Πv of the arguments: rates, all else zero.
    fn rates(element: &Element<E, NV, NS>, p: &SVector<f64, M>) -> SVector<f64, M> {
        let mut rates = SVector::<f64, M>::zeros();
        for (i, arg) in element.vectors.iter().enumerate() {
            if arg.stencil == Stencil::Rate {
                rates
                    .fixed_rows_mut::<3>(3 * i)
                    .copy_from(&p.fixed_rows::<3>(3 * i));
            }
        }
        rates
    }

    pub(super) fn evaluate_element<const ORDER: usize>(
        &self,
        (element, slots): (&Element<E, NV, NS>, Slots<'_, NV, NS>),
        level: Order,
        frame: &Sample<'_>,
        out: &mut Output,
    ) {
        let (p, w) = Self::arguments(element, frame, level);
        let jet: Jet<M, ORDER> = element.energy.jet(&p, &w);
        let (c, h) = (self.factor(frame.h), frame.h);
        let plain = &mut out.plain;
        Self::add_gradient(
            element,
            &jet.gradient,
            c,
            h,
            Self::is_row,
            &mut plain.forces,
            &mut plain.rows,
        );
        let free = frame.horizon == Horizon::Free && self.site == Site::Intervals;
        let (v, mut border) = (Self::rates(element, &p), SVector::zeros());
        if level >= Order::Hessian {
            if E::DEGREE >= 2 {
                let rows =
                    |i: usize, j: usize| E::VIRTUAL == 0 || (i < E::VIRTUAL && j >= E::VIRTUAL);
                Self::add_hessian((element, slots), &jet.hessian, c, frame, rows, plain);
            }
            if free {
                border = jet.gradient - jet.hessian * v - Self::rates(element, &jet.gradient);
                let (forces, rows) = (&mut plain.horizon_forces, &mut plain.horizon_rows);
                Self::add_gradient(element, &border, self.scale, h, Self::is_row, forces, rows);
            }
        }
        if level < Order::Third {
            return;
        }
        let part = &mut out.contracted;
        if E::VIRTUAL > 0 {
            // At δx = w the virtual work itself is the contraction with the costates.
            let other = |i: usize| i >= E::VIRTUAL;
            Self::add_gradient(
                element,
                &jet.gradient,
                c,
                h,
                other,
                &mut part.forces,
                &mut part.rows,
            );
            Self::add_hessian(
                (element, slots),
                &jet.hessian,
                c,
                frame,
                |i, j| other(i) && other(j),
                part,
            );
            if free {
                let (forces, rows) = (&mut part.horizon_forces, &mut part.horizon_rows);
                Self::add_gradient(element, &border, self.scale, h, other, forces, rows);
                part.horizon += self.scale * v.dot(&(jet.hessian * v)) / h;
            }
            return;
        }
        Self::add_gradient(
            element,
            &jet.gradient_w,
            c,
            h,
            |_| true,
            &mut part.forces,
            &mut part.rows,
        );
        if E::DEGREE >= 3 {
            Self::add_hessian(
                (element, slots),
                &jet.hessian_w,
                c,
                frame,
                |_, _| true,
                part,
            );
        }
        if free {
            let vw = Self::rates(element, &w);
            let border = jet.gradient_w
                - jet.hessian_w * v
                - jet.hessian * vw
                - Self::rates(element, &jet.gradient_w);
            let (forces, rows) = (&mut part.horizon_forces, &mut part.horizon_rows);
            Self::add_gradient(element, &border, self.scale, h, |_| true, forces, rows);
            part.horizon +=
                self.scale * (v.dot(&(jet.hessian_w * v)) + 2.0 * vw.dot(&(jet.hessian * v))) / h;
        }
    }
}
