//! The model of a recording at values of the constants, with its start.
//!
//! Free parameters of the inputs of recordings: gains, and delays with which they act.
//!
//! The input of a source is `u(t) = g V(t − τ)`, of which a recording says V(t) from 0 on; before, it is that of the state of rest at the
//! start, or V(0). An interval of length h around the time m has of a delayed input the mean
//!
//! ```text
//! ∫ w u dt,     or  (∫ w u² dt)^½  of a voltage without a resistor, whose forces follow its square,     w(t) = (1 − |t − m| / h) / h.
//! ```
//!
//! These weights of neighbouring intervals add up to 1, and their centres to the time itself: the impulse of a jump and its moment are exact
//! wherever it lies within an interval. The mean is smooth in the delay, `d/dτ ∫ w u dt = ∫ w′ u dt`. The first interval takes in what the one
//! before it would have.

use crate::control::problem::{
    BoundaryState, Control, Identification, Recording, SoughtStart, Voltages,
};
use crate::control::{
    MomentumSlopes, StartDerivatives, ends_that_read, momentum_slopes, resolve_start,
};
use crate::dynamics::{IndependentChanges, Start};
use crate::identify::error::IdentifyError;
use crate::math::in_order;
use crate::model::{
    Analysis, Constant, Coordinates, Model, Parameter, Quantity, System, What, with_parameters,
};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// Constants of a system that recordings are to determine.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// The system.
    pub system: &'a System,
    /// The constants and the recordings.
    pub task: &'a Identification,
}

/// The model of a recording on a grid.
#[derive(Debug)]
pub(super) struct Setup<'a> {
    pub(super) recording: &'a Recording,
    /// Voltages and loads with their gains and delays.
    pub(super) inputs: Inputs<'a>,
    pub(super) control: Control,
    pub(super) model: Model,
}

impl<'a> Problem<'a> {
    /// Guesses of the constants.
    pub(super) fn guesses(self) -> Vec<f64> {
        self.task.parameters.iter().map(|p| p.guess).collect()
    }

    /// The model of a recording at values of the constants, with intervals of about equal length over a duration in ms.
    pub(super) fn setup(
        self,
        recording: &'a Recording,
        constants: &[f64],
        [duration, intervals]: [f64; 2],
    ) -> Result<Setup<'a>, IdentifyError> {
        let (system, parameters) = recording.of(self.system, &self.task.parameters);
        let parameters = parameters.iter().zip(constants);
        let parameters: Vec<Parameter> = parameters
            .map(|(parameter, &guess)| Parameter {
                guess,
                ..parameter.clone()
            })
            .collect();
        let mut system = with_parameters(system, &parameters, constants);
        let (inputs, start) = Inputs::new(recording, &parameters, &mut system);
        let voltages = &inputs.undelayed;
        let control = Control {
            parameters,
            coordinates: self.task.coordinates,
            ..Control::of_course(&start, voltages, duration, intervals as usize)
        };
        let read = |quantity| match ends_that_read(&quantity, &control.parameters) {
            Some(ends) => ends.to_vec(),
            None => vec![quantity],
        };
        let mut analysis = Analysis {
            quantities: recording.quantities().flat_map(read).collect(),
            ..control.analysis(&system, duration / intervals)
        };
        // Forces and charges are there where nothing moves too.
        if recording.seeks_start() || recording.quantities().any(|quantity| lasts(&quantity)) {
            analysis.initially_moving = None;
        }
        for source in recording.quantities().filter_map(|q| q.source()) {
            analysis.zero_inputs.remove(&source);
        }
        let model = Model::for_analysis(system, analysis);
        let setup = Setup {
            model: model.map_err(|error| recording.refused(error))?,
            control,
            recording,
            inputs,
        };
        setup.check()?;
        Ok(setup)
    }
}

