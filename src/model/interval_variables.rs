//! Variables of an interval that sources and parameters bring.

use crate::model::analysis::Analysis;
use crate::model::system::Source;
use crate::model::variables::{Variable, Variables};

/// Voltages, loads and parameters, the first scalars of an interval.
pub(super) fn interval_variables(
    inputs: &[usize],
    sources: &[Source],
    analysis: &Analysis,
) -> Variables {
    let mut variables = Variables::default();
    for &source in inputs {
        let Source { name, kind, .. } = &sources[source];
        variables.add(Variable::input(source, *kind, name.clone()));
    }
    for parameter in &analysis.parameters {
        variables.add(Variable::parameter(parameter.name.clone()));
    }
    variables
}
