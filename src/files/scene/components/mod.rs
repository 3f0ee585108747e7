//! Components of a scene with one file for each kind: its type as written, and the conversion to a component, whose rules stand in the model.

mod load;
pub(super) mod spring;
mod tendon;

pub use load::LoadSpec;
pub(crate) use load::{Carriers, load};
pub use spring::SpringSpec;
pub use tendon::TendonSpec;

/// Gives a macro the lists of components between points, `list: Type` for each kind, with the documentation of the key.
macro_rules! component_lists {
    ($macro:ident) => {
        $macro! {
            /// Springs and dampers between two points.
            springs: SpringSpec,
            /// Elastic cables through points.
            tendons: TendonSpec,
        }
    };
}
pub(crate) use component_lists;
