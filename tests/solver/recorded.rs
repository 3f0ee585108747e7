//! Systems that Ipopt met on the way, recorded by `recorder.rs`: factors against dense eigenvalues, residuals and MUMPS.

use crate::horizon::System;
use nalgebra::{DMatrix, DVector};
use proboscis::kkt::{Inertia, Plan, Solver, Unknown};
use proboscis::sparse::{Backend, Direct, Symmetry};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// Matrices of one pattern.
pub(crate) struct Recording {
    pub(crate) unknowns: Vec<Unknown>,
    pub(crate) rows: Vec<u32>,
    pub(crate) cols: Vec<u32>,
    pub(crate) matrices: Vec<Vec<f64>>,
}

/// Folder of the recordings.
pub(crate) fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/solver/systems")
}

/// An unknown in 32 bits: its kind in the first four, its stage in the others.
const KINDS: u32 = 28;

fn code(unknown: Unknown) -> u32 {
    match unknown {
        Unknown::Variable(stage) => stage,
        Unknown::Multiplier(stage) => 1 << KINDS | stage,
        Unknown::Border => 2 << KINDS,
        Unknown::Slack => 3 << KINDS,
        Unknown::Equality => 4 << KINDS,
        Unknown::Inequality => 5 << KINDS,
    }
}

fn unknown(code: u32) -> Unknown {
    let stage = code & ((1 << KINDS) - 1);
    match code >> KINDS {
        0 => Unknown::Variable(stage),
        1 => Unknown::Multiplier(stage),
        2 => Unknown::Border,
        3 => Unknown::Slack,
        4 => Unknown::Equality,
        5 => Unknown::Inequality,
        kind => panic!("no kind {kind}"),
    }
}

impl Recording {
    /// Numbers of unknowns, entries and matrices; unknowns, rows and columns in 32 bits each; entries in 64 bits, matrix by matrix. All of
    /// them little-endian.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let lengths = [self.unknowns.len(), self.rows.len(), self.matrices.len()];
        let numbers = lengths.into_iter().map(|length| length as u32);
        let codes = self.unknowns.iter().map(|&unknown| code(unknown));
        let places = self.rows.iter().chain(&self.cols).copied();
        let mut bytes: Vec<u8> = numbers
            .chain(codes)
            .chain(places)
            .flat_map(u32::to_le_bytes)
            .collect();
        let entries = self.matrices.iter().flatten();
        bytes.extend(entries.flat_map(|entry| entry.to_le_bytes()));
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Self {
        let mut rest = bytes;
        let mut numbers = |count: usize| -> Vec<u32> {
            let (part, behind) = rest.split_at(4 * count);
            rest = behind;
            let (words, _) = part.as_chunks::<4>();
            words.iter().map(|word| u32::from_le_bytes(*word)).collect()
        };
        let lengths = numbers(3);
        let [order, entries, matrices] = [0, 1, 2].map(|i| lengths[i] as usize);
        let unknowns = numbers(order).into_iter().map(unknown).collect();
        let (rows, cols) = (numbers(entries), numbers(entries));
        assert_eq!(rest.len(), 8 * entries * matrices, "nothing behind");
        let (words, _) = rest.as_chunks::<8>();
        let values: Vec<f64> = words.iter().map(|word| f64::from_le_bytes(*word)).collect();
        Self {
            unknowns,
            rows,
            cols,
            matrices: values.chunks(entries).map(<[f64]>::to_vec).collect(),
        }
    }
}

/// All recordings by name.
fn recordings() -> BTreeMap<String, Recording> {
    let files = fs::read_dir(folder()).expect("the folder of recordings");
    let recording = |file: fs::DirEntry| {
        let name = file.file_name().into_string().unwrap();
        let bytes = fs::read(file.path()).unwrap();
        (name, Recording::from_bytes(&bytes))
    };
    let files = files.map(Result::unwrap);
    let is_recording = |file: &fs::DirEntry| file.path().extension().is_some_and(|e| e == "bin");
    files.filter(is_recording).map(recording).collect()
}

/// The matrix with its rows and columns multiplied until the largest entry of each is one: no sign of an eigenvalue changes.
fn equilibrated(mut a: DMatrix<f64>) -> DMatrix<f64> {
    for _ in 0..20 {
        let factors = DVector::from_fn(a.nrows(), |i, _| match a.row(i).amax() {
            0.0 => 1.0,
            largest => largest.sqrt().recip(),
        });
        a = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| {
            factors[i] * a[(i, j)] * factors[j]
        });
    }
    a
}

