//! Measures of quantities: the vectors and scalars that they read, and their formulas.

use crate::element::FieldPoint;
use crate::energy::{
    Angle, AngleStep, ChargedMembrane, ContactForce, ContactGap, Cores, DielectricMembrane, Energy,
    Law, Multiple, OfCores, OutsideBox, PeakExcess, PositionComponent, Projection, ProjectionStep,
    SquaredDistance, law,
};
use crate::functional::{
    Curved, Element, ElementField, Group, Kernel, LawElement, Measure, Stencil, Term, VectorArg,
};
use crate::kinematics::{MaterialVector, Vectors};
use crate::math::{Jet, Number, Vector};
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::{MuscleConstants, charge_field};
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::{MovedPoints, Read};
use crate::model::construction::Construction;
use crate::model::layout::solid_block::{SolidBlock, of_shape};
use crate::model::layout::variables::Role;
use crate::model::quantities::quantity::Quantity;
use crate::model::quantities::what::{At, FieldPlace, Of, Region, What};
use crate::model::system::joints::JointCoordinate;
use crate::model::system::{Amount, Attachment, Marker};
use crate::model::terms::Present;
use crate::model::terms::constraints::GLUE;
use nalgebra::SVector;
use std::sync::Arc;

/// V in a kV.
const KILOVOLT: f64 = 1e3;

/// Measures by site, in the order of the quantities.
#[derive(Debug, Default)]
pub(crate) struct Measures {
    pub(crate) instants: Vec<Box<dyn Measure>>,
    pub(crate) intervals: Vec<Box<dyn Measure>>,
    /// Index of each quantity among those of its site; `None` where nothing of the model can change it.
    pub(crate) places: Vec<Option<usize>>,
    /// Vector of each marker.
    pub(crate) markers: Vec<usize>,
}

impl Measures {
    /// The measures of the quantities of an analysis, from the terms of the intervals and what is present.
    pub(crate) fn new(
        known: &Construction<'_>,
        terms: &[Arc<dyn Term>],
        present: &[Present],
        vectors: &mut Vectors,
    ) -> Self {
        let mut marker = |marker: &Marker| match marker.solid {
            Some(solid) => known.blocks.list[solid].nearest(&marker.point.at),
            None => {
                let Attachment { body, at } = &marker.point;
                vectors.index(MaterialVector::point(*body, at, known.reference))
            }
        };
        let markers = known.presolved.system.markers.iter();
        let mut out = Self {
            markers: markers.map(&mut marker).collect(),
            ..Self::default()
        };
        let is_glued = present.iter().any(|one| one.term == GLUE);
        let analysis = known.analysis;
        for (index, quantity) in analysis.quantities.iter().enumerate() {
            let list = match quantity.is_of_intervals() {
                true => &mut out.intervals,
                false => &mut out.instants,
            };
            let mut reading = Reading {
                known,
                markers: &out.markers,
                terms,
                is_glued,
                quantity,
                vectors: &mut *vectors,
            };
            let is_curved = analysis.curved.contains(&index);
            let measure = reading.measure().map(|measure| -> Box<dyn Measure> {
                match is_curved {
                    true => Box::new(Curved::new(measure)),
                    false => measure,
                }
            });
            out.places.push(measure.is_some().then_some(list.len()));
            list.extend(measure);
        }
        out
    }
}

/// A quantity whose measure is made.
pub(super) struct Reading<'k, 'v> {
    pub(super) known: &'k Construction<'k>,
    /// Vector of each marker.
    markers: &'k [usize],
    /// Terms of the intervals.
    pub(super) terms: &'k [Arc<dyn Term>],
    /// True if constraints glue blocks to bodies, so that terms do not tell the forces on bodies.
    pub(super) is_glued: bool,
    pub(super) quantity: &'k Quantity,
    pub(super) vectors: &'v mut Vectors,
}

/// Measure of an element.
fn alone<K: Kernel>(element: K) -> Box<dyn Measure> {
    Box::new(Group::intervals("measure", 1.0, vec![element]))
}

