//! Numbers in a page: single precision or indices, little-endian, in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::Vector3;
use serde_json::Value;

/// Numbers in single precision; NaN stays NaN.
pub(super) fn numbers(values: impl IntoIterator<Item = f64>) -> Value {
    let bytes = values
        .into_iter()
        .flat_map(|value| (value as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>()).into()
}

/// Indices below 2³².
pub(super) fn indices(values: impl IntoIterator<Item = usize>) -> Value {
    let bytes = values
        .into_iter()
        .flat_map(|value| (value as u32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>()).into()
}

/// Coordinates of places in mm, one after the other.
pub(super) fn places<'a>(places: impl IntoIterator<Item = &'a Vector3<f64>>) -> Value {
    numbers(
        places
            .into_iter()
            .flat_map(|place| [place.x, place.y, place.z]),
    )
}