/// Parts of the largest eigenvalue below which one is zero, and above which its sign is certain.
const ZERO: [f64; 2] = [1e-15, 1e-12];

/// Signs of the eigenvalues of an equilibrated matrix: those that are certainly negative, zeros, and those near zero.
#[derive(Debug)]
struct Signs {
    negative: usize,
    zero: usize,
    near: usize,
}

impl Signs {
    fn of(a: DMatrix<f64>) -> Self {
        let eigenvalues = equilibrated(a).symmetric_eigenvalues();
        let [zero, certain] = ZERO.map(|part| part * eigenvalues.amax());
        let count = |has: &dyn Fn(f64) -> bool| eigenvalues.iter().filter(|&&e| has(e)).count();
        Self {
            negative: count(&|e| e < -certain),
            zero: count(&|e| e.abs() <= zero),
            near: count(&|e| e.abs() > zero && e.abs() <= certain),
        }
    }

    const fn is_regular(&self) -> bool {
        self.zero + self.near == 0
    }

    /// Returns true if they are those of factors, where eigenvalues that are zero or near zero may have either sign.
    fn are(&self, found: Inertia) -> bool {
        let uncertain = self.zero + self.near;
        let most = self.negative + uncertain - found.zero.min(uncertain);
        found.zero <= uncertain && (self.negative..=most).contains(&found.negative)
    }
}

/// Greatest backward errors of the rows after one refinement and after two: `|b − A x| / (|A| |x| + |b|)`.
fn refined_errors(a: &DMatrix<f64>, solver: &mut Solver) -> [f64; 2] {
    let right = DVector::from_fn(a.nrows(), |i, _| (1.0 + i as f64).sin());
    let mut x = right.clone();
    solver.solve(x.as_mut_slice());
    assert!(x.amax() > 0.0);
    [(); 2].map(|()| {
        let mut correction = &right - a * &x;
        solver.solve(correction.as_mut_slice());
        x += correction;
        let residual = (&right - a * &x).abs();
        let terms = a.abs() * x.abs() + right.abs();
        residual.component_div(&terms).max()
    })
}

#[test]
fn recorded_systems_have_the_inertia_of_dense_eigenvalues_and_small_errors() {
    let (mut regular, mut told, mut compared) = (0, 0, 0);
    for (name, recording) in recordings() {
        for (k, entries) in recording.matrices.iter().enumerate() {
            let system = System {
                rows: recording.rows.clone(),
                cols: recording.cols.clone(),
                entries: entries.clone(),
                unknowns: recording.unknowns.clone(),
            };
            let a = system.dense();
            let expected = Signs::of(a.clone());
            assert!(expected.negative > 0 && expected.negative < system.order());
            for unknowns in [Some(system.unknowns.as_slice()), None] {
                let plan = Plan::new(system.order(), &system.rows, &system.cols, unknowns);
                let mut solver = Solver::new(plan);
                let found = solver.factor(entries);
                told += usize::from(found.zero > 0);
                assert!(expected.are(found), "{name} {k}: {expected:?} {found:?}");
                if expected.is_regular() {
                    let errors = refined_errors(&a, &mut solver);
                    // Problems without a solution are worse conditioned at their ends than all others.
                    let is_hard = ["loop.bin", "out_of_reach.bin"].contains(&name.as_str());
                    let most = if is_hard { 1e-7 } else { 1e-12 };
                    let are_small = errors[0] < most && errors[1] < 1e-12;
                    assert!(are_small, "{name} {k}: {errors:?}");
                }
            }
            if !expected.is_regular() {
                continue;
            }
            regular += 1;
            let places = recording.rows.iter().zip(&recording.cols);
            let places: Vec<(usize, usize)> =
                places.map(|(&i, &j)| (i as usize, j as usize)).collect();
            let mumps = Some(Backend::Mumps);
            let mut mumps = Direct::with(system.order(), &places, Symmetry::Symmetric, mumps);
            // It refuses what it cannot solve well.
            if mumps.factor(entries).is_ok() {
                compared += 1;
                assert_eq!(
                    mumps.negative_pivots(),
                    Some(expected.negative),
                    "{name} {k}"
                );
            }
        }
    }
    let counts = [regular, told, compared];
    println!("{counts:?}");
    assert!(regular >= 18 && told >= 4 && compared >= 15, "{counts:?}");
}
