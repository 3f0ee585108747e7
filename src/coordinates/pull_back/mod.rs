//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.

mod articulated;
mod destination;
mod group;
mod images;
mod joined;
mod mixed;
mod product;

use crate::coordinates::map::{CoordinateMap, Dependence};
use crate::coordinates::pattern::StepPattern;
use crate::functional::{BlockMask, Couplings, Order, Output, SumDerivatives};
use crate::math::compact_index;
use articulated::Groups;
pub use destination::Destination;
use destination::{Linear, Plan};
pub(super) use destination::{Pulled, Site};
use images::BlockKind;
use joined::Joined;
use mixed::Mixed;
use product::Pair;

/// The plan of a pull-back: which blocks go where.
#[derive(Clone, Debug, Default)]
pub(super) struct PullBack {
    articulated: Groups,
    linear: Linear,
    joined: Joined,
    mixed: Mixed,
    /// (slot, place).
    scalars: Vec<(usize, usize)>,
}

impl PullBack {
    /// Plans the pull-back of a site; entries join the layout. Scalars of an instant are its multipliers.
    pub(super) fn new(
        couplings: &Couplings,
        map: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) -> Self {
        let mut own = Self::default();
        let plan = &mut Plan { map, layout, site };
        for (slot, &pair) in couplings.full.iter().enumerate() {
            let slots = [slot, couplings.transposed_full(slot)];
            own.pair(BlockKind::Full, slots, pair, plan);
        }
        for (slot, &pair) in couplings.isotropic.iter().enumerate() {
            let slots = [slot, couplings.transposed_isotropic(slot)];
            own.pair(BlockKind::Isotropic, slots, pair, plan);
        }
        for (slot, &(a, s)) in couplings.mixed.iter().enumerate() {
            own.mixed.add(slot, a, s, plan);
        }
        own.linear.shrink_to_fit();
        own.mixed.shrink_to_fit();
        if site == Site::Intervals {
            let scalars = couplings.scalars.iter().enumerate();
            own.scalars = scalars
                .map(|(slot, &(s, t))| (slot, plan.layout.scalars.slot(s, t)))
                .collect();
        }
        own
    }

    /// Plans the block of one pair of vectors.
    fn pair(
        &mut self,
        kind: BlockKind,
        slots: [usize; 2],
        vectors: (usize, usize),
        plan: &mut Plan<'_>,
    ) {
        use Dependence::{Articulated, Linear};
        let [slot, transposed] = slots;
        let (a, b) = vectors;
        match (&plan.map.vectors[a], &plan.map.vectors[b]) {
            (Articulated(a), Articulated(b)) => {
                let pair = Pair {
                    slot: compact_index(slot),
                    transposed: compact_index(transposed),
                    first: [compact_index(a.first), compact_index(b.first)],
                };
                self.articulated.add(kind, pair, [a, b], plan);
            }
            (Linear { parts: s, .. }, Linear { parts: t, .. }) => {
                self.linear.add(kind, slot, [s, t], plan);
            }
            (Articulated(a), Linear { parts, .. }) => {
                self.joined.add(kind, slots, a, parts, true, plan);
            }
            (Linear { parts, .. }, Articulated(b)) => {
                self.joined.add(kind, slots, b, parts, false, plan);
            }
        }
    }

    /// Size of the local storage that an evaluation needs.
    pub(super) fn local(&self) -> usize {
        self.articulated.local()
    }

    /// Adds second derivatives up to an order: ∇², or the lower blocks of ∇³ along the direction.
    pub(super) fn add(&self, order: Order, out: &Output, to: &mut Pulled<'_>) {
        match order {
            Order::Third => self.third(&out.plain, &out.contracted, to),
            _ => self.hessian(&out.plain, to),
        }
    }

    /// Adds Pᵀ H P.
    pub(super) fn hessian(&self, part: &SumDerivatives, to: &mut Pulled<'_>) {
        let h = &part.blocks;
        self.articulated.hessian(h, to);
        self.linear.pull(h, to);
        self.joined.pull(h, None, to);
        self.mixed.pull(&h.mixed, None, to);
        if to.target.scalars != usize::MAX {
            self.scalars(&h.scalars, to);
        }
    }

    /// Adds the lower blocks of `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l`.
    fn third(&self, plain: &SumDerivatives, contracted: &SumDerivatives, to: &mut Pulled<'_>) {
        let [a, _, c, d] = to.sides.blocks;
        to.sides = BlockMask {
            blocks: [a, false, c, d],
            ..to.sides
        };
        let (h, hw) = (&plain.blocks, &contracted.blocks);
        self.articulated.third([h, hw], to);
        self.linear.pull(hw, to);
        self.joined.pull(hw, Some(h), to);
        self.mixed.pull(&hw.mixed, Some(&h.mixed), to);
        self.scalars(&hw.scalars, to);
    }

    fn scalars(&self, of: &[f64], to: &mut Pulled<'_>) {
        for &(slot, place) in &self.scalars {
            to.values[to.target.scalars + place] += of[slot];
        }
    }
}
