//! Measures of quantities: the vectors and scalars that they read, and their formulas.

use crate::element::FieldPoint;
use crate::energy::{
    Angle, AngleStep, Coefficient, Energy, Law, Multiple, PeakExcess, PositionComponent,
    Projection, ProjectionStep, law,
};
use crate::functional::{
    Curved, Element, ElementField, ElementFields, Formulas, Group, Kernel, LawElement, Laws,
    Measure, Stencil, Term, VectorArg,
};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::{Jet, Number, Vector};
use crate::model::analysis::Analysis;
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::{MuscleConstants, charge_field};
use crate::model::electrode_circuits::ElectrodeCircuit;
use crate::model::free_parameters::Sought;
use crate::model::internal::Internals;
use crate::model::joints::{JointCoordinate, JointReading};
use crate::model::no_terms::no_terms;
use crate::model::presolved::Presolved;
use crate::model::quantity::Quantity;
use crate::model::solid_block::SolidBlock;
use crate::model::system::{Amount, System};
use crate::model::terms::Terms;
use crate::model::variables::{Role, Variables};
use crate::model::what::{At, FieldPlace, Pulling, What};
use nalgebra::SVector;
use std::sync::Arc;

/// V in a kV.
const KILOVOLT: f64 = 1e3;

/// Measures by site, in the order of the quantities.
#[derive(Debug, Default)]
pub(super) struct Measures {
    pub(super) instants: Vec<Box<dyn Measure>>,
    pub(super) intervals: Vec<Box<dyn Measure>>,
    /// Index of each quantity among those of its site; `None` where nothing of the model can change it.
    pub(super) places: Vec<Option<usize>>,
}

/// Data on which quantities are measured.
#[derive(Clone, Debug)]
pub(super) struct Known<'a> {
    pub(super) system: &'a System,
    pub(super) analysis: &'a Analysis,
    pub(super) presolved: &'a Presolved,
    pub(super) internals: &'a Internals,
    pub(super) reference: &'a [Pose],
    pub(super) variables: &'a Variables,
    /// Vector of each marker.
    pub(super) markers: &'a [usize],
    pub(super) blocks: &'a [SolidBlock],
    pub(super) circuits: &'a [ElectrodeCircuit],
    /// Terms of the intervals.
    pub(super) terms: &'a [Arc<dyn Term>],
    /// The free parameters.
    pub(super) sought: Sought,
    /// True if constraints glue blocks to bodies, so that terms do not tell the forces on bodies.
    pub(super) is_glued: bool,
}

impl Measures {
    /// The measures of the quantities of an analysis.
    pub(super) fn new(analysis: &Analysis, known: &Known<'_>, vectors: &mut Vectors) -> Self {
        let mut out = Self::default();
        for (index, quantity) in analysis.quantities.iter().enumerate() {
            let shape = match analysis.curved.contains(&index) {
                true => Shape::Curved,
                false => Shape::Linear,
            };
            let list = match quantity.is_of_intervals() {
                true => &mut out.intervals,
                false => &mut out.instants,
            };
            let measure = known.measure(quantity, shape, vectors);
            out.places.push(measure.is_some().then_some(list.len()));
            list.extend(measure);
        }
        out
    }
}

