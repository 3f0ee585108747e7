//! Construction of the model of a system: presolve, coordinates, terms and constraints, measures.

use crate::coordinates::{CoordinateMap, Reduced};
use crate::functional::Functional;
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::model::analysis::{Analysis, Coordinates};
use crate::model::components::{body, muscle};
use crate::model::error::ModelError;
use crate::model::graph::Graph;
use crate::model::internal::Internals;
use crate::model::joints::JointReading;
use crate::model::measures::{self, Measures};
use crate::model::model::Model;
use crate::model::named::Named;
use crate::model::presolved::Presolved;
use crate::model::quantity::Quantity;
use crate::model::solids::Solids;
use crate::model::system::{Attachment, Body, Muscle, System};
use crate::model::terms::{Carriers, Terms};
use crate::model::variables::{Role, Size, Time, Variable, Variables};
use crate::model::{blocks, constraints, dampers, field_extent, joint_springs, plan};

impl Model {
    /// Builds the model of a system for intervals of about `h0` ms, in which `quantities` can be measured, any voltage may act
    /// and anything may be set in motion.
    ///
    /// Without a choice the coordinates are reduced where the joints form a tree.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn new(
        system: System,
        coordinates: Option<Coordinates>,
        h0: f64,
        quantities: &[Quantity],
    ) -> Result<Self, ModelError> {
        let question = Analysis {
            coordinates,
            quantities: quantities.to_vec(),
            ..Analysis::of_motion(h0)
        };
        Self::answering(system, question)
    }

    /// Builds the model of the terms that an analysis needs, and of no others.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn answering(system: System, question: Analysis) -> Result<Self, ModelError> {
        let condensed = Presolved::new(&system, &question);
        Self::of_presolved(system, question, condensed)
    }

    /// Builds the same model from what remains of the system, which depends neither on coordinates nor on quantities of the question.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn of_presolved(
        system: System,
        question: Analysis,
        mut condensed: Presolved,
    ) -> Result<Self, ModelError> {
        let voltages = field_extent::voltages(&condensed.system);
        let reached = match question.zero_voltage.is_empty() {
            true => voltages.clone(),
            false => field_extent::voltages(&system),
        };
        let solids = blocks::blocks(&mut condensed);
        let rest = &condensed.system;
        let coordinates = Self::choose(rest, question.coordinates)?;
        let graph = Graph::new(rest);
        let reference: Vec<Pose> = rest.bodies.iter().map(Body::pose).collect();
        let mut vectors = Vectors::default();
        let sources = system.sources();
        let mut variables = Variables::default();
        for source in voltages {
            variables.add(Variable::voltage(source, sources[source].name.clone()));
        }
        for parameter in &question.parameters {
            variables.add(Variable::parameter(parameter.name.clone()));
        }
        let ties = coordinates == Coordinates::Redundant;
        let scene = system.solids.len();
        let continua = Solids::new(
            solids,
            scene,
            &reference,
            ties,
            &mut variables,
            &mut vectors,
        )?;
        let of_bodies = match coordinates {
            Coordinates::Reduced => graph.coordinate_count(rest),
            Coordinates::Redundant => 12 * rest.bodies.len(),
        };
        let of_nodes = continua.nodes.iter().flat_map(|node| node.free);
        let mut internals = Internals::behind(of_bodies + of_nodes.filter(|&free| free).count());
        let (intervals, mut present, mut left_out, spans) = {
            let carriers = (0..system.bodies.len()).map(|body| condensed.carrier(Some(body)));
            let bodies = Carriers {
                of: carriers.collect(),
                reference: &reference,
            };
            let called = (question.of_motion, &question.parameters[..]);
            let mut terms = Terms::new(bodies, system.gravity, called, &variables, &mut vectors);
            let span = |m: &Muscle, terms: &mut Terms<'_>| {
                let span = MaterialVector::span(&terms.point(&m.from), &terms.point(&m.to));
                terms.vector(span)
            };
            let muscles = &system.muscles;
            let spans: Vec<usize> = muscles.iter().map(|m| span(m, &mut terms)).collect();
            body::build(&rest.bodies, &reference, &mut terms);
            muscle::build(muscles, &spans, &mut terms);
            continua.build(&mut terms);
            let no_weight = match system.gravity {
                None => "the scene names no gravity",
                Some(_) => "nothing that moves has a mass",
            };
            terms.without(plan::GRAVITY, no_weight);
            dampers::build(&condensed, &reference, coordinates, &mut terms);
            joint_springs::build(&condensed, coordinates, &mut internals, &mut terms);
            system.components.build(&mut terms);
            let (intervals, present, left_out) = terms.finish();
            (intervals, present, left_out, spans)
        };
        let made = match coordinates {
            Coordinates::Reduced => constraints::Made::none(),
            Coordinates::Redundant => constraints::Builder {
                system: rest,
                reference: &reference,
                vectors: &mut vectors,
                continua: &continua,
                internals: &internals,
            }
            .constraints(question.interval),
        };
        let (instants, constraints) = (made.terms, made.multipliers);
        present.extend(made.present);
        left_out.extend(made.left_out);
        plan::settle(&present, &mut left_out);
        let point = |a: &Attachment| MaterialVector::point(a.body, &a.at, &reference);
        let markers = rest
            .markers
            .iter()
            .map(|m| match m.solid {
                Some(solid) => continua.list[solid].nearest(&m.point.at),
                None => vectors.index(point(&m.point)),
            })
            .collect::<Vec<_>>();
        let measures = {
            let known = measures::Known {
                condensed: &condensed,
                reference: &reference,
                variables: &variables,
                markers: &markers,
                continua: &continua.list,
            };
            Measures::new(&question, &known, &mut vectors)
        };
        let list = vectors.list();
        let multipliers = constraints.len();
        let motion = match coordinates {
            Coordinates::Reduced => {
                let tree = graph.tree(rest, &reference, list);
                CoordinateMap::articulated(
                    tree,
                    list,
                    &continua.nodes,
                    internals.list.len(),
                    multipliers,
                )
            }
            Coordinates::Redundant => {
                let (bodies, internal) = (rest.bodies.len(), internals.list.len());
                CoordinateMap::redundant(bodies, list, &continua.nodes, internal, multipliers)
            }
        };
        let intervals = {
            let scalars = variables.of(Time::Interval).len();
            Functional::new(intervals, measures.intervals, list.len(), scalars)
        };
        let instants = Functional::new(instants, measures.instants, list.len(), multipliers);
        {
            let named = Named {
                coordinates,
                system: rest,
                graph: &graph,
                motion: &motion,
                nodes: &continua.names,
                solids: &continua.list,
                internals: &internals.list,
            };
            (0..motion.coordinates).for_each(|i| _ = variables.add(named.coordinate(i)));
            let multiplier = |name| Variable::of(Role::Multiplier, name, Size::Unknown);
            constraints
                .into_iter()
                .for_each(|name| _ = variables.add(multiplier(name)));
        }
        Ok(Self {
            coordinates,
            action: Reduced::new(motion, intervals, instants),
            vectors: list.to_vec(),
            variables,
            reached,
            sources,
            solids: continua.list,
            nodes: continua.nodes,
            node_names: continua.names,
            internals: internals.list,
            spans,
            markers,
            measured: measures.places,
            gauges: Self::gauges(&system, &condensed),
            multiplier_time: question.interval,
            graph,
            reference,
            present,
            left_out,
            system,
            analysis: question,
            presolved: condensed,
        })
    }

    /// Returns the readings of the joint coordinates of the scene from the poses of its bodies.
    fn gauges(system: &System, condensed: &Presolved) -> Vec<JointReading> {
        let reference: Vec<Pose> = system.bodies.iter().map(Body::pose).collect();
        let coordinates = condensed.system.joint_coordinates();
        let gauge = |(j, joint)| {
            let coordinate = condensed.joint(j).and_then(|kept| coordinates[kept]);
            JointReading::new(joint, coordinate, &reference)
        };
        system.joints.iter().enumerate().map(gauge).collect()
    }

    /// The coordinates of a system: those asked for, or reduced where the joints form a tree.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn choose(
        system: &System,
        coordinates: Option<Coordinates>,
    ) -> Result<Coordinates, ModelError> {
        match (coordinates, Graph::new(system).obstacle(system)) {
            (Some(Coordinates::Reduced), Some(obstacle)) => Err(obstacle),
            (Some(choice), _) => Ok(choice),
            (None, Some(_)) => Ok(Coordinates::Redundant),
            (None, None) => Ok(Coordinates::Reduced),
        }
    }
}
