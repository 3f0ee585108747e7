//! The tree of fronts: the unknowns that are eliminated together, and the rows that they reach.
//!
//! The elimination tree of Liu (1990) is walked from its leaves. Each column gathers the rows of its children; a child joins the node
//! of its parent where that stores no further zeros, or few of them (amalgamation of Duff and Reid, 1983).

use super::graph::{Graph, Progress};
use super::order::Elimination;
use crate::math::Stopped;

/// Nodes with fewer columns than this are joined as long as the zeros stay below its square.
const SMALL: usize = 16;
/// Greatest part of zeros in a node of more columns.
const ZEROS: f64 = 0.2;
const NONE: u32 = u32::MAX;

/// Unknowns that are eliminated together.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// The unknowns, then those that they reach, in the order of elimination.
    pub(super) unknowns: Vec<u32>,
    /// Number of unknowns that are eliminated here.
    pub(super) columns: usize,
    /// Nodes that this one sums, ascending.
    pub(super) children: Vec<u32>,
}

/// The nodes, children before their parents and next to them (a postorder).
pub(super) fn nodes(
    graph: &Graph,
    elimination: &Elimination,
    progress: &mut Progress<'_>,
) -> Result<Vec<Node>, Stopped> {
    let (_, neighbours) = graph.lists();
    progress.add(neighbours.len())?;
    let order = postorder(&elimination.order, &parents(graph, &elimination.order));
    progress.add(neighbours.len())?;
    let parents = parents(graph, &order);
    let mut build = Build::new(graph, elimination, &order);
    for column in 0..order.len() {
        let before = build.rows.len();
        build.add(column, &parents);
        progress.add(1 + build.rows.len() - before)?;
    }
    Ok(build.into_nodes())
}

fn inverse(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    for (k, &i) in order.iter().enumerate() {
        place[i as usize] = k as u32;
    }
    place
}

/// Parent of each column of the elimination tree, counted in the order.
fn parents(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let place = inverse(order);
    let mut parents = vec![NONE; order.len()];
    let mut ancestors = vec![NONE; order.len()];
    for (k, &unknown) in order.iter().enumerate() {
        for &i in graph.neighbours(unknown as usize) {
            let mut root = place[i as usize];
            while root < k as u32 {
                let next = std::mem::replace(&mut ancestors[root as usize], k as u32);
                if next == NONE {
                    parents[root as usize] = k as u32;
                }
                root = next;
            }
        }
    }
    parents
}

/// The same elimination with each subtree in one piece.
fn postorder(order: &[u32], parents: &[u32]) -> Vec<u32> {
    let n = order.len();
    let (mut child, mut sibling) = (vec![NONE; n], vec![NONE; n]);
    let mut stack = Vec::new();
    for k in (0..n).rev() {
        match parents[k] {
            NONE => stack.push(k as u32),
            parent => sibling[k] = std::mem::replace(&mut child[parent as usize], k as u32),
        }
    }
    let mut sorted = Vec::with_capacity(n);
    while let Some(&top) = stack.last() {
        match child[top as usize] {
            NONE => {
                sorted.push(order[top as usize]);
                stack.pop();
            }
            next => {
                child[top as usize] = sibling[next as usize];
                stack.push(next);
            }
        }
    }
    sorted
}

/// A node that may still join another.
#[derive(Clone, Copy)]
struct OpenNode {
    /// First and last column; the others are linked.
    columns: (u32, u32),
    count: usize,
    /// Rows below, a range of all rows.
    rows: (usize, usize),
    /// First child; the others are linked.
    child: u32,
    /// Stored zeros.
    zeros: usize,
    is_alive: bool,
    is_alone: bool,
}

struct Build<'a> {
    graph: &'a Graph,
    elimination: &'a Elimination,
    order: &'a [u32],
    place: Vec<u32>,
    parts: Vec<OpenNode>,
    /// Rows of all parts, in places of the order.
    rows: Vec<u32>,
    /// Next column of the same part.
    next_column: Vec<u32>,
    /// Next child of the same part.
    next_child: Vec<u32>,
    /// Column that saw a row last, and the last one that gathered rows.
    seen: Vec<u32>,
    mark: u32,
    /// Children of each column that is still to come, linked by `next_child`.
    waiting: Vec<u32>,
}

impl<'a> Build<'a> {
    fn new(graph: &'a Graph, elimination: &'a Elimination, order: &'a [u32]) -> Self {
        let n = order.len();
        Self {
            graph,
            elimination,
            order,
            place: inverse(order),
            parts: Vec::with_capacity(n),
            rows: Vec::new(),
            next_column: vec![NONE; n],
            next_child: vec![NONE; n],
            seen: vec![NONE; n],
            mark: NONE,
            waiting: vec![NONE; n],
        }
    }

