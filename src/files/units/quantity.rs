//! Quantities as written in JSON: numbers in SI units or strings with a unit, converted once to g, mm, ms, N, MPa, V.

use crate::files::json::either::Scalar;
use crate::files::units::unit::{Dimension, Unit, Written, parts, scale};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;
use std::sync::LazyLock;

/// A kind of quantity: its name, an example, and the units it is written in.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Name with article: `a length`.
    pub name: &'static str,
    /// Example with quotes: `"50 mm"`.
    pub example: &'static str,
    /// Units of the accepted dimensions, the coherent one first; they differ in powers of the radian only.
    units: &'static [&'static str],
    dimensions: Vec<Dimension>,
}

impl Kind {
    fn new(name: &'static str, example: &'static str, units: &'static [&'static str]) -> Self {
        let dimension = |unit: &&str| Unit::parse(unit).unwrap_or(Unit::ONE).dimension;
        Self {
            name,
            example,
            units,
            dimensions: units.iter().map(dimension).collect(),
        }
    }

    /// Name and example, for messages.
    pub fn expected(&self) -> String {
        format!("{}, such as {}", self.name, self.example)
    }

    /// Returns true if a unit of this dimension is one of this kind.
    pub(crate) fn is_in(&self, dimension: Dimension) -> bool {
        self.dimensions.contains(&dimension)
    }

    /// Symbol of the SI unit; empty of a plain number.
    pub(crate) fn symbol(&self) -> &'static str {
        self.units[0]
    }

    /// The SI unit, and its factor from the unit inside.
    pub(crate) fn unit(&self) -> (&'static str, f64) {
        let factor = scale(1.0, -self.dimensions[0].internal_exponent());
        (self.symbol(), factor)
    }

    /// Symbol of its SI unit of this dimension.
    fn symbol_of(&self, dimension: Dimension) -> Option<&'static str> {
        let own = self.dimensions.iter().position(|one| *one == dimension)?;
        Some(self.units[own])
    }
}

/// Description of quantities in the JSON Schema, before the kind.
pub(crate) const WRITTEN: &str = "A number in SI units or a text with a unit: ";

/// Quantity that a [`Quantity`] measures.
pub trait PhysicalQuantity {
    /// Name of the measure in the JSON Schema.
    const NAME: &'static str;

    /// The accepted kinds: one, or two where a joint decides.
    fn kinds() -> &'static [Kind];
}

