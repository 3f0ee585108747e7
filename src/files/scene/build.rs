//! Conversion of a scene file to its system: names resolved and everything checked.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::body::body;
use crate::files::scene::components::spring::{built, check_unique};
use crate::files::scene::components::{component_lists, load};
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::graph::check_connected;
use crate::files::scene::joint::joint;
use crate::files::scene::material::materials;
use crate::files::scene::muscle::{MOST_ELEMENTS, fidelity, layer, muscle, positive_sides};
use crate::files::scene::names::{NamedEntries, attachment, find_material, names};
use crate::files::scene::nodes::place;
use crate::files::scene::point::{unit_axis, vector};
use crate::files::scene::solid::solid;
use crate::files::scene::spec::{ChainSpec, MarkerSpec, SceneSpec};
use crate::mesh::Mesh;
use crate::model::components::{Components, Load, LoadPlace};
use crate::model::system::{Attachment, Marker, Material, Solid, System, number_sources};
use nalgebra::Vector3;
use std::cell::Cell;

/// Longest chain that the shorthand writes out.
pub(crate) const LONGEST_CHAIN: usize = 1000;

/// The system that a scene means.
pub(crate) fn build_scene(scene: &SceneSpec, scope: &Scope<'_>) -> Result<System, SceneError> {
    let mut scene = scene.clone();
    add_named(&mut scene);
    let materials = materials(&scene.materials, &scope.key("materials"))?;
    if let Some(chain) = &scene.chain {
        check_chain(chain, &materials, &scope.key("chain"))?;
    }
    let lists = Lists::new(&scene, scope);
    let scene = expanded(scene);
    lists.check_names(&scene, scope)?;
    let body_names = names(&scene.bodies, |body| &body.name);

    let elements = Elements::default();
    let muscles = lists.muscles.build(&scene.muscles, |spec, scope| {
        let muscle = muscle(spec, &body_names, &materials, scope)?;
        elements.add(muscle.fidelity.elements(), scope)?;
        Ok(muscle)
    })?;
    let mut blocks = lists.solids.build(&scene.solids, |spec, scope| {
        let solid = solid(spec, &body_names, &materials, scope)?;
        elements.add(solid.mesh.hexahedra.len(), scope)?;
        Ok(solid)
    })?;
    number_sources(&mut blocks, muscles.len());
    let built_joints = lists
        .joints
        .build(&scene.joints, |spec, scope| joint(spec, &body_names, scope))?;
    let loads = lists.loads.build(&scene.loads, |spec, scope| {
        load(spec, (&body_names, &built_joints, &muscles, &blocks), scope)
    })?;
    check_charges(&loads, &lists)?;
    let system = System {
        bodies: lists.bodies.build(&scene.bodies, body)?,
        muscles,
        markers: lists.markers.build(&scene.markers, |spec, scope| {
            marker(spec, &body_names, &blocks, scope)
        })?,
        solids: blocks,
        gravity: scene
            .gravity
            .as_ref()
            .map(vector)
            .filter(|g| g.norm() > 0.0),
        components: components(&scene, loads, &body_names, scope)?,
        joints: built_joints,
        name: scene.name,
    };
    check_connected(&scene.bodies, &system.joints, |index| {
        lists.bodies.scope(index)
    })?;
    let sources = names(&system.sources(), |source| &source.name);
    scope.unique(&sources, &[], |_| scope.key("solids"))?;
    Ok(system)
}

/// Checks that no muscle is charged twice.
fn check_charges(loads: &[Load], lists: &Lists<'_>) -> Result<(), SceneError> {
    for (index, load) in loads.iter().enumerate() {
        let is_charge = matches!(load.on, LoadPlace::Muscle(_));
        if is_charge && loads[..index].iter().any(|other| other.on == load.on) {
            let place = lists.loads.scope(index).key("muscle");
            return Err(place.wrong("a second charge of one muscle", "one charge for each"));
        }
    }
    Ok(())
}

