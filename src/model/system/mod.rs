//! The system of a scene: bodies, joints, muscles and markers in g, mm, ms, N, V, names resolved.

pub(super) mod bodies;
pub(super) mod check;
pub(super) mod circuit;
pub(super) mod electrode_circuits;
pub(super) mod joints;
pub(super) mod maxwell;
pub(super) mod prestretch;

use crate::math::Signal;
use crate::mesh::Mesh;
use crate::mesh::cell::Cell;
use crate::mesh::footing::Footing;
use crate::model::components::{BlockLoad, Components, Load, LoadPlace};
use nalgebra::{Matrix3, Vector3};

pub use crate::element::Dielectric as ElectricConstants;
pub use crate::energy::{
    CoordinateSpring as JointSpring, CoordinateStops as JointStops, ElasticLaw,
};
pub use crate::model::system::bodies::{
    Attachment, Body, Shape, directors_along, is_diagonal, principal,
};
pub use crate::model::system::circuit::{Circuit, InputKind, Source, voltage_sources};
pub use crate::model::system::maxwell::{MaxwellBranch, MaxwellBranches};

/// A mechanical system; `None` for a body index is the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// Name for captions.
    pub name: String,
    /// Rigid bodies.
    pub bodies: Vec<Body>,
    /// Joints between bodies or to the ground.
    pub joints: Vec<Joint>,
    /// Muscles.
    pub muscles: Vec<Muscle>,
    /// Elastic blocks.
    pub solids: Vec<Solid>,
    /// Points whose motion is reported.
    pub markers: Vec<Marker>,
    /// Acceleration of gravity in mm/ms², where there is gravity.
    pub gravity: Option<Vector3<f64>>,
    /// Parts that answer for themselves: springs, tendons.
    pub components: Components,
}

impl System {
    /// Returns true if a support holds a marker in the direction of an axis.
    pub fn holds_marker(&self, marker: usize, axis: usize) -> bool {
        let Marker { point, solid, .. } = &self.markers[marker];
        let Some(solid) = solid.map(|s| &self.solids[s]) else {
            return false;
        };
        let node = solid.mesh.nearest_node(&point.at);
        let holds = |s: &Support| s.held[axis] && node.is_some_and(|n| s.nodes.contains(&n));
        solid.supports.iter().any(holds)
    }

    /// Returns true if a material of a muscle or block has Maxwell branches.
    pub fn has_branches(&self) -> bool {
        let of_muscles = self.muscles.iter().map(|muscle| &muscle.material);
        let of_blocks = self.solids.iter().flat_map(|solid| &solid.materials);
        let mut materials = of_muscles.chain(of_blocks);
        materials.any(|material| !material.maxwell.list().is_empty())
    }

