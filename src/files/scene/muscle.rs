//! Conversion of a muscle of a scene file to its span, section and model.

use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::names::{find_compressible, find_material};
use crate::files::scene::point::unit_axis;
use crate::files::scene::spec::{MuscleModel, MuscleSpec};
use crate::files::scene::spec_solids::CircuitSpec;
use crate::files::units::quantity::Quantity;
use crate::model::check_elements;
use crate::model::system::{Discretisation, Fidelity, Material, Muscle};

/// The muscle that is written.
pub(crate) fn muscle(
    spec: &MuscleSpec,
    bodies: &[String],
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Muscle> {
    let scope = &match scope.place.last_key() {
        // The pair of a chain has the same keys.
        Some("chain") => scope.key("muscles"),
        _ => scope.clone(),
    };
    Ok(Muscle {
        name: spec.name.clone(),
        from: spec.from.attachment(bodies, &scope.key("from"))?,
        to: spec.to.attachment(bodies, &scope.key("to"))?,
        cross_section: spec.cross_section.each_ref().map(Quantity::value),
        layer_thickness: spec.layer_thickness.value(),
        material: find_material(&spec.material, materials, &scope.key("material"))?,
        prestretch: spec.prestretch,
        section_inertia: spec.section_inertia,
        circuit: spec.circuit.as_ref().map(CircuitSpec::circuit),
        fidelity: fidelity(spec, materials, scope)?,
    })
}

/// The model of a muscle.
fn fidelity(
    spec: &MuscleSpec,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Fidelity> {
    if spec.model == MuscleModel::Lumped {
        let keys = [
            ("elements", spec.elements.is_some()),
            ("layers", spec.layers.is_some()),
            ("element", spec.element.is_some()),
            ("first_side", spec.first_side.is_some()),
        ];
        let written = keys.into_iter().find(|(_, there)| *there);
        refuse!(if let Some((key, _)) = written, scope.key(key);
            found format!("{key:?} of a lumped muscle"),
            expected "no such key, or \"model\": \"finite_elements\"");
        return Ok(Fidelity::Lumped);
    }
    find_compressible(&spec.material, materials, &scope.key("material"))?;
    let Some(elements) = spec.elements else {
        let expected = "the key \"elements\", such as [2, 2, 8]: across, across, along";
        return Err(scope.wrong("finite elements without a number", expected));
    };
    let checked = check_elements(elements);
    checked.map_err(|fault| scope.key("elements").refuse(&elements, &fault))?;
    let first_side = scope.optional("first_side", &spec.first_side, |at, side| {
        unit_axis(side, at)
    })?;
    Ok(Fidelity::FiniteElements(Discretisation {
        elements,
        layers: spec.layers.unwrap_or(elements[2]),
        element: spec.element.unwrap_or_default().into(),
        first_side,
    }))
}
