//! Construction of the model of a system: presolve, coordinates, terms and constraints, measures.

use crate::coordinates::{CoordinateMap, Reduced};
use crate::energy::{CoordinateSpring, CoordinateStops};
use crate::functional::{Element, Functional, Term};
use crate::kinematics::{MaterialVector, Pose, Vectors};
use crate::math::Matrix;
use crate::mesh::grid::Grid;
use crate::model::analysis::{Analysis, Coordinates, ModelError};
use crate::model::components::{Load, body, circuit, muscle};
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::Sought;
use crate::model::layout::internal::Internals;
use crate::model::layout::named::Named;
use crate::model::layout::solids::Solids;
use crate::model::layout::variables::{Role, Size, Time, Variable, Variables};
use crate::model::model::{Model, length};
use crate::model::presolve::graph::Graph;
use crate::model::presolve::loops::Loops;
use crate::model::presolve::prescribed;
use crate::model::presolve::presolved::{Presolved, clamp};
use crate::model::presolve::tree_drifts;
use crate::model::quantities::measures;
use crate::model::quantities::measures::Measures;
use crate::model::quantities::quantity::Quantity;
use crate::model::system::joints::{JointReading, triad};
use crate::model::system::{
    Attachment, Body, Discretisation, Electrode, Fidelity, Glue, JointSpring, JointStops, Marker,
    Muscle, Potential, Solid, Source, System,
};
use crate::model::term_order::rank;
use crate::model::terms::constraints;
use crate::model::terms::field_extent;
use crate::model::terms::joint_constraints;
use crate::model::terms::loads;
use crate::model::terms::{GRAVITY, LeftOut, Present, Terms, mid, settle};
use nalgebra::Vector3;
use std::collections::BTreeSet;
use std::sync::Arc;

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
    /// Reduced coordinates were asked for and do not exist.
    pub fn for_analysis(system: System, analysis: Analysis) -> Result<Self, ModelError> {
        let presolved = Presolved::new(&system, &analysis);
        Self::of_presolved(system, analysis, presolved)
    }

    /// Builds the same model from what remains of the system, which depends neither on coordinates nor on quantities of the analysis.
    ///
    /// # Errors
    /// Reduced coordinates were asked for and do not exist.
    pub fn of_presolved(
        system: System,
        analysis: Analysis,
        mut presolved: Presolved,
    ) -> Result<Self, ModelError> {
        let inputs = acting(&system, &presolved, &analysis);
        let reached = reached(&system, &analysis, &inputs);
        let solids = blocks(&mut presolved);
        let rest = &presolved.system;
        let coordinates = Self::choose(rest, analysis.coordinates)?;
        let (graph, reference) = (Graph::new(rest), poses(rest));
        let sources = system.sources();
        let mut vectors = Vectors::default();
        let mut variables = interval_variables(&inputs, &sources, &analysis);
        let blocks = Solids::new(
            solids,
            &system,
            &analysis,
            &reference,
            coordinates == Coordinates::Redundant,
            &mut variables,
            &mut vectors,
        )?;
        let internals =
            Internals::new(&system, &presolved, &analysis, coordinates, &graph, &blocks);
        let size = length(rest, &blocks.nodes);
        let loops = Loops::new(coordinates, rest, &graph, &reference, size)?;
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
        };
        let spans = construction.spans(&mut vectors);
        let (intervals, made) = construction.sums(&spans, &variables, &mut vectors);
        let markers = construction.markers(&mut vectors);
        let present = &made.present;
        let measures =
            construction.measures(&variables, &markers, &intervals, present, &mut vectors);
        let list = vectors.list();
        let map = construction.coordinate_map(list, made.multipliers.len());
        let scalars = variables.of(Time::Interval).len();
        let intervals = Functional::new(intervals, measures.intervals, list.len(), scalars);
        let count = made.multipliers.len();
        let instants = Functional::new(made.terms, measures.instants, list.len(), count);
        construction.name_unknowns(&map, made.multipliers, &mut variables);
        Ok(Self {
            coordinates,
            action: Reduced::new(map, intervals, instants),
            vectors: list.to_vec(),
            variables,
            reached,
            sources,
            solids: blocks.list,
            electrode_circuits: blocks.circuits,
            nodes: blocks.nodes,
            node_names: blocks.names,
            prescribed: prescribed::prescribed(&system, &presolved, &internals),
            internals: internals.list,
            of_elements: internals.of_elements,
            spans,
            markers,
            measured: measures.places,
            joint_readings: Self::joint_readings(&system, &presolved),
            multiplier_time: analysis.interval,
            graph,
            reference,
            loops,
            present: made.present,
            left_out: made.left_out,
            system,
            analysis,
            presolved,
        })
    }

    /// Returns the readings of the joint coordinates of the scene from the poses of its bodies.
    fn joint_readings(system: &System, presolved: &Presolved) -> Vec<JointReading> {
        let reference = poses(system);
        let coordinates = presolved.system.joint_coordinates();
        let reading = |(j, joint)| {
            let coordinate = presolved.joint(j).and_then(|kept| coordinates[kept]);
            JointReading::new(joint, coordinate, &reference)
        };
        system.joints.iter().enumerate().map(reading).collect()
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

/// Poses of the bodies in the reference configuration.
fn poses(system: &System) -> Vec<Pose> {
    system.bodies.iter().map(Body::pose).collect()
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

/// A scene with what remains of it, from which the parts of a model are constructed.
struct Construction<'a> {
    system: &'a System,
    presolved: &'a Presolved,
    analysis: &'a Analysis,
    coordinates: Coordinates,
    /// Poses of the bodies that remain.
    reference: &'a [Pose],
    blocks: &'a Solids,
    internals: &'a Internals,
    loops: &'a Loops,
    graph: &'a Graph,
}

impl Construction<'_> {
    /// The free parameters.
    fn sought(&self, variables: &Variables) -> Sought {
        let parameters = &self.analysis.parameters;
        let (system, presolved) = (self.system, self.presolved);
        let drifts =
            tree_drifts::of_tree(parameters, system, presolved, self.graph, self.reference);
        Sought::new(parameters, variables.range(Role::Parameter).start, drifts)
    }

    /// Vector of the span of each muscle.
    fn spans(&self, vectors: &mut Vectors) -> Vec<usize> {
        let carriers = self.presolved.carriers(self.reference);
        let span = |m: &Muscle| {
            let [from, to] = [&m.from, &m.to].map(|end| carriers.point(end));
            vectors.index(MaterialVector::span(&from, &to))
        };
        self.system.muscles.iter().map(span).collect()
    }

    /// Terms of an interval in the order of the plan, and of an instant with the reasons for all.
    fn sums(
        &self,
        spans: &[usize],
        variables: &Variables,
        vectors: &mut Vectors,
    ) -> (Vec<Arc<dyn Term>>, constraints::Made) {
        let (terms, mut present, mut left_out) = self.terms(spans, variables, vectors);
        let made = self.constraints(vectors);
        present.extend(made.present);
        left_out.extend(made.left_out);
        settle(&present, &mut left_out, rank);
        let made = constraints::Made {
            present,
            left_out,
            ..made
        };
        (terms.into_iter().map(Arc::from).collect(), made)
    }

    /// Terms of an interval in the order of the plan, and the reasons for those that are present and for those that are not.
    fn terms(
        &self,
        spans: &[usize],
        variables: &Variables,
        vectors: &mut Vectors,
    ) -> (Vec<Box<dyn Term>>, Vec<Present>, Vec<LeftOut>) {
        let system = self.system;
        let (presolved, reference, sought) =
            (self.presolved, self.reference, self.sought(variables));
        let mut terms = presolved.no_terms(reference, self.analysis, sought, variables, vectors);
        body::build(&self.presolved.system.bodies, self.reference, &mut terms);
        body::build_sought(&system.bodies, &mut terms);
        muscle::build(&system.muscles, spans, self.internals, &mut terms);
        circuit::build(&system.muscles, spans, self.internals, &mut terms);
        circuit::build_electrodes(&self.blocks.circuits, self.internals, &mut terms);
        self.blocks.build(self.internals, &mut terms);
        let no_weight = match system.gravity {
            None => "the scene names no gravity",
            Some(_) => "nothing that moves has a mass",
        };
        terms.without(GRAVITY, no_weight);
        joint_constraints::build_dampers(
            self.presolved,
            self.reference,
            self.coordinates,
            &mut terms,
        );
        add_joint_springs(self.presolved, self.internals, &mut terms);
        loads::build(
            system,
            self.presolved,
            self.internals,
            self.blocks,
            spans,
            &mut terms,
        );
        system.components.build(&mut terms);
        terms.finish(rank)
    }

    /// Constraints of an instant.
    fn constraints(&self, vectors: &mut Vectors) -> constraints::Made {
        match self.coordinates {
            Coordinates::Reduced => constraints::Made::none(),
            Coordinates::Redundant => constraints::Builder {
                system: &self.presolved.system,
                reference: self.reference,
                vectors,
                blocks: self.blocks,
                internals: self.internals,
                loops: self.loops,
            }
            .constraints(self.analysis.interval),
        }
    }

    /// Vector of each marker.
    fn markers(&self, vectors: &mut Vectors) -> Vec<usize> {
        let mut vector = |marker: &Marker| match marker.solid {
            Some(solid) => self.blocks.list[solid].nearest(&marker.point.at),
            None => {
                let Attachment { body, at } = &marker.point;
                vectors.index(MaterialVector::point(*body, at, self.reference))
            }
        };
        let markers = self.presolved.system.markers.iter();
        markers.map(&mut vector).collect()
    }

    /// Measures of the quantities of the analysis, from variables, markers, terms of the intervals and what is present.
    fn measures(
        &self,
        variables: &Variables,
        markers: &[usize],
        terms: &[Arc<dyn Term>],
        present: &[Present],
        vectors: &mut Vectors,
    ) -> Measures {
        let known = measures::Known {
            system: self.system,
            analysis: self.analysis,
            presolved: self.presolved,
            internals: self.internals,
            reference: self.reference,
            variables,
            markers,
            blocks: &self.blocks.list,
            circuits: &self.blocks.circuits,
            terms,
            sought: self.sought(variables),
            is_glued: present.iter().any(|one| one.term == constraints::GLUE),
        };
        Measures::new(self.analysis, &known, vectors)
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

    /// Adds the unknowns of an instant to the variables: coordinates, then multipliers.
    fn name_unknowns(
        &self,
        map: &CoordinateMap,
        multipliers: Vec<String>,
        variables: &mut Variables,
    ) {
        let named = Named {
            coordinates: self.coordinates,
            system: &self.presolved.system,
            graph: self.graph,
            map,
            nodes: &self.blocks.names,
            solids: &self.blocks.list,
            internals: &self.internals.list,
        };
        (0..map.coordinates).for_each(|i| _ = variables.add(named.coordinate(i)));
        let multiplier = |name| Variable::with_role(Role::Multiplier, name, Size::Unknown);
        multipliers
            .into_iter()
            .for_each(|name| _ = variables.add(multiplier(name)));
    }
}

/// Voltages, loads and parameters, the first scalars of an interval.
pub(super) fn interval_variables(
    inputs: &[usize],
    sources: &[Source],
    analysis: &Analysis,
) -> Variables {
    let mut variables = Variables::default();
    for &source in inputs {
        let Source { name, kind, .. } = &sources[source];
        variables.add(Variable::input(source, *kind, name.clone()));
    }
    for parameter in &analysis.parameters {
        variables.add(Variable::parameter(parameter.name.clone()));
    }
    variables
}

const ELASTICITY: &str = "joint elasticity";
const STOPS: &str = "joint stops";

/// Springs and stops of the joints of a presolved system.
pub(super) fn add_joint_springs(
    presolved: &Presolved,
    internals: &Internals,
    terms: &mut Terms<'_>,
) {
    let joints = presolved.system.joints.iter().zip(&presolved.joints);
    for (index, (joint, &of_scene)) in joints.enumerate() {
        if let (Some(spring), Some(coordinate)) = (joint.spring, internals.joint(index)) {
            let JointSpring { stiffness, rest } = spring;
            let mut read = terms.sought().read();
            let law = CoordinateSpring {
                stiffness: read.constant(Constant::JointStiffness(of_scene), stiffness),
                rest: read.constant(Constant::JointRest(of_scene), rest),
            };
            let coordinate = terms.vector(coordinate);
            let element = read.element(law, [mid(coordinate)], []);
            terms.add_law(ELASTICITY, "stiffness of", &joint.name, element);
        }
        if let (Some(stops), Some(coordinate)) = (joint.stops, internals.joint(index)) {
            let JointStops {
                stiffness,
                at,
                smoothing,
            } = stops;
            let energy = CoordinateStops {
                stiffness,
                at,
                smoothing,
            };
            let element = Element {
                energy,
                vectors: [mid(terms.vector(coordinate))],
                scalars: [],
            };
            terms.add(STOPS, "stops of", &joint.name, element);
        }
    }
    terms.without(ELASTICITY, "no joint that moves names a stiffness");
    terms.without(STOPS, "no joint that moves names stops");
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
        velocities: Vec::new(),
        prestretch: stretches.map(|[across, along]| {
            frame * Matrix::from_diagonal(&[across, across, along].into()) * frame.transpose()
        }),
        mesh: mesh.transformed(|x| muscle.from.at + frame * x),
    }
}
