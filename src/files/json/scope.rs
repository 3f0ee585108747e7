//! A place in a document from which checks report, and the checks shared by scene and problem.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::fmt;
use std::path::PathBuf;

use crate::files::json::document::Document;
use crate::files::json::error::SceneError;
use crate::files::json::path::{JsonPath, Step};
use crate::files::units::quantity::{Kind, PhysicalQuantity, Quantity, WRITTEN};
use crate::math::{Fault, unique};

pub(crate) use crate::files::json::error::Result;
pub(crate) use crate::math::refuse;

/// A place in a document.
#[derive(Clone)]
pub(crate) struct Scope<'a> {
    pub(crate) document: &'a Document,
    pub(crate) place: JsonPath,
}

impl<'a> Scope<'a> {
    /// The whole document.
    pub(crate) fn of(document: &'a Document) -> Self {
        let place = JsonPath::default();
        Self { document, place }
    }

    fn inside(&self, place: JsonPath) -> Self {
        Self { place, ..*self }
    }

    /// Returns the error of a value here that is not the expected one.
    pub(crate) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        self.document.mistake(&self.place, found, expected)
    }

    /// The error of an entry that is needed here.
    pub(crate) fn missing_key(&self, key: &str) -> SceneError {
        self.wrong(format!("no key {key:?}"), format!("the key {key:?}"))
    }

    /// The error of a fault of what stands here, in its own words.
    pub(crate) fn error_of(&self, fault: Fault) -> SceneError {
        self.wrong(fault.found, fault.expected)
    }

    /// The error of a fault of what is written here.
    pub(crate) fn refuse<S: Serialize + JsonSchema>(
        &self,
        written: &S,
        fault: &Fault,
    ) -> SceneError {
        self.refuse_in(written, &JsonPath::default(), fault)
    }

    /// The error of a fault of a part of what is written here.
    pub(crate) fn refuse_in<S: Serialize + JsonSchema>(
        &self,
        written: &S,
        part: &JsonPath,
        fault: &Fault,
    ) -> SceneError {
        let at = JsonPath::parse(&fault.clone().under("part").at).unwrap_or_default();
        let steps = part.0.iter().chain(at.0.iter().skip(1));
        let place = steps
            .clone()
            .fold(self.place.clone(), |at, step| at.then(step.clone()));
        let value = serde_json::to_value(written).ok();
        let value = value.as_ref().and_then(|whole| entry(whole, steps.clone()));
        let found = match (&fault.value, value.and_then(text)) {
            (Some(_), Some(value)) => format!("{value}{}", fault.found),
            _ => fault.finding(),
        };
        let schema = schemars::schema_for!(S).to_value();
        let kind = kind(&schema, steps).filter(|_| fault.expects_quantity());
        let kind = kind.map_or_else(String::new, |kind| format!(": {kind}"));
        let expected = format!("{}{kind}", fault.expected);
        self.document.mistake(&place, found, expected)
    }

    /// Index of a name in a list.
    pub(crate) fn find(&self, name: &str, names: &[String], expected: &str) -> Result<usize> {
        let position = names.iter().position(|other| other == name);
        position.ok_or_else(|| {
            let candidates = names.iter().map(String::as_str);
            self.document
                .wrong_name(&self.place, name, expected, candidates)
        })
    }

    /// The file that a path written here names: relative to the document.
    pub(crate) fn file(&self, path: &str, expected: &str) -> Result<PathBuf> {
        let file = Some(self.document.beside(path)).filter(|file| file.is_file());
        file.ok_or_else(|| self.missing(path, "file", expected))
    }

    /// The same, or else in the current folder: results of earlier runs.
    pub(crate) fn file_or_result(&self, path: &str, expected: &str) -> Result<PathBuf> {
        self.result(path, None, expected)
    }

    /// The `solution.json` that a path names, or that is in the folder that it names; in the same places.
    pub(crate) fn solution_file(&self, path: &str, expected: &str) -> Result<PathBuf> {
        self.result(path, Some("solution.json"), expected)
    }

    /// The `feedback.json` that a path names, or that is in the folder that it names; in the same places.
    pub(crate) fn feedback_file(&self, path: &str) -> Result<PathBuf> {
        let expected = "the path of the feedback.json of an optimum, or of its folder";
        self.result(path, Some("feedback.json"), expected)
    }

    /// A file beside the document or in the current folder, or the one of a name in a folder there.
    fn result(&self, path: &str, name: Option<&str>, expected: &str) -> Result<PathBuf> {
        let places = [self.document.beside(path), PathBuf::from(path)];
        let mut files = places.into_iter().map(|place| match name {
            Some(name) if place.is_dir() => place.join(name),
            _ => place,
        });
        let file = files.find(|file| file.is_file());
        file.ok_or_else(|| self.missing(path, name.unwrap_or("file"), expected))
    }

    fn missing(&self, path: &str, kind: &str, expected: &str) -> SceneError {
        self.wrong(format!("{path:?}, where there is no {kind}"), expected)
    }

    /// That times in ms increase, at the first that does not.
    pub(crate) fn increasing(&self, times: &[f64]) -> Result<()> {
        let falls = times.windows(2).position(|pair| pair[0] >= pair[1]);
        falls.map_or(Ok(()), |index| {
            let found = format!("{} s", times[index + 1] / 1e3);
            Err(self.index(index + 1).wrong(found, "increasing times"))
        })
    }

    /// A positive quantity in the units inside.
    pub(crate) fn positive<M: PhysicalQuantity>(&self, quantity: &Quantity<M>) -> Result<f64> {
        let value = quantity.value();
        if value > 0.0 {
            return Ok(value);
        }
        let expected = format!("a positive value: {}", Quantity::<M>::expected());
        Err(self.wrong(quantity.to_string(), expected))
    }

    /// A quantity read as one kind, in the units inside.
    pub(crate) fn value_as<M: PhysicalQuantity>(
        &self,
        quantity: &Quantity<M>,
        kind: &Kind,
    ) -> Result<f64> {
        let value = quantity.value_as(kind);
        value.map_err(|found| self.wrong(found, kind.expected()))
    }

    /// A weight that is zero or more; zero leaves no trace.
    pub(crate) fn weight(&self, weight: f64) -> Result<f64> {
        refuse!(if weight < 0.0, self; found weight, expected "a weight that is not negative");
        Ok(weight)
    }

    /// The one entry that is there.
    pub(crate) fn exactly_one<T, const N: usize>(
        &self,
        entries: [(&str, Option<T>); N],
    ) -> Result<T> {
        let expected = format!(
            "exactly one of {}",
            list(entries.iter().map(|&(key, _)| key))
        );
        let mut there = entries
            .into_iter()
            .filter_map(|(key, entry)| Some((key, entry?)));
        match (there.next(), there.next()) {
            (Some((_, entry)), None) => Ok(entry),
            (None, _) => Err(self.wrong("none of them", expected)),
            (Some((first, _)), Some((second, _))) => {
                Err(self.wrong(list([first, second].into_iter()), expected))
            }
        }
    }

    /// The key of the one entry that is there.
    pub(crate) fn one_key<'k, const N: usize>(
        &self,
        entries: [(&'k str, bool); N],
    ) -> Result<&'k str> {
        self.exactly_one(entries.map(|(key, is_there)| (key, is_there.then_some(key))))
    }

    /// A number of things from one to a limit.
    pub(crate) fn count(&self, value: usize, noun: &str, most: usize) -> Result<()> {
        let expected = match value {
            0 => format!("1 {noun} or more"),
            _ if value > most => format!("no more than {most} {noun}s"),
            _ => return Ok(()),
        };
        Err(self.wrong(value.to_string(), expected))
    }

    /// A list without repeated, empty or reserved names; `place` gives the place of a name.
    pub(crate) fn unique(
        &self,
        names: &[String],
        reserved: &[&str],
        place: impl Fn(usize) -> Self,
    ) -> Result<()> {
        unique(names, reserved).map_err(|(index, fault)| place(index).error_of(fault))
    }
}

