//! Nested dissection of boxes of nodes.

use std::collections::BTreeSet;

use crate::sparse::Symmetry;
use crate::sparse::dissection::Dissection;
use crate::sparse::pattern::Pattern;

/// A box of nodes with two unknowns each, coupled to all nodes around them, and one unknown without a place, coupled to all.
fn grid(nodes: [usize; 3]) -> (Pattern, Vec<Option<[f64; 3]>>) {
    let [nx, ny, nz] = nodes;
    let triples = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
    let triples: Vec<_> = triples.collect();
    let mut entries = Vec::new();
    for (a, p) in triples.iter().enumerate() {
        for (b, q) in triples.iter().enumerate() {
            if (0..3).all(|axis| p[axis].abs_diff(q[axis]) <= 1) {
                let couple = |i, j| (1 + 2 * a + i, 1 + 2 * b + j);
                entries.extend([couple(0, 0), couple(0, 1), couple(1, 0), couple(1, 1)]);
            }
        }
        entries.extend([(1 + 2 * a, 0), (2 + 2 * a, 0)]);
    }
    entries.push((0, 0));
    let place = |p: &[usize; 3]| Some([p[0] as f64, 1.5 * p[1] as f64, p[2] as f64 * 2.0]);
    let mut places = vec![None];
    places.extend(triples.iter().flat_map(|p| [place(p); 2]));
    let size = places.len();
    (
        Pattern::new(size, entries.into_iter(), Symmetry::Symmetric),
        places,
    )
}

/// Numbers below the diagonal of the factor, by elimination of one unknown after the other.
fn fill(pattern: &Pattern, order: &[usize]) -> usize {
    let mut neighbours = vec![BTreeSet::new(); pattern.size];
    for col in 0..pattern.size {
        for &row in &pattern.rows[pattern.slots(col)] {
            if row != col {
                neighbours[row].insert(col);
                neighbours[col].insert(row);
            }
        }
    }
    let mut count = 0;
    for &eliminated in order {
        let around = std::mem::take(&mut neighbours[eliminated]);
        count += around.len();
        for &i in &around {
            neighbours[i].extend(around.iter().filter(|&&j| j != i));
            neighbours[i].remove(&eliminated);
        }
    }
    count
}

#[test]
fn the_middle_plane_across_the_longest_direction_comes_last() {
    let (pattern, places) = grid([3, 4, 9]);
    let Dissection { order, parts } = Dissection::new(&pattern, &places);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..pattern.size));
    assert_eq!(order.last(), Some(&0), "what has no place");
    let plane = &order[pattern.size - 1 - 2 * 12..pattern.size - 1];
    assert!(plane.iter().all(|&row| places[row].unwrap()[2] == 8.0));
    let whole = parts.last().unwrap();
    assert_eq!(whole.own, pattern.size - 1 - 2 * 12..pattern.size);
    assert_eq!(whole.sides.unwrap()[1], parts.len() - 2);
}

#[test]
fn dissection_leaves_less_fill_than_the_order_of_the_nodes() {
    let (pattern, places) = grid([6, 6, 6]);
    let by_nodes: Vec<usize> = (1..pattern.size).chain([0]).collect();
    let [cut, band] =
        [Dissection::new(&pattern, &places).order, by_nodes].map(|order| fill(&pattern, &order));
    assert!(10 * cut < 9 * band, "{cut} {band}");
}
