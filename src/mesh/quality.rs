//! Quality of the elements of a mesh: the sign of `det ∂x/∂ξ`, indices, repeated nodes.
//!
//! The determinant of a trilinear hexahedron at ξ is compared with that of a brick whose edges are as long as the three
//! columns of `∂x/∂ξ` there: the ratio is 1 for bricks of any proportions, 0 for a flat corner, −1 for a brick turned
//! inside out.

use super::Mesh;
use super::cell::Cell;
use super::error::{ElementName, MeshError, MeshPlace};
use super::interpolation::{Element, Interpolation, Parent};
use crate::math::refuse;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Ratio below which an element counts as degenerate. It is also the part of the element's size that the length of a
/// column is at least taken for, so that an element whose thickness is rounding counts as flat.
const LIMIT: f64 = 1e-6;

impl Mesh {
    /// Checks that there is an element, that each one has nodes that exist, differ, are finite and are those of no
    /// other element, that its determinant is positive at the corners and at the Gauss points, and that regions and sets
    /// exist.
    ///
    /// # Errors
    /// One of these does not hold.
    pub fn check(&self) -> Result<(), MeshError> {
        let kind = self.cell().name();
        let kinds = [
            self.hexahedra.len(),
            self.tetrahedra.len(),
            self.triangles.len(),
        ];
        refuse!(if kinds.iter().filter(|&&count| count > 0).count() > 1, MeshPlace::Whole;
            found "elements of several kinds", expected "elements of one kind");
        self.check_elements(|number| ElementName::Number(kind, number))?;
        let (regions, elements) = (self.regions.len(), self.element_count());
        refuse!(if regions != elements, MeshPlace::Whole;
            found format!("{regions} regions of {elements} elements"),
            expected "one region per element");
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
        refuse!(if self.element_count() == 0, MeshPlace::Whole;
            found "no element", expected "one element or more");
        let mut seen: HashMap<Vec<usize>, usize> = HashMap::new();
        for (element, nodes) in self.elements().enumerate() {
            let mut sorted = nodes.to_vec();
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
        nodes: &[usize],
        twin: Option<usize>,
        name: &impl Fn(usize) -> ElementName,
    ) -> Option<(String, String)> {
        let count = self.nodes.len();
        if let Some(node) = nodes.iter().find(|&&node| node >= count) {
            let expected = format!("indices below the number of nodes, {count}");
            return Some((format!("node {node}"), expected));
        }
        let repeated = (1..nodes.len()).find(|&corner| nodes[..corner].contains(&nodes[corner]));
        if let Some(corner) = repeated {
            let x = self.nodes[nodes[corner]];
            let found = format!("the node at ({}, {}, {}) repeated", x.x, x.y, x.z);
            return Some((found, format!("{} different nodes", nodes.len())));
        }
        if let Some(twin) = twin {
            let found = format!("the nodes of {}", name(twin));
            return Some((found, "each element once, in one region".to_owned()));
        }
        let places: Vec<_> = nodes.iter().map(|&node| self.nodes[node]).collect();
        if let Some(x) = places.iter().find(|x| !x.iter().all(|x| x.is_finite())) {
            let found = format!("a node at ({}, {}, {})", x.x, x.y, x.z);
            return Some((found, "finite coordinates".to_owned()));
        }
        let (ratio, place) = match Cell::of(nodes) {
            Cell::Hexahedron => smallest_ratio::<8>(&places),
            Cell::Tetrahedron => smallest_ratio::<10>(&places),
            Cell::Triangle => smallest_ratio_of_areas(&places),
        };
        if ratio > LIMIT {
            return None;
        }
        let found = if ratio < -LIMIT {
            format!("an inverted element, with a determinant ratio of {ratio:.4} at {place}")
        } else {
            format!("a degenerate element, with a determinant ratio of {ratio:.1e} at {place}")
        };
        let order = match Cell::of(nodes) {
            Cell::Hexahedron => {
                "nodes of the lower face counter-clockwise seen from above, then those of the upper face above them"
            }
            Cell::Tetrahedron => {
                "three corners counter-clockwise seen from the fourth, then it, then the middles of the edges"
            }
            Cell::Triangle => "three corners, then the middles of the edges",
        };
        let expected = format!(
            "a Jacobian determinant that is positive, more than 1e-6 of that of a brick with the same edges, \
             at all nodes and Gauss points ({order})"
        );
        Some((found, expected))
    }
}

/// The smallest ratio of determinants over the nodes and the Gauss points of an element, and where.
fn smallest_ratio<const NODES: usize>(places: &[Vector3<f64>]) -> (f64, String)
where
    Parent<NODES>: Element<NODES>,
{
    let scaled = scaled(places);
    let mut smallest = (f64::INFINITY, String::new());
    let nodes = Parent::<NODES>::PLACES;
    let points = Parent::<NODES>::POINTS.map(|(at, _)| at);
    for (kind, all) in [("node", &nodes[..]), ("Gauss point", &points)] {
        for (number, at) in all.iter().enumerate() {
            let ratio = determinant_ratio::<NODES>(&scaled, at);
            // A ratio that is not a number (all nodes at one place, or beyond the range of numbers) is no better than zero.
            let ratio = if ratio.is_nan() { 0.0 } else { ratio };
            if ratio < smallest.0 {
                smallest = (ratio, format!("{kind} {number}"));
            }
        }
    }
    smallest
}

/// Differences from the first node in units of the largest one: neither large nor small lengths leave the range of numbers.
fn scaled(places: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let edges: Vec<_> = places.iter().map(|x| x - places[0]).collect();
    let size = edges.iter().map(Vector3::amax).fold(0.0, f64::max);
    edges.iter().map(|edge| edge / size).collect()
}

/// The smallest ratio of the area of a quadratic triangle and that of a rectangle with edges as long as `∂x/∂ξ`, over its nodes, and where.
fn smallest_ratio_of_areas(places: &[Vector3<f64>]) -> (f64, String) {
    let scaled = scaled(places);
    let ratio = |at: &[f64; 2]| {
        let slopes: [[f64; 2]; 6] = Parent::<6>::slopes(at);
        let [a, b] = [0, 1].map(|k| {
            let terms = scaled.iter().zip(&slopes).map(|(x, slope)| x * slope[k]);
            let tangent: Vector3<f64> = terms.sum();
            tangent / tangent.norm().max(LIMIT)
        });
        let ratio = a.cross(&b).norm();
        if ratio.is_nan() { 0.0 } else { ratio }
    };
    let nodes = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [0.5, 0.0],
        [0.5, 0.5],
        [0.0, 0.5],
    ];
    let ratios = nodes.iter().map(ratio).enumerate();
    let (node, ratio) = ratios
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, 0.0));
    (ratio, format!("node {node}"))
}

/// `det(∂x/∂ξ) / Π_k |∂x/∂ξ_k|` with x in units of the element's size.
fn determinant_ratio<const NODES: usize>(places: &[Vector3<f64>], xi: &[f64; 3]) -> f64
where
    Parent<NODES>: Element<NODES>,
{
    let slopes = Parent::<NODES>::slopes(xi);
    let column = |k: usize| {
        let terms = places.iter().zip(&slopes).map(|(x, slope)| x * slope[k]);
        let column: Vector3<f64> = terms.sum();
        column / column.norm().max(LIMIT)
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)]).determinant()
}
