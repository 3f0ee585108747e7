//! Costs that call for every signal, on markers and joints, and of energies of sources.

use proboscis::control::problem::{
    CostFunction, During, EnergyCost, Objective, QuantityCost, SourceEnergy,
};
use proboscis::math::Signal;
use proboscis::model::Quantity;

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
            let quantity = Quantity::MarkerPlace { marker, axis };
            quantities.push(square(quantity, 0.3 + axis as f64, reference));
        }
    }
    for (i, &(joint, is_angle)) in joints.iter().enumerate() {
        let size = if is_angle { 0.3 } else { 4.0 };
        let reference = signals(0.0, size)[i % 4].clone();
        let quantity = Quantity::Joint { joint, near: 0.0 };
        quantities.push(square(quantity, 20.0, reference));
    }
    Objective {
        effort: 0.1,
        quantities,
        ..Objective::default()
    }
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
