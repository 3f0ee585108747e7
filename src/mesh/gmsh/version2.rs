//! Nodes and elements of format 2: one list of each, elements carry the number of their physical group.

use super::contents::{Element, Lines, insert};
use crate::mesh::error::MeshError;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// `$Nodes`: a count, then lines of number and place.
pub(super) fn nodes(lines: &mut Lines<'_>) -> Result<BTreeMap<u64, Vector3<f64>>, MeshError> {
    let count = count(lines, "the number of nodes")?;
    let mut nodes = BTreeMap::new();
    for _ in 0..count {
        let shape = "a node: number, x, y, z";
        let line = lines.record(shape)?;
        let mut words = line.words(shape);
        let number = words.number()?;
        let place = words.place()?;
        words.end()?;
        insert(&mut nodes, &line, number, place)?;
    }
    lines.end("$EndNodes")?;
    Ok(nodes)
}

/// `$Elements`: a count, then lines of number, kind, tags (the first one the physical group), nodes.
pub(super) fn elements(lines: &mut Lines<'_>) -> Result<Vec<Element>, MeshError> {
    let count = count(lines, "the number of elements")?;
    let mut elements = Vec::new();
    for _ in 0..count {
        let shape = "an element: number, type, number of tags, tags, nodes";
        let line = lines.record(shape)?;
        let mut words = line.words(shape);
        let number = words.number()?;
        let kind = words.number()?;
        let (dimension, corners) = super::contents::shape(kind, &line)?;
        let tags: usize = words.number()?;
        let mut groups = Vec::new();
        for tag in 0..tags {
            let tag_number: i64 = words.number()?;
            if tag == 0 && tag_number != 0 {
                groups.push(tag_number.unsigned_abs());
            }
        }
        let nodes = (0..corners).map(|_| words.number());
        let nodes = nodes.collect::<Result<_, _>>()?;
        words.end()?;
        elements.push(Element {
            number,
            line: line.number,
            dimension,
            kind,
            nodes,
            groups,
        });
    }
    lines.end("$EndElements")?;
    Ok(elements)
}

fn count(lines: &mut Lines<'_>, shape: &str) -> Result<usize, MeshError> {
    let line = lines.record(shape)?;
    let mut words = line.words(shape);
    let count = words.number()?;
    words.end()?;
    Ok(count)
}
