//! Resolution of names in a scene: bodies, points of bodies, materials.

use crate::energy::ElasticLaw;
use crate::files::json::error::SceneError;
use crate::files::json::scope::{Scope, list};
use crate::files::scene::material::named_materials;
use crate::files::scene::point::{Point, vector};
use crate::model::system::{Attachment, Material};

/// Names of the entries of a list.
pub(crate) fn names<T>(specs: &[T], name: impl Fn(&T) -> &String) -> Vec<String> {
    specs.iter().map(|spec| name(spec).clone()).collect()
}

/// The material of a name that stands at `scope`.
pub(crate) fn find_material(
    name: &str,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Material, SceneError> {
    if let Some((_, material)) = materials.iter().find(|(other, _)| other == name) {
        return Ok(*material);
    }
    let names: Vec<String> = materials.iter().map(|(name, _)| name.clone()).collect();
    let kept = named_materials().map(|(name, _)| name.to_owned());
    let kept = kept.filter(|name| !names.contains(name));
    let all: Vec<String> = names.iter().cloned().chain(kept).collect();
    let expected = format!("the name of a material: one of {}", list(all.iter()));
    Err(scope.find(name, &all, &expected).map_or_else(
        |error| error,
        |_| scope.wrong(format!("{name:?}"), expected),
    ))
}

/// The material of finite elements, whose name stands at `scope`: it says how it resists changes of volume.
pub(crate) fn find_compressible(
    name: &str,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Material, SceneError> {
    let material = find_material(name, materials, scope)?;
    if let Some(ElasticLaw::Ogden { .. }) = material.law {
        let found = format!("{name:?}, which follows Ogden's law");
        let expected = "a law of the invariants of the strain, as \"yeoh\": only lumped muscles follow Ogden's";
        return Err(scope.wrong(found, expected));
    }
    if material.lame_lambda.is_some() {
        return Ok(material);
    }
    let found = format!("{name:?}, which has neither \"lame_lambda\" nor \"poisson_ratio\"");
    Err(scope.wrong(
        found,
        "a material with one of them, as finite elements need it",
    ))
}

/// A point of a body that is written under `body` and `at`.
pub(crate) fn attachment(
    body: &str,
    at: &Point,
    bodies: &[String],
    scope: &Scope<'_>,
) -> Result<Attachment, SceneError> {
    let body = find_body(body, bodies, &scope.key("body"))?;
    let at = vector(at);
    Ok(Attachment { body, at })
}

/// Index of a body; `None` is the ground.
pub(crate) fn find_body(
    name: &str,
    bodies: &[String],
    scope: &Scope<'_>,
) -> Result<Option<usize>, SceneError> {
    if name == "ground" {
        return Ok(None);
    }
    if let Some(index) = bodies.iter().position(|body| body == name) {
        return Ok(Some(index));
    }
    let or_ground = bodies.iter().map(String::as_str).chain(["ground"]);
    let expected = "the name of a body or \"ground\"";
    Err(scope
        .document
        .wrong_name(&scope.place, name, expected, or_ground))
}

/// One list of the scene; entries beyond the written ones come from the chain.
pub(super) struct NamedEntries<'a> {
    list: Scope<'a>,
    chain: Scope<'a>,
    written: usize,
}

impl<'a> NamedEntries<'a> {
    pub(super) fn new(scene: &Scope<'a>, list: &str, written: usize) -> Self {
        Self {
            list: scene.key(list),
            chain: scene.key("chain"),
            written,
        }
    }

    pub(super) fn scope(&self, index: usize) -> Scope<'a> {
        match index {
            index if index < self.written => self.list.index(index),
            _ => self.chain.clone(),
        }
    }

    pub(super) fn unique(&self, names: &[String], reserved: &[&str]) -> Result<(), SceneError> {
        self.list.unique(names, reserved, |index| match index {
            index if index < self.written => self.scope(index).key("name"),
            _ => self.scope(index),
        })
    }

    pub(super) fn build<S, T>(
        &self,
        specs: &[S],
        build: impl Fn(&S, &Scope<'a>) -> Result<T, SceneError>,
    ) -> Result<Vec<T>, SceneError> {
        let build = |(index, spec)| build(spec, &self.scope(index));
        specs.iter().enumerate().map(build).collect()
    }
}
