//! Conversion of a muscle of a scene file to its span, section and model.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::circuit::circuit;
use crate::files::scene::names::{attachment, find_compressible, find_material};
use crate::files::scene::point::{PointSpec, unit_axis};
use crate::files::scene::spec::{ModelSpec, MuscleModel, MuscleSpec};
use crate::files::scene::spec_solids::ElementSpec;
use crate::files::units::quantity::{Length, Quantity};
use crate::math::shortest;
use crate::model::system::{Discretisation, ElementKind, Fidelity, Material, Muscle};
use nalgebra::Vector3;

/// Spans shorter than this in mm have no direction.
const SHORTEST_SPAN: f64 = 1e-9;

/// Sine of the angle to the span below which a direction is along it.
const ALONG: f64 = 1e-6;

/// Lengths of a muscle that a side of its section may have: a wider one is a slip of a unit.
const WIDEST: f64 = 100.0;

/// Most elements of one mesh; a slip of the pen asks for more.
pub(crate) const MOST_ELEMENTS: usize = 1_000_000;

/// The muscle that is written.
pub(crate) fn muscle(
    spec: &MuscleSpec,
    bodies: &[String],
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Muscle, SceneError> {
    let material = find_material(&spec.material, materials, &scope.key("material"))?;
    let fidelity = fidelity(&spec.model(), materials, scope)?;
    if spec.section_inertia && fidelity != Fidelity::Lumped {
        let found = "\"section_inertia\" of a muscle of finite elements";
        let expected = "no such key, as all inertia of finite elements counts";
        return Err(scope.key("section_inertia").wrong(found, expected));
    }
    let end =
        |key: &str, point: &PointSpec| attachment(&point.body, &point.at, bodies, &scope.key(key));
    let (from, to) = (end("from", &spec.from)?, end("to", &spec.to)?);
    let length = (to.at - from.at).norm();
    if length.is_nan() || length < SHORTEST_SPAN {
        let found = "the place where the muscle starts, which makes its length zero";
        return Err(scope
            .key("to")
            .key("at")
            .wrong(found, "another place than \"from\""));
    }
    let fidelity = match &spec.first_side {
        Some(side) => turned(fidelity, side, to.at - from.at, &scope.key("first_side"))?,
        None => fidelity,
    };
    let prestretch = prestretch(spec.prestretch, scope)?;
    let rest = length / prestretch.unwrap_or(1.0);
    let muscle = Muscle {
        name: spec.name.clone(),
        from,
        to,
        cross_section: positive_sides(&spec.cross_section, rest, scope)?,
        layer_thickness: layer(&spec.layer_thickness, rest, scope)?,
        material,
        prestretch,
        section_inertia: spec.section_inertia,
        circuit: None,
        fidelity,
    };
    Ok(Muscle {
        circuit: circuit(spec.circuit.as_ref(), &muscle, scope)?,
        ..muscle
    })
}

/// Finite elements of a muscle along a span, with the direction of the first side of its cross-section.
fn turned(
    fidelity: Fidelity,
    side: &[f64; 3],
    span: Vector3<f64>,
    scope: &Scope<'_>,
) -> Result<Fidelity, SceneError> {
    let Fidelity::FiniteElements(discretisation) = fidelity else {
        let found = "\"first_side\" of a lumped muscle";
        let expected = "no such key, or \"model\": \"finite_elements\"";
        return Err(scope.wrong(found, expected));
    };
    let first_side = unit_axis(side, scope)?;
    if span.normalize().cross(&first_side).norm() < ALONG {
        return Err(scope.wrong(
            format!("{side:?}, along the span"),
            "a direction across the span",
        ));
    }
    Ok(Fidelity::FiniteElements(Discretisation {
        first_side: Some(first_side),
        ..discretisation
    }))
}

/// The prestretch of a muscle.
fn prestretch(stretch: Option<f64>, scope: &Scope<'_>) -> Result<Option<f64>, SceneError> {
    match stretch.filter(|stretch| !(*stretch > 0.0 && stretch.is_finite())) {
        None => Ok(stretch),
        Some(wrong) => {
            let place = scope.key("prestretch");
            Err(place.wrong(wrong.to_string(), "a positive stretch"))
        }
    }
}

/// Returns the model of a muscle; the keys stand in `scope`.
pub(crate) fn fidelity(
    spec: &ModelSpec<'_>,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Fidelity, SceneError> {
    if spec.model == MuscleModel::Lumped {
        let keys = [
            ("elements", spec.elements.is_some()),
            ("layers", spec.layers.is_some()),
            ("element", spec.element.is_some()),
        ];
        let Some((key, _)) = keys.into_iter().find(|(_, there)| *there) else {
            return Ok(Fidelity::Lumped);
        };
        let found = format!("{key:?} of a lumped muscle");
        let expected = "no such key, or \"model\": \"finite_elements\"";
        return Err(scope.key(key).wrong(found, expected));
    }
    find_compressible(spec.material, materials, &scope.key("material"))?;
    let Some(elements) = spec.elements else {
        let expected = "the key \"elements\", such as [2, 2, 8]: across, across, along";
        return Err(scope.wrong("finite elements without a number", expected));
    };
    check_elements(elements, &scope.key("elements"))?;
    let layers = spec.layers.unwrap_or(elements[2]);
    if layers == 0 || !elements[2].is_multiple_of(layers) {
        let expected = format!("a divisor of the {} elements along the span", elements[2]);
        return Err(scope.key("layers").wrong(layers.to_string(), expected));
    }
    Ok(Fidelity::FiniteElements(Discretisation {
        elements,
        layers,
        element: element_kind(spec.element),
        first_side: None,
    }))
}

/// One element or more in each direction, and not too many.
pub(crate) fn check_elements(elements: [usize; 3], scope: &Scope<'_>) -> Result<(), SceneError> {
    if let Some(axis) = elements.iter().position(|&count| count == 0) {
        return Err(scope.index(axis).wrong("0", "1 element or more"));
    }
    let total = elements
        .iter()
        .try_fold(1_usize, |total, &count| total.checked_mul(count));
    if total.is_none_or(|total| total > MOST_ELEMENTS) {
        let expected = format!("no more than {MOST_ELEMENTS} elements in all");
        return Err(scope.wrong(format!("{elements:?}"), expected));
    }
    Ok(())
}

/// Returns the kind of hexahedron; trilinear where not written.
pub(crate) fn element_kind(spec: Option<ElementSpec>) -> ElementKind {
    match spec.unwrap_or_default() {
        ElementSpec::Hex8 => ElementKind::Hex8,
        ElementSpec::Hex8Q1p0 => ElementKind::Hex8Q1P0,
    }
}

/// Sides of the cross-section of a muscle or of a pair of some length in mm.
pub(crate) fn positive_sides(
    sides: &[Quantity<Length>; 2],
    length: f64,
    scope: &Scope<'_>,
) -> Result<[f64; 2], SceneError> {
    let place = scope.key("cross_section");
    let side = |index: usize| {
        let (place, written) = (place.index(index), &sides[index]);
        let side = place.positive(written)?;
        if side <= WIDEST * length {
            return Ok(side);
        }
        let found = format!("{written}, {:.0} lengths of the muscle", side / length);
        let expected = format!(
            "a side of no more than {WIDEST} lengths of the muscle, {}; a number without a unit is in m",
            millimetres(length)
        );
        Err(place.wrong(found, expected))
    };
    Ok([side(0)?, side(1)?])
}

/// The thickness of a layer of a muscle or of a pair of some length in mm: layers are stacked along it.
pub(crate) fn layer(
    thickness: &Quantity<Length>,
    length: f64,
    scope: &Scope<'_>,
) -> Result<f64, SceneError> {
    let place = scope.key("layer_thickness");
    let layer = place.positive(thickness)?;
    // The length of a stack of one layer is known to rounding.
    if layer <= length * (1.0 + 1e-9) {
        return Ok(layer);
    }
    let expected = format!(
        "a layer no thicker than the muscle is long, {}, such as \"50 um\"; a number without a unit is in m",
        millimetres(length)
    );
    Err(place.wrong(thickness.to_string(), expected))
}

/// A length in mm.
fn millimetres(length: f64) -> String {
    format!("{} mm", shortest(length, 6))
}
