//! Pairs of articulated vectors, both of which follow joint coordinates.

use crate::coordinates::pull_back::destination::{Plan, Pulled};
use crate::coordinates::pull_back::group::Group;
use crate::coordinates::pull_back::images::BlockKind;
use crate::coordinates::pull_back::product::Pair;
use crate::coordinates::tree::{LANES, TangentColumns};
use crate::functional::Blocks;
use pulp::{Arch, Scalar, Simd, WithSimd};
use rustc_hash::FxHashMap;

/// Groups of pairs by the supports of both vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups {
    list: Vec<Group>,
    /// The group of two supports.
    known: FxHashMap<[Vec<usize>; 2], usize>,
}

impl Groups {
    /// Adds a pair of vectors with these columns.
    pub(super) fn add(
        &mut self,
        kind: BlockKind,
        pair: Pair,
        [a, b]: [&TangentColumns; 2],
        plan: &mut Plan<'_>,
    ) {
        if a.support.is_empty() || b.support.is_empty() {
            return;
        }
        let supports = [a, b].map(|columns| columns.support.clone());
        let index = match self.known.get(&supports) {
            Some(&index) => index,
            None => {
                let stride = [a.stride, b.stride];
                let found = self.list.iter().position(|g| g.fits(&supports, stride));
                let index = found.unwrap_or_else(|| {
                    self.list.push(Group::new(stride));
                    self.list.len() - 1
                });
                self.list[index].widen(&supports, plan);
                self.known.insert(supports, index);
                index
            }
        };
        self.list[index].pairs.add(kind, pair);
    }

    /// Numbers of the storage on the way.
    pub(super) fn local(&self) -> usize {
        self.list.iter().map(Group::local).max().unwrap_or(0)
    }

    /// Adds Pᵀ H P.
    pub(super) fn hessian(&self, blocks: &Blocks, to: &mut Pulled<'_>) {
        dispatch(SecondDerivativesTask {
            groups: self,
            blocks,
            to,
        });
    }

    /// Adds `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l` of plain blocks H and contracted blocks `H_w`.
    pub(super) fn third(&self, blocks: [&Blocks; 2], to: &mut Pulled<'_>) {
        dispatch(ContractedTask {
            groups: self,
            blocks,
            to,
        });
    }
}

/// Pᵀ H P of all groups.
struct SecondDerivativesTask<'a, 'p> {
    groups: &'a Groups,
    blocks: &'a Blocks,
    to: &'a mut Pulled<'p>,
}

impl Task for SecondDerivativesTask<'_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, unit: S) {
        let to = self.to;
        for group in &self.groups.list {
            let (images, out) = group.split(to.local, 1);
            for side in (0..4).filter(|&side| to.sides.blocks[side]) {
                let [a, b] = group.columns(to.columns, side);
                group.pairs.images(unit, side, self.blocks, b, images);
                group.multiply(unit, &[[a.all, images]], out);
                group.scatter(side, to.target.blocks[side], out, to.values);
            }
        }
    }
}

/// `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l` of all groups.
///
/// Within an instant the sum is symmetric: half of it is `Pᵀ (½ H_w P + Hᵀ P′_l)`, and the other half its transpose.
struct ContractedTask<'a, 'p> {
    groups: &'a Groups,
    blocks: [&'a Blocks; 2],
    to: &'a mut Pulled<'p>,
}

impl Task for ContractedTask<'_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, unit: S) {
        let to = self.to;
        for group in &self.groups.list {
            let (images, out) = group.split(to.local, 2);
            let (images, images_l) = images.split_at_mut(images.len() / 2);
            for side in (0..4).filter(|&side| to.sides.blocks[side]) {
                let (base, pairs) = (to.target.blocks[side], &group.pairs);
                let [a, b] = group.columns(to.columns, side);
                let [al, bl] = group.columns(to.columns_l, side);
                if side == 0 || side == 3 {
                    pairs.images_along(unit, side, self.blocks, 0.5, [b, bl], images);
                    group.multiply(unit, &[[a.all, images]], out);
                    group.scatter_transposed(side, base, out, to.values);
                } else {
                    pairs.images_along(unit, side, self.blocks, 1.0, [b, bl], images);
                    pairs.images(unit, side, self.blocks[0], b, images_l);
                    group.multiply(unit, &[[a.all, images], [al.all, images_l]], out);
                }
                group.scatter(side, base, out, to.values);
            }
        }
    }
}

/// Work that is compiled for each vector unit.
pub(super) trait Task {
    /// Does it; a register has a part of [`LANES`] numbers.
    fn run<S: Simd>(self, unit: S);
}

struct Padded<T>(T);

impl<T: Task> WithSimd for Padded<T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        match LANES % S::F64_LANES {
            0 => self.0.run(unit),
            _ => self.0.run(Scalar::new()),
        }
    }
}

/// Does a task with the vector unit of this machine.
#[inline]
pub(super) fn dispatch<T: Task>(task: T) {
    Arch::new().dispatch(Padded(task));
}
