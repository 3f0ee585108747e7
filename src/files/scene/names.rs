//! Resolution of names in a scene: bodies, points of bodies, materials.

use crate::files::json::scope::{Result, Scope, list};
use crate::files::scene::material::named_materials;
use crate::files::scene::point::{PointSpec, vector};
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
) -> Result<Material> {
    let mut names: Vec<String> = materials.iter().map(|(name, _)| name.clone()).collect();
    let kept = named_materials().map(|(name, _)| name.to_owned());
    let kept: Vec<String> = kept.filter(|name| !names.contains(name)).collect();
    names.extend(kept);
    let expected = format!("the name of a material: one of {}", list(names.iter()));
    let index = scope.find(name, &names, &expected)?;
    // Those that are named are among the materials of the scene.
    Ok(materials[index].1)
}

/// The material of finite elements, whose name stands at `scope`: it says how it resists changes of volume.
pub(crate) fn find_compressible(
    name: &str,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<Material> {
    let material = find_material(name, materials, scope)?;
    let checked = material.check_of_elements();
    checked.map_err(|fault| scope.refuse(&name, &fault))?;
    Ok(material)
}

impl PointSpec {
    /// The point.
    pub(crate) fn attachment(&self, bodies: &[String], scope: &Scope<'_>) -> Result<Attachment> {
        let body = find_body(&self.body, bodies, &scope.key("body"))?;
        let at = vector(&self.at);
        Ok(Attachment { body, at })
    }
}

/// Index of a body; `None` is the ground.
pub(crate) fn find_body(name: &str, bodies: &[String], scope: &Scope<'_>) -> Result<Option<usize>> {
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
