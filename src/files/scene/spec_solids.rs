//! Elastic blocks and circuits as they are written: a part of the scene file.

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::fmt;

use crate::files::json::objects::objects;
use crate::files::scene::point::{CornersSpec, Point};
use crate::files::units::quantity::{
    AngularVelocity, Length, Quantity, Rate, Resistance, Velocity, Voltage,
};
use crate::model::system::{Circuit, ElementKind};

objects! {
    /// An elastic block of finite elements: a `box` or a `mesh`, of one `material` or of `materials` by region; or a membrane with a `thickness`: a
    /// `surface` or a `mesh` of triangles or quadrangles.
    ///
    /// Faces are `x_min`, `x_max`, `y_min`, `y_max`, `z_min`, `z_max` of a box, the edges of a surface, and physical groups of a mesh.
    pub struct SolidSpec {
        /// Unique name.
        pub name: String,
        /// Name of the material.
        pub material: Option<String>,
        /// Names of the materials by region.
        pub materials: Option<BTreeMap<String, String>>,
        /// Box with edges along the axes of the ground frame.
        #[serde(rename = "box")]
        pub cuboid: Option<GridSpec>,
        /// Surface of a membrane.
        pub surface: Option<SurfaceSpec>,
        /// Thickness of a membrane before its prestretch, SI unit m.
        pub thickness: Option<Quantity<Length>>,
        /// Path of a Gmsh file, relative to this file.
        pub mesh: Option<String>,
        /// Length of a unit of the Gmsh file, SI unit m; 1 m where not written.
        pub unit: Option<Quantity<Length>>,
        /// Kind of its elements; `hex8` where not written, `tet10` of a mesh of tetrahedra.
        pub element: Option<ElementSpec>,
        /// Electrodes; without any the block has no potential. Those of a membrane lie on both sides: their potential is the voltage across it, of
        /// the triangles that they cover.
        pub electrodes?: Vec<ElectrodeSpec>,
        /// Electrodes between the layers of a stack and at its ends, alternately grounded and driven.
        pub stack: Option<StackSpec>,
        /// Faces and other places that are held. A node that is glued as well moves with its body.
        pub fixed?: Vec<FixedSpec>,
        /// Names of bodies, or of other solids, by the faces that are glued to them; a face glued to `ground` is clamped. A face that is glued to
        /// another solid lies on its surface.
        pub glued: BTreeMap<String, String>,
        /// Velocity at the start; at rest where not written.
        pub velocity: Option<VelocitySpec>,
        /// Stretch before it was glued and held, by which the mesh differs from the block without stress; none where not written.
        pub prestretch: Option<PrestretchSpec>,
    }
}

impl SolidSpec {
    /// Names of the materials that it is made of.
    pub(crate) fn material_names(&self) -> impl Iterator<Item = &String> {
        let of_regions = self.materials.iter().flat_map(BTreeMap::values);
        self.material.iter().chain(of_regions)
    }
}

