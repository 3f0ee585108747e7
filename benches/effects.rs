//! Costs of each effect: unknowns, entries and time per step, changes of the answer, and costs of its absence.
//!
//! `cargo bench --bench effects` prints the tables; `-- --write` puts them into `results/gallery/effects.md`. All variants of a scene
//! are timed in turn, so that numbers of one run can be compared with each other.

mod shared;
mod trunk;

use nalgebra::Vector3;
use proboscis::control::problem::{BoundaryState, Simulation, Voltages};
use proboscis::control::resolve_start;
use proboscis::coordinates::Reduced;
use proboscis::dynamics::{Solving, Start, Stepper};
use proboscis::energy::DielectricCell;
use proboscis::functional::{Element, Functional, Group, Inertia, Mass, Stencil, Term, VectorArg};
use proboscis::kinematics::MaterialVector;
use proboscis::model::system::{
    Body, Discretisation, ElementKind, Fidelity, JointKind, Material, System,
};
use proboscis::model::{Coordinates, Model};
use proboscis::sparse::Symmetry;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

/// Rounds in which every variant is timed once.
const ROUNDS: usize = 41;
/// Steps of a motion of the trunk, of 10 ms each.
const STEPS: usize = 60;
/// Steps of a motion of the block, of 0.5 ms each.
const BLOCK_STEPS: usize = 12;
/// Voltage of the block over layers of 10 mm.
const VOLTAGE: f64 = 2e5;

/// A motion that is timed.
struct Variant {
    name: String,
    model: Model,
    start: Start,
    scalars: Vec<f64>,
    step: f64,
    steps: usize,
    seconds: Vec<f64>,
    /// Newton iterations a step.
    iterations: f64,
    tip: Vector3<f64>,
}

impl Variant {
    fn new(name: &str, model: Model, voltages: &[f64], [step, steps]: [f64; 2]) -> Self {
        let start = BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: Default::default(),
        };
        let start = resolve_start(&model, &start).expect("the reference configuration");
        Self {
            name: name.to_owned(),
            scalars: model.scalars(voltages),
            model,
            start,
            step,
            steps: steps as usize,
            seconds: Vec::new(),
            iterations: f64::NAN,
            tip: Vector3::zeros(),
        }
    }

    /// Times one motion.
    fn run(&mut self) {
        let Start { z, momentum, .. } = &self.start;
        let mut stepper = Stepper::new(&self.model, z, momentum, Solving::default());
        let began = Instant::now();
        for _ in 0..self.steps {
            black_box(
                stepper
                    .step(self.step, &self.scalars)
                    .expect("the system moves on"),
            );
        }
        self.seconds
            .push(began.elapsed().as_secs_f64() / self.steps as f64);
        self.iterations = stepper.report().iterations as f64 / self.steps as f64;
        self.tip = stepper.instant().x[self.model.markers[0]];
    }

    /// Median time of a step in µs, with the quartiles.
    fn time(&self) -> [f64; 3] {
        let mut sorted = self.seconds.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |part: usize| 1e6 * sorted[part * (sorted.len() - 1) / 4];
        [at(1), at(2), at(3)]
    }

    /// Unknowns of a step, and entries of its tangent.
    fn sizes(&self) -> [usize; 2] {
        let model = &self.model;
        let (map, layout) = (&model.action.map, model.action.layout());
        let (n, algebraic) = (map.coordinates, model.variables.algebraic());
        let crossed = |&(i, j): &(usize, usize)| (i < n) != (j < n);
        let of_potential = |&(_, s): &(usize, usize)| algebraic.contains(&s);
        let both = |&(s, t): &(usize, usize)| [s, t].iter().all(|s| algebraic.contains(s));
        let scalars = layout.scalars.entries().filter(both);
        let entries = layout.cross.entries().len()
            + layout.same.entries().filter(crossed).count()
            + 2 * layout.mixed.entries().filter(of_potential).count()
            + scalars
                .map(|(s, t)| if s == t { 1 } else { 2 })
                .sum::<usize>();
        [model.variables.unknown_count(), entries]
    }
}

