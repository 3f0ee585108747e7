//! The one loop that adds derivatives of elements to forces, blocks and couplings.

use crate::functional::couplings::NONE;
use crate::functional::{BlockMask, Coupling, Kernel, NodeBlocks, Sample, SumDerivatives};
use crate::math::{Derivatives, Matrix, Vector};
use std::ops::Range;

/// First derivatives of a scalar of one element.
pub(super) trait FirstDerivatives {
    /// By argument `i`.
    fn by_vector(&self, i: usize) -> Vector;

    /// By scalar `s`.
    fn by_scalar(&self, s: usize) -> f64;
}

impl<D: Derivatives> FirstDerivatives for D {
    #[inline(always)]
    fn by_vector(&self, i: usize) -> Vector {
        self.force(i)
    }

    #[inline(always)]
    fn by_scalar(&self, s: usize) -> f64 {
        self.row(s)
    }
}

/// Sums to which first derivatives are added: by the vectors of both instants, and by scalars.
pub(super) struct FirstSums<'a> {
    pub(super) forces: &'a mut [Vec<Vector>; 2],
    pub(super) rows: &'a mut [f64],
}

impl SumDerivatives {
    /// Its first derivatives.
    #[inline(always)]
    pub(super) fn first(&mut self) -> FirstSums<'_> {
        FirstSums {
            forces: &mut self.forces,
            rows: &mut self.rows,
        }
    }

    /// Their derivatives by the length of the interval.
    #[inline(always)]
    pub(super) fn by_horizon(&mut self) -> FirstSums<'_> {
        FirstSums {
            forces: &mut self.horizon_forces,
            rows: &mut self.horizon_rows,
        }
    }
}

/// All arguments.
pub(super) const ALL: Range<usize> = 0..usize::MAX;

/// One element with its arguments, and the positions of its derivatives.
pub(super) struct Places<'a, K: Kernel> {
    element: &'a K,
    slots: Slots<'a>,
    h: f64,
    mask: BlockMask,
}

impl<'a, K: Kernel> Places<'a, K> {
    #[inline(always)]
    pub(super) fn new(element: &'a K, slots: Slots<'a>, sample: &Sample<'_>) -> Self {
        Self {
            element,
            slots,
            h: sample.h,
            mask: sample.sides,
        }
    }

    /// Adds c times first derivatives of the arguments `rows`, and of the scalars.
    #[inline(always)]
    pub(super) fn first(
        &self,
        c: f64,
        rows: Range<usize>,
        of: &impl FirstDerivatives,
        to: &mut FirstSums<'_>,
    ) {
        for i in 0..self.element.vectors() * K::READINGS {
            if !rows.contains(&i) {
                continue;
            }
            let arg = self.element.vector(i);
            let weights = arg.stencil.weights(self.h);
            let force = of.by_vector(i) * c;
            for (side, forces) in to.forces.iter_mut().enumerate() {
                if arg.stencil.reads(side) {
                    forces[arg.vector] += force * weights[side];
                }
            }
        }
        for s in 0..self.element.scalars() {
            if let Some((at, factor)) = self.element.scalar(s) {
                to.rows[at] += c * factor * of.by_scalar(s);
            }
        }
    }

    /// Adds c times second derivatives between the arguments `rows` and `columns`, with scalars, and between them.
    #[inline(always)]
    pub(super) fn second<D: Derivatives>(
        &self,
        c: f64,
        rows: Range<usize>,
        columns: Range<usize>,
        d: &D,
        part: &mut SumDerivatives,
    ) {
        if let Some(nodes) = &mut part.nodes {
            return self.at_nodes(c, rows, columns, d, nodes);
        }
        self.blocks(c, rows.clone(), columns, d, part);
        let vectors = self.element.vectors();
        for i in 0..vectors * K::READINGS {
            if rows.contains(&i) {
                self.columns(c, i, d, part);
            }
        }
        for s in 0..self.element.scalars() {
            self.entries(c, s, d, part);
        }
    }

    /// Adds the blocks of all pairs of vectors, each the sum over what is read of both.
    #[inline(always)]
    fn blocks<D: Derivatives>(
        &self,
        c: f64,
        rows: Range<usize>,
        columns: Range<usize>,
        d: &D,
        part: &mut SumDerivatives,
    ) {
        let vectors = self.element.vectors();
        for a in 0..vectors {
            for b in 0..vectors {
                let Some(slot) = self.slots.vectors(a, b) else {
                    continue;
                };
                let mut sums = [Matrix::zeros(); 4];
                for k in 0..K::READINGS {
                    for l in 0..K::READINGS {
                        let (i, j) = (k * vectors + a, l * vectors + b);
                        if rows.contains(&i) && columns.contains(&j) && K::couples(i, j) {
                            self.add_block(c, i, j, &d.block(i, j), &mut sums);
                        }
                    }
                }
                for (side, sum) in sums.iter().enumerate() {
                    if !self.mask.blocks[side] {
                        continue;
                    }
                    if K::ISOTROPIC {
                        part.blocks.isotropic[slot][side] += sum[(0, 0)];
                    } else {
                        part.blocks.full[slot][side] += sum;
                    }
                }
            }
        }
    }

