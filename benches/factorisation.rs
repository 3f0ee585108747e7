//! Factorisations of the tangent of a dielectric block, against those of MUMPS, and GMRES with multigrid for the same matrix.
//!
//! `n × n × 4n` nodes of trilinear hexahedra carry three displacements and a potential each; displacements make a positive
//! block, potentials a negative one, and the face z = 0 is held. Without arguments n is 7 and 12; others are given as numbers:
//! `cargo bench --bench factorisation -- 17`. Numbers are the least of a few runs.

use proboscis::sparse::multigrid::{Multigrid, NodeGrid};
use proboscis::sparse::{Backend, Direct, Symmetry};
use std::time::Instant;

/// Unknowns of a node.
const NODE: usize = 4;
/// Steps to the neighbours of a node along one axis.
const STEPS: [isize; 3] = [-1, 0, 1];
/// Position of the Gauss points of an edge.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Lamé parameters, and the field along which the dielectric is stressed; permittivity 1.
const MATERIAL: (f64, f64, [f64; 3]) = (1.0, 10.0, [0.1, 0.2, 0.4]);
/// Sizes measured without arguments.
const SIZES: [usize; 2] = [7, 12];
/// Residual of an iteration relative to the right-hand side.
const RESIDUAL: f64 = 1e-8;
/// Seconds that are spent on the runs of one quantity.
const PATIENCE: f64 = 2.0;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    println!(
        "| unknowns | entries | method      | analysis, s | factorisation, s | solution, s | factorisation / MUMPS | error |\n\
         |---------:|--------:|:------------|------------:|-----------------:|------------:|----------------------:|------:|"
    );
    for n in if given.is_empty() {
        SIZES.to_vec()
    } else {
        given
    } {
        table(n);
    }
}

fn table(n: usize) {
    let (size, entries, values) = tangent(n);
    for symmetry in [Symmetry::Symmetric, Symmetry::Unsymmetric] {
        let mut reference = f64::NAN;
        for backend in [Backend::Mumps, Backend::Faer] {
            let clock = Instant::now();
            let mut solver = Direct::with(size, &entries, symmetry, Some(backend));
            let analysis = clock.elapsed().as_secs_f64();
            let factorisation = least(|| solver.factor(&values).expect("a regular matrix"));
            let rhs = product(size, &entries, &values);
            let mut x = rhs.clone();
            let solution = least(|| {
                x.copy_from_slice(&rhs);
                solver.solve(&mut x);
            });
            let error = error(&x);
            if backend == Backend::Mumps {
                reference = factorisation;
            }
            println!(
                "| {size:8} | {:7} | {:<11} | {analysis:11.3} | {factorisation:16.3} | {solution:11.4} | {:21.2} | {error:5.0e} |",
                entries.len(),
                solver.method(),
                factorisation / reference,
            );
        }
    }
    iterate(n, &entries, &values);
}

/// A solution that is known.
fn known(i: usize) -> f64 {
    (i as f64).sin()
}

/// The right-hand side that belongs to it.
fn product(size: usize, entries: &[(usize, usize)], values: &[f64]) -> Vec<f64> {
    let mut rhs = vec![0.0; size];
    for (&(row, col), value) in entries.iter().zip(values) {
        rhs[row] += value * known(col);
    }
    rhs
}

/// Greatest distance from it.
fn error(x: &[f64]) -> f64 {
    let errors = x.iter().enumerate().map(|(i, x)| (x - known(i)).abs());
    errors.fold(0.0, f64::max)
}

/// Grids, and a solution to a small residual, of the same matrix.
fn iterate(n: usize, entries: &[(usize, usize)], values: &[f64]) {
    let held = n * n;
    let nodes = held * 4 * n;
    let size = NODE * (nodes - held);
    let clock = Instant::now();
    let unknown = |node: usize, component: usize| {
        let node = node.checked_sub(held)?;
        Some((NODE * node + component) as u32)
    };
    let grid = NodeGrid {
        planes: [n, n, 4 * n].map(|count| (0..count).map(|plane| plane as f64).collect()),
        unknowns: (0..nodes)
            .map(|node| [0, 1, 2, 3].map(|component| unknown(node, component)))
            .collect(),
        has_pressures: false,
    };
    let mut solver = Multigrid::new(size, &[grid], &[]).expect("few nodes");
    let slots = entries.iter().map(|&(row, col)| solver.slot(row, col));
    let slots: Vec<usize> = slots
        .map(|slot| slot.expect("neighbours alone are coupled"))
        .collect();
    let analysis = clock.elapsed().as_secs_f64();
    let making = least(|| {
        solver.forget();
        solver.values_mut().fill(0.0);
        for (&slot, value) in slots.iter().zip(values) {
            solver.values_mut()[slot] += value;
        }
        solver.take_values().expect("a regular matrix");
    });
    let rhs = product(size, entries, values);
    let mut x = rhs.clone();
    let mut iterations = 0;
    let solution = least(|| {
        x.copy_from_slice(&rhs);
        solver.counted();
        let solved = solver.solve(&mut x, RESIDUAL, &|| false);
        solved.expect("nothing stops it").expect("it converges");
        iterations = solver.counted().iterations;
    });
    println!(
        "| {size:8} | {:7} | multigrid, {iterations} iterations to {RESIDUAL:.0e} | {analysis:11.3} | {making:16.3} | {solution:11.4} | | {:5.0e} |",
        entries.len(),
        error(&x),
    );
}

