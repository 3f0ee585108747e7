//! Maxwell branches of finite elements: published relaxation, the lumped muscle, FElupe, dissipation.

use crate::common::bare;
use crate::common::solid::{block, held, numbers, placed, reference, system};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{
    DiscreteTrajectory, Integrator, Solving, Start, observations, simulate_by, stable_equilibrium,
};
use proboscis::mesh::grid::Grid;
use proboscis::model::components::{BlockLoad, Load, LoadPlace};
use proboscis::model::system::{
    Attachment, Body, Joint, JointKind, Material, MaxwellBranch, MaxwellBranches, Muscle, Shape,
    System,
};
use proboscis::model::{Analysis, Coordinates, Model, Response};
use std::ops::ControlFlow;

/// Edge of the cube in mm, shear modulus in MPa.
pub(crate) const EDGE: f64 = 10.0;
pub(crate) const MODULUS: f64 = 0.1;
/// MPa, ms.
pub(crate) const BRANCHES: [[f64; 2]; 2] = [[0.05, 8.0], [0.03, 60.0]];

fn branches(list: &[[f64; 2]]) -> MaxwellBranches {
    let of = |&[shear_modulus, relaxation_time]: &[f64; 2]| MaxwellBranch {
        shear_modulus,
        relaxation_time,
    };
    MaxwellBranches::new(&list.iter().map(of).collect::<Vec<_>>()).unwrap()
}

pub(crate) fn rubber(lame_lambda: f64, list: &[[f64; 2]]) -> Material {
    Material {
        shear_modulus: MODULUS,
        lame_lambda: Some(lame_lambda),
        maxwell: branches(list),
        ..Material::default()
    }
}

/// A cube of one hexahedron on rollers whose upper face a dead traction along z pulls.
pub(crate) fn cube(material: Material) -> System {
    let size = Vector3::repeat(EDGE);
    let mesh = Grid::uniform(Vector3::zeros(), size, [1, 1, 1]).mesh();
    let mut solid = block(mesh, material);
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "x_min", [true, false, false]),
        held(mesh, "y_min", [false, true, false]),
        held(mesh, "z_min", [false, false, true]),
    ];
    let load = BlockLoad::Traction(mesh.faces_of(&mesh.sets["z_max"]), Vector3::z());
    let mut system = system(vec![solid]);
    system.components.loads = vec![Load {
        name: "load".into(),
        on: LoadPlace::Block { block: 0, load },
    }];
    system
}

/// A lumped muscle as long as the cube on a slide along x, whose motor pulls a mass of next to nothing.
pub(crate) fn slider(material: Material) -> System {
    let body = Body {
        name: "mass".into(),
        mass: 1e-12,
        inertia: [1.0; 3],
        centre: Vector3::new(EDGE, 0.0, 0.0),
        directors: Matrix3::identity(),
        shape: Shape::None,
    };
    let slide = Joint {
        name: "slide".into(),
        kind: JointKind::Prismatic { axis: Vector3::x() },
        at: Vector3::new(EDGE, 0.0, 0.0),
        ..Joint::default()
    };
    let mut system = bare(vec![body], vec![slide], None);
    let end = |body, x| Attachment {
        body,
        at: Vector3::new(x, 0.0, 0.0),
    };
    system.muscles = vec![Muscle {
        name: "muscle".into(),
        from: end(None, 0.0),
        to: end(Some(0), EDGE),
        cross_section: [EDGE, EDGE],
        layer_thickness: 0.05,
        material,
        prestretch: None,
        section_inertia: false,
        circuit: None,
        fidelity: Default::default(),
    }];
    system.components.loads = vec![Load {
        name: "load".into(),
        on: LoadPlace::Joint(0),
    }];
    system
}

pub(crate) fn model(system: &System, h: f64) -> Model {
    Model::new(system.clone(), None, h, &[]).unwrap()
}