impl Known<'_> {
    /// No terms, to which those of a part are added.
    pub(super) fn no_terms<'v>(&'v self, vectors: &'v mut Vectors) -> Terms<'v> {
        let of = (self.system, self.presolved, self.reference);
        let called = (self.analysis, self.sought.clone());
        no_terms(of, called, self.variables, vectors)
    }

    fn measure(
        &self,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let (unit, at) = (quantity.unit, quantity.at);
        Some(match quantity.what {
            What::Joint { joint, .. } if quantity.is_step() => {
                return self.joint_step(joint, shape, vectors);
            }
            What::Joint { joint, near } => return self.joint(joint, near, shape, vectors),
            What::Stretch(muscle) => self.stretch(muscle, at, shape, vectors),
            What::Capacitance(muscle) => {
                self.variables.input(muscle)?;
                let energy = capacitance(&self.presolved.system.muscles[muscle])?;
                instant(shape, energy, [self.span(muscle, vectors)])
            }
            What::Place { .. } | What::Region { .. } | What::Clearance { .. } | What::Speed(_) => {
                return self.of_marker(quantity, shape, vectors);
            }
            What::Direction { body, axis, along } => {
                let body = self.presolved.carrier(Some(body));
                let direction = MaterialVector::direction(body, &axis, self.reference);
                let (origin, normal) = (Vector::zeros(), along);
                let component = PositionComponent { origin, normal };
                instant(shape, component, [vectors.index(direction)])
            }
            What::PeakVoltage(parameter) => {
                let multiple = Multiple { unit: KILOVOLT };
                interval::<_, 1, 0, 1>(shape, multiple, [], [self.parameter(parameter)?])
            }
            What::Voltage(source) => {
                let voltage = [self.variables.input(source)?];
                interval::<_, 1, 0, 1>(shape, Multiple { unit: 1.0 }, [], voltage)
            }
            What::PeakExcess {
                source,
                parameter,
                unit,
            } => {
                let scalars = [self.variables.input(source)?, self.parameter(parameter)?];
                interval::<_, 2, 0, 2>(shape, PeakExcess { unit }, [], scalars)
            }
            What::Amount { .. } => return amount_measure(quantity, self.system, &self.sought),
            What::ChargedField(_)
            | What::Current(_)
            | What::Power(_)
            | What::Charge(_)
            | What::MeanCharge(_)
            | What::ElectrodeVoltage(_)
            | What::Energy(_) => return self.of_charge(quantity, shape, vectors),
            What::Tension(Pulling::Muscle(muscle)) => {
                return self.tension(muscle, (unit, shape), vectors);
            }
            What::Tension(part) => return self.pull(part, vectors),
            What::Reaction { joint, of, along } => {
                return self.reaction((joint, of), (along, at.stencil()), vectors);
            }
            What::Field(FieldPlace::Muscle(muscle)) => {
                return self.muscle_field(muscle, (unit, at.stencil()), shape, vectors);
            }
            What::Field(FieldPlace::Element {
                block,
                element,
                point,
            }) => {
                return self.element_field(block, element, point, unit, at.stencil(), shape);
            }
            What::Field(FieldPlace::Block { .. }) => return None,
        })
    }

    /// Scalar of a free parameter; none where parameters are put in.
    fn parameter(&self, parameter: usize) -> Option<usize> {
        self.variables.range(Role::Parameter).nth(parameter)
    }

    /// Angle or displacement of a joint.
    fn joint(
        &self,
        joint: usize,
        near: f64,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let joint = self.presolved.joint(joint)?;
        let joint = &self.presolved.system.joints[joint];
        match JointReading::new(joint, None, self.reference).measure {
            JointCoordinate::Angle { vectors: v } => {
                let read = v.map(|x| vectors.index(x));
                Some(instant(shape, Angle { near }, read))
            }
            JointCoordinate::Displacement { axis, span } => {
                let read = [axis, span].map(|x| vectors.index(x));
                Some(instant(shape, Projection, read))
            }
            JointCoordinate::None => None,
        }
    }

    /// Step of the coordinate of a joint in an interval.
    fn joint_step(
        &self,
        joint: usize,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let joint = self.presolved.joint(joint)?;
        let joint = &self.presolved.system.joints[joint];
        let (here, next) = (Stencil::Here, Stencil::Next);
        match JointReading::new(joint, None, self.reference).measure {
            JointCoordinate::Angle { vectors: v } => {
                let [a, b, c] = v.map(|x| vectors.index(x));
                let read = [
                    (a, here),
                    (b, here),
                    (c, here),
                    (a, next),
                    (b, next),
                    (c, next),
                ];
                Some(interval::<_, 18, 6, 0>(shape, AngleStep, read, []))
            }
            JointCoordinate::Displacement { axis, span } => {
                let [n, r] = [axis, span].map(|x| vectors.index(x));
                let read = [(n, here), (r, here), (n, next), (r, next)];
                Some(interval::<_, 12, 4, 0>(shape, ProjectionStep, read, []))
            }
            JointCoordinate::None => None,
        }
    }

    /// Squared field of an element of a block, at its centre or at a Gauss point, over the one of its `limit`.
    fn element_field(
        &self,
        block: usize,
        element: usize,
        point: Option<usize>,
        limit: f64,
        at: Stencil,
        shape: Shape,
    ) -> Option<Box<dyn Measure>> {
        let block = &self.blocks[block];
        if !block.is_dielectric[element] {
            return None;
        }
        let gradients = match point {
            Some(point) => block.shapes[element].gradients_at(point),
            None => block.central_gradients(element)?,
        };
        Some(shape.intervals::<ElementFields>(ElementField {
            point: FieldPoint { gradients, limit },
            nodes: block.nodes(element),
            terminals: block.terminals(element),
            at,
        }))
    }
}

