//! Pᵀ H P and its derivative along a direction, block by block into prepared slots.
//!
//! Vectors with the same support (all vectors of one body, all spans between two) share one small local matrix, which is
//! scattered once; so the cost of scattering does not grow with the number of effects.

use crate::functional::{Couplings, Part, Sides};
use crate::math::{Matrix, Vector};
use crate::reduction::instant::Instant;
use crate::reduction::motion::{Dependence, Motion};
use crate::reduction::pattern::Layout;
use std::collections::BTreeMap;

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
struct Pair {
    slot: usize,
    /// Slot of the pair in the other order.
    transposed: usize,
    /// First columns.
    first: [usize; 2],
}

/// All pairs of articulated vectors between two supports.
#[derive(Clone, Debug)]
struct Articulated {
    rows: usize,
    cols: usize,
    full: Vec<Pair>,
    isotropic: Vec<Pair>,
    same: Vec<usize>,
    cross: Vec<usize>,
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
                (
                    Dependence::Articulated {
                        first: f,
                        support: s,
                    },
                    Dependence::Articulated {
                        first: g,
                        support: t,
                    },
                ) => {
                    let group = Self::group(&mut groups, s, t, layout, site);
                    group.full.push(Pair {
                        slot,
                        transposed,
                        first: [*f, *g],
                    });
                }
                (Dependence::Linear { parts: s, .. }, Dependence::Linear { parts: t, .. }) => {
                    for i in 0..3 {
                        for j in 0..3 {
                            plan.full
                                .extend(Self::linear(slot, s, t, (i, j), layout, site));
                        }
                    }
                }
                _ => unreachable!("vectors of one scene are all articulated or all linear"),
            }
        }
        for (slot, &(a, b)) in couplings.isotropic.iter().enumerate() {
            let transposed = couplings.transposed_isotropic(slot);
            match (&motion.vectors[a], &motion.vectors[b]) {
                (
                    Dependence::Articulated {
                        first: f,
                        support: s,
                    },
                    Dependence::Articulated {
                        first: g,
                        support: t,
                    },
                ) => {
                    let group = Self::group(&mut groups, s, t, layout, site);
                    group.isotropic.push(Pair {
                        slot,
                        transposed,
                        first: [*f, *g],
                    });
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
            .map(|g| 4 * g.rows * g.cols)
            .max()
            .unwrap_or(0);
        for (slot, &(a, s)) in couplings.mixed.iter().enumerate() {
            match &motion.vectors[a] {
                Dependence::Articulated { first, support } => {
                    for (i, &row) in support.iter().enumerate() {
                        for place in site.mixed(layout, motion, row, s) {
                            plan.mixed.push(Mixed::Articulated {
                                slot,
                                column: first + i,
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

    fn group<'a>(
        groups: &'a mut BTreeMap<(Vec<usize>, Vec<usize>), Articulated>,
        s: &[usize],
        t: &[usize],
        layout: &mut Layout,
        site: Site,
    ) -> &'a mut Articulated {
        groups.entry((s.to_vec(), t.to_vec())).or_insert_with(|| {
            let entries = || s.iter().flat_map(|&i| t.iter().map(move |&j| (i, j)));
            Articulated {
                rows: s.len(),
                cols: t.len(),
                full: Vec::new(),
                isotropic: Vec::new(),
                same: entries().map(|(i, j)| layout.same.slot(i, j)).collect(),
                cross: match site {
                    Site::Intervals => entries().map(|(i, j)| layout.cross.slot(i, j)).collect(),
                    Site::Instants => Vec::new(),
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
        [a, b]: [&Instant; 2],
        part: &Part,
        sides: Sides,
        target: &Target,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let columns = [a.columns.as_slice(), b.columns.as_slice()];
        for group in &self.articulated {
            let size = group.rows * group.cols;
            let local = &mut local[..4 * size];
            local.fill(0.0);
            for side in (0..4).filter(|&s| sides.blocks[s]) {
                let (ca, cb) = (columns[side / 2], columns[side % 2]);
                let out = &mut local[side * size..(side + 1) * size];
                for pair in &group.full {
                    let block = &part.blocks.full[pair.slot][side];
                    let rows = &ca[pair.first[0]..][..group.rows];
                    for (j, column) in cb[pair.first[1]..][..group.cols].iter().enumerate() {
                        add_column(out, group.cols, j, rows, &(block * column));
                    }
                }
                for pair in &group.isotropic {
                    let factor = part.blocks.isotropic[pair.slot][side];
                    let rows = &ca[pair.first[0]..][..group.rows];
                    for (j, column) in cb[pair.first[1]..][..group.cols].iter().enumerate() {
                        add_column(out, group.cols, j, rows, &(column * factor));
                    }
                }
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
            for side in 0..2 {
                let (place, value) = match *entry {
                    Mixed::Articulated {
                        slot,
                        column,
                        place,
                    } => (
                        place,
                        columns[side][column].dot(&part.blocks.mixed[slot][side]),
                    ),
                    Mixed::Linear {
                        slot,
                        factor,
                        component,
                        place,
                    } => (place, factor * part.blocks.mixed[slot][side][component]),
                };
                if target.mixed[side] != usize::MAX {
                    values[target.mixed[side] + place] += value;
                }
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
        [a, b]: [&Instant; 2],
        plain: &Part,
        contracted: &Part,
        sides: Sides,
        target: &Target,
        local: &mut [f64],
        values: &mut [f64],
    ) {
        let columns = [a.columns.as_slice(), b.columns.as_slice()];
        let columns_l = [a.columns_l.as_slice(), b.columns_l.as_slice()];
        let lower = Sides {
            blocks: [sides.blocks[0], false, sides.blocks[2], sides.blocks[3]],
        };
        for group in &self.articulated {
            let size = group.rows * group.cols;
            let local = &mut local[..4 * size];
            local.fill(0.0);
            for side in (0..4).filter(|&s| lower.blocks[s]) {
                let (r, s) = (side / 2, side % 2);
                let other = 2 * s + r;
                let out = &mut local[side * size..(side + 1) * size];
                for pair in &group.full {
                    let (fa, fb) = (pair.first[0], pair.first[1]);
                    let (rows, rows_l) = (
                        &columns[r][fa..][..group.rows],
                        &columns_l[r][fa..][..group.rows],
                    );
                    let h = &plain.blocks.full[pair.slot][side];
                    let ht = &plain.blocks.full[pair.transposed][other];
                    let hw = &contracted.blocks.full[pair.slot][side];
                    for j in 0..group.cols {
                        let (column, column_l) = (&columns[s][fb + j], &columns_l[s][fb + j]);
                        add_column(
                            out,
                            group.cols,
                            j,
                            rows,
                            &(hw * column + ht.tr_mul(column_l)),
                        );
                        add_column(out, group.cols, j, rows_l, &(h * column));
                    }
                }
                for pair in &group.isotropic {
                    let (fa, fb) = (pair.first[0], pair.first[1]);
                    let (rows, rows_l) = (
                        &columns[r][fa..][..group.rows],
                        &columns_l[r][fa..][..group.rows],
                    );
                    let h = plain.blocks.isotropic[pair.slot][side];
                    let hw = contracted.blocks.isotropic[pair.slot][side];
                    for j in 0..group.cols {
                        let (column, column_l) = (&columns[s][fb + j], &columns_l[s][fb + j]);
                        add_column(out, group.cols, j, rows, &(column * hw + column_l * h));
                        add_column(out, group.cols, j, rows_l, &(column * h));
                    }
                }
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
            for side in 0..2 {
                let (place, value) = match *entry {
                    Mixed::Articulated {
                        slot,
                        column,
                        place,
                    } => (
                        place,
                        columns[side][column].dot(&contracted.blocks.mixed[slot][side])
                            + columns_l[side][column].dot(&plain.blocks.mixed[slot][side]),
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
                if target.mixed[side] != usize::MAX {
                    values[target.mixed[side] + place] += value;
                }
            }
        }
        for &(slot, place) in &self.scalars {
            values[target.scalars + place] += contracted.blocks.scalars[slot];
        }
    }
}

/// out[i, j] += rows_i · v for all i.
#[inline]
fn add_column(out: &mut [f64], cols: usize, j: usize, rows: &[Vector], v: &Vector) {
    for (i, row) in rows.iter().enumerate() {
        out[i * cols + j] += row.dot(v);
    }
}

impl Articulated {
    fn scatter(&self, sides: Sides, target: &Target, local: &[f64], values: &mut [f64]) {
        let size = self.rows * self.cols;
        for side in (0..4).filter(|&s| sides.blocks[s]) {
            let slots = if side == 1 || side == 2 {
                &self.cross
            } else {
                &self.same
            };
            let base = target.blocks[side];
            for (value, &slot) in local[side * size..].iter().zip(slots) {
                values[base + slot] += value;
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