    /// Indices of the muscles of finite elements; their blocks follow those of the scene in this order.
    pub fn meshed_muscles(&self) -> impl Iterator<Item = usize> + '_ {
        let muscles = self.muscles.iter().enumerate();
        let meshed = muscles.filter(|(_, muscle)| muscle.fidelity != Fidelity::Lumped);
        meshed.map(|(index, _)| index)
    }

    /// Name of a block of the scene, or of the muscle that the block is.
    pub fn block_name(&self, block: usize) -> &str {
        match self.muscle_of_block(block) {
            None => &self.solids[block].name,
            Some(muscle) => &muscle.name,
        }
    }

    fn muscle_of_block(&self, block: usize) -> Option<&Muscle> {
        let index = block.checked_sub(self.solids.len())?;
        self.meshed_muscles().nth(index).map(|m| &self.muscles[m])
    }

    /// Element and point, the centre or a Gauss point, of all points at which the field of a block is limited.
    pub fn field_points(&self, block: usize, region: Option<usize>) -> Vec<(usize, Option<usize>)> {
        let elements = match self.muscle_of_block(block) {
            Some(muscle) => muscle.fidelity.elements(),
            None => self.solids[block].mesh.element_count(),
        };
        let is_in = |e: &usize| region.is_none_or(|r| self.solids[block].mesh.regions[*e] == r);
        let points = || std::iter::once(None).chain((0..8).map(Some));
        let elements = (0..elements).filter(is_in);
        elements
            .flat_map(|e| points().map(move |p| (e, p)))
            .collect()
    }

    /// Number of finite elements of muscles and blocks.
    pub fn elements(&self) -> usize {
        let of_muscles = self.muscles.iter().map(|muscle| muscle.fidelity.elements());
        let of_blocks = self.solids.iter().map(|solid| solid.mesh.element_count());
        of_muscles.chain(of_blocks).sum()
    }

    /// All that inputs are named for, one each: the muscles, then the driven electrodes of blocks by
    /// `block.electrode`, then the loads, in the order of the scene. Electrodes of one name in a block share one voltage.
    pub fn sources(&self) -> Vec<Source> {
        let muscle = |(index, m): (usize, &Muscle)| Source {
            name: m.name.clone(),
            kind: InputKind::Voltage,
            takes_voltage: m.material.electric.is_some() && !self.is_charged(index),
        };
        let mut sources: Vec<Source> = self.muscles.iter().enumerate().map(muscle).collect();
        for solid in &self.solids {
            for electrode in &solid.electrodes {
                if let Potential::Driven { source, .. } = electrode.potential
                    && source == sources.len()
                {
                    sources.push(Source {
                        name: format!("{}.{}", solid.name, electrode.name),
                        kind: InputKind::Voltage,
                        takes_voltage: true,
                    });
                }
            }
        }
        let load = |load: &Load| Source {
            name: load.name.clone(),
            kind: self.load_kind(load),
            takes_voltage: false,
        };
        sources.extend(self.components.loads.iter().map(load));
        sources
    }

    /// Loads with their sources; of a whole scene, for without driven electrodes the numbers are others.
    pub fn loads(&self) -> impl Iterator<Item = (usize, &Load)> {
        (self.first_load()..).zip(&self.components.loads)
    }

    /// Index of the first load among the sources.
    pub fn first_load(&self) -> usize {
        self.sources().len() - self.components.loads.len()
    }

    /// Physical kind of the size of a load.
    fn load_kind(&self, load: &Load) -> InputKind {
        match &load.on {
            LoadPlace::Joint(joint) => match self.joints[*joint].kind {
                JointKind::Prismatic { .. } => InputKind::Force,
                _ => InputKind::Torque,
            },
            LoadPlace::Point { .. } => InputKind::Force,
            LoadPlace::Muscle(_) => InputKind::Charge,
            LoadPlace::Block { load, .. } => match load {
                BlockLoad::Traction(..) | BlockLoad::Pressure { .. } => InputKind::Traction,
                BlockLoad::Charge(_) => InputKind::SurfaceCharge,
                BlockLoad::BodyForce(_) => InputKind::BodyForce,
            },
        }
    }

    /// Bodies on which a load acts.
    pub fn loaded_bodies(&self, load: &Load) -> Vec<usize> {
        match load.on {
            LoadPlace::Point { at, .. } => at.body.into_iter().collect(),
            LoadPlace::Joint(joint) => {
                let joint = &self.joints[joint];
                joint.parent.into_iter().chain([joint.child]).collect()
            }
            LoadPlace::Muscle(muscle) => {
                let muscle = &self.muscles[muscle];
                let ends = [muscle.from, muscle.to].into_iter();
                ends.filter_map(|end| end.body).collect()
            }
            LoadPlace::Block { .. } => Vec::new(),
        }
    }
}