    /// Adds c times the block of two arguments to the sums of the sides: rows of the instant `side / 2`, columns of `side % 2`.
    #[inline(always)]
    fn add_block(&self, c: f64, i: usize, j: usize, block: &Matrix, sums: &mut [Matrix; 4]) {
        let weights = |i: usize| self.element.vector(i).stencil.weights(self.h);
        let (wi, wj) = (weights(i), weights(j));
        for (side, sum) in sums.iter_mut().enumerate() {
            let weight = c * wi[side / 2] * wj[side % 2];
            if self.mask.blocks[side] && weight != 0.0 {
                *sum += block * weight;
            }
        }
    }

    /// Adds the blocks of an argument and all scalars.
    #[inline(always)]
    fn columns<D: Derivatives>(&self, c: f64, i: usize, d: &D, part: &mut SumDerivatives) {
        let vectors = self.element.vectors();
        let weights = self.element.vector(i).stencil.weights(self.h);
        for s in 0..self.element.scalars() {
            let slot = self.slots.mixed(i % vectors, s);
            if let (Some(slot), Some((_, factor))) = (slot, self.element.scalar(s)) {
                let column = d.column(i, s) * (c * factor);
                part.blocks.mixed[slot][0] += column * weights[0];
                part.blocks.mixed[slot][1] += column * weights[1];
            }
        }
    }

    /// Adds the entries of a scalar and all others.
    #[inline(always)]
    fn entries<D: Derivatives>(&self, c: f64, s: usize, d: &D, part: &mut SumDerivatives) {
        let Some((_, factor)) = self.element.scalar(s) else {
            return;
        };
        for t in 0..self.element.scalars() {
            if let Some(slot) = self.slots.scalars(s, t)
                && let Some((_, other)) = self.element.scalar(t)
            {
                part.blocks.scalars[slot] += c * factor * other * d.entry(s, t);
            }
        }
    }

    /// The same, to a matrix of nodes: the sum of the blocks that are asked for.
    #[inline(always)]
    fn at_nodes<D: Derivatives>(
        &self,
        c: f64,
        rows: Range<usize>,
        columns: Range<usize>,
        d: &D,
        nodes: &mut NodeBlocks,
    ) {
        let vectors = self.element.vectors();
        let vector = |i: usize| self.element.vector(i);
        for a in 0..vectors {
            for b in 0..vectors {
                let Some(pair) = nodes.pair(vector(a).vector, vector(b).vector) else {
                    continue;
                };
                let mut sum = Matrix::zeros();
                for k in 0..K::READINGS {
                    for l in 0..K::READINGS {
                        let (i, j) = (k * vectors + a, l * vectors + b);
                        if rows.contains(&i) && columns.contains(&j) && K::couples(i, j) {
                            let weight = c * self.weight(i, j);
                            if weight != 0.0 {
                                sum += d.block(i, j) * weight;
                            }
                        }
                    }
                }
                match K::ISOTROPIC {
                    true => nodes.add_isotropic(pair, sum[(0, 0)]),
                    false => nodes.add_full(pair, &sum),
                }
            }
        }
        let [of_rows, of_columns] = self.mask.instants();
        let sum = |weights: [f64; 2], read: [bool; 2]| {
            let read = weights.into_iter().zip(read).filter(|(_, read)| *read);
            read.map(|(weight, _)| weight).sum::<f64>()
        };
        for s in 0..self.element.scalars() {
            let Some((at, factor)) = self.element.scalar(s) else {
                continue;
            };
            for i in (0..vectors * K::READINGS).filter(|i| rows.contains(i)) {
                let weights = vector(i).stencil.weights(self.h);
                let column = d.column(i, s) * (c * factor);
                let parts = [of_rows, of_columns].map(|read| column * sum(weights, read));
                nodes.add_mixed(vector(i).vector, at, parts);
            }
            for t in 0..self.element.scalars() {
                // Each pair once, as among couplings.
                if let Some((other, by)) = self.element.scalar(t)
                    && other <= at
                {
                    nodes.add_scalars(at, other, c * factor * by * d.entry(s, t));
                }
            }
        }
    }

    /// Adds c times the volume of an element, where a matrix of nodes asks for it, and what its pressure is off in the blocks.
    #[inline(always)]
    pub(super) fn volume(&self, c: f64, sample: &Sample<'_>, nodes: &mut NodeBlocks) {
        let Some(volume) = self.element.volume(sample) else {
            return;
        };
        let vectors = std::array::from_fn(|i| self.element.vector(i).vector);
        let weight = self.weight(0, 0);
        let change = nodes.add_volume(vectors, &volume, [c, weight]);
        if change == 0.0 {
            return;
        }
        let Some(curved) = self.element.curved_volume(sample) else {
            return;
        };
        for (row, a) in curved.iter().zip(vectors) {
            for (block, b) in row.iter().zip(vectors) {
                if let Some(pair) = nodes.pair(a, b) {
                    nodes.add_full(pair, &(block * (c * weight * change)));
                }
            }
        }
    }

