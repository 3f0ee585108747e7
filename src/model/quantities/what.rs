//! Measured variables: their parts, times, units and names.

use crate::functional::Stencil;
use crate::math::Vector;
use crate::model::system::{Amount, Fidelity, JointKind, Muscle, System};
use std::sync::Arc;

/// Measured variable.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// Coordinate of a revolute joint (rad, in the branch nearest to `near`) or prismatic joint (mm).
    Joint {
        /// Joint index.
        joint: usize,
        /// Branch of an angle.
        near: f64,
    },
    /// Stretch Λ of a muscle; its square in rows.
    Stretch(usize),
    /// Mean force in N in an interval with which a part pulls its ends together.
    Tension(Pulling),
    /// True field e in V/mm under the voltages of an interval; its square in rows.
    Field(FieldPlace),
    /// The same of a muscle behind a resistor, which follows from its charge.
    ChargedField(usize),
    /// Current in A of a source: of a muscle or electrodes behind a resistor, of another lumped muscle by the steps of its charge.
    Current(usize),
    /// Power in W of the source of a lumped muscle: behind a resistor, of another one by the steps of its energy.
    Power(usize),
    /// Charge in mC of a muscle or of electrodes behind the resistor of a source.
    Charge(usize),
    /// Mean charge `½ (C_k + C_{k+1}) V` in mC of a lumped muscle under the voltage of its source.
    MeanCharge(usize),
    /// Stored energy `½ C V²` in mJ of a lumped muscle under the voltage of its source.
    Energy(usize),
    /// Capacitance of a lumped muscle in mC/V.
    Capacitance(usize),
    /// Voltage in V of the electrodes behind the resistor of a source.
    ElectrodeVoltage(usize),
    /// Voltage of a source in V.
    Voltage(usize),
    /// Component of the force in N from the parent of a joint on its child, or of the torque in N mm about the point of the joint, by its impulse
    /// in the intervals beside an instant.
    Reaction {
        /// Joint index.
        joint: usize,
        /// Force or torque.
        of: Reaction,
        /// Unit vector of the ground frame.
        along: Vector,
    },
    /// A component of the place of a marker in mm.
    Place {
        /// Marker index.
        marker: usize,
        /// Component 0, 1 or 2.
        axis: usize,
    },
    /// Size in mm/ms of the mean velocity of a marker in an interval; its square in rows.
    Speed(usize),
    /// Relative place of a marker: (|x − c|/r)² for a ball, Σ ((x − c)_i/a_i)¹⁶ for a box.
    Region {
        /// Marker index.
        marker: usize,
        /// The region.
        region: Region,
    },
    /// Distance in mm of a marker from a plane, on the side of its normal.
    Clearance {
        /// Marker index.
        marker: usize,
        /// The plane.
        plane: Plane,
    },
    /// Gap in mm of a contact, negative where both sides overlap.
    Gap(usize),
    /// Normal force in N of a contact in the middle of an interval.
    ContactForce(usize),
    /// a·b of a direction a fixed to a body and a direction b.
    Direction {
        /// Body index.
        body: usize,
        /// a in the reference configuration, a unit vector of the ground frame.
        axis: Vector,
        /// b, a unit vector of the ground frame.
        along: Vector,
    },
    /// A free parameter that bounds voltages, by its index, in kV.
    PeakVoltage(usize),
    /// V² − s² of the voltage V of a source and a free parameter s.
    PeakExcess {
        /// Source index.
        source: usize,
        /// Index of the parameter.
        parameter: usize,
        /// Unit of voltages in V: the row is in its square.
        unit: f64,
    },
    /// Volume in mm³ or mass in g of lumped muscles at rest, together, which follows from constants alone.
    Amount {
        /// Muscle indices.
        muscles: Arc<[usize]>,
        /// Volume or mass.
        amount: Amount,
    },
}

