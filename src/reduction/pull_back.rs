//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.
//!
//! Vectors with the same support (all vectors of one body, all spans between two) share one small local matrix, which is
//! scattered once; so the cost of scattering does not grow with the number of effects.

use crate::functional::{Couplings, Part, Sides};
use crate::math::{Matrix, Vector};
use crate::reduction::instant::Instant;
use crate::reduction::motion::{Dependence, Motion};
use crate::reduction::pattern::{Layout, Pattern};
use crate::reduction::tree::Packed;
use std::collections::BTreeMap;

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
struct Pair {
    slot: usize,
    /// Slot of the pair in the other order.
    transposed: usize,
    /// Where the columns of both start.
    first: [usize; 2],
}

/// All pairs of articulated vectors between two supports.
#[derive(Clone, Debug)]
struct Articulated {
    rows: usize,
    cols: usize,
    /// Strides of the columns.
    stride: [usize; 2],
    full: Vec<Pair>,
    isotropic: Vec<Pair>,
    /// (place in the local matrix, place in the values), for blocks of one instant and between neighbours.
    same: Vec<(usize, usize)>,
    cross: Vec<(usize, usize)>,
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

/// The plan of a pull-back: which blocks go where.
#[derive(Clone, Debug, Default)]
pub struct PullBack {
    articulated: Vec<Articulated>,
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
        let mut groups: BTreeMap<(Vec<usize>, Vec<usize>), Articulated> = BTreeMap::new();
        for (slot, &(a, b)) in couplings.full.iter().enumerate() {
            let transposed = couplings.transposed_full(slot);
            match (&motion.vectors[a], &motion.vectors[b]) {
                (Dependence::Articulated(a), Dependence::Articulated(b)) => {
                    let pair = Pair {
                        slot,
                        transposed,
                        first: [a.first, b.first],
                    };
                    Self::group(&mut groups, [a, b], layout, site)
                        .full
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
                    Self::group(&mut groups, [a, b], layout, site)
                        .isotropic
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
        plan.articulated = groups
            .into_values()
            .filter(|g| g.rows * g.cols > 0)
            .collect();
        plan.local = plan
            .articulated
            .iter()
            .map(|g| 4 * g.rows * g.stride[1])
            .max()
            .unwrap_or(0);
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
        groups: &'g mut BTreeMap<(Vec<usize>, Vec<usize>), Articulated>,
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
                            list.push((i * b.stride + j, pattern.slot(row, col)));
                        }
                    }
                    list
                };
                Articulated {
                    rows: a.support.len(),
                    cols: b.support.len(),
                    stride: [a.stride, b.stride],
                    full: Vec::new(),
                    isotropic: Vec::new(),
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
        for group in &self.articulated {
            let size = group.rows * group.stride[1];
            let local = &mut local[..4 * size];
            local.fill(0.0);
            for side in (0..4).filter(|&s| sides.blocks[s]) {
                let out = &mut local[side * size..(side + 1) * size];
                let ends = [columns[side / 2], columns[side % 2]];
                group.blocks(|lanes, at| match lanes {
                    Lanes::Eight => group.hessian::<8>(at, ends, side, part, out),
                    Lanes::Four => group.hessian::<4>(at, ends, side, part, out),
                });
            }
            group.scatter(sides, target, local, values);
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
        for group in &self.articulated {
            let size = group.rows * group.stride[1];
            let local = &mut local[..4 * size];
            local.fill(0.0);
            for side in (0..4).filter(|&s| lower.blocks[s]) {
                let out = &mut local[side * size..(side + 1) * size];
                let (r, s) = (side / 2, side % 2);
                let ends = [columns[r], columns[s], columns_l[r], columns_l[s]];
                let parts = [plain, contracted];
                group.blocks(|lanes, at| match lanes {
                    Lanes::Eight => group.third::<8>(at, ends, side, parts, out),
                    Lanes::Four => group.third::<4>(at, ends, side, parts, out),
                });
            }
            group.scatter(lower, target, local, values);
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

/// How many columns are taken at once.
#[derive(Clone, Copy, Debug)]
enum Lanes {
    Four,
    Eight,
}

/// `L` columns from `at` of a vector, row by row.
#[inline]
fn take<const L: usize>(columns: &[f64], first: usize, stride: usize, at: usize) -> [[f64; L]; 3] {
    let row = |i: usize| {
        let start = first + i * stride + at;
        let mut lanes = [0.0; L];
        lanes.copy_from_slice(&columns[start..start + L]);
        lanes
    };
    [row(0), row(1), row(2)]
}

/// Adds m b to `t`.
#[inline]
fn add_image<const L: usize>(
    t: &mut [[f64; L]; 3],
    m: impl Fn(usize, usize) -> f64,
    b: &[[f64; L]; 3],
) {
    for (i, row) in t.iter_mut().enumerate() {
        let (x, y, z) = (m(i, 0), m(i, 1), m(i, 2));
        for l in 0..L {
            row[l] += x * b[0][l] + y * b[1][l] + z * b[2][l];
        }
    }
}

impl Articulated {
    /// Calls `work` for each block of columns.
    #[inline]
    fn blocks(&self, mut work: impl FnMut(Lanes, usize)) {
        let mut at = 0;
        while at + 4 < self.cols {
            work(Lanes::Eight, at);
            at += 8;
        }
        if at < self.cols {
            work(Lanes::Four, at);
        }
    }

    /// Adds aᵀ t for the rows of the vector whose columns start at `first`.
    #[inline]
    fn add_product<const L: usize>(
        &self,
        a: &[f64],
        first: usize,
        t: &[[f64; L]; 3],
        at: usize,
        out: &mut [f64],
    ) {
        let stride = self.stride[0];
        let (x, rest) = a[first..first + 3 * stride].split_at(stride);
        let (y, z) = rest.split_at(stride);
        let rows = out
            .chunks_exact_mut(self.stride[1])
            .zip(x.iter().zip(y.iter().zip(z)));
        for (row, (x, (y, z))) in rows {
            let row: &mut [f64; L] = (&mut row[at..at + L])
                .try_into()
                .expect("lanes lie in the row");
            for l in 0..L {
                row[l] += x * t[0][l] + y * t[1][l] + z * t[2][l];
            }
        }
    }

    #[inline]
    fn hessian<const L: usize>(
        &self,
        at: usize,
        [a, b]: [&[f64]; 2],
        side: usize,
        part: &Part,
        out: &mut [f64],
    ) {
        for pair in &self.full {
            let h = &part.blocks.full[pair.slot][side];
            let mut t = [[0.0; L]; 3];
            add_image(
                &mut t,
                |i, j| h[(i, j)],
                &take(b, pair.first[1], self.stride[1], at),
            );
            self.add_product(a, pair.first[0], &t, at, out);
        }
        for pair in &self.isotropic {
            let h = part.blocks.isotropic[pair.slot][side];
            let t = take::<L>(b, pair.first[1], self.stride[1], at).map(|row| row.map(|x| h * x));
            self.add_product(a, pair.first[0], &t, at, out);
        }
    }

    #[inline]
    fn third<const L: usize>(
        &self,
        at: usize,
        [a, b, al, bl]: [&[f64]; 4],
        side: usize,
        [plain, contracted]: [&Part; 2],
        out: &mut [f64],
    ) {
        let other = 2 * (side % 2) + side / 2;
        for pair in &self.full {
            let h = &plain.blocks.full[pair.slot][side];
            let ht = &plain.blocks.full[pair.transposed][other];
            let hw = &contracted.blocks.full[pair.slot][side];
            let columns = take::<L>(b, pair.first[1], self.stride[1], at);
            let columns_l = take::<L>(bl, pair.first[1], self.stride[1], at);
            let (mut t, mut t_l) = ([[0.0; L]; 3], [[0.0; L]; 3]);
            add_image(&mut t, |i, j| hw[(i, j)], &columns);
            add_image(&mut t, |i, j| ht[(j, i)], &columns_l);
            add_image(&mut t_l, |i, j| h[(i, j)], &columns);
            self.add_product(a, pair.first[0], &t, at, out);
            self.add_product(al, pair.first[0], &t_l, at, out);
        }
        for pair in &self.isotropic {
            let h = plain.blocks.isotropic[pair.slot][side];
            let hw = contracted.blocks.isotropic[pair.slot][side];
            let columns = take::<L>(b, pair.first[1], self.stride[1], at);
            let columns_l = take::<L>(bl, pair.first[1], self.stride[1], at);
            let mut t = [[0.0; L]; 3];
            let mut t_l = [[0.0; L]; 3];
            for i in 0..3 {
                for l in 0..L {
                    t[i][l] = hw * columns[i][l] + h * columns_l[i][l];
                    t_l[i][l] = h * columns[i][l];
                }
            }
            self.add_product(a, pair.first[0], &t, at, out);
            self.add_product(al, pair.first[0], &t_l, at, out);
        }
    }

    fn scatter(&self, sides: Sides, target: &Target, local: &[f64], values: &mut [f64]) {
        let size = self.rows * self.stride[1];
        for side in (0..4).filter(|&s| sides.blocks[s]) {
            let places = if side == 1 || side == 2 {
                &self.cross
            } else {
                &self.same
            };
            let local = &local[side * size..(side + 1) * size];
            let values = &mut values[target.blocks[side]..];
            for &(from, to) in places {
                values[to] += local[from];
            }
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