objects! {
    /// Stretches along the axes of the ground frame; those that are not written keep the volume.
    pub struct PrestretchSpec {
        /// Stretch along x.
        pub x: Option<f64>,
        /// Stretch along y.
        pub y: Option<f64>,
        /// Stretch along z.
        pub z: Option<f64>,
    }

    /// Kind of element: its interpolation, and its treatment of volume.
    #[derive(Default)]
    pub enum ElementSpec: ElementKind {
        /// Trilinear hexahedron.
        #[default]
        Hex8,
        /// The same with one dilatation an element, for materials that hardly change their volume.
        Hex8Q1p0 = Hex8Q1P0,
        /// Quadratic tetrahedron.
        Tet10,
        /// The same with one dilatation an element.
        Tet10P2p0 = Tet10P2P0,
        /// Quadratic triangle of an incompressible membrane in plane stress.
        Membrane,
    }

    /// Surface of a membrane: exactly one of `rectangle`, `disc`, `annulus`, `tube` and `sphere`. `surface` is the set of all its nodes.
    pub struct SurfaceSpec {
        /// Centre, or of a tube that of its lower end, SI unit m; the origin where not written.
        pub centre: Option<Point>,
        /// Direction of the normal, or of the axis of a tube; z where not written.
        pub axis: Option<AxisName>,
        /// Rectangle around the centre; edges `x_min`, `x_max`, `y_min`, `y_max` along its own directions, those that follow the axis.
        pub rectangle: Option<RectangleSpec>,
        /// Disc; edge `edge`.
        pub disc: Option<DiscSpec>,
        /// Ring; edges `inner` and `outer`.
        pub annulus: Option<AnnulusSpec>,
        /// Tube, open at both ends `z_min` and `z_max`.
        pub tube: Option<TubeSpec>,
        /// Sphere.
        pub sphere: Option<SphereSpec>,
    }

    /// A rectangle of triangles.
    pub struct RectangleSpec {
        /// Lengths of both edges, SI unit m.
        pub size: [Quantity<Length>; 2],
        /// Elements along both: numbers, or lists of layers.
        pub elements: [DivisionSpec; 2],
    }

    /// A disc of triangles.
    pub struct DiscSpec {
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
        /// Elements from the centre to the edge: a number, or a list of layers.
        pub elements: DivisionSpec,
    }

    /// A ring of triangles.
    pub struct AnnulusSpec {
        /// Inner and outer radius, SI unit m.
        pub radii: [Quantity<Length>; 2],
        /// Elements from the inner edge to the outer one, a number or a list of layers, and around.
        pub elements: [DivisionSpec; 2],
    }

    /// A tube of triangles.
    pub struct TubeSpec {
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
        /// Length, SI unit m.
        pub length: Quantity<Length>,
        /// Elements around, and along the axis, a number or a list of layers.
        pub elements: [DivisionSpec; 2],
    }

    /// A sphere of triangles.
    pub struct SphereSpec {
        /// Radius, SI unit m.
        pub radius: Quantity<Length>,
        /// Elements along a quarter of a great circle.
        pub elements: usize,
    }

    /// A box cut into hexahedra, each of them into six tetrahedra where the kind of its elements is one of these.
    pub struct GridSpec {
        /// Lower corner, SI unit m; the origin where not written.
        pub corner: Option<Point>,
        /// Edge lengths along x, y, z, SI unit m.
        pub size: Point,
        /// Elements along x, y, z: a number, or a list of layers.
        pub elements: [DivisionSpec; 3],
    }
}

/// Division of a direction of a box.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum DivisionSpec {
    /// This many equal elements.
    Equal(usize),
    /// Layers from the lower face to the upper one, whose thicknesses add up to the size of the box.
    Layers(Vec<LayerSpec>),
}

objects! {
    /// A layer of a box.
    pub struct LayerSpec {
        /// Thickness, SI unit m.
        pub thickness: Quantity<Length>,
        /// Elements through the thickness.
        pub elements: usize,
        /// Name of the region that the layer belongs to; in one direction only, and there for every layer.
        pub region: Option<String>,
    }

    /// An electrode: nodes of one potential, at exactly one of `face`, `plane`, `box`.
    ///
    /// Driven electrodes of one name are connected: they share the voltage `block.name`.
    pub struct ElectrodeSpec {
        /// Name, unique in the block except for driven electrodes.
        pub name: String,
        /// All nodes of a face.
        pub face: Option<String>,
        /// All nodes of a plane.
        pub plane: Option<PlaneSpec>,
        /// All nodes in a box.
        #[serde(rename = "box")]
        pub cuboid: Option<CornersSpec>,
        /// Its potential.
        pub potential: PotentialSpec,
        /// Circuit between its source and a driven electrode.
        pub circuit: Option<CircuitSpec>,
    }

    /// A plane at right angles to an axis: exactly one of the three.
    pub struct PlaneSpec {
        /// Place along x, SI unit m.
        pub x: Option<Quantity<Length>>,
        /// Place along y, SI unit m.
        pub y: Option<Quantity<Length>>,
        /// Place along z, SI unit m.
        pub z: Option<Quantity<Length>>,
    }
}