/// Times variants in turn.
fn race(variants: &mut [Variant]) {
    for _ in 0..ROUNDS {
        variants.iter_mut().for_each(Variant::run);
    }
}

/// An effect: the motion with it and the motion without.
struct Pair {
    effect: &'static str,
    scene: &'static str,
    with: Variant,
    without: Variant,
}

fn simulation(voltages: &[f64], coordinates: Coordinates) -> Simulation {
    Simulation {
        duration: 600.0,
        step: trunk::STEP,
        tolerance: None,
        start: BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: Default::default(),
        },
        voltages: Voltages::constant(voltages),
        coordinates: Some(coordinates),
        solving: Solving::default(),
        controller: None,
    }
}

/// A motion of the trunk, of which only what scene and voltages call for is built.
fn called(name: &str, system: System, voltages: &[f64], coordinates: Coordinates) -> Variant {
    let analysis = simulation(voltages, coordinates).analysis(&system, trunk::STEP);
    let model = Model::for_analysis(system, analysis).expect("the model exists");
    Variant::new(name, model, voltages, [trunk::STEP, STEPS as f64])
}

/// The same, with everything that could be asked for.
fn whole(name: &str, system: System, voltages: &[f64], coordinates: Coordinates) -> Variant {
    let model = Model::new(system, Some(coordinates), trunk::STEP, &[]).expect("the model exists");
    Variant::new(name, model, voltages, [trunk::STEP, STEPS as f64])
}

/// The trunk beside a second one without voltage.
fn beside(system: &System) -> System {
    let mut both = system.clone();
    let (count, far) = (system.bodies.len(), Vector3::new(500.0, 0.0, 0.0));
    let name = |name: &str| format!("{name} beside");
    both.bodies.extend(system.bodies.iter().map(|b| Body {
        name: name(&b.name),
        centre: b.centre + far,
        ..b.clone()
    }));
    for joint in &system.joints {
        let mut joint = joint.clone();
        joint.name = name(&joint.name);
        joint.at += far;
        joint.parent = joint.parent.map(|b| b + count);
        joint.child += count;
        both.joints.push(joint);
    }
    for muscle in &system.muscles {
        let mut muscle = muscle.clone();
        muscle.name = name(&muscle.name);
        for end in [&mut muscle.from, &mut muscle.to] {
            end.at += far;
            end.body = end.body.map(|b| b + count);
        }
        both.muscles.push(muscle);
    }
    both
}