/// Time at which a quantity is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// The instants.
    Instant,
    /// The starts of the intervals.
    Start,
    /// The middles of the intervals.
    Middle,
    /// The ends of the intervals.
    End,
}

impl At {
    /// The reading of vectors at that time of an interval.
    pub fn stencil(self) -> Stencil {
        match self {
            Self::Instant | Self::Start => Stencil::Here,
            Self::Middle => Stencil::Mid,
            Self::End => Stencil::Next,
        }
    }
}

/// Value or step of a measured variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Its value.
    Value,
    /// Its step within an interval.
    Step,
    /// Its step from the interval before to an interval.
    Jump,
}

/// Kind of a part of a system that a quantity is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartKind {
    /// A joint.
    Joint,
    /// A muscle.
    Muscle,
    /// A spring.
    Spring,
    /// A tendon.
    Tendon,
    /// A contact.
    Contact,
    /// A source.
    Source,
    /// A marker.
    Marker,
    /// A body.
    Body,
    /// A block: those of the scene, then those of the muscles of finite elements.
    Block,
}

impl PartKind {
    /// Names of the parts of a system.
    pub fn names(self, system: &System) -> Vec<String> {
        fn all<P>(parts: &[P], name: impl Fn(&P) -> &String) -> Vec<String> {
            parts.iter().map(|part| name(part).clone()).collect()
        }
        let components = &system.components;
        match self {
            Self::Joint => all(&system.joints, |one| &one.name),
            Self::Muscle => all(&system.muscles, |one| &one.name),
            Self::Spring => all(&components.springs, |one| &one.name),
            Self::Tendon => all(&components.tendons, |one| &one.name),
            Self::Contact => all(&components.contacts, |one| &one.name),
            Self::Source => all(&system.sources(), |one| &one.name),
            Self::Marker => all(&system.markers, |one| &one.name),
            Self::Body => all(&system.bodies, |one| &one.name),
            Self::Block => {
                let blocks = 0..system.solids.len() + system.meshed_muscles().count();
                let names = blocks.map(|block| system.block_name(block));
                names.map(str::to_owned).collect()
            }
        }
    }
}

/// Names of the axes of the ground frame.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Deviation of the length of a unit vector.
const UNIT: f64 = 1e-9;

impl What {
    /// Visits the indices of the parts that it is of.
    pub fn visit(&mut self, visit: &mut dyn FnMut(PartKind, &mut usize)) {
        match self {
            Self::Joint { joint, .. } | Self::Reaction { joint, .. } => {
                visit(PartKind::Joint, joint);
            }
            Self::Stretch(muscle)
            | Self::Field(FieldPlace::Muscle(muscle))
            | Self::Tension(Pulling::Muscle(muscle))
            | Self::ChargedField(muscle)
            | Self::MeanCharge(muscle)
            | Self::Energy(muscle)
            | Self::Capacitance(muscle) => visit(PartKind::Muscle, muscle),
            Self::Tension(Pulling::Spring(spring)) => visit(PartKind::Spring, spring),
            Self::Tension(Pulling::Tendon(tendon)) => visit(PartKind::Tendon, tendon),
            Self::Field(FieldPlace::Element { block, .. } | FieldPlace::Block { block, .. }) => {
                visit(PartKind::Block, block);
            }
            Self::Current(source)
            | Self::Power(source)
            | Self::Charge(source)
            | Self::ElectrodeVoltage(source)
            | Self::Voltage(source)
            | Self::PeakExcess { source, .. } => visit(PartKind::Source, source),
            Self::Place { marker, .. } | Self::Speed(marker) | Self::Region { marker, .. } => {
                visit(PartKind::Marker, marker);
            }
            Self::Clearance { marker, plane } => {
                visit(PartKind::Marker, marker);
                plane
                    .body
                    .iter_mut()
                    .for_each(|body| visit(PartKind::Body, body));
            }
            Self::Gap(contact) | Self::ContactForce(contact) => visit(PartKind::Contact, contact),
            Self::Direction { body, .. } => visit(PartKind::Body, body),
            Self::PeakVoltage(_) => {}
            Self::Amount { muscles, .. } => {
                let muscles = Arc::make_mut(muscles).iter_mut();
                muscles.for_each(|muscle| visit(PartKind::Muscle, muscle));
            }
        }
    }

