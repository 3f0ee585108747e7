//! Loads of blocks: against FElupe, closed forms, weights, and what a pressure conserves.

use crate::common::solid::{
    block, clamped, crooked, dielectric, electrode, held, numbers, placed, reference, system,
};
use nalgebra::Vector3;
use proboscis::dynamics::{DiscreteTrajectory, Start, equilibrium, observations, simulate};
use proboscis::mesh::Mesh;
use proboscis::mesh::grid::Grid;
use proboscis::model::components::{BlockLoad, Faces, Load, LoadPlace};
use proboscis::model::system::{ElectricConstants, Material, Potential, Solid, System};
use proboscis::model::{Analysis, Coordinates, Model};
use std::ops::ControlFlow;

/// A system of one block with one load.
fn loaded(solid: Solid, load: BlockLoad) -> System {
    let mut system = system(vec![solid]);
    system.components.loads = vec![Load {
        name: "load".into(),
        on: LoadPlace::Block { block: 0, load },
    }];
    system
}

fn faces(mesh: &Mesh, set: &str) -> Faces {
    mesh.faces_of(&mesh.sets[set])
}

/// All faces of the surface.
fn surface(mesh: &Mesh) -> Faces {
    mesh.boundary()
}

#[test]
fn a_crooked_block_under_loads_is_that_of_felupe() {
    let known = reference("pressure");
    let list = |value: &serde_json::Value| -> Vec<Vector3<f64>> {
        let rows = value.as_array().unwrap().iter();
        rows.map(|row| Vector3::from_vec(numbers(row))).collect()
    };
    let number = |key: &str| known[key].as_f64().unwrap();
    let mut mesh = Grid::uniform(Vector3::zeros(), Vector3::new(12.0, 5.0, 6.0), [4, 2, 2]).mesh();
    mesh.nodes = list(&known["nodes"]);
    let material = Material {
        density: None,
        shear_modulus: number("mu"),
        lame_lambda: Some(number("lambda")),
        ..Material::default()
    };
    let upper = faces(&mesh, "z_max");
    let pressure = |follows| BlockLoad::Pressure {
        faces: upper.clone(),
        follows,
    };
    let traction = Vector3::from_vec(numbers(&known["traction"]));
    let along = BlockLoad::Traction(upper.clone(), traction.normalize());
    for (name, load, size) in [
        ("following", pressure(true), number("pressure")),
        ("dead", pressure(false), number("pressure")),
        ("traction", along, traction.norm()),
    ] {
        let mut solid = block(mesh.clone(), material);
        solid.supports = vec![held(&solid.mesh, "x_min", [true; 3])];
        let model = Model::new(loaded(solid, load), None, 1.0, &[]).unwrap();
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[size]).unwrap();
        assert_eq!(found.is_stable(), Some(true), "{name}");
        let expected = list(&known["displacements"][name]);
        let largest = expected.iter().map(Vector3::amax).fold(0.0, f64::max);
        assert!(largest > 0.2, "{name}");
        let moved = placed(&model, &found.z).into_iter().zip(&mesh.nodes);
        for ((x, at), u) in moved.zip(&expected) {
            assert!(
                (x - at - u).amax() < 1e-10 * largest,
                "{name}: {x} {at} {u}"
            );
        }
    }
}

