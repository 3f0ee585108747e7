//! Binary files as the text that Gmsh writes of the same mesh, up to the elements.
//!
//! Counts and numbers are integers of 4 bytes in format 2.2; in 4.1 counts, nodes and elements have 8 bytes, entities, kinds and groups 4. Places
//! are doubles. An integer of one in the head tells the order of bytes.

use super::contents::{Format, Lines, shape};
use crate::math::refuse;
use crate::mesh::error::{MeshError, MeshPlace};
use std::fmt::{Display, Write};

/// A binary file that is read.
struct Binary<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// Place of the next byte.
    at: usize,
    /// True if the first byte of a number is its highest one.
    is_big_endian: bool,
    /// The section.
    section: String,
    text: String,
}

/// The text of a binary file; errors call it `file`.
///
/// # Errors
/// It ends within a section, or has elements of a kind that is of no use.
pub(super) fn as_text(bytes: &[u8], file: &str, format: Format) -> Result<String, MeshError> {
    let mut binary = Binary {
        file,
        bytes,
        at: 0,
        is_big_endian: false,
        section: String::new(),
        text: String::new(),
    };
    binary.head()?;
    while let Some(line) = binary.line() {
        let name = line.strip_prefix('$').unwrap_or_default().to_owned();
        if name.is_empty() {
            continue;
        }
        binary.section.clone_from(&name);
        let _ = writeln!(binary.text, "{line}");
        match (name.as_str(), format) {
            ("Nodes", Format::Two) => binary.nodes_of_two()?,
            ("Elements", Format::Two) => binary.elements_of_two()?,
            ("Entities", Format::Four) => binary.entities()?,
            ("Nodes", Format::Four) => binary.nodes()?,
            ("Elements", Format::Four) => binary.elements()?,
            _ => {}
        }
        let end = format!("$End{name}");
        binary.copy(&end)?;
        let _ = writeln!(binary.text, "{end}");
        // What follows are fields and the like.
        if name == "Elements" {
            break;
        }
    }
    Ok(binary.text)
}