    /// The parts that it is of.
    pub fn parts(&self) -> Vec<(PartKind, usize)> {
        let mut parts = Vec::new();
        self.clone()
            .visit(&mut |kind, index| parts.push((kind, *index)));
        parts
    }

    /// The same of another system whose parts have the same names; none where it lacks one.
    pub fn of_other(&self, from: &System, to: &System) -> Option<Self> {
        let (mut other, mut is_there) = (self.clone(), true);
        other.visit(&mut |kind, index| {
            let name = kind.names(from).swap_remove(*index);
            match kind.names(to).iter().position(|one| *one == name) {
                Some(own) => *index = own,
                None => is_there = false,
            }
        });
        is_there.then_some(other)
    }

    /// Returns true if the parts are there and have what is measured; only a lumped muscle has one stretch, field and tension.
    pub fn exists(&self, system: &System) -> bool {
        let is_there = |(kind, index): (PartKind, usize)| match kind {
            PartKind::Muscle => {
                let muscle = system.muscles.get(index);
                muscle.is_some_and(|muscle| muscle.fidelity == Fidelity::Lumped)
            }
            _ => index < kind.names(system).len(),
        };
        if !self.parts().into_iter().all(is_there) {
            return false;
        }
        match *self {
            Self::Joint { joint, .. } => system.joints[joint].has_coordinate(),
            Self::Reaction { joint, of, along } => {
                let is_known = of == Reaction::Force || system.joints[joint].has_torque();
                is_known && (along.norm() - 1.0).abs() < UNIT
            }
            Self::Clearance { plane, .. } => (plane.normal.norm() - 1.0).abs() < UNIT,
            Self::Current(source) | Self::Power(source) => {
                let muscle = system.muscles.get(source);
                muscle.is_some_and(Muscle::has_measured_current)
            }
            Self::Voltage(source) => system.sources()[source].takes_voltage,
            Self::Place { axis, .. } => axis < 3,
            Self::Amount { ref muscles, .. } => !muscles.is_empty(),
            _ => true,
        }
    }

    /// Its time, words and unit, whatever its parts, and whatever of it is measured.
    fn row(&self) -> (At, &'static str, &'static str) {
        use At::{End, Instant, Middle, Start};
        match self {
            Self::Joint { .. } => (Instant, "coordinate", ""),
            Self::Stretch(_) => (Instant, "stretch", ""),
            Self::Tension(_) => (Middle, "tension", ""),
            Self::Field(_) => (Middle, "electric field", ""),
            Self::ChargedField(_) => (Instant, "electric field", ""),
            Self::Current(_) => (Middle, "current", ""),
            Self::Power(_) => (Middle, "power", ""),
            Self::Charge(_) => (Instant, "charge", "mC"),
            Self::MeanCharge(_) => (Middle, "charge", ""),
            Self::Energy(_) => (End, "energy", ""),
            Self::Capacitance(_) => (Instant, "capacitance", "mF"),
            Self::ElectrodeVoltage(_) => (Middle, "voltage", "V"),
            Self::Voltage(_) => (Middle, "voltage", ""),
            Self::Reaction { of, .. } => match of {
                Reaction::Force => (Start, "reaction force", ""),
                Reaction::Torque => (Start, "reaction torque", ""),
            },
            Self::Place { axis, .. } => (Instant, AXES[*axis], "mm"),
            Self::Speed(_) => (Middle, "speed", ""),
            Self::Region { .. } => (Instant, "region", ""),
            Self::Clearance { .. } => (Instant, "clearance", "mm"),
            Self::Gap(_) => (Instant, "gap", "mm"),
            Self::ContactForce(_) => (Middle, "normal force", ""),
            Self::Direction { .. } => (Instant, "direction", ""),
            Self::PeakVoltage(_) => (Middle, "peak voltage", "kV"),
            Self::PeakExcess { .. } => (Middle, "peak voltage", ""),
            Self::Amount { amount, .. } => (Middle, "amount", amount.unit().0),
        }
    }