/// Shape of a function of a quantity: linear, or curved, so that all that the quantity reads couples.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shape {
    Linear,
    Curved,
}

impl Shape {
    /// Measure of a law of an interval.
    pub(super) fn law<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
        self,
        element: LawElement<L, NV, NS>,
    ) -> Box<dyn Measure> {
        self.scaled_law(1.0, element)
    }

    /// Measure of a law of an interval times a factor.
    pub(super) fn scaled_law<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
        self,
        scale: f64,
        element: LawElement<L, NV, NS>,
    ) -> Box<dyn Measure> {
        match element.given() {
            Some(given) => self.scaled::<Formulas<L::Formula<f64>, M, NV, NS>>(scale, given),
            None => self.scaled::<Laws<L, M, NV, NS>>(scale, element),
        }
    }

    fn instants<K: Kernel>(self, element: K::Element) -> Box<dyn Measure> {
        let elements = vec![element];
        match self {
            Self::Linear => Box::new(Group::<K>::instants("measure", 1.0, elements)),
            Self::Curved => Box::new(Group::<Curved<K>>::instants("measure", 1.0, elements)),
        }
    }

    fn intervals<K: Kernel>(self, element: K::Element) -> Box<dyn Measure> {
        self.scaled::<K>(1.0, element)
    }

    fn scaled<K: Kernel>(self, scale: f64, element: K::Element) -> Box<dyn Measure> {
        let elements = vec![element];
        match self {
            Self::Linear => Box::new(Group::<K>::intervals("measure", scale, elements)),
            Self::Curved => Box::new(Group::<Curved<K>>::intervals("measure", scale, elements)),
        }
    }
}

/// A vector as an element of an interval reads it.
pub(super) fn read(vector: usize, stencil: Stencil) -> VectorArg {
    VectorArg { vector, stencil }
}

/// Measure of a formula of vectors of an instant.
pub(super) fn instant<E: Energy<M> + 'static, const M: usize, const NV: usize>(
    shape: Shape,
    energy: E,
    vectors: [usize; NV],
) -> Box<dyn Measure> {
    shape.instants::<Formulas<E, M, NV, 0>>(Element {
        energy,
        vectors: vectors.map(|vector| read(vector, Stencil::Here)),
        scalars: [],
    })
}

/// Measure of a formula of vectors and scalars of an interval.
pub(super) fn interval<E: Energy<M> + 'static, const M: usize, const NV: usize, const NS: usize>(
    shape: Shape,
    energy: E,
    vectors: [(usize, Stencil); NV],
    scalars: [usize; NS],
) -> Box<dyn Measure> {
    shape.intervals::<Formulas<E, M, NV, NS>>(Element {
        energy,
        vectors: vectors.map(|(vector, stencil)| read(vector, stencil)),
        scalars,
    })
}