impl Binary<'_> {
    /// The next line, without its end; nothing at the end of the file.
    fn line(&mut self) -> Option<String> {
        let left = self.bytes.get(self.at..).filter(|left| !left.is_empty())?;
        let end = left.iter().position(|&byte| byte == b'\n');
        let end = end.unwrap_or(left.len());
        self.at += end + 1;
        Some(String::from_utf8_lossy(&left[..end]).trim().to_owned())
    }

    /// Copies the lines up to the end of a section, which is passed.
    fn copy(&mut self, end: &str) -> Result<(), MeshError> {
        loop {
            match self.line() {
                Some(line) if line == end => return Ok(()),
                Some(line) if !line.is_empty() => {
                    let _ = writeln!(self.text, "{line}");
                }
                Some(_) => {}
                None => return Err(self.ended()),
            }
        }
    }

    fn ended(&self) -> MeshError {
        let place = MeshPlace::Line(self.file.to_owned(), self.text.lines().count().max(1));
        let found = format!("the end of the binary file in ${}", self.section);
        place.wrong(found, "as much as was counted")
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let taken = self.bytes.get(self.at..self.at + N);
        let mut taken: [u8; N] = match taken.and_then(|taken| taken.try_into().ok()) {
            Some(taken) => taken,
            None => return Err(self.ended()),
        };
        self.at += N;
        if self.is_big_endian {
            taken.reverse();
        }
        Ok(taken)
    }

    fn int(&mut self) -> Result<i32, MeshError> {
        self.take().map(i32::from_le_bytes)
    }

    fn long(&mut self) -> Result<u64, MeshError> {
        self.take().map(u64::from_le_bytes)
    }

    fn double(&mut self) -> Result<f64, MeshError> {
        self.take().map(f64::from_le_bytes)
    }

    fn word(&mut self, word: impl Display) {
        let _ = write!(self.text, "{word} ");
    }

    fn end(&mut self) {
        self.text.push('\n');
    }

    /// Writes so many integers, and returns the last one.
    fn ints(&mut self, count: usize) -> Result<i32, MeshError> {
        let mut last = 0;
        for _ in 0..count {
            last = self.int()?;
            self.word(last);
        }
        Ok(last)
    }

    /// Writes so many long ones, and returns the first one.
    fn longs(&mut self, count: usize) -> Result<u64, MeshError> {
        let mut first = None;
        for _ in 0..count {
            let long = self.long()?;
            first.get_or_insert(long);
            self.word(long);
        }
        Ok(first.unwrap_or(0))
    }

    fn doubles(&mut self, count: usize) -> Result<(), MeshError> {
        for _ in 0..count {
            let double = self.double()?;
            self.word(format_args!("{double:?}"));
        }
        Ok(())
    }

    /// `$MeshFormat` with the order of bytes.
    fn head(&mut self) -> Result<(), MeshError> {
        "MeshFormat".clone_into(&mut self.section);
        let lines = [self.line(), self.line()];
        let [Some(first), Some(version)] = lines else {
            return Err(self.ended());
        };
        let version = version
            .split_whitespace()
            .next()
            .unwrap_or_default()
            .to_owned();
        let one = self.int()?;
        self.is_big_endian = one == 1_i32.swap_bytes();
        let place = MeshPlace::Line(self.file.to_owned(), 3);
        refuse!(unless one == 1 || self.is_big_endian, place;
            found one, expected "the integer 1, which tells the order of bytes");
        self.line();
        let _ = writeln!(self.text, "{first}\n{version} 0 8");
        let end = "$EndMeshFormat";
        self.copy(end)?;
        let _ = writeln!(self.text, "{end}");
        Ok(())
    }

    /// A line with a count.
    fn count(&mut self) -> Result<usize, MeshError> {
        let line = self.line().unwrap_or_default();
        let _ = writeln!(self.text, "{line}");
        Ok(line.parse().unwrap_or(0))
    }

    fn nodes_of_two(&mut self) -> Result<(), MeshError> {
        for _ in 0..self.count()? {
            self.ints(1)?;
            self.doubles(3)?;
            self.end();
        }
        Ok(())
    }

    fn elements_of_two(&mut self) -> Result<(), MeshError> {
        let mut left = self.count()?;
        while left > 0 {
            let [kind, count, tags] = [self.int()?, self.int()?, self.int()?].map(|n| n as usize);
            let corners = self.corners(kind)?;
            for _ in 0..count.clamp(1, left) {
                let number = self.int()?;
                self.word(format_args!("{number} {kind} {tags}"));
                self.ints(tags.min(self.bytes.len()) + corners)?;
                self.end();
            }
            left -= count.clamp(1, left);
        }
        Ok(())
    }

    /// Number of the nodes of an element of a kind.
    fn corners(&self, kind: usize) -> Result<usize, MeshError> {
        let line = Lines::new(self.file, &self.section).next("a section")?;
        shape(kind, &line).map(|(_, corners)| corners)
    }

    fn entities(&mut self) -> Result<(), MeshError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.longs(1)?;
        }
        self.end();
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                self.ints(1)?;
                self.doubles(if dimension == 0 { 3 } else { 6 })?;
                for _ in 0..if dimension == 0 { 1 } else { 2 } {
                    let numbers = self.longs(1)?;
                    self.ints(numbers as usize)?;
                }
                self.end();
            }
        }
        Ok(())
    }

    fn nodes(&mut self) -> Result<(), MeshError> {
        let blocks = self.longs(4)?;
        self.end();
        for _ in 0..blocks {
            let (dimension, tag, parametric) = (self.int()?, self.int()?, self.int()?);
            self.word(format_args!("{dimension} {tag} {parametric}"));
            let count = self.longs(1)?;
            self.end();
            for _ in 0..count {
                self.longs(1)?;
                self.end();
            }
            let parameters = if parametric == 0 {
                0
            } else {
                dimension.clamp(0, 3) as usize
            };
            for _ in 0..count {
                self.doubles(3 + parameters)?;
                self.end();
            }
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), MeshError> {
        let blocks = self.longs(4)?;
        self.end();
        for _ in 0..blocks {
            let kind = self.ints(3)?;
            let count = self.longs(1)?;
            self.end();
            let corners = self.corners(kind as usize)?;
            for _ in 0..count {
                self.longs(1 + corners)?;
                self.end();
            }
        }
        Ok(())
    }
}
