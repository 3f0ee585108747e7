//! Transfer by smoothed aggregation: P = (1 − ω D⁻¹ A) R, with the rigid motions R of aggregates, and the coarse matrix Pᵀ A P.
//!
//! In the factor of R weakly coupled neighbours move as the node itself does, so that P reaches no farther across thin layers.
//!
//! Aggregates of neighbouring points (P. Vaněk, J. Mandel, M. Brezina, Computing 56, 1996), and their rigid motions.
//!
//! A point of a coarse level has two nodes: the translation with the potential, and the rotation times a length, so that all numbers are of one
//! size.

use crate::sparse::multigrid::node_grid::{Block, COMPONENTS, add_product, add_transposed_product};
use crate::sparse::multigrid::triangles::{
    BlockMatrix, BlockRows, Marks, distance, each_row, in_two,
};

/// Transfer to a coarser level.
#[derive(Debug)]
pub(super) struct Aggregation {
    is_strong: Vec<bool>,
    pub(super) rigid: Vec<[Rigid; 2]>,
    /// P.
    pub(super) pattern: BlockRows,
    pub(super) values: Vec<Block>,
    /// A P.
    products: BlockRows,
    pub(super) of_products: Vec<Block>,
    /// Rows and blocks of P by column.
    pub(super) children: Vec<Vec<[u32; 2]>>,
    /// Work space of either half of the rows.
    marks: [Marks; 2],
}

impl Aggregation {
    /// Of a level with this pattern; returns the pattern of the coarse matrix too.
    pub(super) fn new(rows: &BlockRows, aggregates: Aggregates) -> (Self, BlockRows) {
        let Aggregates {
            is_strong,
            rigid,
            free,
            ..
        } = aggregates;
        let pattern = BlockRows::new((0..rows.count()).map(|row| {
            let strong = rows.range(row).filter(|&block| is_strong[block]);
            strong
                .flat_map(|block| rigid[rows.column(block)].map(|(node, _)| node))
                .collect()
        }));
        let products = rows.times(&pattern);
        let children = pattern.by_column(free.len());
        let coarse = BlockRows::new(children.iter().map(|children| {
            let mut columns = Vec::new();
            for [row, _] in children {
                columns.extend_from_slice(products.columns(*row as usize));
            }
            columns
        }));
        let found = Self {
            values: vec![Block::default(); pattern.blocks()],
            of_products: vec![Block::default(); products.blocks()],
            marks: Marks::of_halves(free.len()),
            is_strong,
            rigid,
            pattern,
            products,
            children,
        };
        (found, coarse)
    }

    /// Makes P, and the coarse matrix, of a matrix with the inverse of its diagonal blocks and a factor ω.
    pub(super) fn prepare(
        &mut self,
        fine: &BlockMatrix,
        inverse: &[Block],
        damping: f32,
        coarse: &mut BlockMatrix,
    ) {
        let rows = &fine.rows;
        let Self {
            is_strong,
            rigid,
            pattern,
            values,
            products,
            of_products,
            children,
            marks,
        } = self;
        let halves = in_two(values, pattern);
        each_row(pattern, halves, marks, |row, own, marks| {
            for (block, entries) in rows.range(row).zip(fine.row(row)) {
                let from = if is_strong[block] {
                    rows.column(block)
                } else {
                    row
                };
                for (node, motion) in &rigid[from] {
                    let place = marks[*node as usize] as usize;
                    add_product(&mut own[place], entries, motion);
                }
            }
            for block in own.iter_mut() {
                let mut turned = Block::default();
                add_product(&mut turned, &inverse[row], block);
                *block = turned.map(|entry| -damping * entry);
            }
            for (node, motion) in &rigid[row] {
                let place = marks[*node as usize] as usize;
                for (entry, value) in own[place].iter_mut().zip(motion) {
                    *entry += value;
                }
            }
        });
        let (pattern, values) = (&*pattern, &*values);
        let halves = in_two(of_products, products);
        each_row(products, halves, marks, |row, own, marks| {
            for (column, entries) in rows.columns(row).iter().zip(fine.row(row)) {
                for of_column in pattern.range(*column as usize) {
                    let place = marks[pattern.column(of_column)] as usize;
                    add_product(&mut own[place], entries, &values[of_column]);
                }
            }
        });
        let (products, of_products) = (&*products, &*of_products);
        coarse.write_rows(marks, |row, own, marks| {
            for &[child, block] in &children[row] {
                let weights = &values[block as usize];
                for product in products.range(child as usize) {
                    let place = marks[products.column(product)] as usize;
                    add_transposed_product(&mut own[place], weights, &of_products[product]);
                }
            }
        });
    }
}

