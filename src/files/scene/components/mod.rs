//! Components of a scene with one file for each kind: its type as written, and the conversion to a component.

mod load;
mod spring;
mod tendon;

pub use load::LoadSpec;
pub(crate) use load::load;
pub use spring::SpringSpec;
pub(crate) use spring::spring;
pub use tendon::TendonSpec;
pub(crate) use tendon::tendon;
