//! Declaration of objects of JSON files, and of what their words mean.

/// Declares objects as they are written, without other keys: what is an `Option`, a map or true or false need not be written, nor is it where
/// there is none.
macro_rules! objects {
    ($($(#[$about:meta])* pub struct $name:ident { $($entries:tt)* })*) => {
        $($crate::files::json::objects::objects!(@ [(serde::Serialize) $(#[$about])* $name] [] $($entries)*);)*
    };
    (@read $($(#[$about:meta])* pub struct $name:ident { $($entries:tt)* })*) => {
        $($crate::files::json::objects::objects!(@ [() $(#[$about])* $name] [] $($entries)*);)*
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: Option<$of:ty>, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "Option::is_none" $head $done [$(#[$about])* pub $key: Option<$of>,] $($rest)*);
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: BTreeMap<$by:ty, $of:ty>, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "BTreeMap::is_empty" $head $done [$(#[$about])* pub $key: BTreeMap<$by, $of>,] $($rest)*);
    };
    (@ $head:tt $done:tt $(#[$about:meta])* pub $key:ident: bool, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "std::ops::Not::not" $head $done [$(#[$about])* pub $key: bool,] $($rest)*);
    };
    (@ $head:tt [$($done:tt)*] $(#[$about:meta])* $seen:vis $key:ident: $of:ty, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@ $head [$($done)* $(#[$about])* $seen $key: $of,] $($rest)*);
    };
    (@optional $is_absent:literal [() $($head:tt)*] [$($done:tt)*] [$($entry:tt)*] $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@ [() $($head)*] [$($done)* #[serde(default)] $($entry)*] $($rest)*);
    };
    (@optional $is_absent:literal $head:tt [$($done:tt)*] [$($entry:tt)*] $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@ $head [$($done)* #[serde(default, skip_serializing_if = $is_absent)] $($entry)*] $($rest)*);
    };
    (@ [($($written:path)?) $(#[$about:meta])* $name:ident] [$($done:tt)*]) => {
        #[derive(Clone, Debug, serde::Deserialize, schemars::JsonSchema $(, $written)?)]
        $(#[$about])*
        #[serde(deny_unknown_fields)]
        pub struct $name { $($done)* }
    };
}
pub(crate) use objects;

/// Declares objects that are read alone.
macro_rules! read_objects {
    ($($objects:tt)*) => { $crate::files::json::objects::objects!(@read $($objects)*); };
}
pub(crate) use read_objects;

/// Declares what the words of a type mean in the program.
macro_rules! meanings {
    ($($words:ident: $of:ident { $($word:ident => $meant:ident,)* })*) => {
        $(impl From<$words> for $of {
            fn from(word: $words) -> Self {
                match word {
                    $($words::$word => Self::$meant,)*
                }
            }
        })*
    };
}
pub(crate) use meanings;
