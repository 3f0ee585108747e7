//! MUMPS: LDLᵀ of symmetric and LU of unsymmetric matrices, by fronts, with pivots.
//!
//! MUMPS keeps state for the whole process, and Ipopt calls it too: two threads in it at once end in a segmentation fault.
//! So [`exclusive()`] is held during each call here and during a whole solve of Ipopt.

mod ffi;
mod libraries;
#[cfg(mpi)]
mod mpi;

use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Singular, Symmetry};

pub(crate) use ffi::{Exclusive, exclusive};
use ffi::{Instance, Job};
pub(crate) use libraries::has_room;
#[cfg(mpi)]
pub(crate) use mpi::has_threads;

/// Error message where [`has_room`] returns false.
pub(crate) const NO_ROOM: &str =
    "MUMPS needs more address space than this process may have: OpenBLAS takes 128 MB at once";

/// Error message where [`has_threads`] returns false.
pub(crate) const NO_THREADS: &str =
    "this MUMPS needs MPI, which starts threads, and this process can create none";

/// Returns true: this MUMPS needs no threads.
#[cfg(not(mpi))]
pub(crate) fn has_threads() -> bool {
    true
}

/// Ordering of the elimination, ICNTL(7), as measured by `benches/factorisation.rs`: SCOTCH.
const ORDERING: i32 = 3;
/// A pivot below this in a matrix whose largest entries are near 1 is a null pivot.
const TINY: f64 = 1e-14;
/// Space beyond the estimate in per cent, at first and at most.
const SPACE: [i32; 2] = [30, 4000];
/// Answers that ask for more space.
const TOO_LITTLE_SPACE: [i32; 6] = [-8, -9, -14, -15, -17, -20];
/// The answer to a singular matrix.
const SINGULAR: i32 = -10;

/// A factorisation by MUMPS.
#[derive(Debug)]
pub(crate) struct Mumps {
    instance: Instance,
    symmetry: Symmetry,
    values: Vec<f64>,
    space: i32,
}

impl Mumps {
    /// Analyses a pattern that is not empty.
    pub(crate) fn new(pattern: &Pattern) -> Self {
        assert!(has_threads(), "{NO_THREADS}");
        let index = |i: usize| i32::try_from(i + 1).expect("a size that MUMPS can count");
        let rows = pattern.rows.iter().map(|&row| index(row)).collect();
        let cols = (0..pattern.size)
            .flat_map(|col| pattern.slots(col).map(move |_| index(col)))
            .collect();
        let mut instance = Instance::new(pattern.size, pattern.symmetry, rows, cols);
        // Silence.
        for stream in 1..=4 {
            instance.control(stream, if stream == 4 { 0 } else { -1 });
        }
        // The pattern alone decides on the order, and the matrix is scaled before it comes here.
        instance.control(6, 0);
        instance.control(7, ORDERING);
        instance.control(8, 0);
        instance.control(14, SPACE[0]);
        // A null pivot is left out, and the check of a known solution names it.
        instance.control(24, 1);
        instance.threshold(3, -TINY);
        let code = {
            let _lock = exclusive();
            libraries::restart_random_numbers();
            instance.run(Job::Analyse, &mut [])
        };
        assert!(code >= 0, "{}", failure(&instance, "analysis"));
        Self {
            instance,
            symmetry: pattern.symmetry,
            values: vec![0.0; pattern.rows.len()],
            space: SPACE[0],
        }
    }
}

/// Rows in an order of elimination with little fill, if MUMPS can be called; the pattern is not empty.
pub(crate) fn order(pattern: &Pattern) -> Option<Vec<usize>> {
    if !has_threads() {
        return None;
    }
    let analysed = Mumps::new(pattern);
    let mut rows: Vec<usize> = (0..pattern.size).collect();
    let places = analysed.instance.places();
    rows.sort_unstable_by_key(|&row| places[row]);
    Some(rows)
}

impl Factorisation for Mumps {
    fn name(&self) -> &'static str {
        match self.symmetry {
            Symmetry::Symmetric => "MUMPS LDLᵀ",
            Symmetry::Unsymmetric => "MUMPS LU",
        }
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        assert!(has_room(), "{NO_ROOM}");
        self.values.copy_from_slice(values);
        loop {
            match self.instance.run(Job::Factor, &mut self.values) {
                0.. => return Ok(()),
                SINGULAR => return Err(Singular { column: 0 }),
                code if TOO_LITTLE_SPACE.contains(&code) && self.space < SPACE[1] => {
                    self.space *= 2;
                    self.instance.control(14, self.space);
                }
                _ => panic!("{}", failure(&self.instance, "factorisation")),
            }
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let code = self.instance.run(Job::Solve, rhs);
        assert!(code >= 0, "{}", failure(&self.instance, "solution"));
    }

    fn negative_pivots(&self) -> Option<usize> {
        match self.symmetry {
            Symmetry::Symmetric => usize::try_from(self.instance.information(12)).ok(),
            Symmetry::Unsymmetric => None,
        }
    }
}

fn failure(instance: &Instance, job: &str) -> String {
    let [code, detail] = [1, 2].map(|number| instance.information(number));
    format!("{job} by MUMPS ended with INFOG(1) = {code}, INFOG(2) = {detail}")
}
