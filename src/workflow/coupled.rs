//! Pairs of unknowns that an effect couples: coordinates by entry, scalars of the site behind them. They are found unknown by unknown, so that
//! no list of all has to be sorted.

use crate::coordinates::CoordinateMap;
use crate::functional::{Coupling, Term};
use crate::ipopt::SolverResult;

/// In place of the number of an unknown.
const NONE: u32 = u32::MAX;

/// Lists of numbers, one behind the other.
#[derive(Debug)]
struct Lists {
    starts: Vec<usize>,
    items: Vec<u32>,
}

impl Lists {
    /// The lists whose items `visit` hands over with the numbers of their lists, in two passes.
    fn new(count: usize, visit: impl Fn(&mut dyn FnMut(usize, u32))) -> Self {
        let mut starts = vec![0; count + 1];
        visit(&mut |list, _| starts[list + 1] += 1);
        for list in 0..count {
            starts[list + 1] += starts[list];
        }
        let (mut next, mut items) = (starts.clone(), vec![0; starts[count]]);
        visit(&mut |list, item| {
            items[next[list]] = item;
            next[list] += 1;
        });
        Self { starts, items }
    }

    fn of(&self, list: usize) -> &[u32] {
        &self.items[self.starts[list]..self.starts[list + 1]]
    }

    /// The same lists, each item once.
    fn each_once(mut self) -> Self {
        let mut end = 0;
        for list in 0..self.starts.len() - 1 {
            let (first, own) = (end, self.starts[list]..self.starts[list + 1]);
            self.items[own.clone()].sort_unstable();
            self.starts[list] = first;
            for place in own {
                let item = self.items[place];
                if end == first || self.items[end - 1] != item {
                    self.items[end] = item;
                    end += 1;
                }
            }
        }
        if let Some(last) = self.starts.last_mut() {
            *last = end;
        }
        self.items.truncate(end);
        self.items.shrink_to_fit();
        self
    }
}

/// The unknowns that vectors and scalars depend on: arguments are the vectors, then the scalars of the site.
#[derive(Debug)]
pub(super) struct Arguments<'a> {
    map: &'a CoordinateMap,
    /// Unknowns of each argument.
    unknowns: Lists,
    /// Arguments of each unknown.
    arguments: Lists,
}

impl<'a> Arguments<'a> {
    /// Of so many scalars of a site.
    pub(super) fn new(map: &'a CoordinateMap, scalars: usize) -> Self {
        let vectors = map.vectors.len();
        let each = |to: &mut dyn FnMut(usize, usize)| {
            for vector in 0..vectors {
                let support = map.support(vector);
                support.into_iter().for_each(|unknown| to(vector, unknown));
            }
            (0..scalars).for_each(|s| to(vectors + s, map.coordinates + s));
        };
        Self {
            map,
            unknowns: Lists::new(vectors + scalars, |to| {
                each(&mut |argument, unknown| to(argument, unknown as u32));
            }),
            arguments: Lists::new(map.coordinates + scalars, |to| {
                each(&mut |argument, unknown| to(unknown, argument as u32));
            }),
        }
    }

    /// Number of unknowns.
    pub(super) fn count(&self) -> usize {
        self.arguments.starts.len() - 1
    }

    /// Returns true if two unknowns meet where vectors are multiplied by each other: directors and nodes component by component, joint
    /// coordinates all with all.
    fn meet(&self, i: usize, j: usize) -> bool {
        match (axis(self.map, i), axis(self.map, j)) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        }
    }
}

/// An effect with the arguments that it couples.
pub(super) struct Coupled<'a> {
    pub(super) effect: &'a dyn Term,
    /// Twice the argument that each one is coupled with, and one more where only vectors are multiplied.
    partners: Lists,
}

impl<'a> Coupled<'a> {
    /// The couplings of an effect.
    pub(super) fn new(effect: &'a dyn Term, of: &Arguments<'_>) -> Self {
        let (vectors, count) = (of.map.vectors.len(), of.unknowns.starts.len() - 1);
        let ordered = Lists::new(count, |to| {
            effect.couple(&mut |coupling| {
                let (a, b, by_axis) = match coupling {
                    None => return,
                    Some(Coupling::Full(a, b)) => (a, b, 0),
                    Some(Coupling::Isotropic(a, b)) => (a, b, 1),
                    Some(Coupling::Mixed(a, s)) => (a, vectors + s, 0),
                    Some(Coupling::Scalars(s, t)) => (vectors + s, vectors + t, 0),
                };
                to(a.min(b), 2 * a.max(b) as u32 + by_axis);
            });
        })
        .each_once();
        let partners = Lists::new(count, |to| {
            for a in 0..count {
                for &item in ordered.of(a) {
                    let b = item as usize / 2;
                    to(a, item);
                    if a != b {
                        to(b, 2 * a as u32 + item % 2);
                    }
                }
            }
        });
        Self { effect, partners }
    }

    /// Hands over the unknowns that one is coupled with, some of them more than once.
    fn each_partner(&self, of: &Arguments<'_>, i: usize, mut to: impl FnMut(usize)) {
        for &argument in of.arguments.of(i) {
            for &item in self.partners.of(argument as usize) {
                for &j in of.unknowns.of(item as usize / 2) {
                    if item % 2 == 0 || of.meet(i, j as usize) {
                        to(j as usize);
                    }
                }
            }
        }
    }

    /// Hands over each pair once, the smaller unknown first.
    pub(super) fn each_pair(&self, of: &Arguments<'_>, mut to: impl FnMut(usize, usize)) {
        let mut met_by = vec![NONE; of.count()];
        for i in 0..of.count() {
            self.each_partner(of, i, |j| {
                if j >= i && std::mem::replace(&mut met_by[j], i as u32) != i as u32 {
                    to(i, j);
                }
            });
        }
    }

    /// Returns true if two unknowns are coupled.
    pub(super) fn couples(&self, of: &Arguments<'_>, [i, j]: [usize; 2]) -> bool {
        let mut is_met = false;
        self.each_partner(of, i, |partner| is_met |= partner == j);
        is_met
    }
}

/// Direction of a coordinate that moves along one; `None` for a joint's.
fn axis(map: &CoordinateMap, i: usize) -> Option<usize> {
    match i.checked_sub(map.of_bodies) {
        Some(of_node) => map.of_nodes.get(of_node).map(|&(_, axis)| axis),
        None => map.tree.is_none().then_some(i % 3),
    }
}

/// The better of two solves, with the iterations, evaluations and seconds of both.
pub(crate) fn one_of_both(mut first: SolverResult, mut second: SolverResult) -> SolverResult {
    if second.status.is_solved() {
        put_before(&mut second, &first);
        return second;
    }
    put_after(&mut first, &second);
    first
}

/// Adds iterations, evaluations and seconds of an earlier solve.
pub(crate) fn put_before(kept: &mut SolverResult, earlier: &SolverResult) {
    kept.iterations.splice(0..0, earlier.iterations.clone());
    add_calls(kept, earlier);
}

/// Adds iterations, evaluations and seconds of a later solve.
pub(crate) fn put_after(kept: &mut SolverResult, later: &SolverResult) {
    kept.iterations.extend_from_slice(&later.iterations);
    add_calls(kept, later);
}

fn add_calls(kept: &mut SolverResult, other: &SolverResult) {
    kept.seconds += other.seconds;
    kept.evaluations += other.evaluations;
    kept.failed_evaluations += other.failed_evaluations;
}
