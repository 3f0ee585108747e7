//! Contents of a file, by the numbers in it.
//!
//! The lines of a file with their numbers, and the words of a line.

use crate::math::refuse;
use crate::mesh::error::{MeshError, MeshPlace};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::iter::Enumerate;
use std::str::{FromStr, SplitWhitespace};

/// Name of the region of elements that belong to no physical volume.
pub const UNGROUPED: &str = "ungrouped";

/// Layout of nodes and elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// 2.0 to 2.2: elements carry their groups.
    Two,
    /// 4.1: blocks of elements belong to entities, which carry groups.
    Four,
}

/// Number of a physical group by the dimension of its elements; zero is no group.
pub(super) type Group = (usize, u64);

/// An element of a kind that is of use.
pub(super) struct Element {
    pub(super) number: u64,
    /// Number of its line in the file.
    pub(super) line: usize,
    /// 0 point, 1 line, 2 face, 3 volume.
    pub(super) dimension: usize,
    /// Its type.
    pub(super) kind: usize,
    /// Numbers of its nodes in the file.
    pub(super) nodes: Vec<u64>,
    /// Numbers of the physical groups it belongs to.
    pub(super) groups: Vec<u64>,
}

/// A file as read, by the numbers in it.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) names: BTreeMap<Group, String>,
    pub(super) nodes: BTreeMap<u64, Vector3<f64>>,
    pub(super) elements: Vec<Element>,
    /// Line of `$Elements`.
    pub(super) line: usize,
}

/// Puts a node in, unless there is one of its number.
pub(super) fn insert(
    nodes: &mut BTreeMap<u64, Vector3<f64>>,
    line: &Line<'_>,
    number: u64,
    place: Vector3<f64>,
) -> Result<(), MeshError> {
    refuse!(if nodes.insert(number, place).is_some(), line;
        found format!("a second node {number}"), expected "a number of its own for each node");
    Ok(())
}

/// Remaining lines of a file; empty lines do not count.
pub(super) struct Lines<'a> {
    file: &'a str,
    left: Enumerate<std::str::Lines<'a>>,
    /// Number of the line that was read last.
    number: usize,
}

/// A line without the spaces around it.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    file: &'a str,
    pub(super) number: usize,
    pub(super) text: &'a str,
}

/// The words of a line.
pub(super) struct Words<'a> {
    line: Line<'a>,
    left: SplitWhitespace<'a>,
    /// Expected form of the line.
    shape: &'a str,
}

impl<'a> Lines<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            left: text.lines().enumerate(),
            number: 0,
        }
    }

    /// The next line, or nothing at the end of the file.
    pub(super) fn next_or_end(&mut self) -> Option<Line<'a>> {
        for (index, text) in self.left.by_ref() {
            self.number = index + 1;
            let text = text.trim();
            if !text.is_empty() {
                return Some(Line {
                    file: self.file,
                    number: self.number,
                    text,
                });
            }
        }
        None
    }

    /// The next line, where one is expected.
    pub(super) fn next(&mut self, expected: &str) -> Result<Line<'a>, MeshError> {
        self.next_or_end().ok_or_else(|| self.at_end(expected))
    }

    /// The next line, which continues a section: a count that is too large is found at the section's end.
    pub(super) fn record(&mut self, expected: &str) -> Result<Line<'a>, MeshError> {
        let line = self.next(expected)?;
        refuse!(if line.text.starts_with('$'), line;
            found format!("{} before as many lines as were counted", quoted(line.text)),
            expected expected);
        Ok(line)
    }

    /// The line that ends a section.
    pub(super) fn end(&mut self, name: &str) -> Result<(), MeshError> {
        let line = self.next(name)?;
        refuse!(if line.text != name, line;
            found format!("{} after as many lines as were counted", quoted(line.text)),
            expected name);
        Ok(())
    }

    /// Leaves out a section up to the line that ends it.
    pub(super) fn skip(&mut self, end: &str) -> Result<(), MeshError> {
        while self.next(end)?.text != end {}
        Ok(())
    }

    /// The end of the file where something is expected.
    pub(super) fn at_end(&self, expected: &str) -> MeshError {
        let line = Line {
            file: self.file,
            number: self.number.max(1),
            text: "",
        };
        line.wrong("the end of the file", expected)
    }
}

