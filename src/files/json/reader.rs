//! Values of serde from the text of a JSON file, and the path of the first mistake.
//!
//! The text is JSON. Messages are those of [`serde_json::Value`] as a deserializer: they have no line, since a path identifies the place.
//! The reader keeps the path itself: a deserializer around it would compile every type of a file once more. For the same reason a type
//! that asks for one kind of value is given the code of this kind alone.

use crate::files::json::locate::{JsonPath, Step};
use crate::files::json::scan::{Scanner, string};
use serde::Deserialize;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected, MapAccess,
    SeqAccess, Unexpected, VariantAccess, Visitor,
};
use serde_json::{Error, Number};
use std::borrow::Cow;
use std::ops::Range;

/// Reads the value of a JSON text.
///
/// # Errors
/// The path of the innermost value or key that does not fit, and the reason.
pub(crate) fn parse<T: DeserializeOwned>(text: &str) -> Result<T, (JsonPath, Error)> {
    let mut reader = Reader {
        scanner: Scanner::of(text),
        path: Vec::new(),
    };
    T::deserialize(&mut reader).map_err(|error| (reader.path(), error))
}

/// A step to a value: an index, or the bytes of a key with its quotes.
enum Segment {
    Index(usize),
    Key(Range<usize>),
}

/// The next value of a text.
struct Reader<'a> {
    scanner: Scanner<'a>,
    /// Path of the value that is being read. After an error it leads to the mistake, since only values that were read leave it.
    path: Vec<Segment>,
}

impl<'a> Reader<'a> {
    fn path(&self) -> JsonPath {
        let step = |segment: &Segment| match segment {
            Segment::Index(index) => Some(Step::Index(*index)),
            Segment::Key(bytes) => {
                let key = string(self.scanner.text, bytes.clone())?;
                Some(Step::Key(key.into_owned()))
            }
        };
        JsonPath(self.path.iter().filter_map(step).collect())
    }

    /// The key that begins here.
    fn key(&self) -> Result<Segment, Error> {
        let mut ahead = self.scanner;
        let key = ahead.scalar().ok_or_else(Self::broken)?;
        Ok(Segment::Key(key))
    }

    /// A text that is no JSON after all.
    fn broken() -> Error {
        Error::custom("a text that is no JSON")
    }

    fn expect(&mut self, byte: u8) -> Result<(), Error> {
        self.scanner.expect(byte).ok_or_else(Self::broken)
    }

