//! A motion of a program, and the states of rest beside it.

use crate::control::problem::Control;
use crate::control::{
    BoundaryConditions, BoundaryError, RestProgram, Transcription, rest_programs,
};
use crate::model::Model;

/// A motion of a program.
#[derive(Clone, Copy)]
pub(crate) struct ProgramMotion<'m> {
    pub(crate) name: &'m str,
    pub(crate) model: &'m Model,
    pub(crate) boundary: &'m BoundaryConditions,
    pub(crate) control: &'m Control,
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
        let own = rest_programs(program, of, motion.control)?;
        all.extend(own.into_iter().map(|one| (number, one)));
    }
    Ok(all)
}
