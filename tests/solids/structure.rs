//! A block costs what it holds: coordinates of its free nodes, potentials where a field is, and nothing else.

use crate::common::cases::{control, open_end};
use crate::common::random::Random;
use crate::common::solid::{DRIVEN, block, electrode, held, system};
use crate::common::systems::{GRAVITY, blocks};
use nalgebra::Vector3;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::functional::{Order, Sample, TermKind};
use proboscis::mesh::grid::Grid;
use proboscis::model::system::{Electrode, Fidelity, Material, Potential, Solid, System};
use proboscis::model::{Coordinates, Model, Role, Time};
use proboscis::nlp::Nlp;
use std::collections::BTreeSet;

fn rubber() -> Material {
    let material = blocks().muscles[0].material;
    assert!(material.density.is_some() && material.viscosity.is_some());
    assert!(material.electric.is_some() && material.lame_lambda.is_some());
    material
}

/// A clamped block with a roller above, without electrodes.
fn plain(elements: [usize; 3]) -> Solid {
    let size = Vector3::new(10.0, 12.0, 20.0);
    let mesh = Grid::uniform(Vector3::zeros(), size, elements).mesh();
    let mut solid = block(mesh, rubber());
    let mut roller = held(&solid.mesh, "z_max", [true, false, false]);
    roller.nodes.truncate(2);
    solid.supports = vec![held(&solid.mesh, "z_min", [true; 3]), roller];
    solid
}

/// The same between a grounded and a driven face.
fn driven(elements: [usize; 3]) -> Solid {
    let mut solid = plain(elements);
    let mesh = &solid.mesh;
    solid.electrodes = vec![
        electrode(mesh, "bottom", 0.0, Potential::Given(0.0)),
        electrode(mesh, "top", 20.0, DRIVEN),
    ];
    solid
}

fn model(solid: Solid) -> Model {
    Model::new(system(vec![solid]), None, 1.0, &[]).unwrap()
}

/// Axes in which each node is free.
fn free(solid: &Solid) -> Vec<Vec<usize>> {
    let is_held = |node: usize, axis: usize| {
        let mut supports = solid.supports.iter();
        supports.any(|s| s.held[axis] && s.nodes.contains(&node))
    };
    let axes = |node| (0..3).filter(|&axis| !is_held(node, axis)).collect();
    (0..solid.mesh.nodes.len()).map(axes).collect()
}

/// Sizes of a program.
#[derive(Debug, PartialEq)]
struct Counts {
    variables: usize,
    rows: usize,
    jacobian: usize,
    hessian: usize,
}

fn counts(system: &System, intervals: usize) -> Counts {
    let mut control = control(system, intervals);
    control.goal = open_end();
    let (model, boundary) = BoundaryConditions::resolve(system, &control, 10.0).unwrap();
    let initial = guess(&model, &boundary, &control, 10.0, None);
    let program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    Counts {
        variables: program.start(&initial).x.len(),
        rows: program.constraints().lower.len(),
        jacobian: program.jacobian_structure().rows.len(),
        hessian: program.hessian_structure().rows.len(),
    }
}

/// Counted element by element: what meets in an element has a place. The voltage is one more potential, that of the nodes
/// on the driven face.
fn counted(solid: &Solid, intervals: usize) -> Counts {
    let free = free(solid);
    let potential = |node: usize| -> Option<usize> {
        let on = |e: usize| solid.electrodes[e].nodes.contains(&node);
        match solid.electrodes.len() {
            0 => None,
            _ if on(0) => None,
            _ if on(1) => Some(usize::MAX),
            _ => Some(node),
        }
    };
    let (mut places, mut mixed, mut scalars) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    for nodes in &solid.mesh.hexahedra {
        for &a in nodes {
            for &b in nodes {
                let of_b = || free[b].iter().map(move |&axis| (b, axis));
                let of_a = free[a].iter().map(move |&axis| (a, axis));
                places.extend(of_a.flat_map(|a| of_b().map(move |b| (a, b))));
                if let Some(a) = potential(a) {
                    mixed.extend(of_b().map(|b| (a, b)));
                    scalars.extend(potential(b).map(|b| (a, b)));
                }
            }
        }
    }
    let n: usize = free.iter().map(Vec::len).sum();
    let distinct: BTreeSet<usize> = scalars.iter().map(|&(a, _)| a).collect();
    let potentials = distinct.iter().filter(|&&p| p != usize::MAX).count();
    let of_potentials = |p: &usize| *p != usize::MAX;
    let mixed_rows = mixed.iter().filter(|(p, _)| of_potentials(p)).count();
    let scalar_rows = scalars.iter().filter(|(p, _)| of_potentials(p)).count();
    Counts {
        variables: intervals * (n + distinct.len()),
        rows: intervals * (n + potentials),
        // Rows k with z_{k−1}, z_k, z_{k+1} and the scalars of both intervals; Gauss's law with both ends and all scalars.
        // z₀ is given.
        jacobian: (3 * intervals - 3) * places.len()
            + (2 * intervals - 1) * (mixed.len() + mixed_rows)
            + intervals * scalar_rows,
        // Lower triangles of equal instants and of scalars, all of neighbours and of scalars with both ends.
        hessian: intervals * (places.len() + n) / 2
            + (intervals - 1) * places.len()
            + (2 * intervals - 1) * mixed.len()
            + intervals * (scalars.len() + distinct.len()) / 2,
    }
}

