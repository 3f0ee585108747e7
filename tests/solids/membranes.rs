//! Membranes: closed forms of a balloon, an annulus and a flat state, momenta in flight, glue to blocks, wrinkles, files.

use crate::common::solid::{block, placed, system};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::{
    DiscreteTrajectory, Start, Vibrations, equilibrium, observations, simulate, wrinkles,
};
use proboscis::files::read_scene;
use proboscis::mesh::Mesh;
use proboscis::mesh::gmsh;
use proboscis::mesh::grid::Grid;
use proboscis::mesh::surface::Surface;
use proboscis::model::Model;
use proboscis::model::components::{BlockLoad, Load, LoadPlace};
use proboscis::model::system::{
    Electrode, ElementKind, JointKind, Material, Potential, Solid, Support, System, Tie,
};
use std::ops::ControlFlow;
use std::path::Path;

/// μ = 100 kPa, ε_r = 3, of the reference.
fn rubber() -> Material {
    Material::elastomer(0.1).ideal_dielectric(3.0).density(1e-3)
}

fn film(mesh: Mesh, thickness: f64) -> Solid {
    Solid {
        name: "film".to_owned(),
        element: ElementKind::Membrane,
        materials: vec![rubber()],
        thickness: Some(thickness),
        mesh,
        ..Solid::default()
    }
}

fn made(surface: &Surface) -> Mesh {
    let (mesh, _) = surface.mesh();
    mesh.check().unwrap();
    mesh
}

fn under(mut solid: Solid, voltage: f64) -> Solid {
    solid.electrodes.push(Electrode {
        name: "both".to_owned(),
        nodes: solid.mesh.sets["surface"].clone(),
        potential: Potential::Given(voltage),
        circuit: None,
    });
    solid
}

fn held(mut solid: Solid, set: &str) -> Solid {
    let nodes = solid.mesh.sets[set].clone();
    solid.supports.push(Support {
        nodes,
        held: [true; 3],
    });
    solid
}

/// The radius of the balloon of the reference, over that without pressure, by its node on the z axis.
fn inflated(elements: usize, pressure: f64, voltage: f64) -> f64 {
    let mut balloon = under(film(made(&Surface::Sphere(20.0, elements)), 0.5), voltage);
    for axis in 0..3 {
        let nodes = balloon.mesh.nodes_on_plane(axis, 0.0, 1e-9);
        let held = [0, 1, 2].map(|other| other == axis);
        balloon.supports.push(Support { nodes, held });
    }
    let faces = balloon.mesh.boundary();
    let top = balloon.mesh.nearest_node(&(20.0 * Vector3::z())).unwrap();
    let mut system = system(vec![balloon]);
    system.components.loads.push(Load {
        name: "gas".to_owned(),
        on: LoadPlace::Block {
            block: 0,
            load: BlockLoad::Pressure {
                faces,
                follows: true,
            },
        },
    });
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[pressure]).unwrap();
    assert_eq!(found.is_stable(), Some(true));
    placed(&model, &found.z)[top].z / 20.0
}

#[test]
fn a_balloon_is_that_of_the_closed_form() {
    // p = (2 H μ/R)(1/λ − 1/λ⁷) − 2 ε V² λ/(H R), with pressures in MPa.
    let reference = [
        ([0.0005, 0.0], 1.018_055_860_7),
        ([0.0015, 0.0], 1.066_364_110_9),
        ([0.0015, 4000.0], 1.072_016_127_2),
    ];
    for ([pressure, voltage], exact) in reference {
        let [coarse, fine] = [3, 6].map(|n| inflated(n, pressure, voltage) - exact);
        let order = (coarse / fine).log2();
        assert!(fine.abs() < 3e-4, "{pressure} MPa, {voltage} V: {fine}");
        assert!(order > 2.5, "{pressure} MPa, {voltage} V: order {order}");
    }
}

/// The annulus around a rigid disc of the reference, with so many elements along the radius.
fn annulus(elements: usize) -> Model {
    Model::new(disc_in_annulus(elements), None, 1.0, &[]).unwrap()
}

fn disc_in_annulus(elements: usize) -> System {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/annulus.json");
    let mut system = read_scene(&path).unwrap();
    let radii = (0..=elements).map(|i| 10.0 + 15.0 * i as f64 / elements as f64);
    let mesh = made(&Surface::Annulus(radii.collect(), 8 * elements));
    let film = &mut system.solids[0];
    film.glued[0].nodes.clone_from(&mesh.sets["inner"]);
    film.supports[0].nodes.clone_from(&mesh.sets["outer"]);
    film.electrodes[0].nodes.clone_from(&mesh.sets["surface"]);
    film.mesh = mesh;
    film.mesh.region_names = vec!["surface".to_owned()];
    system
}

