//! Component as it is written in a scene file.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::named_entries::NamedEntries;

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
