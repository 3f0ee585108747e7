//! One hexahedron: microseconds of an evaluation.

use criterion::{Criterion, criterion_group, criterion_main};
use proboscis::element::{
    Dielectric, Elastomer, ElementEnergy, ElementGeometry, Field, Local, NodeState, Passive,
    Viscosity, ViscousContraction, ViscousLocal, Volume,
};
use proboscis::energy::NeoHooke;
use proboscis::math::Vector;
use std::hint::black_box;
use std::time::Duration;

/// A distorted hexahedron, a state, and a direction.
struct State {
    shape: ElementGeometry,
    x: [Vector; 8],
    v: [Vector; 8],
    phi: [f64; 8],
}

fn state() -> State {
    let signs = [(0, 0), (1, 0), (1, 1), (0, 1)];
    let nodes: [Vector; 8] = std::array::from_fn(|i| {
        let (a, b) = signs[i % 4];
        Vector::new(f64::from(a), f64::from(b), (i / 4) as f64)
    });
    let bent = |x: Vector, by: f64| x + Vector::new(x.y * x.z, x.x * x.x, x.x * x.y) * by;
    State {
        shape: ElementGeometry::new(&nodes.map(|x| bent(x, 0.1))).expect("a hexahedron"),
        x: nodes.map(|x| bent(x, 0.2)),
        v: nodes.map(|x| bent(x, 0.3) * 0.1),
        phi: nodes.map(|x| 1e3 * x.z + 10.0 * x.x),
    }
}

fn variations<F: Field>(
    criterion: &mut Criterion,
    name: &str,
    law: &Elastomer<F>,
    potentials: &F::Potentials<8>,
) {
    let mut group = criterion.benchmark_group(name);
    group
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    let State { shape, x, v, .. } = state();
    let (mut local, mut along) = (Local::default(), Local::default());
    let at = NodeState::new(&shape, &x, potentials);
    let moving = at.along(&v, potentials);
    group.bench_function("energy", |b| b.iter(|| law.energy(black_box(&at))));
    group.bench_function("gradient", |b| {
        b.iter(|| law.gradient(black_box(&at), black_box(&mut local)));
    });
    group.bench_function("tangent", |b| {
        b.iter(|| law.tangent(black_box(&at), black_box(&mut local)));
    });
    group.bench_function("third", |b| {
        b.iter(|| {
            law.third(
                black_box(&moving),
                black_box(&mut local),
                black_box(&mut along),
            );
        });
    });
    group.finish();
}

fn hexahedron(criterion: &mut Criterion) {
    let field = Dielectric {
        c1: -3.5e-11,
        c2: 1.8e-11,
        permittivity: 8.854e-12,
    };
    let phi = state().phi;
    for (suffix, volume) in [("hex8", Volume::Pointwise), ("hex8_q1p0", Volume::Mean)] {
        let passive = Elastomer {
            shear_modulus: 0.1,
            lame_lambda: 1.0,
            volume,
            field: Passive,
            law: NeoHooke,
        };
        let dielectric = Elastomer {
            shear_modulus: 0.1,
            lame_lambda: 1.0,
            volume,
            field,
            law: NeoHooke,
        };
        variations(criterion, &format!("passive {suffix}"), &passive, &());
        variations(
            criterion,
            &format!("dielectric {suffix}"),
            &dielectric,
            &phi,
        );
    }
}

fn viscosity(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("viscous");
    group
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    let State { shape, x, v, .. } = state();
    let law = Viscosity { viscosity: 2e-3 };
    let mut forces = [Vector::zeros(); 8];
    let mut local = ViscousLocal::default();
    let mut contraction = ViscousContraction::default();
    group.bench_function("forces", |b| {
        b.iter(|| law.forces(black_box(&shape), black_box(&x), &v, black_box(&mut forces)));
    });
    group.bench_function("tangent", |b| {
        b.iter(|| law.tangent(black_box(&shape), black_box(&x), &v, black_box(&mut local)));
    });
    group.bench_function("contraction", |b| {
        b.iter(|| {
            law.contraction(
                black_box(&shape),
                black_box(&x),
                &v,
                &x,
                black_box(&mut contraction),
            );
        });
    });
    group.finish();
}

criterion_group!(benches, hexahedron, viscosity);
criterion_main!(benches);
