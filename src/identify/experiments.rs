//! Experiments that could be done next: what their readings would add to the information on the constants.

use crate::control::problem::{Channel, Identification, Recording};
use crate::identify::error::IdentifyError;
use crate::identify::fit::Fit;
use crate::identify::information::Information;
use crate::identify::prediction::{Grid, count_of_start, predict};
use crate::identify::residuals::Data;
use crate::identify::unknowns::Unknowns;
use crate::model::System;
use nalgebra::DMatrix;

/// A candidate, and the information on the constants with its readings.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Index of the candidate.
    pub candidate: usize,
    /// The information after it.
    pub information: Information,
}

impl Experiment {
    /// All candidates, the best one first: that which leaves fewest combinations undetermined, then the lowest sum of the relative variances.
    pub(super) fn all(
        (system, task): (&System, &Identification),
        (fit, halvings): (&Fit, usize),
    ) -> Result<Vec<Self>, IdentifyError> {
        let of = |candidate| {
            Self::new((system, task), candidate, (fit, halvings))
                .map_err(IdentifyError::of_candidate)
        };
        let all: Result<Vec<_>, _> = (0..task.candidates.len()).map(of).collect();
        let mut all = all?;
        all.sort_by(|a, b| a.rank().partial_cmp(&b.rank()).expect("numbers"));
        Ok(all)
    }

    fn rank(&self) -> (usize, f64) {
        let open = &self.information.undetermined;
        let infinite = open
            .iter()
            .filter(|one| one.deviation.is_infinite())
            .count();
        (infinite, self.information.finite_variance)
    }

    fn new(
        (system, task): (&System, &Identification),
        candidate: usize,
        (fit, halvings): (&Fit, usize),
    ) -> Result<Self, IdentifyError> {
        let recording = &task.candidates[candidate];
        let alone = Identification {
            recordings: vec![recording.clone()],
            ..task.clone()
        };
        let count = count_of_start(system, task, recording)?;
        let mut unknowns = Unknowns::new(&alone, |_| count);
        let constants = unknowns.constants;
        unknowns.values[..constants].copy_from_slice(fit.unknowns.of_constants());
        let mut grid = Grid::first(&alone, &alone.recordings);
        for _ in 0..halvings {
            grid = grid.halved();
        }
        let added = predict((system, &alone), &[0], &unknowns, &grid)?.derivatives;
        let added = standardised(added, recording, fit)?;
        let before = fit.weighted();
        let (rows, columns) = before.shape();
        let mut whole = DMatrix::zeros(rows + added.nrows(), columns + count);
        whole.view_mut((0, 0), (rows, columns)).copy_from(&before);
        let mut below = whole.rows_mut(rows, added.nrows());
        below
            .columns_mut(0, constants)
            .copy_from(&added.columns(0, constants));
        below
            .columns_mut(columns, count)
            .copy_from(&added.columns(constants, count));
        let freedom = (!fit.data.is_known()).then(|| fit.freedom() + added.nrows() - count);
        let values = fit.unknowns.of_constants();
        Ok(Self {
            candidate,
            information: Information::new(task, (&whole, values), &fit.is_at_bound, freedom),
        })
    }
}

/// Derivatives in standard deviations, of which those that are not known are as in the fit.
fn standardised(
    mut derivatives: DMatrix<f64>,
    candidate: &Recording,
    fit: &Fit,
) -> Result<DMatrix<f64>, IdentifyError> {
    let mut row = 0;
    for channel in &candidate.channels {
        for reading in &channel.readings {
            let deviation = deviation((candidate, channel), &fit.data, reading.deviation)?;
            let mut into = derivatives.row_mut(row);
            into /= deviation;
            row += 1;
        }
    }
    Ok(derivatives)
}

/// Refuses a candidate with readings whose standard deviation is neither known nor estimated from these data.
pub(super) fn check_deviations(candidate: &Recording, data: &Data) -> Result<(), IdentifyError> {
    let mut channels = candidate.channels.iter();
    channels.try_for_each(|channel| deviation((candidate, channel), data, 1.0).map(|_| ()))
}

/// The standard deviation of a reading with this relative one.
fn deviation(
    (candidate, channel): (&Recording, &Channel),
    data: &Data,
    relative: f64,
) -> Result<f64, IdentifyError> {
    let found = data.deviation(channel, relative);
    found.ok_or_else(|| IdentifyError::Refused {
        recording: candidate.name.clone(),
        reason: format!(
            "nothing tells the standard deviation of {}, which no recording measures whose deviation is estimated; expected one",
            channel.name
        ),
    })
}
