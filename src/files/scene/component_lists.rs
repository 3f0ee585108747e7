//! Lists of components of a scene: their conversion, and the check of their names.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::components::component_lists;
use crate::files::scene::components::component_spec::{built, check_unique};
use crate::files::scene::named_entries::NamedEntries;
use crate::files::scene::spec::SceneSpec;
use crate::model::components::{Components, Load};

/// Defines what visits all lists.
macro_rules! visits {
    ($($(#[$about:meta])* $list:ident: $spec:ty,)*) => {
        /// The components that are written, beside these loads.
        pub(crate) fn components(
            scene: &SceneSpec,
            loads: Vec<Load>,
            bodies: &[String],
            scope: &Scope<'_>,
        ) -> Result<Components, SceneError> {
            Ok(Components {
                $($list: built(&scene.$list, &list(scope, stringify!($list)), bodies)?,)*
                loads,
                others: Vec::new(),
            })
        }

        /// Checks that no two components have one name.
        pub(crate) fn check_component_names(
            scene: &SceneSpec,
            scope: &Scope<'_>,
        ) -> Result<(), SceneError> {
            let mut names = Vec::new();
            $(check_unique(&scene.$list, &list(scope, stringify!($list)), &mut names)?;)*
            Ok(())
        }
    };
}

component_lists!(visits);

/// A list of which a chain writes nothing.
fn list<'a>(scope: &Scope<'a>, name: &str) -> NamedEntries<'a> {
    NamedEntries::new(scope, name, usize::MAX)
}