    /// Sum of the products of weights of two arguments over the blocks that are asked for.
    #[inline(always)]
    fn weight(&self, i: usize, j: usize) -> f64 {
        let weights = |i: usize| self.element.vector(i).stencil.weights(self.h);
        let (wi, wj) = (weights(i), weights(j));
        let sides = (0..4).filter(|&side| self.mask.blocks[side]);
        sides.map(|side| wi[side / 2] * wj[side % 2]).sum()
    }
}

/// The slots of one element: pairs of vectors, then of vectors and scalars, then of scalars.
#[derive(Clone, Copy, Default)]
pub(super) struct Slots<'a> {
    list: &'a [u32],
    vectors: usize,
    scalars: usize,
}

impl<'a> Slots<'a> {
    /// The first slots of a list are those of the element; they are taken off it. A list without slots serves where no blocks are asked for.
    #[inline(always)]
    pub(super) fn take<K: Kernel>(element: &K, list: &mut &'a [u32]) -> Self {
        let (vectors, scalars) = (element.vectors(), element.scalars());
        let count = match K::DEGREE >= 2 {
            true => vectors * (vectors + scalars) + scalars * scalars,
            false => 0,
        };
        let (own, rest) = list.split_at(count.min(list.len()));
        *list = rest;
        Self {
            list: own,
            vectors,
            scalars,
        }
    }

    /// Slot of two vectors, should they couple.
    #[inline(always)]
    pub(super) fn vectors(self, a: usize, b: usize) -> Option<usize> {
        self.slot(self.vectors * a + b)
    }

    /// Slot of a vector and a scalar that is none of the constants.
    #[inline(always)]
    pub(super) fn mixed(self, a: usize, s: usize) -> Option<usize> {
        self.slot(self.vectors * (self.vectors + s) + a)
    }

    /// Slot of two scalars; `None` where they do not couple, and for one order of two different ones.
    #[inline(always)]
    pub(super) fn scalars(self, s: usize, t: usize) -> Option<usize> {
        let before = self.vectors * (self.vectors + self.scalars);
        self.slot(before + self.scalars * s + t)
    }

    #[inline(always)]
    fn slot(self, at: usize) -> Option<usize> {
        let slot = self.list[at];
        (slot != NONE).then_some(slot as usize)
    }
}

/// Hands over the couplings of an element in the order of its slots; `has_scalars` is true if its scalars couple with each other.
pub(super) fn couple<K: Kernel>(
    element: &K,
    has_scalars: bool,
    to: &mut dyn FnMut(Option<Coupling>),
) {
    if K::DEGREE < 2 {
        return;
    }
    Arguments {
        vectors: element.vectors(),
        scalars: element.scalars(),
        readings: K::READINGS,
        is_isotropic: K::ISOTROPIC,
        has_scalars,
        vector: &|i| element.vector(i).vector,
        scalar: &|s| element.scalar(s).map(|(at, _)| at),
        couples: K::couples,
    }
    .couple(to);
}

/// The arguments of an element of any kernel.
struct Arguments<'a> {
    vectors: usize,
    scalars: usize,
    /// Arguments for each vector.
    readings: usize,
    is_isotropic: bool,
    has_scalars: bool,
    vector: &'a dyn Fn(usize) -> usize,
    scalar: &'a dyn Fn(usize) -> Option<usize>,
    couples: fn(usize, usize) -> bool,
}

impl Arguments<'_> {
    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        for a in 0..self.vectors {
            for b in 0..self.vectors {
                let (row, column) = ((self.vector)(a), (self.vector)(b));
                to(match (self.are_coupled(a, b), self.is_isotropic) {
                    (false, _) => None,
                    (true, true) => Some(Coupling::Isotropic(row, column)),
                    (true, false) => Some(Coupling::Full(row, column)),
                });
            }
        }
        for s in 0..self.scalars {
            for a in 0..self.vectors {
                to((self.scalar)(s).map(|at| Coupling::Mixed((self.vector)(a), at)));
            }
        }
        for s in 0..self.scalars {
            for t in 0..self.scalars {
                // Pairs of different scalars are met twice, once in each order, and kept once.
                let pair = (self.scalar)(s).zip((self.scalar)(t));
                let pair = pair.filter(|(at, other)| self.has_scalars && other <= at);
                to(pair.map(|(at, other)| Coupling::Scalars(at, other)));
            }
        }
    }

    fn are_coupled(&self, a: usize, b: usize) -> bool {
        let readings = |a: usize| (0..self.readings).map(move |k| k * self.vectors + a);
        readings(a).any(|i| readings(b).any(|j| (self.couples)(i, j)))
    }
}