/// Pairs of the trunk.
fn pairs_of_trunk(system: &System, volts: &[f64]) -> Vec<Pair> {
    use Coordinates::{Reduced, Redundant};
    let changed = |change: &dyn Fn(&mut System)| {
        let mut system = system.clone();
        change(&mut system);
        system
    };
    let without = |change: &dyn Fn(&mut System)| called("without", changed(change), volts, Reduced);
    let with = |change: &dyn Fn(&mut System)| called("with", changed(change), volts, Reduced);
    let pair = |effect, scene, with, without| Pair {
        effect,
        scene,
        with,
        without,
    };
    let plain = |_: &mut System| {};
    let materials = |change: fn(&mut Material)| {
        move |s: &mut System| s.muscles.iter_mut().for_each(|m| change(&mut m.material))
    };
    let none = vec![0.0; volts.len()];
    let mut rows = vec![
        pair(
            "muscle inertia",
            "trunk",
            with(&plain),
            without(&materials(|m| m.density = None)),
        ),
        pair(
            "section inertia",
            "trunk",
            with(&|s| s.muscles.iter_mut().for_each(|m| m.section_inertia = true)),
            without(&plain),
        ),
        pair(
            "gravity",
            "trunk",
            with(&|s| s.gravity = Some(Vector3::new(2e-3, -9.61e-3, 0.0))),
            without(&plain),
        ),
        pair(
            "muscle viscosity",
            "trunk",
            with(&plain),
            without(&materials(|m| m.viscosity = None)),
        ),
        pair(
            "joint damping",
            "trunk",
            with(&|s| s.joints.iter_mut().for_each(|j| j.damping = Some(300.0))),
            without(&plain),
        ),
        pair(
            "electric terms of muscles without voltage",
            "trunk, 6 of 12 voltages",
            whole("with", system.clone(), volts, Reduced),
            without(&plain),
        ),
        pair(
            "muscle electroelasticity",
            "trunk under weight",
            with(&|s| s.gravity = Some(Vector3::new(2e-3, -9.61e-3, 0.0))),
            called(
                "without",
                changed(&|s| s.gravity = Some(Vector3::new(2e-3, -9.61e-3, 0.0))),
                &none,
                Reduced,
            ),
        ),
        pair(
            "joint that is not locked",
            "trunk",
            with(&plain),
            without(&|s| s.joints[5].kind = JointKind::Fixed),
        ),
        pair(
            "rigid bodies and joints as constraints",
            "trunk, redundant and reduced",
            called("with", system.clone(), volts, Redundant),
            without(&plain),
        ),
    ];
    rows.push(pair(
        "body of its own where a joint is locked",
        "trunk, redundant",
        called("with", system.clone(), volts, Redundant),
        called(
            "without",
            changed(&|s| s.joints[5].kind = JointKind::Fixed),
            volts,
            Redundant,
        ),
    ));
    let mut row = volts.to_vec();
    row.resize(2 * volts.len(), 0.0);
    rows.push(pair(
        "second trunk that nothing moves",
        "trunk beside",
        whole("with", beside(system), &row, Reduced),
        called("without", beside(system), &row, Reduced),
    ));
    let elements = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 4],
        layers: 4,
        element: ElementKind::Hex8,
    });
    let softer = |s: &mut System| {
        for muscle in &mut s.muscles {
            muscle.material.lame_lambda = Some(0.4);
        }
    };
    rows.push(pair(
        "finite elements of one muscle",
        "trunk",
        with(&|s| {
            softer(s);
            s.muscles[1].fidelity = elements;
        }),
        without(&softer),
    ));
    rows
}

/// A clamped block of 2 × 2 × 8 elements in four layers under gravity, with a marker at a corner of its free end.
fn block(driven: bool, change: impl Fn(&mut Material)) -> System {
    let mut system = shared::block(2, Some(1.0));
    let solid = &mut system.solids[0];
    change(&mut solid.materials[0]);
    if !driven {
        solid.electrodes.clear();
    }
    system.markers.push(proboscis::model::system::Marker {
        name: "tip".into(),
        point: proboscis::model::system::Attachment {
            body: None,
            at: Vector3::new(10.0, 10.0, 40.0),
        },
        solid: Some(0),
    });
    system.gravity = Some(Vector3::new(2e-3, -9.61e-3, 0.0));
    system
}

/// Pairs of the block.
fn pairs_of_block() -> Vec<Pair> {
    let variant = |name: &str, system: System, voltage: &[f64]| {
        let model = Model::new(system, None, 0.5, &[]).expect("the model exists");
        Variant::new(name, model, voltage, [0.5, BLOCK_STEPS as f64])
    };
    let full = || variant("with", block(true, |_| {}), &[VOLTAGE]);
    let pair = |effect, without| Pair {
        effect,
        scene: "block of 32 elements",
        with: full(),
        without,
    };
    vec![
        pair(
            "block viscosity",
            variant("without", block(true, |m| m.viscosity = None), &[VOLTAGE]),
        ),
        pair(
            "block electroelasticity",
            variant("without", block(false, |_| {}), &[]),
        ),
        pair(
            "block inertia",
            variant("without", block(true, |m| m.density = None), &[VOLTAGE]),
        ),
    ]
}

