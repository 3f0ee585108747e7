//! Volume or mass of lumped muscles at rest: a quantity of constants alone, the same all the time.

use nalgebra::SVector;

use crate::energy::Energy;
use crate::functional::{Group, Law, Laws, Measure};
use crate::math::{Jet, Number};
use crate::model::amount::Amount;
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::components::muscle_laws::{PointMass, RestVolume};
use crate::model::quantity::Quantity;
use crate::model::sought::Sought;
use crate::model::system::System;

/// A number without arguments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant<T>(T);

impl<T: Number> Energy<0, T> for Constant<T> {
    type Local<const ORDER: usize> = Jet<0, ORDER, T>;

    fn at<const ORDER: usize>(&self, _: &SVector<T, 0>, _: &SVector<T, 0>) -> Jet<0, ORDER, T> {
        Jet::constant(self.0)
    }
}

/// Amount of one muscle.
#[derive(Clone)]
enum OfMuscle {
    Volume(RestVolume),
    Mass(PointMass),
}

impl Law<0> for OfMuscle {
    type Formula<T: Number> = Constant<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Constant<T> {
        Constant(match self {
            Self::Volume(law) => law.volume(parameters),
            Self::Mass(law) => law.mass(parameters),
        })
    }
}

/// The measure of an amount of muscles; none where no sought constant moves it.
pub(super) fn amount_measure(
    quantity: &Quantity,
    (system, sought): (&System, &Sought),
) -> Option<Box<dyn Measure>> {
    let Quantity::OfMuscles {
        muscles,
        amount,
        unit,
    } = quantity
    else {
        return None;
    };
    let element = |&m: &usize| {
        let of = (&system.muscles[m], m);
        let mut constants =
            MuscleConstants::new(of, (sought.read(), [0.0; 2]), [None; 2], |_| 0).still();
        let law = match amount {
            Amount::Volume => OfMuscle::Volume(constants.volume()),
            Amount::Mass => OfMuscle::Mass(constants.mass(1.0)?),
        };
        Some(constants.element(law, [], []))
    };
    let elements: Vec<_> = muscles.iter().filter_map(element).collect();
    let is_moved = elements.iter().any(|one| !one.parameters.is_empty());
    is_moved.then(|| -> Box<dyn Measure> {
        let group = Group::<Laws<OfMuscle, 0, 0, 0>>::intervals("measure", 1.0 / unit, elements);
        Box::new(group)
    })
}
