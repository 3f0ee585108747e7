//! Constants of a scene by their paths, as an optimisation may seek them: the constants of components that follow each.

use crate::files::json::locate::{JsonPath, Step};
use crate::files::scene::named_materials::named_material;
use crate::files::scene::spec::SceneSpec;
use crate::files::scene::spec_material::Dielectric;
use crate::files::units::quantity::{
    Damping, Kind, Length, Ratio, RotationalDamping, Stiffness, Stress, Viscosity,
};
use crate::model::system::{JointKind, System};
use crate::model::{Constant, DielectricLaw, Follower};

/// A constant of a scene.
#[derive(Debug)]
pub(crate) struct SceneConstant {
    /// Constants of components that follow it.
    pub(crate) followers: Vec<Follower>,
    /// Its kind.
    pub(crate) kind: Kind,
    /// Its value in the scene, in the units inside.
    pub(crate) value: f64,
}

/// Reason why a path names no constant that can be sought.
#[derive(Debug)]
pub(crate) struct NoConstant {
    /// Value that is wrong.
    pub(crate) found: String,
    /// Value that is expected.
    pub(crate) expected: String,
}

/// The keys of all paths that may be sought.
const OFFERED: &str = "a path such as \"materials.NAME.shear_modulus\" (or viscosity, relative_permittivity), \
     \"muscles.NAME.cross_section[0]\" (or layer_thickness, from.at[0], to.at[0]), \"chain.muscles.arm\" (or cross_section[0], \
     layer_thickness), \"springs.NAME.stiffness\" (or damping, rest_length), \"joints.NAME.damping\"";

type Found = Result<SceneConstant, NoConstant>;

/// The constant at a path; `written` is the scene as it is written, `system` its system.
pub(crate) fn constant(path: &str, written: &SceneSpec, system: &System) -> Found {
    let unknown = || NoConstant {
        found: "no constant of the scene that can be sought".to_owned(),
        expected: OFFERED.to_owned(),
    };
    let place = JsonPath::parse(path).ok_or_else(unknown)?;
    let key = |step: &Step| match step {
        Step::Key(key) => key.clone(),
        Step::Index(index) => format!("[{index}]"),
    };
    let keys: Vec<String> = place.0.iter().map(key).collect();
    let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
    match keys.as_slice() {
        ["materials", name, key] => {
            of_material(name, key, written, system).unwrap_or_else(|| Err(unknown()))
        }
        ["chain", "muscles", rest @ ..] => of_chain(rest, written, system).ok_or_else(unknown),
        ["muscles", name, rest @ ..] => {
            let index = find(name, system.muscles.iter().map(|m| m.name.as_str()));
            let index = index.ok_or_else(|| missing("muscle", name))?;
            of_muscle(index, rest, system).ok_or_else(unknown)
        }
        ["springs", name, key] => {
            let springs = &system.components.springs;
            let index = find(name, springs.iter().map(|s| s.name.as_str()));
            let index = index.ok_or_else(|| missing("spring", name))?;
            of_spring(index, key, system).ok_or_else(unknown)
        }
        ["joints", name, "damping"] => {
            let index = find(name, system.joints.iter().map(|j| j.name.as_str()));
            let index = index.ok_or_else(|| missing("joint", name))?;
            let joint = &system.joints[index];
            let kind = match joint.kind {
                JointKind::Revolute { .. } => RotationalDamping::kind(),
                _ => Damping::kind(),
            };
            let value = joint.damping.unwrap_or(0.0);
            Ok(one(Constant::JointDamping(index), kind, value))
        }
        _ => Err(unknown()),
    }
}

/// A component by its name, or by its index in brackets.
fn find<'a>(name: &str, mut names: impl ExactSizeIterator<Item = &'a str>) -> Option<usize> {
    match name.starts_with('[') && name.ends_with(']') {
        true => index(name, names.len()),
        false => names.position(|other| other == name),
    }
}

fn missing(what: &str, name: &str) -> NoConstant {
    NoConstant {
        found: format!("{name:?}, which is no {what} of the scene"),
        expected: format!("the name of a {what}"),
    }
}

fn one(constant: Constant, kind: Kind, value: f64) -> SceneConstant {
    SceneConstant {
        followers: vec![constant.into()],
        kind,
        value,
    }
}

