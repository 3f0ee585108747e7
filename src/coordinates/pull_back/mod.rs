//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.

mod articulated;
mod destination;
mod group;
mod images;
mod joined;
mod mixed;
mod product;

use crate::coordinates::configuration::Configuration;
use crate::coordinates::map::{CoordinateMap, Dependence};
use crate::coordinates::pattern::StepPattern;
use crate::functional::{BlockMask, Couplings, Order, Output, SumDerivatives};
use crate::math::compact_index;
use articulated::{BlockDestination, Ends, Groups};
pub use destination::Destination;
use destination::Linear;
pub(super) use destination::Site;
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
        let mut plan = Self::default();
        for (slot, &pair) in couplings.full.iter().enumerate() {
            let slots = [slot, couplings.transposed_full(slot)];
            plan.pair(BlockKind::Full, slots, pair, map, layout, site);
        }
        for (slot, &pair) in couplings.isotropic.iter().enumerate() {
            let slots = [slot, couplings.transposed_isotropic(slot)];
            plan.pair(BlockKind::Isotropic, slots, pair, map, layout, site);
        }
        for (slot, &(a, s)) in couplings.mixed.iter().enumerate() {
            plan.mixed.add(slot, a, s, map, layout, site);
        }
        plan.linear.shrink_to_fit();
        plan.mixed.shrink_to_fit();
        if site == Site::Intervals {
            let place =
                |(slot, &(s, t)): (usize, &(usize, usize))| (slot, layout.scalars.slot(s, t));
            plan.scalars = couplings.scalars.iter().enumerate().map(place).collect();
        }
        plan
    }

    /// Plans the block of one pair of vectors.
    fn pair(
        &mut self,
        kind: BlockKind,
        slots: [usize; 2],
        (a, b): (usize, usize),
        map: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) {
        use Dependence::{Articulated, Linear};
        let [slot, transposed] = slots;
        match (&map.vectors[a], &map.vectors[b]) {
            (Articulated(a), Articulated(b)) => {
                let pair = Pair {
                    slot: compact_index(slot),
                    transposed: compact_index(transposed),
                    first: [compact_index(a.first), compact_index(b.first)],
                };
                self.articulated.add(kind, pair, [a, b], layout, site);
            }
            (Linear { parts: s, .. }, Linear { parts: t, .. }) => match kind {
                BlockKind::Full => self.linear.add_full(slot, [s, t], layout, site),
                BlockKind::Isotropic => self.linear.add_isotropic(slot, [s, t], layout, site),
            },
            (Articulated(a), Linear { parts, .. }) => {
                self.joined.add(kind, slots, (a, parts), true, layout, site);
            }
            (Linear { parts, .. }, Articulated(b)) => {
                self.joined
                    .add(kind, slots, (b, parts), false, layout, site);
            }
        }
    }

    /// Size of the local storage that an evaluation needs.
    pub(super) fn local(&self) -> usize {
        self.articulated.local()
    }

    /// Adds second derivatives up to an order: ∇², or the lower blocks of ∇³ along the direction.
    pub(super) fn add(
        &self,
        order: Order,
        ends: [&Configuration; 2],
        out: &Output,
        sides: BlockMask,
        target: &Destination,
        [local, values]: [&mut [f64]; 2],
    ) {
        let (plain, contracted) = (&out.plain, &out.contracted);
        match order {
            Order::Third => self.third(ends, [plain, contracted], sides, target, local, values),
            _ => self.hessian(ends, plain, sides, target, local, values),
        }
    }

    /// Adds Pᵀ H P.
    pub(super) fn hessian(
        &self,
        ends: [&Configuration; 2],
        part: &SumDerivatives,
        sides: BlockMask,
        target: &Destination,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let (columns, columns_l) = columns(ends);
        let (ends, blocks) = (Ends { columns, columns_l }, &part.blocks);
        let place = BlockDestination {
            target,
            local,
            values,
        };
        self.articulated.hessian(ends, blocks, sides, place);
        self.linear
            .add(&blocks.full, &blocks.isotropic, sides, target, values);
        self.joined
            .plain(ends, &blocks.full, &blocks.isotropic, sides, target, values);
        self.mixed.plain(columns, part, target, values);
        if target.scalars != usize::MAX {
            for &(slot, place) in &self.scalars {
                values[target.scalars + place] += blocks.scalars[slot];
            }
        }
    }

    /// Adds the lower blocks of `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l`.
    fn third(
        &self,
        ends: [&Configuration; 2],
        [plain, contracted]: [&SumDerivatives; 2],
        sides: BlockMask,
        target: &Destination,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let (columns, columns_l) = columns(ends);
        let lower = BlockMask {
            blocks: [sides.blocks[0], false, sides.blocks[2], sides.blocks[3]],
            ..sides
        };
        let (ends, h, hw) = (
            Ends { columns, columns_l },
            &plain.blocks,
            &contracted.blocks,
        );
        let place = BlockDestination {
            target,
            local,
            values,
        };
        self.articulated.third(ends, [h, hw], lower, place);
        self.linear
            .add(&hw.full, &hw.isotropic, lower, target, values);
        self.joined.along(
            ends,
            [&h.full, &hw.full],
            [&h.isotropic, &hw.isotropic],
            lower,
            target,
            values,
        );
        self.mixed
            .along(columns, columns_l, [plain, contracted], target, values);
        for &(slot, place) in &self.scalars {
            values[target.scalars + place] += hw.scalars[slot];
        }
    }
}

/// Columns of both instants, and their derivatives along l.
fn columns(ends: [&Configuration; 2]) -> ([&[f64]; 2], [&[f64]; 2]) {
    (
        ends.map(|e| e.columns.as_slice()),
        ends.map(|e| e.columns_l.as_slice()),
    )
}
