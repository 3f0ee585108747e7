//! The order of the equations of a group and of their unknowns, so that factors have entries near the diagonal only.
//!
//! Equations that share an unknown are neighbours. They are taken in the order of Cuthill and McKee (1969) from one that lies at an end, and
//! unknowns in the order in which they appear in them.

use super::eliminable_groups::Group;
use super::graph::{Graph, Progress};
use crate::math::Stopped;

const NONE: u32 = u32::MAX;

/// Incidence of the equations of a group and its unknowns.
struct Arrangement<'a> {
    graph: &'a Graph,
    group: &'a Group,
    /// Number of each unknown of the graph among those of the group, and among its equations.
    state_of: &'a [u32],
    equation_of: &'a [u32],
    /// The last search that met an equation, and an unknown.
    met: Vec<u32>,
    seen: Vec<u32>,
    search: u32,
}

/// Brings the equations and unknowns of all groups in order.
pub(super) fn arrange(
    graph: &Graph,
    groups: &mut [Group],
    progress: &mut Progress<'_>,
) -> Result<(), Stopped> {
    let mut state_of = vec![NONE; graph.order()];
    let mut equation_of = vec![NONE; graph.order()];
    for group in groups {
        number(&mut state_of, &group.states);
        number(&mut equation_of, &group.equations);
        let arranged = Arrangement {
            graph,
            group,
            state_of: &state_of,
            equation_of: &equation_of,
            met: vec![0; group.equations.len()],
            seen: vec![0; group.states.len()],
            search: 0,
        }
        .run(progress)?;
        for &i in &group.states {
            state_of[i as usize] = NONE;
        }
        for &i in &group.equations {
            equation_of[i as usize] = NONE;
        }
        *group = arranged;
    }
    Ok(())
}

fn number(numbers: &mut [u32], list: &[u32]) {
    for (number, &i) in list.iter().enumerate() {
        numbers[i as usize] = number as u32;
    }
}

impl Arrangement<'_> {
    fn run(mut self, progress: &mut Progress<'_>) -> Result<Group, Stopped> {
        let count = self.group.equations.len();
        let mut is_done = vec![false; count];
        let mut order = Vec::with_capacity(count);
        for first in 0..count as u32 {
            if is_done[first as usize] {
                continue;
            }
            // What lies farthest from anywhere, then farthest from there, lies at an end.
            let found = self.search(first, progress)?;
            let farthest = *found.last().expect("the first is found");
            let found = self.search(farthest, progress)?;
            let end = *found.last().expect("the first is found");
            let part = self.search(end, progress)?;
            part.iter().for_each(|&i| is_done[i as usize] = true);
            order.extend(part);
        }
        let mut states: Vec<u32> = Vec::with_capacity(self.group.states.len());
        let mut is_taken = vec![false; self.group.states.len()];
        let mut take = |state: u32| {
            if !std::mem::replace(&mut is_taken[state as usize], true) {
                states.push(self.group.states[state as usize]);
            }
        };
        for &equation in &order {
            self.states(equation).for_each(&mut take);
        }
        (0..self.group.states.len() as u32).for_each(take);
        Ok(Group {
            states,
            equations: self.of_group(&order),
        })
    }

    fn of_group(&self, order: &[u32]) -> Vec<u32> {
        let equations = &self.group.equations;
        order.iter().map(|&i| equations[i as usize]).collect()
    }

    /// Unknowns of an equation.
    fn states(&self, equation: u32) -> impl Iterator<Item = u32> {
        let unknown = self.group.equations[equation as usize];
        let others = self.graph.neighbours(unknown as usize).iter();
        let states = others.map(|&i| self.state_of[i as usize]);
        states.filter(|&state| state != NONE)
    }

    /// Equations of an unknown.
    fn equations(&self, state: u32) -> impl Iterator<Item = u32> {
        let unknown = self.group.states[state as usize];
        let others = self.graph.neighbours(unknown as usize).iter();
        let equations = others.map(|&i| self.equation_of[i as usize]);
        equations.filter(|&equation| equation != NONE)
    }

    /// All equations that are connected with one, by their distance from it, those with few unknowns first.
    fn search(&mut self, first: u32, progress: &mut Progress<'_>) -> Result<Vec<u32>, Stopped> {
        self.search += 1;
        let search = self.search;
        let mut order = vec![first];
        self.met[first as usize] = search;
        let mut next = 0;
        while next < order.len() {
            let equation = order[next];
            let begin = order.len();
            let states: Vec<u32> = self.states(equation).collect();
            progress.add(states.len().pow(2))?;
            for state in states {
                if std::mem::replace(&mut self.seen[state as usize], search) == search {
                    continue;
                }
                let others: Vec<u32> = self.equations(state).collect();
                for other in others {
                    if std::mem::replace(&mut self.met[other as usize], search) != search {
                        order.push(other);
                    }
                }
            }
            order[begin..].sort_by_key(|&other| self.states(other).count());
            next += 1;
        }
        Ok(order)
    }
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Envelope;
    use super::*;

    #[test]
    fn shuffled_equations_of_a_bar_come_near_the_diagonal() {
        // Equations 0..200 and unknowns 200..400 of a bar, five next to each other, known by numbers that tell nothing.
        const COUNT: u32 = 200;
        let shuffled = |i: u32| (i * 77 + 13) % COUNT;
        let near = |i: u32| i.saturating_sub(9)..COUNT.min(i + 10);
        let pairs =
            (0..COUNT).flat_map(|i| near(i).map(move |j| (shuffled(i), COUNT + shuffled(j))));
        let (rows, cols): (Vec<u32>, Vec<u32>) = pairs.unzip();
        let progress = &mut Progress::new(&|| false);
        let graph = Graph::new(2 * COUNT as usize, &rows, &cols, progress);
        let graph = graph.expect("nothing stops it");
        let before = Group {
            states: (COUNT..2 * COUNT).collect(),
            equations: (0..COUNT).collect(),
        };
        let mut groups = [before.clone()];
        arrange(&graph, &mut groups, progress).expect("nothing stops it");
        let envelope = |group: &Group| {
            let place = |list: &[u32], i| list.iter().position(|&j| j == i).expect("it is kept");
            let pairs = rows.iter().zip(&cols);
            let places =
                pairs.map(|(&i, &j)| (place(&group.equations, i), place(&group.states, j)));
            Envelope::new(COUNT as usize, COUNT as usize, places)
        };
        let (before, after) = (envelope(&before), envelope(&groups[0]));
        assert_eq!(before.stride, COUNT as usize);
        assert!(after.stride < 80, "{} rows at once", after.stride);
        assert!(
            4 * after.of_factors() < before.of_factors(),
            "{} multiplications, {} before",
            after.of_factors(),
            before.of_factors()
        );
    }
}
