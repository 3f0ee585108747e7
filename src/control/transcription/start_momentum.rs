//! The momentum of the start, which may follow free masses.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::transcription::layout::Layout;
use crate::control::transcription::structure::Structure;
use crate::model::{Model, Role};

/// Momenta of the start: those at the values of the parameters at the start, and straight lines in these.
#[derive(Debug)]
pub(super) struct StartMomentum {
    /// Momentum of each coordinate.
    pub(super) given: Vec<f64>,
    lines: Vec<Line>,
}

/// Change of the momenta with a parameter.
#[derive(Debug)]
struct Line {
    /// Column of the parameter.
    column: usize,
    /// Its value where the momenta are those that are given.
    value: f64,
    /// Slope of each momentum.
    slopes: Vec<f64>,
    /// Entries of the Jacobian, and the coordinate of each.
    entries: Vec<(usize, usize)>,
}

impl StartMomentum {
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        (layout, structure): (&Layout, &Structure),
    ) -> Self {
        if layout.is_closed() {
            return Self {
                given: vec![0.0; boundary.start.momentum.len()],
                lines: Vec::new(),
            };
        }
        let pattern = model.action.layout();
        let first = model.variables.range(Role::Parameter).start;
        let lines = boundary.momentum_slopes.iter().filter_map(|one| {
            let s = first + one.parameter;
            let mixed = pattern.mixed.entries().enumerate();
            let read = mixed.filter(|&(_, (i, scalar))| scalar == s && i < one.slopes.len());
            let entry = |(slot, (i, _)): (usize, (usize, usize))| {
                let place = pattern.mixed_at(0, 0) + slot;
                let mut kept = structure.jacobian.kept.iter();
                Some((kept.position(|kept| kept.place == place)?, i))
            };
            Some(Line {
                column: layout.unknowns.scalar(0, s)?,
                value: one.value,
                slopes: one.slopes.clone(),
                entries: read.filter_map(entry).collect(),
            })
        });
        Self {
            given: boundary.start.momentum.clone(),
            lines: lines.collect(),
        }
    }

    /// The momentum of a coordinate at a point, whose columns have these scales.
    pub(super) fn at(&self, i: usize, (x, scales): (&[f64], &[f64])) -> f64 {
        let Some(given) = self.given.get(i) else {
            return 0.0;
        };
        let of = |line: &Line| line.slopes[i] * (x[line.column] * scales[line.column] - line.value);
        given + self.lines.iter().map(of).sum::<f64>()
    }

    /// Entries of the Jacobian that the momenta change, and their parts.
    pub(super) fn slopes(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.lines.iter().flat_map(|line| {
            let entries = line.entries.iter();
            entries.map(|&(entry, i)| (entry, line.slopes[i]))
        })
    }
}
