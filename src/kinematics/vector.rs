//! Material vectors: points, directors and spans, all that terms read of a configuration.
//!
//! On director coordinates q = [φ; d₁; d₂; d₃] of a body every point φ + ρᵢ dᵢ, every director dᵢ and every difference
//! of points of two bodies is linear: x = Σ (c φ + ρᵢ dᵢ) over a few terms. So is the place of a node of an elastic
//! block, and so are coordinates that are no places, as components. Energies are functions of such vectors.

use crate::math::{Matrix, Vector};
use nalgebra::{Rotation3, UnitQuaternion};
use std::ops::Range;

/// Pose of a rigid body at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of mass φ in mm.
    pub centre: Vector,
    /// Directors d₁, d₂, d₃ as columns, in the ground frame.
    pub directors: Matrix,
}

impl Pose {
    /// The ground: origin and axes at rest.
    pub const GROUND: Self = Self {
        centre: Vector::new(0.0, 0.0, 0.0),
        directors: Matrix::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    /// Components ρ of a place of the reference configuration in this body.
    pub fn local(&self, place: &Vector) -> Vector {
        self.directors.tr_mul(&(place - self.centre))
    }

    /// φ + ρᵢ dᵢ.
    pub fn point(&self, local: &Vector) -> Vector {
        self.centre + self.directors * local
    }

    /// The pose at a part of the way to another one, by a turn about one axis.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let [p, q] = [self, other].map(|pose| Rotation3::from_matrix_unchecked(pose.directors));
        // By a quaternion: the trace of a matrix that hardly turns may tell a cosine above one.
        let turn = UnitQuaternion::from_rotation_matrix(&(p.inverse() * q));
        let turn = UnitQuaternion::new_normalize(turn.into_inner()).scaled_axis();
        let turn = Rotation3::from_scaled_axis(turn * part);
        Self {
            centre: self.centre + (other.centre - self.centre) * part,
            directors: (p * turn).into_inner(),
        }
    }
}

/// Carrier of a part of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// The ground: the part is constant.
    Ground,
    /// A rigid body.
    Body(usize),
    /// A node with coordinates of its own, numbered over all blocks; it has a place and no directors.
    Node(usize),
    /// A coordinate of a joint of a tree, or an internal one, times the coefficients ρ.
    Coordinate(usize),
}

impl Carrier {
    /// A body, or the ground.
    pub fn from_body(body: Option<usize>) -> Self {
        body.map_or(Self::Ground, Self::Body)
    }
}

/// c φ + ρᵢ dᵢ on one carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorTerm {
    /// The carrier.
    pub carrier: Carrier,
    /// Coefficient c of the centre.
    pub centre: f64,
    /// Coefficients ρ of the directors.
    pub directors: Vector,
}

impl VectorTerm {
    /// The value at a pose.
    #[inline]
    pub fn at(&self, pose: &Pose) -> Vector {
        pose.centre * self.centre + pose.directors * self.directors
    }
}

/// A sum of terms on different bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialVector {
    /// At most one term a body.
    pub terms: Vec<VectorTerm>,
}

impl MaterialVector {
    /// The material point of a body (in the reference poses) that lies at `place`.
    pub fn point(body: Option<usize>, place: &Vector, reference: &[Pose]) -> Self {
        let pose = body.map_or(Pose::GROUND, |b| reference[b]);
        Self {
            terms: vec![VectorTerm {
                carrier: Carrier::from_body(body),
                centre: 1.0,
                directors: pose.local(place),
            }],
        }
    }

    /// The direction fixed in a body that points along `direction` in the reference poses.
    pub fn direction(body: Option<usize>, direction: &Vector, reference: &[Pose]) -> Self {
        let pose = body.map_or(Pose::GROUND, |b| reference[b]);
        Self {
            terms: vec![VectorTerm {
                carrier: Carrier::from_body(body),
                centre: 0.0,
                directors: pose.directors.tr_mul(direction),
            }],
        }
    }

