//! Voltages, charges, currents and powers of sources in limits, costs and recordings.

use crate::control::problem::Limit;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::problem::quantities::entry::{
    All, Cost, CostEntry, LimitEntry, Named, Recorded, bounds, costs, limits, squares,
};
use crate::files::units::quantity::{
    Charge, Current, Kind, Power, Quantity as Written, Voltage, VoltageRate,
};
use crate::model::system::{Fidelity, Muscle};
use crate::model::{MILLIAMPERE, Quantity, What};

/// Declares limits of one source (`"source": name`) or all (`"sources": "all"`): `min`, `max` or both.
macro_rules! source_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal, $chosen:ident, $limit:expr;)*) => { limits! {
        $($(#[$about])* $name {
            /// Name of the source: that of its muscle or electrode.
            pub source: Option<String>,
            /// All sources.
            pub sources: Option<All>,
        } within Written<$measure>, $unit => |of, at| {
            let bounds = bounds([&of.min, &of.max], at)?;
            let limit: fn(usize, [f64; 2]) -> Limit = $limit;
            let (sources, _) = $chosen(&of.source, of.sources, at)?;
            sources.into_iter().map(|source| limit(source, bounds)).collect()
        };)*
    } };
}

source_limits! {
    /// Limits of the current from one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both.
    ///
    /// Behind a resistor it is the mean current in each interval. Otherwise it is the charge that flows from the middle of an interval to that
    /// of the next one, where the voltage jumps too; from and to states of rest that are known it is that of half an interval.
    CurrentLimitSpec: Current, ", SI unit A", measured, |source, bounds| Limit::new(What::Current(source), bounds);
    /// Limits of the power of one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both, at the
    /// times of a current.
    ///
    /// Without a resistor it is that of the stored energy and of the work on the motion, as in the table; losses of charging in steps do not
    /// count.
    PowerLimitSpec: Power, ", SI unit W", measured, |source, bounds| Limit::new(What::Power(source), bounds);
    /// Limits of the rate of the voltage of one source (`"source": name`) or each (`"sources": "all"`) from interval to interval: `min`,
    /// `max` or both.
    VoltageRateLimitSpec: VoltageRate, ", SI unit V/s", any, |source, bounds| Limit::of_rate(What::Voltage(source), bounds);
}

costs! {
    /// The current of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
    CurrentCostSpec {
        /// Name of the source: that of its muscle.
        pub source: Option<String>,
        /// All sources.
        pub sources: Option<All>,
        /// Current that is asked for, SI unit A; 0 where not written.
        pub at: Option<Written<Current>>,
    } weight of "the squared deviation in mA²" => |of, at| {
        let current = of.at.as_ref().map(|one| one.value() / MILLIAMPERE);
        let muscles = behind_resistors(&of.source, of.sources, at)?;
        squares(muscles, Quantity::current, current)
    };

    /// The power of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor.
    PowerCostSpec {
        /// Name of the source: that of its muscle.
        pub source: Option<String>,
        /// All sources.
        pub sources: Option<All>,
        /// Power that is asked for, SI unit W; 0 where not written.
        pub at: Option<Written<Power>>,
    } weight of "the squared deviation in W²" => |of, at| {
        let muscles = behind_resistors(&of.source, of.sources, at)?;
        squares(muscles, Quantity::power, of.at.as_ref().map(Written::value))
    };
}

/// One source, or all that take a voltage, with the place where they are chosen.
fn chosen<'s>(one: &Option<String>, all: Option<All>, at: &At<'s>) -> Result<(Vec<usize>, At<'s>)> {
    let one = one.as_ref().map(Some);
    match at.exactly_one([("source", one), ("sources", all.map(|_| None))])? {
        Some(name) => {
            let place = at.key("source");
            Ok((vec![place.driven(name)?], place))
        }
        None => {
            let takes = |&s: &usize| at.sources[s].takes_voltage;
            let all = (0..at.sources.len()).filter(takes);
            Ok((all.collect(), at.key("sources")))
        }
    }
}

/// Sources of which there is one at least.
fn any<'s>(one: &Option<String>, all: Option<All>, at: &At<'s>) -> Result<(Vec<usize>, At<'s>)> {
    let (sources, place) = chosen(one, all, at)?;
    refuse!(if sources.is_empty(), place; found "no source", expected "a source of a voltage");
    Ok((sources, place))
}

