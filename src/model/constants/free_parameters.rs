//! Free parameters as components read them.

use crate::energy::Coefficient;
use crate::functional::{FreeConstant, LawElement, Move, VectorArg};
use crate::kinematics::MaterialVector;
use crate::math::Vector;
use crate::model::constants::constant::{Constant, Drifts, Follower, Parameter, pruned};
use std::sync::Arc;

/// The free parameters of a model.
#[derive(Clone, Debug)]
pub struct Sought {
    parameters: Arc<[Parameter]>,
    /// Scalar of the first one in an interval.
    first: usize,
    drifts: Arc<Drifts>,
}

/// Points of which an element reads the sum by parts.
pub(crate) struct MovedPoints<'a, const N: usize> {
    /// The parts.
    pub(crate) parts: [f64; N],
    /// The bodies of the presolved system that carry them; none is the ground.
    pub(crate) bodies: [Option<usize>; N],
    /// The constant that is the component along an axis of the place of a point, where places can be free.
    pub(crate) places: Option<&'a dyn Fn(usize, usize) -> Constant>,
}

impl Sought {
    pub(crate) fn new(parameters: &[Parameter], first: usize, drifts: Drifts) -> Self {
        Self {
            parameters: parameters.into(),
            first,
            drifts: drifts.into(),
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

    /// Returns true if a constant is free.
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
    /// A list where nothing is free.
    pub fn nothing() -> Self {
        Sought::new(&[], 0, Drifts::default()).read()
    }

    /// The parameters that were read, scalars of the interval.
    pub fn scalars(self) -> Vec<usize> {
        self.scalars
    }

    /// A constant that follows the parameters that were read.
    pub(crate) fn into_constant(self, of: Coefficient) -> FreeConstant {
        let parameters = self.scalars;
        FreeConstant { of, parameters }
    }

    /// The same, and the moves of what an element reads.
    pub(crate) fn with_moves(self) -> (Vec<usize>, Vec<Move>) {
        (self.scalars, self.moves)
    }

    /// Returns true if nothing that is free was read.
    pub fn is_empty(&self) -> bool {
        self.scalars.is_empty()
    }

    /// A constant as a function of parameters: its `value`, or what follows from one.
    pub fn constant(&mut self, constant: Constant, value: f64) -> Coefficient {
        let Some((parameter, follower)) = self.sought.find(constant) else {
            return value.into();
        };
        let [a, b] = follower.higher;
        let powers = [follower.offset, follower.factor, a, b];
        Coefficient::Parameter(self.place(parameter), powers)
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

    /// Notes the parameters that move points of which the weighted sum is vector `of` of the element; `index` gives a material vector its
    /// place. Returns the parameters, their values without a move, and the moves of the places themselves.
    pub(crate) fn moves<const N: usize>(
        &mut self,
        of: usize,
        points: MovedPoints<'_, N>,
        mut index: impl FnMut(MaterialVector) -> usize,
    ) -> Vec<(usize, f64, [Vector; N])> {
        let mut moves = Vec::new();
        let sought = self.sought.clone();
        for (p, parameter) in sought.parameters.iter().enumerate() {
            let own: [Vector; N] = std::array::from_fn(|point| match points.places {
                Some(place) => parameter.moves(|axis| place(point, axis)),
                None => Vector::zeros(),
            });
            let mut sum = MaterialVector::default();
            for (point, own) in own.iter().enumerate() {
                let drift = sought.drifts.of_point(p, points.bodies[point], own);
                sum = MaterialVector::combine(1.0, &sum, points.parts[point], &drift);
            }
            let is_changed = own.iter().any(|own| *own != Vector::zeros());
            let vector = pruned(&sum);
            if !is_changed && vector.is_none() {
                continue;
            }
            let (parameter, at) = (self.place(p), parameter.guess);
            if let Some(vector) = vector {
                let vector = index(vector);
                self.moves.push(Move {
                    of,
                    vector,
                    parameter,
                    at,
                });
            }
            moves.push((parameter, at, own));
        }
        moves
    }

    /// Forgets the moves, for an element that does not read what they move.
    pub fn stand_still(&mut self) {
        self.moves.clear();
    }

    /// The element of a law that reads these parameters.
    pub fn element<L, const M: usize, const NV: usize, const NS: usize>(
        self,
        law: L,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> LawElement<L, M, NV, NS> {
        LawElement {
            law,
            vectors,
            scalars,
            parameters: self.scalars,
            moves: self.moves,
        }
    }
}