/// A motion under one input that grows to `size` in `ramp` ms and stays.
pub(crate) fn motion(
    (model, start): (&Model, &Start),
    (h, steps): (f64, usize),
    (size, ramp): (f64, f64),
    integrator: Integrator,
) -> DiscreteTrajectory {
    let inputs = |from: f64, to: f64| model.scalars(&input(model, size, 0.5 * (from + to) / ramp));
    let solving = Solving {
        integrator,
        ..Solving::default()
    };
    let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
    let (discrete, failure) = simulate_by(solving, model, start, h, steps, inputs, go_on);
    assert_eq!(failure, None);
    discrete
}

/// The load, which is the last source, at a part of the ramp.
pub(crate) fn input(model: &Model, size: f64, part: f64) -> Vec<f64> {
    let mut inputs = vec![0.0; model.sources.len()];
    *inputs.last_mut().unwrap() = size * part.min(1.0);
    inputs
}

pub(crate) fn from_reference(model: &Model) -> Start {
    Start::at_rest(model, model.reference_coordinates())
}

fn column(model: &Model, discrete: &DiscreteTrajectory, name: &str) -> Vec<f64> {
    let seen = observations(model, discrete);
    let found = seen.columns.iter().find(|column| column.name == name);
    found
        .unwrap_or_else(|| panic!("no column {name}"))
        .values
        .clone()
}

/// Stretch of the cube along z.
pub(crate) fn height(model: &Model, z: &[f64]) -> f64 {
    placed(model, z)[7].z / EDGE
}

/// Stretch of the lumped muscle.
pub(crate) fn length(model: &Model, z: &[f64]) -> f64 {
    1.0 + model.joints(&model.action.map.placed(z), &[0.0])[0] / EDGE
}

/// A cube that a mass beyond measure keeps at a stretch Λ along z and Λ^(−1/2) across, with branches that have not felt it yet.
fn suddenly(model: &Model, stretch: f64) -> Start {
    let mut z = model.reference_coordinates();
    let across = stretch.powf(-0.5);
    let map = &model.action.map;
    for (i, &(_, axis)) in map.nodes().zip(&map.of_nodes) {
        z[i] *= if axis == 2 { stretch } else { across };
    }
    Start::at_rest(model, z)
}

#[test]
fn stress_relaxes_as_the_published_law_says() {
    // μ₁ = 50 kPa, τ = 0.1 s, a step to Λ = 0.8: nominal stresses in MPa.
    let expected = [
        (0.0, -0.114375),
        (50.0, -0.1009831352878),
        (100.0, -0.0919727479142),
    ];
    let heavy = Material {
        density: Some(1e14),
        ..rubber(0.4, &[[0.05, 100.0]])
    };
    let h = 5.0;
    let model = model(&cube(heavy), h);
    let start = suddenly(&model, 0.8);
    let galerkin = Integrator::Galerkin { degree: 3 };
    let discrete = motion((&model, &start), (h, 20), (0.0, 1.0), galerkin);
    assert!((height(&model, discrete.z.last().unwrap()) - 0.8).abs() < 1e-10);
    for (time, exact) in expected {
        let z = &discrete.z[(time / h) as usize][model.action.map.internal()];
        let law = |c: f64| {
            MODULUS * (0.8 - 0.8_f64.powi(-2)) + 0.05 * (0.8 / c - c.sqrt() / 0.8_f64.powi(2))
        };
        for point in z.chunks(5) {
            // C_i,33 = e^(z₁ + z₂), and the other two are alike; nothing is sheared.
            let found = law((point[0] + point[1]).exp());
            assert!(
                (found / exact - 1.0).abs() < 1e-8,
                "{time}: {found} {exact}"
            );
            assert!(
                (point[0] - point[1]).abs() < 1e-12 && point[2..].iter().all(|u| u.abs() < 1e-12)
            );
        }
    }
    let lost = column(&model, &discrete, "dissipated_energy");
    assert!(lost.windows(2).all(|pair| pair[1] > pair[0]), "{lost:?}");
}

