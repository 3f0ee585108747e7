//! Blocks against physics: contraction of a bar, free blocks, locking, muscles of finite elements against lumped ones.

use crate::common::solid::{
    DRIVEN, at_rest, block, dielectric, electrode, held, placed, published, system,
};
use nalgebra::Vector3;
use proboscis::dynamics::{DiscreteTrajectory, Start, energies, simulate};
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::system::{
    ElectricConstants, ElementKind, Material, Potential, System, VACUUM_PERMITTIVITY,
};
use std::ops::ControlFlow;

const LENGTH: f64 = 0.1;
const STEP: f64 = 1e-3;

/// Five elements in a row with a rigid cross-section: a bar under uniaxial strain, clamped below.
fn bar(viscosity: Option<f64>) -> System {
    let size = Vector3::new(0.02, 0.02, LENGTH);
    let mesh = Grid::uniform(Vector3::zeros(), size, [1, 1, 5]).mesh();
    let mut solid = block(mesh, published(viscosity));
    let mesh = &solid.mesh;
    let mut guided = held(mesh, "z_min", [true, true, false]);
    guided.nodes = (0..mesh.nodes.len()).collect();
    solid.supports = vec![guided, held(mesh, "z_min", [true; 3])];
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        electrode(mesh, "top", LENGTH, DRIVEN),
    ];
    system(vec![solid])
}

#[test]
fn a_bar_contracts_at_rest() {
    let places = at_rest(bar(None), &[2e4]);
    for tip in &places[20..] {
        let stretch = tip.z / LENGTH;
        assert!(
            (stretch - 0.950_980_230_911_769_3).abs() < 1e-10,
            "{stretch}"
        );
    }
}

/// The motion of the bar, of which the first interval sees another voltage.
fn contraction(viscosity: Option<f64>, first: f64) -> (Model, DiscreteTrajectory) {
    let model = Model::new(bar(viscosity), None, STEP, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let voltage = |from: f64, _: f64| vec![if from == 0.0 { first } else { 2e4 }];
    let (discrete, failure) = simulate(&model, &start, STEP, 100, voltage, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    assert_eq!(discrete.report.halved, 0);
    (model, discrete)
}

/// Instants by number and the tip there in mm.
type Table<'a> = &'a [(usize, f64)];

#[test]
fn a_bar_contracts_by_the_tables() {
    let viscous_ramp: Table<'_> = &[
        (1, 0.099565918),
        (2, 0.097732665),
        (5, 0.092361318),
        (6, 0.091899633),
        (10, 0.097666459),
        (11, 0.097805692),
        (16, 0.092754288),
        (21, 0.097170913),
        (26, 0.093351983),
        (31, 0.096605672),
        (51, 0.095907497),
        (100, 0.095300191),
    ];
    let ramp: Table<'_> = &[
        (1, 0.099503750),
        (2, 0.097519678),
        (5, 0.091933015),
        (6, 0.091394865),
        (10, 0.098415389),
        (11, 0.098468143),
        (16, 0.091816270),
        (21, 0.099212501),
        (26, 0.091155128),
        (31, 0.098402868),
        (51, 0.098397749),
        (100, 0.099183787),
    ];
    let viscous_jump: Table<'_> = &[
        (1, 0.098301541),
        (2, 0.096062974),
        (6, 0.092281686),
        (11, 0.097418800),
        (16, 0.093230183),
        (21, 0.096758688),
        (31, 0.096281997),
        (51, 0.095688637),
        (100, 0.095282272),
    ];
    let jump: Table<'_> = &[
        (1, 0.098070626),
        (2, 0.095901639),
        (6, 0.091658393),
        (11, 0.098164478),
        (16, 0.092508538),
        (21, 0.098057574),
        (31, 0.098111612),
        (51, 0.098063549),
        (100, 0.098688476),
    ];
    for (viscosity, first, table) in [
        (Some(0.25), 1e4, viscous_ramp),
        (None, 1e4, ramp),
        (Some(0.25), 2e4, viscous_jump),
        (None, 2e4, jump),
    ] {
        let (model, discrete) = contraction(viscosity, first);
        for &(k, expected) in table {
            let tip = placed(&model, &discrete.z[k])[20].z;
            // The tables have nine decimals.
            assert!((tip - expected).abs() < 6e-10, "{k}: {tip} {expected}");
        }
    }
}

#[test]
fn the_energy_of_the_bar_keeps_to_its_interval() {
    let (model, discrete) = contraction(None, 1e4);
    let [mut a, mut b] = [(); 2].map(|()| model.action.map.instant());
    let (mut low, mut high, mut kinetic) = (f64::INFINITY, 0.0_f64, 0.0_f64);
    for n in 1..99 {
        for (instant, k) in [(&mut a, n), (&mut b, n + 1)] {
            instant.z.copy_from_slice(&discrete.z[k]);
            model.action.map.place(instant);
        }
        let energy = energies(&model, &a, &b, &discrete.scalars[n], STEP);
        kinetic = kinetic.max(energy.kinetic);
        (low, high) = (low.min(energy.total()), high.max(energy.total()));
    }
    assert!(kinetic > 4e-5, "{kinetic}");
    println!("energy of the bar in [{low}, {high}] mJ");
    assert!((low - 0.081_570_116_003_553_11).abs() < 1e-14, "{low}");
    assert!((high - 0.081_571_165_880_456_57).abs() < 1e-14, "{high}");
}

