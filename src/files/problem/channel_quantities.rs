//! Quantities that columns of recordings measure: places, forces, charges, currents and voltages.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_identify::MeasuredSpec;
use crate::files::problem::state::{driven, joint_with_coordinate, moving_marker};
use crate::files::scene::names::names;
use crate::files::scene::point::unit_axis;
use crate::files::units::quantity::{
    Angle, AngularVelocity, Charge, Current, Force, Kind, Length, Power, Torque, Velocity, Voltage,
};
use crate::functional::Stencil;
use crate::math::Vector;
use crate::model::system::{Fidelity, System};
use crate::model::{Pulling, Quantity, Reaction, joint_unit};

/// A measured quantity: what it is of, what it is called, its parts, and its unit.
pub(super) struct What {
    pub(super) of: String,
    pub(super) name: String,
    pub(super) parts: Vec<(f64, Quantity)>,
    pub(super) kind: Kind,
    pub(super) unit: (&'static str, f64),
}

/// Possible quantities by their keys, each with its key.
macro_rules! keys {
    ($spec:ident, $($key:ident: $make:expr;)*) => {
        [$((
            stringify!($key),
            $spec.$key.as_ref().map(|name| (stringify!($key), name, $make as Make)),
        ),)*]
    };
}

/// Makes the quantity of a name, which stands at the scope with its directions.
type Make = fn(&str, &MeasuredSpec, &System, [&Scope<'_>; 2]) -> Result<What, SceneError>;

impl What {
    /// The quantity that is written.
    pub(super) fn new(
        spec: &MeasuredSpec,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Self, SceneError> {
        let (key, name, make) = scope.exactly_one(keys! { spec,
            joint: joint;
            joint_rate: joint_rate;
            marker: marker;
            tension: tension;
            charge: charge;
            current: current;
            power: power;
            voltage: voltage;
            reaction_force: reaction_force;
            reaction_torque: reaction_torque;
        })?;
        let directions = [
            ("along", spec.along, ["marker", "reaction_force"]),
            ("about", spec.about, ["reaction_torque"; 2]),
        ];
        for (direction, written, of) in directions {
            if written.is_some() && !of.contains(&key) {
                let expected = format!("a direction of a {:?} alone", of[0]);
                return Err(scope.key(direction).wrong("a direction", expected));
            }
        }
        make(name, spec, system, [&scope.key(key), scope])
    }

    /// A quantity as it is, of a kind with an SI unit.
    fn plain(of: &str, name: String, quantity: Quantity, (kind, unit): (Kind, SiUnit)) -> Self {
        Self {
            of: of.to_owned(),
            name,
            parts: vec![(1.0, quantity)],
            kind,
            unit,
        }
    }

    /// The same, called by a word and the name of what it is of.
    fn named(word: &str, of: &str, quantity: Quantity, unit: (Kind, SiUnit)) -> Self {
        Self::plain(of, format!("{word} of {of}"), quantity, unit)
    }
}

/// Symbol and factor.
type SiUnit = (&'static str, f64);

fn joint(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let joint = joint_with_coordinate(name, system, place)?;
    let unit = match joint_unit(system, joint) {
        "mm" => (Length::kind(), ("m", 1e-3)),
        _ => (Angle::kind(), ("rad", 1.0)),
    };
    let quantity = Quantity::Joint { joint, near: 0.0 };
    Ok(What::plain(name, name.to_owned(), quantity, unit))
}

fn joint_rate(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let joint = joint_with_coordinate(name, system, place)?;
    let unit = match joint_unit(system, joint) {
        "mm" => (Velocity::kind(), ("m/s", 1.0)),
        _ => (AngularVelocity::kind(), ("rad/s", 1e3)),
    };
    let quantity = Quantity::joint_rate(joint);
    Ok(What::named("rate", name, quantity, unit))
}

fn marker(
    name: &str,
    spec: &MeasuredSpec,
    system: &System,
    [place, scope]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let marker = moving_marker(name, system, place)?;
    let along = written_direction(spec.along, &scope.key("along"))?;
    let part = |(axis, a): (usize, &f64)| (*a, Quantity::marker_place(marker, axis));
    let along = along.iter().enumerate().filter(|(_, a)| **a != 0.0);
    Ok(What {
        of: name.to_owned(),
        name: name.to_owned(),
        parts: along.map(part).collect(),
        kind: Length::kind(),
        unit: ("m", 1e-3),
    })
}

/// Force with which a muscle, a spring or a tendon pulls its ends together.
fn tension(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    const EXPECTED: &str = "the name of a lumped muscle, a spring or a tendon";
    let components = &system.components;
    let muscles = system.muscles.iter().enumerate().map(|(m, muscle)| {
        let is_meshed = muscle.fidelity != Fidelity::Lumped;
        let without = is_meshed.then_some("a muscle of finite elements, whose forces act on faces");
        (&muscle.name, Quantity::tension(m), without)
    });
    let springs = components.springs.iter().enumerate().map(|(s, spring)| {
        let is_slack = spring.stiffness.is_none() && spring.damping.is_none();
        let without = is_slack.then_some("a spring without stiffness and damping");
        (
            &spring.name,
            Quantity::PullStep(Pulling::Spring(s)),
            without,
        )
    });
    let tendons = components.tendons.iter().enumerate();
    let tendons = tendons.map(|(t, one)| (&one.name, Quantity::PullStep(Pulling::Tendon(t)), None));
    let mut parts: Vec<_> = muscles.chain(springs).chain(tendons).collect();
    let names: Vec<String> = parts.iter().map(|(name, ..)| (*name).clone()).collect();
    let (_, quantity, without) = parts.swap_remove(place.find(name, &names, EXPECTED)?);
    if let Some(without) = without {
        return Err(place.wrong(format!("{name:?}, {without}"), EXPECTED));
    }
    let unit = (Force::kind(), ("N", 1.0));
    Ok(What::named("tension", name, quantity, unit))
}

/// A source, whether it charges a lumped muscle, and whether a resistor lies between.
struct Charging {
    source: usize,
    is_lumped: bool,
    is_behind_resistor: bool,
}

impl Charging {
    fn new(name: &str, system: &System, place: &Scope<'_>) -> Result<Self, SceneError> {
        let source = driven(name, &system.sources(), place)?;
        let muscle = system.muscles.get(source);
        let muscle = muscle.filter(|muscle| muscle.fidelity == Fidelity::Lumped);
        Ok(Self {
            source,
            is_lumped: muscle.is_some(),
            is_behind_resistor: match muscle {
                Some(muscle) => muscle.is_behind_resistor(),
                None => system.has_electrodes_behind_resistor(source),
            },
        })
    }
}

/// Needs of finite elements, for messages.
const OF_ELEMENTS: [&str; 2] = [
    "which drives finite elements without a resistor",
    "a lumped muscle, or electrodes with a \"resistance\" in their \"circuit\"",
];

fn charge(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let of = Charging::new(name, system, place)?;
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Quantity::Charge { source: of.source },
        (false, true) => Quantity::MeanCharge { muscle: of.source },
        (false, false) => {
            let [why, expected] = OF_ELEMENTS;
            return Err(place.wrong(format!("{name:?}, {why}"), expected));
        }
    };
    let unit = (Charge::kind(), ("C", 1e-3));
    Ok(What::named("charge", name, quantity, unit))
}

/// Current of a source: through a resistor, or that of the changing charge.
fn current(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let of = Charging::new(name, system, place)?;
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Quantity::SourceCurrent {
            muscle: of.source,
            unit: 1.0,
        },
        (false, true) if system.muscles[of.source].has_measured_current() => Quantity::ChargeStep {
            muscle: of.source,
            unit: 1.0,
            h: 1.0,
        },
        (false, is_lumped) => {
            let [why, expected] = match is_lumped {
                true => [
                    "which leaks and has no resistor",
                    "a muscle without a \"circuit\", or with a \"resistance\" in it",
                ],
                false => OF_ELEMENTS,
            };
            return Err(place.wrong(format!("{name:?}, {why}"), expected));
        }
    };
    let unit = (Current::kind(), ("A", 1.0));
    Ok(What::named("current", name, quantity, unit))
}

/// Electrical power of the source of a muscle.
fn power(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let of = Charging::new(name, system, place)?;
    if !(of.is_lumped && of.is_behind_resistor) {
        let found = format!("{name:?}, which is no lumped muscle behind a resistor");
        let expected = "a lumped muscle with a \"resistance\" in its \"circuit\"";
        return Err(place.wrong(found, expected));
    }
    let quantity = Quantity::SourcePower {
        muscle: of.source,
        unit: 1.0,
    };
    let unit = (Power::kind(), ("W", 1.0));
    Ok(What::named("power", name, quantity, unit))
}

/// Voltage of electrodes that is not given.
fn voltage(
    name: &str,
    _: &MeasuredSpec,
    system: &System,
    [place, _]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let of = Charging::new(name, system, place)?;
    if !of.is_behind_resistor {
        let found = format!("{name:?}, whose electrodes have the voltage that is given");
        let expected = "a source with a \"resistance\" in its \"circuit\"";
        return Err(place.wrong(found, expected));
    }
    let quantity = Quantity::ElectrodeVoltage { source: of.source };
    let unit = (Voltage::kind(), ("V", 1.0));
    Ok(What::named("voltage", name, quantity, unit))
}

fn reaction_force(
    name: &str,
    spec: &MeasuredSpec,
    system: &System,
    scopes: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let unit = (Force::kind(), ("N", 1.0));
    let of = (Reaction::Force, "force", unit);
    reaction((name, of), ("along", spec.along), system, scopes)
}

fn reaction_torque(
    name: &str,
    spec: &MeasuredSpec,
    system: &System,
    scopes: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let unit = (Torque::kind(), ("N m", 1e-3));
    let of = (Reaction::Torque, "torque", unit);
    reaction((name, of), ("about", spec.about), system, scopes)
}

/// Force or torque, by its word, that a joint transmits along a direction.
fn reaction(
    (name, (of, word, unit)): (&str, (Reaction, &str, (Kind, SiUnit))),
    (key, direction): (&str, Option<[f64; 3]>),
    system: &System,
    [place, scope]: [&Scope<'_>; 2],
) -> Result<What, SceneError> {
    let joints = names(&system.joints, |joint| &joint.name);
    let joint = place.find(name, &joints, "the name of a joint")?;
    if of == Reaction::Torque && !system.joints[joint].has_torque() {
        let found = format!("{name:?}, a spherical joint");
        return Err(place.wrong(found, "a joint that transmits a torque"));
    }
    let place = scope.key(key);
    let quantity = Quantity::ReactionStep {
        joint,
        of,
        along: written_direction(direction, &place)?,
        at: Stencil::Here,
        unit: 1.0,
        h: 1.0,
    };
    Ok(What::named(word, name, quantity, unit))
}

/// The unit vector of a direction that has to be written.
fn written_direction(direction: Option<[f64; 3]>, place: &Scope<'_>) -> Result<Vector, SceneError> {
    let Some(direction) = direction else {
        let expected = "a direction, such as [1, 0, 0]";
        return Err(place.wrong("no direction", expected));
    };
    unit_axis(&direction, place)
}
