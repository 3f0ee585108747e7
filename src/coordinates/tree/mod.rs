//! Kinematic trees: joint coordinates, and the derivatives of all vectors by them.
//!
//! A joint is a list of screws, each a turn about an axis or a slide along one; the tree is made of links, one for each
//! screw, which carry one frame each: a body, or a frame without mass between two screws of a joint. For a link j with
//! axis a_j through c_j the column of P on every descendant is `a_j × (φ − c_j)`, `a_j × d_I` (turn) or `a_j`, `0` (slide).
//! Second derivatives nest, the link nearest the root outermost: ∂_i ∂_k x = a_i × (a_k × v). Contracted with forces R one
//! matrix `N_k = Σ v Rᵀ` and one force f_k per link carry the curvature (docs/theory.md, 5.3),
//!
//! ```text
//! (R·P′)_ik = a_iᵀ N_k a_k − (a_i·a_k) tr N_k          slide k:  f_k·(a_i × a_k)
//! ```
//!
//! and R·P″_l is its derivative along l, in which axes and points move with the twists of their parents.
//!
//! Three turns about perpendicular axes give any rotation, but none of them moves a body alone once the second one is a right
//! angle. Before such turns stands a chart: a rotation that belongs to the configuration as data, a unit quaternion, so that
//! the turns stay small. [`Tree::recentre`] puts the turns into the chart; nothing moves.

mod charts;
mod forces;
mod motion;

use crate::coordinates::configuration::{Moments, TreeState};
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm};
use crate::math::{Matrix, Vector, compact_index};

/// Motion that a link of a tree permits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkKind {
    /// Rotation about the axis.
    Turn,
    /// Translation along the axis.
    Slide,
    /// Nothing.
    Fixed,
}

/// One screw of a joint, or a joint without any, between two frames; links stand in an order in which parents come first.
#[derive(Clone, Debug)]
pub struct Link {
    /// Motion that it permits.
    pub kind: LinkKind,
    /// Parent frame; `None` is the ground.
    pub parent: Option<usize>,
    /// Child frame: the bodies come first, then the frames between screws.
    pub child: usize,
    /// The chart between the parent and the link, which is the first of three turns in a row; axis and what follows are then
    /// in the directors that it turned. Charts are numbered in the order of the links.
    pub chart: Option<usize>,
    /// Unit axis in the parent's directors.
    pub axis: Vector,
    /// Point in the parent's directors, from its centre.
    pub point: Vector,
    /// Directors of the child relative to the parent at zero.
    pub directors: Matrix,
    /// Centre of the child relative to the point at zero, in the parent's directors.
    pub centre: Vector,
    /// Index of the joint coordinate; `None` for a fixed link.
    pub coordinate: Option<usize>,
}

/// Numbers of a chart among the data of a configuration: its unit quaternion w, x, y, z.
pub const CHART: usize = 4;

/// A column of an articulated vector: the link, and the part of the vector that the link moves.
#[derive(Clone, Copy, Debug)]
struct Column {
    link: u32,
    /// The moved part.
    arm: u32,
    /// Sum of its centre coefficients.
    centre: f64,
}

/// A sum of terms of one vector that the same links move.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MovedPart {
    /// The first term, and the number of terms: those that a link moves are neighbours.
    first: usize,
    count: usize,
    /// Sum of their centre coefficients.
    centre: f64,
}

/// One term of a vector, flattened.
#[derive(Clone, Copy, Debug)]
struct FlatTerm {
    vector: usize,
    body: usize,
    centre: f64,
    directors: Vector,
}

/// The columns of one vector: three rows of `stride` numbers from `first`, one number for each coordinate, then zeros.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TangentColumns {
    /// First number.
    pub first: usize,
    /// Numbers a row: the coordinates, rounded up to [`LANES`].
    pub stride: usize,
    /// Coordinates that move the vector: those of the tree, then those of nodes, whose columns are constant.
    pub support: Vec<usize>,
    /// Number of those of the tree.
    pub of_tree: usize,
}

