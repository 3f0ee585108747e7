//! The tree of links: their poses in the reference configuration, and the bodies that carry them.

use nalgebra::Isometry3;
use std::collections::BTreeMap;

use crate::files::json::scope::{Result, refuse};
use crate::files::urdf::read::{Kind, Robot};

/// Links by their places in the file.
pub(super) struct Tree {
    /// Links from the root outwards.
    pub(super) order: Vec<usize>,
    /// Joint to the parent; `None` for the root.
    pub(super) joint: Vec<Option<usize>>,
    /// Parent of each link; `None` for the root.
    pub(super) parent: Vec<Option<usize>>,
    /// Frame of each link in the ground frame, which is that of the root.
    pub(super) pose: Vec<Isometry3<f64>>,
    /// Link whose body carries each link: itself, or the one to which a link without a mass is fixed; `None` is the ground.
    pub(super) carrier: Vec<Option<usize>>,
}

/// The tree of a robot.
pub(super) fn tree(robot: &Robot<'_>) -> Result<Tree> {
    let count = robot.links.len();
    let mut index = BTreeMap::new();
    for (i, link) in robot.links.iter().enumerate() {
        refuse!(if index.insert(link.name.as_str(), i).is_some(), link.element;
            found "its name a second time", expected "a name of its own");
    }
    let (mut joint, mut parent) = (vec![None; count], vec![None; count]);
    let mut children = vec![Vec::new(); count];
    for (j, written) in robot.joints.iter().enumerate() {
        let find = |name: &str| {
            let (element, found) = (&written.element, format!("{name:?}"));
            let index = index.get(name).copied();
            index.ok_or_else(|| element.wrong(found, "the name of a link"))
        };
        let (from, to) = (find(&written.parent)?, find(&written.child)?);
        refuse!(if joint[to].replace(j).is_some(), written.element;
            found format!("a second joint with the child {:?}", written.child),
            expected "one joint to each child");
        parent[to] = Some(from);
        children[from].push(to);
    }
    let mut roots = (0..count).filter(|&link| joint[link].is_none());
    let root = match (roots.next(), roots.next()) {
        (Some(root), None) => root,
        (first, second) => {
            let element = &robot.links.first().map(|link| &link.element);
            let named = [first, second].map(|link| link.map(|link| &robot.links[link]));
            let (place, found) = match (named, element) {
                ([Some(_), Some(second)], _) => (&second.element, "a second link without a parent"),
                (_, Some(element)) => (*element, "no link without a parent: joints form a loop"),
                (_, None) => {
                    return Err(robot.element.wrong("no <link>", "links"));
                }
            };
            return Err(place.wrong(found, "one link, the root, that is no child of a joint"));
        }
    };
    let mut tree = Tree {
        order: vec![root],
        joint,
        parent,
        pose: vec![Isometry3::identity(); count],
        carrier: vec![None; count],
    };
    let mut next = 0;
    while let Some(&link) = tree.order.get(next) {
        tree.place(link, robot)?;
        tree.order.extend(&children[link]);
        next += 1;
    }
    let apart = (0..count).find(|link| !tree.order.contains(link));
    refuse!(if let Some(link) = apart, robot.links[link].element;
        found "a link in a loop of joints, which the root is no part of",
        expected "a tree of links");
    Ok(tree)
}

impl Tree {
    /// Pose and carrier of a link whose parent is placed.
    fn place(&mut self, link: usize, robot: &Robot<'_>) -> Result<()> {
        let has_mass = robot.links[link].inertial.is_some();
        let (Some(parent), Some(joint)) = (self.parent[link], self.joint[link]) else {
            self.carrier[link] = has_mass.then_some(link);
            return Ok(());
        };
        let joint = &robot.joints[joint];
        self.pose[link] = self.pose[parent] * joint.pose;
        self.carrier[link] = match (has_mass, joint.kind) {
            (true, _) => Some(link),
            (false, Kind::Fixed) => self.carrier[parent],
            (false, _) => {
                let found = format!("no mass, though the joint {:?} moves it", joint.name);
                let expected = "<inertial> with a mass";
                return Err(robot.links[link].element.wrong(found, expected));
            }
        };
        Ok(())
    }
}