/// A joint at a point of the reference configuration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// Unique name.
    pub name: String,
    /// Motion that it permits.
    pub kind: JointKind,
    /// Body on the side of the root; `None` is the ground.
    pub parent: Option<usize>,
    /// Body on the other side.
    pub child: usize,
    /// Place in mm, in the ground frame.
    pub at: Vector3<f64>,
    /// Damping of the joint coordinate: N mm ms for an angle, N ms/mm for a displacement; `None` leaves no trace.
    pub damping: Option<f64>,
    /// Spring of the joint coordinate; `None` leaves no trace.
    pub spring: Option<JointSpring>,
    /// Stops of the joint coordinate; `None` leaves no trace.
    pub stops: Option<JointStops>,
    /// Prescribed coordinate in rad or mm as a function of time; `None` where forces move the joint.
    pub motion: Option<Signal>,
}

/// A stacked dielectric elastomer between two material points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Muscle {
    /// Unique name.
    pub name: String,
    /// Start of the span.
    pub from: Attachment,
    /// End of the span.
    pub to: Attachment,
    /// Sides of the rectangular cross-section at rest in mm.
    pub cross_section: [f64; 2],
    /// Thickness of one layer at rest in mm.
    pub layer_thickness: f64,
    /// Elastomer.
    pub material: Material,
    /// Stretch before it was glued between its ends; `None` where it is as long as at rest.
    pub prestretch: Option<f64>,
    /// True if the inertia of the changing cross-section is asked for.
    pub section_inertia: bool,
    /// Circuit between its source and its electrodes; `None` where they have the voltage of the source.
    pub circuit: Option<Circuit>,
    /// Model of the muscle.
    pub fidelity: Fidelity,
}

/// Model of a muscle: lumped or finite elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Fidelity {
    /// One stretch at constant volume.
    #[default]
    Lumped,
    /// Finite elements, glued to both bodies with its end faces.
    FiniteElements(Discretisation),
}

impl Fidelity {
    /// Number of finite elements.
    pub fn elements(&self) -> usize {
        match self {
            Self::Lumped => 0,
            Self::FiniteElements(discretisation) => discretisation.elements.iter().product(),
        }
    }
}

/// The finite elements of a muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation {
    /// Elements along both sides of the cross-section and along the span.
    pub elements: [usize; 3],
    /// Layers of the model along the span, a divisor of the elements there; each stands for many layers of the muscle
    /// under the same field.
    pub layers: usize,
    /// Kind of its elements.
    pub element: ElementKind,
    /// Direction of the first side of the cross-section in the ground frame, of which the part across the span counts; `None` for the direction
    /// that is perpendicular to the span and to the first ground axis within 0.6 of its cosine.
    pub first_side: Option<Vector3<f64>>,
}

/// An elastic block of finite elements, or a membrane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Unique name.
    pub name: String,
    /// Nodes and elements in the reference configuration, in the ground frame.
    pub mesh: Mesh,
    /// Material of each region of the mesh.
    pub materials: Vec<Material>,
    /// Kind of its elements.
    pub element: ElementKind,
    /// Electrodes; without any the block has no potential.
    pub electrodes: Vec<Electrode>,
    /// Nodes that are held in some directions.
    pub supports: Vec<Support>,
    /// Nodes that are glued to bodies.
    pub glued: Vec<Glue>,
    /// Nodes that are glued to other blocks or membranes, of which none is glued itself.
    pub tied: Vec<Tie>,
    /// Velocity of each node at the start in mm/ms; empty at rest.
    pub velocities: Vec<Vector3<f64>>,
    /// Thickness of a membrane without stress in mm; `None` of a block.
    pub thickness: Option<f64>,
    /// Stretch U of the reference configuration x = U X of the places X without stress, symmetric; `None` where it has none.
    pub prestretch: Option<Matrix3<f64>>,
}

/// Kind of element: its interpolation, and its treatment of volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementKind {
    /// Trilinear hexahedron with 2 × 2 × 2 Gauss points.
    #[default]
    Hex8,
    /// The same with one dilatation an element (Q1P0), against volumetric locking.
    Hex8Q1P0,
    /// Quadratic tetrahedron with eight Gauss points.
    Tet10,
    /// The same with one dilatation an element (P2P0), against volumetric locking.
    Tet10P2P0,
    /// Quadratic triangle of an incompressible membrane in plane stress with three points.
    Membrane,
}

