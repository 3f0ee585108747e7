//! A static equilibrium, with its stability.

use crate::control::problem::AtRest;
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    self, DiscreteTrajectory, Equilibrium, StabilityLoss, out_of_domain, out_of_range,
    stable_equilibrium, wrinkles,
};
use crate::model::{Model, System};
use crate::stop;
use crate::tasks::check::moved_markers;
use crate::tasks::vibrations::{Vibrating, vibrating};
use crate::workflow::memory::{self, Occasion};
use crate::workflow::remark::{Remarks, phase};
use crate::workflow::warnings::{self, Outside};
use crate::workflow::{WorkflowError, infeasible};
use std::time::Instant;
use thiserror::Error;

/// Remark on what the eigenvalues of a stiffness without symmetry leave open.
const FLUTTER: &str = "loads follow what they act on, and stability is that of strongly damped motion: with little damping the state may \
                       flutter; simulate a disturbed motion to see whether it returns";

/// Reason why there is no equilibrium.
#[derive(Debug, Error)]
pub enum EquilibriumTaskError {
    /// The model does not exist, or the machine has no room for it.
    #[error(transparent)]
    Workflow(#[from] WorkflowError),
    /// No equilibrium was found.
    #[error(transparent)]
    NotFound(#[from] dynamics::EquilibriumError),
}

/// A stable equilibrium; where growing loads lose it, the last one before.
#[derive(Debug)]
pub struct EquilibriumResult {
    /// The model that rests.
    pub model: Model,
    /// The equilibrium.
    pub found: Equilibrium,
    /// The loss of stability on the way to it, after which there is no other one.
    pub loss: Option<StabilityLoss>,
    /// The equilibrium as a motion of one instant.
    pub discrete: DiscreteTrajectory,
    /// The same as positions and voltages.
    pub trajectory: Trajectory,
    /// Muscles and blocks outside the domain of their material.
    pub outside: Vec<Outside>,
    /// Vibrations about it, where they were sought and found.
    pub vibrations: Option<Vibrating>,
    /// Warnings and notes.
    pub remarks: Remarks,
    /// Seconds before the first iteration.
    pub setup: f64,
}

/// The model of an equilibrium.
///
/// # Errors
/// It does not exist in the coordinates that the task names, or the machine has no room for it.
pub(crate) fn model_at_rest(system: &System, task: &AtRest) -> Result<Model, WorkflowError> {
    memory::of_elements(system, Occasion::Rest)?;
    phase("building");
    let model = Model::for_analysis(system.clone(), task.analysis(system));
    model.map_err(|error| WorkflowError::boundary("equilibrium", &error.into()))
}

/// Finds the stable equilibrium under the voltages and loads of a task.
///
/// # Errors
/// The model does not exist, or no equilibrium was found at all. One that is lost under growing loads is no error: see the loss.
pub fn equilibrium(
    system: &System,
    task: &AtRest,
) -> Result<EquilibriumResult, EquilibriumTaskError> {
    let began = Instant::now();
    let model = model_at_rest(system, task)?;
    let setup = began.elapsed().as_secs_f64();
    phase("equilibrium");
    let start = model.reference_coordinates();
    let (found, loss) = match stable_equilibrium(&model, &start, &model.scalars(&task.voltages)) {
        Ok(found) => (found, None),
        Err(dynamics::EquilibriumError::LimitPoint { loss, last }) => (*last, Some(loss)),
        Err(error) => return Err(error.into()),
    };
    let discrete = DiscreteTrajectory {
        times: vec![0.0],
        z: vec![found.z.clone()],
        momenta: vec![vec![0.0; model.coordinate_count()]],
        scalars: vec![found.scalars.clone()],
        ..DiscreteTrajectory::default()
    };
    let outside = warnings::outside_domain(&out_of_domain(&model, &discrete));
    let mut remarks = Remarks::default();
    remarks.note("moved_marker", moved_markers(system));
    remarks.warn("singular_loops", model.loops.warning.clone());
    remarks.warn("outside_domain", warnings::domain_note(&outside, false));
    let wrinkles = wrinkles(&model, &discrete);
    remarks.warn("wrinkles", warnings::wrinkle_warning(&wrinkles, false));
    let beyond = out_of_range(&model, &discrete);
    let beyond = warnings::stretch_range_warning(&beyond, false);
    remarks.warn("outside_range", beyond);
    remarks.warn("may_flutter", found.may_flutter.then(|| FLUTTER.to_owned()));
    if let Some((_, fallbacks)) = found.on_grids {
        remarks.warn("multigrid_stalled", infeasible::stalled_warning(fallbacks));
        let is_unknown = found.is_stable().is_none();
        let undecided = || infeasible::undecided(stop::reason());
        remarks.warn("stability_unknown", is_unknown.then(undecided));
    }
    let mut vibrations = None;
    if let Some(request) = task.vibrations.as_ref().filter(|_| loss.is_none()) {
        phase("vibrations");
        match vibrating(system, task, request, &found)? {
            Ok(list) => vibrations = Some(list),
            Err(reason) => remarks.warn("no_vibrations", Some(reason)),
        }
        let notes = vibrations.iter().flat_map(|found| &found.notes).cloned();
        remarks.note("vibrations", notes);
    }
    Ok(EquilibriumResult {
        vibrations,
        trajectory: Trajectory::from_discrete(&model, &discrete),
        model,
        found,
        loss,
        discrete,
        outside,
        remarks,
        setup,
    })
}
