//! The method of a simulation as it is written, and its conversion.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};
use std::marker::PhantomData;

use crate::dynamics::Integrator;
use crate::files::json::either::{Either, ScalarOrObject, scalar_or_object};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::model::system::System;

/// Degree beyond which rounding takes what the order gives.
const HIGHEST: usize = 8;
/// Spectral radius of the word alone.
const RADIUS: f64 = 0.8;

/// A method by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum IntegratorWord {
    /// The midpoint variational integrator, order 2.
    Midpoint,
    /// Implicit Euler, order 1; damps.
    ImplicitEuler,
    /// Generalised α with the spectral radius 0.8, order 2; damps fast oscillations.
    GeneralisedAlpha,
}

/// A method with its parameter: exactly one of the two.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IntegratorObject {
    /// Degree, from 1 to 8, of a Galerkin variational integrator with Lobatto points, order 2 × degree.
    #[serde(default)]
    pub galerkin: Option<usize>,
    /// Spectral radius at infinity, from 0 to 1, of the generalised-α method.
    #[serde(default)]
    pub generalised_alpha: Option<f64>,
}

/// A word or an object.
#[derive(Clone, Debug, JsonSchema)]
#[serde(untagged)]
pub enum IntegratorSpec {
    /// By name.
    Word(IntegratorWord),
    /// With its parameter.
    Object(IntegratorObject),
}

scalar_or_object! {
    IntegratorSpec: IntegratorWord = Self::Word, IntegratorObject = Self::Object,
        "\"midpoint\", \"implicit_euler\", \"generalised_alpha\" or an object with \"galerkin\" or \"generalised_alpha\"";
}

/// The method of a simulation.
pub(crate) fn integrator(
    spec: Option<&IntegratorSpec>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Integrator, SceneError> {
    let method = match spec {
        None => Integrator::Midpoint,
        Some(IntegratorSpec::Word(word)) => match word {
            IntegratorWord::Midpoint => Integrator::Midpoint,
            IntegratorWord::ImplicitEuler => Integrator::ImplicitEuler,
            IntegratorWord::GeneralisedAlpha => Integrator::GeneralisedAlpha {
                spectral_radius: RADIUS,
            },
        },
        Some(IntegratorSpec::Object(object)) => with_parameter(object, scope)?,
    };
    let changes = system.muscles.iter().find(|muscle| muscle.section_inertia);
    match (method, changes) {
        (Integrator::GeneralisedAlpha { .. }, Some(muscle)) => {
            let found = format!(
                "\"generalised_alpha\", though \"section_inertia\" of {} is not constant",
                muscle.name
            );
            Err(scope.wrong(found, "another method"))
        }
        _ => Ok(method),
    }
}

fn with_parameter(object: &IntegratorObject, scope: &Scope<'_>) -> Result<Integrator, SceneError> {
    match (object.galerkin, object.generalised_alpha) {
        (Some(degree), None) if (1..=HIGHEST).contains(&degree) => {
            Ok(Integrator::Galerkin { degree })
        }
        (Some(degree), None) => {
            let expected = format!("a degree from 1 to {HIGHEST}");
            Err(scope.key("galerkin").wrong(degree.to_string(), expected))
        }
        (None, Some(radius)) if (0.0..=1.0).contains(&radius) => Ok(Integrator::GeneralisedAlpha {
            spectral_radius: radius,
        }),
        (None, Some(radius)) => {
            let place = scope.key("generalised_alpha");
            Err(place.wrong(radius.to_string(), "a spectral radius from 0 to 1"))
        }
        (galerkin, generalised_alpha) => {
            let there = [
                ("galerkin", galerkin.map(|_| ())),
                ("generalised_alpha", generalised_alpha.map(|_| ())),
            ];
            scope.exactly_one(there).map(|()| Integrator::Midpoint)
        }
    }
}
