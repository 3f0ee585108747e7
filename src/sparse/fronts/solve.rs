//! Solution with the panels of a tree: forward substitution upwards, back substitution downwards.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_unit_lower_triangular_in_place, solve_unit_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::traits::ext::ComplexFieldExt;
use faer::{Accum, MatRef, Par};

use crate::math::join_if;
use crate::sparse::faer::column;
use crate::sparse::fronts::factor::Number;
use crate::sparse::fronts::tree::{Front, Tree};

/// One right-hand side on its way through a subtree.
pub(super) struct Passage<'a, T> {
    /// Panels of the subtree.
    pub(super) panels: &'a [T],
    /// Unknowns of the subtree, in the order of elimination.
    pub(super) x: &'a mut [T],
    /// Later rows of each front of the subtree: upwards their updates, downwards their solution.
    pub(super) passed: &'a mut [T],
}

/// Vectors cut into the part of one front and those of the subtrees of its sides.
struct Cut<'a, T> {
    panel: MatRef<'a, T>,
    x: &'a mut [T],
    passed: &'a mut [T],
    sides: Option<[Passage<'a, T>; 2]>,
}

impl<'a, T: Number> Passage<'a, T> {
    fn cut(self, tree: &Tree, front: &Front) -> Cut<'a, T> {
        let Self { panels, x, passed } = self;
        let (panels, panel) = panels.split_at(panels.len() - front.panel());
        let (below, x) = x.split_at_mut(x.len() - front.own);
        let (passed_below, passed) = passed.split_at_mut(passed.len() - front.boundary.len());
        let sides = front.sides.map(|sides| {
            let [a, b] = sides.fronts.map(|side| &tree.fronts[side]);
            let panels = panels.split_at(a.panels);
            let x = below.split_at_mut(b.first - a.first);
            let passed = passed_below.split_at_mut(a.updates);
            let side = |panels, x, passed| Passage { panels, x, passed };
            [side(panels.0, x.0, passed.0), side(panels.1, x.1, passed.1)]
        });
        Cut {
            panel: MatRef::from_column_major_slice(panel, front.rows(), front.own),
            x,
            passed,
            sides,
        }
    }

    /// Solves with L.
    pub(super) fn upwards(self, tree: &Tree, f: usize) {
        let front = &tree.fronts[f];
        let Cut {
            panel,
            x,
            passed,
            sides,
        } = self.cut(tree, front);
        passed.fill(T::default());
        if let (Some([mut a, mut b]), Some(sides)) = (sides, front.sides) {
            let [f, g] = sides.fronts;
            join_if(
                sides.at_once,
                || a.reborrow().upwards(tree, f),
                || b.reborrow().upwards(tree, g),
            );
            for (side, f) in [(a, f), (b, g)] {
                let below = &tree.fronts[f];
                let from = &side.passed[side.passed.len() - below.above.len()..];
                for (&row, value) in below.above.iter().zip(from) {
                    match (row as usize).checked_sub(front.own) {
                        None => x[row as usize] += *value,
                        Some(row) => passed[row] += *value,
                    }
                }
            }
        }
        let (pivots, rest) = panel.split_at_row(front.own);
        let mut x = column(x);
        solve_unit_lower_triangular_in_place(pivots, x.rb_mut(), Par::Seq);
        let minus = -faer::traits::math_utils::one::<T>();
        matmul(column(passed), Accum::Add, rest, x.rb(), minus, Par::Seq);
    }

    /// Solves with D Lᵀ.
    pub(super) fn downwards(self, tree: &Tree, f: usize) {
        let front = &tree.fronts[f];
        let Cut {
            panel,
            x,
            passed,
            sides,
        } = self.cut(tree, front);
        let (pivots, rest) = panel.split_at_row(front.own);
        for (i, value) in x.iter_mut().enumerate() {
            *value *= pivots[(i, i)].recip();
        }
        let told = MatRef::from_column_major_slice(passed, passed.len(), 1);
        let minus = -faer::traits::math_utils::one::<T>();
        matmul(
            column(x),
            Accum::Add,
            rest.transpose(),
            told,
            minus,
            Par::Seq,
        );
        solve_unit_upper_triangular_in_place(pivots.transpose(), column(x), Par::Seq);
        if let (Some([a, b]), Some(sides)) = (sides, front.sides) {
            let tell = |side: &mut Passage<T>, f: usize| {
                let below = &tree.fronts[f];
                let first = side.passed.len() - below.above.len();
                for (value, &row) in side.passed[first..].iter_mut().zip(&below.above) {
                    *value = match (row as usize).checked_sub(front.own) {
                        None => x[row as usize],
                        Some(row) => passed[row],
                    };
                }
            };
            let [f, g] = sides.fronts;
            let (mut a, mut b) = (a, b);
            tell(&mut a, f);
            tell(&mut b, g);
            join_if(
                sides.at_once,
                || a.downwards(tree, f),
                || b.downwards(tree, g),
            );
        }
    }

    fn reborrow(&mut self) -> Passage<'_, T> {
        Passage {
            panels: self.panels,
            x: self.x,
            passed: self.passed,
        }
    }
}
