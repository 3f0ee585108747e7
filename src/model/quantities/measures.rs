//! Measures of quantities: the vectors and scalars that they read, and their formulas.

use crate::element::FieldPoint;
use crate::energy::{
    Angle, AngleStep, Coefficient, Energy, Law, Multiple, PeakExcess, PositionComponent,
    Projection, ProjectionStep, law,
};
use crate::functional::{
    Curved, Element, ElementField, ElementFields, Formulas, Group, Kernel, LawElement, Laws,
    Measure, Stencil, Term,
};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::{Jet, Number, Vector};
use crate::model::analysis::Analysis;
use crate::model::components::capacitance;
use crate::model::components::muscle_constants::{MuscleConstants, charge_field};
use crate::model::constants::free_parameters::Sought;
use crate::model::layout::internal::Internals;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::variables::{Role, Variables};
use crate::model::presolve::presolved::Presolved;
use crate::model::quantities::quantity::Quantity;
use crate::model::quantities::what::{At, FieldPlace, Pulling, What};
use crate::model::system::electrode_circuits::ElectrodeCircuit;
use crate::model::system::joints::{JointCoordinate, JointReading};
use crate::model::system::{Amount, System};
use crate::model::terms::Terms;
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
}

/// Data on which quantities are measured.
#[derive(Clone, Debug)]
pub(crate) struct Known<'a> {
    pub(crate) system: &'a System,
    pub(crate) analysis: &'a Analysis,
    pub(crate) presolved: &'a Presolved,
    pub(crate) internals: &'a Internals,
    pub(crate) reference: &'a [Pose],
    pub(crate) variables: &'a Variables,
    /// Vector of each marker.
    pub(crate) markers: &'a [usize],
    pub(crate) blocks: &'a [SolidBlock],
    pub(crate) circuits: &'a [ElectrodeCircuit],
    /// Terms of the intervals.
    pub(crate) terms: &'a [Arc<dyn Term>],
    /// The free parameters.
    pub(crate) sought: Sought,
    /// True if constraints glue blocks to bodies, so that terms do not tell the forces on bodies.
    pub(crate) is_glued: bool,
}

