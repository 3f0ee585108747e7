//! Hard cases: each ends in a right answer or in a refusal that says why; never in a panic, a hang, a number that is not
//! finite in a file, or a wrong "solved".
//!
//! With `PROBOSCIS_WRITE_PAGES=1` each case writes its figure and its section of `results/gallery/hard_cases.md`.

#[path = "../common/mod.rs"]
mod common;

mod arms;
mod blocks;
mod goals;
mod horizons;
mod joints;
mod loops;
mod muscle_ends;
mod muscles;
mod page;
mod program;
mod ratios;
mod repeat;
mod rest;
mod scenes;
mod steps;
mod units;
mod warm;
