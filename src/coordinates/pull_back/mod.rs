//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.

mod articulated;
mod destination;
mod joined;
mod lanes;
mod linear;
mod mixed;

use crate::coordinates::configuration::Configuration;
use crate::coordinates::map::{CoordinateMap, Dependence};
use crate::coordinates::pattern::StepPattern;
use crate::functional::{BlockMask, Couplings, Part};
use articulated::{BlockDestination, Ends, Groups, Pair};
pub use destination::Destination;
pub(super) use destination::Site;
use joined::{Block, Joined};
use linear::Linear;
use mixed::Mixed;

/// The plan of a pull-back: which blocks go where.
#[derive(Clone, Debug, Default)]
pub(super) struct PullBack {
    full: Groups,
    isotropic: Groups,
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
        motion: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) -> Self {
        let mut plan = Self::default();
        for (slot, &pair) in couplings.full.iter().enumerate() {
            let slots = [slot, couplings.transposed_full(slot)];
            plan.pair(Block::Full, slots, pair, motion, layout, site);
        }
        for (slot, &pair) in couplings.isotropic.iter().enumerate() {
            let slots = [slot, couplings.transposed_isotropic(slot)];
            plan.pair(Block::Isotropic, slots, pair, motion, layout, site);
        }
        for (slot, &(a, s)) in couplings.mixed.iter().enumerate() {
            plan.mixed.add(slot, a, s, motion, layout, site);
        }
        plan.linear.shrink_to_fit();
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
        block: Block,
        slots: [usize; 2],
        (a, b): (usize, usize),
        motion: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) {
        use Dependence::{Articulated, Linear};
        let [slot, transposed] = slots;
        match (&motion.vectors[a], &motion.vectors[b]) {
            (Articulated(a), Articulated(b)) => {
                let pair = Pair {
                    slot,
                    transposed,
                    first: [a.first, b.first],
                };
                let groups = match block {
                    Block::Full => &mut self.full,
                    Block::Isotropic => &mut self.isotropic,
                };
                groups.add(pair, [a, b], layout, site);
            }
            (Linear { parts: s, .. }, Linear { parts: t, .. }) => match block {
                Block::Full => self.linear.add_full(slot, [s, t], layout, site),
                Block::Isotropic => self.linear.add_isotropic(slot, [s, t], layout, site),
            },
            (Articulated(a), Linear { parts, .. }) => {
                self.joined
                    .add(block, slots, (a, parts), true, layout, site);
            }
            (Linear { parts, .. }, Articulated(b)) => {
                self.joined
                    .add(block, slots, (b, parts), false, layout, site);
            }
        }
    }

    /// Size of the local storage that an evaluation needs.
    pub(super) fn local(&self) -> usize {
        self.full.local().max(self.isotropic.local())
    }

    /// Adds Pᵀ H P.
    pub(super) fn hessian(
        &self,
        ends: [&Configuration; 2],
        part: &Part,
        sides: BlockMask,
        target: &Destination,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let (columns, columns_l) = columns(ends);
        let (ends, blocks) = (Ends { columns, columns_l }, &part.blocks);
        self.full.full(
            ends,
            &blocks.full,
            sides,
            BlockDestination {
                target,
                local,
                values,
            },
        );
        self.isotropic.isotropic(
            ends,
            &blocks.isotropic,
            sides,
            BlockDestination {
                target,
                local,
                values,
            },
        );
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
    pub(super) fn third(
        &self,
        ends: [&Configuration; 2],
        [plain, contracted]: [&Part; 2],
        sides: BlockMask,
        target: &Destination,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let (columns, columns_l) = columns(ends);
        let lower = BlockMask {
            blocks: [sides.blocks[0], false, sides.blocks[2], sides.blocks[3]],
        };
        let (ends, h, hw) = (
            Ends { columns, columns_l },
            &plain.blocks,
            &contracted.blocks,
        );
        self.full.full_along(
            ends,
            [&h.full, &hw.full],
            lower,
            BlockDestination {
                target,
                local,
                values,
            },
        );
        self.isotropic.isotropic_along(
            ends,
            [&h.isotropic, &hw.isotropic],
            lower,
            BlockDestination {
                target,
                local,
                values,
            },
        );
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
