//! A scene, what remains of it, and the layout of its unknowns: all from which terms, constraints and measures of a model are made, and names
//! of its coordinates.

use crate::coordinates::CoordinateMap;
use crate::kinematics::{Pose, Vectors};
use crate::math::Vector;
use crate::model::analysis::{Analysis, Coordinates};
use crate::model::constants::free_parameters::Sought;
use crate::model::layout::internal::{Internal, Internals};
use crate::model::layout::solids::Solids;
use crate::model::layout::variables::{Role, Size, Variable, Variables};
use crate::model::model::Model;
use crate::model::presolve::graph::Graph;
use crate::model::presolve::loops::Loops;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::joints::Screw;
use crate::model::system::{JointKind, System};
use crate::model::terms::Terms;

/// Part of a unit vector along an axis of the ground frame from which on it is called by its letter.
const ALIGNED: f64 = 1.0 - 1e-9;

/// A scene with what remains of it, from which the parts of a model are constructed.
#[derive(Debug)]
pub(crate) struct Construction<'a> {
    pub(crate) system: &'a System,
    pub(crate) presolved: &'a Presolved,
    pub(crate) analysis: &'a Analysis,
    pub(crate) coordinates: Coordinates,
    /// Poses of the bodies that remain.
    pub(crate) reference: &'a [Pose],
    pub(crate) blocks: &'a Solids,
    pub(crate) internals: &'a Internals,
    pub(crate) loops: &'a Loops,
    pub(crate) graph: &'a Graph,
    /// Variables of the intervals.
    pub(crate) variables: &'a Variables,
    /// Vector of the span of each muscle.
    pub(crate) spans: &'a [usize],
    /// The free parameters.
    pub(crate) sought: Sought,
}

impl Construction<'_> {
    /// No terms, to which those of parts are added.
    pub(crate) fn no_terms<'v>(&'v self, vectors: &'v mut Vectors) -> Terms<'v> {
        Terms::new(
            self.presolved.carriers(self.reference),
            self.presolved.system.gravity,
            self.analysis.of_motion,
            self.analysis.response,
            self.sought.clone(),
            self.variables,
            vectors,
        )
        .with_nodes(self.blocks.list.iter().map(|block| &block.vectors[..]))
    }

    /// Coordinate `i` of an instant with a map.
    pub(crate) fn coordinate(&self, map: &CoordinateMap, i: usize) -> Variable {
        let internal = i.checked_sub(map.internal().start);
        let internal = internal.map(|index| &self.internals.list[index]);
        if let Some(Internal { name, size, .. }) = internal {
            return Variable::with_role(Role::Coordinate, name.clone(), *size);
        }
        let (name, size) = match i.checked_sub(map.of_bodies) {
            Some(place) => {
                let (node, axis) = map.of_nodes[place];
                let (block, node) = self.blocks.names[node];
                let name = &self.blocks.list[block].solid.name;
                let axis = ["x", "y", "z"][axis];
                (format!("{axis} of node {node} of {name}"), Size::Length)
            }
            None => self.of_body(i),
        };
        Variable::with_role(Role::Coordinate, name, size)
    }

    fn of_body(&self, i: usize) -> (String, Size) {
        match self.coordinates {
            Coordinates::Reduced => {
                let Freedom {
                    of,
                    screw,
                    number,
                    is_only,
                } = freedom(&self.presolved.system, self.graph, i);
                let (name, size) = match screw {
                    Screw::Turn(axis) => (
                        format!("rotation about {}", axis_name(&axis, number)),
                        Size::One,
                    ),
                    Screw::Slide(axis) => (
                        format!("displacement along {}", axis_name(&axis, number)),
                        Size::Length,
                    ),
                };
                match is_only {
                    true => (format!("coordinate of {of}"), size),
                    false => (format!("{name} of {of}"), size),
                }
            }
            Coordinates::Redundant => {
                let part = ["centre", "d1", "d2", "d3"][i % 12 / 3];
                let axis = ["x", "y", "z"][i % 3];
                let name = format!(
                    "{} {part}.{axis}",
                    self.presolved.system.bodies[i / 12].name
                );
                let size = if i % 12 < 3 { Size::Length } else { Size::One };
                (name, size)
            }
        }
    }
}

impl Model {
    /// Returns true if coordinate `i` is a length, rather than an angle or a component of a director.
    pub fn is_length(&self, i: usize) -> bool {
        self.variables.with(Role::Coordinate)[i].size == Size::Length
    }

    /// Joint coordinate `i` of reduced coordinates.
    pub fn freedom(&self, i: usize) -> Freedom<'_> {
        freedom(&self.presolved.system, &self.graph, i)
    }
}

/// A joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Freedom<'m> {
    /// Name of the joint, or of the body that is free.
    pub of: &'m str,
    /// Motion that it permits.
    pub screw: Screw,
    /// Its number in the joint, from 0.
    pub number: usize,
    /// True if it is the only coordinate of its joint.
    pub is_only: bool,
}

/// Joint coordinate `i` of a presolved system.
fn freedom<'m>(system: &'m System, graph: &Graph, i: usize) -> Freedom<'m> {
    let mut at = i;
    for (_, joint) in graph.in_order(system) {
        let (screws, _) = joint.kind.screws();
        if let Some(&screw) = screws.get(at) {
            return Freedom {
                of: &joint.name,
                screw,
                number: at,
                is_only: screws.len() == 1,
            };
        }
        at -= screws.len();
    }
    let (screws, _) = JointKind::Floating.screws();
    Freedom {
        of: &system.bodies[graph.free()[at / screws.len()]].name,
        screw: screws[at % screws.len()],
        number: at % screws.len(),
        is_only: false,
    }
}

/// x, y or z of an axis of the ground frame; others have the number of their screw.
fn axis_name(axis: &Vector, number: usize) -> String {
    match axis.amax() > ALIGNED {
        true => ["x", "y", "z"][axis.iamax()].to_owned(),
        false => format!("axis {}", number + 1),
    }
}