impl Measures {
    /// The measures of the quantities of an analysis.
    pub(crate) fn new(analysis: &Analysis, known: &Known<'_>, vectors: &mut Vectors) -> Self {
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
    pub(crate) fn no_terms<'v>(&'v self, vectors: &'v mut Vectors) -> Terms<'v> {
        let (sought, variables) = (self.sought.clone(), self.variables);
        let (reference, analysis) = (self.reference, self.analysis);
        self.presolved
            .no_terms(reference, analysis, sought, variables, vectors)
    }

    fn measure(
        &self,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let (unit, at) = (quantity.unit, quantity.at);
        Some(match quantity.what {
            What::Joint { joint, near } => {
                return self.joint(joint, near, quantity, shape, vectors);
            }
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
                return self.tension(muscle, unit, shape, vectors);
            }
            What::Tension(part) => return self.pull(part, vectors),
            What::Reaction { joint, of, along } => {
                return self.reaction(joint, of, along, at.stencil(), vectors);
            }
            What::Field(FieldPlace::Muscle(muscle)) => {
                return self.muscle_field(muscle, unit, at.stencil(), shape, vectors);
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

    /// Angle or displacement of a joint, or its step in an interval.
    fn joint(
        &self,
        joint: usize,
        near: f64,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let joint = self.presolved.joint(joint)?;
        let joint = &self.presolved.system.joints[joint];
        let is_step = quantity.is_step();
        let (here, next) = (Stencil::Here, Stencil::Next);
        Some(
            match JointReading::new(joint, None, self.reference).measure {
                JointCoordinate::Angle { vectors: v } => {
                    let [a, b, c] = v.map(|x| vectors.index(x));
                    let both = [here, next].map(|at| [(a, at), (b, at), (c, at)]);
                    match both {
                        _ if !is_step => instant(shape, Angle { near }, [a, b, c]),
                        [[a, b, c], [d, e, f]] => {
                            interval::<_, 18, 6, 0>(shape, AngleStep, [a, b, c, d, e, f], [])
                        }
                    }
                }
                JointCoordinate::Displacement { axis, span } => {
                    let [n, r] = [axis, span].map(|x| vectors.index(x));
                    let read = [(n, here), (r, here), (n, next), (r, next)];
                    match is_step {
                        false => instant(shape, Projection, [n, r]),
                        true => interval::<_, 12, 4, 0>(shape, ProjectionStep, read, []),
                    }
                }
                JointCoordinate::None => return None,
            },
        )
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
pub(crate) enum Shape {
    Linear,
    Curved,
}

impl Shape {
    /// Measure of a law of an interval.
    pub(crate) fn law<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
        self,
        element: LawElement<L, NV, NS>,
    ) -> Box<dyn Measure> {
        self.scaled_law(1.0, element)
    }

    /// Measure of a law of an interval times a factor.
    pub(crate) fn scaled_law<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
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

/// Measure of a formula of vectors of an instant.
pub(crate) fn instant<E: Energy<M> + 'static, const M: usize, const NV: usize>(
    shape: Shape,
    energy: E,
    vectors: [usize; NV],
) -> Box<dyn Measure> {
    shape.instants::<Formulas<E, M, NV, 0>>(Element {
        energy,
        vectors: vectors.map(|vector| Stencil::Here.of(vector)),
        scalars: [],
    })
}

/// Measure of a formula of vectors and scalars of an interval.
pub(crate) fn interval<E: Energy<M> + 'static, const M: usize, const NV: usize, const NS: usize>(
    shape: Shape,
    energy: E,
    vectors: [(usize, Stencil); NV],
    scalars: [usize; NS],
) -> Box<dyn Measure> {
    shape.intervals::<Formulas<E, M, NV, NS>>(Element {
        energy,
        vectors: vectors.map(|(vector, stencil)| stencil.of(vector)),
        scalars,
    })
}

/// A number without arguments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constant<T>(T);

law!(Constant { 0 } of 0);

impl<T: Number> Energy<0, T> for Constant<T> {
    type Local<const ORDER: usize> = Jet<0, ORDER, T>;

    fn at<const ORDER: usize>(&self, _: &SVector<T, 0>, _: &SVector<T, 0>) -> Jet<0, ORDER, T> {
        Jet::constant(self.0)
    }
}

/// The measure of an amount of muscles; none where no free parameter moves it.
pub(crate) fn amount_measure(
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
    pub(crate) fn stretch(
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
                let (stretch, span) = (of.stretch(), at.stencil().of(span));
                shape.law::<_, 3, 1, 0>(of.element(stretch, [span], []))
            }
        }
    }

    /// Squared field of a lumped muscle over the one of its `limit`.
    pub(crate) fn muscle_field(
        &self,
        muscle: usize,
        limit: f64,
        at: Stencil,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let span = [at.of(self.span(muscle, vectors))];
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
    pub(crate) fn muscle(&self, index: usize, vectors: &mut Vectors) -> MuscleConstants<'_> {
        let muscle = &self.presolved.system.muscles[index];
        let read = self.sought.read();
        let bodies = [muscle.from.body, muscle.to.body];
        MuscleConstants::new(muscle, index, read, [-1.0, 1.0], bodies, |moved| {
            vectors.index(moved)
        })
    }

    /// Vector of the span of a muscle.
    pub(crate) fn span(&self, muscle: usize, vectors: &mut Vectors) -> usize {
        let muscle = &self.presolved.system.muscles[muscle];
        let [from, to] = [&muscle.from, &muscle.to]
            .map(|a| MaterialVector::point(a.body, &a.at, self.reference));
        vectors.index(MaterialVector::span(&from, &to))
    }
}
