//! JSON text: values with their places, errors that quote them, overrides, the layout of written files.
//!
//! - `source`: the bytes of a file, if there is room for them; `document`: a file; `scope`: a value with its place, for messages.
//! - `scan`, `locate`: its text value by value, and where these stand; `token`, `reader`: values of serde from it. Beside the text nothing is kept of a file.
//! - `error`, `wording`: mistakes, and serde's in our words; `not_offered`: words for what is not offered; `either`: values that are written in two ways.
//! - `set`: overrides of the command line; `layout`: lines of what is written.

pub(crate) mod document;
pub mod either;
pub mod error;
pub(crate) mod layout;
pub(crate) mod locate;
pub(crate) mod reader;
pub(crate) mod scan;
pub(crate) mod scope;
pub(crate) mod set;
pub(crate) mod source;
pub(crate) mod wording;
