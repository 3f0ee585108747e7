//! Values that are written as a scalar or as an object, as a number or a text, or as `"auto"` or a value, read without losing the place of an
//! error.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Unexpected, Visitor};
use std::fmt;

/// Visits a scalar or an object, so that paths and messages of both survive.
pub(crate) struct Either<S, O, T> {
    /// Both, for messages.
    pub(crate) expected: &'static str,
    pub(crate) scalar: fn(S) -> T,
    pub(crate) object: fn(O) -> T,
}

impl<'de, S: Deserialize<'de>, O: Deserialize<'de>, T> Visitor<'de> for Either<S, O, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        S::deserialize(text.into_deserializer()).map(self.scalar)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        S::deserialize(number.into_deserializer()).map(self.scalar)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        O::deserialize(MapAccessDeserializer::new(map)).map(self.object)
    }
}

/// Visits a number or a text; errors of the functions that read them name the value found.
pub(crate) struct Scalar<T> {
    pub(crate) expected: fn() -> String,
    pub(crate) number: fn(f64) -> Result<T, String>,
    pub(crate) text: fn(&str) -> Result<T, String>,
}

impl<T> Visitor<'_> for Scalar<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&(self.expected)())
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        let read = (self.number)(number);
        read.map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        let read = (self.text)(text);
        read.map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))
    }
}

/// Visits `"auto"` or a value, which is a whole number or else a quantity.
pub(crate) struct AutoOr<V, T> {
    /// Both, for messages.
    pub(crate) expected: &'static str,
    pub(crate) auto: T,
    pub(crate) value: fn(V) -> T,
    pub(crate) is_whole: bool,
}

impl<'de, V: Deserialize<'de>, T> Visitor<'de> for AutoOr<V, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        match text {
            "auto" => Ok(self.auto),
            _ if self.is_whole => Err(E::invalid_value(Unexpected::Str(text), &self)),
            _ => V::deserialize(text.into_deserializer()).map(self.value),
        }
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        V::deserialize(number.into_deserializer()).map(self.value)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        V::deserialize(number.into_deserializer()).map(self.value)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        match self.is_whole {
            true => Err(E::invalid_type(Unexpected::Float(number), &self)),
            false => V::deserialize(number.into_deserializer()).map(self.value),
        }
    }
}
