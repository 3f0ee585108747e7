//! Solutions with the factors of a block against naive products.

use pulp::{Arch, Simd, WithSimd};

use super::super::bandwidth_order::Envelope;
use super::super::block_lu::{BlockLu, Room};
use crate::math::Random;

const EQUATIONS: usize = 150;
const UNKNOWNS: usize = 153;

/// One column, and the block.
struct One<'a>(&'a BlockLu, &'a mut [f64], bool);

impl WithSimd for One<'_> {
    type Output = ();

    fn with_simd<S: Simd>(self, unit: S) {
        match self.2 {
            true => self.0.solve_one_transposed(unit, self.1),
            false => self.0.solve_one(unit, self.1),
        }
    }
}

/// Equations that hold a few unknowns near them each, small ones where pivots would stand without exchanges.
fn entries() -> Vec<(usize, usize, f64)> {
    let of = |i: usize| i.saturating_sub(6)..UNKNOWNS.min(i + 9);
    let places = (0..EQUATIONS).flat_map(|i| of(i).map(move |j| (i, j)));
    let mut random = Random::new(7);
    let size = |i, j| if i == j { 1e-9 } else { 1.0 };
    places
        .map(|(i, j)| (i, j, size(i, j) * random.between(-1.0, 1.0)))
        .collect()
}

fn factored(entries: &[(usize, usize, f64)]) -> (BlockLu, bool) {
    let places = entries.iter().map(|&(i, j, _)| (i, j));
    let mut block = BlockLu::new(Envelope::new(EQUATIONS, UNKNOWNS, places));
    assert!(block.envelope.panels.len() > 3, "there is one panel alone");
    assert!(
        block.envelope.len() < EQUATIONS * UNKNOWNS / 2,
        "{} numbers",
        block.envelope.len()
    );
    for &(i, j, value) in entries {
        block.add(i, j, value);
    }
    let mut room = Room::for_blocks(std::slice::from_ref(&block));
    let is_regular = block.factor(&mut room);
    (block, is_regular)
}

fn times(entries: &[(usize, usize, f64)], unknowns: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; EQUATIONS];
    entries
        .iter()
        .for_each(|&(i, j, a)| out[i] += a * unknowns[j]);
    out
}

fn assert_near(found: &[f64], expected: &[f64], size: f64) {
    for (i, (x, y)) in found.iter().zip(expected).enumerate() {
        assert!((x - y).abs() <= 1e-11 * size, "{i}: {x}, not {y}");
    }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn unknowns_and_multipliers_fulfil_what_is_naively_multiplied() {
    let entries = entries();
    let (block, is_regular) = factored(&entries);
    assert!(is_regular);
    let exchanged = (0..EQUATIONS).filter(|&j| block.exchanges[j] as usize != j);
    assert!(exchanged.count() > EQUATIONS / 2, "hardly any exchange");

    let mut free = vec![0.0; 3 * UNKNOWNS];
    block.free(&mut free);
    for column in free.chunks_exact(UNKNOWNS) {
        assert!(largest(column) >= 1.0);
        assert_near(&times(&entries, column), &[0.0; EQUATIONS], largest(column));
    }

    let mut random = Random::new(11);
    let right: Vec<f64> = (0..3 * UNKNOWNS)
        .map(|_| random.between(-1.0, 1.0))
        .collect();
    let mut several = right.clone();
    block.solve(&mut several);
    let is_free = |i: usize| several[i] == 0.0;
    assert_eq!(
        (0..UNKNOWNS).filter(|&i| is_free(i)).count(),
        UNKNOWNS - EQUATIONS
    );
    for (k, column) in several.chunks_exact(UNKNOWNS).enumerate() {
        let right = &right[k * UNKNOWNS..][..UNKNOWNS];
        assert_near(&times(&entries, column), right, largest(column));
        let mut one = right.to_vec();
        Arch::new().dispatch(One(&block, &mut one, false));
        assert_near(&one, column, largest(column));
    }

    let mut multipliers = right.clone();
    block.solve_transposed(&mut multipliers);
    for (k, column) in multipliers.chunks_exact(UNKNOWNS).enumerate() {
        let right = &right[k * UNKNOWNS..][..UNKNOWNS];
        let mut balance = vec![0.0; UNKNOWNS];
        entries
            .iter()
            .for_each(|&(i, j, a)| balance[j] += a * column[i]);
        for i in (0..UNKNOWNS).filter(|&i| !is_free(i)) {
            assert_near(&balance[i..=i], &right[i..=i], largest(column));
        }
        let mut one = right.to_vec();
        Arch::new().dispatch(One(&block, &mut one, true));
        assert_near(&one[..EQUATIONS], &column[..EQUATIONS], largest(column));
    }
}

#[test]
fn equations_that_depend_on_each_other_are_told() {
    let mut entries = entries();
    // Equation 71 becomes twice equation 70.
    let row: Vec<_> = entries.iter().filter(|e| e.0 == 70).copied().collect();
    entries.retain(|e| e.0 != 71);
    entries.extend(row.iter().map(|&(_, j, value)| (71, j, 2.0 * value)));
    assert!(!factored(&entries).1);
}
