//! Random blocks on boxes by multigrid and by factors: the same motion, the same rest, the same stability.
//!
//! `PROBOSCIS_BLOCKS` is the number of blocks (`make compare-solvers`).

use crate::common::random::Random;
use crate::common::solid::{DRIVEN, block, electrode, held, system};
use nalgebra::Vector3;
use proboscis::dynamics::{
    DiscreteTrajectory, Equilibrium, EquilibriumError, MultigridUse, Newton, Solving, Start,
    StepError, simulate_by, stable_equilibrium, stable_equilibrium_by,
};
use proboscis::energy::ElasticLaw;
use proboscis::mesh::grid::Grid;
use proboscis::model::Model;
use proboscis::model::components::{BlockLoad, Load, LoadPlace};
use proboscis::model::system::{
    ElectricConstants, ElementKind, Glue, Material, Potential, Solid, System, VACUUM_PERMITTIVITY,
};
use proboscis::sparse::Backend;
use std::ops::ControlFlow;

/// Difference of both solutions, relative to the length of the system and the voltage.
const APART: f64 = 1e-9;

/// A block with what acts on it.
struct Case {
    system: System,
    inputs: Vec<f64>,
}

fn chance(random: &mut Random, part: f64) -> bool {
    random.between(0.0, 1.0) < part
}

fn whole(random: &mut Random, least: usize, most: usize) -> usize {
    least + (random.between(0.0, (most - least + 1) as f64) as usize).min(most - least)
}

fn material(random: &mut Random, kind: ElementKind, is_viscous: bool) -> Material {
    let shear_modulus = 0.03 * 10_f64.powf(random.between(0.0, 1.2));
    let stiff = match kind {
        ElementKind::Hex8Q1P0 | ElementKind::Tet10P2P0 => random.between(5.0, 50.0),
        ElementKind::Hex8 | ElementKind::Tet10 | ElementKind::Membrane => random.between(1.0, 8.0),
    };
    let law = match whole(random, 0, 5) {
        0 => Some(ElasticLaw::Gent { limit: 60.0 }),
        1 => Some(ElasticLaw::MooneyRivlin { share: 0.2 }),
        2 => Some(ElasticLaw::Yeoh {
            c2: -0.01 * shear_modulus,
            c3: 0.001 * shear_modulus,
        }),
        _ => None,
    };
    let ideal = ElectricConstants {
        c1: 0.0,
        c2: 0.0,
        permittivity: 3.0 * VACUUM_PERMITTIVITY,
    };
    let aligned = ElectricConstants {
        c1: -2.0 * VACUUM_PERMITTIVITY,
        c2: VACUUM_PERMITTIVITY,
        permittivity: VACUUM_PERMITTIVITY,
    };
    Material {
        density: Some(1e-3),
        shear_modulus,
        law,
        lame_lambda: Some(stiff * shear_modulus),
        electric: Some(if chance(random, 0.5) { ideal } else { aligned }),
        viscosity: is_viscous.then(|| random.between(0.1, 2.0)),
        ..Material::default()
    }
}

/// A stack of layers, each with its own material, with electrodes between some; returns the thickness of the thinnest one between two of them.
fn stack(random: &mut Random, kind: ElementKind, is_viscous: bool) -> (Solid, f64) {
    let layers: Vec<(f64, usize)> = (0..whole(random, 1, 4))
        .map(|_| (random.between(0.7, 8.0), whole(random, 1, 3)))
        .collect();
    let mut across = || -> Vec<(f64, usize)> {
        (0..whole(random, 1, 2))
            .map(|_| (random.between(2.0, 8.0), whole(random, 1, 3)))
            .collect()
    };
    let [x, y] = [across(), across()];
    let height = |layers: &[(f64, usize)]| layers.iter().map(|layer| layer.0).sum::<f64>();
    let size = Vector3::new(height(&x), height(&y), height(&layers));
    let grid = Grid::layers(Vector3::zeros(), size, [x, y, layers.clone()]).unwrap();
    let mut mesh = grid.mesh();
    let tops: Vec<f64> = (1..=layers.len()).map(|n| height(&layers[..n])).collect();
    let middle = |of: &[usize; 8]| of.iter().map(|&n| mesh.nodes[n].z).sum::<f64>() / 8.0;
    let regions = mesh.hexahedra.iter().map(|of| {
        let at = middle(of);
        tops.iter().position(|top| at < *top).unwrap()
    });
    mesh.regions = regions.collect();
    mesh.region_names = (0..layers.len()).map(|n| format!("layer{n}")).collect();
    let mut solid = block(mesh, Material::default());
    solid.materials = layers
        .iter()
        .map(|_| material(random, kind, is_viscous))
        .collect();
    solid.element = kind;
    let mesh = &solid.mesh;
    let places: Vec<f64> = [&[0.0], &tops[..]].concat();
    let last = places.len() - 1;
    let kept: Vec<f64> = (places.iter().enumerate())
        .filter(|(n, _)| *n == 0 || *n == last || chance(random, 0.7))
        .map(|(_, place)| *place)
        .collect();
    let mut thinnest = f64::INFINITY;
    if chance(random, 0.85) {
        let gaps = kept.windows(2).map(|two| two[1] - two[0]);
        thinnest = gaps.fold(f64::INFINITY, f64::min);
        let electrodes = kept.iter().enumerate().map(|(n, &place)| {
            let potential = match n % 2 {
                0 => Potential::Given(0.0),
                _ => DRIVEN,
            };
            electrode(mesh, &format!("e{n}"), place, potential)
        });
        solid.electrodes = electrodes.collect();
    }
    solid.supports = match chance(random, 0.6) {
        true => vec![held(mesh, "z_min", [true; 3])],
        false => vec![
            held(mesh, "x_min", [true, false, false]),
            held(mesh, "y_min", [false, true, false]),
            held(mesh, "z_min", [false, false, true]),
        ],
    };
    if chance(random, 0.2) {
        let nodes = mesh.sets["z_max"].clone();
        solid.glued = vec![Glue { nodes, body: None }];
    }
    (solid, thinnest)
}

