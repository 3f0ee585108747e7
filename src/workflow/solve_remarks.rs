//! Remarks on a solve, the same for the command line, Python and Rust.

use crate::control::problem::Control;
use crate::workflow::afterwards::Afterwards;
use crate::workflow::further::is_unreached;
use crate::workflow::hold_check::free_end;
use crate::workflow::infeasible::explain;
use crate::workflow::optimum::Optimum;
use crate::workflow::remark::Remarks;
use crate::workflow::resimulate::Resimulation;

/// Adds all that is to be known of an optimum, or of the last iterate of a solve that found none; `refined` tells why another
/// grid was taken than that of the problem.
pub(crate) fn add_remarks(
    remarks: &mut Remarks,
    control: &Control,
    optimum: &Optimum,
    refined: Option<String>,
    not_kept: Option<String>,
) {
    let tested = optimum.resimulation.as_ref();
    let left_goal = optimum.afterwards.as_ref().and_then(Afterwards::warning);
    remarks.note("refined_grid", refined);
    remarks.warn("coarse_intervals", tested.and_then(Resimulation::warning));
    remarks.warn("goal_not_held", not_kept.into_iter().chain(left_goal));
    remarks.warn("optimality_gap", optimum.wide.clone());
    remarks.note("free_end", free_end(control));
    remarks.note("linear_solver", optimum.solution.linear.note());
    if is_unreached(&optimum.solution) {
        remarks.note("infeasible", explain(control, optimum));
    }
}
