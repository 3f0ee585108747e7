//! Symbolic factorisation: the work done once for all matrices of one pattern.

use super::condense::Condensation;
use super::fronts::Fronts;
use super::order::Unknown;
use super::progress::Progress;
use crate::math::{IsOver, Stopped};

/// Order of elimination, fronts and maps for all matrices of one pattern.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) fronts: Fronts,
    /// Groups that are eliminated first, where that is worth it.
    pub(super) condensation: Option<Condensation>,
}

impl Plan {
    /// A plan for symmetric matrices of `order` unknowns with entries at `rows` and `cols`, in either triangle; entries at
    /// one place are added. `unknowns` gives the kind of each unknown; without it the order is one of approximate minimum degree.
    ///
    /// # Panics
    ///
    /// If lengths or indices contradict each other.
    #[must_use]
    pub fn new(order: usize, rows: &[u32], cols: &[u32], unknowns: Option<&[Unknown]>) -> Self {
        let planned = Self::new_unless(order, rows, cols, unknowns, &|| false);
        planned.expect("nothing stops it")
    }

    /// The same, unless it is stopped; it calls `is_over` every few milliseconds.
    ///
    /// # Errors
    ///
    /// If `is_over` returned true.
    ///
    /// # Panics
    ///
    /// If lengths or indices contradict each other.
    pub fn new_unless(
        order: usize,
        rows: &[u32],
        cols: &[u32],
        unknowns: Option<&[Unknown]>,
        is_over: IsOver<'_>,
    ) -> Result<Self, Stopped> {
        assert_eq!(rows.len(), cols.len(), "as many rows as columns");
        if let Some(unknowns) = unknowns {
            assert_eq!(unknowns.len(), order, "a word on each unknown");
        }
        let is_inside = |list: &[u32]| list.iter().all(|&i| (i as usize) < order);
        assert!(
            is_inside(rows) && is_inside(cols),
            "a matrix of order {order}"
        );
        let progress = &mut Progress::new(is_over);
        let (graph, fronts) = Fronts::new(order, rows, cols, unknowns, progress)?;
        let multiplications = fronts.multiplications();
        let condensation = match unknowns {
            Some(unknowns) => {
                let pattern = (rows, cols);
                Condensation::new(&graph, unknowns, pattern, multiplications, progress)?
            }
            None => None,
        };
        Ok(Self {
            fronts,
            condensation,
        })
    }

    /// Number of unknowns.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.fronts.order()
    }

    /// Rows and columns of the entries.
    #[must_use]
    pub fn pattern(&self) -> (&[u32], &[u32]) {
        self.fronts.pattern()
    }

    /// Multiplications of a factorisation along the horizon without delays.
    #[must_use]
    pub fn multiplications(&self) -> f64 {
        self.fronts.multiplications()
    }
}
