//! Surfaces of quadratic triangles, for membranes: flat triangles of a plane or of an octahedron, with their nodes moved to their places by a map.

use super::Mesh;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_3, TAU};

/// Part of the largest coordinate within which two places are one node.
const SAME: f64 = 1e-9;

/// A surface about the z axis.
#[derive(Clone, Debug)]
pub enum Surface {
    /// A rectangle in the plane z = 0 with its first corner at the origin: planes of nodes along x and y.
    Rectangle([Vec<f64>; 2]),
    /// A disc, by radii of rings of nodes from zero on.
    Disc(Vec<f64>),
    /// A ring, by radii of rings of nodes, and the number of elements around it.
    Annulus(Vec<f64>, usize),
    /// A tube from z = 0 on, by its radius, the number of elements around it, and planes of nodes along its axis.
    Tube(f64, usize, Vec<f64>),
    /// A sphere, by its radius and the number of elements along each edge of an octahedron.
    Sphere(f64, usize),
}

/// Corners of a flat triangle, and the number of its cell along each of two directions.
type Flat = ([Vector3<f64>; 3], [usize; 2]);

/// Triangles of the cells of a grid of so many cells each way; diagonals turn from cell to cell, so that no direction is preferred.
fn grid(cells: [usize; 2]) -> Vec<Flat> {
    let cell = |[i, j]: [usize; 2]| {
        let at = |a: usize, b: usize| Vector3::new((i + a) as f64, (j + b) as f64, 0.0);
        let corners = match (i + j) % 2 {
            0 => [
                [at(0, 0), at(1, 0), at(1, 1)],
                [at(0, 0), at(1, 1), at(0, 1)],
            ],
            _ => [
                [at(0, 0), at(1, 0), at(0, 1)],
                [at(1, 0), at(1, 1), at(0, 1)],
            ],
        };
        corners.map(|corners| (corners, [i, j]))
    };
    let cells = (0..cells[1]).flat_map(|j| (0..cells[0]).map(move |i| [i, j]));
    cells.flat_map(cell).collect()
}

