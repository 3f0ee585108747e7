//! Conversion of a scene file to its system: names resolved and everything checked.

use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::scene::body::{body, check_connected};
use crate::files::scene::contact::contacts;
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::joint::joint;
use crate::files::scene::load::{Carriers, load};
use crate::files::scene::material::materials;
use crate::files::scene::muscle::muscle;
use crate::files::scene::names::{find_body, names};
use crate::files::scene::nodes::place;
use crate::files::scene::point::{unit_axis, vector};
use crate::files::scene::shape::shape;
use crate::files::scene::solid::{solid, ties};
use crate::files::scene::spec::{ChainSpec, MarkerSpec, SceneSpec};
use crate::files::scene::spring::{spring, tendon};
use crate::mesh::Mesh;
use crate::model::MOST_ELEMENTS;
use crate::model::components::Components;
use crate::model::system::{Attachment, Marker, Solid, System, number_sources};
use nalgebra::Vector3;
use std::cell::Cell;

/// Longest chain that the shorthand writes out.
pub(crate) const LONGEST_CHAIN: usize = 1000;

/// The system that a scene means.
pub(crate) fn build_scene(scene: &SceneSpec, scope: &Scope<'_>) -> Result<System> {
    let mut named = scene.clone();
    add_named(&mut named);
    let materials = materials(&named.materials, &scope.key("materials"))?;
    if let Some(chain) = &scene.chain {
        check_chain(chain, &scope.key("chain"))?;
    }
    let lists = Lists::new(scene, scope);
    let scene = expanded(named);
    check_names(&scene, &lists)?;
    let body_names = names(&scene.bodies, |body| &body.name);

    let elements = Elements::default();
    let muscles = lists.build("muscles", &scene.muscles, |spec, scope| {
        let muscle = muscle(spec, &body_names, &materials, scope)?;
        elements.add(muscle.fidelity.elements(), scope)?;
        Ok(muscle)
    })?;
    let solid_names = names(&scene.solids, |solid| &solid.name);
    let mut blocks = lists.build("solids", &scene.solids, |spec, scope| {
        let solid = solid(spec, &body_names, &solid_names, &materials, scope)?;
        elements.add(solid.mesh.element_count(), scope)?;
        Ok(solid)
    })?;
    tie(&scene, &body_names, &mut blocks, scope)?;
    number_sources(&mut blocks, muscles.len());
    let joints = lists.build("joints", &scene.joints, |spec, scope| {
        joint(spec, &body_names, scope)
    })?;
    let on = Carriers {
        bodies: &body_names,
        joints: &joints,
        muscles: &muscles,
        solids: &blocks,
    };
    let loads = lists.build("loads", &scene.loads, |spec, scope| load(spec, &on, scope))?;
    let shapes = lists.build("shapes", &scene.shapes, |spec, scope| {
        shape(spec, &body_names, &blocks, scope)
    })?;
    let pairs = lists.build("contacts", &scene.contacts, |spec, scope| {
        contacts(spec, &body_names, &shapes, scope)
    })?;
    let written = pairs.iter().enumerate();
    let written = written.flat_map(|(index, pairs)| vec![index; pairs.len()]);
    let written: Vec<usize> = written.collect();
    let system = System {
        bodies: lists.build("bodies", &scene.bodies, body)?,
        muscles,
        markers: lists.build("markers", &scene.markers, |spec, scope| {
            marker(spec, &body_names, &blocks, scope)
        })?,
        solids: blocks,
        gravity: scene
            .gravity
            .as_ref()
            .map(vector)
            .filter(|g| g.norm() > 0.0),
        components: Components {
            springs: lists.build("springs", &scene.springs, |spec, scope| {
                spring(spec, &body_names, scope)
            })?,
            tendons: lists.build("tendons", &scene.tendons, |spec, scope| {
                tendon(spec, &body_names, scope)
            })?,
            contacts: pairs.concat(),
            loads,
            others: Vec::new(),
        },
        joints,
        name: scene.name,
    };
    lists.check(&system, &written)?;
    check_connected(&scene.bodies, &system.joints, |index| {
        lists.scope("bodies", index)
    })?;
    let sources = names(&system.sources(), |source| &source.name);
    scope.unique(&sources, &[], |_| scope.key("solids"))?;
    Ok(system)
}

