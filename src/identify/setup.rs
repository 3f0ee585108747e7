//! The model of a recording at values of the constants, with its start.

use crate::control::problem::{
    BoundaryState, Control, Duration, Identification, Recording, SoughtStart, Voltages,
};
use crate::control::{
    BoundaryError, MomentumSlopes, StartDerivatives, ends_that_read, momentum_slopes,
    resolve_start, rest_at,
};
use crate::dynamics::{Equilibrium, IndependentChanges, Start};
use crate::identify::error::IdentifyError;
use crate::identify::input_constants::{Drive, Inputs};
use crate::model::{
    Analysis, Coordinates, Model, Parameter, Quantity, System, What, with_parameters,
};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;

/// The model of a recording on a grid.
#[derive(Debug)]
pub(super) struct Setup<'a> {
    pub(super) recording: &'a Recording,
    /// Voltages and loads with their gains and delays.
    pub(super) inputs: Inputs<'a>,
    start: Cow<'a, BoundaryState>,
    pub(super) control: Control,
    pub(super) model: Model,
}

impl<'a> Setup<'a> {
    /// The model at values of the constants, with steps of `h` ms.
    pub(super) fn new(
        system: &System,
        task: &Identification,
        recording: &'a Recording,
        constants: &[f64],
        [duration, intervals]: [f64; 2],
    ) -> Result<Self, IdentifyError> {
        let at = |(parameter, &value): (&Parameter, &f64)| Parameter {
            guess: value,
            ..parameter.clone()
        };
        let (system, parameters) = recording.of((system, &task.parameters));
        let parameters: Vec<_> = parameters.iter().zip(constants).map(at).collect();
        let mut system = with_parameters(system, &parameters, constants);
        let drive = Drive::new(system.sources().len(), &parameters, constants);
        let start = drive.start(&recording.start);
        let inputs = Inputs::new(drive, &recording.voltages, (&mut system, &start));
        let voltages = &inputs.undelayed;
        let control = Control {
            parameters,
            coordinates: task.coordinates,
            ..Control::of_course(&start, voltages, duration, intervals as usize)
        };
        let mut analysis = Analysis {
            quantities: recording
                .quantities()
                .flat_map(
                    |quantity| match ends_that_read(&quantity, &control.parameters) {
                        Some(ends) => ends.to_vec(),
                        None => vec![quantity],
                    },
                )
                .collect(),
            ..control.analysis(&system, duration / intervals)
        };
        // Forces and charges are there where nothing moves too.
        let is_force = |quantity: Quantity| lasts(&quantity);
        if recording.sought_start != SoughtStart::Nothing || recording.quantities().any(is_force) {
            analysis.initially_moving = None;
        }
        for source in recording.quantities().filter_map(|q| q.source()) {
            analysis.zero_inputs.remove(&source);
        }
        let model = Model::for_analysis(system, analysis);
        let setup = Self {
            model: model.map_err(|error| recording.wrong(error.into()))?,
            control,
            recording,
            inputs,
            start,
        };
        setup.check()?;
        Ok(setup)
    }

    /// Refuses what derivatives by the start are not offered for.
    fn check(&self) -> Result<(), IdentifyError> {
        let parameters = self.control.parameters.iter();
        let mut constants = parameters.flat_map(|parameter| &parameter.constants);
        let are_joints = self.model.coordinates == Coordinates::Reduced;
        if !are_joints && constants.any(|one| one.constant.is_place()) {
            return Err(self.refused(
                "places of bodies, joints and markers are sought in joint coordinates alone"
                    .to_owned(),
            ));
        }
        for channel in &self.recording.channels {
            let parts = channel.parts.iter().map(|(_, quantity)| quantity);
            let mut silent = parts.filter(|q| lasts(q) && self.model.place_of(q).is_none());
            if silent.next().is_some() {
                return Err(self.refused(format!(
                    "nothing of the model tells {}: of a joint that is fixed, in a loop, or where blocks are glued, of a part between points that do not move, or of a source that drives nothing",
                    channel.name
                )));
            }
        }
        let is_of_rest = matches!(self.recording.start, BoundaryState::RestAtVoltages(..));
        let is_sought = self.recording.sought_start != SoughtStart::Nothing;
        if is_of_rest && is_sought && self.model.action.map.multipliers > 0 {
            return Err(self.refused(
                "an unknown start near a state of rest is offered in joint coordinates alone; expected a start with \"joint_angles\""
                    .to_owned(),
            ));
        }
        Ok(())
    }

