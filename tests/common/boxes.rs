//! Matrices of springs between the nodes of boxes.
#![allow(dead_code, reason = "each test program uses some of these")]

use proboscis::sparse::multigrid::{Multigrid, NodeGrid};

/// A box of nodes with four unknowns each; those of the lowest plane are given.
pub(crate) fn grid(counts: [usize; 3], first: &mut u32) -> NodeGrid {
    let planes = counts.map(|count| (0..count).map(|plane| plane as f64).collect());
    let below = counts[0] * counts[1];
    let nodes = below * counts[2];
    let mut fresh = |node: usize| {
        (node >= below).then(|| {
            *first += 1;
            *first - 1
        })
    };
    let unknowns = (0..nodes).map(|node| [0; 4].map(|_| fresh(node)));
    NodeGrid {
        has_pressures: false,
        planes,
        unknowns: unknowns.collect(),
    }
}

/// Springs between neighbours along the axes: displacements pull, potentials push, and both are coupled, without symmetry.
pub(crate) fn entries(grid: &NodeGrid) -> Vec<((usize, usize), f64)> {
    let [n_x, n_y, n_z] = [0, 1, 2].map(|axis| grid.planes[axis].len());
    let mut entries = Vec::new();
    let mut add = |row: Option<u32>, col: Option<u32>, value: f64| {
        if let (Some(row), Some(col)) = (row, col) {
            entries.push(((row as usize, col as usize), value));
        }
    };
    for node in 0..n_x * n_y * n_z {
        let at = [node % n_x, node / n_x % n_y, node / (n_x * n_y)];
        let steps = [(0, 1, n_x), (1, n_x, n_y), (2, n_x * n_y, n_z)];
        for (axis, stride, count) in steps {
            if at[axis] + 1 == count {
                continue;
            }
            let ends = [grid.unknowns[node], grid.unknowns[node + stride]];
            for component in 0..4 {
                let stiffness = match component {
                    3 => -2.0,
                    _ if component == axis => 3.0,
                    _ => 1.0,
                };
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let sign = if i == j { 1.0 } else { -1.0 };
                    add(ends[i][component], ends[j][component], sign * stiffness);
                    add(ends[i][component], ends[j][3 - component], 0.1 * sign);
                    add(
                        ends[i][component],
                        ends[j][component],
                        0.05 * (j as f64 - i as f64),
                    );
                }
            }
        }
    }
    entries
}

/// A solver that has taken the matrix of these grids.
pub(crate) fn solver(size: usize, grids: &[NodeGrid]) -> Multigrid {
    let mut solver = Multigrid::new(size, grids, &[]).unwrap();
    fill(&mut solver, grids);
    solver.take_values().unwrap();
    solver
}

/// Writes the matrix of these grids.
pub(crate) fn fill(solver: &mut Multigrid, grids: &[NodeGrid]) {
    solver.values_mut().fill(0.0);
    for ((row, col), value) in grids.iter().flat_map(entries) {
        let slot = solver.slot(row, col).unwrap();
        solver.values_mut()[slot] += value;
    }
}