/// Elements counted while a scene is built.
#[derive(Default)]
struct Elements(Cell<usize>);

impl Elements {
    /// Adds those of a muscle or block, unless they are too many in all.
    fn add(&self, count: usize, scope: &Scope<'_>) -> Result<(), SceneError> {
        let total = self.0.get() + count;
        self.0.set(total);
        if total <= MOST_ELEMENTS {
            return Ok(());
        }
        let found = format!("{total} elements with those before");
        Err(scope.wrong(
            found,
            format!("no more than {MOST_ELEMENTS} elements in all"),
        ))
    }
}

/// The named lists of a scene.
struct Lists<'a> {
    bodies: NamedEntries<'a>,
    joints: NamedEntries<'a>,
    muscles: NamedEntries<'a>,
    solids: NamedEntries<'a>,
    markers: NamedEntries<'a>,
    loads: NamedEntries<'a>,
}

impl<'a> Lists<'a> {
    /// The lists of a scene as it is written.
    fn new(scene: &SceneSpec, scope: &Scope<'a>) -> Self {
        let list = |name: &str, written: usize| NamedEntries::new(scope, name, written);
        Self {
            bodies: list("bodies", scene.bodies.len()),
            joints: list("joints", scene.joints.len()),
            muscles: list("muscles", scene.muscles.len()),
            solids: list("solids", scene.solids.len()),
            markers: list("markers", scene.markers.len()),
            loads: list("loads", scene.loads.len()),
        }
    }

    /// Checks that the names of the expanded scene are unique where they must be.
    fn check_names(&self, scene: &SceneSpec, scope: &Scope<'_>) -> Result<(), SceneError> {
        let bodies = names(&scene.bodies, |body| &body.name);
        let joints = names(&scene.joints, |joint| &joint.name);
        let muscles = names(&scene.muscles, |muscle| &muscle.name);
        let solids = names(&scene.solids, |solid| &solid.name);
        let markers = names(&scene.markers, |marker| &marker.name);
        let loads = names(&scene.loads, |load| &load.name);

        self.bodies.unique(&bodies, &["ground"])?;
        self.joints.unique(&joints, &[])?;
        let reserved = ["solution", "time", "voltages", "hold"];
        self.muscles.unique(&muscles, &reserved)?;
        check_component_names(scene, scope)?;
        // Blocks and muscles share files and names of voltages.
        let driven = [muscles, solids].concat();
        let place = |index: usize| scope.key("solids").index(index - scene.muscles.len());
        scope.unique(&driven, &[], |index| place(index).key("name"))?;
        self.loads.unique(
            &loads,
            &driven.iter().map(String::as_str).collect::<Vec<_>>(),
        )?;
        self.markers.unique(&markers, &[])
    }
}

/// Checks the entries from which a chain is written out.
fn check_chain(
    chain: &ChainSpec,
    materials: &[(String, Material)],
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    if !(1..=LONGEST_CHAIN).contains(&chain.segments) {
        let expected = format!("a whole number from 1 to {LONGEST_CHAIN}");
        return Err(scope
            .key("segments")
            .wrong(chain.segments.to_string(), expected));
    }
    let length = scope.key("length").positive(&chain.length)?;
    scope.key("radius").positive(&chain.radius)?;
    scope.key("mass").positive(&chain.mass)?;
    let reach = length * chain.segments as f64;
    if !reach.is_finite() {
        let found = chain.length.to_string();
        return Err(scope.key("length").wrong(found, "a finite chain"));
    }
    let axis = unit_axis(&chain.axis, &scope.key("axis"))?;
    let place = scope.key("first_joint_axis");
    let joint_axis = unit_axis(&chain.first_joint_axis, &place)?;
    if axis.dot(&joint_axis).abs() > 1e-9 {
        let found = format!("{:?}", chain.first_joint_axis);
        return Err(place.wrong(found, "an axis at right angles to \"axis\""));
    }
    if let Some(pair) = &chain.muscles {
        let scope = scope.key("muscles");
        find_material(&pair.material, materials, &scope.key("material"))?;
        fidelity(&pair.model(), materials, &scope)?;
        let arm = scope.key("arm").positive(&pair.arm)?;
        let rest_length = scope.key("rest_length").positive(&pair.rest_length)?;
        if !(reach + arm + rest_length).is_finite() {
            let found = format!("an arm of {} at a length of {}", pair.arm, pair.rest_length);
            return Err(scope.wrong(found, "muscles in finite places"));
        }
        positive_sides(&pair.cross_section, rest_length, &scope)?;
        layer(&pair.layer_thickness, rest_length, &scope)?;
    }
    Ok(())
}