    pub(super) fn refused(&self, reason: String) -> IdentifyError {
        IdentifyError::Refused {
            recording: self.recording.name.clone(),
            reason,
        }
    }

    /// The start that the recording gives, and the changes of its momenta with sought masses.
    pub(super) fn given_start(&self) -> Result<(Start, Vec<MomentumSlopes>), IdentifyError> {
        let found = resolve_start(&self.model, &self.start, "start");
        let mut start = found.map_err(|error| self.recording.wrong(error))?;
        let slopes = momentum_slopes(&self.model, (&self.start, &mut start));
        let slopes = slopes.map_err(|index| {
            let name = &self.control.parameters[index].name;
            self.refused(format!(
                "the momenta of its start are no straight line in {name}; expected a start at rest, with \"sought_start\": \"state\" where it moves"
            ))
        })?;
        Ok((start, slopes))
    }

    /// The changes of the start that are unknowns; none where it is given.
    fn changes(&self, start: &Start) -> Result<Option<IndependentChanges<'_>>, IdentifyError> {
        if self.recording.sought_start == SoughtStart::Nothing {
            return Ok(None);
        }
        let found = IndependentChanges::at(&self.model, start.z.clone());
        let many = || self.refused("an unknown start is offered of fewer coordinates".to_owned());
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

    /// The start with changes of its coordinates and momenta, and its derivatives by the constants that masses read, then by these changes.
    pub(super) fn start(
        &self,
        (constants, values): (usize, &[f64]),
    ) -> Result<(Start, StartDerivatives), IdentifyError> {
        let (mut start, lines) = self.given_start()?;
        let (n, count) = (self.model.coordinate_count(), constants + values.len());
        let mut by = StartDerivatives {
            coordinates: DMatrix::zeros(n, count),
            momenta: DMatrix::zeros(n, count),
        };
        for line in lines.iter().filter(|line| line.parameter < constants) {
            let slopes = DVector::from_column_slice(&line.slopes);
            by.momenta.set_column(line.parameter, &slopes);
        }
        let Some(changes) = self.changes(&start)? else {
            return Ok((start, by));
        };
        let basis = changes.basis();
        let (of_coordinates, of_momenta) = values.split_at(basis.ncols());
        let Some((z, slopes)) = changes.changed(of_coordinates) else {
            return Err(
                self.refused("its loops do not close at the start that is sought".to_owned())
            );
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

    /// The equilibrium under voltages in V, by source.
    pub(super) fn rest_under(&self, voltages: &[f64]) -> Result<Equilibrium, IdentifyError> {
        let found = rest_at(&self.model, voltages, ("rest", 0.0));
        found.map_err(|error| self.recording.wrong(error))
    }

    /// The problem whose transcription has the derivatives by the start too.
    pub(super) fn open(&self, voltages: Voltages, intervals: usize, h: f64) -> Control {
        let any = [f64::NEG_INFINITY, f64::INFINITY];
        Control {
            start: BoundaryState::Free,
            // Inputs of which something is sought have columns.
            load_bounds: self.inputs.sought().map(|source| (source, any)).collect(),
            course: Some(voltages),
            duration: Duration::Given(h * intervals as f64),
            intervals,
            ..self.control.clone()
        }
    }
}

impl Recording {
    /// All quantities, channel by channel, with those that are subtracted in the intervals before.
    pub(super) fn quantities(&self) -> impl Iterator<Item = Quantity> {
        let parts = self.channels.iter().flat_map(|channel| &channel.parts);
        parts.flat_map(|(_, quantity)| [quantity.clone()].into_iter().chain(quantity.before()))
    }

    pub(super) fn wrong(&self, source: BoundaryError) -> IdentifyError {
        IdentifyError::Boundary {
            recording: self.name.clone(),
            source,
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
