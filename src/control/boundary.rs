//! Start and goal: the coordinates that they give, the equations that they add, and the voltages at rest.

use crate::control::conditions::{BoundaryConditions, Rests, TerminalState};
use crate::control::ends;
use crate::control::energy_cost::sources;
use crate::control::error::BoundaryError;
use crate::control::goal_rows;
use crate::control::limits::Limits;
use crate::control::problem::{BoundaryState, Control, Rest};
use crate::control::rest::rest_at;
use crate::control::sought;
use crate::control::transcription::count::overdetermined;
use crate::control::transcription::layout::Layout;
use crate::dynamics::{Start, muscle_without_length};
use crate::functional::Order;
use crate::model::{Analysis, Coordinates, Graph, Model, Presolved, Quantity, Role, System};

impl BoundaryConditions {
    /// Builds the model of a control problem and resolves its start and goal.
    ///
    /// # Errors
    /// The model does not exist in the coordinates, or a state of rest does not exist.
    pub fn resolve(
        system: &System,
        control: &Control,
        h0: f64,
    ) -> Result<(Model, Self), BoundaryError> {
        let (model, boundary) = Self::of_goal(system, control, h0)?;
        let goal = match model.solids.is_empty() {
            true => None,
            false => control.goal.resting(Rest::Bodies),
        };
        let Some(goal) = goal else {
            return Ok((model, boundary));
        };
        let layout = Layout::new(&model, &boundary, control, control.intervals);
        let Some(error) = overdetermined(&layout, &model, control.intervals) else {
            return Ok((model, boundary));
        };
        let names_markers = matches!(goal, BoundaryState::Markers { .. });
        if !names_markers && model.action.motion.of_bodies == 0 {
            return Err(error);
        }
        let eased = Control {
            goal,
            ..control.clone()
        };
        let (model, mut boundary) = Self::of_goal(system, &eased, h0)?;
        boundary.notes.push(format!(
            "{} voltages cannot bring all {} coordinates of elastic blocks and bodies to rest: at the goal {} rest, as by \"rest\": \"bodies\"",
            layout.unknowns.voltages.len(),
            model.coordinate_count(),
            if names_markers { "bodies and its markers" } else { "bodies" },
        ));
        Ok((model, boundary))
    }

    /// The same, where everything rests unless the goal says otherwise.
    fn of_goal(
        system: &System,
        control: &Control,
        h0: f64,
    ) -> Result<(Model, Self), BoundaryError> {
        let system = &sought::at_guess(system, control)?;
        let question = control.question(system, h0);
        let presolved = Presolved::new(system, &question);
        let coordinates = Model::choose(&presolved.system, control.coordinates)?;
        let redundant = coordinates == Coordinates::Redundant;
        let mut limits = Limits::new(&control.limits, system, redundant);
        let all_joints = all_joints_given(system, &control.goal);
        match &control.goal {
            BoundaryState::Markers {
                places,
                orientations,
                rest,
                ..
            } => {
                goal_rows::add_places(&mut limits, system, places, *rest == Rest::Bodies);
                goal_rows::add_orientations(&mut limits, system, orientations);
            }
            BoundaryState::JointAngles { angles, .. } if redundant && !all_joints => {
                for (&joint, &near) in angles {
                    let name = format!("goal of {}", system.joints[joint].name);
                    limits.add_goal(Quantity::Joint { joint, near }, near, name);
                }
            }
            _ => {}
        }
        let mut quantities = limits.quantities();
        let paid = &control.objective.quantities;
        let curved = paid.iter().enumerate().filter(|(_, c)| c.is_curved());
        let question = Analysis {
            coordinates: Some(coordinates),
            curved: curved.map(|(i, _)| quantities.len() + i).collect(),
            quantities: {
                quantities.extend(paid.iter().map(|cost| cost.quantity));
                let charged = sources(&control.objective.energies).into_iter();
                quantities.extend(charged.map(|muscle| Quantity::Capacitance { muscle }));
                quantities
            },
            ..question
        };
        let mut model = Model::of_presolved(system.clone(), question, presolved)?;
        let mut scalars = [None, None];
        let start = match &control.start {
            BoundaryState::RestAtVoltages(voltages, _) => {
                let rest = rest_at(&model, voltages, "start")?;
                scalars[0] = Some(rest.scalars);
                at_rest(&model, rest.z)
            }
            state => resolve_start(&model, state, "start")?,
        };
        goal_rows::leave_out_constant(&mut model, &limits, &start.z)?;
        let n = model.coordinate_count();
        let mut given = vec![None; n];
        let mut at_goal = None;
        match &control.goal {
            BoundaryState::RestAtVoltages(voltages, of) => {
                let rest = rest_at(&model, voltages, "goal")?;
                scalars[1] = Some(rest.scalars.clone());
                let reached = match of {
                    Rest::Everything | Rest::Attainable => n,
                    Rest::Bodies => model.action.motion.of_bodies.min(n),
                };
                for (given, value) in given.iter_mut().zip(&rest.z[..reached]) {
                    *given = Some(*value);
                }
                at_goal = Some(rest);
            }
            BoundaryState::JointAngles { angles, .. } if redundant && all_joints => {
                let joints: Vec<f64> = (0..system.joints.len())
                    .map(|j| angles.get(&j).copied().unwrap_or(0.0))
                    .collect();
                let z = model.coordinates_at(&joints);
                given = z[..n].iter().copied().map(Some).collect();
            }
            BoundaryState::JointAngles { angles, .. } if !redundant => {
                for (&joint, &value) in angles {
                    if let Some(c) = model.gauges[joint].coordinate {
                        given[c] = Some(value);
                    }
                }
            }
            _ => {}
        }
        if let Some(z) = given.iter().copied().collect::<Option<Vec<f64>>>() {
            check_muscles(&model, &z, "goal")?;
        }
        let rest = [&control.start, &control.goal].map(BoundaryState::voltages);
        let rest = rest.map(|voltages| voltages.map(<[f64]>::to_vec));
        let boundary = Self {
            start,
            goal: TerminalState {
                coordinates: given,
                rests: match &control.goal {
                    BoundaryState::Free => Rests::Nothing,
                    BoundaryState::Markers {
                        rest: Rest::Bodies, ..
                    }
                    | BoundaryState::RestAtVoltages(_, Rest::Bodies) => Rests::Bodies,
                    _ => Rests::Everything,
                },
                rest: at_goal,
            },
            rest,
            limits,
            notes: Vec::new(),
        };
        let rest = boundary.goal.rest.as_ref();
        let ends = [Some(&boundary.start.z[..]), rest.map(|rest| &rest.z[..])];
        sought::check(&model, control, ends)?;
        ends::check(&model, &boundary, control, scalars)?;
        Ok((model, boundary))
    }
}