fn case(random: &mut Random, is_viscous: bool) -> Case {
    let kind = match chance(random, 0.3) {
        true => ElementKind::Hex8Q1P0,
        false => ElementKind::Hex8,
    };
    let (first, mut thinnest) = stack(random, kind, is_viscous);
    let faces = first.mesh.faces_of(&first.mesh.sets["x_max"]);
    let mut solids = vec![first];
    if chance(random, 0.2) {
        let (mut second, other) = stack(random, kind, is_viscous);
        second.name = "second".into();
        second.mesh = second
            .mesh
            .transformed(|x| x + Vector3::new(40.0, 0.0, 0.0));
        thinnest = thinnest.min(other);
        solids.push(second);
    }
    let softest = solids.iter().flat_map(|solid| &solid.materials);
    let softest = softest.fold(f64::INFINITY, |m, of| m.min(of.shear_modulus));
    let field = random.between(0.1, 0.5) * (softest / (3.0 * VACUUM_PERMITTIVITY)).sqrt();
    let mut inputs = Vec::new();
    if thinnest.is_finite() {
        inputs.push(field * thinnest);
    }
    let mut system = system(solids);
    if chance(random, 0.5) {
        system.gravity = Some(9.81e-3 * random.vector());
    }
    if chance(random, 0.5) || inputs.is_empty() {
        let load = match chance(random, 0.6) {
            true => BlockLoad::Pressure {
                faces,
                follows: chance(random, 0.5),
            },
            false => BlockLoad::Traction(faces, random.vector().normalize()),
        };
        system.components.loads = vec![Load {
            name: "load".into(),
            on: LoadPlace::Block { block: 0, load },
        }];
        inputs.push(0.1 * softest * random.between(-1.0, 1.0));
    }
    Case { system, inputs }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let parts = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    parts.fold(0.0, f64::max)
}

/// Counts of what was compared.
#[derive(Debug, Default)]
struct Counts {
    motions: usize,
    /// Those that moved by more than 1e-5 of the length.
    moved: usize,
    rests: usize,
    unstable: usize,
    without_rest: usize,
    fallbacks: usize,
    /// Motions in which one of both halves a step that the other one takes.
    halved: usize,
    /// Verdicts without factors, and those that the lowest mode leaves open.
    by_mode: usize,
    undecided: usize,
    /// Greatest differences of places from those by factors in each iteration: by multigrid with a new tangent in each, with one that is kept,
    /// at rest, and by factors that are kept.
    greatest: [f64; 4],
}

