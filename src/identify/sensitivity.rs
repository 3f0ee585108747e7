//! Exact derivatives of a discrete motion by constants, start coordinates and start momenta.

use crate::control::problem::{Regime, Voltages};
use crate::control::{
    Argument, BoundaryConditions, Column, ImplicitFunction, InitialGuess, StartDerivatives,
    Transcription,
};
use crate::dynamics::{DiscreteTrajectory, Start};
use crate::identify::error::IdentifyError;
use crate::identify::setup::Setup;
use crate::model::{Role, Time};
use nalgebra::DMatrix;

/// Derivatives of a motion by unknowns: of the coordinates of each instant, and of scalars that are read in each interval.
#[derive(Clone, Debug)]
pub(super) struct CourseDerivatives {
    pub(super) instants: Vec<DMatrix<f64>>,
    /// Scalars that are read, in order.
    pub(super) read: Vec<usize>,
    pub(super) intervals: Vec<DMatrix<f64>>,
}

/// Start of a motion of a recording, and the number of unknowns by which it is differentiated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beginning<'a> {
    pub(super) start: &'a Start,
    /// Derivatives of the start; none of a state of rest, which has no start.
    pub(super) derivatives: Option<&'a StartDerivatives>,
    /// Number of unknowns.
    pub(super) unknowns: usize,
}

/// Derivatives of a motion by the unknowns; of a state of rest where its beginning has no derivatives.
pub(super) fn derivatives(
    setup: &Setup<'_>,
    from: Beginning<'_>,
    discrete: &DiscreteTrajectory,
    voltages: &Voltages,
) -> Result<CourseDerivatives, IdentifyError> {
    let (model, intervals) = (&setup.model, discrete.intervals());
    let h = discrete.times[1] - discrete.times[0];
    let control = setup.open(voltages.clone(), intervals, h);
    let count = model.coordinate_count();
    let boundary = BoundaryConditions::without_goal(from.start.clone(), count);
    let initial = InitialGuess {
        discrete: discrete.clone(),
        h,
        costates: None,
        carried: Default::default(),
    };
    let program = Transcription::of_any(model, &boundary, &control, &initial);
    let mut program = program.map_err(|error| setup.recording.wrong(error))?;
    let regime = match from.derivatives {
        Some(_) => Regime::Motion,
        None => Regime::Rest,
    };
    let function = ImplicitFunction::new(&program, regime, known(setup, discrete, regime));
    let function = function.expect("a motion follows from its start");
    let mut x = program.encode(&initial.discrete, h);
    let by = (from.unknowns, from.derivatives);
    let Some(solved) = function.derivatives(&mut program, &mut x, by) else {
        return Err(setup.refused("the equations of its derivatives are singular".to_owned()));
    };
    let parts = (&program, &function);
    Ok(CourseDerivatives::new(
        setup,
        parts,
        (&solved, from),
        intervals,
    ))
}

/// Tells the columns that are functions of the constants, and their derivatives: constants themselves, and inputs with gains or delays.
fn known<'a>(
    setup: &'a Setup<'_>,
    discrete: &'a DiscreteTrajectory,
    regime: Regime,
) -> impl Fn(&Column) -> Option<Vec<(usize, f64)>> + 'a {
    let variables = &setup.model.variables;
    let first = variables.range(Role::Parameter).start;
    move |column| match *column {
        Column::Parameter { s } => Some(vec![(s - first, 1.0)]),
        Column::Interval { k, s } => {
            let source = variables.of(Time::Interval)[s].source?;
            let times = [discrete.times[k], discrete.times[k + 1]];
            let interval = (regime == Regime::Motion).then_some(times);
            let value = discrete.scalars[k][s];
            setup.inputs.slopes((source, value), interval)
        }
        _ => None,
    }
}

impl CourseDerivatives {
    /// Those of all instants and intervals out of the unknowns.
    fn new(
        setup: &Setup<'_>,
        (program, function): (&Transcription<'_>, &ImplicitFunction),
        (solved, from): (&DMatrix<f64>, Beginning<'_>),
        intervals: usize,
    ) -> Self {
        let (n, count) = (setup.model.coordinate_count(), from.unknowns);
        let measures = setup.model.action.intervals.measures.iter();
        let mut read: Vec<usize> = measures.flat_map(|one| one.scalars()).collect();
        read.sort_unstable();
        read.dedup();
        let parameters = setup.model.variables.range(Role::Parameter);
        // A free parameter is a scalar of all intervals.
        let by_itself = DMatrix::from_fn(read.len(), count, |row, column| {
            let is_own = parameters.contains(&read[row]) && read[row] - parameters.start == column;
            f64::from(u8::from(is_own))
        });
        let mut out = Self {
            instants: vec![DMatrix::zeros(n, count); intervals + 1],
            intervals: vec![by_itself; intervals],
            read,
        };
        if let Some(by_start) = from.derivatives {
            out.instants[0].clone_from(&by_start.coordinates);
        }
        let columns = program.unknowns().columns.iter().zip(&function.columns);
        for (column, meaning) in columns {
            let unknown = match (*column, meaning) {
                (_, Argument::Unknown(unknown)) => *unknown,
                (Column::Interval { k, s }, Argument::Known(slopes)) => {
                    if let Ok(row) = out.read.binary_search(&s) {
                        let each = slopes.iter();
                        each.for_each(|&(of, slope)| out.intervals[k][(row, of)] = slope);
                    }
                    continue;
                }
                _ => continue,
            };
            match *column {
                Column::Instant { k, i } if i < n => {
                    out.instants[k].set_row(i, &solved.row(unknown));
                }
                Column::Interval { k, s } => {
                    if let Ok(row) = out.read.binary_search(&s) {
                        out.intervals[k].set_row(row, &solved.row(unknown));
                    }
                }
                _ => {}
            }
        }
        out
    }

    /// The same of a state of rest that lasts over some intervals.
    pub(super) fn lasting(&self, intervals: usize) -> Self {
        let last = self.instants.last().expect("one instant or more");
        Self {
            instants: vec![last.clone(); intervals + 1],
            read: self.read.clone(),
            intervals: vec![self.intervals[0].clone(); intervals],
        }
    }
}
