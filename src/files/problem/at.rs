//! A place in a problem, and the parts of the system whose names stand there.

use crate::files::json::objects::read_objects;
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse, ways_inside};
use crate::files::scene::names::names;
use crate::files::units::quantity::{
    Angle, AngularVelocity, Kind, Length, LoadSize, PhysicalQuantity, Quantity, Velocity, Voltage,
};
use crate::model::system::{JointKind, Source, System, voltage_sources};
use crate::model::{Coordinates, PartKind};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::rc::Rc;

/// Expected name of a voltage, for messages.
pub(crate) const A_SOURCE: &str = "the name of a muscle or of a driven electrode (block.electrode)";

/// Keys that give a material an electric term, for messages.
pub(crate) const ELECTRIC_KEYS: &str =
    "a material with \"relative_permittivity\", or \"c1\" and \"c2\"";

/// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
pub type VoltageMap = BTreeMap<String, Quantity<Voltage>>;

/// A place in a problem, with the system of its scene.
#[derive(Clone)]
pub(crate) struct At<'a> {
    scope: Scope<'a>,
    pub(crate) system: &'a System,
    /// All sources of the system.
    pub(crate) sources: Rc<[Source]>,
}

impl<'a> Deref for At<'a> {
    type Target = Scope<'a>;

    fn deref(&self) -> &Scope<'a> {
        &self.scope
    }
}

impl<'a> At<'a> {
    pub(crate) fn new(scope: &Scope<'a>, system: &'a System) -> Self {
        Self {
            scope: scope.clone(),
            system,
            sources: system.sources().into(),
        }
    }

    fn inside(&self, place: JsonPath) -> Self {
        Self {
            scope: Scope {
                place,
                ..self.scope
            },
            sources: Rc::clone(&self.sources),
            ..*self
        }
    }

    fn part(&self, name: &str, kind: PartKind, expected: &str) -> Result<usize> {
        self.find(name, &kind.names(self.system), expected)
    }

    /// The elastic block of a name, of those of the scene.
    pub(crate) fn solid(&self, name: &str) -> Result<usize> {
        let solids = names(&self.system.solids, |solid| &solid.name);
        self.find(name, &solids, "the name of an elastic block")
    }

    /// The source of a name, of any kind.
    pub(crate) fn source(&self, name: &str, expected: &str) -> Result<usize> {
        self.part(name, PartKind::Source, expected)
    }

    /// A marker that may move.
    pub(crate) fn moving_marker(&self, name: &str) -> Result<usize> {
        let index = self.marker(name)?;
        let marker = &self.system.markers[index];
        refuse!(if marker.point.body.is_none() && marker.solid.is_none(), self;
            found format!("{name:?}, which is fixed to the ground"),
            expected "a marker on a body or a block");
        Ok(index)
    }

    /// A source that takes a voltage.
    pub(crate) fn driven(&self, name: &str) -> Result<usize> {
        let sources = voltage_sources(&self.sources);
        let index = self.find(name, &names(sources, |one| &one.name), A_SOURCE)?;
        if sources[index].takes_voltage {
            return Ok(index);
        }
        let found = format!(
            "{name:?}, which takes no voltage: its material has no electric term, or a load gives its charge"
        );
        Err(self.wrong(found, format!("a muscle of {ELECTRIC_KEYS}")))
    }

    /// One voltage per source in V, 0 where not named.
    pub(crate) fn voltages(&self, map: &VoltageMap) -> Result<Vec<f64>> {
        let mut voltages = vec![0.0; self.sources.len()];
        for (name, voltage) in map {
            voltages[self.key(name).driven(name)?] = voltage.value();
        }
        Ok(voltages)
    }

    /// A joint that has one coordinate.
    pub(crate) fn coordinate(&self, name: &str) -> Result<usize> {
        let index = self.joint(name)?;
        refuse!(if !self.system.joints[index].has_coordinate(), self;
            found format!("{name:?}, which is neither revolute nor prismatic, or locked"),
            expected "a joint with one coordinate");
        Ok(index)
    }

    fn is_prismatic(&self, joint: usize) -> bool {
        matches!(self.system.joints[joint].kind, JointKind::Prismatic { .. })
    }

    /// Kind of the coordinate of a joint.
    pub(crate) fn kind_of(&self, joint: usize) -> Kind {
        match self.is_prismatic(joint) {
            true => Length::kind(),
            false => Angle::kind(),
        }
    }

    /// Kind of its rate.
    pub(crate) fn kind_of_rate(&self, joint: usize) -> Kind {
        match self.is_prismatic(joint) {
            true => Velocity::kind(),
            false => AngularVelocity::kind(),
        }
    }

    /// Kind of the input of a source.
    pub(crate) fn kind_of_source(&self, source: usize) -> Kind {
        let (unit, _) = self.sources[source].kind.si();
        let mut kinds = Voltage::kinds().iter().chain(LoadSize::kinds());
        let kind = kinds.find(|kind| kind.symbol() == unit);
        kind.expect("an input has the unit of a voltage or load")
            .clone()
    }

    /// A value of a joint, in the kind that the joint calls for.
    pub(crate) fn of_joint<M: PhysicalQuantity>(
        &self,
        joint: usize,
        written: &Quantity<M>,
    ) -> Result<f64> {
        let kinds = M::kinds();
        self.value_as(written, &kinds[usize::from(self.is_prismatic(joint))])
    }

    /// Values of joints by their names.
    pub(crate) fn by_joint<M: PhysicalQuantity>(
        &self,
        map: &Option<BTreeMap<String, Quantity<M>>>,
    ) -> Result<BTreeMap<usize, f64>> {
        self.each_named(map.iter().flatten(), |name, written, at| {
            let joint = at.coordinate(name)?;
            Ok((joint, at.of_joint(joint, written)?))
        })
    }
}

ways_inside!(At);

/// Declares how parts are found whose names stand at a place.
macro_rules! named_parts {
    ($($name:ident: $kind:ident,)*) => {
        impl At<'_> {
            $(
                #[doc = concat!("The ", stringify!($name), " of a name that stands here.")]
                pub(crate) fn $name(&self, name: &str) -> Result<usize> {
                    self.part(name, PartKind::$kind, concat!("the name of a ", stringify!($name)))
                }
            )*
        }
    };
}

named_parts! {
    body: Body,
    joint: Joint,
    muscle: Muscle,
    marker: Marker,
    spring: Spring,
    tendon: Tendon,
    contact: Contact,
}

read_objects! {
    /// Coordinates in which a problem is solved; reduced ones, unless written.
    pub enum CoordinatesSpec: Coordinates {
        /// Joint coordinates, with multipliers of joints that close loops.
        Reduced,
        /// Directors with multipliers.
        Redundant,
    }
}
