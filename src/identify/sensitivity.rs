//! Exact derivatives of a discrete motion by constants, start coordinates and start momenta.
//!
//! The rows `c(y, p) = 0` of the transcription hold along the motion y. Its derivatives S by p solve `∂c/∂y S = −∂c/∂p`, where ∂c/∂y is
//! square: instant by instant it has blocks on the diagonal and below it. At rest all instants move alike.

use crate::control::problem::{Regime, Voltages};
use crate::control::{Column, InitialGuess, Row, Transcription};
use crate::dynamics::{DiscreteTrajectory, Start};
use crate::identify::error::IdentifyError;
use crate::identify::setup::Setup;
use crate::model::{Role, Time};
use crate::nlp::Nlp;
use crate::sparse::Direct;
use nalgebra::DMatrix;

/// Derivatives of the state at the start: coordinates and momenta by unknowns.
#[derive(Clone, Debug)]
pub(super) struct StartDerivatives {
    pub(super) coordinates: DMatrix<f64>,
    pub(super) momenta: DMatrix<f64>,
}

/// Derivatives of a motion by unknowns: of the coordinates of each instant, and of scalars that are read in each interval.
#[derive(Clone, Debug)]
pub(super) struct CourseDerivatives {
    pub(super) instants: Vec<DMatrix<f64>>,
    /// Scalars that are read, in order.
    pub(super) read: Vec<usize>,
    pub(super) intervals: Vec<DMatrix<f64>>,
}

/// Linear equations of the derivatives of a motion.
struct Equations {
    /// Row of each row of the program.
    rows: Vec<Option<usize>>,
    /// Meaning of each column of the program.
    columns: Vec<Meaning>,
    size: usize,
}

/// Meaning of a column of the program.
#[derive(Clone, Copy, Debug)]
enum Meaning {
    /// Unknown of this number.
    Unknown(usize),
    /// Coordinate of the start.
    Start(usize),
    /// Sought constant.
    Constant(usize),
    /// Input with this derivative by its gain, a constant.
    Input(usize, f64),
}

/// Derivatives of a motion by the unknowns.
pub(super) fn derivatives(
    setup: &Setup<'_>,
    (start, by_start): (&Start, &StartDerivatives),
    discrete: &DiscreteTrajectory,
    (voltages, regime): (&Voltages, Regime),
) -> Result<CourseDerivatives, IdentifyError> {
    let (model, intervals) = (&setup.model, discrete.intervals());
    let h = discrete.times[1] - discrete.times[0];
    let control = setup.open(voltages.clone(), intervals, h);
    let boundary = setup.boundary(start.clone());
    let initial = InitialGuess {
        discrete: discrete.clone(),
        h,
        costates: None,
        carried: Default::default(),
    };
    let program = Transcription::of_any(model, &boundary, &control, &initial);
    let mut program = program.map_err(|error| setup.recording.wrong(error))?;
    let x = program.encode(&initial.discrete, h);
    let entries = program.jacobian_structure();
    let mut values = vec![0.0; entries.rows.len()];
    program.jacobian(&x, &mut values);
    let equations = Equations::new(setup, (&program, discrete), regime);
    let count = by_start.coordinates.ncols();
    let mut right = DMatrix::zeros(equations.size, count);
    let (mut places, mut left) = (Vec::new(), Vec::new());
    for ((&row, &col), &value) in entries.rows.iter().zip(&entries.cols).zip(&values) {
        let Some(row) = equations.rows[row as usize] else {
            continue;
        };
        let scale = program.column_scale(col as usize);
        match equations.columns[col as usize] {
            Meaning::Unknown(unknown) => {
                places.push((row, unknown));
                left.push(value / scale);
            }
            Meaning::Start(i) => {
                for j in 0..count {
                    right[(row, j)] -= value / scale * by_start.coordinates[(i, j)];
                }
            }
            Meaning::Constant(p) => right[(row, p)] -= value / scale,
            Meaning::Input(gain, slope) => right[(row, gain)] -= value / scale * slope,
        }
    }
    for (r, row) in program.unknowns().rows.iter().enumerate() {
        if let (Row::Instant { k: 0, i }, Some(at), Regime::Motion) =
            (*row, equations.rows[r], regime)
        {
            for j in 0..count {
                right[(at, j)] -= program.row_scale(r) * by_start.momenta[(i, j)];
            }
        }
    }
    let mut solver = Direct::new(equations.size, &places);
    let refused = |_| IdentifyError::Refused {
        recording: setup.recording.name.clone(),
        reason: "the equations of its derivatives are singular".to_owned(),
    };
    solver.factor(&left).map_err(refused)?;
    for mut column in right.column_iter_mut() {
        solver.solve(column.as_mut_slice());
    }
    let solved = (&right, by_start);
    Ok(CourseDerivatives::new(
        setup,
        (&program, &equations),
        solved,
        intervals,
    ))
}

