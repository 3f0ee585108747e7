//! The scene file: its types as written (`spec`, `spec_joints`, `spec_material`, `spec_solids`, `point`) and their conversion to a [`System`](crate::model::System).
//!
//! - `build`: the scene; `body`, `material`, `muscle`, `marker`: its parts; `components`: kinds of which each has one file for both, in the lists of `component_lists`.
//! - `solid`, `mesh`, `electrodes`, `nodes`: elastic solids; `graph`: connections by joints; `names`: resolution of names; `named_entries`: lists with positions.
//! - `law`: laws of elasticity of materials; `named_materials`: published constants; `circuit`: circuits of muscles.
//! - `constants`: constants by their paths, as an optimisation may seek them.
//! - `expand`: the shorthand of chains; `trunk`: a scene to begin with.

pub(crate) mod body;
pub(crate) mod build;
mod circuit;
mod component_lists;
pub mod components;
pub(crate) mod constants;
pub(crate) mod electrodes;
pub(crate) mod expand;
pub(crate) mod graph;
mod joint;
pub mod law;
pub(crate) mod marker;
pub(crate) mod material;
pub(crate) mod mesh;
pub(crate) mod muscle;
mod named_entries;
pub(crate) mod named_materials;
pub(crate) mod names;
pub(crate) mod nodes;
pub mod point;
mod prestretch;
pub(crate) mod solid;
pub mod spec;
pub mod spec_joints;
pub mod spec_material;
pub mod spec_solids;
pub(crate) mod trunk;