/// Distance of neighbours, relative to that of the nearest one, up to which they are strongly coupled.
const NEAR: f64 = 2.2;
/// In place of an aggregate.
const NONE: u32 = u32::MAX;
/// Nodes of a point of a coarse level.
const OF_AGGREGATE: usize = 2;

/// Points that have one node each, or two.
#[derive(Clone, Debug)]
pub(super) struct Points {
    places: Vec<[f64; 3]>,
    /// Lengths by which rotations are multiplied; zero where points have none.
    lengths: Vec<f64>,
    nodes_of_each: usize,
    /// True if aggregates turn, as displacements do.
    have_rotations: bool,
}

/// A node of a coarse level that a node follows, and how.
pub(super) type Rigid = (u32, Block);

/// Aggregates of points.
#[derive(Debug)]
pub(super) struct Aggregates {
    /// True for each block of the matrix that couples strongly.
    pub(super) is_strong: Vec<bool>,
    /// Nodes that each node follows as a part of a rigid aggregate; blocks are zero where it does not.
    pub(super) rigid: Vec<[Rigid; OF_AGGREGATE]>,
    /// For each node of the coarse level, a bit for each component that moves something.
    pub(super) free: Vec<u8>,
    /// The points of the coarse level.
    pub(super) points: Points,
}

impl Points {
    /// Nodes at places.
    pub(super) fn at(places: &[[f64; 3]]) -> Self {
        Self {
            places: places.to_vec(),
            lengths: vec![0.0; places.len()],
            nodes_of_each: 1,
            have_rotations: true,
        }
    }

    /// The same nodes with a scalar as each component.
    pub(super) fn of_scalars(&self) -> Self {
        Self {
            have_rotations: false,
            ..self.clone()
        }
    }

    /// Number of points.
    pub(super) fn count(&self) -> usize {
        self.places.len()
    }

    /// Aggregate of each point, and the aggregates as points of one node each.
    pub(super) fn alone(&self, rows: &BlockRows) -> (Vec<u32>, Self) {
        let (of, count) = self.aggregates(rows);
        let points = Self {
            nodes_of_each: 1,
            ..self.coarse(&of, count)
        };
        (of, points)
    }

    /// Strongly coupled neighbours of a point.
    fn neighbours(&self, rows: &BlockRows, point: usize) -> Vec<u32> {
        let columns = rows.columns(self.nodes_of_each * point).iter();
        let mut found: Vec<u32> = columns.map(|c| c / self.nodes_of_each as u32).collect();
        found.dedup();
        found.retain(|&other| other as usize != point);
        let away = |other: u32| distance(self.places[point], self.places[other as usize]);
        let nearest = found.iter().map(|&other| away(other));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        found.retain(|&other| away(other) <= NEAR * nearest);
        found
    }

    /// Aggregate of each point: those around points whose neighbours belong to none, then the rest to that of most of their neighbours.
    fn aggregates(&self, rows: &BlockRows) -> (Vec<u32>, usize) {
        let mut of = vec![NONE; self.places.len()];
        let mut count = 0;
        let mut begin = |of: &mut [u32], point: usize, members: &[u32]| {
            of[point] = count;
            for &member in members {
                of[member as usize] = count;
            }
            count += 1;
        };
        for point in 0..of.len() {
            let around = self.neighbours(rows, point);
            let is_free = |&other: &u32| of[other as usize] == NONE;
            if is_free(&(point as u32)) && around.iter().all(is_free) {
                begin(&mut of, point, &around);
            }
        }
        let first = of.clone();
        for point in (0..first.len()).filter(|&point| first[point] == NONE) {
            let around = self.neighbours(rows, point).into_iter();
            let mut there: Vec<u32> = around.map(|other| first[other as usize]).collect();
            there.retain(|&aggregate| aggregate != NONE);
            there.sort_unstable();
            let groups = there.chunk_by(|a, b| a == b);
            let most = groups.max_by_key(|group| (group.len(), NONE - group[0]));
            of[point] = most.map_or(NONE, |group| group[0]);
        }
        for point in 0..of.len() {
            if of[point] == NONE {
                let mut around = self.neighbours(rows, point);
                around.retain(|&other| of[other as usize] == NONE);
                begin(&mut of, point, &around);
            }
        }
        (of, count as usize)
    }

