//! Structure: what a scene does not call for leaves no trace, and imports go downwards.

#[path = "../common/mod.rs"]
mod common;

mod circles;
mod condensed;
mod floors;
mod sources;
mod trace;
