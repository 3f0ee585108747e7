//! Scene and problem files, as written and as mistaken.

mod amounts;
mod arbitrary;
mod body_mesh_mistakes;
mod body_meshes;
mod extremes;
mod free;
mod fuzz_reader;
mod headers;
mod meaning;
mod measured_costs;
mod motions;
mod named_materials;
mod npz;
mod objectives;
mod quantities;
mod reference;
mod rules;
mod scene;
mod schema_walk;
mod sensitivity;
mod slips;
mod solids;
mod tasks;
mod urdf;
