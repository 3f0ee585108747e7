//! The linear system of a block under a voltage, displacements and potentials together, by GMRES with multigrid, and as files for other solvers.
//!
//! `cargo bench --bench coupled -- FOLDER 16` finds the equilibrium of 16 × 16 × 64 elements under a field of 30 MV/m, solves its tangent for
//! weights across the block to a residual of 1e-8, and writes both with the solution for `benches/peers/coupled_block.py`: entries as rows,
//! columns and values, of each unknown its place in mm and its component (3 is the potential). Rows and columns have factors that make the mean
//! of the diagonal one, of displacements and of potentials.

use nalgebra::DVector;
use proboscis::dynamics::{MultigridUse, Start, stable_equilibrium_by};
use proboscis::functional::{Order, Sample};
use proboscis::model::Model;
use proboscis::sparse::multigrid::{Multigrid, NodeMesh};
use shared::block;
use std::path::Path;
use std::time::Instant;

mod shared;

/// Voltage in V over layers of 10 mm.
const VOLTAGE: f64 = 3e5;
/// Residual relative to that of zero.
const RESIDUAL: f64 = 1e-8;

fn main() {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    let [folder, n] = &words[..] else {
        eprintln!("needs a folder, and the number n of n × n × 4n elements");
        std::process::exit(2);
    };
    let n: usize = n.parse().expect("a number of elements");
    let model = Model::new(block(n, None), None, 1.0, &[]).unwrap();
    let mut system = Coupled::at_rest(&model);
    system.scale();
    let rhs = system.weights();
    let on_grid = model.node_grids().unwrap().boxes;
    let mesh = without_grid(&model);
    let size = system.size;
    let solver = || Multigrid::new(size, &on_grid, &[]).unwrap();
    let solution = solve("multigrid on the grid", solver, &system, &rhs);
    let solver = || Multigrid::new(size, &[], &[mesh]).unwrap();
    solve("multigrid by smoothed aggregation", solver, &system, &rhs);
    system.write(Path::new(folder), [&rhs, &solution]);
}

/// A symmetric matrix with the places of its unknowns.
struct Coupled {
    entries: Vec<(usize, usize, f64)>,
    /// Node and component of each unknown.
    components: Vec<(usize, usize)>,
    places: Vec<[f64; 3]>,
    size: usize,
}

impl Coupled {
    /// Second derivatives of the potential energy at the equilibrium under the voltage.
    fn at_rest(model: &Model) -> Self {
        let start = Start::at_rest(model, model.coordinates_at(&[]));
        let rest =
            stable_equilibrium_by(model, &start.z, &[VOLTAGE], MultigridUse::Always).unwrap();
        let (action, layout) = (&model.action, model.action.layout());
        let mut ends = [action.map.placed(&rest.z), action.map.placed(&rest.z)];
        let interval = Sample::of_interval(&rest.scalars, 1.0);
        let mut scratch = action.scratch(Order::Hessian);
        let mut values = vec![0.0; layout.values(1)];
        let [a, b] = &mut ends;
        action.evaluate_at_rest([&mut *a, &mut *b], &interval, &mut scratch, None);
        let order = Order::Hessian;
        action.pull_back_interval(order, [a, b], &interval, 0, &mut scratch, &mut values);
        // The action is minus the energy.
        let sum = |at: &[usize], slot: usize| -at.iter().map(|at| values[at + slot]).sum::<f64>();
        let mut entries = Vec::new();
        let same = [layout.same_at(0), layout.same_at(1)];
        for (slot, (i, j)) in layout.same.entries().enumerate() {
            entries.push((i, j, sum(&same, slot)));
        }
        let cross = [layout.lower_at(0), layout.upper_at(0)];
        for (slot, (i, j)) in layout.cross.entries().enumerate() {
            entries.push((i, j, sum(&cross, slot)));
        }
        let mixed = [layout.mixed_at(0, 0), layout.mixed_at(0, 1)];
        for (slot, (i, s)) in layout.mixed.entries().enumerate() {
            if let Some(s) = model.variables.place(s) {
                let value = sum(&mixed, slot);
                entries.extend([(i, s, value), (s, i, value)]);
            }
        }
        for (slot, (s, t)) in layout.scalars.entries().enumerate() {
            if let (Some(i), Some(j)) = (model.variables.place(s), model.variables.place(t)) {
                let value = sum(&[layout.scalars_at(0)], slot);
                entries.push((i, j, value));
                if i != j {
                    entries.push((j, i, value));
                }
            }
        }
        let grid = &model.node_grids().unwrap().boxes[0];
        let size = model.variables.unknown_count();
        let mut components = vec![(0, 0); size];
        for (node, unknowns) in grid.unknowns.iter().enumerate() {
            for (component, unknown) in unknowns.iter().enumerate() {
                if let Some(unknown) = unknown {
                    components[*unknown as usize] = (node, component);
                }
            }
        }
        let nodes = &model.solids[0].solid.mesh.nodes;
        let places = components.iter().map(|&(node, _)| nodes[node].into());
        Self {
            entries,
            places: places.collect(),
            components,
            size,
        }
    }

