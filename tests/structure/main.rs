//! Structure: what a scene does not call for leaves no trace, and imports go downwards.

#[path = "../common/mod.rs"]
mod common;

mod absent;
mod circles;
mod condensed;
mod floors;
mod lengths;
mod sources;
mod trace;
mod welded;
