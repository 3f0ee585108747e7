//! Terms of lumped muscles some of whose constants are sought.

use crate::energy::{Affine, SoughtCell, SoughtDielectric, SoughtShape, SoughtViscousCell};
use crate::functional::{SoughtElement, SpanMove};
use crate::kinematics::MaterialVector;
use crate::math::Vector;
use crate::model::constant::{Constant, DielectricLaw, Parameter};
use crate::model::sought::{Arguments, Sought};
use crate::model::system::{ElectricConstants, Muscle};
use crate::model::terms::Terms;

/// Arguments of the elastic energy before its scalars: the span.
const OF_ENERGY: usize = 3;
/// Arguments of the viscous work before its scalars: virtual displacement, span and rate.
const OF_WORK: usize = 9;

/// A muscle that reads sought parameters.
pub(super) struct SoughtMuscle<'a> {
    muscle: &'a Muscle,
    index: usize,
    span: usize,
    sought: Sought,
    /// Parameters that move the ends: index, the vector e along which the span changes, and its components at rest.
    moves: Vec<(usize, usize, Vector)>,
}

impl<'a> SoughtMuscle<'a> {
    /// The muscle, where a constant of it is sought; `span` is the vector of its span.
    pub(super) fn new(
        muscle: &'a Muscle,
        index: usize,
        span: usize,
        terms: &mut Terms<'_>,
    ) -> Option<Self> {
        let sought = terms.sought();
        if !sought.any(|constant| constant.muscle() == Some(index)) {
            return None;
        }
        let mut moves = Vec::new();
        for (p, parameter) in sought.parameters.iter().enumerate() {
            if parameter.moves(index) {
                let [from, to] = directions(parameter, index);
                let [a, b] = [
                    terms.direction(&muscle.from, &from),
                    terms.direction(&muscle.to, &to),
                ];
                let vector = terms.vector(MaterialVector::span(&a, &b));
                moves.push((p, vector, to - from));
            }
        }
        Some(Self {
            muscle,
            index,
            span,
            sought,
            moves,
        })
    }

    /// Returns true if the elastic or electric energy reads a parameter.
    fn is_in_energy(&self, is_driven: bool) -> bool {
        self.reads(|constant| match constant {
            Constant::Permittivity(..) | Constant::Layer(_) => is_driven,
            Constant::ShearModulus(_) => true,
            other => other.is_shape(),
        })
    }

    fn reads(&self, is_read: impl Fn(Constant) -> bool) -> bool {
        let own = |constant: Constant| constant.muscle() == Some(self.index);
        self.sought
            .any(|constant| own(constant) && is_read(constant))
    }

    fn constant(&self, constant: Constant, value: f64, arguments: &mut Arguments) -> Affine {
        self.sought.constant(constant, value, arguments)
    }

    fn shape(&self, arguments: &mut Arguments) -> SoughtShape {
        let at_rest = self.muscle.to.at - self.muscle.from.at;
        let mut span = [at_rest.x, at_rest.y, at_rest.z].map(Affine::from);
        for &(parameter, _, along) in &self.moves {
            let argument = arguments.of(self.sought.scalar(parameter));
            let at = self.sought.parameters[parameter].guess;
            for (component, &slope) in span.iter_mut().zip(along.iter()) {
                if slope != 0.0 {
                    component.value -= slope * at;
                    component.slopes.push((argument, slope));
                }
            }
        }
        let side = |side: usize, arguments: &mut Arguments| {
            let value = self.muscle.cross_section[side];
            self.constant(Constant::Side(self.index, side), value, arguments)
        };
        SoughtShape {
            span,
            sides: [side(0, arguments), side(1, arguments)],
        }
    }

    fn element<E, const N: usize>(
        &self,
        energy: E,
        mut arguments: Arguments,
    ) -> SoughtElement<E, N> {
        let mut moved = |&(parameter, vector, _): &(usize, usize, Vector)| SpanMove {
            vector,
            scalar: arguments.place(self.sought.scalar(parameter)),
            at: self.sought.parameters[parameter].guess,
        };
        let moves: Vec<SpanMove> = self.moves.iter().map(&mut moved).collect();
        debug_assert_eq!(moves.len() + 1, N);
        SoughtElement {
            energy,
            span: self.span,
            moves,
            scalars: arguments.scalars(),
        }
    }

