//! Quantities as written in JSON: numbers in SI units or strings with a unit, converted once to g, mm, ms, N, MPa, V.

use crate::files::json::either::Scalar;
use crate::files::units::unit::{Dimension, Unit, Written, parts, scale, symbol};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use uom::si;
use uom::si::ISQ;
use uom::typenum::{N1, N2, N4, P1, P2, Z0};

/// A kind of quantity: its name, an example, and the dimensions it is written in.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Name with article: `a length`.
    pub name: &'static str,
    /// Example with quotes: `"50 mm"`.
    pub example: &'static str,
    /// Accepted dimensions, the coherent one first; they differ in powers of the radian only.
    dimensions: Vec<Dimension>,
}

impl Kind {
    /// Name and example, for messages.
    pub fn expected(&self) -> String {
        format!("{}, such as {}", self.name, self.example)
    }

    /// Returns true if a unit of this dimension is one of this kind.
    pub(crate) fn is_in(&self, dimension: Dimension) -> bool {
        self.dimensions.contains(&dimension)
    }

    /// Symbol of the SI unit; empty of a plain number.
    pub(crate) fn symbol(&self) -> String {
        symbol(self.dimensions[0])
    }
}

/// Description of quantities in the JSON Schema, before the kind.
pub(crate) const WRITTEN: &str = "A number in SI units or a text with a unit: ";

/// Quantity that a [`Quantity`] measures.
pub trait PhysicalQuantity {
    /// Name of the measure in the JSON Schema.
    const NAME: &'static str;

    /// The accepted kinds: one, or two where a joint decides.
    fn kinds() -> Vec<Kind>;
}

