//! Collection of the terms of components: elements of one kind make one term, those that read nothing that moves are left out, and the
//! reasons are recorded.

pub(super) mod block_terms;
pub(super) mod charged;
pub(super) mod constraints;
pub(super) mod field_extent;
pub(super) mod joint_constraints;
pub(super) mod loads;
pub(super) mod parametric_elements;
mod sheet_terms;

use crate::energy::{Coefficient, Gravity, KineticEnergy, Law};
use crate::functional::{
    FreeConstant, Group, Inertia, Kernel, LawElement, Mass, ScaledElement, Stencil, Term, VectorArg,
};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Vector;
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{Read, Sought};
use crate::model::layout::contact_reading::ContactReading;
use crate::model::layout::variables::Variables;
use crate::model::system::bodies::Attachment;
use crate::model::system::maxwell::Response;
use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Reason for the springs of branches at rest.
pub(super) const UNRELAXED: &str = "unrelaxed Maxwell branches of";

/// The bodies of the presolved system that carry those of the scene.
pub(crate) struct Carriers<'a> {
    /// The presolved body of each body of the scene; `None` is the ground.
    pub(super) of: Vec<Option<usize>>,
    /// Poses of the presolved bodies in the reference configuration.
    pub(super) reference: &'a [Pose],
}

impl Carriers<'_> {
    fn carrier(&self, body: Option<usize>) -> Option<usize> {
        self.of[body?]
    }

    /// The point as a vector, whose body is the one that carries it.
    pub(super) fn point(&self, point: &Attachment) -> MaterialVector {
        MaterialVector::point(self.carrier(point.body), &point.at, self.reference)
    }
}

/// Terms of components collected for the action.
pub struct Terms<'a> {
    bodies: Carriers<'a>,
    gravity: Option<Vector>,
    pub(super) vectors: &'a mut Vectors,
    variables: &'a Variables,
    /// Vectors of the nodes of each elastic block.
    nodes: Vec<&'a [usize]>,
    of_motion: bool,
    response: Response,
    sought: Sought,
    /// Coordinates of the elastic displacement of each contact that sticks, by its name.
    pub(super) bristles: BTreeMap<String, Range<usize>>,
    /// Readings of the contacts that were added.
    pub(super) contacts: Vec<ContactReading>,
    collected: Vec<Collected>,
    present: Vec<Present>,
    left_out: Vec<LeftOut>,
}

impl fmt::Debug for Terms<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&self.present).finish()
    }
}

/// Reason for a term: the name of the term, words such as "stiffness of", and the component.
#[derive(Clone, Copy)]
pub(super) struct Call<'a>(
    pub(super) &'static str,
    pub(super) &'static str,
    pub(super) &'a str,
);

impl Call<'_> {
    /// Adds an element.
    pub(super) fn add<K: Kernel>(self, element: K, terms: &mut Terms<'_>) {
        terms.collect(self.0, self.1, self.2, element);
    }

    /// Adds an element, of those that are no formulas of constants, times a constant that follows parameters.
    pub(super) fn add_scaled<K: Kernel>(self, of: K, factor: FreeConstant, terms: &mut Terms<'_>) {
        self.add(ScaledElement { of, factor }, terms);
    }

    /// Adds an element as it is given, or where parameters are read that of the constant one times the constant.
    pub(super) fn add_times<K: Kernel>(
        self,
        given: K,
        unit: K,
        factor: FreeConstant,
        terms: &mut Terms<'_>,
    ) {
        match factor.parameters.is_empty() {
            true => self.add(given, terms),
            false => self.add_scaled(unit, factor, terms),
        }
    }

    /// Adds an element that is linear in a constant, as it is for the value or times a free one.
    pub(super) fn add_linear<K: Kernel>(
        self,
        constant: Constant,
        value: f64,
        element: impl Fn(f64) -> K,
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let factor = read.constant(constant, value);
        self.add_times(
            element(value),
            element(1.0),
            read.into_constant(factor),
            terms,
        );
    }
}

/// Elements of one type under one name.
struct Collected {
    term: &'static str,
    /// A vector of the type.
    list: Box<dyn Any>,
    finish: fn(&str, Box<dyn Any>) -> Box<dyn Term>,
}