#[test]
fn the_bar_has_its_frequency_and_damping() {
    let model = Model::new(bar(Some(0.25)), None, STEP, &[]).unwrap();
    // The first mode of equal elements is a sine at their nodes.
    let (z, map) = (model.coordinates_at(&[]), &model.action.map);
    let sine = |z: &f64| 1e-6 * (std::f64::consts::FRAC_PI_2 * z / LENGTH).sin();
    let rates: Vec<f64> = z.iter().map(sine).collect();
    assert!(map.of_nodes.iter().all(|&(_, axis)| axis == 2));
    let start = Start::with_rates(&model, z, &rates);
    let (discrete, failure) = simulate(
        &model,
        &start,
        STEP,
        8,
        |_, _| vec![0.0],
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    let u: Vec<f64> = (0..8)
        .map(|k| placed(&model, &discrete.z[k])[20].z - LENGTH)
        .collect();
    // u₊ = a u − b u₋ along a damped mode, solved for a and b from two triples.
    let determinant = u[5] * u[3] - u[4] * u[4];
    let a = (u[6] * u[3] - u[5] * u[4]) / determinant;
    let b = (u[6] * u[4] - u[5] * u[5]) / determinant;
    // The multiplier ρ = r e^{iα} of a step, r² = b, 2 r cos α = a; s = (2/h)(ρ − 1)/(ρ + 1) is that of the motion in time.
    let (r, turn) = (b.sqrt(), (0.5 * a / b.sqrt()).acos());
    let below = 1.0 + b + a;
    let real = (b - 1.0) / below * 2.0 / STEP;
    let imaginary = 2.0 * r * turn.sin() / below * 2.0 / STEP;
    let omega = real.hypot(imaginary);
    println!("ω = {omega}, ζ = {}", -real / omega);
    assert!((omega / 603.867_510_231_557_2 - 1.0).abs() < 1e-5);
    assert!((-real / omega / 0.051_496_410_682_865_77 - 1.0).abs() < 1e-4);
}

#[test]
fn a_free_block_takes_its_homogeneous_state() {
    for (field, across, along) in [
        (2.0e4, 1.000_497_244_4, 0.998_776_462_8),
        (5.0e4, 1.003_083_359_9, 0.992_443_338_3),
        (1.0e5, 1.012_001_614_0, 0.970_988_099_1),
        (1.5e5, 1.025_876_383_3, 0.938_756_011_6),
        (2.0e5, 1.043_555_014_8, 0.899_609_295_0),
    ] {
        let mesh = Grid::uniform(Vector3::zeros(), Vector3::new(2.0, 3.0, 0.5), [1; 3]).mesh();
        let mut solid = block(mesh, published(None));
        let mesh = &solid.mesh;
        solid.supports = vec![
            held(mesh, "x_min", [true, false, false]),
            held(mesh, "y_min", [false, true, false]),
            held(mesh, "z_min", [false, false, true]),
        ];
        solid.electrodes = vec![
            electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
            electrode(mesh, "top", 0.5, DRIVEN),
        ];
        let places = at_rest(system(vec![solid]), &[0.5 * field]);
        let corner = places[7];
        // The table has ten decimals.
        assert!(
            (corner.x / 2.0 - across).abs() < 6e-11,
            "{}",
            corner.x / 2.0
        );
        assert!((corner.y / 3.0 - across).abs() < 6e-11);
        assert!((corner.z / 0.5 - along).abs() < 6e-11, "{}", corner.z / 0.5);
    }
}

/// An ideal dielectric in which a field of one V/mm is one unit √(μ/ε).
fn ideal(lame_lambda: f64) -> Material {
    let electric = ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: 1.0,
    };
    dielectric(1.0, lame_lambda, electric)
}