    /// Moves past what begins here.
    fn scalar(&mut self) -> Result<&'a str, Error> {
        let bytes = self.scanner.scalar().ok_or_else(Self::broken)?;
        self.scanner.blanks();
        Ok(&self.scanner.text[bytes])
    }

    fn string(&mut self) -> Result<Cow<'a, str>, Error> {
        let bytes = self.scanner.scalar().ok_or_else(Self::broken)?;
        self.scanner.blanks();
        string(self.scanner.text, bytes).ok_or_else(Self::broken)
    }

    /// Moves into the object or list that begins here.
    fn open(&mut self) -> Result<Scanner<'a>, Error> {
        let whole = self.scanner;
        let bracket = whole.peek().ok_or_else(Self::broken)?;
        self.expect(bracket)?;
        Ok(whole)
    }

    /// Moves past the end of the object or list that began at `whole`, of which all entries have to be taken.
    fn close(&mut self, whole: Scanner<'a>) -> Result<(), Error> {
        let (bracket, expected) = match whole.peek() {
            Some(b'{') => (b'}', "fewer elements in map"),
            _ => (b']', "fewer elements in array"),
        };
        if self.scanner.peek() != Some(bracket) {
            let length = whole.entries().count();
            return Err(Error::invalid_length(length, &expected));
        }
        self.expect(bracket)
    }

    /// The value that begins here, where it is none with entries; moves past it.
    fn token(&mut self) -> Result<Token<'a>, Error> {
        Ok(match self.scanner.peek().ok_or_else(Self::broken)? {
            b'{' => Token::Object,
            b'[' => Token::List,
            b'"' => Token::Text(self.string()?),
            _ => match self.scalar()? {
                "null" => Token::Null,
                "true" => Token::Bool(true),
                "false" => Token::Bool(false),
                number => Token::Number(serde_json::from_str(number)?),
            },
        })
    }

    /// Moves into the object of one entry that begins here.
    fn open_variant(&mut self) -> Result<Scanner<'a>, Error> {
        if self.scanner.entries().count() != 1 {
            let expected = "map with a single key";
            return Err(Error::invalid_value(Unexpected::Map, &expected));
        }
        self.open()
    }

    /// The error of the value that begins here where something else is expected.
    fn unexpected(&mut self, expected: &dyn Expected) -> Error {
        self.token()
            .map_or_else(|broken| broken, |token| token.unexpected(expected))
    }

    /// Visits the object that begins here.
    fn object<V: Visitor<'a>>(&mut self, visitor: V) -> Result<V::Value, Error> {
        if self.scanner.peek() != Some(b'{') {
            return Err(self.unexpected(&visitor));
        }
        let whole = self.open()?;
        let value = visitor.visit_map(Entries::of(self))?;
        self.close(whole)?;
        Ok(value)
    }

    /// Visits the list that begins here.
    fn list<V: Visitor<'a>>(&mut self, visitor: V) -> Result<V::Value, Error> {
        if self.scanner.peek() != Some(b'[') {
            return Err(self.unexpected(&visitor));
        }
        let whole = self.open()?;
        let value = visitor.visit_seq(Entries::of(self))?;
        self.close(whole)?;
        Ok(value)
    }

    /// Visits a variant by its word, which begins here, alone or as the key of its content.
    fn variant<V: Visitor<'a>>(
        &mut self,
        visitor: V,
        has_content: bool,
    ) -> Result<V::Value, Error> {
        let key = self.key()?;
        let word = self.string()?;
        if has_content {
            self.expect(b':')?;
        }
        let value = visitor.visit_enum(Word {
            word,
            key,
            has_content,
            reader: &mut *self,
        })?;
        self.path.pop();
        Ok(value)
    }
}

/// Methods of a deserializer that visit values of one kind only.
macro_rules! one_kind {
    ($kind:ident: $($method:ident($($argument:ty),*)),+) => {$(
        fn $method<V: Visitor<'a>>(self, $(_: $argument,)* visitor: V) -> Result<V::Value, Error> {
            self.$kind(visitor)
        }
    )+};
    ($kind:ident of a token: $($method:ident($($argument:ty),*)),+) => {$(
        fn $method<V: Visitor<'a>>(self, $(_: $argument,)* visitor: V) -> Result<V::Value, Error> {
            self.token()?.$kind(visitor)
        }
    )+};
}

