//! LDLᵀ without exchanges by fronts, along a nested dissection of unknowns with places in space (J. W. H. Liu, SIAM Review 34,
//! 1992).
//!
//! A quasi-definite matrix has an LDLᵀ in every order. Others may break down or lose their digits; the check of a known
//! solution sees it. Both sides of a cut are worked on at once where they are large. What is computed where follows from the
//! pattern alone, so that factors have the same bits on any number of cores.

mod factor;
mod solve;
mod tree;

use std::sync::Arc;

use crate::math::{IsOver, Stopped};
use crate::sparse::dissection::{Dissection, Places};
use crate::sparse::mumps::Mumps;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Precision, Singular};

use factor::{Elimination, Number, Undone};
use solve::Passage;
use tree::Tree;

/// LDLᵀ by fronts with factors of numbers `T`.
#[derive(Debug)]
pub(crate) struct Fronts<T> {
    pattern: Arc<Pattern>,
    tree: Arc<Tree>,
    panels: Vec<T>,
    /// Numbers in passing: updates of fronts.
    space: Vec<T>,
    x: Vec<T>,
    passed: Vec<T>,
}

impl Fronts<f32> {
    /// With factors in single precision.
    pub(crate) fn new(pattern: &Arc<Pattern>, places: &Places) -> Self {
        let tree = Tree::new(pattern, &Dissection::new(pattern, places));
        Self::from_tree(pattern, &Arc::new(tree))
    }
}

impl<T: Number> Fronts<T> {
    fn from_tree(pattern: &Arc<Pattern>, tree: &Arc<Tree>) -> Self {
        let whole = tree.whole();
        let zeros = |count| vec![T::default(); count];
        Self {
            panels: zeros(whole.panels),
            space: zeros(whole.space),
            x: zeros(pattern.size),
            passed: zeros(whole.updates),
            pattern: Arc::clone(pattern),
            tree: Arc::clone(tree),
        }
    }

    fn last(&self) -> usize {
        self.tree.fronts.len() - 1
    }

    fn passage(&mut self) -> Passage<'_, T> {
        Passage {
            panels: &self.panels,
            x: &mut self.x,
            passed: &mut self.passed,
        }
    }
}

impl<T: Number> Factorisation for Fronts<T> {
    fn name(&self) -> &'static str {
        T::LDLT
    }

    fn precision(&self) -> Precision {
        T::PRECISION
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let done = self.factor_unless(values, &|| false);
        done.expect("it is never time to stop")
    }

    fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        let last = self.last();
        let elimination = Elimination {
            tree: &self.tree,
            values,
            is_over,
        };
        let mut memory = elimination.memory::<T>();
        match elimination.run(last, &mut self.panels, &mut self.space, &mut memory) {
            Ok(()) => Ok(Ok(())),
            Err(Undone::Singular(singular)) => Ok(Err(singular)),
            Err(Undone::Stopped) => Err(Stopped),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        // A power of two rounds nothing, and keeps numbers of little precision in their range.
        let peak = rhs
            .iter()
            .fold(0.0_f64, |peak, value| peak.max(value.abs()));
        let unit = match peak.is_normal() {
            true => peak.log2().round().exp2(),
            false => 1.0,
        };
        for (value, &place) in rhs.iter().zip(&self.tree.places) {
            self.x[place] = T::near(value / unit);
        }
        let (tree, last) = (Arc::clone(&self.tree), self.last());
        self.passage().upwards(&tree, last);
        self.passage().downwards(&tree, last);
        for (value, &place) in rhs.iter_mut().zip(&self.tree.places) {
            *value = self.x[place].value() * unit;
        }
    }

    fn negative_pivots(&self) -> Option<usize> {
        let (mut count, mut start) = (0, 0);
        for front in &self.tree.fronts {
            let pivots = (0..front.own).map(|i| self.panels[start + i * (front.rows() + 1)]);
            count += pivots.filter(|d| d.value() < 0.0).count();
            start += front.panel();
        }
        Some(count)
    }

    fn in_single_precision(&self) -> Option<Box<dyn Factorisation>> {
        Some(Box::new(Fronts::<f32>::from_tree(
            &self.pattern,
            &self.tree,
        )))
    }

    /// The same with more digits, and then with exchanges: the matrix may merely not be quasi-definite.
    fn more_robust(&self) -> Option<Box<dyn Factorisation>> {
        match T::PRECISION {
            Precision::Single => Some(Box::new(Fronts::<f64>::from_tree(
                &self.pattern,
                &self.tree,
            ))),
            Precision::Double => Some(Box::new(Mumps::new(&self.pattern))),
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/units/sparse/fronts.rs"]
mod tests;
