//! The homogeneous solid that a closed triangulated surface encloses: its volume, centre and second moments.
//!
//! The solid is the sum of tetrahedra between a point and the triangles, with the sign of their determinant. For a tetrahedron with its apex
//! at the origin and the corners a, b, c, with D = a · (b × c),
//!
//! ```text
//! ∫ dV = D/6,   ∫ x dV = D/24 (a + b + c),   ∫ x xᵀ dV = D/120 (a aᵀ + b bᵀ + c cᵀ + (a + b + c)(a + b + c)ᵀ)
//! ```
//!
//! (F. Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor in terms of its vertex coordinates, J. Math. Stat. 1, 2005).

use super::error::{MeshError, MeshPlace};
use super::triangulated::Surface;
use crate::math::refuse;
use nalgebra::{Matrix3, Vector3};
use rustc_hash::{FxHashMap, FxHashSet};

/// A volume below this part of that of the box around the surface is one of rounding.
const FLAT: f64 = 1e-9;

/// A solid of density one.
#[derive(Clone, Debug, PartialEq)]
pub struct EnclosedSolid {
    /// Volume in mm³.
    pub volume: f64,
    /// Centre of mass in mm.
    pub centre: Vector3<f64>,
    /// Second moments ∫ x xᵀ dV about the centre in mm⁵.
    pub second_moments: Matrix3<f64>,
}

impl EnclosedSolid {
    /// The inertia tensor about the centre for a density of one, in mm⁵.
    pub fn inertia(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.second_moments.trace() - self.second_moments
    }
}

impl Surface {
    /// The solid within the surface. Parts within parts with normals inwards are cavities; that the surface does not intersect itself is
    /// not checked.
    ///
    /// # Errors
    /// There is no triangle, a place is not finite, the surface is open, neighbours are oriented differently, normals point inwards, or it
    /// encloses no volume.
    pub fn enclosed(&self) -> Result<EnclosedSolid, MeshError> {
        self.check_closed()?;
        let (lower, upper) = self.bounds();
        // Sums from the middle keep their digits far from the origin.
        let middle = 0.5 * (lower + upper);
        let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for corners in self.corners() {
            let [a, b, c] = corners.map(|corner| corner - middle);
            let determinant = a.dot(&b.cross(&c));
            let sum = a + b + c;
            volume += determinant / 6.0;
            first += sum * (determinant / 24.0);
            let products = [a, b, c, sum].map(|x| x * x.transpose());
            second += products.iter().sum::<Matrix3<f64>>() * (determinant / 120.0);
        }
        refuse!(if volume.abs() <= FLAT * (upper - lower).max().powi(3), MeshPlace::Whole;
            found "a surface that encloses no volume", expected "that of a solid");
        refuse!(if volume < 0.0, MeshPlace::Whole;
            found format!("normals that point inwards, and a volume of {volume:.4e} mm^3"),
            expected "corners of triangles that are counter-clockwise seen from outside");
        let centre = first / volume;
        Ok(EnclosedSolid {
            volume,
            centre: middle + centre,
            second_moments: second - centre * centre.transpose() * volume,
        })
    }

    /// Checks that vertices are finite, and that each edge is passed as often one way as the other.
    fn check_closed(&self) -> Result<(), MeshError> {
        refuse!(if self.triangles.is_empty(), MeshPlace::Whole;
            found "no triangle with an area", expected "a surface");
        let outside = |vertex: &&Vector3<f64>| !vertex.iter().all(|x| x.is_finite());
        refuse!(if let Some(vertex) = self.vertices.iter().find(outside), MeshPlace::Whole;
            found place(vertex), expected "finite places");
        let mut seen = FxHashSet::default();
        for triangle in &self.triangles {
            let least = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
            if !seen.insert([0, 1, 2].map(|i| triangle[(least + i) % 3])) {
                let [a, b, c] = triangle.map(|vertex| place(&self.vertices[vertex]));
                let found = format!("the triangle {a}, {b}, {c} twice");
                return Err(MeshPlace::Whole.wrong(found, "each triangle once"));
            }
        }
        // Passes of an edge from the lower vertex to the higher one, and the other way.
        let mut passes: FxHashMap<[usize; 2], [usize; 2]> = FxHashMap::default();
        for triangle in &self.triangles {
            for i in 0..3 {
                let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
                let pass = passes.entry([from.min(to), from.max(to)]).or_default();
                pass[usize::from(from > to)] += 1;
            }
        }
        let mut uneven: Vec<_> = passes
            .iter()
            .filter(|(_, pass)| pass[0] != pass[1])
            .collect();
        uneven.sort_unstable();
        let Some((edge, _)) = uneven.first() else {
            return Ok(());
        };
        let ends = edge
            .map(|vertex| place(&self.vertices[vertex]))
            .join(" to ");
        let open = uneven
            .iter()
            .filter(|(_, pass)| (pass[0] + pass[1]) % 2 == 1);
        match open.count() {
            0 => Err(MeshPlace::Whole.wrong(
                format!("triangles of opposite orientation at the edge from {ends}"),
                "neighbours that are oriented alike",
            )),
            count => Err(MeshPlace::Whole.wrong(
                format!(
                    "an open surface: {count} of {} edges have a triangle on one side only; one edge in question goes from {ends}",
                    passes.len()
                ),
                "a closed surface",
            )),
        }
    }
}

fn place(x: &Vector3<f64>) -> String {
    format!("({}, {}, {}) mm", x.x, x.y, x.z)
}