impl Setup<'_> {
    /// Refuses what derivatives by the start are not offered for.
    fn check(&self) -> Result<(), IdentifyError> {
        let parameters = self.control.parameters.iter();
        let mut constants = parameters.flat_map(|parameter| &parameter.constants);
        let are_joints = self.model.coordinates == Coordinates::Reduced;
        if !are_joints && constants.any(|one| one.constant.is_place()) {
            return Err(self.recording.refused(
                "places of bodies, joints and markers are sought in joint coordinates alone",
            ));
        }
        for channel in &self.recording.channels {
            let parts = channel.parts.iter().map(|(_, quantity)| quantity);
            let mut silent = parts.filter(|q| lasts(q) && self.model.place_of(q).is_none());
            if silent.next().is_some() {
                return Err(self.recording.refused(format!(
                    "nothing of the model tells {}: of a joint that is fixed, in a loop, or where blocks are glued, of a part between points that do not move, or of a source that drives nothing",
                    channel.name
                )));
            }
        }
        let is_of_rest = matches!(self.recording.start, BoundaryState::RestAtVoltages(..));
        if is_of_rest && self.recording.seeks_start() && self.model.action.map.multipliers > 0 {
            return Err(self.recording.refused(
                "an unknown start near a state of rest is offered in joint coordinates alone; expected a start with \"joint_angles\"",
            ));
        }
        Ok(())
    }

    /// The start that the recording gives, and the changes of its momenta with sought masses.
    pub(super) fn given_start(&self) -> Result<(Start, Vec<MomentumSlopes>), IdentifyError> {
        let found = resolve_start(&self.model, &self.control.start);
        let mut start = found.map_err(|error| self.recording.refused(error))?;
        let slopes = momentum_slopes(&self.model, &self.control.start, &mut start);
        let slopes = slopes.map_err(|index| {
            let name = &self.control.parameters[index].name;
            self.recording.refused(format!(
                "the momenta of its start are no straight line in {name}; expected a start at rest, with \"sought_start\": \"state\" where it moves"
            ))
        })?;
        Ok((start, slopes))
    }

    /// The changes of the start that are unknowns; none where it is given.
    fn changes(&self, start: &Start) -> Result<Option<IndependentChanges<'_>>, IdentifyError> {
        if !self.recording.seeks_start() {
            return Ok(None);
        }
        let found = IndependentChanges::at(&self.model, start.z.clone());
        let many = || {
            self.recording
                .refused("an unknown start is offered of fewer coordinates")
        };
        found.ok_or_else(many).map(Some)
    }

    /// Number of unknowns of the start.
    pub(super) fn count_of_start(&self) -> Result<usize, IdentifyError> {
        let Some(changes) = self.changes(&self.given_start()?.0)? else {
            return Ok(0);
        };
        let momenta = match self.recording.sought_start {
            SoughtStart::State => changes.moving().len(),
            _ => 0,
        };
        Ok(changes.basis().ncols() + momenta)
    }

    /// Number of constants.
    pub(super) fn constants(&self) -> usize {
        self.control.parameters.len()
    }

    /// The start with changes of its coordinates and momenta, and its derivatives by the constants that masses read, then by these changes.
    pub(super) fn start(&self, values: &[f64]) -> Result<(Start, StartDerivatives), IdentifyError> {
        let (mut start, lines) = self.given_start()?;
        let (n, constants) = (self.model.coordinate_count(), self.constants());
        let count = constants + values.len();
        let mut by = StartDerivatives {
            coordinates: DMatrix::zeros(n, count),
            momenta: DMatrix::zeros(n, count),
        };
        for line in &lines {
            let slopes = DVector::from_column_slice(&line.slopes);
            by.momenta.set_column(line.parameter, &slopes);
        }
        let Some(changes) = self.changes(&start)? else {
            return Ok((start, by));
        };
        let basis = changes.basis();
        let (of_coordinates, of_momenta) = values.split_at(basis.ncols());
        let Some((z, slopes)) = changes.changed(of_coordinates) else {
            return Err(self
                .recording
                .refused("its loops do not close at the start that is sought"));
        };
        start.z = z;
        let columns = by.coordinates.columns_mut(constants, slopes.ncols());
        { columns }.copy_from(&slopes);
        let first = constants + slopes.ncols();
        for ((column, of), value) in (first..).zip(changes.moving()).zip(of_momenta) {
            let along = basis.column(of);
            by.momenta.set_column(column, &along);
            start
                .momentum
                .iter_mut()
                .zip(along.iter())
                .for_each(|(p, along)| *p += along * value);
            start.rates = None;
        }
        Ok((start, by))
    }
}