/// Declares measures: of one kind by its units in the International System, name and example, or of several kinds.
macro_rules! measures {
    ($($(#[$doc:meta])* $measure:ident: $units:expr, $name:literal, $example:literal;)*) => {
        $(
            impl $measure {
                /// The one kind of this measure.
                pub fn kind() -> Kind {
                    Self::kinds()[0].clone()
                }
            }
        )*

        measures! { $($(#[$doc])* $measure = vec![Kind::new($name, $example, &$units)];)* }

        /// Every kind that has a name.
        fn named_kinds() -> impl Iterator<Item = &'static Kind> {
            [$($measure::kinds()),*].into_iter().flatten()
        }
    };
    ($($(#[$doc:meta])* $measure:ident: $($kind:ident)|+;)*) => {
        measures! { $($(#[$doc])* $measure = [$($kind::kinds()),+].concat();)* }
    };
    ($($(#[$doc:meta])* $measure:ident = $kinds:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct $measure;

        impl PhysicalQuantity for $measure {
            const NAME: &'static str = stringify!($measure);

            fn kinds() -> &'static [Kind] {
                static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| $kinds);
                &KINDS
            }
        }
    )*};
}

measures! {
    /// Length: m, mm inside.
    Length: ["m"], "a length", "\"50 mm\"";
    /// Mass: kg, g inside.
    Mass: ["kg"], "a mass", "\"30 g\"";
    /// Time: s, ms inside.
    Time: ["s"], "a time", "\"10 ms\"";
    /// Voltage: V.
    Voltage: ["V"], "a voltage", "\"1.7 kV\"";
    /// Angle: rad.
    Angle: ["rad"], "an angle", "\"0.3 rad\" or \"17 deg\"";
    /// Stress or elastic modulus: Pa, MPa inside.
    Stress: ["Pa"], "a stress", "\"100 kPa\"";
    /// Density: kg/m³, g/mm³ inside.
    Density: ["kg/m^3"], "a density", "\"1000 kg/m^3\"";
    /// Viscosity: Pa s, MPa ms inside.
    Viscosity: ["Pa s"], "a viscosity", "\"1000 Pa s\"";
    /// Permittivity: F/m, N/V² inside.
    Permittivity: ["F/m"], "a permittivity", "\"8.854e-12 F/m\"";
    /// Electric field: V/m, V/mm inside.
    ElectricField: ["V/m"], "an electric field", "\"80 V/um\"";
    /// Acceleration: m/s², mm/ms² inside.
    Acceleration: ["m/s^2"], "an acceleration", "\"9.81 m/s^2\"";
    /// Velocity: m/s, mm/ms inside.
    Velocity: ["m/s"], "a velocity", "\"0.2 m/s\"";
    /// Angular velocity: rad/s, rad/ms inside.
    AngularVelocity: ["rad/s"], "an angular velocity", "\"2 rad/s\"";
    /// Rate of a stretch: 1/s, 1/ms inside.
    Rate: ["1/s"], "a rate", "\"25 1/s\"";
    /// Frequency: Hz, kHz inside.
    Frequency: ["Hz"], "a frequency", "\"20 Hz\"";
    /// Moment of inertia: kg m², g mm² inside.
    MomentOfInertia: ["kg m^2"], "a moment of inertia", "\"9.25e-6 kg m^2\"";
    /// Damping of a rotation: N m s/rad, N mm ms inside.
    RotationalDamping: ["N m s", "N m s/rad"], "a rotational damping", "\"1e-4 N m s/rad\"";
    /// Stiffness of a rotation: N m/rad, N mm/rad inside.
    RotationalStiffness: ["N m", "N m/rad"], "a rotational stiffness", "\"0.2 N m/rad\"";
    /// Damping of a translation: N s/m, N ms/mm inside.
    Damping: ["N s/m"], "a damping", "\"0.5 N s/m\"";
    /// Stiffness of a spring: N/m, N/mm inside.
    Stiffness: ["N/m"], "a stiffness", "\"200 N/m\"";
    /// Ratio: a plain number.
    Ratio: [""], "a plain number", "3.2";
    /// Force: N.
    Force: ["N"], "a force", "\"1 N\"";
    /// Volume: m³, mm³ inside.
    Volume: ["m^3"], "a volume", "\"48 cm^3\"";
    /// Area, for messages.
    Area: ["m^2"], "an area", "\"1 mm^2\"";
    /// Energy, for messages.
    Energy: ["N m"], "an energy", "\"1 mJ\"";
    /// Torque: N m, N mm inside.
    Torque: ["N m"], "a torque", "\"0.2 N m\"";
    /// Force for a volume: N/m³, N/mm³ inside.
    ForceDensity: ["N/m^3"], "a force for a volume", "\"10 kN/m^3\"";
    /// Charge for an area: C/m², mC/mm² inside.
    ChargeDensity: ["C/m^2"], "a charge for an area", "\"0.2 mC/m^2\"";
    /// Charge: C, mC inside.
    Charge: ["C"], "a charge", "\"0.5 uC\"";
    /// Electric current: A.
    Current: ["A"], "a current", "\"1 mA\"";
    /// Power: W.
    Power: ["W"], "a power", "\"0.5 W\"";
    /// Rate of a voltage: V/s, V/ms inside.
    VoltageRate: ["V/s"], "a rate of a voltage", "\"10 kV/s\"";
    /// Electrical resistance: Ω.
    Resistance: ["Ohm"], "a resistance", "\"10 MOhm\"";
}

measures! {
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

measures! {
    /// A constant that an optimisation seeks, of the kind of its place in the scene.
    SoughtConstant = named_kinds().cloned().collect();
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
        .find(|kind| kind.is_in(dimension))
        .map_or_else(
            || match dimension.to_string() {
                unit if unit.is_empty() => "a plain number".to_owned(),
                unit => format!("a quantity in {unit}"),
            },
            |kind| kind.name.to_owned(),
        )
}

/// Value and unit in the International System of a text such as `80 kPa`; none where it is no number with a unit.
pub(crate) fn si(text: &str) -> Option<(f64, String)> {
    let (
        number,
        Unit {
            factor,
            exponent,
            dimension,
        },
    ) = parts(text).ok()?;
    let symbol = named_kinds().find_map(|kind| kind.symbol_of(dimension));
    let symbol = symbol.map_or_else(|| dimension.to_string(), str::to_owned);
    Some((scale(number * factor, exponent), symbol))
}
