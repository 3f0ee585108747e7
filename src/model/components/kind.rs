//! Kind of component of this crate, of which a system has a list.

use crate::model::component::Component;
use crate::model::terms::Terms;

/// A kind of component; [`Components`](super::Components) lists all of them.
pub trait Kind: Component + Sized {
    /// A part of this kind in words: "spring".
    const NAME: &'static str;

    /// Reason why its terms are absent from a scene without such a part.
    const ABSENT: &'static str;

    /// Names of its terms with a potential, in the order of the sum.
    const POTENTIALS: &'static [&'static str];

    /// Names of its terms that dissipate, in the order of the sum.
    const DISSIPATIONS: &'static [&'static str] = &[];

    /// Its unique name.
    fn name_mut(&mut self) -> &mut String;

    /// Makes the terms of the part with this index in the list; an index is needed where its constants can be free.
    fn build_at(&self, _index: usize, terms: &mut Terms<'_>) {
        self.build(terms);
    }
}

/// Makes the terms of all parts of a kind.
pub(super) fn build<K: Kind>(parts: &[K], terms: &mut Terms<'_>) {
    let parts = parts.iter().enumerate();
    parts.for_each(|(index, part)| part.build_at(index, terms));
    let names = K::POTENTIALS.iter().chain(K::DISSIPATIONS);
    names.for_each(|term| terms.without(term, K::ABSENT));
}
