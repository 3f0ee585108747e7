//! One step of the forward motion of the trunk at h = 10 ms, the mean over a swing of one second.

mod trunk;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use proboscis::model::Coordinates::{Reduced, Redundant};
use std::time::Duration;
use trunk::{at_rest, march};

/// Steps of one swing.
const STEPS: usize = 100;

fn step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    group
        .throughput(Throughput::Elements(STEPS as u64))
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    for coordinates in [Reduced, Redundant] {
        let (model, start, scalars) = at_rest(coordinates);
        group.bench_function(coordinates.name(), |b| {
            b.iter(|| march(&model, &start, &scalars, STEPS));
        });
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