#[test]
fn an_annulus_around_a_disc_is_that_of_the_reference() {
    // Voltage in V and force in N, and the displacement of the disc in mm.
    let reference = [
        ([0.0, 0.1], 0.319_701_33),
        ([0.0, 0.6], 1.911_572_90),
        ([2000.0, 0.3], 0.968_441_95),
        ([3000.0, 0.6], 1.957_209_14),
    ];
    let models = [2, 4, 8].map(annulus);
    for (inputs, exact) in reference {
        let errors = models.each_ref().map(|model| {
            let found = equilibrium(model, &model.coordinates_at(&[]), &inputs).unwrap();
            found.z[0].abs() - exact
        });
        assert!(errors[2].abs() < 5e-6 * exact, "{inputs:?}: {errors:?}");
        let order = (errors[1] / errors[2]).abs().log2();
        assert!(order > 3.5, "{inputs:?}: {errors:?}");
    }
}

/// The disc of one gram on a film without mass swings with the stiffness by which states of rest under other forces differ.
#[test]
fn a_disc_on_an_annulus_has_the_frequency_of_its_stiffness() {
    let model = annulus(3);
    let rest = |force: f64| {
        let inputs = [2000.0, force];
        equilibrium(&model, &model.coordinates_at(&[]), &inputs).unwrap()
    };
    let at = rest(0.3);
    let modes = Vibrations::about(&model, &at).unwrap().modes(1).unwrap();
    let [one] = &modes.vibrations[..] else {
        panic!("one mode");
    };
    let small = 1e-4;
    let moved = (rest(0.3 + small).z[0] - rest(0.3 - small).z[0]).abs();
    let expected = (2.0 * small / moved).sqrt();
    let found = one.frequency * std::f64::consts::TAU;
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
}

/// A square sheet on rollers under a voltage: `μ (λ² − λ⁻⁴) = ε (V/H)² λ⁴`, up to pull-in at λ = 2^(1/3).
#[test]
fn a_free_sheet_stretches_until_it_is_pulled_in() {
    let square = Surface::Rectangle([vec![0.0, 5.0, 10.0], vec![0.0, 5.0, 10.0]]);
    let stretched = |field: f64| {
        let permittivity = rubber().electric.unwrap().permittivity;
        let voltage = 0.2 * field * (0.1 / permittivity).sqrt();
        let mut sheet = under(film(made(&square), 0.2), voltage);
        for (set, axis) in [("x_min", 0), ("y_min", 1), ("surface", 2)] {
            let nodes = sheet.mesh.sets[set].clone();
            let held = [0, 1, 2].map(|other| other == axis);
            sheet.supports.push(Support { nodes, held });
        }
        let model = Model::new(system(vec![sheet]), None, 1.0, &[]).unwrap();
        let found = equilibrium(&model, &model.coordinates_at(&[]), &[]).ok()?;
        let places = placed(&model, &found.z);
        let far = places.iter().map(|x| x.x).fold(0.0, f64::max);
        (found.is_stable() == Some(true)).then_some(far / 10.0)
    };
    for field in [0.3, 0.6, 0.68] {
        let [mut low, mut high] = [1.0, 2.0_f64.cbrt()];
        for _ in 0..60 {
            let middle: f64 = 0.5 * (low + high);
            match middle.powi(-2) - middle.powi(-8) < field * field {
                true => low = middle,
                false => high = middle,
            }
        }
        let found = stretched(field).unwrap();
        assert!((found - low).abs() < 1e-8, "{field}: {found} {low}");
    }
    // The field at the limit is √(2^(−2/3) − 2^(−8/3)) = 0.6874.
    assert_eq!(stretched(0.69), None);
}

