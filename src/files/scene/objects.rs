//! Declaration of what a scene file has as objects.

/// Declares objects as they are written, without other keys: what is an `Option`, a map or true or false need not be written, nor is it where
/// there is none.
macro_rules! objects {
    ($($(#[$about:meta])* pub struct $name:ident { $($entries:tt)* })*) => {
        $(objects!(@ [$(#[$about])* $name] [] $($entries)*);)*
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: Option<$of:ty>, $($rest:tt)*) => {
        objects!(@optional "Option::is_none" $head $done [$(#[$about])* pub $key: Option<$of>,] $($rest)*);
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: BTreeMap<$by:ty, $of:ty>, $($rest:tt)*) => {
        objects!(@optional "BTreeMap::is_empty" $head $done [$(#[$about])* pub $key: BTreeMap<$by, $of>,] $($rest)*);
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: bool, $($rest:tt)*) => {
        objects!(@optional "std::ops::Not::not" $head $done [$(#[$about])* pub $key: bool,] $($rest)*);
    };
    (@ $head:tt [$($done:tt)*] $(#[$about:meta])* pub $key:ident: $of:ty, $($rest:tt)*) => {
        objects!(@ $head [$($done)* $(#[$about])* pub $key: $of,] $($rest)*);
    };
    (@optional $is_absent:literal $head:tt [$($done:tt)*] [$($entry:tt)*] $($rest:tt)*) => {
        objects!(@ $head [$($done)* #[serde(default, skip_serializing_if = $is_absent)] $($entry)*] $($rest)*);
    };
    (@ [$(#[$about:meta])* $name:ident] [$($done:tt)*]) => {
        $(#[$about])*
        #[derive(Clone, Debug, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name { $($done)* }
    };
}
pub(crate) use objects;
