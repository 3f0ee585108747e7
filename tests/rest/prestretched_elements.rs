//! Prestretched muscles of finite elements against a bar that is free of stress across, and against an elastic block.

use nalgebra::Vector3;
use proboscis::energy::ElasticLaw;
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{Electrode, Glue, Potential};
use proboscis::prelude::*;

/// Distance of the ends and sides at rest in mm.
const DISTANCE: f64 = 30.0;
const SIDES: [f64; 2] = [8.0, 6.0];
const LAYER: f64 = 0.05;
/// Shear modulus in MPa and Poisson ratio.
const MODULUS: f64 = 0.1;
const RATIO: f64 = 0.45;
/// Coefficients of Yeoh's law in MPa.
const YEOH: [f64; 2] = [-0.004, 0.002];

fn rubber(law: Option<ElasticLaw>) -> Material {
    Material {
        law,
        ..Material::elastomer(MODULUS)
    }
    .poisson_ratio(RATIO)
}

/// Limit of I₁ − 3 of Gent's law.
const GENT: f64 = 3.0;

/// Energy in MPa of stretches t, t, s: μ/2 (I₁ − 3) − μ ln J + λ/2 ln²J, or that of Yeoh's or Gent's law.
fn energy(law: Option<ElasticLaw>, ratio: f64, t: f64, s: f64) -> f64 {
    let lambda = 2.0 * MODULUS * ratio / (1.0 - 2.0 * ratio);
    let (first, volume) = (2.0 * t * t + s * s, t * t * s);
    let log = volume.ln();
    match law {
        None => 0.5 * MODULUS * (first - 3.0) - MODULUS * log + 0.5 * lambda * log * log,
        Some(law) => {
            let i = first * volume.powf(-2.0 / 3.0) - 3.0;
            let bulk = lambda + 2.0 / 3.0 * MODULUS;
            let isochoric = match law {
                ElasticLaw::Gent { .. } => -0.5 * MODULUS * GENT * (1.0 - i / GENT).ln(),
                _ => 0.5 * MODULUS * i + YEOH[0] * i * i + YEOH[1] * i * i * i,
            };
            isochoric + 0.5 * bulk * log * log
        }
    }
}

/// Central difference of the fourth order.
fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let h = 1e-3;
    (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h)
}

/// Stretch across without stress there, and the tension in N of the bar.
fn bar(law: Option<ElasticLaw>, ratio: f64, s: f64) -> (f64, f64) {
    let (mut low, mut high) = (0.3, 2.0);
    for _ in 0..100 {
        let t = 0.5 * (low + high);
        match slope(|t| energy(law, ratio, t, s), t) < 0.0 {
            true => low = t,
            false => high = t,
        }
    }
    let tension = slope(|s| energy(law, ratio, low, s), s) * SIDES[0] * SIDES[1];
    (low, tension)
}

fn muscle(material: &Material, stretch: f64) -> Muscle {
    let muscle = Muscle::of(material)
        .section(SIDES[0], SIDES[1])
        .layer(LAYER);
    muscle.prestretch(stretch).finite_elements([2, 1, 2])
}

/// A mass on a slide along an axis at the end of a muscle, and a load along it.
fn slider(
    muscle: Muscle,
    axis: Vector3<f64>,
) -> (System, Handle<Muscle>, Handle<Joint>, Handle<Load>) {
    let mut system = System::new("slider");
    let mass = system.add(Body::cuboid([mm(20.0); 3]).mass(g(50.0)));
    let slide = system.add(Joint::prismatic(axis).between(GROUND, mass));
    let muscle = muscle.from(GROUND, -axis * DISTANCE);
    let muscle = system.add(muscle.to(mass, Vector3::zeros()));
    let load = system.add(Load::force(mass, Vector3::zeros(), axis));
    (system, muscle, slide, load)
}

