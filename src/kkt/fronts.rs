//! The symbolic part of a factorisation: fronts, and where each entry of the matrix goes.

use std::ops::Range;

use super::graph::{Graph, Pattern, Progress};
use super::order::{self, Unknown};
use super::tree::{self, Node};
use crate::math::Stopped;

/// One front, without the rows that are delayed to it.
#[derive(Clone, Debug)]
pub(super) struct Front {
    /// Its unknowns among all: those eliminated here, then those that they reach.
    pub(super) unknowns: Range<usize>,
    /// Number of columns that are eliminated here.
    pub(super) columns: usize,
    /// Fronts that this one sums, a range of all children.
    pub(super) children: Range<usize>,
    /// Entries of the matrix that begin here.
    pub(super) entries: Range<usize>,
    /// Places of the rows below in the front of the parent, a range of all places.
    pub(super) places: Range<usize>,
    /// True if no front sums this one.
    pub(super) is_root: bool,
}

/// An entry of the matrix in a front.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrontEntry {
    /// Its number among the entries.
    pub(super) entry: u32,
    /// Its row in the front.
    pub(super) row: u32,
    /// Its column in the front, not after the row.
    pub(super) column: u32,
}

/// Order of elimination, fronts and maps for all matrices of one pattern.
#[derive(Clone, Debug)]
pub(super) struct Fronts {
    order: usize,
    rows: Vec<u32>,
    cols: Vec<u32>,
    pub(super) list: Vec<Front>,
    pub(super) unknowns: Vec<u32>,
    pub(super) children: Vec<u32>,
    pub(super) entries: Vec<FrontEntry>,
    pub(super) places: Vec<u32>,
}

impl Fronts {
    /// For symmetric matrices of `order` unknowns with these entries; with the graph of the pattern.
    pub(super) fn new(
        order: usize,
        pattern: Pattern<'_>,
        unknowns: Option<&[Unknown]>,
        progress: &mut Progress<'_>,
    ) -> Result<(Graph, Self), Stopped> {
        let graph = Graph::new(order, pattern, progress)?;
        progress.add(pattern.len())?;
        let elimination = order::elimination(&graph, unknowns);
        let nodes = tree::nodes(&graph, &elimination, progress)?;
        let mut fronts = Self {
            order,
            rows: pattern.rows.to_vec(),
            cols: pattern.cols.to_vec(),
            list: Vec::with_capacity(nodes.len()),
            unknowns: Vec::new(),
            children: Vec::new(),
            entries: Vec::with_capacity(pattern.len()),
            places: Vec::new(),
        };
        fronts.lay_out(&nodes, progress)?;
        Ok((graph, fronts))
    }

    /// Number of unknowns.
    pub(super) const fn order(&self) -> usize {
        self.order
    }

    /// Rows and columns of the entries.
    pub(super) fn pattern(&self) -> Pattern<'_> {
        Pattern::new(&self.rows, &self.cols)
    }

    /// Multiplications of a factorisation along the horizon without delays.
    pub(super) fn multiplications(&self) -> f64 {
        let of_front = |front: &Front| {
            let (k, m) = (front.columns as f64, front.unknowns.len() as f64);
            k * (m * (m - k) + k * k / 3.0) / 2.0
        };
        self.list.iter().map(of_front).sum()
    }

    fn lay_out(&mut self, nodes: &[Node], progress: &mut Progress<'_>) -> Result<(), Stopped> {
        // Front that eliminates each unknown, and the place there.
        let mut home = vec![(0, 0); self.order];
        for (k, node) in nodes.iter().enumerate() {
            for (place, &unknown) in node.unknowns[..node.columns].iter().enumerate() {
                home[unknown as usize] = (k as u32, place as u32);
            }
        }
        progress.add(self.rows.len())?;
        let begins = self.sort_entries(&home, nodes.len());
        let mut local = vec![0; self.order];
        for (k, node) in nodes.iter().enumerate() {
            for (place, &unknown) in node.unknowns.iter().enumerate() {
                local[unknown as usize] = place as u32;
            }
            let entries = begins[k]..begins[k + 1];
            progress.add(node.unknowns.len() + entries.len())?;
            for entry in &mut self.entries[entries.clone()] {
                let (row, col) = (entry.row as usize, entry.column as usize);
                let (a, b) = (local[row], local[col]);
                (entry.row, entry.column) = (a.max(b), a.min(b));
            }
            let children = self.children.len();
            self.children.extend(&node.children);
            for &child in &node.children {
                let begin = self.places.len();
                let below = self.list[child as usize].unknowns.clone();
                let below = below.start + nodes[child as usize].columns..below.end;
                let of_parent = self.unknowns[below].iter().map(|&i| local[i as usize]);
                self.places.extend(of_parent);
                self.list[child as usize].places = begin..self.places.len();
                self.list[child as usize].is_root = false;
            }
            let begin = self.unknowns.len();
            self.unknowns.extend(&node.unknowns);
            self.list.push(Front {
                unknowns: begin..self.unknowns.len(),
                columns: node.columns,
                children: children..self.children.len(),
                entries,
                places: 0..0,
                is_root: true,
            });
        }
        Ok(())
    }

    /// Sorts the entries by front and returns where those of each begin; their places are still those in the matrix.
    fn sort_entries(&mut self, home: &[(u32, u32)], fronts: usize) -> Vec<usize> {
        let front_of = |row: u32, col: u32| home[row as usize].min(home[col as usize]).0 as usize;
        let mut begins = vec![0; fronts + 1];
        for (&row, &col) in self.rows.iter().zip(&self.cols) {
            begins[front_of(row, col) + 1] += 1;
        }
        for k in 0..fronts {
            begins[k + 1] += begins[k];
        }
        let mut next = begins.clone();
        let nothing = FrontEntry {
            entry: 0,
            row: 0,
            column: 0,
        };
        self.entries.resize(self.rows.len(), nothing);
        for (entry, (&row, &column)) in self.rows.iter().zip(&self.cols).enumerate() {
            let place = &mut next[front_of(row, column)];
            self.entries[*place] = FrontEntry {
                entry: entry as u32,
                row,
                column,
            };
            *place += 1;
        }
        begins
    }
}
