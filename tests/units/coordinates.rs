//! Products of the pull-back, which need pairs of vectors alone.

#[path = "../../src/coordinates/pull_back/product.rs"]
pub(crate) mod product;

pub(crate) mod pull_back {
    pub(crate) use super::product;
}

pub(crate) mod tree {
    pub(crate) use proboscis::coordinates::LANES;
}