    /// Makes the mean size of the diagonal one, of displacements and of potentials.
    fn scale(&mut self) {
        let mut sums = [(0.0, 0.0); 2];
        let kind = |unknown: usize| usize::from(self.components[unknown].1 == 3);
        let mut diagonal = vec![0.0; self.size];
        for &(i, j, value) in &self.entries {
            if i == j {
                diagonal[i] += value;
            }
        }
        for (i, value) in diagonal.iter().enumerate() {
            let (sum, count) = sums[kind(i)];
            sums[kind(i)] = (sum + value.abs(), count + 1.0);
        }
        let factors = sums.map(|(sum, count): (f64, f64)| (count / sum).sqrt());
        for (i, j, value) in &mut self.entries {
            *value *= factors[kind(*i)] * factors[kind(*j)];
        }
    }

    /// A force of one across the block at each node, and no charge.
    fn weights(&self) -> Vec<f64> {
        let across = |&(_, component): &(usize, usize)| f64::from(u8::from(component == 0));
        self.components.iter().map(across).collect()
    }

    /// Residual of a solution relative to the right-hand side.
    fn residual(&self, rhs: &[f64], x: &[f64]) -> f64 {
        let mut left = DVector::from_column_slice(rhs);
        for &(i, j, value) in &self.entries {
            left[i] -= value * x[j];
        }
        left.norm() / DVector::from_column_slice(rhs).norm()
    }

    /// Writes all as arrays of NumPy.
    fn write(&self, folder: &Path, [rhs, solution]: [&[f64]; 2]) {
        std::fs::create_dir_all(folder).unwrap();
        let integers = |name: &str, values: &mut dyn Iterator<Item = usize>| {
            let bytes: Vec<u8> = values.flat_map(|v| (v as u32).to_le_bytes()).collect();
            write_array(&folder.join(name), "<u4", bytes);
        };
        let numbers = |name: &str, values: &mut dyn Iterator<Item = f64>| {
            let bytes: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
            write_array(&folder.join(name), "<f8", bytes);
        };
        integers("rows.npy", &mut self.entries.iter().map(|&(row, ..)| row));
        integers(
            "columns.npy",
            &mut self.entries.iter().map(|&(_, column, _)| column),
        );
        integers(
            "components.npy",
            &mut self.components.iter().map(|&(_, of)| of),
        );
        numbers(
            "values.npy",
            &mut self.entries.iter().map(|&(.., value)| value),
        );
        numbers("places.npy", &mut self.places.iter().flatten().copied());
        numbers("rhs.npy", &mut rhs.iter().copied());
        numbers("solution.npy", &mut solution.iter().copied());
    }
}

/// The nodes of the block as those of a mesh without a grid.
fn without_grid(model: &Model) -> NodeMesh {
    let mesh = &model.solids[0].solid.mesh;
    let elements = mesh.hexahedra.iter();
    NodeMesh {
        places: mesh.nodes.iter().map(|&node| node.into()).collect(),
        elements: elements
            .map(|of| of.map(|node| node as u32).to_vec())
            .collect(),
        unknowns: model.node_grids().unwrap().boxes[0].unknowns.clone(),
        shortest_edge: mesh.shortest_edge(),
        has_pressures: false,
    }
}

/// The solution by multigrid; tells what it took.
fn solve(
    name: &str,
    solver: impl FnOnce() -> Multigrid,
    system: &Coupled,
    rhs: &[f64],
) -> Vec<f64> {
    let began = Instant::now();
    let mut solver = solver();
    let patterns = began.elapsed().as_secs_f64();
    for &(i, j, value) in &system.entries {
        let slot = solver.slot(i, j).expect("nodes of one element");
        solver.values_mut()[slot] += value;
    }
    let began = Instant::now();
    solver.take_values().unwrap();
    let setup = began.elapsed().as_secs_f64();
    let mut x = rhs.to_vec();
    let began = Instant::now();
    let solved = solver.solve(&mut x, RESIDUAL, &|| false);
    let seconds = began.elapsed().as_secs_f64();
    assert_eq!(solved, Ok(Ok(())));
    println!(
        "| proboscis, {name} | {} | {} | {patterns:.2} + {setup:.2} | {seconds:.2} | {:.1e} |",
        system.size,
        solver.counted().iterations,
        system.residual(rhs, &x),
    );
    x
}

/// Writes an array of one dimension in the format of NumPy, version 1.0.
fn write_array(path: &Path, kind: &str, bytes: Vec<u8>) {
    let width: usize = kind[2..].parse().unwrap();
    let shape = format!(
        "{{'descr': '{kind}', 'fortran_order': False, 'shape': ({},), }}",
        bytes.len() / width
    );
    let header = format!("{shape:<117}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(bytes);
    std::fs::write(path, file).unwrap();
}