#[test]
fn programs_of_blocks_have_their_closed_form() {
    for elements in [[1, 1, 2], [2, 1, 3], [2, 2, 2]] {
        for solid in [plain(elements), driven(elements)] {
            for intervals in [2, 5] {
                let expected = counted(&solid, intervals);
                assert!(expected.rows > 40 && expected.jacobian > 1000);
                // Weight couples nothing, but a block that nothing moves is not solved for.
                let mut heavy = system(vec![solid.clone()]);
                heavy.gravity = Some(GRAVITY);
                assert_eq!(counts(&heavy, intervals), expected);
                if solid.electrodes.is_empty() {
                    let none = counts(&system(vec![solid.clone()]), intervals);
                    assert_eq!([none.variables, none.rows, none.jacobian], [0; 3]);
                }
            }
        }
    }
    // Written out once: eight free nodes of which two are on rollers, all in one element of two.
    let mut heavy = system(vec![plain([1, 1, 2])]);
    heavy.gravity = Some(GRAVITY);
    let (n, found) = (3 * 8 - 2, counts(&heavy, 2));
    assert_eq!(
        (found.variables, found.rows, found.jacobian),
        (2 * n, 2 * n, 3 * n * n)
    );
}

#[test]
fn a_block_without_electrodes_has_no_potential() {
    let solid = plain([2, 2, 3]);
    let expected: usize = free(&solid).iter().map(Vec::len).sum();
    let found = model(solid);
    // 36 nodes, 9 of them clamped, 2 on rollers.
    assert_eq!(expected, 3 * 27 - 2);
    assert_eq!(found.coordinate_count(), expected);
    assert_eq!(found.variables.of(Time::Interval), []);
    assert_eq!(found.action.intervals.scalars, 0);
}

#[test]
fn inner_nodes_of_dielectric_elements_have_a_potential() {
    let elements = [2, 2, 4];
    let with = |change: &dyn Fn(&mut Solid)| {
        let mut solid = driven(elements);
        change(&mut solid);
        let model = model(solid);
        [Role::Potential, Role::Voltage].map(|role| model.variables.count(role))
    };
    // Three planes of nine nodes between both faces.
    assert_eq!(with(&|_| {}), [27, 1]);
    // An electrode takes the potentials of its nodes away; floating ones keep one.
    let middle = |potential| {
        move |s: &mut Solid| {
            let middle = electrode(&s.mesh, "middle", 10.0, potential);
            s.electrodes.push(middle);
        }
    };
    // Between two of one voltage there is no field.
    assert_eq!(with(&middle(Potential::Given(0.0))), [9, 1]);
    assert_eq!(with(&middle(Potential::Given(30.0))), [18, 1]);
    assert_eq!(with(&middle(DRIVEN)), [9, 1]);
    assert_eq!(with(&middle(Potential::Floating)), [19, 1]);
    // A passive half below an electrode in the middle: its nodes have none, and the field ends at the electrode.
    let passive = |s: &mut Solid| {
        s.mesh.regions = (0..16).map(|e| usize::from(e < 8)).collect();
        s.mesh.region_names.push("passive".into());
        let electric = None;
        s.materials.push(Material {
            electric,
            ..s.materials[0]
        });
    };
    assert_eq!(
        with(&|s| {
            passive(s);
            middle(Potential::Given(0.0))(s);
        }),
        [9, 1]
    );
    // Without it the nodes in the middle are on the boundary of the field, and no electrode grounds the dielectric.
    assert_eq!(with(&passive), [0, 0]);
    // Nor is there a field where all electrodes have one potential.
    assert_eq!(
        with(&|s| s.electrodes[1].potential = Potential::Given(0.0)),
        [0, 0]
    );
    assert_eq!(with(&|s| s.electrodes.truncate(1)), [0, 0]);
    // An electrode of no dielectric element drives nothing.
    let beside = |s: &mut Solid| {
        passive(s);
        middle(Potential::Given(0.0))(s);
        let nodes = s.mesh.nodes_on_plane(2, 5.0, 1e-9);
        s.electrodes.push(Electrode {
            circuit: None,
            name: "idle".into(),
            nodes,
            potential: Potential::Driven {
                source: 1,
                factor: 1.0,
            },
        });
    };
    assert_eq!(with(&beside), [9, 1]);
}

/// Kinds of the effects of a model.
fn kinds(solid: Solid) -> Vec<TermKind> {
    let model = model(solid);
    model
        .action
        .intervals
        .terms
        .iter()
        .map(|e| e.kind())
        .collect()
}

