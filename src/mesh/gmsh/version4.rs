//! Entities, nodes and elements of format 4.1: blocks belong to entities, which carry the numbers of physical groups.

use super::contents::{Element, Line, Lines, insert};
use crate::math::refuse;
use crate::mesh::error::MeshError;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Numbers of the physical groups of each entity, by dimension and number.
pub(super) type Entities = BTreeMap<(usize, i64), Vec<u64>>;

const HEAD: &str = "four counts: blocks, all of them, smallest and largest number";

/// `$Entities`: counts per dimension, then lines of number, bounding box (a place for points), count and numbers of
/// physical groups, and the bounding entities.
pub(super) fn entities(lines: &mut Lines<'_>) -> Result<Entities, MeshError> {
    let shape = "the numbers of points, curves, surfaces and volumes";
    let line = lines.record(shape)?;
    let mut words = line.words(shape);
    let mut counts = [0_usize; 4];
    for count in &mut counts {
        *count = words.number()?;
    }
    words.end()?;
    let mut entities = Entities::new();
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let shape = "an entity: number, bounding box, number of physical groups, their numbers, bounding entities";
            let line = lines.record(shape)?;
            let mut words = line.words(shape);
            let number = words.number()?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                words.word()?;
            }
            let mut groups = Vec::new();
            for _ in 0..words.number::<usize>()? {
                groups.push(words.number::<i64>()?.unsigned_abs());
            }
            entities.insert((dimension, number), groups);
        }
    }
    lines.end("$EndEntities")?;
    Ok(entities)
}

/// `$Nodes`: blocks of the numbers of nodes, then their places (and parameters on the entity).
pub(super) fn nodes(lines: &mut Lines<'_>) -> Result<BTreeMap<u64, Vector3<f64>>, MeshError> {
    let (head, blocks, total) = head(lines)?;
    let mut nodes = BTreeMap::new();
    for _ in 0..blocks {
        let shape = "a block of nodes: dimension and number of the entity, 0 or 1 for parameters, number of nodes";
        let line = lines.record(shape)?;
        let mut words = line.words(shape);
        words.number::<usize>()?;
        words.number::<i64>()?;
        let parametric: u8 = words.number()?;
        let count: usize = words.number()?;
        words.end()?;
        let mut numbers = Vec::new();
        for _ in 0..count {
            let shape = "the number of a node";
            let line = lines.record(shape)?;
            let mut words = line.words(shape);
            numbers.push(words.number()?);
            words.end()?;
        }
        for number in numbers {
            let shape = "the place of a node: x, y, z";
            let line = lines.record(shape)?;
            let mut words = line.words(shape);
            let place = words.place()?;
            if parametric == 0 {
                words.end()?;
            }
            insert(&mut nodes, &line, number, place)?;
        }
    }
    lines.end("$EndNodes")?;
    agree(&head, nodes.len(), total)?;
    Ok(nodes)
}

/// `$Elements`: blocks of elements of one kind and entity.
pub(super) fn elements(
    lines: &mut Lines<'_>,
    entities: Option<&Entities>,
) -> Result<Vec<Element>, MeshError> {
    let (head, blocks, total) = head(lines)?;
    let mut elements = Vec::new();
    for _ in 0..blocks {
        let shape =
            "a block of elements: dimension and number of the entity, type, number of elements";
        let line = lines.record(shape)?;
        let mut words = line.words(shape);
        let entity: (usize, i64) = (words.number()?, words.number()?);
        let kind = words.number()?;
        let (dimension, corners) = super::contents::shape(kind, &line)?;
        let count: usize = words.number()?;
        words.end()?;
        refuse!(if entity.0 != dimension, line;
            found format!("elements of dimension {dimension} in an entity of dimension {}", entity.0),
            expected "equal dimensions");
        let groups = match entities {
            None => &[][..],
            Some(entities) => entities.get(&entity).ok_or_else(|| {
                let found = format!("the entity {} of dimension {dimension}", entity.1);
                line.wrong(found, "an entity that $Entities lists")
            })?,
        };
        for _ in 0..count {
            let shape = "an element: number, nodes";
            let line = lines.record(shape)?;
            let mut words = line.words(shape);
            let number = words.number()?;
            let nodes = (0..corners).map(|_| words.number());
            let nodes = nodes.collect::<Result<_, _>>()?;
            words.end()?;
            elements.push(Element {
                number,
                line: line.number,
                dimension,
                kind,
                nodes,
                groups: groups.to_vec(),
            });
        }
    }
    lines.end("$EndElements")?;
    agree(&head, elements.len(), total)?;
    Ok(elements)
}

/// The first line of nodes or elements: number of blocks and of all in them.
fn head<'a>(lines: &mut Lines<'a>) -> Result<(Line<'a>, usize, usize), MeshError> {
    let line = lines.record(HEAD)?;
    let mut words = line.words(HEAD);
    let (blocks, total) = (words.number()?, words.number()?);
    for _ in 0..2 {
        words.number::<u64>()?;
    }
    words.end()?;
    Ok((line, blocks, total))
}

fn agree(head: &Line<'_>, found: usize, total: usize) -> Result<(), MeshError> {
    refuse!(if found != total, head;
        found format!("a total of {total}"),
        expected format!("{found}, as many as the blocks hold"));
    Ok(())
}