    /// Adds the energy, where it reads a parameter; returns true if it does.
    pub(super) fn energy(
        &self,
        input: Option<usize>,
        (term, why): (&'static str, &'static str),
        terms: &mut Terms<'_>,
    ) -> bool {
        let material = &self.muscle.material;
        let driven = material.electric.zip(input);
        if !self.is_in_energy(driven.is_some()) {
            return false;
        }
        let mut arguments = Arguments::new(OF_ENERGY);
        arguments.first(driven.map(|(_, voltage)| voltage));
        let shape = self.shape(&mut arguments);
        let modulus = Constant::ShearModulus(self.index);
        let energy = SoughtCell {
            shear_modulus: self.constant(modulus, material.shear_modulus, &mut arguments),
            electric: driven.map(|(electric, _)| self.electric(electric, &mut arguments)),
            shape,
        };
        let (name, arguments) = (&self.muscle.name, arguments);
        // With four parameters, or with all that a muscle has.
        let is_small = arguments.count() <= 5;
        match (is_small, self.moves.len()) {
            (true, 0) => {
                terms.add_sought::<_, 8, 1, 1>(term, why, name, self.element(energy, arguments));
            }
            (true, 1) => {
                terms.add_sought::<_, 8, 1, 2>(term, why, name, self.element(energy, arguments));
            }
            (_, 0) => {
                terms.add_sought::<_, 12, 1, 1>(term, why, name, self.element(energy, arguments));
            }
            (_, 1) => {
                terms.add_sought::<_, 12, 1, 2>(term, why, name, self.element(energy, arguments));
            }
            _ => terms.add_sought::<_, 12, 1, 3>(term, why, name, self.element(energy, arguments)),
        }
        true
    }

    fn electric(&self, electric: ElectricConstants, arguments: &mut Arguments) -> SoughtDielectric {
        let layer = Constant::Layer(self.index);
        let layer = self.constant(layer, self.muscle.layer_thickness, arguments);
        let ratio = [DielectricLaw::FirstOrder, DielectricLaw::Ideal]
            .into_iter()
            .find(|&law| {
                let constant = Constant::Permittivity(self.index, law);
                self.sought.find(constant).is_some()
            });
        let Some(law) = ratio else {
            return SoughtDielectric {
                c1: electric.c1.into(),
                c2: electric.c2.into(),
                permittivity: electric.permittivity.into(),
                layer,
            };
        };
        let ratio = self.constant(Constant::Permittivity(self.index, law), 1.0, arguments);
        // The constants are linear in the ratio: of none and of one.
        let [none, one] = [0.0, 1.0].map(|ratio| law.constants(ratio));
        let of = |c: fn(&ElectricConstants) -> f64| ratio.scaled(c(&one) - c(&none), c(&none));
        SoughtDielectric {
            c1: of(|e| e.c1),
            c2: of(|e| e.c2),
            permittivity: of(|e| e.permittivity),
            layer,
        }
    }

    /// Adds the viscous work, where it reads a parameter; returns true if it does.
    pub(super) fn viscosity(
        &self,
        viscosity: f64,
        (term, why): (&'static str, &'static str),
        terms: &mut Terms<'_>,
    ) -> bool {
        if !self.reads(|c| c.is_shape() || matches!(c, Constant::Viscosity(_))) {
            return false;
        }
        let mut arguments = Arguments::new(OF_WORK);
        let constant = Constant::Viscosity(self.index);
        let energy = SoughtViscousCell {
            viscosity: self.constant(constant, viscosity, &mut arguments),
            shape: self.shape(&mut arguments),
        };
        let name = &self.muscle.name;
        match self.moves.len() {
            0 => terms.add_sought::<_, 14, 3, 1>(term, why, name, self.element(energy, arguments)),
            1 => terms.add_sought::<_, 14, 3, 2>(term, why, name, self.element(energy, arguments)),
            _ => terms.add_sought::<_, 14, 3, 3>(term, why, name, self.element(energy, arguments)),
        }
        true
    }
}

/// Returns the derivatives of both ends of a muscle by a parameter, in the ground frame at rest.
fn directions(parameter: &Parameter, muscle: usize) -> [Vector; 2] {
    let mut ends = [Vector::zeros(); 2];
    for follower in &parameter.constants {
        if let Constant::End(m, end, axis) = follower.constant
            && m == muscle
        {
            ends[end][axis] += follower.factor;
        }
    }
    ends
}
