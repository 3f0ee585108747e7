//! Values of serde from the text of a JSON file, as serde_json reads them from its values, without values in between.
//!
//! The text is JSON. Messages are those of [`serde_json::Value`] as a deserializer: they have no line, since a path identifies the place.

use serde::Deserialize;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error as _, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};
use serde_json::{Error, Number};
use std::borrow::Cow;

use crate::files::json::scan::{Scanner, string};

/// The next value of a text.
#[derive(Debug)]
pub(crate) struct Reader<'a>(Scanner<'a>);

impl<'a> Reader<'a> {
    /// Of a JSON text.
    pub(crate) fn of(text: &'a str) -> Self {
        Self(Scanner::of(text))
    }

    /// A text that is no JSON after all.
    fn broken() -> Error {
        Error::custom("a text that is no JSON")
    }

    fn expect(&mut self, byte: u8) -> Result<(), Error> {
        self.0.expect(byte).ok_or_else(Self::broken)
    }

    /// Moves past what begins here.
    fn scalar(&mut self) -> Result<&'a str, Error> {
        let bytes = self.0.scalar().ok_or_else(Self::broken)?;
        self.0.blanks();
        Ok(&self.0.text[bytes])
    }

    fn string(&mut self) -> Result<Cow<'a, str>, Error> {
        let bytes = self.0.scalar().ok_or_else(Self::broken)?;
        self.0.blanks();
        string(self.0.text, bytes).ok_or_else(Self::broken)
    }

    /// Moves past the object or list that begins here, of which `visit` takes all entries.
    fn inside<T>(
        &mut self,
        [open, close]: [u8; 2],
        expected: &'static str,
        visit: impl FnOnce(Entries<'_, 'a>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let whole = self.0;
        self.expect(open)?;
        let value = visit(Entries::of(self))?;
        if self.0.peek() != Some(close) {
            let length = whole.entries().count();
            return Err(Error::invalid_length(length, &expected));
        }
        self.expect(close)?;
        Ok(value)
    }
}

/// Visits the string of a text.
fn visit<'a, V: Visitor<'a>>(text: Cow<'a, str>, visitor: V) -> Result<V::Value, Error> {
    match text {
        Cow::Borrowed(text) => visitor.visit_borrowed_str(text),
        Cow::Owned(text) => visitor.visit_string(text),
    }
}

impl<'a> Deserializer<'a> for &mut Reader<'a> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0.peek().ok_or_else(Reader::broken)? {
            b'{' => self.inside(*b"{}", "fewer elements in map", |entries| {
                visitor.visit_map(entries)
            }),
            b'[' => self.inside(*b"[]", "fewer elements in array", |entries| {
                visitor.visit_seq(entries)
            }),
            b'"' => visit(self.string()?, visitor),
            _ => match self.scalar()? {
                "null" => visitor.visit_unit(),
                "true" => visitor.visit_bool(true),
                "false" => visitor.visit_bool(false),
                number => serde_json::from_str::<Number>(number)?.deserialize_any(visitor),
            },
        }
    }

    fn deserialize_option<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0.peek() {
            // No other word begins so.
            Some(b'n') => {
                self.scalar()?;
                visitor.visit_none()
            }
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'a>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'a>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let wrong = |found| Err(Error::invalid_type(found, &"string or map"));
        match self.0.peek().ok_or_else(Reader::broken)? {
            b'"' => {
                let word = self.string()?;
                visitor.visit_enum(Word {
                    word,
                    content: None,
                })
            }
            b'{' => {
                if self.0.entries().count() != 1 {
                    let expected = "map with a single key";
                    return Err(Error::invalid_value(Unexpected::Map, &expected));
                }
                self.expect(b'{')?;
                let word = self.string()?;
                self.expect(b':')?;
                let content = Some(&mut *self);
                let value = visitor.visit_enum(Word { word, content })?;
                self.expect(b'}')?;
                Ok(value)
            }
            b'[' => wrong(Unexpected::Seq),
            _ => match self.scalar()? {
                "null" => wrong(Unexpected::Unit),
                "true" => wrong(Unexpected::Bool(true)),
                "false" => wrong(Unexpected::Bool(false)),
                number => {
                    let number = serde_json::from_str::<Number>(number)?;
                    wrong(match (number.as_u64(), number.as_i64()) {
                        (Some(number), _) => Unexpected::Unsigned(number),
                        (None, Some(number)) => Unexpected::Signed(number),
                        (None, None) => Unexpected::Float(number.as_f64().unwrap_or_default()),
                    })
                }
            },
        }
    }

    fn deserialize_ignored_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        self.0.value().ok_or_else(Reader::broken)?;
        self.0.blanks();
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map struct identifier
    }
}

/// The entries of an object or list that are still to come.
struct Entries<'r, 'a> {
    reader: &'r mut Reader<'a>,
    is_first: bool,
}

impl<'r, 'a> Entries<'r, 'a> {
    fn of(reader: &'r mut Reader<'a>) -> Self {
        Self {
            reader,
            is_first: true,
        }
    }

    /// Moves to the next one.
    fn next(&mut self) -> Result<bool, Error> {
        if matches!(self.reader.0.peek(), Some(b'}' | b']')) {
            return Ok(false);
        }
        if !self.is_first {
            self.reader.expect(b',')?;
        }
        self.is_first = false;
        Ok(true)
    }
}

impl<'a> SeqAccess<'a> for Entries<'_, 'a> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'a>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        match self.next()? {
            true => seed.deserialize(&mut *self.reader).map(Some),
            false => Ok(None),
        }
    }
}

impl<'a> MapAccess<'a> for Entries<'_, 'a> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'a>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Error> {
        match self.next()? {
            true => seed.deserialize(&mut *self.reader).map(Some),
            false => Ok(None),
        }
    }

    fn next_value_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<T::Value, Error> {
        self.reader.expect(b':')?;
        seed.deserialize(&mut *self.reader)
    }
}

/// A variant by its word, alone or as the key of its content.
struct Word<'r, 'a> {
    word: Cow<'a, str>,
    content: Option<&'r mut Reader<'a>>,
}

impl<'r, 'a> EnumAccess<'a> for Word<'r, 'a> {
    type Error = Error;
    type Variant = Content<'r, 'a>;

    fn variant_seed<T: DeserializeSeed<'a>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Self::Variant), Error> {
        let variant = seed.deserialize(Key(self.word))?;
        Ok((variant, Content(self.content)))
    }
}

/// The word of a variant.
struct Key<'a>(Cow<'a, str>);

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

/// Value under the word of a variant.
struct Content<'r, 'a>(Option<&'r mut Reader<'a>>);

impl<'a> Content<'_, 'a> {
    fn taken<V: Visitor<'a>>(self, visitor: V, expected: &str) -> Result<V::Value, Error> {
        match self.0 {
            Some(reader) => reader.deserialize_any(visitor),
            None => Err(Error::invalid_type(Unexpected::UnitVariant, &expected)),
        }
    }
}

impl<'a> VariantAccess<'a> for Content<'_, 'a> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        self.0.map_or(Ok(()), Deserialize::deserialize)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'a>>(self, seed: T) -> Result<T::Value, Error> {
        let expected = "newtype variant";
        let missing = || Error::invalid_type(Unexpected::UnitVariant, &expected);
        seed.deserialize(self.0.ok_or_else(missing)?)
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, visitor: V) -> Result<V::Value, Error> {
        self.taken(visitor, "tuple variant")
    }

    fn struct_variant<V: Visitor<'a>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.taken(visitor, "struct variant")
    }
}
