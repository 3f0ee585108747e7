//! Construction of the model of a system: presolve, coordinates, terms and constraints, measures.

use crate::coordinates::{CoordinateMap, Reduced};
use crate::functional::{Functional, Term};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Matrix;
use crate::mesh::grid::Grid;
use crate::model::analysis::{Analysis, Coordinates, ModelError};
use crate::model::components::{Load, body, circuit, muscle};
use crate::model::constants::free_parameters::Sought;
use crate::model::construction::Construction;
use crate::model::layout::contact_reading::ContactReading;
use crate::model::layout::internal::Internals;
use crate::model::layout::solids::Solids;
use crate::model::layout::variables::{Role, Size, Time, Variable, Variables};
use crate::model::model::{Model, length};
use crate::model::presolve::graph::Graph;
use crate::model::presolve::loops::Loops;
use crate::model::presolve::prescribed;
use crate::model::presolve::presolved::{Presolved, clamp};
use crate::model::presolve::tree_drifts;
use crate::model::quantities::measures::Measures;
use crate::model::quantities::quantity::Quantity;
use crate::model::system::joints::{JointReading, triad};
use crate::model::system::{
    Body, Discretisation, Electrode, Fidelity, Glue, Muscle, Potential, Solid, Source, System,
};
use crate::model::term_order::{rank, settle};
use crate::model::terms::GRAVITY;
use crate::model::terms::constraints::Constraints;
use crate::model::terms::field_extent;
use crate::model::terms::loads;
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::sync::Arc;

impl Model {
    /// Builds the model of a system for intervals of about `h0` ms, in which `quantities` can be measured, any voltage may act
    /// and anything may be set in motion.
    ///
    /// Without a choice the coordinates are reduced.
    ///
    /// # Errors
    /// A loop is closed in the reference only, or an element of a mesh is inverted.
    pub fn new(
        system: System,
        coordinates: Option<Coordinates>,
        h0: f64,
        quantities: &[Quantity],
    ) -> Result<Self, ModelError> {
        let analysis = Analysis {
            coordinates,
            quantities: quantities.to_vec(),
            ..Analysis::of_motion(h0)
        };
        Self::for_analysis(system, analysis)
    }

    /// Builds the model of the terms that an analysis needs, and of no others.
    ///
    /// # Errors
    /// As of [`new`](Self::new).
    pub fn for_analysis(system: System, analysis: Analysis) -> Result<Self, ModelError> {
        let presolved = Presolved::new(&system, &analysis);
        Self::of_presolved(system, analysis, presolved)
    }

    /// Builds the same model from what remains of the system, which depends neither on coordinates nor on quantities of the analysis.
    ///
    /// # Errors
    /// As of [`new`](Self::new).
    pub fn of_presolved(
        system: System,
        analysis: Analysis,
        mut presolved: Presolved,
    ) -> Result<Self, ModelError> {
        let inputs = acting(&system, &presolved, &analysis);
        let reached = reached(&system, &analysis, &inputs);
        let solids = blocks(&mut presolved);
        let rest = &presolved.system;
        let coordinates = analysis.coordinates.unwrap_or(Coordinates::Reduced);
        let (graph, reference) = (Graph::new(rest), poses(rest));
        let mut vectors = Vectors::default();
        let mut variables = interval_variables(&inputs, &system, &analysis);
        let blocks = Solids::new(
            solids,
            &system,
            &analysis,
            &reference,
            coordinates == Coordinates::Redundant,
            &mut variables,
            &mut vectors,
        )?;
        let internals = Internals::new(&system, &presolved, &analysis, &graph, &blocks, &vectors);
        let loops = Loops::new(rest, &graph, &reference, length(rest, &blocks.nodes))?;
        let spans = spans(&system, &presolved, &reference, &mut vectors);
        let construction = Construction {
            system: &system,
            presolved: &presolved,
            analysis: &analysis,
            coordinates,
            reference: &reference,
            blocks: &blocks,
            internals: &internals,
            loops: &loops,
            graph: &graph,
            variables: &variables,
            spans: &spans,
            sought: sought(
                &analysis, &system, &presolved, &graph, &reference, &variables,
            ),
        };
        let (intervals, made, contacts) = construction.sums(&mut vectors);
        let measures = Measures::new(&construction, &intervals, &made.present, &mut vectors);
        let list = vectors.list();
        let (count, scalars) = (made.multipliers.len(), variables.of(Time::Interval).len());
        let map = construction.coordinate_map(list, count);
        let intervals = Functional::new(intervals, measures.intervals, list.len(), scalars);
        let instants = Functional::new(made.terms, measures.instants, list.len(), count);
        let unknowns = construction.unknowns(&map, made.multipliers);
        unknowns.into_iter().for_each(|one| _ = variables.add(one));
        Ok(Self {
            coordinates,
            action: Reduced::new(map, intervals, instants),
            vectors: list.to_vec(),
            variables,
            reached,
            sources: system.sources(),
            solids: blocks.list,
            electrode_circuits: blocks.circuits,
            nodes: blocks.nodes,
            node_names: blocks.names,
            prescribed: prescribed::prescribed(&system, &presolved, &internals),
            joint_readings: Self::joint_readings(&system, &presolved, &internals),
            internals,
            spans,
            markers: measures.markers,
            measured: measures.places,
            multiplier_time: analysis.interval,
            graph,
            reference,
            loops,
            contacts,
            present: made.present,
            left_out: made.left_out,
            system,
            analysis,
            presolved,
        })
    }

