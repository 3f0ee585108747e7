//! Shorthand written out: chains as bodies, joints, muscles and a marker, and materials that are only named.

use nalgebra::Vector3;
use serde_json::json;

use crate::files::scene::joint::JointSpec;
use crate::files::scene::material::named_material;
use crate::files::scene::point::{Point, PointSpec, direction};
use crate::files::scene::spec::{
    BodySpec, ChainSpec, CylinderSpec, MarkerSpec, MuscleSpec, SceneSpec,
};
use crate::files::units::quantity::Quantity;

/// The same scene without shorthand; the parts of the chain come after those that are written.
///
/// The chain is in order: positive lengths, perpendicular axes.
pub(crate) fn expanded(mut scene: SceneSpec) -> SceneSpec {
    if let Some(chain) = scene.chain.take() {
        for number in 1..=chain.segments {
            let link = Link::new(&chain, number);
            scene.bodies.push(link.body(&chain));
            scene.joints.push(link.joint());
            scene.muscles.extend(link.muscles(&chain));
        }
        scene.markers.extend(tip(&chain));
    }
    scene
}

/// Writes the materials with published constants that muscles and blocks name, and that the scene does not write, among its materials.
pub(crate) fn add_named(scene: &mut SceneSpec) {
    let muscles = scene.muscles.iter().map(|muscle| &muscle.material);
    let pairs = scene
        .chain
        .iter()
        .filter_map(|chain| chain.muscles.as_ref());
    let blocks = scene.solids.iter().flat_map(|solid| solid.material_names());
    let names = muscles
        .chain(pairs.map(|pair| &pair.material))
        .chain(blocks);
    let is_absent = |name: &&String| !scene.materials.contains_key(*name);
    let added: Vec<_> = names
        .filter(is_absent)
        .filter_map(|name| Some((name.clone(), named_material(name)?)))
        .collect();
    scene.materials.extend(added);
}

/// One joint and the segment behind it.
struct Link {
    number: usize,
    /// Unit vector along the chain.
    axis: Vector3<f64>,
    /// Unit vector of the joint axis.
    joint_axis: Vector3<f64>,
    /// Unit vector towards the first muscle.
    arm_axis: Vector3<f64>,
    /// Place of the joint in mm.
    at: Vector3<f64>,
}

impl Link {
    fn new(chain: &ChainSpec, number: usize) -> Self {
        let axis = direction(&chain.axis).unwrap_or_default();
        let first = direction(&chain.first_joint_axis).unwrap_or_default();
        let second = axis.cross(&first);
        let odd = number % 2 == 1;
        Self {
            number,
            axis,
            joint_axis: if odd { first } else { second },
            arm_axis: if odd { second } else { first },
            at: axis * ((number - 1) as f64 * chain.length.value()),
        }
    }

    fn segment(&self) -> String {
        format!("segment{}", self.number)
    }

    fn parent(&self) -> String {
        match self.number {
            1 => "ground".to_owned(),
            number => format!("segment{}", number - 1),
        }
    }

    fn body(&self, chain: &ChainSpec) -> BodySpec {
        let centre = self.axis * ((self.number as f64 - 0.5) * chain.length.value());
        BodySpec {
            name: self.segment(),
            mass: Some(chain.mass.clone()),
            cylinder: Some(CylinderSpec {
                length: chain.length.clone(),
                radius: chain.radius.clone(),
                axis: chain.axis,
            }),
            position: Some(point(&centre)),
            ..BodySpec::default()
        }
    }

    fn joint(&self) -> JointSpec {
        // Adding zero turns −0 into 0.
        let axis = self.joint_axis.map(|entry| entry + 0.0);
        let written = json!({
            "name": format!("joint{}", self.number),
            "revolute": { "axis": axis.as_slice() },
            "parent": self.parent(),
            "child": self.segment(),
            "at": point(&self.at),
        });
        serde_json::from_value(written).expect("a link of a chain has finite places")
    }

    fn muscles(&self, chain: &ChainSpec) -> Vec<MuscleSpec> {
        let Some(pair) = &chain.muscles else {
            return Vec::new();
        };
        let stretch = pair.prestretch.unwrap_or(1.0);
        let half = self.axis * (0.5 * stretch * pair.rest_length.value());
        let muscle = |(place, side): (usize, f64)| {
            let middle = self.at + self.arm_axis * (side * pair.arm.value());
            MuscleSpec {
                name: format!("muscle{}", 2 * self.number - 1 + place),
                model: pair.model,
                elements: pair.elements,
                layers: pair.layers,
                element: pair.element,
                material: pair.material.clone(),
                cross_section: pair.cross_section.clone(),
                layer_thickness: pair.layer_thickness.clone(),
                prestretch: pair.prestretch,
                circuit: pair.circuit.clone(),
                from: PointSpec {
                    body: self.parent(),
                    at: point(&(middle - half)),
                },
                to: PointSpec {
                    body: self.segment(),
                    at: point(&(middle + half)),
                },
                first_side: None,
                section_inertia: false,
            }
        };
        [1.0, -1.0].into_iter().enumerate().map(muscle).collect()
    }
}

fn tip(chain: &ChainSpec) -> Option<MarkerSpec> {
    let link = Link::new(chain, chain.segments);
    let end = link.axis * (chain.segments as f64 * chain.length.value());
    Some(MarkerSpec {
        name: chain.tip_marker.clone()?,
        body: Some(link.segment()),
        solid: None,
        at: point(&end),
    })
}

fn point(place: &Vector3<f64>) -> Point {
    [place.x, place.y, place.z].map(Quantity::millimetres)
}
