//! Groups of equations that may be solved for unknowns before all others.
//!
//! * Where a stage has as many equations as variables, and these equations reach no later stage, they determine its states from earlier
//!   ones and from the rest: inputs, multipliers of further equations, a free duration.
//! * Constraints of one stage determine as many of its variables; the others stay. In the equations of a stage that hold multipliers of
//!   constraints, the rows of these multipliers do the same to the costates: P in `G P = 0` of the null space method, for both.

use std::collections::BTreeMap;

use super::graph::Graph;
use super::order::Unknown;

/// Equations and the unknowns that they determine, as many or more.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    pub(super) states: Vec<u32>,
    pub(super) equations: Vec<u32>,
}

/// Stages with as many equations as variables.
pub(super) fn squares(graph: &Graph, unknowns: &[Unknown]) -> Vec<Group> {
    let mut stages: BTreeMap<u32, Group> = BTreeMap::new();
    for (i, unknown) in unknowns.iter().enumerate() {
        match unknown {
            Unknown::Variable(stage) | Unknown::Multiplier(stage) => {
                let group = stages.entry(*stage).or_default();
                group.states.push(i as u32);
            }
            Unknown::Equality => {
                if let Some(stage) = stages_of(graph, unknowns, i).max() {
                    let group = stages.entry(stage).or_default();
                    group.equations.push(i as u32);
                }
            }
            _ => {}
        }
    }
    let mut groups: Vec<Group> = stages.into_values().collect();
    groups.retain(|group| !group.states.is_empty() && group.equations.len() >= group.states.len());
    for group in &mut groups {
        group.equations.truncate(group.states.len());
    }
    groups
}

/// Constraints of one stage with its variables, then multipliers of constraints with the equations that hold them.
pub(super) fn constraints(graph: &Graph, unknowns: &[Unknown]) -> Vec<Group> {
    let mut of_variables: BTreeMap<u32, Group> = BTreeMap::new();
    let mut is_constraint = vec![false; unknowns.len()];
    for (i, unknown) in unknowns.iter().enumerate() {
        let stage = only_stage(graph, unknowns, i);
        if let (Unknown::Equality, Some(stage)) = (unknown, stage) {
            is_constraint[i] = true;
            let group = of_variables.entry(stage).or_default();
            group.equations.push(i as u32);
            group.states.extend(graph.neighbours(i));
        }
    }
    let mut of_costates: BTreeMap<u32, Group> = BTreeMap::new();
    for (i, unknown) in unknowns.iter().enumerate() {
        if let Unknown::Multiplier(stage) = unknown {
            let group = of_costates.entry(*stage).or_default();
            group.equations.push(i as u32);
            let others = graph.neighbours(i).iter();
            let rows = others.filter(|&&j| unknowns[j as usize] == Unknown::Equality);
            group.states.extend(rows);
        }
    }
    let mut is_taken = is_constraint;
    let mut groups = Vec::new();
    for mut group in of_variables.into_values().chain(of_costates.into_values()) {
        group.states.sort_unstable();
        group.states.dedup();
        let is_free = group.states.iter().all(|&i| !is_taken[i as usize]);
        if is_free && group.equations.len() <= group.states.len() {
            group
                .states
                .iter()
                .for_each(|&i| is_taken[i as usize] = true);
            groups.push(group);
        }
    }
    groups
}

/// The stages of the variables that share an entry with an unknown.
fn stages_of<'a>(
    graph: &'a Graph,
    unknowns: &'a [Unknown],
    i: usize,
) -> impl Iterator<Item = u32> + 'a {
    let others = graph.neighbours(i).iter();
    others.filter_map(|&j| unknowns[j as usize].stage())
}

/// The stage of all unknowns that share an entry with an equation, if they are variables of one stage and no multipliers.
fn only_stage(graph: &Graph, unknowns: &[Unknown], i: usize) -> Option<u32> {
    let stage = stages_of(graph, unknowns, i).next()?;
    let mut others = graph.neighbours(i).iter();
    let is_own = |&j: &u32| unknowns[j as usize] == Unknown::Variable(stage);
    others.all(is_own).then_some(stage)
}