/// Declares measures by the dimension of uom, powers of the radian, name and example.
macro_rules! measures {
    ($($(#[$doc:meta])* $measure:ident: $dimension:ty, $radians:expr, $name:literal, $example:literal;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $measure;

            impl $measure {
                /// The one kind of this measure.
                pub fn kind() -> Kind {
                    let dimension = Dimension::of::<$dimension>();
                    let dimensions = $radians.into_iter().map(|radian| dimension.radians(radian)).collect();
                    Kind { name: $name, example: $example, dimensions }
                }
            }

            impl PhysicalQuantity for $measure {
                const NAME: &'static str = stringify!($measure);

                fn kinds() -> Vec<Kind> {
                    vec![Self::kind()]
                }
            }
        )*

        /// Every kind that has a name.
        fn named_kinds() -> Vec<Kind> {
            vec![$($measure::kind()),*]
        }
    };
}

measures! {
    /// Length: m, mm inside.
    Length: si::length::Dimension, [0], "a length", "\"50 mm\"";
    /// Mass: kg, g inside.
    Mass: si::mass::Dimension, [0], "a mass", "\"30 g\"";
    /// Time: s, ms inside.
    Time: si::time::Dimension, [0], "a time", "\"10 ms\"";
    /// Voltage: V.
    Voltage: si::electric_potential::Dimension, [0], "a voltage", "\"1.7 kV\"";
    /// Angle: rad.
    Angle: si::angle::Dimension, [1], "an angle", "\"0.3 rad\" or \"17 deg\"";
    /// Stress or elastic modulus: Pa, MPa inside.
    Stress: si::pressure::Dimension, [0], "a stress", "\"100 kPa\"";
    /// Density: kg/m³, g/mm³ inside.
    Density: si::mass_density::Dimension, [0], "a density", "\"1000 kg/m^3\"";
    /// Viscosity: Pa s, MPa ms inside.
    Viscosity: si::dynamic_viscosity::Dimension, [0], "a viscosity", "\"1000 Pa s\"";
    /// Permittivity: F/m, N/V² inside.
    Permittivity: si::electric_permittivity::Dimension, [0], "a permittivity", "\"8.854e-12 F/m\"";
    /// Electric field: V/m, V/mm inside.
    ElectricField: si::electric_field::Dimension, [0], "an electric field", "\"80 V/um\"";
    /// Acceleration: m/s², mm/ms² inside.
    Acceleration: si::acceleration::Dimension, [0], "an acceleration", "\"9.81 m/s^2\"";
    /// Velocity: m/s, mm/ms inside.
    Velocity: si::velocity::Dimension, [0], "a velocity", "\"0.2 m/s\"";
    /// Angular velocity: rad/s, rad/ms inside.
    AngularVelocity: si::angular_velocity::Dimension, [1], "an angular velocity", "\"2 rad/s\"";
    /// Rate of a stretch: 1/s, 1/ms inside.
    Rate: si::frequency::Dimension, [0], "a rate", "\"25 1/s\"";
    /// Moment of inertia: kg m², g mm² inside.
    MomentOfInertia: si::moment_of_inertia::Dimension, [0], "a moment of inertia", "\"9.25e-6 kg m^2\"";
    /// Damping of a rotation: N m s/rad, N mm ms inside.
    RotationalDamping: si::angular_momentum::Dimension, [0, -1], "a rotational damping", "\"1e-4 N m s/rad\"";
    /// Stiffness of a rotation: N m/rad, N mm/rad inside.
    RotationalStiffness: si::energy::Dimension, [0, -1], "a rotational stiffness", "\"0.2 N m/rad\"";
    /// Damping of a translation: N s/m, N ms/mm inside.
    Damping: si::mass_rate::Dimension, [0], "a damping", "\"0.5 N s/m\"";
    /// Stiffness of a spring: N/m, N/mm inside.
    Stiffness: si::surface_tension::Dimension, [0], "a stiffness", "\"200 N/m\"";
    /// Ratio: a plain number.
    Ratio: si::ratio::Dimension, [0], "a plain number", "3.2";
    /// Force: N.
    Force: si::force::Dimension, [0], "a force", "\"1 N\"";
    /// Volume: m³, mm³ inside.
    Volume: si::volume::Dimension, [0], "a volume", "\"48 cm^3\"";
    /// Area, for messages.
    Area: si::area::Dimension, [0], "an area", "\"1 mm^2\"";
    /// Energy, for messages.
    Energy: si::energy::Dimension, [0], "an energy", "\"1 mJ\"";
    /// Torque: N m, N mm inside.
    Torque: si::energy::Dimension, [0], "a torque", "\"0.2 N m\"";
    /// Force for a volume: N/m³, N/mm³ inside.
    ForceDensity: Weight, [0], "a force for a volume", "\"10 kN/m^3\"";
    /// Charge for an area: C/m², mC/mm² inside.
    ChargeDensity: si::electric_charge_areal_density::Dimension, [0], "a charge for an area", "\"0.2 mC/m^2\"";
    /// Charge: C, mC inside.
    Charge: si::electric_charge::Dimension, [0], "a charge", "\"0.5 uC\"";
    /// Electric current: A.
    Current: si::electric_current::Dimension, [0], "a current", "\"1 mA\"";
    /// Power: W.
    Power: si::power::Dimension, [0], "a power", "\"0.5 W\"";
    /// Rate of a voltage: V/s, V/ms inside.
    VoltageRate: VoltageRateDimension, [0], "a rate of a voltage", "\"10 kV/s\"";
    /// Electrical resistance: Ω.
    Resistance: si::electrical_resistance::Dimension, [0], "a resistance", "\"10 MOhm\"";
}

/// Declares measures of several kinds; of joints an angular and a linear one.
macro_rules! either_measures {
    ($($(#[$doc:meta])* $measure:ident: $($kind:ident)|+;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $measure;

            impl PhysicalQuantity for $measure {
                const NAME: &'static str = stringify!($measure);

                fn kinds() -> Vec<Kind> {
                    vec![$($kind::kind()),+]
                }
            }
        )*
    };
}

either_measures! {
    /// Joint coordinate: an angle, or a length of a prismatic joint.
    JointCoordinate: Angle | Length;
    /// Rate of a joint coordinate: an angular velocity, or a velocity of a prismatic joint.
    JointRate: AngularVelocity | Velocity;
    /// Damping of a joint coordinate: rotational, or linear of a prismatic joint.
    JointDamping: RotationalDamping | Damping;
    /// Stiffness of a joint coordinate: rotational, or linear of a prismatic joint.
    JointStiffness: RotationalStiffness | Stiffness;
    /// Size of a load, whose kind the scene says.
    LoadSize: Torque | Force | Stress | ForceDensity | ChargeDensity | Charge;
    /// Size of a measured quantity, whose kind the quantity says.
    MeasuredSize: Length | Angle | Velocity | AngularVelocity | Force | Torque | Charge | Current | Power | Voltage;
}

/// A constant that an optimisation seeks, of the kind of its place in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoughtConstant;

impl PhysicalQuantity for SoughtConstant {
    const NAME: &'static str = "SoughtConstant";

    fn kinds() -> Vec<Kind> {
        named_kinds()
    }
}

/// A finite quantity of one of the kinds of a [`PhysicalQuantity`].
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity<M> {
    written: Written,
    measure: PhantomData<M>,
}

impl<M: PhysicalQuantity> Quantity<M> {
    /// A number in SI units; the error names the value found instead.
    pub(crate) fn try_from_number(number: f64) -> Result<Self, String> {
        Self {
            written: Written::Number(number),
            measure: PhantomData,
        }
        .checked()
    }

    /// Reads a text such as `50 mm`; the error names the value found instead.
    ///
    /// # Errors
    /// The text is no number with a unit that is known here.
    pub fn try_from_text(text: &str) -> Result<Self, String> {
        let (_, unit) = parts(text)?;
        if !M::kinds().iter().any(|kind| kind.is_in(unit.dimension)) {
            return Err(format!("{text:?}, which is {}", describe(unit.dimension)));
        }
        Self {
            written: Written::Text(text.into()),
            measure: PhantomData,
        }
        .checked()
    }

    /// A finite value that stays finite in the units inside.
    fn checked(self) -> Result<Self, String> {
        let finite = |kind: &Kind| self.converted(kind).is_finite();
        if M::kinds().iter().all(finite) {
            Ok(self)
        } else {
            Err(format!("{self}, which is not finite"))
        }
    }

    fn converted(&self, kind: &Kind) -> f64 {
        let (number, unit) = self.written.parts();
        let unit = unit.unwrap_or(Unit::ONE);
        let exponent = unit.exponent + kind.dimensions[0].internal_exponent();
        scale(number * unit.factor, exponent)
    }

    /// Value in units of the International System.
    pub(crate) fn si(&self) -> f64 {
        let (number, unit) = self.written.parts();
        let unit = unit.unwrap_or(Unit::ONE);
        scale(number * unit.factor, unit.exponent)
    }

    /// Value in the units inside, of the only kind of this measure.
    pub fn value(&self) -> f64 {
        self.converted(&M::kinds()[0])
    }

    /// Value in the units inside, where one is written; zero leaves no trace.
    pub(crate) fn present(written: &Option<Self>) -> Option<f64> {
        let value = written.as_ref().map(Self::value);
        value.filter(|value| *value != 0.0)
    }

    /// Value in the units inside, read as one kind; the error names the value found instead.
    ///
    /// # Errors
    /// Its unit is of another kind.
    pub fn value_as(&self, kind: &Kind) -> Result<f64, String> {
        let (_, unit) = self.written.parts();
        match unit {
            Some(unit) if !kind.is_in(unit.dimension) => {
                Err(format!("{self}, which is {}", describe(unit.dimension)))
            }
            _ => Ok(self.converted(kind)),
        }
    }

    /// Dimension of its unit, where it is written with one.
    pub(crate) fn dimension(&self) -> Option<Dimension> {
        let (_, unit) = self.written.parts();
        unit.map(|unit| unit.dimension)
    }

    /// Kinds and examples, for messages.
    pub(crate) fn expected() -> String {
        let kinds: Vec<String> = M::kinds().iter().map(Kind::expected).collect();
        kinds.join(", or ")
    }
}

impl Quantity<Length> {
    /// A finite length of this many mm, written with its unit.
    pub(crate) fn millimetres(value: f64) -> Self {
        // Adding zero turns −0 into 0.
        let number = value + 0.0;
        Self {
            written: Written::Text(format!("{number} mm").into()),
            measure: PhantomData,
        }
    }
}

impl<M> fmt::Display for Quantity<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.written {
            Written::Number(number) => write!(f, "{number}"),
            Written::Text(text) => write!(f, "{text:?}"),
        }
    }
}