impl<'a> Deserializer<'a> for &mut Reader<'a> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.scanner.peek() {
            Some(b'{') => self.object(visitor),
            Some(b'[') => self.list(visitor),
            _ => match self.token()? {
                Token::Text(text) => visit(text, visitor),
                Token::Bool(value) => visitor.visit_bool(value),
                Token::Number(number) => number.deserialize_any(visitor),
                _ => visitor.visit_unit(),
            },
        }
    }

    fn deserialize_option<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.scanner.peek() {
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
        match self.scanner.peek() {
            Some(b'"') => self.variant(visitor, false),
            Some(b'{') => {
                let whole = self.open_variant()?;
                let value = self.variant(visitor, true)?;
                self.close(whole)?;
                Ok(value)
            }
            _ => Err(self.unexpected(&"string or map")),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'a>>(self, visitor: V) -> Result<V::Value, Error> {
        self.scanner.value().ok_or_else(Reader::broken)?;
        self.scanner.blanks();
        visitor.visit_unit()
    }

    one_kind!(boolean of a token: deserialize_bool());
    one_kind!(number of a token:
        deserialize_i8(), deserialize_i16(), deserialize_i32(), deserialize_i64(),
        deserialize_u8(), deserialize_u16(), deserialize_u32(), deserialize_u64(),
        deserialize_f32(), deserialize_f64());
    one_kind!(text of a token:
        deserialize_char(), deserialize_str(), deserialize_string(), deserialize_identifier());
    one_kind!(null of a token: deserialize_unit(), deserialize_unit_struct(&'static str));
    one_kind!(list:
        deserialize_seq(), deserialize_tuple(usize),
        deserialize_tuple_struct(&'static str, usize));
    one_kind!(object:
        deserialize_map(), deserialize_struct(&'static str, &'static [&'static str]));

    serde::forward_to_deserialize_any! {
        <W: Visitor<'a>>
        bytes byte_buf
    }
}

/// The entries of an object or list that are still to come.
struct Entries<'r, 'a> {
    reader: &'r mut Reader<'a>,
    /// Number of entries before the next one.
    before: usize,
}

impl<'r, 'a> Entries<'r, 'a> {
    fn of(reader: &'r mut Reader<'a>) -> Self {
        Self { reader, before: 0 }
    }

    /// Moves to the next one.
    fn next(&mut self) -> Result<bool, Error> {
        if matches!(self.reader.scanner.peek(), Some(b'}' | b']')) {
            return Ok(false);
        }
        if self.before > 0 {
            self.reader.expect(b',')?;
        }
        self.before += 1;
        Ok(true)
    }
}

impl<'a> SeqAccess<'a> for Entries<'_, 'a> {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'a>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Error> {
        if !self.next()? {
            return Ok(None);
        }
        self.reader.path.push(Segment::Index(self.before - 1));
        let value = seed.deserialize(&mut *self.reader)?;
        self.reader.path.pop();
        Ok(Some(value))
    }
}

impl<'a> MapAccess<'a> for Entries<'_, 'a> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'a>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Error> {
        if !self.next()? {
            return Ok(None);
        }
        let key = self.reader.key()?;
        self.reader.path.push(key);
        seed.deserialize(&mut *self.reader).map(Some)
    }

    fn next_value_seed<T: DeserializeSeed<'a>>(&mut self, seed: T) -> Result<T::Value, Error> {
        self.reader.expect(b':')?;
        let value = seed.deserialize(&mut *self.reader)?;
        self.reader.path.pop();
        Ok(value)
    }
}

/// A variant by its word, alone or as the key of its content.
struct Word<'r, 'a> {
    word: Cow<'a, str>,
    key: Segment,
    has_content: bool,
    reader: &'r mut Reader<'a>,
}

impl<'r, 'a> EnumAccess<'a> for Word<'r, 'a> {
    type Error = Error;
    type Variant = Content<'r, 'a>;

    fn variant_seed<T: DeserializeSeed<'a>>(
        self,
        seed: T,
    ) -> Result<(T::Value, Self::Variant), Error> {
        let variant = seed.deserialize(Key(self.word))?;
        // What is wrong from here on is a mistake in the content of a known word.
        self.reader.path.push(self.key);
        Ok((variant, Content(self.has_content.then_some(self.reader))))
    }
}

/// Value under the word of a variant.
struct Content<'r, 'a>(Option<&'r mut Reader<'a>>);

impl<'r, 'a> Content<'r, 'a> {
    fn taken(self, expected: &str) -> Result<&'r mut Reader<'a>, Error> {
        let missing = || Error::invalid_type(Unexpected::UnitVariant, &expected);
        self.0.ok_or_else(missing)
    }
}

impl<'a> VariantAccess<'a> for Content<'_, 'a> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        self.0.map_or(Ok(()), Deserialize::deserialize)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'a>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self.taken("newtype variant")?)
    }

    fn tuple_variant<V: Visitor<'a>>(self, _: usize, visitor: V) -> Result<V::Value, Error> {
        self.taken("tuple variant")?.list(visitor)
    }

    fn struct_variant<V: Visitor<'a>>(
        self,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.taken("struct variant")?.object(visitor)
    }
}

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
