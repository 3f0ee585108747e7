//! A scene as it is written: the serde types of the scene file.

use std::collections::BTreeMap;

use crate::files::json::objects::objects;
use crate::files::scene::contact::ContactSpec;
use crate::files::scene::joint::JointSpec;
use crate::files::scene::load::LoadSpec;
use crate::files::scene::material::MaterialSpec;
use crate::files::scene::point::{Point, PointSpec};
use crate::files::scene::shape::ContactShapeSpec;
use crate::files::scene::spec_solids::{CircuitSpec, ElementSpec, SolidSpec};
use crate::files::scene::spring::{SpringSpec, TendonSpec};
use crate::files::units::quantity::{
    Acceleration, Angle, Density, Length, Mass, MomentOfInertia, Quantity,
};

objects! {
    /// Scene. Positions and axes are given in the reference configuration, in the ground frame; parts that are not written do not exist.
    #[derive(Default)]
    pub struct SceneSpec {
        /// JSON Schema of this file, for editors.
        #[serde(rename = "$schema")]
        pub schema: Option<String>,
        /// Name for captions.
        pub name: String,
        /// Elastomers by name.
        pub materials: BTreeMap<String, MaterialSpec>,
        /// Rigid bodies; `ground` is there without being written.
        pub bodies?: Vec<BodySpec>,
        /// Joints between bodies or to the ground.
        pub joints?: Vec<JointSpec>,
        /// Dielectric elastomer muscles.
        pub muscles?: Vec<MuscleSpec>,
        /// Elastic blocks of finite elements.
        pub solids?: Vec<SolidSpec>,
        /// Springs and dampers between two points.
        pub springs?: Vec<SpringSpec>,
        /// Elastic cables through points.
        pub tendons?: Vec<TendonSpec>,
        /// Shapes that contacts name.
        pub shapes?: Vec<ContactShapeSpec>,
        /// Contacts of shapes.
        pub contacts?: Vec<ContactSpec>,
        /// Forces and torques whose sizes a problem gives or seeks.
        pub loads?: Vec<LoadSpec>,
        /// Points whose motion is reported.
        pub markers?: Vec<MarkerSpec>,
        /// Acceleration of gravity, SI unit m/s².
        pub gravity: Option<[Quantity<Acceleration>; 3]>,
        /// Shorthand for a chain of segments with a pair of muscles at each joint.
        pub chain: Option<ChainSpec>,
    }

    /// A rigid body: a mass or a density; one shape, or an explicit inertia, or both.
    #[derive(Default)]
    pub struct BodySpec {
        /// Unique name other than `ground`.
        pub name: String,
        /// Mass, SI unit kg.
        pub mass: Option<Quantity<Mass>>,
        /// Density of the shape, SI unit kg/m³, in place of the mass.
        pub density: Option<Quantity<Density>>,
        /// Solid cylinder.
        pub cylinder: Option<CylinderSpec>,
        /// Solid box with edges along the axes of the ground frame.
        #[serde(rename = "box")]
        pub cuboid: Option<BoxSpec>,
        /// Solid sphere.
        pub sphere: Option<SphereSpec>,
        /// Solid within a closed surface of triangles, from an STL file; beside `inertia` it is only drawn.
        pub mesh: Option<BodyMeshSpec>,
        /// Moments of inertia about the axes of the ground frame through the centre of mass, SI unit kg m²; overrides the shape's.
        pub inertia: Option<[Quantity<MomentOfInertia>; 3]>,
        /// Entries xy, xz, yz of the tensor of inertia whose diagonal is `inertia`, such as −∫ x y dm, SI unit kg m²; zero where not written.
        pub products_of_inertia: Option<[Quantity<MomentOfInertia>; 3]>,
        /// Centre of mass, SI unit m; of a `mesh` without `inertia` it follows from the surface, and is not written.
        pub position: Option<Point>,
        /// True if the body is free of the ground: no chain of joints leads there.
        pub free: bool,
    }

    /// A cylinder.
    pub struct CylinderSpec {
        /// Length along the axis, SI unit m.
        pub length: Quantity<Length>,
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
        /// Direction of the axis, of any length.
        pub axis: [f64; 3],
    }

    /// A box.
    pub struct BoxSpec {
        /// Edge lengths along x, y, z, SI unit m.
        pub size: Point,
    }

    /// A sphere.
    pub struct SphereSpec {
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
    }

    /// A surface from an STL file.
    pub struct BodyMeshSpec {
        /// STL file, binary or text; its path is relative to the scene file.
        pub file: String,
        /// Length of its unit, SI unit m; 1 m where not written.
        pub unit: Option<Quantity<Length>>,
        /// Place of its origin, SI unit m; that of the ground frame where not written.
        pub at: Option<Point>,
        /// Rotation about its origin; where not written its axes are those of the ground frame.
        pub rotation: Option<RotationSpec>,
    }

    /// A rotation.
    pub struct RotationSpec {
        /// Direction of the axis, of any length.
        pub axis: [f64; 3],
        /// Angle by the right-hand rule, SI unit rad.
        pub angle: Quantity<Angle>,
    }
}

