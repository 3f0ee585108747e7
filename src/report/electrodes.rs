//! Voltages that colour muscles in pictures: those of their electrodes.
//!
//! They are those of the sources but for muscles with a charge, whose voltage is an observation at the instants.

use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::model::System;
use std::borrow::Cow;

/// The motion with the voltages of the electrodes at the end of each interval.
pub(super) fn coloured<'t>(
    system: &System,
    trajectory: &'t Trajectory,
    observations: &Observations,
) -> Cow<'t, Trajectory> {
    let mut out = Cow::Borrowed(trajectory);
    let charged = (0..system.muscles.len()).filter(|&m| !system.has_source_voltage(m));
    for muscle in charged {
        let name = format!("{}_voltage", system.muscles[muscle].name);
        let is_own = |column: &&Column| column.name == name;
        let Some(column) = observations.columns.iter().find(is_own) else {
            continue;
        };
        let rows = out.to_mut().voltages.iter_mut();
        for (row, voltage) in rows.zip(column.values.iter().skip(1)) {
            row[muscle] = *voltage;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use crate::dynamics::trajectory::{Column, Observations, Trajectory};
    use crate::math::Vector;
    use crate::model::System;
    use crate::model::system::{Attachment, Circuit, Fidelity, Material, Muscle};
    use crate::report::electrodes::coloured;
    use std::borrow::Cow;

    #[test]
    fn only_muscles_with_a_charge_have_another_voltage_than_their_source() {
        let end = |x: f64| Attachment {
            body: None,
            at: Vector::x() * x,
        };
        let muscle = |name: &str, circuit| Muscle {
            name: name.to_owned(),
            from: end(0.0),
            to: end(10.0),
            cross_section: [1.0; 2],
            layer_thickness: 0.1,
            material: Material::default(),
            section_inertia: false,
            circuit,
            fidelity: Fidelity::Lumped,
        };
        let mut system = System {
            muscles: vec![muscle("direct", None), muscle("behind", None)],
            ..System::new("two muscles")
        };
        let motion = Trajectory {
            voltages: vec![vec![100.0, 200.0]; 2],
            ..Trajectory::default()
        };
        let column = Column {
            name: "behind_voltage".to_owned(),
            unit: "V",
            values: vec![0.0, 150.0, 190.0],
        };
        let observed = Observations {
            columns: vec![column],
        };
        let same = coloured(&system, &motion, &observed);
        assert!(matches!(same, Cow::Borrowed(_)));
        system.muscles[1].circuit = Some(Circuit { resistance: 1e6 });
        let found = coloured(&system, &motion, &observed);
        assert_eq!(found.voltages, [[100.0, 150.0], [100.0, 190.0]]);
    }
}