#[test]
fn a_flat_membrane_has_the_charge_and_the_stress_of_the_closed_form() {
    let (stretch, thickness, voltage) = (1.5_f64, 0.5, 3000.0);
    let square = Surface::Rectangle([vec![0.0, 3.0, 10.0], vec![0.0, 6.0, 8.0]]);
    let mut solid = held(under(film(made(&square), thickness), voltage), "surface");
    let stretches = Vector3::new(stretch, stretch, stretch.powi(-2));
    solid.prestretch = Some(Matrix3::from_diagonal(&stretches));
    let model = Model::new(system(vec![solid]), None, 1.0, &[]).unwrap();
    let block = &model.solids[0];
    let x = model.action.map.placed(&model.coordinates_at(&[])).x;
    let (places, potentials) = (block.places(&x), block.potentials(&[]));
    let permittivity = block.material(0).electric.unwrap().permittivity;
    // The thickness is H/λ², and the stress μ (λ² − λ⁻⁴) − ε e².
    let field = voltage / thickness * stretch.powi(2);
    let expected = 0.1 * (stretch.powi(2) - stretch.powi(-4)) - permittivity * field.powi(2);
    let fields = block.fields(1, &places, &potentials);
    let stress = Matrix3::from_diagonal(&Vector3::new(expected, expected, 0.0));
    assert!((fields.stress - stress).amax() < 1e-13, "{}", fields.stress);
    assert!((fields.electric_field.norm() / field - 1.0).abs() < 1e-13);
    let displacement = fields.electric_displacement.norm();
    assert!((displacement / (permittivity * field) - 1.0).abs() < 1e-13);
    let gradient = Matrix3::from_diagonal(&stretches);
    assert!((fields.deformation_gradient - gradient).amax() < 1e-13);
    let charge: f64 = block.immobile_charges(&x, &[]).iter().sum();
    let expected = permittivity * field * 80.0;
    assert!(
        (charge / expected - 1.0).abs() < 1e-12,
        "{charge} {expected}"
    );
}

/// A free membrane with a viscosity and a Maxwell branch keeps its momenta, and loses energy.
#[test]
fn a_free_membrane_keeps_its_momenta() {
    let mut solid = film(made(&Surface::Annulus(vec![4.0, 7.0, 10.0], 8)), 0.3);
    solid.materials[0] = rubber().viscosity(0.5).maxwell(0.05, 3.0);
    let velocity = |x: &Vector3<f64>| {
        Vector3::new(0.1, 0.05 * x.x, 0.02 * x.y) + Vector3::new(0.01, 0.02, 0.03).cross(x)
    };
    solid.velocities = solid.mesh.nodes.iter().map(velocity).collect();
    keeps_momenta(system(vec![solid]));
}

/// So does one around a free disc, whose tangents are sums of nodes and of points of the disc.
#[test]
fn a_free_membrane_around_a_disc_keeps_its_momenta() {
    let mut free = disc_in_annulus(2);
    free.joints[0].kind = JointKind::Floating;
    free.components.loads.clear();
    let film = &mut free.solids[0];
    film.supports.clear();
    film.electrodes.clear();
    film.materials[0] = rubber().viscosity(0.5);
    film.prestretch = None;
    let velocity = |x: &Vector3<f64>| Vector3::new(0.1, 0.02 * x.x, 0.01 * x.y);
    film.velocities = film.mesh.nodes.iter().map(velocity).collect();
    keeps_momenta(free);
}

/// Momenta stay in 60 steps of half a millisecond, and energy is lost.
fn keeps_momenta(system: System) {
    let model = Model::new(system, None, 0.5, &[]).unwrap();
    let rates = model.node_rates().unwrap();
    let start = Start::with_rates(&model, model.coordinates_at(&[]), &rates);
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate(&model, &start, 0.5, 60, |_, _| vec![], go_on);
    assert_eq!(failure, None);
    let seen = observations(&model, &discrete);
    for column in &seen.columns {
        let values = &column.values[1..];
        let largest = values.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
        let drift = values
            .iter()
            .map(|v| (v - values[0]).abs())
            .fold(0.0, f64::max);
        if column.name.contains("momentum") {
            assert!(drift < 1e-9 * largest, "{}: {drift:e}", column.name);
        }
        if column.name == "total_energy" {
            let last = values[values.len() - 1];
            assert!(last < 0.99 * values[0], "{last} of {}", values[0]);
        }
    }
}