/// The least duration of a few runs.
fn least(mut run: impl FnMut()) -> f64 {
    let began = Instant::now();
    let mut least = f64::INFINITY;
    for _ in 0..20 {
        let clock = Instant::now();
        run();
        least = least.min(clock.elapsed().as_secs_f64());
        if began.elapsed().as_secs_f64() > PATIENCE {
            break;
        }
    }
    least
}

/// Size, entries and values of the tangent.
fn tangent(n: usize) -> (usize, Vec<(usize, usize)>, Vec<f64>) {
    let shape = [n, n, 4 * n];
    let node = |at: [usize; 3]| at[0] + n * (at[1] + n * at[2]);
    let nodes = n * n * 4 * n;
    let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2 & 1];
    let element = element();
    // One block per node and neighbour.
    let mut blocks = vec![[0.0; NODE * NODE]; 27 * nodes];
    for z in 0..shape[2] - 1 {
        for y in 0..n - 1 {
            for x in 0..n - 1 {
                for (a, blocks_of_a) in element.iter().enumerate() {
                    let [i, j, k] = corner(a);
                    let row = node([x + i, y + j, z + k]);
                    for (b, part) in blocks_of_a.iter().enumerate() {
                        let [p, q, r] = corner(b);
                        let neighbour = (p + 1 - i) + 3 * ((q + 1 - j) + 3 * (r + 1 - k));
                        let block = &mut blocks[27 * row + neighbour];
                        for (value, part) in block.iter_mut().zip(part) {
                            *value += part;
                        }
                    }
                }
            }
        }
    }
    let held = n * n;
    let (mut entries, mut values) = (Vec::new(), Vec::new());
    for row in held..nodes {
        let at = [row % n, row / n % n, row / (n * n)];
        for neighbour in 0..27 {
            let steps = [neighbour % 3, neighbour / 3 % 3, neighbour / 9].map(|s| STEPS[s]);
            let there: Option<Vec<usize>> = (0..3)
                .map(|i| at[i].checked_add_signed(steps[i]).filter(|&c| c < shape[i]))
                .collect();
            let Some(there) = there else { continue };
            let col = node([there[0], there[1], there[2]]);
            if col < held {
                continue;
            }
            for (slot, &value) in blocks[27 * row + neighbour].iter().enumerate() {
                let (i, j) = (slot / NODE, slot % NODE);
                entries.push((NODE * (row - held) + i, NODE * (col - held) + j));
                values.push(value);
            }
        }
    }
    (NODE * (nodes - held), entries, values)
}

/// Blocks `∂²/∂(u, φ)_a ∂(u, φ)_b` of ½λ (tr ε)² + μ ε:ε − ½|∇φ|² + ∇φ·ε E on the unit cube.
fn element() -> [[[f64; NODE * NODE]; 8]; 8] {
    let (mu, lambda, field) = MATERIAL;
    let mut blocks = [[[0.0; NODE * NODE]; 8]; 8];
    for point in 0..8 {
        let at = [
            GAUSS[point & 1],
            GAUSS[point >> 1 & 1],
            GAUSS[point >> 2 & 1],
        ];
        let gradient = |a: usize| -> [f64; 3] {
            std::array::from_fn(|axis| {
                let factor = |i: usize| {
                    let upper = a >> i & 1 == 1;
                    match (i == axis, upper) {
                        (true, true) => 1.0,
                        (true, false) => -1.0,
                        (false, true) => at[i],
                        (false, false) => 1.0 - at[i],
                    }
                };
                factor(0) * factor(1) * factor(2)
            })
        };
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (a, blocks) in blocks.iter_mut().enumerate() {
            for (b, block) in blocks.iter_mut().enumerate() {
                let (g, h) = (gradient(a), gradient(b));
                let inner = dot(&g, &h);
                for i in 0..3 {
                    for j in 0..3 {
                        block[NODE * i + j] += (lambda * g[i] * h[j] + mu * g[j] * h[i]) / 8.0;
                    }
                    block[NODE * i + i] += mu * inner / 8.0;
                    // ∇φ·ε E with 2ε = u⊗g + g⊗u.
                    let couple = |g: &[f64; 3], h: &[f64; 3]| {
                        0.5 * (h[i] * dot(g, &field) + inner * field[i]) / 8.0
                    };
                    block[NODE * i + 3] += couple(&g, &h);
                    block[NODE * 3 + i] += couple(&h, &g);
                }
                block[NODE * 3 + 3] -= inner / 8.0;
            }
        }
    }
    blocks
}