#[test]
fn the_tension_of_a_bar_keeps_its_prestretch() {
    let skew = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    let yeoh = ElasticLaw::Yeoh {
        c2: YEOH[0],
        c3: YEOH[1],
    };
    let gent = ElasticLaw::Gent { limit: GENT };
    for law in [None, Some(yeoh), Some(gent)] {
        for stretch in [0.8, 1.0, 1.3, 2.0] {
            let (_, tension) = bar(law, RATIO, stretch);
            assert_eq!(tension.abs() > 0.5, stretch != 1.0, "{tension} N");
            let (system, _, slide, load) = slider(muscle(&rubber(law), stretch), skew);
            let at = |force: f64| {
                let found = Equilibrium::new().load(load, force).find(&system);
                found.unwrap().joint(slide)[0]
            };
            let rest = at(tension);
            assert!(rest.abs() < 1e-8 * DISTANCE, "{rest} mm at {stretch}");
            assert!(at(tension + 0.1) > 0.01);
        }
    }
}

#[test]
fn nearly_incompressible_bars_pull_like_lumped_muscles() {
    let lumped = SIDES[0] * SIDES[1] * MODULUS * (1.5 - f64::powi(1.5, -2));
    let gap = |ratio: f64| {
        let material = Material::elastomer(MODULUS).poisson_ratio(ratio);
        let (system, _, slide, load) = slider(muscle(&material, 1.5), Vector3::x());
        let still = Equilibrium::new().load(load, lumped).find(&system);
        still.unwrap().joint(slide)[0].abs()
    };
    let [near, nearer] = [gap(0.49), gap(0.499)];
    assert!(near > 1e-3 && near / nearer > 8.0, "{near} {nearer}");
}

/// The muscle and an elastic block of the stretched shape with electrodes of the same field move their mass to the same place.
#[test]
fn a_muscle_is_a_block_of_its_stretched_shape() {
    let (stretch, volts, layers) = (1.4, 900.0, 2_usize);
    let material = rubber(None).ideal_dielectric(3.0);
    let (mut system, of_muscle, slide, load) = slider(muscle(&material, stretch), Vector3::z());
    let (across, tension) = bar(None, RATIO, stretch);
    let place = |system: &System, input: Input, volts: f64| {
        let still = Equilibrium::new().voltage(input, volts);
        let found = still.load(load, tension).find(system);
        found.unwrap().joint(slide)[0]
    };
    let of_muscle = place(&system, of_muscle.into(), volts);

    system.muscles.clear();
    let [a, b] = SIDES.map(|side| side * across);
    let corner = Vector3::new(-0.5 * a, -0.5 * b, -DISTANCE);
    let grid = Grid::uniform(corner, Vector3::new(a, b, DISTANCE), [1, 2, 2]);
    let mesh = grid.mesh();
    let electrode = |layer: usize| Electrode {
        circuit: None,
        name: format!("electrode{layer}"),
        nodes: mesh.nodes_on_plane(2, (layer as f64 / layers as f64 - 1.0) * DISTANCE, 1e-9),
        potential: match layer % 2 {
            1 => Potential::DRIVEN,
            _ => Potential::GROUNDED,
        },
    };
    let electrodes = (0..=layers).map(electrode).collect();
    let glue = |face: &str, body: Option<usize>| Glue {
        nodes: mesh.sets[face].clone(),
        body,
    };
    let glued = vec![glue("z_min", None), glue("z_max", Some(0))];
    let block = Solid {
        name: "block".to_owned(),
        electrodes,
        glued,
        ..Solid::on(mesh.clone(), &material).prestretch([across, across, stretch])
    };
    let block = system.add(block);
    let of_layer = volts * DISTANCE / stretch / layers as f64 / LAYER;
    let of_block = place(&system, (block, "electrode1").into(), of_layer);
    assert!(of_muscle < -0.1, "{of_muscle} mm");
    let apart = (of_muscle - of_block).abs();
    assert!(apart < 1e-9, "{apart} mm of {of_muscle}");
}
