//! The quadratic tetrahedron with straight or curved edges, and its faces, over barycentric coordinates λ = (1 − Σ ξ, ξ):
//!
//! ```text
//! N_i = λ_i (2 λ_i − 1) at corners,      N_ab = 4 λ_a λ_b at the middles of edges.
//! ```
//!
//! Eight Gauss points lie in two orbits of (a, a, a, 1 − 3a). Of the rules of third degree with such points, which form a family of one
//! parameter, this one integrates Σ λ_i⁴ too; its weights are positive.
//!
//! Masses and loads of faces take more points, which are exact to degree 7.

use super::interpolation::{Element, Interpolation, Parent, Point, collapsed};

/// Ends of the edges with a middle, in the order of VTK; those of a face are the first three.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

pub(super) const FACES: [&[usize]; 4] = [
    &[0, 2, 1, 6, 5, 4],
    &[0, 1, 3, 4, 8, 7],
    &[1, 2, 3, 5, 9, 8],
    &[0, 3, 2, 7, 9, 6],
];

/// Places a of both orbits and weights for a volume of one.
const ORBITS: [[f64; 2]; 2] = [
    [0.106_952_273_932_930_68, 0.111_472_033_488_137_86],
    [0.328_054_696_711_426_7, 0.138_527_966_511_862_14],
];

/// λ_i of a place.
fn barycentric<const D: usize>(at: &[f64; D], i: usize) -> f64 {
    match i {
        0 => 1.0 - at.iter().sum::<f64>(),
        _ => at[i - 1],
    }
}

/// ∂λ_i/∂ξ_m.
fn slope(i: usize, m: usize) -> f64 {
    match i {
        0 => -1.0,
        _ => f64::from(u8::from(i == m + 1)),
    }
}

fn values<const D: usize, const NODES: usize>(at: &[f64; D]) -> [f64; NODES] {
    std::array::from_fn(|i| match i.checked_sub(D + 1) {
        None => barycentric(at, i) * (2.0 * barycentric(at, i) - 1.0),
        Some(edge) => 4.0 * barycentric(at, EDGES[edge][0]) * barycentric(at, EDGES[edge][1]),
    })
}

fn slopes<const D: usize, const NODES: usize>(at: &[f64; D]) -> [[f64; D]; NODES] {
    let of = |i: usize, m: usize| match i.checked_sub(D + 1) {
        None => (4.0 * barycentric(at, i) - 1.0) * slope(i, m),
        Some(edge) => {
            let [a, b] = EDGES[edge];
            4.0 * (barycentric(at, a) * slope(b, m) + barycentric(at, b) * slope(a, m))
        }
    };
    std::array::from_fn(|i| std::array::from_fn(|m| of(i, m)))
}

impl Interpolation<3, 10> for Parent<10> {
    fn values(at: &[f64; 3]) -> [f64; 10] {
        values(at)
    }

    fn slopes(at: &[f64; 3]) -> [[f64; 3]; 10] {
        slopes(at)
    }

    fn quadrature() -> Vec<Point<3>> {
        collapsed()
    }
}

impl Element<10> for Parent<10> {
    const PLACES: [[f64; 3]; 10] = {
        let mut places = [[0.0; 3]; 10];
        let mut i = 0;
        while i < 30 {
            let (node, m) = (i / 3, i % 3);
            places[node][m] = if node < 4 {
                (node == m + 1) as u8 as f64
            } else {
                let [a, b] = EDGES[node - 4];
                0.5 * ((a == m + 1) as u8 + (b == m + 1) as u8) as f64
            };
            i += 1;
        }
        places
    };
    const CENTRE: [f64; 3] = [0.25; 3];
    const POINTS: [Point<3>; 8] = {
        let mut points = [([0.0; 3], 0.0); 8];
        let mut g = 0;
        while g < 8 {
            let [a, weight] = ORBITS[g / 4];
            let mut at = [a; 3];
            if g % 4 > 0 {
                at[g % 4 - 1] = 1.0 - 3.0 * a;
            }
            points[g] = (at, weight / 6.0);
            g += 1;
        }
        points
    };
}

/// A face.
impl Interpolation<2, 6> for Parent<6> {
    fn values(at: &[f64; 2]) -> [f64; 6] {
        values(at)
    }

    fn slopes(at: &[f64; 2]) -> [[f64; 2]; 6] {
        slopes(at)
    }

    fn quadrature() -> Vec<Point<2>> {
        collapsed()
    }
}

/// Nodes of quadratic tetrahedra or triangles with straight edges from those of linear ones: the middle of each edge is a node, numbered from
/// `next` on. Middles are found again by the ends of their edges in ascending order.
pub(super) fn raised<const CORNERS: usize, const NODES: usize>(
    corners: &[[usize; CORNERS]],
    next: usize,
) -> (Vec<[usize; NODES]>, Vec<[usize; 2]>) {
    let (mut found, mut edges) = (rustc_hash::FxHashMap::default(), Vec::new());
    let mut middle = |[a, b]: [usize; 2]| {
        let ends = [a.min(b), a.max(b)];
        *found.entry(ends).or_insert_with(|| {
            edges.push(ends);
            next + edges.len() - 1
        })
    };
    let mut element = |corners: &[usize; CORNERS]| {
        std::array::from_fn(|i| match i.checked_sub(CORNERS) {
            None => corners[i],
            Some(edge) => middle(EDGES[edge].map(|end| corners[end])),
        })
    };
    (corners.iter().map(&mut element).collect(), edges)
}