/// The potential of an electrode.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PotentialSpec {
    /// Zero.
    Grounded,
    /// Whatever makes the charge vanish.
    Floating,
    /// The voltage `block.electrode` of the problem.
    Driven,
    /// This one, SI unit V.
    Given(Quantity<Voltage>),
}

objects! {
    /// Electrodes at all boundaries of equal layers, both ends included: grounded, driven, grounded…
    pub struct StackSpec {
        /// Direction across the layers.
        pub axis: AxisName,
        /// Number of layers, a divisor of the elements along the axis.
        pub layers: usize,
        /// Name of the driven electrodes, whose voltage is `block.name`.
        pub name: String,
        /// Circuit between their source and the driven electrodes.
        pub circuit: Option<CircuitSpec>,
    }

    /// An axis of the ground frame.
    pub enum AxisName {
        /// The first.
        X,
        /// The second.
        Y,
        /// The third.
        Z,
    }

    /// A face that is clamped, or a place that is held in some directions.
    pub either FixedSpec("the name of a face, or an object with \"face\" and \"directions\"") {
        /// Held in all directions.
        Clamped: String,
        /// Held in some.
        Held: Box<HeldSpec>,
    }

    /// A `face`, `plane` or `box` whose nodes are held in some directions: a roller is held in one.
    pub struct HeldSpec {
        /// All nodes of a face.
        pub face: Option<String>,
        /// All nodes of a plane.
        pub plane: Option<PlaneSpec>,
        /// All nodes in a box.
        #[serde(rename = "box")]
        pub cuboid: Option<CornersSpec>,
        /// Directions in which it is held; all three where not written.
        pub directions: Option<Vec<AxisName>>,
    }

    /// A velocity v = v₀ + ω × (X − c) + diag(rate) (X − c) at the start.
    pub struct VelocitySpec {
        /// v₀, SI unit m/s.
        pub linear: Option<[Quantity<Velocity>; 3]>,
        /// ω, SI unit rad/s.
        pub angular: Option<[Quantity<AngularVelocity>; 3]>,
        /// c, SI unit m; the middle of the block where not written.
        pub centre: Option<Point>,
        /// Rate of stretch along x, y, z, SI unit 1/s.
        pub stretch_rate: Option<[Quantity<Rate>; 3]>,
    }

    /// Circuit between a source and the electrodes of a muscle or a block: a resistor, a leak or both.
    pub struct CircuitSpec {
        /// Resistance in series, SI unit Ohm; without it the electrodes have the voltage of the source.
        pub resistance: Option<Quantity<Resistance>>,
        /// Resistance of a leak parallel to the electrodes, SI unit Ohm.
        pub leakage: Option<Quantity<Resistance>>,
    }
}

impl AxisName {
    /// Index of the coordinate.
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

impl CircuitSpec {
    /// The circuit.
    pub(crate) fn circuit(&self) -> Circuit {
        let of = |part: &Option<Quantity<Resistance>>| part.as_ref().map(Quantity::value);
        Circuit {
            resistance: of(&self.resistance),
            leakage: of(&self.leakage),
        }
    }
}

impl<'de> Deserialize<'de> for DivisionSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DivisionVisitor)
    }
}

struct DivisionVisitor;

impl<'de> Visitor<'de> for DivisionVisitor {
    type Value = DivisionSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number of elements or a list of layers")
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<DivisionSpec, E> {
        let number = usize::try_from(number);
        number.map(DivisionSpec::Equal).map_err(|_| {
            let found = Unexpected::Other("a number beyond counting");
            E::invalid_value(found, &self)
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, layers: A) -> Result<DivisionSpec, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(layers)).map(DivisionSpec::Layers)
    }
}