/// A triangle from its first corner, cut into n² equal ones in rows from there; the number of a row is that of the cell.
fn rows([first, second, third]: [Vector3<f64>; 3], n: usize) -> Vec<Flat> {
    let [along, across] = [second - first, third - second].map(|edge| edge / n as f64);
    let at = |i: usize, j: usize| first + along * i as f64 + across * j as f64;
    let row = |i: usize| {
        let outward = (0..=i).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
        let inward = (0..i).map(move |j| [at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        outward.chain(inward).map(move |corners| (corners, [i, 0]))
    };
    (0..n).flat_map(row).collect()
}

/// The place between planes of nodes that a number of planes counts to.
fn between(planes: &[f64], count: f64) -> f64 {
    let last = (count.floor() as usize).min(planes.len() - 2);
    planes[last] + (planes[last + 1] - planes[last]) * (count - last as f64)
}

fn turned(radius: f64, angle: f64) -> Vector3<f64> {
    Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
}

impl Surface {
    /// Cells along each of two directions: regions follow one of them.
    pub fn cells(&self) -> [usize; 2] {
        match self {
            Self::Rectangle([x, y]) => [x.len() - 1, y.len() - 1],
            Self::Disc(radii) => [radii.len() - 1, 1],
            Self::Annulus(radii, around) => [radii.len() - 1, *around],
            Self::Tube(_, around, z) => [*around, z.len() - 1],
            Self::Sphere(_, edge) => [*edge, 1],
        }
    }

    fn flat(&self) -> Vec<Flat> {
        match self {
            Self::Disc(radii) => {
                let corner = |k: usize| turned((radii.len() - 1) as f64, k as f64 * FRAC_PI_3);
                let sector = |k| [Vector3::zeros(), corner(k), corner(k + 1)];
                let sectors = (0..6).map(sector);
                sectors
                    .flat_map(|sector| rows(sector, radii.len() - 1))
                    .collect()
            }
            Self::Sphere(_, edge) => {
                let axes = [Vector3::x(), Vector3::y(), -Vector3::x(), -Vector3::y()];
                let face = |(side, up): (usize, bool)| {
                    let [a, b] = [axes[side], axes[(side + 1) % 4]];
                    if up {
                        [Vector3::z(), a, b]
                    } else {
                        [-Vector3::z(), b, a]
                    }
                };
                let faces = (0..4).flat_map(|side| [true, false].map(|up| (side, up)));
                faces.flat_map(|of| rows(face(of), *edge)).collect()
            }
            _ => grid(self.cells()),
        }
    }

    /// The place of a point of the flat triangles.
    fn place(&self, at: &Vector3<f64>) -> Vector3<f64> {
        let angle = |count: f64, around: &usize| TAU * count / *around as f64;
        match self {
            Self::Rectangle([x, y]) => Vector3::new(between(x, at.x), between(y, at.y), 0.0),
            Self::Disc(radii) => {
                // The number of the hexagon that the point lies on.
                let sides = (0..6).map(|k| at.dot(&turned(1.0, (k as f64 + 0.5) * FRAC_PI_3)));
                let count = sides.fold(0.0, f64::max) / (FRAC_PI_3 / 2.0).cos();
                at * (between(radii, count.clamp(0.0, (radii.len() - 1) as f64))
                    / at.norm().max(SAME))
            }
            Self::Annulus(radii, around) => turned(between(radii, at.x), angle(at.y, around)),
            Self::Tube(radius, around, z) => {
                turned(*radius, angle(at.x, around)) + Vector3::z() * between(z, at.y)
            }
            Self::Sphere(radius, _) => at.normalize() * *radius,
        }
    }

    /// Names and points of its edges among the flat triangles.
    fn edges(&self) -> Vec<(&'static str, [Option<f64>; 2])> {
        let [x, y] = self.cells().map(|cells| cells as f64);
        let (along_x, along_y) = (|at| [Some(at), None], |at| [None, Some(at)]);
        match self {
            Self::Rectangle(_) => vec![
                ("x_min", along_x(0.0)),
                ("x_max", along_x(x)),
                ("y_min", along_y(0.0)),
                ("y_max", along_y(y)),
            ],
            Self::Annulus(..) => vec![("inner", along_x(0.0)), ("outer", along_x(x))],
            Self::Tube(..) => vec![("z_min", along_y(0.0)), ("z_max", along_y(y))],
            Self::Disc(_) | Self::Sphere(..) => Vec::new(),
        }
    }

    /// The mesh in one region. Sets are its edges (`x_min` …; `inner` and `outer`; `z_min` and `z_max`; `edge`), and `surface`, all of it.
    /// Normals point along z or outwards. Returns the number of the cell of each element too.
    pub fn mesh(&self) -> (Mesh, Vec<[usize; 2]>) {
        let flat = self.flat();
        let mut mesh = Mesh {
            region_names: vec!["surface".to_owned()],
            regions: vec![0; flat.len()],
            ..Mesh::default()
        };
        let size = flat.iter().flat_map(|(corners, _)| corners);
        let size = size.map(|at| self.place(at).amax()).fold(0.0, f64::max);
        let (mut known, edges) = (FxHashMap::default(), self.edges());
        let mut sets: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (corners, _) in &flat {
            let [a, b, c] = *corners;
            let points = [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (a + c) / 2.0];
            mesh.triangles.push(points.map(|at| {
                let place = self.place(&at);
                let key = place.map(|x| (x / (SAME * size)).round() as i64);
                let node = *known.entry([key.x, key.y, key.z]).or_insert_with(|| {
                    mesh.nodes.push(place);
                    mesh.nodes.len() - 1
                });
                let is_on = |wanted: &[Option<f64>; 2]| {
                    let pairs = wanted.iter().zip([at.x, at.y]);
                    pairs
                        .into_iter()
                        .all(|(wanted, at)| wanted.is_none_or(|wanted| wanted == at))
                };
                for (name, _) in edges.iter().filter(|(_, wanted)| is_on(wanted)) {
                    sets.entry((*name).to_owned()).or_default().push(node);
                }
                node
            }));
        }
        if let Self::Disc(_) = self {
            let is_outside = |node: &usize| mesh.nodes[*node].norm() > size * (1.0 - SAME);
            sets.insert(
                "edge".to_owned(),
                (0..mesh.nodes.len()).filter(is_outside).collect(),
            );
        }
        sets.insert("surface".to_owned(), (0..mesh.nodes.len()).collect());
        for set in sets.values_mut() {
            set.sort_unstable();
            set.dedup();
        }
        mesh.sets = sets;
        (mesh, flat.into_iter().map(|(_, cell)| cell).collect())
    }
}
