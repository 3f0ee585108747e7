//! Conversion of a scene file to its system: names resolved and everything checked.

use std::cell::Cell;

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::body::body;
use crate::files::scene::component_lists::{check_component_names, components};
use crate::files::scene::components::load;
use crate::files::scene::expand::{add_named, expanded};
use crate::files::scene::graph::check_connected;
use crate::files::scene::joint::joint;
use crate::files::scene::marker::marker;
use crate::files::scene::material::materials;
use crate::files::scene::muscle::{MOST_ELEMENTS, fidelity, layer, muscle, positive_sides};
use crate::files::scene::named_entries::NamedEntries;
use crate::files::scene::names::{find_material, names};
use crate::files::scene::point::unit_axis;
use crate::files::scene::point::vector;
use crate::files::scene::solid::solid;
use crate::files::scene::spec::{ChainSpec, SceneSpec};
use crate::model::components::{Load, LoadPlace};
use crate::model::system::{Material, System, number_sources};

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
