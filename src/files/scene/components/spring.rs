//! Springs and dampers.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::names::{NamedEntries, attachment};
use crate::files::scene::point::PointSpec;
use crate::files::units::quantity::{Damping, Length, PhysicalQuantity, Quantity, Stiffness};
use crate::model::components::Spring;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A linear spring, a damper, or both, between two points: force k (length − rest length) + c (rate of the length).
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringSpec {
    /// Name, unique among springs and tendons.
    pub name: String,
    /// One end.
    pub from: PointSpec,
    /// The other end.
    pub to: PointSpec,
    /// Stiffness k, SI unit N/m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Quantity<Stiffness>>,
    /// Damping c, SI unit N s/m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<Quantity<Damping>>,
    /// Length without force, SI unit m; the distance of the ends where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_length: Option<Quantity<Length>>,
}

impl ComponentSpec for SpringSpec {
    type Part = Spring;

    fn name(&self) -> &String {
        &self.name
    }

    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Spring, SceneError> {
        let end = |key: &str, point: &PointSpec| {
            attachment(&point.body, &point.at, bodies, &scope.key(key))
        };
        let (from, to) = (end("from", &self.from)?, end("to", &self.to)?);
        if self.stiffness.is_none() && self.damping.is_none() {
            return Err(scope.wrong("neither of them", "\"stiffness\" or \"damping\""));
        }
        let stiffness = not_negative(self.stiffness.as_ref(), &scope.key("stiffness"))?;
        let damping = not_negative(self.damping.as_ref(), &scope.key("damping"))?;
        let place = scope.key("rest_length");
        if self.rest_length.is_some() && self.stiffness.is_none() {
            let expected = "no such key, as a spring without \"stiffness\" does not read it";
            return Err(place.wrong("\"rest_length\"", expected));
        }
        let distance = (to.at - from.at).norm();
        let written = self.rest_length.as_ref().map(Quantity::value);
        let rest_length = written.unwrap_or(distance);
        if rest_length < 0.0 {
            return Err(place.wrong(format!("{} mm", rest_length), "zero or a positive length"));
        }
        // The force of a spring with a rest length has no direction where the ends meet; nor has that of a damper.
        let has_direction = damping.is_some() || (stiffness.is_some() && rest_length > 0.0);
        if has_direction && distance == 0.0 {
            let expected =
                "another place than \"from\", as the force along the span has no direction there";
            return Err(scope
                .key("to")
                .key("at")
                .wrong("the place of \"from\"", expected));
        }
        Ok(Spring {
            name: self.name.clone(),
            from,
            to,
            stiffness,
            damping,
            rest_length,
        })
    }
}

/// A value that is not negative; zero leaves no trace.
fn not_negative<M: PhysicalQuantity>(
    quantity: Option<&Quantity<M>>,
    scope: &Scope<'_>,
) -> Result<Option<f64>, SceneError> {
    let Some(quantity) = quantity else {
        return Ok(None);
    };
    let value = quantity.value();
    if value < 0.0 {
        return Err(scope.wrong(quantity.to_string(), "zero or a positive value"));
    }
    Ok(Some(value).filter(|&value| value > 0.0))
}

/// A kind of component as it is written.
pub(in crate::files::scene) trait ComponentSpec {
    /// The component of the system.
    type Part;

    /// Its name, unique among components.
    fn name(&self) -> &String;

    /// The component, with its numbers checked.
    ///
    /// # Errors
    /// A number or a name is wrong.
    fn component(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Self::Part, SceneError>;
}

/// The components of a list.
pub(in crate::files::scene) fn built<S: ComponentSpec>(
    specs: &[S],
    list: &NamedEntries<'_>,
    bodies: &[String],
) -> Result<Vec<S::Part>, SceneError> {
    list.build(specs, |spec, scope| spec.component(bodies, scope))
}

/// Checks that the names of a list differ from each other and from those before, and adds them to these.
pub(in crate::files::scene) fn check_unique<S: ComponentSpec>(
    specs: &[S],
    list: &NamedEntries<'_>,
    before: &mut Vec<String>,
) -> Result<(), SceneError> {
    let names: Vec<String> = specs.iter().map(|spec| spec.name().clone()).collect();
    let reserved: Vec<&str> = before.iter().map(String::as_str).collect();
    list.unique(&names, &reserved)?;
    before.extend(names);
    Ok(())
}
