//! Sought parameters as components read them.

use crate::energy::Affine;
use crate::model::constant::{Constant, Follower, Parameter};

/// The sought parameters of a model.
#[derive(Clone, Debug)]
pub struct Sought {
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// Scalar of the first one in an interval.
    first: usize,
}

impl Sought {
    pub(super) fn new(parameters: &[Parameter], first: usize) -> Self {
        Self {
            parameters: parameters.to_vec(),
            first,
        }
    }

    /// Scalar of a parameter in an interval.
    pub fn scalar(&self, parameter: usize) -> usize {
        self.first + parameter
    }

    /// The parameter that a constant follows, and how; `None`: it is given.
    pub fn find(&self, constant: Constant) -> Option<(usize, Follower)> {
        let all = self.parameters.iter().enumerate();
        let mut pairs = all.flat_map(|(p, parameter)| {
            let followers = parameter.constants.iter();
            followers.map(move |&follower| (p, follower))
        });
        pairs.find(|(_, follower)| follower.constant == constant)
    }

    /// Returns true if a constant of some kind is sought.
    pub fn any(&self, is_kind: impl Fn(Constant) -> bool) -> bool {
        let constants = self.parameters.iter().flat_map(|p| &p.constants);
        constants
            .into_iter()
            .any(|follower| is_kind(follower.constant))
    }

    /// A constant as a function of the arguments of a formula: its `value`, or what follows from a parameter.
    pub fn constant(&self, constant: Constant, value: f64, arguments: &mut Arguments) -> Affine {
        match self.find(constant) {
            Some((parameter, follower)) => {
                let argument = arguments.of(self.scalar(parameter));
                Affine::single(argument, follower.factor).scaled(1.0, follower.offset)
            }
            None => value.into(),
        }
    }
}

/// Scalars of an element in the order in which its formula reads them, behind its vectors.
#[derive(Debug)]
pub struct Arguments {
    vectors: usize,
    scalars: Vec<Option<usize>>,
}

impl Arguments {
    /// Makes an empty list, behind this number of arguments that are components of vectors.
    pub fn new(vectors: usize) -> Self {
        Self {
            vectors,
            scalars: Vec::new(),
        }
    }

    /// The first scalar; `None` is zero.
    pub fn first(&mut self, scalar: Option<usize>) {
        self.scalars.push(scalar);
    }

    /// Place of a scalar of the interval among those of the element, which it joins if it is new.
    pub fn place(&mut self, scalar: usize) -> usize {
        let known = self.scalars.iter().position(|&s| s == Some(scalar));
        known.unwrap_or_else(|| {
            self.scalars.push(Some(scalar));
            self.scalars.len() - 1
        })
    }

    /// Argument of the formula that a scalar of the interval is.
    pub fn of(&mut self, scalar: usize) -> usize {
        self.vectors + self.place(scalar)
    }

    /// Number of scalars.
    pub fn count(&self) -> usize {
        self.scalars.len()
    }

    /// The scalars.
    pub fn scalars(self) -> Vec<Option<usize>> {
        self.scalars
    }
}