    /// Makes the part of a column, one a column, and joins children to it.
    fn add(&mut self, column: usize, parents: &[u32]) {
        let rows = self.inherited(column);
        let rows = rows.unwrap_or_else(|| self.gather(column));
        let unknown = self.order[column] as usize;
        let mut part = OpenNode {
            columns: (column as u32, column as u32),
            count: 1,
            rows,
            child: NONE,
            zeros: 0,
            is_alive: true,
            is_alone: self.elimination.alone[unknown],
        };
        let mut child = self.waiting[column];
        while child != NONE {
            let next = self.next_child[child as usize];
            match self.zeros_together(&self.parts[child as usize], &part) {
                Some(zeros) => self.join(child, &mut part, zeros),
                None => self.next_child[child as usize] = std::mem::replace(&mut part.child, child),
            }
            child = next;
        }
        self.parts.push(part);
        if parents[column] != NONE {
            let waiting = &mut self.waiting[parents[column] as usize];
            self.next_child[column] = std::mem::replace(waiting, column as u32);
        }
    }

    /// The rows of its child where a column reaches no others and has no other child: those of a dense front are listed once.
    fn inherited(&self, column: usize) -> Option<(usize, usize)> {
        let child = self.waiting[column];
        let is_only = child != NONE && self.next_child[child as usize] == NONE;
        // No column in between has gathered rows.
        if !is_only || child as usize + 1 != column {
            return None;
        }
        let others = self.graph.neighbours(self.order[column] as usize).iter();
        let mut rows = others.map(|&i| self.place[i as usize] as usize);
        let (first, last) = self.parts[child as usize].rows;
        // The first row of a child is its parent.
        rows.all(|row| row < column || self.seen[row] == self.mark)
            .then_some((first + 1, last))
    }

    /// Appends the rows below a column to all rows.
    fn gather(&mut self, column: usize) -> (usize, usize) {
        let begin = self.rows.len();
        let mark = column as u32;
        self.mark = mark;
        for &i in self.graph.neighbours(self.order[column] as usize) {
            let row = self.place[i as usize];
            if row > mark && self.seen[row as usize] != mark {
                self.seen[row as usize] = mark;
                self.rows.push(row);
            }
        }
        let mut child = self.waiting[column];
        while child != NONE {
            let (first, last) = self.parts[child as usize].rows;
            for at in first..last {
                let row = self.rows[at];
                if row > mark && self.seen[row as usize] != mark {
                    self.seen[row as usize] = mark;
                    self.rows.push(row);
                }
            }
            child = self.next_child[child as usize];
        }
        self.rows[begin..].sort_unstable();
        (begin, self.rows.len())
    }

    /// Stored zeros of a node made of two, if they are few enough.
    fn zeros_together(&self, child: &OpenNode, part: &OpenNode) -> Option<usize> {
        if child.is_alone || part.is_alone {
            return None;
        }
        let below = part.rows.1 - part.rows.0;
        let reached = child.rows.1 - child.rows.0;
        // Each column of the child is lengthened to the columns of the part and all rows below.
        let more = child.count * (part.count + below - reached);
        let zeros = child.zeros + part.zeros + more;
        let count = child.count + part.count;
        let area = count * (count + 1) / 2 + count * below;
        let is_small = child.count < SMALL && part.count < SMALL && zeros <= SMALL * SMALL;
        let few = is_small || (zeros as f64) < ZEROS * area as f64 && count > SMALL;
        (more == 0 || few).then_some(zeros)
    }

    fn join(&mut self, child: u32, part: &mut OpenNode, zeros: usize) {
        let joined = &mut self.parts[child as usize];
        joined.is_alive = false;
        let joined = *joined;
        self.next_column[joined.columns.1 as usize] = part.columns.0;
        part.columns.0 = joined.columns.0;
        part.count += joined.count;
        part.zeros = zeros;
        let mut child = joined.child;
        while child != NONE {
            let next = self.next_child[child as usize];
            self.next_child[child as usize] = std::mem::replace(&mut part.child, child);
            child = next;
        }
    }

    /// The parts that are left, in the order of their last columns.
    fn into_nodes(self) -> Vec<Node> {
        let mut number = vec![NONE; self.parts.len()];
        let mut nodes = Vec::new();
        for (k, part) in self
            .parts
            .iter()
            .enumerate()
            .filter(|(_, part)| part.is_alive)
        {
            number[k] = nodes.len() as u32;
            let rows = part.rows.0..part.rows.1;
            let mut unknowns = Vec::with_capacity(part.count + rows.len());
            let mut column = part.columns.0;
            while column != NONE {
                unknowns.push(self.order[column as usize]);
                column = self.next_column[column as usize];
            }
            unknowns.extend(self.rows[rows].iter().map(|&row| self.order[row as usize]));
            let mut children = Vec::new();
            let mut child = part.child;
            while child != NONE {
                children.push(number[child as usize]);
                child = self.next_child[child as usize];
            }
            children.sort_unstable();
            nodes.push(Node {
                unknowns,
                columns: part.count,
                children,
            });
        }
        nodes
    }
}