/// Returns true if a goal gives all coordinates of a tree, each the only one of its joint.
fn all_joints_given(system: &System, goal: &BoundaryState) -> bool {
    let BoundaryState::JointAngles { angles, .. } = goal else {
        return false;
    };
    let coordinates = system.joint_coordinates();
    let named = |(j, c): (usize, &Option<usize>)| c.is_none() || angles.contains_key(&j);
    Graph::new(system).has_one_coordinate_a_joint(system)
        && coordinates.iter().enumerate().all(named)
}

/// A start at coordinates of rest; nodes may have velocities of their own.
fn at_rest(model: &Model, z: Vec<f64>) -> Start {
    match model.node_rates() {
        Some(rates) => Start::with_rates(model, z, &rates),
        None => Start::at_rest(model, z),
    }
}

/// Coordinates and momenta of a start.
///
/// # Errors
/// There is no equilibrium, or joint coordinates do not fit the loops of the scene.
pub fn resolve_start(
    model: &Model,
    state: &BoundaryState,
    place: &'static str,
) -> Result<Start, BoundaryError> {
    match state {
        BoundaryState::RestAtVoltages(voltages, _) => {
            Ok(at_rest(model, rest_at(model, voltages, place)?.z))
        }
        BoundaryState::JointAngles {
            angles,
            rates,
            velocities,
        } => {
            let value = |map: &std::collections::BTreeMap<usize, f64>, j: usize| {
                map.get(&j).copied().unwrap_or(0.0)
            };
            let joints = |map| {
                (0..model.gauges.len())
                    .map(|j| value(map, j))
                    .collect::<Vec<f64>>()
            };
            let z = model.coordinates_at(&joints(angles));
            check_constraints(model, &z, place)?;
            check_muscles(model, &z, place)?;
            let of_joints = joints(rates);
            let rates = model.rates_at(&joints(angles), &of_joints, velocities);
            let rates = rates.map_err(|body| BoundaryError::Follows {
                place,
                body: model.system.bodies[body].name.clone(),
            })?;
            let rates = model.rates_of_all(&rates, &of_joints);
            Ok(Start::with_rates(model, z, &rates))
        }
        BoundaryState::EndOf(end) => {
            let start = end
                .start(model)
                .map_err(|reason| BoundaryError::OtherEnd { place, reason })?;
            check_muscles(model, &start.z, place)?;
            Ok(start)
        }
        BoundaryState::Markers { .. } | BoundaryState::Free => unreachable!("it is a goal only"),
    }
}

/// Checks that no muscle has lost its length at coordinates.
fn check_muscles(model: &Model, z: &[f64], place: &'static str) -> Result<(), BoundaryError> {
    match muscle_without_length(model, z) {
        None => Ok(()),
        Some(muscle) => Err(BoundaryError::NoLength {
            place,
            muscle: model.system.muscles[muscle].name.clone(),
        }),
    }
}

/// Checks the constraints that the coordinates leave open.
fn check_constraints(model: &Model, z: &[f64], place: &'static str) -> Result<(), BoundaryError> {
    let mut instant = model.action.motion.instant();
    let mut scratch = model.action.scratch(Order::Gradient);
    instant.z.copy_from_slice(z);
    model.action.motion.place(&mut instant);
    model
        .action
        .evaluate_instant(Order::Gradient, &mut instant, &[], &mut scratch);
    let rows = &scratch.instant.plain.rows;
    let worst = (0..rows.len()).max_by(|&a, &b| rows[a].abs().total_cmp(&rows[b].abs()));
    let Some(worst) = worst else { return Ok(()) };
    let value = rows[worst].abs() / model.multiplier_time;
    if value > 1e-9 * model.length() {
        return Err(BoundaryError::Inconsistent {
            place,
            name: model.variables.with(Role::Multiplier)[worst].name.clone(),
            value,
        });
    }
    Ok(())
}