#[test]
fn what_a_material_lacks_is_no_effect() {
    let all = kinds(driven([1, 1, 2]));
    let count = |kinds: &[TermKind], kind| kinds.iter().filter(|&&k| k == kind).count();
    for kind in [
        TermKind::Kinetic,
        TermKind::Potential,
        TermKind::Dissipation,
    ] {
        assert_eq!(count(&all, kind), 1);
    }
    let with = |change: &dyn Fn(&mut Material)| {
        let mut solid = driven([1, 1, 2]);
        change(&mut solid.materials[0]);
        kinds(solid)
    };
    assert_eq!(count(&with(&|m| m.density = None), TermKind::Kinetic), 0);
    assert_eq!(
        count(&with(&|m| m.viscosity = None), TermKind::Dissipation),
        0
    );
    let bare = with(&|m| (m.density, m.viscosity) = (None, None));
    assert_eq!(bare, vec![TermKind::Potential]);
    // Nothing remains of a mass: any rates have no momentum.
    let momenta = |density| {
        let mut solid = plain([1, 1, 2]);
        solid.materials[0].density = density;
        let model = model(solid);
        let mut instant = crate::common::placed(&model, &model.coordinates_at(&[]));
        model
            .action
            .momentum(&mut instant, &vec![1.0; model.coordinate_count()])
    };
    assert!(momenta(Some(1e-3)).iter().all(|&p| p > 0.0));
    assert!(momenta(None).iter().all(|&p| p == 0.0));
}

/// Rows of both ends, Gauss's law and second derivatives of an interval at a point near the reference, by row and column;
/// of the first `n` coordinates.
fn numbers(model: &Model, n: usize) -> Vec<(usize, usize, f64)> {
    let mut random = Random(11);
    let rest = model.coordinates_at(&vec![0.0; model.joint_readings.len()]);
    let noise: Vec<f64> = (0..2 * n).map(|_| 0.02 * random.unit()).collect();
    let [mut a, mut b] = [0, 1].map(|side| {
        let mut z = rest.clone();
        let noise = &noise[side * n..][..n];
        z.iter_mut().zip(noise).for_each(|(z, noise)| *z += noise);
        crate::common::placed(model, &z)
    });
    let scalars: Vec<f64> = (0..model.action.intervals.scalars)
        .map(|s| 100.0 + s as f64)
        .collect();
    let interval = Sample::of_interval(&scalars, 2.0);
    let (action, layout) = (&model.action, model.action.layout());
    let mut scratch = action.scratch(Order::Hessian);
    let mut values = vec![0.0; layout.values(1)];
    action.evaluate_interval(Order::Hessian, [&mut a, &mut b], &interval, &mut scratch);
    action.pull_back_interval(
        Order::Hessian,
        [&a, &b],
        &interval,
        0,
        &mut scratch,
        &mut values,
    );
    let mut out = Vec::new();
    for (side, instant) in [&a, &b].into_iter().enumerate() {
        let mut rows = vec![0.0; model.coordinate_count()];
        action
            .map
            .pull_back(&instant.columns, &instant.forces, &mut rows);
        out.extend(rows[..n].iter().enumerate().map(|(i, &row)| (i, side, row)));
        for (slot, (i, s)) in layout.mixed.entries().enumerate() {
            out.push((i, s, values[layout.mixed_at(0, side) + slot]));
        }
        for (slot, (i, j)) in layout.same.entries().enumerate() {
            out.push((i, j, values[layout.same_at(side) + slot]));
        }
    }
    for (slot, (i, j)) in layout.cross.entries().enumerate() {
        out.push((i, j, values[layout.upper_at(0) + slot]));
    }
    out.extend(
        scratch
            .interval
            .plain
            .rows
            .iter()
            .enumerate()
            .map(|(s, &row)| (s, s, row)),
    );
    // The slots of far coordinates lie among the others.
    out.retain(|&(i, j, _)| i < n && j < n);
    out
}

#[test]
fn a_block_far_away_changes_no_bit() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut near = blocks();
        near.muscles[0].fidelity = Fidelity::Lumped;
        let mut far = near.clone();
        let mut solid = plain([2, 1, 2]);
        solid.mesh = solid.mesh.transformed(|x| x + Vector3::new(1e4, 0.0, 0.0));
        far.solids.push(solid);
        let [near, far] =
            [near, far].map(|system| Model::new(system, Some(coordinates), 2.0, &[]).unwrap());
        let n = near.coordinate_count();
        assert!(far.coordinate_count() > n && near.variables.count(Role::Potential) > 0);
        let [mut near, mut far] = [near, far].map(|model| numbers(&model, n));
        assert!(near.iter().filter(|v| v.2.abs() > 1e-3).count() > 500);
        // Places are in the order of the list of entries, which the far block may shift: compare them sorted.
        for list in [&mut near, &mut far] {
            list.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        }
        assert_eq!(near.len(), far.len());
        for (a, b) in near.iter().zip(&far) {
            assert_eq!(
                (a.0, a.1, a.2.to_bits()),
                (b.0, b.1, b.2.to_bits()),
                "{a:?} {b:?}"
            );
        }
    }
}