/// Value of lists of numbers at μ/λ = 0, of which each list belongs to half of that of the one before: Romberg's scheme.
pub(crate) fn extrapolated(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    for power in 1..rows.len() as i32 {
        let factor = 2.0_f64.powi(power);
        let better = |pair: &[Vec<f64>]| -> Vec<f64> {
            let both = pair[0].iter().zip(&pair[1]);
            both.map(|(a, b)| b + (b - a) / (factor - 1.0)).collect()
        };
        rows = rows.windows(2).map(better).collect();
    }
    rows.remove(0)
}

/// Shear modulus over λ of the least compressible cube is 1/1280.
pub(crate) const LAMBDAS: [f64; 5] = [8.0, 16.0, 32.0, 64.0, 128.0];

#[test]
fn a_free_cube_that_hardly_changes_its_volume_is_the_lumped_muscle() {
    let (h, steps, ramp, stress) = (0.5, 40, 15.0, -0.05);
    let moved = |system: &System, size: f64, read: fn(&Model, &[f64]) -> f64| {
        let model = model(system, h);
        let start = from_reference(&model);
        let midpoint = Integrator::default();
        let discrete = motion((&model, &start), (h, steps), (size, ramp), midpoint);
        assert_eq!(discrete.report.halved, 0);
        discrete
            .z
            .iter()
            .map(|z| read(&model, z))
            .collect::<Vec<_>>()
    };
    let force = stress * EDGE * EDGE;
    let lumped = moved(&slider(rubber(1.0, &BRANCHES)), force, length);
    let (resting, z) = equilibrium_of(&slider(rubber(1.0, &[])), force, Response::Relaxed);
    let relaxed = length(&resting, &z);
    assert!(lumped[30] - relaxed > 0.02, "branches matter");
    let cubes = LAMBDAS.map(|lambda| moved(&cube(rubber(lambda, &BRANCHES)), stress, height));
    let limit = extrapolated(cubes.to_vec());
    for (k, (limit, lumped)) in limit.iter().zip(&lumped).enumerate() {
        assert!(
            (limit - lumped).abs() < 1e-10,
            "{k}: {limit} {lumped}: {:e}",
            limit - lumped
        );
    }
}

#[test]
fn a_clamped_block_creeps_as_that_of_felupe() {
    let known = reference("creep");
    let number = |key: &str| known[key].as_f64().unwrap();
    let list = |value: &serde_json::Value| -> Vec<Vector3<f64>> {
        let rows = value.as_array().unwrap().iter();
        rows.map(|row| Vector3::from_vec(numbers(row))).collect()
    };
    let of_branches = known["branches"].as_array().unwrap().iter();
    let of_branches: Vec<[f64; 2]> = of_branches
        .map(|pair| numbers(pair).try_into().unwrap())
        .collect();
    let material = Material {
        shear_modulus: number("mu"),
        lame_lambda: Some(number("lambda")),
        maxwell: branches(&of_branches),
        ..Material::default()
    };
    let mut mesh = Grid::uniform(Vector3::zeros(), Vector3::new(10.0, 4.0, 4.0), [2, 1, 1]).mesh();
    mesh.nodes = list(&known["nodes"]);
    let traction = Vector3::from_vec(numbers(&known["traction"]));
    let faces = mesh.faces_of(&mesh.sets["x_max"]);
    let mut solid = block(mesh, material);
    solid.supports = vec![held(&solid.mesh, "x_min", [true; 3])];
    let mut system = system(vec![solid]);
    system.components.loads = vec![Load {
        name: "load".into(),
        on: LoadPlace::Block {
            block: 0,
            load: BlockLoad::Traction(faces, traction.normalize()),
        },
    }];
    let ramp = number("ramp");
    let at = |steps: usize| {
        let h = ramp / steps as f64;
        let model = model(&system, h);
        let start = from_reference(&model);
        let load = (traction.norm(), ramp);
        let discrete = motion(
            (&model, &start),
            (h, 2 * steps),
            load,
            Integrator::default(),
        );
        [steps, 2 * steps].map(|k| placed(&model, &discrete.z[k]))
    };
    let [coarse, fine] = [at(20), at(40)];
    for (k, expected) in known["displacements"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let expected = list(expected);
        let largest = expected.iter().map(Vector3::amax).fold(0.0, f64::max);
        assert!(largest > 1.5, "{largest}");
        let error = |places: &[Vector3<f64>]| {
            let moved = places.iter().zip(&system.solids[0].mesh.nodes);
            let errors = moved.zip(&expected).map(|((x, at), u)| (x - at - u).amax());
            errors.fold(0.0, f64::max) / largest
        };
        let limit: Vec<_> = fine[k]
            .iter()
            .zip(&coarse[k])
            .map(|(f, c)| (f * 4.0 - c) / 3.0)
            .collect();
        let errors = [&coarse[k], &fine[k], &limit].map(|places| error(places));
        println!("relative to FElupe: {errors:?}");
        assert!(errors[2] < 1e-5 && errors[1] < 1e-4, "{errors:?}");
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 2.0).abs() < 0.3, "{errors:?}");
    }
}

