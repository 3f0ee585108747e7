//! The matrix of rest: factorised, with what gives its inertia and so proves stability, or on box grids, where an iteration does not. It leads to
//! the state of rest; then its matrix is factorised, as far as its size allows, and all that follows is done with factors.

use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::solving::{MultigridUse, Solving};
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::functional::TermKind;
use crate::model::Model;
use crate::sparse::Symmetry;

/// Factors beside those of the matrix.
#[derive(Debug, Default)]
pub(super) struct Inertia {
    /// The symmetric part of the tangent where it has no symmetry.
    pub(super) symmetric_part: Option<Tangent>,
    /// The own block of the scalars with an equation.
    pub(super) electric: Option<Tangent>,
}

/// Pairs of the turns behind a chart, with the third one.
pub(super) fn turned_pairs(&[a, b, c]: &[usize; 3]) -> [[usize; 3]; 3] {
    [[a, b, c], [a, c, b], [b, c, a]]
}

/// First places of the curvature of charts in the values, three a chart, and of the added stiffness.
pub(super) fn places(model: &Model) -> [usize; 2] {
    let curved = model.action.layout().values(1);
    [curved, curved + 3 * model.action.map.tree.charted().len()]
}

/// Entries of the tangent, and its symmetry.
fn entries(model: &Model) -> (EntryList, Symmetry) {
    let (map, layout) = (&model.action.map, model.action.layout());
    let (n, m) = (map.coordinates, map.unknowns());
    let mut entries = EntryList::default();
    for (slot, entry) in layout.same.entries().enumerate() {
        entries.add(layout.same_at(0) + slot, entry);
        entries.add_to(layout.same_at(1) + slot, slot);
    }
    for (slot, (row, col)) in layout.cross.entries().enumerate() {
        let same = layout.same.find(row, col);
        let same = same.expect("what couples neighbouring instants couples within one");
        entries.add_to(layout.lower_at(0) + slot, same);
        entries.add_to(layout.upper_at(0) + slot, same);
    }
    entries.add_scalars(model, &[[0, 0], [1, 1]]);
    let [curved, added] = places(model);
    for (place, [i, j, _]) in map.tree.charted().iter().flat_map(turned_pairs).enumerate() {
        for entry in [(i, j), (j, i)] {
            let same = layout.same.find(entry.0, entry.1);
            let same = same.expect("the turns of a joint are coupled");
            entries.add_to(curved + place, same);
        }
    }
    for (place, i) in (0..n).chain(m..model.variables.unknown_count()).enumerate() {
        entries.add(added + place, (i, i));
    }
    // The tangent is negative where a state is stable.
    entries.hold(&model.held_at_rest(), -1.0);
    let mut terms = model.action.intervals.terms.iter();
    let symmetry = match terms.any(|term| term.kind() == TermKind::AppliedWork) {
        true => Symmetry::Unsymmetric,
        false => Symmetry::Symmetric,
    };
    (entries, symmetry)
}

/// The tangent, factorised.
fn direct(model: &Model) -> Tangent {
    let (entries, symmetry) = entries(model);
    entries.tangent(model.variables.unknown_count(), symmetry, None)
}

impl Inertia {
    /// Of a model.
    pub(super) fn new(model: &Model) -> Self {
        let (entries, symmetry) = entries(model);
        let size = model.variables.unknown_count();
        let symmetric_part =
            (symmetry == Symmetry::Unsymmetric).then(|| entries.symmetric_part(size));
        let algebraic = model.variables.algebraic();
        let electric = (!algebraic.is_empty()).then(|| {
            let mut entries = EntryList::default();
            entries.add_scalars(model, &[]);
            let first = model.action.map.unknowns();
            entries.tangent_from(first, algebraic.len(), Symmetry::Symmetric, None)
        });
        Self {
            symmetric_part,
            electric,
        }
    }
}

/// The matrix of a model, by its nodes where an iteration is wanted and nodes have all unknowns; what gives the inertia, where it is factorised.
pub(super) fn matrix(model: &Model, multigrid: Option<MultigridUse>) -> (NewtonMatrix, Inertia) {
    let matrix = match multigrid {
        Some(multigrid) => {
            let solving = Solving {
                multigrid,
                ..Solving::default()
            };
            NewtonMatrix::new(model, solving, true, direct, || direct(model))
        }
        None => NewtonMatrix::Direct(Box::new(direct(model))),
    };
    let inertia = matrix.direct().map(|_| Inertia::new(model));
    (matrix, inertia.unwrap_or_default())
}