/// A list of a known length.
fn array<const N: usize>(list: &[usize]) -> [usize; N] {
    std::array::from_fn(|i| list[i])
}

/// Midpoints of vectors, then their rates.
fn read_twice<const N: usize>(vectors: &[usize]) -> [VectorArg; N] {
    let count = vectors.len();
    std::array::from_fn(|i| match i < count {
        true => Stencil::Mid.of(vectors[i]),
        false => Stencil::Rate.of(vectors[i - count]),
    })
}

/// A measure; none where nothing of the model can change the quantity.
pub(super) type Made = Option<Box<dyn Measure>>;

impl<'k> Reading<'k, '_> {
    fn measure(&mut self) -> Made {
        match self.quantity.what {
            What::Joint { joint, near } => self.joint(joint, near),
            What::Stretch(muscle) => {
                let span = self.span(muscle);
                let of = self.muscle(muscle);
                let stretch = of.stretch();
                self.law::<_, 3, 1, 0>(of.element(stretch, [self.at(span)], []))
            }
            What::Capacitance(muscle) => {
                self.known.variables.input(muscle)?;
                let energy = capacitance(&self.known.presolved.system.muscles[muscle])?;
                let span = self.span(muscle);
                self.instant(energy, [span])
            }
            What::Place { .. } | What::Region { .. } | What::Clearance { .. } | What::Speed(_) => {
                self.of_marker()
            }
            What::Gap(contact) | What::ContactForce(contact) => self.of_contact(contact),
            What::Direction { body, axis, along } => {
                let body = self.known.presolved.carrier(Some(body));
                let direction = MaterialVector::direction(body, &axis, self.known.reference);
                let (origin, normal) = (Vector::zeros(), along);
                let component = PositionComponent { origin, normal };
                let direction = self.vectors.index(direction);
                self.instant(component, [direction])
            }
            What::PeakVoltage(parameter) => {
                let multiple = Multiple { unit: KILOVOLT };
                self.formula::<_, 1, 0, 1>(multiple, [], [self.parameter(parameter)?])
            }
            What::Voltage(source) => {
                let voltage = [self.known.variables.input(source)?];
                self.formula::<_, 1, 0, 1>(Multiple { unit: 1.0 }, [], voltage)
            }
            What::PeakExcess {
                source,
                parameter,
                unit,
            } => {
                let voltage = self.known.variables.input(source)?;
                let scalars = [voltage, self.parameter(parameter)?];
                self.formula::<_, 2, 0, 2>(PeakExcess { unit }, [], scalars)
            }
            What::Amount {
                ref muscles,
                amount,
            } => self.amount(muscles, amount),
            What::ChargedField(muscle) => self.charged_field(muscle),
            What::Current(source) | What::Power(source) => self.flow(source),
            What::Charge(source) => self.charge(source),
            What::MeanCharge(muscle) => self.mean_charge(muscle),
            What::ElectrodeVoltage(source) => self.across(source),
            What::Energy(muscle) => self.stored_energy(muscle),
            What::Tension(part) => self.tension(part),
            What::Reaction { joint, of, along } => self.reaction(joint, of, along),
            What::Field(FieldPlace::Muscle(muscle)) => self.muscle_field(muscle),
            What::Field(FieldPlace::Element {
                block,
                element,
                point,
            }) => self.element_field(block, element, point),
            What::Field(FieldPlace::Block { .. }) => None,
        }
    }

    /// The reading of a vector at the time of the quantity.
    pub(super) fn at(&self, vector: usize) -> VectorArg {
        self.quantity.at.stencil().of(vector)
    }

    /// Measure of a law.
    pub(super) fn law<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
        &self,
        element: LawElement<L, M, NV, NS>,
    ) -> Made {
        Some(match element.given() {
            Some(given) => alone(given),
            None => alone(element),
        })
    }

    /// Measure of a formula of vectors of an instant.
    pub(super) fn instant<E: Energy<M> + 'static, const M: usize, const NV: usize>(
        &self,
        energy: E,
        vectors: [usize; NV],
    ) -> Made {
        self.formula::<E, M, NV, 0>(energy, vectors.map(|v| Stencil::Here.of(v)), [])
    }

    /// Measure of a formula of vectors and scalars.
    pub(super) fn formula<E, const M: usize, const NV: usize, const NS: usize>(
        &self,
        energy: E,
        vectors: [VectorArg; NV],
        scalars: [usize; NS],
    ) -> Made
    where
        E: Energy<M> + 'static,
    {
        let element = Element::<E, M, NV, NS> {
            energy,
            vectors,
            scalars,
        };
        Some(alone(element))
    }

    /// Scalar of a free parameter; none where parameters are put in.
    fn parameter(&self, parameter: usize) -> Option<usize> {
        let mut parameters = self.known.variables.range(Role::Parameter);
        parameters.nth(parameter)
    }

    /// Gap or normal force of a contact.
    fn of_contact(&mut self, contact: usize) -> Made {
        let contact = &self.known.system.components.contacts[contact];
        let mut terms = self.known.no_terms(self.vectors);
        let reading = contact.reading(&mut terms)?;
        let (law, unit) = (reading.law, self.quantity.unit);
        let force = ContactForce { law, unit };
        if let Some(cores) = reading.cores {
            return self.of_cored_contact(force, cores, &reading.normal_vectors());
        }
        let both = [Stencil::Mid, Stencil::Rate];
        match (&self.quantity.what, &reading.normal_vectors()[..]) {
            (What::Gap(_), &[r]) => self.instant::<_, 3, 1>(ContactGap(law), [r]),
            (What::Gap(_), &[r, n]) => self.instant::<_, 6, 2>(ContactGap(law), [r, n]),
            (_, &[r]) => self.formula::<_, 6, 2, 0>(force, both.map(|at| at.of(r)), []),
            (_, &[r, n]) => {
                let [[a, b], [c, d]] = both.map(|at| [at.of(r), at.of(n)]);
                self.formula::<_, 12, 4, 0>(force, [a, b, c, d], [])
            }
            _ => None,
        }
    }

    /// Gap or normal force of a contact between shapes with cores.
    fn of_cored_contact(&mut self, of: ContactForce, cores: Cores, vectors: &[usize]) -> Made {
        let gap = ContactGap(of.law);
        let (gap, force) = (OfCores { of: gap, cores }, OfCores { of, cores });
        match (&self.quantity.what, vectors.len()) {
            (What::Gap(_), 2) => self.instant::<_, 6, 2>(gap, array(vectors)),
            (What::Gap(_), 3) => self.instant::<_, 9, 3>(gap, array(vectors)),
            (What::Gap(_), 4) => self.instant::<_, 12, 4>(gap, array(vectors)),
            (What::Gap(_), _) => self.instant::<_, 15, 5>(gap, array(vectors)),
            (_, 2) => self.formula::<_, 12, 4, 0>(force, read_twice(vectors), []),
            (_, 3) => self.formula::<_, 18, 6, 0>(force, read_twice(vectors), []),
            (_, 4) => self.formula::<_, 24, 8, 0>(force, read_twice(vectors), []),
            (_, _) => self.formula::<_, 30, 10, 0>(force, read_twice(vectors), []),
        }
    }

    /// Angle or displacement of a joint, or its step in an interval.
    fn joint(&mut self, joint: usize, near: f64) -> Made {
        let joint = self.known.presolved.joint(joint)?;
        let joint = &self.known.presolved.system.joints[joint];
        let is_step = self.quantity.is_step();
        let both = [Stencil::Here, Stencil::Next];
        match JointCoordinate::new(joint, self.known.reference)? {
            JointCoordinate::Angle { vectors } => {
                let vectors = vectors.map(|x| self.vectors.index(x));
                if !is_step {
                    return self.instant(Angle { near }, vectors);
                }
                let [[a, b, c], [d, e, f]] = both.map(|at| vectors.map(|vector| at.of(vector)));
                self.formula::<_, 18, 6, 0>(AngleStep, [a, b, c, d, e, f], [])
            }
            JointCoordinate::Displacement { axis, span } => {
                let vectors = [axis, span].map(|x| self.vectors.index(x));
                if !is_step {
                    return self.instant(Projection, vectors);
                }
                let [[n, r], [m, s]] = both.map(|at| vectors.map(|vector| at.of(vector)));
                self.formula::<_, 12, 4, 0>(ProjectionStep, [n, r, m, s], [])
            }
        }
    }

    /// Squared field `D (V/H)²` of a triangle of a membrane at a point, or the first one, over the one of the unit.
    fn sheet_field(&mut self, block: &SolidBlock, element: usize, point: usize) -> Made {
        let points = block.sheets[element].get(point)?;
        let places = block.nodes::<6>(element);
        let tangents = points.sums(|node| &self.vectors.list()[places[node]]);
        let tangents = tangents.map(|tangent| self.vectors.index(tangent));
        let vectors = tangents.map(|tangent| self.at(tangent));
        let [terminal, ..] = block.terminals::<6>(element);
        let factor = terminal
            .scalar
            .map_or(terminal.constant, |(_, factor)| factor);
        let of = DielectricMembrane {
            volume: 1.0,
            c1: 0.0,
            c2: 0.0,
            permittivity: -2.0,
            thickness: block.thickness() * self.quantity.unit / factor,
        };
        match terminal.scalar {
            Some((scalar, _)) => self.formula::<_, 7, 2, 1>(of, vectors, [scalar]),
            None => self.formula::<_, 6, 2, 0>(ChargedMembrane { of }, vectors, []),
        }
    }

    /// Squared field of an element of a block, at its centre or at a Gauss point, over the one of the unit.
    fn element_field(&mut self, block: usize, element: usize, point: Option<usize>) -> Made {
        let block = &self.known.blocks.list[block];
        if !block.is_dielectric[element] {
            return None;
        }
        if block.solid.is_membrane() {
            return self.sheet_field(block, element, point.unwrap_or_default());
        }
        let limit = self.quantity.unit;
        of_shape!(&block.shapes[element], shape => {
            let gradients = match point {
                Some(point) => shape.gradients_at(point),
                None => block.central_gradients(element)?,
            };
            let field = ElementField {
                point: FieldPoint { gradients, limit },
                nodes: block.nodes(element),
                terminals: block.terminals(element),
                at: self.quantity.at.stencil(),
            };
            Some(alone(field))
        })
    }

    /// Squared field of a lumped muscle over the one of the unit.
    fn muscle_field(&mut self, muscle: usize) -> Made {
        let limit = self.quantity.unit;
        let span = self.span(muscle);
        let span = [self.at(span)];
        let mut of = self.muscle(muscle);
        if let Some(source) = self.known.system.charge_of(muscle) {
            let charge = [self.known.variables.input(source)?];
            let field = charge_field(of.capacitance()?, limit);
            return self.law(of.element(field, span, charge));
        }
        let voltage = [self.known.variables.input(muscle)?];
        let field = of.field(limit);
        self.law(of.element(field, span, voltage))
    }

    /// Amount of muscles; none where no free parameter moves it.
    fn amount(&self, muscles: &[usize], amount: Amount) -> Made {
        let element = |&m: &usize| {
            let (muscle, read) = (&self.known.system.muscles[m], self.known.sought.read());
            let constants = MuscleConstants::new(muscle, m, read, [0.0; 2], [None; 2], |_| 0);
            let mut constants = constants.still();
            let amount = match amount {
                Amount::Volume => constants.volume(),
                Amount::Mass => constants.mass(1.0)?,
            };
            Some(constants.element::<_, 0, 0, 0>(ConstantFormula(amount), [], []))
        };
        let elements: Vec<_> = muscles.iter().filter_map(element).collect();
        let is_moved = elements.iter().any(|one| !one.parameters.is_empty());
        let scale = 1.0 / self.quantity.unit;
        let group = || Group::intervals("measure", scale, elements);
        is_moved.then(|| Box::new(group()) as Box<dyn Measure>)
    }

    /// The constants of a muscle, whose span is the first vector of an element; given ones at the instants, where no parameter is read.
    pub(super) fn muscle(&mut self, index: usize) -> MuscleConstants<'k> {
        let muscle = &self.known.presolved.system.muscles[index];
        if self.quantity.at == At::Instant {
            return MuscleConstants::given(muscle);
        }
        let read = self.known.sought.read();
        let bodies = [muscle.from.body, muscle.to.body];
        MuscleConstants::new(muscle, index, read, [-1.0, 1.0], bodies, |moved| {
            self.vectors.index(moved)
        })
    }

    /// Vector of the span of a muscle.
    pub(super) fn span(&mut self, muscle: usize) -> usize {
        let muscle = &self.known.presolved.system.muscles[muscle];
        let [from, to] = [&muscle.from, &muscle.to]
            .map(|end| MaterialVector::point(end.body, &end.at, self.known.reference));
        self.vectors.index(MaterialVector::span(&from, &to))
    }
}

