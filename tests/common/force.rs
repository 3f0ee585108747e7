//! A control that is a force or whatever else reads one vector: its optimum is known in closed form.

use nalgebra::{SVector, Vector3};
use proboscis::coordinates::Reduced;
use proboscis::energy::Energy;
use proboscis::functional::{Element, Functional, Group, Stencil, VectorArg};
use proboscis::kinematics::MaterialVector;
use proboscis::math::Jet;
use proboscis::model::system::InputKind;
use proboscis::model::{Model, Variable};

/// Scalars of a program are in kV: one unit of force is a thousand units of the scalar.
pub const UNIT: f64 = 1e-3;

/// `−s n·x`, arguments: x and s.
#[derive(Clone)]
pub struct Force {
    pub direction: Vector3<f64>,
}

impl Energy<4> for Force {
    type Local<const ORDER: usize> = Jet<4, ORDER>;

    const DEGREE: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> Jet<4, ORDER> {
        let along = |i: usize| Jet::argument(i, p, w) * self.direction[i];
        (along(0) + along(1) + along(2)) * Jet::argument(3, p, w) * -UNIT
    }
}

/// The model with one scalar more, which an element with one vector reads.
pub fn with_control<E: Energy<4> + 'static>(
    mut model: Model,
    energy: E,
    vector: &MaterialVector,
) -> Model {
    let at = model.vectors.iter().position(|v| v == vector);
    let element = Element::<E, 4, 1, 1> {
        energy,
        vectors: [VectorArg {
            vector: at.expect("inertia reads this vector"),
            stencil: Stencil::Mid,
        }],
        scalars: [0],
    };
    let control = Group::intervals("control", -1.0, vec![element]);
    let Reduced {
        map,
        intervals,
        instants,
        ..
    } = model.action;
    let mut terms = intervals.terms;
    terms.push(std::sync::Arc::new(control));
    let intervals = Functional::new(terms, intervals.measures, intervals.vectors, 1);
    model.action = Reduced::new(map, intervals, instants);
    let control = Variable::input(0, InputKind::Voltage, "control".to_owned());
    assert_eq!(model.variables.add(control), 0);
    model
}
