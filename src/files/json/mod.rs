//! JSON text: values with their places, errors that quote them, overrides, the layout of written files.
//!
//! - `tree`: values with their places in a text; `path`: places by keys.
//! - `document`: a file with overrides; `scope`: a value with its place, for messages.
//! - `reader`: values of serde from a tree; `misfit`: those that do not fit, in our words; `either`: values that are written in two ways;
//!   `objects`: types of objects.
//! - `error`: mistakes; `set`: overrides of the command line; `layout`: objects and lines of what is written.

pub(crate) mod document;
pub mod either;
pub mod error;
pub(crate) mod layout;
pub(crate) mod misfit;
pub(crate) mod objects;
pub(crate) mod path;
pub(crate) mod reader;
pub(crate) mod scope;
pub(crate) mod set;
pub(crate) mod tree;
