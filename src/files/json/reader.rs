//! Values of serde from the tree of a JSON text. A mistake has the steps to the innermost value or key that does not fit.
//!
//! A type that asks for an object is given the code of objects alone.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, Error as _, Expected, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, Visitor,
};
use serde_json::Number;
use std::borrow::Cow;
use std::convert::Infallible;
use std::fmt;

use crate::files::json::misfit::Misfit;
use crate::files::json::path::Step;
use crate::files::json::tree::Json;

impl<'a> Json<'a> {
    /// The value as a type.
    pub(crate) fn read<T: Deserialize<'a>>(self) -> Result<T, Misfit> {
        T::deserialize(self)
    }

    /// Visits an object.
    fn object<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_map(Parts::of(self))
    }

    /// Visits a list, of which all entries have to be taken.
    fn list<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        let mut parts = Parts::of(self);
        let value = visitor.visit_seq(&mut parts)?;
        let (taken, length) = (parts.taken, self.parts().len());
        match taken == length {
            true => Ok(value),
            false => {
                let expected = format!("a list of {taken} values");
                Err(Misfit::invalid_length(length, &expected.as_str()))
            }
        }
    }

    /// Visits a string, number or word.
    fn scalar<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        if let Some(text) = self.string() {
            let expected = (&visitor as &dyn Expected).to_string();
            let value = match text {
                Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
                Cow::Owned(text) => visitor.visit_string(text),
            };
            return value.map_err(|misfit: Misfit| misfit.beside(expected));
        }
        match self.written() {
            "null" => visitor.visit_unit(),
            "true" => visitor.visit_bool(true),
            "false" => visitor.visit_bool(false),
            written => {
                let number: Number = serde_json::from_str(written)
                    .map_err(|_| Misfit::custom(format!("{written}, which is not finite")))?;
                match (number.as_u64(), number.as_i64()) {
                    (Some(number), _) => visitor.visit_u64(number),
                    (_, Some(number)) => visitor.visit_i64(number),
                    _ => visitor.visit_f64(number.as_f64().unwrap_or(f64::NAN)),
                }
            }
        }
    }
}

impl<'a> Deserializer<'a> for Json<'a> {
    type Error = Misfit;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.first() {
            Some('{') => self.object(visitor),
            Some('[') => self.list(visitor),
            _ => self.scalar(visitor),
        }
    }

    fn deserialize_map<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.first() {
            Some('{') => self.object(visitor),
            // Types with keys would take a list in their order.
            Some('[') => Err(Misfit::invalid_type(Unexpected::Seq, &visitor)),
            _ => self.scalar(visitor),
        }
    }

    fn deserialize_struct<V: Visitor<'a>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        self.deserialize_map(visitor)
    }

    fn deserialize_option<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        match self.written() {
            "null" => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'a>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'a>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Misfit> {
        if let Some(word) = self.string() {
            let value = visitor.visit_enum(word.clone().into_deserializer());
            // A known word without its content is a mistake in the content.
            return value.map_err(|misfit: Misfit| match misfit.is_of_word() {
                true => misfit,
                false => misfit.inside(Step::Key(word.into_owned())),
            });
        }
        match (self.first(), self.parts().len()) {
            (Some('{'), 1) => visitor.visit_enum(MapAccessDeserializer::new(Parts {
                is_variant: true,
                ..Parts::of(self)
            })),
            (Some('{'), _) => {
                let expected = "map with a single key";
                Err(Misfit::invalid_value(Unexpected::Map, &expected))
            }
            _ => match self.deserialize_any(WordOrObject)? {},
        }
    }

    fn deserialize_ignored_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Misfit> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct seq tuple tuple_struct identifier
    }
}

/// A word or an object, where a variant is expected and something else stands.
struct WordOrObject;

impl Visitor<'_> for WordOrObject {
    type Value = Infallible;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("string or map")
    }
}

/// The entries of an object or list, of which some are taken.
struct Parts<'a> {
    of: Json<'a>,
    taken: usize,
    /// True if the key is the word of a variant: a wrong one is a mistake of the whole.
    is_variant: bool,
}

impl<'a> Parts<'a> {
    fn of(of: Json<'a>) -> Self {
        Self {
            of,
            taken: 0,
            is_variant: false,
        }
    }

    /// Takes the next one.
    fn next(&mut self) -> Option<Json<'a>> {
        let next = self.of.part(self.taken)?;
        self.taken += 1;
        Some(next)
    }
}

impl<'a> SeqAccess<'a> for &mut Parts<'a> {
    type Error = Misfit;

    fn next_element_seed<T: DeserializeSeed<'a>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Misfit> {
        let index = self.taken;
        let value = self.next().map(|next| seed.deserialize(next)).transpose();
        value.map_err(|misfit| misfit.inside(Step::Index(index)))
    }
}

impl<'a> MapAccess<'a> for Parts<'a> {
    type Error = Misfit;

    fn next_key_seed<K: DeserializeSeed<'a>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Misfit> {
        let Some(key) = self.next().and_then(Json::key) else {
            return Ok(None);
        };
        let read = seed.deserialize(key.clone().into_deserializer());
        read.map(Some)
            .map_err(|misfit: Misfit| match self.is_variant {
                true => misfit,
                false => misfit.inside(Step::Key(key.into_owned())),
            })
    }

    fn next_value_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<T::Value, Misfit> {
        let present = self.taken.checked_sub(1);
        let value = present.and_then(|taken| self.of.part(taken));
        let value = value.ok_or_else(|| Misfit::custom("a value without a key"))?;
        seed.deserialize(value).map_err(|misfit| {
            let key = value.key().unwrap_or_default();
            misfit.inside(Step::Key(key.into_owned()))
        })
    }
}