/// Declares the keys of stacked muscles: those that all have, and those of their places.
macro_rules! stacked {
    ($(#[$about:meta])* $name:ident { $($first:tt)* } { $($last:tt)* }) => { objects! {
        $(#[$about])*
        pub struct $name {
            $($first)*
            /// Model; `lumped` where not written.
            #[serde(default)]
            pub model: MuscleModel,
            /// Elements along both sides of the cross-section and along the span; of `finite_elements` only.
            pub elements: Option<[usize; 3]>,
            /// Layers of the model along the span, a divisor of the elements there, which is its default; of `finite_elements` only.
            pub layers: Option<usize>,
            /// Kind of hexahedron; `hex8` where not written. Of `finite_elements` only.
            pub element: Option<ElementSpec>,
            /// Name of the material.
            pub material: String,
            /// Sides of the rectangular cross-section at rest, SI unit m.
            pub cross_section: [Quantity<Length>; 2],
            /// Thickness of one layer at rest, SI unit m.
            pub layer_thickness: Quantity<Length>,
            /// Stretch before it was glued between its ends; 1 where not written.
            pub prestretch: Option<f64>,
            /// Circuit between the source and the electrodes, of a lumped muscle; without it they have the voltage of the source.
            pub circuit: Option<CircuitSpec>,
            $($last)*
        }
    } };
}

stacked! {
    /// A muscle between two points.
    MuscleSpec {
        /// Unique name.
        pub name: String,
    } {
        /// Start.
        pub from: PointSpec,
        /// End.
        pub to: PointSpec,
        /// Direction of the first side of the cross-section, of which the part across the span counts; where not written perpendicular to the span
        /// and to the first of the axes x, y, z whose cosine with the span is below 0.6. Of `finite_elements` only.
        pub first_side: Option<[f64; 3]>,
        /// True if the inertia of the changing cross-section is taken into account.
        pub section_inertia: bool,
    }
}

stacked! {
    /// A pair of muscles at a joint of a chain.
    PairSpec {
        /// Distance from the long axis, SI unit m.
        pub arm: Quantity<Length>,
        /// Length at rest, SI unit m.
        pub rest_length: Quantity<Length>,
    } {}
}

objects! {
    /// Model of a muscle.
    #[derive(Default)]
    pub enum MuscleModel {
        /// One stretch at constant volume.
        #[default]
        Lumped,
        /// Finite elements, glued to both bodies with its end faces.
        FiniteElements,
    }

    /// A named material point of a body or of a block: exactly one of `body` and `solid`.
    pub struct MarkerSpec {
        /// Unique name.
        pub name: String,
        /// Name of the body, or `ground`.
        pub body: Option<String>,
        /// Name of the block; its node nearest to the place is meant.
        pub solid: Option<String>,
        /// Place, SI unit m.
        pub at: Point,
    }

    /// A chain from the origin along an axis: `segment1`…, `joint1`…, and `muscle1`…, two at each joint.
    ///
    /// Joint i stands at (i − 1) lengths; the joint axes alternate by 90° about the long axis. Muscle 2i − 1 runs at `+arm`, muscle 2i at
    /// `−arm` off the long axis, from half a rest length below the joint to half a rest length above it.
    pub struct ChainSpec {
        /// Number of segments.
        pub segments: usize,
        /// Length of a segment, SI unit m.
        pub length: Quantity<Length>,
        /// Radius of a segment, SI unit m.
        pub radius: Quantity<Length>,
        /// Mass of a segment, SI unit kg.
        pub mass: Quantity<Mass>,
        /// Long axis.
        pub axis: [f64; 3],
        /// Axis of the first joint, at right angles to the long axis.
        pub first_joint_axis: [f64; 3],
        /// Pair of muscles at each joint.
        pub muscles: Option<PairSpec>,
        /// Name of a marker at the end.
        pub tip_marker: Option<String>,
    }
}