/// A number without arguments.
#[derive(Clone, Copy, Debug)]
struct ConstantFormula<T>(T);

law!(ConstantFormula { 0 } of 0);

impl<T: Number> Energy<0, T> for ConstantFormula<T> {
    type Local<const ORDER: usize> = Jet<0, ORDER, T>;

    fn at<const ORDER: usize>(&self, _: &SVector<T, 0>, _: &SVector<T, 0>) -> Jet<0, ORDER, T> {
        Jet::constant(self.0)
    }
}

impl Reading<'_, '_> {
    /// Place, velocity or clearance of a marker.
    pub(super) fn of_marker(&mut self) -> Made {
        let origin = Vector::zeros();
        match self.quantity.what {
            What::Place { marker, axis } => {
                let normal = Vector::ith(axis, 1.0);
                self.marker(marker, PositionComponent { origin, normal })
            }
            // At most one inside a sphere, at least three only outside a box.
            What::Region { marker, region } => match region {
                Region::Sphere { centre, radius } => {
                    let scale = radius.into();
                    self.marker(marker, SquaredDistance { centre, scale })
                }
                Region::Box { min, max } => {
                    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
                    self.marker(marker, OutsideBox { centre, half })
                }
            },
            What::Speed(marker) => {
                let (centre, scale) = (origin, self.quantity.unit.into());
                self.marker(marker, SquaredDistance { centre, scale })
            }
            What::Clearance { marker, plane } => {
                let (reference, list) = (self.known.reference, self.vectors.list());
                let body = self.known.presolved.carrier(plane.body);
                let normal = MaterialVector::direction(body, &plane.normal, reference);
                let foot = MaterialVector::point(body, &plane.point, reference);
                let place = list[self.markers[marker]].clone();
                let read = [normal, MaterialVector::span(&foot, &place)];
                let read = read.map(|vector| self.vectors.index(vector));
                self.instant(Projection, read)
            }
            _ => None,
        }
    }

    /// Measure of a law of the place or velocity of a marker, with the parameters that move it in the intervals.
    fn marker<L: Law<3>>(&mut self, marker: usize, law: L) -> Made {
        let vector = self.markers[marker];
        let read = match (&self.quantity.what, self.quantity.of) {
            (What::Speed(_), _) => Stencil::Rate.of(vector),
            (_, Of::Step) => Stencil::Difference.of(vector),
            _ => self.at(vector),
        };
        let moved = match self.quantity.at {
            At::Instant => Read::nothing(),
            _ => self.moved_marker(marker),
        };
        self.law::<_, 3, 1, 0>(moved.element(law, [read], []))
    }

    /// The parameters that move a marker.
    fn moved_marker(&mut self, marker: usize) -> Read {
        let mut moved = self.known.sought.read();
        let of = &self.known.presolved.system.markers[marker];
        let point = MovedPoints {
            parts: [1.0],
            bodies: [of.point.body],
            places: Some(&|_, axis| Constant::MarkerPlace(marker, axis)),
        };
        if of.solid.is_none() {
            moved.moves(0, point, |vector| self.vectors.index(vector));
        }
        moved
    }
}