/// The effects of the trunk without viscosity written out by hand, in place of those that its scene called for.
fn by_hand(system: &System, volts: &[f64]) -> Variant {
    let mut variant = called("by hand", system.clone(), volts, Coordinates::Reduced);
    let model = &mut variant.model;
    let reference = model.reference.to_vec();
    let list = model.vectors.clone();
    let at = |vector: MaterialVector| {
        let found = list.iter().position(|v| *v == vector);
        found.expect("the scene has this vector")
    };
    let mut bodies = Vec::new();
    for (b, body) in system.bodies.iter().enumerate() {
        let centre = MaterialVector::point(Some(b), &body.centre, &reference);
        bodies.push(Mass::point(at(centre), body.mass));
        let [j1, j2, j3] = body.inertia;
        let euler = [j2 + j3 - j1, j3 + j1 - j2, j1 + j2 - j3];
        for (i, euler) in euler.into_iter().enumerate() {
            let axis = body.directors.column(i).into();
            let director = MaterialVector::direction(Some(b), &axis, &reference);
            bodies.push(Mass::point(at(director), 0.5 * euler));
        }
    }
    let (mut rods, mut cells) = (Vec::new(), Vec::new());
    for (m, muscle) in system.muscles.iter().enumerate() {
        let [from, to] =
            [&muscle.from, &muscle.to].map(|a| MaterialVector::point(a.body, &a.at, &reference));
        let middle = at(MaterialVector::combine(0.5, &from, 0.5, &to));
        let span = at(MaterialVector::span(&from, &to));
        let mass = muscle.mass().expect("the muscles of the trunk have a mass");
        rods.push(Mass::point(middle, mass));
        rods.push(Mass::point(span, mass / 12.0));
        let electric = muscle.material.electric.expect("and electric constants");
        cells.push(Element {
            energy: DielectricCell {
                elastic: proboscis::energy::ElasticCell {
                    length: muscle.length(),
                    volume: muscle.volume(),
                    shear_modulus: muscle.material.shear_modulus,
                    law: proboscis::energy::NeoHooke,
                },
                c1: electric.c1,
                c2: electric.c2,
                permittivity: electric.permittivity,
                layer: muscle.layer_thickness,
            },
            vectors: [VectorArg {
                vector: span,
                stencil: Stencil::Mid,
            }],
            scalars: [m],
        });
    }
    let effects: Vec<Box<dyn Term>> = vec![
        Box::new(Inertia::new("bodies", bodies)),
        Box::new(Inertia::new("rods", rods)),
        Box::new(Group::intervals("muscles", -1.0, cells)),
    ];
    let scalars = model.action.intervals.scalars;
    let effects = effects.into_iter().map(Into::into).collect();
    let intervals = Functional::new(effects, Vec::new(), list.len(), scalars);
    let instants = Functional::new(Vec::new(), Vec::new(), list.len(), 0);
    model.action = Reduced::new(model.action.map.clone(), intervals, instants);
    variant
}