/// Muscles of whose sources current and power are known: all of them without such a muscle is none.
fn measured<'s>(
    one: &Option<String>,
    all: Option<All>,
    at: &At<'s>,
) -> Result<(Vec<usize>, At<'s>)> {
    const EXPECTED: &str = "sources of lumped muscles with a permittivity: without a \"circuit\", or with a \"resistance\" in it";
    let (chosen, place) = chosen(one, all, at)?;
    let obstacle = |s: usize| match at.system.muscles.get(s) {
        Some(muscle) if muscle.has_measured_current() => None,
        Some(muscle) if muscle.circuit.is_some() => Some("which leaks and has no resistor"),
        Some(_) => Some("a muscle of finite elements"),
        None => Some("which drives finite elements"),
    };
    let obstacle = chosen.iter().find_map(|&s| Some((s, obstacle(s)?)));
    refuse!(if let Some((source, why)) = obstacle, place;
        found format!("{:?}, {why}", at.sources[source].name), expected EXPECTED);
    refuse!(if chosen.is_empty(), place; found "no source", expected EXPECTED);
    Ok((chosen, place))
}

/// Muscles whose sources are behind a resistor.
fn behind_resistors(one: &Option<String>, all: Option<All>, at: &At<'_>) -> Result<Vec<usize>> {
    let (muscles, place) = measured(one, all, at)?;
    let of_system = &at.system.muscles;
    let jumps = |&&muscle: &&usize| !Muscle::is_behind_resistor(&of_system[muscle]);
    refuse!(if let Some(&muscle) = muscles.iter().find(jumps), place;
        found format!("{:?}, without a resistor: its voltage jumps between intervals", of_system[muscle].name),
        expected "a muscle with a \"resistance\" in its \"circuit\"; otherwise \"rate\", \"electrical_energy\" or a limit");
    Ok(muscles)
}

/// A source, whether it charges a lumped muscle, and whether a resistor lies between.
struct Charging {
    source: usize,
    is_lumped: bool,
    is_behind_resistor: bool,
}

impl Charging {
    fn new(of: &Named<'_>) -> Result<Self> {
        let (source, system) = (of.place.driven(of.name)?, of.at.system);
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

/// A quantity of a source, or why it is not known, and what is expected.
fn known(
    named: &Named<'_>,
    word: &str,
    quantity: Result<Quantity, [&str; 2]>,
    kind: Kind,
) -> Result<Recorded> {
    let quantity = quantity.map_err(|[why, expected]| {
        let found = format!("{:?}, {why}", named.name);
        named.place.wrong(found, expected)
    });
    Ok(named.recorded(word, quantity?, kind))
}

pub(super) fn charge(named: &Named<'_>) -> Result<Recorded> {
    let of = Charging::new(named)?;
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Ok(Quantity::of(What::Charge(of.source))),
        (false, true) => Ok(Quantity::of(What::MeanCharge(of.source))),
        (false, false) => Err(OF_ELEMENTS),
    };
    known(named, "charge", quantity, Charge::kind())
}

/// Current of a source: through a resistor, or that of the changing charge.
pub(super) fn current(named: &Named<'_>) -> Result<Recorded> {
    let of = Charging::new(named)?;
    let is_measured = |source: usize| named.at.system.muscles[source].has_measured_current();
    let quantity = match (of.is_behind_resistor, of.is_lumped) {
        (true, _) => Ok(Quantity::of(What::Current(of.source))),
        (false, true) if is_measured(of.source) => {
            Ok(Quantity::jump(What::MeanCharge(of.source), 1.0, 1.0))
        }
        (false, true) => Err([
            "which leaks and has no resistor",
            "a muscle without a \"circuit\", or with a \"resistance\" in it",
        ]),
        (false, false) => Err(OF_ELEMENTS),
    };
    known(named, "current", quantity, Current::kind())
}

/// Electrical power of the source of a muscle.
pub(super) fn power(named: &Named<'_>) -> Result<Recorded> {
    let of = Charging::new(named)?;
    let is_known = of.is_lumped && of.is_behind_resistor;
    let quantity = is_known.then(|| Quantity::power(of.source)).ok_or([
        "which is no lumped muscle behind a resistor",
        "a lumped muscle with a \"resistance\" in its \"circuit\"",
    ]);
    known(named, "power", quantity, Power::kind())
}

/// Voltage of electrodes that is not given.
pub(super) fn voltage(named: &Named<'_>) -> Result<Recorded> {
    let of = Charging::new(named)?;
    let quantity = Quantity::of(What::ElectrodeVoltage(of.source));
    let quantity = of.is_behind_resistor.then_some(quantity).ok_or([
        "whose electrodes have the voltage that is given",
        "a source with a \"resistance\" in its \"circuit\"",
    ]);
    known(named, "voltage", quantity, Voltage::kind())
}