impl TangentColumns {
    /// The three rows of the vector's columns.
    #[inline]
    pub fn rows<'c>(&self, columns: &'c [f64]) -> [&'c [f64]; 3] {
        let (x, rest) = columns[self.first..self.first + 3 * self.stride].split_at(self.stride);
        let (y, z) = rest.split_at(self.stride);
        [x, y, z]
    }
}

/// Rows of columns are padded to a multiple of this.
pub const LANES: usize = 4;

/// A kinematic tree and the vectors on it.
#[derive(Clone, Debug)]
pub struct Tree {
    links: Vec<Link>,
    /// Number of bodies: the first frames.
    bodies: usize,
    /// Link that carries each frame.
    carrier: Vec<usize>,
    /// The first of the three turns behind each chart.
    charts: Vec<usize>,
    /// Link before each link on its way to the ground.
    before: Vec<Option<usize>>,
    /// Constant part of each vector.
    constants: Vec<Vector>,
    terms: Vec<FlatTerm>,
    moved_parts: Vec<MovedPart>,
    /// Columns of all vectors, one vector after the other.
    columns: Vec<Column>,
    packed: Vec<TangentColumns>,
    size: usize,
    /// Pairs of links (i, k) on one path, i not behind k.
    paths: Vec<(usize, usize)>,
}

impl Tree {
    /// The tree of `links` over `bodies` bodies and the frames between them, each the child of exactly one link, and the vectors on it.
    pub fn new(links: Vec<Link>, bodies: usize, vectors: &[MaterialVector]) -> Self {
        let mut carrier = vec![usize::MAX; links.len()];
        for (j, link) in links.iter().enumerate() {
            carrier[link.child] = j;
        }
        assert!(
            carrier.iter().all(|&j| j != usize::MAX),
            "every frame of a tree is carried by a link"
        );
        let before = links
            .iter()
            .map(|link| link.parent.map(|b| carrier[b]))
            .collect();
        let mut tree = Self {
            charts: (0..links.len())
                .filter(|&j| links[j].chart.is_some())
                .collect(),
            links,
            bodies,
            carrier,
            before,
            constants: Vec::new(),
            terms: Vec::new(),
            moved_parts: Vec::new(),
            columns: Vec::new(),
            packed: Vec::new(),
            size: 0,
            paths: Vec::new(),
        };
        for (index, vector) in vectors.iter().enumerate() {
            if vector.is_on_tree() {
                tree.lay_vector(index, vector);
            } else {
                tree.constants.push(Vector::zeros());
                tree.packed.push(TangentColumns::default());
            }
        }
        tree.lay_columns();
        tree.lay_paths();
        tree
    }

    /// Gives vectors columns for coordinates that are not of the tree.
    pub fn widen(&mut self, vectors: impl Iterator<Item = (usize, Vec<usize>)>) {
        for (vector, coordinates) in vectors {
            self.packed[vector].support.extend(coordinates);
        }
        self.lay_columns();
    }

    /// Lays the columns of all vectors, one vector after the other.
    fn lay_columns(&mut self) {
        self.size = 0;
        for packed in &mut self.packed {
            packed.first = self.size;
            packed.stride = packed.support.len().next_multiple_of(LANES);
            self.size += 3 * packed.stride;
        }
    }