impl ElementKind {
    /// The kind of the elements of a mesh where none is named.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        match mesh.cell() {
            Cell::Hexahedron => Self::Hex8,
            Cell::Tetrahedron => Self::Tet10,
            Cell::Triangle => Self::Membrane,
        }
    }

    /// Its interpolation.
    pub fn cell(self) -> Cell {
        match self {
            Self::Hex8 | Self::Hex8Q1P0 => Cell::Hexahedron,
            Self::Tet10 | Self::Tet10P2P0 => Cell::Tetrahedron,
            Self::Membrane => Cell::Triangle,
        }
    }

    /// Returns true if its volumetric energy is that of its mean dilatation.
    pub fn has_mean_dilatation(self) -> bool {
        matches!(self, Self::Hex8Q1P0 | Self::Tet10P2P0)
    }
}

/// Nodes of one potential.
#[derive(Clone, Debug, PartialEq)]
pub struct Electrode {
    /// Name, unique in the block.
    pub name: String,
    /// The nodes.
    pub nodes: Vec<usize>,
    /// Its potential.
    pub potential: Potential,
    /// Circuit between it and its source, where it is driven.
    pub circuit: Option<Circuit>,
}

/// The potential of an electrode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Potential {
    /// A constant in V; 0 is grounded.
    Given(f64),
    /// `factor` times the voltage of a source (see [`System::sources`]).
    Driven {
        /// The source.
        source: usize,
        /// Its factor.
        factor: f64,
    },
    /// Whatever makes the charge of the electrode vanish.
    Floating,
}

/// Nodes held at their reference places in some directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    /// The nodes.
    pub nodes: Vec<usize>,
    /// Directions (x, y, z) that are held.
    pub held: [bool; 3],
}

/// Nodes that move with a body; `None` is the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Glue {
    /// The nodes.
    pub nodes: Vec<usize>,
    /// The body.
    pub body: Option<usize>,
}

/// A node of a block or a membrane that is glued to another one: it is a sum of nodes there.
#[derive(Clone, Debug, PartialEq)]
pub struct Tie {
    /// The node.
    pub node: usize,
    /// The other block or membrane.
    pub solid: usize,
    /// Its nodes, and the parts that they have.
    pub on: Footing,
}

/// A named material point whose path is reported.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Unique name.
    pub name: String,
    /// The point.
    pub point: Attachment,
    /// The block whose node nearest to the point is meant, where it is on a block rather than on a body.
    pub solid: Option<usize>,
}

impl Muscle {
    /// Rest length L₀ in mm: the distance of its ends by its prestretch.
    pub fn length(&self) -> f64 {
        let distance = (self.to.at - self.from.at).norm();
        self.prestretch
            .map_or(distance, |stretch| distance / stretch)
    }

    /// Rest volume in mm³.
    pub fn volume(&self) -> f64 {
        self.cross_section[0] * self.cross_section[1] * self.length()
    }

    /// Force μ A₀ in N of the shear modulus and the cross-section at rest.
    pub fn shear_force(&self) -> f64 {
        self.material.shear_modulus * self.cross_section[0] * self.cross_section[1]
    }

    /// Mass in g; `None` where the material has no density.
    pub fn mass(&self) -> Option<f64> {
        self.material.density.map(|rho| rho * self.volume())
    }
}

/// Gives the driven electrodes their sources, in the order of the blocks; the first one is `first`.
pub fn number_sources(solids: &mut [Solid], first: usize) {
    let mut next = first;
    for electrode in solids.iter_mut().flat_map(|solid| &mut solid.electrodes) {
        if let Potential::Driven { source, .. } = &mut electrode.potential {
            *source = next;
            next += 1;
        }
    }
}

