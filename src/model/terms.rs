//! Where components hand over their terms: what reads nothing that moves is left out, what is of one kind is collected, and the
//! reasons are written down.

use crate::energy::Energy;
use crate::functional::{Effect, Element, Group, Path, Paths, Stencil, VectorArg};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::model::attachment::Attachment;
use crate::model::condensed::Condensed;
use std::any::Any;
use std::fmt;

/// A term that is there and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Present {
    /// Name of the term.
    pub term: &'static str,
    /// What of its components calls for it.
    pub why: &'static str,
    /// Names of these components.
    pub of: Vec<String>,
}

/// A term that a component could have and has not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the term.
    pub term: &'static str,
    /// Why it is not there.
    pub why: &'static str,
}

/// Terms of components on their way to the action.
pub struct Terms<'a> {
    condensed: &'a Condensed,
    reference: &'a [Pose],
    vectors: &'a mut Vectors,
    of_motion: bool,
    collected: Vec<Collected>,
    left_out: Vec<LeftOut>,
}

impl fmt::Debug for Terms<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let present = self.collected.iter().map(|collected| &collected.present);
        f.debug_list().entries(present).finish()
    }
}

/// Elements of one type under one name.
struct Collected {
    present: Present,
    /// A vector of the type.
    list: Box<dyn Any>,
    finish: fn(&str, Box<dyn Any>) -> Box<dyn Effect>,
}

/// What elements of one type are together.
trait Member: Sized + 'static {
    fn effect(name: &str, list: Vec<Self>) -> Box<dyn Effect>;
}

impl Member for Path {
    fn effect(name: &str, list: Vec<Self>) -> Box<dyn Effect> {
        Box::new(Paths::new(name, list))
    }
}

/// An element with the number of arguments of its formula.
struct Of<E, const M: usize, const NV: usize, const NS: usize>(Element<E, NV, NS>);

impl<E, const M: usize, const NV: usize, const NS: usize> Member for Of<E, M, NV, NS>
where
    E: Energy<M> + 'static,
{
    fn effect(name: &str, list: Vec<Self>) -> Box<dyn Effect> {
        // The action has the kinetic energy less the potential one.
        let scale = if E::VIRTUAL == 0 { -1.0 } else { 1.0 };
        let elements = list.into_iter().map(|Self(element)| element).collect();
        Box::new(Group::intervals(name, scale, elements))
    }
}

impl<'a> Terms<'a> {
    pub(super) fn new(
        condensed: &'a Condensed,
        reference: &'a [Pose],
        of_motion: bool,
        vectors: &'a mut Vectors,
    ) -> Self {
        Self {
            condensed,
            reference,
            vectors,
            of_motion,
            collected: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Whether inertia and dissipation count: a state of rest has neither.
    pub fn is_of_motion(&self) -> bool {
        self.of_motion
    }

    /// Index of the vector from one point to another, for [`mid`] and [`rate`]; `None` where no motion of the robot changes it.
    pub fn span(&mut self, from: &Attachment, to: &Attachment) -> Option<usize> {
        let [a, b] = [from, to].map(|end| self.condensed.carrier(end.body));
        if a == b {
            return None;
        }
        let point = |body, end: &Attachment| MaterialVector::point(body, &end.at, self.reference);
        let span = MaterialVector::span(&point(a, from), &point(b, to));
        Some(self.vectors.index(span))
    }

    /// Adds a formula of vectors of the intervals: a potential energy, or where it has virtual displacements a virtual work.
    ///
    /// `term` names the term in reports, which holds all elements of that name; `why` says what of the component `of` calls for
    /// it: "stiffness".
    pub fn add<E, const M: usize, const NV: usize, const NS: usize>(
        &mut self,
        term: &'static str,
        why: &'static str,
        of: &str,
        element: Element<E, NV, NS>,
    ) where
        E: Energy<M> + 'static,
    {
        self.collect(term, why, of, Of::<E, M, NV, NS>(element));
    }

    /// Adds the energy of the length of a path.
    pub fn add_path(&mut self, term: &'static str, why: &'static str, of: &str, path: Path) {
        self.collect(term, why, of, path);
    }

    /// Says why a term is left out.
    pub fn without(&mut self, term: &'static str, why: &'static str) {
        let left_out = LeftOut { term, why };
        if !self.left_out.contains(&left_out) {
            self.left_out.push(left_out);
        }
    }

    fn collect<T: Member>(&mut self, term: &'static str, why: &'static str, of: &str, element: T) {
        let of = of.to_owned();
        for collected in &mut self.collected {
            if collected.present.term == term
                && let Some(list) = collected.list.downcast_mut::<Vec<T>>()
            {
                list.push(element);
                collected.present.of.push(of);
                return;
            }
        }
        self.collected.push(Collected {
            present: Present {
                term,
                why,
                of: vec![of],
            },
            list: Box::new(vec![element]),
            finish: |name, list| {
                let list = list.downcast::<Vec<T>>();
                T::effect(name, *list.expect("a list of its own elements"))
            },
        });
    }

    /// The terms, what they are there for, and what is left out.
    pub(super) fn finish(self) -> (Vec<Box<dyn Effect>>, Vec<Present>, Vec<LeftOut>) {
        let (mut effects, mut present) = (Vec::new(), Vec::new());
        for collected in self.collected {
            effects.push((collected.finish)(collected.present.term, collected.list));
            present.push(collected.present);
        }
        let is_there = |left_out: &LeftOut| present.iter().any(|p| p.term == left_out.term);
        let left_out = self.left_out.into_iter().filter(|l| !is_there(l)).collect();
        (effects, present, left_out)
    }
}

/// The vector in the middle of an interval.
pub fn mid(vector: usize) -> VectorArg {
    VectorArg {
        vector,
        stencil: Stencil::Mid,
    }
}

/// The rate of the vector in an interval.
pub fn rate(vector: usize) -> VectorArg {
    VectorArg {
        vector,
        stencil: Stencil::Rate,
    }
}