    /// Time at which it is read where nothing else is said.
    pub fn time(&self) -> At {
        self.row().0
    }

    /// Unit of its values or steps; none of a ratio, or of what is measured in a unit of its own.
    pub fn unit(&self, of: Of, system: &System) -> &'static str {
        match self {
            Self::Joint { joint, .. } => joint_unit(system, *joint),
            Self::MeanCharge(_) if of == Of::Value => "mC",
            _ => self.row().2,
        }
    }

    /// End of the name of its column where a cost names it; none of places and joint coordinates.
    pub fn column(&self, of: Of) -> Option<&'static str> {
        match self {
            Self::Joint { .. } if of == Of::Step => Some("rate"),
            Self::ChargedField(_) | Self::Field(FieldPlace::Muscle(_)) => Some("field"),
            Self::Tension(_)
            | Self::Current(_)
            | Self::Power(_)
            | Self::Speed(_)
            | Self::Clearance { .. } => Some(self.row().1),
            _ => None,
        }
    }

    /// Its name in limits, costs and recordings: `tension of muscle1`.
    pub fn words(&self, of: Of, system: &System) -> String {
        let what = match self {
            Self::Joint { .. } if of != Of::Value => "rate",
            Self::Voltage(_) if of != Of::Value => "rate of the voltage",
            Self::Amount { muscles, amount } => return amount.words(muscles, system),
            _ => self.row().1,
        };
        match self.parts().first() {
            None => format!("{what} of "),
            Some(&(kind, index)) => {
                let marker = if kind == PartKind::Marker {
                    "marker "
                } else {
                    ""
                };
                format!("{what} of {marker}{}", kind.names(system)[index])
            }
        }
    }
}

/// Unit of a joint coordinate.
pub fn joint_unit(system: &System, joint: usize) -> &'static str {
    match system.joints[joint].kind {
        JointKind::Prismatic { .. } => "mm",
        _ => "rad",
    }
}

/// A region of space in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Box between two corners.
    Box {
        /// Lower corner.
        min: Vector,
        /// Upper corner.
        max: Vector,
    },
    /// Ball.
    Sphere {
        /// Centre.
        centre: Vector,
        /// Radius.
        radius: f64,
    },
}

/// Place where a true electric field is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldPlace {
    /// In a lumped muscle.
    Muscle(usize),
    /// At a point of a finite element.
    Element {
        /// Block: those of the scene, then those of the muscles of finite elements.
        block: usize,
        /// Element of its mesh.
        element: usize,
        /// Gauss point; the centre where there is none.
        point: Option<usize>,
    },
    /// At all points of a block that a field reaches: as many quantities.
    Block {
        /// Block.
        block: usize,
        /// Region of its mesh; all elements where there is none.
        region: Option<usize>,
    },
}

/// A plane that is fixed to a body, or to the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Body; the ground where there is none.
    pub body: Option<usize>,
    /// A point of it in mm, in the reference configuration.
    pub point: Vector,
    /// Its unit normal, in the reference configuration.
    pub normal: Vector,
}

/// Force or torque that a joint transmits along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Force in N.
    Force,
    /// Torque in N mm about the point of the joint.
    Torque,
}

/// A part between points that pulls its ends together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulling {
    /// A lumped muscle.
    Muscle(usize),
    /// A spring with its damper.
    Spring(usize),
    /// A tendon.
    Tendon(usize),
}