impl<'a> Line<'a> {
    /// This line is not as expected.
    pub(super) fn wrong(&self, found: impl Into<String>, expected: impl Into<String>) -> MeshError {
        MeshPlace::Line(self.file.to_owned(), self.number).wrong(found, expected)
    }

    /// The words of a line that is expected to say what `shape` describes.
    pub(super) fn words(&self, shape: &'a str) -> Words<'a> {
        Words {
            line: *self,
            left: self.text.split_whitespace(),
            shape,
        }
    }
}

impl<'a> Words<'a> {
    /// The next word.
    pub(super) fn word(&mut self) -> Result<&'a str, MeshError> {
        let word = self.left.next();
        word.ok_or_else(|| self.line.wrong(quoted(self.line.text), self.shape))
    }

    /// The next word as a number.
    pub(super) fn number<T: FromStr>(&mut self) -> Result<T, MeshError> {
        let word = self.word()?;
        word.parse().map_err(|_| {
            let found = format!("{} in {}", quoted(word), quoted(self.line.text));
            self.line.wrong(found, self.shape)
        })
    }

    /// The next three words as a place.
    pub(super) fn place(&mut self) -> Result<Vector3<f64>, MeshError> {
        let place = Vector3::new(self.number()?, self.number()?, self.number()?);
        let is_finite = place.iter().all(|x: &f64| x.is_finite());
        refuse!(if !is_finite, self.line;
            found quoted(self.line.text), expected "finite coordinates");
        Ok(place)
    }

    /// Nothing is left.
    pub(super) fn end(&mut self) -> Result<(), MeshError> {
        refuse!(if self.left.next().is_some(), self.line;
            found quoted(self.line.text), expected self.shape);
        Ok(())
    }
}

/// Text of a file in a message, cut where it is long.
pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{:?} …", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// Types of volumes that are of use.
pub(super) const HEXAHEDRON: usize = 5;
pub(super) const LINEAR_TETRAHEDRON: usize = 4;
pub(super) const TETRAHEDRON: usize = 11;
/// Words for them in messages.
pub(super) const VOLUMES: &str =
    "8-node hexahedra (type 5), or tetrahedra of 4 or 10 nodes (types 4 and 11)";
/// Types of surfaces, which are membranes where there is no volume.
pub(super) const LINEAR_TRIANGLE: usize = 2;
pub(super) const QUADRANGLE: usize = 3;
pub(super) const TRIANGLE: usize = 9;
pub(super) const QUADRATIC_QUADRANGLE: usize = 10;

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
        8 => Ok((1, 3)),
        LINEAR_TRIANGLE => Ok((2, 3)),
        TRIANGLE => Ok((2, 6)),
        QUADRANGLE => Ok((2, 4)),
        QUADRATIC_QUADRANGLE => Ok((2, 9)),
        LINEAR_TETRAHEDRON => Ok((3, 4)),
        TETRAHEDRON => Ok((3, 10)),
        HEXAHEDRON => Ok((3, 8)),
        _ => {
            let expected = format!(
                "{VOLUMES}, bounded by quadrangles (types 3 and 10), triangles (types 2 and 9), lines (types 1 and 8) and points \
                 (type 15): mesh with transfinite or extruded, recombined volumes of first order, or with tetrahedra"
            );
            Err(line.wrong(named(kind), expected))
        }
    }
}

/// An element of a type, for messages.
pub(super) fn named(kind: usize) -> String {
    match kind.checked_sub(1).and_then(|index| KINDS.get(index)) {
        Some(name) => format!("a {name} (type {kind})"),
        None => format!("an element of type {kind}"),
    }
}
