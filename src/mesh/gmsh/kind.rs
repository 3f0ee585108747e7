//! Kinds of elements by their number in the format.

use super::lines::Line;
use crate::mesh::error::MeshError;

const KINDS: [&str; 19] = [
    "2-node line",
    "3-node triangle",
    "4-node quadrangle",
    "4-node tetrahedron",
    "8-node hexahedron",
    "6-node prism",
    "5-node pyramid",
    "3-node line of second order",
    "6-node triangle of second order",
    "9-node quadrangle of second order",
    "10-node tetrahedron of second order",
    "27-node hexahedron of second order",
    "18-node prism of second order",
    "14-node pyramid of second order",
    "1-node point",
    "8-node quadrangle of second order",
    "20-node hexahedron of second order",
    "15-node prism of second order",
    "13-node pyramid of second order",
];

/// Dimension and number of nodes of a kind that is of use.
pub(super) fn shape(kind: usize, line: &Line<'_>) -> Result<(usize, usize), MeshError> {
    match kind {
        15 => Ok((0, 1)),
        1 => Ok((1, 2)),
        3 => Ok((2, 4)),
        5 => Ok((3, 8)),
        _ => {
            let name = kind.checked_sub(1).and_then(|index| KINDS.get(index));
            let found = match name {
                Some(name) => format!("a {name} (type {kind})"),
                None => format!("an element of type {kind}"),
            };
            let expected = "8-node hexahedra (type 5) bounded by 4-node quadrangles (type 3), 2-node lines (type 1) and \
                 points (type 15): mesh with transfinite or extruded, recombined volumes of first order";
            Err(line.error(found, expected))
        }
    }
}