/// Declares the ways from a place to those inside it, of a type that makes itself for another place by `inside`.
macro_rules! ways_inside {
    ($name:ident) => {
        impl<'a> $name<'a> {
            /// The entry under a key.
            pub(crate) fn key(&self, key: &str) -> Self {
                self.inside(self.place.key(key))
            }

            /// The entry at an index.
            pub(crate) fn index(&self, index: usize) -> Self {
                self.inside(self.place.index(index))
            }

            /// Makes a value of each entry of a list here.
            pub(crate) fn each<S, T, C: FromIterator<T>>(
                &self,
                list: &[S],
                make: impl Fn(&S, &Self) -> Result<T>,
            ) -> Result<C> {
                let make = |(index, one)| make(one, &self.index(index));
                list.iter().enumerate().map(make).collect()
            }

            /// Makes a value of each entry of an object here by its name.
            pub(crate) fn each_named<'s, S: 's, T, C: FromIterator<T>>(
                &self,
                map: impl IntoIterator<Item = (&'s String, &'s S)>,
                make: impl Fn(&str, &S, &Self) -> Result<T>,
            ) -> Result<C> {
                let make = |(name, one): (&'s String, &'s S)| make(name, one, &self.key(name));
                map.into_iter().map(make).collect()
            }

            /// Makes a value of what is written under a key, where something is.
            pub(crate) fn optional<S, T>(
                &self,
                key: &str,
                written: &Option<S>,
                make: impl FnOnce(&Self, &S) -> Result<T>,
            ) -> Result<Option<T>> {
                let make = |one| make(&self.key(key), one);
                written.as_ref().map(make).transpose()
            }
        }
    };
}
pub(crate) use ways_inside;

