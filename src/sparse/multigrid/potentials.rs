//! Potentials at given displacements: conjugate gradients with multigrid, for four right-hand sides at once as the components of a node.

use crate::math::{IsOver, Stopped};
use crate::sparse::Singular;
use crate::sparse::multigrid::node_grid::{Block, COMPONENTS, ENTRIES};
use crate::sparse::multigrid::parts::{Part, Parts};

/// Component of the potential.
pub(super) const POTENTIAL: usize = COMPONENTS - 1;
/// Residual relative to that of zero, both measured by the preconditioner.
const RESIDUAL: f64 = 1e-11;
/// Iterations after which it is given up.
const LIMIT: usize = 60;

/// A value for each right-hand side.
type Values = [f64; COMPONENTS];

/// The part of a matrix between potentials, made positive by a sign.
#[derive(Debug)]
pub(super) struct Potentials {
    list: Vec<Part>,
    /// First node of each part, and the number of all.
    starts: Vec<usize>,
    /// First entry of each part, and the number of all.
    first_entries: Vec<usize>,
    matrix: Vec<f64>,
    direction: Vec<Values>,
    residual: Vec<Values>,
    corrections: Vec<Values>,
    products: Vec<Values>,
    pub(super) solution: Vec<Values>,
}

impl Potentials {
    /// The potentials of a matrix times a sign; `None` where there are none.
    pub(super) fn new(parts: &Parts, sign: f64) -> Result<Option<Self>, Singular> {
        let is_free = |free: u8| free & 1 << POTENTIAL != 0;
        if !parts.free().any(is_free) {
            return Ok(None);
        }
        let free_of = |free: &[u8]| {
            let all = u8::MAX >> (u8::BITS as usize - COMPONENTS);
            let free = free.iter();
            let free = free.map(|free| if is_free(*free) { all } else { 0 });
            free.collect::<Vec<u8>>()
        };
        let of_potentials = parts.matrix.iter();
        let of_potentials = of_potentials.map(|block| sign * block[ENTRIES - 1]);
        let matrix: Vec<f64> = of_potentials.collect();
        let mut list = Vec::new();
        for (part, one) in parts.list.iter().enumerate() {
            let mut one = one.of_scalars(free_of(one.free()));
            let entries = &matrix[parts.blocks(part)];
            one.write(|block| of_scalar(entries[block]));
            one.prepare()?;
            list.push(one);
        }
        let zero = || vec![Values::default(); parts.node_count()];
        Ok(Some(Self {
            direction: zero(),
            starts: parts.starts.clone(),
            first_entries: parts.first_blocks.clone(),
            residual: zero(),
            corrections: zero(),
            products: zero(),
            solution: zero(),
            matrix,
            list,
        }))
    }

    /// Solves for the right-hand sides; returns their residuals relative to those of zero, or `None` where the matrix is not positive or the
    /// iteration does not converge.
    pub(super) fn solve(
        &mut self,
        rhs: impl Iterator<Item = Values>,
        is_over: IsOver<'_>,
    ) -> Result<Option<Values>, Stopped> {
        for (residual, rhs) in self.residual.iter_mut().zip(rhs) {
            *residual = rhs;
        }
        self.solution.fill(Values::default());
        self.precondition();
        let first = dot(&self.residual, &self.corrections);
        let (mut square, mut factor) = (first, Values::default());
        for _ in 0..LIMIT {
            if is_over() {
                return Err(Stopped);
            }
            if square.iter().any(|square| square.is_nan() || *square < 0.0) {
                return Ok(None);
            }
            let relative: Values = std::array::from_fn(|v| match first[v] > 0.0 {
                true => (square[v] / first[v]).sqrt(),
                false => 0.0,
            });
            if relative.iter().all(|relative| *relative <= RESIDUAL) {
                return Ok(Some(relative));
            }
            self.turn(&factor);
            let along = self.multiply();
            let is_active = |v: usize| relative[v] > RESIDUAL;
            if (0..COMPONENTS).any(|v| is_active(v) && along[v] <= 0.0) {
                return Ok(None);
            }
            let step = std::array::from_fn(|v| match is_active(v) {
                true => square[v] / along[v],
                false => 0.0,
            });
            self.step(&step);
            self.precondition();
            let next = dot(&self.residual, &self.corrections);
            factor = std::array::from_fn(|v| match square[v] > 0.0 {
                true => next[v] / square[v],
                false => 0.0,
            });
            square = next;
        }
        Ok(None)
    }

    /// Directions of the next step: corrections and a part of the last directions.
    fn turn(&mut self, factor: &Values) {
        for (direction, correction) in self.direction.iter_mut().zip(&self.corrections) {
            *direction = std::array::from_fn(|v| correction[v] + factor[v] * direction[v]);
        }
    }

    /// Multiplies the directions; returns their products with the results.
    fn multiply(&mut self) -> Values {
        let mut along = Values::default();
        for (part, one) in self.list.iter().enumerate() {
            let nodes = self.starts[part]..self.starts[part + 1];
            let entries = &self.matrix[self.first_entries[part]..];
            let direction = &self.direction[nodes.clone()];
            let products = &mut self.products[nodes];
            one.rows().multiply(entries, direction, products, add);
            let of_part = dot(direction, products);
            along = std::array::from_fn(|v| along[v] + of_part[v]);
        }
        along
    }

    fn step(&mut self, step: &Values) {
        let lists = self.solution.iter_mut().zip(&mut self.residual);
        let lists = lists.zip(&self.products).zip(&self.direction);
        for (((solution, residual), product), direction) in lists {
            for v in 0..COMPONENTS {
                solution[v] += step[v] * direction[v];
                residual[v] -= step[v] * product[v];
            }
        }
    }

    fn precondition(&mut self) {
        for (part, one) in self.list.iter_mut().enumerate() {
            let nodes = self.starts[part]..self.starts[part + 1];
            for (to, from) in one.rhs_mut().iter_mut().zip(&self.residual[nodes.clone()]) {
                *to = from.map(|value| value as f32);
            }
            one.cycle();
            let corrections = self.corrections[nodes].iter_mut();
            for (to, from) in corrections.zip(one.x()) {
                *to = from.map(f64::from);
            }
        }
    }
}

/// A block of a matrix of potentials, with its entry for each component.
fn of_scalar(entry: f64) -> Block {
    let mut block = Block::default();
    for component in 0..COMPONENTS {
        block[(COMPONENTS + 1) * component] = entry as f32;
    }
    block
}

/// Adds an entry times the values at a node.
#[inline(always)]
fn add(sum: &mut Values, entry: &f64, there: &Values) {
    for (sum, value) in sum.iter_mut().zip(there) {
        *sum += entry * value;
    }
}

fn dot(a: &[Values], b: &[Values]) -> Values {
    let mut sums = Values::default();
    for (a, b) in a.iter().zip(b) {
        for v in 0..COMPONENTS {
            sums[v] += a[v] * b[v];
        }
    }
    sums
}
