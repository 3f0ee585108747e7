//! Conversion of the output entry of a problem file to the columns and instants shown.

use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::scene::names::names;
use crate::files::units::quantity::{Quantity, Time};
use crate::model::system::System;

/// Part of a motion that tables, figures and page show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Time in ms between the instants shown.
    pub every: Option<f64>,
    /// Columns of the table; `None`: all.
    pub quantities: Option<Vec<String>>,
}

/// Test of a column of a system by its name.
type IsOfKind = fn(&str, &System) -> bool;

/// Words for columns of one kind.
const KINDS: [(&str, IsOfKind); 14] = [
    ("joints", is_of_joint),
    ("rates", |column, _| column.ends_with("_rate")),
    ("speeds", |column, _| column.ends_with("_speed")),
    ("reactions", |column, _| {
        column.contains("_force_") || column.contains("_torque_")
    }),
    ("markers", is_of_marker),
    ("stretches", |column, _| column.ends_with("_stretch")),
    ("tensions", |column, _| column.ends_with("_tension")),
    ("fields", |column, _| column.ends_with("_field")),
    ("charges", |column, _| column.ends_with("_charge")),
    ("currents", |column, _| column.ends_with("_current")),
    ("powers", |column, _| column.ends_with("_power")),
    ("energies", is_energy),
    ("momenta", |column, _| column.contains("_momentum_")),
    ("constraint_violation", |column, _| {
        column == "constraint_violation"
    }),
];

fn is_of_joint(column: &str, system: &System) -> bool {
    system.joints.iter().any(|joint| {
        let several = joint.several_names();
        joint.name == column || several.iter().any(|(name, _)| name == column)
    })
}

fn is_of_marker(column: &str, system: &System) -> bool {
    let point = column.strip_suffix(['x', 'y', 'z']);
    let marker = point.and_then(|point| point.strip_suffix('_'));
    let mut markers = system.markers.iter();
    markers.any(|m| Some(m.name.as_str()) == marker)
}

fn is_energy(column: &str, _: &System) -> bool {
    let at_end = ["mechanical_work", "_heat"];
    column.contains("energy") || at_end.iter().any(|end| column.ends_with(end))
}

pub(crate) fn output(spec: &OutputSpec, at: &At<'_>) -> Result<Output> {
    let every = at.optional("every", &spec.every, |at, every| at.positive(every))?;
    let place = at.key("quantities");
    refuse!(if spec.quantities.as_ref().is_some_and(Vec::is_empty), place;
        found "none", expected "one or more names of quantities");
    let kinds = KINDS.map(|(kind, _)| kind);
    let mut known: Vec<String> = kinds.map(str::to_owned).to_vec();
    known.extend(names(&at.system.joints, |joint| &joint.name));
    known.extend(names(&at.system.markers, |marker| &marker.name));
    known.extend(names(&at.system.muscles, |muscle| &muscle.name));
    known.extend(names(&at.system.solids, |solid| &solid.name));
    known.extend(at.system.components.iter().map(|one| one.name().to_owned()));
    known.extend(names(&at.system.components.loads, |load| &load.name));
    for (index, name) in spec.quantities.iter().flatten().enumerate() {
        let expected = format!(
            "{}, or the name of a joint, marker, muscle, block, spring, tendon or load",
            kinds.join(", ")
        );
        place.index(index).find(name, &known, &expected)?;
    }
    Ok(Output {
        every,
        quantities: spec.quantities.clone(),
    })
}

impl Output {
    /// Returns true if a column stands in the table.
    pub fn takes(&self, column: &str, system: &System) -> bool {
        let Some(quantities) = &self.quantities else {
            return true;
        };
        let of_kind = |word: &str| {
            let mut kinds = KINDS.iter();
            kinds.any(|(kind, is_of_it)| *kind == word && is_of_it(column, system))
        };
        let of_name = |name: &str| {
            let rest = column.strip_prefix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
        };
        column == "time" || quantities.iter().any(|name| of_kind(name) || of_name(name))
    }
}

read_objects! {
    /// Part of a motion that tables, figures and page show; all of it stays in the solution.
    pub struct OutputSpec {
        /// Time between the instants shown, SI unit s: those nearest to its multiples. Where not written all, and of a long motion so many that
        /// nothing is lost to the eye.
        pub every: Option<Quantity<Time>>,
        /// Columns of `trajectory.csv`: `joints`, `rates`, `speeds`, `reactions`, `markers`, `stretches`, `tensions`, `fields`, `charges`, `currents`,
        /// `powers`, `energies`, `momenta`, `constraint_violation`, or all of a joint, marker, muscle, block, spring, tendon or load by its name. All where
        /// not written.
        pub quantities: Option<Vec<String>>,
    }
}
