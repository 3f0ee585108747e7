//! The matrix of a step of the midpoint rule.

use crate::dynamics::grid_tangent::GridTangent;
use crate::dynamics::solving::{MultigridUse, Newton, Solving};
use crate::dynamics::step_matrix::StepMatrix;
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::model::Model;
use crate::sparse::{Backend, DENSE};

/// The matrix of a step: by its nodes where an iteration is wanted and nodes have all unknowns, otherwise factorised.
pub(super) fn step_matrix(model: &Model, solving: Solving) -> StepMatrix {
    let direct = |model: &Model| direct_by(model, Newton::Modified, None);
    let is_wanted = solving.takes_grids(model);
    let direct = (solving.multigrid != MultigridUse::Alone).then_some(direct as fn(&_) -> _);
    let grids = is_wanted.then(|| GridTangent::new(model, direct, false));
    match grids.flatten() {
        Some(grids) => StepMatrix::Grids(Box::new(grids)),
        None => StepMatrix::Direct(Box::new(direct_by(model, solving.newton, solving.backend))),
    }
}

/// The matrix of a step, factorised.
fn direct_by(model: &Model, newton: Newton, backend: Option<Backend>) -> Tangent {
    let map = &model.action.map;
    let (n, layout) = (map.coordinates, model.action.layout());
    let mut entries = EntryList::default();
    for (slot, entry) in layout.cross.entries().enumerate() {
        entries.add(layout.upper_at(0) + slot, entry);
    }
    for (slot, (row, col)) in layout.same.entries().enumerate() {
        if row < n && col >= n {
            entries.add(layout.same_at(0) + slot, (row, col));
        }
        if row >= n && col < n {
            entries.add(layout.same_at(1) + slot, (row, col));
        }
    }
    entries.add_scalars(model, &[[0, 1]]);
    entries.hold(&model.prescribed_coordinates(), 1.0);
    let (size, symmetry) = (model.variables.unknown_count(), model.step_symmetry());
    let is_corrected = newton == Newton::Modified && backend.is_none();
    match is_corrected && map.multipliers == 0 && size > DENSE {
        true => entries.corrected_tangent(model, symmetry),
        false => entries.tangent(size, symmetry, backend),
    }
}