/// Glues solids to others, on which their nodes then depend, whatever else holds them.
fn tie(
    scene: &SceneSpec,
    bodies: &[String],
    blocks: &mut [Solid],
    scope: &Scope<'_>,
) -> Result<()> {
    let tied = ties(&scene.solids, blocks, bodies, &scope.key("solids"))?;
    for (block, tied) in blocks.iter_mut().zip(tied) {
        for support in &mut block.supports {
            let is_free = |node: &usize| tied.iter().all(|tie| tie.node != *node);
            support.nodes.retain(is_free);
        }
        block.supports.retain(|support| !support.nodes.is_empty());
        block.tied = tied;
    }
    Ok(())
}

/// Checks that names by which parts refer to each other and to files are unique.
fn check_names(scene: &SceneSpec, lists: &Lists<'_>) -> Result<()> {
    let reserved = ["solution", "time", "voltages", "hold"];
    lists.unique(
        "bodies",
        &names(&scene.bodies, |body| &body.name),
        &["ground"],
    )?;
    lists.unique("joints", &names(&scene.joints, |joint| &joint.name), &[])?;
    lists.unique(
        "muscles",
        &names(&scene.muscles, |muscle| &muscle.name),
        &reserved,
    )?;
    lists.unique("solids", &names(&scene.solids, |solid| &solid.name), &[])?;
    let mut shapes = names(&scene.shapes, |shape| &shape.name);
    lists.unique("shapes", &shapes, &[])?;
    let count = shapes.len();
    for (index, shape) in scene.shapes.iter().enumerate() {
        if let Some(group) = &shape.group {
            shapes.truncate(count);
            shapes.push(group.clone());
            lists
                .scope
                .unique(&shapes, &[], |_| lists.scope("shapes", index).key("group"))?;
        }
    }
    Ok(())
}

/// Elements counted while a scene is built.
#[derive(Default)]
struct Elements(Cell<usize>);

impl Elements {
    /// Adds those of a muscle or block, unless they are too many in all.
    fn add(&self, count: usize, scope: &Scope<'_>) -> Result<()> {
        let total = self.0.get() + count;
        self.0.set(total);
        refuse!(if total > MOST_ELEMENTS, scope;
            found format!("{total} elements with those before"),
            expected format!("no more than {MOST_ELEMENTS} elements in all"));
        Ok(())
    }
}

/// The lists of a scene as it is written; entries beyond the written ones come from the chain.
struct Lists<'a> {
    scene: &'a SceneSpec,
    scope: Scope<'a>,
}

impl<'a> Lists<'a> {
    fn new(scene: &'a SceneSpec, scope: &Scope<'a>) -> Self {
        let scope = scope.clone();
        Self { scene, scope }
    }

    /// Place of an entry of a list in the scene.
    fn place(&self, list: &str, index: usize) -> JsonPath {
        let written = match list {
            "bodies" => self.scene.bodies.len(),
            "joints" => self.scene.joints.len(),
            "muscles" => self.scene.muscles.len(),
            "markers" => self.scene.markers.len(),
            // A chain writes nothing of the others.
            _ => usize::MAX,
        };
        let root = JsonPath::default();
        match index < written {
            true => root.key(list).index(index),
            false => root.key("chain"),
        }
    }

    /// An entry of a list.
    fn scope(&self, list: &str, index: usize) -> Scope<'a> {
        let steps = self.place(list, index).0.into_iter();
        let place = steps.fold(self.scope.place.clone(), |at, step| at.then(step));
        Scope {
            place,
            ..self.scope
        }
    }

    /// Refuses names of a list that are empty, reserved or repeated.
    fn unique(&self, list: &str, names: &[String], reserved: &[&str]) -> Result<()> {
        self.scope.unique(names, reserved, |index| {
            let place = self.scope(list, index);
            match place.place.last_key() {
                None => place.key("name"),
                Some(_) => place,
            }
        })
    }

    /// The parts of a list.
    fn build<S, T>(
        &self,
        list: &str,
        specs: &[S],
        build: impl Fn(&S, &Scope<'a>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let build = |(index, spec)| build(spec, &self.scope(list, index));
        specs.iter().enumerate().map(build).collect()
    }

    /// Checks the rules of a system, whose contacts are `written` in entries of their list.
    fn check(&self, system: &System, written: &[usize]) -> Result<()> {
        system.check().map_err(|error| {
            let index = match error.list {
                "contacts" => written[error.index],
                _ => error.index,
            };
            let (mut part, mut fault) = (self.place(error.list, index), error.fault);
            let is_between = |index: usize| self.scene.contacts[index].between.is_some();
            let of_shapes = ["name", "sphere", "other", "plane"];
            match (error.list, part.last_key()) {
                // Shapes make the sides of a pair and its name.
                ("contacts", _)
                    if is_between(index)
                        && of_shapes.iter().any(|key| fault.at.starts_with(key)) =>
                {
                    fault.at = "between".into();
                }
                // A chain makes the names of its parts.
                (_, Some("chain")) if fault.at == "name" => fault.at.clear(),
                ("muscles", Some("chain")) => part = part.key("muscles"),
                _ => {}
            }
            self.scope.refuse_in(self.scene, &part, &fault)
        })
    }
}