impl JointStops {
    /// Distance in rad or mm by which a coordinate is beyond a stop; negative between the stops.
    pub fn beyond(&self, coordinate: f64) -> f64 {
        (self.at[0] - coordinate).max(coordinate - self.at[1])
    }
}

/// Motion that a joint permits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum JointKind {
    /// Rotation about a unit axis.
    Revolute {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Translation along a unit axis.
    Prismatic {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Rotation about a unit axis of the parent, then about a unit axis of the child perpendicular to it.
    Universal {
        /// Both axes in the ground frame.
        axes: [Vector3<f64>; 2],
    },
    /// Translation along a unit axis and rotation about it.
    Cylindrical {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Translation in a plane and rotation about its unit normal.
    Planar {
        /// Unit normal in the ground frame.
        normal: Vector3<f64>,
    },
    /// Rotation about a point.
    Spherical,
    /// Anything: the child is as free as without the joint.
    Floating,
    /// Nothing.
    #[default]
    Fixed,
}

/// A dielectric elastomer. What is `None` leaves no trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// Density in g/mm³.
    pub density: Option<f64>,
    /// Shear modulus μ of small strains in MPa.
    pub shear_modulus: f64,
    /// Law of elasticity other than the neo-Hookean one.
    pub law: Option<ElasticLaw>,
    /// First Lamé constant λ in MPa; finite elements need it, lumped muscles keep their volume and do not read it.
    pub lame_lambda: Option<f64>,
    /// Electric constants.
    pub electric: Option<ElectricConstants>,
    /// Viscosity η in MPa ms, σ_vis = η d.
    pub viscosity: Option<f64>,
    /// Maxwell branches.
    pub maxwell: MaxwellBranches,
    /// Smallest and largest stretch for which the constants hold, for warnings.
    pub stretch_range: Option<[f64; 2]>,
}

/// Permittivity of vacuum in N/V² (F/m), CODATA value in the decimals of the reference solutions.
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_817e-12;

impl Material {
    /// λ = 2 μ ν/(1 − 2 ν) of a shear modulus and a Poisson ratio.
    pub fn first_lame_constant(shear_modulus: f64, poisson_ratio: f64) -> f64 {
        2.0 * shear_modulus * poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    }
}

impl ElectricConstants {
    /// A dielectric of this relative permittivity whose polarisation is linear in the reference field.
    pub fn first_order(ratio: f64) -> Self {
        Self {
            c1: -(ratio - 1.0) * VACUUM_PERMITTIVITY,
            c2: (ratio - 1.0) * VACUUM_PERMITTIVITY / 2.0,
            permittivity: VACUUM_PERMITTIVITY,
        }
    }

    /// An ideal dielectric of this relative permittivity.
    pub fn ideal(ratio: f64) -> Self {
        Self {
            c1: 0.0,
            c2: 0.0,
            permittivity: ratio * VACUUM_PERMITTIVITY,
        }
    }
}

/// Volume or mass of muscles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Amount {
    /// Volume in mm³.
    Volume,
    /// Mass in g; muscles without a density have none.
    Mass,
}

impl Amount {
    /// Words for messages.
    pub fn words(self, muscles: &[usize], system: &System) -> String {
        let what = match self {
            Self::Volume => "volume",
            Self::Mass => "mass",
        };
        match muscles {
            [one] => format!("{what} of {}", system.muscles[*one].name),
            several => format!("{what} of {} muscles", several.len()),
        }
    }

    /// Unit for messages, and its size in mm³ or g.
    pub const fn unit(self) -> (&'static str, f64) {
        match self {
            Self::Volume => ("cm^3", 1e3),
            Self::Mass => ("g", 1.0),
        }
    }

    /// Value of given muscles, in mm³ or g.
    pub fn of(self, muscles: &[usize], system: &System) -> f64 {
        let one = |muscle: &Muscle| match self {
            Self::Volume => muscle.volume(),
            Self::Mass => muscle.mass().unwrap_or(0.0),
        };
        muscles.iter().map(|&m| one(&system.muscles[m])).sum()
    }
}
