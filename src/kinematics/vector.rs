//! Material vectors: points, directors and spans, the only thing effects ever read of a configuration.
//!
//! On director coordinates q = [φ; d₁; d₂; d₃] of a body every point φ + ρᵢ dᵢ, every director dᵢ and every difference
//! of points of two bodies is linear: x = Σ (c φ + ρᵢ dᵢ) over a few terms. Energies are functions of such vectors.

use crate::math::{Matrix, Vector};

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
}

/// c φ + ρᵢ dᵢ on one body; `None` is the ground, whose part is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The body.
    pub body: Option<usize>,
    /// Coefficient c of the centre.
    pub centre: f64,
    /// Coefficients ρ of the directors.
    pub directors: Vector,
}

impl Term {
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
    pub terms: Vec<Term>,
}

impl MaterialVector {
    /// The material point of a body (in the reference poses) that lies at `place`.
    pub fn point(body: Option<usize>, place: &Vector, reference: &[Pose]) -> Self {
        let pose = body.map_or(Pose::GROUND, |b| reference[b]);
        Self {
            terms: vec![Term {
                body,
                centre: 1.0,
                directors: pose.local(place),
            }],
        }
    }

    /// The direction fixed in a body that points along `direction` in the reference poses.
    pub fn direction(body: Option<usize>, direction: &Vector, reference: &[Pose]) -> Self {
        let pose = body.map_or(Pose::GROUND, |b| reference[b]);
        Self {
            terms: vec![Term {
                body,
                centre: 0.0,
                directors: pose.directors.tr_mul(direction),
            }],
        }
    }

    /// a x + b y.
    pub fn combine(a: f64, x: &Self, b: f64, y: &Self) -> Self {
        let mut terms: Vec<Term> = Vec::new();
        let scaled = |factor: f64, v: &Self| {
            let scale = move |t: &Term| Term {
                body: t.body,
                centre: factor * t.centre,
                directors: t.directors * factor,
            };
            v.terms.iter().map(scale).collect::<Vec<_>>()
        };
        for term in scaled(a, x).into_iter().chain(scaled(b, y)) {
            match terms.iter_mut().find(|t| t.body == term.body) {
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

    /// The value at given poses.
    pub fn at(&self, poses: &[Pose]) -> Vector {
        let pose = |t: &Term| t.body.map_or(Pose::GROUND, |b| poses[b]);
        self.terms.iter().map(|t| t.at(&pose(t))).sum()
    }
}

/// The list of vectors that effects read, each once.
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

    /// All vectors.
    pub fn list(&self) -> &[MaterialVector] {
        &self.list
    }
}