    /// Centres of aggregates, and their mean radii.
    fn coarse(&self, of: &[u32], count: usize) -> Self {
        let (mut places, mut members) = (vec![[0.0; 3]; count], vec![0.0; count]);
        for (place, &aggregate) in self.places.iter().zip(of) {
            let sums = places[aggregate as usize].iter_mut();
            sums.zip(place).for_each(|(sum, x)| *sum += x);
            members[aggregate as usize] += 1.0;
        }
        for (place, members) in places.iter_mut().zip(&members) {
            place.iter_mut().for_each(|sum| *sum /= members);
        }
        let mut lengths = vec![0.0; count];
        for (point, &aggregate) in of.iter().enumerate() {
            let radius = distance(self.places[point], places[aggregate as usize]);
            lengths[aggregate as usize] += radius * radius + self.lengths[point].powi(2);
        }
        for (length, members) in lengths.iter_mut().zip(&members) {
            let mean = (*length / members).sqrt();
            *length = if mean > 0.0 { mean } else { 1.0 };
        }
        Self {
            places,
            lengths,
            nodes_of_each: OF_AGGREGATE,
            have_rotations: self.have_rotations,
        }
    }

    /// Aggregates of the points of a matrix with this pattern, some components of whose nodes are free.
    pub(super) fn aggregate(&self, rows: &BlockRows, free: &[u8]) -> Aggregates {
        let (of, count) = self.aggregates(rows);
        let points = self.coarse(&of, count);
        let each = self.nodes_of_each;
        let mut is_strong = Vec::with_capacity(rows.blocks());
        for node in 0..rows.count() {
            let near = self.neighbours(rows, node / each);
            is_strong.extend(rows.columns(node).iter().map(|&column| {
                let other = column as usize / each;
                other == node / each || near.contains(&(other as u32))
            }));
        }
        let rigid = free
            .iter()
            .enumerate()
            .map(|(node, free)| self.rigid(node, *free, &points, of[node / each] as usize));
        let rigid: Vec<_> = rigid.collect();
        let mut moving = vec![0; OF_AGGREGATE * count];
        for (node, block) in rigid.iter().flatten() {
            for (component, column) in block.chunks_exact(COMPONENTS).enumerate() {
                let moves = column.iter().any(|entry| entry.abs() > f32::EPSILON);
                moving[*node as usize] |= u8::from(moves) << component;
            }
        }
        Aggregates {
            is_strong,
            rigid,
            free: moving,
            points,
        }
    }

    /// Rigid motion of a node of a point with an aggregate: of its place, or of its rotation.
    fn rigid(
        &self,
        node: usize,
        free: u8,
        coarse: &Self,
        aggregate: usize,
    ) -> [Rigid; OF_AGGREGATE] {
        let point = node / self.nodes_of_each;
        let (mut moved, mut turned) = (Block::default(), Block::default());
        let length = coarse.lengths[aggregate];
        let is_free = |component: usize| free & 1 << component != 0;
        let turns = |axis: &usize| self.have_rotations && is_free(*axis);
        if node.is_multiple_of(self.nodes_of_each) {
            for component in (0..COMPONENTS).filter(|&c| is_free(c)) {
                moved[(COMPONENTS + 1) * component] = 1.0;
            }
            let (from, to) = (coarse.places[aggregate], self.places[point]);
            let arm = [0, 1, 2].map(|axis| ((to[axis] - from[axis]) / length) as f32);
            // The displacement ω × r of a rotation ω.
            for axis in (0..3).filter(turns) {
                let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
                turned[COMPONENTS * next + axis] = arm[last];
                turned[COMPONENTS * last + axis] = -arm[next];
            }
        } else {
            for axis in (0..3).filter(turns) {
                turned[(COMPONENTS + 1) * axis] = (self.lengths[point] / length) as f32;
            }
        }
        let first = (OF_AGGREGATE * aggregate) as u32;
        [(first, moved), (first + 1, turned)]
    }
}
