//! Parts of a scene of which each kind has one file: what is written, and how it becomes a component.

mod spring;
mod tendon;

pub use spring::SpringSpec;
pub(crate) use spring::spring;
pub use tendon::TendonSpec;
pub(crate) use tendon::tendon;
