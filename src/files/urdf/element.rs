//! Elements of a URDF file: their attributes as numbers and vectors, mistakes with their lines, and parts that are left out.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use crate::files::json::error::{Mistake, Result, SceneError};

/// Parts of a file that are left out, by their kinds, each with its owners.
#[derive(Debug, Default)]
pub(super) struct LeftOut(BTreeMap<String, Vec<String>>);

impl LeftOut {
    /// Adds a part of an owner.
    pub(super) fn add(&mut self, kind: impl Into<String>, owner: impl fmt::Display) {
        let owners = self.0.entry(kind.into()).or_default();
        let owner = owner.to_string();
        if !owners.contains(&owner) {
            owners.push(owner);
        }
    }

    /// A sentence for each kind.
    pub(super) fn notes(&self) -> impl Iterator<Item = String> + '_ {
        let note = |(kind, owners): (&String, &Vec<String>)| {
            format!("left out: {kind} of {}", owners.join(", "))
        };
        self.0.iter().map(note)
    }
}

/// Numbers of a size that no robot has.
const HUGE: f64 = 1e12;

/// An element, and its owner for messages, such as `the link "arm"`.
#[derive(Clone)]
pub(super) struct Element<'a> {
    pub(super) node: Node<'a, 'a>,
    pub(super) owner: String,
    pub(super) path: &'a Path,
}

impl<'a> Element<'a> {
    /// The error of this element.
    pub(super) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        let line = self
            .node
            .document()
            .text_pos_at(self.node.range().start)
            .row;
        let place = format!("{}:{line}: {}", self.path.display(), self.owner);
        Mistake::of_file(place, found, expected).into()
    }

    /// An element within it, of the same owner.
    fn within(&self, node: Node<'a, 'a>) -> Self {
        Self {
            node,
            ..self.clone()
        }
    }

    /// All elements of a name within it.
    pub(super) fn children(&self, name: &'static str) -> impl Iterator<Item = Self> + '_ {
        let nodes = self.node.children();
        let nodes = nodes.filter(move |node| node.is_element() && node.has_tag_name(name));
        nodes.map(|node| self.within(node))
    }

    /// The element of a name within it, where there is one.
    pub(super) fn child(&self, name: &'static str) -> Result<Option<Self>> {
        let mut all = self.children(name);
        match (all.next(), all.next()) {
            (first, None) => Ok(first),
            (_, Some(second)) => Err(second.wrong(format!("a second <{name}>"), "it once")),
        }
    }

    /// The element of a name within it.
    pub(super) fn needed(&self, name: &'static str) -> Result<Self> {
        let missing = || self.wrong(format!("no <{name}>"), format!("<{name}>"));
        self.child(name)?.ok_or_else(missing)
    }

    /// An attribute.
    pub(super) fn word(&self, name: &str) -> Result<&'a str> {
        let tag = self.node.tag_name().name();
        let missing = || self.wrong(format!("<{tag}> without {name:?}"), format!("{name:?}"));
        self.node.attribute(name).ok_or_else(missing)
    }

    /// An attribute of several numbers.
    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        let text = self.word(name)?;
        let mut numbers = [0.0; N];
        let mut words = text.split_whitespace();
        for number in &mut numbers {
            let parsed = words.next().and_then(|word| word.parse::<f64>().ok());
            let finite = parsed.filter(|value| value.abs() < HUGE);
            *number = finite.ok_or_else(|| self.no_numbers(name, text, N))?;
        }
        match words.next() {
            None => Ok(numbers),
            Some(_) => Err(self.no_numbers(name, text, N)),
        }
    }

    fn no_numbers(&self, name: &str, text: &str, count: usize) -> SceneError {
        let expected = match count {
            1 => "a number".to_owned(),
            count => format!("{count} numbers"),
        };
        self.wrong(format!("{name}={text:?}"), expected)
    }

    /// A number.
    pub(super) fn number(&self, name: &str) -> Result<f64> {
        self.numbers::<1>(name).map(|[number]| number)
    }

    /// A number, or what stands for it where the attribute is absent.
    pub(super) fn number_or(&self, name: &str, absent: f64) -> Result<f64> {
        match self.node.has_attribute(name) {
            true => self.number(name),
            false => Ok(absent),
        }
    }

    /// A positive length.
    pub(super) fn length(&self, name: &str) -> Result<f64> {
        match self.number(name)? {
            length if length > 0.0 => Ok(length),
            length => Err(self.wrong(format!("{name}={length}"), "a positive length")),
        }
    }

    /// The pose of its `<origin>`: a rotation by roll, pitch and yaw about the fixed axes x, y and z, then a displacement in m.
    pub(super) fn origin(&self, left_out: &mut LeftOut) -> Result<Isometry3<f64>> {
        let Some(origin) = self.child("origin")? else {
            return Ok(Isometry3::identity());
        };
        origin.only(&[], &["xyz", "rpy"], left_out);
        let vector = |name: &str| match origin.node.has_attribute(name) {
            true => origin.numbers::<3>(name),
            false => Ok([0.0; 3]),
        };
        let [roll, pitch, yaw] = vector("rpy")?;
        Ok(Isometry3::from_parts(
            Translation3::from(Vector3::from(vector("xyz")?)),
            UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        ))
    }

    /// Names elements and attributes other than these as left out.
    pub(super) fn only(&self, children: &[&str], attributes: &[&str], left_out: &mut LeftOut) {
        let tag = self.node.tag_name().name();
        for node in self.node.children().filter(Node::is_element) {
            let name = node.tag_name().name();
            if !children.contains(&name) {
                left_out.add(format!("<{name}>"), &self.owner);
            }
        }
        for attribute in self.node.attributes() {
            let name = attribute.name();
            if !attributes.contains(&name) {
                left_out.add(format!("{name:?} of <{tag}>"), &self.owner);
            }
        }
    }
}
