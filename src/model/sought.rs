//! Sought parameters as components read them.

use crate::energy::Affine;
use crate::functional::{LawElement, Move, VectorArg};
use crate::math::Vector;
use crate::model::constant::{Constant, Follower, Parameter};
use std::sync::Arc;

/// The sought parameters of a model.
#[derive(Clone, Debug)]
pub struct Sought {
    parameters: Arc<[Parameter]>,
    /// Scalar of the first one in an interval.
    first: usize,
}

impl Sought {
    pub(super) fn new(parameters: &[Parameter], first: usize) -> Self {
        Self {
            parameters: parameters.into(),
            first,
        }
    }

    /// The parameter that a constant follows, and how; `None`: it is given.
    fn find(&self, constant: Constant) -> Option<(usize, Follower)> {
        let all = self.parameters.iter().enumerate();
        let mut pairs = all.flat_map(|(p, parameter)| {
            let followers = parameter.constants.iter();
            followers.map(move |&follower| (p, follower))
        });
        pairs.find(|(_, follower)| follower.constant == constant)
    }

    /// Returns true if a constant is sought.
    pub fn is_sought(&self, constant: Constant) -> bool {
        self.find(constant).is_some()
    }

    /// A list of what one element reads.
    pub fn read(&self) -> Read {
        Read {
            sought: self.clone(),
            scalars: Vec::new(),
            moves: Vec::new(),
        }
    }
}

/// Parameters that one element reads, in the order in which its law takes them.
#[derive(Clone, Debug)]
pub struct Read {
    sought: Sought,
    scalars: Vec<usize>,
    moves: Vec<Move>,
}

impl Read {
    /// A list where nothing is sought.
    pub fn nothing() -> Self {
        Sought::new(&[], 0).read()
    }

    /// The parameters that were read, scalars of the interval.
    pub fn scalars(self) -> Vec<usize> {
        self.scalars
    }

    /// Returns true if nothing that is sought was read.
    pub fn is_empty(&self) -> bool {
        self.scalars.is_empty()
    }

    /// A constant as a function of parameters: its `value`, or what follows from one.
    pub fn constant(&mut self, constant: Constant, value: f64) -> Affine {
        let Some((parameter, follower)) = self.sought.find(constant) else {
            return value.into();
        };
        Affine {
            value: follower.offset,
            slopes: vec![(self.place(parameter), follower.factor)],
        }
    }

    /// Place of a parameter in the list, which it joins if it is new.
    fn place(&mut self, parameter: usize) -> usize {
        let scalar = self.sought.first + parameter;
        let known = self.scalars.iter().position(|&s| s == scalar);
        known.unwrap_or_else(|| {
            self.scalars.push(scalar);
            self.scalars.len() - 1
        })
    }

    /// Notes the parameters that move two ends between which vector `of` of the element lies: `end` is a component of the place of an end,
    /// and `vector` the material vector of directions at both ends. Returns the parameters, their values without a move, and the directions.
    pub fn moves(
        &mut self,
        of: usize,
        end: impl Fn(usize, usize) -> Constant,
        mut vector: impl FnMut([Vector; 2]) -> usize,
    ) -> Vec<(usize, f64, [Vector; 2])> {
        let mut moves = Vec::new();
        let parameters = self.sought.parameters.clone();
        for (p, parameter) in parameters.iter().enumerate() {
            let mut ends = [Vector::zeros(); 2];
            for follower in &parameter.constants {
                for (e, axis) in (0..6).map(|i| (i / 3, i % 3)) {
                    if follower.constant == end(e, axis) {
                        ends[e][axis] += follower.factor;
                    }
                }
            }
            if ends != [Vector::zeros(); 2] {
                let (parameter, at) = (self.place(p), parameter.guess);
                self.moves.push(Move {
                    of,
                    vector: vector(ends),
                    parameter,
                    at,
                });
                moves.push((parameter, at, ends));
            }
        }
        moves
    }

    /// Forgets the moves, for an element that does not read what they move.
    pub fn stand_still(&mut self) {
        self.moves.clear();
    }

    /// The element of a law that reads these parameters.
    pub fn element<L, const NV: usize, const NS: usize>(
        self,
        law: L,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> LawElement<L, NV, NS> {
        LawElement {
            law,
            vectors,
            scalars,
            parameters: self.scalars,
            moves: self.moves,
        }
    }
}
