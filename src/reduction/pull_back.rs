//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.
//!
//! Vectors with the same support (all vectors of one body, all spans between two) share one small local matrix, which is
//! scattered once; so the cost of scattering does not grow with the number of effects.

use crate::functional::{Couplings, Part, Sides};
use crate::math::{Matrix, Vector};
use crate::reduction::instant::Instant;
use crate::reduction::motion::{Dependence, Motion};
use crate::reduction::pattern::{Layout, Pattern};
use crate::reduction::tree::{LANES, Packed};
use std::collections::BTreeMap;
use wide::f64x4;

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
struct Pair {
    slot: usize,
    /// Slot of the pair in the other order.
    transposed: usize,
    /// Where the columns of both start.
    first: [usize; 2],
}

/// Pairs of articulated vectors between two supports.
#[derive(Clone, Debug)]
struct Articulated {
    rows: usize,
    /// Strides of the columns.
    stride: [usize; 2],
    pairs: Vec<Pair>,
    /// Places of the entries, for blocks of one instant and between neighbours.
    same: Vec<Scatter>,
    cross: Vec<Scatter>,
}

/// Where an entry of a local matrix goes.
#[derive(Clone, Copy, Debug)]
struct Scatter {
    from: usize,
    to: usize,
    /// Where it goes in the transposed block.
    transposed: usize,
}

/// One scalar entry c · block[i, j] of a pair of linear vectors.
#[derive(Clone, Copy, Debug)]
struct Linear {
    slot: usize,
    factor: f64,
    entry: (usize, usize),
    same: usize,
    cross: usize,
}

/// One entry of a vector against a scalar.
#[derive(Clone, Copy, Debug)]
enum Mixed {
    Articulated {
        slot: usize,
        column: usize,
        stride: usize,
        place: usize,
    },
    Linear {
        slot: usize,
        factor: f64,
        component: usize,
        place: usize,
    },
}

/// Groups by the supports of both vectors.
type Groups = BTreeMap<(Vec<usize>, Vec<usize>), Articulated>;

/// The plan of a pull-back: which blocks go where.
#[derive(Clone, Debug, Default)]
pub struct PullBack {
    articulated_full: Vec<Articulated>,
    articulated_isotropic: Vec<Articulated>,
    full: Vec<Linear>,
    isotropic: Vec<Linear>,
    mixed: Vec<Mixed>,
    /// (slot, place).
    scalars: Vec<(usize, usize)>,
    /// Largest local matrix.
    local: usize,
}

/// Where the blocks of one interval go in the values: places of the four blocks, of both mixed blocks and of scalars.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// (k, k), (k, k+1), (k+1, k), (k+1, k+1).
    pub blocks: [usize; 4],
    /// (z_k, s), (z_{k+1}, s).
    pub mixed: [usize; 2],
    /// (s, s).
    pub scalars: usize,
}

