//! Quality of the elements of a mesh: the sign of `det ∂x/∂ξ`, indices, repeated nodes.
//!
//! The determinant of a trilinear hexahedron at ξ is compared with that of a brick whose edges are as long as the three
//! columns of `∂x/∂ξ` there: the ratio is 1 for bricks of any proportions, 0 for a flat corner, −1 for a brick turned
//! inside out.

use super::error::{ElementName, MeshError, MeshPlace};
use super::{CORNERS, Mesh};
use crate::math::refuse;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Ratio below which an element counts as degenerate. It is also the part of the element's size that the length of a
/// column is at least taken for, so that an element whose thickness is rounding counts as flat.
const LIMIT: f64 = 1e-6;

impl Mesh {
    /// Checks that there is an element, that each one has eight nodes that exist, differ, are finite and are those of no
    /// other element, that its determinant is positive at the corners and at the Gauss points, and that regions and sets
    /// exist.
    ///
    /// # Errors
    /// One of these does not hold.
    pub fn check(&self) -> Result<(), MeshError> {
        self.check_elements(ElementName::Index)?;
        let (regions, elements) = (self.regions.len(), self.hexahedra.len());
        refuse!(if regions != elements, MeshPlace::Whole;
            found format!("{regions} regions of {elements} hexahedra"),
            expected "one region per hexahedron");
        let names = self.region_names.len();
        let beyond = self.regions.iter().find(|&&region| region >= names);
        refuse!(if let Some(region) = beyond, MeshPlace::Whole;
            found format!("region {region} of {names} names"), expected "a name for each region");
        let count = self.nodes.len();
        for (name, nodes) in &self.sets {
            let ascending = nodes.windows(2).all(|pair| pair[0] < pair[1]);
            let outside = nodes.iter().find(|&&node| node >= count);
            refuse!(if let Some(node) = outside, MeshPlace::Whole;
                found format!("node {node} in the set {name:?}"),
                expected format!("indices below the number of nodes, {count}"));
            refuse!(if !ascending, MeshPlace::Whole;
                found format!("a set {name:?} that is not sorted"),
                expected "ascending nodes, each once");
        }
        Ok(())
    }

    /// The part of [`check`](Self::check) that concerns elements, with names for them.
    pub(super) fn check_elements(
        &self,
        name: impl Fn(usize) -> ElementName,
    ) -> Result<(), MeshError> {
        refuse!(if self.hexahedra.is_empty(), MeshPlace::Whole;
            found "no element", expected "one hexahedron or more");
        let mut seen: HashMap<[usize; 8], usize> = HashMap::new();
        for (element, nodes) in self.hexahedra.iter().enumerate() {
            let mut sorted = *nodes;
            sorted.sort_unstable();
            let twin = seen.insert(sorted, element);
            if let Some((found, expected)) = self.fault(nodes, twin, &name) {
                let places = nodes.iter().filter_map(|&node| self.nodes.get(node));
                let place = MeshPlace::Element(name(element), places.copied().collect());
                return Err(place.wrong(found, expected));
            }
        }
        Ok(())
    }

    /// Returns the fault of an element as the values found and expected, if it has one; `twin` has the same nodes.
    fn fault(
        &self,
        nodes: &[usize; 8],
        twin: Option<usize>,
        name: &impl Fn(usize) -> ElementName,
    ) -> Option<(String, String)> {
        let count = self.nodes.len();
        if let Some(node) = nodes.iter().find(|&&node| node >= count) {
            let expected = format!("indices below the number of nodes, {count}");
            return Some((format!("node {node}"), expected));
        }
        let repeated = (1..8).find(|&corner| nodes[..corner].contains(&nodes[corner]));
        if let Some(corner) = repeated {
            let x = self.nodes[nodes[corner]];
            let found = format!("the node at ({}, {}, {}) repeated", x.x, x.y, x.z);
            return Some((found, "eight different nodes".to_owned()));
        }
        if let Some(twin) = twin {
            let found = format!("the nodes of {}", name(twin));
            return Some((found, "each hexahedron once, in one region".to_owned()));
        }
        let places = nodes.map(|node| self.nodes[node]);
        if let Some(x) = places.iter().find(|x| !x.iter().all(|x| x.is_finite())) {
            let found = format!("a node at ({}, {}, {})", x.x, x.y, x.z);
            return Some((found, "finite coordinates".to_owned()));
        }
        let (ratio, place) = smallest_ratio(&places);
        if ratio > LIMIT {
            return None;
        }
        let found = if ratio < -LIMIT {
            format!("an inverted element, with a determinant ratio of {ratio:.4} at {place}")
        } else {
            format!("a degenerate element, with a determinant ratio of {ratio:.1e} at {place}")
        };
        let expected = "a Jacobian determinant that is positive, more than 1e-6 of that of a brick with the same edges, \
             at all corners and Gauss points (nodes of the lower face counter-clockwise seen from above, then those of the \
             upper face above them)";
        Some((found, expected.to_owned()))
    }
}

/// The smallest ratio of determinants over the corners and the Gauss points of an element, and where.
fn smallest_ratio(places: &[Vector3<f64>; 8]) -> (f64, String) {
    // Differences in units of the largest one: neither large nor small lengths leave the range of numbers.
    let edges = places.map(|x| x - places[0]);
    let size = edges.iter().map(Vector3::amax).fold(0.0, f64::max);
    let scaled = edges.map(|edge| edge / size);
    let gauss = 1.0 / 3.0_f64.sqrt();
    let mut smallest = (f64::INFINITY, String::new());
    for (kind, at) in [("corner", 1.0), ("Gauss point", gauss)] {
        for (index, corner) in CORNERS.iter().enumerate() {
            let ratio = determinant_ratio(&scaled, &corner.map(|xi| at * xi));
            // A ratio that is not a number (all nodes at one place, or beyond the range of numbers) is no better than zero.
            let ratio = if ratio.is_nan() { 0.0 } else { ratio };
            if ratio < smallest.0 {
                smallest = (ratio, format!("{kind} {index}"));
            }
        }
    }
    smallest
}

/// `det(∂x/∂ξ) / Π_k |∂x/∂ξ_k|` with `∂x/∂ξ_k = Σ_a x_a s_ak/8 Π_{l≠k} (1 + s_al ξ_l)`, s the corners; x in units of the
/// element's size.
fn determinant_ratio(places: &[Vector3<f64>; 8], xi: &[f64; 3]) -> f64 {
    let column = |k: usize| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        let terms = places.iter().zip(&CORNERS).map(|(x, s)| {
            let weight = s[k] * (1.0 + s[l] * xi[l]) * (1.0 + s[m] * xi[m]) / 8.0;
            x * weight
        });
        let column: Vector3<f64> = terms.sum();
        column / column.norm().max(LIMIT)
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)]).determinant()
}