/// Defines what visits all lists.
macro_rules! visits {
    ($($(#[$about:meta])* $list:ident: $spec:ty,)*) => {
        /// The components that are written, beside these loads.
        pub(crate) fn components(
            scene: &SceneSpec,
            loads: Vec<Load>,
            bodies: &[String],
            scope: &Scope<'_>,
        ) -> Result<Components, SceneError> {
            Ok(Components {
                $($list: built(&scene.$list, &list(scope, stringify!($list)), bodies)?,)*
                loads,
                others: Vec::new(),
            })
        }

        /// Checks that no two components have one name.
        pub(crate) fn check_component_names(
            scene: &SceneSpec,
            scope: &Scope<'_>,
        ) -> Result<(), SceneError> {
            let mut names = Vec::new();
            $(check_unique(&scene.$list, &list(scope, stringify!($list)), &mut names)?;)*
            Ok(())
        }
    };
}

component_lists!(visits);

/// A list of which a chain writes nothing.
fn list<'a>(scope: &Scope<'a>, name: &str) -> NamedEntries<'a> {
    NamedEntries::new(scope, name, usize::MAX)
}

/// The marker that is written.
pub(crate) fn marker(
    spec: &MarkerSpec,
    bodies: &[String],
    solids: &[Solid],
    scope: &Scope<'_>,
) -> Result<Marker, SceneError> {
    scope.exactly_one([
        ("body", spec.body.as_ref().map(|_| ())),
        ("solid", spec.solid.as_ref().map(|_| ())),
    ])?;
    let name = spec.name.clone();
    let Some(solid) = &spec.solid else {
        let body = spec.body.as_deref().unwrap_or_default();
        return Ok(Marker {
            name,
            point: attachment(body, &spec.at, bodies, scope)?,
            solid: None,
        });
    };
    let all = names(solids, |solid| &solid.name);
    let solid = scope
        .key("solid")
        .find(solid, &all, "the name of a block")?;
    let at = vector(&spec.at);
    let mesh = &solids[solid].mesh;
    let (node, distance) = nearest(mesh, &at);
    if distance.is_nan() || distance > size_at(mesh, node) {
        let found = format!(
            "{}, which is {distance:.3} mm away from the nearest node, at {}",
            place(&at),
            place(&mesh.nodes[node])
        );
        let expected = "a place no farther from the block than the size of an element";
        return Err(scope.key("at").wrong(found, expected));
    }
    Ok(Marker {
        name,
        point: Attachment { body: None, at },
        solid: Some(solid),
    })
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
    const EDGES: [[usize; 2]; 12] = [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 0],
        [4, 5],
        [5, 6],
        [6, 7],
        [7, 4],
        [0, 4],
        [1, 5],
        [2, 6],
        [3, 7],
    ];
    let around = mesh
        .hexahedra
        .iter()
        .filter(|corners| corners.contains(&node));
    around
        .flat_map(|corners| EDGES.map(|[a, b]| mesh.nodes[corners[a]] - mesh.nodes[corners[b]]))
        .map(|edge| edge.norm())
        .fold(0.0, f64::max)
}
