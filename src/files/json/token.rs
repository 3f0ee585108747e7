//! Values of a JSON text that have no entries: their kinds, and what visitors of serde make of them.

use serde::de::{Deserializer, Error as _, Expected, Unexpected, Visitor};
use serde_json::{Error, Number};
use std::borrow::Cow;

/// A value, or that entries follow.
pub(super) enum Token<'a> {
    Object,
    List,
    Text(Cow<'a, str>),
    Null,
    Bool(bool),
    Number(Number),
}

impl Token<'_> {
    /// The error of a value of this kind where something else is expected.
    pub(super) fn unexpected(&self, expected: &dyn Expected) -> Error {
        let found = match self {
            Token::Object => Unexpected::Map,
            Token::List => Unexpected::Seq,
            Token::Text(text) => Unexpected::Str(text),
            Token::Null => Unexpected::Unit,
            Token::Bool(value) => Unexpected::Bool(*value),
            Token::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(number), _) => Unexpected::Unsigned(number),
                (None, Some(number)) => Unexpected::Signed(number),
                (None, None) => Unexpected::Float(number.as_f64().unwrap_or_default()),
            },
        };
        Error::invalid_type(found, expected)
    }
}

impl<'a> Token<'a> {
    pub(super) fn null<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Token::Null => visitor.visit_unit(),
            other => Err(other.unexpected(&visitor)),
        }
    }

    pub(super) fn boolean<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Token::Bool(value) => visitor.visit_bool(value),
            other => Err(other.unexpected(&visitor)),
        }
    }

    pub(super) fn number<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Token::Number(number) => number.deserialize_any(visitor),
            other => Err(other.unexpected(&visitor)),
        }
    }

    pub(super) fn text<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self {
            Token::Text(text) => visit(text, visitor),
            other => Err(other.unexpected(&visitor)),
        }
    }
}

/// Visits the string of a text.
pub(super) fn visit<'a, V: Visitor<'a>>(text: Cow<'a, str>, visitor: V) -> Result<V::Value, Error> {
    match text {
        Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
        Cow::Owned(text) => visitor.visit_string(text),
    }
}

/// The word of a variant.
pub(super) struct Key<'a>(pub(super) Cow<'a, str>);

impl<'a> Deserializer<'a> for Key<'a> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        visit(self.0, visitor)
    }

    serde::forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}
