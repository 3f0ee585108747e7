//! Sections and figures of `results/hard_cases.md`.
//!
//! The page is its own store: a case replaces its section, the list at the top is made anew from all sections that stand.

use proboscis::report::atomic;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{LinePlot, Series};
use proboscis::report::origin::Origin;
use proboscis::report::style::hue;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

/// Every case, in the order of the page.
pub const CASES: [&str; 0] = [];

/// Tests of one process write one after the other.
static PAGE: Mutex<()> = Mutex::new(());