impl PullBack {
    /// Plans the pull-back of a site; entries join the layout. Scalars of an instant are its multipliers.
    pub fn new(couplings: &Couplings, motion: &Motion, layout: &mut Layout, site: Site) -> Self {
        let mut plan = Self::default();
        let (mut full, mut isotropic) = (Groups::new(), Groups::new());
        for (slot, &(a, b)) in couplings.full.iter().enumerate() {
            let transposed = couplings.transposed_full(slot);
            match (&motion.vectors[a], &motion.vectors[b]) {
                (Dependence::Articulated(a), Dependence::Articulated(b)) => {
                    let pair = Pair {
                        slot,
                        transposed,
                        first: [a.first, b.first],
                    };
                    Self::group(&mut full, [a, b], layout, site)
                        .pairs
                        .push(pair);
                }
                (Dependence::Linear { parts: s, .. }, Dependence::Linear { parts: t, .. }) => {
                    for entry in (0..9).map(|e| (e / 3, e % 3)) {
                        plan.full
                            .extend(Self::linear(slot, s, t, entry, layout, site));
                    }
                }
                _ => unreachable!("vectors of one scene are all articulated or all linear"),
            }
        }
        for (slot, &(a, b)) in couplings.isotropic.iter().enumerate() {
            let transposed = couplings.transposed_isotropic(slot);
            match (&motion.vectors[a], &motion.vectors[b]) {
                (Dependence::Articulated(a), Dependence::Articulated(b)) => {
                    let pair = Pair {
                        slot,
                        transposed,
                        first: [a.first, b.first],
                    };
                    Self::group(&mut isotropic, [a, b], layout, site)
                        .pairs
                        .push(pair);
                }
                (Dependence::Linear { parts: s, .. }, Dependence::Linear { parts: t, .. }) => {
                    for i in 0..3 {
                        plan.isotropic
                            .extend(Self::linear(slot, s, t, (i, i), layout, site));
                    }
                }
                _ => unreachable!("vectors of one scene are all articulated or all linear"),
            }
        }
        let lay = |groups: Groups| {
            groups
                .into_values()
                .filter(|g| g.rows * g.stride[1] > 0)
                .collect::<Vec<_>>()
        };
        (plan.articulated_full, plan.articulated_isotropic) = (lay(full), lay(isotropic));
        let groups = plan
            .articulated_full
            .iter()
            .chain(&plan.articulated_isotropic);
        plan.local = groups.map(|g| g.rows * g.stride[1]).max().unwrap_or(0);
        for (slot, &(a, s)) in couplings.mixed.iter().enumerate() {
            match &motion.vectors[a] {
                Dependence::Articulated(packed) => {
                    for (i, &row) in packed.support.iter().enumerate() {
                        for place in site.mixed(layout, motion, row, s) {
                            let (column, stride) = (packed.first + i, packed.stride);
                            plan.mixed.push(Mixed::Articulated {
                                slot,
                                column,
                                stride,
                                place,
                            });
                        }
                    }
                }
                Dependence::Linear { parts, .. } => {
                    for &(first, factor) in parts {
                        for component in 0..3 {
                            for place in site.mixed(layout, motion, first + component, s) {
                                plan.mixed.push(Mixed::Linear {
                                    slot,
                                    factor,
                                    component,
                                    place,
                                });
                            }
                        }
                    }
                }
            }
        }
        if site == Site::Intervals {
            plan.scalars = couplings
                .scalars
                .iter()
                .enumerate()
                .map(|(i, &(s, t))| (i, layout.scalars.slot(s, t)))
                .collect();
        }
        plan
    }

