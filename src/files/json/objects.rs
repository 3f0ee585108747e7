//! Declaration of the types of JSON files: objects, words with what they mean in the program, and values that are written in two ways.

/// Declares types as they are written.
///
/// - `struct`: an object without other keys. What is an `Option`, a map or true or false need not be written, nor what a `?` marks; nor is it where
///   there is none.
/// - `enum`: words. With a type behind a colon each means the variant of it of the same name, or of the name behind `=`.
/// - `either`: a scalar or else an object, with both for messages.
/// - `auto`: `"auto"`, with a type of that word alone, or a value, with both for messages and true if the value is a whole number.
macro_rules! objects {
    ($($(#[$about:meta])* pub $kind:tt $name:ident $(<$of:ident: $bound:path>)? $(: $meaning:ident)? $(($expected:expr))? { $($entries:tt)* })*) => {
        $($crate::files::json::objects::objects!(@$kind
            [(serde::Serialize) $(#[$about])* $name $(<$of: $bound>)? $(: $meaning)? $(($expected))?] [] $($entries)*);)*
    };
    (@read $($(#[$about:meta])* pub $kind:tt $name:ident $(<$of:ident: $bound:path>)? $(: $meaning:ident)? $(($expected:expr))? { $($entries:tt)* })*) => {
        $($crate::files::json::objects::objects!(@$kind
            [() $(#[$about])* $name $(<$of: $bound>)? $(: $meaning)? $(($expected))?] [] $($entries)*);)*
    };
    (@struct $head:tt $done:tt $(#[$about:meta])* pub $key:ident: Option<$of:ty>, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "Option::is_none" $head $done [$(#[$about])* pub $key: Option<$of>,] $($rest)*);
    };
    (@struct $head:tt $done:tt $(#[$about:meta])* pub $key:ident: BTreeMap<$by:ty, $of:ty>, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "BTreeMap::is_empty" $head $done [$(#[$about])* pub $key: BTreeMap<$by, $of>,] $($rest)*);
    };
    (@struct $head:tt $done:tt $(#[$about:meta])* pub $key:ident: bool, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "std::ops::Not::not" $head $done [$(#[$about])* pub $key: bool,] $($rest)*);
    };
    (@struct $head:tt $done:tt $(#[$about:meta])* pub $key:ident?: $of:ty, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@optional "Vec::is_empty" $head $done [$(#[$about])* pub $key: $of,] $($rest)*);
    };
    (@struct $head:tt [$($done:tt)*] $(#[$about:meta])* $seen:vis $key:ident: $of:ty, $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@struct $head [$($done)* $(#[$about])* $seen $key: $of,] $($rest)*);
    };
    (@optional $is_absent:literal [() $($head:tt)*] [$($done:tt)*] [$($entry:tt)*] $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@struct [() $($head)*] [$($done)* #[serde(default)] $($entry)*] $($rest)*);
    };
    (@optional $is_absent:literal $head:tt [$($done:tt)*] [$($entry:tt)*] $($rest:tt)*) => {
        $crate::files::json::objects::objects!(@struct $head [$($done)* #[serde(default, skip_serializing_if = $is_absent)] $($entry)*] $($rest)*);
    };
    (@struct [($($written:path)?) $(#[$about:meta])* $name:ident $(<$of:ident: $bound:path>)?] [$($done:tt)*]) => {
        #[derive(Clone, Debug, serde::Deserialize, schemars::JsonSchema $(, $written)?)]
        $(#[$about])*
        #[serde(deny_unknown_fields)]
        pub struct $name $(<$of: $bound>)? { $($done)* }
    };
    (@enum [($($written:path)?) $(#[$about:meta])* $name:ident $(: $meaning:ident)?] [] $($(#[$doc:meta])* $word:ident $(= $meant:ident)?,)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, schemars::JsonSchema $(, $written)?)]
        $(#[$about])*
        #[serde(rename_all = "snake_case")]
        pub enum $name { $($(#[$doc])* $word,)* }

        $crate::files::json::objects::objects!(@meaning [$name $(: $meaning)?] $($word $(= $meant)?,)*);
    };
    (@meaning [$name:ident] $($words:tt)*) => {};
    (@meaning [$name:ident: $meaning:ident] $($word:ident $(= $meant:ident)?,)*) => {
        impl From<$name> for $meaning {
            fn from(word: $name) -> Self {
                match word {
                    $($name::$word => $crate::files::json::objects::objects!(@meant $word $($meant)?),)*
                }
            }
        }
    };
    (@meant $word:ident) => { Self::$word };
    (@meant $word:ident $meant:ident) => { Self::$meant };
    (@either [($($written:path)?) $(#[$about:meta])* $name:ident $(<$of:ident: $bound:path>)? ($expected:expr)] []
     $(#[$of_scalar:meta])* $scalar:ident: $from_scalar:ty, $(#[$of_object:meta])* $object:ident: $from_object:ty,) => {
        #[derive(Clone, Debug, schemars::JsonSchema $(, $written)?)]
        $(#[$about])*
        #[serde(untagged)]
        pub enum $name $(<$of: $bound>)? {
            $(#[$of_scalar])*
            $scalar($from_scalar),
            $(#[$of_object])*
            $object($from_object),
        }

        impl<'de $(, $of: $bound)?> serde::Deserialize<'de> for $name $(<$of>)? {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any($crate::files::json::either::Either::<$from_scalar, $from_object, Self> {
                    expected: $expected,
                    scalar: Self::$scalar,
                    object: Self::$object,
                })
            }
        }
    };
    (@auto [($($written:path)?) $(#[$about:meta])* $name:ident ($expected:expr)] []
     $(#[$of_type:meta])* $word:ident { $(#[$of_word:meta])* Auto }, $(#[$of_value:meta])* $value:ident: $of:ty, $is_whole:literal) => {
        $crate::files::json::objects::objects!(@enum [($($written)?) $(#[$of_type])* $word] [] $(#[$of_word])* Auto,);

        #[derive(Clone, Debug, schemars::JsonSchema $(, $written)?)]
        $(#[$about])*
        #[serde(untagged)]
        pub enum $name {
            /// `"auto"`.
            Word($word),
            $(#[$of_value])*
            $value($of),
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any($crate::files::json::either::AutoOr {
                    expected: $expected,
                    auto: Self::Word($word::Auto),
                    value: Self::$value,
                    is_whole: $is_whole,
                })
            }
        }
    };
}
pub(crate) use objects;

/// Declares types that are read alone.
macro_rules! read_objects {
    ($($objects:tt)*) => { $crate::files::json::objects::objects!(@read $($objects)*); };
}
pub(crate) use read_objects;
