//! Rules of parts: a mistake in a file and the same one in a program in Rust have one reason.

use crate::scene::{folder, mistake};
use proboscis::files::read_problem;
use proboscis::model::components::{
    ContactElasticLaw, ContactShape, ContactSide, ElasticSolid, LoadPlace, Restitution,
};
use proboscis::model::system::{ElasticLaw, Fidelity, System};

const SCENE: &str = r#"{
  "name": "rules",
  "materials": {
    "foam": { "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "poisson_ratio": 0.3, "relative_permittivity": 3.0, "viscosity": "10 Pa s",
      "law": { "gent": { "limit": 20 } }, "maxwell": [ { "shear_modulus": "10 kPa", "relaxation_time": "1 s" } ], "stretch_range": [0.5, 2] }
  },
  "bodies": [ { "name": "b", "mass": "10 g", "sphere": { "radius": "5 mm" }, "inertia": [2e-7, 2e-7, 3e-7], "position": [0.03, 0, 0] } ],
  "joints": [ { "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": [0.03, 0, 0], "damping": "1 N s/m",
    "stiffness": "40 N/m", "stops": { "min": "-10 mm", "max": "20 mm", "stiffness": "400 N/m", "smoothing": "1 mm" } } ],
  "muscles": [
    { "name": "m", "material": "foam", "cross_section": ["10 mm", "12 mm"], "layer_thickness": "50 um", "prestretch": 1.5,
      "circuit": { "resistance": "1 MOhm" }, "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "b", "at": ["30 mm", 0, 0] } },
    { "name": "e", "material": "foam", "model": "finite_elements", "elements": [1, 1, 4], "layers": 2, "first_side": [0, 1, 0],
      "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
      "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "b", "at": ["30 mm", 0, 0] } }
  ],
  "springs": [ { "name": "s", "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "b", "at": ["31 mm", 0, 0] },
    "stiffness": "200 N/m", "damping": "0.5 N s/m", "rest_length": "25 mm" } ],
  "tendons": [ { "name": "t", "through": [ { "body": "ground", "at": [0, 0, 0] }, { "body": "b", "at": ["32 mm", 0, 0] } ],
    "stiffness": "2 N/mm", "rest_length": "26 mm", "smoothing": "3 mm" } ],
  "contacts": [ { "name": "c", "sphere": { "body": "b", "at": ["30 mm", 0, 0], "radius": "4 mm" }, "plane": { "at": ["26 mm", 0, 0], "normal": [1, 0, 0] },
    "stiffness": "9 N/mm", "smoothing": "2 um", "restitution": { "coefficient": 0.7, "speed": "3 m/s" }, "friction": 0.4, "slip_speed": "7 mm/s", "stick": "8 um" },
    { "name": "h", "sphere": { "body": "b", "at": ["30 mm", 0, 0], "radius": "4.1 mm" }, "other": { "body": "ground", "at": ["60 mm", 0, 0], "radius": "6.1 mm" },
    "hertz": [ { "modulus": "8 MPa", "poisson_ratio": 0.45 } ] } ],
  "loads": [ { "name": "push", "point": { "body": "b", "at": [0.03, 0, 0] }, "direction": [1, 0, 0] }, { "name": "motor", "joint": "j" } ],
  "markers": [ { "name": "tip", "body": "b", "at": [0.03, 0, 0] } ]
}"#;

const SIMULATION: &str =
    r#"{ "scene": "scene.json", "simulate": { "duration": "10 ms", "step": "1 ms" } }"#;

/// A text of the scene, another one in its place, the path of the mistake, and the same mistake in Rust.
type Case = (&'static str, &'static str, &'static str, fn(&mut System));

fn foam(system: &mut System, change: impl Fn(&mut proboscis::Material)) {
    system
        .muscles
        .iter_mut()
        .for_each(|m| change(&mut m.material));
}

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("\"10 g\"", "\"-10 g\"", "bodies[0].mass", |s| s.bodies[0].mass = -10.0),
    ("3e-7", "5e-7", "bodies[0].inertia", |s| s.bodies[0].inertia = [200.0, 200.0, 500.0]),
    ("\"parent\": \"ground\"", "\"parent\": \"b\"", "joints[0].child", |s| s.joints[0].parent = Some(0)),
    ("\"1 N s/m\"", "\"-1 N s/m\"", "joints[0].damping", |s| s.joints[0].damping = Some(-1.0)),
    ("\"40 N/m\"", "\"-40 N/m\"", "joints[0].stiffness", |s| s.joints[0].spring.as_mut().unwrap().stiffness = -0.04),
    ("\"400 N/m\"", "\"-400 N/m\"", "joints[0].stops.stiffness", |s| s.joints[0].stops.as_mut().unwrap().stiffness = -0.4),
    ("\"20 mm\"", "\"-20 mm\"", "joints[0].stops.max", |s| s.joints[0].stops.as_mut().unwrap().at[1] = -20.0),
    ("\"min\": \"-10 mm\", \"max\": \"20 mm\", ", "", "joints[0].stops", |s| s.joints[0].stops.as_mut().unwrap().at = [f64::NEG_INFINITY, f64::INFINITY]),
    ("\"1 mm\"", "\"-1 mm\"", "joints[0].stops.smoothing", |s| s.joints[0].stops.as_mut().unwrap().smoothing = -1.0),
    ("\"12 mm\"", "0", "muscles[0].cross_section[1]", |s| s.muscles[0].cross_section[1] = 0.0),
    ("\"12 mm\"", "3", "muscles[0].cross_section[1]", |s| s.muscles[0].cross_section[1] = 3000.0),
    ("\"50 um\"", "\"-50 um\"", "muscles[0].layer_thickness", |s| s.muscles[0].layer_thickness = -0.05),
    ("\"50 um\"", "\"50 mm\"", "muscles[0].layer_thickness", |s| s.muscles[0].layer_thickness = 50.0),
    ("1.5", "-1.5", "muscles[0].prestretch", |s| s.muscles[0].prestretch = Some(-1.5)),
    ("\"30 mm\"", "0", "muscles[0].to.at", |s| s.muscles[0].to.at = s.muscles[0].from.at),
    ("\"1 MOhm\"", "\"-1 MOhm\"", "muscles[0].circuit.resistance", |s| s.muscles[0].circuit.as_mut().unwrap().resistance = Some(-1e6)),
    ("{ \"resistance\": \"1 MOhm\" }", "{}", "muscles[0].circuit", |s| s.muscles[0].circuit = Some(Default::default())),
    ("[1, 1, 4]", "[1, 0, 4]", "muscles[1].elements[1]", |s| elements(s).elements[1] = 0),
    ("\"layers\": 2", "\"layers\": 3", "muscles[1].layers", |s| elements(s).layers = 3),
    ("[0, 1, 0]", "[1, 0, 0]", "muscles[1].first_side", |s| elements(s).first_side = Some(proboscis::X)),
    ("\"layers\": 2", "\"section_inertia\": true", "muscles[1].section_inertia", |s| s.muscles[1].section_inertia = true),
    ("\"200 N/m\"", "\"-200 N/m\"", "springs[0].stiffness", |s| s.components.springs[0].stiffness = Some(-0.2)),
    ("\"0.5 N s/m\"", "\"-0.5 N s/m\"", "springs[0].damping", |s| s.components.springs[0].damping = Some(-0.5)),
    ("\"25 mm\"", "\"-25 mm\"", "springs[0].rest_length", |s| s.components.springs[0].rest_length = -25.0),
    ("\"31 mm\"", "0", "springs[0].to.at", |s| s.components.springs[0].to.at = s.components.springs[0].from.at),
    ("\"2 N/mm\"", "0", "tendons[0].stiffness", |s| s.components.tendons[0].stiffness = 0.0),
    ("\"26 mm\"", "\"-26 mm\"", "tendons[0].rest_length", |s| s.components.tendons[0].rest_length = -26.0),
    ("\"3 mm\"", "\"53 mm\"", "tendons[0].smoothing", |s| s.components.tendons[0].smoothing = 53.0),
    ("\"3 mm\"", "\"-3 mm\"", "tendons[0].smoothing", |s| s.components.tendons[0].smoothing = -3.0),
    ("\"32 mm\"", "0", "tendons[0].through[1].at", |s| s.components.tendons[0].through[1] = s.components.tendons[0].through[0]),
    ("[ { \"body\": \"ground\", \"at\": [0, 0, 0] }, {", "[ {", "tendons[0].through", |s| s.components.tendons[0].through.truncate(1)),
    ("\"name\": \"t\"", "\"name\": \"s\"", "tendons[0].name", |s| s.components.tendons[0].name = "s".to_owned()),
    ("\"9 N/mm\"", "\"-9 N/mm\"", "contacts[0].stiffness", |s| s.components.contacts[0].elasticity = ContactElasticLaw::Linear(-9.0)),
    ("\"2 um\"", "\"-2 um\"", "contacts[0].smoothing", |s| s.components.contacts[0].smoothing = -2e-3),
    ("\"coefficient\": 0.7", "\"coefficient\": 1.7", "contacts[0].restitution.coefficient", |s| restitution(s).coefficient = 1.7),
    ("\"3 m/s\"", "0", "contacts[0].restitution.speed", |s| restitution(s).speed = 0.0),
    ("\"friction\": 0.4", "\"friction\": -0.4", "contacts[0].friction", |s| s.components.contacts[0].friction = Some(-0.4)),
    ("\"7 mm/s\"", "0", "contacts[0].slip_speed", |s| s.components.contacts[0].slip_speed = 0.0),
    ("\"8 um\"", "\"-8 um\"", "contacts[0].stick", |s| s.components.contacts[0].stick = Some(-0.008)),
    ("\"4 mm\"", "\"-4 mm\"", "contacts[0].sphere.radius", |s| s.components.contacts[0].round.radius = -4.0),
    (", \"radius\": \"4.1 mm\"", "", "contacts[1].sphere.radius", |s| s.components.contacts[1].round.radius = 0.0),
    ("\"6.1 mm\"", "\"-6 mm\"", "contacts[1].other.radius", |s| s.components.contacts[1].side = ContactSide::Shape(ContactShape { radius: -6.0, ..Default::default() })),
    ("\"8 MPa\"", "0", "contacts[1].hertz[0].modulus", |s| hertz(s)[0].modulus = 0.0),
    ("0.45", "0.6", "contacts[1].hertz[0].poisson_ratio", |s| hertz(s)[0].poisson_ratio = 0.6),
    ("[ { \"modulus\": \"8 MPa\", \"poisson_ratio\": 0.45 } ]", "[]", "contacts[1].hertz", |s| hertz(s).clear()),
    ("\"name\": \"motor\"", "\"name\": \"push\"", "loads[1].name", |s| s.components.loads[1].name = "push".to_owned()),
    ("\"name\": \"motor\"", "\"name\": \"m\"", "loads[1].name", |s| s.components.loads[1].name = "m".to_owned()),
    ("\"name\": \"tip\"", "\"name\": \"\"", "markers[0].name", |s| s.markers[0].name = String::new()),
    ("\"point\": { \"body\": \"b\"", "\"point\": { \"body\": \"ground\"", "loads[0].point.body", |s| to_ground(s)),
    ("\"joint\": \"j\"", "\"muscle\": \"m\"", "loads[1].muscle", |s| s.components.loads[1].on = LoadPlace::Muscle(0)),
    ("\"100 kPa\"", "0", "materials.foam.shear_modulus", |s| foam(s, |m| m.shear_modulus = 0.0)),
    ("\"1000 kg/m^3\"", "\"-1 kg/m^3\"", "materials.foam.density", |s| foam(s, |m| m.density = Some(-1e-6))),
    ("\"1000 kg/m^3\"", "\"1000 g/cm^3\"", "materials.foam.density", |s| foam(s, |m| m.density = Some(1.0))),
    ("\"10 Pa s\"", "\"-10 Pa s\"", "materials.foam.viscosity", |s| foam(s, |m| m.viscosity = Some(-0.01))),
    ("\"poisson_ratio\": 0.3", "\"lame_lambda\": \"-80 kPa\"", "materials.foam.lame_lambda", |s| foam(s, |m| m.lame_lambda = Some(-0.08))),
    ("\"limit\": 20", "\"limit\": -20", "materials.foam.law.gent.limit", |s| foam(s, |m| m.law = Some(ElasticLaw::Gent { limit: -20.0 }))),
    ("\"gent\": { \"limit\": 20 }", "\"yeoh\": { \"c2\": \"1 kPa\", \"c3\": \"-1 kPa\" }", "materials.foam.law.yeoh.c3", |s| foam(s, |m| m.law = Some(ElasticLaw::Yeoh { c2: 0.001, c3: -0.001 }))),
    ("\"gent\": { \"limit\": 20 }", "\"mooney_rivlin\": { \"share\": 2 }", "materials.foam.law.mooney_rivlin.share", |s| foam(s, |m| m.law = Some(ElasticLaw::MooneyRivlin { share: 2.0 }))),
    ("\"1 s\"", "0", "materials.foam.maxwell[0].relaxation_time", |s| foam(s, |m| m.maxwell.get_mut(0).unwrap().relaxation_time = 0.0)),
    ("\"10 kPa\"", "0", "materials.foam.maxwell[0].shear_modulus", |s| foam(s, |m| m.maxwell.get_mut(0).unwrap().shear_modulus = 0.0)),
    ("[0.5, 2]", "[1.5, 2]", "materials.foam.stretch_range", |s| foam(s, |m| m.stretch_range = Some([1.5, 2.0]))),
];

fn restitution(system: &mut System) -> &mut Restitution {
    system.components.contacts[0].restitution.as_mut().unwrap()
}

fn hertz(system: &mut System) -> &mut Vec<ElasticSolid> {
    match &mut system.components.contacts[1].elasticity {
        ContactElasticLaw::Hertz(solids) => solids,
        ContactElasticLaw::Linear(_) => panic!("a contact after Hertz"),
    }
}

fn elements(system: &mut System) -> &mut proboscis::model::system::Discretisation {
    match &mut system.muscles[1].fidelity {
        Fidelity::FiniteElements(elements) => elements,
        Fidelity::Lumped => panic!("a muscle of finite elements"),
    }
}

fn to_ground(system: &mut System) {
    if let LoadPlace::Point { at, .. } = &mut system.components.loads[0].on {
        at.body = None;
    }
}

#[test]
fn mistakes_have_one_reason_in_files_and_in_rust() {
    let (_folder, path) = folder(SCENE, SIMULATION);
    let system = read_problem(&path, &[]).expect("a right scene").system;
    assert_eq!(system.check(), Ok(()));
    for (old, new, path, change) in CASES {
        assert!(SCENE.contains(old), "{old}");
        let in_file = mistake(&SCENE.replacen(old, new, 1), SIMULATION, &[]);
        assert_eq!(in_file.path(), *path, "{in_file}");
        let mut wrong = system.clone();
        change(&mut wrong);
        let in_rust = wrong.check().expect_err(path);
        let fault = &in_rust.fault;
        // The same place, which a file has under the name of a material; the value as it is written, and the kind of quantity behind it.
        let place = fault.at.trim_start_matches("material.");
        assert!(path.ends_with(place), "{in_file}; {in_rust}");
        assert!(
            in_file.expected().starts_with(&fault.expected),
            "{in_file}; {in_rust}"
        );
        match fault.value {
            Some(_) => assert!(
                in_file.found().ends_with(&fault.found),
                "{in_file}; {in_rust}"
            ),
            None => assert_eq!(in_file.found(), fault.found),
        }
    }
    let told = |change: fn(&mut System)| {
        let mut wrong = system.clone();
        change(&mut wrong);
        wrong.check().unwrap_err().to_string()
    };
    let spring = told(|system| system.components.springs[0].stiffness = Some(-0.2));
    let expected = "springs.s.stiffness: found -0.2, expected zero or a positive value";
    assert_eq!(spring, expected);
    let written = SCENE.replacen("\"200 N/m\"", "\"-200 N/m\"", 1);
    let spring = mistake(&written, SIMULATION, &[]).to_string();
    let expected = "springs[0].stiffness: found \"-200 N/m\", expected zero or a positive value: a stiffness, such as \"200 N/m\"";
    assert!(spring.ends_with(expected), "{spring}");
}