    /// a x + b y.
    pub fn combine(a: f64, x: &Self, b: f64, y: &Self) -> Self {
        let mut terms: Vec<VectorTerm> = Vec::new();
        let scaled = |factor: f64, v: &Self| {
            let scale = move |t: &VectorTerm| VectorTerm {
                carrier: t.carrier,
                centre: factor * t.centre,
                directors: t.directors * factor,
            };
            v.terms.iter().map(scale).collect::<Vec<_>>()
        };
        for term in scaled(a, x).into_iter().chain(scaled(b, y)) {
            match terms.iter_mut().find(|t| t.carrier == term.carrier) {
                Some(same) => {
                    same.centre += term.centre;
                    same.directors += term.directors;
                }
                None => terms.push(term),
            }
        }
        Self { terms }
    }

    /// y − x.
    pub fn span(x: &Self, y: &Self) -> Self {
        Self::combine(-1.0, x, 1.0, y)
    }

    /// The place of a node.
    pub fn node(node: usize) -> Self {
        Self {
            terms: vec![VectorTerm {
                carrier: Carrier::Node(node),
                centre: 1.0,
                directors: Vector::zeros(),
            }],
        }
    }

    /// A coordinate of a joint of a tree, or an internal one, in the first component.
    pub fn coordinate(coordinate: usize) -> Self {
        Self::coordinates(coordinate..coordinate + 1)
    }

    /// Up to three successive coordinates as the first components.
    pub fn coordinates(coordinates: Range<usize>) -> Self {
        let component = |(axis, coordinate)| VectorTerm {
            carrier: Carrier::Coordinate(coordinate),
            centre: 0.0,
            directors: Vector::ith(axis, 1.0),
        };
        Self {
            terms: coordinates.enumerate().map(component).collect(),
        }
    }

    /// Returns true if bodies move it, or nothing does.
    pub fn is_on_tree(&self) -> bool {
        let of_body = |t: &VectorTerm| matches!(t.carrier, Carrier::Body(_));
        let is_still = |t: &VectorTerm| t.carrier == Carrier::Ground;
        self.terms.iter().any(of_body) || self.terms.iter().all(is_still)
    }

    /// Sum of the coefficients of its centres: its displacement where all that carries it moves by a unit.
    pub fn centre(&self) -> f64 {
        self.terms.iter().map(|term| term.centre).sum()
    }

    /// The value at given poses of the bodies and places of the nodes; coordinates that are no places are not read from poses.
    pub fn at(&self, poses: &[Pose], nodes: &[Vector]) -> Vector {
        let part = |t: &VectorTerm| match t.carrier {
            Carrier::Ground => t.at(&Pose::GROUND),
            Carrier::Body(body) => t.at(&poses[body]),
            Carrier::Node(node) => nodes[node] * t.centre,
            Carrier::Coordinate(_) => unreachable!("a coordinate is no place"),
        };
        self.terms.iter().map(part).sum()
    }

    /// Its rate at given rates of the poses of the bodies, all else at rest.
    pub fn rate(&self, poses: &[Pose]) -> Vector {
        let part = |t: &VectorTerm| match t.carrier {
            Carrier::Body(body) => t.at(&poses[body]),
            Carrier::Ground | Carrier::Node(_) | Carrier::Coordinate(_) => Vector::zeros(),
        };
        self.terms.iter().map(part).sum()
    }
}

/// The list of vectors that terms read, each once.
#[derive(Clone, Debug, Default)]
pub struct Vectors {
    list: Vec<MaterialVector>,
}

impl Vectors {
    /// Index of a vector, which joins the list if it is new.
    pub fn index(&mut self, vector: MaterialVector) -> usize {
        self.list
            .iter()
            .position(|v| *v == vector)
            .unwrap_or_else(|| {
                self.list.push(vector);
                self.list.len() - 1
            })
    }

    /// Index of a vector that is known to be new.
    pub fn push(&mut self, vector: MaterialVector) -> usize {
        self.list.push(vector);
        self.list.len() - 1
    }

    /// Returns true if a vector of the list moves with a body, a node or a coordinate.
    pub fn moves(&self, vector: usize) -> bool {
        let mut parts = self.list[vector].terms.iter();
        parts.any(|part| part.carrier != Carrier::Ground)
    }

    /// All vectors.
    pub fn list(&self) -> &[MaterialVector] {
        &self.list
    }
}