impl<M> Serialize for Quantity<M> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.written {
            Written::Number(number) => serializer.serialize_f64(*number),
            Written::Text(text) => serializer.serialize_str(text),
        }
    }
}

impl<'de, M: PhysicalQuantity> Deserialize<'de> for Quantity<M> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Scalar {
            expected: Self::expected,
            number: Self::try_from_number,
            text: Self::try_from_text,
        })
    }
}

impl<M: PhysicalQuantity> JsonSchema for Quantity<M> {
    fn schema_name() -> Cow<'static, str> {
        M::NAME.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["number", "string"],
            "description": format!("{WRITTEN}{}.", Self::expected()),
        })
    }
}

/// Describes a quantity of this dimension in words.
pub(crate) fn describe(dimension: Dimension) -> String {
    named_kinds()
        .into_iter()
        .find(|kind| kind.is_in(dimension))
        .map_or_else(
            || match dimension.to_string() {
                unit if unit.is_empty() => "a plain number".to_owned(),
                unit => format!("a quantity in {unit}"),
            },
            |kind| kind.name.to_owned(),
        )
}

/// Of a force for a volume.
pub(super) type Weight = ISQ<N2, P1, N2, Z0, Z0, Z0, Z0>;

/// Of the rate of a voltage.
type VoltageRateDimension = ISQ<P2, P1, N4, N1, Z0, Z0, Z0>;