    fn group<'g>(
        groups: &'g mut Groups,
        [a, b]: [&Packed; 2],
        layout: &mut Layout,
        site: Site,
    ) -> &'g mut Articulated {
        groups
            .entry((a.support.clone(), b.support.clone()))
            .or_insert_with(|| {
                let places = |pattern: &mut Pattern| {
                    let mut list = Vec::new();
                    for (i, &row) in a.support.iter().enumerate() {
                        for (j, &col) in b.support.iter().enumerate() {
                            let from = i * b.stride + j;
                            list.push(Scatter {
                                from,
                                to: pattern.slot(row, col),
                                transposed: pattern.slot(col, row),
                            });
                        }
                    }
                    list
                };
                Articulated {
                    rows: a.support.len(),
                    stride: [a.stride, b.stride],
                    pairs: Vec::new(),
                    same: places(&mut layout.same),
                    cross: if site == Site::Intervals {
                        places(&mut layout.cross)
                    } else {
                        Vec::new()
                    },
                }
            })
    }

    fn linear(
        slot: usize,
        s: &[(usize, f64)],
        t: &[(usize, f64)],
        entry: (usize, usize),
        layout: &mut Layout,
        site: Site,
    ) -> Vec<Linear> {
        let mut list = Vec::new();
        for &(f, c) in s {
            for &(g, d) in t {
                let (row, col) = (f + entry.0, g + entry.1);
                let same = layout.same.slot(row, col);
                let cross = match site {
                    Site::Intervals => layout.cross.slot(row, col),
                    Site::Instants => usize::MAX,
                };
                list.push(Linear {
                    slot,
                    factor: c * d,
                    entry,
                    same,
                    cross,
                });
            }
        }
        list
    }

    /// Size of the local storage that an evaluation needs.
    pub fn local(&self) -> usize {
        self.local
    }

    /// Adds Pᵀ H P.
    pub fn hessian(
        &self,
        ends: [&Instant; 2],
        part: &Part,
        sides: Sides,
        target: &Target,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let columns = ends.map(|e| e.columns.as_slice());
        for group in &self.articulated_full {
            for side in (0..4).filter(|&s| sides.blocks[s]) {
                let local = group.local(local);
                group.add_full(
                    [columns[side / 2], columns[side % 2]],
                    side,
                    &part.blocks.full,
                    local,
                );
                group.scatter(side, target.blocks[side], local, values);
            }
        }
        // Isotropic blocks come from potentials: the block below the diagonal is the one above, transposed.
        let mirrored = sides.blocks[1] && sides.blocks[2];
        for group in &self.articulated_isotropic {
            for side in (0..4).filter(|&s| sides.blocks[s] && !(mirrored && s == 2)) {
                let local = group.local(local);
                group.add_isotropic(
                    [columns[side / 2], columns[side % 2]],
                    side,
                    &part.blocks.isotropic,
                    local,
                );
                group.scatter(side, target.blocks[side], local, values);
                if mirrored && side == 1 {
                    group.scatter_transposed(side, target.blocks[2], local, values);
                }
            }
        }
        self.hessian_linear(
            &part.blocks.full,
            &part.blocks.isotropic,
            sides,
            target,
            values,
        );
        for entry in &self.mixed {
            for side in (0..2).filter(|&side| target.mixed[side] != usize::MAX) {
                let (place, value) = match *entry {
                    Mixed::Articulated {
                        slot,
                        column,
                        stride,
                        place,
                    } => (
                        place,
                        dot(
                            columns[side],
                            column,
                            stride,
                            &part.blocks.mixed[slot][side],
                        ),
                    ),
                    Mixed::Linear {
                        slot,
                        factor,
                        component,
                        place,
                    } => (place, factor * part.blocks.mixed[slot][side][component]),
                };
                values[target.mixed[side] + place] += value;
            }
        }
        for &(slot, place) in &self.scalars {
            values[target.scalars + place] += part.blocks.scalars[slot];
        }
    }

    fn hessian_linear(
        &self,
        full: &[[Matrix; 4]],
        isotropic: &[[f64; 4]],
        sides: Sides,
        target: &Target,
        values: &mut [f64],
    ) {
        for side in (0..4).filter(|&s| sides.blocks[s]) {
            let base = target.blocks[side];
            let cross = side == 1 || side == 2;
            for e in &self.full {
                let place = if cross { e.cross } else { e.same };
                values[base + place] += e.factor * full[e.slot][side][e.entry];
            }
            for e in &self.isotropic {
                let place = if cross { e.cross } else { e.same };
                values[base + place] += e.factor * isotropic[e.slot][side];
            }
        }
    }

    /// Adds the lower blocks of `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l`.
    pub fn third(
        &self,
        ends: [&Instant; 2],
        [plain, contracted]: [&Part; 2],
        sides: Sides,
        target: &Target,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let columns = ends.map(|e| e.columns.as_slice());
        let columns_l = ends.map(|e| e.columns_l.as_slice());
        let lower = Sides {
            blocks: [sides.blocks[0], false, sides.blocks[2], sides.blocks[3]],
        };
        for group in &self.articulated_full {
            for side in (0..4).filter(|&s| lower.blocks[s]) {
                let (r, s) = (side / 2, side % 2);
                let local = group.local(local);
                let ends = [columns[r], columns[s], columns_l[r], columns_l[s]];
                group.add_full_along(
                    ends,
                    side,
                    &plain.blocks.full,
                    &contracted.blocks.full,
                    local,
                );
                group.scatter(side, target.blocks[side], local, values);
            }
        }
        for group in &self.articulated_isotropic {
            for side in (0..4).filter(|&s| lower.blocks[s]) {
                let (r, s) = (side / 2, side % 2);
                let local = group.local(local);
                let ends = [columns[r], columns[s], columns_l[r], columns_l[s]];
                let (h, hw) = (&plain.blocks.isotropic, &contracted.blocks.isotropic);
                group.add_isotropic_along(ends, side, h, hw, local);
                group.scatter(side, target.blocks[side], local, values);
                if r == s {
                    group.scatter_transposed(side, target.blocks[side], local, values);
                }
            }
        }
        self.hessian_linear(
            &contracted.blocks.full,
            &contracted.blocks.isotropic,
            lower,
            target,
            values,
        );
        for entry in &self.mixed {
            for side in (0..2).filter(|&side| target.mixed[side] != usize::MAX) {
                let (place, value) = match *entry {
                    Mixed::Articulated {
                        slot,
                        column,
                        stride,
                        place,
                    } => (
                        place,
                        dot(
                            columns[side],
                            column,
                            stride,
                            &contracted.blocks.mixed[slot][side],
                        ) + dot(
                            columns_l[side],
                            column,
                            stride,
                            &plain.blocks.mixed[slot][side],
                        ),
                    ),
                    Mixed::Linear {
                        slot,
                        factor,
                        component,
                        place,
                    } => (
                        place,
                        factor * contracted.blocks.mixed[slot][side][component],
                    ),
                };
                values[target.mixed[side] + place] += value;
            }
        }
        for &(slot, place) in &self.scalars {
            values[target.scalars + place] += contracted.blocks.scalars[slot];
        }
    }
}

