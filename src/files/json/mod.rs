//! JSON text: values with their places, mistakes that quote them, overrides, the layout of what is written.
//!
//! - `document`, `locate`: a file and where its values stand; `scope`: a value with its place, for messages.
//! - `error`, `wording`: mistakes, and serde's in our words; `not_offered`: words for what is not offered; `either`: values that are written in two ways.
//! - `set`: overrides of the command line; `layout`: lines of what is written.

pub(crate) mod document;
pub mod either;
pub mod error;
pub(crate) mod layout;
pub(crate) mod locate;
mod not_offered;
pub(crate) mod scope;
pub(crate) mod set;
pub(crate) mod wording;