    /// Returns the readings of the joint coordinates of the scene from the poses of its bodies.
    fn joint_readings(
        system: &System,
        presolved: &Presolved,
        internals: &Internals,
    ) -> Vec<JointReading> {
        let reference = poses(system);
        let reading = |(j, joint)| {
            let kept = presolved.joint(j);
            let coordinate = kept.and_then(|kept| internals.joint_coordinate(kept));
            JointReading::new(joint, coordinate, &reference)
        };
        system.joints.iter().enumerate().map(reading).collect()
    }
}

/// Poses of the bodies in the reference configuration.
fn poses(system: &System) -> Vec<Pose> {
    system.bodies.iter().map(Body::pose).collect()
}

/// Vector of the span of each muscle.
fn spans(
    system: &System,
    presolved: &Presolved,
    reference: &[Pose],
    vectors: &mut Vectors,
) -> Vec<usize> {
    let carriers = presolved.carriers(reference);
    let span = |m: &Muscle| {
        let [from, to] = [&m.from, &m.to].map(|end| carriers.point(end));
        vectors.index(MaterialVector::span(&from, &to))
    };
    system.muscles.iter().map(span).collect()
}

/// Sources whose inputs do something.
fn acting(scene: &System, presolved: &Presolved, analysis: &Analysis) -> Vec<usize> {
    let charged = |block| field_extent::charged(scene, block, &analysis.zero_inputs);
    let acts = |(source, load): &(usize, &Load)| {
        !analysis.zero_inputs.contains(source) && loads::moves(load, presolved)
    };
    let loads = scene.loads().filter(acts).map(|(source, _)| source);
    field_extent::voltages(&presolved.system, charged)
        .into_iter()
        .chain(loads)
        .collect()
}

/// Sources that would drive something if none were at zero all the time.
fn reached(system: &System, analysis: &Analysis, inputs: &[usize]) -> Vec<usize> {
    match analysis.zero_inputs.is_empty() {
        true => inputs.to_vec(),
        false => {
            let charged = |block| field_extent::charged(system, block, &BTreeSet::new());
            let loads = system.loads().map(|(source, _)| source);
            field_extent::voltages(system, charged)
                .into_iter()
                .chain(loads)
                .collect()
        }
    }
}

/// The free parameters.
fn sought(
    analysis: &Analysis,
    system: &System,
    presolved: &Presolved,
    graph: &Graph,
    reference: &[Pose],
    variables: &Variables,
) -> Sought {
    let parameters = &analysis.parameters;
    let drifts = tree_drifts::of_tree(parameters, system, presolved, graph, reference);
    Sought::new(parameters, variables.range(Role::Parameter).start, drifts)
}

impl Construction<'_> {
    /// Terms of an interval in the order of the plan, of an instant with the reasons for all, and readings of contacts.
    fn sums(
        &self,
        vectors: &mut Vectors,
    ) -> (Vec<Arc<dyn Term>>, Constraints, Vec<ContactReading>) {
        let mut terms = self.no_terms(vectors);
        body::build(&self.presolved.system.bodies, self.reference, &mut terms);
        body::build_sought(&self.system.bodies, &mut terms);
        muscle::build(self, &mut terms);
        circuit::build(self, &mut terms);
        self.blocks.build(self.internals, &mut terms);
        if self.system.gravity.is_none() {
            terms.without(GRAVITY, "the scene names no gravity");
        }
        body::build_dampers(self, &mut terms);
        body::build_springs(self, &mut terms);
        loads::build(self, &mut terms);
        terms.bristles.clone_from(&self.internals.bristles);
        self.system.components.build(&mut terms);
        let contacts = std::mem::take(&mut terms.contacts);
        let (terms, present, left_out) = terms.finish(rank);
        let mut constraints = Constraints {
            present,
            left_out,
            ..Constraints::default()
        };
        self.add_constraints(&mut constraints, vectors);
        settle(&constraints.present, &mut constraints.left_out);
        (terms, constraints, contacts)
    }

    /// The map from coordinates to material vectors.
    fn coordinate_map(&self, vectors: &[MaterialVector], multipliers: usize) -> CoordinateMap {
        let (rest, nodes) = (&self.presolved.system, &self.blocks.nodes);
        let internal = self.internals.list.len();
        match self.coordinates {
            Coordinates::Reduced => {
                let tree = self.graph.tree(rest, self.reference, vectors);
                CoordinateMap::articulated(tree, vectors, nodes, internal, multipliers)
            }
            Coordinates::Redundant => {
                CoordinateMap::redundant(rest.bodies.len(), vectors, nodes, internal, multipliers)
            }
        }
    }

    /// The unknowns of an instant: coordinates, then multipliers.
    fn unknowns(&self, map: &CoordinateMap, multipliers: Vec<String>) -> Vec<Variable> {
        let coordinates = (0..map.coordinates).map(|i| self.coordinate(map, i));
        let multiplier = |name| Variable::with_role(Role::Multiplier, name, Size::Unknown);
        coordinates
            .chain(multipliers.into_iter().map(multiplier))
            .collect()
    }
}

