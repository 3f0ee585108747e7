//! Costs that call for every signal, on markers and joints, and of energies of sources.

use proboscis::control::problem::{
    CostFunction, During, EnergyCost, Objective, QuantityCost, SourceEnergy,
};
use proboscis::math::Signal;
use proboscis::model::{FieldPlace, Pulling, Quantity, What};

/// Signals of each kind about a mean, changing within some ms.
pub fn signals(mean: f64, size: f64) -> [Signal; 4] {
    [
        Signal::Constant(mean + size),
        Signal::Ramp {
            from: mean,
            to: mean + size,
            start: 4.0,
            duration: 31.0,
        },
        Signal::Sine {
            mean,
            amplitude: size,
            frequency: 0.013,
            phase: 0.4,
        },
        Signal::Table {
            times: vec![2.0, 17.0, 34.0],
            values: vec![mean - size, mean + size, mean],
        },
    ]
}

/// A square of a quantity.
pub fn square(quantity: Quantity, weight: f64, reference: Signal) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during: During::Motion,
    }
}

/// A little effort, markers and joints that follow signals; joints by index, angles with `true`.
pub fn tracked(markers: &[usize], joints: &[(usize, bool)]) -> Objective {
    let mut quantities = Vec::new();
    for &marker in markers {
        let along = signals(5.0, 8.0);
        for (axis, reference) in along.into_iter().skip(1).enumerate() {
            let quantity = Quantity::marker_place(marker, axis);
            quantities.push(square(quantity, 0.3 + axis as f64, reference));
        }
    }
    for (i, &(joint, is_angle)) in joints.iter().enumerate() {
        let size = if is_angle { 0.3 } else { 4.0 };
        let reference = signals(0.0, size)[i % 4].clone();
        let quantity = Quantity::joint(joint, 0.0);
        quantities.push(square(quantity, 20.0, reference));
    }
    Objective {
        effort: 0.1,
        quantities,
        ..Objective::default()
    }
}

/// A quantity that is itself a cost.
fn itself(quantity: Quantity, weight: f64) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Itself,
        during: During::Motion,
    }
}

/// Costs of tensions of muscles, of rates of joints, angles with `true`, of speeds of markers and of true fields of muscles; every third at
/// the end only.
pub fn measured(
    muscles: &[usize],
    joints: &[(usize, bool)],
    markers: &[usize],
    fields: &[usize],
) -> Vec<QuantityCost> {
    let mut costs = Vec::new();
    for (i, &muscle) in muscles.iter().enumerate() {
        let quantity = Quantity::tension(Pulling::Muscle(muscle)).in_unit(0.5);
        costs.push(square(quantity, 0.3, signals(1.0, 0.7)[i % 4].clone()));
    }
    for (i, &(joint, is_angle)) in joints.iter().enumerate() {
        let size = if is_angle { 5.0 } else { 0.4 };
        let quantity = Quantity::joint_rate(joint);
        costs.push(square(
            quantity,
            0.2,
            signals(0.0, size)[(i + 2) % 4].clone(),
        ));
    }
    for &marker in markers {
        costs.push(itself(Quantity::squared_speed(marker).in_unit(0.5), 0.4));
    }
    for &muscle in fields {
        let place = FieldPlace::Muscle(muscle);
        let limit = 2e4;
        costs.push(itself(Quantity::of(What::Field(place)).in_unit(limit), 2.0));
    }
    for cost in costs.iter_mut().skip(2).step_by(3) {
        cost.during = During::End;
    }
    costs
}

/// Costs of current, power and field of a muscle behind a resistor.
pub fn measured_source(muscle: usize) -> Vec<QuantityCost> {
    let current = Quantity::of(What::Current(muscle)).in_unit(2e-5);
    let power = Quantity::power(muscle).in_unit(0.03);
    let field = Quantity::of(What::ChargedField(muscle)).in_unit(4e4);
    let mut end = square(power.clone(), 1.0, Signal::Constant(0.2));
    end.during = During::End;
    vec![
        square(current, 0.7, signals(0.1, 0.4)[2].clone()),
        square(power, 0.3, Signal::Constant(0.0)),
        itself(field, 2.0),
        end,
    ]
}

/// Electrical energies, then mechanical works, by source and weight.
pub fn energies(electrical: &[(usize, f64)], mechanical: &[(usize, f64)]) -> Vec<EnergyCost> {
    let costs = |energy: SourceEnergy, list: &[(usize, f64)]| {
        let cost = |&(source, weight): &(usize, f64)| EnergyCost {
            source,
            energy,
            weight,
        };
        list.iter().map(cost).collect::<Vec<_>>()
    };
    let mut all = costs(SourceEnergy::Electrical, electrical);
    all.extend(costs(SourceEnergy::Mechanical, mechanical));
    all
}