    /// Links from the one that carries `body` to the ground.
    fn path(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(self.carrier[body]), |&j| self.before[j])
    }

    fn lay_vector(&mut self, index: usize, vector: &MaterialVector) {
        let first_term = self.terms.len();
        let mut constant = Vector::zeros();
        for term in &vector.terms {
            match term.carrier {
                Carrier::Body(body) => {
                    let VectorTerm {
                        centre, directors, ..
                    } = *term;
                    self.terms.push(FlatTerm {
                        vector: index,
                        body,
                        centre,
                        directors,
                    });
                }
                Carrier::Ground => constant += term.at(&Pose::GROUND),
                Carrier::Node(_) => {}
                Carrier::Coordinate(_) => unreachable!("a coordinate is on no tree"),
            }
        }
        self.constants.push(constant);
        let mut moved = Vec::new();
        for (j, link) in self.links.iter().enumerate() {
            let Some(coordinate) = link.coordinate else {
                continue;
            };
            let is_moved = |&t: &usize| self.path(self.terms[t].body).any(|i| i == j);
            let terms: Vec<usize> = (first_term..self.terms.len()).filter(is_moved).collect();
            let centre: f64 = terms.iter().map(|&t| self.terms[t].centre).sum();
            let still = link.kind == LinkKind::Slide && centre == 0.0;
            let (Some(&first), Some(&last), false) = (terms.first(), terms.last(), still) else {
                continue;
            };
            assert!(
                last - first + 1 == terms.len(),
                "terms that a link moves are neighbours"
            );
            moved.push((
                j,
                coordinate,
                MovedPart {
                    first,
                    count: terms.len(),
                    centre,
                },
            ));
        }
        self.packed.push(TangentColumns {
            support: moved.iter().map(|&(_, coordinate, _)| coordinate).collect(),
            of_tree: moved.len(),
            ..TangentColumns::default()
        });
        for (link, _, part) in moved {
            let known = self.moved_parts.iter().rposition(|a| *a == part);
            let arm = known.unwrap_or_else(|| {
                self.moved_parts.push(part);
                self.moved_parts.len() - 1
            });
            self.columns.push(Column {
                link: compact_index(link),
                arm: compact_index(arm),
                centre: part.centre,
            });
        }
    }

    fn lay_paths(&mut self) {
        let mut paths = Vec::new();
        for k in 0..self.links.len() {
            for i in std::iter::successors(Some(k), |&j| self.before[j]) {
                let moving = |j: usize| self.links[j].kind != LinkKind::Fixed;
                let turning = self.links[i].kind == LinkKind::Turn
                    && (i != k || self.links[k].kind == LinkKind::Turn);
                if moving(i) && moving(k) && turning {
                    paths.push((i, k));
                }
            }
        }
        self.paths = paths;
    }

    /// Number of joint coordinates.
    pub fn coordinates(&self) -> usize {
        self.links
            .iter()
            .filter(|link| link.coordinate.is_some())
            .count()
    }

    /// The link that carries a body.
    pub fn carrier(&self, body: usize) -> usize {
        self.carrier[body]
    }

    /// Number of charts.
    pub fn charts(&self) -> usize {
        self.charts.len()
    }

    /// Columns of each vector: the structure of P.
    pub fn packed(&self) -> &[TangentColumns] {
        &self.packed
    }

    /// Coordinates that the curvature couples; both orders are meant.
    pub fn curvature_entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let coordinate = |j: usize| {
            self.links[j]
                .coordinate
                .expect("a moving link has a coordinate")
        };
        self.paths
            .iter()
            .map(move |&(i, k)| (coordinate(i), coordinate(k)))
    }

    /// Storage for an instant.
    pub fn state(&self) -> TreeState {
        let links = self.links.len();
        TreeState {
            poses: vec![Pose::GROUND; links],
            screws: vec![[Vector::zeros(); 2]; links],
            screws_l: vec![[Vector::zeros(); 2]; links],
            axes: vec![Vector::zeros(); links],
            points: vec![Vector::zeros(); links],
            axes_l: vec![Vector::zeros(); links],
            points_l: vec![Vector::zeros(); links],
            twists: vec![[Vector::zeros(); 2]; links],
            moments: vec![Moments::default(); links],
            wrenches: vec![[Vector::zeros(); 2]; links],
            terms: vec![Vector::zeros(); self.terms.len()],
            terms_l: vec![Vector::zeros(); self.terms.len()],
            arms: vec![Vector::zeros(); self.moved_parts.len()],
            arms_l: vec![Vector::zeros(); self.moved_parts.len()],
        }
    }

    /// Length of the storage of all columns.
    pub fn size(&self) -> usize {
        self.size
    }
}