/// Voltages, loads and parameters, the first scalars of an interval.
pub(super) fn interval_variables(
    inputs: &[usize],
    system: &System,
    analysis: &Analysis,
) -> Variables {
    let (mut variables, sources) = (Variables::default(), system.sources());
    for &source in inputs {
        let Source { name, kind, .. } = &sources[source];
        variables.add(Variable::input(source, *kind, name.clone()));
    }
    for parameter in &analysis.parameters {
        variables.add(Variable::parameter(parameter.name.clone()));
    }
    variables
}

/// All blocks, those of the scene taken out of the presolved system; every node of a muscle that nothing moves is held.
pub(super) fn blocks(presolved: &mut Presolved) -> Vec<Solid> {
    let of_scene = std::mem::take(&mut presolved.system.solids);
    let (system, immobile) = (&presolved.system, &presolved.immobile);
    let muscles = system.muscles.iter().enumerate();
    let of_muscles = muscles.filter_map(|(source, muscle)| match muscle.fidelity {
        Fidelity::Lumped => None,
        Fidelity::FiniteElements(discretisation) => {
            let mut solid = block(source, muscle, &discretisation);
            if immobile.muscles[source] {
                clamp(&mut solid);
            }
            Some(solid)
        }
    });
    of_scene.into_iter().chain(of_muscles).collect()
}

/// A muscle as a pile of layers, glued to both bodies. A layer of the model stands for many of the muscle: its voltage is
/// larger by the ratio of thicknesses, so that the field is the same.
fn block(source: usize, muscle: &Muscle, discretisation: &Discretisation) -> Solid {
    let Discretisation {
        elements,
        layers,
        element,
        first_side,
    } = *discretisation;
    let span = muscle.to.at - muscle.from.at;
    let (length, axis) = (span.norm(), span.normalize());
    let first = match first_side {
        Some(side) => (side - axis * axis.dot(&side)).normalize(),
        None => triad(&axis)[0],
    };
    let frame = Matrix::from_columns(&[first, axis.cross(&first), axis]);
    let stretches = muscle.stretches();
    let across = stretches.map_or(1.0, |[across, _]| across);
    let [a, b] = muscle.cross_section.map(|side| side * across);
    let corner = Vector3::new(-0.5 * a, -0.5 * b, 0.0);
    let grid = Grid::uniform(corner, Vector3::new(a, b, length), elements);
    let mesh = grid.mesh();
    let electrode = |layer: usize| {
        let place = length * layer as f64 / layers as f64;
        let driven = layer % 2 == 1;
        Electrode {
            name: format!("electrode{}", layer + 1),
            nodes: mesh.nodes_on_plane(2, place, 1e-9 * length),
            potential: match driven {
                true => Potential::Driven {
                    source,
                    factor: muscle.length() / layers as f64 / muscle.layer_thickness,
                },
                false => Potential::Given(0.0),
            },
            circuit: None,
        }
    };
    let is_dielectric = muscle.material.electric.is_some();
    let glue = |face: &str, body: Option<usize>| Glue {
        nodes: mesh.sets[face].clone(),
        body,
    };
    Solid {
        name: muscle.name.clone(),
        materials: vec![muscle.material],
        element,
        electrodes: match is_dielectric {
            true => (0..=layers).map(electrode).collect(),
            false => Vec::new(),
        },
        supports: Vec::new(),
        glued: vec![
            glue("z_min", muscle.from.body),
            glue("z_max", muscle.to.body),
        ],
        tied: Vec::new(),
        velocities: Vec::new(),
        thickness: None,
        prestretch: stretches.map(|[across, along]| {
            frame * Matrix::from_diagonal(&[across, across, along].into()) * frame.transpose()
        }),
        mesh: mesh.transformed(|x| muscle.from.at + frame * x),
    }
}
