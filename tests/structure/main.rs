//! Structure: what a scene does not call for leaves no trace, imports go downwards, documents name what exists.

#[path = "../common/mod.rs"]
mod common;

mod absent;
mod circles;
mod constants;
mod coupled;
mod documents;
mod floors;
mod functions;
mod heads;
mod lengths;
mod numbering;
mod presolved;
mod ratchet;
mod roles;
mod sources;
mod trace;
mod unit_tests;
mod welded;
mod words;