/// One column of a vector times a vector.
#[inline]
fn dot(columns: &[f64], column: usize, stride: usize, v: &Vector) -> f64 {
    columns[column] * v.x + columns[column + stride] * v.y + columns[column + 2 * stride] * v.z
}

/// Four neighbouring columns of a vector: its three rows.
type Lanes = [f64x4; 3];

/// The columns from `at` of a vector.
#[inline]
fn take(columns: &[f64], first: usize, stride: usize, at: usize) -> Lanes {
    let row = |i: usize| load(columns, first + i * stride + at);
    [row(0), row(1), row(2)]
}

#[inline]
fn load(values: &[f64], at: usize) -> f64x4 {
    let lanes: [f64; LANES] = values[at..at + LANES]
        .try_into()
        .expect("rows are padded to whole lanes");
    f64x4::from(lanes)
}

/// m b.
#[inline]
fn image(m: &Matrix, b: &Lanes) -> Lanes {
    let row = |i: usize| {
        b[0] * f64x4::splat(m[(i, 0)])
            + b[1] * f64x4::splat(m[(i, 1)])
            + b[2] * f64x4::splat(m[(i, 2)])
    };
    [row(0), row(1), row(2)]
}

/// c b.
#[inline]
fn scaled(c: f64, b: &Lanes) -> Lanes {
    let c = f64x4::splat(c);
    [b[0] * c, b[1] * c, b[2] * c]
}