/// A number without arguments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant<T>(T);

law!(Constant { 0 } of 0);

impl<T: Number> Energy<0, T> for Constant<T> {
    type Local<const ORDER: usize> = Jet<0, ORDER, T>;

    fn at<const ORDER: usize>(&self, _: &SVector<T, 0>, _: &SVector<T, 0>) -> Jet<0, ORDER, T> {
        Jet::constant(self.0)
    }
}

/// The measure of an amount of muscles; none where no free parameter moves it.
pub(super) fn amount_measure(
    quantity: &Quantity,
    system: &System,
    sought: &Sought,
) -> Option<Box<dyn Measure>> {
    let What::Amount { muscles, amount } = &quantity.what else {
        return None;
    };
    let element = |&m: &usize| {
        let (muscle, read) = (&system.muscles[m], sought.read());
        let constants = MuscleConstants::new(muscle, m, read, [0.0; 2], [None; 2], |_| 0);
        let mut constants = constants.still();
        let amount = match amount {
            Amount::Volume => constants.volume(),
            Amount::Mass => constants.mass(1.0)?,
        };
        Some(constants.element(Constant(amount), [], []))
    };
    let elements: Vec<_> = muscles.iter().filter_map(element).collect();
    let is_moved = elements.iter().any(|one| !one.parameters.is_empty());
    is_moved.then(|| -> Box<dyn Measure> {
        let group = Group::<Laws<Constant<Coefficient>, 0, 0, 0>>::intervals(
            "measure",
            1.0 / quantity.unit,
            elements,
        );
        Box::new(group)
    })
}

impl Known<'_> {
    /// Squared stretch of a muscle, at the instants or at a place of the intervals.
    pub(super) fn stretch(
        &self,
        muscle: usize,
        at: At,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Box<dyn Measure> {
        let span = self.span(muscle, vectors);
        match at {
            At::Instant => {
                let stretch = MuscleConstants::given(&self.presolved.system.muscles[muscle]);
                instant(shape, stretch.stretch().formula(&[]), [span])
            }
            at => {
                let of = self.muscle(muscle, vectors);
                let (stretch, span) = (of.stretch(), read(span, at.stencil()));
                shape.law::<_, 3, 1, 0>(of.element(stretch, [span], []))
            }
        }
    }

    /// Squared field of a lumped muscle over the one of its `limit`.
    pub(super) fn muscle_field(
        &self,
        muscle: usize,
        (limit, at): (f64, Stencil),
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let span = [read(self.span(muscle, vectors), at)];
        let mut of = self.muscle(muscle, vectors);
        if let Some(source) = self.system.charge_of(muscle) {
            let charge = [self.variables.input(source)?];
            let capacitance = of.capacitance()?;
            let field = charge_field(capacitance, limit);
            return Some(shape.law(of.element(field, span, charge)));
        }
        let voltage = [self.variables.input(muscle)?];
        let field = of.field(limit);
        Some(shape.law(of.element(field, span, voltage)))
    }

    /// The constants of a muscle, whose span is the first vector of an element.
    pub(super) fn muscle(&self, index: usize, vectors: &mut Vectors) -> MuscleConstants<'_> {
        let muscle = &self.presolved.system.muscles[index];
        let read = self.sought.read();
        let bodies = [muscle.from.body, muscle.to.body];
        MuscleConstants::new(muscle, index, read, [-1.0, 1.0], bodies, |moved| {
            vectors.index(moved)
        })
    }

    /// Vector of the span of a muscle.
    pub(super) fn span(&self, muscle: usize, vectors: &mut Vectors) -> usize {
        let muscle = &self.presolved.system.muscles[muscle];
        let [from, to] = [&muscle.from, &muscle.to]
            .map(|a| MaterialVector::point(a.body, &a.at, self.reference));
        vectors.index(MaterialVector::span(&from, &to))
    }
}
