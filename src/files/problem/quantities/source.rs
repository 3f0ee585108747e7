//! Voltages, charges, currents and powers of sources in limits, costs and recordings.

use crate::control::problem::{During, Limit, QuantityCost};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::quantities::entry::{
    All, CostEntry, LimitEntry, Named, Recorded, bounds, limits_of, square, weight,
};
use crate::files::problem::state::driven;
use crate::files::units::quantity::{
    Charge, Current, Power, Quantity as Written, Voltage, VoltageRate,
};
use crate::model::system::{Fidelity, Muscle, Source, System};
use crate::model::{MILLIAMPERE, Quantity, What};
use schemars::JsonSchema;
use serde::Deserialize;

/// Declares limits of one source (`"source": name`) or all (`"sources": "all"`): `min`, `max` or both.
macro_rules! source_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal, $limits:expr;)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Name of the source: that of its muscle or electrode.
                #[serde(default)]
                pub source: Option<String>,
                /// All sources.
                #[serde(default)]
                pub sources: Option<All>,
                #[doc = concat!("Lower bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub min: Option<Written<$measure>>,
                #[doc = concat!("Upper bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub max: Option<Written<$measure>>,
            }

            impl LimitEntry for $name {
                fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
                    let bounds = bounds([&self.min, &self.max], scope)?;
                    let chosen = Chosen { one: &self.source, all: self.sources };
                    $limits(chosen, bounds, system, scope)
                }
            }
        )*
    };
}

source_limits! {
    /// Limits of the current from one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both.
    ///
    /// Behind a resistor it is the mean current in each interval. Otherwise it is the charge that flows from the middle of an interval to that
    /// of the next one, where the voltage jumps too; from and to states of rest that are known it is that of half an interval.
    CurrentLimitSpec: Current, "A", |chosen, bounds, system, scope| {
        let sources = measured(&chosen, system, scope)?;
        Ok(limits_of(sources.into_iter().map(What::Current), bounds))
    };
    /// Limits of the power of one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both, at the
    /// times of a current.
    ///
    /// Without a resistor it is that of the stored energy and of the work on the motion, as in the table; losses of charging in steps do not
    /// count.
    PowerLimitSpec: Power, "W", |chosen, bounds, system, scope| {
        let sources = measured(&chosen, system, scope)?;
        Ok(limits_of(sources.into_iter().map(What::Power), bounds))
    };
    /// Limits of the rate of the voltage of one source (`"source": name`) or each (`"sources": "all"`) from interval to interval: `min`,
    /// `max` or both.
    VoltageRateLimitSpec: VoltageRate, "V/s", rates;
}

/// The current of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CurrentCostSpec {
    /// Name of the source: that of its muscle.
    #[serde(default)]
    pub source: Option<String>,
    /// All sources.
    #[serde(default)]
    pub sources: Option<All>,
    /// Current that is asked for, SI unit A; 0 where not written.
    #[serde(default)]
    pub at: Option<Written<Current>>,
    /// Weight of the squared deviation in mA²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The power of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PowerCostSpec {
    /// Name of the source: that of its muscle.
    #[serde(default)]
    pub source: Option<String>,
    /// All sources.
    #[serde(default)]
    pub sources: Option<All>,
    /// Power that is asked for, SI unit W; 0 where not written.
    #[serde(default)]
    pub at: Option<Written<Power>>,
    /// Weight of the squared deviation in W²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// Sources of which an entry speaks.
struct Chosen<'s> {
    one: &'s Option<String>,
    all: Option<All>,
}

impl Chosen<'_> {
    /// One source, or all that take a voltage, with the place where they are chosen.
    fn sources<'s>(
        &self,
        sources: &[Source],
        scope: &Scope<'s>,
    ) -> Result<(Vec<usize>, Scope<'s>)> {
        let one = self.one.as_ref().map(Some);
        match scope.exactly_one([("source", one), ("sources", self.all.map(|_| None))])? {
            Some(name) => {
                let place = scope.key("source");
                Ok((vec![driven(name, sources, &place)?], place))
            }
            None => {
                let takes = |&s: &usize| sources[s].takes_voltage;
                let all = (0..sources.len()).filter(takes);
                Ok((all.collect(), scope.key("sources")))
            }
        }
    }
}

