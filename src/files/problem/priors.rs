//! Conversion of what is known of sought constants beside their recordings.

use std::collections::BTreeMap;

use crate::control::problem::Prior;
use crate::files::json::error::SceneError;
use crate::files::json::locate::JsonPath;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_free::FreeMap;
use crate::files::problem::spec_identify::PriorSpec;
use crate::files::scene::constants::WrittenScene;
use crate::model::Parameter;

/// The priors of sought constants, by their paths.
pub(super) fn priors(
    map: &BTreeMap<String, PriorSpec>,
    (parameters, free): (&[Parameter], &FreeMap),
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Vec<Prior>, SceneError> {
    let one = |(path, spec): (&String, &PriorSpec)| {
        let place = scope.key(path);
        let found = parameters.iter().position(|one| one.name == *path);
        let (Some(constant), Some(bounds)) = (found, free.get(path)) else {
            return Err(place.wrong(format!("{path:?}"), "a constant of \"free\""));
        };
        let [of_value, of_size] = ["value", "standard_deviation"].map(|key| place.key(key));
        let text = serde_json::to_value(&spec.value).unwrap_or_default();
        scene
            .with(&JsonPath::parse(path).unwrap_or_default(), &text)
            .map_err(|reason| of_value.wrong(reason.found, reason.expected))?;
        let size = &spec.standard_deviation;
        let written = [&spec.value, &bounds.min, &bounds.max];
        let unit = written.into_iter().find_map(|one| one.dimension());
        if size.dimension().is_some_and(|own| unit != Some(own)) {
            let expected = "a size in a unit of the value, or a plain number in its SI unit";
            return Err(of_size.wrong(size.to_string(), expected));
        }
        if size.si() <= 0.0 {
            return Err(of_size.wrong(size.to_string(), "a positive size"));
        }
        let factor = parameters[constant].unit(scene.system).factor;
        Ok(Prior {
            constant,
            value: spec.value.si() / factor,
            deviation: size.si() / factor,
        })
    };
    map.iter().map(one).collect()
}