ways_inside!(Scope);

/// Makes a value of the one of some entries of an object that is there, at its place.
macro_rules! the_one {
    ($at:expr, $of:expr; $($key:literal $entry:ident |$place:pat_param, $one:pat_param| $made:expr;)+) => {{
        $at.one_key([$(($key, $of.$entry.is_some())),+])?;
        $(if let Some($one) = &$of.$entry {
            let $place = &$at.key($key);
            $made
        } else)+ {
            unreachable!("one of them is there")
        }
    }};
}
pub(crate) use the_one;

/// The value at a place.
fn entry<'v, 's>(whole: &'v Value, mut steps: impl Iterator<Item = &'s Step>) -> Option<&'v Value> {
    steps.try_fold(whole, |value, step| match step {
        Step::Key(key) => value.get(key),
        Step::Index(index) => value.get(index),
    })
}

/// A value in messages: a number, a text or a list of numbers.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::Number(number) => Some(number.as_f64()?.to_string()),
        Value::String(text) => Some(format!("{text:?}")),
        Value::Array(list) => {
            let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
            Some(format!("{:?}", numbers?))
        }
        _ => None,
    }
}

/// The kind of the quantity at a place of what a schema describes.
fn kind<'v, 's>(schema: &'v Value, mut steps: impl Iterator<Item = &'s Step>) -> Option<&'v str> {
    let one = |entry: &'v Value| {
        let entry = entry.pointer("/anyOf/0").unwrap_or(entry);
        let named = entry.get("$ref").and_then(Value::as_str);
        named.map_or(Some(entry), |name| schema.pointer(name.strip_prefix('#')?))
    };
    let entry = steps.try_fold(schema, |entry, step| match step {
        Step::Key(key) => one(entry.get("properties")?.get(key)?),
        Step::Index(_) => one(entry.get("items")?),
    })?;
    let described = entry.get("description")?.as_str()?;
    described.strip_prefix(WRITTEN)?.strip_suffix('.')
}

/// Names in quotes, separated by commas.
pub(crate) fn list<T: fmt::Debug>(names: impl Iterator<Item = T>) -> String {
    names
        .map(|name| format!("{name:?}"))
        .collect::<Vec<_>>()
        .join(", ")
}