/// The table of pairs, and how many times as long a step takes with each effect.
fn table(mut pairs: Vec<Pair>) -> (String, Vec<(&'static str, f64)>) {
    for _ in 0..ROUNDS {
        for pair in &mut pairs {
            pair.with.run();
            pair.without.run();
        }
    }
    let mut text = String::from(
        "| effect | scene | unknowns of a step, without → with | entries of the tangent | µs a step, without → with | Newton iterations a step | tip moves by, mm |\n\
         |:--|:--|--:|--:|--:|--:|--:|\n",
    );
    for Pair {
        effect,
        scene,
        with,
        without,
    } in &pairs
    {
        let ([a, b], [c, d]) = (without.sizes(), with.sizes());
        let factored = |v: &Variant| match v.model.step_symmetry() {
            Symmetry::Symmetric => " (LDLᵀ)",
            Symmetry::Unsymmetric => "",
        };
        let times = [without.time()[1], with.time()[1]];
        let moved = (with.tip - without.tip).norm();
        writeln!(
            text,
            "| {effect} | {scene} | {a} → {c} | {b} → {d} | {:.1}{} → {:.1}{} | {:.2} → {:.2} | {moved:.1e} |",
            times[0],
            factored(without),
            times[1],
            factored(with),
            without.iterations,
            with.iterations,
        )
        .expect("a string takes text");
    }
    let factor = |pair: &Pair| (pair.effect, pair.with.time()[1] / pair.without.time()[1]);
    (text, pairs.iter().map(factor).collect())
}

/// A scene without an effect against the same written out by hand.
fn specialised(system: &System, volts: &[f64]) -> (String, [f64; 2]) {
    let mut inviscid = system.clone();
    for muscle in &mut inviscid.muscles {
        muscle.material.viscosity = None;
    }
    // Every muscle has a voltage here, so that scene and hand list the same cells.
    let volts: Vec<f64> = volts.iter().map(|v| v.max(100.0)).collect();
    let mut variants = [
        called(
            "scene without viscosity",
            inviscid.clone(),
            &volts,
            Coordinates::Reduced,
        ),
        by_hand(&inviscid, &volts),
        called(
            "scene without viscosity, again",
            inviscid,
            &volts,
            Coordinates::Reduced,
        ),
        called(
            "scene with viscosity",
            system.clone(),
            &volts,
            Coordinates::Reduced,
        ),
    ];
    race(&mut variants);
    let [reference, hand, ..] = &variants;
    assert!(
        (reference.tip - hand.tip).norm() == 0.0 && reference.tip.norm() > 1.0,
        "the hand wrote another scene: {} {}",
        reference.tip,
        hand.tip
    );
    let base = reference.time()[1];
    let mut text = String::from(
        "| trunk, reduced | µs a step: quartile, median, quartile | median over the first | Newton iterations a step |\n|:--|--:|--:|--:|\n",
    );
    for variant in &variants {
        let [low, middle, high] = variant.time();
        writeln!(
            text,
            "| {} | {low:.2}, {middle:.2}, {high:.2} | {:.3} | {:.2} |",
            variant.name,
            middle / base,
            variant.iterations
        )
        .expect("a string takes text");
    }
    let over = |k: usize| variants[k].time()[1] / base;
    (text, [over(1), over(2)])
}

/// Conclusion of the tables: the cost of absence, and the effects that cost most.
fn conclusion(mut factors: Vec<(&str, f64)>, [by_hand, again]: [f64; 2]) -> String {
    factors.sort_by(|a, b| b.1.total_cmp(&a.1));
    let close = factors
        .iter()
        .filter(|(_, factor)| (factor - 1.0).abs() < 0.1);
    let close = close.count();
    let dearest = factors.iter().take(3);
    let dearest = dearest.map(|(effect, factor)| format!("{effect} ({factor:.1} times as long)"));
    let dearest: Vec<_> = dearest.collect();
    let absent = match (by_hand - 1.0).abs() < 0.05 {
        true => "costs nothing that can be measured",
        false => "costs time",
    };
    format!(
        "An effect that a scene does not call for {absent}: a step takes {:.3} of the time of one written by hand without it, \
         where the same step timed twice gives {again:.3}. {close} of {} effects change the time of a step by less than a tenth; \
         those that cost most are {}.",
        1.0 / by_hand,
        factors.len(),
        dearest.join(", ")
    )
}

fn main() {
    let (system, control) = trunk::read(1, Coordinates::Reduced);
    let BoundaryState::RestAtVoltages(volts, _) = &control.goal else {
        panic!("the goal of the trunk problem is a state of rest");
    };
    let (of_trunk, mut factors) = table(pairs_of_trunk(&system, volts));
    let (of_block, more) = table(pairs_of_block());
    factors.extend(more);
    let (by_hand, ratios) = specialised(&system, volts);
    let text = format!(
        "# What each effect costs, and what it changes\n\n**Conclusion.** {}\n\n\
         Written by `cargo bench --bench effects -- --write`. Times are medians of {ROUNDS} rounds in which all variants take turns;\n\
         they are compared within this run only. The trunk takes {STEPS} steps of 10 ms under the voltages of `problems/elephant_trunk_effort.json`,\n\
         the block {BLOCK_STEPS} steps of 0.5 ms under {VOLTAGE:.0} V; its weight pulls aside. \
         The last column is the distance of both tips at the end.\n\n\
         {of_trunk}\n{of_block}\n\
         ## An absent effect against a program without it\n\n\
         The effects of the trunk without viscosity are listed by hand, from the same formulas, and stepped by the same code. Scene and\n\
         hand end at the same point to the last bit; the third row is the first one once more, and shows the noise.\n\n{by_hand}",
        conclusion(factors, ratios),
    );
    println!("{text}");
    if std::env::args().any(|argument| argument == "--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/results/gallery/effects.md");
        std::fs::write(path, text).expect("results can be written");
    }
}