impl Counts {
    fn motion(&mut self, case: &Case, (h, steps): (f64, usize)) {
        let model = Model::new(case.system.clone(), None, h, &[]).unwrap();
        let start = Start::at_rest(&model, model.coordinates_at(&[]));
        let scalars = model.scalars(&case.inputs);
        let motion = |solving: Solving| -> (DiscreteTrajectory, Option<StepError>) {
            let drive = |_: f64, _: f64| scalars.clone();
            let observer = |_: &_| ControlFlow::Continue(());
            simulate_by(solving, &model, &start, h, steps, drive, observer)
        };
        let by = |newton, backend, multigrid| {
            let (discrete, failure) = motion(Solving {
                newton,
                backend,
                multigrid,
                ..Solving::default()
            });
            assert_eq!(failure, None);
            discrete
        };
        let factors = Some(Backend::Faer);
        let direct = by(Newton::Full, factors, MultigridUse::WhereFaster);
        self.motions += 1;
        let last = direct.z.len() - 1;
        self.moved += usize::from(apart(&direct.z[last], &direct.z[0]) > 1e-5 * model.length());
        for (kind, newton, tolerance) in [(0, Newton::Full, APART), (1, Newton::Modified, APART)] {
            let iterated = by(newton, None, MultigridUse::Always);
            assert!(iterated.report.multigrid.iterations > 0);
            self.fallbacks += usize::from(iterated.report.fallbacks > 0);
            if direct.report.halved != iterated.report.halved {
                // Potentials come to Gauss's law first on grids: a step may converge that factors halve.
                println!(
                    "  halved {} and {} times",
                    direct.report.halved, iterated.report.halved
                );
                self.halved += 1;
                continue;
            }
            for (a, b) in direct.z.iter().zip(&iterated.z) {
                let error = apart(a, b) / model.length();
                self.greatest[kind] = self.greatest[kind].max(error);
                assert!(error < tolerance, "{error:e}, {:?}", iterated.report);
            }
            let largest = case.inputs[0].abs().max(1.0);
            for (a, b) in direct.scalars.iter().zip(&iterated.scalars) {
                assert!(apart(a, b) < tolerance * largest, "{:e}", apart(a, b));
            }
        }
        let modified = by(Newton::Modified, None, MultigridUse::WhereFaster);
        if modified.report.halved == direct.report.halved {
            for (a, b) in direct.z.iter().zip(&modified.z) {
                self.greatest[3] = self.greatest[3].max(apart(a, b) / model.length());
            }
        }
    }

    fn rest(&mut self, case: &Case) {
        let model = Model::new(case.system.clone(), None, 1.0, &[]).unwrap();
        let scalars = model.scalars(&case.inputs);
        let start = model.reference_coordinates();
        let direct = stable_equilibrium(&model, &start, &scalars);
        let by = |multigrid| stable_equilibrium_by(&model, &start, &scalars, multigrid);
        let mut iterated = by(MultigridUse::Alone);
        self.rests += 1;
        let Ok(direct) = direct else {
            // Without factors the limit is not located.
            self.without_rest += 1;
            assert!(iterated.is_err(), "{:?}", iterated.unwrap().unstable);
            return;
        };
        let is_iterated = |found: &Result<Equilibrium, EquilibriumError>| {
            let found = found.as_ref().ok();
            found.is_some_and(|found| apart(&direct.z, &found.z) < 1e-3 * model.length())
        };
        let is_alone = is_iterated(&iterated);
        if !is_alone {
            self.fallbacks += 1;
            iterated = by(MultigridUse::Always);
        }
        let iterated = iterated.unwrap();
        assert_eq!(
            iterated.lowest.is_none(),
            iterated.softest.is_none() || !is_alone
        );
        self.by_mode += usize::from(iterated.lowest.is_some());
        self.moved += usize::from(apart(&direct.z, &start) > 1e-5 * model.length());
        let error = apart(&direct.z, &iterated.z) / model.length();
        self.greatest[2] = self.greatest[2].max(error);
        assert!(error < APART, "{error:e}");
        let largest = case.inputs[0].abs().max(1.0);
        let potentials = apart(&direct.scalars, &iterated.scalars);
        assert!(potentials < APART * largest, "{potentials:e}");
        match (iterated.is_stable(), direct.is_stable()) {
            (None, _) => self.undecided += 1,
            (found, expected) => {
                assert_eq!(found, expected, "{:?}", iterated.lowest);
                self.unstable += usize::from(found == Some(false));
            }
        }
    }
}

#[test]
fn random_blocks_are_those_of_the_direct_solver() {
    let asked = std::env::var("PROBOSCIS_BLOCKS").ok();
    let blocks = asked.map_or(12, |count| count.parse().unwrap());
    let mut counts = Counts::default();
    for number in 0..blocks {
        let random = &mut Random(1000 + number);
        let case = case(random, number % 4 > 1);
        println!("block {number}");
        match number % 2 {
            0 => counts.rest(&case),
            _ => {
                let step = (random.between(0.2, 2.0), whole(random, 1, 4));
                counts.motion(&case, step);
            }
        }
    }
    println!("{counts:?}");
    assert!(20 * counts.halved <= counts.motions, "{counts:?}");
    let found = counts.rests - counts.without_rest;
    assert!(2 * counts.moved > blocks as usize, "{counts:?}");
    assert!(3 * found > counts.rests && 4 * counts.fallbacks < blocks as usize);
    assert!(counts.by_mode > counts.undecided, "{counts:?}");
    assert!(8 * counts.undecided <= counts.rests, "{counts:?}");
}