impl Recording {
    /// Returns true if something of the state at its start is unknown.
    pub fn seeks_start(&self) -> bool {
        self.sought_start != SoughtStart::Nothing
    }

    /// All quantities, channel by channel, with those that are subtracted in the intervals before.
    pub(super) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let parts = self.channels.iter().flat_map(|channel| &channel.parts);
        parts.flat_map(|(_, quantity)| [quantity.clone()].into_iter().chain(quantity.before()))
    }

    /// That it is not offered.
    pub(super) fn refused(&self, reason: impl ToString) -> IdentifyError {
        IdentifyError::Refused {
            recording: self.name.clone(),
            reason: reason.to_string(),
        }
    }
}

/// Returns true of forces, charges, currents, powers and voltages, which are none where they have no measure.
fn lasts(quantity: &Quantity) -> bool {
    matches!(
        quantity.what,
        What::Tension(_)
            | What::Reaction { .. }
            | What::Charge(_)
            | What::MeanCharge(_)
            | What::ElectrodeVoltage(_)
            | What::Current(_)
            | What::Power(_)
    )
}

/// Places and weights of Gauss's rule of order 8 in an interval of length 1.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// A free parameter at its value.
#[derive(Clone, Copy, Debug)]
struct Sought {
    /// Index of the constant.
    constant: usize,
    value: f64,
}

/// An input in an interval, and its derivative by its delay.
struct Delayed {
    value: f64,
    slope: f64,
}

/// The inputs of a motion with their gains and delays at values of the constants.
#[derive(Clone, Debug)]
pub(super) struct Inputs<'a> {
    /// By source.
    gains: Vec<Option<Sought>>,
    delays: Vec<Option<Sought>>,
    /// Those that are said, with gains.
    pub(super) undelayed: Cow<'a, Voltages>,
    /// Times in ms at which they have corners or jumps.
    switches: Vec<f64>,
    /// Inputs before those that are said.
    before: Vec<f64>,
    /// Sources that act by their squares: voltages of electrodes without a resistor.
    by_squares: Vec<bool>,
}

impl<'a> Inputs<'a> {
    /// Those that a recording says of a system with parameters at their guesses, and its start under them.
    pub(super) fn new(
        recording: &'a Recording,
        parameters: &[Parameter],
        system: &mut System,
    ) -> (Self, Cow<'a, BoundaryState>) {
        let none = vec![None; system.sources().len()];
        let [mut gains, mut delays] = [none.clone(), none];
        for (constant, parameter) in parameters.iter().enumerate() {
            let value = parameter.guess;
            let sought = Some(Sought { constant, value });
            for follower in &parameter.constants {
                match follower.constant {
                    Constant::Gain(source) => gains[source] = sought,
                    Constant::Delay(source) => delays[source] = sought,
                    _ => {}
                }
            }
        }
        let factor = |source: usize| gains[source].map_or(1.0, |gain| gain.value);
        let (mut undelayed, mut start) = (
            Cow::Borrowed(&recording.voltages),
            Cow::Borrowed(&recording.start),
        );
        if gains.iter().any(Option::is_some) {
            undelayed = Cow::Owned(recording.voltages.scaled(factor));
            if let BoundaryState::RestAtVoltages(row, _) = start.to_mut() {
                let row = row.iter_mut().enumerate();
                row.for_each(|(source, value)| *value *= factor(source));
            }
        }
        let before = match &*start {
            BoundaryState::RestAtVoltages(row, _) => row.clone(),
            _ => undelayed.at(0.0),
        };
        let loads = system.first_load();
        let is_square = |source| {
            let resistor = Constant::Resistance(source).value(system);
            source < loads && resistor.is_none()
        };
        let inputs = Self {
            by_squares: (0..before.len()).map(is_square).collect(),
            before,
            switches: undelayed.switches(),
            undelayed,
            gains,
            delays,
        };
        (inputs, start)
    }

