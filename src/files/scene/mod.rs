//! The scene file: its types as written (`spec`, `spec_solids`, `point`) and their conversion to a [`System`](crate::model::System).
//!
//! - `build`: the scene; `body`, `joint`, `material`, `muscle`, `spring`, `shape`, `contact`, `load`: its parts, each described and
//!   converted in one file.
//! - `solid`, `mesh`, `division`, `surface`, `electrodes`, `nodes`: elastic solids; `names`: resolution of names.
//! - `constants`: constants by their paths, as an optimisation may seek them.
//! - `expand`: the shorthand of chains; `trunk`: a scene to begin with.

pub(crate) mod body;
pub(crate) mod build;
pub(crate) mod constants;
pub mod contact;
pub(crate) mod division;
pub(crate) mod electrodes;
pub(crate) mod expand;
pub mod joint;
pub mod load;
pub mod material;
pub(crate) mod mesh;
pub(crate) mod muscle;
pub(crate) mod names;
pub(crate) mod nodes;
pub mod point;
pub mod shape;
pub(crate) mod solid;
pub mod spec;
pub mod spec_solids;
pub mod spring;
mod surface;
pub(crate) mod trunk;