fn of_material(name: &str, key: &str, written: &SceneSpec, system: &System) -> Option<Found> {
    let of_scene = written.materials.get(name).cloned();
    let Some(material) = of_scene.or_else(|| named_material(name)) else {
        return Some(Err(missing("material", name)));
    };
    let law = match material.dielectric.unwrap_or_default() {
        Dielectric::FirstOrder => DielectricLaw::FirstOrder,
        Dielectric::Ideal => DielectricLaw::Ideal,
    };
    let absent = || {
        Err(NoConstant {
            found: format!("a material without {key:?}"),
            expected: format!("a value of {key:?} in the scene"),
        })
    };
    type Of = Box<dyn Fn(usize) -> Constant>;
    let (constant, kind, value): (Of, Kind, Option<f64>) = match key {
        "shear_modulus" => (
            Box::new(Constant::ShearModulus),
            Stress::kind(),
            Some(material.shear_modulus.value()),
        ),
        "viscosity" => (
            Box::new(Constant::Viscosity),
            Viscosity::kind(),
            material.viscosity.as_ref().map(|v| v.value()),
        ),
        "relative_permittivity" => (
            Box::new(move |muscle| Constant::Permittivity(muscle, law)),
            Ratio::kind(),
            material.relative_permittivity,
        ),
        _ => return None,
    };
    let Some(value) = value else {
        return Some(absent());
    };
    let reads = |solid: &crate::files::scene::spec_solids::SolidSpec| {
        solid.material_names().any(|other| other == name)
    };
    if let Some(solid) = written.solids.iter().find(|solid| reads(solid)) {
        return Some(Err(NoConstant {
            found: format!("a constant that block \"{}\" reads", solid.name),
            expected: "one that lumped muscles alone read: sought parameters of finite elements are not offered".to_owned(),
        }));
    }
    // Muscles of the chain come after those that are written.
    let of_chain = written
        .chain
        .as_ref()
        .and_then(|chain| chain.muscles.as_ref());
    let of_chain = of_chain.map(|pair| pair.material.as_str());
    let named = written
        .muscles
        .iter()
        .map(|muscle| muscle.material.as_str());
    let followers: Vec<Follower> = named
        .map(Some)
        .chain(std::iter::repeat(of_chain))
        .take(system.muscles.len())
        .enumerate()
        .filter(|(_, material)| *material == Some(name))
        .map(|(muscle, _)| constant(muscle).into())
        .collect();
    if followers.is_empty() {
        return Some(Err(NoConstant {
            found: format!("a constant of {name:?}, which no muscle is made of"),
            expected: "a material of a muscle".to_owned(),
        }));
    }
    Some(Ok(SceneConstant {
        followers,
        kind,
        value,
    }))
}

fn of_muscle(m: usize, keys: &[&str], system: &System) -> Option<SceneConstant> {
    let muscle = &system.muscles[m];
    let (constant, value) = match *keys {
        ["cross_section", side] => {
            let side = index(side, 2)?;
            (Constant::Side(m, side), muscle.cross_section[side])
        }
        ["layer_thickness"] => (Constant::Layer(m), muscle.layer_thickness),
        [end @ ("from" | "to"), "at", axis] => {
            let (axis, end) = (index(axis, 3)?, usize::from(end == "to"));
            let place = [&muscle.from, &muscle.to][end].at[axis];
            (Constant::End(m, end, axis), place)
        }
        _ => return None,
    };
    Some(one(constant, Length::kind(), value))
}

fn of_spring(s: usize, key: &str, system: &System) -> Option<SceneConstant> {
    let spring = &system.components.springs[s];
    let (constant, kind, value) = match key {
        "stiffness" => (
            Constant::SpringStiffness(s),
            Stiffness::kind(),
            spring.stiffness,
        ),
        "damping" => (Constant::SpringDamping(s), Damping::kind(), spring.damping),
        "rest_length" => {
            let length = Some(spring.rest_length);
            (Constant::SpringLength(s), Length::kind(), length)
        }
        _ => return None,
    };
    Some(one(constant, kind, value.unwrap_or(0.0)))
}

/// An index in brackets below a length.
fn index(key: &str, length: usize) -> Option<usize> {
    let index = key.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?;
    (index < length).then_some(index)
}

/// A constant that all muscles of the chain share.
fn of_chain(keys: &[&str], written: &SceneSpec, system: &System) -> Option<SceneConstant> {
    let chain = written.chain.as_ref()?;
    let pair = chain.muscles.as_ref()?;
    let muscles = system.muscles.len() - 2 * chain.segments..system.muscles.len();
    if *keys != ["arm"] {
        let first = of_muscle(muscles.start, keys, system)?;
        let is_of_pair = !matches!(first.followers[0].constant, Constant::End(..));
        let all = muscles.filter_map(|m| of_muscle(m, keys, system));
        return is_of_pair.then(|| SceneConstant {
            followers: all.flat_map(|constant| constant.followers).collect(),
            ..first
        });
    }
    // Both ends lie beside the joint by the arm.
    let arm = pair.arm.value();
    let joints = &system.joints[system.joints.len() - chain.segments..];
    let mut followers = Vec::new();
    for (place, m) in muscles.enumerate() {
        let muscle = &system.muscles[m];
        let middle = (muscle.from.at + muscle.to.at) * 0.5;
        let side = (middle - joints[place / 2].at) / arm;
        for (end, attachment) in [&muscle.from, &muscle.to].into_iter().enumerate() {
            for axis in (0..3).filter(|&axis| side[axis].abs() > 1e-9) {
                let factor = side[axis];
                followers.push(Follower {
                    constant: Constant::End(m, end, axis),
                    factor,
                    offset: attachment.at[axis] - factor * arm,
                });
            }
        }
    }
    Some(SceneConstant {
        followers,
        kind: Length::kind(),
        value: arm,
    })
}