/// Limits of the rates of voltages.
fn rates(
    chosen: Chosen<'_>,
    bounds: [f64; 2],
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Limit>> {
    let (sources, place) = chosen.sources(&system.sources(), scope)?;
    if sources.is_empty() {
        return Err(place.wrong("no source", "a source of a voltage"));
    }
    let limit = |source| Limit::of_rate(What::Voltage(source), bounds);
    Ok(sources.into_iter().map(limit).collect())
}

/// Muscles of whose sources current and power are known: all of them without such a muscle is none.
fn measured(of: &Chosen<'_>, system: &System, scope: &Scope<'_>) -> Result<Vec<usize>> {
    const EXPECTED: &str = "sources of lumped muscles with a permittivity: without a \"circuit\", or with a \"resistance\" in it";
    let sources = system.sources();
    let (chosen, place) = of.sources(&sources, scope)?;
    let obstacle = |s: usize| match system.muscles.get(s) {
        Some(muscle) if muscle.has_measured_current() => None,
        Some(muscle) if muscle.circuit.is_some() => Some("which leaks and has no resistor"),
        Some(_) => Some("a muscle of finite elements"),
        None => Some("which drives finite elements"),
    };
    if let Some((source, why)) = chosen.iter().find_map(|&s| Some((s, obstacle(s)?))) {
        let found = format!("{:?}, {why}", sources[source].name);
        return Err(place.wrong(found, EXPECTED));
    }
    match chosen.is_empty() {
        true => Err(place.wrong("no source", EXPECTED)),
        false => Ok(chosen),
    }
}

/// Muscles whose sources are behind a resistor.
fn behind_resistors(of: &Chosen<'_>, system: &System, scope: &Scope<'_>) -> Result<Vec<usize>> {
    let key = if of.one.is_some() {
        "source"
    } else {
        "sources"
    };
    let muscles = measured(of, system, scope)?;
    let jumps = |&&muscle: &&usize| !Muscle::is_behind_resistor(&system.muscles[muscle]);
    match muscles.iter().find(jumps) {
        None => Ok(muscles),
        Some(&muscle) => {
            let name = &system.muscles[muscle].name;
            let found =
                format!("{name:?}, without a resistor: its voltage jumps between intervals");
            let expected = "a muscle with a \"resistance\" in its \"circuit\"; otherwise \"rate\", \"electrical_energy\" or a limit";
            Err(scope.key(key).wrong(found, expected))
        }
    }
}

impl CostEntry for CurrentCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let at = self.at.as_ref();
        let at = at.map_or(0.0, |at| at.value() / MILLIAMPERE);
        let (one, all) = (&self.source, self.sources);
        let muscles = behind_resistors(&Chosen { one, all }, system, scope)?;
        let cost = |muscle| square(Quantity::current(muscle), at, weight, during);
        Ok(muscles.into_iter().map(cost).collect())
    }
}

impl CostEntry for PowerCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let at = self.at.as_ref().map_or(0.0, Written::value);
        let (one, all) = (&self.source, self.sources);
        let muscles = behind_resistors(&Chosen { one, all }, system, scope)?;
        let cost = |muscle| square(Quantity::power(muscle), at, weight, during);
        Ok(muscles.into_iter().map(cost).collect())
    }
}

/// A source, whether it charges a lumped muscle, and whether a resistor lies between.
struct Charging {
    source: usize,
    is_lumped: bool,
    is_behind_resistor: bool,
}

impl Charging {
    fn new(of: &Named<'_>) -> Result<Self> {
        let (name, system, place) = (of.name, of.system, of.place);
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

pub(super) fn charge(named: &Named<'_>) -> Result<Recorded> {
    let (name, place) = (named.name, named.place);
    let of = Charging::new(named)?;
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Quantity::of(What::Charge(of.source)),
        (false, true) => Quantity::of(What::MeanCharge(of.source)),
        (false, false) => {
            let [why, expected] = OF_ELEMENTS;
            return Err(place.wrong(format!("{name:?}, {why}"), expected));
        }
    };
    let unit = (Charge::kind(), ("C", 1e-3));
    Ok(Recorded::named("charge", name, quantity, unit))
}

/// Current of a source: through a resistor, or that of the changing charge.
pub(super) fn current(named: &Named<'_>) -> Result<Recorded> {
    let (name, place) = (named.name, named.place);
    let of = Charging::new(named)?;
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Quantity::of(What::Current(of.source)),
        (false, true) if named.system.muscles[of.source].has_measured_current() => {
            Quantity::jump(What::MeanCharge(of.source), 1.0, 1.0)
        }
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
    Ok(Recorded::named("current", name, quantity, unit))
}

/// Electrical power of the source of a muscle.
pub(super) fn power(named: &Named<'_>) -> Result<Recorded> {
    let (name, place) = (named.name, named.place);
    let of = Charging::new(named)?;
    if !(of.is_lumped && of.is_behind_resistor) {
        let found = format!("{name:?}, which is no lumped muscle behind a resistor");
        let expected = "a lumped muscle with a \"resistance\" in its \"circuit\"";
        return Err(place.wrong(found, expected));
    }
    let quantity = Quantity::power(of.source);
    let unit = (Power::kind(), ("W", 1.0));
    Ok(Recorded::named("power", name, quantity, unit))
}

/// Voltage of electrodes that is not given.
pub(super) fn voltage(named: &Named<'_>) -> Result<Recorded> {
    let (name, place) = (named.name, named.place);
    let of = Charging::new(named)?;
    if !of.is_behind_resistor {
        let found = format!("{name:?}, whose electrodes have the voltage that is given");
        let expected = "a source with a \"resistance\" in its \"circuit\"";
        return Err(place.wrong(found, expected));
    }
    let quantity = Quantity::of(What::ElectrodeVoltage(of.source));
    let unit = (Voltage::kind(), ("V", 1.0));
    Ok(Recorded::named("voltage", name, quantity, unit))
}