/// The lowest frequency of a round membrane under tension is 2.404826 √(σ/ρ)/R, and its stress does not change to first order.
#[test]
fn a_drum_has_its_frequency() {
    let stretch = 1.3_f64;
    let radii = (0..=8).map(|i| 20.0 * f64::from(i) / 8.0).collect();
    let mut solid = held(film(made(&Surface::Disc(radii)), 0.2), "edge");
    let stretches = Vector3::new(stretch, stretch, stretch.powi(-2));
    solid.prestretch = Some(Matrix3::from_diagonal(&stretches));
    let model = Model::new(system(vec![solid]), None, 1.0, &[]).unwrap();
    let rest = model.coordinates_at(&[]);
    let found = equilibrium(&model, &rest, &[]).unwrap();
    let stress = 0.1 * (stretch.powi(2) - stretch.powi(-4));
    let expected = 2.404_825_557_7 * (stress / 1e-3_f64).sqrt() / 20.0;
    let modes = Vibrations::about(&model, &found).unwrap().modes(1).unwrap();
    let [lowest] = &modes.vibrations[..] else {
        panic!("one mode");
    };
    let found = lowest.frequency * std::f64::consts::TAU;
    assert!((found / expected - 1.0).abs() < 2e-4, "{found} {expected}");
}

/// A film with triangles of its own between two blocks, whose faces they do not meet, pulls as far as one that is clamped to places of the faces.
#[test]
fn a_membrane_is_glued_to_faces_of_blocks() {
    let grid = Grid::uniform(
        Vector3::new(-4.0, -3.0, -3.0),
        Vector3::new(4.0, 6.0, 6.0),
        [1, 2, 3],
    );
    let mut wall = block(grid.mesh(), Material::elastomer(1.0).poisson_ratio(0.3));
    wall.supports = vec![Support {
        nodes: wall.mesh.sets["x_min"].clone(),
        held: [true; 3],
    }];
    let mesh = made(&Surface::Rectangle([
        vec![0.0, 5.0, 10.0],
        vec![-2.0, 0.5, 2.0],
    ]));
    let faces = wall.mesh.boundary();
    let mut sheet = held(film(mesh, 0.2), "x_max");
    sheet.prestretch = Some(Matrix3::from_diagonal(&Vector3::new(1.4, 1.1, 0.6)));
    let along: Vec<usize> = ["y_min", "y_max"]
        .map(|set| sheet.mesh.sets[set].clone())
        .concat();
    sheet.supports.push(Support {
        nodes: along,
        held: [false, true, true],
    });
    for &node in &sheet.mesh.sets["x_min"] {
        let at = sheet.mesh.nodes[node];
        let on = wall.mesh.footing(&faces, &at).unwrap();
        let sum: Vector3<f64> = on.iter().map(|&(n, part)| wall.mesh.nodes[n] * part).sum();
        assert!((sum - at).norm() < 1e-12);
        let is_inside = |(_, part): &(usize, f64)| (-1e-5..=1.0 + 1e-5).contains(part);
        assert!(on.iter().all(is_inside), "{at}: {on:?}");
        sheet.tied.push(Tie { node, solid: 0, on });
    }
    let edge = sheet.mesh.sets["x_min"].clone();
    let model = Model::new(system(vec![wall, sheet]), None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[]).unwrap();
    assert_eq!(found.is_stable(), Some(true));
    let x = model.action.map.placed(&found.z).x;
    let [wall, sheet] = [&model.solids[0], &model.solids[1]];
    let (of_wall, of_sheet) = (wall.places(&x), sheet.places(&x));
    let pulled = of_sheet[edge[0]].x;
    assert!(pulled > 1e-3, "{pulled}");
    // The edge is where the face is, and the wall is pulled by the force of the film across a section, width by stress by thickness.
    let faces = wall.solid.mesh.boundary();
    let moved = Mesh {
        nodes: of_wall,
        ..wall.solid.mesh.clone()
    };
    for &node in &edge {
        assert!(moved.footing(&faces, &of_sheet[node]).is_some());
    }
    let section = |element: usize| {
        let fields = sheet.fields(element, &of_sheet, &[0.0; 64]);
        fields.stress[(0, 0)] * 0.2 * fields.deformation_gradient[(2, 2)]
    };
    let forces: Vec<f64> = (0..sheet.sheets.len()).map(section).collect();
    let [least, most] = [f64::min, f64::max].map(|of| forces.iter().copied().reduce(of).unwrap());
    assert!(least > 0.5 * most && most > 0.0, "{forces:?}");
}