/// A motion of a block from rest under a constant load.
fn motion(system: System, size: f64, (step, steps): (f64, usize)) -> (Model, DiscreteTrajectory) {
    let model = Model::new(system, None, step, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let scalars = model.scalars(&[0.0, size]);
    let drive = |_: f64, _: f64| scalars.clone();
    let (discrete, failure) = simulate(&model, &start, step, steps, drive, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    (model, discrete)
}

fn column(model: &Model, discrete: &DiscreteTrajectory, name: &str) -> Vec<f64> {
    let seen = observations(model, discrete);
    let found = seen.columns.iter().find(|column| column.name == name);
    found
        .unwrap_or_else(|| panic!("no column {name}"))
        .values
        .clone()
}

#[test]
fn a_pressure_on_a_closed_surface_pushes_nothing_away() {
    let follows = |mesh: &Mesh, follows| BlockLoad::Pressure {
        faces: surface(mesh),
        follows,
    };
    for does_follow in [true, false] {
        let solid = crooked(Some(1.0));
        let load = follows(&solid.mesh, does_follow);
        let (model, discrete) = motion(loaded(solid, load), 0.02, (0.2, 40));
        let kinetic = column(&model, &discrete, "kinetic_energy");
        let most = kinetic.iter().fold(0.0_f64, |m, e| m.max(*e));
        assert!(most > 1e-2, "{most}");
        for axis in ["x", "y", "z"] {
            let linear = column(&model, &discrete, &format!("linear_momentum_{axis}"));
            let angular = column(&model, &discrete, &format!("angular_momentum_{axis}"));
            let most = |list: &[f64]| list.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
            assert!(most(&linear) < 1e-12, "{axis}: {linear:?}");
            // Dead pressures turn what has been deformed.
            let is_zero = most(&angular) < 1e-10;
            assert!(is_zero || !does_follow, "{axis}: {angular:?}");
        }
    }
}

#[test]
fn the_work_of_a_following_pressure_is_the_energy_that_it_supplies() {
    // Without viscosity E − W is constant, and W = −p ΔV as the surface is closed.
    let volume = |model: &Model, z: &[f64]| -> f64 {
        let x = placed(model, z);
        let quads = surface(&model.solids[0].solid.mesh);
        let of = |quad: &Vec<usize>| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| x[quad[i]]);
            // The volume under a bilinear face.
            let normal =
                |p: &Vector3<f64>, q: &Vector3<f64>, r: &Vector3<f64>| p.dot(&q.cross(r)) / 6.0;
            let one = normal(&a, &b, &c) + normal(&a, &c, &d);
            let two = normal(&a, &b, &d) + normal(&b, &c, &d);
            0.5 * (one + two)
        };
        quads.iter().map(of).sum()
    };
    let run = |step: f64, steps: usize| {
        let solid = clamped(None);
        let load = BlockLoad::Pressure {
            faces: surface(&solid.mesh),
            follows: true,
        };
        let (model, discrete) = motion(loaded(solid, load), 0.02, (step, steps));
        let work = column(&model, &discrete, "following_load_work");
        let energy = column(&model, &discrete, "total_energy");
        let change = volume(&model, &discrete.z[steps]) - volume(&model, &discrete.z[0]);
        let sums: Vec<f64> = energy.iter().zip(&work).map(|(e, w)| e - w).collect();
        let worst = sums[1..]
            .iter()
            .map(|s| (s - sums[0]).abs())
            .fold(0.0, f64::max);
        (worst, work[steps], -0.02 * change)
    };
    let [coarse, fine] = [run(0.04, 60), run(0.02, 120)];
    assert!(fine.1.abs() > 1e-2, "{fine:?}");
    assert!((coarse.0 / fine.0 - 4.0).abs() < 0.8, "{coarse:?} {fine:?}");
    let errors = [coarse, fine].map(|(_, work, exact)| (work - exact).abs());
    assert!(errors[1] < 1e-3 * fine.1.abs(), "{coarse:?} {fine:?}");
    assert!((errors[0] / errors[1] - 4.0).abs() < 1.0, "{errors:?}");
}