#[inline]
fn sum(a: &Lanes, b: &Lanes) -> Lanes {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

impl Articulated {
    /// Adds aᵀ t to the columns from `at`, for the vector whose columns start at `first`.
    #[inline]
    fn add_product(&self, a: &[f64], first: usize, t: &Lanes, at: usize, out: &mut [f64]) {
        let stride = self.stride[0];
        let (x, rest) = a[first..first + 3 * stride].split_at(stride);
        let (y, z) = rest.split_at(stride);
        let rows = out
            .chunks_exact_mut(self.stride[1])
            .zip(x.iter().zip(y.iter().zip(z)));
        for (row, (&x, (&y, &z))) in rows {
            let row = &mut row[at..at + LANES];
            let sum = load(row, 0)
                + t[0] * f64x4::splat(x)
                + t[1] * f64x4::splat(y)
                + t[2] * f64x4::splat(z);
            row.copy_from_slice(&sum.to_array());
        }
    }

    /// Adds aᵀ t + a′ᵀ t′, likewise.
    #[inline]
    fn add_products(
        &self,
        [a, al]: [&[f64]; 2],
        first: usize,
        [t, tl]: [&Lanes; 2],
        at: usize,
        out: &mut [f64],
    ) {
        let stride = self.stride[0];
        let (x, rest) = a[first..first + 3 * stride].split_at(stride);
        let (y, z) = rest.split_at(stride);
        let (xl, rest) = al[first..first + 3 * stride].split_at(stride);
        let (yl, zl) = rest.split_at(stride);
        let rows = out
            .chunks_exact_mut(self.stride[1])
            .zip(x.iter().zip(y.iter().zip(z)));
        for ((row, (&x, (&y, &z))), (&xl, (&yl, &zl))) in rows.zip(xl.iter().zip(yl.iter().zip(zl)))
        {
            let row = &mut row[at..at + LANES];
            let plain = t[0] * f64x4::splat(x) + t[1] * f64x4::splat(y) + t[2] * f64x4::splat(z);
            let along =
                tl[0] * f64x4::splat(xl) + tl[1] * f64x4::splat(yl) + tl[2] * f64x4::splat(zl);
            let sum = load(row, 0) + plain + along;
            row.copy_from_slice(&sum.to_array());
        }
    }

    /// The local matrix, cleared.
    #[inline]
    fn local<'l>(&self, local: &'l mut [f64]) -> &'l mut [f64] {
        let local = &mut local[..self.rows * self.stride[1]];
        local.fill(0.0);
        local
    }

    fn add_full(&self, [a, b]: [&[f64]; 2], side: usize, blocks: &[[Matrix; 4]], out: &mut [f64]) {
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let t = image(
                    &blocks[pair.slot][side],
                    &take(b, pair.first[1], self.stride[1], at),
                );
                self.add_product(a, pair.first[0], &t, at, out);
            }
        }
    }

    fn add_isotropic(
        &self,
        [a, b]: [&[f64]; 2],
        side: usize,
        blocks: &[[f64; 4]],
        out: &mut [f64],
    ) {
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let t = scaled(
                    blocks[pair.slot][side],
                    &take(b, pair.first[1], self.stride[1], at),
                );
                self.add_product(a, pair.first[0], &t, at, out);
            }
        }
    }

    fn add_full_along(
        &self,
        [a, b, al, bl]: [&[f64]; 4],
        side: usize,
        plain: &[[Matrix; 4]],
        contracted: &[[Matrix; 4]],
        out: &mut [f64],
    ) {
        let other = 2 * (side % 2) + side / 2;
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let (h, hw) = (&plain[pair.slot][side], &contracted[pair.slot][side]);
                let ht = plain[pair.transposed][other].transpose();
                let columns = take(b, pair.first[1], self.stride[1], at);
                let columns_l = take(bl, pair.first[1], self.stride[1], at);
                let t = sum(&image(hw, &columns), &image(&ht, &columns_l));
                self.add_products([a, al], pair.first[0], [&t, &image(h, &columns)], at, out);
            }
        }
    }

    /// Within an instant half of the symmetric sum, `Jᵀ(½ h_w J + h J′)`; the transpose is the other half.
    fn add_isotropic_along(
        &self,
        [a, b, al, bl]: [&[f64]; 4],
        side: usize,
        plain: &[[f64; 4]],
        contracted: &[[f64; 4]],
        out: &mut [f64],
    ) {
        let within = side == 0 || side == 3;
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let (h, hw) = (plain[pair.slot][side], contracted[pair.slot][side]);
                let columns = take(b, pair.first[1], self.stride[1], at);
                let columns_l = take(bl, pair.first[1], self.stride[1], at);
                if within {
                    let t = sum(&scaled(0.5 * hw, &columns), &scaled(h, &columns_l));
                    self.add_product(a, pair.first[0], &t, at, out);
                } else {
                    let t = sum(&scaled(hw, &columns), &scaled(h, &columns_l));
                    self.add_products([a, al], pair.first[0], [&t, &scaled(h, &columns)], at, out);
                }
            }
        }
    }

    fn places(&self, side: usize) -> &[Scatter] {
        if side == 1 || side == 2 {
            &self.cross
        } else {
            &self.same
        }
    }

    #[inline]
    fn scatter(&self, side: usize, base: usize, local: &[f64], values: &mut [f64]) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.to] += local[place.from];
        }
    }

    #[inline]
    fn scatter_transposed(&self, side: usize, base: usize, local: &[f64], values: &mut [f64]) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.transposed] += local[place.from];
        }
    }
}

/// Where a sum lives in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Site {
    /// Scalars are those of the interval.
    Intervals,
    /// Scalars are multipliers, unknowns of the instant itself.
    Instants,
}

impl Site {
    /// Places of the coupling of coordinate `row` and scalar `s`: a block of its own for an interval, both triangles of
    /// (z, z) for an instant.
    fn mixed(self, layout: &mut Layout, motion: &Motion, row: usize, s: usize) -> Vec<usize> {
        match self {
            Self::Intervals => vec![layout.mixed.slot(row, s)],
            Self::Instants => {
                let multiplier = motion.coordinates + s;
                vec![
                    layout.same.slot(row, multiplier),
                    layout.same.slot(multiplier, row),
                ]
            }
        }
    }
}