#[test]
fn a_compressed_membrane_is_told() {
    let square = Surface::Rectangle([vec![0.0, 5.0, 10.0], vec![0.0, 5.0, 10.0]]);
    let told = |stretch: f64, voltage: f64| {
        let solid = held(under(film(made(&square), 0.2), voltage), "surface");
        let stretches = Vector3::new(stretch, 1.2, 1.0 / (1.2 * stretch));
        let prestretch = Some(Matrix3::from_diagonal(&stretches));
        let solid = Solid {
            prestretch,
            ..solid
        };
        let model = Model::new(system(vec![solid]), None, 1.0, &[]).unwrap();
        let at = DiscreteTrajectory {
            times: vec![0.0],
            z: vec![model.coordinates_at(&[])],
            scalars: vec![Vec::new()],
            ..DiscreteTrajectory::default()
        };
        wrinkles(&model, &at)
    };
    assert_eq!(told(1.2, 0.0), []);
    let [one] = &told(0.7, 0.0)[..] else {
        panic!("one membrane is compressed");
    };
    let expected = 0.1 * (0.7_f64.powi(2) - (0.7 * 1.2_f64).powi(-2));
    assert!((one.stress - expected).abs() < 1e-13, "{one:?}");
    // The voltage makes it too large for its edges.
    assert_eq!(told(1.2, 9000.0).len(), 1);
}

/// Triangles and quadrangles of first and second order are one surface, with its edge and its two regions as sets.
#[test]
fn surfaces_come_from_files() {
    let files = [
        ("1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n", 4),
        ("1 3 2 1 1 1 2 3 4\n", 4),
        ("1 9 2 1 1 1 2 3 5 6 9\n2 9 2 1 1 1 3 4 9 7 8\n", 9),
        ("1 10 2 1 1 1 2 3 4 5 6 7 8 9\n", 9),
    ];
    let places = [
        [0, 0],
        [4, 0],
        [4, 2],
        [0, 2],
        [2, 0],
        [4, 1],
        [2, 2],
        [0, 1],
        [2, 1],
    ];
    for (elements, count) in files {
        let nodes: String = (0..count)
            .map(|n| format!("{} {} {} 0\n", n + 1, places[n][0], places[n][1]))
            .collect();
        let edge = match count {
            4 => "9 1 2 2 1 1 2\n",
            _ => "9 8 2 2 1 1 2 5\n",
        };
        let lines = elements.lines().count() + 1;
        let text = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"skin\"\n1 2 \"below\"\n$EndPhysicalNames\n\
             $Nodes\n{count}\n{nodes}$EndNodes\n$Elements\n{lines}\n{elements}{edge}$EndElements\n"
        );
        let mesh = gmsh::parse(text.as_bytes(), "a.msh", 1.0).unwrap();
        mesh.check().unwrap();
        assert_eq!(
            (mesh.nodes.len(), mesh.triangles.len()),
            (9, 2),
            "{elements}"
        );
        let place = |&node: &usize| mesh.nodes[node];
        let mut below: Vec<f64> = mesh.sets["below"].iter().map(|n| place(n).x).collect();
        below.sort_by(f64::total_cmp);
        assert_eq!(below, [0.0, 2.0, 4.0], "{elements}");
        assert_eq!(mesh.sets["skin"].len(), 9, "{elements}");
        let area: f64 = mesh.areas_of(&mesh.boundary()).values().sum();
        assert!((area - 8.0).abs() < 1e-12, "{elements}: {area}");
        for nodes in &mesh.triangles {
            for (middle, [a, b]) in nodes[3..].iter().zip([[0, 1], [1, 2], [0, 2]]) {
                let expected = (place(&nodes[a]) + place(&nodes[b])) / 2.0;
                assert!((place(middle) - expected).norm() < 1e-12, "{elements}");
            }
        }
    }
}

/// Areas of all surfaces by their triangles.
#[test]
fn surfaces_have_their_areas() {
    let pi = std::f64::consts::PI;
    let steps = |from: f64, to: f64| (0..=6).map(move |i| from + (to - from) * f64::from(i) / 6.0);
    let all = [
        (
            Surface::Rectangle([steps(0.0, 3.0).collect(), steps(0.0, 2.0).collect()]),
            6.0,
        ),
        (Surface::Disc(steps(0.0, 2.0).collect()), 4.0 * pi),
        (Surface::Annulus(steps(1.0, 2.0).collect(), 24), 3.0 * pi),
        (Surface::Tube(2.0, 24, steps(0.0, 3.0).collect()), 12.0 * pi),
        (Surface::Sphere(2.0, 6), 16.0 * pi),
    ];
    for (surface, expected) in all {
        let mesh = made(&surface);
        let area: f64 = mesh.areas_of(&mesh.boundary()).values().sum();
        assert!(
            (area / expected - 1.0).abs() < 2e-4,
            "{surface:?}: {area} {expected}"
        );
    }
}