#[test]
fn a_body_force_is_weight() {
    let direction = Vector3::new(0.6, 0.0, -0.8);
    let weigh = |solid: Solid| {
        let mut system = system(vec![solid]);
        system.gravity = Some(direction * 0.02);
        system
    };
    let pushed = loaded(clamped(Some(1.0)), BlockLoad::BodyForce(direction));
    // ρ = 10⁻³ g/mm³.
    let (_, one) = motion(pushed, 2e-5, (0.5, 30));
    let model = Model::new(weigh(clamped(Some(1.0))), None, 0.5, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let scalars = model.scalars(&[0.0]);
    let (two, failure) = simulate(
        &model,
        &start,
        0.5,
        30,
        |_, _| scalars.clone(),
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    let most = two.z[30].iter().fold(0.0_f64, |m, z| m.max(z.abs()));
    assert!(most > 0.1, "{most}");
    for (a, b) in one.z[30].iter().zip(&two.z[30]) {
        assert!((a - b).abs() < 1e-11 * most, "{a} {b}");
    }
}

/// A slab of an ideal dielectric whose lower face is grounded and whose upper one carries a charge; `is_free` says whether it may deform.
fn slab(is_free: bool) -> System {
    let size = Vector3::new(4.0, 3.0, 2.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [2, 3, 2]).mesh();
    let electric = ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: 3e-11,
    };
    let mut solid = block(mesh, dielectric(0.1, 0.5, electric));
    let mesh = &solid.mesh;
    let rollers = [("x_min", 0), ("y_min", 1), ("z_min", 2)];
    solid.supports = match is_free {
        true => rollers
            .map(|(face, axis)| held(mesh, face, std::array::from_fn(|i| i == axis)))
            .into(),
        false => vec![proboscis::model::system::Support {
            nodes: (0..mesh.nodes.len()).collect(),
            held: [true; 3],
        }],
    };
    solid.electrodes = vec![electrode(mesh, "ground", 0.0, Potential::Given(0.0))];
    let charge = BlockLoad::Charge(faces(&solid.mesh, "z_max"));
    loaded(solid, charge)
}

#[test]
fn a_slab_with_a_surface_charge_has_that_displacement() {
    // C/m² of the size of ε √(μ/ε): 1.7 kC/m² in 10⁻³ mC/mm².
    let charge = 1.3e-6;
    let model = Model::new(slab(false), None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[charge]).unwrap();
    let potentials = model.solids[0].potentials(&found.scalars);
    let mesh = &model.solids[0].solid.mesh;
    for (node, potential) in mesh.nodes.iter().zip(&potentials) {
        // E = Q/ε, and φ grows towards the charge.
        let exact = charge / 3e-11 * node.z;
        assert!(
            (potential - exact).abs() < 1e-12 * charge / 3e-11 * 2.0,
            "{potential} {exact}"
        );
    }
    assert!(potentials.iter().any(|p| *p > 8e4));
    // What the electrode at the other side supplies is the opposite charge.
    let instant = model.action.map.placed(&found.z);
    let supplied = model.solids[0].immobile_charges(&instant.x, &found.scalars);
    assert!(
        (supplied[0] + charge * 12.0).abs() < 1e-12 * charge * 12.0,
        "{supplied:?}"
    );
}

#[test]
fn a_free_slab_with_a_surface_charge_thins_by_its_closed_form() {
    // Stretches a (x = y) and c (z) of the block: with the charge the energy per volume is W(a, c) + Q²c/(2 ε a² A²…): Q = charge of the
    // reference area, D = Q/a², energy D²/(2ε) a² c.
    let charge = 1.3e-6;
    let (mu, lambda, eps) = (0.1, 0.5, 3e-11);
    let k = charge * charge / (2.0 * eps);
    // ∂/∂a and ∂/∂c of μ/2 (2a² + c² − 3) − μ ln J + λ/2 ln² J + k c/a², J = a² c.
    let (mut a, mut c) = (1.0_f64, 1.0_f64);
    let slope = |a: f64, c: f64| {
        let log = (a * a * c).ln();
        [
            2.0 * mu * a + 2.0 * (lambda * log - mu) / a - 2.0 * k * c / a.powi(3),
            mu * c + (lambda * log - mu) / c + k / (a * a),
        ]
    };
    for _ in 0..200 {
        let e = 1e-7;
        let [f, g] = slope(a, c);
        let [fa, ga] = slope(a + e, c);
        let [fc, gc] = slope(a, c + e);
        let j = nalgebra::Matrix2::new((fa - f) / e, (fc - f) / e, (ga - g) / e, (gc - g) / e);
        let step = j.lu().solve(&nalgebra::Vector2::new(f, g)).unwrap();
        a -= step.x;
        c -= step.y;
    }
    assert!(c < 0.9 && a > 1.03, "{a} {c}");
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let model = Model::new(slab(true), Some(coordinates), 1.0, &[]).unwrap();
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[charge]).unwrap();
        assert_eq!(found.is_stable(), Some(true));
        let mesh = &model.solids[0].solid.mesh;
        for (x, at) in placed(&model, &found.z).iter().zip(&mesh.nodes) {
            let exact = Vector3::new(a * at.x, a * at.y, c * at.z);
            assert!((x - exact).amax() < 1e-10, "{x} {exact}");
        }
    }
}

#[test]
fn a_load_stays_itself_beside_an_electrode_without_voltage() {
    let direction = -Vector3::z();
    let system = loaded(clamped(None), BlockLoad::BodyForce(direction));
    let analysis = Analysis {
        zero_inputs: [0].into(),
        ..Analysis::of_motion(1.0)
    };
    let model = Model::for_analysis(system, analysis).unwrap();
    assert_eq!(model.variables.sources().collect::<Vec<_>>(), [1]);
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[1e-4]).unwrap();
    let top = placed(&model, &found.z)
        .iter()
        .map(|x| x.z)
        .fold(0.0, f64::max);
    let before = model.solids[0]
        .solid
        .mesh
        .nodes
        .iter()
        .map(|x| x.z)
        .fold(0.0, f64::max);
    assert!(top < before - 0.05, "{top} {before}");
}
