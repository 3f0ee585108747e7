//! Callbacks of the transcribed trunk on finer and finer grids; throughput counts intervals.

mod trunk;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use proboscis::model::Coordinates::{self, Reduced, Redundant};
use std::time::Duration;
use trunk::{Callbacks, with_program};

const CASES: [(Coordinates, usize); 6] = [
    (Reduced, 40),
    (Reduced, 80),
    (Reduced, 160),
    (Reduced, 320),
    (Reduced, 640),
    (Redundant, 40),
];

fn callbacks(criterion: &mut Criterion) {
    for (coordinates, intervals) in CASES {
        let mut group = criterion.benchmark_group(format!("callbacks, {}", coordinates.name()));
        group
            .throughput(Throughput::Elements(intervals as u64))
            .sample_size(20)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(1));
        with_program(intervals, coordinates, |program, start| {
            let mut callbacks = Callbacks::new(program, start);
            group.bench_function(BenchmarkId::new("constraint", intervals), |b| {
                b.iter(|| callbacks.constraint());
            });
            group.bench_function(BenchmarkId::new("jacobian", intervals), |b| {
                b.iter(|| callbacks.jacobian());
            });
            group.bench_function(BenchmarkId::new("hessian", intervals), |b| {
                b.iter(|| callbacks.hessian());
            });
        });
        group.finish();
    }
}

criterion_group!(benches, callbacks);
criterion_main!(benches);