/// Rotation per length of a bilayer of two layers of 1 mm, passive below, under plane strain and φ_n = 0.5.
fn curvature(element: ElementKind, along: usize, layer: usize) -> f64 {
    let length = 10.0;
    let size = Vector3::new(length, length / along as f64, 2.0);
    let mut mesh = Grid::uniform(Vector3::zeros(), size, [along, 1, 2 * layer]).mesh();
    let half = mesh.hexahedra.len() / 2;
    mesh.regions = (0..2 * half).map(|e| usize::from(e >= half)).collect();
    mesh.region_names = vec!["passive".into(), "active".into()];
    let material = ideal(1000.0);
    let passive = Material {
        electric: None,
        ..material
    };
    let mut solid = block(mesh, material);
    solid.materials = vec![passive, material];
    solid.element = element;
    let mesh = &solid.mesh;
    let mut plane = held(mesh, "y_min", [false, true, false]);
    plane.nodes = (0..mesh.nodes.len()).collect();
    let mut corner = held(mesh, "x_min", [true, false, true]);
    corner.nodes.retain(|&n| mesh.nodes[n].z == 0.0);
    solid.supports = vec![plane, held(mesh, "x_min", [true, false, false]), corner];
    solid.electrodes = vec![
        electrode(mesh, "middle", 1.0, Potential::Given(0.0)),
        electrode(mesh, "outer", 2.0, DRIVEN),
    ];
    let nodes = mesh.nodes.clone();
    let places = at_rest(system(vec![solid]), &[0.5]);
    // The free end disturbs the bending over about one thickness: the section in the middle turns as in theory.
    let at = |z: f64| {
        let on = |x: &&Vector3<f64>| (*x - Vector3::new(0.5 * length, 0.0, z)).norm() < 1e-9;
        places[nodes.iter().position(|x| on(&x)).unwrap()]
    };
    let across = at(2.0) - at(0.0);
    across.x.atan2(across.z) / (0.5 * length)
}

#[test]
fn a_bilayer_bends() {
    let meshes = [(10, 1), (20, 2), (40, 4)];
    let of = |kind| meshes.map(|(along, layer)| curvature(kind, along, layer));
    let [pointwise, mean] = [ElementKind::Hex8, ElementKind::Hex8Q1P0].map(of);
    let order = ((mean[1] - mean[0]) / (mean[2] - mean[1])).log2();
    let limit = mean[2] + (mean[2] - mean[1]) / 3.0;
    println!("bilayer: Q1P0 {mean:?}, order {order}, limit {limit}; Hex8 {pointwise:?}");
    // Incompressible, with 30 digits. At λ = 1000 μ, extrapolated from 80 × 16 elements, 2e-5 of it remain.
    let exact = 0.055_624_802_5;
    for errors in mean.map(|k| (k - exact).abs()).windows(2) {
        assert!(errors[1] < 0.3 * errors[0]);
    }
    assert!((mean[2] / exact - 1.0).abs() < 6e-3);
    assert!((order - 2.0).abs() < 0.15, "{order}");
    assert!((limit / exact - 1.0).abs() < 2e-4, "{limit}");
    // The same meshes lock without one dilatation an element, and unlock slowly.
    assert!(pointwise.windows(2).all(|k| k[1] > 2.0 * k[0]));
    assert!(pointwise[0] > 0.0 && pointwise[2] < 0.25 * exact);
}

/// The default dielectric of relative permittivity 3.
pub(crate) fn silicone(lame_lambda: f64) -> Material {
    let electric = ElectricConstants {
        c1: -2.0 * VACUUM_PERMITTIVITY,
        c2: VACUUM_PERMITTIVITY,
        permittivity: VACUUM_PERMITTIVITY,
    };
    dielectric(0.1, lame_lambda, electric)
}

/// Displacement of the middle of the free face of a clamped stack of four layers, of which a quarter is modelled.
fn clamped_stack(element: ElementKind, side: usize) -> f64 {
    let size = Vector3::new(10.0, 10.0, 40.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, [side, side, 8 * side]).mesh();
    let mut solid = block(mesh, silicone(1e3));
    solid.element = element;
    let mesh = &solid.mesh;
    solid.supports = vec![
        held(mesh, "z_min", [true; 3]),
        held(mesh, "x_min", [true, false, false]),
        held(mesh, "y_min", [false, true, false]),
    ];
    solid.electrodes = (0..5)
        .map(|layer| {
            let potential = [Potential::Given(0.0), DRIVEN][layer % 2];
            electrode(mesh, &format!("e{layer}"), 10.0 * layer as f64, potential)
        })
        .collect();
    let centre = mesh
        .nodes
        .iter()
        .position(|x| *x == Vector3::new(0.0, 0.0, 40.0));
    let places = at_rest(system(vec![solid]), &[3e5]);
    places[centre.unwrap()].z - 40.0
}

#[test]
fn a_nearly_incompressible_stack_locks_without_one_dilatation_an_element() {
    let fine = clamped_stack(ElementKind::Hex8Q1P0, 4);
    println!("stack, 4 elements a side: {fine} mm");
    assert!(fine < -2.5);
    for side in [1, 2] {
        let [pointwise, mean] = [ElementKind::Hex8, ElementKind::Hex8Q1P0]
            .map(|kind| (clamped_stack(kind, side) / fine - 1.0).abs());
        println!("{side} a side: error {pointwise:.4} of Hex8, {mean:.4} of Q1P0");
        assert!(pointwise > 0.5, "{pointwise}");
        assert!(mean < 0.02 / side as f64, "{mean}");
    }
}
