//! Named list of a scene, with the positions of its entries.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;

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
