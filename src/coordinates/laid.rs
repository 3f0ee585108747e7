//! Entries of the second derivatives by coordinates, and the plan of their pull-back.

use crate::coordinates::map::CoordinateMap;
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::{PullBack, Site};
use crate::functional::Functional;

/// Entries and the way to them, laid down where they are asked for.
#[derive(Debug)]
pub(super) struct Laid {
    pub(super) intervals: PullBack,
    pub(super) instants: PullBack,
    pub(super) curvature: Vec<[usize; 2]>,
    pub(super) layout: StepPattern,
}

impl Laid {
    pub(super) fn new(map: &CoordinateMap, intervals: &Functional, instants: &Functional) -> Self {
        let mut layout = StepPattern {
            unknowns: map.unknowns(),
            interval_scalars: intervals.scalars,
            ..StepPattern::default()
        };
        let mut plan =
            |sum: &Functional, site| PullBack::new(sum.couplings(), map, &mut layout, site);
        let intervals = plan(intervals, Site::Intervals);
        let instants = plan(instants, Site::Instants);
        let entries = map.tree.iter().flat_map(|tree| tree.curvature_entries());
        let curvature = entries
            .map(|(i, k)| [layout.same.slot(i, k), layout.same.slot(k, i)])
            .collect();
        layout.shrink_to_fit();
        Self {
            intervals,
            instants,
            curvature,
            layout,
        }
    }
}
