//! A motion of a program, the states of rest beside it, and the programs of several as one.

use crate::control::problem::{Combined, MotionTask};
use crate::control::{
    BoundaryConditions, BoundaryError, RestProgram, Transcription, rest_programs,
};
use crate::ipopt::StartingPoint;
use crate::model::Model;
use crate::nlp::Multipliers;
use crate::nlp::joined::{Joined, Places, SharedVariable};

/// A motion of a program.
#[derive(Clone, Copy)]
pub(crate) struct ProgramMotion<'m> {
    pub(crate) task: MotionTask<'m>,
    pub(crate) model: &'m Model,
    pub(crate) boundary: &'m BoundaryConditions,
}

/// The states of rest that are unknowns beside programs of motions, each with the number of its motion.
///
/// # Errors
/// It is time to stop.
pub(super) fn states_of_rest<'m>(
    motions: &[ProgramMotion<'m>],
    programs: &[(String, Transcription<'m>)],
) -> Result<Vec<(usize, RestProgram<'m>)>, BoundaryError> {
    let mut all = Vec::new();
    for (number, (motion, (_, program))) in motions.iter().zip(programs).enumerate() {
        let of = (motion.model, motion.boundary);
        let own = rest_programs(program, of, motion.task.control)?;
        all.extend(own.into_iter().map(|one| (number, one)));
    }
    Ok(all)
}

/// The multipliers of the program of a motion.
pub(super) fn multipliers_of(places: &Places, number: usize, whole: &Multipliers) -> Multipliers {
    Multipliers {
        constraints: whole.constraints[places.rows(number)].to_vec(),
        lower: places.multipliers_of(number, &whole.lower),
        upper: places.multipliers_of(number, &whole.upper),
    }
}

/// Programs of motions with their points, and their states of rest.
pub(super) struct Programs<'m> {
    pub(super) programs: Vec<(String, Transcription<'m>)>,
    pub(super) points: Vec<StartingPoint>,
    pub(super) rest: Vec<(usize, RestProgram<'m>)>,
}

/// Programs as one, and the point of all of them.
pub(super) fn joined<'m>(
    whole: Programs<'m>,
    shared: &[SharedVariable],
    combined: Combined,
) -> (Joined<Transcription<'m>>, StartingPoint) {
    let Programs {
        mut programs,
        mut points,
        rest,
    } = whole;
    let motions = programs.len();
    for (number, one) in rest {
        let name = &programs[number].0;
        let of = if name.is_empty() { "" } else { ": " };
        let name = format!("{name}{of}state of rest at the {}", one.end);
        programs.push((name, one.program));
        points.push(one.point);
    }
    let program = Joined::new(programs, shared).with_objectives_of(motions);
    let mut program = match combined {
        Combined::Sum => program,
        Combined::Worst => program.with_worst(),
    };
    let mut point = joined_point(program.places(), &points);
    let StartingPoint { x, costates } = &mut point;
    program.complete(x, costates.as_mut().map(|all| &mut all.constraints));
    (program, point)
}

/// The point of several programs as one; with multipliers where all of them have some.
fn joined_point(places: &Places, points: &[StartingPoint]) -> StartingPoint {
    let x: Vec<&[f64]> = points.iter().map(|point| &*point.x).collect();
    let all = points.iter().map(|point| point.costates.as_ref());
    let all: Option<Vec<&Multipliers>> = all.collect();
    let of = |list: fn(&Multipliers) -> &Vec<f64>, all: &[&Multipliers]| {
        let lists: Vec<&[f64]> = all.iter().map(|one| &**list(one)).collect();
        places.multipliers(&lists)
    };
    StartingPoint {
        x: places.values(&x),
        costates: all.map(|all| Multipliers {
            constraints: all
                .iter()
                .flat_map(|one| one.constraints.iter().copied())
                .collect(),
            lower: of(|one| &one.lower, &all),
            upper: of(|one| &one.upper, &all),
        }),
    }
}
