//! The ordering of the linear systems that suits a program.

use std::collections::BTreeMap;

use crate::control::problem::{Control, Duration};
use crate::ipopt::OptionValue;
use crate::model::{Coordinates, Model};

/// Options of Ipopt, with the ordering of MUMPS that was fastest for the kind of program, unless the problem names one.
///
/// Approximate minimum degree (0) where each instant is a small dense block or the duration is given; minimum fill (2)
/// where a free duration couples all instants of a redundant program; nested dissection of SCOTCH (3) for the meshes of elastic
/// blocks. Measurements: `benches/README.md`.
pub(super) fn ordering(model: &Model, control: &Control) -> BTreeMap<String, OptionValue> {
    let free = matches!(control.duration, Duration::Free { .. });
    let ordering = if !model.action.map.of_nodes.is_empty() {
        3
    } else if free && model.coordinates == Coordinates::Redundant {
        2
    } else {
        0
    };
    let mut options = control.solver.ipopt.clone();
    options
        .entry("mumps_pivot_order".to_owned())
        .or_insert(OptionValue::Integer(ordering));
    options
}
