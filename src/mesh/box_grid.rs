//! Recognition of meshes whose nodes are those of a box grid, wherever the box stands.

use super::Mesh;

impl Mesh {
    /// Places of the node planes along the edges of a box from its first node on, where the mesh is a box grid whose nodes count along one
    /// edge first, then along the second and the third.
    pub fn box_planes(&self) -> Option<[Vec<f64>; 3]> {
        let [origin, x, _, y, z, ..] = *self.hexahedra.first()?;
        let steps = [x, y, z].map(|node| node.checked_sub(origin));
        let [Some(1), Some(n_x), Some(n_xy)] = steps else {
            return None;
        };
        let whole =
            |all: usize, part: usize| (part > 0 && all.is_multiple_of(part)).then(|| all / part);
        let counts = [n_x, whole(n_xy, n_x)?, whole(self.nodes.len(), n_xy)?];
        let cells: usize = counts.iter().map(|count| count.saturating_sub(1)).product();
        if origin != 0 || cells != self.hexahedra.len() {
            return None;
        }
        let [cells_x, cells_y] = [counts[0] - 1, counts[1] - 1];
        let is_cell = |(cell, nodes): (usize, &[usize; 8])| {
            let [i, j, k] = [
                cell % cells_x,
                cell / cells_x % cells_y,
                cell / (cells_x * cells_y),
            ];
            let first = i + n_x * j + n_xy * k;
            let lower = [first, first + 1, first + 1 + n_x, first + n_x];
            nodes[..4] == lower && nodes[4..] == lower.map(|node| node + n_xy)
        };
        if !self.hexahedra.iter().enumerate().all(is_cell) {
            return None;
        }
        let strides = [1, n_x, n_xy];
        Some([0, 1, 2].map(|axis| {
            let node = |plane: usize| self.nodes[plane * strides[axis]];
            let mut place = 0.0;
            let mut planes = vec![0.0];
            for plane in 1..counts[axis] {
                place += (node(plane) - node(plane - 1)).norm();
                planes.push(place);
            }
            planes
        }))
    }
}