/// Model and coordinates of a state of rest under a load.
pub(crate) fn equilibrium_of(system: &System, load: f64, response: Response) -> (Model, Vec<f64>) {
    let analysis = Analysis {
        response,
        ..Analysis::of_rest()
    };
    let model = Model::for_analysis(system.clone(), analysis).unwrap();
    assert_eq!(model.action.map.of_internal, 0);
    let inputs = model.scalars(&input(&model, load, 1.0));
    let found = stable_equilibrium(&model, &model.reference_coordinates(), &inputs).unwrap();
    (model, found.z)
}

#[test]
fn a_block_without_branches_has_no_unknown_and_no_term_of_them() {
    let [with, without] = [&BRANCHES[..1], &[]].map(|list| model(&cube(rubber(0.4, list)), 1.0));
    assert_eq!(with.coordinate_count(), without.coordinate_count() + 40);
    for term in ["block maxwell elasticity", "block maxwell viscosity"] {
        let has = |model: &Model| model.present.iter().any(|p| p.term == term);
        assert!(has(&with) && !has(&without), "{term}");
    }
    assert_eq!(with.coordinates, Coordinates::Reduced);
}

#[test]
fn dissipation_is_never_negative_and_balances_the_energy() {
    let mut material = rubber(0.4, &BRANCHES);
    material.density = Some(1e-3);
    let size = Vector3::new(12.0, 4.0, 5.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [2, 1, 1]).mesh();
    let mut solid = block(mesh, material);
    solid.supports = vec![held(&solid.mesh, "x_min", [true; 3])];
    // Bent and twisted at the start.
    let rates = |x: &Vector3<f64>| Vector3::new(0.0, -x.z, x.y + 1.0) * (0.02 * x.x);
    solid.velocities = solid.mesh.nodes.iter().map(rates).collect();
    let system = system(vec![solid]);
    let errors = [0.4, 0.2].map(|h| {
        let model = model(&system, h);
        let rates = model.node_rates().unwrap();
        let start = Start::with_rates(&model, model.reference_coordinates(), &rates);
        let steps = (12.0 / h) as usize;
        let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
        let solving = Solving::default();
        let none = |_: f64, _: f64| Vec::new();
        let (discrete, failure) = simulate_by(solving, &model, &start, h, steps, none, go_on);
        assert_eq!(failure, None);
        let total = column(&model, &discrete, "total_energy");
        let lost = column(&model, &discrete, "dissipated_energy");
        assert!(lost.windows(2).all(|pair| pair[1] >= pair[0]), "{lost:?}");
        assert!(
            lost[steps] > 0.2 * total[0],
            "{} of {}",
            lost[steps],
            total[0]
        );
        (total[steps] + lost[steps] - total[0]).abs() / total[0]
    });
    assert!(errors[1] < 1e-3, "{errors:?}");
    assert!(errors[0] / errors[1] > 3.0, "{errors:?}");
}