impl Equations {
    fn new(
        setup: &Setup<'_>,
        (program, discrete): (&Transcription<'_>, &DiscreteTrajectory),
        regime: Regime,
    ) -> Self {
        let variables = &setup.model.variables;
        let gain = |s: usize| {
            let source = variables.of(Time::Interval)[s].source?;
            setup.drive.of_source(source)
        };
        let n = setup.model.coordinate_count();
        let first = variables.range(Role::Parameter).start;
        let mut size = 0;
        let mut of_rest = vec![None; n];
        let mut next = || {
            size += 1;
            size - 1
        };
        let mut meaning = |column: &Column| match *column {
            Column::Instant { k: 0, i } if regime == Regime::Motion && i < n => Meaning::Start(i),
            Column::Instant { i, .. } if regime == Regime::Rest && i < n => {
                Meaning::Unknown(*of_rest[i].get_or_insert_with(&mut next))
            }
            Column::Parameter { s } => Meaning::Constant(s - first),
            Column::Interval { k, s } => match gain(s) {
                Some(gain) => Meaning::Input(gain.constant, discrete.scalars[k][s] / gain.value),
                None => Meaning::Unknown(next()),
            },
            _ => Meaning::Unknown(next()),
        };
        let columns = program
            .unknowns()
            .columns
            .iter()
            .map(&mut meaning)
            .collect();
        let mut count = 0;
        let row = |row: &Row| {
            // The start meets its constraints.
            let is_met = matches!(*row, Row::Instant { k: 0, i } if i >= n);
            (!is_met).then(|| {
                count += 1;
                count - 1
            })
        };
        let rows = program.unknowns().rows.iter().map(row).collect();
        assert_eq!(count, size, "a motion follows from its start");
        Self {
            rows,
            columns,
            size,
        }
    }
}

impl CourseDerivatives {
    /// Those of all instants and intervals out of the unknowns.
    fn new(
        setup: &Setup<'_>,
        (program, equations): (&Transcription<'_>, &Equations),
        (solved, by_start): (&DMatrix<f64>, &StartDerivatives),
        intervals: usize,
    ) -> Self {
        let (n, count) = by_start.coordinates.shape();
        let measures = setup.model.action.intervals.measures.iter();
        let mut read: Vec<usize> = measures.flat_map(|one| one.scalars()).collect();
        read.sort_unstable();
        read.dedup();
        let parameters = setup.model.variables.range(Role::Parameter);
        // A sought constant is a scalar of all intervals.
        let by_itself = DMatrix::from_fn(read.len(), count, |row, column| {
            let is_own = parameters.contains(&read[row]) && read[row] - parameters.start == column;
            f64::from(u8::from(is_own))
        });
        let mut out = Self {
            instants: vec![DMatrix::zeros(n, count); intervals + 1],
            intervals: vec![by_itself; intervals],
            read,
        };
        out.instants[0].clone_from(&by_start.coordinates);
        let columns = program.unknowns().columns.iter().zip(&equations.columns);
        for (column, meaning) in columns {
            let unknown = match (*column, *meaning) {
                (_, Meaning::Unknown(unknown)) => unknown,
                (Column::Interval { k, s }, Meaning::Input(gain, slope)) => {
                    if let Ok(row) = out.read.binary_search(&s) {
                        out.intervals[k][(row, gain)] = slope;
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