    /// Sources of which a gain or a delay is sought.
    pub(super) fn sought(&self) -> impl Iterator<Item = usize> + '_ {
        let both = self.gains.iter().zip(&self.delays).enumerate();
        both.filter_map(|(source, (gain, delay))| gain.or(*delay).map(|_| source))
    }

    /// Inputs in the interval between two times in ms: at its middle, unless they are delayed.
    pub(super) fn within(&self, from: f64, to: f64) -> Vec<f64> {
        let mut out = self.undelayed.at(0.5 * (from + to));
        for (source, delay) in self.delays.iter().enumerate() {
            if let Some(delay) = delay {
                out[source] = self.delayed(source, delay.value, [from, to]).value;
            }
        }
        out
    }

    /// Constants on which the value of an input in an interval depends, and its derivatives by them; of one at rest there is no interval. None
    /// where nothing of the source is sought.
    pub(super) fn slopes(
        &self,
        source: usize,
        value: f64,
        interval: Option<[f64; 2]>,
    ) -> Option<Vec<(usize, f64)>> {
        let (gain, delay) = (self.gains[source], self.delays[source]);
        let by_delay = delay.zip(interval).map(|(delay, times)| {
            let slope = self.delayed(source, delay.value, times).slope;
            (delay.constant, slope)
        });
        let by_gain = gain.map(|gain| (gain.constant, value / gain.value));
        let is_sought = gain.is_some() || delay.is_some();
        is_sought.then(|| by_gain.into_iter().chain(by_delay).collect())
    }

    /// Times in ms at which inputs have corners or jumps.
    pub(super) fn corners(&self) -> Vec<f64> {
        let delays = self.delays.iter();
        let delays = in_order(delays.map(|one| one.map_or(0.0, |one| one.value)));
        let later = |&delay: &f64| {
            let begins = (delay > 0.0).then_some(delay);
            begins
                .into_iter()
                .chain(self.switches.iter().map(move |t| t + delay))
        };
        in_order(delays.iter().flat_map(later))
    }

    /// A delayed input: mean, or root of the mean of its square with the sign of the mean.
    fn delayed(&self, source: usize, delay: f64, [from, to]: [f64; 2]) -> Delayed {
        let h = to - from;
        let weighted = |of: fn(f64) -> f64| {
            let own = self.weighted(source, delay, [from, to], of);
            match from > 0.0 {
                true => own,
                false => {
                    let earlier = self.weighted(source, delay, [from - h, from], of);
                    Delayed {
                        value: own.value + earlier.value - of(self.before[source]),
                        slope: own.slope + earlier.slope,
                    }
                }
            }
        };
        let mean = weighted(|u| u);
        if !self.by_squares[source] {
            return mean;
        }
        let square = weighted(|u| u * u);
        let value = square.value.max(0.0).sqrt().copysign(mean.value);
        Delayed {
            value,
            slope: if value == 0.0 {
                0.0
            } else {
                0.5 * square.slope / value
            },
        }
    }

    /// The weighted mean of a function of a delayed input in an interval.
    fn weighted(
        &self,
        source: usize,
        delay: f64,
        [from, to]: [f64; 2],
        of: fn(f64) -> f64,
    ) -> Delayed {
        let (h, middle) = (to - from, 0.5 * (from + to));
        let at = |time: f64| match time - delay {
            early if early < 0.0 => self.before[source],
            said => self.undelayed.signals[source].at(said),
        };
        let corners = [0.0].into_iter().chain(self.switches.iter().copied());
        let (first, last) = (middle - h, middle + h);
        let inside = corners
            .map(|t| t + delay)
            .filter(|t| (first..last).contains(t));
        let ends = in_order([first, middle, last].into_iter().chain(inside));
        let mut out = Delayed {
            value: 0.0,
            slope: 0.0,
        };
        for pair in ends.windows(2) {
            let length = pair[1] - pair[0];
            let side = if pair[0] < middle { 1.0 } else { -1.0 };
            for (x, w) in GAUSS {
                let time = pair[0] + x * length;
                let part = w * length * of(at(time)) / h;
                out.value += part * (1.0 - (time - middle).abs() / h);
                out.slope += part * side / h;
            }
        }
        out
    }
}