impl<'a> Terms<'a> {
    pub(super) fn new(
        bodies: Carriers<'a>,
        gravity: Option<Vector>,
        of_motion: bool,
        response: Response,
        sought: Sought,
        variables: &'a Variables,
        vectors: &'a mut Vectors,
    ) -> Self {
        Self {
            nodes: Vec::new(),
            bodies,
            gravity,
            vectors,
            variables,
            of_motion,
            response,
            sought,
            bristles: BTreeMap::new(),
            contacts: Vec::new(),
            collected: Vec::new(),
            present: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Returns true if inertia and dissipation count: a state of rest has neither.
    pub fn is_of_motion(&self) -> bool {
        self.of_motion
    }

    /// Returns true if Maxwell branches are springs that have not relaxed.
    pub(super) fn is_instantaneous(&self) -> bool {
        !self.of_motion && self.response == Response::Instantaneous
    }

    /// Says why terms of Maxwell branches are left out of a state of rest, should they be.
    pub(super) fn without_branches(&mut self, terms: [&'static str; 2]) {
        match (self.of_motion, self.response) {
            (true, _) => {}
            (false, Response::Relaxed) => {
                self.without_each(terms, "at rest Maxwell branches are relaxed");
            }
            (false, Response::Instantaneous) => {
                self.without(terms[1], "a state of rest dissipates nothing");
            }
        }
    }

    /// The point as a vector, whose body is the one that carries it.
    pub fn point(&self, point: &Attachment) -> MaterialVector {
        self.bodies.point(point)
    }

    /// The body of the presolved system that carries a point; none is the ground.
    pub(super) fn carrier(&self, point: &Attachment) -> Option<usize> {
        self.bodies.carrier(point.body)
    }

    /// Returns true if nothing moves the points.
    pub fn is_immobile(&self, points: &[Attachment]) -> bool {
        let mut carriers = points.iter().map(|p| self.bodies.carrier(p.body));
        carriers.all(|carrier| carrier.is_none())
    }

    /// The direction fixed in the body of a point that it has in the reference configuration.
    pub fn direction(&self, point: &Attachment, direction: &Vector) -> MaterialVector {
        let body = self.bodies.carrier(point.body);
        MaterialVector::direction(body, direction, self.bodies.reference)
    }

    /// The free parameters.
    pub fn sought(&self) -> &Sought {
        &self.sought
    }

    /// Index of a vector, for [`mid`] and [`rate`].
    pub fn vector(&mut self, vector: MaterialVector) -> usize {
        self.vectors.index(vector)
    }

    /// Index of a vector that is known to be new.
    pub(super) fn new_vector(&mut self, vector: MaterialVector) -> usize {
        self.vectors.push(vector)
    }

    /// Index of the vector from one point to another; `None` where no motion of the robot changes its length.
    pub fn span(&mut self, from: &Attachment, to: &Attachment) -> Option<usize> {
        let [a, b] = [from, to].map(|end| self.bodies.carrier(end.body));
        (a != b).then(|| {
            let span = MaterialVector::span(&self.point(from), &self.point(to));
            self.vectors.index(span)
        })
    }

    /// With the vectors of the nodes of each elastic block.
    pub(super) fn with_nodes(mut self, nodes: impl Iterator<Item = &'a [usize]>) -> Self {
        self.nodes = nodes.collect();
        self
    }

    /// Index of the vector from a point to the node of an elastic block; `None` where both stay as they are.
    pub(super) fn span_to_node(&mut self, from: &Attachment, node: [usize; 2]) -> Option<usize> {
        let [block, node] = node;
        let to = self.nodes[block][node];
        let span = MaterialVector::span(&self.point(from), &self.vectors.list()[to]);
        let span = self.vectors.index(span);
        self.moves(span).then_some(span)
    }

    /// Index of a vector that stays as it is.
    pub(super) fn on_ground(&mut self, vector: &Vector) -> usize {
        let fixed = MaterialVector::direction(None, vector, self.bodies.reference);
        self.vectors.index(fixed)
    }

    /// Returns true if a vector of the list moves with a body, a node or a coordinate.
    pub fn moves(&self, vector: usize) -> bool {
        self.vectors.moves(vector)
    }

    /// Returns true if a scalar of the intervals has an equation of its own.
    pub fn is_unknown(&self, scalar: usize) -> bool {
        self.variables.place(scalar).is_some()
    }

    /// Scalar of the voltage of a source; `None` where it is zero all the time, or does nothing.
    pub fn input(&self, source: usize) -> Option<usize> {
        self.variables.input(source)
    }

    /// Adds an element of the intervals: an energy, or where it has virtual displacements a virtual work.
    ///
    /// `term` names the term in reports, which holds all elements of that name; `why` says what of the component `of` calls for
    /// it: "stiffness of".
    pub fn add<K: Kernel>(&mut self, term: &'static str, why: &'static str, of: &str, element: K) {
        self.collect(term, why, of, element);
    }

    /// Adds the formula of a law, like [`add`](Self::add); with the parameters that it reads where constants of it are free.
    pub fn add_law<L, const M: usize, const NV: usize, const NS: usize>(
        &mut self,
        term: &'static str,
        why: &'static str,
        of: &str,
        element: LawElement<L, M, NV, NS>,
    ) where
        L: Law<M>,
    {
        match element.given() {
            Some(given) => self.add(term, why, of, given),
            None => self.add(term, why, of, element),
        }
    }

    /// Notes that a part of the scene calls for a term.
    pub(super) fn note(&mut self, term: &'static str, why: &'static str, of: &str) {
        note(&mut self.present, term, why, of);
    }

    /// Gravity in mm/ms² as an element reads it, where there is any.
    pub(super) fn gravity(&self, read: &mut Read) -> Option<[Coefficient; 3]> {
        let g = self.gravity?;
        Some([0, 1, 2].map(|axis| read.constant(Constant::Gravity(axis), g[axis])))
    }

    /// Size of gravity in mm/ms² as it is written; zero where there is none.
    pub(super) fn gravity_size(&self) -> f64 {
        self.gravity.unwrap_or_default().norm()
    }

    /// Adds the weight of a mass in g at a point, where there is gravity; of what the mass follows was `read`.
    pub(super) fn weigh(&mut self, point: &MaterialVector, mass: &Coefficient, read: Read) {
        if self.gravity.is_some() {
            let vector = self.vectors.index(point.clone());
            self.weigh_vector(vector, mass, read);
        }
    }

    /// Adds the weight of a mass in g at the point of a vector of the list, where there is gravity.
    pub(super) fn weigh_vector(&mut self, vector: usize, mass: &Coefficient, mut read: Read) {
        if let Some(gravity) = self.gravity(&mut read) {
            let weight = Gravity {
                weight: gravity.map(|g| &g * mass).into(),
            };
            let element = read.element(weight, [mid(vector)], []);
            self.add_law(GRAVITY, "gravity of", "the scene", element);
        }
    }

    /// Adds the kinetic energy of a mass in g on a vector of the list; of what it follows was `read`.
    pub(super) fn add_mass(
        &mut self,
        call: Call<'_>,
        vector: usize,
        mass: Coefficient,
        read: Read,
    ) {
        let element = read.element(KineticEnergy { mass }, [rate(vector)], []);
        self.add_law(call.0, call.1, call.2, element);
    }

    /// Says why a term is left out, should it be; the first reason counts.
    pub fn without(&mut self, term: &'static str, why: &'static str) {
        if self.left_out.iter().all(|known| known.term != term) {
            self.left_out.push(LeftOut { term, why });
        }
    }

    /// The same of several terms.
    pub(super) fn without_each<const N: usize>(
        &mut self,
        terms: [&'static str; N],
        why: &'static str,
    ) {
        terms.into_iter().for_each(|term| self.without(term, why));
    }

    /// Adds an element to those of its type under the same name.
    pub(super) fn collect<T: Member>(
        &mut self,
        term: &'static str,
        why: &'static str,
        of: &str,
        element: T,
    ) {
        self.note(term, why, of);
        self.push(term, element);
    }

    /// Adds an element whose parts of the scene are [noted](Self::note) by themselves.
    pub(super) fn push<T: Member>(&mut self, term: &'static str, element: T) {
        let mut same = self.collected.iter_mut().filter(|c| c.term == term);
        if let Some(list) = same.find_map(|c| c.list.downcast_mut::<Vec<T>>()) {
            list.push(element);
            return;
        }
        self.collected.push(Collected {
            term,
            list: Box::new(vec![element]),
            finish: |name, list| {
                let list = list.downcast::<Vec<T>>();
                T::term(name, *list.expect("a list of its own elements"))
            },
        });
    }

    /// Returns the terms in the order of the sum, in which `rank` is the place of each, their reasons, and the absent terms.
    pub(super) fn finish(
        mut self,
        rank: impl Fn(&str) -> usize,
    ) -> (Vec<Arc<dyn Term>>, Vec<Present>, Vec<LeftOut>) {
        self.collected.sort_by_key(|collected| rank(collected.term));
        let collected = self.collected.into_iter();
        let terms = collected.map(|c| Arc::from((c.finish)(c.term, c.list)));
        (terms.collect(), self.present, self.left_out)
    }
}

/// The vector in the middle of an interval.
pub fn mid(vector: usize) -> VectorArg {
    Stencil::Mid.of(vector)
}

/// The rate of the vector in an interval.
pub fn rate(vector: usize) -> VectorArg {
    Stencil::Rate.of(vector)
}

/// Element that makes one term together with all of its type.
pub(super) trait Member: Sized + 'static {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term>;
}

impl Member for Mass {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        Box::new(Inertia::new(name, list))
    }
}

/// The action has the kinetic energy less the potential one; a virtual work is added.
impl<K: Kernel> Member for K {
    fn term(name: &str, list: Vec<Self>) -> Box<dyn Term> {
        let is_added = K::KINETIC || K::VIRTUAL > 0;
        let scale = if is_added { 1.0 } else { -1.0 };
        Box::new(Group::intervals(name, scale, list))
    }
}

/// Weight, the one term that acts in every place with a mass.
pub(super) const GRAVITY: &str = "gravity";

/// Term that is present, with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Present {
    /// Name of the term.
    pub term: &'static str,
    /// Reason, before the names: "stiffness of".
    pub why: &'static str,
    /// Names of the parts of the scene that do.
    pub of: Vec<String>,
}

/// A term that is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the term.
    pub term: &'static str,
    /// Reason why it is absent.
    pub why: &'static str,
}

/// Notes that a part of the scene calls for a term.
pub(super) fn note(present: &mut Vec<Present>, term: &'static str, why: &'static str, of: &str) {
    let same = |p: &&mut Present| p.term == term && p.why == why;
    match present.iter_mut().rev().find(same) {
        // Parts come one after the other.
        Some(known) if known.of.last().is_some_and(|last| last == of) => {}
        Some(known) => known.of.push(of.to_owned()),
        None => present.push(Present {
            term,
            why,
            of: vec![of.to_owned()],
        }),
    }
}