/// Checks the entries from which a chain is written out.
fn check_chain(chain: &ChainSpec, scope: &Scope<'_>) -> Result<()> {
    refuse!(if !(1..=LONGEST_CHAIN).contains(&chain.segments), scope.key("segments");
        found chain.segments, expected format!("a whole number from 1 to {LONGEST_CHAIN}"));
    let length = scope.key("length").positive(&chain.length)?;
    scope.key("radius").positive(&chain.radius)?;
    scope.key("mass").positive(&chain.mass)?;
    let reach = length * chain.segments as f64;
    refuse!(if !reach.is_finite(), scope.key("length");
        found chain.length, expected "a finite chain");
    let axis = unit_axis(&chain.axis, &scope.key("axis"))?;
    let place = scope.key("first_joint_axis");
    let joint_axis = unit_axis(&chain.first_joint_axis, &place)?;
    refuse!(if axis.dot(&joint_axis).abs() > 1e-9, place;
        found format!("{:?}", chain.first_joint_axis),
        expected "an axis at right angles to \"axis\"");
    if let Some(pair) = &chain.muscles {
        let scope = scope.key("muscles");
        let arm = scope.key("arm").positive(&pair.arm)?;
        let rest_length = scope.key("rest_length").positive(&pair.rest_length)?;
        refuse!(if !(reach + arm + rest_length).is_finite(), scope;
            found format!("an arm of {} at a length of {}", pair.arm, pair.rest_length),
            expected "muscles in finite places");
    }
    Ok(())
}

/// The marker that is written.
pub(crate) fn marker(
    spec: &MarkerSpec,
    bodies: &[String],
    solids: &[Solid],
    scope: &Scope<'_>,
) -> Result<Marker> {
    let at = vector(&spec.at);
    let (body, solid) = the_one!(scope, spec;
        "body" body |place, name| (find_body(name, bodies, place)?, None);
        "solid" solid |place, name| {
            let all = names(solids, |solid| &solid.name);
            let solid = place.find(name, &all, "the name of a block")?;
            check_near(&solids[solid].mesh, &at, &scope.key("at"))?;
            (None, Some(solid))
        };
    );
    Ok(Marker {
        name: spec.name.clone(),
        point: Attachment { body, at },
        solid,
    })
}

/// Refuses a place that is far from all nodes.
fn check_near(mesh: &Mesh, at: &Vector3<f64>, scope: &Scope<'_>) -> Result<()> {
    let (node, distance) = nearest(mesh, at);
    let (from, to) = (place(at), place(&mesh.nodes[node]));
    refuse!(if distance.is_nan() || distance > size_at(mesh, node), scope;
        found format!("{from}, which is {distance:.3} mm away from the nearest node, at {to}"),
        expected "a place no farther from the block than the size of an element");
    Ok(())
}

/// The node nearest to a place, and its distance in mm.
fn nearest(mesh: &Mesh, at: &Vector3<f64>) -> (usize, f64) {
    let distances = mesh.nodes.iter().map(|node| (node - at).norm());
    let nearest = distances
        .enumerate()
        .min_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest.expect("a checked mesh has nodes")
}

/// The longest edge in mm of the elements at a node.
fn size_at(mesh: &Mesh, node: usize) -> f64 {
    let around = mesh.elements().filter(|nodes| nodes.contains(&node));
    let lengths = around.flat_map(|nodes| mesh.edge_lengths(nodes));
    lengths.fold(0.0, f64::max)
}
